/// test_planner_commands.c: commands to a planner while it plays, and its reports: current stroke,
/// beat and notes. Under all commands the motion stays continuous, finite and deterministic.
#include "allocations.h"
#include "planners.h"

#include "plan/planner_state.h"

#include <stdlib.h>
#include <string.h>

static void test_current_names_the_stroke_until_its_touch_is_over(void)
{
    himc_stroke s;
    int drum;
    double touch;
    add(planner, 2, HIMC_LEFT, HIMC_TENUTO, 0.5);
    add(planner, 4, HIMC_LEFT, HIMC_ACCENT, 0.5);
    himc_planner_play(planner, 0);
    himc_planner_advance(planner, 0.9);
    TEST_ASSERT_TRUE(himc_planner_current(planner, HIMC_LEFT, 1.02, &s, &drum, &touch));
    TEST_ASSERT_EQUAL_INT(HIMC_TENUTO, s.nuance);
    TEST_ASSERT_EQUAL_DOUBLE(1, touch);
    himc_planner_advance(planner, 1.1);
    TEST_ASSERT_TRUE(himc_planner_current(planner, HIMC_LEFT, 1.1, &s, &drum, &touch));
    TEST_ASSERT_EQUAL_INT(HIMC_ACCENT, s.nuance);
    TEST_ASSERT_EQUAL_DOUBLE(2, touch);
    himc_planner_advance(planner, 3);
    TEST_ASSERT_FALSE(himc_planner_current(planner, HIMC_LEFT, 3, &s, &drum, &touch));
    TEST_ASSERT_FALSE(himc_planner_current(planner, HIMC_RIGHT, 3, &s, &drum, &touch));
}

static void test_play_waits_for_the_first_stroke_and_seek_says_how_late_it_is(void)
{
    himc_planner_note note;
    add(planner, 0, HIMC_RIGHT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 1);
    double touch = first_touch(HIMC_RIGHT);
    TEST_ASSERT_TRUE(touch > 1.3 && touch < 1.8);
    TEST_ASSERT_FALSE(himc_planner_note_next(planner, &note));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_planner_beat(planner, 1));
    TEST_ASSERT_TRUE(himc_planner_is_preparing(planner, touch - 1e-3));
    TEST_ASSERT_FALSE(himc_planner_is_preparing(planner, touch));
    himc_planner_seek(planner, 1, 0);
    TEST_ASSERT_TRUE(himc_planner_note_next(planner, &note));
    TEST_ASSERT_NOT_NULL(strstr(note.text, "late: the first stroke must be prepared"));
    TEST_ASSERT_FALSE(himc_planner_note_next(planner, &note));
}

static void test_fast_strokes_are_softer_and_one_note_says_so(void)
{
    himc_planner_note note;
    use(200);
    for (int i = 0; i < 40; i++)
        add(planner, 4 + 0.4 * i, HIMC_RIGHT, HIMC_LEGATO, 0.9);
    himc_planner_play(planner, 0);
    double next = first_touch(HIMC_RIGHT);
    for (double t = 0; t < 8; t += 0.01) {
        himc_planner_advance(planner, t);
        if (t < next + HIMC_CONTACT_TIME)
            continue;
        himc_target left = himc_planner_target(planner, HIMC_RIGHT, t); // as planned
        himc_planner_separated(planner, HIMC_RIGHT, t, &left);
        next += 0.12;
    }
    TEST_ASSERT_TRUE(himc_planner_note_next(planner, &note));
    TEST_ASSERT_EQUAL_STRING("stroke at beat 4 right: too little time for 5.3 m/s, struck with 4.8",
                             note.text);
    TEST_ASSERT_FALSE(himc_planner_note_next(planner, &note));
}

static void test_32_notes_are_kept_and_lost_ones_are_counted(void)
{
    himc_planner_note note, last = {.text = ""};
    int count = 0;
    for (int i = 0; i < 40; i++) {
        himc_planner_clear(planner);
        add(planner, 0, HIMC_RIGHT, HIMC_LEGATO, 0.5);
        himc_planner_play(planner, 0);
        himc_planner_seek(planner, 0, 0);
    }
    while (himc_planner_note_next(planner, &note)) {
        last = note;
        count++;
    }
    TEST_ASSERT_EQUAL_INT(32, count);
    TEST_ASSERT_NOT_NULL(strstr(last.text, "more notes were lost"));
}

