/// test_performance.c: the whole path from commands to forces and sound.
#define _GNU_SOURCE
#include "allocations.h"
#include "himc/himc.h"
#include "performance/research.h"
#include "performance/performance_state.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PIECE                                                                     \
    "tempo 120; drum kettle; "                                                    \
    "stroke 2 right legato mf; stroke 3 left tenuto f; stroke 4 right accent f; " \
    "stroke 5 left vertical-accent mf rim; stroke 6 right staccato mp center; "   \
    "stroke 7 left legato pp;"

#define RATE 48000  // (Hz)
#define PARTED 1e-3 // of the stick in micro-contact from the body (m)

static himc_error error;

void setUp(void)
{
    error.text[0] = 0;
}

void tearDown(void)
{
}

static bool try_command(himc_performance *p, const char *text)
{
    himc_command c;
    return himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) &&
           himc_performance_command(p, &c, 0, &error);
}

static void command(himc_performance *p, const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(try_command(p, text), error.text);
}

static himc_performance *new_performance(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    himc_performance_make_drums(p, true);
    return p;
}

// a performance with a score loaded from a temporary file
static himc_performance *with_score(const char *text)
{
    char path[] = "/tmp/himc-test-XXXXXX", line[64];
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text));
    close(file);
    himc_performance *p = new_performance();
    snprintf(line, sizeof line, "score %s", path);
    bool ok = try_command(p, line);
    unlink(path);
    TEST_ASSERT_TRUE_MESSAGE(ok, error.text);
    return p;
}

