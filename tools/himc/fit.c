/// fit.c: `himc fit`: a drum from recorded strokes, as commands that make it.
///
/// partials.c finds what sounds, fit_drum.c the timpano that sounds so, fit_strike.c its mallet;
/// what no membrane sounds like becomes a list of modes (fit_list.c, partials_lines.c). What is
/// made is struck and its partials are set beside those found.
#include "cli.h"
#include "fit_drum.h"
#include "fit_list.h"
#include "himc/drum.h"

#include "base/order.h"
#include "base/text.h"
#include "system/files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RADIUS_PER_INCH 0.0127 // (m) half an inch
#define ROWS 60                // of the report; as many as a list has modes
#define HIGHEST 1200.0         // (Hz) of a timpano
#define SECONDS 4.0            // of the blow that is set beside the recording
#define NEAR 0.015             // per frequency: the same partial
#define UNKNOWN (-170.0)       // (dB) digital silence before the stroke, or nothing
#define LEAST_SCORE 10.0       // of a drum (dB) ...
#define MOST_APART 5.5         // ... and of its blow's spectrum (dB); chosen: bars have 8 and more
#define LAWFUL 2.0        // ... as a membrane's; chosen: ours have 1.5 and less, recorded 2.9 up
#define UNLIKE 0.1        // (dB) two mallets differ by this ...
#define UNLIKE_PART 0.15  // ... and per distance, or they are not told apart; chosen
#define ALIKE 0.003       // per frequency: so near it is
#define UNLIKE_DECAY 0.3  // (Hz) per ln of T60
#define SURE 6.0          // (dB) clear of the others
#define STEADY 0.2        // (Hz)
#define CENTS 5.0         // a principal so far from the recorded one is told
#define DECAYS_APART 0.26 // of ln T60, 30 %: told ...
#define CERTAIN 0.15      // ... of a T60 known within this part of it ...
#define TOLD_BY 4         // pairings; the middle one of them is told
#define LOUD 40.0         // (dB) below the loudest a partial is not certain ...
#define HELD_UP 2.0       // ... nor a T60 longer than made, but below so many T60s of the room

enum { OUT, INSTRUMENT, JSON };

static const cli_option options[] = {
    {"output", 'o', "DRUM.txt", "the commands, a score; DRUM-head.txt is the same for [membrane~]"},
    {"instrument", 0, "KIND",
     "timpano: a membrane, or modes: a list; else what sounds as recorded"},
    {"json", 0, NULL, "the report as a JSON object"},
    {0},
};

typedef struct fit {
    partials_sound sound, again;
    partials_list found, made;
    fit_spectrum spectrum;
    fit_drum drum, second;
    bool two;     // the second sounds as well
    bool timpano; // it is known which drum it is
    bool list;    // what is made is a list of modes
    char name[HIMC_NAME_SIZE];
    double pitch;                                     // of the list (Hz)
    char head[HIMC_PATH_SIZE], modes[HIMC_PATH_SIZE]; // files beside the drum's
    cli_file file, head_file, modes_file;
} fit;

// the next letter of the path, small and without its mark; another character as it is
static char plain(const char **at)
{
    static const char latin[] = "aaaaaaaceeeeiiiidnooooo-ouuuuyts"; // U+00C0 on, twice
    unsigned char c = (unsigned char)**at, next = (unsigned char)(*at)[1];
    if (c == 0xc3 && next >= 0x80 && next < 0xc0) {
        ++*at;
        return latin[next % 32];
    }
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : (char)c;
}

// the name of the drum: the file's without folder, ending and what a drum's name cannot have
static void name_drum(const char *path, char *name, size_t size)
{
    const char *slash = strrchr(path, '/');
    size_t n = 0;
    for (const char *at = slash ? slash + 1 : path; *at && *at != '.' && n + 1 < size; at++) {
        char c = plain(&at);
        if ((c >= 'a' && c <= 'z') || (n > 0 && c >= '0' && c <= '9'))
            name[n++] = c;
    }
    name[n] = '\0';
    himc_command command;
    himc_atom atom = {HIMC_ATOM_SYMBOL, 0, name};
    if (!himc_command_parse(&command, HIMC_PERFORMER, "drum", &atom, 1, NULL))
        snprintf(name, size, "fitted");
}

static void put(const void *text, FILE *out)
{
    fputs(text, out);
}

