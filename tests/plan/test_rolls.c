/// test_rolls.c: a roll has a rate that no tempo changes; it ends on its beat, hand by hand.
/// Its dynamics are tested in test_planner_changes.c.
#include "session.h"

#include <math.h>

static int by_time(const void *a, const void *b)
{
    const himc_strike *s = a, *r = b;
    return (s->time > r->time) - (s->time < r->time);
}

static himc_performance *with_kettle(double tempo)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_drum(p, 0, "tune A2");
    session_do(p, "tempo %g", tempo);
    return p;
}

static void sort(heard *h)
{
    qsort(h->strike, (size_t)h->strikes, sizeof *h->strike, by_time);
}

typedef struct intervals {
    double least, most, mean; ///< of planned times (s)
} intervals;

/// Of the strikes from one to before another one; hands take turns.
static intervals intervals_of(const heard *h, int from, int to)
{
    intervals i = {HUGE_VAL, 0, 0};
    TEST_ASSERT_TRUE(to - from > 3);
    for (int k = from + 1; k < to; k++) {
        double gap = h->strike[k].planned_time - h->strike[k - 1].planned_time;
        TEST_ASSERT_TRUE(h->strike[k].hand != h->strike[k - 1].hand);
        i.least = fmin(i.least, gap);
        i.most = fmax(i.most, gap);
        i.mean += gap / (to - from - 1);
    }
    return i;
}

/// Interval of a roll at a constant tempo.
static double usual_interval(const char *kind, double tempo)
{
    heard h = {0};
    himc_performance *p = with_kettle(tempo);
    session_do(p, "roll 1 4 %s mf", kind);
    session_do(p, "play");
    session_play(p, 5.5 * 60 / tempo + 1, &h);
    sort(&h);
    int n = 0; // without the bounces
    for (int i = 0; i < h.strikes; i++)
        if (isfinite(h.strike[i].planned_time))
            h.strike[n++] = h.strike[i];
    double mean = intervals_of(&h, 0, n).mean;
    heard_free(&h);
    himc_performance_free(p);
    return mean;
}

/// Strokes a second of a single roll.
static double single_rate(double inches, const char *pitch, const char *dynamic)
{
    heard h = {0};
    char tune[20];
    himc_performance *p = session_new();
    session_do(p, "drum kettle %g", inches);
    snprintf(tune, sizeof tune, "tune %s", pitch);
    session_drum(p, 0, tune);
    session_do(p, "roll 1 6 single %s", dynamic);
    session_do(p, "play");
    session_play(p, 6, &h);
    sort(&h);
    double rate = 1 / intervals_of(&h, 0, h.strikes).mean;
    heard_free(&h);
    himc_performance_free(p);
    return rate;
}

