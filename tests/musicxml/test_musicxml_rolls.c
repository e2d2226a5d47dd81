/// MusicXML: tremolos, rolls, graces, and six reports of users of MuseScore.
#define _XOPEN_SOURCE 700
#include "made.h"

static void test_two_strokes_through_the_stem_are_measured(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) C3(4, MARKS(1)) C3(4, MARKS(2)) REST(8)));
    expect_beats(6, 0.0, 0.5, 1.0, 1.25, 1.5, 1.75);
    // an eighth has a flag already
    PLAY(BAR(1, FOUR TEMPO(60) C3(2, "<type>eighth</type>" MARKS(1)) REST(14)));
    expect_beats(2, 0.0, 0.25);
    expect_text("1 of 1 notes for timpani");
    // an accent and a hand are of the first
    PLAY(BAR(1, FOUR TEMPO(60) DIRECTION("<words>L</words>")
                    C3(4, "<notations><ornaments><tremolo type='single'>2</tremolo></ornaments>"
                          "<articulations><accent/></articulations></notations>") REST(12)));
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(i ? HIMC_LEGATO : HIMC_ACCENT, stroke(i)->nuance);
        TEST_ASSERT_EQUAL(i % 2 ? HIMC_RIGHT : HIMC_LEFT, stroke(i)->hand);
    }
}

// musescore#20883: three are a roll, but measured where they are slow, or where it says so
static void test_three_strokes_are_a_roll_unless_measured(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(16, MARKS(3))));
    TEST_ASSERT_EQUAL(1, score->stroke_count);
    expect_roll(0, 0, 4, 4, 4);
    PLAY(BAR(1, FOUR TEMPO(54) C3(16, MARKS(3)))); // an Adagio
    expect_roll(0, 0, 4, 4, 4);
    PLAY(BAR(1, FOUR TEMPO(40) C3(4, MARKS(3)) REST(12)));
    TEST_ASSERT_EQUAL(8, score->stroke_count);
    PLAY(BAR(1, FOUR TEMPO(66) WORDS("gemessen") C3(4, MARKS(3)) REST(12)));
    TEST_ASSERT_EQUAL(8, score->stroke_count);
    // faster than two hands
    PLAY(BAR(1, FOUR TEMPO(100) WORDS("gemessen") C3(16, MARKS(3))));
    expect_roll(0, 0, 4, 4, 4);
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
    // of another voice
    PLAY(BAR(
        1,
        FOUR TEMPO(40) NOTE(
            G, 2, 16,
            "<notations><fermata/></notations>") "<backup><duration>16</duration></backup>" C3(4,
                                                                                               "")
            C3(12, MARKS(3))));
    TEST_ASSERT_EQUAL(3, score->stroke_count);
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
    // a line that nothing ends is of the notes tied to its first
    PLAY(BAR(1, FOUR C3(4, WAVY("start")) C3(4, "") C3(4, TIE("start")) C3(4, TIE("stop"))));
    expect_beats(3, 0.0, 1.0, 2.0);
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
static void test_a_roll_on_two_bars_has_both(void)
{
    load(HEAD PART("Marimba")
             BAR(1, FOUR NOTE(C, 4, 16, MARKS(3)) "<note><chord/><pitch><step>E</step><octave>4"
                                                  "</octave></pitch><duration>16</duration>"
                                                  "<voice>1</voice></note>") TAIL);
    expect_text("2 of 2 notes for marimba are played");
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    expect_roll(0, 0, 4, 4, 4);
    expect_roll(1, 0, 4, 4, 4);
    TEST_ASSERT_EQUAL_STRING("C4", stroke(0)->part);
    TEST_ASSERT_EQUAL_STRING("E4", stroke(1)->part);
}

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
    // a fermata: both are rolled to its end
    PLAY(BAR(1, FOUR C3(8, "<tie type='start'/>" MARKS(3)) CHORD(G, 2, 8, "<tie type='start'/>")
                    C3(8, "<tie type='stop'/><notations><fermata/></notations>")
                        CHORD(G, 2, 8, "<tie type='stop'/>")));
    TEST_ASSERT_EQUAL_MESSAGE(2, score->stroke_count, made.text);
    expect_roll_of_two(0, 0, 4);
}

