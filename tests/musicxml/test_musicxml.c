/// MusicXML: each sign of a percussionist's part, and bad files.
#define _XOPEN_SOURCE 700
#include "unity.h"

#include "musicxml/import.h"
#include "plan/score.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static himc_error error;
static midi_score made;
static himc_score *score;

void setUp(void)
{
    error.text[0] = '\0';
}

static void forget(void)
{
    himc_midi_score_free(&made);
    himc_score_free(score);
    score = NULL;
}

void tearDown(void)
{
    forget();
}

// a score of one part, whose divisions are 4 to a quarter note, at 120 beats a minute

#define HEAD                                                                 \
    "<?xml version='1.0' encoding='UTF-8'?><!DOCTYPE score-partwise PUBLIC " \
    "'-//Recordare//DTD MusicXML 4.0 Partwise//EN' "                         \
    "'http://www.musicxml.org/dtds/partwise.dtd'><score-partwise version='4.0'>"
#define PART(name)                                                                \
    "<part-list><score-part id='P1'><part-name>" name "</part-name></score-part>" \
    "</part-list><part id='P1'>"
#define TAIL "</part></score-partwise>"
#define BAR(number, body) "<measure number='" #number "'>" body "</measure>"
#define FOUR "<attributes><divisions>4</divisions></attributes>"
#define NOTE(step, octave, duration, more)                                                        \
    "<note><pitch><step>" #step "</step><octave>" #octave "</octave></pitch><duration>" #duration \
    "</duration><voice>1</voice>" more "</note>"
#define C3(duration, more) NOTE(C, 3, duration, more)
#define REST(duration) "<note><rest/><duration>" #duration "</duration></note>"
#define GRACE(step)                                                         \
    "<note><grace/><pitch><step>" #step "</step><octave>3</octave></pitch>" \
    "<voice>1</voice></note>"
#define MARKS(n)                                                                \
    "<notations><ornaments><tremolo type='single'>" #n "</tremolo></ornaments>" \
    "</notations>"
#define ARTICULATION(a) "<notations><articulations><" a "/></articulations></notations>"
#define DIRECTION(type) "<direction><direction-type>" type "</direction-type></direction>"
#define WORDS(text) DIRECTION("<words>" text "</words>")
#define DYNAMICS(d) DIRECTION("<dynamics><" d "/></dynamics>")
#define WEDGE(type) DIRECTION("<wedge type='" type "'/>")
#define TEMPO(bpm) "<sound tempo='" #bpm "'/>"

static bool import(const char *text)
{
    forget();
    if (!himc_music_import(&made, text, strlen(text), "test.musicxml", NULL, &error))
        return false;
    score = himc_score_parse(made.text, "made.txt", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    return true;
}

static void load(const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(import(text), error.text);
}

#define PLAY(body) load(HEAD PART("Timpani") body TAIL)

/// Beats before the first of the file.
static double lead(void)
{
    double beats = -1;
    TEST_ASSERT_EQUAL(1, sscanf(strstr(made.text, "beat 0 of the file"),
                                "beat 0 of the file is beat %lf", &beats));
    return beats;
}

static const himc_stroke *stroke(int index)
{
    TEST_ASSERT_TRUE_MESSAGE(index < score->stroke_count, made.text);
    return &score->strokes[index];
}

static void expect_beats(int count, ...)
{
    va_list list;
    va_start(list, count);
    TEST_ASSERT_EQUAL_MESSAGE(count, score->stroke_count, made.text);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_FLOAT_WITHIN(1e-4, va_arg(list, double) + lead(), stroke(i)->beat);
    va_end(list);
}

/// In steps of 7: 4 is mf.
static void expect_dynamics(int count, ...)
{
    va_list list;
    va_start(list, count);
    TEST_ASSERT_EQUAL_MESSAGE(count, score->stroke_count, made.text);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_FLOAT_WITHIN(0.05, va_arg(list, double), 7 * stroke(i)->dynamic);
    va_end(list);
}

static void expect_roll(int index, double beat, double length, double from, double to)
{
    const himc_stroke *s = stroke(index);
    TEST_ASSERT_EQUAL_MESSAGE(HIMC_ROLL_SINGLE, s->ornament, made.text);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, beat + lead(), s->beat);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, length, s->length);
    TEST_ASSERT_FLOAT_WITHIN(0.06, from, 7 * s->dynamic);
    TEST_ASSERT_FLOAT_WITHIN(0.06, to, 7 * s->last_dynamic);
}

static void expect_text(const char *text)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, text), made.text);
}

static double bpm_at(double beat)
{
    double bpm = 0;
    for (int i = 0; i < score->tempo_count; i++)
        if (score->tempi[i].beat <= beat + lead() + 1e-6)
            bpm = score->tempi[i].bpm;
    return bpm;
}

/// Seconds between two beats of the file.
static double time_between(double from, double to)
{
    return himc_score_seconds(score->tempi, score->tempo_count, to + lead()) -
           himc_score_seconds(score->tempi, score->tempo_count, from + lead());
}

// --- notes

static void test_notes_are_strokes_on_their_beats(void)
{
    PLAY(BAR(1, FOUR C3(4, "") REST(4) NOTE(G, 2, 2, "") C3(6, "")) BAR(2, C3(16, "")));
    expect_beats(4, 0.0, 2.0, 2.5, 4.0);
    expect_text("4 of 4 notes for timpani are played");
    TEST_ASSERT_EQUAL_STRING(stroke(0)->drum, stroke(2)->drum);
    TEST_ASSERT_TRUE(strcmp(stroke(0)->drum, stroke(1)->drum) != 0);
    expect_text("tune G2;");
    expect_text("tune C3;");
}

static void test_voices_and_chords_sound_together(void)
{
    PLAY(BAR(1, FOUR C3(8, "") "<note><chord/><pitch><step>G</step><octave>2</octave></pitch>"
                               "<duration>8</duration></note>"
                               "<backup><duration>4</duration></backup>"
                               "<forward><duration>2</duration></forward>" C3(2, "")));
    expect_beats(3, 0.0, 0.0, 1.5);
}

static void test_a_pickup_is_as_long_as_its_notes(void)
{
    PLAY("<measure number='0' implicit='yes'>" FOUR
         "<attributes><time><beats>4</beats><beat-type>4</beat-type></time></attributes>" C3(
             4, "") "</measure>" BAR(1, C3(16, "")));
    expect_beats(2, 0.0, 1.0);
    expect_text("comment bar 0;");
}

static void test_an_empty_bar_is_as_long_as_its_time_signature(void)
{
    PLAY(BAR(1, FOUR "<attributes><time><beats>3+2</beats><beat-type>8</beat-type></time>"
                     "</attributes>") BAR(2, C3(4, "")));
    expect_beats(1, 2.5);
}