// the name of a file beside DRUM.txt, which is none of the recordings
static bool beside(const cli_arguments *a, const char *what, char out[HIMC_PATH_SIZE],
                   himc_error *error)
{
    const char *path = a->value[OUT];
    size_t length = strlen(path);
    if (length > 4 && !strcmp(path + length - 4, ".txt"))
        length -= 4;
    if (snprintf(out, HIMC_PATH_SIZE, "%.*s-%s.txt", (int)length, path, what) >= HIMC_PATH_SIZE)
        return himc_error_set(error, "-o: a path of %zu characters, expected up to %zu", length,
                              HIMC_PATH_SIZE - sizeof "-modes.txt");
    return cli_apart(out, a->repeated, a->repeats, error);
}

static bool write_drum(fit *f, const char *path, himc_error *error)
{
    const fit_drum *d = &f->drum;
    char text[1024], head[512];
    snprintf(head, sizeof head, "radius %.6g;\ndecay %.6g %.6g;\ntune %.6g;\nmallet %s;\n",
             RADIUS_PER_INCH * d->inches, d->constant, d->square, d->tune, fit_mallets[d->mallet]);
    snprintf(
        text, sizeof text,
        "comment made by himc fit;\ndrum %s %g;\n%s decay %.6g %.6g;\n%s tune %.6g;\n%s mallet %s;\n"
        "tempo 60;\nstroke 1 right legato %s;\n",
        f->name, d->inches, f->name, d->constant, d->square, f->name, d->tune, f->name,
        fit_mallets[d->mallet], fit_dynamics[d->dynamic]);
    return cli_draft(&f->head_file, f->head, put, head, error) &&
           cli_draft(&f->file, path, put, text, error);
}

// names the list by its whole path: files in a score are looked for where the program runs
static bool write_list(fit *f, const char *path, himc_error *error)
{
    char text[3 * HIMC_PATH_SIZE];
    himc_state_line line = himc_state_begin("instrument"), shape = himc_state_begin("shape");
    double radius = f->timpano ? RADIUS_PER_INCH * f->drum.inches : FIT_LIST_RADIUS;
    f->pitch = f->timpano ? f->drum.tune : 0;
    if (!fit_list(&f->sound, &f->found, radius, &f->pitch, f->modes, &f->modes_file, &f->made,
                  error))
        return false;
    // it is not there yet: its draft is, whose name goes on
    const cli_file *file = &f->modes_file;
    char *whole = himc_system_real_path(file->temp);
    size_t length = whole ? strlen(whole) + strlen(file->path) - strlen(file->temp) : 0;
    if (!whole || length >= HIMC_PATH_SIZE || strpbrk(whole, "\n\r\v\f")) {
        free(whole);
        return himc_error_set(error, "%s: expected a path of up to %d characters without line ends",
                              f->modes, HIMC_PATH_SIZE - 1);
    }
    whole[length] = '\0';
    himc_state_word(&line, f->name);
    himc_state_word(&line, "modes");
    himc_state_word(&line, whole);
    himc_state_word(&shape, "modes");
    himc_state_word(&shape, whole);
    free(whole);
    // without a room: the list has the recording's
    snprintf(text, sizeof text,
             "comment made by himc fit;\n%s;\nroom 0;\ntempo 60;\nstroke 1 right legato mf;\n",
             line.text);
    if (!cli_draft(&f->file, path, put, text, error))
        return false;
    snprintf(text, sizeof text, "%s;\n", shape.text);
    return cli_draft(&f->head_file, f->head, put, text, error);
}

static bool hear_drum(fit *f, himc_error *error)
{
    const fit_drum *d = &f->drum;
    double rate = f->sound.rate < 16000 ? 48000 : f->sound.rate;
    himc_drum *drum = fit_drum_make(d, d->mallet, rate, error);
    double x = -FIT_PLACE * RADIUS_PER_INCH * d->inches;
    bool good = drum && fit_hear(drum, x, fit_speeds[d->dynamic], SECONDS, &f->again, error);
    himc_drum_release(drum);
    return good && partials_find(&f->again, HIGHEST, &f->made, error);
}

