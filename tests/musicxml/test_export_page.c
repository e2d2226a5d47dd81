/// Export: the page that MusicXML makes: values, tuplets, beams, graces, hairpins.
#define _XOPEN_SOURCE 700
#include "written.h"

#include "musicxml/spell.h"

static void write_score(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, false, &error), error.text);
    TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "page"));
}

static void parse(const char *words)
{
    score = himc_score_parse(words, "words", NULL, &error);
    write_score();
}

static int count_of(const char *what)
{
    int count = 0;
    for (const char *at = text.bytes; (at = strstr(at, what)); at += strlen(what))
        count++;
    return count;
}

// the number behind a tag of a note, else `otherwise`
static long number_in(const char *note, const char *end, const char *tag, long otherwise)
{
    const char *at = strstr(note, tag);
    return at && at < end ? atol(at + strlen(tag)) : otherwise;
}

// the length of a note's written value (ticks); 0: a grace
static double value_of(const char *note, const char *end)
{
    static const char *const types[] = {"whole", "half", "quarter", "eighth",
                                        "16th",  "32nd", "64th",    "128th"};
    const char *type = strstr(note, "<type>"), *dot = strstr(note, "<dot/>");
    TEST_ASSERT_TRUE_MESSAGE(type && type < end, note);
    int i = 0;
    while (strncmp(type + 6, types[i], strlen(types[i])) != 0)
        i++;
    double value = (4.0 * MUSIC_TICKS) / (1 << i) * (dot && dot < end ? 1.5 : 1);
    return value * (double)number_in(note, end, "<normal-notes>", 1) /
           (double)number_in(note, end, "<actual-notes>", 1);
}

// each value is as long as the note, and the first voice's fill each bar
static void expect_values(const char *path, double quarters)
{
    for (const char *bar = text.bytes; (bar = strstr(bar, "<measure number"));) {
        const char *next = strstr(bar, "</measure>");
        double all = 0;
        for (const char *note = bar; (note = strstr(note, "<note")) && note < next;) {
            const char *end = strstr(note, "</note>");
            const char *voice = strstr(note, "<voice>1"), *chord = strstr(note, "<chord/>");
            long duration = number_in(note, end, "<duration>", 0);
            const char *whole = strstr(note, "<rest measure");
            double value = whole && whole < end ? quarters * MUSIC_TICKS : value_of(note, end);
            if (duration > 0)
                TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, value, (double)duration, path);
            if (duration > 0 && voice && voice < end && !(chord && chord < end))
                all += value;
            note = end;
        }
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, quarters * MUSIC_TICKS, all, path);
        bar = next;
    }
    tearDown();
}

static void test_values_are_as_long_as_notes_and_fill_each_bar(void)
{
    static const char *const pieces[] = {"patches/improvisation.txt", "patches/pieces/kit.txt",
                                         "patches/pieces/grain.txt", "patches/pieces/rudiments.txt",
                                         "patches/pieces/stations.txt"};
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
        score = himc_score_load(pieces[i], &error);
        write_score();
        expect_values(pieces[i], 4);
    }
}

// `comment bars of 3/4`: in any metre, with strokes and rolls anywhere
static void test_bars_are_those_of_the_comments(void)
{
    static const struct {
        const char *metre;
        double quarters;
    } metres[] = {{"3/4", 3},   {"6/8", 3},    {"2/4", 2},  {"5/8", 2.5}, {"7/8", 3.5},
                  {"9/8", 4.5}, {"6/16", 1.5}, {"12/8", 6}, {"5/4", 5},   {"3/2", 6}};
    for (size_t i = 0; i < sizeof metres / sizeof *metres; i++) {
        char words[4096], time[100];
        int size = snprintf(words, sizeof words,
                            "drum k; tempo 80; comment bars of %s from beat 2;"
                            "roll 10 1.5 single p p normal; roll 20 7 single p p normal;",
                            metres[i].metre);
        for (int k = 0; k < 24; k++)
            size +=
                snprintf(words + size, sizeof words - (size_t)size, "stroke %.9g right legato f;",
                         k < 12 ? 2 + 0.5 * k + k % 3 / 6.0 : 30 + k);
        parse(words);
        snprintf(time, sizeof time, "<time><beats>%d</beats><beat-type>%s</beat-type></time>",
                 atoi(metres[i].metre), strchr(metres[i].metre, '/') + 1);
        TEST_ASSERT_EQUAL_MESSAGE(1, count_of(time), metres[i].metre);
        TEST_ASSERT_EQUAL_MESSAGE((int)ceil(51.001 / metres[i].quarters), count_of("<measure"),
                                  metres[i].metre);
        expect_values(metres[i].metre, metres[i].quarters);
    }
}