static void test_a_transposing_part_sounds_as_it_is_transposed(void)
{
    PLAY(BAR(1, FOUR "<attributes><transpose><chromatic>2</chromatic></transpose></attributes>" C3(
                    16, "")));
    expect_text("tune D3;");
}

static void test_tied_notes_are_one_stroke(void)
{
    PLAY(BAR(1, FOUR C3(16, "<tie type='start'/>"))
             BAR(2, C3(4, "<tie type='stop'/>") C3(4, "") REST(8)));
    expect_beats(2, 0.0, 5.0);
}

static void test_cue_notes_are_left_out_and_counted_with_their_bars(void)
{
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, "<note><cue/><pitch><step>C</step><octave>3</octave>"
                                        "</pitch><duration>16</duration></note>"));
    expect_beats(1, 0.0);
    expect_text("1 cue note is left out (bar 2)");
    TEST_ASSERT_EQUAL(0, made.left_out);
}

static void test_what_is_not_played_has_its_bar_and_reason(void)
{
    PLAY(BAR(7, FOUR C3(16, "")) BAR(8, "<note><pitch><step>X</step><octave>3</octave></pitch>"
                                        "<duration>16</duration></note>"));
    expect_text("1 note is not played: it has no pitch or no length (bar 8)");
    TEST_ASSERT_EQUAL(1, made.left_out);
    // four chords of drums in 0.1 s: more than two hands can
    PLAY(BAR(3, FOUR TEMPO(200) NOTE(C, 2, 1, "") NOTE(G, 2, 1, "") NOTE(D, 3, 1, "")
                    NOTE(G, 3, 1, "") NOTE(C, 2, 1, "") NOTE(G, 3, 1, "") NOTE(G, 2, 10, "")));
    expect_text("both hands are busy (bar 3)");
}

// --- order

#define REPEAT(direction) "<barline><repeat direction='" direction "'/></barline>"
#define ENDING(number, type) "<barline><ending number='" number "' type='" type "'/></barline>"
#define SOUND(what) DIRECTION("<words/>") "<sound " what "/>"

static void test_repeats_and_endings_are_played(void)
{
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, REPEAT("forward") C3(16, "")) BAR(
        3, ENDING("1", "start")
               NOTE(G, 2, 16,
                    "") "<barline><ending number='1' type='stop'/><repeat direction='backward'/>"
                        "</barline>")
             BAR(4, ENDING("2", "start") NOTE(D, 3, 16, "") ENDING("2", "discontinue"))
                 BAR(5, C3(16, "") REPEAT("backward")) BAR(6, C3(16, "")));
    expect_beats(8, 0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0);
    const char *const first = stroke(2)->drum;
    TEST_ASSERT_TRUE(strcmp(first, stroke(4)->drum) != 0);
    TEST_ASSERT_EQUAL_STRING(stroke(3)->drum, stroke(1)->drum);
}

static void test_endings_without_a_number_or_a_stop_lose_no_bar(void)
{
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, ENDING("", "start") C3(16, "") ENDING("", "stop"))
             BAR(3, C3(16, "")));
    expect_beats(3, 0.0, 4.0, 8.0);
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, ENDING("1", "start") C3(16, "") REPEAT("backward"))
             BAR(3, ENDING("2", "start") C3(16, "") ENDING("2", "stop")));
    expect_beats(4, 0.0, 4.0, 8.0, 12.0);
}

static void test_numbers_beyond_music_are_read_and_lose_nothing(void)
{
    PLAY(BAR(1, FOUR C3(16, MARKS(1)) "<backup><duration>-1e19</duration></backup>")
             BAR(2, C3(16, MARKS(4))));
    TEST_ASSERT_TRUE(score->stroke_count >= 2);
    PLAY(BAR(1, FOUR TEMPO(4) C3(16, MARKS(3)) C3(16, MARKS(4)))); // rolls longer than a minute
    TEST_ASSERT_TRUE(score->stroke_count >= 2);
    PLAY(BAR(1, FOUR C3(1, MARKS(1)) C3(15, ""))); // a note without a type
    TEST_ASSERT_EQUAL(2, score->stroke_count);
}

static void test_graces_at_the_end_are_counted(void)
{
    PLAY(BAR(1, FOUR C3(16, "") GRACE(C)));
    expect_text("1 grace note is not played");
}

static void test_an_accent_over_a_rest_is_not_the_next_note_s(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("f") C3(4, "") DYNAMICS("sfz") REST(4) C3(8, "")));
    TEST_ASSERT_EQUAL(stroke(0)->nuance, stroke(1)->nuance);
}

static void test_a_repeat_is_played_as_often_as_it_says(void)
{
    PLAY(BAR(1, FOUR C3(16, "") "<barline><repeat direction='backward' times='3'/></barline>")
             BAR(2, NOTE(G, 2, 16, "")));
    expect_beats(4, 0.0, 4.0, 8.0, 12.0);
}

static void test_da_capo_goes_to_fine_without_repeats(void)
{
    PLAY(BAR(1, FOUR C3(16, "") REPEAT("backward")) BAR(2, C3(16, "") WORDS("Fine"))
             BAR(3, C3(16, "") WORDS("D.C. al Fine")));
    expect_beats(6, 0.0, 4.0, 8.0, 12.0, 16.0, 20.0);
}

static void test_dal_segno_goes_to_the_coda(void)
{
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, "<sound segno='s'/>" NOTE(G, 2, 16, ""))
             BAR(3, C3(16, "") "<sound tocoda='c'/>") BAR(4, C3(16, "") "<sound dalsegno='s'/>")
                 BAR(5, "<sound coda='c'/>" NOTE(G, 2, 16, "")));
    // 1 2 3 4 2 3 5
    expect_beats(7, 0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0);
    TEST_ASSERT_EQUAL_STRING(stroke(1)->drum, stroke(4)->drum);
    TEST_ASSERT_EQUAL_STRING(stroke(1)->drum, stroke(6)->drum);
}

// --- tempo

static void test_tempo_marks_words_and_numbers(void)
{
    PLAY(BAR(1, FOUR DIRECTION("<metronome><beat-unit>half</beat-unit><per-minute>c. 50"
                               "</per-minute></metronome>") C3(16, ""))
             BAR(2, WORDS("Adagio molto") C3(16, "")) BAR(3, WORDS("Allegro") TEMPO(140) C3(16, ""))
                 BAR(4, WORDS("Tempo I") C3(16, "")) BAR(5, C3(16, "")));
    TEST_ASSERT_EQUAL_FLOAT(100, bpm_at(0));
    TEST_ASSERT_EQUAL_FLOAT(66, bpm_at(4));
    TEST_ASSERT_EQUAL_FLOAT(140, bpm_at(8));
    TEST_ASSERT_EQUAL_FLOAT(100, bpm_at(12));
}