// A drum; or, where none is asked for, a list: if none is like it, and if one is but has other
// losses or radiates otherwise than a membrane's laws say.
static bool find_drum(fit *f, const char *kind, himc_error *error)
{
    fit_drum choice[FIT_CHOICES];
    int count = fit_spectrum_of(&f->sound, &f->spectrum, error)
                    ? fit_drum_find(&f->sound, &f->spectrum, &f->found, choice, error)
                    : 0;
    if (count == 0 || !fit_drum_strike(&f->sound, choice, count, &f->drum, error))
        return false;
    f->timpano = kind || (f->drum.score > LEAST_SCORE && f->drum.distance < MOST_APART);
    f->list = !f->timpano || (!kind && f->drum.distance > LAWFUL);
    if (f->timpano && !fit_drum_second(&f->drum, &f->spectrum, &f->second, &f->two, error))
        return false;
    return !f->list || partials_find(&f->sound, FIT_LIST_HIGHEST, &f->found, error);
}

// known well, as loud as others, and not held up by the room
static bool is_certain(const fit *f, const partial *p, double made, double loudest)
{
    return p->clear > SURE && p->frequency_error < STEADY && p->t60_error < CERTAIN * p->t60 &&
           p->energy > loudest - LOUD && (p->t60 < made || p->t60 > HELD_UP * f->found.room);
}

typedef struct pairing {
    const partial *found;
    double t60; // made (s)
} pairing;

static int by_decay(const void *a, const void *b)
{
    const pairing *p = a, *q = b;
    double x = p->found->t60 * q->t60, y = q->found->t60 * p->t60;
    return (x > y) - (x < y);
}

// says where a drum's principal is, and how its partials ring, if certainly not as recorded
static bool say_apart(const fit *f, himc_error *error)
{
    fit_mode modes[FIT_MODES];
    pairing pair[4 * FIT_ORDERS];
    const fit_drum *d = &f->drum;
    int count = fit_drum_modes(d, modes, error), pairs = 0;
    double loudest = -INFINITY, cents = INFINITY;
    for (int i = 0; i < f->found.count; i++)
        loudest = fmax(loudest, f->found.row[i].energy);
    for (int i = 0; i < 2 * FIT_MODES; i++) { // each member found beside both made
        const fit_mode *m = &modes[i / 2];
        int k = 2 * (m->m - 1) + i % 2;
        if (i / 2 >= count || m->n != 1 || k < 0 || k >= 2 * FIT_ORDERS || d->of[k] < 0)
            continue;
        const partial *p = &f->found.row[d->of[k]];
        double here = 1200 * log2(m->frequency / p->frequency);
        if (is_certain(f, p, m->t60, loudest))
            pair[pairs++] = (pairing){p, m->t60};
        if (m->m == 1 && is_certain(f, p, 0, loudest) && fabs(here) < fabs(cents))
            cents = here;
    }
    qsort(pair, (size_t)pairs, sizeof *pair, by_decay);
    const pairing *middle = &pair[pairs / 2];
    if (isfinite(cents) && fabs(cents) > CENTS)
        cli_say("note: (1,1) is made %+.0f cents from where it sounds\n", cents);
    if (pairs >= TOLD_BY && fabs(log(middle->found->t60 / middle->t60)) > DECAYS_APART)
        cli_say("note: %.0f Hz rings %.2f s, made %.2f s\n", middle->found->frequency,
                middle->found->t60, middle->t60);
    if (d->strange)
        cli_say("note: tuned by (1,1): no drum of %g inches has the other partials there\n",
                d->inches);
    if (d->hidden)
        cli_say("note: the room rings longer than the drum: losses and tuning are uncertain, "
                "expected a drier or longer one\n");
    return count > 0;
}

