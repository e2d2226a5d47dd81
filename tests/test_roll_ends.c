/// test_roll_ends.c: a roll is joined to what follows it: another drum, grace notes, an accent, at
/// any tempo; what is given up is told.
#include "session.h"

#include <math.h>

// two timpani side by side
#define NEIGHBOURS "drum a 29", "drum b 26", "a place 0.832 0.287 0.85", "b place 0.763 -0.439 0.85"

static int by_time(const void *a, const void *b)
{
    const himc_strike *s = a, *r = b;
    return (s->time > r->time) - (s->time < r->time);
}

/// All strokes of that score, in the order of time, without bounces.
static heard play(himc_performance *p, double seconds, const char *const *lines)
{
    heard h = {0};
    for (int i = 0; lines[i]; i++)
        session_do(p, "%s", lines[i]);
    session_do(p, "play");
    session_play(p, seconds, &h);
    return h;
}

static void keep_asked(heard *h)
{
    int n = 0;
    qsort(h->strike, (size_t)h->strikes, sizeof *h->strike, by_time);
    for (int i = 0; i < h->strikes; i++)
        if (isfinite(h->strike[i].planned_time))
            h->strike[n++] = h->strike[i];
    h->strikes = n;
}

static heard play_new(double seconds, const char *const *lines)
{
    himc_performance *p = session_new();
    heard h = play(p, seconds, lines);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
    keep_asked(&h);
    himc_performance_free(p);
    return h;
}

/// The longest time between two strokes of both hands, from the first to the last.
static double longest_gap(const heard *h)
{
    double most = 0;
    for (int i = 1; i < h->strikes; i++)
        most = fmax(most, h->strike[i].planned_time - h->strike[i - 1].planned_time);
    return most;
}

static const himc_strike *last_of(const heard *h)
{
    return &h->strike[h->strikes - 1];
}

// hands need 0.18 s from drum to drum, and have 0.17 s from stroke to stroke
static void test_a_roll_that_goes_to_another_drum_and_back_has_all_its_strokes(void)
{
    static const char *const kind[] = {"single", "double", "press"};
    static const char *const loud[] = {"p", "mf", "ff"};
    for (int k = 0; k < 9; k++) {
        char a[64], b[64], c[64], d[64];
        snprintf(a, sizeof a, "roll 1 1 %s %s a", kind[k % 3], loud[k / 3]);
        snprintf(b, sizeof b, "roll 2 1 %s %s b", kind[k % 3], loud[k / 3]);
        snprintf(c, sizeof c, "roll 3 1 %s %s a", kind[k % 3], loud[k / 3]);
        snprintf(d, sizeof d, "stroke 4 %s legato f b", k % 2 ? "left" : "right");
        const char *there[] = {"drum a 29", "drum b 26", "tempo 60", a, b, c, d, NULL};
        const char *stays[] = {"drum a 29", "tempo 60", "roll 1 3 single mf",
                               "stroke 4 right legato f", NULL};
        heard h = play_new(6, there), plain = play_new(6, stays);
        printf("%s %s: %d strokes, gaps up to %.0f ms\n", kind[k % 3], loud[k / 3], h.strikes,
               1e3 * longest_gap(&h));
        if (k % 3 == 0) {
            TEST_ASSERT_INT_WITHIN(4, plain.strikes, h.strikes);
            TEST_ASSERT_TRUE(longest_gap(&h) < 1.6 * longest_gap(&plain));
        }
        heard_free(&h);
        heard_free(&plain);
    }
}

