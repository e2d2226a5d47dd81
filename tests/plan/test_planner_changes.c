/// test_planner_changes.c: the score, the units and the hits of a planner change while it plays,
/// and each stroke is still played once, at its time, or given up and counted.
#include "planners.h"

#include "base/random.h"
#include "plan/hand.h"

#include <string.h>

static void advance_to(double t)
{
    for (double now = 0; now < t; now += 0.01)
        himc_planner_advance(planner, now);
    himc_planner_advance(planner, t);
}

// time of the touch that is next for a hand at t; -1 if there is none
static double touch_at(himc_hand hand, double t)
{
    himc_stroke s;
    int drum;
    double touch;
    return himc_planner_current(planner, hand, t, &s, &drum, &touch) ? touch : -1;
}

static void expect_note(const char *text)
{
    himc_planner_note note = {.text = ""};
    TEST_ASSERT_TRUE_MESSAGE(himc_planner_note_next(planner, &note), text);
    TEST_ASSERT_EQUAL_STRING(text, note.text);
}

// largest height of a tip over the plane of touches in a time
static double highest(himc_hand hand, double from, double to)
{
    double high = 0;
    for (double t = from; t < to; t += 0.002)
        high = fmax(high, at(planner, hand, t).x.z - PLANE);
    return high;
}

static himc_unit unit_of(double height, int grip, himc_spot spot, double speed)
{
    return (himc_unit){.nuance = HIMC_LEGATO,
                       .hand = HIMC_LEFT,
                       .spot = spot,
                       .grip = grip,
                       .height = height,
                       .speed = speed,
                       .down = 2 * height / speed,
                       .lift = 0.3,
                       .rebound = 0.5,
                       .pull = 2};
}

// height of a legato stroke that may choose among these units
static double height_with(const himc_unit *units, int count, int grip)
{
    use(120);
    TEST_ASSERT_TRUE(himc_planner_add_units(planner, units, count, &error));
    himc_planner_set_grip(planner, grip);
    add(planner, 4, HIMC_LEFT, HIMC_LEGATO, 5.0 / 7);
    himc_planner_play(planner, 0);
    return highest(HIMC_LEFT, 1.4, 2);
}

static void test_unit_of_the_grip_then_of_the_spot_then_of_the_speed_is_played(void)
{
    double f = himc_gesture_of(HIMC_LEGATO, 5.0 / 7).speed;
    himc_unit grips[] = {unit_of(0.2, 0, HIMC_SPOT_XY, f), unit_of(0.4, 1, HIMC_SPOT_XY, f)};
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, height_with(grips, 2, 0));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.4, height_with(grips, 2, 1));
    himc_unit spots[] = {unit_of(0.2, 0, HIMC_SPOT_RIM, f),
                         unit_of(0.4, 0, HIMC_SPOT_NORMAL, 0.9 * f)};
    TEST_ASSERT_TRUE(height_with(spots, 2, 0) > 0.35);
    himc_unit speeds[] = {unit_of(0.2, 0, HIMC_SPOT_XY, 0.5 * f),
                          unit_of(0.4, 0, HIMC_SPOT_XY, 1.1 * f)};
    TEST_ASSERT_TRUE(height_with(speeds, 2, 0) > 0.3);
    himc_unit strange[] = {unit_of(0.2, 0, HIMC_SPOT_XY, 0.8 * f), unit_of(0.4, 0, HIMC_SPOT_XY, f),
                           unit_of(0.4, 0, HIMC_SPOT_XY, f)};
    strange[1].hand = HIMC_RIGHT; // whatever else fits
    strange[2].nuance = HIMC_STACCATO;
    TEST_ASSERT_TRUE(height_with(strange, 3, 0) < 0.35);
    himc_unit other[] = {unit_of(0.2, 0, HIMC_SPOT_RIM, f), unit_of(0.4, 1, HIMC_SPOT_XY, f)};
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, height_with(other, 2, 0)); // the grip goes first
}

