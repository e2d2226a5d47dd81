/// test_ears.c: two ears hear a drum: late by the way, weaker by it, from its side, over a floor.
#include "drum/drum_state.h"
#include "drum/ears.h"
#include "himc/himc.h"
#include "himc/loader.h"
#include "one_drum.h"

#include <complex.h>
#include <stdlib.h>
#include <string.h>

#define C 344.0  // (m/s)
#define H 0.0875 // radius of a head (m)
#define PLENTY 4800
#define SOFT 0.01 // of full scale: what is louder is bent

static himc_ears ears;
static const himc_head_frame place = {.center = {0, 0, 0.85}, .radius = 0.33};

static himc_listener facing(double x, double y, double z)
{
    return himc_listener_at(himc_vec3_make(x, y, z));
}

// response of an ear to a sine of `hz` in the rays of the ears times `direct`, of the floor `floor`
static double complex response(const himc_ear_paths *paths, int ear, double hz, double direct,
                               double floor)
{
    static double row[HIMC_RAYS][PLENTY], out[HIMC_EARS][PLENTY];
    double *rays[] = {row[0], row[1], row[2]}, *rows[] = {out[0], out[1]}, w = 2 * HIMC_PI * hz;
    double complex sum = 0;
    memset(&ears, 0, sizeof ears);
    memset(out, 0, sizeof out);
    himc_ears_set(&ears, paths, &(himc_walls){0}, RATE);
    for (int i = 0; i < PLENTY; i++) {
        row[0][i] = row[1][i] = SOFT * direct * cos(w * i / RATE);
        row[2][i] = SOFT * floor * cos(w * i / RATE);
    }
    himc_ears_hear(&ears, PLENTY, rays, rows, 1);
    for (int i = PLENTY / 2; i < PLENTY; i++) // whole periods of multiples of 20 Hz
        sum += out[ear][i] * cexp(-I * w * i / RATE);
    return sum / (SOFT * PLENTY / 4);
}

// Brown and Duda's shadow for a source at `angle` from the ear's axis
static double complex shadow(double angle, double hz)
{
    double x = 2 * HIMC_PI * hz * H / C / 2, a = 1.05 + 0.95 * cos(1.2 * angle);
    return (1 + I * a * x) / (1 + I * x);
}

static void test_ears_hear_a_drum_r_by_c_later_to_a_hundredth_of_a_sample(void)
{
    for (double distance = 0.5; distance < 12; distance *= 1.7) {
        himc_listener l = facing(distance, 0, place.center.z);
        himc_ear_paths paths = himc_ears_trace(&l, &place);
        for (int ear = 0; ear < HIMC_EARS; ear++)
            for (double hz = 100; hz <= 1600; hz *= 2) {
                double complex h = response(&paths, ear, hz, 1, 0) / shadow(HIMC_PI / 2, hz);
                double periods = distance / C * hz, late = -carg(h) / (2 * HIMC_PI);
                double samples = remainder(late - periods, 1) / hz * RATE;
                TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, samples);
            }
    }
}

static void test_ears_hear_a_drum_weaker_with_its_distance(void)
{
    for (double distance = 0.5; distance < 12; distance *= 1.7) {
        himc_listener l = facing(distance, 0, place.center.z);
        himc_ear_paths paths = himc_ears_trace(&l, &place);
        double complex h = response(&paths, 0, 200, 1, 0) / shadow(HIMC_PI / 2, 200);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, HIMC_EARS_LEVEL, cabs(h) * distance);
    }
}

