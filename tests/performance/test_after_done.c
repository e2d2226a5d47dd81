/// What is sent after the end of a piece: `play` begins at the top, whatever was sent; the beats go
/// on, so that a late `at` acts on its beat or is told to be past.
#include "session.h"

#include "himc/membrane.h"

#define SCORE "build/after-done.txt"
#define PIECE                                                                                 \
    "drum low 26; low tune A2; tempo 120; stroke 1 right legato f; stroke 2 left accent mf; " \
    "stroke 3 right legato p; "
#define END 1.55 // the piece is over so long after its beat 0 (s)

static himc_performance *performer(const char *more)
{
    himc_performance *p = session_new();
    char text[512];
    snprintf(text, sizeof text, "%s %s", PIECE, more);
    session_score(p, SCORE, text);
    return p;
}

/// Plays until `done`; false if it does not come within 6 s.
static bool play_out(himc_performance *p, heard *h)
{
    int dones = h->dones;
    for (int i = 0; i < 60 && h->dones == dones; i++)
        session_play(p, 0.1, h);
    return h->dones == dones + 1;
}

static double damping(himc_performance *p)
{
    return himc_membrane_head(himc_drum_membrane(himc_performance_drum(p, 0)))->damp;
}

/// The same strokes, at the same distances.
static void expect_same(const heard *a, const heard *b, const char *what)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(a->strikes, b->strikes, what);
    for (int i = 0; i < a->strikes; i++) {
        const himc_strike *s = &a->strike[i], *r = &b->strike[i];
        TEST_ASSERT_EQUAL_INT_MESSAGE(s->hand, r->hand, what);
        if (!isfinite(s->planned_time))
            continue;
        TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(s->beat, r->beat, what);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.005, s->time - a->strike[0].time,
                                          r->time - b->strike[0].time, what);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.03 * s->velocity, s->velocity, r->velocity, what);
    }
}

// sent after the end, it makes the next `play` what it makes of the first; what acts at once is
// over by then
static void test_play_after_done_is_play_with_what_was_sent(void)
{
    static const struct {
        const char *sent, *lasts; ///< `lasts`: what of it the next `play` has
    } after[] = {
        {"comment", ""},
        {"at 4 low damp 1", "at 4 low damp 1;"},
        {"at 40 push head 1 0 0 0.1", ""}, // which would end the piece 40 beats later
        {"stroke 4 left legato f", "stroke 4 left legato f;"},
        {"roll 4 1 single p", "roll 4 1 single p;"},
        {"tempo 100", "tempo 100;"},
        {"tempo 100 2", "tempo 100 2;"},
        {"low damp 0", ""},
        {"hit left legato f", ""},
        {"target right 0.5 -0.2 0.9", ""},
        {"stop", ""},
        {"seek 0", ""},
        {"seek 2", "seek 2;"},
        {"loop 0", ""},
        {"human 0", ""},
    };
    for (size_t i = 0; i < sizeof after / sizeof *after; i++) {
        heard first = {.strikes = 0}, second = first, unused = first;
        himc_performance *p = performer(after[i].lasts), *q = performer("");
        session_do(p, "play");
        TEST_ASSERT_TRUE_MESSAGE(play_out(p, &first), after[i].sent);
        session_do(q, "play");
        TEST_ASSERT_TRUE_MESSAGE(play_out(q, &unused), after[i].sent);
        session_play(q, 0.4, NULL);
        if (strncmp(after[i].sent, "comment", 7) != 0)
            session_do(q, "%s", after[i].sent);
        session_play(q, 1, NULL);
        session_do(q, "play");
        if (strncmp(after[i].sent, "at 40", 5) == 0)
            session_play(q, 3, &second);
        else
            TEST_ASSERT_TRUE_MESSAGE(play_out(q, &second), after[i].sent);
        expect_same(&first, &second, after[i].sent);
        heard_free(&first);
        heard_free(&second);
        heard_free(&unused);
        himc_performance_free(p);
        himc_performance_free(q);
    }
}

