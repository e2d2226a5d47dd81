/// test_session_long.c: timing, position, dynamics and nuances of strokes in long sessions.
#include "session.h"
#include "base/head_frame.h"

static const char *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent", "staccato"};
static const char *const spots[] = {"center", "normal", "rim"};

typedef struct figures {
    int asked, found, unasked;
    double mean, p99, worst; // of |onset - score| (s)
    int off;                 // beyond 10 ms
    double place;            // RMS (m)
} figures;

static figures measure(const heard *h, int asked)
{
    figures f = {.asked = asked};
    double *away = calloc((size_t)h->strikes + 1, sizeof *away);
    for (int i = 0; i < h->strikes; i++) {
        const himc_strike *s = &h->strike[i];
        if (!isfinite(s->planned_time)) {
            f.unasked++;
            continue;
        }
        away[f.found] = fabs(s->time - s->planned_time);
        f.mean += away[f.found];
        f.off += away[f.found++] > 0.010;
        f.place += pow(s->x - s->planned_x, 2) + pow(s->y - s->planned_y, 2);
    }
    qsort(away, (size_t)f.found, sizeof *away, by_size);
    f.mean /= f.found;
    f.place = sqrt(f.place / f.found);
    f.p99 = away[(int)(0.99 * (f.found - 1))];
    f.worst = away[f.found - 1];
    free(away);
    return f;
}

static void expect_on_time(const figures *f)
{
    int good = f->found - f->off;
    double f1 = 2.0 * good / (f->asked + f->found + f->unasked);
    printf("%d strokes: mean %.3f ms, 99 %% %.3f ms, worst %.3f ms, F1 %.4f, place %.2f mm\n",
           f->asked, 1e3 * f->mean, 1e3 * f->p99, 1e3 * f->worst, f1, 1e3 * f->place);
    TEST_ASSERT_TRUE(f->mean <= 0.002);
    TEST_ASSERT_TRUE(f->p99 <= 0.005);
    TEST_ASSERT_EQUAL_DOUBLE(1, f1);
    TEST_ASSERT_TRUE(f->place <= 0.015);
}

// adds `count` strokes, hands in turn, at the performer's present tempo; returns the last beat
static double write_strokes(himc_performance *p, unsigned *seed, int count, double beat,
                            double seconds_per_beat)
{
    static const double steps[] = {0.25, 0.5, 0.5, 1, 1, 1.5, 2};
    for (int i = 0; i < count; i++) {
        double step = steps[choose(seed, 7)];
        while (step * seconds_per_beat < 0.15) // each hand then has 0.3 s
            step *= 2;
        beat += step;
        session_do(p, "stroke %.6f %s %s %.3f %s", beat, i & 1 ? "right" : "left",
                   nuances[choose(seed, 5)], chance(seed), spots[choose(seed, 3)]);
    }
    return beat;
}

static void test_500_random_strokes_from_40_to_200_beats_land_on_time_and_place(void)
{
    static const int tempi[] = {40, 72, 100, 140, 200};
    unsigned seed = 5;
    heard h = {0};
    for (int i = 0; i < 5; i++) {
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        session_do(p, "tempo %d", tempi[i]);
        double beat = write_strokes(p, &seed, 100, 2, 60.0 / tempi[i]);
        session_do(p, "play");
        session_play(p, (beat + 1) * 60 / tempi[i] + 3, &h);
        himc_performance_free(p);
    }
    figures f = measure(&h, 500);
    expect_on_time(&f);
    heard_free(&h);
}

static double spearman(const double *force, const double *asked, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++) {
        int a = 0, b = 0;
        for (int j = 0; j < count; j++) {
            a += force[j] < force[i];
            b += asked[j] < asked[i];
        }
        sum += (double)(a - b) * (a - b);
    }
    return 1 - 6 * sum / ((double)count * ((double)count * count - 1));
}