static bool work(fit *f, const cli_arguments *a, himc_error *error)
{
    const char *kind = a->value[INSTRUMENT], *out = a->value[OUT];
    if (!out)
        return himc_error_set(error, "no -o DRUM.txt given (himc fit --help)");
    if (cli_is_standard(out))
        return himc_error_set(error, "-o: -, expected a file: a second one is named after it");
    if (kind && strcmp(kind, "timpano") && strcmp(kind, "modes"))
        return himc_error_set(error, "--instrument: %s, expected timpano or modes", kind);
    if (!cli_ending_is("-o", out, ".txt", error) ||
        !cli_apart(out, a->repeated, a->repeats, error) || !beside(a, "head", f->head, error) ||
        !beside(a, "modes", f->modes, error) || !cli_draft(&f->file, out, put, "", error))
        return false;
    cli_file_drop(&f->file); // it can be written
    for (int i = 0; i < a->repeats; i++)
        if (!partials_read(&f->sound, a->repeated[i], error))
            return false;
    f->list = kind && !strcmp(kind, "modes");
    if (!partials_find(&f->sound, f->list ? FIT_LIST_HIGHEST : HIGHEST, &f->found, error))
        return false;
    name_drum(out, f->name, sizeof f->name);
    if (!f->list && !find_drum(f, kind, error))
        return false;
    if (f->list)
        partials_lines(&f->sound, &f->found);
    if (!(f->list ? write_list(f, out, error) : write_drum(f, out, error) && hear_drum(f, error)) ||
        (f->list && !cli_file_keep(&f->modes_file, error)) ||
        !cli_file_keep(&f->head_file, error) || !cli_file_keep(&f->file, error))
        return false;
    if (f->list && !kind)
        cli_say(f->timpano ? "note: no membrane sounds so: a list of modes (--instrument timpano "
                             "makes the nearest)\n"
                           : "note: no timpano found: a list of modes (--instrument timpano makes "
                             "the nearest)\n");
    return f->list || say_apart(f, error);
}

// two mallets whose blows are as near, beside how near they are, are not told apart
static bool decided(const fit_drum *d)
{
    return d->next - d->distance > fmax(UNLIKE, UNLIKE_PART * d->distance);
}

// the made partial nearest to a found one, or NULL
static const partial *nearest(const fit *f, const partial *p)
{
    const partial *best = NULL;
    double most = (f->list ? ALIKE : NEAR) * p->frequency;
    for (int i = 0; i < f->made.count; i++) {
        double apart =
            fabs(f->made.row[i].frequency - p->frequency) + 0.02 * f->made.row[i].frequency_error;
        if (f->list) // one line may be made of two modes
            apart += UNLIKE_DECAY * fabs(log(f->made.row[i].t60 / p->t60));
        if (apart < most && f->made.row[i].clear > 0) {
            most = apart;
            best = &f->made.row[i];
        }
    }
    return best;
}

// of a drum the partials that it has, of a list the strongest of the clear ones
static int rows(const fit *f, int out[ROWS])
{
    double strongest = -INFINITY;
    int count = 0;
    for (int i = 0; i < f->found.count; i++)
        strongest = fmax(strongest, f->found.row[i].energy);
    for (int i = 0; i < f->found.count; i++) {
        const partial *p = &f->found.row[i], *q = nearest(f, p);
        bool member = false;
        for (int k = 0; k < 2 * FIT_ORDERS; k++)
            member = member || (!f->list && f->drum.of[k] == i);
        bool doubtful = f->list && !p->line && p->frequency < PARTIALS_LINES;
        bool alike = q && fabs(q->frequency / p->frequency - 1) < ALIKE;
        member =
            member || (f->list && alike && p->energy > strongest - FIT_LIST_STRONG) ||
            (p->clear > SURE && p->frequency_error < STEADY && (alike || f->list) && !doubtful);
        if (member && count < ROWS)
            out[count++] = i;
        else if (member) { // the softest makes room
            int least = 0;
            for (int k = 1; k < ROWS; k++)
                least = f->found.row[out[k]].energy < f->found.row[out[least]].energy ? k : least;
            if (p->energy <= f->found.row[out[least]].energy)
                continue;
            memmove(&out[least], &out[least + 1], sizeof *out * (size_t)(ROWS - 1 - least));
            out[ROWS - 1] = i;
        }
    }
    return count;
}

static const char *const text_row = "%9.2f %6.2f %6.2f %6.2f %6.1f";
static const char *const json_row =
    "{\"hz\": %.3f, \"hz_error\": %.3f, \"t60_s\": %.4f, \"t60_error_s\": %.4f, \"level_db\": %.2f";