// the sound of a drum to the left is first, and brightest, in the left ear
static void test_ears_are_at_most_0_66_ms_apart(void)
{
    double most = 0;
    for (int degrees = -180; degrees <= 180; degrees += 5) {
        himc_listener l = facing(3, 0, place.center.z);
        l.yaw = HIMC_PI - degrees * HIMC_PI / 180; // the drum is so far to the left
        himc_ear_paths p = himc_ears_trace(&l, &place);
        double lead = p.direct[HIMC_EAR_RIGHT].delay - p.direct[HIMC_EAR_LEFT].delay;
        double side = sin(degrees * HIMC_PI / 180), angle = fabs(asin(side));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, copysign(H / C * (angle + sin(angle)), side), lead);
        double brighter = p.direct[HIMC_EAR_LEFT].shelf - p.direct[HIMC_EAR_RIGHT].shelf;
        TEST_ASSERT_TRUE(fabs(side) < 0.1 || side * brighter > 0);
        most = fmax(most, fabs(lead));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01e-3, 0.66e-3, most);
}

static void test_ears_hear_the_shadow_of_the_head(void)
{
    himc_listener l = facing(3, 0, place.center.z);
    l.yaw = HIMC_PI / 2; // the drum is to the left
    himc_ear_paths paths = himc_ears_trace(&l, &place);
    double complex near = response(&paths, HIMC_EAR_LEFT, 4000, 1, 0);
    double complex far = response(&paths, HIMC_EAR_RIGHT, 4000, 1, 0);
    double expected =
        cabs(shadow(0, 4000) / shadow(HIMC_PI, 4000)) * (3 + H * HIMC_PI / 2) / (3 - H);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * expected, expected, cabs(near / far));
}

static void same_path(const himc_ear_path *a, const himc_ear_path *b)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, a->delay, b->delay);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, a->gain, b->gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, a->shelf, b->shelf);
}

static void test_ears_exchange_sides_when_all_is_mirrored(void)
{
    himc_listener left = facing(2, 1.3, 1.4), right = facing(2, -1.3, 1.4);
    himc_head_frame one = {.center = {0.8, 0.3, 0.85}}, other = {.center = {0.8, -0.3, 0.85}};
    himc_ear_paths a = himc_ears_trace(&left, &one), b = himc_ears_trace(&right, &other);
    for (int ear = 0; ear < HIMC_EARS; ear++) {
        same_path(&a.direct[ear], &b.direct[1 - ear]);
        same_path(&a.floor[ear], &b.floor[1 - ear]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, a.ray[ear].azimuth, -b.ray[1 - ear].azimuth);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, a.ray[ear].elevation, b.ray[1 - ear].elevation);
    }
}

static void test_ears_see_a_tilted_head_as_it_lies(void)
{
    himc_head_frame tilted = {.center = {0.8, 0, 0.85}, .tilt = 0.2}; // towards the performer
    himc_listener l = facing(3.8, 0, 3.85);
    himc_ear_paths p = himc_ears_trace(&l, &tilted);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, HIMC_PI / 4 - 0.2, p.ray[HIMC_RAY_LEFT].elevation);
    l = facing(0.8, 2, 0.85);
    p = himc_ears_trace(&l, &tilted);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, HIMC_PI / 2, p.ray[HIMC_RAY_LEFT].azimuth);
}

// where the sum of the direct sound and the floor's is weakest between two frequencies
static double dip(const himc_ear_paths *paths, double from, double to)
{
    double least = INFINITY, at = 0;
    for (double hz = from; hz <= to; hz += 1) {
        double now = cabs(response(paths, 0, hz, 1, 1));
        at = now < least ? hz : at;
        least = fmin(now, least);
    }
    return at;
}

static void test_ears_hear_the_dips_of_the_floor_at_281_and_842_hz(void)
{
    himc_listener l = facing(3, 0, 1.2);
    himc_ear_paths paths = himc_ears_trace(&l, &place);
    TEST_ASSERT_DOUBLE_WITHIN(3, 281, dip(&paths, 250, 310));
    TEST_ASSERT_DOUBLE_WITHIN(6, 842, dip(&paths, 810, 870));
}

static void listens(himc_drum *to, const himc_listener *listener)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_open_ears(to, &error), error.text);
    himc_drum_listen(to, listener);
}

