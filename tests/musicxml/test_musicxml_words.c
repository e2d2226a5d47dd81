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

static void test_what_belongs_to_a_note_swings_with_it(void)
{
    PLAY(BAR(1, FOUR WORDS("Swing") C3(2, "") WORDS("R") GRACE(C) C3(2, "") C3(2, MARKS(4))
                    C3(2, "<tie type='start'/>") C3(4, "<tie type='stop'/>") REST(4)));
    TEST_ASSERT_EQUAL_MESSAGE(4, score->stroke_count, made.text);
    TEST_ASSERT_EQUAL(HIMC_FLAM, stroke(1)->ornament);
    TEST_ASSERT_EQUAL(HIMC_RIGHT, stroke(1)->hand);
    expect_roll(2, 1, 2 / 3.0, 4, 4); // up to the next note
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_piu_and_meno_are_a_step_from_what_was_before);
    RUN_TEST(test_mosso_and_movimento_are_shares_of_the_tempo);
    RUN_TEST(test_a_ritardando_is_less_with_poco_and_more_with_molto);
    RUN_TEST(test_al_niente_ends_where_the_notes_end);
    RUN_TEST(test_hairpins_come_from_nothing_and_go_there);
    RUN_TEST(test_eighths_swing_and_what_is_finer_does_not);
    RUN_TEST(test_what_belongs_to_a_note_swings_with_it);
    RUN_TEST(test_a_gliss_of_a_line_with_words_is_one);
    return UNITY_END();
}
