/// MusicXML: words, noteheads and marks of drums and cymbals; what is not played is counted.
#define _XOPEN_SOURCE 700
#include "made.h"

#define DRUM(step, octave, duration, more)                                                 \
    "<note><unpitched><display-step>" #step "</display-step><display-octave>" #octave      \
    "</display-octave></unpitched><duration>" #duration "</duration><voice>1</voice>" more \
    "</note>"
#define SNARE(duration, more) DRUM(C, 5, duration, more)
#define HATS(duration, more) DRUM(G, 5, duration, more)
#define KIT(body) load(HEAD PART("Drum Set") body TAIL)
#define HEADED(name) "<notehead>" name "</notehead>"
#define TECHNICAL(t) "<notations><technical><" t "/></technical></notations>"

/// How many lines of the score do that to a drum.
static int changes(const char *drum, himc_command_id id, double value)
{
    int count = 0;
    for (int i = 0; i < score->change_count; i++)
        count += strcmp(score->changes[i].drum, drum) == 0 && score->changes[i].command.id == id &&
                 score->changes[i].command.atom[0].number == value;
    return count;
}

static void test_a_bell_of_a_ride_is_struck(void)
{
    static const char *const words[] = {"bell", "on the bell", "Kuppe", "sulla cupola"};
    for (int k = 0; k < 4; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Ride Cymbal") "<measure number='1'>" FOUR C3(4, "") WORDS("%s")
                     C3(4, "") C3(4, "") WORDS("ord.") C3(4, "") "</measure>" TAIL,
                 words[k]);
        load(text);
        const himc_spot spot[] = {HIMC_SPOT_NORMAL, HIMC_SPOT_CENTER, HIMC_SPOT_CENTER,
                                  HIMC_SPOT_NORMAL};
        for (int i = 0; i < 4; i++)
            TEST_ASSERT_EQUAL_MESSAGE(spot[i], stroke(i)->spot, words[k]);
    }
    KIT(BAR(1, FOUR DRUM(F, 5, 8, HEADED("diamond")) DRUM(F, 5, 8, HEADED("x"))));
    TEST_ASSERT_EQUAL_STRING("ride", stroke(0)->drum);
    TEST_ASSERT_EQUAL(HIMC_SPOT_CENTER, stroke(0)->spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, stroke(1)->spot);
}

static void test_a_circle_at_the_hats_opens_them(void)
{
    static const char *const open[] = {HEADED("circle-x"), TECHNICAL("open"),
                                       TECHNICAL("open-string")};
    for (int k = 0; k < 3; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Drum Set") BAR(1, FOUR HATS(4, HEADED("x")) HATS(4, "%s")
                                                  HATS(8, TECHNICAL("stopped"))) TAIL,
                 open[k]);
        load(text);
        TEST_ASSERT_EQUAL(3, score->stroke_count);
        TEST_ASSERT_EQUAL_STRING("hats", stroke(1)->drum);
        TEST_ASSERT_EQUAL_MESSAGE(1, changes("hats", HIMC_COMMAND_PEDAL, 0), made.text);
        TEST_ASSERT_EQUAL(2, changes("hats", HIMC_COMMAND_PEDAL, 1));
    }
    KIT(BAR(1, FOUR SNARE(16, HEADED("circle-x"))));
    TEST_ASSERT_EQUAL(HIMC_SPOT_CLICK, stroke(0)->spot);
}

static void test_notes_in_parentheses_are_softer(void)
{
    KIT(BAR(1, FOUR SNARE(8, "") SNARE(8, "<notehead parentheses='yes'>normal</notehead>")));
    expect_dynamics(2, 4.0, 2.0);
    KIT(BAR(1, FOUR SNARE(8, "") SNARE(8, ARTICULATION("unstress"))));
    expect_dynamics(2, 4.0, 2.0);
}

static void test_words_about_snares_move_the_wires(void)
{
    static const char *const words[][2] = {{"snares off", "snares on"},
                                           {"Snares Off", "with snares"},
                                           {"ohne Schnarrsaiten", "mit Schnarrsaiten"},
                                           {"sans timbre", "avec timbre"},
                                           {"senza corde", "colle corde"}};
    for (int k = 0; k < 5; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Snare Drum") "<measure number='1'>" FOUR WORDS("%s") C3(8, "")
                     WORDS("%s") C3(8, "") "</measure>" TAIL,
                 words[k][0], words[k][1]);
        load(text);
        TEST_ASSERT_EQUAL_MESSAGE(1, changes("snare", HIMC_COMMAND_WIRES, 0), words[k][0]);
        TEST_ASSERT_EQUAL_MESSAGE(1, changes("snare", HIMC_COMMAND_WIRES, 1), words[k][1]);
        TEST_ASSERT_FLOAT_WITHIN(1e-4, stroke(0)->beat, score->changes[0].beat);
        TEST_ASSERT_FLOAT_WITHIN(1e-4, stroke(1)->beat, score->changes[1].beat);
    }
    load(HEAD PART("Tom-tom") BAR(1, FOUR WORDS("snares off") C3(16, "")) TAIL);
    expect_text("1 word about snares is not followed: no drum of the part has any");
}