static void test_an_accent_on_a_roll_is_its_beginning(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) DYNAMICS("p") C3(16, ARTICULATION("accent") MARKS(3))));
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    expect_roll(0, 0, 0.2, 3, 2);
    expect_roll(1, 0.2, 3.8, 2, 2);
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
    PLAY(BAR(1, FOUR TEMPO(60) C3(4, "<type>half</type>" PAIR("start")) REST(12)));
    expect_beats(1, 0.0); // its second is missing
}

#define BACK "<backup><duration>16</duration></backup>"

static void test_graces_are_flam_drag_and_ruff(void)
{
#define SLOW_GRACE                                                  \
    "<note><grace/><pitch><step>C</step><octave>3</octave></pitch>" \
    "<voice>1</voice><type>eighth</type></note>"
    PLAY(BAR(1, FOUR REST(4) GRACE(C) C3(4, "") GRACE(C) GRACE(C) C3(4, "")
                    SLOW_GRACE SLOW_GRACE C3(4, "")));
    TEST_ASSERT_EQUAL(3, score->stroke_count);
    TEST_ASSERT_EQUAL(HIMC_FLAM, stroke(0)->ornament);
    TEST_ASSERT_EQUAL(HIMC_DRAG, stroke(1)->ornament);
    TEST_ASSERT_EQUAL(HIMC_RUFF, stroke(2)->ornament);
    // a ruff of four: three softer strokes before the beat, hand by hand
    PLAY(BAR(1, FOUR TEMPO(60) REST(4) GRACE(C) GRACE(C) GRACE(C) C3(4, "")));
    expect_beats(4, 0.79, 0.86, 0.93, 1.0);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_TRUE(stroke(i)->hand != stroke(i + 1)->hand);
        TEST_ASSERT_TRUE(stroke(i)->dynamic < stroke(3)->dynamic - 0.1);
    }
    // also before the first note of a piece
    PLAY(BAR(1, FOUR TEMPO(120) GRACE(C) GRACE(C) GRACE(C) C3(16, "")));
    expect_beats(4, -0.42, -0.28, -0.14, 0.0);
}

// a hairpin that ends a 16th before the bar, fp on a short roll, a grace on the roll's drum: the
// roll gives way to the note on another drum
static void test_a_note_on_another_drum_after_a_roll_is_never_lost(void)
{
    static const int tempi[] = {60, 90, 120, 144, 160};
    for (int i = 0; i < 5; i++) {
        char text[4096];
        snprintf(
            text, sizeof text,
            HEAD PART("Timpani") BAR(
                1, FOUR "<sound tempo='%d'/>" DYNAMICS("p") WEDGE("crescendo") NOTE(
                       G, 2, 16,
                       MARKS(3)) "<direction><direction-type><wedge type='stop'/></direction-type>"
                                 "<offset>-1</offset></direction>")
                BAR(2, DYNAMICS("f") C3(4, "") REST(4) DYNAMICS("fp") NOTE(G, 2, 4, MARKS(3))
                           C3(4, "")) BAR(3, NOTE(G, 2, 12, MARKS(3)) GRACE(G) C3(4, "")) TAIL,
            tempi[i]);
        load(text);
        int plain = 0;
        for (int k = 0; k < score->stroke_count; k++)
            plain += strcmp(stroke(k)->drum, "third") == 0;
        TEST_ASSERT_EQUAL_MESSAGE(3, plain, made.text);
        expect_roll(0, 0, 4, 2, 5);
        expect_text("6 of 6 notes for timpani are played");
    }
}

#define ON(more) \
    "<note><pitch><step>%c</step><octave>%c</octave></pitch><duration>%d</duration>" more "</note>"

