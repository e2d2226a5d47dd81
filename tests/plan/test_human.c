/// test_human.c: a player's variation, at the planner: its statistics, that it is repeatable from
/// the seed, and that no stroke becomes impossible by it.
#include "plan/gesture.h"
#include "plan/planner_state.h"
#include "planners.h"

#include <stdlib.h>
#include <string.h>

#define MOST 4000
#define STEP 0.005 // (s)

/// A touch as planned.
typedef struct touch {
    double beat, time; ///< (s)
    himc_hand hand;
    double x, y, speed; ///< on the head (m), of impact (m/s)
} touch;

static touch played[MOST];
static int count;

/// Takes the touches in (t, t + STEP].
static void take_touches(double t, himc_hand hand)
{
    himc_stroke s;
    int drum;
    double time;
    if (!himc_planner_current(planner, hand, t, &s, &drum, &time) || time <= t || time > t + STEP)
        return;
    double radius = drum ? 0.33 : 0.3;
    touch now = {.beat = s.beat, .time = time, .hand = hand};
    himc_stroke_spot(&s, radius, &now.x, &now.y);
    now.speed = himc_vec3_length(himc_planner_target(planner, hand, time).v);
    TEST_ASSERT_TRUE(count < MOST);
    played[count++] = now;
}

/// Plays from `from` to `to` (s) and keeps all touches.
static void play_on(double from, double to)
{
    for (long i = lround(from / STEP); i < lround(to / STEP); i++) {
        himc_planner_advance(planner, (double)i * STEP);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            take_touches((double)i * STEP, (himc_hand)hand);
    }
}

/// `strokes` equal strokes, a beat apart, by one hand or by both in turn.
static void play_equal(double amount, uint32_t seed, int strokes, double interval, bool both)
{
    use(60 / interval);
    count = 0;
    himc_planner_set_human(planner, (himc_human){amount, seed});
    for (int i = 0; i < strokes; i++)
        add(planner, i + 8, both && i % 2 ? HIMC_LEFT : HIMC_RIGHT, HIMC_LEGATO, 0.4);
    himc_planner_play(planner, 0);
    play_on(0, (strokes + 9) * interval);
    TEST_ASSERT_EQUAL_INT(strokes, count);
}

/// How late a touch is (s).
static double late(const touch *s, double interval)
{
    return s->time - s->beat * interval;
}

/// Mean, standard deviation and lag-1 correlation of a series.
typedef struct series {
    double mean, sd, lag;
} series;

static series series_of(const double *x, int n)
{
    series s = {0};
    double squares = 0, neighbours = 0;
    for (int i = 0; i < n; i++)
        s.mean += x[i] / n;
    for (int i = 0; i < n; i++) {
        squares += (x[i] - s.mean) * (x[i] - s.mean);
        neighbours += i ? (x[i] - s.mean) * (x[i - 1] - s.mean) : 0;
    }
    s.sd = sqrt(squares / n);
    s.lag = neighbours / squares;
    return s;
}

/// Of the intervals between the touches, without the hands' own biases.
static series intervals(double interval)
{
    double x[MOST], bias[HIMC_HANDS] = {0}, n[HIMC_HANDS] = {0};
    for (int i = 0; i < count; i++) {
        bias[played[i].hand] += late(&played[i], interval);
        n[played[i].hand]++;
    }
    for (int i = 0; i + 1 < count; i++) {
        himc_hand a = played[i].hand, b = played[i + 1].hand;
        x[i] = played[i + 1].time - bias[b] / n[b] - played[i].time + bias[a] / n[a];
    }
    return series_of(x, count - 1);
}

