/// MusicXML: words and signs that say more or less than before, from nothing, and swing.
#define _XOPEN_SOURCE 700
#include "made.h"

static void test_piu_and_meno_are_a_step_from_what_was_before(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("p") C3(4, "") WORDS("più f") C3(4, "") WORDS("Poco meno f") C3(4, "")
                    WORDS("meno f") C3(4, "")));
    expect_dynamics(4, 2.0, 3.0, 2.5, 1.5);
    // written as a word and a sign, as one sign, and beside each staff
    PLAY(BAR(1,
             FOUR DYNAMICS("p") C3(
                 4, "") "<direction><direction-type><words>più</words></direction-type>"
                        "<direction-type><dynamics><f/></dynamics></direction-type></direction>" C3(
                            4, "") DIRECTION("<dynamics><other-dynamics>più f</other-dynamics>"
                                             "</dynamics>") C3(4, "") WORDS("meno p")
                            WORDS("meno p") C3(4, "")));
    expect_dynamics(4, 2.0, 3.0, 4.0, 5.0);
    // behind a hairpin, louder than its end
    PLAY(BAR(1, FOUR DYNAMICS("p") WEDGE("crescendo") C3(8, "") C3(8, ""))
             BAR(2, WORDS("più f") WEDGE("stop") C3(16, "")));
    expect_dynamics(3, 2.0, 2.5, 4.0);
    PLAY(BAR(1, FOUR WORDS("poco f") C3(8, "") WORDS("p") C3(8, "")));
    TEST_ASSERT_TRUE(stroke(0)->dynamic < 5 / 7.0 && stroke(0)->dynamic > 4 / 7.0);
}

static void test_mosso_and_movimento_are_shares_of_the_tempo(void)
{
    PLAY(BAR(1, FOUR TEMPO(100) C3(16, "")) BAR(2, WORDS("Più mosso") C3(16, ""))
             BAR(3, WORDS("L'istesso tempo") C3(16, "")) BAR(4, WORDS("Meno mosso") C3(16, ""))
                 BAR(5, WORDS("Doppio movimento") C3(16, "")));
    TEST_ASSERT_TRUE(bpm_at(4) > 105 && bpm_at(4) < 130);
    TEST_ASSERT_EQUAL_FLOAT(bpm_at(4), bpm_at(8));
    TEST_ASSERT_TRUE(bpm_at(12) < bpm_at(8) && bpm_at(12) > 80);
    TEST_ASSERT_EQUAL_FLOAT(2 * bpm_at(12), bpm_at(16));
    // poco is less, and a number beside it holds
    PLAY(BAR(1, FOUR TEMPO(100) C3(16, "")) BAR(2, WORDS("un poco più mosso") C3(16, "")) BAR(
        3, WORDS("Più mosso") DIRECTION("<metronome><beat-unit>quarter</beat-unit>"
                                        "<per-minute>140</per-minute></metronome>") C3(16, "")));
    TEST_ASSERT_TRUE(bpm_at(4) > 100 && bpm_at(4) < 112);
    TEST_ASSERT_EQUAL_FLOAT(140, bpm_at(8));
}

static double slowest(const char *words)
{
    char text[2048];
    snprintf(text, sizeof text,
             HEAD PART("Timpani") BAR(1, FOUR TEMPO(120) WORDS("%s") C3(16, ""))
                 BAR(2, WORDS("a tempo") C3(16, "")) TAIL,
             words);
    load(text);
    return bpm_at(3.9);
}

static void test_a_ritardando_is_less_with_poco_and_more_with_molto(void)
{
    double poco = slowest("poco rit."), usual = slowest("rit."), molto = slowest("molto rit.");
    TEST_ASSERT_TRUE(120 > poco + 5 && poco > usual + 5 && usual > molto + 5);
}

static void test_hairpins_come_from_nothing_and_go_there(void)
{
#define CIRCLE(type) DIRECTION("<wedge type='" type "' niente='yes'/>")
    PLAY(BAR(1, FOUR DYNAMICS("mf") CIRCLE("crescendo") C3(16, MARKS(4)))
             BAR(2, WEDGE("stop") DYNAMICS("f") WEDGE("diminuendo") C3(16, MARKS(4)))
                 BAR(3, CIRCLE("stop") DYNAMICS("f") C3(16, "")));
    TEST_ASSERT_EQUAL_MESSAGE(3, score->stroke_count, made.text);
    expect_roll(0, 0, 4, 0, 5);
    expect_roll(1, 4, 4, 5, 0);
    // the circle at the beginning of the diminuendo
    PLAY(BAR(1, FOUR DYNAMICS("f") CIRCLE("diminuendo") C3(16, MARKS(4)))
             BAR(2, WEDGE("stop") C3(16, "")));
    expect_roll(0, 0, 4, 5, 0);
    // also in words, up to a mark that is louder
    PLAY(BAR(1, FOUR DYNAMICS("f") WORDS("dim. al niente") C3(16, MARKS(4)))
             BAR(2, DYNAMICS("ff") C3(16, "")));
    expect_roll(0, 0, 4, 5, 0);
    TEST_ASSERT_FLOAT_WITHIN(0.06, 6, 7 * stroke(1)->dynamic);
}

