/// MusicXML: each sign of a percussionist's part, and bad files.
#define _XOPEN_SOURCE 700
#include "made.h"

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
    PLAY(BAR(0, FOUR "<attributes><time><beats>4</beats><beat-type>4</beat-type></time>"
                     "</attributes>" C3(4, "")) BAR(1, C3(16, "")));
    expect_text("bars of 4/4 from beat 2");
    expect_text("bars of 4/4 from beat 3");
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
    PLAY(BAR(1, FOUR "<attributes><transpose><chromatic>2</chromatic><octave-change>-1"
                     "</octave-change></transpose></attributes>" NOTE(C, 4, 16, "")));
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

// a hand that damps is off the head before the pedal moves
static void test_a_pedal_moves_a_free_head(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(4, "") REST(1) WORDS("C muta in D") REST(3) NOTE(D, 3, 8, "")));
    double damped = 0;
    bool moved = false;
    for (int i = 0; i < score->change_count; i++) {
        const himc_command *c = &score->changes[i].command;
        damped = c->id == HIMC_COMMAND_DAMP ? c->atom[0].number : damped;
        moved |= c->id == HIMC_COMMAND_GLISS;
        TEST_ASSERT_TRUE_MESSAGE(c->id != HIMC_COMMAND_GLISS || damped == 0, made.text);
    }
    TEST_ASSERT_TRUE(moved);
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

