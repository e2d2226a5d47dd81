/// Export: a score as MusicXML and as MIDI, read back, is the same music.
#define _XOPEN_SOURCE 700
#include "written.h"

#define MOST 1000

/// All strokes that were read back, of every part, on the beats of the original.
static himc_stroke back[MOST];
static bool matched[MOST];
static int count;

static void load(const char *path)
{
    score = himc_score_load(path, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, false, &error), error.text);
}

static void parse(const char *words)
{
    score = himc_score_parse(words, "words", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, false, &error), error.text);
    TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "words"));
}

static void read_back(himc_score_maker *make)
{
    double lead = 0;
    count = 0;
    if (!import_as(make, NULL))
        return;
    himc_score *part = himc_score_parse(made.text, "back", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(part, error.text);
    sscanf(strstr(made.text, "beat 0 of the file"), "beat 0 of the file is beat %lf", &lead);
    for (int i = 0; i < part->stroke_count && count < MOST; i++) {
        back[count] = part->strokes[i];
        matched[count] = false;
        back[count++].beat -= lead;
    }
    himc_score_free(part);
}

static bool is_same(const himc_stroke *a, const himc_stroke *b)
{
    bool roll = a->ornament >= HIMC_ROLL_SINGLE;
    double first = score->bars ? score->bars[0].beat : 0; // its page begins there
    if (fabs(a->beat - first - b->beat) > 2e-3 || roll != (b->ornament >= HIMC_ROLL_SINGLE))
        return false;
    if (roll)
        return fabs(a->length - b->length) < 2e-3 && fabs(a->dynamic - b->dynamic) < 0.08 &&
               fabs(a->last_dynamic - b->last_dynamic) < 0.08;
    return a->hand == b->hand && a->nuance == b->nuance && a->ornament == b->ornament &&
           fabs(a->dynamic - b->dynamic) < 0.02 && strcmp(a->part, b->part) == 0;
}

// each stroke has its like among those that were read
static void expect_same(const char *name)
{
    char which[200];
    TEST_ASSERT_EQUAL_MESSAGE(score->stroke_count, count, name);
    for (int i = 0; i < score->stroke_count; i++) {
        bool found = false;
        for (int k = 0; k < count && !found; k++)
            if (!matched[k] && is_same(&score->strokes[i], &back[k]))
                found = matched[k] = true;
        snprintf(which, sizeof which, "%s: stroke at beat %g", name, score->strokes[i].beat);
        TEST_ASSERT_TRUE_MESSAGE(found, which);
    }
}

static void test_the_pieces_are_the_same_after_musicxml(void)
{
    static const char *const pieces[] = {"patches/improvisation.txt",
                                         "patches/pieces/tide.txt",
                                         "patches/pieces/kit.txt",
                                         "patches/pieces/grain.txt",
                                         "patches/pieces/zarathustra.mid",
                                         "tests/midi/scherzo.mid",
                                         "tests/midi/pedals.mid",
                                         "tests/midi/groove.mid",
                                         "tests/midi/roll.mid",
                                         "tests/fuzz/corpus/musicxml/signs",
                                         "tests/fuzz/corpus/musicxml/order"};
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
        load(pieces[i]);
        TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "piece"));
        read_back(himc_music_import);
        expect_same(pieces[i]);
        tearDown();
        setUp();
    }
}

static void test_each_kind_of_roll_comes_back(void)
{
    parse("drum kettle; instrument snare snare 14; tempo 100; roll 0 4 single p f kettle;"
          "roll 4 4 double p kettle; roll 8 4 press p kettle; roll 12 4 single f snare;"
          "roll 16 4 double p f snare; roll 20 4 press p snare;");
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(6, count);
    for (int i = 0; i < 6; i++)
        TEST_ASSERT_EQUAL(score->strokes[i].ornament, back[i].ornament);
    expect_same("rolls");
    // also where three strokes would be measured, and two that are no accent
    tearDown();
    parse("drum low 32; tempo 40; roll 0 4 single f f; roll 6 0.13333333 single mf mf;"
          "roll 6.13333333 3.8 single mp mp;");
    read_back(himc_music_import);
    expect_same("slow rolls");
}

