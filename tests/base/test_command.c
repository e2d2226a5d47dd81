/// test_command.c: every row of the command table parses, every fault is one line and changes
/// nothing.
#define _DEFAULT_SOURCE // strsep
#include "unity.h"

#include "base/argument.h"
#include "control/controller.h"
#include "drum/drum_state.h"
#include "himc/command.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static himc_command command;
static himc_error error;

void setUp(void)
{
    memset(&command, 0, sizeof command);
    error.text[0] = '\0';
}

void tearDown(void)
{
}

static bool perform(const char *text)
{
    return himc_command_parse_text(&command, HIMC_PERFORMER, text, &error);
}

static bool drum(const char *text)
{
    return himc_command_parse_text(&command, HIMC_DRUM, text, &error);
}

static void refused(bool good, const char *text)
{
    TEST_ASSERT_FALSE(good);
    TEST_ASSERT_EQUAL_STRING(text, error.text);
}

static void test_table_is_complete_and_in_order_of_the_ids(void)
{
    for (int i = 0; i < HIMC_COMMANDS; i++)
        TEST_ASSERT_EQUAL_INT(i, himc_command_table(i)->id);
    TEST_ASSERT_NULL(himc_command_table(HIMC_COMMANDS));
    TEST_ASSERT_NULL(himc_command_table(-1));
}

#define TOKENS 12 // of a form, and room for one atom too many

/// A form of a row's grammar, and atoms that fit it.
typedef struct example {
    const himc_command_row *row;
    int form, count, required;
    bool more; // any atoms may follow
    char token[TOKENS][64];
    const himc_argument *argument[TOKENS]; // NULL for literal words
    himc_atom atom[TOKENS];
} example;

// an atom that the argument accepts
static himc_atom fitting(const himc_argument *a)
{
    static const char *const note = "A2", *const free_word = "a-word";
    if (a->kind == HIMC_ARGUMENT_NUMBER || a->kind == HIMC_ARGUMENT_COUNT)
        return (himc_atom){HIMC_ATOM_NUMBER, a->high, NULL};
    return (himc_atom){HIMC_ATOM_SYMBOL, 0,
                       a->kind == HIMC_ARGUMENT_NOTE ? note
                       : a->words                    ? a->words[0]
                                                     : free_word};
}

// word `index` of the token "a|b|c" into `word`; false past the last
static bool cut(const char *token, int index, char word[64])
{
    char copy[64], *rest = copy, *found = NULL;
    snprintf(copy, sizeof copy, "%s", token);
    for (int i = 0; i <= index; i++)
        found = rest ? strsep(&rest, "|") : NULL;
    snprintf(word, 64, "%s", found ? found : "");
    return found;
}

// fills in the tokens and fitting atoms of the form that begins at `grammar`; returns the next form
static const char *make_example(example *e, const char *grammar)
{
    static char first[TOKENS][64];
    const char *context = e->row->name, *end = strstr(grammar, " | ");
    size_t length = end ? (size_t)(end - grammar) : strlen(grammar);
    char text[256], *rest = text, *token;
    snprintf(text, sizeof text, "%.*s", (int)length, grammar);
    e->count = e->required = 0;
    e->more = false;
    while (text[0] && (token = strsep(&rest, " "))) {
        if (strcmp(token, "[...]") == 0) {
            e->more = true;
            continue;
        }
        int i = e->count++;
        e->required += token[0] != '[';
        snprintf(e->token[i], sizeof e->token[i], "%.*s",
                 (int)strcspn(token + (*token == '['), "]"), token + (*token == '['));
        e->argument[i] = NULL;
        if (isupper((unsigned char)e->token[i][0])) {
            e->argument[i] = himc_argument_find(e->token[i], context);
            TEST_ASSERT_NOT_NULL_MESSAGE(e->argument[i], e->token[i]);
            e->atom[i] = fitting(e->argument[i]);
        } else {
            cut(e->token[i], 0, first[i]);
            context = first[i];
            e->atom[i] = (himc_atom){HIMC_ATOM_SYMBOL, 0, first[i]};
        }
    }
    return end ? end + 3 : NULL;
}

static void each_form(void (*visit)(example *e))
{
    for (int i = 0; i < HIMC_COMMANDS; i++) {
        example e = {.row = himc_command_table(i)};
        const char *grammar = e.row->atoms;
        for (; grammar; e.form++) {
            grammar = make_example(&e, grammar);
            visit(&e);
        }
    }
}

static bool parse(const example *e, int count)
{
    return himc_command_parse(&command, e->row->receiver, e->row->name, e->atom, count, &error);
}