// a roll makes room for the grace notes of the stroke in which it ends, and goes on up to them
static void test_a_roll_ends_in_grace_notes_as_they_are_without_it(void)
{
    static const char *const kind[] = {"flam", "drag", "ruff"}, *const hand[] = {"left", "right"};
    for (int k = 0; k < 12; k++) {
        char end[64];
        snprintf(end, sizeof end, "%s 3 %s legato %s", kind[k % 3], hand[k / 3 % 2],
                 k < 6 ? "f" : "mp");
        const char *rolled[] = {"drum a 29", "tempo 60", "roll 1 2 single mf", end, NULL};
        const char *alone[] = {"drum a 29", "tempo 60", end, NULL};
        heard h = play_new(5, rolled), plain = play_new(5, alone);
        const himc_strike *own = last_of(&h), *grace = own - 1, *like = last_of(&plain);
        double rolls = h.strike[5].planned_time - h.strike[4].planned_time,
               before = grace->planned_time - grace[-1].planned_time;
        printf("%s: grace %.1f ms before, %.2f of the speed, after %.0f ms; main %.2f of %.2f\n",
               end, 1e3 * (own->planned_time - grace->planned_time),
               grace->velocity / own->velocity, 1e3 * before, own->velocity, like->velocity);
        TEST_ASSERT_EQUAL_INT(like[-1].hand, grace->hand);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, like->planned_time - like[-1].planned_time,
                                  own->planned_time - grace->planned_time);
        TEST_ASSERT_DOUBLE_WITHIN(1, 0, 20 * log10(grace->velocity / like[-1].velocity));
        TEST_ASSERT_DOUBLE_WITHIN(1, 0, 20 * log10(own->velocity / like->velocity));
        TEST_ASSERT_TRUE(before < 1.35 * rolls);
        heard_free(&h);
        heard_free(&plain);
    }
}

// both hands go to the other drum: one of them leads, the other one must not meet it
static void test_a_roll_leaves_an_ornament_on_the_next_drum_as_it_is_without_it(void)
{
    static const char *const kind[] = {"single", "double", "press"},
                             *const end[] = {"flam", "drag", "ruff"}, *const drum[] = {"a", "b"},
                             *const hand[] = {"left", "right"};
    for (int k = 0; k < 36; k++) {
        char roll[64], ornament[64];
        snprintf(roll, sizeof roll, "roll 1 1 %s mf normal %s", kind[k % 3], drum[k / 9 % 2]);
        snprintf(ornament, sizeof ornament, "%s 2 %s legato f normal %s", end[k / 3 % 3],
                 hand[k / 18], drum[1 - k / 9 % 2]);
        const char *rolled[] = {NEIGHBOURS, "tempo 60", roll, ornament, NULL};
        const char *alone[] = {NEIGHBOURS, "tempo 60", ornament, NULL};
        heard h = play_new(4, rolled), plain = play_new(4, alone);
        const himc_strike *own = last_of(&h), *like = last_of(&plain);
        printf("%s, %s: %.2f and %.2f m/s of %.2f and %.2f\n", roll, ornament, own[-1].velocity,
               own->velocity, like[-1].velocity, like->velocity);
        for (int i = -1; i <= 0; i++) {
            TEST_ASSERT_EQUAL_INT(like[i].hand, own[i].hand);
            TEST_ASSERT_EQUAL_STRING(like[i].drum, own[i].drum);
            TEST_ASSERT_DOUBLE_WITHIN(1, 0, 20 * log10(own[i].velocity / like[i].velocity));
        }
        heard_free(&h);
        heard_free(&plain);
    }
}

// a tempo that comes within a roll, at many moments of it
static void test_an_accent_after_a_roll_is_as_strong_when_the_tempo_has_changed_in_it(void)
{
    static const char *const kind[] = {"single", "double", "press"};
    for (int k = 0; k < 3; k++) {
        char roll[64];
        snprintf(roll, sizeof roll, "roll 1 5 %s mf", kind[k]);
        const char *lines[] = {"drum a 29", "tempo 60", roll, "stroke 6 right accent f", NULL};
        heard plain = play_new(8, lines);
        double least = HUGE_VAL;
        for (int i = 0; i < 12; i++) {
            himc_performance *p = session_new();
            heard h = play(p, 2.5 + 0.037 * i, lines);
            session_do(p, "tempo %d", 50 + 5 * i);
            session_play(p, 6, &h);
            keep_asked(&h);
            least = fmin(least, last_of(&h)->velocity);
            TEST_ASSERT_EQUAL_DOUBLE(6, last_of(&h)->beat);
            heard_free(&h);
            himc_performance_free(p);
        }
        printf("%s: %.2f m/s, after a change of tempo %.2f and more\n", kind[k],
               last_of(&plain)->velocity, least);
        TEST_ASSERT_TRUE(20 * log10(last_of(&plain)->velocity / least) < 0.5);
        heard_free(&plain);
    }
}

