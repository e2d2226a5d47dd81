/// test_database.c: the motion database, performed: each sequence becomes a take, its player is
/// read from the take, and plays from the tips alone; the null-space posture comes from the
/// regression over the other two players in that nuance. The joints are then compared with the
/// captured ones.
///
/// One sequence of each nuance, or all 45 with HIMC_LONG (make test-long): 3 players, 5 nuances, 3
/// spots. Without noise and with exact limbs and masses, so that the errors are those of the
/// control.
#include "tools/himc/trial.h"

#include "unity.h"
#include "control/controller.h"

#include <stdio.h>
#include <stdlib.h>

#define FRAMES 8192
#define DEGREE (HIMC_PI / 180)
#define AROUND 0.08 // time around an impact in which the mallet is fastest (s)

// a sequence's simulated tips
typedef struct film {
    int frames;
    double time[FRAMES];
    himc_vec3 tip[FRAMES][HIMC_HANDS];
    double elbow[FRAMES][HIMC_HANDS][2]; // heights: captured, simulated (m)
} film;

// sums over the sequences of a nuance
typedef struct sums {
    int count, strokes, gaps;
    double played;
    double all, outside; // squares of RMS over amplitude
    double elbow[2];     // ranges of the elbows' heights, captured and simulated, likewise
    double whole[2];     // the same, from a sequence's lowest to its highest
    double angle[3];     // squares of RMS: shoulder, elbow, wrist (rad^2)
    double speed;        // of the mallets at impact (m/s), all strokes
    double height;       // from it to the next apex (m), all gaps between strokes
    double depth;        // range towards and from the player (m), likewise
} sums;

static film seen;
static himc_error error;

void setUp(void)
{
    error.text[0] = 0;
}

void tearDown(void)
{
}

static bool is_long(void)
{
    return getenv("HIMC_LONG") != NULL;
}

static void keep_frame(void *user, const trial_frame *frame)
{
    film *f = user;
    TEST_ASSERT_TRUE(f->frames < FRAMES);
    f->time[f->frames] = frame->time;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        f->tip[f->frames][hand] = frame->simulated->tip[hand];
        f->elbow[f->frames][hand][0] = frame->captured->origin[HIMC_LEFT_FOREARM + hand].z;
        f->elbow[f->frames][hand][1] = frame->simulated->elbow[hand].z;
    }
    f->frames++;
}

// fastest downwards around an impact (m/s)
static double impact_speed(const film *f, himc_hand hand, double at)
{
    double fastest = 0;
    for (int i = 1; i < f->frames; i++)
        if (fabs(f->time[i] - at) < AROUND) {
            double fall = f->tip[i - 1][hand].z - f->tip[i][hand].z;
            fastest = fmax(fastest, fall / (f->time[i] - f->time[i - 1]));
        }
    return fastest;
}

// ranges of its heights, captured and simulated (m)
static void add_elbow(const film *f, himc_hand hand, double from, double to, double range[2])
{
    double high[2] = {-9, -9}, low[2] = {9, 9};
    for (int i = 0; i < f->frames; i++)
        for (int which = 0; which < 2; which++) {
            double z = f->elbow[i][hand][which];
            if (f->time[i] < from || f->time[i] > to)
                continue;
            high[which] = fmax(high[which], z);
            low[which] = fmin(low[which], z);
        }
    range[0] += high[0] - low[0];
    range[1] += high[1] - low[1];
}

static void measure_gap(const film *f, himc_hand hand, double from, double to, sums *s)
{
    double high = -9, low = 9, near = 9, far = -9;
    for (int i = 0; i < f->frames; i++) {
        himc_vec3 x = f->tip[i][hand];
        if (f->time[i] < from || f->time[i] > to)
            continue;
        high = fmax(high, x.z), low = fmin(low, x.z);
        far = fmax(far, x.x), near = fmin(near, x.x);
    }
    s->height += high - low;
    s->depth += far - near;
    s->gaps++;
    add_elbow(f, hand, from, to, s->elbow);
}