// the atoms do not fit this form: one line, and nothing changed, unless another form takes them
static void refuses(const example *e, int count)
{
    static himc_command before;
    memset(&command, 0x5a, sizeof command);
    memcpy(&before, &command, sizeof before);
    error.text[0] = '\0';
    if (parse(e, count)) {
        TEST_ASSERT_TRUE_MESSAGE(command.form != e->form, e->row->name);
        return;
    }
    TEST_ASSERT_TRUE_MESSAGE(strlen(error.text) > 10 && !strchr(error.text, '\n'), e->row->name);
    TEST_ASSERT_EQUAL_STRING_LEN(e->row->name, error.text, strlen(e->row->name));
    TEST_ASSERT_EQUAL_MEMORY(&before, &command, sizeof before);
}

// atom `i` in place of the fitting one
static void refuses_atom(example *e, int i, himc_atom atom)
{
    himc_atom good = e->atom[i];
    e->atom[i] = atom;
    refuses(e, e->count);
    e->atom[i] = good;
}

static void check_choices(example *e)
{
    TEST_ASSERT_TRUE_MESSAGE(parse(e, e->count), error.text);
    bool preset = e->row->id == HIMC_COMMAND_PRESET; // `preset NAME` is `score NAME.txt`
    TEST_ASSERT_EQUAL_INT(preset ? HIMC_COMMAND_SCORE : e->row->id, command.id);
    TEST_ASSERT_EQUAL_INT_MESSAGE(e->form, command.form, e->row->name);
    for (int i = 0; i < e->count; i++) {
        const himc_argument *a = e->argument[i];
        himc_atom good = e->atom[i];
        char word[64];
        if (a && !a->words)
            TEST_ASSERT_EQUAL_INT_MESSAGE(-1, command.choice[i], e->row->name);
        for (int k = 0; a ? a->words && a->words[k] : cut(e->token[i], k, word); k++) {
            e->atom[i] = (himc_atom){HIMC_ATOM_SYMBOL, 0, a ? a->words[k] : word};
            TEST_ASSERT_TRUE_MESSAGE(parse(e, e->count), error.text);
            TEST_ASSERT_EQUAL_INT_MESSAGE(k, command.choice[i], e->atom[i].symbol);
            if (e->form == 0 && !a)
                TEST_ASSERT_EQUAL_STRING(word, himc_command_word(e->row->id, i, k).text);
        }
        e->atom[i] = good;
    }
}

static void check_kinds(example *e)
{
    for (int i = 0; i < e->count; i++) {
        const himc_argument *a = e->argument[i];
        bool number = e->atom[i].kind == HIMC_ATOM_NUMBER;
        if (!number)
            refuses_atom(e, i, (himc_atom){HIMC_ATOM_NUMBER, 0.5, NULL});
        if (!a || a->words || number || a->kind == HIMC_ARGUMENT_NOTE)
            refuses_atom(e, i, (himc_atom){HIMC_ATOM_SYMBOL, 0, "no-such-word"});
    }
}

static void check_ranges(example *e)
{
    for (int i = 0; i < e->count; i++) {
        const himc_argument *a = e->argument[i];
        if (e->atom[i].kind != HIMC_ATOM_NUMBER)
            continue;
        const double bad[] = {NAN, INFINITY, -INFINITY, a->low - fabs(a->low) - 1,
                              a->high + fabs(a->high) + 1};
        for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
            refuses_atom(e, i, (himc_atom){HIMC_ATOM_NUMBER, bad[k], NULL});
        if (a->kind == HIMC_ARGUMENT_COUNT)
            refuses_atom(e, i, (himc_atom){HIMC_ATOM_NUMBER, a->low + 0.5, NULL});
    }
}

static void check_counts(example *e)
{
    for (int count = 0; count < e->required; count++)
        refuses(e, count);
    for (int i = e->count; i < TOKENS; i++)
        e->atom[i] = (himc_atom){HIMC_ATOM_NUMBER, 0.5, NULL};
    refuses(e, e->more ? TOKENS : e->count + 1);
}

static void test_every_word_of_every_row_parses_to_its_index(void)
{
    each_form(check_choices);
}

static void test_atoms_of_the_wrong_kind_are_refused_in_every_row(void)
{
    each_form(check_kinds);
}

static void test_numbers_out_of_range_or_not_finite_are_refused_in_every_row(void)
{
    each_form(check_ranges);
}

static void test_missing_and_excess_atoms_are_refused_in_every_row(void)
{
    each_form(check_counts);
}

