/// MusicXML: a written part is one player with several instruments.
#define _XOPEN_SOURCE 700
#include "made.h"

#include "midi/part.h"
#include "musicxml/export.h"
#include "musicxml/names.h"

#define HIT(more)                                                              \
    "<note>" more "<unpitched><display-step>E</display-step><display-octave>4" \
    "</display-octave></unpitched><duration>4</duration><voice>1</voice></note>"
#define AT(step, octave)                                                              \
    "<note><unpitched><display-step>" #step "</display-step><display-octave>" #octave \
    "</display-octave></unpitched><duration>4</duration><voice>1</voice></note>"
#define OF(id, step, octave)                                                             \
    "<note><pitch><step>" #step "</step><octave>" #octave "</octave></pitch><duration>4" \
    "</duration><instrument id='" id "'/><voice>1</voice></note>"
#define INSTRUMENT(id, name) \
    "<score-instrument id='" id "'><instrument-name>" name "</instrument-name></score-instrument>"
#define PLAYER(id, name, instruments) \
    "<score-part id='" id "'><part-name>" name "</part-name>" instruments "</score-part>"
#define ONE_LINE                                                                      \
    "<attributes><divisions>4</divisions><staff-details><staff-lines>1</staff-lines>" \
    "</staff-details></attributes>"

#define LINE(step)                                                                             \
    "<note><unpitched><display-step>" step "</display-step><display-octave>5</display-octave>" \
    "</unpitched><duration>4</duration><voice>1</voice></note>"

#define PLAYED_BY(list) HEAD "<part-list>" list "</part-list><part id='P1'>"
#define CHANGED(id, sound)                                           \
    "<sound><instrument-change id='" id "'><instrument-sound>" sound \
    "</instrument-sound></instrument-change></sound>"
#define TIMPANI_AND_SNARE \
    PLAYER("P1", "Percussion", INSTRUMENT("T", "Timpani") INSTRUMENT("S", "Snare Drum"))
#define SAYS(staff, type) \
    "<direction><direction-type>" type "</direction-type><staff>" #staff "</staff></direction>"
#define ON(n, id, duration)                                                     \
    "<note><pitch><step>D</step><octave>3</octave></pitch><duration>" #duration \
    "</duration><instrument id='" id "'/><voice>" #n "</voice><staff>" #n "</staff></note>"
#define BACK "<backup><duration>16</duration></backup>"

static void expect_drums(int count, const char *const *names)
{
    TEST_ASSERT_EQUAL_MESSAGE(count, score->stroke_count, made.text);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_EQUAL_STRING_MESSAGE(names[i], stroke(i)->drum, made.text);
}

static void test_ids_of_notes_say_the_instrument(void)
{
    static const char *const drums[] = {"third", "xylophone", "snare", "xylophone"};
    load(HEAD "<part-list>" PLAYER(
        "P1", "Percussion",
        INSTRUMENT("T", "Timpani") INSTRUMENT("X", "Xylophone") INSTRUMENT(
            "S", "Snare Drum")) "</part-list><part id='P1'>" BAR(1, FOUR OF("T", D, 3) OF("X", C, 5)
                                                                        OF("S", C, 5) OF("X", E, 5))
             TAIL);
    expect_drums(4, drums);
    expect_text("4 of 4 notes for timpani drums xylophone are played");
}

// in four languages, and a bare name on a staff of one line
static void test_words_change_the_instrument(void)
{
    static const char *const words[][3] = {
        {"to Xylophone", "take Cymbals", "Snare Drum"},
        {"nimmt Xylophon", "Becken nehmen", "nimmt Kl. Trommel"},
        {"prenez le xylophone", "Cymbales", "prend la Caisse claire"},
        {"muta in Xilofono", "muta in Piatti", "Tamburo"}};
    static const char *const drums[] = {"xylophone", "crash", "snare", "snare"};
    for (int k = 0; k < 4; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Percussion") "<measure number='1'>" ONE_LINE WORDS("%s")
                     NOTE(C, 5, 4, "") WORDS("%s") HIT("") WORDS("%s") HIT("") WORDS("p")
                         HIT("") "</measure>" TAIL,
                 words[k][0], words[k][1], words[k][2]);
        load(text);
        expect_drums(4, drums);
    }
}

static void test_words_that_name_sticks_or_a_pitch_change_no_instrument(void)
{
    static const char *const words[] = {"take timpani sticks", "mit Paukenschlägeln", "to Coda",
                                        "muta in F",           "like a triangle",     "Solo"};
    for (int k = 0; k < 6; k++) {
        char text[4096];
        snprintf(text, sizeof text,
                 HEAD PART("Snare Drum") "<measure number='1'>" FOUR HIT("") WORDS("%s")
                     HIT("") "</measure>" TAIL,
                 words[k]);
        load(text);
        expect_drums(2, (const char *const[]){"snare", "snare"});
    }
}