static void test_hits_at_once_are_played_one_after_the_other(void)
{
    himc_stroke s = {
        .hand = HIMC_LEFT, .nuance = HIMC_LEGATO, .dynamic = 4 / 7.0, .spot = HIMC_SPOT_NORMAL};
    double last = 0;
    himc_planner_advance(planner, 1);
    for (int i = 0; i < 4; i++) {
        double touch = himc_planner_hit(planner, 1, &s, 0);
        TEST_ASSERT_TRUE(touch > last + 0.12 && touch < last + (i ? 0.13 : 2));
        last = touch;
    }
}

static void test_stroke_added_before_the_present_beat_is_given_up_once(void)
{
    add(planner, 4.5, HIMC_LEFT, HIMC_LEGATO, 0.5);
    add(planner, 6, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    advance_to(1.95);
    add(planner, 3.2, HIMC_LEFT, HIMC_LEGATO, 0.5);
    expect_note("stroke at beat 3.2 left: given up, that beat is past");
    TEST_ASSERT_EQUAL_INT(1, himc_planner_given_up(planner));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2.25, touch_at(HIMC_LEFT, 1.95));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, at(planner, HIMC_LEFT, 2.25).x.z);
}

static void test_stroke_added_before_a_committed_one_does_not_repeat_it(void)
{
    add(planner, 4, HIMC_LEFT, HIMC_LEGATO, 0.5);
    add(planner, 20, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    advance_to(1.95);
    add(planner, 1, HIMC_LEFT, HIMC_LEGATO, 0.5);
    for (double t = 1.95; t < 3; t += 0.01)
        himc_planner_advance(planner, t);
    TEST_ASSERT_EQUAL_INT(1, himc_planner_given_up(planner));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 10, touch_at(HIMC_LEFT, 3));
}

static void test_new_score_is_played_after_a_stroke_of_the_old_one_came_early(void)
{
    for (int i = 1; i <= 4; i++)
        add(planner, i, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    advance_to(1.95);
    himc_planner_clear(planner);
    add(planner, 2, HIMC_LEFT, HIMC_ACCENT, 0.5);
    himc_planner_play(planner, 1.95);
    himc_target here = himc_planner_target(planner, HIMC_LEFT, 1.96);
    himc_planner_separated(planner, HIMC_LEFT, 1.96, &here);
    himc_planner_advance(planner, 2.3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2.95, touch_at(HIMC_LEFT, 2.4));
}

// four strokes in a loop of 2 s; the tempo is set again, as it is, at that time of the third round
static void check_round(double at)
{
    use(120);
    for (int i = 0; i < 4; i++)
        add(planner, i + 0.5, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_loop(planner, 0, true);
    himc_planner_play(planner, 0);
    double late = first_touch(HIMC_LEFT) - 0.25;
    advance_to(at + late);
    himc_planner_tempo(planner, at + late, 120);
    for (double t = at; t < at + 1.8; t += 0.01) {
        himc_planner_advance(planner, t + late);
        double touch = touch_at(HIMC_LEFT, t + late) - late;
        TEST_ASSERT_DOUBLE_WITHIN(0.31, t + 0.25, touch);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, fmod(touch, 0.5));
    }
}

static void test_tempo_in_a_later_round_of_a_loop_keeps_every_stroke(void)
{
    check_round(5.1); // before the next stroke can no longer be changed ...
    check_round(5.2); // ... and after
}

// times of the touches of a hand between two times, as they are planned
static int touches(himc_hand hand, double from, double to, double time[], int most)
{
    int count = 0;
    for (double t = from; t < to; t += 0.01) {
        himc_planner_advance(planner, t);
        double touch = touch_at(hand, t);
        if (touch > 0 && touch - t < 0.02 && count < most &&
            (count == 0 || touch > time[count - 1] + 0.05))
            time[count++] = touch;
    }
    return count;
}

static void test_new_strokes_in_a_loop_that_was_cleared_while_it_turns_are_played_on_its_beats(void)
{
    double first[2], time[16];
    for (int i = 0; i < 4; i++)
        add(planner, i, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_loop(planner, 0, true);
    himc_planner_play(planner, 0);
    TEST_ASSERT_EQUAL_INT(1, touches(HIMC_LEFT, 0, 1.2, first, 1));
    advance_to(3.1);
    himc_planner_clear(planner);
    double turning = himc_planner_beat(planner, 3.2), later = himc_planner_beat(planner, 3.7);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, later - turning);
    TEST_ASSERT_EQUAL_DOUBLE(HUGE_VAL, himc_planner_end(planner));
    TEST_ASSERT_EQUAL_INT(0, touches(HIMC_LEFT, 3.3, 5, time, 16));
    add(planner, 1, HIMC_LEFT, HIMC_TENUTO, 0.5);
    add(planner, 0, HIMC_LEFT, HIMC_TENUTO, 0.5);
    add(planner, 2.5, HIMC_RIGHT, HIMC_TENUTO, 0.5);
    int count = touches(HIMC_LEFT, 5, 9.6, time, 16);
    TEST_ASSERT_TRUE(count >= 4);
    TEST_ASSERT_TRUE(time[0] < 6.6);
    for (int i = 0; i < count; i++) { // beats 0 and 1 of three, on the old beats
        double beats = (time[i] - first[0]) / 0.5;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, round(beats), beats);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, i % 2 ? 0.5 : 1, i ? time[i] - time[i - 1] : 1);
    }
    TEST_ASSERT_EQUAL_INT(0, himc_planner_given_up(planner));
}