// FNV-1a over the bytes of doubles
static uint64_t hash_doubles(uint64_t hash, const double *x, int n)
{
    const unsigned char *bytes = (const unsigned char *)x;
    for (size_t i = 0; i < (size_t)n * sizeof *x; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

static uint64_t play_hashed(himc_performance *p, int samples, int block)
{
    static double left[1024], right[1024], sound[1024];
    double *force[HIMC_HANDS] = {left, right};
    uint64_t hash = 14695981039346656037u, at = 0;
    uint64_t hashes[3] = {hash, hash, hash};
    while (samples > 0) {
        int n = block < samples ? block : samples;
        himc_performance_process(p, n, force);
        himc_drum_read(himc_performance_drum(p, 0), at, n, sound, NULL);
        hashes[0] = hash_doubles(hashes[0], left, n);
        hashes[1] = hash_doubles(hashes[1], right, n);
        hashes[2] = hash_doubles(hashes[2], sound, n);
        at += (uint64_t)n;
        samples -= n;
    }
    return hashes[0] ^ (hashes[1] * 3) ^ (hashes[2] * 5);
}

static uint64_t hash_of_piece(const char *before, int block)
{
    himc_performance *p = with_score(PIECE);
    command(p, before);
    command(p, "play");
    uint64_t hash = play_hashed(p, 3 * 48000, block);
    himc_performance_free(p);
    return hash;
}

static himc_performance_stats play(himc_performance *p, double seconds)
{
    for (int i = 0; i < (int)(seconds * 48000); i += 480)
        himc_performance_process(p, 480, NULL);
    return himc_performance_measure(p);
}

static void test_performance_is_the_same_twice_and_at_any_block_size(void)
{
    uint64_t first = hash_of_piece("stop", 64);
    TEST_ASSERT_EQUAL_HEX64(first, hash_of_piece("stop", 64));
    TEST_ASSERT_EQUAL_HEX64(first, hash_of_piece("stop", 1));
    TEST_ASSERT_EQUAL_HEX64(first, hash_of_piece("stop", 1024));
    TEST_ASSERT_EQUAL_HEX64(first, hash_of_piece("human 0 5", 333));
}

// two drums, the sound of both
static uint64_t hash_of_pair(const char *air, int block)
{
    static double sound[1000];
    char text[512];
    uint64_t hash = 14695981039346656037u;
    snprintf(
        text, sizeof text,
        "drum a 26; a place 0.7 0.4 0.85; drum b 26; b place 0.7 -0.4 0.85; a air %s; b air %s; "
        "listener 2.2 0 1.4; tempo 120; stroke 1 left legato f normal a; "
        "stroke 1.5 right legato mf normal b; stroke 2 left legato mf normal a; "
        "stroke 2 right legato f normal b;",
        air, air);
    himc_performance *p = with_score(text);
    command(p, "play");
    for (int at = 0, n; at < 2 * RATE; at += n) {
        n = block < 2 * RATE - at ? block : 2 * RATE - at;
        himc_performance_process(p, n, NULL);
        for (int k = 0; k < 2; k++) {
            himc_drum_read(himc_performance_drum(p, k), (uint64_t)at, n, sound, NULL);
            for (int i = 0; i < n; i++)
                hash ^= hash_doubles((uint64_t)(2 * (at + i) + k), &sound[i], 1);
        }
    }
    TEST_ASSERT_EQUAL_INT(4, himc_performance_measure(p).played);
    himc_performance_free(p);
    return hash;
}

static void test_two_drums_sound_the_same_at_any_block_size(void)
{
    static const char *const air[] = {"0", "1"};
    for (int i = 0; i < 2; i++) {
        uint64_t first = hash_of_pair(air[i], 64);
        TEST_ASSERT_EQUAL_HEX64(first, hash_of_pair(air[i], 1));
        TEST_ASSERT_EQUAL_HEX64(first, hash_of_pair(air[i], 1000));
    }
}

static void test_a_players_variation_is_the_same_at_any_block_size_and_follows_its_seed(void)
{
    uint64_t first = hash_of_piece("human 0.7 5", 64);
    TEST_ASSERT_EQUAL_HEX64(first, hash_of_piece("human 0.7 5", 1));
    TEST_ASSERT_EQUAL_HEX64(first, hash_of_piece("human 0.7 5", 1000));
    TEST_ASSERT_TRUE(first != hash_of_piece("human 0.7 6", 64));
    TEST_ASSERT_TRUE(first != hash_of_piece("stop", 64));
}

static void test_varied_strokes_land_as_they_vary(void)
{
    himc_performance *p = with_score(PIECE);
    himc_event event;
    command(p, "human 1 2");
    command(p, "play");
    himc_performance_stats s = play(p, 5);
    TEST_ASSERT_EQUAL_INT(6, s.played);
    TEST_ASSERT_EQUAL_INT(0, s.missed);
    while (himc_performance_event(p, &event)) {
        const himc_strike *k = &event.strike;
        if (event.kind != HIMC_EVENT_STRIKE)
            continue;
        TEST_ASSERT_DOUBLE_WITHIN(0.001, k->planned_time, k->time);
        TEST_ASSERT_TRUE(hypot(k->x - k->planned_x, k->y - k->planned_y) < 0.002);
    }
    himc_performance_free(p);
}

static void test_all_five_nuances_land_on_time_and_place(void)
{
    himc_performance *p = with_score(PIECE);
    command(p, "play");
    himc_performance_stats s = play(p, 5);
    TEST_ASSERT_EQUAL_INT(6, s.strokes);
    TEST_ASSERT_EQUAL_INT(6, s.played);
    TEST_ASSERT_EQUAL_INT(0, s.missed);
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    himc_performance_free(p);
}

static void test_default_law_keeps_tips_within_0_3_percent_of_height(void)
{
    himc_performance *p = with_score(PIECE);
    command(p, "play");
    himc_performance_stats s = play(p, 5);
    TEST_ASSERT_TRUE(s.stroke_height > 0.1);
    TEST_ASSERT_TRUE(s.tip_rms_percent < 0.3);
    himc_performance_free(p);
}

static void play_mode_and_expect_strokes(const char *mode, const char *law)
{
    himc_performance *p = with_score(PIECE);
    command(p, mode);
    command(p, law);
    command(p, "play");
    himc_performance_stats s = play(p, 5);
    TEST_ASSERT_EQUAL_INT_MESSAGE(6, s.strokes, mode);
    TEST_ASSERT_TRUE_MESSAGE(s.peak_force > 10, law);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, s.recoveries, law);
    himc_performance_free(p);
}

static void test_every_mode_and_law_strikes_the_drum(void)
{
    static const char *const modes[] = {"mode himc", "mode id", "mode ik"};
    static const char *const laws[] = {"law printed", "law feedforward", "law computed-torque"};
    for (int m = 0; m < 3; m++)
        for (int l = 0; l < 3; l++)
            play_mode_and_expect_strokes(modes[m], laws[l]);
}

static void test_one_way_coupling_also_sounds(void)
{
    himc_performance *p = with_score(PIECE);
    command(p, "coupling one-way");
    command(p, "play");
    himc_performance_stats s = play(p, 5);
    TEST_ASSERT_EQUAL_INT(6, s.played);
    TEST_ASSERT_TRUE(s.peak_force > 10);
    himc_performance_free(p);
}

static void test_strikes_are_reported_as_they_were_asked_for(void)
{
    himc_performance *p = with_score("tempo 60; drum kettle; stroke 1 left accent f 0.05 -0.1;");
    himc_event event;
    int strikes = 0, done = 0, beats = 0;
    command(p, "play");
    play(p, 4);
    while (himc_performance_event(p, &event)) {
        done += event.kind == HIMC_EVENT_DONE;
        beats += event.kind == HIMC_EVENT_BEAT;
        if (event.kind != HIMC_EVENT_STRIKE)
            continue;
        strikes++;
        TEST_ASSERT_EQUAL_INT(HIMC_LEFT, event.strike.hand);
        TEST_ASSERT_EQUAL_STRING("kettle", event.strike.drum);
        TEST_ASSERT_EQUAL_STRING("accent", event.strike.nuance);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 1, event.strike.time);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.05, event.strike.x);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, -0.1, event.strike.y);
        TEST_ASSERT_TRUE(event.strike.velocity > 2 && event.strike.velocity < 8);
        TEST_ASSERT_TRUE(event.strike.duration > 0.003 && event.strike.duration < 0.015);
    }
    TEST_ASSERT_EQUAL_INT(1, strikes);
    TEST_ASSERT_EQUAL_INT(1, done);
    TEST_ASSERT_TRUE(beats >= 1);
    himc_performance_free(p);
}