static void test_an_ending_may_be_of_two_times(void)
{
    PLAY(BAR(1, FOUR C3(16, ""))
             BAR(2, ENDING("1, 2", "start")
                        NOTE(G, 2, 16, "") "<barline><ending number='1, 2' "
                                           "type='stop'/><repeat direction='backward'/></barline>")
                 BAR(3, ENDING("3", "start") NOTE(D, 3, 16, "") ENDING("3", "stop")));
    expect_beats(6, 0.0, 4.0, 8.0, 12.0, 16.0, 20.0);
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

static void test_after_da_capo_the_last_ending_is_played(void)
{
    PLAY(BAR(1, FOUR C3(16, ""))
             BAR(2, ENDING("1", "start")
                        NOTE(G, 2, 16, "") "<barline><ending number='1' "
                                           "type='stop'/><repeat direction='backward'/></barline>")
                 BAR(3, ENDING("2", "start") C3(16, "") WORDS("D.C.") ENDING("2", "stop")));
    expect_beats(6, 0.0, 4.0, 8.0, 12.0, 16.0, 20.0); // 1 2 1 3 1 3
    TEST_ASSERT_EQUAL_STRING(stroke(0)->drum, stroke(5)->drum);
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

// signs alone, as programs write them: one leaves at the first coda and goes to the last
static void test_the_first_coda_is_left_for_the_last(void)
{
    static const char *const from[] = {"<coda/>", "<words>To Coda</words><coda/>",
                                       "<words>To Coda</words>"};
    static const char *const to[] = {"<coda/>", "<coda/>", "<words>Coda</words>"};
    for (int k = 0; k < 3; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") BAR(1, FOUR C3(16, ""))
                     BAR(2, DIRECTION("<segno/>") C3(16, "")) BAR(3, C3(16, "") DIRECTION("%s"))
                         BAR(4, C3(16, "") WORDS("D.S. al Coda"))
                             BAR(5, DIRECTION("%s") NOTE(G, 2, 16, "")) TAIL,
                 from[k], to[k]);
        load(text);
        expect_beats(7, 0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0);
        for (int i = 0; i < 7; i++)
            TEST_ASSERT_EQUAL_INT(i == 6, strcmp(stroke(i)->drum, stroke(0)->drum) != 0);
    }
}

static void test_a_bar_with_a_repeat_sign_is_the_one_before(void)
{
    PLAY(BAR(1, FOUR C3(8, "") NOTE(G, 2, 8, ""))
             BAR(2, "<attributes><measure-style><measure-repeat type='start'>1</measure-repeat>"
                    "</measure-style></attributes>" REST(16)) BAR(3, REST(16))
                 BAR(4, "<attributes><measure-style><measure-repeat type='stop'/></measure-style>"
                        "</attributes>" C3(8, "") REST(8)));
    expect_beats(7, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0);
    for (int i = 0; i < 6; i++)
        TEST_ASSERT_EQUAL_STRING(stroke(i % 2)->drum, stroke(i)->drum);
    // some programs write the notes, too
    PLAY(BAR(1, FOUR C3(16, ""))
             BAR(2, "<attributes><measure-style><measure-repeat type='start'>1</measure-repeat>"
                    "</measure-style></attributes>" C3(16, "")));
    expect_beats(2, 0.0, 4.0);
    expect_text("2 of 2 notes for timpani are played");
}

static void test_both_notes_of_a_chord_are_damped_or_none(void)
{
    PLAY(BAR(1, FOUR C3(4, "") "<note><chord/><pitch><step>G</step><octave>2</octave></pitch>"
                               "<duration>4</duration><voice>1</voice></note>" REST(12))
             BAR(2, C3(4, "") NOTE(G, 2, 4, "") REST(8)));
    int damped[2] = {0};
    for (int i = 0; i < score->change_count; i++)
        if (score->changes[i].command.id == HIMC_COMMAND_DAMP && score->changes[i].beat < 4.9)
            damped[strcmp(score->changes[i].drum, "low") == 0]++;
    TEST_ASSERT_EQUAL_MESSAGE(2, damped[0], made.text);
    TEST_ASSERT_EQUAL(2, damped[1]);
}

// each of two notes in turn is written as long as both sound, with a time-modification or without
static void test_two_notes_in_turn_are_as_fast_with_their_time_modification(void)
{
#define PAIR(step, octave, type, more)                                                \
    NOTE(step, octave, 8,                                                             \
         "<type>whole</type>" more "<notations><ornaments><tremolo type='" type "'>1" \
         "</tremolo></ornaments></notations>")
#define TWO \
    "<time-modification><actual-notes>2</actual-notes><normal-notes>1</normal-notes></time-modification>"
    for (int k = 0; k < 2; k++) {
        if (k)
            PLAY(BAR(1, FOUR PAIR(C, 3, "start", TWO) PAIR(G, 2, "stop", TWO)));
        else
            PLAY(BAR(1, FOUR PAIR(C, 3, "start", "") PAIR(G, 2, "stop", "")));
        expect_beats(8, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5);
    }
}

// one lane's marks are not another's where they differ
static void test_two_voices_have_their_own_dynamics(void)
{
#define FOR_VOICE(d, v)                                                         \
    "<direction><direction-type><dynamics><" d "/></dynamics></direction-type>" \
    "<voice>" v "</voice></direction>"
#define SECOND                                                                    \
    "<note><pitch><step>G</step><octave>2</octave></pitch><duration>8</duration>" \
    "<voice>2</voice></note>"
    static const char *const marks[] = {FOR_VOICE("ff", "1") FOR_VOICE("pp", "2"),
                                        FOR_VOICE("pp", "1") FOR_VOICE("ff", "2"),
                                        FOR_VOICE("ff", "1"), FOR_VOICE("pp", "2")};
    static const double first[] = {6, 1, 6, 1}, second[] = {1, 6, 6, 1}; // of 7
    for (int k = 0; k < 4; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani")
                     BAR(1, FOUR "%s" C3(8, "")
                                C3(8, "") "<backup><duration>16</duration></backup>" SECOND SECOND)
                         TAIL,
                 marks[k]);
        load(text);
        TEST_ASSERT_EQUAL(4, score->stroke_count);
        for (int i = 0; i < 4; i++) {
            bool low = strcmp(stroke(i)->drum, "low") == 0;
            TEST_ASSERT_DOUBLE_WITHIN(0.01, (low ? second : first)[k] / 7, stroke(i)->dynamic);
        }
    }
}

static void test_voices_with_the_same_dynamics_share_the_next(void)
{
    PLAY(BAR(1, FOUR FOR_VOICE("p", "1") FOR_VOICE("p", "2")
                    C3(8, "") "<backup><duration>8</duration></backup>" SECOND FOR_VOICE("f", "1")
                        C3(8, "") "<backup><duration>8</duration></backup>" SECOND));
    expect_dynamics(4, 2.0, 2.0, 5.0, 5.0);
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
    // what comes after the last note is of others
    PLAY(BAR(1, FOUR TEMPO(60) C3(16, "")) BAR(2, REST(16)) BAR(3, TEMPO(90) REST(16)));
    TEST_ASSERT_EQUAL(1, score->tempo_count);
}