// the kinds of one player are staves of one part
static void test_a_piece_for_many_instruments_keeps_its_strokes(void)
{
    load("patches/pieces/stations.txt");
    TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "stations"));
    read_back(himc_music_import);
    expect_same("stations");
}

static void test_pedals_come_back_as_words(void)
{
    parse("drum low 32; low tune D2; drum second 29; second tune A2; tempo 60;"
          "stroke 0 right legato f low; stroke 1 left legato f second; at 4 low tune E2;"
          "stroke 8 right legato f low; at 9 second muffle 1; stroke 12 left legato f second;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>D2 muta in E2</words>"));
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>coperto</words>"));
    import_back();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "low tune D2;"), made.text);
    const char *at = strstr(made.text, "low gliss E2 0.25;");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, made.text);
    while (at > made.text && at[-1] != '\n')
        at--;
    // at beat 4 of the score, after a second of the file's own
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 5, atof(at + 3));
}

static void test_ornaments_rolls_spots_and_dynamics_are_written(void)
{
    parse("drum kettle; tempo 100; flam 1 right accent ff; drag 2 left legato p center;"
          "ruff 3 right staccato mf rim; roll 4 6 single pp ff; stroke 10 left tenuto fff;"
          "stroke 12 right accent ppp; stroke 13 left legato ppp;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<wedge type=\"crescendo\"/>"));
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>near rim</words>"));
    read_back(himc_music_import);
    expect_same("ornaments");
    for (int i = 0; i < count; i++)
        if (back[i].beat < 3.5)
            TEST_ASSERT_EQUAL(score->strokes[i].spot, back[i].spot);
    tearDown();
    // a flam beside another drum's stroke
    parse("setup kit; stroke 0 right legato f crash; flam 0 left legato f snare;");
    read_back(himc_music_import);
    expect_same("flam");
    TEST_ASSERT_NULL(strstr(text.bytes, "<chord/>"));
}

static void test_midi_keeps_times_pitches_and_dynamics(void)
{
    load("patches/pieces/grain.txt");
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, text.bytes, text.size, &error), error.text);
    TEST_ASSERT_EQUAL(0, file.cut + file.missing);
    for (int i = 0; i < notes.note_count; i++) {
        bool found = false;
        for (int k = 0; k < file.note_count && !found; k++)
            found = file.notes[k].key == notes.notes[i].key &&
                    fabs(file.notes[k].seconds - notes.notes[i].seconds) < 1e-3 &&
                    fabs(file.notes[k].velocity -
                         himc_midi_played_velocity(notes.notes[i].way.nuance,
                                                   notes.notes[i].way.dynamic)) < 1;
        TEST_ASSERT_TRUE(found);
    }
    himc_midi_file_free(&file);
}

static void test_midi_has_each_grace_note(void)
{
    score = himc_score_parse("drum kettle; flam 1 right legato f; drag 2 left legato f;"
                             "ruff 3 left legato f; stroke 4 right legato f;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, text.bytes, text.size, &error), error.text);
    TEST_ASSERT_EQUAL(4 + 1 + 2 + 2, file.note_count);
    TEST_ASSERT_TRUE(file.notes[0].velocity < file.notes[1].velocity);
    for (int i = 0; i < file.note_count; i++)
        TEST_ASSERT_TRUE(file.notes[i].off > file.notes[i].seconds + 0.02);
    himc_midi_file_free(&file);
}

// a short roll is four strokes, a grace before time 0 none; a bar behind a pickup begins there
static void test_midi_has_short_rolls_and_pickups(void)
{
    score = himc_score_parse("drum kettle; tempo 60; comment bars of 4/4 from beat 0;"
                             "comment bars of 4/4 from beat 1; flam 0 right legato f;"
                             "roll 1 0.2 single f f; stroke 5 right legato f;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE(himc_music_notes(&notes, score, true, &error));
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, text.bytes, text.size, &error), error.text);
    TEST_ASSERT_EQUAL(1 + 4 + 1, file.note_count);
    for (int i = 0; i < file.note_count; i++)
        TEST_ASSERT_TRUE(file.notes[i].off > file.notes[i].seconds + 0.02);
    TEST_ASSERT_EQUAL_DOUBLE(1, file.bars[1].beat);
    TEST_ASSERT_EQUAL_DOUBLE(5, file.bars[2].beat);
    himc_midi_file_free(&file);
}