// a roll of `length` 16ths and a note on another drum: all pairs of four drums, 4 beats each
static void load_pairs(int tempo, int length)
{
    static const char *const drums[] = {"F2", "B2", "C3", "G3"};
    static const char *const types[] = {"", "<type>16th</type>", "<type>eighth</type>",
                                        "<type>eighth</type><dot/>", "<type>quarter</type>"};
    char text[16384];
    int n = snprintf(text, sizeof text,
                     HEAD PART("Timpani") "<measure number='1'>" FOUR "<sound tempo='%d'/>", tempo);
    for (int k = 0; k < 16; k++) {
        const char *from = drums[k / 4], *to = drums[k % 4];
        if (from == to)
            continue;
        n += snprintf(text + n, sizeof text - (size_t)n,
                      ON("%s" MARKS(3)) ON("") "<note><rest/><duration>%d</duration></note>",
                      from[0], from[1], length, types[length], to[0], to[1], 4, 12 - length);
    }
    snprintf(text + n, sizeof text - (size_t)n, "</measure>" TAIL);
    load(text);
}

// the strikes of what was made: each pair's roll and note at their beats on their drums, on time
static void expect_struck(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    himc_command play;
    himc_event event;
    int found = 0;
    TEST_ASSERT_TRUE_MESSAGE(p && himc_performance_load_text(p, made.text, "made", &error) &&
                                 himc_command_parse_text(&play, HIMC_PERFORMER, "play", &error) &&
                                 himc_performance_command(p, &play, 0, &error),
                             error.text);
    double end = stroke(score->stroke_count - 1)->beat, all = time_between(-lead(), end);
    for (int i = 0; i < (all + 1) * config.sample_rate / 480; i++) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event))
            for (int k = 0; k < score->stroke_count && event.kind == HIMC_EVENT_STRIKE; k++)
                found += fabs(stroke(k)->beat - event.strike.beat) < 1e-4 &&
                         strcmp(stroke(k)->drum, event.strike.drum) == 0 &&
                         fabs(event.strike.time - event.strike.planned_time) < 0.01;
    }
    TEST_ASSERT_EQUAL_MESSAGE(score->stroke_count, found, made.text);
    TEST_ASSERT_EQUAL(0, himc_performance_measure(p).missed);
    himc_performance_free(p);
}

// it ends earlier, or is one stroke where a hand could not leave it in time
static void test_a_short_roll_gives_way_to_a_note_on_another_drum(void)
{
    static const int tempi[] = {60, 96, 120, 144, 176, 208};
    int rolls = 0, singles = 0;
    for (int i = 0; i < 24; i++) {
        int length = 1 + i % 4, before = singles;
        double beats = length / 4.0;
        load_pairs(tempi[i / 4], length);
        expect_text("24 of 24 notes for timpani are played");
        TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not played"), made.report);
        TEST_ASSERT_EQUAL_MESSAGE(24, score->stroke_count, made.text);
        for (int k = 0; k < 24; k += 2) {
            const himc_stroke *first = stroke(k), *next = stroke(k + 1);
            TEST_ASSERT_FLOAT_WITHIN(1e-3, lead() + 2 * k, first->beat);
            TEST_ASSERT_FLOAT_WITHIN(1e-3, lead() + 2 * k + beats, next->beat);
            TEST_ASSERT_EQUAL(HIMC_PLAIN, next->ornament);
            TEST_ASSERT_TRUE(strcmp(first->drum, next->drum) != 0);
            bool roll = first->ornament == HIMC_ROLL_SINGLE;
            TEST_ASSERT_EQUAL_FLOAT(roll ? beats : 0, first->length);
            TEST_ASSERT_TRUE(roll || first->hand != next->hand);
            rolls += roll;
            singles += !roll;
        }
        if (beats * 60 / tempi[i / 4] > 0.3)
            TEST_ASSERT_EQUAL_MESSAGE(before, singles, made.text);
        if (length == 2 && tempi[i / 4] == 144)
            expect_struck();
    }
    TEST_ASSERT_TRUE(rolls > 100 && singles > 50);
}

// its softer end is short, but the hand may leave already from its louder beginning
static void test_a_short_roll_with_an_accent_gives_way_to_the_farthest_drum(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) NOTE(F, 2, 4, "") C3(4, "") NOTE(G, 3, 4, "") NOTE(B, 3, 4, ""))
             BAR(2, DYNAMICS("sfz") NOTE(F, 2, 2, MARKS(3)) NOTE(B, 3, 2, "") REST(12)));
    expect_text("6 of 6 notes for timpani are played");
    TEST_ASSERT_EQUAL_STRING(stroke(3)->drum, stroke(6)->drum);
}