static void test_a_ritardando_slows_evenly_to_a_tempo(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(16, "")) BAR(2, WORDS("rit.") C3(16, ""))
             BAR(3, WORDS("a tempo") C3(16, "")) BAR(4, C3(16, "")));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(3.5));
    for (double beat = 4.5; beat < 8; beat += 0.5)
        TEST_ASSERT_TRUE(bpm_at(beat) < bpm_at(beat - 0.5));
    TEST_ASSERT_FLOAT_WITHIN(3, 90, bpm_at(7.9));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(8));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 120 - bpm_at(4), bpm_at(7.9) - 90); // its steps are even
}

#define BARS_OF(a, b, c, d) \
    BAR(a, C3(16, "")) BAR(b, C3(16, "")) BAR(c, C3(16, "")) BAR(d, C3(16, ""))

static void test_a_ritardando_without_an_end_lasts_two_bars(void)
{
    static const char *const far[] = {"", "a tempo"}; // too far away to be its end
    for (int i = 0; i < 2; i++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") BAR(1, FOUR TEMPO(120) WORDS("rit.") C3(16, ""))
                     BARS_OF(2, 3, 4, 5) BAR(6, WORDS("%s") C3(16, "")) TAIL,
                 far[i]);
        load(text);
        TEST_ASSERT_TRUE(bpm_at(0) > bpm_at(4) && bpm_at(4) > bpm_at(7.9));
        TEST_ASSERT_EQUAL_FLOAT(bpm_at(7.9), bpm_at(19));
    }
    // three bars before its end
    PLAY(BAR(1, FOUR TEMPO(120) WORDS("rit.") C3(16, "")) BAR(2, C3(16, "")) BAR(3, C3(16, ""))
             BAR(4, WORDS("a tempo") C3(16, "")));
    TEST_ASSERT_TRUE(bpm_at(8) > bpm_at(11.9));
}

// each part has the words of the tempo
static void test_words_of_all_parts_count_once(void)
{
    static const char *const words[] = {"Più mosso", "rit."};
    for (int i = 0; i < 2; i++) {
        double seconds[2];
        for (int parts = 1; parts <= 2; parts++) {
            char text[4096], second[1024] = "";
            if (parts == 2)
                snprintf(second, sizeof second,
                         "</part><part id='P2'>" BAR(1, FOUR REST(16)) BAR(2, WORDS("%s") REST(16)),
                         words[i]);
            snprintf(text, sizeof text,
                     HEAD "<part-list><score-part id='P1'><part-name>Timpani</part-name>"
                          "</score-part><score-part id='P2'><part-name>Violin</part-name>"
                          "</score-part></part-list><part id='P1'>" BAR(1, FOUR C3(16, ""))
                              BAR(2, WORDS("%s") C3(16, "")) BARS_OF(3, 4, 5, 6) "%s" TAIL,
                     words[i], second);
            load(text);
            seconds[parts - 1] = time_between(4, 24);
        }
        TEST_ASSERT_EQUAL_FLOAT(seconds[0], seconds[1]);
        TEST_ASSERT_TRUE(seconds[0] != 10);
    }
}

static void test_a_tempo_is_that_before_two_ritardandi(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(16, "")) BAR(2, WORDS("rit.") C3(16, ""))
             BAR(3, WORDS("molto rit.") C3(16, "")) BAR(4, WORDS("a tempo") C3(16, "")));
    TEST_ASSERT_TRUE(bpm_at(11.9) < bpm_at(8) && bpm_at(8) < 95);
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(12));
}

static void test_an_accelerando_arrives_at_the_mark_that_it_leads_to(void)
{
    PLAY(BAR(1, FOUR TEMPO(60) WORDS("accel.") C3(16, "")) BAR(2, TEMPO(120) C3(16, ""))
             BAR(3, WORDS("rit.") C3(16, "")) BAR(4, TEMPO(60) C3(16, "")));
    TEST_ASSERT_FLOAT_WITHIN(8, 120, bpm_at(3.9));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(4));
    TEST_ASSERT_FLOAT_WITHIN(8, 60, bpm_at(11.9));
    TEST_ASSERT_EQUAL_FLOAT(60, bpm_at(12));
}

