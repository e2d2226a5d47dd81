/// test_tempo_walk.c: a tempo that changes at random from 5 to 600, in steps and in jumps, under
/// rolls, ornaments, bounces and takes. All targets, tips, joints, rows and packets stay finite, no
/// plan is dropped, and the performer plays on afterwards as a new one does.
///
/// 600 changes; 100,000 with HIMC_LONG, as many as HIMC_CHANGES says. HIMC_SEED is another walk.
#include "take_players.h"

#include "finite_watch.h"
#include "session.h"

#define RATE 16000 // (Hz) of samples, physics at 1000 Hz: to save time
#define PIECE 20   // changes of tempo; then another piece
#define SLOWEST 5.0
#define FASTEST 600.0
#define LOUDER 1.6   // than asked for: with little time from high up, and for rounding
#define SWINGING 0.3 // (m/s) of a ringing head that comes to meet the stick

static char take_file[64]; // its own, so that two walks may run at once

static long from_environment(const char *name, long usual)
{
    const char *text = getenv(name);
    return text ? atol(text) : usual;
}

static himc_performance *performer(double physics)
{
    himc_performance_config config = {
        .sample_rate = RATE, .physics_rate = physics, .task_rate = 250};
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    himc_performance_make_drums(p, true);
    session_do(p, "drum kettle 23");
    return p;
}

static void make_take(void)
{
    himc_skeleton body;
    himc_skeleton_config config = himc_skeleton_default();
    snprintf(take_file, sizeof take_file, "build/tempo-walk-%d.bvh", (int)getpid());
    TEST_ASSERT_TRUE(himc_skeleton_init(&body, &config, &error));
    himc_take *take = beaten_take(&body, 100, 4, &error);
    TEST_ASSERT_TRUE_MESSAGE(take && himc_take_save(take, take_file, &error), error.text);
    himc_take_free(take);
}

// rolls of each kind, ornaments on both sides of them, and plain strokes; or a take
static void begin_piece(himc_performance *p, unsigned *seed)
{
    static const char *const roll[] = {"single", "double", "press"},
                             *const ornament[] = {"flam", "drag", "ruff", "stroke"},
                             *const nuance[] = {"legato", "tenuto", "accent", "vertical-accent",
                                                "staccato"},
                             *const hand[] = {"left", "right"};
    if (choose(seed, 6) == 0) {
        session_do(p, "take %s", take_file);
        session_do(p, "play");
        return;
    }
    session_do(p, "reset");
    session_do(p, "human %g %d", choose(seed, 2) ? 0.0 : chance(seed), choose(seed, 100));
    session_do(p, "loop %d", choose(seed, 2));
    session_do(p, "grip %s", choose(seed, 2) ? "german" : "french");
    session_do(p, "tempo %g", SLOWEST * pow(FASTEST / SLOWEST, chance(seed)));
    for (double beat = 0; beat < 8; beat += 0.5 + 3 * chance(seed))
        if (choose(seed, 2))
            session_try(p, "roll %g %g %s %g %g", beat, 0.1 + 4 * chance(seed),
                        roll[choose(seed, 3)], chance(seed), chance(seed));
        else
            session_try(p, "%s %g %s %s %g", ornament[choose(seed, 4)], beat, hand[choose(seed, 2)],
                        nuance[choose(seed, 5)], chance(seed));
    session_do(p, "play");
}

// half of the time a step, else a jump
static double walk(double bpm, unsigned *seed)
{
    double to = choose(seed, 2) ? bpm * exp(chance(seed) - 0.5)
                                : SLOWEST * pow(FASTEST / SLOWEST, chance(seed));
    return fmin(fmax(to, SLOWEST), FASTEST);
}

// the speed that a planned stroke was to have; infinite for another contact
static double asked_of(himc_performance *p, const himc_strike *strike)
{
    const planner_hand *h = &p->motion->planner->hand[strike->hand];
    for (int i = 0; i < h->planned_count && !p->motion->track; i++)
        if (h->planned[i].goal.time == strike->planned_time)
            return h->planned[i].asked;
    return HUGE_VAL;
}

static void play_on(finite_watch *w, double seconds, int *dropped, heard *h)
{
    himc_event event;
    for (int i = 0; i < seconds * 250; i++) {
        himc_performance_process(w->p, RATE / 250, NULL);
        while (himc_performance_event(w->p, &event)) {
            finite_watch_event(w, &event);
            if (event.kind == HIMC_EVENT_STRIKE &&
                event.strike.velocity > LOUDER * asked_of(w->p, &event.strike) + SWINGING)
                w->bad = "the speed of a stroke";
            *dropped += event.kind == HIMC_EVENT_NOTE && strstr(event.text, "no body");
            if (h)
                heard_event(h, &event);
        }
        finite_watch_played(w, 0.004);
    }
}