// faster than the hands could alternate on two drums stroke by stroke: each rolls on its own
static void test_a_fast_tremolo_of_two_notes_is_a_roll_on_both(void)
{
#define OF_TWO(type) \
    "<notations><ornaments><tremolo type='" type "'>3</tremolo></ornaments></notations>"
    for (int k = 0; k < 2; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("%s")
                     BAR(1, FOUR TEMPO(96) NOTE(C, 3, 8, "<type>whole</type>" OF_TWO("start"))
                                NOTE(E, 3, 8, "<type>whole</type>" OF_TWO("stop"))) TAIL,
                 k ? "Marimba" : "Timpani");
        load(text);
        TEST_ASSERT_EQUAL_MESSAGE(2, score->stroke_count, made.text);
        expect_roll(0, 0, 4, 4, 4);
        expect_roll(1, 0, 4, 4, 4);
    }
}

// on a timpano it is a roll; on bars the note and the next one above, by the key or a sign
static void test_a_trill_on_bars_is_of_two_notes(void)
{
#define TRILL(more) "<notations><ornaments><trill-mark/>" more "</ornaments></notations>"
#define KEY(fifths) "<attributes><key><fifths>" #fifths "</fifths></key></attributes>"
#define F_SHARP                                                                         \
    "<note><pitch><step>F</step><alter>1</alter><octave>4</octave></pitch><duration>16" \
    "</duration><voice>1</voice>" TRILL("") "</note>"
    static const char *const lower = "EEEEDDFE", *const upper[] = {"F", "F#", "F", "F#",
                                                                   "E", "D#", "G", "F#"};
    load(HEAD PART("Xylophone") BAR(1, FOUR NOTE(E, 4, 16, TRILL("")))
             BAR(2, KEY(2) NOTE(E, 4, 16, TRILL("")))
                 BAR(3, NOTE(E, 4, 16, TRILL("<accidental-mark>natural</accidental-mark>"))) BAR(
                     4, KEY(0) NOTE(E, 4, 16, TRILL("<accidental-mark>sharp</accidental-mark>")))
                     BAR(5, KEY(-1) NOTE(D, 4, 16, TRILL("")))
                         BAR(6, KEY(-2) NOTE(D, 4, 16, TRILL(""))) BAR(7, KEY(1) F_SHARP)
                             BAR(8, FOUR NOTE(E, 4, 16, TRILL(""))) TAIL);
    expect_text("8 of 8 notes for xylophone are played");
    TEST_ASSERT_EQUAL_MESSAGE(16, score->stroke_count, made.text);
    for (int i = 0; i < 8; i++) { // in the octave that the instrument has
        TEST_ASSERT_EQUAL(lower[i], stroke(2 * i)->part[0]);
        TEST_ASSERT_EQUAL(strlen(upper[i]) + 1, strlen(stroke(2 * i + 1)->part));
        TEST_ASSERT_EQUAL_STRING_LEN(upper[i], stroke(2 * i + 1)->part, strlen(upper[i]));
    }
}

static void test_a_roll_that_begins_with_another_drum_is_struck_on_the_beat(void)
{
    PLAY(BAR(1, FOUR TEMPO(100) C3(16, MARKS(3)) BACK NOTE(G, 2, 16, "")));
    TEST_ASSERT_EQUAL_MESSAGE(3, score->stroke_count, made.text);
    TEST_ASSERT_FLOAT_WITHIN(1e-6, stroke(0)->beat, stroke(1)->beat);
    TEST_ASSERT_TRUE(strcmp(stroke(0)->drum, stroke(1)->drum) != 0);
    TEST_ASSERT_TRUE(stroke(0)->hand != stroke(1)->hand);
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, stroke(2)->ornament);
    expect_text("1 note is played as 1 roll");
}

static void test_a_grace_on_another_drum_is_a_stroke(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) REST(8) GRACE(G) C3(8, "")));
    expect_beats(2, 1.93, 2.0);
    TEST_ASSERT_TRUE(strcmp(stroke(0)->drum, stroke(1)->drum) != 0);
}