// at the end of a roll over bars, before a rest and a louder mark, or at the last of some strokes
static void test_al_niente_ends_where_the_notes_end(void)
{
    static const char *const words[] = {"dim. al niente", "morendo", "smorzando", "perdendosi"};
    for (int i = 0; i < 4; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani")
                     BAR(1, FOUR DYNAMICS("f") WORDS("%s") C3(16, "<tie type='start'/>" MARKS(4)))
                         BAR(2, C3(16, "<tie type='stop'/>" MARKS(4))) BAR(3, REST(16))
                             BAR(4, DYNAMICS("ff") C3(16, "")) TAIL,
                 words[i]);
        load(text);
        TEST_ASSERT_EQUAL_MESSAGE(2, score->stroke_count, made.text);
        expect_roll(0, 0, 8, 5, 0);
        TEST_ASSERT_FLOAT_WITHIN(0.06, 6, 7 * stroke(1)->dynamic);
    }
    PLAY(BAR(1, FOUR DYNAMICS("f") C3(4, "") WORDS("morendo") C3(4, "") C3(4, "") C3(4, ""))
             BAR(2, C3(2, "") REST(14)));
    expect_dynamics(5, 5.0, 5.0, 10 / 3.0, 5 / 3.0, 0.0);
}

#define EIGHTHS C3(2, "") C3(2, "") C3(2, "") C3(2, "")

static void expect_swing(double share)
{
    double first = time_between(stroke(0)->beat, stroke(1)->beat),
           both = time_between(stroke(0)->beat, stroke(2)->beat);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, share, first / both);
}

static void test_eighths_swing_and_what_is_finer_does_not(void)
{
#define UNIT(type) "<metronome-note><metronome-type>" type "</metronome-type></metronome-note>"
#define SWING(in) "<sound><swing>" in "</swing></sound>"
    PLAY(BAR(1, FOUR WORDS("Swing") EIGHTHS SWING("<straight/>") EIGHTHS));
    expect_beats(8, 0.0, 2 / 3.0, 1.0, 5 / 3.0, 2.0, 2.5, 3.0, 3.5);
    expect_swing(2 / 3.0);
    PLAY(BAR(1, FOUR WORDS("Swing") EIGHTHS WORDS("Straight") EIGHTHS)
             BAR(2, WORDS("Shuffle") EIGHTHS WORDS("gerade Achtel") EIGHTHS));
    expect_beats(16, 0.0, 2 / 3.0, 1.0, 5 / 3.0, 2.0, 2.5, 3.0, 3.5, 4.0, 14 / 3.0, 5.0, 17 / 3.0,
                 6.0, 6.5, 7.0, 7.5);
    PLAY(BAR(1, FOUR DIRECTION("<metronome>" UNIT("eighth") UNIT(
                    "eighth") "<metronome-relation>equals</metronome-relation>" UNIT("quarter")
                                   UNIT("eighth") "</metronome>") EIGHTHS REST(8)));
    expect_swing(2 / 3.0);
    PLAY(BAR(1, FOUR SWING("<first>3</first><second>2</second>") EIGHTHS REST(8)));
    expect_swing(0.6);
    PLAY(BAR(1, FOUR SWING("<first>2</first><second>1</second><swing-type>16th</swing-type>")
                    C3(1, "") C3(1, "") C3(1, "") C3(1, "") C3(2, "") C3(2, "") REST(8)));
    expect_beats(6, 0.0, 1 / 3.0, 0.5, 5 / 6.0, 1.0, 1.5);
    PLAY(BAR(1, FOUR WORDS("Swing") C3(2, "") C3(1, "") C3(1, "") EIGHTHS REST(4)));
    expect_beats(7, 0.0, 0.5, 0.75, 1.0, 5 / 3.0, 2.0, 8 / 3.0);
}

// the first eighth of each bar is long; that of a pickup is its last, a short one
static void test_eighths_swing_in_bars_and_pickups_of_any_length(void)
{
#define METER(beats, type)                                                                 \
    "<attributes><divisions>4</divisions><time><beats>" #beats "</beats><beat-type>" #type \
    "</beat-type></time></attributes>"
    PLAY(BAR(1, METER(5, 8) WORDS("Swing") EIGHTHS C3(2, "")) BAR(2, METER(2, 4) EIGHTHS));
    expect_beats(9, 0.0, 2 / 3.0, 1.0, 5 / 3.0, 2.0, 2.5, 2.5 + 2 / 3.0, 3.5, 3.5 + 2 / 3.0);
    PLAY(BAR(0, METER(2, 4) WORDS("Swing") C3(2, "")) BAR(1, EIGHTHS));
    expect_beats(5, 1 / 6.0, 0.5, 0.5 + 2 / 3.0, 1.5, 1.5 + 2 / 3.0);
}