static void test_a_sound_changes_the_instrument(void)
{
    load(PLAYED_BY(PLAYER("P1", "Timpani", INSTRUMENT("A", "Timpani"))) BAR(
        1, FOUR OF("A", D, 3) CHANGED("A", "pitched-percussion.xylophone") OF("A", C, 5)) TAIL);
    expect_drums(2, (const char *const[]){"third", "xylophone"});
}

static void test_clefs_say_the_instrument_where_notes_do_not(void)
{
#define CLEF(sign) "<attributes><clef><sign>" sign "</sign></clef></attributes>"
    load(HEAD PART("Pauken, Xylophon, Kl. Trommel")
             BAR(1, FOUR CLEF("F") NOTE(D, 3, 4, "") CLEF("G") NOTE(C, 5, 4, "") CLEF("percussion")
                        HIT("") CLEF("F") NOTE(D, 3, 4, "")) TAIL);
    expect_drums(4, (const char *const[]){"third", "xylophone", "snare", "third"});
}

// each staff of several kinds has its dynamics and its words
static void test_staves_have_their_own_words(void)
{
    load(PLAYED_BY(TIMPANI_AND_SNARE)
             BAR(1, FOUR SAYS(1, "<dynamics><ff/></dynamics>") SAYS(1, "<words>near rim</words>")
                        ON(1, "T", 16) BACK SAYS(2, "<dynamics><pp/></dynamics>") ON(2, "S", 4)
                            SAYS(2, "<words>snares off</words>") ON(2, "S", 12))
                 BAR(2, SAYS(1, "<words>hard sticks</words>") ON(1, "T", 16)) TAIL);
    expect_drums(4, (const char *const[]){"snare", "third", "snare", "third"});
    expect_dynamics(4, 1.0, 6.0, 1.0, 6.0);
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, stroke(0)->spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_RIM, stroke(1)->spot);
    expect_text("snare wires 0;");
    TEST_ASSERT_NULL(strstr(made.text, "third wires"));
    load(PLAYED_BY(TIMPANI_AND_SNARE) BAR(1, FOUR SAYS(1, "<words>coperto</words>") ON(1, "T", 16)
                                                 BACK ON(2, "S", 16)) TAIL);
    expect_text("third muffle 1;");
    TEST_ASSERT_NULL(strstr(made.text, "snare muffle"));
    // what only one of them has is not the other's, whichever note comes first
    load(PLAYED_BY(TIMPANI_AND_SNARE)
             BAR(1, FOUR SAYS(1, "<dynamics><ff/></dynamics>") ON(1, "T", 16)
                        BACK SAYS(2, "<words>near rim</words>") ON(2, "S", 16)) TAIL);
    for (int i = 0; i < 2; i++) {
        bool snare = strcmp(stroke(i)->drum, "snare") == 0;
        TEST_ASSERT_EQUAL(snare ? HIMC_SPOT_RIM : HIMC_SPOT_NORMAL, stroke(i)->spot);
        TEST_ASSERT_FLOAT_WITHIN(0.01, snare ? 4 : 6, 7 * stroke(i)->dynamic);
    }
    // a roll is not cut where the other's dynamic changes
    load(PLAYED_BY(TIMPANI_AND_SNARE) BAR(
        1, FOUR
        "<note><pitch><step>D</step><octave>3</octave></pitch><duration>16"
        "</duration><instrument id='T'/><voice>1</voice><staff>1</staff>" MARKS(
            3) "</note>" BACK ON(2, "S", 8)
            SAYS(
                2,
                "<dynamics><ff/></dynamics>") "<note><rest/><duration>8</duration><voice>2</voice><staff>2</staff>"
                                              "</note>") BAR(2, ON(2, "S", 16)) TAIL);
    TEST_ASSERT_EQUAL_MESSAGE(4, score->stroke_count, made.text); // both hands, one roll, the snare
}