static void test_a_single_roll_is_faster_on_a_higher_drum_and_when_loud(void)
{
    static const char *const pitch[] = {"C2", "A2", "A3"}, *const dynamic[] = {"ppp", "mf", "f"};
    static const double inches[] = {32, 26, 23};
    double rate[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            rate[i][k] = single_rate(inches[i], pitch[i], dynamic[k]);
            printf("%s %s: %.1f/s\n", pitch[i], dynamic[k], rate[i][k]);
            TEST_ASSERT_TRUE(i == 0 || rate[i][k] > 1.1 * rate[i - 1][k]);
            TEST_ASSERT_TRUE(k == 0 || rate[i][k] > 1.03 * rate[i][k - 1]);
        }
    TEST_ASSERT_DOUBLE_WITHIN(1.2, 8, rate[0][0]); // as practised: 7 to 9, 11 to 14
    TEST_ASSERT_DOUBLE_WITHIN(1.2, 8, rate[0][2]);
    TEST_ASSERT_DOUBLE_WITHIN(1.7, 12.5, rate[2][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1.7, 12.5, rate[2][2]);
}

static void test_rate_of_a_roll_does_not_depend_on_the_tempo(void)
{
    static const char *const kind[] = {"single", "double", "press"};
    for (int i = 0; i < 3; i++) {
        double slow = usual_interval(kind[i], 50), fast = usual_interval(kind[i], 140);
        printf("%s: %.1f and %.1f ms\n", kind[i], 1e3 * slow, 1e3 * fast);
        TEST_ASSERT_DOUBLE_WITHIN(0.06 * slow, slow, fast);
    }
}

/// Tempi in turn while a roll of six beats plays, and a stroke after it.
static void play_through(const double *tempo, int count, double each, const char *drive, heard *h)
{
    himc_performance *p = with_kettle(60);
    session_do(p, "roll 1 6 single p ff");
    session_do(p, "stroke 7 right accent f");
    session_do(p, "%s", drive);
    session_do(p, "play");
    session_play(p, 2, h);
    for (int i = 0; i < count; i++) {
        session_do(p, "tempo %g", tempo[i]);
        session_play(p, each, h);
    }
    session_play(p, 8, h);
    sort(h);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(0, s.missed);
    himc_performance_free(p);
}

static void check_roll(const heard *h, int strikes, double rate)
{
    intervals i = intervals_of(h, 0, strikes);
    printf("%d strokes, %.1f .. %.1f ms\n", strikes, 1e3 * i.least, 1e3 * i.most);
    TEST_ASSERT_DOUBLE_WITHIN(0.25 / rate, 1 / rate, i.least);
    TEST_ASSERT_DOUBLE_WITHIN(0.25 / rate, 1 / rate, i.most);
}

static void test_intervals_of_a_roll_stay_when_the_tempo_changes_in_it(void)
{
    static const double steps[] = {120, 40}, walk[] = {5, 300, 17, 600, 60};
    heard a = {0}, b = {0}, c = {0};
    double rate = 0;
    play_through(steps, 0, 0, "loop 0", &a);
    rate = 1 / intervals_of(&a, 0, a.strikes - 1).mean;
    play_through(steps, 2, 1.2, "loop 0", &b);
    play_through(walk, 5, 0.4, "loop 0", &c);
    check_roll(&b, b.strikes - 1, rate);
    check_roll(&c, c.strikes - 1, rate);
    const heard *all[] = {&a, &b, &c};
    for (int i = 0; i < 3; i++) {
        const himc_strike *last = &all[i]->strike[all[i]->strikes - 2], *next = last + 1;
        // the end is where the next stroke is
        TEST_ASSERT_DOUBLE_WITHIN(0.55 / rate, 1 / rate, next->planned_time - last->planned_time);
        TEST_ASSERT_EQUAL_DOUBLE(7, next->beat);
    }
    heard_free(&a);
    heard_free(&b);
    heard_free(&c);
}

// a slider: 40 to 200 and back in steps of 10 ms
static void test_a_slider_of_the_tempo_leaves_a_roll_even(void)
{
    double tempo[100];
    heard h = {0}, plain = {0};
    for (int i = 0; i < 100; i++)
        tempo[i] = 120 + 80 * sin(i * 2 * HIMC_PI / 50);
    play_through(tempo, 0, 0, "loop 0", &plain);
    play_through(tempo, 100, 0.01, "loop 0", &h);
    check_roll(&h, h.strikes - 1, 1 / intervals_of(&plain, 0, plain.strikes - 1).mean);
    heard_free(&h);
    heard_free(&plain);
}

// the roll of each round has all its strokes at the rate, and the loop keeps its beats
static void test_rounds_of_a_loop_whose_tempo_changed_in_a_roll_are_whole_rolls(void)
{
    heard h = {0};
    himc_performance *p = with_kettle(100);
    session_do(p, "roll 0 2 single mf");
    session_do(p, "stroke 2 right accent f");
    session_do(p, "stroke 3 left accent f");
    session_do(p, "loop 1");
    session_do(p, "play");
    session_play(p, 1.3, NULL);
    session_do(p, "tempo 60");
    session_play(p, 14, &h);
    sort(&h);
    int rolls = 0, accents = 0, from = 0;
    for (int i = 0; i < h.strikes; i++) {
        if (strcmp(h.strike[i].nuance, "accent") != 0)
            continue;
        if (h.strike[i].hand == HIMC_RIGHT && i - from > 5 && accents > 1) {
            intervals own = intervals_of(&h, from, i);
            TEST_ASSERT_DOUBLE_WITHIN(0.13 * own.mean, own.mean, own.most); // as a player's
            TEST_ASSERT_DOUBLE_WITHIN(0.13 * own.mean, own.mean, own.least);
            TEST_ASSERT_DOUBLE_WITHIN(0.01, 2,
                                      h.strike[i].planned_time - h.strike[from].planned_time);
            TEST_ASSERT_EQUAL_INT(0, (i - from) % 2);
            rolls++;
        }
        accents++;
        from = i + 1;
    }
    TEST_ASSERT_TRUE(rolls >= 2);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
    heard_free(&h);
    himc_performance_free(p);
}

// a hand that has just struck another drum, or is about to, leaves the beginning to the other one
static void test_a_roll_begins_on_its_beat_with_the_hand_that_is_free(void)
{
    static const char *const hands[] = {"left", "right"};
    for (int k = 0; k < 4; k++) {
        int busy = k % 2, first = -1;
        heard h = {0};
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        session_do(p, "drum far");
        session_do(p, "tempo 60");
        session_drum(p, 0, busy ? "place 0.7 0.4 0.85 0" : "place 0.7 -0.4 0.85 0");
        session_drum(p, 1, busy ? "place 0.7 -0.4 0.85 0" : "place 0.7 0.4 0.85 0");
        session_do(p, "stroke %g %s legato mf normal far", k < 2 ? 1.88 : 2.12, hands[busy]);
        session_do(p, "roll 2 1 single mf mf normal kettle");
        session_do(p, "play");
        session_play(p, 4, &h);
        sort(&h);
        for (int i = h.strikes - 1; i >= 0; i--)
            first = strcmp(h.strike[i].drum, "kettle") == 0 ? i : first;
        TEST_ASSERT_TRUE(first >= 0 && h.strikes > 4);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2, h.strike[first].beat);
        TEST_ASSERT_EQUAL_INT(1 - busy, h.strike[first].hand);
        TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
        heard_free(&h);
        himc_performance_free(p);
    }
}

