/// command.c: the vocabulary: one table, one parser.
///
/// The `atoms` text of a row is the grammar the parser follows, so the manual cannot differ from
/// it. Capitals name an argument (argument.c says what it may be), small letters stand for
/// themselves, `a|b` is one word of several, brackets are optional, ` | ` separates whole
/// alternatives; SPOT is a word or two numbers. If no alternative fits, the error speaks of the one
/// that came closest. Numbers are held in single precision, as Pure Data and OSC send them, so that
/// a command is the same to the last bit whoever carries it. Invariant: a refused command changes
/// nothing.
#include "himc/command.h"

#include "argument.h"
#include "text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WHAT "pose|targets|strikes|head|vmc"
#define STROKE_ATOMS "HAND NUANCE DYNAMIC [SPOT] [DRUM]"

static const himc_command_row table[] = {
    {HIMC_COMMAND_STROKE, HIMC_PERFORMER, "stroke", "BEAT " STROKE_ATOMS,
     "adds one stroke to the score"},
    {HIMC_COMMAND_HIT, HIMC_PERFORMER, "hit", STROKE_ATOMS,
     "plays a stroke as soon as it can be prepared"},
    {HIMC_COMMAND_TEMPO, HIMC_PERFORMER, "tempo", "BPM [BEAT]",
     "sets the tempo, from that beat or from now on"},
    {HIMC_COMMAND_GRIP, HIMC_PERFORMER, "grip", "french|german",
     "how the sticks are held: thumbs up, or palms down (german)"},
    {HIMC_COMMAND_LOOP, HIMC_PERFORMER, "loop", "SWITCH",
     "whether the score begins again after its last whole beat"},
    {HIMC_COMMAND_CLEAR, HIMC_PERFORMER, "clear", "", "forgets the score and all that is queued"},
    {HIMC_COMMAND_PLAY, HIMC_PERFORMER, "play", "", "starts the score from the current beat"},
    {HIMC_COMMAND_STOP, HIMC_PERFORMER, "stop", "", "stops the score; the sticks come to rest"},
    {HIMC_COMMAND_SEEK, HIMC_PERFORMER, "seek", "BEAT", "goes to a beat"},
    {HIMC_COMMAND_SCORE, HIMC_PERFORMER, "score", "FILE",
     "loads a score; while one plays, the new one follows it"},
    {HIMC_COMMAND_TAKE, HIMC_PERFORMER, "take", "FILE", "loads a motion capture and tracks it"},
    {HIMC_COMMAND_UNITS, HIMC_PERFORMER, "units", "clear | FILE NUANCE [SPOT]",
     "cuts strokes out of a take and plays them instead of the built-in ones"},
    {HIMC_COMMAND_TARGET, HIMC_PERFORMER, "target", "HAND X Y Z",
     "moves a drumstick's tip to a place; many of them, it follows"},
    {HIMC_COMMAND_MODE, HIMC_PERFORMER, "mode", "himc|id|ik", "chooses the control pipeline"},
    {HIMC_COMMAND_SOLVER, HIMC_PERFORMER, "solver", "dls|pinv|transpose|nakamura|sdls",
     "chooses the inverse kinematics"},
    {HIMC_COMMAND_DAMPING, HIMC_PERFORMER, "damping", "LAMBDA",
     "sets the damping of the least squares"},
    {HIMC_COMMAND_POSTURE, HIMC_PERFORMER, "posture", "SWITCH",
     "whether the tips' null space is for a natural posture (1), or for nothing, as published"},
    {HIMC_COMMAND_BEND, HIMC_PERFORMER, "bend", "SWITCH",
     "whether `id` bends a take's arms to its tips, so that strokes land (1), or follows the joints "
     "as captured, as published (0)"},
    {HIMC_COMMAND_ELBOW, HIMC_PERFORMER, "elbow", "SWITCH",
     "whether the elbow's place comes before the rest of the posture"},
    {HIMC_COMMAND_WEIGHTS, HIMC_PERFORMER, "weights", "SHOULDER ELBOW WRIST GRIP",
     "how willingly each joint turns to bring the tip nearer"},
    {HIMC_COMMAND_LAW, HIMC_PERFORMER, "law", "printed|feedforward|computed-torque",
     "chooses the inverse dynamics"},
    {HIMC_COMMAND_GAIN, HIMC_PERFORMER, "gain", "reset | frequency FACTOR | JOINT KS KD",
     "sets stiffness and damping of a joint's servo, the natural frequency of all over the usual, "
     "or all as they were"},
    {HIMC_COMMAND_LIMITS, HIMC_PERFORMER, "limits", "ellipsoid|euler|off",
     "keeps the joints as far as the take's player turned them, or table 1's"},
    {HIMC_COMMAND_STRENGTH, HIMC_PERFORMER, "strength", "human|off | JOINT TORQUE",
     "sets the most that a joint's torque may be, or a man's for all, or any"},
    {HIMC_COMMAND_RATE, HIMC_PERFORMER, "rate", "physics HZ | task HZ",
     "sets the rate of simulation or control"},
    {HIMC_COMMAND_COUPLING, HIMC_PERFORMER, "coupling", "two-way|one-way",
     "whether the head's vibration pushes back on the stick"},
    {HIMC_COMMAND_PLAYER, HIMC_PERFORMER, "player", "HEIGHT MASS", "changes the performer's body"},
    {HIMC_COMMAND_PUSH, HIMC_PERFORMER, "push", "SEGMENT FX FY FZ SECONDS",
     "pushes a part of the body with a force for so long"},
    {HIMC_COMMAND_RECORD, HIMC_PERFORMER, "record", "stop | FILE",
     "writes what is played as a take, .bvh .c3d or .trc, when stopped"},
    {HIMC_COMMAND_INFO, HIMC_PERFORMER, "info", "", "tells the state in a few lines"},
    {HIMC_COMMAND_RESET, HIMC_PERFORMER, "reset", "", "makes everything as when just made"},
    {HIMC_COMMAND_MAKE_DRUM, HIMC_PERFORMER, "drum", "NAME [INCHES]",
     "makes a drum, 23 inches by default"},
    {HIMC_COMMAND_SUBSCRIBE, HIMC_PERFORMER, "subscribe", "HOST PORT " WHAT " [HZ] | HOST vmc [HZ]",
     "sends that to an address over OSC, 33 times a second by default; vmc to port 39539"},
    {HIMC_COMMAND_UNSUBSCRIBE, HIMC_PERFORMER, "unsubscribe",
     "HOST PORT [" WHAT "] [HZ] | HOST vmc", "stops sending that, or anything, to an address"},
    {HIMC_COMMAND_LISTEN, HIMC_PERFORMER, "listen", "PORT",
     "takes commands over OSC at that port of this machine; 0 ends it"},
    {HIMC_COMMAND_RADIUS, HIMC_DRUM, "radius", "RADIUS", "sets the head's radius"},
    {HIMC_COMMAND_TENSION, HIMC_DRUM, "tension", "TENSION", "sets the head's tension"},
    {HIMC_COMMAND_DENSITY, HIMC_DRUM, "density", "DENSITY", "sets the head's mass per area"},
    {HIMC_COMMAND_TUNE, HIMC_DRUM, "tune", "HZ | NOTE",
     "sets the tension so that the principal mode sounds there"},
    {HIMC_COMMAND_MODES, HIMC_DRUM, "modes", "COUNT", "sets the number of modes"},
    {HIMC_COMMAND_DECAY, HIMC_DRUM, "decay", "T60 | SIGMA0 SIGMA1",
     "sets the losses by the decay time, or by both of their parameters"},
    {HIMC_COMMAND_AIR, HIMC_DRUM, "air", "SWITCH", "whether air and kettle load the head"},
    {HIMC_COMMAND_KETTLE, HIMC_DRUM, "kettle", "usual | VOLUME",
     "sets the volume under the head, or the usual one for its radius"},
    {HIMC_COMMAND_GLIDE, HIMC_DRUM, "glide", "AMOUNT",
     "sets how much the tension rises as the head bows out"},
    {HIMC_COMMAND_DAMP, HIMC_DRUM, "damp", "AMOUNT", "lays a hand on the head"},
    {HIMC_COMMAND_SHAPE, HIMC_DRUM, "shape", "circle | rectangle LENGTH WIDTH | FILE",
     "makes a head of another outline, or one of masses and springs from a file"},
    {HIMC_COMMAND_MALLET, HIMC_DRUM, "mallet", "soft|medium|hard|wood | K ALPHA MASS",
     "chooses the mallet, or its stiffness, exponent and mass"},
    {HIMC_COMMAND_PLACE, HIMC_DRUM, "place", "X Y Z [TILT]",
     "says where the head stands and how it leans"},
    {HIMC_COMMAND_PICKUP, HIMC_DRUM, "pickup", "air AZIMUTH ELEVATION DISTANCE | X Y",
     "says where the sound is taken: in the air or on the head"},
    {HIMC_COMMAND_PICKUPS, HIMC_DRUM, "pickups", "CHANNELS", "sets by how many it is heard"},
    {HIMC_COMMAND_CHANNEL, HIMC_DRUM, "channel",
     "CHANNEL air AZIMUTH ELEVATION DISTANCE | CHANNEL X Y",
     "says where the sound of one of them is taken"},
    {HIMC_COMMAND_TECHNIQUE, HIMC_DRUM, "technique", "modal|signal|clip",
     "how blows become sound: by the head, or in Pure Data by the patch around it"},
    {HIMC_COMMAND_STRIKE, HIMC_DRUM, "strike", "X Y VELOCITY", "strikes without a performer"},
};

#define ROWS ((int)(sizeof table / sizeof *table))
#define WORD_SIZE 64
#define ALLOWED_SIZE 256

const himc_command_row *himc_command_table(int index)
{
    return index >= 0 && index < ROWS ? &table[index] : NULL;
}

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
    const char *nearest = NULL;
    int least = strlen(name) > 3 ? 3 : 2;
    for (int i = 0; i < ROWS; i++) {
        int distance =
            table[i].receiver == receiver ? edit_distance(name, table[i].name) : WORD_SIZE;
        if (distance < least) {
            least = distance;
            nearest = table[i].name;
        }
    }
    return nearest;
}

static bool refuse_name(himc_receiver receiver, const char *name, himc_error *error)
{
    char word[WORD_SIZE], names[ALLOWED_SIZE] = "";
    himc_text_printable(word, sizeof word, name);
    for (int i = 0; i < ROWS; i++) {
        size_t used = strlen(names);
        if (table[i].receiver == receiver)
            snprintf(names + used, sizeof names - used, " %s", table[i].name);
        else if (strcmp(table[i].name, name) == 0)
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
    for (int i = 0; i < ROWS; i++)
        if (table[i].receiver == receiver && strcmp(table[i].name, name) == 0)
            return &table[i];
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