// drums of one sort are told apart by their names, and by their places on the staff
static void test_names_of_drums_say_high_and_low(void)
{
    static const struct {
        const char *name;
        int key;
    } rows[] = {{"Tom-tom 1", 50},
                {"Tom I", 50},
                {"Tom 2", 48},
                {"Tom-Tom III", 45},
                {"Hohes Tom", 50},
                {"Tom aigu", 50},
                {"Tom médium", 48},
                {"Tom grave", 45},
                {"Tom-tom", 48},
                {"Large Tom", 45},
                {"4 Tom-toms", 48},
                {"Floor Tom", 43},
                {"Low Tom", 45},
                {"Wood Block (high)", 76},
                {"Wood Block 2", MIDI_MIDDLE_BLOCK},
                {"Holzblock tief", 77},
                {"Bloc de bois moyen", MIDI_MIDDLE_BLOCK},
                {"Kleine Kuhglocke", MIDI_HIGH_COWBELL},
                {"Cowbell large", MIDI_LOW_COWBELL},
                {"Cowbell", 56},
                {"Temple Block 1", MIDI_LOW_TEMPLE_BLOCK + 4},
                {"Temple Block 5", MIDI_LOW_TEMPLE_BLOCK},
                {"Tempelblock", MIDI_TEMPLE_BLOCKS},
                {"second temple block", MIDI_LOW_TEMPLE_BLOCK + 1},
                {"Bongo grave", 61},
                {"Kl. Tr.", 38},
                {"Gr. Tr.", MIDI_BASS_DRUM},
                {"S.D.", 38},
                {"B.D.", MIDI_BASS_DRUM}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        int key = 0;
        TEST_ASSERT_EQUAL_MESSAGE(MIDI_DRUMS, himc_music_instrument(rows[i].name, &key),
                                  rows[i].name);
        TEST_ASSERT_EQUAL_MESSAGE(rows[i].key, key, rows[i].name);
    }
    int key;
    for (int i = 0; i < 7; i++) // seven toms on the five that there are, the outer ones apart
        TEST_ASSERT_TRUE(himc_music_of_sort(48, i, 7) >= himc_music_of_sort(48, i + 1, 8));
    TEST_ASSERT_EQUAL(50, himc_music_of_sort(48, 0, 7));
    TEST_ASSERT_EQUAL(41, himc_music_of_sort(48, 6, 7));
    TEST_ASSERT_EQUAL(MIDI_TUBULAR_BELL, himc_music_instrument("Chimes", &key));
    TEST_ASSERT_EQUAL(MIDI_DRUMS, himc_music_instrument("Wind Chimes", &key));
    TEST_ASSERT_EQUAL(MIDI_NO_SOUND, key);
    load(HEAD PART("Temple Blocks") BAR(1, FOUR AT(D, 4) AT(F, 4) AT(A, 4) AT(C, 5))
             BAR(2, AT(E, 5)) TAIL);
    static const char *const parts[] = {"low", "second", "third", "fourth", "high"};
    for (int i = 0; i < 5; i++)
        TEST_ASSERT_EQUAL_STRING(parts[i], stroke(i)->part);
    load(HEAD PART("Tom-toms") BAR(1, FOUR AT(C, 5) AT(E, 5) AT(A, 4) AT(C, 5)) TAIL);
    expect_drums(4, (const char *const[]){"tom", "high-tom", "mid-tom", "tom"});
    load(HEAD PART("Tom-toms") BAR(1, FOUR AT(C, 5) AT(C, 5)) TAIL);
    expect_drums(2, (const char *const[]){"tom", "tom"});
}

static void test_what_is_not_known_on_one_line_is_told_and_left_out(void)
{
    load(HEAD "<part-list>" PLAYER(
        "P1", "Percussion",
        INSTRUMENT("A", "Anvil") INSTRUMENT(
            "S", "Snare Drum")) "</part-list><part id='P1'>" BAR(1, ONE_LINE OF("S", E, 4) HIT("")
                                                                        OF("S", E, 4)) TAIL);
    expect_drums(2, (const char *const[]){"snare", "snare"});
    expect_text("1 note is not played: there is no instrument for it (bar 1)");
    expect_text("no such instrument here: Anvil");
}

// not as another one: by its place, by a part of its name, nor as that of its part
static void test_an_unknown_instrument_is_told_by_its_name_and_left_out(void)
{
    static const char *const names[] = {
        "Anvil",       "Amboss",      "Sleigh Bells",  "Crotales",       "Thunder Sheet",
        "Brake Drum",  "Log Drum",    "Cajon",         "Rute",           "Castagnettes",
        "Lion's Roar", "Waldteufel",  "Rahmentrommel", "Finger Cymbals", "Holztrommel",
        "Castanets",   "Castañuelas", "Nacchere",      "Peitsche",       "Frusta",
        "Steel Drum",  "Schellen",    "Temple Bowl",   "Tambour de bois"};
    static const char *const parts[] = {"Percussion", "Schlagzeug", "Snare Drum"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char text[4096], line[100];
        snprintf(text, sizeof text,
                 HEAD "<part-list>" PLAYER(
                     "P1", "%s",
                     INSTRUMENT("A", "%s") INSTRUMENT(
                         "S", "Snare Drum")) "</part-list><part id='P1'><measure number='1'>" FOUR
                     OF("A", F, 4) OF("S", E, 4) OF("A", C, 5) OF("S", E, 4) "</measure>" TAIL,
                 parts[i % 3], names[i]);
        load(text);
        expect_drums(2, (const char *const[]){"snare", "snare"});
        snprintf(line, sizeof line, "comment no such instrument here: %s;\n", names[i]);
        expect_text(line);
    }
    TEST_ASSERT_FALSE(import(
        HEAD PART("Amboss") BAR(1, FOUR "<note><unpitched/><duration>16</duration></note>") TAIL));
    TEST_ASSERT_EQUAL_STRING("nothing to play: no such instrument here: Amboss", error.text);
}