static void test_dynamics_rise_from_ppp_to_fff_for_each_nuance_and_spot(void)
{
    double worst_range = 1e9, worst_rank = 1;
    for (int n = 0; n < 5; n++)
        for (int s = 0; s < 3; s++) {
            enum { COUNT = 14 };
            double force[COUNT], asked[COUNT];
            himc_performance *p = session_new();
            heard h = {0};
            session_do(p, "drum kettle");
            session_do(p, "tempo 60");
            for (int i = 0; i < COUNT; i++) {
                asked[i] = (i * 5 % COUNT) / (COUNT - 1.0); // not in order
                session_do(p, "stroke %g %s %s %.4f %s", 2 + 0.9 * i, i & 1 ? "right" : "left",
                           nuances[n], asked[i], spots[s]);
            }
            session_do(p, "play");
            session_play(p, 2 + 0.9 * COUNT + 1, &h);
            himc_performance_free(p);
            TEST_ASSERT_EQUAL_INT(COUNT, h.strikes);
            double soft = 0, loud = 0;
            for (int i = 0; i < COUNT; i++) {
                force[i] = h.strike[i].force;
                soft = asked[i] == 0 ? force[i] : soft;
                loud = asked[i] == 1 ? force[i] : loud;
            }
            worst_range = fmin(worst_range, 20 * log10(loud / soft));
            worst_rank = fmin(worst_rank, spearman(force, asked, COUNT));
            heard_free(&h);
        }
    printf("210 strokes: smallest range %.1f dB, smallest Spearman %.4f\n", worst_range,
           worst_rank);
    TEST_ASSERT_TRUE(worst_range >= 20);
    TEST_ASSERT_TRUE(worst_rank >= 0.98);
}

// the tips' positions over the drumhead in a session, at 250 Hz
typedef struct watch {
    double (*height)[HIMC_HANDS], (*away)[HIMC_HANDS];
    int count, room;
} watch;

static void keep_row(void *user, const himc_motion_row *row)
{
    watch *w = user;
    himc_head_frame place = {.center = {0.75, 0, 0.85}, .radius = 0.2921};
    for (int hand = 0; hand < HIMC_HANDS && w->count < w->room; hand++) {
        himc_vec3 at = himc_head_frame_from_world(&place, row->tip[hand]);
        w->height[w->count][hand] = at.z;
        w->away[w->count][hand] = at.x;
    }
    w->count += w->count < w->room;
}

#define FEATURES 4

static void features_of(const watch *w, const himc_strike *s, double f[FEATURES])
{
    int touch = (int)(s->time * 250), top = touch, back = touch, bounce = touch;
    for (int i = touch - 120; i < touch; i++)
        if (w->height[i][s->hand] > w->height[top][s->hand])
            top = i;
    for (int i = touch - 120; i < touch; i++)
        if (w->away[i][s->hand] < w->away[back][s->hand])
            back = i;
    for (int i = touch; i < touch + 90; i++) // a soft rebound takes 0.3 s
        if (w->height[i][s->hand] > w->height[bounce][s->hand])
            bounce = i;
    f[0] = log(w->height[top][s->hand]);
    f[1] = log(s->velocity);
    f[2] = log(w->height[bounce][s->hand] / w->height[top][s->hand]);
    f[3] = log(fmax(s->x - w->away[back][s->hand], 1e-3));
}

static int nuance_of(const himc_strike *s)
{
    for (int n = 0; n < 5; n++)
        if (strcmp(s->nuance, nuances[n]) == 0)
            return n;
    return 0;
}

// centroids of the nuances, and their pooled covariance
typedef struct classes {
    double centre[HIMC_NUANCES][FEATURES], scatter[FEATURES][FEATURES];
} classes;

// scatter = L L', in place
static void factor(double a[FEATURES][FEATURES])
{
    for (int i = 0; i < FEATURES; i++)
        for (int j = 0; j <= i; j++) {
            double sum = a[i][j];
            for (int k = 0; k < j; k++)
                sum -= a[i][k] * a[j][k];
            a[i][j] = i == j ? sqrt(sum) : sum / a[j][j];
        }
}

// distance to a centroid in units of the scatter (Mahalanobis 1936)
static double distance(const classes *c, int n, const double f[FEATURES])
{
    double z[FEATURES], sum = 0;
    for (int i = 0; i < FEATURES; i++) {
        z[i] = f[i] - c->centre[n][i];
        for (int k = 0; k < i; k++)
            z[i] -= c->scatter[i][k] * z[k];
        z[i] /= c->scatter[i][i];
        sum += z[i] * z[i];
    }
    return sum;
}

static int nearest(const classes *c, const double f[FEATURES])
{
    int best = 0;
    for (int n = 1; n < HIMC_NUANCES; n++)
        if (distance(c, n, f) < distance(c, best, f))
            best = n;
    return best;
}

