/// command.c: the parser of commands.
///
/// It follows the grammar in the rows of command_rows.h form by form. If no form fits, the error
/// line is about the form that came closest. Numbers are held in single precision, as Pure Data and
/// OSC send them, so that a command is the same to the last bit wherever it comes from. Invariant:
/// a refused command changes nothing.
#include "base/format.h"
#include "himc/command.h"

#include "base/argument.h"
#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define DEAD_TIME 0.2  // of a mallet on the head (s); chosen: the tone is over by then
#define LEAST_LOOP 0.1 // chosen: a stroke of one hand at 150 beats a minute (beats)
#define WORD_SIZE 64
#define EXPECTED_SIZE 256
#define OWN_WORD 1000 // rank of a form with a word of its own; more than that of all atoms

/// A command's atoms as the grammar understands them.
typedef struct reading {
    int form;
    double number[HIMC_COMMAND_ATOMS];
    int choice[HIMC_COMMAND_ATOMS];
} reading;

/// How far a form of the grammar fitted, and the reason for its end.
typedef struct attempt {
    int rank; ///< larger is closer
    enum { FITS, WRONG, MISSING, TOO_MANY } end;
    int at;    ///< atom that stopped it
    int forms; ///< that came as close
    char name[WORD_SIZE];
    char expected[EXPECTED_SIZE];
} attempt;

/// The state of following one form.
typedef struct walk {
    const char *context; ///< command or last literal word
    const himc_atom *atom;
    int count, at;
    bool literal; ///< a literal word fitted
    reading *out; ///< of the atoms that fitted
} walk;

/// Copies the first token of `grammar` without brackets; returns the rest.
static const char *next_token(const char *grammar, char token[WORD_SIZE], bool *optional)
{
    size_t n = strcspn(grammar, " ");
    *optional = grammar[0] == '[';
    himc_format(token, WORD_SIZE, "%.*s", (int)(n - 2 * (size_t)*optional), grammar + *optional);
    grammar += n;
    return grammar + strspn(grammar, " ");
}

/// Word `index` of "a|b|c", or "".
static himc_word cut_word(const char *token, int index)
{
    himc_word word = {""};
    for (; index > 0 && *token; index--) {
        token += strcspn(token, "|");
        token += *token == '|';
    }
    if (index == 0)
        himc_format(word.text, sizeof word.text, "%.*s", (int)strcspn(token, "|"), token);
    return word;
}

static bool is_argument(const char *token)
{
    return isupper((unsigned char)token[0]);
}

/// Takes the next atom as this argument, or as a literal word if `argument` is NULL.
static void take_atom(walk *w, const himc_argument *argument, int choice)
{
    const himc_atom *atom = &w->atom[w->at];
    if (w->at < HIMC_COMMAND_ATOMS) {
        w->out->choice[w->at] = choice;
        if (argument && atom->kind == HIMC_ATOM_NUMBER)
            w->out->number[w->at] = himc_argument_number(argument, atom->number);
    }
    w->at++;
}

/// Tells what is expected at a token.
static void describe(const char *token, const char *context, char expected[EXPECTED_SIZE])
{
    if (strcmp(token, "...") == 0) {
        snprintf(expected, EXPECTED_SIZE, "words and finite numbers");
    } else if (is_argument(token)) {
        himc_argument_describe(himc_argument_find(token, context), expected, EXPECTED_SIZE);
        if (strcmp(token, "SPOT") == 0)
            strncat(expected, " or X Y, both -1 .. 1 m", EXPECTED_SIZE - strlen(expected) - 1);
    } else {
        snprintf(expected, EXPECTED_SIZE, "%s", token);
        for (char *s = expected; *s; s++)
            *s = *s == '|' ? ' ' : *s;
    }
}

/// Takes the next atom if it is one of the words of a token "a|b|c".
static bool take_word(walk *w, const char *token)
{
    const himc_atom *atom = &w->atom[w->at];
    himc_word word;
    if (atom->kind != HIMC_ATOM_SYMBOL)
        return false;
    for (int choice = 0; (word = cut_word(token, choice)).text[0]; choice++)
        if (strcmp(word.text, atom->symbol) == 0) {
            w->context = atom->symbol;
            w->literal = true;
            take_atom(w, NULL, choice);
            return true;
        }
    return false;
}