static void test_words_stand_in_the_order_of_their_enums(void)
{
    static const struct {
        himc_command_id id;
        int value;
        const char *word;
    } words[] = {
        {HIMC_COMMAND_GRIP, HIMC_GRIP_GERMAN, "german"},
        {HIMC_COMMAND_GRIP, HIMC_GRIP_FRENCH, "french"},
        {HIMC_COMMAND_MODE, HIMC_PIPELINE_HIMC, "himc"},
        {HIMC_COMMAND_MODE, HIMC_PIPELINE_ID, "id"},
        {HIMC_COMMAND_MODE, HIMC_PIPELINE_IK, "ik"},
        {HIMC_COMMAND_SOLVER, HIMC_SOLVER_DLS, "dls"},
        {HIMC_COMMAND_SOLVER, HIMC_SOLVER_PINV, "pinv"},
        {HIMC_COMMAND_SOLVER, HIMC_SOLVER_TRANSPOSE, "transpose"},
        {HIMC_COMMAND_SOLVER, HIMC_SOLVER_NAKAMURA, "nakamura"},
        {HIMC_COMMAND_SOLVER, HIMC_SOLVER_SDLS, "sdls"},
        {HIMC_COMMAND_SOLVER, HIMC_SOLVERS, ""},
        {HIMC_COMMAND_LAW, HIMC_LAW_PRINTED, "printed"},
        {HIMC_COMMAND_LAW, HIMC_LAW_FEEDFORWARD, "feedforward"},
        {HIMC_COMMAND_LAW, HIMC_LAW_COMPUTED_TORQUE, "computed-torque"},
        {HIMC_COMMAND_LIMITS, HIMC_LIMITS_OFF, "off"},
        {HIMC_COMMAND_LIMITS, HIMC_LIMITS_ELLIPSOID, "ellipsoid"},
        {HIMC_COMMAND_LIMITS, HIMC_LIMITS_EULER, "euler"},
        {HIMC_COMMAND_STRENGTH, 0, "human"},
        {HIMC_COMMAND_COUPLING, 0, "two-way"},
        {HIMC_COMMAND_COUPLING, 1, "one-way"},
        {HIMC_COMMAND_MALLET, DRUM_MALLET_SOFT, "soft"},
        {HIMC_COMMAND_MALLET, DRUM_MALLET_MEDIUM, "medium"},
        {HIMC_COMMAND_MALLET, DRUM_MALLET_HARD, "hard"},
        {HIMC_COMMAND_MALLET, DRUM_MALLET_WOOD, "wood"},
        {HIMC_COMMAND_TECHNIQUE, HIMC_TECHNIQUE_MODAL, "modal"},
        {HIMC_COMMAND_TECHNIQUE, HIMC_TECHNIQUE_SIGNAL, "signal"},
        {HIMC_COMMAND_TECHNIQUE, HIMC_TECHNIQUE_CLIP, "clip"},
    };
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        TEST_ASSERT_EQUAL_STRING(words[i].word,
                                 himc_command_word(words[i].id, 0, words[i].value).text);
    TEST_ASSERT_EQUAL_STRING("head", himc_command_word(HIMC_COMMAND_SUBSCRIBE, 2, 3).text);
    TEST_ASSERT_EQUAL_STRING("", himc_command_word(HIMC_COMMAND_LAW, 1, 0).text);
    TEST_ASSERT_EQUAL_STRING("", himc_command_word(HIMC_COMMANDS, 0, 0).text);
    TEST_ASSERT_EQUAL_STRING("", himc_command_word(HIMC_COMMAND_HIT, 0, 0).text);
}

static void test_hands_nuances_and_spots_stand_in_the_order_of_their_enums(void)
{
    static const char *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent",
                                          "staccato"};
    static const char *const spots[] = {"center", "normal", "rim"};
    char text[80];
    for (int i = 0; i < HIMC_NUANCES; i++) {
        snprintf(text, sizeof text, "hit %s %s p %s", i % 2 ? "right" : "left", nuances[i],
                 spots[i % 3]);
        TEST_ASSERT_TRUE(perform(text));
        TEST_ASSERT_EQUAL_INT(i % 2 ? HIMC_RIGHT : HIMC_LEFT, command.stroke.hand);
        TEST_ASSERT_EQUAL_INT(i, command.stroke.nuance);
        TEST_ASSERT_EQUAL_INT(i % 3, command.stroke.spot);
        TEST_ASSERT_EQUAL_STRING(nuances[i], himc_nuance_name((himc_nuance)i));
        TEST_ASSERT_EQUAL_STRING(spots[i % 3], himc_spot_name((himc_spot)(i % 3)));
    }
    TEST_ASSERT_TRUE(perform("hit left vertical-accent p rim"));
    TEST_ASSERT_EQUAL_INT(HIMC_VERTICAL_ACCENT, command.stroke.nuance);
    TEST_ASSERT_EQUAL_INT(HIMC_SPOT_RIM, command.stroke.spot);
    TEST_ASSERT_EQUAL_STRING("left", himc_hand_name(HIMC_LEFT));
    TEST_ASSERT_EQUAL_STRING("right", himc_hand_name(HIMC_RIGHT));
    TEST_ASSERT_EQUAL_STRING("none", himc_nuance_name(HIMC_NUANCES));
}

