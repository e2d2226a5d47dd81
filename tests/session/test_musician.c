/// test_musician.c: relations that a musician takes for granted, whatever is played: equal strokes
/// are equal, louder is louder, mirrored is mirrored. Strokes are drawn from a seed over all
/// nuances, dynamics, intervals of 80 to 1000 ms, hands, tempi, scores and hits. What is compared
/// is the simulated impact. HIMC_LONG=1 draws ten times as many.
#include "session.h"

#define EQUAL 0.5 // of equal strokes, at most (dB): below what is heard
// of what is the same but for the time at which the ticks of 4 ms fall, up or down (dB)
#define SAME 0.05
#define SAME_TIME 0.0002 // two steps of the physics (s)
#define MOST 64
#define STATE "musician-state"

static const char *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent", "staccato"};
static const char *const hand_names[] = {"left", "right", "two", "any"};
enum { LEFT, RIGHT, TWO, ANY, WAYS };

/// Equal strokes at equal intervals.
typedef struct run {
    int nuance, way, count;
    bool hits;
    double dynamic, interval, latency, tempo, begin; ///< seconds; beats a minute
} run;

typedef struct played {
    heard h;
    char what[512]; ///< what was asked, and what came
} played;

static int draws(int few)
{
    return getenv("HIMC_LONG") ? 10 * few : few;
}

static run draw(unsigned *seed)
{
    run r = {.nuance = choose(seed, 5), .count = 6};
    r.hits = choose(seed, 2);
    r.way = choose(seed, r.hits ? WAYS : ANY);
    r.dynamic = chance(seed);
    r.interval = 0.08 * pow(12.5, chance(seed));
    r.latency = choose(seed, 2) ? 0.15 : 0.06 + 0.27 * chance(seed);
    r.tempo = 40 + 160 * chance(seed);
    r.begin = 1;
    return r;
}

static const char *hand_of(const run *r, int i)
{
    return r->way == TWO ? hand_names[i % 2] : hand_names[r->way];
}

static himc_performance *at_one_drum(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_drum(p, 0, "modes 6"); // to save time
    return p;
}

static void write_score(himc_performance *p, const run *r)
{
    session_do(p, "tempo %.9g", r->tempo);
    for (int i = 0; i < r->count; i++)
        session_do(p, "stroke %.9g %s %s %.9g", (r->begin + i * r->interval) * r->tempo / 60,
                   hand_of(r, i), nuances[r->nuance], r->dynamic);
}

static double length(const run *r)
{
    return r->begin + r->count * r->interval + 0.3;
}

/// What was asked and what came, for a failure.
static void describe(played *x, const run *r)
{
    int n = snprintf(x->what, sizeof x->what,
                     "%d %s, %s, %s %.3f every %.1f ms, latency %.0f ms, %.1f bpm:", r->count,
                     r->hits ? "hits" : "strokes", hand_names[r->way], nuances[r->nuance],
                     r->dynamic, 1e3 * r->interval, 1e3 * r->latency, r->tempo);
    for (int i = 0; i < x->h.strikes && n < (int)sizeof x->what - 16; i++)
        n += snprintf(x->what + n, sizeof x->what - (size_t)n, " %.3f", x->h.strike[i].velocity);
    snprintf(x->what + n, sizeof x->what - (size_t)n, " m/s");
}

static void play_on(himc_performance *p, const run *r, played *x)
{
    x->h = (heard){0};
    if (!r->hits) {
        session_do(p, "play");
        session_play(p, length(r), &x->h);
    } else {
        session_do(p, "latency %.9g", 1e3 * r->latency);
        session_play(p, 0.6, &x->h);
        for (int i = 0; i < r->count; i++) {
            session_do(p, "hit %s %s %.9g", hand_of(r, i), nuances[r->nuance], r->dynamic);
            session_play(p, r->interval, &x->h);
        }
        session_play(p, 0.5, &x->h);
    }
    describe(x, r);
}

static played play(const run *r)
{
    played x;
    himc_performance *p = at_one_drum();
    if (!r->hits)
        write_score(p, r);
    play_on(p, r, &x);
    himc_performance_free(p);
    return x;
}