#define SECOND(duration, more)                                                  \
    "<note><pitch><step>C</step><octave>3</octave></pitch><duration>" #duration \
    "</duration><voice>2</voice>" more "</note>"
#define REST2(duration) "<note><rest/><duration>" #duration "</duration><voice>2</voice></note>"

// each accent is there, at its beat, louder than the roll, which fills all the time between
static void expect_one_roll(double end, int accents, const double *at)
{
    double now = 0;
    int found = 0;
    for (int i = 0; i < score->stroke_count; i++) {
        const himc_stroke *s = stroke(i);
        TEST_ASSERT_EQUAL_MESSAGE(HIMC_ROLL_SINGLE, s->ornament, made.text);
        TEST_ASSERT_FLOAT_WITHIN(1e-3, now + lead(), s->beat);
        now += s->length;
        if (7 * s->dynamic < 2.5)
            continue;
        TEST_ASSERT_TRUE_MESSAGE(found < accents, made.text);
        TEST_ASSERT_FLOAT_WITHIN(1e-3, at[found++] + lead(), s->beat);
        TEST_ASSERT_FLOAT_WITHIN(0.06, 2, 7 * s->last_dynamic); // one stroke
    }
    TEST_ASSERT_EQUAL_MESSAGE(accents, found, made.text);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, end, now);
}

static void test_an_accent_of_another_voice_is_a_louder_stroke_of_the_roll(void)
{
    static const double at[] = {0, 2, 4, 7};
#define ACCENTS \
    SECOND(4, ARTICULATION("accent")) REST2(4) SECOND(4, ARTICULATION("accent")) REST2(4)
    PLAY(BAR(1, FOUR TEMPO(120) DYNAMICS("p") C3(16, TIE("start") MARKS(3)) BACK ACCENTS)
             BAR(2, C3(16, TIE("stop") MARKS(3)) BACK SECOND(4, ARTICULATION("accent"))
                        SECOND(4, "") REST2(4) SECOND(4, ARTICULATION("accent"))));
    expect_one_roll(8, 4, at);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not played"), made.report);
    // the voice of the accents is written first
    PLAY(BAR(1, FOUR TEMPO(120) DYNAMICS("p") ACCENTS BACK C3(16, MARKS(4))));
    expect_one_roll(4, 2, at);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not played"), made.report);
}

// a hand leaves the roll for the stroke and comes back; where too little is left, it is told
static void test_a_stroke_on_another_drum_takes_a_hand_from_a_roll(void)
{
#define LOW(duration) NOTE(G, 2, duration, "")
    PLAY(BAR(1, FOUR TEMPO(80) DYNAMICS("p") C3(16, MARKS(3)) BACK REST(4) LOW(4) REST(4) LOW(4))
             BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL_MESSAGE(6, score->stroke_count, made.text);
    expect_text("4 of 4 notes");
    expect_roll(0, 0, 1, 2, 2);
    double back = stroke(2)->beat - stroke(1)->beat;
    TEST_ASSERT_TRUE(back > 0.1 && back < 0.5);
    expect_roll(2, 1 + back, 2 - back, 2, 2);
    expect_roll(4, 3 + back, 1 - back, 2, 2);
    // less than half would be left
    PLAY(BAR(1, FOUR TEMPO(80) C3(8, MARKS(3)) REST(8) BACK LOW(2) LOW(2) LOW(2) LOW(2)));
    expect_roll(1, 0, 2, 4, 4);
    PLAY(BAR(1, FOUR TEMPO(120) C3(4, MARKS(3)) REST(12) BACK LOW(2) LOW(2)));
    expect_text("1 note is not played: both hands are busy (bar 1)");
}

static void test_a_louder_voice_strikes_in_a_soft_roll(void)
{
#define OF(voice, d)                                                                          \
    "<direction><direction-type><dynamics><" d "/></dynamics></direction-type><voice>" #voice \
    "</voice></direction>"
    PLAY(
        BAR(1, FOUR TEMPO(120) OF(1, "p") C3(16, MARKS(4)) BACK OF(2, "f") REST2(8) SECOND(8, "")));
    TEST_ASSERT_EQUAL_MESSAGE(3, score->stroke_count, made.text);
    expect_roll(0, 0, 2, 2, 2);
    TEST_ASSERT_FLOAT_WITHIN(0.06, 5, 7 * stroke(1)->dynamic);
    TEST_ASSERT_FLOAT_WITHIN(0.06, 2, 7 * stroke(2)->last_dynamic);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 2, stroke(1)->length + stroke(2)->length);
    // a softer one does not soften it, nor ends its dot the roll
    PLAY(BAR(1, FOUR TEMPO(120) OF(1, "ff") C3(16, "<notations><tied type='let-ring'/><ornaments>"
                                                   "<tremolo type='single'>4</tremolo></ornaments>"
                                                   "</notations>") BACK OF(2, "p") REST2(8)
                    SECOND(8, ARTICULATION("staccato"))) BAR(2, REST(16)) BAR(3, C3(16, "")));
    expect_roll(0, 0, 2, 6, 6);
    expect_roll(1, 2, 2, 6, 6);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "damp 1"), made.text);
}