static void test_a_roll_is_a_roll_after_midi(void)
{
    score = himc_score_parse("drum kettle; tempo 60; stroke 0 right legato f; roll 2 4 single p f;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    read_back(himc_midi_import);
    TEST_ASSERT_EQUAL(2, count);
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, back[1].ornament);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 4, back[1].length);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 5 / 7.0, back[1].last_dynamic);
}

static void test_hats_stay_closed_and_a_foot_s_stroke_stays_the_foot_s(void)
{
    static himc_score_maker *const make[] = {himc_music_import, himc_midi_import};
    parse("setup kit; stroke 1 left legato mf rim hats; stroke 2 foot legato f hats;");
    for (int i = 0; i < 2; i++) {
        midi_options options = {.choice = MIDI_DRUMS};
        if (i == 1) {
            free(text.bytes);
            text = (himc_text_lines){0};
            TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
        }
        TEST_ASSERT_TRUE_MESSAGE(import_as(make[i], &options), error.text);
        TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "pedal 0"), made.text);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "foot legato"), made.text);
    }
}

static void test_a_gliss_comes_back_as_a_gliss(void)
{
    static const char *const lines[] = {"at 4 low gliss E2 2;", "at 9 low gliss D2 1;",
                                        "at 9 second gliss B2 0.5;", "at 12 low gliss F2 1.5;"};
    parse("drum low 32; low tune D2; drum second 29; second tune A2; tempo 60;"
          "roll 4 4 single p f low; stroke 9 right legato f low; stroke 9 left legato f second;"
          "roll 12 2 single f low;"
          "at 4 low gliss E2 2; at 9 low gliss D2 1; at 9 second gliss B2 .5;"
          "at 12 low gliss F2 1.5;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>gliss. D2 to E2</words>"));
    import_back();
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, lines[i]), made.text);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "damp"), made.text); // it is heard
    read_back(himc_music_import);
    expect_same("gliss");
}

// the note that it leads to is struck where it has arrived, though another drum has that pitch
static void test_a_gliss_ends_on_its_own_drum(void)
{
    parse("drum second 29; second tune F2; drum third 26; third tune C3; tempo 90;"
          "stroke 0 right legato f third; stroke 4 left legato f second;"
          "at 4 second gliss C3 1.3333333; stroke 6 left legato f second;");
    read_back(himc_music_import);
    expect_same("gliss");
    for (int i = 0; i < count; i++)
        TEST_ASSERT_EQUAL_STRING(score->strokes[i].drum, back[i].drum);
    tearDown();
    parse("drum low 32; low tune C2; tempo 60; stroke 0 right legato f;"
          "at 2 low gliss E2 2;"); // ends with the bar
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<dashes type=\"stop\""));
    TEST_ASSERT_NULL(strstr(strstr(text.bytes, "</measure>"), "<dashes"));
}

static void test_a_choked_cymbal_is_choked_again(void)
{
    parse("setup kit; tempo 120; stroke 0 right legato f crash; at 1 crash damp 1;"
          "at 1.5 crash damp 0; stroke 2 right legato f crash; stroke 4 left legato f snare;");
    import_back();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "at 3 crash damp 1;"), made.text);
    TEST_ASSERT_NULL(strstr(strstr(made.text, "damp 1;") + 1, "damp 1;"));
}

static void test_a_stroke_on_no_drum_of_the_score_is_refused(void)
{
    score = himc_score_parse("setup kit; stroke 3 right legato f none;", "words", NULL, &error);
    TEST_ASSERT_FALSE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_EQUAL_STRING("stroke at beat 3: no drum none, expected one that is made",
                             error.text);
}