static void check_intervals(bool both)
{
    double lag = 0;
    for (uint32_t seed = 0; seed < 4; seed++) {
        play_equal(1, seed, 1000, 0.25, both);
        series s = intervals(0.25);
        printf("human 1, seed %u: intervals %.2f ms SD, lag 1 %.3f\n", (unsigned)seed, 1e3 * s.sd,
               s.lag);
        TEST_ASSERT_TRUE(s.sd > 0.007 && s.sd < 0.010);
        lag += s.lag / 4;
    }
    TEST_ASSERT_TRUE(lag > -0.3 && lag < -0.1);
}

static void test_intervals_of_one_hand_scatter_and_are_anticorrelated_as_players_are(void)
{
    check_intervals(false);
}

static void test_intervals_of_alternating_hands_do_too(void)
{
    check_intervals(true);
}

static void test_player_stays_with_the_written_tempo(void)
{
    double x[MOST];
    play_equal(1, 3, 1000, 0.25, true);
    for (int i = 0; i < count; i++) {
        x[i] = late(&played[i], 0.25);
        TEST_ASSERT_TRUE(fabs(x[i]) < 0.07);
    }
    series all = series_of(x, count), last = series_of(x + 800, 200);
    TEST_ASSERT_TRUE(fabs(all.mean) < 0.008 && fabs(last.mean) < 0.02);
    TEST_ASSERT_TRUE(all.sd > 0.008 && all.sd < 0.02); // about a metronome, experts: 10 to 15 ms
}

static void test_places_scatter_about_each_hands_own_point(void)
{
    double out[MOST], aside[MOST];
    himc_stroke s = {.hand = HIMC_RIGHT, .spot = HIMC_SPOT_NORMAL};
    double x, y;
    himc_stroke_spot(&s, 0.3, &x, &y);
    double r = hypot(x, y);
    play_equal(1, 5, 1000, 0.5, false);
    for (int i = 0; i < count; i++) {
        double dx = played[i].x - x, dy = played[i].y - y;
        out[i] = (dx * x + dy * y) / r;
        aside[i] = (dy * x - dx * y) / r;
    }
    series o = series_of(out, count), a = series_of(aside, count);
    TEST_ASSERT_DOUBLE_WITHIN(0.0008, 0.009, o.sd);
    TEST_ASSERT_DOUBLE_WITHIN(0.0006, 0.006, a.sd);
    TEST_ASSERT_DOUBLE_WITHIN(0.0012, 0.015, hypot(o.mean, a.mean));
}

static void test_speeds_scatter_as_log_normal(void)
{
    double x[MOST];
    double written = himc_gesture_of(HIMC_LEGATO, 0.4).speed;
    play_equal(1, 6, 1000, 1, false);
    for (int i = 0; i < count; i++)
        x[i] = log(played[i].speed / written);
    series s = series_of(x, count);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.089, s.sd); // .08 white and .04 drift
    TEST_ASSERT_TRUE(fabs(s.mean) < 0.02);
}

static void test_half_the_amount_scatters_half_as_much(void)
{
    play_equal(1, 9, 300, 0.5, false);
    double whole = intervals(0.5).sd;
    play_equal(0.5, 9, 300, 0.5, false);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * whole, intervals(0.5).sd);
}

static void test_equal_seeds_give_equal_bits_and_others_do_not(void)
{
    static touch first[MOST];
    play_equal(1, 11, 60, 0.3, true);
    memcpy(first, played, sizeof first);
    play_equal(1, 11, 60, 0.3, true);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_TRUE(first[i].time == played[i].time && first[i].x == played[i].x &&
                         first[i].y == played[i].y && first[i].speed == played[i].speed);
    play_equal(1, 12, 60, 0.3, true);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_TRUE(first[i].time != played[i].time && first[i].x != played[i].x);
}

static void test_amount_0_plays_as_written(void)
{
    double written = himc_gesture_of(HIMC_LEGATO, 0.4).speed;
    play_equal(0, 11, 20, 1, true);
    for (int i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(played[i].beat, played[i].time);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, written, played[i].speed);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, played[i].hand == HIMC_LEFT ? 0.015 : -0.015, played[i].y);
    }
}