static void test_the_tempo_of_a_repeated_bar_returns(void)
{
    PLAY(BAR(1, FOUR TEMPO(120) C3(16, "")) BAR(2, WORDS("rit.") C3(16, "") REPEAT("backward"))
             BAR(3, WORDS("a tempo") C3(16, "")));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(0));
    TEST_ASSERT_TRUE(bpm_at(7.9) < 95);
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(8));
    TEST_ASSERT_TRUE(bpm_at(15.9) < 95);
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(16));
}

// the eighth becomes the quarter, a dotted quarter the quarter
static void test_a_note_value_becomes_another(void)
{
#define UNIT(u) "<beat-unit>" u "</beat-unit>"
    PLAY(BAR(1, FOUR TEMPO(60) C3(16, "")) BAR(
        2, DIRECTION("<metronome>" UNIT("eighth") UNIT("quarter") "</metronome>") C3(16, ""))
             BAR(3, DIRECTION("<metronome>" UNIT("quarter") "<beat-unit-dot/>" UNIT(
                        "quarter") "</metronome>") C3(16, ""))
                 BAR(4, DIRECTION("<metronome><metronome-note><metronome-type>half</metronome-type>"
                                  "</metronome-note><metronome-relation>equals</metronome-relation>"
                                  "<metronome-note><metronome-type>quarter</metronome-type>"
                                  "<metronome-dot/></metronome-note></metronome>") C3(16, "")));
    TEST_ASSERT_EQUAL_FLOAT(60, bpm_at(12));
    TEST_ASSERT_EQUAL_FLOAT(60, bpm_at(0));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(4));
    TEST_ASSERT_EQUAL_FLOAT(80, bpm_at(8));
}

static void test_a_fermata_holds(void)
{
    PLAY(BAR(1, FOUR TEMPO(40) C3(16, "<notations><fermata/></notations>")) BAR(2, C3(16, "")));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 8.0, time_between(0, 4)); // longer by 2 s at most
    PLAY(BAR(1, FOUR TEMPO(120) C3(4, "<notations><fermata/></notations>") C3(4, "") REST(8)));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1.0, time_between(0, 1));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(1));
    // two voices: once, and what comes after it has its own tempo
    PLAY(BAR(
        1, FOUR
        "<attributes><time><beats>2</beats><beat-type>4</beat-type></time>"
        "</attributes>" TEMPO(60)
            C3(8, "<notations><fermata/></notations>") "<backup><duration>8</duration></backup>" NOTE(
                G, 2, 4, "<notations><fermata/></notations>")) BAR(2, TEMPO(120) C3(8, "")));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 4, time_between(0, 2));
    TEST_ASSERT_EQUAL_FLOAT(120, bpm_at(2));
}

// --- dynamics

static void test_dynamics_hold_until_the_next(void)
{
    PLAY(BAR(1, FOUR C3(4, "") DYNAMICS("pp") C3(4, "") C3(4, "") DYNAMICS("ff") C3(4, "")));
    expect_dynamics(4, 4.0, 1.0, 1.0, 6.0);
    PLAY(BAR(1, FOUR DIRECTION("<dynamics><other-dynamics>ffff</other-dynamics></dynamics>")
                    C3(8, "") DYNAMICS("pppp") C3(8, "")));
    expect_dynamics(2, 7.0, 0.0);
}

static void test_a_hairpin_leads_to_its_end(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("p") WEDGE("crescendo") C3(4, "") C3(4, "") C3(4, "") C3(4, "")
                    WEDGE("stop")) BAR(2, DYNAMICS("f") C3(4, "") REST(12)));
    expect_dynamics(5, 2.0, 2.75, 3.5, 4.25, 5.0);
    PLAY(BAR(1, FOUR DYNAMICS("f") WEDGE("diminuendo") C3(8, "") WEDGE("stop") C3(8, "")));
    expect_dynamics(2, 5.0, 4.0);
    // two steps where it is longer than a bar
    PLAY(BAR(1, FOUR DYNAMICS("p") WEDGE("crescendo") C3(16, "")) BAR(2, C3(16, "") WEDGE("stop"))
             BAR(3, C3(16, "")));
    expect_dynamics(3, 2.0, 3.0, 4.0);
    // the f of an accent or an fp is an end, too
    static const char *const ends[] = {"fp", "sfz", "f"};
    for (int i = 0; i < 3; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") BAR(1, FOUR DYNAMICS("p") WEDGE("crescendo") C3(16, MARKS(4)))
                     BAR(2, WEDGE("stop") DYNAMICS("%s") C3(16, "")) TAIL,
                 ends[i]);
        load(text);
        expect_roll(0, 0, 4, 2, 5);
    }
}