static void test_names_that_sound_alike_are_told_apart(void)
{
    static const struct {
        const char *name, *drum;
    } rows[] = {{"Tamburo basco", "tambourine"},
                {"Pandereta", "tambourine"},
                {"Schellentrommel", "tambourine"},
                {"Tambour de basque", "tambourine"},
                {"Tenor Drum", "mid-tom"},
                {"Rührtrommel", "mid-tom"},
                {"Wirbeltrommel", "mid-tom"},
                {"Tamburo piccolo", "snare"},
                {"Tambour", "snare"},
                {"Drumset", "kick"},
                {"Drums", "kick"},
                {"Percussion 2", "kick"},
                {"Schlagzeug", "kick"},
                {"Batterie", "kick"},
                {"Multi-Percussion", "kick"},
                {"Jazz Drums", "kick"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD PART("%s") BAR(1, FOUR "<note><unpitched><display-step>F</display-step>"
                                             "<display-octave>4</display-octave></unpitched>"
                                             "<duration>16</duration></note>") TAIL,
                 rows[i].name);
        load(text);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(rows[i].drum, stroke(0)->drum, rows[i].name);
    }
}

#define SNARE_AND_XYLOPHONE INSTRUMENT("S", "Snare Drum") INSTRUMENT("X", "Xylophone")
#define TWO_PLAYERS                                                                        \
    PLAYED_BY(PLAYER("P1", "Timpani", "") PLAYER("P2", "Percussion", SNARE_AND_XYLOPHONE)) \
    BAR(1, FOUR NOTE(D, 3, 4, "") NOTE(D, 3, 4, ""))                                       \
    "</part><part id='P2'>" BAR(1, FOUR REST(8) OF("S", E, 4) OF("X", C, 5)) TAIL

static void test_other_players_are_told_and_all_can_be_asked_for(void)
{
    load(TWO_PLAYERS);
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    expect_text("2 notes for other percussion are not asked for: drums xylophone");
    forget();
    TEST_ASSERT_TRUE(himc_music_import(&made, TWO_PLAYERS, strlen(TWO_PLAYERS), "all",
                                       &(midi_options){.all = true}, &error));
    score = himc_score_parse(made.text, "made.txt", NULL, &error);
    expect_loaded();
    expect_drums(4, (const char *const[]){"third", "third", "snare", "xylophone"});
    TEST_ASSERT_NULL(strstr(made.text, "not asked for"));
}

#define CHORD(step, octave)                                                                      \
    "<note><chord/><pitch><step>" #step "</step><octave>" #octave "</octave></pitch><duration>4" \
    "</duration><voice>1</voice></note>"
#define LOUD(step, octave)                                                       \
    "<note dynamics='130'><chord/><pitch><step>" #step "</step><octave>" #octave \
    "</octave></pitch><duration>4</duration><voice>1</voice></note>"

static void expect_parts(int count, const char *const *part)
{
    TEST_ASSERT_EQUAL_MESSAGE(count, score->stroke_count, made.text);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_EQUAL_STRING_MESSAGE(part[i], stroke(i)->part, made.text);
}

static void test_of_a_chord_two_hands_play_the_outer_notes(void)
{
    load(HEAD PART("Vibraphone") BAR(
        1, FOUR NOTE(E, 4, 4, "") CHORD(C, 4) CHORD(B, 4) CHORD(G, 4) NOTE(F, 3, 4, "") CHORD(A, 3)
               CHORD(C, 4) CHORD(E, 4) NOTE(E, 5, 4, "") CHORD(C, 4) CHORD(G, 4) REST(4)) TAIL);
    expect_parts(6, (const char *const[]){"C4", "B4", "F3", "E4", "C4", "E5"});
    for (int i = 0; i < 6; i++)
        TEST_ASSERT_EQUAL(i % 2 ? HIMC_RIGHT : HIMC_LEFT, stroke(i)->hand);
    expect_text("5 notes are not played: both hands are busy (bar 1)");
    // but not without a louder one
    load(HEAD PART("Vibraphone") BAR(1, FOUR DYNAMICS("p") NOTE(C, 4, 4, "") CHORD(E, 4) LOUD(G, 4)
                                            CHORD(B, 4) REST(12)) TAIL);
    TEST_ASSERT_EQUAL(2, score->stroke_count);
    TEST_ASSERT_TRUE_MESSAGE(
        strcmp(stroke(0)->part, "G4") == 0 || strcmp(stroke(1)->part, "G4") == 0, made.text);
}

