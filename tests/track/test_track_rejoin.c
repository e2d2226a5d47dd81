/// test_track_rejoin.c: the way of a tip around a strike: the time of contact, and the way back to
/// the take near its end, before the next strike and at low rates.
#include "tracks.h"

#define RADIUS 0.0175

typedef double height_at(double t); // of the tip above where it strikes (m)

// a right tip alone, in millimetres with y up
static void make_take(height_at *height, double rate, int frames)
{
    static char text[90000];
    int used = snprintf(text, sizeof text,
                        "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\t"
                        "NumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
                        "%g\t%g\t%d\t1\tmm\t%g\t1\t%d\nFrame#\tTime\tRTIP\t\t\n\t\tX1\tY1\tZ1\n\n",
                        rate, rate, frames, rate, frames);
    for (int i = 0; i < frames; i++)
        used +=
            snprintf(text + used, sizeof text - (size_t)used, "%d\t%.6f\t%.6f\t%.6f\t50\n", i + 1,
                     i / rate, 600 + 20 * sin(4 * i / rate), 1000 + 1000 * height(i / rate));
    take = read_text(text, "a.trc", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    track = himc_track_new(take, NULL, &place, NULL, RADIUS, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
}

static double beaten(double t)
{
    return beaten_height(t, 4).x.z;
}

static himc_target at(double t)
{
    return himc_track_target(track, HIMC_RIGHT, t);
}

static double contact_after(double t)
{
    double time, x, y;
    TEST_ASSERT_TRUE(himc_track_current(track, HIMC_RIGHT, t, &time, &x, &y));
    return time;
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

// v t + a t^2 / 3, with an acceleration that fades to zero, ends on the head
static void test_the_approach_ends_on_the_head_without_acceleration(void)
{
    make_take(beaten, 250, 1000);
    for (int k = 1; k <= 8; k++) {
        double time = contact_after(0.5 * k - 0.3);
        himc_target s = at(time - 1e-12);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, LEVEL + RADIUS, s.x.z);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, himc_vec3_length(s.a));
        TEST_ASSERT_TRUE(s.v.z < -3.9);
    }
}

static himc_target as_measured(double t)
{
    himc_target s = at(t);
    s.x.z += 0.002;
    s.v = himc_vec3_make(0.1, -0.05, 3.2);
    s.a = himc_vec3_make(1, 2, -30);
    return s;
}

static void goes_on_from(const himc_target *s, double t)
{
    himc_target now = at(t);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(s->x, now.x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(s->v, now.v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, distance(s->a, now.a));
}

// the last strike is at 0.4 s; the take's time slows down from 0.37 s to its end at 0.424 s
static void test_near_the_end_rejoining_begins_in_the_measured_state_as_time_slows_down(void)
{
    make_take(beaten, 250, 107);
    double time = contact_after(0.2);
    himc_target s = as_measured(time + 0.008);
    himc_track_source.separated(track, HIMC_RIGHT, time + 0.008, &s);
    goes_on_from(&s, time + 0.008);
}

// a stick pushed 0.4 m upwards, and one thrown at 40 m/s
static void test_from_far_off_rejoining_is_slow_and_no_throw_is_followed(void)
{
    make_take(beaten, 250, 250);
    double time = contact_after(0.2) + 0.008, hardest = 0, fastest = 0;
    himc_target s = as_measured(time), off = s, thrown = s;
    off.x.z += 0.4;
    himc_track_source.separated(track, HIMC_RIGHT, time, &off);
    for (double t = time; t < time + 0.09; t += 0.0005)
        hardest = fmax(hardest, himc_vec3_length(at(t).a));
    himc_track_rewind(track, 0);
    thrown.v = himc_vec3_make(-40, 0, 0);
    himc_track_source.separated(track, HIMC_RIGHT, time, &thrown);
    for (double t = time; t < time + 0.02; t += 0.0005)
        fastest = fmax(fastest, himc_vec3_length(at(t).v));
    printf("at most %.0f m/s^2, %.1f m/s\n", hardest, fastest);
    TEST_ASSERT_TRUE(hardest < 1500 && fastest < 13);
}

// strikes every 60 ms, from 4 cm: after a separation the next strike is near
static double rolled(double t)
{
    double since = fmod(t, 0.06), v = 2.5;
    return v * since - v / 0.06 * since * since;
}

// a stick that leaves late has less than 20 ms before the next strike's fall begins: over steps of
// 10 us position agrees with velocity and acceleration
static void test_rejoining_ends_before_the_next_strike_begins(void)
{
    double h = 1e-5;
    make_take(rolled, 1000, 1000);
    double time = contact_after(0.2);
    for (double late = 0.0065; late < 0.032; late += 0.006) {
        himc_track_rewind(track, 0);
        himc_target s = as_measured(time + late);
        himc_track_source.separated(track, HIMC_RIGHT, time + late, &s);
        goes_on_from(&s, time + late);
        double next = contact_after(time + late);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, time + 0.06, next);
        for (double t = time + late; t + h < next; t += h) {
            himc_target a = at(t), b = at(t + h);
            himc_vec3 v = himc_vec3_madd(a.v, h, a.a);
            himc_vec3 x = himc_vec3_madd(a.x, 0.5 * h, himc_vec3_add(a.v, v));
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(x, b.x));
        }
    }
}