// the simulated strokes, without the first and the last of a hand
static void measure_strokes(const film *f, const himc_mocap_config *config, sums *s)
{
    himc_mocap *mocap = himc_mocap_new(config, &error);
    double last[HIMC_HANDS] = {-1, -1};
    TEST_ASSERT_NOT_NULL_MESSAGE(mocap, error.text);
    for (int i = 0; i < himc_mocap_touches(mocap); i++) {
        himc_mocap_touch touch = himc_mocap_touch_at(mocap, i);
        if (last[touch.hand] >= f->time[0] && touch.time <= f->time[f->frames - 1]) {
            s->speed += impact_speed(f, touch.hand, touch.time);
            measure_gap(f, touch.hand, last[touch.hand], touch.time, s);
        }
        last[touch.hand] = touch.time;
    }
    himc_mocap_free(mocap);
}

static void play_sequence(const trial_kind *kind, int number, sums *s)
{
    trial_config config = trial_default(kind, number);
    trial_result r;
    config.noise = config.mass_error = config.length_error = 0;
    config.limits = false;
    config.bent = true;
    config.frame = keep_frame;
    config.user = &seen;
    seen.frames = 0;
    TEST_ASSERT_TRUE_MESSAGE(trial_run(&config, &r, &error), error.text);
    himc_mocap_config sequence = trial_sequence(&config);
    measure_strokes(&seen, &sequence, s);
    const double angle[3] = {r.shoulder_error, r.elbow_error, r.wrist_error};
    for (int k = 0; k < 3; k++)
        s->angle[k] += angle[k] * angle[k];
    s->all += r.rms * r.rms / (r.amplitude * r.amplitude);
    s->outside += r.outside * r.outside / (r.amplitude * r.amplitude);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        add_elbow(&seen, (himc_hand)hand, 0, seen.time[seen.frames - 1], s->whole);
    s->strokes += (int)r.strokes;
    s->played += r.played;
    s->count++;
}

static void print_row(const char *name, const sums *s)
{
    double n = s->count;
    printf("%-16s %9.4f %9.4f %6.3f %6.3f %6.2f %6.2f %6.2f %6.2f %6.0f %6.0f %4.0f/%d\n", name,
           100 * sqrt(s->outside / n), 100 * sqrt(s->all / n), s->elbow[1] / s->elbow[0],
           s->whole[1] / s->whole[0], sqrt(s->angle[0] / n) / DEGREE,
           sqrt(s->angle[1] / n) / DEGREE, sqrt(s->angle[2] / n) / DEGREE, s->speed / s->gaps,
           1e3 * s->height / s->gaps, 1e3 * s->depth / s->gaps, s->played, s->strokes);
}

static void add_sums(const sums *a, sums *total)
{
    total->count += a->count, total->strokes += a->strokes, total->gaps += a->gaps;
    total->played += a->played, total->all += a->all, total->outside += a->outside;
    total->speed += a->speed;
    total->height += a->height, total->depth += a->depth;
    for (int k = 0; k < 3; k++)
        total->angle[k] += a->angle[k];
    for (int i = 0; i < 2; i++)
        total->elbow[i] += a->elbow[i], total->whole[i] += a->whole[i];
}

// nuances, a row of the table each, all of them if long; the sums of all
static sums play_database(himc_pipeline controller, himc_law law, int few,
                          sums nuance[HIMC_NUANCES])
{
    sums total = {0};
    printf("%-16s %9s %9s %6s %6s %6s %6s %6s %6s %6s %6s\n",
           trial_controller_name(controller).text, "outside %", "all %", "elbow", "whole", "sh deg",
           "el deg", "wr deg", "m/s", "mm", "deep");
    for (int i = 0; i < (is_long() ? HIMC_NUANCES : few); i++) {
        trial_kind kind = {(himc_nuance)i, controller, law};
        nuance[i] = (sums){0};
        int count = is_long() ? TRIAL_SEQUENCES : 1;
        for (int k = 0; k < count; k++) // else another player and spot in each nuance
            play_sequence(&kind, 1 + (count == 1 ? (4 * i) % TRIAL_SEQUENCES : k), &nuance[i]);
        print_row(himc_nuance_name(kind.nuance), &nuance[i]);
        add_sums(&nuance[i], &total);
    }
    print_row("all", &total);
    return total;
}