// a dynamic that is written before the hairpin's end is subito
static void test_a_hairpin_grows_up_to_a_sudden_p(void)
{
    static const char *const ends[] = {DYNAMICS("p") WEDGE("stop"), WEDGE("stop") DYNAMICS("p"),
                                       DYNAMICS("p")};
    for (int i = 0; i < 3; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD PART("Timpani") BAR(1, FOUR DYNAMICS("mf") WEDGE("crescendo") C3(8, "")
                                                 C3(8, "")) BAR(2, "%s" C3(16, "")) TAIL,
                 ends[i]);
        load(text);
        expect_dynamics(3, 4.0, 4.5, 2.0);
    }
}

static void test_words_beside_a_dynamic_do_not_hide_it(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("mf") C3(4, "") WORDS("p sub.") C3(4, "") WORDS("sempre ff") C3(4, "")
                    DIRECTION("<dynamics><other-dynamics>sub. pp</other-dynamics></dynamics>")
                        C3(4, "")));
    expect_dynamics(4, 4.0, 2.0, 6.0, 1.0);
    PLAY(BAR(1, FOUR C3(8, "") WORDS("Timpani in F") C3(8, "")));
    expect_dynamics(2, 4.0, 4.0);
}

static void test_a_word_leads_to_the_next_dynamic(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("p") WORDS("cresc.") C3(8, "") C3(8, ""))
             BAR(2, DYNAMICS("ff") C3(16, "")));
    expect_dynamics(3, 2.0, 4.0, 6.0);
    PLAY(BAR(1, FOUR DYNAMICS("p") WORDS("cresc.") C3(16, "")) BAR(2, C3(16, "")) BAR(3, C3(16, ""))
             BAR(4, C3(16, "")) BAR(5, DYNAMICS("ff") C3(16, "")));
    expect_dynamics(5, 2.0, 3.0, 4.0, 5.0, 6.0);
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
    // an accent is a step louder, sfz f at least
    expect_dynamics(6, 5.0, 4.0, 4.0, 4.0, 5.0, 4.0);
    PLAY(BAR(1, FOUR DYNAMICS("p") DYNAMICS("sfz") C3(8, "") DYNAMICS("ff") DYNAMICS("rfz")
                    C3(8, "")));
    expect_dynamics(2, 5.0, 7.0);
}

static void test_fp_is_loud_once(void)
{
    PLAY(BAR(1, FOUR DYNAMICS("fp") C3(8, "") C3(8, "")));
    expect_dynamics(2, 5.0, 2.0);
    PLAY(BAR(1, FOUR DYNAMICS("fp") C3(1, "") C3(1, "") C3(2, "") REST(12)));
    expect_dynamics(3, 5.0, 2.0, 2.0);
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
    PLAY(BAR(1, FOUR C3(2, "<tie type='start'/>") REST(14)) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(0, damps()); // a tie into the air
    PLAY(BAR(1, FOUR WORDS("l.v.") C3(2, ARTICULATION("staccato")) REST(14)) BAR(2, C3(16, "")));
    TEST_ASSERT_EQUAL(0, damps());
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, WORDS("secco") C3(8, "") C3(8, "")));
    TEST_ASSERT_EQUAL(1, damps());
    PLAY(BAR(1, FOUR C3(4, "") C3(4, "") DIRECTION("<damp-all/>") REST(8)));
    TEST_ASSERT_EQUAL(1, damps()); // the last stroke
    PLAY(BAR(1, FOUR TEMPO(240) C3(1, "") REST(15)) BAR(2, C3(16, "")));
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 4 * 0.15 + lead(), score->changes[0].beat); // as fast as a hand
    PLAY(BAR(1, FOUR TEMPO(180) WORDS("sempre secco") C3(2, "") C3(2, "") C3(2, "") C3(2, "")
                    REST(8)));
    TEST_ASSERT_EQUAL(1, damps()); // no time between eighths
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
    PLAY(BAR(1, FOUR C3(4, "") WORDS("L") REST(4) C3(4, "") WORDS("L") REST(4))
             BAR(2, C3(16, ""))); // over a rest
    TEST_ASSERT_EQUAL(HIMC_LEFT, stroke(1)->hand);
    TEST_ASSERT_EQUAL(HIMC_LEFT, stroke(2)->hand);
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
        {"Tambour de basque", "instrument tambourine"},
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
    // behind the coda no one leaves for it
    PLAY(BAR(1, FOUR C3(16, "")) BAR(2, C3(16, "") WORDS("D.C."))
             BAR(3, "<sound coda='c'/>" C3(16, "")) BAR(4, C3(16, "") "<sound tocoda='c'/>"));
    TEST_ASSERT_EQUAL(2 + 4, score->stroke_count);
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