static void test_done_comes_with_the_last_contact_and_no_beat_after_it(void)
{
    static const char *const piece[] = {"tempo 240; drum kettle; stroke 1 left accent f;",
                                        "tempo 240; drum kettle; roll 1 2 press mf;"};
    for (int i = 0; i < 2; i++) {
        himc_performance *p = with_score(piece[i]);
        double contact = 0, done = 0;
        himc_event event;
        command(p, "play");
        for (int k = 0; k < 500; k++) {
            himc_performance_process(p, 480, NULL);
            while (himc_performance_event(p, &event)) {
                if (event.kind == HIMC_EVENT_STRIKE)
                    contact = event.strike.time + event.strike.duration;
                TEST_ASSERT_TRUE(done == 0);
                if (event.kind == HIMC_EVENT_DONE)
                    done = 0.01 * (k + 1);
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.04, contact + 0.05, done);
        int played = himc_performance_measure(p).played;
        command(p, "play"); // from the beginning
        TEST_ASSERT_EQUAL_INT(2 * played, play(p, 4).played);
        himc_performance_free(p);
    }
}

static void test_process_never_allocates_after_the_first_stroke(void)
{
    himc_performance *p = with_score(PIECE);
    command(p, "play");
    play(p, 1.2);
    watch_allocations();
    play(p, 3);
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
    himc_performance_free(p);
}

static void test_bad_commands_change_nothing_and_name_the_allowed_values(void)
{
    himc_performance *p = with_score(PIECE);
    static const char *const bad[][2] = {{"gain knuckle 1 1", "left-wrist"},
                                         {"rate physics 1", "rate"},
                                         {"score /no/such/file.txt", "/no/such/file.txt"},
                                         {"take /no/such/file.trc", "/no/such/file.trc"},
                                         {"player 17 75", "HEIGHT"},
                                         {"mode fly", "himc"},
                                         {"tempo nan", "tempo"}};
    command(p, "play");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        TEST_ASSERT_FALSE_MESSAGE(try_command(p, bad[i][0]), bad[i][0]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, bad[i][1]), error.text);
        TEST_ASSERT_NULL(strchr(error.text, '\n'));
    }
    TEST_ASSERT_EQUAL_INT(6, play(p, 5).played);
    himc_performance_free(p);
}