static void test_a_choked_cymbal_is_damped_at_its_end(void)
{
    static const char *const how[] = {
        WORDS("choke") DRUM(A, 5, 4, ""),
        DRUM(A, 5, 4,
             "<notations><articulations><other-articulation>choke</other-articulation>"
             "</articulations></notations>"),
        DRUM(A, 5, 4, "") DIRECTION("<damp/>")};
    for (int k = 0; k < 3; k++) {
        char text[4096];
        snprintf(text, sizeof text, HEAD PART("Drum Set") BAR(1, FOUR "%s" REST(12)) TAIL, how[k]);
        load(text);
        TEST_ASSERT_EQUAL_STRING("crash", stroke(0)->drum);
        TEST_ASSERT_EQUAL_MESSAGE(1, changes("crash", HIMC_COMMAND_DAMP, 1), made.text);
        TEST_ASSERT_FLOAT_WITHIN(1e-3, stroke(0)->beat + 1, score->changes[0].beat);
    }
}

// a snare drum's are double, a z on the stem is pressed; those of a tom and of timpani single
static void test_rolls_are_of_the_kind_of_their_drum(void)
{
#define SIGN(o) "<notations><ornaments>" o "</ornaments></notations>"
#define Z SIGN("<tremolo type='unmeasured'>0</tremolo>")
    KIT(BAR(1, FOUR DRUM(C, 5, 8, MARKS(3)) DRUM(C, 5, 8, SIGN("<trill-mark/>")))
            BAR(2, DRUM(C, 5, 8, Z) DRUM(E, 5, 8, MARKS(3))));
    const himc_ornament kind[] = {HIMC_ROLL_DOUBLE, HIMC_ROLL_DOUBLE, HIMC_ROLL_PRESS,
                                  HIMC_ROLL_SINGLE};
    TEST_ASSERT_EQUAL_MESSAGE(4, score->stroke_count, made.text);
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_EQUAL_MESSAGE(kind[i], stroke(i)->ornament, made.text);
    PLAY(BAR(1, FOUR C3(16, Z)));
    expect_roll(0, 0, 4, 4, 4);
}

static void test_feet_leave_a_roll_to_the_hands(void)
{
    KIT(BAR(1, FOUR SNARE(16, MARKS(3)) "<backup><duration>16</duration></backup>" DRUM(F, 4, 4, "")
                   DRUM(F, 4, 4, "") DRUM(F, 4, 8, "")));
    TEST_ASSERT_EQUAL_MESSAGE(4, score->stroke_count, made.text);
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_EQUAL(strcmp(stroke(i)->drum, "snare") == 0 ? 4 : 0, stroke(i)->length);
}

static void test_accents_are_played_or_counted(void)
{
    // within a roll it begins anew
    PLAY(BAR(1, FOUR TEMPO(60) DYNAMICS("p") C3(16, "<tie type='start'/>" MARKS(3)))
             BAR(2, DYNAMICS("sfz") C3(16, "<tie type='stop'/>" MARKS(3))));
    TEST_ASSERT_EQUAL_MESSAGE(3, score->stroke_count, made.text);
    expect_roll(0, 0, 4, 2, 2);
    expect_roll(1, 4, 0.2, 5, 2);
    expect_roll(2, 4.2, 3.8, 2, 2);
    // a short roll sinks from it
    PLAY(BAR(1, FOUR TEMPO(60) DYNAMICS("p") C3(1, ARTICULATION("accent") MARKS(4)) REST(15)));
    expect_roll(0, 0, 0.25, 3, 2);
    // of two notes in turn the first has it
    PLAY(BAR(1, FOUR TEMPO(60) DYNAMICS("p")
                    C3(4, "<type>half</type><notations><ornaments><tremolo type='start'>1"
                          "</tremolo></ornaments><articulations><accent/></articulations>"
                          "</notations>")
                        NOTE(G, 2, 4,
                             "<type>half</type><notations><ornaments><tremolo type='stop'>"
                             "1</tremolo></ornaments></notations>") REST(8)));
    expect_dynamics(4, 3.0, 2.0, 2.0, 2.0);
    TEST_ASSERT_EQUAL(HIMC_ACCENT, stroke(0)->nuance);
    TEST_ASSERT_EQUAL(HIMC_LEGATO, stroke(2)->nuance);
    // over a rest, and over a note that is not struck again
    PLAY(BAR(4, FOUR C3(4, "") DYNAMICS("sfz") REST(4) C3(8, "<tie type='start'/>"))
             BAR(5, C3(16, "<tie type='stop'/>" ARTICULATION("accent"))));
    expect_text("2 accents are not played: no stroke begins there (bars 4 5)");
}