static double decibels(double a, double b)
{
    return 20 * log10(a / b);
}

static double mean(const played *x)
{
    double sum = 0;
    for (int i = 0; i < x->h.strikes; i++)
        sum += x->h.strike[i].velocity / x->h.strikes;
    return sum;
}

/// The same strikes, `later` by so much (s).
static void expect_same(const played *a, const played *b, double later, double within)
{
    char what[1200];
    snprintf(what, sizeof what, "%s\nbut then %s", a->what, b->what);
    TEST_ASSERT_EQUAL_INT_MESSAGE(a->h.strikes, b->h.strikes, what);
    for (int i = 0; i < a->h.strikes; i++) {
        const himc_strike *s = &a->h.strike[i], *t = &b->h.strike[i];
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(SAME_TIME, later, t->time - s->time, what);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(within, 0, decibels(t->velocity, s->velocity), what);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(s->nuance, t->nuance, what);
    }
}

static void test_equal_strokes_are_equal_from_the_first_on(void)
{
    unsigned seed = 2801;
    double worst = 0;
    for (int k = draws(10); k > 0; k--) {
        run r = draw(&seed);
        played x = play(&r);
        double low = HUGE_VAL, high = 0;
        TEST_ASSERT_EQUAL_INT_MESSAGE(r.count, x.h.strikes, x.what);
        for (int i = 0; i < x.h.strikes; i++) {
            low = fmin(low, x.h.strike[i].velocity);
            high = fmax(high, x.h.strike[i].velocity);
        }
        worst = fmax(worst, decibels(high, low));
        TEST_ASSERT_TRUE_MESSAGE(decibels(high, low) <= EQUAL, x.what);
        TEST_ASSERT_TRUE_MESSAGE(x.h.softer <= 1, x.what);
        heard_free(&x.h);
    }
    printf("equal strokes differ by %.2f dB at most\n", worst);
}

static void test_louder_is_louder_at_any_interval(void)
{
    unsigned seed = 2802;
    for (int k = draws(2); k > 0; k--) {
        run r = draw(&seed);
        double before = 0;
        r.count = 3;
        for (r.dynamic = 0; r.dynamic <= 1; r.dynamic += 1 / 7.001) {
            played x = play(&r);
            TEST_ASSERT_EQUAL_INT_MESSAGE(r.count, x.h.strikes, x.what);
            TEST_ASSERT_TRUE_MESSAGE(mean(&x) > 1.02 * before, x.what);
            before = mean(&x);
            heard_free(&x.h);
        }
    }
}

// loud and soft in turn, at any interval and latency, by one hand or two
static void test_a_hit_is_never_louder_than_the_same_alone(void)
{
    unsigned seed = 2811;
    for (int k = draws(6); k > 0; k--) {
        run alone = draw(&seed);
        double soft = 0.5 * chance(&seed), loud = soft + (1 - soft) * chance(&seed);
        alone.hits = true;
        alone.latency = choose(&seed, 2) ? 0.15 : 0.015 + 0.1 * chance(&seed);
        alone.interval = 0.09 + 0.3 * chance(&seed);
        run turns = alone;
        alone.latency = 0.33;
        alone.count = 1;
        alone.dynamic = soft;
        played x = play(&alone), y = {.h = {0}};
        himc_performance *p = at_one_drum();
        session_do(p, "latency %.9g", 1e3 * turns.latency);
        session_play(p, 0.6, NULL);
        for (int i = 0; i < 8; i++) {
            session_do(p, "hit %s %s %.9g", hand_of(&turns, i), nuances[turns.nuance],
                       i % 2 ? soft : loud);
            session_play(p, turns.interval, &y.h);
        }
        session_play(p, 0.5, &y.h);
        turns.dynamic = loud;
        describe(&y, &turns);
        TEST_ASSERT_EQUAL_INT_MESSAGE(8, y.h.strikes, y.what);
        for (int i = 1; i < 8; i += 2)
            TEST_ASSERT_TRUE_MESSAGE(
                decibels(y.h.strike[i].velocity, x.h.strike[0].velocity) < 2 * EQUAL, y.what);
        heard_free(&x.h);
        heard_free(&y.h);
        himc_performance_free(p);
    }
}