// the same stroke by a performer that has done nothing before; session_play counts 48 kHz
static void expect_hit_as_new(himc_performance *p)
{
    himc_performance *fresh = performer(1000), *both[] = {p, fresh};
    heard h[2] = {{0}, {0}};
    session_do(p, "stop");
    session_do(p, "human 0");
    session_play(p, 1, NULL);
    for (int i = 0; i < 2; i++) {
        session_do(both[i], "clear");
        session_do(both[i], "latency auto");
        session_do(both[i], "hit right legato f");
        session_play(both[i], 0.5, &h[i]);
        TEST_ASSERT_TRUE(heard_asked(&h[i]) >= 1);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.06 * h[1].strike[0].velocity, h[1].strike[0].velocity,
                              h[0].strike[0].velocity);
    heard_free(&h[0]);
    heard_free(&h[1]);
    himc_performance_free(fresh);
}

// from a walk: of the roll in the next round one stroke is left, later than those that were counted
static void test_a_roll_stays_within_its_dynamics_when_the_tempo_changes_near_its_end(void)
{
    static const char *const said[] = {"human 0",
                                       "loop 1",
                                       "grip french",
                                       "tempo 347.783",
                                       "stroke 0 left tenuto 0",
                                       "roll 1.01854 0.185575 single 0.739441 0.16212",
                                       "roll 3.70724 1.03575 single 0.251584 0.20377",
                                       "roll 5.92752 3.29916 double 0.799875 0.910187",
                                       "drag 7.00913 right tenuto 0.596348",
                                       "play"};
    static const double tempo[] = {233.284, 446.007, 306.522, 57.4985, 34.2374, 35.272},
                        after[] = {0.04, 0.008, 0.028, 0.08, 0.036, 1};
    int dropped = 0;
    finite_watch w;
    himc_performance *p = performer(1000);
    TEST_ASSERT_TRUE(finite_watch_begin(&w, p));
    for (size_t i = 0; i < sizeof said / sizeof *said; i++)
        session_do(p, "%s", said[i]);
    for (int i = 0; i < 6; i++) {
        session_do(p, "tempo %g", tempo[i]);
        play_on(&w, after[i] - 1e-6, &dropped, NULL);
    }
    TEST_ASSERT_NULL_MESSAGE(w.bad, w.bad);
    TEST_ASSERT_EQUAL_INT(0, dropped);
    finite_watch_end(&w);
    himc_performance_free(p);
}

// from an attacker's hour: what was given up of a roll, ahead of its time, stood for its beginning
static void test_a_roll_to_come_is_not_begun_by_what_was_given_up_of_it(void)
{
    static const char *const said[] = {
        "hit right legato ppp", "play",    "tempo 1000 5.004", "seek 5.6",
        "tempo 469.2",          "tempo 1", "tempo 1000"};
    static const double after[] = {0.1, 0.001, 0, 0.001, 0.124, 0, 0.6};
    int dropped = 0;
    finite_watch w;
    heard h = {0};
    himc_performance *p = performer(10000);
    TEST_ASSERT_TRUE(finite_watch_begin(&w, p));
    session_do(p, "flam 8 right legato mf");
    session_do(p, "roll 14 0.3 press p ppp");
    for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
        session_do(p, "%s", said[i]);
        play_on(&w, after[i], &dropped, &h);
    }
    TEST_ASSERT_NULL_MESSAGE(w.bad, w.bad);
    TEST_ASSERT_TRUE(h.strikes >= 3);
    for (int i = 0; i < h.strikes; i++)
        TEST_ASSERT_TRUE(h.strike[i].velocity < 3.2);
    finite_watch_end(&w);
    heard_free(&h);
    himc_performance_free(p);
}

// from an attacker's hour: the lift over the other hand, broken off by `stop`, was still fading at
// the touch, so that the stick fell on and came 10 ms late with 2.2 m/s
static void test_a_lift_that_is_broken_off_is_over_before_the_touch(void)
{
    heard h = {0};
    himc_performance *p = performer(10000);
    session_do(p, "drag 0.4 right legato ppp");
    session_do(p, "stroke 1 right legato p");
    session_do(p, "tempo 1000");
    session_do(p, "play");
    session_play(p, 0.06 * RATE / 48000, &h); // session_play counts 48 kHz
    session_do(p, "tempo 680.5");
    session_play(p, 0.17 * RATE / 48000, &h);
    session_do(p, "tempo 1");
    session_do(p, "stop");
    session_do(p, "play");
    session_do(p, "tempo 860.6");
    session_play(p, 0.5 * RATE / 48000, &h);
    TEST_ASSERT_TRUE(h.strikes > 0);
    for (int i = 0; i < h.strikes; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.002, h.strike[i].planned_time, h.strike[i].time);
        TEST_ASSERT_TRUE(h.strike[i].velocity < 1.4); // p has 1.3
    }
    heard_free(&h);
    himc_performance_free(p);
}