static void test_a_part_beyond_what_is_built_moves_as_a_whole(void)
{
    load(HEAD PART("Glockenspiel") BAR(1, FOUR NOTE(G, 5, 4, "") NOTE(E, 5, 4, "") NOTE(C, 5, 4, "")
                                              NOTE(G, 4, 4, "")) TAIL);
    expect_parts(4, (const char *const[]){"G6", "E6", "C6", "G5"});
    expect_text("all notes for glockenspiel are moved up by 1 octave to what is built");
    TEST_ASSERT_NULL(strstr(made.text, "note is moved"));
    // what does not fit then is moved alone
    load(HEAD PART("Glockenspiel") BAR(1, FOUR NOTE(G, 5, 4, "") NOTE(E, 5, 4, "") NOTE(C, 5, 4, "")
                                              NOTE(C, 9, 4, "")) TAIL);
    expect_parts(4, (const char *const[]){"G6", "E6", "C6", "C8"});
    expect_text("1 note is moved by octaves to what is built");
    // what fits stays
    load(HEAD PART("Marimba") BAR(1, FOUR NOTE(C, 3, 4, "") NOTE(E, 3, 4, "") NOTE(G, 3, 4, "")
                                         NOTE(C, 2, 4, "") NOTE(C, 7, 4, "")) TAIL);
    expect_parts(5, (const char *const[]){"C3", "E3", "G3", "C3", "C7"});
    TEST_ASSERT_NULL(strstr(made.text, "all notes for"));
}

// where an instrument stands (m)
static void place_of(const char *drum, double *x, double *y)
{
    char line[64];
    snprintf(line, sizeof line, "\n%s place ", drum);
    const char *at = strstr(made.text, line);
    TEST_ASSERT_NOT_NULL_MESSAGE(at, drum);
    TEST_ASSERT_EQUAL(2, sscanf(at + strlen(line), "%lf %lf", x, y));
}

static void test_a_keyboard_has_an_octave_at_least(void)
{
    char low[8], high[8];
    double from, to;
    load(HEAD PART("Marimba") BAR(1, FOUR NOTE(C, 5, 16, "")) TAIL);
    const char *line = strstr(made.text, "instrument marimba");
    TEST_ASSERT_EQUAL(2, sscanf(line, "instrument marimba marimba %7s %7[^;]", low, high));
    TEST_ASSERT_TRUE(himc_note_frequency(low, &from));
    TEST_ASSERT_TRUE(himc_note_frequency(high, &to));
    TEST_ASSERT_TRUE(to / from > 1.999);
}

static void test_instruments_stand_apart_and_in_reach(void)
{
    static const char *const drums[] = {"third", "xylophone", "snare", "crash", "bass-drum", "tom"};
    load(HEAD "<part-list>" PLAYER(
        "P1", "Percussion",
        INSTRUMENT("T", "Timpani") INSTRUMENT("X", "Xylophone") INSTRUMENT("S", "Snare Drum")
            INSTRUMENT("C", "Cymbal") INSTRUMENT("B", "Bass Drum") INSTRUMENT(
                "O", "Tom")) "</part-list><part id='P1'>" BAR(1, FOUR OF("T", D, 3) OF("X", C, 5)
                                                                     OF("S", E, 4) OF("C", E, 4)
                                                                         OF("B", E, 4)
                                                                             OF("O", E, 4)) TAIL);
    expect_drums(6, drums);
    for (int i = 0; i < 6; i++) {
        double x, y, other_x, other_y;
        place_of(drums[i], &x, &y);
        TEST_ASSERT_TRUE_MESSAGE(hypot(x, y) < 1.2 && x > -0.4, drums[i]);
        for (int k = 0; k < i; k++) {
            place_of(drums[k], &other_x, &other_y);
            TEST_ASSERT_TRUE_MESSAGE(hypot(x - other_x, y - other_y) > 0.3, made.text);
        }
    }
}