static void test_a_ritardando_slows_evenly_to_a_tempo(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(16, "")) BAR(2, WORDS("poco rit.") C3(16, ""))
             BAR(3, WORDS("a tempo") C3(16, "")) BAR(4, C3(16, "")));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(3.5));
    for (double beat = 4.5; beat < 8; beat += 0.5)
        TEST_ASSERT_TRUE(bpm_at(beat) < bpm_at(beat - 0.5));
    TEST_ASSERT_FLOAT_WITHIN(3, 90, bpm_at(7.9));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(8));
}

static void test_a_fermata_holds(void)
{
    PLAY(BAR(1, FOUR TEMPO(40) C3(16, "<notations><fermata/></notations>")) BAR(2, C3(16, "")));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 8.0, time_between(0, 4)); // longer by 2 s at most
    PLAY(BAR(1, FOUR TEMPO(120) C3(4, "<notations><fermata/></notations>") C3(4, "") REST(8)));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1.0, time_between(0, 1));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(1));
}

// --- dynamics

static void test_dynamics_hold_until_the_next(void)
{
    PLAY(BAR(1, FOUR C3(4, "") DYNAMICS("pp") C3(4, "") C3(4, "") DYNAMICS("ff") C3(4, "")));
    expect_dynamics(4, 4.0, 1.0, 1.0, 6.0);
}

static void test_a_hairpin_leads_to_its_end(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("p") WEDGE("crescendo") C3(4, "") C3(4, "") C3(4, "") C3(4, "")
                    WEDGE("stop")) BAR(2, DYNAMICS("f") C3(4, "") REST(12)));
    expect_dynamics(5, 2.0, 2.75, 3.5, 4.25, 5.0);
    PLAY(BAR(1, FOUR DYNAMICS("f") WEDGE("diminuendo") C3(8, "") WEDGE("stop") C3(8, "")));
    expect_dynamics(2, 5.0, 4.0);
}

static void test_a_word_leads_to_the_next_dynamic(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("p") WORDS("cresc.") C3(8, "") C3(8, ""))
             BAR(2, DYNAMICS("ff") C3(16, "")));
    expect_dynamics(3, 2.0, 4.0, 6.0);
}

static void test_marks_of_a_note_are_its_nuance(void)
{
    PLAY(BAR(1, FOUR C3(4, ARTICULATION("accent")) C3(4, ARTICULATION("strong-accent"))
                    C3(4, ARTICULATION("staccato")) C3(4, ARTICULATION("tenuto")))
             BAR(2, DYNAMICS("sfz") C3(4, "") C3(12, "")));
    const himc_nuance nuance[] = {HIMC_ACCENT, HIMC_VERTICAL_ACCENT, HIMC_LEGATO,
                                  HIMC_TENUTO, HIMC_VERTICAL_ACCENT, HIMC_LEGATO};
    for (int i = 0; i < 6; i++)
        TEST_ASSERT_EQUAL(nuance[i], stroke(i)->nuance);
    // an accent is a step louder
    expect_dynamics(6, 5.0, 4.0, 4.0, 4.0, 4.0, 4.0);
}

static void test_fp_is_loud_once(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("fp") C3(8, "") C3(8, "")));
    expect_dynamics(2, 5.0, 2.0);
}

// --- tremolos, and six reports of users of MuseScore

static void test_two_strokes_through_the_stem_are_measured(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) C3(4, MARKS(1)) C3(4, MARKS(2)) REST(8)));
    expect_beats(6, 0.0, 0.5, 1.0, 1.25, 1.5, 1.75);
    // an eighth has a flag already
    PLAY(BAR(1, FOUR TEMPO(60) C3(2, "<type>eighth</type>" MARKS(1)) REST(14)));
    expect_beats(2, 0.0, 0.25);
    expect_text("1 of 1 notes for timpani");
}

// musescore#20883: three are a roll, but measured where they are slow, or where it says so
static void test_three_strokes_are_a_roll_unless_measured(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(16, MARKS(3))));
    TEST_ASSERT_EQUAL(1, score->stroke_count);
    expect_roll(0, 0, 4, 4, 4);
    PLAY(BAR(1, FOUR TEMPO(40) C3(4, MARKS(3)) REST(12)));
    TEST_ASSERT_EQUAL(8, score->stroke_count);
    PLAY(BAR(1, FOUR TEMPO(66) WORDS("gemessen") C3(4, MARKS(3)) REST(12)));
    TEST_ASSERT_EQUAL(8, score->stroke_count);
    PLAY(BAR(1, FOUR TEMPO(40) C3(16, "<notations><ornaments><tremolo type='unmeasured'/>"
                                      "</ornaments></notations>")));
    expect_roll(0, 0, 4, 4, 4);
}

static void test_three_strokes_under_a_fermata_are_a_roll(void)
{
    PLAY(BAR(1, FOUR TEMPO(96) REST(8)
                    C3(8, "<notations><ornaments><tremolo type='single'>3</tremolo></ornaments>"
                          "<fermata/></notations>")));
    TEST_ASSERT_EQUAL(1, score->stroke_count);
    expect_roll(0, 2, 2, 4, 4);
}

// musescore#16756: a timpani trill is a roll
static void test_a_trill_is_a_roll(void)
{
    PLAY(BAR(1,
             FOUR C3(8, "<notations><ornaments><trill-mark/></ornaments></notations>") C3(8, "")));
    expect_roll(0, 0, 2, 4, 4);
    TEST_ASSERT_EQUAL(2, score->stroke_count);
}

// musescore#19095, #21060: hairpins act within a roll, tied over bars, too
static void test_a_hairpin_acts_within_a_roll(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("pp") WEDGE("crescendo") C3(16, "<tie type='start'/>" MARKS(3))) BAR(
        2, C3(16, "<tie type='stop'/>" MARKS(3)) WEDGE("stop")) BAR(3, DYNAMICS("ff") C3(16, "")));
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    expect_roll(0, 0, 8, 1, 6);
    PLAY(BAR(1, FOUR DYNAMICS("p") WEDGE("crescendo")
                    C3(16, MARKS(3)) "<backup><duration>8"
                                     "</duration></backup>" WEDGE("stop") WEDGE(
                                         "diminuendo") "<forward><duration>8"
                                                       "</duration></forward>" WEDGE("stop")));
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    expect_roll(0, 0, 2, 2, 3);
    expect_roll(1, 2, 2, 3, 2);
    expect_text("1 of 1 notes");
}