static void test_a_stroke_added_to_a_loop_that_turns_sounds_in_its_next_round(void)
{
    double time[4];
    add(planner, 0, HIMC_LEFT, HIMC_LEGATO, 0.5);
    add(planner, 3, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_loop(planner, 0, true);
    himc_planner_play(planner, 0);
    touches(HIMC_LEFT, 0, 1.2, time, 1);
    double begun = time[0];
    advance_to(begun + 1);
    add(planner, 1, HIMC_RIGHT, HIMC_LEGATO, 0.5); // past in this round
    TEST_ASSERT_EQUAL_INT(2, touches(HIMC_RIGHT, begun + 1, begun + 6, time, 4));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, begun + 2.5, time[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, begun + 4.5, time[1]);
}

static void test_play_stop_and_loop_0_end_the_turning_of_an_empty_loop(void)
{
    for (int i = 0; i < 3; i++) {
        use(120);
        add(planner, 1, HIMC_LEFT, HIMC_LEGATO, 0.5);
        himc_planner_loop(planner, 0, true);
        himc_planner_play(planner, 0);
        advance_to(2);
        himc_planner_clear(planner);
        advance_to(2.5);
        if (i == 0) {
            himc_planner_stop(planner, 2.5);
            TEST_ASSERT_TRUE(himc_planner_beat(planner, 3) < 0);
        } else if (i == 1) {
            himc_planner_loop(planner, 2.5, false);
            TEST_ASSERT_TRUE(himc_planner_end(planner) < 3);
        } else {
            add(planner, 4, HIMC_LEFT, HIMC_LEGATO, 0.5);
            himc_planner_play(planner, 2.53);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.53, touch_at(HIMC_LEFT, 2.53));
        }
    }
}

