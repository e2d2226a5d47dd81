/// test_strange_takes.c: captures that are not of drummers, played: a person who does not strike,
/// one who walks, and gestures that no arm can follow.
#include "take_players.h"

#include "session.h"

#include "body/stretch.h"

#define SECONDS 3.0 // of the swings

static const char *notes_of(himc_performance *p, char *text, size_t size)
{
    himc_event event;
    text[0] = 0;
    while (himc_performance_event(p, &event))
        if (event.kind == HIMC_EVENT_NOTE)
            snprintf(text + strlen(text), size - strlen(text), "%s\n", event.text);
    return text;
}

static const char *limits = "off", *law = "computed-torque";

static himc_performance_stats play(const char *mode, const char *file, const char *left,
                                   const char *right, double seconds, char *notes, size_t size)
{
    himc_performance *p = session_new();
    himc_take_options options = himc_take_default();
    options.left_tip = left;
    options.right_tip = right;
    himc_performance_take_options(p, &options);
    session_do(p, "mode %s", mode);
    session_do(p, "law %s", law);
    session_do(p, "limits %s", limits);
    session_do(p, "take %s", file);
    notes_of(p, notes, size);
    session_do(p, "play");
    session_play(p, seconds, NULL);
    himc_performance_stats s = himc_performance_measure(p);
    himc_performance_free(p);
    return s;
}

static void test_a_reaching_arm_is_followed_in_every_mode(void)
{
    static const char *const modes[] = {"himc", "id", "ik"};
    char path[512], notes[1024];
    const char *shared = shared_capture("upperlimb_pyomeca_100hz/markers_analogs.c3d");
    if (!shared)
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    snprintf(path, sizeof path, "%s", shared);
    for (int i = 0; i < 3; i++) {
        himc_performance_stats s =
            play(modes[i], path, NULL, "Daphnee:INDEX", 7.5, notes, sizeof notes);
        TEST_ASSERT_TRUE_MESSAGE(1e3 * s.tip_rms < 0.2, modes[i]);
        TEST_ASSERT_EQUAL_INT(0, s.recoveries);
        TEST_ASSERT_EQUAL_INT(0, s.strokes);
        TEST_ASSERT_EQUAL_DOUBLE(0, s.peak_force); // the head is out of the way
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(notes, "out of the take's way"), notes);
        TEST_ASSERT_NULL_MESSAGE(strstr(notes, "out of reach"), notes);
    }
}

static void test_a_person_hopping_through_the_room_is_held_at_the_seat(void)
{
    char path[512], notes[1024];
    const char *shared = shared_capture("cmu131_bvh_120hz/131_03.bvh");
    if (!shared)
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    snprintf(path, sizeof path, "%s", shared);
    himc_performance_stats s =
        play("ik", path, "LFingers_end", "RFingers_end", 11, notes, sizeof notes);
    TEST_ASSERT_TRUE_MESSAGE(s.tip_rms < 0.005, notes); // once 0.6 m, from the hips' first position
    s = play("himc", path, "LFingers_end", "RFingers_end", 11, notes, sizeof notes);
    TEST_ASSERT_TRUE(s.tip_rms < 0.05); // the head stops a hand that goes down
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    s = play("id", path, "LFingers_end", "RFingers_end", 11, notes, sizeof notes);
    TEST_ASSERT_TRUE(s.tip_rms < 0.05); // once unstable: arms bent to hold a stick
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
}

// these hands hold no stick: the limits are those of arms that hold one
static void test_a_take_without_sticks_is_playable_within_its_limits(void)
{
    static const char *const kinds[] = {"ellipsoid", "euler"}, *const modes[] = {"himc", "id"};
    char path[512], notes[1024];
    const char *shared = shared_capture("upperlimb_pyomeca_100hz/markers_analogs.c3d");
    if (!shared)
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    snprintf(path, sizeof path, "%s", shared);
    for (int i = 0; i < 4; i++) {
        limits = kinds[i / 2];
        himc_performance_stats s =
            play(modes[i % 2], path, NULL, "Daphnee:INDEX", 7.5, notes, sizeof notes);
        limits = "off";
        TEST_ASSERT_TRUE_MESSAGE(s.tip_rms < 0.003, notes);
        TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    }
    snprintf(path, sizeof path, "%s", shared_capture("cmu131_bvh_120hz/131_03.bvh"));
    limits = "ellipsoid";
    law = "feedforward";
    himc_performance_stats s =
        play("himc", path, "LFingers_end", "RFingers_end", 4, notes, sizeof notes);
    limits = "off";
    law = "computed-torque";
    printf("with limits: tips within %.0f mm (RMS)\n", 1e3 * s.tip_rms);
    TEST_ASSERT_TRUE_MESSAGE(s.tip_rms < 0.1, notes); // once 246 mm
}