static void test_a_drum_that_nobody_listens_to_has_no_ears_and_takes_less_than_2_5_megabytes(void)
{
    TEST_ASSERT_NULL(drum->ears);
    TEST_ASSERT_LESS_THAN(2500000, sizeof *drum);
}

// the drum, struck, in blocks, with a listener who comes, moves and leaves; two channels
static void listened(int block, double *left, double *right)
{
    const himc_listener off = {.on = false};
    says("pickups 2");
    himc_drum_strike_at(drum, 100, -0.2, 0, 3, &error);
    himc_drum_strike_at(drum, 6000, -0.1, 0.1, 2, &error);
    for (int i = 0; i < LENGTH;) {
        himc_listener first = facing(2, 1, 1.5), second = facing(-1, 2, 1.7);
        int stop = i < 1200 ? 1200 : i < 4000 ? 4000 : i < 4100 ? 4100 : i < 8000 ? 8000 : LENGTH;
        int n = stop - i < block ? stop - i : block;
        if (i == 1200 || i == 4100)
            listens(drum, &first);
        if (i == 4000)
            listens(drum, &second);
        if (i == 8000)
            listens(drum, &off);
        advance(n);
        himc_drum_read_channel(drum, 0, himc_drum_time(drum) - (uint64_t)n, n, left + i);
        himc_drum_read_channel(drum, 1, himc_drum_time(drum) - (uint64_t)n, n, right + i);
        i += n;
    }
}

static void test_ears_hear_the_same_in_blocks_of_any_size(void)
{
    static double left[LENGTH], right[LENGTH], again[HIMC_EARS][LENGTH];
    static const int blocks[] = {1, 7, 64, 1000};
    listened(333, left, right);
    TEST_ASSERT_TRUE(peak(left, LENGTH) > 0.01);
    for (int b = 0; b < 4; b++) {
        tearDown();
        setUp();
        listened(blocks[b], again[0], again[1]);
        TEST_ASSERT_EQUAL_MEMORY(left, again[0], sizeof left);
        TEST_ASSERT_EQUAL_MEMORY(right, again[1], sizeof right);
    }
}

// who goes away hears after a while what he would if he had always been there, and, back again,
// what he heard before
static void test_ears_that_have_moved_hear_as_if_they_had_always_been_there(void)
{
    enum { STAY = PLENTY / 4 };
    static double row[HIMC_RAYS][PLENTY], out[3][HIMC_EARS][PLENTY];
    const himc_listener near = facing(1, 0, 1), far = facing(14, 0, 1);
    const himc_ear_paths paths[] = {himc_ears_trace(&near, &place), himc_ears_trace(&far, &place)};
    for (int k = 0; k < HIMC_RAYS; k++)
        for (int i = 0; i < PLENTY; i++)
            row[k][i] = 0.01 * sin(0.3 * i * (1 + 1e-4 * i) + k);
    for (int who = 0; who < 3; who++) { // the last one goes from near to far and back
        memset(&ears, 0, sizeof ears);
        for (int part = 0; part < 4; part++) {
            const himc_ear_paths *at = &paths[who < 2 ? who : part == 1 || part == 2];
            double *rays[HIMC_RAYS], *rows[HIMC_EARS];
            for (int k = 0; k < HIMC_RAYS; k++)
                rays[k] = row[k] + part * STAY;
            for (int k = 0; k < HIMC_EARS; k++)
                rows[k] = out[who][k] + part * STAY;
            if (part == 0 || who == 2)
                himc_ears_set(&ears, at, &(himc_walls){0}, RATE);
            himc_ears_hear(&ears, STAY, rays, rows, 1);
        }
    }
    for (int k = 0; k < HIMC_EARS; k++)
        for (int i = 0; i < STAY / 4; i++) {
            int far_end = 3 * STAY - 1 - i, near_end = PLENTY - 1 - i;
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, out[1][k][far_end], out[2][k][far_end]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, out[0][k][near_end], out[2][k][near_end]);
        }
}