static void test_a_roll_goes_from_its_first_dynamic_to_its_last_at_any_tempi(void)
{
    static const double bpm[] = {60, 200, 30, 90};
    himc_stroke roll = {.beat = 1,
                        .length = 6,
                        .ornament = HIMC_ROLL_SINGLE,
                        .dynamic = 0.2,
                        .last_dynamic = 0.8,
                        .spot = HIMC_SPOT_NORMAL};
    double last[HIMC_HANDS] = {-1, -1}, louder[HIMC_HANDS] = {0.2, 0.2}, all = 0;
    int strokes = 0;
    TEST_ASSERT_EQUAL_INT(0, himc_planner_add_roll(planner, &roll, 0, 11, &error));
    himc_planner_play(planner, 0);
    for (double t = 0; t < fmin(himc_planner_end(planner), 60); t += 0.01) {
        himc_planner_advance(planner, t);
        if (fmod(t, 0.7) < 0.01 && t > 1)
            himc_planner_tempo(planner, t + 0.03, bpm[(int)(t / 0.7) % 4]);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_stroke s;
            int drum;
            double touch;
            if (!himc_planner_current(planner, (himc_hand)hand, t, &s, &drum, &touch) ||
                touch > t || touch < last[hand] + 0.05)
                continue;
            // one that was committed may be a moment ahead of a slower beat
            TEST_ASSERT_TRUE(s.dynamic >= louder[hand] - 0.01);
            last[hand] = touch;
            louder[hand] = all = s.dynamic;
            strokes++;
        }
    }
    TEST_ASSERT_TRUE(strokes > 20);
    TEST_ASSERT_EQUAL_INT(0, himc_planner_given_up(planner));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.8, fmax(all, louder[HIMC_LEFT]));
}

static void test_tempi_of_a_score_that_follows_count_from_its_beginning(void)
{
    static const himc_tempo_change next[] = {{0, 60}, {2, 240}};
    static const double beat[] = {1, 3, 5, 7}, touch[] = {0.5, 1.5, 3, 4.25};
    TEST_ASSERT_TRUE(himc_planner_append_tempi(planner, next, 2, 4, &error));
    for (int i = 0; i < 4; i++)
        add(planner, beat[i], HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    for (int i = 0; i < 4; i++) {
        double before = touch[i] - 0.1;
        himc_planner_advance(planner, before);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, touch[i], touch_at(HIMC_LEFT, before));
    }
}

static void test_stroke_beyond_the_rim_is_struck_just_inside_it_and_a_note_says_so(void)
{
    himc_stroke s = {.beat = 2, .hand = HIMC_LEFT, .dynamic = 0.5, .spot = HIMC_SPOT_XY, .y = 0.4};
    TEST_ASSERT_TRUE(himc_planner_add(planner, &s, 0, &error));
    himc_planner_play(planner, 0);
    himc_vec3 x = at(planner, HIMC_LEFT, 1).x;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, x.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.75, x.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.97 * 0.3, x.y);
    expect_note("0 0.4 is beyond the rim: struck at 0 0.291");
}