// a line over the bars is played by both hands in turn
static void test_a_line_on_a_keyboard_goes_hand_by_hand(void)
{
    load(HEAD PART("Xylophone") BAR(1, FOUR NOTE(C, 5, 4, "") NOTE(D, 5, 4, "") NOTE(E, 5, 4, "")
                                           NOTE(F, 5, 4, ""))
             BAR(2, NOTE(G, 5, 4, "") NOTE(F, 5, 4, "") NOTE(E, 5, 4, "") NOTE(D, 5, 4, "")) TAIL);
    TEST_ASSERT_EQUAL(8, score->stroke_count);
    for (int i = 1; i < 8; i++)
        TEST_ASSERT_TRUE_MESSAGE(stroke(i)->hand != stroke(i - 1)->hand, made.text);
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
    RUN_TEST(test_an_ending_may_be_of_two_times);
    RUN_TEST(test_endings_without_a_number_or_a_stop_lose_no_bar);
    RUN_TEST(test_numbers_beyond_music_are_read_and_lose_nothing);
    RUN_TEST(test_graces_at_the_end_are_counted);
    RUN_TEST(test_an_accent_over_a_rest_is_not_the_next_note_s);
    RUN_TEST(test_a_repeat_is_played_as_often_as_it_says);
    RUN_TEST(test_da_capo_goes_to_fine_without_repeats);
    RUN_TEST(test_after_da_capo_the_last_ending_is_played);
    RUN_TEST(test_dal_segno_goes_to_the_coda);
    RUN_TEST(test_the_first_coda_is_left_for_the_last);
    RUN_TEST(test_a_bar_with_a_repeat_sign_is_the_one_before);
    RUN_TEST(test_both_notes_of_a_chord_are_damped_or_none);
    RUN_TEST(test_two_notes_in_turn_are_as_fast_with_their_time_modification);
    RUN_TEST(test_two_voices_have_their_own_dynamics);
    RUN_TEST(test_voices_with_the_same_dynamics_share_the_next);
    RUN_TEST(test_tempo_marks_words_and_numbers);
    RUN_TEST(test_a_ritardando_slows_evenly_to_a_tempo);
    RUN_TEST(test_a_ritardando_without_an_end_lasts_two_bars);
    RUN_TEST(test_words_of_all_parts_count_once);
    RUN_TEST(test_a_tempo_is_that_before_two_ritardandi);
    RUN_TEST(test_an_accelerando_arrives_at_the_mark_that_it_leads_to);
    RUN_TEST(test_the_tempo_of_a_repeated_bar_returns);
    RUN_TEST(test_a_note_value_becomes_another);
    RUN_TEST(test_a_fermata_holds);
    RUN_TEST(test_dynamics_hold_until_the_next);
    RUN_TEST(test_a_hairpin_leads_to_its_end);
    RUN_TEST(test_a_hairpin_grows_up_to_a_sudden_p);
    RUN_TEST(test_words_beside_a_dynamic_do_not_hide_it);
    RUN_TEST(test_a_word_leads_to_the_next_dynamic);
    RUN_TEST(test_marks_of_a_note_are_its_nuance);
    RUN_TEST(test_fp_is_loud_once);
    RUN_TEST(test_damped_notes_and_notes_that_ring);
    RUN_TEST(test_sticking_is_kept);
    RUN_TEST(test_spots_hold_until_the_next);
    RUN_TEST(test_words_and_noteheads_strike_hoop_and_shell);
    RUN_TEST(test_a_fermata_on_a_tied_end_is_held);
    RUN_TEST(test_a_dot_is_a_short_note_of_the_same_loudness);
    RUN_TEST(test_a_pedal_moves_a_free_head);
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
    RUN_TEST(test_a_line_on_a_keyboard_goes_hand_by_hand);
    return UNITY_END();
}