// largest second difference of `x`
static double curvature(const double *x, int n)
{
    double most = 0;
    for (int i = 2; i < n; i++)
        most = fmax(most, fabs(x[i] - 2 * x[i - 1] + x[i - 2]));
    return most;
}

// two channels of the coming `n` samples
static double bent(int n)
{
    static double next[LENGTH];
    double most = 0;
    advance(n);
    for (int k = 0; k < HIMC_EARS; k++) {
        himc_drum_read_channel(drum, k, himc_drum_time(drum) - (uint64_t)n - 2, n + 2, next);
        most = fmax(most, curvature(next, n + 2));
    }
    return most;
}

static void test_ears_do_not_click_when_they_come_move_and_leave(void)
{
    const himc_listener to[] = {facing(2, 1, 1.5),   facing(-1, 2, 1.7), facing(5, -6, 0.3),
                                facing(1, 0.5, 1.0), {.on = false},      facing(0, 0, 1.5)};
    says("pickups 2");
    says("noise 0"); // bends more than a click
    himc_drum_strike_at(drum, 0, -0.2, 0, 3, &error);
    advance(9600);
    double before = 0.6 * HIMC_EARS_LEVEL * bent(1200); // of the pickups, at 1 m
    for (int i = 0; i < 6; i++) {
        listens(drum, &to[i]);
        double now = bent(1200);
        TEST_ASSERT_TRUE(now > 0);
        TEST_ASSERT_TRUE_MESSAGE(now < 3 * before, "a click");
    }
    for (int i = 0; i < 200; i++) { // on the move all the time
        himc_listener l = facing(3 * cos(0.1 * i), 3 * sin(0.1 * i), 1.2);
        listens(drum, &l);
        TEST_ASSERT_TRUE_MESSAGE(bent(48) < 3 * before, "a click on the move");
    }
}

static void test_pickups_sound_as_if_nobody_had_listened_once_ears_have_left(void)
{
    double *with = sound, *without = seen;
    for (int k = 0; k < 2; k++) {
        himc_listener l = facing(2, 1, 1.5);
        tearDown();
        setUp();
        himc_drum_strike_at(drum, 0, -0.2, 0, 3, &error);
        advance(2000);
        if (k == 0)
            listens(drum, &l);
        advance(2000);
        l.on = false;
        listens(drum, &l);
        advance(1000);
        advance(LENGTH);
        himc_drum_read(drum, himc_drum_time(drum) - LENGTH, LENGTH, k == 0 ? with : without, NULL);
    }
    TEST_ASSERT_EQUAL_MEMORY(without, with, sizeof sound);
}

static void test_ears_find_a_drum_that_was_moved(void)
{
    himc_listener l = facing(2, 1, 1.5);
    listens(drum, &l);
    says("place 0.2 -0.8 0.9 0.1");
    himc_ear_paths p = himc_ears_trace(&l, himc_drum_head_frame(drum));
    TEST_ASSERT_EQUAL_MEMORY(p.ray, himc_membrane_config_of(drum->membrane)->pickups + HIMC_PICKUPS,
                             sizeof p.ray);
    TEST_ASSERT_EQUAL_INT((int)floor(p.direct[0].delay * RATE), drum->ears->next.direct[0].whole);
}

// the sound of an outside force on a second drum that hears as the first is that on the first
static void test_a_drum_hears_as_another(void)
{
    static double here[LENGTH], there[LENGTH], force[LENGTH], where[LENGTH];
    himc_listener l = facing(2, 1, 1.5);
    himc_drum *other = himc_drum_new("layer", 26, RATE, &error);
    for (int i = 0; i < 200; i++)
        force[i] = 20 * sin(HIMC_PI * i / 200);
    says("place 0.2 -0.8 0.9");
    listens(drum, &l);
    TEST_ASSERT_TRUE(himc_drum_follow(other, drum, &error));
    himc_drum_advance(drum, LENGTH, force, where, where);
    himc_drum_advance(other, LENGTH, force, where, where);
    for (int ear = 0; ear < HIMC_EARS; ear++) {
        himc_drum_read_channel(drum, ear, 0, LENGTH, here);
        himc_drum_read_channel(other, ear, 0, LENGTH, there);
        TEST_ASSERT_TRUE(peak(here, LENGTH) > 0);
        TEST_ASSERT_EQUAL_MEMORY(here, there, sizeof here);
    }
    himc_drum_release(other);
}