static void test_commands_say_which_file_they_read_or_write(void)
{
    static const struct {
        const char *text;
        himc_file_use use;
    } cases[] = {{"score a.txt", HIMC_FILE_READ},        {"take a.bvh", HIMC_FILE_READ},
                 {"units a.c3d legato", HIMC_FILE_READ}, {"units clear", HIMC_FILE_NONE},
                 {"record a.bvh", HIMC_FILE_WRITE},      {"record stop", HIMC_FILE_NONE},
                 {"tempo 90", HIMC_FILE_NONE},           {"play", HIMC_FILE_NONE}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int atom = -1;
        TEST_ASSERT_TRUE(perform(cases[i].text));
        TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].use, himc_command_file(&command, &atom),
                                      cases[i].text);
        if (cases[i].use != HIMC_FILE_NONE)
            TEST_ASSERT_EQUAL_INT(0, atom);
    }
    int atom;
    TEST_ASSERT_TRUE(drum("shape head.mtx"));
    TEST_ASSERT_EQUAL_INT(HIMC_FILE_READ, himc_command_file(&command, &atom));
    TEST_ASSERT_TRUE(drum("shape circle"));
    TEST_ASSERT_EQUAL_INT(HIMC_FILE_NONE, himc_command_file(&command, &atom));
    TEST_ASSERT_TRUE(drum("shape rectangle 0.5 0.4"));
    TEST_ASSERT_EQUAL_INT(HIMC_FILE_NONE, himc_command_file(&command, &atom));
}

static void test_command_made_without_the_parser_is_checked_and_completed(void)
{
    static himc_command raw;
    raw = (himc_command){.id = HIMC_COMMAND_DECAY, .count = 2, .form = 7};
    raw.atom[0] = (himc_atom){HIMC_ATOM_NUMBER, 0.1, NULL};
    raw.atom[1] = (himc_atom){HIMC_ATOM_NUMBER, 0.2, NULL};
    TEST_ASSERT_TRUE(himc_command_check(&command, HIMC_DRUM, &raw, &error));
    TEST_ASSERT_EQUAL_INT(1, command.form);
    TEST_ASSERT_TRUE(command.atom[0].number == 0.1); // not rounded to single precision
    raw.atom[0] = (himc_atom){HIMC_ATOM_SYMBOL, 0, "wood"};
    raw.id = HIMC_COMMAND_MALLET;
    raw.count = 1;
    TEST_ASSERT_TRUE(himc_command_check(&command, HIMC_DRUM, &raw, &error));
    TEST_ASSERT_EQUAL_INT(DRUM_MALLET_WOOD, command.choice[0]);
    TEST_ASSERT_TRUE(command.atom[0].symbol == command.storage);
    raw.count = HIMC_COMMAND_ATOMS + 1;
    TEST_ASSERT_FALSE(himc_command_check(&command, HIMC_DRUM, &raw, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "with 9 atoms: not from the parser"));
    raw.id = HIMC_COMMANDS;
    TEST_ASSERT_FALSE(himc_command_check(&command, HIMC_DRUM, &raw, &error));
    raw.id = HIMC_COMMAND_PLAY;
    raw.count = 0;
    refused(himc_command_check(&command, HIMC_DRUM, &raw, &error),
            "play: a command for the performer, not for a drum");
}

