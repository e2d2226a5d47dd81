/// command.c: the vocabulary: one parser.
///
/// It follows the grammar in the rows of command_table.c. If no alternative fits, the error speaks
/// of the one that came closest. Numbers are held in single precision, as Pure Data and OSC send
/// them, so that a command is the same to the last bit whoever carries it. Invariant: a refused
/// command changes nothing.
#include "himc/command.h"

#include "base/argument.h"
#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WORD_SIZE 64
#define ALLOWED_SIZE 256

const char *himc_nuance_name(himc_nuance nuance)
{
    static const char *const name[] = {"legato", "tenuto", "accent", "vertical-accent", "staccato"};
    return nuance >= 0 && nuance < HIMC_NUANCES ? name[nuance] : "none";
}

/// How far an alternative of the grammar was followed, and what stopped it.
typedef struct attempt {
    int rank; ///< larger is closer
    enum { FITS, WRONG, MISSING, TOO_MANY } end;
    int at; ///< atom that stopped it
    char name[WORD_SIZE];
    char allowed[ALLOWED_SIZE];
} attempt;

/// The state of following one alternative.
typedef struct walk {
    const char *context; ///< command or last literal word
    const himc_atom *atom;
    int count, at;
    bool literal;   ///< a literal word fitted
    double *number; ///< what the atoms that fitted are stored as (HIMC_COMMAND_ATOMS)
} walk;

static const char *next_token(const char *grammar, char token[WORD_SIZE], bool *optional)
{
    size_t n = strcspn(grammar, " ");
    *optional = grammar[0] == '[';
    snprintf(token, WORD_SIZE, "%.*s", (int)(n - 2 * (size_t)*optional), grammar + *optional);
    grammar += n;
    return grammar + strspn(grammar, " ");
}

/// SPOT as two numbers.
static bool is_place(const walk *w)
{
    const himc_argument *x = himc_argument_find("X", "stroke");
    return w->at + 1 < w->count && w->atom[w->at].kind == HIMC_ATOM_NUMBER &&
           w->atom[w->at + 1].kind == HIMC_ATOM_NUMBER &&
           himc_argument_accepts(x, &w->atom[w->at]) &&
           himc_argument_accepts(x, &w->atom[w->at + 1]);
}

static void take_atoms(walk *w, const himc_argument *argument, int count)
{
    for (; count > 0; count--, w->at++)
        if (w->at < HIMC_COMMAND_ATOMS && w->atom[w->at].kind == HIMC_ATOM_NUMBER)
            w->number[w->at] = himc_argument_number(argument, w->atom[w->at].number);
}

/// Takes the atoms that fit the token; false if the next one does not.
static bool take(walk *w, const char *token, char allowed[ALLOWED_SIZE])
{
    const himc_atom *atom = &w->atom[w->at];
    if (!isupper((unsigned char)token[0])) {
        snprintf(allowed, ALLOWED_SIZE, "%s", token);
        for (char *s = allowed; *s; s++)
            *s = *s == '|' ? ' ' : *s;
        if (atom->kind != HIMC_ATOM_SYMBOL || himc_word_index(token, atom->symbol) < 0)
            return false;
        w->context = atom->symbol;
        w->literal = true;
        w->at++;
        return true;
    }
    const himc_argument *argument = himc_argument_find(token, w->context);
    bool spot = strcmp(token, "SPOT") == 0;
    himc_argument_describe(argument, allowed, ALLOWED_SIZE);
    if (spot)
        snprintf(allowed, ALLOWED_SIZE, "%s or X Y, both -1 .. 1 m", argument->words);
    bool place = spot && is_place(w);
    if (!place && !himc_argument_accepts(argument, atom))
        return false;
    take_atoms(w, place ? himc_argument_find("X", "stroke") : argument, place ? 2 : 1);
    return true;
}