// also beyond a drum's usual pitches, and where two drums have one pitch
static void test_a_gliss_keeps_its_octave_and_its_drum(void)
{
    static const char *const lines[] = {"low gliss D3 1;", "low gliss C3 1;", "third gliss G3 1;"};
    parse("drum low 32; low tune C3; drum third 26; third tune C3; tempo 60;"
          "stroke 0 left legato f low; stroke 1 right legato f third; at 2 low gliss D3 1;"
          "stroke 4 left legato f low; stroke 5 right legato f third; at 6 low gliss C3 1;"
          "stroke 8 left legato f low; at 9 third gliss G3 1; stroke 12 right legato f third;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>gliss. third C3 to G3</words>"));
    import_back();
    for (int i = 0; i < 3; i++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, lines[i]), made.text);
    read_back(himc_music_import);
    expect_same("gliss");
    for (int i = 0; i < count; i++)
        TEST_ASSERT_EQUAL_STRING(score->strokes[i].drum, back[i].drum);
}

static void test_what_notation_does_not_have_is_told_once_with_its_first_bar(void)
{
    parse(
        "drum kettle; kettle tune 110.5; kettle place 0.5 0 0.8; kettle decay 3; tempo 60;"
        "stroke 1 right legato f dead kettle; stroke 9 left legato f dead kettle;"
        "stroke 10 right legato f 0.1 0.1 kettle; roll 12 2 press p kettle;"
        "at 20 kettle decay 2; at 22 kettle muffle 0.5; at 24 kettle decay 1; at 28 push trunk 10 0 0 0.1;"
        "hit right legato f; stroke 30 left legato f kettle;");
    TEST_ASSERT_EQUAL_STRING("1 place (bar 3) is written as the usual spot\n"
                             "2 dead strokes (bar 1) are written as usual\n"
                             "1 tuning (bar 1) is written to the semitone\n"
                             "1 change by push (bar 8) is not written\n"
                             "2 changes by decay (bar 6) are not written\n"
                             "1 change by muffle (bar 6) is not written\n"
                             "before the piece, not written: hit 1, decay 1, place 1\n",
                             notes.said);
}

static void test_midi_tells_of_nuances_spots_and_pedals_that_it_does_not_have(void)
{
    score =
        himc_score_parse("drum low; stroke 0 right accent f low; stroke 5 left legato f rim low;"
                         "at 9 low gliss E3 1; stroke 12 left legato f low; at 13 low muffle 1;",
                         "words", NULL, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, true, &error), error.text);
    TEST_ASSERT_EQUAL_STRING("1 spot (bar 2) is not written: the instrument has no sign for it\n"
                             "1 nuance (bar 1) is written as loudness, for other programs\n"
                             "1 change by gliss (bar 3) is not written\n"
                             "1 change by muffle (bar 4) is not written\n",
                             notes.said);
}

// a cymbal's key in MIDI says nothing of its end
static void test_midi_tells_of_a_choked_cymbal(void)
{
    score = himc_score_parse("setup kit; tempo 120; stroke 0 right legato f crash;"
                             "at 1 crash damp 1; stroke 2 right legato f snare;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, true, &error), error.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(notes.said, "1 change by damp (bar 1) is not written\n"),
                                 notes.said);
}

// a stroke rings unless a hand damps it, also after a bar's end and where its note is short
static void test_what_rings_and_what_a_hand_damps_come_back(void)
{
    parse("drum low 32; low tune D2; drum second 29; second tune A2; tempo 60;"
          "stroke 0 left legato f low; stroke 1 right legato f second; at 2.5 second damp 1;"
          "at 3 second damp 0; stroke 5 right legato f second; stroke 7 left legato f low;"
          "at 9.5 low damp 1; at 10 low damp 0; roll 12 2 single p f low; at 14 low damp 1;"
          "stroke 20 left legato f low; stroke 28 right legato f second;");
    TEST_ASSERT_NULL_MESSAGE(notes.said, notes.said);
    static const char *const lines[] = {"second damp 1;", "low damp 1;", "low damp 1;"};
    static const double beats[] = {2.5, 9.5, 14};
    double lead = 0;
    import_back();
    sscanf(strstr(made.text, "beat 0 of the file"), "beat 0 of the file is beat %lf", &lead);
    const char *at = made.text;
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_NOT_NULL_MESSAGE(at = strstr(at, "damp 1;"), made.text);
        const char *line = at;
        while (line[-1] != '\n')
            line--;
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line, lines[i]), line);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, beats[i], atof(line + 3) - lead);
        at++;
    }
    TEST_ASSERT_NULL_MESSAGE(strstr(at, "damp 1;"), at);
    read_back(himc_music_import);
    expect_same("damped");
}