static void test_what_belongs_to_a_note_swings_with_it(void)
{
    PLAY(BAR(1, FOUR WORDS("Swing") C3(2, "") WORDS("R") GRACE(C) C3(2, "") C3(2, MARKS(4))
                    C3(2, "<tie type='start'/>") C3(4, "<tie type='stop'/>") REST(4)));
    TEST_ASSERT_EQUAL_MESSAGE(4, score->stroke_count, made.text);
    TEST_ASSERT_EQUAL(HIMC_FLAM, stroke(1)->ornament);
    TEST_ASSERT_EQUAL(HIMC_RIGHT, stroke(1)->hand);
    expect_roll(2, 1, 2 / 3.0, 4, 4);                           // up to the next note
    PLAY(BAR(1, FOUR WORDS("Swing") C3(2, MARKS(4)) REST(14))); // or where one would be
    expect_roll(0, 0, 2 / 3.0, 4, 4);
}

// a line and words that say the same are one gliss, of the line's length
static void test_a_gliss_of_a_line_with_words_is_one(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) WORDS("gliss. C3 to D3")
                    C3(8, "<notations><glissando type='start'/></notations>")
                        NOTE(D, 3, 8, "<notations><glissando type='stop'/></notations>")));
    expect_text("gliss D3 2;");
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not followed"), made.report);
}

static double tempo_of(const char *words)
{
    char text[2048];
    snprintf(text, sizeof text,
             HEAD PART("Timpani") BAR(1, FOUR WORDS("%s") C3(16, "")) BAR(2, C3(16, "")) TAIL,
             words);
    load(text);
    return bpm_at(4);
}

static void test_a_metronome_mark_in_words_is_the_tempo(void)
{
    static const struct {
        const char *words;
        double bpm;
    } marks[] = {
        {"q = 96", 96},
        {"q=96", 96},
        {"♩ = 72", 72},
        {"♩=72", 72},
        {"Allegro (♩ = 140)", 140},
        {"Andante (♩ = c. 80)", 80},
        {"Largo, ca. 44", 44},
        {"c. 80", 80},
        {"♩. = 60", 90},
        {"q. = 60", 90},
        {"h = 60", 120},
        {"♪ = 120", 60},
        {"♩ = 100–110", 105},
        {"M.M. 84", 84},
        {"Vivo \xF0\x9D\x85\x9F = 150", 150},
        {"\xF0\x9D\x85\x98\xF0\x9D\x85\xA5 = 150", 150},
        {"\xF0\x9D\x85\x98\xF0\x9D\x85\xA5\xF0\x9D\x85\xAE = 150", 75},
        {"\xF0\x9D\x85\x9E\xF0\x9D\x85\xAD = 40", 120},
        {"\xEE\xB2\xA5 = 66", 66},
        {"♩ = ♪", 60}, // of 120
        // these are none
        {"♩ = wie vorher", 120},
        {"♪♪ = ♩♪", 120},
        {"♪ ♪ = ♩ ♪", 120},
        {"ca. 20 sec.", 120},
        {"Solo 72", 120},
        {"the = 72", 120},
    };
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++)
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(marks[i].bpm, tempo_of(marks[i].words), marks[i].words);
}

static void test_a_sound_or_a_sign_holds_before_the_number_of_words(void)
{
    PLAY(BAR(1, FOUR "<direction><direction-type><words>Presto (♩ = 190)</words></direction-type>"
                     "<sound tempo='100'/></direction>" C3(16, ""))
             BAR(2, WORDS("♩ = 150") C3(16, "")) BAR(3, WORDS("Tempo primo") C3(16, "")));
    TEST_ASSERT_EQUAL_FLOAT(100, bpm_at(0));
    TEST_ASSERT_EQUAL_FLOAT(150, bpm_at(4));
    TEST_ASSERT_EQUAL_FLOAT(100, bpm_at(8));
}

static void test_a_tempo_with_a_number_is_that_tempo(void)
{
    PLAY(BAR(1, FOUR WORDS("q = 100") C3(16, "")) BAR(2, WORDS("rall.") C3(16, ""))
             BAR(3, WORDS("a tempo (♩ = 90)") C3(16, "")));
    TEST_ASSERT_EQUAL_FLOAT(90, bpm_at(8));
}

#define SPLIT(a, b) DIRECTION("<words>" a "</words><words font-style='italic'>" b "</words>")