/// Takes the atoms that fit the token; false if the next one does not.
static bool take(walk *w, const char *token)
{
    if (strcmp(token, "...") == 0) { // all that is left
        const himc_argument *word = himc_argument_find("COMMAND", NULL);
        for (; w->at < w->count && w->at < HIMC_COMMAND_ATOMS; w->at++) {
            const himc_atom *atom = &w->atom[w->at];
            bool number = atom->kind == HIMC_ATOM_NUMBER;
            if (number ? !isfinite((float)atom->number) : !himc_argument_accepts(word, atom))
                return false;
            w->out->number[w->at] = number ? (float)atom->number : 0;
        }
        return true;
    }
    if (!is_argument(token))
        return take_word(w, token);
    const himc_argument *argument = himc_argument_find(token, w->context);
    const himc_atom *atom = &w->atom[w->at];
    if (strcmp(token, "PART") == 0 && w->at + 1 == w->count)
        return false; // a last word is a drum's
    if (strcmp(token, "SPOT") == 0) {
        const himc_argument *x = himc_argument_find("X", "stroke");
        if (w->at + 1 < w->count && atom[0].kind == HIMC_ATOM_NUMBER &&
            atom[1].kind == HIMC_ATOM_NUMBER && himc_argument_accepts(x, &atom[0]) &&
            himc_argument_accepts(x, &atom[1])) {
            take_atom(w, x, -1);
            take_atom(w, x, -1);
            return true;
        }
    }
    if (!himc_argument_accepts(argument, atom))
        return false;
    take_atom(w, argument, himc_argument_choice(argument, atom));
    return true;
}

/// Follows one form from `grammar` to its end; returns where the next begins, or NULL.
static const char *follow(const char *grammar, walk w, attempt *result)
{
    char token[WORD_SIZE];
    int least = 0, most = 0;
    bool optional;
    *result = (attempt){.end = FITS, .forms = 1};
    while (*grammar && *grammar != '|') {
        grammar = next_token(grammar, token, &optional);
        least += !optional;
        most += 1 + (strcmp(token, "SPOT") == 0);
        if (result->end != FITS || (optional && w.at == w.count))
            continue;
        bool taken = w.at < w.count && take(&w, token);
        // an optional word may be left out when something else may follow
        bool skip = optional && *grammar && w.at < w.count && w.atom[w.at].kind == HIMC_ATOM_SYMBOL;
        if (taken || skip)
            continue;
        result->end = w.at == w.count ? MISSING : WRONG;
        memcpy(result->name, token, sizeof token);
        if (w.at < w.count)
            describe(token, w.context, result->expected);
    }
    if (result->end == FITS && w.at < w.count)
        result->end = TOO_MANY;
    result->at = w.at;
    // the right number of atoms counts for more than one that fits, and for less than two
    result->rank = OWN_WORD * w.literal + 3 * (w.count >= least && w.count <= most) + 2 * w.at;
    return *grammar ? grammar + 2 : NULL;
}

/// `without`: the next token of a form that all atoms fit, or "".
static bool refuse(const himc_command_row *row, const himc_atom *atoms, const attempt *best,
                   const char *without, himc_error *error)
{
    char value[WORD_SIZE];
    bool named = is_argument(best->name);
    const char *space = row->atoms[0] ? " " : "";
    if (best->end == MISSING)
        return himc_error_set(error, "%s: %s missing, expected %s %s", row->name,
                              best->at > 0 || named ? best->name : "atoms", row->name, row->atoms);
    const himc_atom *atom = &atoms[best->at];
    if (atom->kind == HIMC_ATOM_SYMBOL)
        himc_text_shorten(value, sizeof value, atom->symbol);
    else
        snprintf(value, sizeof value, isfinite(atom->number) ? "%g" : "%g is not a finite number",
                 atom->number);
    if (best->end == TOO_MANY)
        return himc_error_set(error, "%s: %s is one atom too many, expected %s%s%s", row->name,
                              value, row->name, space, row->atoms);
    // the first atom may be a word that fits none of several forms, of which `best` is only some
    int forms = 1;
    for (const char *s = row->atoms; (s = strstr(s, " | ")); s += 3)
        forms++;
    if (best->at == 0 && best->forms < forms && !named && atom->kind == HIMC_ATOM_SYMBOL)
        return himc_error_set(error, "%s: %s%s%s, expected %s %s", row->name, value,
                              without[0] ? " without " : "", without, row->name, row->atoms);
    return himc_error_set(error, "%s: %s%s%s, expected %s", row->name, named ? best->name : "",
                          named ? ": " : "", value, best->expected);
}