// musescore#22480: grace notes before a roll are played before it, softer
static void test_graces_come_before_a_roll(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) REST(8) GRACE(C) GRACE(C) C3(8, MARKS(3))));
    TEST_ASSERT_EQUAL(3, score->stroke_count);
    expect_roll(2, 2, 2, 4, 4);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 0.14, time_between(stroke(0)->beat - lead(), 2));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 0.07, time_between(stroke(1)->beat - lead(), 2));
    TEST_ASSERT_TRUE(stroke(0)->hand != stroke(1)->hand);
    TEST_ASSERT_TRUE(stroke(1)->dynamic < stroke(2)->dynamic - 0.1);
}

// musescore#24793: notes above the usual B are played: on the high drum, or an octave lower
static void test_notes_above_high_b_are_played(void)
{
    PLAY(BAR(1, FOUR NOTE(B, 3, 8, "") NOTE(C, 4, 8, "")));
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    expect_text("2 of 2 notes");
}

// musescore#16733: a roll is as even at any tempo and ends with its note
static void test_a_roll_ends_with_its_note_at_any_tempo(void)
{
    PLAY(BAR(1, FOUR TEMPO(180) C3(8, MARKS(3)) NOTE(G, 2, 8, "")));
    expect_roll(0, 0, 2, 4, 4);
    PLAY(BAR(1, FOUR TEMPO(70) C3(8, MARKS(4)) NOTE(G, 2, 8, "")));
    expect_roll(0, 0, 2, 4, 4);
    TEST_ASSERT_EQUAL(2, score->stroke_count);
}

// a roll tied to a note without a tremolo ends with a stroke there, one tied to a tremolo goes on
static void test_a_roll_tied_to_a_plain_note_ends_with_a_stroke(void)
{
#define WAVY(type) "<notations><ornaments><wavy-line type='" type "'/></ornaments></notations>"
#define TIE(type) "<tie type='" type "'/>"
    static const char *const roll[] = {MARKS(3), MARKS(4), WAVY("start")},
                             *const goes_on[] = {MARKS(3), MARKS(4), ""},
                             *const ends[] = {MARKS(3), MARKS(4), WAVY("stop")};
    for (int k = 0; k < 3; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") BAR(1, FOUR DYNAMICS("f") C3(16, TIE("start") "%s"))
                     BAR(2, C3(16, TIE("stop") TIE("start") "%s"))
                         BAR(3, C3(8, TIE("stop") TIE("start") "%s") C3(4, TIE("stop")) REST(4))
                             TAIL,
                 roll[k], goes_on[k], ends[k]);
        load(text);
        TEST_ASSERT_EQUAL_MESSAGE(2, score->stroke_count, made.text);
        expect_roll(0, 0, 10, 5, 5);
        TEST_ASSERT_EQUAL(HIMC_PLAIN, stroke(1)->ornament);
        TEST_ASSERT_FLOAT_WITHIN(1e-4, 10 + lead(), stroke(1)->beat);
        expect_text("2 of 2 notes");
    }
    // a stroke, and a roll from the ringing drum on
    PLAY(BAR(1, FOUR C3(16, TIE("start"))) BAR(2, C3(16, TIE("stop") MARKS(3))));
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    TEST_ASSERT_EQUAL(HIMC_PLAIN, stroke(0)->ornament);
    expect_roll(1, 4, 4, 4, 4);
}

#define CHORD(step, octave, duration, more)                                           \
    "<note><chord/><pitch><step>" #step "</step><octave>" #octave "</octave></pitch>" \
    "<duration>" #duration "</duration><voice>1</voice>" more "</note>"

static void expect_roll_of_two(int index, double beat, double length)
{
    expect_roll(index, beat, length, 4, 4);
    expect_roll(index + 1, beat, length, 4, 4);
    TEST_ASSERT_TRUE(strcmp(stroke(index)->drum, stroke(index + 1)->drum) != 0);
}

// both drums of a roll on two sound, a hand each, however it is written
static void test_a_roll_on_two_drums_has_both(void)
{
    PLAY(BAR(1, FOUR C3(16, MARKS(3)) CHORD(G, 2, 16, MARKS(3))) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(3, score->stroke_count);
    expect_roll_of_two(0, 0, 4);
    expect_text("3 of 3 notes");
    PLAY(BAR(1, FOUR C3(16, MARKS(3)) CHORD(G, 2, 16, "")) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(3, score->stroke_count); // marks of the chord at its first note alone
    expect_roll_of_two(0, 0, 4);
    // one goes on behind the other
    PLAY(BAR(1, FOUR C3(16, MARKS(3)) "<backup><duration>16</duration></backup>" REST(8)
                    NOTE(G, 2, 8, MARKS(3))) BAR(2, NOTE(G, 2, 16, "")));
    TEST_ASSERT_EQUAL(4, score->stroke_count);
    expect_roll(0, 0, 2, 4, 4);
    expect_roll_of_two(1, 2, 2);
    PLAY(BAR(1, FOUR C3(16, MARKS(3)) CHORD(G, 2, 16, "") CHORD(F, 3, 16, "")));
    TEST_ASSERT_EQUAL(2, score->stroke_count); // no third hand
    expect_text("2 of 3 notes");
    expect_text("1 note is not played: both hands are busy (bar 1)");
}

static void test_marks_of_a_chord_are_of_all_its_notes(void)
{
    PLAY(
        BAR(1, FOUR C3(8, ARTICULATION("accent")) CHORD(G, 2, 8, "") C3(8, "") CHORD(G, 2, 8, "")));
    expect_dynamics(4, 5.0, 5.0, 4.0, 4.0);
}

static void test_an_accent_on_a_roll_is_its_beginning(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) DYNAMICS("p") C3(16, ARTICULATION("accent") MARKS(3))));
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    expect_roll(0, 0, 0.3, 3, 2);
    expect_roll(1, 0.3, 3.7, 2, 2);
}

static void test_two_notes_are_played_in_turn(void)
{
#define PAIR(type)                                                           \
    "<notations><ornaments><tremolo type='" type "'>2</tremolo></ornaments>" \
    "</notations>"
    PLAY(BAR(1, FOUR TEMPO(60) C3(4, "<type>half</type>" PAIR("start"))
                    NOTE(G, 2, 4, "<type>half</type>" PAIR("stop")) REST(8)));
    expect_beats(8, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75);
    for (int i = 2; i < 8; i++)
        TEST_ASSERT_EQUAL_STRING(stroke(i - 2)->drum, stroke(i)->drum);
    TEST_ASSERT_TRUE(strcmp(stroke(0)->drum, stroke(1)->drum) != 0);
    expect_text("2 of 2 notes");
}