static void test_play_past_the_end_begins_at_beat_0(void)
{
    add(planner, 4, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_seek(planner, 0, 10);
    himc_planner_play(planner, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3, touch_at(HIMC_LEFT, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, himc_planner_beat(planner, 1.5));
}

static void test_seek_to_the_beat_of_a_stroke_plays_it(void)
{
    add(planner, 4, HIMC_LEFT, HIMC_LEGATO, 0.5);
    add(planner, 8, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_seek(planner, 0, 4);
    himc_planner_play(planner, 1);
    himc_stroke s;
    int drum;
    double touch;
    TEST_ASSERT_TRUE(himc_planner_current(planner, HIMC_LEFT, 1, &s, &drum, &touch));
    TEST_ASSERT_EQUAL_DOUBLE(4, s.beat);
    TEST_ASSERT_TRUE(touch < 1.8);
}

static void test_strokes_that_make_a_waiting_hand_rest_elsewhere_are_not_exchanged(void)
{
    static const int drum[] = {1, 0};
    add(planner, 40, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    advance_to(3);
    for (int i = 0; i < 2; i++) {
        himc_planner *fresh = make(120);
        himc_stroke s = {.beat = 40, .dynamic = 0.3, .nuance = HIMC_LEGATO, .hand = HIMC_LEFT};
        TEST_ASSERT_TRUE(himc_planner_add(fresh, &s, drum[i], &error));
        TEST_ASSERT_EQUAL(drum[i] == 0, himc_planner_exchange(planner, fresh));
        himc_planner_free(fresh);
    }
}

#define PIECE 40 // strokes

static double uniform(uint64_t *state, double from, double to)
{
    return from + (to - from) * himc_random_uniform(state);
}

static void random_piece(uint64_t *state, himc_stroke *strokes)
{
    for (int i = 0; i < PIECE; i++)
        strokes[i] = (himc_stroke){.beat = (i > 0 ? strokes[i - 1].beat : 0) +
                                           0.01 * floor(uniform(state, 8, i % 9 ? 40 : 400)),
                                   .hand = i % 2 ? HIMC_LEFT : HIMC_RIGHT,
                                   .nuance = (himc_nuance)uniform(state, 0, HIMC_NUANCES),
                                   .dynamic = uniform(state, 0, 1),
                                   .spot = HIMC_SPOT_NORMAL};
}

// one thing about a stroke
static void edit(uint64_t *state, himc_stroke *s, int what)
{
    if (what == 0)
        s->beat += uniform(state, -0.03, 0.03);
    else if (what == 1)
        s->spot = HIMC_SPOT_RIM;
    else if (what == 2)
        s->nuance = (himc_nuance)((s->nuance + 1) % HIMC_NUANCES);
    else
        s->dynamic = uniform(state, 0, 1);
}

static himc_planner *of_piece(const himc_stroke *strokes)
{
    himc_planner *p = make(60);
    for (int i = 0; i < PIECE; i++)
        TEST_ASSERT_TRUE_MESSAGE(himc_planner_add(p, &strokes[i], 0, &error), error.text);
    return p;
}

// the tips bounce where the plan touches
static void play_on(himc_planner *p, double t)
{
    himc_planner_advance(p, t);
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        himc_target now = himc_planner_target(p, hand, t);
        himc_stroke s;
        int drum;
        double touch;
        if (himc_planner_current(p, hand, t, &s, &drum, &touch) && touch <= t && touch > t - 0.01) {
            now.v.z = 0.3 * fabs(now.v.z);
            himc_planner_separated(p, hand, t, &now);
        }
    }
}

static int exchanged(uint64_t *state, bool human)
{
    himc_stroke strokes[PIECE];
    himc_human player = {.amount = human ? 0.5 : 0, .seed = 3};
    random_piece(state, strokes);
    himc_planner_free(planner);
    planner = of_piece(strokes);
    int which = (int)uniform(state, 1, PIECE - 1), what = (int)uniform(state, 0, 6);
    double from = strokes[which].beat - uniform(state, 0.2, 1.6);
    edit(state, &strokes[which], what);
    himc_planner *fresh = of_piece(strokes), *other = of_piece(strokes);
    himc_planner_set_human(planner, player);
    himc_planner_set_human(fresh, player);
    himc_planner_play(planner, 0);
    himc_planner_play(fresh, 0);
    bool done = false;
    for (int k = 0; k < 100 * (strokes[PIECE - 1].beat + 1); k++) {
        double t = 0.01 * k;
        if (!done && t >= from && !(done = himc_planner_exchange(planner, other)))
            break;
        play_on(planner, t);
        play_on(fresh, t);
        for (int i = 0; i < HIMC_HANDS && done; i++) {
            himc_target own = himc_planner_target(planner, (himc_hand)i, t),
                        its = himc_planner_target(fresh, (himc_hand)i, t);
            TEST_ASSERT_EQUAL_MEMORY(&its, &own, sizeof own);
        }
    }
    himc_planner_free(fresh);
    himc_planner_free(other);
    return done;
}

static void test_exchanged_strokes_are_played_as_if_they_had_been_there_from_the_start(void)
{
    uint64_t state = 7;
    int count = 0;
    for (int i = 0; i < 1000; i++)
        count += exchanged(&state, i % 2);
    TEST_ASSERT_GREATER_THAN(100, count);
}

static void test_a_stroke_can_be_exchanged_in_strength_until_it_is_planned(void)
{
    himc_planner *other = make(60);
    use(60);
    for (int i = 0; i < 8; i++) {
        add(planner, i, HIMC_LEFT, HIMC_LEGATO, 0.5);
        add(other, i, HIMC_LEFT, HIMC_LEGATO, i == 4 ? 0.9 : 0.5);
    }
    himc_planner_play(planner, 0);
    advance_to(2.4); // the stroke at 3 s is planned, half a second ahead
    TEST_ASSERT_EQUAL_DOUBLE(4, himc_planner_rests_to(planner, HIMC_LEFT));
    TEST_ASSERT_TRUE(himc_planner_exchange(planner, other));
    himc_planner_free(other);
}

// a plan that no body could follow is dropped in one line, with its strokes; the next one is played
static void test_a_plan_faster_than_a_body_is_dropped_and_the_hand_rests(void)
{
    himc_target state;
    add(planner, 1, HIMC_LEFT, HIMC_LEGATO, 0.7);
    add(planner, 4, HIMC_LEFT, HIMC_LEGATO, 0.7);
    himc_planner_play(planner, 0);
    advance_to(0.3);
    state = himc_planner_target(planner, HIMC_LEFT, 0.3);
    state.v.x = 1e3;
    himc_planner_resume(planner, 0.3, HIMC_LEFT, &state);
    for (double t = 0.3; t < 1; t += 0.002) {
        himc_target s = at(planner, HIMC_LEFT, t);
        TEST_ASSERT_TRUE(himc_target_finite(&s) && himc_vec3_length(s.v) <= HIMC_FASTEST_TIP);
    }
    expect_note("left hand: a motion that no body could make was dropped at 0.300 s");
    double second = touch_at(HIMC_LEFT, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2, second);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, PLANE, at(planner, HIMC_LEFT, second).x.z);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_exchanged_strokes_are_played_as_if_they_had_been_there_from_the_start);
    RUN_TEST(test_a_stroke_can_be_exchanged_in_strength_until_it_is_planned);
    RUN_TEST(test_strokes_that_make_a_waiting_hand_rest_elsewhere_are_not_exchanged);
    RUN_TEST(test_unit_of_the_grip_then_of_the_spot_then_of_the_speed_is_played);
    RUN_TEST(test_hits_at_once_are_played_one_after_the_other);
    RUN_TEST(test_stroke_added_before_the_present_beat_is_given_up_once);
    RUN_TEST(test_stroke_added_before_a_committed_one_does_not_repeat_it);
    RUN_TEST(test_new_score_is_played_after_a_stroke_of_the_old_one_came_early);
    RUN_TEST(test_tempo_in_a_later_round_of_a_loop_keeps_every_stroke);
    RUN_TEST(test_new_strokes_in_a_loop_that_was_cleared_while_it_turns_are_played_on_its_beats);
    RUN_TEST(test_a_stroke_added_to_a_loop_that_turns_sounds_in_its_next_round);
    RUN_TEST(test_play_stop_and_loop_0_end_the_turning_of_an_empty_loop);
    RUN_TEST(test_a_roll_goes_from_its_first_dynamic_to_its_last_at_any_tempi);
    RUN_TEST(test_tempi_of_a_score_that_follows_count_from_its_beginning);
    RUN_TEST(test_stroke_beyond_the_rim_is_struck_just_inside_it_and_a_note_says_so);
    RUN_TEST(test_play_past_the_end_begins_at_beat_0);
    RUN_TEST(test_seek_to_the_beat_of_a_stroke_plays_it);
    RUN_TEST(test_a_plan_faster_than_a_body_is_dropped_and_the_hand_rests);
    return UNITY_END();
}