// the performer's command

static himc_performance *performance;

static bool tell(const char *text)
{
    himc_command c;
    return himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) &&
           himc_performance_command(performance, &c, 0, &error);
}

static void refused(const char *text, const char *why)
{
    TEST_ASSERT_FALSE_MESSAGE(tell(text), text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, why), error.text);
    TEST_ASSERT_NULL(strchr(error.text, '\n'));
}

static void perform(void)
{
    himc_performance_config config = himc_performance_default();
    performance = himc_performance_new(&config, &error);
    TEST_ASSERT_TRUE(himc_performance_add_drum(performance, drum, &error));
}

static void test_listener_refuses_what_is_no_place(void)
{
    perform();
    refused("listener 16 0 1.2", "listener: X: 16, expected -15 .. 15 m");
    refused("listener 0 -15.1 1.2", "listener: Y: -15.1, expected -15 .. 15 m");
    refused("listener 0 0 -1", "listener: Z: -1, expected 0 .. 3 m");
    refused("listener 0 0 1 7", "listener: YAW: 7, expected -6.2832 .. 6.2832 rad");
    refused("listener 0 0 nan", "listener");
    refused("listener on", "listener");
    TEST_ASSERT_FALSE(drum->listener.on);
    himc_performance_free(performance);
}

static void hears(const himc_drum *d, double x, double yaw)
{
    TEST_ASSERT_TRUE(d->listener.on);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, x, d->listener.place.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, remainder(yaw - d->listener.yaw, 2 * HIMC_PI));
}

static void test_listener_hears_all_drums_of_a_performance_until_reset(void)
{
    himc_drum *later = himc_drum_new("later", 26, RATE, &error);
    perform();
    TEST_ASSERT_TRUE(tell("listener 3 0 1.2"));
    TEST_ASSERT_TRUE(himc_performance_add_drum(performance, later, &error));
    hears(drum, 3, HIMC_PI);
    hears(later, 3, HIMC_PI);
    TEST_ASSERT_TRUE(tell("listener 2 1 1.2 0.5"));
    hears(later, 2, 0.5);
    TEST_ASSERT_TRUE(tell("reset"));
    TEST_ASSERT_FALSE(drum->listener.on);
    TEST_ASSERT_FALSE(later->listener.on);
    TEST_ASSERT_TRUE(tell("listener 2 1 1.2"));
    himc_performance_free(performance);
    TEST_ASSERT_FALSE(later->listener.on);
    himc_drum_release(later);
}

// a head of many modes turns its rays in the helper thread, to the same rays
static void test_listener_is_loaded_to_the_same_result(void)
{
    himc_command c;
    himc_load_target target;
    himc_loader *loader = himc_loader_new(&error);
    says("modes 600");
    perform();
    target = (himc_load_target){.performance = performance};
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_PERFORMER, "listener 2 1 1.2", &error));
    TEST_ASSERT_TRUE(himc_loader_command(loader, &target, &c, &error));
    TEST_ASSERT_TRUE(himc_loader_busy(loader));
    himc_loader_finish(loader);
    hears(drum, 2, atan2(-1, -2));
    himc_ear_paths p = himc_ears_trace(&drum->listener, himc_drum_head_frame(drum));
    TEST_ASSERT_EQUAL_MEMORY(p.ray, himc_membrane_config_of(drum->membrane)->pickups + HIMC_PICKUPS,
                             sizeof p.ray);
    himc_loader_free(loader);
    himc_performance_free(performance);
}