// a pickup, a change of metre, and a first stroke before the first bar
static void test_a_short_bar_is_a_pickup(void)
{
    parse("drum k; comment bars of 4/4 from beat 2; comment bars of 4/4 from beat 3;"
          "comment bars of 3/4 from beat 11; comment bars of 3/5 from beat 12;"
          "stroke 2 right legato f; stroke 3 right legato f; stroke 11 right legato f;");
    TEST_ASSERT_EQUAL(1, count_of("<measure number=\"0\" implicit=\"yes\">"));
    TEST_ASSERT_EQUAL(1, count_of("implicit"));
    TEST_ASSERT_EQUAL(1, count_of("<measure number=\"3\"><attributes><time><beats>3<"));
    TEST_ASSERT_EQUAL(4, count_of("<measure"));
    tearDown();
    parse("drum k; comment bars of 3/4 from beat 2; stroke 1 right legato f;"
          "stroke 2 right legato f;");
    TEST_ASSERT_EQUAL(2, count_of("<measure"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2, notes.notes[0].beat);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3, notes.notes[1].beat);
}

static void test_tuplets_have_brackets_and_ratios(void)
{
    parse("drum k; tempo 80; stroke 0 right legato f; stroke 0.33333333 left legato f;"
          "stroke 0.66666667 right legato f; stroke 1 left legato f; stroke 1.2 right legato f;"
          "stroke 1.4 left legato f; stroke 1.6 right legato f; stroke 1.8 left legato f;"
          "stroke 2 right legato f; stroke 2.66666667 left legato f;"
          "stroke 3.33333333 left legato f; stroke 4 right legato f;");
    TEST_ASSERT_EQUAL(3, count_of("<tuplet type=\"start\""));
    TEST_ASSERT_EQUAL(3, count_of("<tuplet type=\"stop\""));
    TEST_ASSERT_EQUAL(6, count_of("<actual-notes>3</actual-notes><normal-notes>2<"));
    TEST_ASSERT_EQUAL(5, count_of("<actual-notes>5</actual-notes><normal-notes>4<"));
    TEST_ASSERT_EQUAL(1, count_of("bracket=\"yes\"")); // quarters have no beam
}

// six in a beat are twice three where a note is in its middle
static void test_a_sextuplet_is_two_triplets(void)
{
    parse("drum k; stroke 0 right legato f; stroke 0.16666667 left legato f;"
          "stroke 0.33333333 right legato f; stroke 0.5 left legato f;"
          "stroke 0.66666667 right legato f; stroke 0.83333333 left legato f;"
          "stroke 1 right legato f;");
    TEST_ASSERT_EQUAL(6, count_of("<actual-notes>3<"));
    TEST_ASSERT_EQUAL(2, count_of("<tuplet type=\"start\""));
}

// a whole bar's is one; in 3/4 each beat has its own
static void test_rests_show_the_beats(void)
{
    parse("drum k; stroke 0 right legato f; stroke 8 left legato f;");
    TEST_ASSERT_EQUAL(1, count_of("<rest measure=\"yes\"/>"));
    TEST_ASSERT_EQUAL(5, count_of("<rest"));
    tearDown();
    parse("drum k; comment bars of 3/4 from beat 0; stroke 0 right legato f;");
    TEST_ASSERT_EQUAL(2, count_of("<rest/>"));
    tearDown();
    parse("drum k; comment bars of 6/8 from beat 0; roll 0 3 single f f normal;");
    TEST_ASSERT_EQUAL(1, count_of("<type>half</type><dot/>")); // of a note, one for the bar
}

static void test_dots_and_syncopations_are_one_note(void)
{
    parse("drum k; stroke 0 right legato f; stroke 0.75 left legato f; stroke 1 right legato f;"
          "stroke 1.25 left legato f; stroke 1.75 right legato f; stroke 2 left legato f;");
    TEST_ASSERT_EQUAL(1, count_of("<type>eighth</type><dot/>"));
    TEST_ASSERT_EQUAL(3, count_of("<type>16th</type>"));
    TEST_ASSERT_EQUAL(2, count_of("<beam number=\"2\">backward hook"));
    TEST_ASSERT_EQUAL(1, count_of("<beam number=\"2\">forward hook"));
    TEST_ASSERT_EQUAL(0, count_of("<tie type"));
}

// a circle over each, a cross where they are closed again; read back without a word
static void test_open_and_closed_hats_have_their_signs(void)
{
    parse("instrument hats hi-hat 14; at 0 hats pedal 1; stroke 0 right legato f hats;"
          "stroke 1 right legato f hats; at 1.9 hats pedal 0; stroke 2 right legato f hats;"
          "at 2.9 hats pedal 1; stroke 3 right legato f hats; stroke 4 right legato f hats;");
    TEST_ASSERT_EQUAL(1, count_of("<technical><open/><fingering>R</fingering></technical>"));
    TEST_ASSERT_EQUAL(1, count_of("<stopped/>"));
    import_back();
    TEST_ASSERT_NOT_NULL(strstr(made.text, "hats pedal 0;"));
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not played"), made.report);
}

