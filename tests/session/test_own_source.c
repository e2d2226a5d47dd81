/// test_own_source.c: a source of motion of its own, in one file, plays a drum: a tip that goes up
/// and down as a cosine, and strikes where it falls fastest.
#include "session.h"

#include "performance/performance_motion.h"
#include "performance/performance_state.h"

#define PERIOD 0.5    // (s)
#define AMPLITUDE 0.1 // (m) of the tip's motion: 1.2 m/s at the head, which is half way
#define TURNS 6       // of a piece
#define SPOT 0.6      // x of the strokes in the world (m)

typedef struct wheel {
    double level;          ///< of the tip when it touches (m)
    double left;           ///< time of the last separation (s)
    int turns;             ///< separations
    double began, stopped; ///< by the transport (s)
    himc_vec3 from;        ///< of the left tip as it began
} wheel;

// the tip passes the head downwards a quarter of a turn after its highest point
static himc_target target(const void *source, himc_hand hand, double t)
{
    const wheel *w = source;
    double omega = 2 * HIMC_PI / PERIOD, side = hand == HIMC_LEFT ? 0.1 : -0.1;
    double z = AMPLITUDE * cos(omega * t);
    himc_target now = {.x = {SPOT, side, w->level + fmax(z, -0.002)}};
    if (z > -0.002) {
        now.v.z = -omega * AMPLITUDE * sin(omega * t);
        now.a.z = -omega * omega * z;
    }
    return now;
}

static himc_source_contact next(const void *source, himc_hand hand, double t)
{
    (void)source;
    (void)hand;
    return (himc_source_contact){true, (floor(t / PERIOD) + 0.25) * PERIOD, 0};
}

static himc_source_stroke stroke(const void *source, himc_hand hand, double t)
{
    himc_source_contact c = next(source, hand, t);
    return (himc_source_stroke){
        .any = c.any, .time = c.time, .x = 0, .y = 0, .beat = NAN, .speed = NAN, .nuance = "none"};
}

static void separated(void *source, himc_hand hand, double t, const himc_target *measured)
{
    wheel *w = source;
    (void)hand;
    (void)measured;
    w->left = t;
    w->turns++;
}

static void play(void *source, double t, const himc_target *tip, const himc_posture_motion *joints)
{
    wheel *w = source;
    (void)joints;
    w->began = t;
    w->from = tip[HIMC_LEFT].x;
}

static void stop(void *source, double t, const himc_target *tip)
{
    wheel *w = source;
    (void)tip;
    w->stopped = t;
}

static double beat(const void *source, double t)
{
    const wheel *w = source;
    return (t - w->began) / PERIOD;
}

static double end(const void *source)
{
    const wheel *w = source;
    return w->began + TURNS * PERIOD;
}

static const himc_source wheel_source = {target, next, stroke, separated, NULL,
                                         play,   stop, beat,   end};

static void test_a_source_in_one_file_plays_a_drum(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle");
    session_drum(p, 0, "place 0.6 0 0.85");
    session_play(p, 0.5, &h); // the drum is where it is put
    wheel w = {.level = 0.85 + p->body->skeleton.mallet_radius};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        p->motion->source[hand] = (hand_source){&wheel_source, &w};
    session_play(p, 5, &h);
    TEST_ASSERT_INT_WITHIN(2, 2 * 5 / PERIOD, h.strikes);
    TEST_ASSERT_INT_WITHIN(2, h.strikes, w.turns);
    for (int i = 0; i < h.strikes; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.005, PERIOD / 4, fmod(h.strike[i].time, PERIOD));
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 2 * HIMC_PI / PERIOD * AMPLITUDE, h.strike[i].velocity);
    }
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_source_is_played_to_its_end_and_stopped(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle");
    session_do(p, "stroke 1 right legato f");
    session_play(p, 0.5, &h);
    wheel w = {.level = 2};
    p->motion->piece = (hand_source){&wheel_source, &w};
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_send(p, "play", &error), error.text);
    session_play(p, (TURNS - 1) * PERIOD, &h);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5, w.began);
    TEST_ASSERT_TRUE(himc_vec3_length(w.from) > 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, TURNS - 1,
                              himc_motion_score_beat(p->motion, himc_clock_time(&p->clock)));
    TEST_ASSERT_FALSE(p->motion->over);
    session_play(p, 1.1 * PERIOD, &h);
    TEST_ASSERT_TRUE(p->motion->over);
    session_do(p, "stop");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5 + (TURNS + 0.1) * PERIOD, w.stopped);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_source_in_one_file_plays_a_drum);
    RUN_TEST(test_a_source_is_played_to_its_end_and_stopped);
    return UNITY_END();
}