static void test_target_out_of_reach_is_clamped_with_one_line(void)
{
    himc_performance *p = new_performance();
    himc_event event;
    int lines = 0;
    command(p, "target right 2.5 0 2");
    himc_performance_stats s = play(p, 2);
    while (himc_performance_event(p, &event))
        lines += event.kind == HIMC_EVENT_NOTE && strstr(event.text, "out of reach");
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    himc_performance_free(p);
}

// the host's drum, for the performance that `user` points to
static bool lend_drum(void *user, const char *name)
{
    himc_performance *p = *(himc_performance **)user;
    if (strcmp(name, "tabla") != 0)
        return false;
    himc_drum *drum = himc_drum_new(name, 14, 48000, &error);
    bool good = himc_performance_add_drum(p, drum, &error);
    himc_drum_release(drum);
    return good;
}

static void test_a_word_that_is_neither_spot_nor_drum_is_refused_with_both_lists(void)
{
    static const char *const form[] = {"hit right legato f %s",     "stroke 1 right legato f %s",
                                       "flam 1 right legato f %s",  "drag 1 right legato f %s",
                                       "ruff 1 right legato f %s",  "roll 1 2 single f %s",
                                       "hit right legato f rim %s", "hit right legato f 0 0.1 %s"};
    himc_performance *p = new_performance();
    char text[80];
    command(p, "drum low 29");
    command(p, "drum high 23");
    for (size_t i = 0; i < sizeof form / sizeof *form; i++) {
        snprintf(text, sizeof text, form[i], "rmi");
        TEST_ASSERT_FALSE_MESSAGE(try_command(p, text), text);
        TEST_ASSERT_EQUAL_STRING(
            i < 6
                ? "rmi: no spot (center normal rim crossstick rimshot click shell), not dead, no drum (low high), did "
                  "you mean rim?"
            : i < 7 ? "rmi: not dead, no drum (low high)"
                    : "rmi: no drum (low high)",
            error.text);
        snprintf(text, sizeof text, form[i], "ded");
        TEST_ASSERT_FALSE_MESSAGE(try_command(p, text), text);
        TEST_ASSERT_TRUE_MESSAGE(i == 7 || strstr(error.text, "did you mean dead?"), error.text);
        snprintf(text, sizeof text, form[i], "high");
        TEST_ASSERT_TRUE_MESSAGE(try_command(p, text), error.text);
        command(p, "clear");
    }
    TEST_ASSERT_NULL(himc_performance_drum(p, 2));
    himc_performance_free(p);
}

static void test_a_drum_that_the_host_has_is_asked_for(void)
{
    himc_performance *p = NULL;
    himc_performance_config config = himc_performance_default();
    config.find_drum = lend_drum;
    config.find_user = &p;
    p = himc_performance_new(&config, &error);
    TEST_ASSERT_FALSE(try_command(p, "stroke 1 right legato f bongo"));
    command(p, "stroke 1 right legato f tabla");
    TEST_ASSERT_EQUAL_STRING("tabla", himc_drum_name(himc_performance_drum(p, 0)));
    command(p, "hit right legato f tabla");
    TEST_ASSERT_NULL(himc_performance_drum(p, 1));
    himc_performance_free(p);
}