// f at the end of a roll and the next ff are not one word: drawn before the barline, read at it
static void test_the_end_of_a_roll_and_the_next_dynamic_do_not_collide(void)
{
    parse("drum k; tempo 80; roll 0 4 single p f normal; roll 4 4 single ff ff normal;"
          "roll 8 4 single p f normal; roll 12 4 single f f normal;");
    TEST_ASSERT_EQUAL(2, count_of("<offset sound=\"no\">-"));
    import_back();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, " 4 single p f "), made.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, " 4 single ff ff "), made.text);
}

// as the import cuts them, and no other ones
static void test_a_roll_with_a_louder_beginning_has_an_accent(void)
{
    parse("drum k; tempo 120; roll 0 0.4 single mp p normal; roll 0.4 3.6 single p p normal;"
          "roll 4 0.4 single f mp normal; roll 4.4 1.6 single mp mp normal;");
    TEST_ASSERT_EQUAL(2, notes.note_count);
    TEST_ASSERT_EQUAL(1, count_of("<accent/>"));
    TEST_ASSERT_EQUAL(1, count_of("<strong-accent/>"));
    TEST_ASSERT_EQUAL(0, count_of("<tuplet"));
    import_back();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, " 0.4 single f mp "), made.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, " 1.6 single mp mp "), made.text);
    tearDown();
    parse("drum k; tempo 120; roll 0 0.5 single mp p normal; roll 0.5 3.5 single p p normal;"
          "roll 4 0.4 single mp p normal; roll 4.4 1.6 single p f normal;");
    TEST_ASSERT_EQUAL(4, notes.note_count);
}

// as many graces as are played, and none is told when the page is read
static void test_a_flam_is_slashed_and_a_ruff_is_beamed(void)
{
    parse("drum k; flam 1 right legato f; drag 2 right legato f; ruff 3 right legato f;");
    TEST_ASSERT_EQUAL(1, count_of("<grace slash=\"yes\"/>"));
    TEST_ASSERT_EQUAL(4, count_of("<grace/>"));
    TEST_ASSERT_EQUAL(3, count_of(">begin</beam>")); // two beams of a drag, one of a ruff
    TEST_ASSERT_EQUAL(0, count_of(">continue</beam>"));
    import_back();
    TEST_ASSERT_NULL(strstr(made.report, "grace"));
    TEST_ASSERT_NOT_NULL(strstr(made.text, "\ndrag "));
    TEST_ASSERT_NOT_NULL(strstr(made.text, "\nruff "));
    TEST_ASSERT_EQUAL(3, count_of("<slur type=\"start\""));
}

static void test_a_ramp_of_strokes_is_one_hairpin(void)
{
    parse("drum k; stroke 0 right legato p; stroke 0.5 left legato 0.357; stroke 1 right legato mp;"
          "stroke 1.5 left legato 0.5; stroke 2 right legato mf; stroke 2.5 left legato 0.643;"
          "stroke 3 right legato f; stroke 4 left legato f; stroke 5 left legato p;"
          "stroke 6 right legato p;");
    TEST_ASSERT_EQUAL(1, count_of("<wedge type=\"crescendo\""));
    TEST_ASSERT_EQUAL(1, count_of("<wedge type=\"stop\""));
    TEST_ASSERT_EQUAL(3, count_of("<dynamics>")); // p, f, and subito p
}

// a kit's drums have one dynamic on the page, hands above and feet below
static void test_a_kit_has_one_mark_and_two_voices(void)
{
    parse("setup kit; stroke 0 foot legato f kick; stroke 0 right legato mp hats;"
          "stroke 1 right legato mp hats; stroke 1 left legato f snare;"
          "stroke 2 foot legato f kick; stroke 2 right legato mp hats;");
    TEST_ASSERT_EQUAL(1, count_of("<dynamics>"));
    TEST_ASSERT_EQUAL(1, count_of("<chord/>"));
    TEST_ASSERT_EQUAL(2, count_of("<stem>down</stem>"));
    TEST_ASSERT_EQUAL(4, count_of("<stem>up</stem>"));
    TEST_ASSERT_EQUAL(3, count_of("<notehead>x</notehead>"));
    TEST_ASSERT_EQUAL(2, count_of("<display-step>F</display-step><display-octave>4<"));
    tearDown();
    parse("setup kit; stroke 0 foot legato f kick; stroke 1 foot legato f kick;"); // feet alone
    TEST_ASSERT_EQUAL(0, count_of("<voice>2</voice>"));
}

