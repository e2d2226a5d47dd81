/// test_roll_ends.c: a roll is joined to what follows it: another drum, grace notes, an accent, at
/// any tempo; what is given up is told. Everyday some of the cases are played, with HIMC_LONG all.
#include "session.h"

#include <math.h>

// two timpani side by side
#define NEIGHBOURS "drum a 29", "drum b 26", "a place 0.832 0.287 0.85", "b place 0.763 -0.439 0.85"

/// From one case to the next: everyday some, so that each word of a case comes with others.
static int next(int everyday)
{
    return getenv("HIMC_LONG") ? 1 : everyday;
}

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

// from bar to bar as from drum to drum: the written hand plays the note, the roll ends before it
static void test_a_roll_on_a_bar_ends_early_enough_for_a_leap_to_another_bar(void)
{
    static const char *const leap[] = {"stroke 3 left legato mf C5 xylophone",
                                       "stroke 3 right legato mf C7 xylophone",
                                       "stroke 3 left legato mf G5 xylophone"};
    for (int k = 0; k < 3; k++) {
        heard h = play_new(4, (const char *[]){"setup xylophone", "tempo 120",
                                               "roll 1 2 single mf C6 xylophone", leap[k], NULL});
        TEST_ASSERT_GREATER_THAN(10, h.strikes);
        TEST_ASSERT_EQUAL_INT(k == 1 ? HIMC_RIGHT : HIMC_LEFT, last_of(&h)->hand);
        TEST_ASSERT_EQUAL_DOUBLE(3, last_of(&h)->beat);
        heard_free(&h);
    }
}

// hands need 0.18 s from drum to drum, and have 0.17 s from stroke to stroke
static void test_a_roll_that_goes_to_another_drum_and_back_has_all_its_strokes(void)
{
    static const char *const kind[] = {"single", "double", "press"};
    static const char *const loud[] = {"p", "mf", "ff"};
    const char *stays[] = {"drum a 29", "tempo 60", "roll 1 3 single mf", "stroke 4 right legato f",
                           NULL};
    heard plain = play_new(6, stays);
    for (int k = 0; k < 9; k += next(4)) {
        char a[64], b[64], c[64], d[64];
        snprintf(a, sizeof a, "roll 1 1 %s %s a", kind[k % 3], loud[k / 3]);
        snprintf(b, sizeof b, "roll 2 1 %s %s b", kind[k % 3], loud[k / 3]);
        snprintf(c, sizeof c, "roll 3 1 %s %s a", kind[k % 3], loud[k / 3]);
        snprintf(d, sizeof d, "stroke 4 %s legato f b", k % 2 ? "left" : "right");
        const char *there[] = {"drum a 29", "drum b 26", "tempo 60", a, b, c, d, NULL};
        heard h = play_new(6, there);
        printf("%s %s: %d strokes, gaps up to %.0f ms\n", kind[k % 3], loud[k / 3], h.strikes,
               1e3 * longest_gap(&h));
        if (k % 3 == 0) {
            TEST_ASSERT_INT_WITHIN(4, plain.strikes, h.strikes);
            TEST_ASSERT_TRUE(longest_gap(&h) < 1.6 * longest_gap(&plain));
        }
        heard_free(&h);
    }
    heard_free(&plain);
}