static void test_graces_are_flam_drag_and_ruff(void)
{
    PLAY(BAR(1, FOUR REST(4) GRACE(C) C3(4, "") GRACE(C) GRACE(C) C3(4, "") GRACE(C) GRACE(C)
                    GRACE(C) C3(4, "")));
    TEST_ASSERT_EQUAL(3, score->stroke_count);
    TEST_ASSERT_EQUAL(HIMC_FLAM, stroke(0)->ornament);
    TEST_ASSERT_EQUAL(HIMC_DRAG, stroke(1)->ornament);
    TEST_ASSERT_EQUAL(HIMC_RUFF, stroke(2)->ornament);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.report, "1 grace"),
                                 made.report); // of the ruff's three
}

static void test_a_grace_on_another_drum_is_a_stroke(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) REST(8) GRACE(G) C3(8, "")));
    expect_beats(2, 1.93, 2.0);
    TEST_ASSERT_TRUE(strcmp(stroke(0)->drum, stroke(1)->drum) != 0);
}

// --- words

static int damps(void)
{
    int count = 0;
    for (int i = 0; i < score->change_count; i++)
        count += score->changes[i].command.id == HIMC_COMMAND_DAMP &&
                 score->changes[i].command.atom[0].number > 0;
    return count;
}

static void test_damped_notes_and_notes_that_ring(void)
{
    PLAY(BAR(1, FOUR C3(2, "") REST(14)) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(1, damps()); // as usual
    PLAY(BAR(1, FOUR WORDS("l.v.") C3(2, "") REST(14)) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(0, damps());
    PLAY(BAR(1, FOUR C3(2, "<notations><tied type='let-ring'/></notations>") REST(14))
             BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(0, damps());
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, WORDS("secco") C3(8, "") C3(8, "")));
    TEST_ASSERT_EQUAL(1, damps());
    PLAY(BAR(1, FOUR C3(12, "") DIRECTION("<damp-all/>") REST(4)) BAR(2, REST(16)));
    TEST_ASSERT_EQUAL(1, damps());
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 3 + lead(), score->changes[0].beat);
}

static void test_sticking_is_kept(void)
{
    static const char *const how[] = {
        "<lyric><text>L</text></lyric>",
        "<notations><technical><fingering>L</fingering></technical></notations>",
        "<notations><technical><other-technical>l</other-technical></technical></notations>"};
    for (int k = 0; k < 3; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") "<measure number='1'>" FOUR C3(4, "%s") C3(4, "%s")
                     C3(8, "") "</measure>" TAIL,
                 how[k], how[k]);
        load(text);
        TEST_ASSERT_EQUAL(HIMC_LEFT, stroke(0)->hand);
        TEST_ASSERT_EQUAL(HIMC_LEFT, stroke(1)->hand);
    }
    PLAY(BAR(1, FOUR WORDS("L") C3(4, "") WORDS("L") C3(4, "") WORDS("R") C3(8, "")));
    TEST_ASSERT_EQUAL(HIMC_LEFT, stroke(0)->hand);
    TEST_ASSERT_EQUAL(HIMC_LEFT, stroke(1)->hand);
    TEST_ASSERT_EQUAL(HIMC_RIGHT, stroke(2)->hand);
}

static void test_spots_hold_until_the_next(void)
{
    static const char *const words[][3] = {{"center", "near rim", "ord."},
                                           {"in der Mitte", "am Rand", "gewöhnlich"},
                                           {"au centre", "près du bord", "normal"},
                                           {"al centro", "sul bordo", "naturale"}};
    for (int k = 0; k < 4; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") "<measure number='1'>" FOUR C3(2, "") WORDS("%s") C3(2, "")
                     C3(2, "") WORDS("%s") C3(2, "") WORDS("%s") C3(8, "") "</measure>" TAIL,
                 words[k][0], words[k][1], words[k][2]);
        load(text);
        const himc_spot spot[] = {HIMC_SPOT_NORMAL, HIMC_SPOT_CENTER, HIMC_SPOT_CENTER,
                                  HIMC_SPOT_RIM, HIMC_SPOT_NORMAL};
        for (int i = 0; i < 5; i++)
            TEST_ASSERT_EQUAL_MESSAGE(spot[i], stroke(i)->spot, words[k][0]);
    }
}

static void test_words_and_noteheads_strike_hoop_and_shell(void)
{
    // until the next word, or of their note alone
    static const struct {
        const char *word;
        himc_spot here, then;
    } row[] = {{"rim shot", HIMC_SPOT_RIMSHOT, HIMC_SPOT_NORMAL},
               {"Rimshot", HIMC_SPOT_RIMSHOT, HIMC_SPOT_NORMAL},
               {"stick click", HIMC_SPOT_CLICK, HIMC_SPOT_NORMAL},
               {"cross-stick", HIMC_SPOT_CROSSSTICK, HIMC_SPOT_CROSSSTICK},
               {"side stick", HIMC_SPOT_CROSSSTICK, HIMC_SPOT_CROSSSTICK},
               {"on rim", HIMC_SPOT_CROSSSTICK, HIMC_SPOT_CROSSSTICK},
               {"rim shots", HIMC_SPOT_RIMSHOT, HIMC_SPOT_RIMSHOT},
               {"on the shell", HIMC_SPOT_SHELL, HIMC_SPOT_SHELL},
               {"near rim", HIMC_SPOT_RIM, HIMC_SPOT_RIM}};
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Snare Drum") "<measure number='1'>" FOUR WORDS("%s") C3(4, "") C3(4, "")
                     WORDS("ord.") C3(8, "") "</measure>" TAIL,
                 row[k].word);
        load(text);
        TEST_ASSERT_EQUAL_MESSAGE(row[k].here, stroke(0)->spot, row[k].word);
        TEST_ASSERT_EQUAL_MESSAGE(row[k].then, stroke(1)->spot, row[k].word);
        TEST_ASSERT_EQUAL_MESSAGE(HIMC_SPOT_NORMAL, stroke(2)->spot, row[k].word);
    }
    load(HEAD PART("Snare Drum") BAR(1, FOUR C3(8, "<notehead>x</notehead>") C3(8, "")) TAIL);
    TEST_ASSERT_EQUAL(HIMC_SPOT_CROSSSTICK, stroke(0)->spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, stroke(1)->spot);
    load(HEAD PART("Hi-Hat") BAR(1, FOUR C3(16, "<notehead>x</notehead>")) TAIL);
    TEST_ASSERT_EQUAL(HIMC_SPOT_RIM, stroke(0)->spot);
    PLAY(BAR(1, FOUR WORDS("rim shot") C3(16, "")));
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, stroke(0)->spot);
    expect_text("1 stroke is played at its usual place: the instrument has no hoop or shell");
}