static void test_drum_of_a_host_without_it_is_silent_and_noted_once(void)
{
    himc_performance *p = new_performance();
    himc_event event;
    int lines = 0;
    himc_performance_make_drums(p, false);
    command(p, "drum tabla");
    command(p, "drum tabla");
    command(p, "stroke 1 right legato mf normal tabla");
    command(p, "stroke 2 right legato mf normal tabla");
    command(p, "play");
    TEST_ASSERT_EQUAL_INT(2, play(p, 4).strokes);
    while (himc_performance_event(p, &event))
        lines += event.kind == HIMC_EVENT_NOTE && strstr(event.text, "tabla");
    TEST_ASSERT_EQUAL_INT(1, lines);
    himc_performance_free(p);
}

static void test_commands_wait_for_their_sample(void)
{
    himc_performance *p = with_score("tempo 120; drum kettle; stroke 2 right accent f;");
    himc_command c;
    himc_event event = {.kind = HIMC_EVENT_NOTE};
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_PERFORMER, "play", &error));
    TEST_ASSERT_TRUE(himc_performance_command(p, &c, 4800, &error));
    play(p, 3);
    while (event.kind != HIMC_EVENT_STRIKE)
        TEST_ASSERT_TRUE(himc_performance_event(p, &event));
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 1.1, event.strike.time);
    himc_performance_free(p);
}

static void test_any_gain_stays_finite_and_recovers(void)
{
    static const char *const gains[] = {"gain left-shoulder 7440 296", "gain right-wrist 4.8 0.11",
                                        "gain right-grip 200 3.6", "gain left-elbow 35800 1140"};
    static const char *const laws[] = {"law printed", "law feedforward", "law computed-torque"};
    for (int l = 0; l < 3; l++)
        for (size_t g = 0; g < sizeof gains / sizeof gains[0]; g++) {
            himc_performance *p = with_score(PIECE);
            command(p, laws[l]);
            command(p, gains[g]);
            command(p, "play");
            himc_performance_stats s = play(p, 3);
            TEST_ASSERT_TRUE(isfinite(s.tip_rms) && isfinite(s.peak_force));
            himc_performance_free(p);
        }
}

static void test_sample_rate_changes_while_playing(void)
{
    himc_performance *p = with_score(PIECE);
    command(p, "play");
    play(p, 1.2);
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_set_rate(p, 44100, &error), error.text);
    TEST_ASSERT_FALSE(himc_performance_set_rate(p, NAN, &error));
    himc_performance_stats s = play(p, 4);
    TEST_ASSERT_EQUAL_INT(6, s.played);
    himc_performance_free(p);
}

static void test_realign_does_not_disturb_the_sound(void)
{
    static double plain[9600], cut[9600];
    himc_performance *a = with_score(PIECE), *b = with_score(PIECE);
    command(a, "play");
    command(b, "play");
    play(a, 1.01);
    play(b, 1.01);
    uint64_t at = himc_performance_time(a);
    himc_performance_realign(b);
    TEST_ASSERT_EQUAL_UINT64(0, himc_performance_time(b));
    himc_performance_process(a, 9600, NULL);
    himc_performance_process(b, 9600, NULL);
    himc_drum_read(himc_performance_drum(a, 0), at, 9600, plain, NULL);
    himc_drum_read(himc_performance_drum(b, 0), 0, 9600, cut, NULL);
    TEST_ASSERT_EQUAL_MEMORY(plain, cut, sizeof plain);
    himc_performance_free(a);
    himc_performance_free(b);
}