static void test_signs_without_a_way_to_play_them_are_counted(void)
{
    PLAY(BAR(1, FOUR C3(8, ARTICULATION("doit")) C3(8, "")) BAR(2, C3(16, TECHNICAL("up-bow"))));
    expect_text("2 signs of notes are not played: strokes have no way for them (bars 1 2)");
    PLAY(BAR(1, FOUR C3(8, ARTICULATION("stress")) C3(8, ARTICULATION("soft-accent"))));
    TEST_ASSERT_EQUAL(HIMC_TENUTO, stroke(0)->nuance);
    TEST_ASSERT_NULL(strstr(made.text, "not played"));
}

#define NAMED(id, name, key)                                                          \
    "<score-instrument id='" id "'><instrument-name>" name "</instrument-name>"       \
    "</score-instrument><midi-instrument id='" id "'><midi-channel>10</midi-channel>" \
    "<midi-unpitched>" #key "</midi-unpitched></midi-instrument>"
#define PERCUSSION(part, names, body)                                                \
    load(HEAD "<part-list><score-part id='P1'><part-name>" part "</part-name>" names \
              "</score-part></part-list><part id='P1'>" body TAIL)
#define BY(id, more) DRUM(F, 4, 8, "<instrument id='" id "'/>" more)

static void test_a_bass_drum_without_a_kit_is_struck_by_hands(void)
{
    // by its name, or by a roll
    PERCUSSION("Percussion", NAMED("B", "Gran Cassa", 37) NAMED("C", "Cymbal", 50),
               BAR(1, FOUR BY("B", "") BY("C", "")));
    TEST_ASSERT_EQUAL_STRING("bass-drum", stroke(0)->drum);
    PERCUSSION("Percussion", NAMED("B", "Bass Drum", 36),
               BAR(1, FOUR BY("B", "") BY("B", MARKS(3))));
    TEST_ASSERT_EQUAL_STRING("bass-drum", stroke(0)->drum);
    TEST_ASSERT_EQUAL_STRING("bass-drum", stroke(1)->drum);
    expect_roll(1, 2, 2, 4, 4);
    PERCUSSION("Drumset", NAMED("B", "B. D.", 37) NAMED("S", "Snare", 39),
               BAR(1, FOUR BY("B", "") BY("B", MARKS(3))));
    TEST_ASSERT_EQUAL_STRING("bass-drum", stroke(0)->drum);
    // of a kit it is a foot's, and its roll is left out
    PERCUSSION("Percussion", NAMED("B", "Bass Drum", 37) NAMED("H", "Hi-Hat", 43),
               BAR(1, FOUR BY("B", "") BY("H", "")) BAR(2, BY("H", "") BY("B", MARKS(3))));
    TEST_ASSERT_EQUAL(3, score->stroke_count);
    TEST_ASSERT_EQUAL_STRING("kick", stroke(0)->drum);
    expect_text("1 roll is not played: a foot plays none (bar 2)");
    PERCUSSION("Drumset", NAMED("B", "Bass Drum", 37) NAMED("S", "Snare", 39),
               BAR(1, FOUR BY("B", "") BY("S", "")));
    TEST_ASSERT_EQUAL_STRING("kick", stroke(0)->drum);
}

// of a tremolo that is too fast on two drums and of its notes
static void test_lost_strokes_of_a_tremolo_are_counted(void)
{
    load(HEAD PART("Timpani") BAR(
        3, FOUR TEMPO(160) NOTE(
               D, 2, 16,
               MARKS(2)) "<backup><duration>16"
                         "</duration></backup>" NOTE(
                             A, 2, 16,
                             MARKS(2)) "<backup><duration>16</duration></backup>" NOTE(F, 3, 16,
                                                                                       MARKS(2)))
             TAIL);
    TEST_ASSERT_TRUE(score->stroke_count < 3 * 16);
    int lost = 3 * 16 - score->stroke_count, notes = 0, strokes = 0;
    const char *line = strstr(made.report, " not played: both hands are busy (bar 3)");
    TEST_ASSERT_NOT_NULL_MESSAGE(line, made.report);
    line = strchr(made.report, '\n') + 1;
    for (const char *end; (end = strchr(line, '\n')); line = end + 1) {
        if (strstr(line, " of tremolos, rolls") && strstr(line, " of tremolos, rolls") < end)
            strokes += atoi(line);
        else if (strstr(line, "not played: both") && strstr(line, "not played: both") < end)
            notes += atoi(line);
    }
    TEST_ASSERT_EQUAL_MESSAGE(lost, notes + strokes, made.report);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_bell_of_a_ride_is_struck);
    RUN_TEST(test_a_circle_at_the_hats_opens_them);
    RUN_TEST(test_notes_in_parentheses_are_softer);
    RUN_TEST(test_words_about_snares_move_the_wires);
    RUN_TEST(test_a_choked_cymbal_is_damped_at_its_end);
    RUN_TEST(test_rolls_are_of_the_kind_of_their_drum);
    RUN_TEST(test_feet_leave_a_roll_to_the_hands);
    RUN_TEST(test_accents_are_played_or_counted);
    RUN_TEST(test_signs_without_a_way_to_play_them_are_counted);
    RUN_TEST(test_a_bass_drum_without_a_kit_is_struck_by_hands);
    RUN_TEST(test_lost_strokes_of_a_tremolo_are_counted);
    return UNITY_END();
}