static void test_stroke_is_read_with_word_and_number_forms(void)
{
    TEST_ASSERT_TRUE(perform("stroke 2 right accent f rim kettle"));
    TEST_ASSERT_EQUAL_INT(HIMC_COMMAND_STROKE, command.id);
    TEST_ASSERT_EQUAL_DOUBLE(2, command.stroke.beat);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, command.stroke.hand);
    TEST_ASSERT_EQUAL_INT(HIMC_ACCENT, command.stroke.nuance);
    TEST_ASSERT_EQUAL_DOUBLE(5 / 7.0, command.stroke.dynamic);
    TEST_ASSERT_EQUAL_INT(HIMC_SPOT_RIM, command.stroke.spot);
    TEST_ASSERT_EQUAL_STRING("kettle", command.stroke.drum);
    TEST_ASSERT_TRUE(perform("stroke .5 left vertical-accent 0.25 -0.125 0.0625"));
    TEST_ASSERT_EQUAL_INT(HIMC_VERTICAL_ACCENT, command.stroke.nuance);
    TEST_ASSERT_EQUAL_DOUBLE(0.25, command.stroke.dynamic);
    TEST_ASSERT_EQUAL_INT(HIMC_SPOT_XY, command.stroke.spot);
    TEST_ASSERT_EQUAL_DOUBLE(-0.125, command.stroke.x);
    TEST_ASSERT_EQUAL_DOUBLE(0.0625, command.stroke.y);
    TEST_ASSERT_EQUAL_STRING("", command.stroke.drum);
    TEST_ASSERT_TRUE(perform("stroke 0 left legato ppp low"));
    TEST_ASSERT_EQUAL_INT(HIMC_SPOT_NORMAL, command.stroke.spot);
    TEST_ASSERT_EQUAL_STRING("low", command.stroke.drum);
    TEST_ASSERT_EQUAL_DOUBLE(0, command.stroke.dynamic);
}

static const char *const performer_forms[] = {"hit left staccato fff",
                                              "tempo 90",
                                              "tempo 90 16",
                                              "grip french",
                                              "grip german",
                                              "human 0.3",
                                              "human 1 999999",
                                              "alive 0",
                                              "alive 1",
                                              "loop 0",
                                              "loop 1",
                                              "record a.bvh",
                                              "record stop",
                                              "clear",
                                              "play",
                                              "stop",
                                              "seek 4",
                                              "score a.txt",
                                              "take b.bvh",
                                              "units clear",
                                              "units a.c3d legato",
                                              "units a.c3d accent rim",
                                              "target left 0.5 0.1 1",
                                              "mode id",
                                              "solver transpose",
                                              "damping 0.01",
                                              "law computed-torque",
                                              "gain wrist 40 1",
                                              "gain reset",
                                              "rate physics 10000",
                                              "rate task 250",
                                              "coupling one-way",
                                              "engine ode",
                                              "limits ellipsoid",
                                              "limits euler",
                                              "limits off",
                                              "strength human",
                                              "strength off",
                                              "strength left-elbow 40",
                                              "player 1.75 75",
                                              "info",
                                              "reset",
                                              "drum low",
                                              "drum low 29"};
static const char *const drum_forms[] = {"info",
                                         "radius 0.29",
                                         "tension 4000",
                                         "density 0.26",
                                         "tune 110",
                                         "tune A2",
                                         "tune f#3",
                                         "modes 200",
                                         "decay 1.5",
                                         "decay 0.5 0.01",
                                         "mallet soft",
                                         "mallet 1.6e8 2.54 0.028",
                                         "place 0.7 0 0.85",
                                         "place 0.7 0 0.85 0.1",
                                         "pickup 0.1 0",
                                         "pickup air 0 0.5 2",
                                         "gain -6",
                                         "strike 0.1 0 3"};

static void test_every_form_of_every_command_is_accepted(void)
{
    for (size_t i = 0; i < sizeof performer_forms / sizeof *performer_forms; i++)
        TEST_ASSERT_TRUE_MESSAGE(perform(performer_forms[i]), performer_forms[i]);
    for (size_t i = 0; i < sizeof drum_forms / sizeof *drum_forms; i++)
        TEST_ASSERT_TRUE_MESSAGE(drum(drum_forms[i]), drum_forms[i]);
}

static void test_errors_name_field_value_and_allowed_values(void)
{
    refused(perform("stroke 1 left legato 1.7"),
            "stroke: DYNAMIC: 1.7, expected ppp pp p mp mf f ff fff - or 0 .. 1");
    refused(perform("stroke 1 left legatto f"),
            "stroke: NUANCE: legatto, expected legato tenuto accent vertical-accent staccato");
    refused(perform("stroke 1 left"),
            "stroke: NUANCE missing, expected stroke BEAT HAND NUANCE DYNAMIC [SPOT] [dead] "
            "[PART] [DRUM]");
    refused(
        perform("stroke 1 left legato f 0.1"),
        "stroke: SPOT: 0.1, expected center normal rim crossstick rimshot click shell or X Y, both -1 .. 1 m");
    refused(perform("drum dead"),
            "drum: NAME: dead, expected a drum's name: up to 31 letters and digits, no number, no "
            "spot, not `dead` of strokes, no command of the performer");
    refused(perform("stroke x left legato f"), "stroke: BEAT: x, expected 0 .. 1e+06");
    refused(perform("mode idd"), "mode: idd, expected himc id ik");
    refused(perform("tempo 90 1 2 3 4"),
            "tempo: 4 is one atom too many, expected tempo BPM [BEAT] | BPM BPM LENGTH [BEAT]");
    refused(perform("play 1"), "play: 1 is one atom too many, expected play");
    refused(perform("rate task 5"), "rate: HZ: 5, expected 50 .. 2000 Hz");
    refused(drum("radius 0"), "radius: RADIUS: 0, expected 0.05 .. 1 m");
    refused(drum("modes 2.5"), "modes: 2.5, expected 1 .. 2000, whole or auto");
    refused(drum("tune 0"), "tune: 0, expected 1 .. 20000 Hz or a note such as A2 or f#3");
    refused(drum("tune H2"), "tune: H2, expected 1 .. 20000 Hz or a note such as A2 or f#3");
    refused(drum("mallet 5"), "mallet: 5, expected soft medium hard wood usual");
    refused(
        drum("mallet 1e6 2.5"),
        "mallet: MASS missing, expected mallet soft|medium|hard|wood|usual | K ALPHA MASS | HAND "
        "soft|medium|hard|wood|usual | HAND K ALPHA MASS");
    refused(drum("pickup air 0 0"),
            "pickup: DISTANCE missing, expected pickup air AZIMUTH ELEVATION DISTANCE | X Y");
    refused(drum("kettle"), "kettle: atoms missing, expected kettle usual | VOLUME");
}