static void test_real_stroke_strikes_the_drum_from_its_bead_alone(void)
{
    const char *shared = getenv("HIMC_SHARED");
    char line[512], path[400];
    snprintf(path, sizeof path, "%s/mocap/drumstroke_pearl_240hz/stroke.trc",
             shared ? shared : "../shared");
    if (access(path, R_OK) != 0)
        TEST_IGNORE_MESSAGE("no captures here");
    himc_performance *p = new_performance();
    himc_event event;
    int strikes = 0;
    snprintf(line, sizeof line, "take %s", path);
    command(p, line);
    command(p, "play");
    himc_performance_stats s = play(p, 3);
    while (himc_performance_event(p, &event)) {
        if (event.kind != HIMC_EVENT_STRIKE)
            continue;
        strikes++;
        TEST_ASSERT_DOUBLE_WITHIN(0.8, 10, event.strike.velocity);
    }
    TEST_ASSERT_EQUAL_INT(1, strikes);
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    TEST_ASSERT_TRUE(s.tip_rms_percent < 1);
    himc_performance_free(p);
}

// the stick in micro-contact and the body's own tip feel one impulse: only what the inertia changes
// in a step parts them; and once they leave the head the plan goes on from where the tip really is
static void test_stick_and_body_tip_stay_together_and_the_plan_joins_the_tip(void)
{
    himc_performance *p = with_score(PIECE);
    double parted = 0, away = 0, slip = 0;
    command(p, "play");
    for (int i = 0; i < 4 * 48000; i += 4) {
        himc_performance_process(p, 4, NULL);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            const stick_contact *c = &p->contacts.hand[hand];
            himc_vec3 d = himc_vec3_sub(p->body->state.tip[hand], p->motion->reference.tip[hand].x);
            himc_vec3 v =
                himc_vec3_sub(p->body->state.tip_velocity[hand], p->motion->reference.tip[hand].v);
            if (c->touching)
                parted = fmax(parted, fabs(c->offset));
            if (c->touching || p->motion->reference.released[hand])
                continue;
            away = fmax(away, himc_vec3_length(d));
            slip = fmax(slip, himc_vec3_length(v));
        }
    }
    himc_performance_free(p);
    TEST_ASSERT_TRUE(parted > 0 && parted < PARTED);
    TEST_ASSERT_TRUE(away < 1e-3);
    TEST_ASSERT_TRUE(slip < 0.2);
}

// the printed law lags by more than the 5 ms within which a stroke counts as played
static void test_a_late_stroke_is_not_counted_as_played(void)
{
    himc_performance *p =
        with_score("tempo 60; drum kettle; law printed; stroke 1 right legato f;");
    himc_event event = {.kind = HIMC_EVENT_NOTE};
    command(p, "play");
    himc_performance_stats s = play(p, 3);
    while (event.kind != HIMC_EVENT_STRIKE)
        TEST_ASSERT_TRUE(himc_performance_event(p, &event));
    TEST_ASSERT_TRUE(event.strike.time > 1.005 && event.strike.time < 1.05);
    TEST_ASSERT_EQUAL_INT(1, s.strokes);
    TEST_ASSERT_EQUAL_INT(0, s.played);
    TEST_ASSERT_EQUAL_INT(1, s.missed);
    himc_performance_free(p);
}

static void sound_of(himc_performance *p, double *sound)
{
    himc_performance_process(p, 2 * RATE, NULL);
    himc_drum_read(himc_performance_drum(p, 0), RATE, RATE, sound, NULL);
    himc_performance_free(p);
}

static void test_strokes_and_texts_of_C_programs_equal_commands(void)
{
    static double typed[RATE], told[RATE];
    const himc_stroke stroke = {
        .beat = 1, .hand = HIMC_LEFT, .nuance = HIMC_ACCENT, .dynamic = 1, .spot = HIMC_SPOT_RIM};
    himc_stroke hit = {.hand = HIMC_RIGHT, .dynamic = 0.5, .spot = HIMC_SPOT_XY, .x = 0.125};
    himc_performance *a = new_performance(), *b = new_performance();
    TEST_ASSERT_TRUE(himc_performance_send(a, "tempo 90", &error));
    TEST_ASSERT_TRUE(himc_performance_add_stroke(a, &stroke, &error));
    TEST_ASSERT_TRUE(himc_performance_send(a, "play", &error));
    TEST_ASSERT_TRUE(himc_performance_hit(a, &hit, &error));
    himc_performance_process(a, RATE, NULL);
    TEST_ASSERT_TRUE(himc_performance_send(a, "stop", &error));
    command(b, "tempo 90");
    command(b, "stroke 1 left accent fff rim");
    command(b, "play");
    command(b, "hit right legato 0.5 0.125 0");
    himc_performance_process(b, RATE, NULL);
    command(b, "stop");
    sound_of(a, typed);
    sound_of(b, told);
    TEST_ASSERT_EQUAL_MEMORY(told, typed, sizeof told);
}