static void test_at_after_done_acts_on_its_beat(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = performer("play;");
    TEST_ASSERT_TRUE(play_out(p, &h)); // shortly after beat 3
    session_do(p, "at 4 low damp 1");
    session_do(p, "at 5 low damp 0");
    session_play(p, 0.2, &h);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_play(p, 0.3, &h);
    TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
    session_play(p, 0.5, &h);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    TEST_ASSERT_EQUAL_INT(0, h.notes);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_at_after_done_for_a_past_beat_is_told_and_acts_in_the_next_play(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = performer("play;");
    TEST_ASSERT_TRUE(play_out(p, &h));
    session_play(p, 1, &h);
    session_do(p, "at 4 low damp 1");
    session_do(p, "at 2 push head 1 0 0 0.1");
    session_play(p, 0.5, &h);
    TEST_ASSERT_EQUAL_INT(2, h.notes);
    TEST_ASSERT_EQUAL_STRING("at 2 push: given up, that beat is past", h.note);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_do(p, "play");
    session_play(p, END, &h);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    TEST_ASSERT_TRUE(play_out(p, &h));
    TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
    TEST_ASSERT_EQUAL_INT(2, h.notes);
    heard_free(&h);
    himc_performance_free(p);
}

// after `stop` and `clear` no beat goes on: what is sent then is for the next `play`
static void test_at_after_stop_or_clear_waits_for_play(void)
{
    static const char *const words[] = {"stop", "clear", "seek 1", "loop 1"};
    for (int i = 0; i < 4; i++) {
        heard h = {.strikes = 0};
        himc_performance *p = performer("play;");
        TEST_ASSERT_TRUE(play_out(p, &h));
        session_do(p, "%s", words[i]);
        session_do(p, "at 2.5 low damp 1");
        session_play(p, 1, &h);
        TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(0, damping(p), words[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, h.notes, words[i]);
        session_do(p, "play");
        session_play(p, 1.6, &h);
        TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(1, damping(p), words[i]);
        heard_free(&h);
        himc_performance_free(p);
    }
}

/// Strikes of a stroke on that beat.
static int strikes_on(const heard *h, double beat)
{
    int count = 0;
    for (int i = 0; i < h->strikes; i++)
        count += h->strike[i].beat == beat;
    return count;
}

static void test_a_stroke_after_done_sounds_on_its_beat_and_the_piece_is_done_again(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = performer("play;");
    TEST_ASSERT_TRUE(play_out(p, &h));
    int beats = h.beats;
    session_play(p, 0.4, &h);
    session_do(p, "stroke 6 left legato f");
    session_do(p, "flam 7 right legato f");
    session_do(p, "roll 8 2 single p");
    TEST_ASSERT_TRUE(play_out(p, &h));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, h.notes, h.all);
    TEST_ASSERT_EQUAL_INT(1, strikes_on(&h, 6));
    TEST_ASSERT_EQUAL_INT(2, strikes_on(&h, 7));
    TEST_ASSERT_TRUE(h.strikes > 10);
    TEST_ASSERT_INT_WITHIN(1, beats + 6, h.beats); // of beats 4 to 10
    for (int i = 1; i < h.strikes; i++)
        if (h.strike[i].beat == 6)
            TEST_ASSERT_DOUBLE_WITHIN(0.005, 2.5, h.strike[i].time - h.strike[0].time);
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(2, h.dones);
    session_do(p, "play"); // all of it
    TEST_ASSERT_TRUE(play_out(p, &h));
    TEST_ASSERT_EQUAL_INT(2, strikes_on(&h, 1));
    TEST_ASSERT_EQUAL_INT(2, strikes_on(&h, 6));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, h.notes, h.all);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_play_while_a_late_stroke_is_still_to_come_begins_at_the_top(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = performer("play;");
    TEST_ASSERT_TRUE(play_out(p, &h));
    session_do(p, "stroke 12 left legato f");
    session_play(p, 0.5, &h);
    session_do(p, "play");
    session_play(p, END + 0.5, &h);
    TEST_ASSERT_EQUAL_INT(2, strikes_on(&h, 1));
    TEST_ASSERT_EQUAL_INT(2, strikes_on(&h, 3));
    TEST_ASSERT_EQUAL_INT(0, strikes_on(&h, 12));
    TEST_ASSERT_TRUE(play_out(p, &h));
    TEST_ASSERT_EQUAL_INT(1, strikes_on(&h, 12));
    heard_free(&h);
    himc_performance_free(p);
}

// one line for a whole phrase
static void test_strokes_after_done_for_past_beats_are_told_once_and_kept_for_the_next_play(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = performer("play;");
    TEST_ASSERT_TRUE(play_out(p, &h));
    session_play(p, 2, &h);
    session_do(p, "stroke 2.5 left legato f");
    session_do(p, "stroke 3.5 left legato f");
    session_do(p, "roll 4 1 single p");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_STRING(
        "stroke at beat 2.5 left low: that beat is past, the next play has it\n", h.all);
    TEST_ASSERT_EQUAL_INT(3, h.strikes);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
    session_do(p, "play");
    TEST_ASSERT_TRUE(play_out(p, &h));
    TEST_ASSERT_EQUAL_INT(1, strikes_on(&h, 2.5));
    TEST_ASSERT_EQUAL_INT(1, strikes_on(&h, 3.5));
    TEST_ASSERT_TRUE(h.strikes > 10);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_play_after_done_is_play_with_what_was_sent);
    RUN_TEST(test_at_after_done_acts_on_its_beat);
    RUN_TEST(test_at_after_done_for_a_past_beat_is_told_and_acts_in_the_next_play);
    RUN_TEST(test_at_after_stop_or_clear_waits_for_play);
    RUN_TEST(test_a_stroke_after_done_sounds_on_its_beat_and_the_piece_is_done_again);
    RUN_TEST(test_play_while_a_late_stroke_is_still_to_come_begins_at_the_top);
    RUN_TEST(test_strokes_after_done_for_past_beats_are_told_once_and_kept_for_the_next_play);
    return UNITY_END();
}