// two rolls at once: the left hand on the left drum, the right hand on the right one, in turn
static void test_two_rolls_at_once_on_two_drums_have_a_hand_each(void)
{
    static const char *const kind[] = {"single", "double", "press"};
    for (int k = 0; k < 6; k++) {
        char a[64], b[64];
        snprintf(a, sizeof a, "roll 1 2 %s p %c", kind[k % 3], k < 3 ? 'a' : 'b');
        snprintf(b, sizeof b, "roll 1 2 %s f %c", kind[k % 3], k < 3 ? 'b' : 'a');
        const char *two[] = {"drum a 29", "drum b 26", "tempo 60", a, b, "roll 3 1 single mf a",
                             NULL};
        heard h = play_new(5, two);
        int each[HIMC_HANDS] = {0};
        double speed[HIMC_HANDS] = {0};
        for (int i = 0; i < h.strikes && h.strike[i].beat < 3 - 1e-6; i++) {
            himc_hand hand = h.strike[i].hand;
            TEST_ASSERT_EQUAL_STRING(hand == HIMC_LEFT ? "a" : "b", h.strike[i].drum);
            each[hand]++;
            speed[hand] += h.strike[i].velocity;
        }
        double left = speed[HIMC_LEFT] / each[HIMC_LEFT],
               right = speed[HIMC_RIGHT] / each[HIMC_RIGHT];
        printf("%s: %d strokes of %.2f m/s, %d of %.2f\n", kind[k % 3], each[HIMC_LEFT], left,
               each[HIMC_RIGHT], right);
        TEST_ASSERT_INT_WITHIN(1, each[HIMC_LEFT], each[HIMC_RIGHT]);
        TEST_ASSERT_TRUE(each[HIMC_LEFT] >= 4);
        TEST_ASSERT_TRUE(k < 3 ? right > 1.5 * left : left > 1.5 * right);
        heard_free(&h);
    }
}

/// How many notes in the first second begin so.
static int notes_of(const char *const *lines, const char *begin)
{
    himc_performance *p = session_new();
    himc_event event;
    int notes = 0;
    for (int i = 0; lines[i]; i++)
        session_do(p, "%s", lines[i]);
    session_do(p, "play");
    himc_performance_process(p, 48000, NULL);
    while (himc_performance_event(p, &event))
        notes += event.kind == HIMC_EVENT_NOTE && strncmp(event.text, begin, strlen(begin)) == 0;
    himc_performance_free(p);
    return notes;
}

static void test_a_roll_that_loses_its_beats_to_another_one_is_named(void)
{
    static const char *const same[] = {"drum a 29", "tempo 60", "roll 1 2 single mf",
                                       "roll 1 2 double f", NULL},
                             *const partly[] = {"drum a 29",
                                                "drum b 26",
                                                "tempo 60",
                                                "roll 1 2 single mf a",
                                                "roll 2 2 single mf b",
                                                NULL},
                             *const after[] = {"drum a 29", "tempo 60", "roll 1 1 single mf",
                                               "roll 2 2 single mf", NULL};
    TEST_ASSERT_EQUAL_INT(1, notes_of(same, "roll at beat 1: given up, another one begins there"));
    TEST_ASSERT_EQUAL_INT(
        1, notes_of(partly, "roll at beat 1 on a: ends at beat 2, where another one"));
    TEST_ASSERT_EQUAL_INT(0, notes_of(after, "roll"));
}

static void test_notes_that_are_left_out_are_named_as_they_are_written(void)
{
    static const char *const near[] = {"drum a 29", "tempo 60", "stroke 1.96 left legato mf",
                                       "drag 2 right legato f", NULL},
                             *const within[] = {"drum a 29", "tempo 60",
                                                "stroke 2.04 left legato mf", "roll 1 3 single mf",
                                                NULL};
    TEST_ASSERT_EQUAL_INT(
        1, notes_of(near, "drag at beat 2 right a: no grace notes, the left hand has"));
    TEST_ASSERT_EQUAL_INT(1,
                          notes_of(within, "roll at beat 1: 1 of its strokes left out, too near"));
}