// drums alone: each pair and more are played, whatever they are
static void test_each_drum_of_a_percussionist_is_struck(void)
{
    static const char *const sets[][3] = {{"Snare Drum", "Low Tom", "Snare Drum"},
                                          {"Low Wood Block", "High Wood Block", "Tambourine"},
                                          {"Bass Drum", "Conga", "Cymbal"},
                                          {"Tom", "High Cowbell", "Triangle"}};
    for (int k = 0; k < 4; k++) {
        char text[4096];
        snprintf(
            text, sizeof text,
            HEAD "<part-list>" PLAYER(
                "P1", "Percussion",
                INSTRUMENT("A", "%s") INSTRUMENT("B", "%s") INSTRUMENT(
                    "C", "%s")) "</part-list><part id='P1'><measure number='1'>" FOUR TEMPO(100)
                OF("A", F, 4) OF("B", E, 4) OF("C", C, 5) OF("B", E, 4) "</measure>" TAIL,
            sets[k][0], sets[k][1], sets[k][2]);
        load(text);
        himc_performance_config config = himc_performance_default();
        himc_performance *p = himc_performance_new(&config, &error);
        himc_command play;
        TEST_ASSERT_TRUE_MESSAGE(
            p && himc_performance_load_text(p, made.text, "made", &error) &&
                himc_command_parse_text(&play, HIMC_PERFORMER, "play", &error) &&
                himc_performance_command(p, &play, 0, &error),
            error.text);
        for (int i = 0; i < 6 * config.sample_rate / 480; i++)
            himc_performance_process(p, 480, NULL);
        TEST_ASSERT_EQUAL_MESSAGE(4, himc_performance_measure(p).played, made.text);
        TEST_ASSERT_EQUAL_MESSAGE(0, himc_performance_measure(p).missed, made.text);
        himc_performance_free(p);
    }
}

// a score of ours, out and in again

static void expect_back(const char *words, bool midi)
{
    himc_text_lines text = {0};
    midi_file notes;
    himc_score *from = himc_score_parse(words, "words", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(from, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, from, midi, &error), error.text);
    TEST_ASSERT_TRUE(midi ? himc_music_write_midi(&text, &notes)
                          : himc_music_write(&text, &notes, "words"));
    forget();
    TEST_ASSERT_TRUE_MESSAGE(
        himc_score_maker_of(text.bytes, text.size)(&made, text.bytes, text.size, "b", NULL, &error),
        error.text);
    score = himc_score_parse(made.text, "made.txt", NULL, &error);
    expect_loaded();
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_EQUAL_MESSAGE(from->stroke_count, score->stroke_count, made.text);
    for (int i = 0; i < from->stroke_count; i++) {
        const himc_stroke *a = &from->strokes[i], *b = stroke(i);
        TEST_ASSERT_FLOAT_WITHIN(2e-3, a->beat + lead(), b->beat);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(a->drum, b->drum, made.text);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(a->part, b->part, made.text);
        TEST_ASSERT_FLOAT_WITHIN(0.02, a->dynamic, b->dynamic);
        TEST_ASSERT_TRUE(midi || a->hand == b->hand);
        TEST_ASSERT_TRUE(midi || (a->nuance == b->nuance && a->ornament == b->ornament));
    }
    himc_score_free(from);
    himc_midi_file_free(&notes);
    free(text.bytes);
}

static const char several[] =
    "drum low 32; low tune D2; instrument xylophone xylophone F4 C6; instrument snare snare 14;"
    "instrument tam-tam tam-tam 32; instrument temple-blocks temple-blocks;"
    "instrument low-cowbell cowbell 420; instrument agogo agogo; tempo 60;"
    "stroke 0 left legato p low; stroke 1 right legato f F5 xylophone;"
    "stroke 2 left legato mf snare;"
    "stroke 3 right legato ff tam-tam; stroke 4 left legato mp low temple-blocks;"
    "stroke 5 right legato mf fourth temple-blocks; stroke 6 left legato f low-cowbell;"
    "stroke 7 right legato f low agogo; stroke 8 right legato f high agogo;";

static void test_several_kinds_come_back_from_one_part(void)
{
    expect_back(several, false);
    expect_text("9 of 9 notes for timpani drums xylophone are played");
    static const char more[] =
        "drum low 32; low tune D2; instrument marimba marimba C3 C6; instrument snare snare 14;"
        "tempo 60; roll 0 4 single pp ff low; stroke 4.5 right legato p C4 marimba;"
        "flam 5 left accent f snare; stroke 7 right tenuto mp E4 marimba;";
    expect_back(more, false);
    expect_roll(0, 0, 4, 1, 6);
}

static void test_several_kinds_come_back_from_midi(void)
{
    expect_back(several, true);
}