static void test_a_word_that_fits_no_form_is_answered_with_all_forms(void)
{
    refused(perform("listener here"),
            "listener: here, expected listener off | usual | X Y Z [YAW]");
    refused(perform("gain loud"),
            "gain: loud without KS, expected gain reset | frequency FACTOR | JOINT KS KD | DB");
    refused(perform("gain 100"), "gain: 100, expected reset or -60 .. 24 dB");
    refused(perform("grip american"), "grip: american, expected german french or servo");
}

static void test_a_change_at_a_beat_without_its_drum_is_answered_with_that(void)
{
    refused(perform("gain left-wrist"), "gain: left-wrist without KS, expected gain reset | "
                                        "frequency FACTOR | JOINT KS KD | DB");
    refused(perform("gain frequency 2 3"), "gain: 3 is one atom too many, expected gain reset | "
                                           "frequency FACTOR | JOINT KS KD | DB");
    refused(perform("strength left-wrist"),
            "strength: left-wrist without TORQUE, expected strength human|off | JOINT TORQUE");
    refused(perform("strength human 1"),
            "strength: 1 is one atom too many, expected strength human|off | JOINT TORQUE");
    refused(perform("at 3 stance fixed"), "at: stance does not act at a beat, expected at BEAT "
                                          "DRUM COMMAND [...] | BEAT push SEGMENT [...]");
    refused(perform("at 4 tune C3"),
            "at: DRUM missing before tune, expected at BEAT DRUM tune HZ | NOTE");
    refused(perform("at 4 damp"),
            "at: DRUM missing before damp, expected at BEAT DRUM damp AMOUNT");
    refused(perform("at 4 damp 1"),
            "at: DRUM missing before damp, expected at BEAT DRUM damp AMOUNT");
    // a drum may have the name of a drum's command
    TEST_ASSERT_TRUE_MESSAGE(perform("at 4 damp tune C3"), error.text);
    TEST_ASSERT_TRUE_MESSAGE(perform("at 4 kettle tune C3"), error.text);
    TEST_ASSERT_TRUE_MESSAGE(perform("at 4 push head 1 1 1 1"), error.text);
}

static void test_a_refused_line_for_a_drum_asks_if_drum_was_meant(void)
{
    refused(perform("drums kettle"),
            "drums: kettle: atoms missing, expected kettle usual | VOLUME; or did you mean drum?");
    refused(perform("low damp 2"), "low: damp: AMOUNT: 2, expected 0 .. 1");
}

static void test_centre_and_center_are_one_spot(void)
{
    static const char *const form[] = {"hit left accent f %s", "stroke 1 left accent f %s",
                                       "roll 1 2 press f %s low", "units a.bvh accent %s"};
    for (size_t i = 0; i < sizeof form / sizeof *form; i++) {
        char text[2][80];
        himc_command c[2];
        for (int k = 0; k < 2; k++) {
            snprintf(text[k], sizeof text[k], form[i], k ? "centre" : "center");
            TEST_ASSERT_TRUE(himc_command_parse_text(&c[k], HIMC_PERFORMER, text[k], &error));
        }
        TEST_ASSERT_EQUAL_INT(HIMC_SPOT_CENTER, i < 3 ? (int)c[0].stroke.spot : c[0].choice[2]);
        TEST_ASSERT_EQUAL_INT_ARRAY(c[0].choice, c[1].choice, c[0].count);
        TEST_ASSERT_EQUAL_INT(c[0].stroke.spot, c[1].stroke.spot);
        TEST_ASSERT_EQUAL_STRING(c[0].stroke.drum, c[1].stroke.drum);
    }
    TEST_ASSERT_FALSE(perform("drum centre"));
}