static void test_tempo_change_keeps_the_beat_and_moves_later_strokes(void)
{
    himc_stroke s;
    int drum;
    double touch;
    for (int i = 0; i < 8; i++)
        add(planner, 1 + i, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    for (double t = 0; t < 1.25; t += 0.004)
        himc_planner_advance(planner, t);
    double beat = himc_planner_beat(planner, 1.25);
    himc_planner_tempo(planner, 1.25, 60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, beat, himc_planner_beat(planner, 1.25));
    TEST_ASSERT_TRUE(himc_planner_current(planner, HIMC_LEFT, 1.25, &s, &drum, &touch));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.75, touch);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, at(planner, HIMC_LEFT, 1.75).x.z);
}

static void test_new_tempi_while_playing_keep_the_beat(void)
{
    static const himc_tempo_change tempi[] = {{0, 60}, {3, 240}, {4, 60}};
    for (int i = 0; i < 8; i++)
        add(planner, 1 + i, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    for (double t = 0; t < 0.75; t += 0.004)
        himc_planner_advance(planner, t);
    double now = 0.748 + PLANNER_AHEAD, beat = himc_planner_beat(planner, now);
    TEST_ASSERT_TRUE_MESSAGE(himc_planner_set_tempi(planner, tempi, 3, &error), error.text);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, beat, himc_planner_beat(planner, now));
    double third = now + 3 - beat; // at 60 a minute
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4, himc_planner_beat(planner, third + 0.25));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, at(planner, HIMC_LEFT, third + 0.25).x.z);
    himc_planner_tempo(planner, third + 2, 120); // past both changes
    beat = himc_planner_beat(planner, third + 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, beat + 2, himc_planner_beat(planner, third + 3));
}

static void test_tempi_out_of_order_or_none_are_refused(void)
{
    static const himc_tempo_change tempi[] = {{0, 60}, {3, 240}, {3, 60}};
    TEST_ASSERT_FALSE(himc_planner_set_tempi(planner, tempi, 3, &error));
    TEST_ASSERT_EQUAL_STRING("tempo: BEAT: 3 is not after the one before", error.text);
    TEST_ASSERT_FALSE(himc_planner_set_tempi(planner, tempi, 0, &error));
    TEST_ASSERT_EQUAL_STRING("tempo: 0 changes, expected 1 or more", error.text);
    himc_planner_play(planner, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2,
                              himc_planner_beat(planner, 2) - himc_planner_beat(planner, 1));
    himc_planner_config config = himc_planner_default();
    config.rest[HIMC_RIGHT].y = NAN;
    TEST_ASSERT_NULL(himc_planner_new(&config, &error));
    TEST_ASSERT_EQUAL_STRING("rest of the right hand: not finite", error.text);
}

static void test_stop_brings_the_tip_to_rest_and_play_resumes(void)
{
    for (int i = 0; i < 8; i++)
        add(planner, 1 + i, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    himc_planner_advance(planner, 1.3);
    himc_planner_stop(planner, 1.3);
    TEST_ASSERT_TRUE(himc_planner_beat(planner, 1.4) < 0);
    TEST_ASSERT_TRUE(isinf(himc_planner_end(planner)));
    himc_target s = at(planner, HIMC_LEFT, 4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.55, s.x.x); // two thirds of the radius before the centre
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, himc_vec3_length(s.v));
    himc_planner_play(planner, 4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2.6, himc_planner_beat(planner, 4));
    double end = himc_planner_end(planner) + 2.5;
    s = at(planner, HIMC_LEFT, end);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, himc_vec3_length(s.v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, PLANE + 0.085, s.x.z);
}