// whether a piece is played from the start, from its middle or with its tempo set again and again
static void test_a_stroke_varies_the_same_from_wherever_play_began(void)
{
    static touch first[MOST];
    play_equal(1, 4, 60, 0.4, true);
    memcpy(first, played, sizeof first);
    count = 0;
    himc_planner_seek(planner, 28, 38);
    double t0 = 28 - himc_planner_beat(planner, 28) * 0.4, begun = 28;
    for (double t = 28; t < 45; t += 0.1) {
        himc_planner_tempo(planner, t, 150);
        play_on(t, t + 0.1);
    }
    t0 = played[0].time - first[30].time;
    TEST_ASSERT_TRUE(begun < played[0].time && count == 30);
    for (int i = 0; i < count; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, first[30 + i].time, played[i].time - t0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, first[30 + i].x, played[i].x);
    }
}

static void test_rounds_of_a_loop_differ_and_a_tempo_change_does_not_repeat_them(void)
{
    use(120);
    count = 0;
    himc_planner_set_human(planner, (himc_human){1, 2});
    for (int i = 0; i < 4; i++)
        add(planner, i, HIMC_LEFT, HIMC_LEGATO, 0.5);
    himc_planner_loop(planner, 0, true);
    himc_planner_play(planner, 0);
    play_on(0, 11);
    himc_planner_tempo(planner, 11, 110);
    play_on(11, 22);
    TEST_ASSERT_TRUE(count > 36);
    for (int i = 4; i < count; i++)
        for (int k = i - 4; k >= 0; k -= 4)
            TEST_ASSERT_TRUE(played[i].x != played[k].x);
}

static void test_hits_vary_and_never_come_early(void)
{
    himc_stroke s = {
        .hand = HIMC_LEFT, .nuance = HIMC_LEGATO, .dynamic = 0.4, .spot = HIMC_SPOT_NORMAL};
    double x[2], time[2];
    for (int run = 0; run < 2; run++) {
        use(120);
        himc_planner_set_human(planner, (himc_human){run, 3});
        himc_planner_advance(planner, 1);
        time[run] = himc_planner_hit(planner, 1, &s, 0);
        count = 0;
        play_on(1, 3);
        TEST_ASSERT_EQUAL_INT(1, count);
        TEST_ASSERT_EQUAL_DOUBLE(time[run], played[0].time);
        x[run] = played[0].x;
    }
    TEST_ASSERT_TRUE(time[1] > time[0] && time[1] <= time[0] + 0.012 && x[0] != x[1]);
}

static void test_hands_that_strike_together_do_not_come_nearer(void)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        use(60);
        count = 0;
        himc_planner_set_human(planner, (himc_human){1, seed});
        for (int i = 2; i < 12; i++) {
            add(planner, i, HIMC_LEFT, HIMC_LEGATO, 0.5);
            add(planner, i + (i % 2 ? 0.03 : 0), HIMC_RIGHT, HIMC_LEGATO, 0.5);
        }
        himc_planner_play(planner, 0);
        play_on(0, 13);
        TEST_ASSERT_EQUAL_INT(20, count);
        for (int i = 0; i < count; i++)
            TEST_ASSERT_TRUE(played[i].hand == HIMC_LEFT ? played[i].y >= 0.015 - 1e-12
                                                         : played[i].y <= -0.015 + 1e-12);
    }
}

/// A piece of random strokes on two drums, fast ones too; strokes given up.
static int play_random(double amount, unsigned seed)
{
    use(100);
    count = 0;
    srand(seed);
    himc_planner_set_human(planner, (himc_human){amount, seed});
    double beat[HIMC_HANDS] = {2, 2};
    for (int i = 0; i < 60; i++) {
        himc_hand hand = (himc_hand)(rand() % 2);
        himc_stroke s = {.hand = hand,
                         .nuance = (himc_nuance)(rand() % HIMC_NUANCES),
                         .dynamic = rand() % 8 / 7.0,
                         .spot = (himc_spot)(rand() % 3)};
        s.beat = beat[hand] += (rand() % 4 ? 0.3 : 0.07) + rand() % 100 / 300.0;
        TEST_ASSERT_TRUE_MESSAGE(himc_planner_add(planner, &s, rand() % 3 == 0, &error),
                                 error.text);
    }
    himc_planner_play(planner, 0);
    play_on(0, 25);
    return himc_planner_given_up(planner);
}