/// Follows one alternative from `grammar` to its end; returns where the next begins, or NULL.
static const char *follow(const char *grammar, walk w, attempt *result)
{
    char token[WORD_SIZE], allowed[ALLOWED_SIZE];
    int least = 0, most = 0;
    bool optional;
    *result = (attempt){.end = FITS};
    while (*grammar && *grammar != '|') {
        grammar = next_token(grammar, token, &optional);
        least += !optional;
        most += 1 + (strcmp(token, "SPOT") == 0);
        if (result->end != FITS || (optional && w.at == w.count))
            continue;
        bool taken = w.at < w.count && take(&w, token, allowed);
        // an optional word may be left out when something else may follow
        bool skip = optional && *grammar && w.at < w.count && w.atom[w.at].kind == HIMC_ATOM_SYMBOL;
        if (taken || skip)
            continue;
        result->end = w.at == w.count ? MISSING : WRONG;
        snprintf(result->name, sizeof result->name, "%s", token);
        snprintf(result->allowed, sizeof result->allowed, "%s", w.at == w.count ? "" : allowed);
    }
    if (result->end == FITS && w.at < w.count)
        result->end = TOO_MANY;
    result->at = w.at;
    result->rank = 1000 * w.literal + 100 * (w.count >= least && w.count <= most) + w.at;
    return *grammar ? grammar + 2 : NULL;
}

static void print_value(char *out, size_t size, const himc_atom *atom)
{
    if (atom->kind == HIMC_ATOM_SYMBOL)
        himc_text_printable(out, size, atom->symbol);
    else
        snprintf(out, size, isfinite(atom->number) ? "%g" : "%g is not a finite number",
                 atom->number);
}

static bool refuse(const himc_command_row *row, const himc_atom *atoms, const attempt *best,
                   himc_error *error)
{
    char value[WORD_SIZE] = "";
    if (best->end != MISSING)
        print_value(value, sizeof value, &atoms[best->at]);
    bool named = isupper((unsigned char)best->name[0]);
    const char *space = row->atoms[0] ? " " : "";
    if (best->end == MISSING)
        return himc_error_set(error, "%s: %s missing, allowed %s %s", row->name, best->name,
                              row->name, row->atoms);
    if (best->end == TOO_MANY)
        return himc_error_set(error, "%s: %s is one atom too many, allowed %s%s%s", row->name,
                              value, row->name, space, row->atoms);
    return himc_error_set(error, "%s: %s%s%s, allowed %s", row->name, named ? best->name : "",
                          named ? ": " : "", value, best->allowed);
}

/// Of two failures the closer one; of two equally close wrong atoms, both of what was allowed.
static void keep_closer(attempt *best, const attempt *other)
{
    if (other->rank > best->rank || (other->rank == best->rank && best->end == TOO_MANY)) {
        *best = *other;
    } else if (other->rank == best->rank && other->end == WRONG && best->end == WRONG) {
        size_t used = strlen(best->allowed);
        int room = (int)(sizeof best->allowed - used);
        snprintf(best->allowed + used, (size_t)room, " or %.*s", room - 5 > 0 ? room - 5 : 0,
                 other->allowed);
        best->name[0] = '\0';
    }
}

static bool check(const himc_command_row *row, const himc_atom *atoms, int count,
                  double number[HIMC_COMMAND_ATOMS], himc_error *error)
{
    attempt best = {.rank = -1}, now;
    walk start = {row->name, atoms, count, 0, false, number};
    for (const char *grammar = row->atoms; grammar;) {
        grammar = follow(grammar, start, &now);
        if (now.end == FITS)
            return true;
        keep_closer(&best, &now);
    }
    return refuse(row, atoms, &best, error);
}

/// Distance of two words in insertions, deletions and replacements.
static int edit_distance(const char *a, const char *b)
{
    int row[WORD_SIZE];
    int n = (int)strlen(b);
    for (int j = 0; j <= n; j++)
        row[j] = j;
    for (int i = 1; *a; a++, i++) {
        int diagonal = row[0];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int change = diagonal + (*a != b[j - 1]);
            diagonal = row[j];
            int shift = 1 + (row[j] < row[j - 1] ? row[j] : row[j - 1]);
            row[j] = change < shift ? change : shift;
        }
    }
    return row[n];
}

static const char *nearest_name(himc_receiver receiver, const char *name)
{
    const himc_command_row *row;
    const char *nearest = NULL;
    int least = strlen(name) > 3 ? 3 : 2;
    for (int i = 0; (row = himc_command_table(i)); i++) {
        int distance = row->receiver == receiver ? edit_distance(name, row->name) : WORD_SIZE;
        if (distance < least) {
            least = distance;
            nearest = row->name;
        }
    }
    return nearest;
}