/// Finds the first form that fits; if none does, the error is about the closest.
static bool check(const himc_command_row *row, const himc_atom *atoms, int count, reading *out,
                  himc_error *error)
{
    attempt best = {.rank = -1}, now;
    walk start = {row->name, atoms, count, 0, false, out};
    const char *grammar = row->atoms;
    char without[WORD_SIZE] = "";
    for (out->form = 0; grammar; out->form++) {
        for (int i = 0; i < HIMC_COMMAND_ATOMS; i++)
            out->choice[i] = -1;
        grammar = follow(grammar, start, &now);
        // a form's own word, as `off`, is no name in another form
        if (now.end == FITS && (best.rank < OWN_WORD || now.rank >= OWN_WORD))
            return true;
        if (now.end == MISSING && !without[0])
            memcpy(without, now.name, sizeof without);
        if (now.rank > best.rank || (now.rank == best.rank && best.end == TOO_MANY)) {
            best = now;
        } else if (now.rank == best.rank && now.end == WRONG && best.end == WRONG) {
            // two equally close wrong atoms: the expected values of both
            best.forms++;
            if (strcmp(now.expected, best.expected) == 0)
                continue;
            size_t used = strlen(best.expected);
            int room = (int)(sizeof best.expected - used);
            snprintf(best.expected + used, (size_t)room, " or %.*s", room - 5 > 0 ? room - 5 : 0,
                     now.expected);
            best.name[0] = '\0';
        }
    }
    return refuse(row, atoms, &best, without, error);
}

static bool refuse_name(himc_receiver receiver, const char *name, himc_error *error)
{
    const himc_command_row *row;
    char word[WORD_SIZE];
    himc_nearest nearest = {.word = word};
    himc_text_shorten(word, sizeof word, name);
    for (int i = 0; (row = himc_command_table(i)); i++)
        if (row->receiver == receiver)
            himc_nearest_try(&nearest, row->name);
        else if (strcmp(row->name, name) == 0)
            return receiver == HIMC_DRUM
                       ? himc_error_set(error, "%s: a command for the performer, not for a drum",
                                        word)
                       : himc_error_set(error,
                                        "%s: a command for a drum, not for the performer: its name "
                                        "comes before it (`kettle %s`)",
                                        word, word);
    if (nearest.name)
        return himc_error_set(error, "%s: unknown command, did you mean %s?", word, nearest.name);
    return himc_error_set(error, "%s: unknown command, `himc help commands` lists them", word);
}

/// Copies atoms and their symbols; they have been checked, so they fit.
static void store(himc_command *out, const himc_atom *atoms, int count, const reading *read)
{
    size_t used = 0;
    out->count = count;
    out->form = read->form;
    out->drum[0] = '\0';
    out->folder = NULL;
    for (int i = 0; i < count; i++) {
        double hz;
        out->choice[i] = read->choice[i];
        out->atom[i] = (himc_atom){HIMC_ATOM_NUMBER, read->number[i], NULL};
        if (atoms[i].kind != HIMC_ATOM_SYMBOL)
            continue;
        bool pitch = out->id == HIMC_COMMAND_TUNE || out->id == HIMC_COMMAND_GLISS ||
                     out->id == HIMC_COMMAND_DRUM_GLISS ||
                     (out->id == HIMC_COMMAND_INSTRUMENT && i > 1);
        if (pitch && himc_note_frequency(atoms[i].symbol, &hz)) {
            out->atom[i].number = hz;
            continue;
        }
        size_t size = strlen(atoms[i].symbol) + 1;
        memcpy(out->storage + used, atoms[i].symbol, size);
        out->atom[i] = (himc_atom){HIMC_ATOM_SYMBOL, 0, out->storage + used};
        used += size;
    }
}

static double read_dynamic(const himc_command *c, int i)
{
    if (c->choice[i] > 7) // "-"
        return HIMC_DYNAMIC_FOLLOWS;
    return c->choice[i] >= 0 ? c->choice[i] / 7.0 : c->atom[i].number; // word 7 is fff
}

/// What the commands that hold a stroke make of it; -1 for the others.
static int ornament_of(himc_command_id id)
{
    switch (id) {
    case HIMC_COMMAND_STROKE:
    case HIMC_COMMAND_HIT: return HIMC_PLAIN;
    case HIMC_COMMAND_FLAM: return HIMC_FLAM;
    case HIMC_COMMAND_DRAG: return HIMC_DRAG;
    case HIMC_COMMAND_RUFF: return HIMC_RUFF;
    case HIMC_COMMAND_ROLL: return HIMC_ROLL_SINGLE;
    default: return -1;
    }
}

static bool is_dead(const himc_command *c, int i)
{
    return i < c->count && c->atom[i].kind == HIMC_ATOM_SYMBOL &&
           strcmp(c->atom[i].symbol, "dead") == 0;
}