static void test_hit_comes_within_a_quarter_second_from_rest(void)
{
    himc_stroke s = {
        .hand = HIMC_LEFT, .nuance = HIMC_LEGATO, .dynamic = 4 / 7.0, .spot = HIMC_SPOT_NORMAL};
    himc_planner_advance(planner, 1);
    double t = himc_planner_hit(planner, 1, &s, 0);
    TEST_ASSERT_TRUE(t > 1 && t <= 1.25);
    himc_target x = at(planner, HIMC_LEFT, t - 1e-12);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, x.x.z);
    TEST_ASSERT_TRUE(x.v.z < -1.5);
    himc_planner_advance(planner, 4);
    himc_planner_reach(planner, 4, HIMC_LEFT, himc_vec3_make(0.525, 0.015, 1.15));
    himc_planner_advance(planner, 5);
    t = himc_planner_hit(planner, 5, &s, 0);
    TEST_ASSERT_TRUE(t <= 5.12);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, at(planner, HIMC_LEFT, t).x.z);
}

// it only has to fall; the other one would have to come across the head
static void test_a_hit_of_any_hand_is_played_by_the_one_above_its_spot(void)
{
    himc_stroke any = {
        .hand = HIMC_HAND_ANY, .nuance = HIMC_LEGATO, .dynamic = 0.5, .spot = HIMC_SPOT_NORMAL};
    for (int i = 0; i < 4; i++) {
        himc_hand above = i % 2 ? HIMC_RIGHT : HIMC_LEFT, aside = i % 2 ? HIMC_LEFT : HIMC_RIGHT;
        double side = i % 2 ? -1 : 1, tilt = i < 2 ? 0 : 0.4, touch;
        int drum;
        use(120);
        himc_planner_set_drum(
            planner, 0, &(himc_head_frame){.center = {0.75, 0, 0.85}, .tilt = tilt, .radius = 0.3});
        himc_planner_reach(planner, 0, above, himc_vec3_make(0.55, 0.02 * side, 1.3));
        himc_planner_reach(planner, 0, aside, himc_vec3_make(0.55, -0.25 * side, 0.9));
        himc_planner_advance(planner, 2);
        himc_planner_hit_at(planner, 2, &(himc_hit){&any, 0, 2.4, false});
        TEST_ASSERT_TRUE(himc_planner_current(planner, above, 2, NULL, &drum, &touch));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2.4, touch);
    }
}

static void test_reach_arrives_and_stays(void)
{
    himc_vec3 goal = {0.6, 0.2, 1.2};
    himc_planner_reach(planner, 0, HIMC_RIGHT, goal);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0,
                              himc_vec3_length(himc_vec3_sub(goal, at(planner, HIMC_RIGHT, 1).x)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0,
                              himc_vec3_length(himc_vec3_sub(goal, at(planner, HIMC_RIGHT, 9).x)));
}

static void test_strokes_nearer_than_40_ms_or_on_no_drum_are_refused(void)
{
    himc_stroke s = {.beat = 1.05, .hand = HIMC_LEFT};
    add(planner, 1, HIMC_LEFT, HIMC_LEGATO, 0.5);
    TEST_ASSERT_FALSE(himc_planner_add(planner, &s, 0, &error));
    TEST_ASSERT_EQUAL_STRING("stroke: BEAT: 1.05 is 0.025 s from another stroke of the left hand, "
                             "expected 0.04 s or more",
                             error.text);
    s.hand = HIMC_RIGHT;
    TEST_ASSERT_TRUE(himc_planner_add(planner, &s, 0, &error));
    TEST_ASSERT_FALSE(himc_planner_add(planner, &s, 99, &error));
}

static void test_stroke_added_while_playing_is_played(void)
{
    himc_stroke s;
    int drum;
    double touch;
    add(planner, 20, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    himc_planner_advance(planner, 3);
    add(planner, 8, HIMC_LEFT, HIMC_ACCENT, 0.5);
    TEST_ASSERT_TRUE(himc_planner_current(planner, HIMC_LEFT, 3, &s, &drum, &touch));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4, touch);
    himc_planner_advance(planner, 3.9);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, at(planner, HIMC_LEFT, 4).x.z);
}