static void test_a_fermata_on_a_tied_end_is_held(void)
{
#define HELD "<notations><fermata/></notations>"
    PLAY(BAR(1, FOUR TEMPO(120) C3(16, "<tie type='start'/>" MARKS(3)))
             BAR(2, C3(4, "<tie type='stop'/>" HELD) REST(12)));
    expect_roll(0, 0, 5, 4, 4);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1.0, time_between(4, 5)); // twice as long
    PLAY(BAR(1, FOUR TEMPO(120) WORDS("secco") C3(16, "<tie type='start'/>"))
             BAR(2, C3(4, "<tie type='stop'/>" HELD) REST(12)));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1.0, time_between(4, 5));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 5 + lead(), score->changes[0].beat); // damped behind it
}

static void test_a_dot_is_a_short_note_of_the_same_loudness(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) C3(4, "") C3(4, ARTICULATION("staccato")) REST(8)));
    TEST_ASSERT_EQUAL(stroke(0)->nuance, stroke(1)->nuance);
    TEST_ASSERT_EQUAL_DOUBLE(stroke(0)->dynamic, stroke(1)->dynamic);
    TEST_ASSERT_EQUAL(2, score->change_count);
    TEST_ASSERT_EQUAL(HIMC_COMMAND_DAMP, score->changes[0].command.id);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1.5 + lead(), score->changes[0].beat);
}

static void test_a_line_between_notes_or_words_is_a_gliss(void)
{
#define LINE(type) "<notations><glissando type='" type "'/></notations>"
    PLAY(BAR(1, FOUR TEMPO(60) C3(8, LINE("start")) NOTE(D, 3, 8, LINE("stop"))));
    expect_text("third gliss D3 2;");
    TEST_ASSERT_EQUAL_MESSAGE(1, score->change_count, made.text); // it is not damped
    TEST_ASSERT_EQUAL_STRING(stroke(0)->drum, stroke(1)->drum);
    TEST_ASSERT_FLOAT_WITHIN(1e-6, lead(), score->changes[0].beat);
#define DASHES(type) "<direction-type><dashes type='" type "' number='1'/></direction-type>"
    PLAY(BAR(1, FOUR TEMPO(60) C3(8, "") "<direction><direction-type><words>C muta in D</words>"
                                         "</direction-type>" DASHES("start") "</direction>" REST(8))
             BAR(2, REST(4) "<direction>" DASHES("stop") "</direction>" REST(12))
                 BAR(3, NOTE(D, 3, 16, "")));
    expect_text("third gliss D3 3;");
    TEST_ASSERT_EQUAL(1, score->change_count);
    PLAY(BAR(1, FOUR TEMPO(60) C3(16, MARKS(3)) "<backup><duration>8</duration></backup>" WORDS(
                    "gliss. C to D") REST(8)));
    expect_text("third gliss D3 0.25;"); // after the last stroke, too
}

static void test_mallets_and_cloths(void)
{
    PLAY(BAR(1, FOUR WORDS("mit Holzschlägeln") C3(16, ""))
             BAR(2, WORDS("soft sticks") C3(16, "")));
    expect_text("third mallet wood;");
    expect_text("1 change of mallets is not played: a score has one pair");
    PLAY(BAR(1, FOUR DIRECTION("<percussion><stick><stick-type>timpani</stick-type>"
                               "<stick-material>hard</stick-material></stick></percussion>")
                    C3(16, "")));
    expect_text("mallet hard;");
    PLAY(BAR(1, FOUR WORDS("coperto") C3(16, "")) BAR(2, WORDS("scoperto") C3(16, "")));
    TEST_ASSERT_EQUAL(2, score->change_count);
    TEST_ASSERT_EQUAL(HIMC_COMMAND_MUFFLE, score->changes[1].command.id);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 4 + lead(), score->changes[1].beat);
}

static void test_words_about_tuning_move_a_pedal_there(void)
{
    static const char *const words[] = {"muta in D",          "C muta in D",      "change C to D",
                                        "C nach D umstimmen", "changez do en ré", "Do muta in Re"};
    for (int k = 0; k < 6; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") BAR(1, FOUR TEMPO(60) C3(4, "")
                                                 NOTE(G, 2, 12, "")) "<measure number='2'>" REST(4)
                     WORDS("%s") REST(12) "</measure>" BAR(3, REST(16)) BAR(4, NOTE(D, 3, 16, ""))
                         TAIL,
                 words[k]);
        load(text);
        TEST_ASSERT_TRUE_MESSAGE(score->change_count > 0, words[k]);
        TEST_ASSERT_EQUAL_MESSAGE(HIMC_COMMAND_GLISS, score->changes[0].command.id, words[k]);
        TEST_ASSERT_TRUE(score->changes[0].beat < lead() + 6);
        TEST_ASSERT_TRUE(score->changes[0].beat > lead() + 5 - 1e-3);
        TEST_ASSERT_EQUAL_STRING(stroke(0)->drum, score->changes[0].drum);
        TEST_ASSERT_EQUAL_STRING(stroke(0)->drum, stroke(2)->drum);
    }
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, WORDS("change A to B") C3(16, "")));
    expect_text("1 word about tuning is not followed: no drum has that pitch and time");
}

// --- instruments

static void test_names_in_four_languages(void)
{
    static const struct {
        const char *name, *made;
    } row[] = {
        {"Kettledrums", "drum "},
        {"Pauken", "drum "},
        {"Timbales", "drum "},
        {"Snare Drum", "instrument snare snare"},
        {"Kleine Trommel", "instrument snare snare"},
        {"Caisse claire", "instrument snare snare"},
        {"Tamburo", "instrument snare snare"},
        {"Große Trommel", "instrument bass-drum"},
        {"Gran Cassa", "instrument bass-drum"},
        {"GROSSE CAISSE", "instrument bass-drum"},
        {"Becken", "instrument crash"},
        {"Piatti", "instrument crash"},
        {"Tam-tam", "instrument tam-tam"},
        {"Triangolo", "instrument triangle"},
        {"Xilofono", "instrument xylophone"},
        {"Marimbaphon", "instrument marimba"},
        {"Vibraphone", "instrument vibraphone"},
        {"Jeu de timbres", "instrument glockenspiel"},
        {"Wood Blocks", "instrument high-block"},
        {"Tempelblöcke", "instrument temple-blocks"},
        {"Bongos", "bongo"},
        {"Cowbell", "instrument cowbell"},
        {"Claves", "instrument claves"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char text[2048];
        snprintf(text, sizeof text, HEAD PART("%s") BAR(1, FOUR NOTE(C, 5, 16, "")) TAIL,
                 row[i].name);
        TEST_ASSERT_TRUE_MESSAGE(import(text), row[i].name);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, row[i].made), row[i].name);
    }
    TEST_ASSERT_FALSE(import(HEAD PART("Violin") BAR(1, FOUR C3(16, "")) TAIL));
    static const char line[] =
        "nothing to play: 1 bar without a note of timpani, drums, cymbals or "
        "keyboard percussion";
    TEST_ASSERT_EQUAL_STRING(line, error.text);
    TEST_ASSERT_FALSE(import(HEAD PART("Timpani") BAR(1, FOUR REST(16)) TAIL));
    TEST_ASSERT_EQUAL_STRING(line, error.text);
}