// every third blow is 50 mm deeper than the head
static double uneven(double t)
{
    return beaten(t) - ((int)floor((t + 0.35) / 0.5) % 3 == 2 ? 0.05 : 0);
}

static void test_rejoining_does_not_go_below_the_head_for_a_capture_that_is_there(void)
{
    make_take(uneven, 250, 1000);
    double time = contact_after(0.7);
    TEST_ASSERT_TRUE(himc_track_target(track, HIMC_RIGHT, time + 0.022).x.z < LEVEL + RADIUS);
    himc_target s = as_measured(time + 0.008);
    s.x.z = LEVEL + RADIUS;
    himc_track_source.separated(track, HIMC_RIGHT, time + 0.008, &s);
    for (double t = time + 0.008; t < time + 0.2; t += 1e-3)
        TEST_ASSERT_TRUE(at(t).x.z > LEVEL + RADIUS - 1e-3);
}

// with too little time for a way back nothing changes
static void test_a_stick_that_leaves_too_late_changes_nothing(void)
{
    make_take(rolled, 1000, 1000);
    double time = contact_after(0.2);
    for (double late = 0.035; late < 0.040; late += 0.001) {
        himc_vec3 before[20];
        himc_track_rewind(track, 0);
        himc_target s = as_measured(time + late);
        for (int i = 0; i < 20; i++)
            before[i] = at(time + late + 1e-3 * i).x;
        himc_track_source.separated(track, HIMC_RIGHT, time + late, &s);
        for (int i = 0; i < 20; i++)
            TEST_ASSERT_EQUAL_DOUBLE(before[i].z, at(time + late + 1e-3 * i).x.z);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, time + 0.06, contact_after(time + late));
    }
}

static double beaten_softly(double t)
{
    return beaten_height(t, 2).x.z;
}

// frames are 40 ms apart: nothing is known between the last before a strike and the first after it
static void test_at_25_hz_a_tick_never_moves_a_tip_faster_than_12_metres_per_second(void)
{
    for (int speed = 2; speed <= 4; speed += 2) {
        make_take(speed == 2 ? beaten_softly : beaten, 25, 100);
        double tick = 0.004, struck = 0;
        himc_vec3 last = at(0).x;
        TEST_ASSERT_TRUE(himc_track_strikes(track, HIMC_RIGHT) > 4);
        for (double t = tick; t < 3.8; t += tick) {
            double contact, x, y;
            if (himc_track_current(track, HIMC_RIGHT, t, &contact, &x, &y) &&
                t > contact + 0.0065 && contact > struck) {
                himc_target measured = {.x = at(t).x, .v = {0, 0, 2}};
                himc_track_source.separated(track, HIMC_RIGHT, t, &measured);
                struck = contact;
            }
            himc_vec3 now = at(t).x;
            TEST_ASSERT_TRUE(distance(now, last) < 12 * tick);
            last = now;
        }
        TEST_ASSERT_TRUE(struck > 3);
        tearDown();
        setUp();
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_approach_ends_on_the_head_without_acceleration);
    RUN_TEST(test_near_the_end_rejoining_begins_in_the_measured_state_as_time_slows_down);
    RUN_TEST(test_rejoining_ends_before_the_next_strike_begins);
    RUN_TEST(test_rejoining_does_not_go_below_the_head_for_a_capture_that_is_there);
    RUN_TEST(test_a_stick_that_leaves_too_late_changes_nothing);
    RUN_TEST(test_from_far_off_rejoining_is_slow_and_no_throw_is_followed);
    RUN_TEST(test_at_25_hz_a_tick_never_moves_a_tip_faster_than_12_metres_per_second);
    return UNITY_END();
}