static void test_slower_is_not_softer_and_with_time_enough_it_is_the_same(void)
{
    unsigned seed = 2803;
    for (int k = draws(1); k > 0; k--) {
        run r = draw(&seed);
        double before = 0, at[2] = {0};
        r.count = 3;
        for (r.interval = 0.08; r.interval < 1.1; r.interval *= 1.37) {
            played x = play(&r);
            TEST_ASSERT_TRUE_MESSAGE(mean(&x) > 0.994 * before, x.what); // 0.05 dB
            before = mean(&x);
            if (r.interval > 0.45) {
                at[0] = at[0] == 0 ? before : at[0];
                at[1] = before;
            }
            heard_free(&x.h);
        }
        TEST_ASSERT_TRUE(decibels(at[1], at[0]) < EQUAL);
    }
}

static void test_another_tempo_has_the_same_dynamics_where_there_is_time(void)
{
    unsigned seed = 2804;
    for (int k = draws(2); k > 0; k--) {
        run r = draw(&seed), slower = r;
        r.hits = slower.hits = false;
        r.way = slower.way = choose(&seed, ANY);
        r.interval = 0.45 + 0.2 * chance(&seed);
        slower.interval = r.interval * (1.1 + chance(&seed));
        slower.tempo = r.tempo * r.interval / slower.interval; // the same beats
        slower.begin = r.begin * r.tempo / slower.tempo;
        r.count = slower.count = 3;
        played x = play(&r), y = play(&slower);
        TEST_ASSERT_EQUAL_INT_MESSAGE(3, y.h.strikes, y.what);
        for (int i = 0; i < 3; i++)
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(
                EQUAL, 0, decibels(x.h.strike[i].velocity, y.h.strike[i].velocity), y.what);
        heard_free(&x.h);
        heard_free(&y.h);
    }
}

/// A passage of both hands, or its mirror image, on a head that is a mirror image of itself.
static played passage(unsigned seed, bool mirrored)
{
    played x = {.what = "a passage"};
    himc_performance *p = at_one_drum();
    session_drum(p, 0, "uniformity 1");
    session_drum(p, 0, "noise 0");
    session_do(p, "tempo 60");
    double beat = 1;
    for (int i = 0; i < 12; i++) {
        int hand = choose(&seed, 2), nuance = choose(&seed, 5);
        double ahead = -0.3 + 0.2 * chance(&seed), aside = 0.02 + 0.06 * chance(&seed);
        double dynamic = chance(&seed), y = (hand == LEFT) == mirrored ? -aside : aside;
        session_do(p, "stroke %.4f %s %s %.3f %.4f %.4f", beat,
                   hand_names[mirrored ? 1 - hand : hand], nuances[nuance], dynamic, ahead, y);
        beat += 0.08 + 0.3 * chance(&seed);
    }
    session_do(p, "play");
    session_play(p, beat + 0.3, &x.h);
    himc_performance_free(p);
    return x;
}

static void test_left_and_right_are_mirror_images(void)
{
    for (int k = draws(3); k > 0; k--) {
        played x = passage(977 * (unsigned)k, false), y = passage(977 * (unsigned)k, true);
        expect_same(&x, &y, 0, 0.01);
        for (int i = 0; i < x.h.strikes; i++) {
            const himc_strike *a = &x.h.strike[i], *b = &y.h.strike[i];
            TEST_ASSERT_NOT_EQUAL(a->hand, b->hand);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, a->x, b->x);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, -a->y, b->y);
        }
        heard_free(&x.h);
        heard_free(&y.h);
    }
}