// of drums with names of their own those stand that are nearest in size, each another one
static void test_drums_of_one_kind_stay_apart(void)
{
    himc_text_lines text = {0};
    midi_file notes;
    himc_score *from = himc_score_parse(
        "instrument a tom 10; instrument b tom 14; instrument c tom 14.5; instrument d cowbell 400;"
        "instrument e cowbell 800; stroke 1 right legato f a; stroke 2 right legato f b;"
        "stroke 3 right legato f c; stroke 4 right legato f d; stroke 5 right legato f e;",
        "words", NULL, &error);
    TEST_ASSERT_TRUE(himc_music_notes(&notes, from, false, &error));
    TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "words"));
    load(text.bytes);
    expect_drums(
        5, (const char *const[]){"high-tom", "mid-tom", "floor", "low-cowbell", "high-cowbell"});
    himc_score_free(from);
    himc_midi_file_free(&notes);
    free(text.bytes);
}

// a name says more than the id of its sound, which is of a whole family
static void test_names_of_instruments_decide_before_their_sounds(void)
{
#define SOUNDING(id, name, sound)                          \
    "<score-instrument id='" id "'><instrument-name>" name \
    "</instrument-name><instrument-sound>" sound "</instrument-sound></score-instrument>"
    static const char *const drums[] = {"kick", "floor", "hats", "ride"};
    load(HEAD "<part-list>" PLAYER(
        "P1", "Drum Set",
        SOUNDING("K", "Kick Drum", "drum.bass-drum") SOUNDING("F", "Floor Tom", "drum.tom-tom")
            SOUNDING("H", "Pedal Hi-Hat", "metal.hi-hat") SOUNDING(
                "C", "Cymbal",
                "metal.cymbal.ride")) "</part-list><part id='P1'>" BAR(1,
                                                                       FOUR OF("K", F, 4) OF(
                                                                           "F", A, 4) OF("H", D, 4)
                                                                           OF("C", F, 5)) TAIL);
    expect_drums(4, drums);
    TEST_ASSERT_EQUAL(HIMC_FOOT, stroke(0)->hand);
    TEST_ASSERT_EQUAL(HIMC_FOOT, stroke(2)->hand);
}

#define WRITTEN(step, octave)                                                        \
    "<note><unpitched><display-step>" step "</display-step><display-octave>" #octave \
    "</display-octave></unpitched><duration>4</duration><voice>1</voice></note>"

// two drums in one name: where a note is written says which
static void test_a_name_of_two_drums_is_both(void)
{
    static const char *const names[][3] = {{"Snare Drum &amp; Bass Drum", "snare", "bass-drum"},
                                           {"S.D./B.D.", "snare", "bass-drum"},
                                           {"Percussion 1 (Cymbals, Snare Drum)", "crash", "snare"},
                                           {"Triangle, Tambourine", "triangle", "tambourine"}};
    for (int i = 0; i < 4; i++)
        for (int declared = 0; declared < 2; declared++) {
            char text[4096];
            snprintf(text, sizeof text,
                     HEAD "<part-list><score-part id='P1'><part-name>%s</part-name>%s%s%s"
                          "</score-part></part-list><part id='P1'>" BAR(
                              1, FOUR WRITTEN("C", 5) WRITTEN("F", 4) WRITTEN("C", 5)
                                     WRITTEN("F", 4)) TAIL,
                     names[i][0], declared ? "<score-instrument id='I'><instrument-name>" : "",
                     declared ? names[i][0] : "",
                     declared ? "</instrument-name></score-instrument>" : "");
            load(text);
            for (int k = 0; k < 4; k++)
                TEST_ASSERT_EQUAL_STRING_MESSAGE(names[i][1 + k % 2], stroke(k)->drum, made.text);
        }
}

// of three drums in a name two are written, each in its usual place
static void test_a_drum_of_a_name_may_have_no_notes(void)
{
    load(HEAD PART("Cymbals, Snare Drum, Bass Drum")
             BAR(1, FOUR WRITTEN("C", 5) WRITTEN("F", 4) WRITTEN("C", 5) WRITTEN("F", 4)) TAIL);
    expect_drums(4, (const char *const[]){"snare", "bass-drum", "snare", "bass-drum"});
}

// the staff of words is 1 where there is one only, though notes do not say it
static void test_words_of_staff_one_are_of_notes_without_a_staff(void)
{
    static const char *const drums[] = {"crash", "crash", "snare", "snare"};
#define TOLD(words)                            \
    "<direction><direction-type><words>" words \
    "</words></direction-type><staff>1</staff></direction>"
    load(HEAD PART("Percussion") BAR(1, ONE_LINE TOLD("Cymbals") LINE("B") LINE("B")
                                            TOLD("Snare Drum") LINE("B") LINE("B")) TAIL);
    expect_drums(4, drums);
}

static void test_toms_of_a_kit_are_apart_where_they_are_written(void)
{
    static const char *const drums[] = {"high-tom", "tom", "floor", "snare"};
    load(HEAD PART("Drum Set")
             BAR(1, FOUR WRITTEN("E", 5) WRITTEN("D", 5) WRITTEN("A", 4) WRITTEN("C", 5)) TAIL);
    expect_drums(4, drums);
}