static double mean_speed(const heard *h, int from, int to)
{
    double sum = 0;
    for (int i = from; i < to; i++)
        sum += h->strike[i].velocity / (to - from);
    return sum;
}

// the last stroke of each hand has no other one after it, and was 3 dB louder
static void test_a_roll_is_even_to_its_end(void)
{
    static const char *const kind[] = {"single", "double", "press"}, *const loud[] = {"mf", "ff",
                                                                                      "fff"};
    for (int k = 0; k < 9; k++) {
        char roll[64];
        snprintf(roll, sizeof roll, "roll 1 3 %s %s", kind[k % 3], loud[k / 3]);
        const char *lines[] = {"drum a 29", "tempo 60", roll, NULL};
        heard h = play_new(6, lines);
        int n = h.strikes;
        double within = mean_speed(&h, 2, n - 2), last = mean_speed(&h, n - 2, n);
        printf("%s %s: %.2f m/s, the last ones %.2f\n", kind[k % 3], loud[k / 3], within, last);
        TEST_ASSERT_DOUBLE_WITHIN(0.5, 0, 20 * log10(last / within));
        heard_free(&h);
    }
}

/// Strokes of at most that share of a speed.
static int strokes_below(const heard *h, double speed)
{
    int n = 0;
    for (int i = 0; i < h->strikes; i++)
        n += h->strike[i].velocity < speed;
    return n;
}

// more than half a decibel softer; a contact differs by a hundredth from its plan
static void test_the_line_about_softer_strokes_counts_all_that_are(void)
{
    static const char *const kind[] = {"single", "double", "press"}, *const loud[] = {"mf", "f",
                                                                                      "ff", "fff"};
    for (int k = 0; k < 12; k++) {
        char roll[64], one[64];
        snprintf(roll, sizeof roll, "roll 1 3 %s %s", kind[k % 3], loud[k / 3]);
        snprintf(one, sizeof one, "stroke 2 right legato %s", loud[k / 3]);
        const char *lines[] = {"drum a 29", "tempo 60", roll, NULL},
                   *plain[] = {"drum a 29", "tempo 60", one, NULL};
        heard h = play_new(6, lines), alone = play_new(4, plain);
        double asked = last_of(&alone)->velocity, share = pow(10, -0.5 / 20);
        int said = 0;
        if (h.notes > 0)
            TEST_ASSERT_EQUAL_INT_MESSAGE(1, sscanf(h.note, "in all %d strokes softer", &said),
                                          h.note);
        int least = strokes_below(&h, 0.985 * share * asked),
            most = strokes_below(&h, 1.015 * share * asked);
        printf("%s %s: %d of %d strokes said to be softer, %d .. %d are\n", kind[k % 3],
               loud[k / 3], said, h.strikes, least, most);
        TEST_ASSERT_TRUE(said >= least && said <= most);
        heard_free(&h);
        heard_free(&alone);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_roll_that_goes_to_another_drum_and_back_has_all_its_strokes);
    RUN_TEST(test_a_roll_ends_in_grace_notes_as_they_are_without_it);
    RUN_TEST(test_a_roll_leaves_an_ornament_on_the_next_drum_as_it_is_without_it);
    RUN_TEST(test_an_accent_after_a_roll_is_as_strong_when_the_tempo_has_changed_in_it);
    RUN_TEST(test_two_rolls_at_once_on_two_drums_have_a_hand_each);
    RUN_TEST(test_a_roll_that_loses_its_beats_to_another_one_is_named);
    RUN_TEST(test_notes_that_are_left_out_are_named_as_they_are_written);
    RUN_TEST(test_a_roll_is_even_to_its_end);
    RUN_TEST(test_the_line_about_softer_strokes_counts_all_that_are);
    return UNITY_END();
}