// from a timpanist's hour: a stick that is up strikes, a little late if it must, and no louder
static void test_a_jump_to_a_faster_tempo_loses_no_stroke(void)
{
    static const double faster[] = {75, 90, 133, 240};
    static const char *const before[] = {"stroke 3 left legato mf", "roll 1 2.9 single mf"};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 2; k++)
            for (double gap = 0.02; gap < (i < 3 ? 0.4 : 0.15); gap += 0.03) {
                heard h = {0};
                himc_performance *p = performer(1000);
                bool found = false;
                session_do(p, "tempo 60");
                session_do(p, "%s", before[k]);
                session_do(p, "stroke 4 right legato mf");
                session_do(p, "stroke 6 left legato mf");
                session_do(p, "play");
                session_play(p, (4 - gap) * RATE / 48000, NULL); // session_play counts 48 kHz
                session_do(p, "tempo %g", faster[i]);
                session_play(p, 3.0 * RATE / 48000, &h);
                for (int j = 0; j < h.strikes; j++)
                    if (h.strike[j].beat == 4) {
                        found = true;
                        TEST_ASSERT_TRUE(h.strike[j].velocity < 3.4);
                        TEST_ASSERT_TRUE(h.strike[j].time < 4.1);
                    }
                TEST_ASSERT_TRUE(found);
                heard_free(&h);
                himc_performance_free(p);
            }
}

static void test_any_walk_of_the_tempo_leaves_all_finite_and_the_performer_plays_on(void)
{
    long changes = from_environment("HIMC_CHANGES", getenv("HIMC_LONG") ? 100000 : 600);
    unsigned seed = (unsigned)from_environment("HIMC_SEED", 1);
    int dropped = 0;
    double bpm = 120;
    char text[128];
    finite_watch w;
    heard h = {0};
    himc_performance *p = performer(1000);
    make_take();
    TEST_ASSERT_TRUE(finite_watch_begin(&w, p));
    for (long i = 0; i < changes && !w.bad; i++) {
        if (i % PIECE == 0)
            begin_piece(p, &seed);
        bpm = walk(bpm, &seed);
        session_do(p, "tempo %g", bpm);
        play_on(&w, 0.004 + 0.2 * chance(&seed) * chance(&seed), &dropped, &h);
        h.strikes = h.strikes < 100000 ? h.strikes : 0;
        snprintf(text, sizeof text, "%s is wrong after change %ld, at %g bpm", w.bad ? w.bad : "",
                 i, bpm);
    }
    printf("%ld changes: %ld rows, %ld packets, %d strikes, %d plans dropped, %ld recoveries\n",
           changes, w.rows, w.packets, h.strikes, dropped, himc_performance_measure(p).recoveries);
    TEST_ASSERT_NULL_MESSAGE(w.bad, text);
    TEST_ASSERT_EQUAL_INT(0, dropped);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    finite_watch_end(&w);
    session_do(p, "reset");
    expect_hit_as_new(p);
    heard_free(&h);
    himc_performance_free(p);
    unlink(take_file);
}

// what a user does with a slider, at the usual rates
static void slide(const char *piece, double from, double to, double wait)
{
    int dropped = 0;
    finite_watch w;
    heard h = {0};
    himc_performance *p = performer(10000);
    TEST_ASSERT_TRUE(finite_watch_begin(&w, p));
    session_do(p, "tempo %g", from);
    session_do(p, "%s", piece);
    session_do(p, "play");
    play_on(&w, wait, &dropped, &h);
    session_do(p, "tempo %g", to);
    play_on(&w, 4, &dropped, &h);
    TEST_ASSERT_NULL_MESSAGE(w.bad, w.bad);
    TEST_ASSERT_EQUAL_INT(0, dropped);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    finite_watch_end(&w);
    expect_hit_as_new(p);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_faster_tempo_under_a_bouncing_roll_leaves_the_performer_alive(void)
{
    slide("roll 0 8 press 0.7", 60, 500, 0.9);
    slide("roll 0 8 press 0.7", 60, 220, 0.9);
    slide("roll 0 8 press 0.7", 120, 400, 0.9);
    slide("roll 0 8 double 0.7", 60, 320, 0.9);
}

// before the first block the body is built at the first target: ODE ended the process
static void test_a_bouncing_roll_without_time_before_the_first_block_ends_no_process(void)
{
    himc_performance *p = performer(10000);
    session_do(p, "roll 0 4 press 1 0 kettle");
    session_do(p, "play");
    session_do(p, "tempo 1000");
    session_do(p, "roll 0.5 1 press 0.5 0 kettle");
    session_drum(p, 0, "place 0.5 0 1.1");
    session_do(p, "play");
    expect_hit_as_new(p);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_faster_tempo_under_a_bouncing_roll_leaves_the_performer_alive);
    RUN_TEST(test_a_bouncing_roll_without_time_before_the_first_block_ends_no_process);
    RUN_TEST(test_a_roll_stays_within_its_dynamics_when_the_tempo_changes_near_its_end);
    RUN_TEST(test_a_roll_to_come_is_not_begun_by_what_was_given_up_of_it);
    RUN_TEST(test_a_lift_that_is_broken_off_is_over_before_the_touch);
    RUN_TEST(test_a_jump_to_a_faster_tempo_loses_no_stroke);
    RUN_TEST(test_any_walk_of_the_tempo_leaves_all_finite_and_the_performer_plays_on);
    return UNITY_END();
}