static void test_words_in_several_elements_are_one_text(void)
{
    PLAY(BAR(1, FOUR TEMPO(100) C3(16, "")) BAR(2, SPLIT("meno ", "mosso") C3(16, ""))
             BAR(3, "<direction><direction-type><words>Più </words></direction-type>"
                    "<direction-type><words>mosso</words></direction-type></direction>" C3(16, ""))
                 BAR(4, SPLIT("poco ", "rit.") C3(16, "")) BAR(5, WORDS("Tempo I") C3(16, "")));
    double slow = bpm_at(4), back = bpm_at(8), end = bpm_at(15.9);
    TEST_ASSERT_TRUE(slow < 95 && back > slow + 5);
    TEST_ASSERT_TRUE_MESSAGE(end < back - 5 && end > 0.85 * back, made.text); // poco
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, SPLIT("muta ", "C in D") REST(16))
             BAR(3, NOTE(D, 3, 16, "")));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.report, "1 change of pitch by pedal"), made.report);
}

static void test_a_rallentando_ends_at_words_of_tempo_that_are_unknown(void)
{
#define BOLD(text) DIRECTION("<words font-weight='bold'>" text "</words>")
    PLAY(BAR(1, FOUR TEMPO(100) C3(16, "")) BAR(2, WORDS("rall.") C3(16, ""))
             BAR(3, BOLD("Feierlich") C3(16, "")) BAR(4, WORDS("a tempo") C3(16, "")));
    TEST_ASSERT_TRUE_MESSAGE(bpm_at(8) < 80, made.text);
    TEST_ASSERT_EQUAL_FLOAT(bpm_at(8), bpm_at(11));
    TEST_ASSERT_EQUAL_FLOAT(100, bpm_at(12));
}

#define FOUR_OF(a, b, c) a C3(4, "") b C3(4, "") c C3(4, "") C3(4, "")

static void expect_growth(const char *first, const char *second, const char *third)
{
    char text[3000];
    snprintf(text, sizeof text,
             HEAD PART("Timpani")
                 BAR(1, FOUR DYNAMICS("p") FOUR_OF(WORDS("%s"), WORDS("%s"), WORDS("%s")))
                     BAR(2, DYNAMICS("f") C3(16, "")) TAIL,
             first, second, third);
    load(text);
    expect_dynamics(5, 2.0, 2.75, 3.5, 4.25, 5.0);
}

static void test_a_cresc_with_its_syllables_apart_is_one(void)
{
    expect_growth("cresc.", "", "");
    expect_growth("cre", "scen", "do");
    expect_growth("cre -", "scen -", "do");
    expect_growth("cre - - scen - - do", "", "");
    expect_growth("cresc. _ _ _ _", "", "");
    expect_growth("p cresc.", "", "");
    PLAY(BAR(1, FOUR DYNAMICS("f") FOUR_OF(WORDS("dim - in - u - en - do"), "", ""))
             BAR(2, DYNAMICS("p") C3(16, "")));
    expect_dynamics(5, 5.0, 4.25, 3.5, 2.75, 2.0);
    PLAY(BAR(1, FOUR DYNAMICS("f") FOUR_OF(WORDS("di"), WORDS("mi"), WORDS("nuendo")))
             BAR(2, DYNAMICS("p") C3(16, "")));
    expect_dynamics(5, 5.0, 4.25, 3.5, 2.75, 2.0);
}

static void test_a_dynamic_before_other_words_holds(void)
{
    PLAY(BAR(1, FOUR WORDS("pp subito") C3(4, "") WORDS("mf espr.") C3(4, "") WORDS("ff pesante")
                    C3(4, "") WORDS("p leggiero") C3(4, "")));
    expect_dynamics(4, 1.0, 4.0, 6.0, 2.0);
    // a pitch and a name are none
    PLAY(BAR(1, FOUR DYNAMICS("p") C3(4, "") WORDS("F, C, D") C3(4, "") WORDS("f g") C3(8, "")));
    expect_dynamics(3, 2.0, 2.0, 2.0);
}

static void test_two_dynamics_in_one_sign_are_the_attack_and_what_follows(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("f/><p") C3(16, MARKS(4))) BAR(2, C3(16, "")));
    expect_roll(0, 0, stroke(0)->length, 5, 2);
    TEST_ASSERT_TRUE(stroke(0)->length < 1);
    expect_roll(1, stroke(0)->length, 4 - stroke(0)->length, 2, 2);
    TEST_ASSERT_FLOAT_WITHIN(0.05, 2, 7 * stroke(2)->dynamic);
    // with the loudness that is written
    PLAY(BAR(1, FOUR DYNAMICS("mf/><p") C3(8, "") C3(8, "")) BAR(2, DYNAMICS("ff/><mp") C3(16, ""))
             BAR(3, C3(16, "")));
    expect_dynamics(4, 4.0, 2.0, 6.0, 3.0);
}