static void test_midi_has_what_rings_and_what_a_hand_damps(void)
{
    score = himc_score_parse("drum low 32; low tune D2; drum second 29; second tune A2; tempo 60;"
                             "stroke 0 left legato f low; stroke 1 right legato f second;"
                             "at 2.5 second damp 1; at 3 second damp 0;"
                             "stroke 5 right legato f second; stroke 9 left legato f low;"
                             "stroke 12 right legato f second;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, true, &error), error.text);
    TEST_ASSERT_NULL_MESSAGE(notes.said, notes.said);
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    TEST_ASSERT_TRUE(import_as(himc_midi_import, NULL));
    const char *at = strstr(made.text, "at 3.5 second damp 1;"); // after a beat of its own
    TEST_ASSERT_NOT_NULL_MESSAGE(at, made.text);
    TEST_ASSERT_EQUAL_PTR(strstr(made.text, "damp 1;"), strstr(at, "damp 1;"));
    TEST_ASSERT_NULL_MESSAGE(strstr(strstr(at, "1;"), "damp 1;"), made.text);
}

static void test_a_note_before_graces_rings_on_after_midi(void)
{
    static const char *const with[] = {"flam", "drag", "ruff"};
    for (int k = 0; k < 3; k++) {
        char words[200];
        snprintf(words, sizeof words,
                 "drum kettle; tempo 60; stroke 0 right legato f; %s 2 left legato f;"
                 "stroke 4 right legato f;",
                 with[k]);
        score = himc_score_parse(words, "words", NULL, &error);
        TEST_ASSERT_TRUE(himc_music_notes(&notes, score, true, &error));
        TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
        TEST_ASSERT_TRUE(import_as(himc_midi_import, NULL));
        TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "damp 1;"), made.text);
        tearDown();
    }
}

// behind a roll's end on one drum, while another one rings on
static void test_a_hand_after_a_roll_damps_where_it_did(void)
{
    parse("drum low 32; low tune D2; drum second 29; second tune A2; tempo 60;"
          "stroke 0 right legato f second; roll 1 3 single p f low; at 5.5 low damp 1;"
          "at 6 low damp 0; stroke 10 left legato f low;");
    double lead = 0;
    import_back();
    sscanf(strstr(made.text, "beat 0 of the file"), "beat 0 of the file is beat %lf", &lead);
    const char *at = strstr(made.text, "low damp 1;");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, made.text);
    while (at[-1] != '\n')
        at--;
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 5.5, atof(at + 3) - lead);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "second damp 1;"), made.text);
    read_back(himc_music_import);
    expect_same("damped after a roll");
    tearDown();
    parse("drum low 32; tempo 60; roll 0 0.2 single f mf; roll 0.2 1.8 single mf mf;"
          "at 2 low damp 1; at 2.2 low damp 0; stroke 6 left legato f;");
    import_back(); // of a roll with an accent, too
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "low damp 1;"), made.text);
}

// elsewhere a velocity is all that is heard of an accent; here the same strokes come back
static void test_nuances_are_velocities_in_midi_and_come_back(void)
{
    score = himc_score_parse(
        "drum kettle; tempo 60; stroke 0 right legato mf; stroke 1 left accent mf;"
        "stroke 2 right vertical-accent mf; stroke 3 left staccato mf; stroke 4 right tenuto ppp;"
        "stroke 5 left vertical-accent ff; stroke 6 right vertical-accent f;",
        "words", NULL, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, true, &error), error.text);
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, text.bytes, text.size, &error), error.text);
    const midi_note *n = file.notes;
    TEST_ASSERT_TRUE(n[3].velocity < n[0].velocity && n[0].velocity < n[1].velocity);
    TEST_ASSERT_TRUE(n[1].velocity < n[2].velocity);
    // as loud as a legato stroke of 7.5 m/s, which at f has 4.3 and at fff 1.39 times that
    const double forte = 5 / 7.0, step = (1 - forte) / log(1.39);
    double all = himc_midi_velocity(forte + step * log(7.5 / 4.3));
    TEST_ASSERT_EQUAL((int)fmin(lround(all), 127), n[6].velocity);
    himc_midi_file_free(&file);
    read_back(himc_midi_import);
    expect_same("nuances");
}