/// The stroke in the checked atoms of a command that holds one.
static himc_stroke read_stroke(const himc_command *c)
{
    himc_stroke stroke = {.spot = HIMC_SPOT_NORMAL};
    int i = 0;
    stroke.ornament = (himc_ornament)ornament_of(c->id);
    if (c->id != HIMC_COMMAND_HIT)
        stroke.beat = c->atom[i++].number;
    if (c->id == HIMC_COMMAND_ROLL) {
        enum { TWO_DYNAMICS }; // the first form
        stroke.hand = HIMC_RIGHT;
        stroke.nuance = HIMC_LEGATO;
        stroke.length = c->atom[i++].number;
        stroke.ornament = (himc_ornament)(HIMC_ROLL_SINGLE + c->choice[i++]);
        stroke.dynamic = read_dynamic(c, i++);
        stroke.last_dynamic = c->form == TWO_DYNAMICS ? read_dynamic(c, i++) : stroke.dynamic;
    } else {
        stroke.hand = himc_argument_hand(&c->atom[i++]);
        stroke.nuance = (himc_nuance)c->choice[i++];
        stroke.dynamic = read_dynamic(c, i++);
    }
    if (i < c->count && c->atom[i].kind == HIMC_ATOM_NUMBER) {
        stroke.spot = HIMC_SPOT_XY;
        stroke.x = c->atom[i++].number;
        stroke.y = c->atom[i++].number;
    } else if (i < c->count && c->choice[i] >= 0 && !is_dead(c, i)) {
        stroke.spot = (himc_spot)c->choice[i++];
    }
    if (is_dead(c, i)) {
        stroke.bounces = HIMC_DEAD;
        stroke.bounce_time = DEAD_TIME;
        i++;
    }
    if (i + 1 < c->count)
        snprintf(stroke.part, sizeof stroke.part, "%s", c->atom[i++].symbol);
    if (i < c->count)
        snprintf(stroke.drum, sizeof stroke.drum, "%s", c->atom[i].symbol);
    return stroke;
}

bool himc_command_doubt_drum(const char *name, himc_error *error)
{
    himc_nearest nearest = {.word = name};
    himc_nearest_try(&nearest, himc_command_table(HIMC_COMMAND_MAKE_DRUM)->name);
    himc_error_prefix(error, "%s", name);
    size_t used = error ? strlen(error->text) : 0;
    if (error && nearest.name)
        himc_format(error->text + used, sizeof error->text - used, "; or did you mean %s?",
                    nearest.name);
    return false;
}

/// The receiver's command that an atom names, or NULL.
static const himc_command_row *command_named(himc_receiver receiver, const himc_atom *atoms,
                                             int count, int index)
{
    bool word = index < count && atoms[index].kind == HIMC_ATOM_SYMBOL;
    return word ? himc_command_find(receiver, atoms[index].symbol) : NULL;
}

bool himc_command_parse(himc_command *out, himc_receiver receiver, const char *name,
                        const himc_atom *atoms, int count, himc_error *error)
{
    const himc_command_row *row = himc_command_find(receiver, name);
    const himc_atom drum = {HIMC_ATOM_SYMBOL, 0, name};
    // DRUM COMMAND ...: no drum has the name of a performer's command
    if (!row && receiver == HIMC_PERFORMER && command_named(HIMC_DRUM, atoms, count, 0) &&
        himc_argument_accepts(himc_argument_find("NAME", "drum"), &drum)) {
        if (!himc_command_parse(out, HIMC_DRUM, atoms[0].symbol, atoms + 1, count - 1, error))
            return himc_command_doubt_drum(name, error);
        snprintf(out->drum, sizeof out->drum, "%s", name);
        return true;
    }
    if (!row)
        return refuse_name(receiver, name, error);
    // BEAT COMMAND ...: what acts at a beat, without the drum before it
    bool beat = row->id == HIMC_COMMAND_AT && count > 0 && atoms[0].kind == HIMC_ATOM_NUMBER;
    const himc_command_row *act = beat ? command_named(HIMC_DRUM, atoms, count, 1) : NULL;
    if (act && (act->marks & HIMC_AT_BEAT) && !command_named(HIMC_DRUM, atoms, count, 2))
        return himc_error_set(error, "at: DRUM missing before %s, expected at BEAT DRUM %s %s",
                              act->name, act->name, act->atoms);
    const himc_command_row *own = beat ? command_named(HIMC_PERFORMER, atoms, count, 1) : NULL;
    if (own && !(own->marks & HIMC_AT_BEAT))
        return himc_error_set(error, "at: %s does not act at a beat, expected at %s", own->name,
                              row->atoms);
    reading read = {.form = 0};
    if (!check(row, atoms, count, &read, error))
        return false;
    if (row->id == HIMC_COMMAND_PRESET) {
        // `preset NAME` is `score NAME.txt`, for whoever looks for the file and allows it
        char file[HIMC_NAME_SIZE + 8];
        snprintf(file, sizeof file, "%s.txt", atoms[0].symbol);
        return himc_command_parse(out, HIMC_PERFORMER, "score",
                                  &(himc_atom){HIMC_ATOM_SYMBOL, 0, file}, 1, error);
    }
    if (row->id == HIMC_COMMAND_LOOP && count == 2 &&
        !himc_check_range("loop: TO", atoms[1].number, atoms[0].number + LEAST_LOOP, 1e6, "beats",
                          error))
        return false;
    out->id = row->id;
    store(out, atoms, count, &read);
    if (ornament_of(row->id) >= 0)
        out->stroke = read_stroke(out);
    return true;
}