static void expect_tuned(const char *words, int changes)
{
    char text[2048], say[64];
    snprintf(text, sizeof text,
             HEAD PART("Timpani") BAR(1, FOUR NOTE(F, 2, 8, "") C3(8, ""))
                 BAR(2, WORDS("%s") REST(16)) BAR(3, NOTE(G, 2, 8, "") C3(8, "")) TAIL,
             words);
    snprintf(say, sizeof say, "%d change of pitch by pedal", changes);
    load(text);
    TEST_ASSERT_EQUAL_MESSAGE(changes > 0, strstr(made.report, say) != NULL, made.report);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not followed"), made.report);
}

static void test_a_retuning_is_written_in_many_ways(void)
{
    expect_tuned("sempre secco", 0);
    expect_tuned("muta F in G", 1);
    expect_tuned("F muta G", 1);
    expect_tuned("F to G", 1);
    expect_tuned("F → G", 1);
    expect_tuned("F→G", 1);
    expect_tuned("F - G", 1);
    expect_tuned("Fa in Sol", 1);
    expect_tuned("(F to G, C to C)", 1);
    // in the octave that is written, and to a pitch that a drum has already
    PLAY(BAR(1, FOUR NOTE(G, 2, 4, "") NOTE(G, 3, 4, "") WORDS("G3 muta in A3") REST(8))
             BAR(2, NOTE(A, 3, 8, "") NOTE(G, 2, 8, "")));
    expect_text("gliss A3");
    PLAY(BAR(1, FOUR C3(4, "") NOTE(G, 2, 4, "") WORDS("muta in G") NOTE(G, 2, 8, "")));
    TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "gliss"), made.text);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "not followed"), made.report);
    // German B is B flat
    PLAY(BAR(1, FOUR "<note><pitch><step>B</step><alter>-1</alter><octave>2</octave></pitch>"
                     "<duration>8</duration><voice>1</voice></note>" WORDS("B nach C umstimmen")
                         REST(8)) BAR(2, C3(16, "")));
    expect_text("gliss C3");
    // how drums are tuned at first is no change
    PLAY(BAR(1, FOUR WORDS("F - C") NOTE(F, 2, 8, "") C3(8, "")));
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "tun"), made.report);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.report, "pedal"), made.report);
}

static void expect_hands(const char *words, const char *hands)
{
    char text[3000];
    snprintf(text, sizeof text,
             HEAD PART("Snare drum") BAR(1, FOUR WORDS("%s") C3(2, "") C3(2, "") C3(2, "") REST(2)
                                                GRACE(C) C3(2, "")) TAIL,
             words);
    load(text);
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_EQUAL_MESSAGE(hands[i] == 'R' ? HIMC_RIGHT : HIMC_LEFT, stroke(i)->hand, words);
}

static void test_a_row_of_hands_is_of_the_notes_in_turn(void)
{
    expect_hands("R L R L", "RLRL");
    expect_hands("RLRR", "RLRR");
    expect_hands("L R L L", "LRLL");
    expect_hands("r-l-r-r", "RLRR");
    expect_hands("R L L rL", "RLLL"); // the small one is the grace note's
    // a tied note has none, nor has another voice
    PLAY(BAR(1, FOUR WORDS("R R L L") C3(4, "<tie type='start'/>") C3(4, "<tie type='stop'/>")
                    C3(8, "") "<backup><duration>4</duration></backup><note><pitch><step>G</step>"
                              "<octave>2</octave></pitch><duration>4</duration><voice>2</voice>"
                              "</note>") BAR(2, C3(8, "") C3(8, "")));
    static const himc_hand hands[] = {HIMC_RIGHT, HIMC_RIGHT, HIMC_LEFT, HIMC_LEFT};
    for (int i = 0, k = 0; i < score->stroke_count; i++)
        if (strcmp(stroke(i)->drum, stroke(0)->drum) == 0)
            TEST_ASSERT_EQUAL_MESSAGE(hands[k++], stroke(i)->hand, made.text);
}

static void test_a_composite_metre_has_the_length_of_its_parts(void)
{
#define METRE(in) "<attributes><time>" in "</time></attributes>"
#define PAIR(beats, unit) "<beats>" beats "</beats><beat-type>" unit "</beat-type>"
    PLAY(BAR(1, FOUR METRE(PAIR("3", "8") PAIR("2", "4")) C3(14, "")) BAR(2, "") BAR(3, C3(14, ""))
             BAR(4, METRE(PAIR("3+2", "8")) C3(10, "")) BAR(5, "") BAR(6, C3(10, "")));
    expect_beats(4, 0.0, 7.0, 10.5, 15.5);
    expect_text("bars of 7/8");
    expect_text("bars of 5/8");
}

#define BARLINE(in) "<barline location='right'>" in "</barline>"
#define HELD BARLINE("<bar-style>light-heavy</bar-style><fermata/>")

