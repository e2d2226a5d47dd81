/// test_own_source.c: a source of motion of its own, in one file, plays a drum: a tip that goes up
/// and down as a cosine, and strikes where it falls fastest.
#include "session.h"

#include "performance/performance_motion.h"
#include "performance/performance_state.h"

#define PERIOD 0.5    // (s)
#define AMPLITUDE 0.1 // (m) of the tip's motion: 1.2 m/s at the head, which is half way
#define SPOT 0.6      // x of the strokes in the world (m)

typedef struct wheel {
    double level; ///< of the tip when it touches (m)
    double left;  ///< time of the last separation (s)
    int turns;    ///< separations
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

static const himc_source wheel_source = {target, next, stroke, separated, NULL};

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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_source_in_one_file_plays_a_drum);
    return UNITY_END();
}