static void test_play_from_within_a_roll_plays_the_rest_of_it(void)
{
    heard h = {0}, all = {0};
    for (int i = 0; i < 2; i++) {
        himc_performance *p = with_kettle(60);
        session_do(p, "roll 0 4 single mf");
        session_do(p, "seek %d", i ? 2 : 0);
        session_do(p, "play");
        session_play(p, 5, i ? &h : &all);
        himc_performance_free(p);
    }
    sort(&h);
    sort(&all);
    int first = 0;
    while (all.strike[first].beat < 2)
        first++;
    TEST_ASSERT_EQUAL_INT(all.strikes - first, h.strikes);
    for (int i = 0; i < h.strikes; i++) {
        TEST_ASSERT_EQUAL_INT(all.strike[first + i].hand, h.strike[i].hand);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, all.strike[first + i].beat, h.strike[i].beat);
    }
    heard_free(&h);
    heard_free(&all);
}

static void
test_a_roll_added_while_its_beats_play_is_played_from_there_and_a_past_one_is_missed(void)
{
    heard h = {0};
    himc_performance *p = with_kettle(60);
    himc_event event;
    session_do(p, "stroke 8 left legato mf");
    session_do(p, "play");
    session_play(p, 3.5, NULL);
    session_do(p, "roll 2 3 single mf");
    session_do(p, "roll 1 0.5 single mf");
    int missed = 0;
    for (int i = 0; i < 400; i++) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event)) {
            heard_event(&h, &event);
            missed += event.kind == HIMC_EVENT_MISSED && event.strike.beat == 1;
        }
    }
    TEST_ASSERT_EQUAL_INT(1, missed);
    TEST_ASSERT_TRUE(h.strikes > 8 && h.strikes < 30);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_single_roll_is_faster_on_a_higher_drum_and_when_loud);
    RUN_TEST(test_rate_of_a_roll_does_not_depend_on_the_tempo);
    RUN_TEST(test_intervals_of_a_roll_stay_when_the_tempo_changes_in_it);
    RUN_TEST(test_a_slider_of_the_tempo_leaves_a_roll_even);
    RUN_TEST(test_rounds_of_a_loop_whose_tempo_changed_in_a_roll_are_whole_rolls);
    RUN_TEST(test_a_roll_begins_on_its_beat_with_the_hand_that_is_free);
    RUN_TEST(test_play_from_within_a_roll_plays_the_rest_of_it);
    RUN_TEST(test_a_roll_added_while_its_beats_play_is_played_from_there_and_a_past_one_is_missed);
    return UNITY_END();
}