bool himc_command_check(himc_command *out, himc_receiver receiver, const himc_command *in,
                        himc_error *error)
{
    const himc_command_row *row = himc_command_table((int)in->id);
    if (!row || in->count < 0 || in->count > HIMC_COMMAND_ATOMS)
        return himc_error_set(error, "command %d with %d atoms: not from the parser", (int)in->id,
                              in->count);
    if (in->drum[0] && receiver == HIMC_PERFORMER)
        receiver = HIMC_DRUM; // one of its drums
    if (!himc_command_parse(out, receiver, row->name, in->atom, in->count, error))
        return false;
    memmove(out->drum, in->drum, sizeof out->drum);
    for (int i = 0; i < in->count; i++)
        if (in->atom[i].kind == HIMC_ATOM_NUMBER)
            out->atom[i].number = in->atom[i].number;
    return true;
}

bool himc_command_parse_text(himc_command *out, himc_receiver receiver, const char *text,
                             himc_error *error)
{
    himc_atom atoms[HIMC_COMMAND_ATOMS + 2];
    char storage[sizeof out->storage];
    himc_text_statement s = {.atom = atoms,
                             .capacity = HIMC_COMMAND_ATOMS + 2,
                             .storage = storage,
                             .size = sizeof storage};
    int line = 1;
    if (!himc_text_next(&text, &line, &s) || s.count == 0)
        return himc_error_set(error, "an empty command, expected a name and its atoms");
    if (s.overflow)
        return himc_error_set(error, "a command of more than %zu characters", s.size);
    if (text[strspn(text, " \t\r\n")])
        return himc_error_set(error, "%.60s: more than one command in a line", text);
    int known = s.count < s.capacity ? s.count : s.capacity;
    return himc_command_parse(out, receiver, atoms[0].symbol, atoms + 1, known - 1, error);
}

void himc_command_copy(himc_command *out, const himc_command *in)
{
    if (out == in)
        return;
    *out = *in;
    for (int i = 0; i < out->count; i++)
        if (out->atom[i].kind == HIMC_ATOM_SYMBOL)
            out->atom[i].symbol = out->storage + (in->atom[i].symbol - in->storage);
    if (in->folder)
        out->folder = out->storage + (in->folder - in->storage);
}

himc_word himc_command_word(himc_command_id id, int atom, int choice)
{
    const himc_command_row *row = himc_command_table((int)id);
    const char *grammar = row ? row->atoms : "";
    char token[WORD_SIZE] = "";
    bool optional;
    for (int i = 0; i <= atom; i++) {
        if (!*grammar || *grammar == '|')
            return (himc_word){""};
        grammar = next_token(grammar, token, &optional);
    }
    if (is_argument(token))
        return (himc_word){""};
    return cut_word(token, choice);
}

himc_file_use himc_command_file(const himc_command *command, int *atom)
{
    const himc_command_row *row = himc_command_table((int)command->id);
    const char *grammar = row->atoms;
    char token[WORD_SIZE];
    bool optional;
    for (int form = 0; form < command->form; form++)
        grammar = strstr(grammar, " | ") + 3;
    for (int i = 0; i < command->count && *grammar && *grammar != '|'; i++) {
        grammar = next_token(grammar, token, &optional);
        *atom = i;
        if (strcmp(token, "FILE") == 0)
            return row->marks & HIMC_WRITES_FILE ? HIMC_FILE_WRITE : HIMC_FILE_READ;
    }
    return HIMC_FILE_NONE;
}