static void test_a_fermata_over_a_barline_holds_the_last_note(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(4, "") C3(4, "") C3(8, "") HELD) BAR(2, C3(16, "")));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1, time_between(0, 2));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 2, time_between(2, 4)); // twice as long
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 2, time_between(4, 8));
    // a roll, which is one on it, too
    PLAY(BAR(1, FOUR TEMPO(60) C3(8, "") C3(8, MARKS(3)) HELD) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, stroke(1)->ornament);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 4, time_between(2, 4));
    // of two voices the note that is struck last
    PLAY(BAR(1, FOUR TEMPO(120) C3(12, "")
                    C3(4, "") "<backup><duration>16</duration></backup>" NOTE(G, 2, 16, "") HELD)
             BAR(2, C3(16, "")));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1.5, time_between(0, 3));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1, time_between(3, 4));
    // only what is held is no longer measured
    PLAY(BAR(1, FOUR TEMPO(40) C3(4, MARKS(3)) C3(12, MARKS(3)) HELD) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(8 + 1 + 1, score->stroke_count);
    // a rest, where another part ends with it; once where the note has a fermata itself
    PLAY(BAR(1, FOUR TEMPO(120) C3(12, "") REST(4) HELD) BAR(2, C3(16, "")));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1.5, time_between(0, 3));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1, time_between(3, 4));
    PLAY(BAR(1, FOUR TEMPO(120) C3(8, "") C3(8, "<notations><fermata/></notations>") HELD));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 2, time_between(2, 4));
}

static void test_a_vibraphone_rings_until_its_pedal_goes_up(void)
{
#define PEDAL(type) DIRECTION("<pedal type='" type "' line='yes'/>")
    static const char body[] =
        BAR(1, FOUR TEMPO(60) PEDAL("start") NOTE(F, 4, 8, "") PEDAL("change") NOTE(A, 4, 8, ""))
            BAR(2, PEDAL("stop") REST(8) NOTE(C, 5, 8, "")) TAIL;
    char text[3000];
    snprintf(text, sizeof text, HEAD PART("Vibraphone") "%s", body);
    load(text);
    double up[2], down[2];
    int count = 0;
    for (const char *at = strstr(made.text, "\nat "); at && count < 2; count++) {
        TEST_ASSERT_EQUAL_MESSAGE(1, sscanf(at, "\nat %lf vibraphone pedal 0;", &up[count]), at);
        at = strstr(at + 1, "\nat ");
        TEST_ASSERT_EQUAL_MESSAGE(1, sscanf(at, "\nat %lf vibraphone pedal 1;", &down[count]), at);
        at = strstr(at + 1, "\nat ");
    }
    TEST_ASSERT_EQUAL_MESSAGE(2, count, made.text);
    // the first note goes, before the second, which is not damped; at a rest it is on the beat
    TEST_ASSERT_TRUE(up[0] > 1.5 + lead() && up[0] < down[0] && down[0] < 2 + lead());
    TEST_ASSERT_FLOAT_WITHIN(1e-6, 4 + lead(), up[1]);
    TEST_ASSERT_TRUE(down[1] > up[1] + 0.1);
    // other bars have none
    snprintf(text, sizeof text, HEAD PART("Marimba") "%s", body);
    load(text);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "pedal 0"), made.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(made.report, "2 pedals are not played: the instrument has none (bars 1 2)"),
        made.report);
}

static void expect_change(const char *words, const char *instrument)
{
    char text[3000], line[80];
    snprintf(text, sizeof text,
             HEAD PART("Bass Drum") BAR(1, FOUR C3(16, "")) BAR(2, WORDS("%s") C3(16, "")) TAIL,
             words);
    snprintf(line, sizeof line, "\ninstrument %s", instrument);
    load(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, line), words);
}

static void test_brackets_and_sticks_do_not_hide_an_instrument(void)
{
    expect_change("(Sus. Cym.)", "crash");
    expect_change("Susp. cymbal with yarn mallets", "crash");
    expect_change("Hängebecken", "crash");
    expect_change("[S.D.]", "snare");
    expect_change("S.D. (snares off)", "snare");
    expect_text("wires 0");
    expect_change("Snare drum (brushes)", "snare");
    expect_change("change to snare drum with brushes", "snare");
    expect_change("Sn. Dr.", "snare");
    expect_change("Tamb.", "tambourine");
    expect_change("Kleine Trommel", "snare");
    expect_change("Large Sus. Cymbal", "crash");
    expect_change("Tom (high)", "high-tom");
    // what is not built is told by its name
    expect_change("Whip", "bass-drum");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.report, "no such instrument here: Whip"), made.report);
    load(HEAD PART("Snare drum") BAR(1, FOUR C3(8, "") WORDS("G.C.") C3(8, "")) TAIL);
    expect_text("\ninstrument bass-drum");
}