static void test_no_stroke_becomes_impossible(void)
{
    int written = 0;
    for (unsigned seed = 1; seed <= 60; seed++) {
        int given_up = play_random(0, seed);
        written += given_up;
        TEST_ASSERT_TRUE(play_random(1, seed) <= given_up);
        for (int i = 0; i < count; i++)
            TEST_ASSERT_TRUE(hypot(played[i].x, played[i].y) < 0.33);
    }
    printf("%d of 3600 strokes given up as written\n", written);
}

static void test_no_stroke_moves_by_more_than_a_fifth_of_its_hands_gap(void)
{
    const double gap = 0.16, most = 0.2 * gap;
    double largest = 0;
    play_equal(1, 3, 600, gap / 2, true);
    for (int i = 0; i < count; i++)
        largest = fmax(largest, fabs(late(&played[i], gap / 2)));
    printf("moved by at most %.2f ms\n", 1e3 * largest);
    TEST_ASSERT_TRUE(largest <= most + 1e-9 && largest > 0.999 * most);
}

/// Leaves bytes behind that no variable should be made of.
static void soil_stack(void)
{
    volatile unsigned char bytes[8192];
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = 60;
}

/// A change of tempo moves the strokes of a roll, those that are planned already too; another score
/// has other strokes. So the score may lack a stroke that is planned.
static void test_a_planned_stroke_varies_the_same_when_the_score_has_lost_it(void)
{
    const himc_human human = {1, 7};
    use(60);
    add(planner, 5, HIMC_RIGHT, HIMC_LEGATO, 0.4);
    himc_variation kept = himc_human_stroke(&human, &planner->score, HIMC_RIGHT, 0, 5);
    use(60);
    soil_stack();
    himc_variation lost = himc_human_stroke(&human, &planner->score, HIMC_RIGHT, 0, 5);
    TEST_ASSERT_EQUAL_DOUBLE(kept.late, lost.late);
    TEST_ASSERT_EQUAL_DOUBLE(kept.log_speed, lost.log_speed);
    TEST_ASSERT_EQUAL_DOUBLE(kept.outwards, lost.outwards);
    TEST_ASSERT_FALSE(lost.together);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_intervals_of_one_hand_scatter_and_are_anticorrelated_as_players_are);
    RUN_TEST(test_intervals_of_alternating_hands_do_too);
    RUN_TEST(test_player_stays_with_the_written_tempo);
    RUN_TEST(test_places_scatter_about_each_hands_own_point);
    RUN_TEST(test_speeds_scatter_as_log_normal);
    RUN_TEST(test_half_the_amount_scatters_half_as_much);
    RUN_TEST(test_equal_seeds_give_equal_bits_and_others_do_not);
    RUN_TEST(test_amount_0_plays_as_written);
    RUN_TEST(test_a_stroke_varies_the_same_from_wherever_play_began);
    RUN_TEST(test_rounds_of_a_loop_differ_and_a_tempo_change_does_not_repeat_them);
    RUN_TEST(test_hits_vary_and_never_come_early);
    RUN_TEST(test_hands_that_strike_together_do_not_come_nearer);
    RUN_TEST(test_no_stroke_becomes_impossible);
    RUN_TEST(test_no_stroke_moves_by_more_than_a_fifth_of_its_hands_gap);
    RUN_TEST(test_a_planned_stroke_varies_the_same_when_the_score_has_lost_it);
    return UNITY_END();
}