static void test_state_is_continuous_through_every_command(void)
{
    srand(3);
    for (int i = 0; i < 60; i++)
        add(planner, 1 + i * 0.5, HIMC_LEFT, (himc_nuance)(i % 5), i % 8 / 7.0);
    for (int k = 0; k < 400; k++) {
        double t = k * 0.037;
        himc_target before = at(planner, HIMC_LEFT, t);
        switch (rand() % 6) {
        case 0: himc_planner_tempo(planner, t, 40 + rand() % 160); break;
        case 1: himc_planner_stop(planner, t); break;
        case 2: himc_planner_play(planner, t); break;
        case 3: himc_planner_seek(planner, t, rand() % 30); break;
        case 4:
            himc_planner_hit(planner, t, &(himc_stroke){.hand = HIMC_LEFT, .dynamic = 0.5}, 1);
            break;
        default: himc_planner_reach(planner, t, HIMC_LEFT, himc_vec3_make(0.5, 0.2, 1.1));
        }
        same_state(before, himc_planner_target(planner, HIMC_LEFT, t));
    }
}

/// Many random commands; returns a digest of the motion.
static double storm(unsigned seed, int commands)
{
    double digest = 0, t = 0;
    srand(seed);
    use(120);
    for (int k = 0; k < commands; k++) {
        himc_stroke s = {.beat = rand() % 400 / 4.0,
                         .hand = (himc_hand)(rand() % 2),
                         .nuance = (himc_nuance)(rand() % 5),
                         .dynamic = rand() % 8 / 7.0,
                         .spot = (himc_spot)(rand() % 3)};
        himc_target m = himc_planner_target(planner, s.hand, t);
        m.v.z = rand() % 9;
        m.a.z = rand() % 2000 - 1000;
        switch (rand() % 11) {
        case 0: himc_planner_tempo(planner, t, 1 + rand() % 1000); break;
        case 1: himc_planner_stop(planner, t); break;
        case 2:
        case 3: himc_planner_play(planner, t); break;
        case 4: himc_planner_seek(planner, t, rand() % 100); break;
        case 5: himc_planner_hit(planner, t, &s, rand() % 3); break;
        case 6:
            himc_planner_reach(planner, t, s.hand, himc_vec3_make(rand() % 7 * 0.1, 0.3, 1.1));
            break;
        case 7: himc_planner_separated(planner, s.hand, t, &m); break;
        case 8:
            himc_planner_set_drum(
                planner, 0,
                &(himc_head_frame){.center = {0.7, 0, 0.8 + rand() % 9 * 0.01}, .radius = 0.3});
            break;
        case 9:
            if (rand() % 40 == 0)
                himc_planner_clear(planner);
            break;
        default: himc_planner_add(planner, &s, rand() % 2, &error);
        }
        t += rand() % 50 * 1e-3;
        himc_planner_advance(planner, t);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_target x = himc_planner_target(planner, (himc_hand)hand, t);
            TEST_ASSERT_TRUE(himc_vec3_finite(x.x) && himc_vec3_finite(x.v) &&
                             himc_vec3_finite(x.a));
            TEST_ASSERT_TRUE(himc_vec3_length(x.x) < 3);
            digest = digest * 0.99 + x.x.x + 2 * x.x.z + x.v.y;
        }
    }
    return digest;
}

static void test_tip_thrown_off_a_head_stops_within_15_cm(void)
{
    for (double speed = 1; speed <= 16; speed *= 2) {
        himc_target off = {{0.45, 0.1, PLANE}, {-speed, 0, 1}, {0, 0, 0}};
        himc_planner_separated(planner, HIMC_LEFT, 1, &off);
        for (double t = 1; t < 3; t += 0.004) {
            himc_vec3 x = at(planner, HIMC_LEFT, t).x;
            TEST_ASSERT_TRUE(x.x > 0.45 - 0.15 - 0.02 * speed - 0.01);
        }
        TEST_ASSERT_TRUE(himc_vec3_length(at(planner, HIMC_LEFT, 3).v) < 0.5);
        use(120);
    }
}

static void test_motion_stays_finite_and_near_through_ten_thousand_random_commands(void)
{
    storm(1, 10000);
}

static void test_the_same_commands_give_the_same_bits(void)
{
    double a = storm(9, 2000), b = storm(9, 2000);
    TEST_ASSERT_EQUAL_MEMORY(&a, &b, sizeof a);
}