static void test_unknown_commands_are_answered_with_the_nearest_name(void)
{
    refused(perform("strok 1"), "strok: unknown command, did you mean stroke?");
    refused(perform("PLAY"), "PLAY: unknown command, did you mean play?");
    refused(perform("paly"), "paly: unknown command, did you mean play?");
    refused(perform("x"), "x: unknown command, `himc help commands` lists them");
    refused(perform("xylophone"), "xylophone: unknown command, `himc help commands` lists them");
    refused(
        perform("tune 110"),
        "tune: a command for a drum, not for the performer: its name comes before it (`kettle tune`)");
    refused(drum("play"), "play: a command for the performer, not for a drum");
    TEST_ASSERT_FALSE(perform("a\001b"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "a?b"));
    TEST_ASSERT_FALSE(perform("preset /tmp/x"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "expected a name, without a folder"));
}

static void test_numbers_that_are_not_finite_are_refused(void)
{
    himc_atom atom = {HIMC_ATOM_NUMBER, NAN, NULL};
    TEST_ASSERT_FALSE(himc_command_parse(&command, HIMC_PERFORMER, "tempo", &atom, 1, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "nan is not a finite number, expected 1 .. 1000"));
    atom.number = HUGE_VAL;
    TEST_ASSERT_FALSE(himc_command_parse(&command, HIMC_PERFORMER, "tempo", &atom, 1, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "inf is not a finite number"));
    TEST_ASSERT_FALSE(perform("tempo nan"));
    TEST_ASSERT_FALSE(perform("tempo 0x50"));
}

// Pd's numbers are of single precision: its 2.2 and 1.5708 are a little more than those
static void test_ends_of_a_range_arrive_exactly_from_single_precision(void)
{
    himc_atom atom[4] = {{HIMC_ATOM_SYMBOL, 0, "air"},
                         {HIMC_ATOM_NUMBER, 0, NULL},
                         {HIMC_ATOM_NUMBER, 1.5708f, NULL},
                         {HIMC_ATOM_NUMBER, 2, NULL}};
    TEST_ASSERT_TRUE(himc_command_parse(&command, HIMC_DRUM, "pickup", atom, 4, &error));
    TEST_ASSERT_TRUE(command.atom[2].number == 1.5708);
    atom[2].number = nextafterf(1.5708f, 2);
    TEST_ASSERT_FALSE(himc_command_parse(&command, HIMC_DRUM, "pickup", atom, 4, &error));
    TEST_ASSERT_TRUE(drum("pickup air 0 0.7 2"));
    TEST_ASSERT_TRUE(command.atom[2].number == 0.7f);
}

static void test_refused_command_leaves_the_result_untouched(void)
{
    himc_command before;
    TEST_ASSERT_TRUE(perform("tempo 90"));
    memcpy(&before, &command, sizeof before);
    TEST_ASSERT_FALSE(perform("tempo 90000"));
    TEST_ASSERT_FALSE(perform("score a b"));
    TEST_ASSERT_EQUAL_MEMORY(&before, &command, sizeof before);
}