static void report_drum(const fit *f, bool json)
{
    const fit_drum *d = &f->drum;
    printf(json ? "\"inches\": %g, \"tune_hz\": %.4f, \"decay_s0\": %g, \"decay_s1\": %g, "
                : "drum        %g inches, tuned to %.2f Hz, losses %.3g 1/s and %.3g s\n",
           d->inches, d->tune, d->constant, d->square);
    printf(json ? "\"mallet\": \"%s\", \"dynamic\": \"%s\", \"mallet_db\": %.2f, "
                  "\"next_mallet\": \"%s\", \"next_mallet_db\": %.2f, \"mallet_decided\": %s, "
                : "blow        %s mallet, %s: spectrum within %.1f dB; %s within %.1f: %s\n",
           fit_mallets[d->mallet], fit_dynamics[d->dynamic], d->distance, fit_mallets[d->other],
           d->next,
           decided(d) ? json ? "true" : "decided"
           : json     ? "false"
                      : "undecided");
    if (f->two && json)
        printf("\"second_drum_hz\": %.1f, ", f->second.tune);
    else if (f->two)
        printf("second drum at %.1f Hz: expected one; its partials are not in the drum made\n",
               f->second.tune);
}

static void report(const fit *f, bool json)
{
    int row[ROWS], count = rows(f, row);
    double strongest = -INFINITY, louder[ROWS] = {0}; // the made ones; the middle one is set aside
    int pairs = 0;
    for (int i = 0; i < count; i++) {
        const partial *p = &f->found.row[row[i]], *q = nearest(f, p);
        strongest = fmax(strongest, p->level);
        if (q)
            louder[pairs++] = q->level - p->level;
    }
    qsort(louder, (size_t)pairs, sizeof *louder, himc_order_doubles);
    printf(json ? "{\"instrument\": \"%s\", " : "instrument  %s\n",
           f->timpano ? "timpano" : "modes");
    if (f->timpano && (json || !f->list))
        report_drum(f, json);
    if (f->list)
        printf(json ? "\"pitch_hz\": %.3f, " : "pitch       %.2f Hz\n", f->pitch);
    printf(json ? "\"made\": \"%s\", " : "made        as %s\n",
           f->list ? json ? "modes" : "a list of modes"
           : json  ? "membrane"
                   : "a membrane");
    if (f->sound.noise > UNKNOWN)
        printf(json ? "\"noise_db\": %.1f, " : "noise       %.0f dB\n", f->sound.noise);
    else
        fputs(json ? "\"noise_db\": null, " : "noise       not known: nothing before the stroke\n",
              stdout);
    fputs(json ? "\"partials\": [" : "\n", stdout);
    if (!json)
        puts("    found (Hz, +-; T60 s, +-; dB)              made (Hz; T60 s; dB)");
    for (int i = 0; i < count; i++) {
        const partial *p = &f->found.row[row[i]], *q = nearest(f, p);
        if (json && i > 0)
            printf(", ");
        printf(json ? json_row : text_row, p->frequency, p->frequency_error, p->t60, p->t60_error,
               p->level - strongest);
        if (q)
            printf(json ? ", \"made_hz\": %.3f, \"made_t60_s\": %.4f, \"made_level_db\": %.2f"
                        : "      %9.2f %6.2f %6.1f",
                   q->frequency, q->t60, q->level - louder[pairs / 2] - strongest);
        puts(json ? "}" : "");
    }
    if (json)
        puts("]}");
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    static fit f; // large
    bool good = work(&f, arguments, &error);
    if (good)
        report(&f, arguments->value[JSON]);
    cli_file_drop(&f.file);
    cli_file_drop(&f.head_file);
    cli_file_drop(&f.modes_file);
    partials_sound_free(&f.sound);
    partials_sound_free(&f.again);
    return good ? cli_finish(&cli_fit) : cli_fail(&cli_fit, "%s", error.text);
}

const cli_call cli_fit = {
    "fit",
    "RECORDING...",
    " -o DRUM.txt",
    "makes a drum of recorded strokes",
    "Each RECORDING is one stroke on the same instrument: WAV, FLAC, OGG and what else libsndfile\n"
    "reads, up to 300 s at 8000 Hz or more, all at one rate, with 32 channels together, without\n"
    "clipping; from the onset .5 s or more, better 4 s, the first 20 s are used. A timpano becomes\n"
    "commands (size, tuning, losses, mallet) where a membrane sounds as recorded, else, as any other\n"
    "instrument, a list of modes, DRUM-modes.txt, which DRUM.txt names by its whole path; a list has\n"
    "the recording's hall. The report sets each partial found with certainty, with its errors,\n"
    "beside that of the drum made: Hz, T60 (s), level at the onset (dB re the strongest).\n"
    "What cannot be used is refused in one line: silence, noise, a second stroke, clipping.",
    options,
    run,
};