static void test_later_in_the_score_is_later_by_as_much(void)
{
    unsigned seed = 2806;
    for (int k = draws(3); k > 0; k--) {
        run r = draw(&seed), later = r;
        r.hits = later.hits = false;
        r.way = later.way = choose(&seed, ANY);
        later.begin = r.begin + 2 * chance(&seed);
        played x = play(&r), y = play(&later);
        expect_same(&x, &y, later.begin - r.begin, 3 * SAME);
        heard_free(&x.h);
        heard_free(&y.h);
    }
}

static void test_what_is_played_twice_is_the_same_twice(void)
{
    unsigned seed = 2807;
    for (int k = draws(3); k > 0; k--) {
        run r = draw(&seed);
        r.hits = false;
        r.way = choose(&seed, ANY);
        himc_performance *p = at_one_drum();
        played x, y;
        write_score(p, &r);
        play_on(p, &r, &x);
        session_play(p, 2, NULL);
        play_on(p, &r, &y);
        TEST_ASSERT_EQUAL_INT_MESSAGE(r.count, x.h.strikes, x.what);
        expect_same(&x, &y, y.h.strike[0].time - x.h.strike[0].time, 2 * SAME);
        heard_free(&x.h);
        heard_free(&y.h);
        himc_performance_free(p);
    }
}

static void test_stop_silences_at_any_moment(void)
{
    unsigned seed = 2808;
    for (int k = draws(4); k > 0; k--) {
        run r = draw(&seed);
        played x = {.h = {0}};
        himc_performance *p = at_one_drum();
        r.hits = false;
        r.way = choose(&seed, ANY);
        write_score(p, &r);
        session_do(p, "play");
        session_play(p, r.begin + 2 * r.interval * chance(&seed), NULL);
        session_do(p, "stop");
        session_play(p, 0.2, NULL); // a stroke that is falling lands
        session_play(p, 2.5, &x.h);
        describe(&x, &r);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, x.h.strikes, x.what);
        heard_free(&x.h);
        himc_performance_free(p);
    }
}

static void test_clear_forgets(void)
{
    unsigned seed = 2809;
    for (int k = draws(2); k > 0; k--) {
        run other = draw(&seed), r = draw(&seed);
        other.hits = r.hits = false;
        other.way = r.way = TWO;
        himc_performance *p = at_one_drum();
        played x, y = play(&r);
        write_score(p, &other);
        session_do(p, "clear");
        write_score(p, &r);
        play_on(p, &r, &x);
        expect_same(&y, &x, 0, 1e-9);
        heard_free(&x.h);
        heard_free(&y.h);
        himc_performance_free(p);
    }
}

static void test_a_state_that_is_sent_again_restores_the_playing(void)
{
    unsigned seed = 2810;
    for (int k = draws(2); k > 0; k--) {
        run r = draw(&seed);
        r.hits = false;
        r.way = TWO;
        himc_performance *p = at_one_drum();
        played x = play(&r), y;
        session_do(p, "dump " STATE ".txt");
        session_do(p, "human 0.8 3");
        session_do(p, "grip french");
        session_do(p, "law printed");
        session_do(p, "gain right-wrist 40 2");
        session_do(p, "preset " STATE);
        write_score(p, &r);
        play_on(p, &r, &y);
        expect_same(&x, &y, 0, SAME);
        heard_free(&x.h);
        heard_free(&y.h);
        himc_performance_free(p);
    }
    unlink(STATE ".txt");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_equal_strokes_are_equal_from_the_first_on);
    RUN_TEST(test_louder_is_louder_at_any_interval);
    RUN_TEST(test_a_hit_is_never_louder_than_the_same_alone);
    RUN_TEST(test_slower_is_not_softer_and_with_time_enough_it_is_the_same);
    RUN_TEST(test_another_tempo_has_the_same_dynamics_where_there_is_time);
    RUN_TEST(test_left_and_right_are_mirror_images);
    RUN_TEST(test_later_in_the_score_is_later_by_as_much);
    RUN_TEST(test_what_is_played_twice_is_the_same_twice);
    RUN_TEST(test_stop_silences_at_any_moment);
    RUN_TEST(test_clear_forgets);
    RUN_TEST(test_a_state_that_is_sent_again_restores_the_playing);
    return UNITY_END();
}