static void test_calls_for_C_programs_refuse_what_is_out_of_range(void)
{
    himc_performance *p = new_performance();
    const himc_stroke good = {.beat = 1, .dynamic = 0.5, .spot = HIMC_SPOT_NORMAL};
    himc_stroke bad[] = {good, good, good, good, good, good, good};
    bad[0].hand = (himc_hand)2;
    bad[1].nuance = HIMC_NUANCES;
    bad[2].dynamic = NAN;
    bad[3].dynamic = 1.01;
    bad[4].spot = HIMC_SPOT_XY;
    bad[4].y = INFINITY;
    memset(bad[5].drum, 'a', sizeof bad[5].drum);
    bad[6].spot = (himc_spot)-1;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        TEST_ASSERT_FALSE(himc_performance_add_stroke(p, &bad[i], &error));
        TEST_ASSERT_FALSE(himc_performance_hit(p, &bad[i], &error));
        TEST_ASSERT_EQUAL_INT(0, strncmp(error.text, "stroke: ", 8));
    }
    himc_stroke early = good;
    early.beat = -1;
    TEST_ASSERT_FALSE(himc_performance_add_stroke(p, &early, &error));
    TEST_ASSERT_FALSE(himc_performance_send(p, "tempo 0", &error));
    TEST_ASSERT_NULL(himc_performance_drum(p, 0));
    himc_performance_free(p);
}

static void test_commands_that_are_not_the_performers_or_too_far_ahead_are_refused(void)
{
    himc_performance *p = new_performance();
    himc_command c;
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, "tension 3000", &error));
    TEST_ASSERT_FALSE(himc_performance_command(p, &c, 0, &error));
    TEST_ASSERT_EQUAL_STRING("a drum's command, not the performer's", error.text);
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_PERFORMER, "stop", &error));
    TEST_ASSERT_TRUE(himc_performance_command(p, &c, 8192, &error));
    TEST_ASSERT_FALSE(himc_performance_command(p, &c, 8193, &error));
    TEST_ASSERT_EQUAL_STRING("delay: 8193 samples, expected 0 .. 8192", error.text);
    for (int i = 0; i < 2; i++) {
        c.id = (himc_command_id)(i == 0 ? -3 : HIMC_COMMANDS);
        TEST_ASSERT_FALSE(himc_performance_command(p, &c, 0, &error));
        TEST_ASSERT_NOT_NULL(strstr(error.text, "not from the parser"));
    }
    himc_performance_free(p);
}

static void test_a_target_of_no_hand_moves_nothing(void)
{
    himc_performance *p = new_performance();
    himc_performance_stats before, after;
    himc_performance_process(p, 100, NULL);
    before = himc_performance_measure(p);
    himc_performance_target(p, (himc_hand)99, himc_vec3_make(0.6, 0, 1));
    himc_performance_target(p, (himc_hand)-100000, himc_vec3_make(0.6, 0, 1));
    himc_performance_target(p, (himc_hand)HIMC_HANDS, himc_vec3_make(0.6, 0, 1));
    himc_performance_process(p, 4800, NULL);
    after = himc_performance_measure(p);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, before.tip_rms, after.tip_rms);
    himc_performance_free(p);
}