static void test_a_kit_is_played_by_its_instruments(void)
{
    load(HEAD "<part-list><score-part id='P1'><part-name>Drumset</part-name>"
              "<score-instrument id='A'><instrument-name>Acoustic Bass Drum</instrument-name>"
              "</score-instrument><score-instrument id='B'><instrument-name>x</instrument-name>"
              "</score-instrument><score-instrument id='C'><instrument-name>y</instrument-name>"
              "<instrument-sound>metal.hi-hat</instrument-sound></score-instrument>"
              "<midi-instrument id='A'><midi-channel>10</midi-channel><midi-unpitched>36"
              "</midi-unpitched></midi-instrument><midi-instrument id='B'><midi-channel>10"
              "</midi-channel><midi-unpitched>39</midi-unpitched></midi-instrument>"
              "</score-part></part-list><part id='P1'><measure number='1'>" FOUR
#define DRUM(id)                                                       \
    "<note><unpitched><display-step>F</display-step><display-octave>4" \
    "</display-octave></unpitched><duration>4</duration><instrument id='" id "'/></note>"
                  DRUM("A") DRUM("B") DRUM("C") REST(4) "</measure>" TAIL);
    TEST_ASSERT_EQUAL_STRING("kick", stroke(0)->drum);
    TEST_ASSERT_EQUAL_STRING("snare", stroke(1)->drum);
    TEST_ASSERT_EQUAL_STRING("hats", stroke(2)->drum);
    TEST_ASSERT_EQUAL(HIMC_FOOT, stroke(0)->hand);
}

static void test_several_parts_of_timpani_are_played_together(void)
{
    load(HEAD "<part-list><score-part id='A'><part-name>Timpani I</part-name></score-part>"
              "<score-part id='V'><part-name>Violin</part-name></score-part>"
              "<score-part id='B'><part-name>Timpani II</part-name></score-part></part-list>"
              "<part id='A'>" BAR(
                  1, FOUR DYNAMICS("f")
                         C3(16, "")) "</part>"
                                     "<part id='V'>" BAR(
                                         1, FOUR TEMPO(77) DYNAMICS("ppp") NOTE(
                                                A, 5, 16, "")) "</part>"
                                                               "<part id='B'>" BAR(
                                                                   1, FOUR DYNAMICS("p") REST(8)
                                                                          NOTE(G, 2, 8, "")) TAIL);
    expect_beats(2, 0.0, 2.0);
    expect_dynamics(2, 5.0, 2.0);
    TEST_ASSERT_EQUAL_FLOAT(77, bpm_at(0)); // of any part
}

static void test_tempo_names_and_bars_are_as_a_person_writes_them(void)
{
    PLAY(BAR(12, FOUR TEMPO(90) DYNAMICS("mf") C3(16, "")));
    expect_text("tempo 90 0;");
    expect_text("comment bar 12;");
    expect_text(" tune C3;");
    expect_text(" legato mf normal ");
}

// --- bad files

static void refuse(const char *text, size_t size, const char *expected)
{
    forget();
    error.text[0] = '\0';
    TEST_ASSERT_FALSE(himc_music_import(&made, text, size, "bad.xml", NULL, &error));
    TEST_ASSERT_NULL(strchr(error.text, '\n'));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, expected), error.text);
    TEST_ASSERT_NULL(made.text);
}

static void test_entities_are_refused(void)
{
    static const char bomb[] =
        "<?xml version='1.0'?><!DOCTYPE score-partwise [<!ENTITY a 'aaaaaaaaaaaaaaaa'>"
        "<!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'><!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;'>]>"
        "<score-partwise>&c;</score-partwise>";
    static const char outside[] =
        "<?xml version='1.0'?><!DOCTYPE score-partwise [<!ENTITY a SYSTEM 'file:///etc/passwd'>]>"
        "<score-partwise><part-list>&a;</part-list></score-partwise>";
    static const char parameter[] =
        "<?xml version='1.0'?><!DOCTYPE score-partwise [<!ENTITY % a SYSTEM 'http://x/y'> %a;]>"
        "<score-partwise/>";
    refuse(bomb, strlen(bomb), "line 1: an entity is declared");
    refuse(outside, strlen(outside), "an entity is declared");
    refuse(parameter, strlen(parameter), "an entity is declared");
}

static void test_other_documents_are_refused_by_their_kind(void)
{
#define REFUSE(text, expected) refuse(text, strlen(text), expected)
    REFUSE("<html><body/></html>", "XML of the kind html, expected score-partwise");
    REFUSE("<credit/>", "XML of the kind credit, expected score-partwise");
    REFUSE("<score-timewise/>", "export it as score-partwise");
    REFUSE("<score-partwise/>", "a score without a bar");
    REFUSE("<score-partwise>\n<part>\n</score-partwise>", "line 3: mismatched tag");
    REFUSE("PK\3\4 nothing", "an archive without a score");
    REFUSE("<", "line 1:");
}

static void test_a_deep_or_endless_document_is_refused(void)
{
    enum { MANY = 5000000 };
    char *text = malloc(4 * MANY + 100);
    strcpy(text, "<a>");
    for (int i = 0; i < MANY; i++)
        memcpy(text + 3 + 3 * i, "<a>", 4);
    refuse(text, 3 + 3 * MANY, "elements too deep for a score");
    for (int i = 0; i < MANY; i++)
        memcpy(text + 3 + 4 * i, "<b/>", 5);
    refuse(text, 3 + 4 * MANY, "more elements than a score has");
    free(text);
}

static void test_a_file_of_100_MB_is_refused_by_its_size(void)
{
    size_t size = (size_t)100 << 20;
    char *text = calloc(size, 1);
    memcpy(text, "<a>", 3);
    refuse(text, size, "too long, expected 64 MiB of MusicXML");
    free(text);
}

static void test_endless_jumps_end(void)
{
    PLAY(BAR(1, FOUR C3(16, "") "<barline><repeat direction='backward' times='31'/></barline>") BAR(
        2, C3(16, "") "<barline><repeat direction='backward' times='999999999'/></barline>")
             BAR(3, C3(16, "") WORDS("D.C.") WORDS("D.S.")));
    TEST_ASSERT_EQUAL(31 + 2 + 1 + 3, score->stroke_count);
}