static void test_note_names_arrive_as_frequencies(void)
{
    TEST_ASSERT_TRUE(drum("tune A2"));
    TEST_ASSERT_EQUAL_INT(HIMC_ATOM_NUMBER, command.atom[0].kind);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 110, command.atom[0].number);
    TEST_ASSERT_TRUE(drum("tune f#3"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 184.997211, command.atom[0].number);
    TEST_ASSERT_TRUE(drum("tune Bb1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 58.270470, command.atom[0].number);
    TEST_ASSERT_FALSE(drum("tune H2"));
}

static void test_text_and_atoms_give_the_same_bits(void)
{
    himc_command other;
    himc_atom atoms[] = {{HIMC_ATOM_NUMBER, (double)0.1f, NULL}};
    TEST_ASSERT_TRUE(himc_command_parse(&other, HIMC_PERFORMER, "damping", atoms, 1, &error));
    TEST_ASSERT_TRUE(perform("damping 0.1"));
    TEST_ASSERT_EQUAL_MEMORY(&other.atom[0].number, &command.atom[0].number, sizeof(double));
}

static void test_backslash_keeps_a_space_in_a_file_name(void)
{
    TEST_ASSERT_TRUE(perform("score my\\ score.txt;"));
    TEST_ASSERT_EQUAL_STRING("my score.txt", command.atom[0].symbol);
}

static void test_a_copied_command_points_to_its_own_text(void)
{
    himc_command copy;
    TEST_ASSERT_TRUE(perform("gain wrist 40 1"));
    himc_command_copy(&copy, &command);
    memset(&command, 0, sizeof command);
    TEST_ASSERT_EQUAL_STRING("wrist", copy.atom[0].symbol);
    TEST_ASSERT_TRUE(copy.atom[0].symbol == copy.storage);
}

static void test_invalid_names_of_drums_are_refused(void)
{
    TEST_ASSERT_FALSE(perform("drum rim"));
    TEST_ASSERT_FALSE(perform("drum stroke"));
    TEST_ASSERT_FALSE(perform("drum a/b"));
    TEST_ASSERT_FALSE(perform("drum 12345678901234567890123456789012x"));
    TEST_ASSERT_TRUE(perform("drum kettle-23"));
}

static void test_random_atoms_never_break_the_parser(void)
{
    static const char *const word[] = {"left",
                                       "right",
                                       "legato",
                                       "f",
                                       "rim",
                                       "reset",
                                       "air",
                                       "",
                                       "x",
                                       "physics",
                                       "A2",
                                       "soft",
                                       "\n",
                                       ("a very long word indeed, longer "
                                        "than anything the table would ever ask for, to be cut")};
    unsigned seed = 1;
    int good = 0;
    for (int k = 0; k < 100000; k++) {
        himc_atom atom[10];
        int count = (int)((seed = seed * 1664525u + 1013904223u) >> 16) % 10;
        for (int i = 0; i < count; i++) {
            unsigned r = (seed = seed * 1664525u + 1013904223u) >> 12;
            atom[i] = (himc_atom){r & 1 ? HIMC_ATOM_SYMBOL : HIMC_ATOM_NUMBER,
                                  r % 7 == 0 ? NAN : r % 1000 / 100.0, word[(r >> 3) % 14]};
        }
        const himc_command_row *row = himc_command_table((int)((seed >> 10) % HIMC_COMMANDS));
        error.text[0] = '\0';
        bool parsed = himc_command_parse(&command, row->receiver, row->name, atom, count, &error);
        good += parsed;
        TEST_ASSERT_TRUE(parsed || (error.text[0] && !strchr(error.text, '\n')));
        for (int i = 0; parsed && i < command.count; i++)
            TEST_ASSERT_TRUE(command.atom[i].kind == HIMC_ATOM_SYMBOL ||
                             isfinite(command.atom[i].number));
    }
    TEST_ASSERT_TRUE(good > 100);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_table_is_complete_and_in_order_of_the_ids);
    RUN_TEST(test_every_word_of_every_row_parses_to_its_index);
    RUN_TEST(test_atoms_of_the_wrong_kind_are_refused_in_every_row);
    RUN_TEST(test_numbers_out_of_range_or_not_finite_are_refused_in_every_row);
    RUN_TEST(test_missing_and_excess_atoms_are_refused_in_every_row);
    RUN_TEST(test_words_stand_in_the_order_of_their_enums);
    RUN_TEST(test_hands_nuances_and_spots_stand_in_the_order_of_their_enums);
    RUN_TEST(test_commands_say_which_file_they_read_or_write);
    RUN_TEST(test_command_made_without_the_parser_is_checked_and_completed);
    RUN_TEST(test_stroke_is_read_with_word_and_number_forms);
    RUN_TEST(test_every_form_of_every_command_is_accepted);
    RUN_TEST(test_errors_name_field_value_and_allowed_values);
    RUN_TEST(test_a_word_that_fits_no_form_is_answered_with_all_forms);
    RUN_TEST(test_a_change_at_a_beat_without_its_drum_is_answered_with_that);
    RUN_TEST(test_a_refused_line_for_a_drum_asks_if_drum_was_meant);
    RUN_TEST(test_centre_and_center_are_one_spot);
    RUN_TEST(test_unknown_commands_are_answered_with_the_nearest_name);
    RUN_TEST(test_numbers_that_are_not_finite_are_refused);
    RUN_TEST(test_ends_of_a_range_arrive_exactly_from_single_precision);
    RUN_TEST(test_refused_command_leaves_the_result_untouched);
    RUN_TEST(test_note_names_arrive_as_frequencies);
    RUN_TEST(test_text_and_atoms_give_the_same_bits);
    RUN_TEST(test_backslash_keeps_a_space_in_a_file_name);
    RUN_TEST(test_a_copied_command_points_to_its_own_text);
    RUN_TEST(test_invalid_names_of_drums_are_refused);
    RUN_TEST(test_random_atoms_never_break_the_parser);
    return UNITY_END();
}