static bool refuse_name(himc_receiver receiver, const char *name, himc_error *error)
{
    const himc_command_row *row;
    char word[WORD_SIZE], names[ALLOWED_SIZE] = "";
    himc_text_printable(word, sizeof word, name);
    for (int i = 0; (row = himc_command_table(i)); i++) {
        size_t used = strlen(names);
        if (row->receiver == receiver)
            snprintf(names + used, sizeof names - used, " %s", row->name);
        else if (strcmp(row->name, name) == 0)
            return himc_error_set(error, "%s: a command for %s", word,
                                  receiver == HIMC_DRUM ? "the performer, not for a drum"
                                                        : "a drum, not for the performer");
    }
    const char *nearest = nearest_name(receiver, word);
    return himc_error_set(error, "%s: unknown command, %s%s%sallowed%s", word,
                          nearest ? "did you mean " : "", nearest ? nearest : "",
                          nearest ? "? " : "", names);
}

static const himc_command_row *find_row(himc_receiver receiver, const char *name)
{
    const himc_command_row *row;
    for (int i = 0; (row = himc_command_table(i)); i++)
        if (row->receiver == receiver && strcmp(row->name, name) == 0)
            return row;
    return NULL;
}

/// Copies atoms and their symbols; they have been checked, so they fit.
static void store(himc_command *out, const himc_atom *atoms, const double *number, int count)
{
    size_t used = 0;
    out->count = count;
    for (int i = 0; i < count; i++) {
        double hz;
        out->atom[i] = (himc_atom){HIMC_ATOM_NUMBER, number[i], NULL};
        if (atoms[i].kind != HIMC_ATOM_SYMBOL)
            continue;
        if (out->id == HIMC_COMMAND_TUNE && himc_note_frequency(atoms[i].symbol, &hz)) {
            out->atom[i].number = hz;
            continue;
        }
        size_t size = strlen(atoms[i].symbol) + 1;
        memcpy(out->storage + used, atoms[i].symbol, size);
        out->atom[i] = (himc_atom){HIMC_ATOM_SYMBOL, 0, out->storage + used};
        used += size;
    }
}

static int word_of(const char *argument, const himc_atom *atom)
{
    return himc_word_index(himc_argument_find(argument, "stroke")->words, atom->symbol);
}

/// The stroke that checked atoms describe.
static himc_stroke read_stroke(const himc_command *command)
{
    const himc_atom *atom = command->atom, *end = atom + command->count;
    himc_stroke stroke = {.spot = HIMC_SPOT_NORMAL};
    if (command->id == HIMC_COMMAND_STROKE)
        stroke.beat = (atom++)->number;
    stroke.hand = (himc_hand)word_of("HAND", atom++);
    stroke.nuance = (himc_nuance)word_of("NUANCE", atom++);
    stroke.dynamic = atom->kind == HIMC_ATOM_NUMBER ? atom->number : word_of("DYNAMIC", atom) / 7.0;
    atom++;
    if (atom < end && atom->kind == HIMC_ATOM_NUMBER) {
        stroke.spot = HIMC_SPOT_XY;
        stroke.x = (atom++)->number;
        stroke.y = (atom++)->number;
    } else if (atom < end && word_of("SPOT", atom) >= 0) {
        stroke.spot = (himc_spot)word_of("SPOT", atom++);
    }
    if (atom < end)
        snprintf(stroke.drum, sizeof stroke.drum, "%s", atom->symbol);
    return stroke;
}

bool himc_command_parse(himc_command *out, himc_receiver receiver, const char *name,
                        const himc_atom *atoms, int count, himc_error *error)
{
    const himc_command_row *row = find_row(receiver, name);
    if (!row)
        return refuse_name(receiver, name, error);
    double number[HIMC_COMMAND_ATOMS] = {0};
    if (!check(row, atoms, count, number, error))
        return false;
    out->id = row->id;
    store(out, atoms, number, count);
    if (row->id == HIMC_COMMAND_STROKE || row->id == HIMC_COMMAND_HIT)
        out->stroke = read_stroke(out);
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
        return himc_error_set(error, "an empty command, allowed a name and its atoms");
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
}