// who edits a velocity in another program is heard
static void test_an_edited_velocity_counts(void)
{
    score =
        himc_score_parse("drum kettle; tempo 60; stroke 0 right accent mf;", "words", NULL, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, true, &error), error.text);
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    size_t at = 0;
    while (at < text.size && !((uint8_t)text.bytes[at] == 0x90 && text.bytes[at + 1] == 50))
        at++;
    TEST_ASSERT_TRUE(at < text.size);
    text.bytes[at + 2] = 40;
    read_back(himc_midi_import);
    TEST_ASSERT_EQUAL(1, count);
    TEST_ASSERT_EQUAL(HIMC_ACCENT, back[0].nuance);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, himc_midi_dynamic(40, 0), back[0].dynamic);
}

static void test_more_bars_than_are_read_are_refused(void)
{
    score = himc_score_parse("drum kettle; stroke 0 right legato f; stroke 80000 left legato f;",
                             "words", NULL, &error);
    TEST_ASSERT_FALSE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_EQUAL_STRING("it ends in bar 20001, expected up to 20000 bars of MusicXML",
                             error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, true, &error), error.text);
}

static void test_the_last_bar_that_is_read_is_written(void)
{
    parse("drum kettle; tempo 1000; stroke 1 right legato f; stroke 79999 left legato f;");
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(2, count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 79999, back[1].beat);
}

// a time between two events has four bytes in MIDI
static void test_midi_keeps_a_rest_of_any_length(void)
{
    score = himc_score_parse("drum kettle; tempo 1000; stroke 1 right legato f;"
                             "stroke 279625 left legato f; stroke 990000 left legato f;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, true, &error), error.text);
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, text.bytes, text.size, &error), error.text);
    TEST_ASSERT_EQUAL(3, file.note_count);
    for (int i = 0; i < file.note_count; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, score->strokes[i].beat, file.notes[i].beat);
    himc_midi_file_free(&file);
}

static void test_a_tempo_slower_than_midi_has_is_refused(void)
{
    score = himc_score_parse("drum kettle; tempo 90; tempo 1.6 4; stroke 1 right legato f;",
                             "words", NULL, &error);
    TEST_ASSERT_FALSE(himc_music_notes(&notes, score, true, &error));
    TEST_ASSERT_EQUAL_STRING("tempo 1.6 at beat 4, expected 3.576 beats per minute or more in MIDI",
                             error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, false, &error), error.text);
}

// all parts have the bars of the longest, and the first has all tempi
static void test_a_tempo_after_the_end_of_a_part_is_written(void)
{
    parse("drum kettle; instrument tom tom; tempo 60; tempo 120 40; stroke 0 right legato f kettle;"
          "stroke 30 right legato f tom; stroke 50 left legato f tom;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<sound tempo=\"120\"/>"));
    read_back(himc_music_import);
    expect_same("two parts");
}

static void test_strokes_on_hoop_and_shell_come_back(void)
{
    parse(
        "setup kit; stroke 1 left legato mf crossstick snare; stroke 2 left legato mf rimshot snare;"
        "stroke 2.5 right legato mf snare; stroke 3 left legato mf click snare;"
        "stroke 4 right legato mf shell tom; stroke 4 foot legato mf kick;"
        "stroke 5 right legato f rimshot tom; stroke 6 left legato f snare;");
    TEST_ASSERT_EQUAL_STRING("before the piece, not written: place 8\n", notes.said);
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(score->stroke_count, count);
    for (int i = 0; i < count; i++) {
        bool found = false;
        for (int k = 0; k < count && !found; k++)
            found = is_same(&score->strokes[i], &back[k]) &&
                    strcmp(score->strokes[i].drum, back[k].drum) == 0 &&
                    score->strokes[i].spot == back[k].spot;
        TEST_ASSERT_TRUE(found);
    }
}

