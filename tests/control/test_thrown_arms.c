/// test_thrown_arms.c: an arm that is kept from its target, by joint limits or for want of
/// strength, is not thrown about: control brings no energy that a stroke does not need.
#include "session.h"

#include "performance/performance_state.h"

#define FASTEST \
    40.0 // (m/s) chosen: a stroke fff has 10; it is 9 to 31 here, without bounds 106 to 115
#define BLOCK 480
#define STROKES 16

static const char *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent", "staccato"};
static const char *const spots[] = {"center", "normal", "rim"};

// loud strokes of both hands on three drums from a seed; the fastest tip (m/s)
static double fastest_tip(const char *setting, unsigned number)
{
    unsigned seed = 7919 * number;
    himc_performance *p = session_new();
    double beat = 2, fastest = 0;
    session_do(p, "rate physics 10000");
    session_do(p, "drum kettle");
    session_do(p, "drum tom 23");
    session_do(p, "drum tam 23");
    session_drum(p, 0, "place 0.7 0 0.85");
    for (int drum = 0; drum < 3; drum++)
        session_drum(p, drum, "modes 20"); // to save time
    for (int i = 0; i < STROKES; i++) {
        int hand = i & 1;
        // one after the other: of arguments the compiler may choose the order
        const char *side = hand == HIMC_LEFT ? "tam" : "tom";
        const char *drum = choose(&seed, 2) ? "kettle" : side, *spot = spots[choose(&seed, 3)];
        double loud = 0.5 + 0.5 * chance(&seed);
        session_do(p, "stroke %.3f %s %s %.3f %s %s", beat, himc_hand_name((himc_hand)hand),
                   nuances[choose(&seed, 5)], loud, spot, drum);
        beat += 0.25 + 0.5 * chance(&seed);
    }
    session_do(p, "%s", setting);
    session_do(p, "play");
    for (double t = 0; t < (beat + 1) * 0.6; t += BLOCK / 48000.0) {
        himc_performance_process(p, BLOCK, NULL);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            fastest = fmax(fastest, himc_vec3_length(p->body->state.tip_velocity[hand]));
    }
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    himc_performance_free(p);
    return fastest;
}

static void test_arms_that_their_limits_hold_are_not_thrown_about(void)
{
    double ellipsoid = fastest_tip("limits ellipsoid", 15), euler = fastest_tip("limits euler", 15);
    printf("ellipsoid %.0f m/s, euler %.0f m/s\n", ellipsoid, euler);
    TEST_ASSERT_TRUE(fmax(ellipsoid, euler) < FASTEST);
}

static void test_weak_arms_are_not_thrown_about(void)
{
    double fastest = fastest_tip("strength human", 109);
    printf("weak arms %.0f m/s\n", fastest);
    TEST_ASSERT_TRUE(fastest < FASTEST);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_arms_that_their_limits_hold_are_not_thrown_about);
    RUN_TEST(test_weak_arms_are_not_thrown_about);
    return UNITY_END();
}