// markers of two tips that swing by so much (m) to each side; y is up
static void write_swings(const char *path, double way)
{
    FILE *file = fopen(path, "w");
    int frames = (int)(100 * SECONDS);
    TEST_ASSERT_NOT_NULL(file);
    fprintf(file,
            "PathFileType\t4\t(X/Y/Z)\t%s\n"
            "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\t"
            "OrigDataStartFrame\tOrigNumFrames\n100\t100\t%d\t2\tm\t100\t1\t%d\n"
            "Frame#\tTime\tLTIP\t\t\tRTIP\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n",
            path, frames, frames);
    for (int i = 0; i < frames; i++) {
        double t = i / 100.0, aside = way * sin(2 * HIMC_PI * t / SECONDS);
        fprintf(file, "%d\t%.2f\t0.5\t1\t%.5f\t0.5\t1\t%.5f\n", i + 1, t, aside - 0.15,
                aside + 0.15);
    }
    fclose(file);
}

typedef struct seen {
    himc_skeleton skeleton;
    double off;    // farthest of a tip from the nearest place to its target in reach (m)
    double beyond; // farthest of a target from that place (m)
} seen;

static void see(void *user, const himc_tick *tick)
{
    seen *s = user;
    if (tick->time < 1.2) // the way in
        return;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_target asked = {.x = tick->target[hand]};
        himc_vec3 near =
            himc_stretch_towards(&asked, tick->body->origin[HIMC_LEFT_UPPER_ARM + hand],
                                 himc_stretch(&s->skeleton, (himc_hand)hand))
                .x;
        s->off = fmax(s->off, himc_vec3_length(himc_vec3_sub(tick->body->tip[hand], near)));
        s->beyond = fmax(s->beyond, himc_vec3_length(himc_vec3_sub(asked.x, near)));
    }
}

static void test_an_arm_is_stretched_towards_targets_out_of_reach(void)
{
    char notes[1024];
    const char *path = "build/swings.trc";
    seen s = {.off = 0};
    himc_performance *p = session_new();
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&s.skeleton, &config, &error));
    write_swings(path, 1.2);
    himc_performance_on_tick(p, see, &s);
    session_do(p, "take %s", path);
    notes_of(p, notes, sizeof notes);
    session_do(p, "play");
    session_play(p, SECONDS + 1.5, NULL);
    printf("targets up to %.2f m out of reach, tips %.1f mm from the nearest place\n", s.beyond,
           1e3 * s.off);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(notes, "tips out of reach in"), notes);
    TEST_ASSERT_TRUE(s.beyond > 0.2);
    TEST_ASSERT_TRUE(s.off < 0.02);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    himc_performance_free(p);
}

static void test_a_take_in_reach_that_strikes_nothing_is_called_silent_alone(void)
{
    char notes[1024];
    write_swings("build/small-swings.trc", 0.1);
    play("himc", "build/small-swings.trc", NULL, NULL, 0.1, notes, sizeof notes);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(notes, "silent: no tip falls onto a head (y up, as usual in TRC files"), notes);
    TEST_ASSERT_NULL_MESSAGE(strstr(notes, "out of reach"), notes);
}

// nothing a person does: said when it happens, once since the start or `reset`
static void test_a_joint_faster_than_a_persons_is_told_once(void)
{
    char notes[1024];
    himc_performance *p = session_new();
    for (int time = 0; time < 2; time++) {
        session_play(p, 0.5, NULL);
        TEST_ASSERT_NULL(strstr(notes_of(p, notes, sizeof notes), "rad/s"));
        for (int again = 0; again < 2; again++) {
            session_do(p, "push right-stick 0 -1000 0 0.05");
            for (int i = 0; i < 40; i++)
                himc_performance_process(p, 480, NULL);
            const char *line = strstr(notes_of(p, notes, sizeof notes), "rad/s, a person's at 160");
            TEST_ASSERT_TRUE_MESSAGE(again ? !line : !!line, notes);
        }
        session_do(p, "reset");
    }
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_reaching_arm_is_followed_in_every_mode);
    RUN_TEST(test_a_person_hopping_through_the_room_is_held_at_the_seat);
    RUN_TEST(test_a_take_without_sticks_is_playable_within_its_limits);
    RUN_TEST(test_an_arm_is_stretched_towards_targets_out_of_reach);
    RUN_TEST(test_a_take_in_reach_that_strikes_nothing_is_called_silent_alone);
    RUN_TEST(test_a_joint_faster_than_a_persons_is_told_once);
    return UNITY_END();
}