static void test_a_performer_has_16_drums_and_one_of_a_name(void)
{
    himc_performance *p = new_performance();
    himc_drum *drum = NULL, *again = himc_drum_new("d0", 29, RATE, &error);
    char name[8];
    for (int i = 0; i <= HIMC_DRUMS; i++) {
        snprintf(name, sizeof name, "d%d", i);
        drum = himc_drum_new(name, 26, RATE, &error);
        TEST_ASSERT_EQUAL(i < HIMC_DRUMS, himc_performance_add_drum(p, drum, &error));
        if (i < HIMC_DRUMS) {
            TEST_ASSERT_EQUAL_PTR(drum, himc_performance_drum(p, i));
        }
        himc_drum_release(drum);
    }
    TEST_ASSERT_EQUAL_STRING("drum d16: a performer plays on 16 drums at most", error.text);
    for (int i = 0; i < 2; i++) { // in place of the old one, and then of itself
        TEST_ASSERT_TRUE(himc_performance_add_drum(p, again, &error));
        TEST_ASSERT_EQUAL_PTR(again, himc_performance_drum(p, 0));
    }
    himc_drum_release(again);
    TEST_ASSERT_EQUAL_STRING("d15", himc_drum_name(himc_performance_drum(p, 15)));
    play(p, 0.01);
    himc_performance_free(p);
}

static void test_weights_out_of_range_name_their_segment(void)
{
    himc_performance *p = new_performance();
    double weight[HIMC_SEGMENTS];
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        weight[i] = 1;
    weight[HIMC_LEFT_HAND] = -1;
    TEST_ASSERT_FALSE(himc_performance_set_weights(p, weight, &error));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, strncmp(error.text, "left-hand: weight: -1, expected", 30),
                                  error.text);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_performance_is_the_same_twice_and_at_any_block_size);
    RUN_TEST(test_two_drums_sound_the_same_at_any_block_size);
    RUN_TEST(test_a_players_variation_is_the_same_at_any_block_size_and_follows_its_seed);
    RUN_TEST(test_varied_strokes_land_as_they_vary);
    RUN_TEST(test_all_five_nuances_land_on_time_and_place);
    RUN_TEST(test_default_law_keeps_tips_within_0_3_percent_of_height);
    RUN_TEST(test_every_mode_and_law_strikes_the_drum);
    RUN_TEST(test_one_way_coupling_also_sounds);
    RUN_TEST(test_strikes_are_reported_as_they_were_asked_for);
    RUN_TEST(test_done_comes_with_the_last_contact_and_no_beat_after_it);
    RUN_TEST(test_process_never_allocates_after_the_first_stroke);
    RUN_TEST(test_bad_commands_change_nothing_and_name_the_allowed_values);
    RUN_TEST(test_target_out_of_reach_is_clamped_with_one_line);
    RUN_TEST(test_a_word_that_is_neither_spot_nor_drum_is_refused_with_both_lists);
    RUN_TEST(test_a_drum_that_the_host_has_is_asked_for);
    RUN_TEST(test_drum_of_a_host_without_it_is_silent_and_noted_once);
    RUN_TEST(test_commands_wait_for_their_sample);
    RUN_TEST(test_any_gain_stays_finite_and_recovers);
    RUN_TEST(test_sample_rate_changes_while_playing);
    RUN_TEST(test_realign_does_not_disturb_the_sound);
    RUN_TEST(test_stick_and_body_tip_stay_together_and_the_plan_joins_the_tip);
    RUN_TEST(test_a_late_stroke_is_not_counted_as_played);
    RUN_TEST(test_strokes_and_texts_of_C_programs_equal_commands);
    RUN_TEST(test_calls_for_C_programs_refuse_what_is_out_of_range);
    RUN_TEST(test_real_stroke_strikes_the_drum_from_its_bead_alone);
    RUN_TEST(test_commands_that_are_not_the_performers_or_too_far_ahead_are_refused);
    RUN_TEST(test_a_target_of_no_hand_moves_nothing);
    RUN_TEST(test_a_performer_has_16_drums_and_one_of_a_name);
    RUN_TEST(test_weights_out_of_range_name_their_segment);
    return UNITY_END();
}