static void test_bells_have_names_in_four_languages(void)
{
    static const char *const names[] = {"Tubular Bells", "Campane (tubolari)",
                                        "Cloches (tubulaires)", "Röhrenglocken", "Campane"};
    for (int i = 0; i < 5; i++) {
        char text[2048];
        snprintf(text, sizeof text, HEAD PART("%s") BAR(1, FOUR NOTE(C, 5, 16, "")) TAIL, names[i]);
        load(text);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "tubular-bell"), names[i]);
    }
}

static void expect_times(int times, const char *words)
{
    char text[3000];
    snprintf(text, sizeof text,
             HEAD PART("Timpani") BAR(1, FOUR C3(16, BARLINE(""))) BAR(
                 2, "<barline location='left'><repeat direction='forward'/></barline>" WORDS("%s")
                        C3(16, "")) BAR(3, C3(16, "") BARLINE("<repeat direction='backward'/>"))
                 BAR(4, C3(16, "") BARLINE("<repeat direction='backward'/>")) TAIL,
             words);
    load(text);
    TEST_ASSERT_EQUAL_MESSAGE(1 + 2 * times + 2, score->stroke_count, words);
}

static void test_words_say_how_often_a_repeat_is_played(void)
{
    expect_times(2, "");
    expect_times(4, "Play 4 times");
    expect_times(4, "4x");
    expect_times(4, "(4×)");
    expect_times(3, "3 volte");
    expect_times(4, "4 fois");
    expect_times(2, "4x only");
    expect_times(2, "16 bars");
    // words before its beginning are not of a repeat
    PLAY(BAR(1, FOUR WORDS("3x") C3(16, ""))
             BAR(2, "<barline><repeat direction='forward'/></barline>" C3(
                        16, "") "<barline><repeat direction='backward'/></barline>"));
    expect_beats(3, 0.0, 4.0, 8.0);
}

static void test_a_repeat_within_a_bar_repeats_its_first_half(void)
{
    PLAY(BAR(1, FOUR C3(16, "")) BAR(
        2,
        "<barline location='left'><repeat direction='forward'/></barline>" C3(4, "") WORDS("più f")
            C3(4, "") "<barline location='middle'><repeat direction='backward'/></barline>" NOTE(
                G, 2, 8, "")) BAR(3, C3(16, "")));
    expect_beats(7, 0.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0);
    TEST_ASSERT_EQUAL_STRING(stroke(1)->drum, stroke(3)->drum);
    TEST_ASSERT_TRUE(strcmp(stroke(4)->drum, stroke(5)->drum) != 0);
    expect_dynamics(7, 4.0, 4.0, 5.0, 5.0, 6.0, 6.0, 6.0);
}

// Fine, D.C., a coda and an ending are of the half where they stand
static void test_a_bar_with_a_repeat_in_it_keeps_its_signs(void)
{
#define MIDDLE(direction) "<barline location='middle'><repeat direction='" direction "'/></barline>"
#define LEFT "<barline location='left'><repeat direction='forward'/></barline>"
    PLAY(BAR(1, FOUR C3(16, "") "<sound tocoda='c'/>")
             BAR(2, LEFT C3(8, "") MIDDLE("backward") NOTE(G, 2, 8, "") "<sound dacapo='yes'/>")
                 BAR(3, "<sound coda='c'/>" C3(8, "") MIDDLE("backward") NOTE(G, 2, 8, "")));
    expect_beats(7, 0.0, 4.0, 6.0, 8.0, 10.0, 14.0, 16.0);
    PLAY(BAR(1, FOUR C3(8, "") MIDDLE("backward") NOTE(
                    G, 2, 8, "") "<barline><repeat direction='backward' times='3'/></barline>"));
    expect_beats(5, 0.0, 2.0, 4.0, 6.0, 8.0);
    TEST_ASSERT_EQUAL_STRING(stroke(2)->drum, stroke(4)->drum);
    PLAY(BAR(1, FOUR C3(16, "")) BAR(
        2, "<barline><ending number='1' type='start'/></barline>" C3(
               16, "") "<barline><ending number='1' type='stop'/><repeat direction='backward'/>"
                       "</barline>")
             BAR(3,
                 "<barline><ending number='2' type='start'/></barline>" C3(8, "") MIDDLE("forward")
                     NOTE(G, 2, 8, "") "<barline><ending number='2' type='stop'/></barline>")
                 BAR(4, C3(16, "") "<barline><repeat direction='backward'/></barline>"));
    // 1 2 1 3, then twice its second half and 4
    expect_beats(8, 0.0, 4.0, 8.0, 12.0, 14.0, 16.0, 20.0, 22.0);
}

static void test_a_repeat_may_begin_within_a_bar(void)
{
    PLAY(BAR(
        1, FOUR C3(8, "") "<barline location='middle'><repeat direction='forward'/></barline>" NOTE(
               G, 2, 8, ""))
             BAR(2, C3(16, "") "<barline location='right'><repeat direction='backward'/></barline>")
                 BAR(3, C3(16, "")));
    expect_beats(6, 0.0, 2.0, 4.0, 8.0, 10.0, 14.0);
    TEST_ASSERT_EQUAL_STRING(stroke(1)->drum, stroke(3)->drum);
    TEST_ASSERT_TRUE(strcmp(stroke(0)->drum, stroke(1)->drum) != 0);
}