// a later sign for all leaves the drums alone that are damped already
static void test_each_damp_sign_is_for_what_sounds(void)
{
    char text[100];
    PLAY(BAR(1, FOUR LOW(4) C3(4, MARKS(3)) DIRECTION("<damp/>") REST(8))
             BAR(2, LOW(8) DIRECTION("<damp-all/>") REST(8)));
    snprintf(text, sizeof text, "at %g third damp 1;", 2 + lead());
    expect_text(text);
    snprintf(text, sizeof text, "at %g third damp 1;", 6 + lead());
    TEST_ASSERT_NULL(strstr(made.text, text));
    snprintf(text, sizeof text, "at %g low damp 1;", 6 + lead());
    expect_text(text);
}

// by the standard what is hidden sounds, and a note of a cue's size does; a cue does not
static void test_hidden_notes_sound_but_not_those_that_play_a_roll(void)
{
#define HIDDEN(duration)                                                                          \
    "<note print-object='no'><pitch><step>C</step><octave>3</octave></pitch><duration>" #duration \
    "</duration><voice>2</voice></note>"
    PLAY(BAR(1, FOUR C3(8, MARKS(3)) C3(8, "") BACK HIDDEN(2) HIDDEN(2) HIDDEN(2) HIDDEN(2)));
    TEST_ASSERT_EQUAL_MESSAGE(2, score->stroke_count, made.text);
    expect_roll(0, 0, 2, 4, 4);
    expect_text("4 hidden notes are left out: rolls are played there (bar 1)");
    PLAY(BAR(1, FOUR HIDDEN(8) HIDDEN(8)));
    expect_beats(2, 0.0, 2.0);
    PLAY(BAR(
        1,
        FOUR C3(
            8,
            "<type size='cue'>half</type>") "<note><cue/><pitch><step>C</step><octave>3</octave></pitch>"
                                            "<duration>8</duration></note>"));
    expect_beats(1, 0.0);
}

int main(void)
{
    UNITY_BEGIN();
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
    RUN_TEST(test_an_accent_of_another_voice_is_a_louder_stroke_of_the_roll);
    RUN_TEST(test_a_stroke_on_another_drum_takes_a_hand_from_a_roll);
    RUN_TEST(test_a_louder_voice_strikes_in_a_soft_roll);
    RUN_TEST(test_each_damp_sign_is_for_what_sounds);
    RUN_TEST(test_hidden_notes_sound_but_not_those_that_play_a_roll);
    RUN_TEST(test_a_roll_on_two_bars_has_both);
    RUN_TEST(test_a_note_on_another_drum_after_a_roll_is_never_lost);
    RUN_TEST(test_a_short_roll_gives_way_to_a_note_on_another_drum);
    RUN_TEST(test_a_short_roll_with_an_accent_gives_way_to_the_farthest_drum);
    RUN_TEST(test_a_fast_tremolo_of_two_notes_is_a_roll_on_both);
    RUN_TEST(test_a_trill_on_bars_is_of_two_notes);
    RUN_TEST(test_a_roll_that_begins_with_another_drum_is_struck_on_the_beat);
    return UNITY_END();
}