static void test_spots_without_a_key_are_told_and_come_back_normal(void)
{
    parse(
        "setup kit; stroke 1 left legato mf rim snare; stroke 2 left legato mf crossstick snare;"
        "stroke 3 left legato mf rimshot tom; drum kettle; stroke 5 left legato mf click kettle;");
    TEST_ASSERT_EQUAL_STRING("2 spots (bar 1) are not written: the instrument has no sign for it\n"
                             "before the piece, not written: place 8\n",
                             notes.said);
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(4, count);
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, back[0].spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_CROSSSTICK, back[1].spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_RIMSHOT, back[2].spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, back[3].spot);
}

static void test_the_bell_of_a_ride_comes_back(void)
{
    parse("setup kit; stroke 1 left legato mf bell ride; stroke 2 left legato mf bow ride;");
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(2, count);
    TEST_ASSERT_EQUAL(HIMC_SPOT_CENTER, back[0].spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, back[1].spot);
}

// `timbales` alone are the French timpani
static void test_a_timbale_is_a_drum_also_under_another_name(void)
{
    parse("instrument high-timbale timbale 13; instrument t timbale 14;"
          "stroke 0 right legato f high-timbale; stroke 1 left legato f t;");
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_EQUAL_INT(MIDI_DRUMS, notes.notes[i].choice);
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(2, count);
}

static void test_a_score_without_strokes_is_refused(void)
{
    score = himc_score_parse("drum kettle;", "words", NULL, &error);
    TEST_ASSERT_FALSE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_EQUAL_STRING("no stroke that notation has, expected a score with strokes",
                             error.text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_pieces_are_the_same_after_musicxml);
    RUN_TEST(test_each_kind_of_roll_comes_back);
    RUN_TEST(test_a_piece_for_many_instruments_keeps_its_strokes);
    RUN_TEST(test_pedals_come_back_as_words);
    RUN_TEST(test_ornaments_rolls_spots_and_dynamics_are_written);
    RUN_TEST(test_midi_keeps_times_pitches_and_dynamics);
    RUN_TEST(test_midi_has_each_grace_note);
    RUN_TEST(test_midi_has_short_rolls_and_pickups);
    RUN_TEST(test_a_roll_is_a_roll_after_midi);
    RUN_TEST(test_hats_stay_closed_and_a_foot_s_stroke_stays_the_foot_s);
    RUN_TEST(test_a_gliss_comes_back_as_a_gliss);
    RUN_TEST(test_a_gliss_keeps_its_octave_and_its_drum);
    RUN_TEST(test_what_notation_does_not_have_is_told_once_with_its_first_bar);
    RUN_TEST(test_midi_tells_of_nuances_spots_and_pedals_that_it_does_not_have);
    RUN_TEST(test_midi_tells_of_a_choked_cymbal);
    RUN_TEST(test_what_rings_and_what_a_hand_damps_come_back);
    RUN_TEST(test_midi_has_what_rings_and_what_a_hand_damps);
    RUN_TEST(test_a_note_before_graces_rings_on_after_midi);
    RUN_TEST(test_a_hand_after_a_roll_damps_where_it_did);
    RUN_TEST(test_nuances_are_velocities_in_midi_and_come_back);
    RUN_TEST(test_an_edited_velocity_counts);
    RUN_TEST(test_more_bars_than_are_read_are_refused);
    RUN_TEST(test_the_last_bar_that_is_read_is_written);
    RUN_TEST(test_midi_keeps_a_rest_of_any_length);
    RUN_TEST(test_a_tempo_slower_than_midi_has_is_refused);
    RUN_TEST(test_a_tempo_after_the_end_of_a_part_is_written);
    RUN_TEST(test_strokes_on_hoop_and_shell_come_back);
    RUN_TEST(test_the_bell_of_a_ride_comes_back);
    RUN_TEST(test_spots_without_a_key_are_told_and_come_back_normal);
    RUN_TEST(test_a_timbale_is_a_drum_also_under_another_name);
    RUN_TEST(test_a_score_without_strokes_is_refused);
    RUN_TEST(test_a_gliss_ends_on_its_own_drum);
    RUN_TEST(test_a_choked_cymbal_is_choked_again);
    RUN_TEST(test_a_stroke_on_no_drum_of_the_score_is_refused);
    return UNITY_END();
}