static void test_slashes_are_counted_and_not_played(void)
{
#define STYLE(in) "<attributes><measure-style>" in "</measure-style></attributes>"
#define HEADED(head)                                                                    \
    "<note><unpitched><display-step>C</display-step><display-octave>5</display-octave>" \
    "</unpitched><duration>8</duration><voice>1</voice><notehead>" head "</notehead></note>"
#define SLASH HEADED("slash")
    load(HEAD PART("Drumset") BAR(1, FOUR HEADED("normal") HEADED("normal")) BAR(2, SLASH SLASH)
             BAR(3, STYLE("<slash type='start'/>") HEADED("normal") HEADED("normal"))
                 BAR(4, STYLE("<slash type='stop'/>") HEADED("normal") HEADED("normal")) TAIL);
    expect_beats(4, 0.0, 2.0, 12.0, 14.0);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(made.report, "3 slashes that stand for notes are not played (bars 2 3)"),
        made.report);
    PLAY(BAR(1, FOUR C3(8, "") STYLE("<beat-repeat type='start' slashes='1'/>") REST(8))
             BAR(2, STYLE("<beat-repeat type='stop'/>") C3(16, "")));
    expect_beats(2, 0.0, 4.0);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.report, "1 slash that stands for notes"), made.report);
}

// the line behind the words says how long; then the tempo stays
static void test_a_ritardando_ends_with_its_line(void)
{
#define LINE(type) DIRECTION("<dashes type='" type "'/>")
    PLAY(BAR(1, FOUR TEMPO(100) "<direction><direction-type><words>rit.</words></direction-type>"
                                "<direction-type><dashes type='start'/></direction-type>"
                                "</direction>" C3(8, "") C3(8, ""))
             BAR(2, LINE("stop") C3(8, "") C3(8, "")) BAR(3, C3(16, "")));
    TEST_ASSERT_TRUE(time_between(2, 4) > time_between(0, 2) * 1.05);
    TEST_ASSERT_FLOAT_WITHIN(1e-6, time_between(4, 6), time_between(8, 10));
    TEST_ASSERT_FLOAT_WITHIN(0.5, 75, bpm_at(5));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_fermata_over_a_barline_holds_the_last_note);
    RUN_TEST(test_a_vibraphone_rings_until_its_pedal_goes_up);
    RUN_TEST(test_brackets_and_sticks_do_not_hide_an_instrument);
    RUN_TEST(test_bells_have_names_in_four_languages);
    RUN_TEST(test_words_say_how_often_a_repeat_is_played);
    RUN_TEST(test_a_repeat_within_a_bar_repeats_its_first_half);
    RUN_TEST(test_a_repeat_may_begin_within_a_bar);
    RUN_TEST(test_a_bar_with_a_repeat_in_it_keeps_its_signs);
    RUN_TEST(test_slashes_are_counted_and_not_played);
    RUN_TEST(test_a_metronome_mark_in_words_is_the_tempo);
    RUN_TEST(test_a_sound_or_a_sign_holds_before_the_number_of_words);
    RUN_TEST(test_a_tempo_with_a_number_is_that_tempo);
    RUN_TEST(test_words_in_several_elements_are_one_text);
    RUN_TEST(test_a_rallentando_ends_at_words_of_tempo_that_are_unknown);
    RUN_TEST(test_a_cresc_with_its_syllables_apart_is_one);
    RUN_TEST(test_a_dynamic_before_other_words_holds);
    RUN_TEST(test_two_dynamics_in_one_sign_are_the_attack_and_what_follows);
    RUN_TEST(test_a_retuning_is_written_in_many_ways);
    RUN_TEST(test_a_row_of_hands_is_of_the_notes_in_turn);
    RUN_TEST(test_a_composite_metre_has_the_length_of_its_parts);
    RUN_TEST(test_piu_and_meno_are_a_step_from_what_was_before);
    RUN_TEST(test_mosso_and_movimento_are_shares_of_the_tempo);
    RUN_TEST(test_a_ritardando_is_less_with_poco_and_more_with_molto);
    RUN_TEST(test_al_niente_ends_where_the_notes_end);
    RUN_TEST(test_hairpins_come_from_nothing_and_go_there);
    RUN_TEST(test_eighths_swing_and_what_is_finer_does_not);
    RUN_TEST(test_eighths_swing_in_bars_and_pickups_of_any_length);
    RUN_TEST(test_what_belongs_to_a_note_swings_with_it);
    RUN_TEST(test_a_gliss_of_a_line_with_words_is_one);
    RUN_TEST(test_a_ritardando_ends_with_its_line);
    return UNITY_END();
}