// two poles below or above `hz`, in place
static void filter(double *x, int n, double hz, bool above)
{
    double w = tan(HIMC_PI * hz / RATE), norm = 1 / (1 + sqrt(2) * w + w * w);
    double a1 = 2 * (w * w - 1) * norm, a2 = (1 - sqrt(2) * w + w * w) * norm;
    double gain = (above ? 1 : w * w) * norm, middle = above ? -2 : 2;
    double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
    for (int i = 0; i < n; i++) {
        double y = gain * (x[i] + middle * x1 + x2) - a1 * y1 - a2 * y2;
        x2 = x1, x1 = x[i], y2 = y1, y1 = x[i] = y;
    }
}

// correlation of what both ears of a drum have heard in its last n samples, below or above `hz`
static double correlation(const himc_drum *d, int n, double hz, bool above)
{
    static double x[HIMC_EARS][HIMC_DRUM_RING];
    double sum[3] = {0};
    for (int ear = 0; ear < HIMC_EARS; ear++) {
        himc_drum_read_channel(d, ear, himc_drum_time(d) - (uint64_t)n, n, x[ear]);
        for (int k = 0; k < 3; k++)
            filter(x[ear], n, hz, above);
    }
    for (int i = 0; i < n; i++) {
        sum[0] += x[0][i] * x[1][i];
        sum[1] += x[0][i] * x[0][i];
        sum[2] += x[1][i] * x[1][i];
    }
    return sum[0] / sqrt(sum[1] * sum[2]);
}

// the loudest difference of both sides after a strike, in a drum that is silent again
static double apart(himc_drum *d)
{
    static double side[HIMC_EARS][4800];
    double most = 0;
    himc_drum_advance(d, HIMC_DRUM_RING, NULL, NULL, NULL);
    himc_drum_strike_at(d, 0, -0.2, 0.05, 1, &error);
    himc_drum_advance(d, 4800, NULL, NULL, NULL);
    for (int ear = 0; ear < HIMC_EARS; ear++)
        himc_drum_read_channel(d, ear, himc_drum_time(d) - 4800, 4800, side[ear]);
    for (int i = 0; i < 4800; i++)
        most = fmax(most, fabs(side[0][i] - side[1][i]));
    return most;
}

static void test_a_drum_alone_is_heard_by_two_ears_until_a_pickup_is_asked_for(void)
{
    static const char *const dry[] = {"pickup air 0 0.5 1", "channel 1 0.1 0", "listener off"};
    TEST_ASSERT_EQUAL_DOUBLE(0, apart(drum)); // a single pickup is heard on both sides
    TEST_ASSERT_TRUE(himc_drum_set_usual_listener(drum, &error));
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_TRUE(apart(drum) > 1e-4);
        says(dry[i]);
        TEST_ASSERT_EQUAL_DOUBLE(0, apart(drum));
        says("listener usual");
    }
    listens(drum, &(himc_listener){.on = false}); // of a performer, who leaves the drum again
    TEST_ASSERT_EQUAL_DOUBLE(0, apart(drum));
    himc_drum_listen(drum, NULL);
    TEST_ASSERT_TRUE(apart(drum) > 1e-4);
}

// three strokes in the pickups behind the first two, with ears that come, leave and come back
static void hear_behind(bool heard, double out[2][3 * LENGTH])
{
    static const char *const listener[] = {"usual", "off", "usual"};
    tearDown();
    setUp();
    TEST_ASSERT_TRUE(!heard || himc_drum_set_usual_listener(drum, &error));
    says("pickups 4");
    says("channel 3 0.1 0.05");
    for (int i = 0; i < 3; i++) {
        char text[40];
        snprintf(text, sizeof text, "listener %s", heard ? listener[i] : "off");
        says(text);
        TEST_ASSERT_EQUAL(heard && i != 1, himc_drum_is_heard(drum));
        himc_drum_strike_at(drum, 0, -0.2, 0.05, 1, &error);
        advance(LENGTH);
        for (int k = 0; k < 2; k++)
            himc_drum_read_channel(drum, 2 + k, (uint64_t)i * LENGTH, LENGTH, out[k] + i * LENGTH);
    }
}