// learned from every second stroke beginning with `first`
static classes learn(double (*f)[FEATURES], const heard *h, int first)
{
    classes c = {{{0}}, {{0}}};
    int of[HIMC_NUANCES] = {0};
    for (int i = first; i < h->strikes; i += 2) {
        int n = nuance_of(&h->strike[i]);
        of[n]++;
        for (int k = 0; k < FEATURES; k++)
            c.centre[n][k] += f[i][k];
    }
    for (int n = 0; n < HIMC_NUANCES; n++)
        for (int k = 0; k < FEATURES; k++)
            c.centre[n][k] /= of[n];
    for (int i = first; i < h->strikes; i += 2)
        for (int j = 0; j < FEATURES; j++)
            for (int k = 0; k < FEATURES; k++)
                c.scatter[j][k] += (f[i][j] - c.centre[nuance_of(&h->strike[i])][j]) *
                                   (f[i][k] - c.centre[nuance_of(&h->strike[i])][k]);
    factor(c.scatter);
    return c;
}

// the share recognised: each half of the strokes by the classes of the other half
static double recognised(double (*f)[FEATURES], const heard *h)
{
    int right = 0;
    for (int half = 0; half < 2; half++) {
        classes c = learn(f, h, half);
        for (int i = 1 - half; i < h->strikes; i += 2)
            right += nearest(&c, f[i]) == nuance_of(&h->strike[i]);
    }
    return (double)right / h->strikes;
}

static void test_nuances_are_recognised_by_height_speed_rebound_and_depth(void)
{
    enum { COUNT = 250 };
    unsigned seed = 11;
    himc_performance *p = session_new();
    heard h = {0};
    watch w = {.room = 250 * 200};
    w.height = calloc((size_t)w.room, sizeof *w.height);
    w.away = calloc((size_t)w.room, sizeof *w.away);
    session_do(p, "drum kettle");
    session_do(p, "tempo 60");
    for (int i = 0; i < COUNT; i++)
        session_do(p, "stroke %g %s %s %.3f", 2 + 0.6 * i, i & 1 ? "right" : "left",
                   nuances[choose(&seed, 5)], chance(&seed));
    himc_performance_on_motion(p, keep_row, &w);
    session_do(p, "play");
    session_play(p, 2 + 0.6 * COUNT + 1, &h);
    himc_performance_free(p);
    TEST_ASSERT_EQUAL_INT(COUNT, h.strikes);
    double(*f)[FEATURES] = calloc(COUNT, sizeof *f);
    for (int i = 0; i < COUNT; i++)
        features_of(&w, &h.strike[i], f[i]);
    double share = recognised(f, &h);
    printf("nuances recognised: %.1f %%\n", 100 * share);
    free(f), free(w.height), free(w.away);
    heard_free(&h);
    TEST_ASSERT_TRUE(share >= 0.95);
}

static void test_ten_minutes_of_4000_strokes_load_and_land(void)
{
    enum { COUNT = 4000 };
    char path[] = "/tmp/himc-piece-XXXXXX";
    unsigned seed = 21;
    FILE *file = fdopen(mkstemp(path), "w");
    fprintf(file, "tempo 60; drum kettle;\n");
    double beat = 2;
    for (int i = 0; i < COUNT; i++, beat += 0.15 * (0.95 + 0.1 * chance(&seed)))
        fprintf(file, "stroke %.5f %s %s %.3f %s;\n", beat, i & 1 ? "right" : "left",
                nuances[choose(&seed, 5)], chance(&seed), spots[choose(&seed, 3)]);
    fclose(file);
    himc_performance *p = session_new();
    heard h = {0};
    bool loaded = session_try(p, "score %s", path);
    unlink(path);
    TEST_ASSERT_TRUE_MESSAGE(loaded, error.text);
    session_do(p, "play");
    session_play(p, beat + 4, &h);
    himc_performance_stats s = himc_performance_measure(p);
    printf("%.0f s, played %d, tips within %.4f mm, recoveries %ld\n", s.seconds, s.played,
           1e3 * s.tip_rms, s.recoveries);
    himc_performance_free(p);
    figures f = measure(&h, COUNT);
    expect_on_time(&f);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    TEST_ASSERT_EQUAL_INT(0, (int)s.recoveries);
    heard_free(&h);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_500_random_strokes_from_40_to_200_beats_land_on_time_and_place);
    RUN_TEST(test_dynamics_rise_from_ppp_to_fff_for_each_nuance_and_spot);
    RUN_TEST(test_nuances_are_recognised_by_height_speed_rebound_and_depth);
    RUN_TEST(test_ten_minutes_of_4000_strokes_load_and_land);
    return UNITY_END();
}