static void test_values_that_are_not_finite_change_nothing(void)
{
    himc_target bad = {{NAN, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    himc_target before = at(planner, HIMC_LEFT, 1);
    himc_planner_separated(planner, HIMC_LEFT, 1, &bad);
    himc_planner_reach(planner, 1, HIMC_LEFT, bad.x);
    himc_planner_tempo(planner, 1, NAN);
    himc_planner_seek(planner, 1, NAN);
    TEST_ASSERT_FALSE(himc_planner_set_drum(
        planner, 0, &(himc_head_frame){.center = {NAN, 0, 0}, .radius = 0.3}));
    same_state(before, himc_planner_target(planner, HIMC_LEFT, 1));
}

/// A planner of one drum with `strokes` of alternating hands, of a player whose left arm, or both,
/// is as short as a finger.
static void use_reach(bool right_too, int strokes)
{
    himc_planner_config config = with_body();
    for (int i = HIMC_LEFT_FOREARM; i <= HIMC_RIGHT_HAND; i += right_too ? 1 : 2) {
        himc_vec3 *joint = &body.posture.skeleton.segment[i].origin;
        *joint = himc_vec3_scale(*joint, 0.1);
    }
    himc_planner_free(planner);
    planner = himc_planner_new(&config, &error);
    TEST_ASSERT_NOT_NULL(planner);
    for (int i = 0; i < strokes; i++)
        add(planner, 2 + i, (himc_hand)(i & 1), HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
}

static void test_strokes_that_no_hand_reaches_are_given_up_once_each(void)
{
    himc_planner_note note;
    int notes = 0;
    use_reach(true, 40);
    for (double t = 0; t < himc_planner_end(planner); t += 0.01) {
        himc_planner_advance(planner, t);
        while (himc_planner_note_next(planner, &note) && notes++ == 0)
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(note.text, "given up, out of reach by 0.14 m"),
                                         note.text);
    }
    TEST_ASSERT_EQUAL_INT(40, himc_planner_given_up(planner));
    himc_planner_finish(planner);
    while (himc_planner_note_next(planner, &note))
        notes++;
    TEST_ASSERT_EQUAL_STRING("in all 0 strokes softer, 0 by the other hand, 40 given up",
                             note.text);
    TEST_ASSERT_TRUE(notes > 8 && notes <= 41);
    himc_planner_miss miss;
    for (int i = 0; i < 40; i++)
        TEST_ASSERT_TRUE(himc_planner_miss_next(planner, &miss) && !miss.hit);
    TEST_ASSERT_FALSE(himc_planner_miss_next(planner, &miss));
}

static void test_strokes_out_of_one_hands_reach_are_all_played_by_the_other(void)
{
    int played = 0;
    double last = -1;
    use_reach(false, 40);
    for (double t = 0; t < himc_planner_end(planner); t += 0.01) {
        himc_stroke s;
        int drum;
        double touch;
        himc_planner_advance(planner, t);
        TEST_ASSERT_TRUE(at(planner, HIMC_LEFT, t).x.z > PLANE + 0.01);
        if (himc_planner_current(planner, HIMC_RIGHT, t, &s, &drum, &touch) && touch > last &&
            t > touch - 0.01) {
            last = touch;
            played++;
        }
    }
    TEST_ASSERT_EQUAL_INT(40, played);
    TEST_ASSERT_EQUAL_INT(0, himc_planner_given_up(planner));
}

static void test_nothing_is_allocated_while_playing(void)
{
    for (int i = 0; i < 200; i++)
        add(planner, i * 0.25, (himc_hand)(i & 1), (himc_nuance)(i % 5), 0.6);
    himc_stroke s = {.hand = HIMC_LEFT, .dynamic = 0.5};
    himc_planner_note note;
    watch_allocations();
    himc_planner_play(planner, 0);
    for (int k = 0; k < 5000; k++) {
        double t = k * 0.004;
        himc_planner_advance(planner, t);
        himc_target x = himc_planner_target(planner, HIMC_LEFT, t);
        if (k % 100 == 0)
            himc_planner_separated(planner, HIMC_LEFT, t, &x);
        if (k % 70 == 0)
            himc_planner_hit(planner, t, &s, 0);
        if (k % 300 == 0)
            himc_planner_tempo(planner, t, 60 + k % 100);
        if (k % 900 == 0)
            himc_planner_seek(planner, t, 3);
        if (k % 1000 == 999)
            himc_planner_stop(planner, t), himc_planner_play(planner, t);
        himc_planner_note_next(planner, &note);
    }
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
}

static void test_a_score_has_room_behind_another_up_to_200000_strokes_of_a_hand(void)
{
    himc_stroke more[] = {{.hand = HIMC_LEFT},
                          {.hand = HIMC_LEFT, .ornament = HIMC_ROLL_SINGLE},
                          {.hand = HIMC_RIGHT},
                          {.hand = HIMC_LEFT}};
    for (int i = 0; i < 199999; i++)
        add(planner, i, HIMC_LEFT, HIMC_LEGATO, 0.5);
    TEST_ASSERT_TRUE(himc_planner_has_room(planner, more, 3, &error));
    TEST_ASSERT_FALSE(himc_planner_has_room(planner, more, 4, &error));
    TEST_ASSERT_EQUAL_STRING("stroke: one too many, expected 200000 for a hand", error.text);
}

static void test_a_hit_without_a_time_or_a_drum_is_refused_and_changes_nothing(void)
{
    himc_stroke s = {.hand = HIMC_RIGHT, .dynamic = 0.5};
    const himc_hit bad[] = {{&s, 0, NAN, false},
                            {&s, 0, INFINITY, false},
                            {&s, -1, 2, false},
                            {&s, HIMC_DRUMS, 2, false}};
    himc_target before = at(planner, HIMC_RIGHT, 1), after;
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_TRUE(himc_planner_hit_at(planner, 1, &bad[i]) == HUGE_VAL);
    TEST_ASSERT_TRUE(himc_planner_hit_at(planner, NAN, &(himc_hit){&s, 0, 2, false}) == HUGE_VAL);
    TEST_ASSERT_TRUE(himc_planner_hit(planner, NAN, &s, 0) == HUGE_VAL);
    TEST_ASSERT_TRUE(himc_planner_hit(planner, 1, &s, -1) == HUGE_VAL);
    TEST_ASSERT_TRUE(himc_planner_hit(planner, 1, &s, HIMC_DRUMS) == HUGE_VAL);
    after = at(planner, HIMC_RIGHT, 3);
    TEST_ASSERT_EQUAL_MEMORY(&before, &after, sizeof before);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_hit_without_a_time_or_a_drum_is_refused_and_changes_nothing);
    RUN_TEST(test_current_names_the_stroke_until_its_touch_is_over);
    RUN_TEST(test_play_waits_for_the_first_stroke_and_seek_says_how_late_it_is);
    RUN_TEST(test_fast_strokes_are_softer_and_one_note_says_so);
    RUN_TEST(test_32_notes_are_kept_and_lost_ones_are_counted);
    RUN_TEST(test_tempo_change_keeps_the_beat_and_moves_later_strokes);
    RUN_TEST(test_new_tempi_while_playing_keep_the_beat);
    RUN_TEST(test_tempi_out_of_order_or_none_are_refused);
    RUN_TEST(test_stop_brings_the_tip_to_rest_and_play_resumes);
    RUN_TEST(test_hit_comes_within_a_quarter_second_from_rest);
    RUN_TEST(test_a_hit_of_any_hand_is_played_by_the_one_above_its_spot);
    RUN_TEST(test_reach_arrives_and_stays);
    RUN_TEST(test_strokes_nearer_than_40_ms_or_on_no_drum_are_refused);
    RUN_TEST(test_stroke_added_while_playing_is_played);
    RUN_TEST(test_state_is_continuous_through_every_command);
    RUN_TEST(test_tip_thrown_off_a_head_stops_within_15_cm);
    RUN_TEST(test_motion_stays_finite_and_near_through_ten_thousand_random_commands);
    RUN_TEST(test_the_same_commands_give_the_same_bits);
    RUN_TEST(test_values_that_are_not_finite_change_nothing);
    RUN_TEST(test_strokes_that_no_hand_reaches_are_given_up_once_each);
    RUN_TEST(test_strokes_out_of_one_hands_reach_are_all_played_by_the_other);
    RUN_TEST(test_nothing_is_allocated_while_playing);
    RUN_TEST(test_a_score_has_room_behind_another_up_to_200000_strokes_of_a_hand);
    return UNITY_END();
}