// one mark, an accent over what is louder, parentheses around what is much softer; none of it is
// another way of playing when it is read
static void test_accents_and_ghost_notes_are_signs_of_a_bar_with_one_mark(void)
{
    parse("instrument snare snare 14; tempo 100; stroke 0 right legato mf snare;"
          "stroke 0.5 left legato pp snare; stroke 1 right legato f snare;"
          "stroke 1.5 left legato pp snare; stroke 2 right legato mf snare;"
          "stroke 2.5 left legato mf snare; stroke 3 right accent f snare;");
    TEST_ASSERT_EQUAL(1, count_of("<dynamics>"));
    TEST_ASSERT_EQUAL(1, count_of("<mf/>"));
    TEST_ASSERT_EQUAL(2, count_of("<accent/>"));
    TEST_ASSERT_EQUAL(2, count_of("<notehead parentheses=\"yes\">"));
    import_back();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "right legato f normal snare"), made.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "right accent f normal snare"), made.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "left legato pp normal snare"), made.text);
}

// each of other drums than a kit's has a place and its name before its first note
static void test_other_drums_are_apart_and_named_once(void)
{
    parse("instrument t tambourine; instrument w wood-block; instrument c cowbell; setup kit;"
          "stroke 0 right legato f t; stroke 1 right legato f w; stroke 2 right legato f c;"
          "stroke 3 right legato f snare; stroke 4 right legato f t; stroke 5 left legato f w;");
    static const char *const names[] = {"tambourine", "high wood block", "cowbell"};
    char words[64];
    for (int i = 0; i < 3; i++) {
        snprintf(words, sizeof words, "<words>%s</words>", names[i]);
        TEST_ASSERT_EQUAL_MESSAGE(1, count_of(words), names[i]);
    }
    TEST_ASSERT_EQUAL(3, count_of("<words>"));
    const char *seen[4], *at = text.bytes;
    for (int i = 0; i < 4; i++) {
        at = strstr(at, "<display-step>");
        seen[i] = at++;
        for (int k = 0; k < i; k++) // a step and its octave
            TEST_ASSERT_TRUE(strncmp(seen[i], seen[k], 46) != 0);
    }
    import_back();
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not played"), made.report);
}

static void test_a_tempo_on_its_way_is_a_word(void)
{
    parse("drum k; tempo 60; tempo 60 120 8 4; stroke 0 right legato f; stroke 20 left legato f;");
    TEST_ASSERT_EQUAL(1, count_of("<words>accel.</words>"));
    TEST_ASSERT_EQUAL(0, count_of("<words>rit.</words>"));
    TEST_ASSERT_TRUE(count_of("<metronome>") <= 3);
    TEST_ASSERT_TRUE(count_of("<sound tempo") > 6);
    tearDown();
    // in steps of two bars each is a number; of those before the first bar the last counts
    parse("drum k; tempo 60; tempo 80 8; tempo 100 16; stroke 0 right legato f;"
          "stroke 20 left legato f;");
    TEST_ASSERT_EQUAL(3, count_of("<metronome>"));
    tearDown();
    parse(
        "drum k; tempo 60; tempo 90 2; comment bars of 4/4 from beat 4; stroke 4 right legato f;");
    TEST_ASSERT_EQUAL(1, count_of("<metronome>"));
    TEST_ASSERT_EQUAL(1, count_of("<per-minute>90<"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_values_are_as_long_as_notes_and_fill_each_bar);
    RUN_TEST(test_bars_are_those_of_the_comments);
    RUN_TEST(test_a_short_bar_is_a_pickup);
    RUN_TEST(test_tuplets_have_brackets_and_ratios);
    RUN_TEST(test_a_sextuplet_is_two_triplets);
    RUN_TEST(test_rests_show_the_beats);
    RUN_TEST(test_dots_and_syncopations_are_one_note);
    RUN_TEST(test_a_roll_with_a_louder_beginning_has_an_accent);
    RUN_TEST(test_open_and_closed_hats_have_their_signs);
    RUN_TEST(test_the_end_of_a_roll_and_the_next_dynamic_do_not_collide);
    RUN_TEST(test_a_flam_is_slashed_and_a_ruff_is_beamed);
    RUN_TEST(test_a_ramp_of_strokes_is_one_hairpin);
    RUN_TEST(test_a_kit_has_one_mark_and_two_voices);
    RUN_TEST(test_a_tempo_on_its_way_is_a_word);
    RUN_TEST(test_accents_and_ghost_notes_are_signs_of_a_bar_with_one_mark);
    RUN_TEST(test_other_drums_are_apart_and_named_once);
    return UNITY_END();
}