// a roll makes room for the grace notes of the stroke in which it ends, and goes on up to them
static void test_a_roll_ends_in_grace_notes_as_they_are_without_it(void)
{
    static const char *const kind[] = {"flam", "drag", "ruff"}, *const hand[] = {"left", "right"};
    for (int k = 0; k < 12; k += next(5)) {
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

// the hand with the grace notes has no time for a double before them
static void test_a_double_roll_is_even_up_to_a_drag(void)
{
    static const char *const end[] = {"drag", "ruff"}, *const hand[] = {"left", "right"};
    for (int k = 0; k < 4; k++) {
        char ornament[64];
        snprintf(ornament, sizeof ornament, "%s 2 %s legato f", end[k % 2], hand[k / 2]);
        const char *lines[] = {"drum a 26", "tempo 60", "roll 1 1 double mf", ornament, NULL};
        heard h = play_new(4, lines);
        const himc_strike *own = last_of(&h), *last = own - 2;
        printf("%s: the last double %.2f m/s, of %.2f\n", ornament, last->velocity,
               h.strike[2].velocity);
        TEST_ASSERT_TRUE(last->hand != own[-1].hand);
        TEST_ASSERT_DOUBLE_WITHIN(1, 0, 20 * log10(last->velocity / h.strike[2].velocity));
        heard_free(&h);
    }
}

// contacts and bounces are as near to each other up to the grace note
static void test_a_double_roll_leaves_no_hole_before_a_flam(void)
{
    static const char *const end[] = {"flam 2 left legato f", "flam 2 right legato f"};
    for (int k = 0; k < 2; k++) {
        const char *lines[] = {"drum a 26", "tempo 60", "roll 1 1 double mf", end[k], NULL};
        himc_performance *p = session_new();
        heard h = play(p, 4, lines);
        qsort(h.strike, (size_t)h.strikes, sizeof *h.strike, by_time);
        const himc_strike *main = last_of(&h);
        double most = 0, before = main[-1].time - main[-2].time;
        for (int i = 1; i < h.strikes - 2; i++)
            most = fmax(most, h.strike[i].time - h.strike[i - 1].time);
        printf("%s: intervals up to %.0f ms, then %.0f ms\n", end[k], 1e3 * most, 1e3 * before);
        TEST_ASSERT_TRUE(before < 1.35 * most);
        heard_free(&h);
        himc_performance_free(p);
    }
}

// both hands go to the other drum: one of them leads, the other one must not meet it
static void test_a_roll_leaves_an_ornament_on_the_next_drum_as_it_is_without_it(void)
{
    static const char *const kind[] = {"single", "double", "press"},
                             *const end[] = {"flam", "drag", "ruff"}, *const drum[] = {"a", "b"},
                             *const hand[] = {"left", "right"};
    for (int k = 0; k < 36; k += next(7)) {
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

// an accent on another drum just before the written end: the last strokes of the roll make room
static void test_an_accent_before_the_end_of_a_roll_is_played(void)
{
    static const char *const kind[] = {"single", "double", "press"};
    for (int k = 0; k < 3; k++) {
        char roll[64];
        snprintf(roll, sizeof roll, "roll 1 4 %s pp ff normal a", kind[k]);
        heard h = play_new(6, (const char *[]){NEIGHBOURS, "tempo 90", roll,
                                               "stroke 4.9 right legato fff normal b", NULL});
        const himc_strike *accented = NULL;
        for (int i = 0; i < h.strikes; i++)
            if (strcmp(h.strike[i].drum, "b") == 0)
                accented = &h.strike[i];
        printf("%s: %.2f m/s\n", roll, accented ? accented->velocity : 0);
        TEST_ASSERT_NOT_NULL(accented);
        TEST_ASSERT_TRUE(accented->velocity > 3);
        heard_free(&h);
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
        for (int i = 0; i < 12; i += next(7)) {
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

// a tempo so near a roll's end that few of its strokes are left to plan: they give way
static void test_a_stroke_after_a_roll_is_as_strong_when_the_tempo_changes_just_before_it(void)
{
    static const char *const hand[] = {"left", "right"};
    for (int k = 0; k < 12; k += next(5)) {
        char end[64];
        bool faster = k / 2 % 2;
        double before = faster ? 0.26 + 0.04 * (k / 4) : 0.18 + 0.03 * (k / 4);
        snprintf(end, sizeof end, "stroke 2 %s legato f", hand[k % 2]);
        const char *lines[] = {"drum a 29", "tempo 60", "roll 1 1 single mf", end, NULL};
        heard plain = play_new(4, lines);
        himc_performance *p = session_new();
        heard h = play(p, 2 - before, lines);
        session_do(p, "tempo %d", faster ? 90 : 45);
        session_play(p, 2, &h);
        TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
        keep_asked(&h);
        const himc_strike *own = last_of(&h), *like = last_of(&plain);
        printf("%s, tempo %d %.0f ms before: %.2f m/s of %.2f\n", end, faster ? 90 : 45,
               1e3 * before, own->velocity, like->velocity);
        TEST_ASSERT_EQUAL_DOUBLE(2, own->beat);
        TEST_ASSERT_EQUAL_INT(like->hand, own->hand);
        TEST_ASSERT_TRUE(own[-1].hand != own->hand);
        TEST_ASSERT_TRUE(20 * log10(like->velocity / own->velocity) < 0.5);
        heard_free(&h);
        heard_free(&plain);
        himc_performance_free(p);
    }
}

// the same tempo again, at any moment of a roll
static void test_a_tempo_that_is_already_so_changes_nothing(void)
{
    static const char *const kind[] = {"single", "double", "press"};
    for (int k = 0; k < 9; k += next(4)) {
        char roll[64];
        snprintf(roll, sizeof roll, "roll 1 1 %s p f", kind[k % 3]);
        const char *lines[] = {"drum a 29", "tempo 60", roll, "stroke 2 right accent f", NULL};
        heard plain = play_new(4, lines);
        himc_performance *p = session_new();
        heard h = play(p, 1.2 + 0.2 * (k / 3) + 0.21 * (k % 3), lines);
        session_do(p, "tempo 60");
        session_play(p, 2.8, &h);
        keep_asked(&h);
        TEST_ASSERT_EQUAL_INT(plain.strikes, h.strikes);
        for (int i = 0; i < h.strikes; i++) {
            const himc_strike *own = &h.strike[i], *like = &plain.strike[i];
            TEST_ASSERT_EQUAL_DOUBLE(like->planned_time, own->planned_time);
            TEST_ASSERT_DOUBLE_WITHIN(0.1, 0, 20 * log10(own->velocity / like->velocity));
        }
        heard_free(&h);
        heard_free(&plain);
        himc_performance_free(p);
    }
}

/// A line of a round: a command, its beat, and the rest.
typedef struct round_line {
    const char *command;
    double beat;
    const char *rest;
} round_line;

/// Strokes of rounds of four beats, looped or written one after the other.
static heard play_rounds(const round_line *line, int rounds, double seconds)
{
    himc_performance *p = session_new();
    heard h = {0};
    static const char *const begin[] = {NEIGHBOURS, "tempo 60"};
    for (int i = 0; i < 5; i++)
        session_do(p, "%s", begin[i]);
    for (int k = 0; k < rounds; k++)
        for (const round_line *l = line; l->command; l++)
            session_do(p, "%s %g %s", l->command, l->beat + 4 * k, l->rest);
    session_do(p, "loop %d", rounds == 1);
    session_do(p, "play");
    session_play(p, seconds, &h);
    keep_asked(&h);
    himc_performance_free(p);
    return h;
}

// a roll at a loop's end looks into the next round: its drum, its hand, its grace notes
static void test_a_looped_score_is_as_the_same_written_again_and_again(void)
{
    static const round_line piece[][5] = {
        {{"stroke", 0, "right legato f normal a"}, {"roll", 1, "3 single mf normal b"}},
        {{"stroke", 0, "left accent f normal b"}, {"roll", 1, "3 double f normal b"}},
        {{"flam", 0, "right legato f normal b"}, {"roll", 1, "3 single mf normal b"}},
        {{"flam", 0, "left legato f normal a"}, {"roll", 2, "2 press mf normal a"}},
        {{"drag", 0, "left legato f normal b"}, {"roll", 1, "3 double mf normal b"}},
        {{"roll", 0, "2 single mf normal a"}, {"roll", 2, "2 single p f normal b"}},
        {{"roll", 0, "2 press mf normal b"}, {"roll", 2, "2 single mf normal a"}},
        {{"roll", 0.5, "3.5 single mf normal b"}, {"stroke", 0, "right legato f normal b"}},
        {{"stroke", 0.5, "right legato f normal a"}, {"roll", 3.7, "0.3 single mf normal a"}},
        {{"roll", 0, "4 single p ff normal a"}},
    };
    for (int k = 0; k < (int)(sizeof piece / sizeof *piece); k += next(4)) {
        heard loop = play_rounds(piece[k], 1, 12.5), h = play_rounds(piece[k], 3, 12.5);
        double begin = h.strike[0].time, off = 0, far = 0;
        int n = 0;
        for (; n < h.strikes && h.strike[n].time < begin + 8.2; n++) {
            const himc_strike *own = &loop.strike[n], *like = &h.strike[n];
            TEST_ASSERT_TRUE(n < loop.strikes);
            TEST_ASSERT_EQUAL_INT(like->hand, own->hand);
            TEST_ASSERT_EQUAL_STRING(like->drum, own->drum);
            off = fmax(off, fabs(20 * log10(own->velocity / like->velocity)));
            far = fmax(far, fabs(own->planned_time - like->planned_time));
        }
        printf("loop %d: %d strokes, off by %.3f dB and %.2g s\n", k, n, off, far);
        TEST_ASSERT_TRUE(off < 0.3 && far < 1e-6);
        heard_free(&loop);
        heard_free(&h);
    }
}

/// Strokes of a roll at beat 1; and how fast the last one is, which may be a stroke at its end.
static int count_of_roll(const char *kind, double length, const char *end, double *speed)
{
    char roll[64], stroke[64];
    snprintf(roll, sizeof roll, "roll 1 %g %s mf", length, kind);
    snprintf(stroke, sizeof stroke, "stroke %g %s legato mf", 1 + length, end);
    const char *lines[] = {"drum a 29", "tempo 60", roll, end[0] ? stroke : NULL, NULL};
    heard h = play_new(1.6 + length, lines);
    int count = h.strikes - (end[0] != 0);
    *speed = last_of(&h)->velocity;
    heard_free(&h);
    return count;
}

// a few strokes, as many as the time has at the rate of a long roll, with or without an end
static void test_short_rolls_have_the_rate_of_long_ones(void)
{
    static const char *const kind[] = {"single", "double", "press"}, *const end[] = {"", "left",
                                                                                     "right"};
    for (int k = 0; k < 9; k += next(4)) {
        double speed, alone, rate = count_of_roll(kind[k / 3], 8, "", &alone) / 8.0;
        for (double length = 0.15; length < 0.5; length += 0.06 * next(2)) {
            int count = count_of_roll(kind[k / 3], length, end[k % 3], &speed);
            printf("%s %.2f s %s: %.2f strokes asked, %d, the end %.2f m/s of %.2f\n", kind[k / 3],
                   length, end[k % 3], rate * length, count, speed, alone);
            TEST_ASSERT_DOUBLE_WITHIN(0.6, rate * length, count);
            TEST_ASSERT_TRUE(20 * log10(alone / speed) < 1);
        }
    }
}

// the hand's last buzz gives way to it; what is still too strong for the time is told
static void test_an_accent_after_a_buzz_is_as_strong_as_alone_or_a_line_tells(void)
{
    static const char *const hand[] = {"left", "right"}, *const loud[] = {"mf", "ff"};
    static const char *const accent[] = {"legato f", "accent f", "accent fff",
                                         "vertical-accent fff"};
    for (int k = 0; k < 16; k += next(5)) {
        char roll[64], end[64], told[64];
        snprintf(roll, sizeof roll, "roll 1 1 press %s", loud[k / 2 % 2]);
        snprintf(end, sizeof end, "stroke 2 %s %s", hand[k % 2], accent[k / 4]);
        snprintf(told, sizeof told, "stroke at beat 2 %s a: too little time", hand[k % 2]);
        const char *lines[] = {"drum a 29", "tempo 60", roll, end, NULL},
                   *alone[] = {"drum a 29", "tempo 60", end, NULL};
        heard h = play_new(2.6, lines), plain = play_new(2.6, alone);
        double loss = 20 * log10(last_of(&plain)->velocity / last_of(&h)->velocity);
        printf("%s, %s: %.2f dB softer\n", roll, end, loss);
        TEST_ASSERT_TRUE(loss < 0.6 || strstr(h.all, told));
        TEST_ASSERT_TRUE(loss < 0.6 || k >= 8);
        heard_free(&h);
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

// the same on two bars of a marimba, and on one bar both
static void test_two_rolls_at_once_on_two_bars_have_a_hand_each(void)
{
    const char *two[] = {"instrument m marimba C4 C5",
                         "m place .45 0 .87",
                         "tempo 60",
                         "roll 1 2 single mf E4 m",
                         "roll 1 2 single mf C4 m",
                         "roll 3 1 single mf G4 m",
                         NULL};
    heard h = play_new(5, two);
    int each[2][HIMC_HANDS] = {0};
    double low = 0, high = 0;
    for (int i = 0; i < h.strikes; i++)
        each[h.strike[i].beat >= 3 - 1e-6][h.strike[i].hand]++;
    for (int i = 0; i < h.strikes && h.strike[i].beat < 3 - 1e-6; i++)
        *(h.strike[i].hand == HIMC_LEFT ? &low : &high) += h.strike[i].y;
    TEST_ASSERT_TRUE(each[0][HIMC_LEFT] >= 6 && each[1][HIMC_LEFT] >= 3);
    TEST_ASSERT_INT_WITHIN(1, each[0][HIMC_LEFT], each[0][HIMC_RIGHT]);
    TEST_ASSERT_INT_WITHIN(1, each[1][HIMC_LEFT], each[1][HIMC_RIGHT]);
    // C4 is .08 m and more to the left of E4
    TEST_ASSERT_TRUE(low / each[0][HIMC_LEFT] > high / each[0][HIMC_RIGHT] + .08);
    heard_free(&h);
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
static void test_a_stroke_that_ends_a_roll_is_as_loud_as_alone(void)
{
    static const char *const made[] = {"drum d", "instrument d snare"};
    for (int i = 0; i < 4; i += next(3)) {
        double speed[2];
        for (int alone = 0; alone < 2; alone++) {
            himc_performance *p = session_new();
            heard h = {0};
            session_do(p, "%s", made[i / 2]);
            session_do(p, "tempo 60");
            if (!alone)
                session_do(p, "roll 1 2 single f d");
            session_do(p, "stroke 3 right legato %s d", i % 2 ? "ff" : "f");
            session_do(p, "play");
            session_play(p, 5, &h);
            speed[alone] = h.strike[h.strikes - 1].velocity;
            heard_free(&h);
            himc_performance_free(p);
        }
        TEST_ASSERT_TRUE(20 * log10(speed[0] / speed[1]) > -0.5);
    }
}

static void test_a_roll_is_even_to_its_end(void)
{
    static const char *const kind[] = {"single", "double", "press"}, *const loud[] = {"mf", "ff",
                                                                                      "fff"};
    for (int k = 0; k < 9; k += next(4)) {
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
    for (int k = 0; k < 12; k += next(5)) {
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
    RUN_TEST(test_a_roll_on_a_bar_ends_early_enough_for_a_leap_to_another_bar);
    RUN_TEST(test_a_roll_that_goes_to_another_drum_and_back_has_all_its_strokes);
    RUN_TEST(test_a_roll_ends_in_grace_notes_as_they_are_without_it);
    RUN_TEST(test_a_double_roll_is_even_up_to_a_drag);
    RUN_TEST(test_a_double_roll_leaves_no_hole_before_a_flam);
    RUN_TEST(test_an_accent_before_the_end_of_a_roll_is_played);
    RUN_TEST(test_a_roll_leaves_an_ornament_on_the_next_drum_as_it_is_without_it);
    RUN_TEST(test_an_accent_after_a_roll_is_as_strong_when_the_tempo_has_changed_in_it);
    RUN_TEST(test_a_stroke_after_a_roll_is_as_strong_when_the_tempo_changes_just_before_it);
    RUN_TEST(test_a_tempo_that_is_already_so_changes_nothing);
    RUN_TEST(test_a_looped_score_is_as_the_same_written_again_and_again);
    RUN_TEST(test_short_rolls_have_the_rate_of_long_ones);
    RUN_TEST(test_an_accent_after_a_buzz_is_as_strong_as_alone_or_a_line_tells);
    RUN_TEST(test_two_rolls_at_once_on_two_drums_have_a_hand_each);
    RUN_TEST(test_two_rolls_at_once_on_two_bars_have_a_hand_each);
    RUN_TEST(test_a_roll_that_loses_its_beats_to_another_one_is_named);
    RUN_TEST(test_notes_that_are_left_out_are_named_as_they_are_written);
    RUN_TEST(test_a_stroke_that_ends_a_roll_is_as_loud_as_alone);
    RUN_TEST(test_a_roll_is_even_to_its_end);
    RUN_TEST(test_the_line_about_softer_strokes_counts_all_that_are);
    return UNITY_END();
}