static double percent(double squares, const sums *s)
{
    return 100 * sqrt(squares / s->count);
}

// The elbow's range is that of a stroke, and that of a whole sequence; in a sequence the captured
// trunk drifts by 0.3 degrees, which the tips do not show.
static void expect_unseen_joints(const sums *s)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1, s->elbow[1] / s->elbow[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1, s->whole[1] / s->whole[0]);
    for (int k = 0; k < 3; k++)
        TEST_ASSERT_TRUE(sqrt(s->angle[k] / s->count) < DEGREE);
}

// as in figure 6(a) of the 2012 paper and in captured strokes (mocap/README.md)
static void expect_order(const sums *n)
{
    double speed[HIMC_NUANCES], height[HIMC_NUANCES], depth[HIMC_NUANCES];
    for (int i = 0; i < HIMC_NUANCES; i++) {
        speed[i] = n[i].speed / n[i].gaps;
        height[i] = n[i].height / n[i].gaps;
        depth[i] = n[i].depth / n[i].gaps;
    }
    for (int i = 0; i < HIMC_NUANCES; i++) {
        TEST_ASSERT_TRUE(i == HIMC_VERTICAL_ACCENT || speed[i] < speed[HIMC_VERTICAL_ACCENT]);
        TEST_ASSERT_TRUE(i == HIMC_STACCATO || speed[i] > speed[HIMC_STACCATO]);
        TEST_ASSERT_TRUE(i == HIMC_ACCENT || height[i] < height[HIMC_ACCENT]);
        TEST_ASSERT_TRUE(i == HIMC_ACCENT || depth[i] > depth[HIMC_ACCENT]);
        TEST_ASSERT_TRUE(i == HIMC_VERTICAL_ACCENT || depth[i] < depth[HIMC_VERTICAL_ACCENT]);
    }
}

static void test_tips_alone_reproduce_the_player(void)
{
    sums nuance[HIMC_NUANCES];
    sums all = play_database(HIMC_PIPELINE_HIMC, HIMC_LAW_COMPUTED_TORQUE, HIMC_NUANCES, nuance);
    TEST_ASSERT_EQUAL_INT(all.strokes, (int)all.played);
    TEST_ASSERT_TRUE(percent(all.outside, &all) < 0.05);
    TEST_ASSERT_TRUE(percent(all.all, &all) < 0.3);
    expect_unseen_joints(&all);
    for (int i = 0; is_long() && i < HIMC_NUANCES; i++) // one player is not the mean of a nuance
        expect_unseen_joints(&nuance[i]);
    if (is_long())
        expect_order(nuance);
}

static void test_feedforward_tips_stay_within_6_thousandths(void)
{
    sums nuance[HIMC_NUANCES];
    sums all = play_database(HIMC_PIPELINE_HIMC, HIMC_LAW_FEEDFORWARD, 1, nuance);
    TEST_ASSERT_EQUAL_INT(all.strokes, (int)all.played);
    TEST_ASSERT_TRUE(percent(all.outside, &all) < 0.6);
}

static void test_id_from_the_joints_has_tips_and_joints(void)
{
    sums nuance[HIMC_NUANCES];
    if (!is_long())
        TEST_IGNORE_MESSAGE("long");
    sums all = play_database(HIMC_PIPELINE_ID, HIMC_LAW_COMPUTED_TORQUE, HIMC_NUANCES, nuance);
    TEST_ASSERT_EQUAL_INT(all.strokes, (int)all.played);
    TEST_ASSERT_TRUE(percent(all.outside, &all) < 0.05);
    TEST_ASSERT_TRUE(percent(all.all, &all) < 0.3);
    for (int i = 0; i < HIMC_NUANCES; i++)
        expect_unseen_joints(&nuance[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tips_alone_reproduce_the_player);
    RUN_TEST(test_feedforward_tips_stay_within_6_thousandths);
    RUN_TEST(test_id_from_the_joints_has_tips_and_joints);
    return UNITY_END();
}