static const char whole[] = HEAD PART("Timpani")
    BAR(1, FOUR TEMPO(100) WORDS("muta in D") DYNAMICS("p") GRACE(C) C3(4, MARKS(3)) C3(12, ""))
        BAR(2, REPEAT("forward") NOTE(G, 2, 16, MARKS(2)) REPEAT("backward")) TAIL;

static void test_a_file_cut_anywhere_is_refused_in_a_line(void)
{
    load(whole);
    // but for white space behind it
    for (size_t size = 0; size + 1 < strlen(whole); size += 7)
        refuse(whole, size, "line ");
}

static void test_a_file_with_random_edits_is_read_or_refused_in_a_line(void)
{
    unsigned state = 1;
    char text[sizeof whole];
    for (int run = 0; run < 4000; run++) {
        memcpy(text, whole, sizeof whole);
        for (int k = 0; k < 1 + run % 4; k++) {
            state = state * 1664525 + 1013904223;
            size_t at = (state >> 8) % (sizeof whole - 1);
            state = state * 1664525 + 1013904223;
            text[at] = (char)(run % 2 ? '0' + (state >> 16) % 75 : (state >> 16) % 255 + 1);
        }
        forget();
        error.text[0] = '\0';
        if (himc_music_import(&made, text, strlen(text), "x", NULL, &error)) {
            score = himc_score_parse(made.text, "made.txt", NULL, &error);
            TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
        } else {
            TEST_ASSERT_TRUE(error.text[0] && !strchr(error.text, '\n'));
        }
    }
}

// the same, in UTF-16 as some programs write it
static void test_utf_16_is_read(void)
{
    const char *text = "<score-partwise>" PART("Timpani") BAR(1, FOUR C3(16, "")) TAIL;
    size_t size = 2;
    char *wide = calloc(2 * strlen(text) + 3, 1);
    memcpy(wide, "\xFF\xFE", 2);
    for (const char *c = text; *c; c++, size += 2)
        wide[size] = *c;
    TEST_ASSERT_EQUAL_PTR(himc_music_import, himc_score_maker_of(wide, size));
    TEST_ASSERT_TRUE_MESSAGE(himc_music_import(&made, wide, size, "x", NULL, &error), error.text);
    free(wide);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_notes_are_strokes_on_their_beats);
    RUN_TEST(test_voices_and_chords_sound_together);
    RUN_TEST(test_a_pickup_is_as_long_as_its_notes);
    RUN_TEST(test_an_empty_bar_is_as_long_as_its_time_signature);
    RUN_TEST(test_a_transposing_part_sounds_as_it_is_transposed);
    RUN_TEST(test_tied_notes_are_one_stroke);
    RUN_TEST(test_cue_notes_are_left_out_and_counted_with_their_bars);
    RUN_TEST(test_what_is_not_played_has_its_bar_and_reason);
    RUN_TEST(test_repeats_and_endings_are_played);
    RUN_TEST(test_endings_without_a_number_or_a_stop_lose_no_bar);
    RUN_TEST(test_numbers_beyond_music_are_read_and_lose_nothing);
    RUN_TEST(test_graces_at_the_end_are_counted);
    RUN_TEST(test_an_accent_over_a_rest_is_not_the_next_note_s);
    RUN_TEST(test_a_repeat_is_played_as_often_as_it_says);
    RUN_TEST(test_da_capo_goes_to_fine_without_repeats);
    RUN_TEST(test_dal_segno_goes_to_the_coda);
    RUN_TEST(test_tempo_marks_words_and_numbers);
    RUN_TEST(test_a_ritardando_slows_evenly_to_a_tempo);
    RUN_TEST(test_a_fermata_holds);
    RUN_TEST(test_dynamics_hold_until_the_next);
    RUN_TEST(test_a_hairpin_leads_to_its_end);
    RUN_TEST(test_a_word_leads_to_the_next_dynamic);
    RUN_TEST(test_marks_of_a_note_are_its_nuance);
    RUN_TEST(test_fp_is_loud_once);
    RUN_TEST(test_two_strokes_through_the_stem_are_measured);
    RUN_TEST(test_three_strokes_are_a_roll_unless_measured);
    RUN_TEST(test_three_strokes_under_a_fermata_are_a_roll);
    RUN_TEST(test_a_trill_is_a_roll);
    RUN_TEST(test_a_hairpin_acts_within_a_roll);
    RUN_TEST(test_graces_come_before_a_roll);
    RUN_TEST(test_notes_above_high_b_are_played);
    RUN_TEST(test_a_roll_ends_with_its_note_at_any_tempo);
    RUN_TEST(test_a_roll_tied_to_a_plain_note_ends_with_a_stroke);
    RUN_TEST(test_a_roll_on_two_drums_has_both);
    RUN_TEST(test_marks_of_a_chord_are_of_all_its_notes);
    RUN_TEST(test_an_accent_on_a_roll_is_its_beginning);
    RUN_TEST(test_two_notes_are_played_in_turn);
    RUN_TEST(test_graces_are_flam_drag_and_ruff);
    RUN_TEST(test_a_grace_on_another_drum_is_a_stroke);
    RUN_TEST(test_damped_notes_and_notes_that_ring);
    RUN_TEST(test_sticking_is_kept);
    RUN_TEST(test_spots_hold_until_the_next);
    RUN_TEST(test_words_and_noteheads_strike_hoop_and_shell);
    RUN_TEST(test_a_fermata_on_a_tied_end_is_held);
    RUN_TEST(test_a_dot_is_a_short_note_of_the_same_loudness);
    RUN_TEST(test_a_line_between_notes_or_words_is_a_gliss);
    RUN_TEST(test_mallets_and_cloths);
    RUN_TEST(test_words_about_tuning_move_a_pedal_there);
    RUN_TEST(test_names_in_four_languages);
    RUN_TEST(test_a_kit_is_played_by_its_instruments);
    RUN_TEST(test_several_parts_of_timpani_are_played_together);
    RUN_TEST(test_tempo_names_and_bars_are_as_a_person_writes_them);
    RUN_TEST(test_entities_are_refused);
    RUN_TEST(test_other_documents_are_refused_by_their_kind);
    RUN_TEST(test_a_deep_or_endless_document_is_refused);
    RUN_TEST(test_a_file_of_100_MB_is_refused_by_its_size);
    RUN_TEST(test_endless_jumps_end);
    RUN_TEST(test_a_file_cut_anywhere_is_refused_in_a_line);
    RUN_TEST(test_a_file_with_random_edits_is_read_or_refused_in_a_line);
    RUN_TEST(test_utf_16_is_read);
    return UNITY_END();
}