static void test_ears_leave_the_pickups_behind_the_first_two_as_they_are(void)
{
    static double heard[2][3 * LENGTH], dry[2][3 * LENGTH];
    hear_behind(true, heard);
    hear_behind(false, dry);
    TEST_ASSERT_TRUE(peak(dry[0], LENGTH) > 0 && peak(dry[1], LENGTH) > 0);
    TEST_ASSERT_EQUAL_MEMORY(dry, heard, sizeof dry);
}

// a stroke on a drum as it is made, from the side
static void test_ears_beside_a_drum_hear_two_sounds(void)
{
    himc_listener l = facing(1, 1.7, 1.4);
    himc_drum *timpano = himc_drum_new("timpano", 26, RATE, &error);
    himc_command quiet; // noise comes to the ears at two times, which this correlation does not see
    TEST_ASSERT_TRUE(himc_command_parse_text(&quiet, HIMC_DRUM, "noise 0", &error));
    TEST_ASSERT_TRUE(himc_drum_command(timpano, &quiet, &error));
    himc_drum_enclose(timpano, &(himc_walls){0});
    listens(timpano, &l);
    himc_drum_strike_at(timpano, 0, -0.75 * 0.33, 0.015, 0.2, &error);
    himc_drum_advance(timpano, 32000, NULL, NULL, NULL);
    double low = correlation(timpano, 32000, 800, false);
    double high = correlation(timpano, 32000, 800, true);
    char text[80];
    snprintf(text, sizeof text, "%.3f below 800 Hz, %.3f above", low, high);
    TEST_ASSERT_TRUE_MESSAGE(low > 0.45 && low < 0.92, text);
    TEST_ASSERT_TRUE_MESSAGE(high > -0.3 && high < 0.6, text);
    himc_drum_release(timpano);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_ears_hear_a_drum_r_by_c_later_to_a_hundredth_of_a_sample);
    RUN_TEST(test_ears_hear_a_drum_weaker_with_its_distance);
    RUN_TEST(test_ears_are_at_most_0_66_ms_apart);
    RUN_TEST(test_ears_hear_the_shadow_of_the_head);
    RUN_TEST(test_ears_hear_the_dips_of_the_floor_at_281_and_842_hz);
    RUN_TEST(test_ears_exchange_sides_when_all_is_mirrored);
    RUN_TEST(test_ears_see_a_tilted_head_as_it_lies);
    RUN_TEST(test_a_drum_that_nobody_listens_to_has_no_ears_and_takes_less_than_2_5_megabytes);
    RUN_TEST(test_ears_hear_the_same_in_blocks_of_any_size);
    RUN_TEST(test_ears_that_have_moved_hear_as_if_they_had_always_been_there);
    RUN_TEST(test_ears_do_not_click_when_they_come_move_and_leave);
    RUN_TEST(test_pickups_sound_as_if_nobody_had_listened_once_ears_have_left);
    RUN_TEST(test_ears_find_a_drum_that_was_moved);
    RUN_TEST(test_a_drum_hears_as_another);
    RUN_TEST(test_a_drum_alone_is_heard_by_two_ears_until_a_pickup_is_asked_for);
    RUN_TEST(test_ears_leave_the_pickups_behind_the_first_two_as_they_are);
    RUN_TEST(test_ears_beside_a_drum_hear_two_sounds);
    RUN_TEST(test_listener_refuses_what_is_no_place);
    RUN_TEST(test_listener_hears_all_drums_of_a_performance_until_reset);
    RUN_TEST(test_listener_is_loaded_to_the_same_result);
    return UNITY_END();
}