// not while its note is written, if there is time before the next, wherever the word stands
static void test_a_pedal_waits_for_the_end_of_a_long_note(void)
{
    static const char *const words[] = {"C muta in D", "muta in D", ""};
    for (int i = 0; i < 3; i++) {
        char text[4096];
        snprintf(
            text, sizeof text,
            HEAD PART("Timpani") "<measure number='1'>" FOUR TEMPO(60) NOTE(
                C, 3, 16,
                "") "<backup><duration>8</duration></backup><direction><direction-type><words>%s"
                    "</words></direction-type></direction><forward><duration>8</duration>"
                    "</forward></measure>" BAR(2, REST(16)) BAR(3, WORDS("%s") REST(16))
                        BAR(4, NOTE(D, 3, 16, "")) TAIL,
            words[i], i < 2 ? "" : "muta in D");
        load(text);
        double beat = -1;
        for (int k = 0; k < score->change_count; k++)
            if (score->changes[k].command.id == HIMC_COMMAND_GLISS)
                beat = score->changes[k].beat - lead();
        TEST_ASSERT_TRUE_MESSAGE(beat >= (i < 2 ? 4 : 8) && beat < 12, made.text);
    }
}

// the note that a line leads to is struck on the drum that has glided, though another has its pitch
static void test_a_line_ends_on_the_drum_that_glides(void)
{
#define SLIDE(type) "<notations><slide type='" type "' number='1'/></notations>"
    load(HEAD PART("Timpani") BAR(1, FOUR TEMPO(90) C3(4, "") REST(12))
             BAR(2, NOTE(F, 2, 8, SLIDE("start")) NOTE(C, 3, 8, SLIDE("stop"))) TAIL);
    TEST_ASSERT_EQUAL(3, score->stroke_count);
    TEST_ASSERT_EQUAL_STRING(stroke(1)->drum, stroke(2)->drum);
    TEST_ASSERT_TRUE(strcmp(stroke(0)->drum, stroke(1)->drum) != 0);
}

// found by the fuzzer: a gliss down to a pitch that no drum has
static void test_a_gliss_far_beyond_a_drum_is_counted(void)
{
    load(HEAD PART("Timpani") BAR(1, FOUR C3(8, "") WORDS("gliss. C6 to D2") C3(8, "")) TAIL);
    expect_text("1 word about tuning is not followed");
    expect_text("2 of 2 notes for timpani are played");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_ids_of_notes_say_the_instrument);
    RUN_TEST(test_words_change_the_instrument);
    RUN_TEST(test_words_that_name_sticks_or_a_pitch_change_no_instrument);
    RUN_TEST(test_a_sound_changes_the_instrument);
    RUN_TEST(test_clefs_say_the_instrument_where_notes_do_not);
    RUN_TEST(test_staves_have_their_own_words);
    RUN_TEST(test_names_of_drums_say_high_and_low);
    RUN_TEST(test_what_is_not_known_on_one_line_is_told_and_left_out);
    RUN_TEST(test_an_unknown_instrument_is_told_by_its_name_and_left_out);
    RUN_TEST(test_names_that_sound_alike_are_told_apart);
    RUN_TEST(test_of_a_chord_two_hands_play_the_outer_notes);
    RUN_TEST(test_a_part_beyond_what_is_built_moves_as_a_whole);
    RUN_TEST(test_a_keyboard_has_an_octave_at_least);
    RUN_TEST(test_each_drum_of_a_percussionist_is_struck);
    RUN_TEST(test_other_players_are_told_and_all_can_be_asked_for);
    RUN_TEST(test_instruments_stand_apart_and_in_reach);
    RUN_TEST(test_several_kinds_come_back_from_one_part);
    RUN_TEST(test_several_kinds_come_back_from_midi);
    RUN_TEST(test_drums_of_one_kind_stay_apart);
    RUN_TEST(test_names_of_instruments_decide_before_their_sounds);
    RUN_TEST(test_a_name_of_two_drums_is_both);
    RUN_TEST(test_a_drum_of_a_name_may_have_no_notes);
    RUN_TEST(test_words_of_staff_one_are_of_notes_without_a_staff);
    RUN_TEST(test_toms_of_a_kit_are_apart_where_they_are_written);
    RUN_TEST(test_a_pedal_waits_for_the_end_of_a_long_note);
    RUN_TEST(test_a_line_ends_on_the_drum_that_glides);
    RUN_TEST(test_a_gliss_far_beyond_a_drum_is_counted);
    return UNITY_END();
}
