/// fit_list.c: partials as a list of modes: all of one mass, with shape 1 or -1 everywhere, so that
/// only the pressure of each says how loud it is. The signs are such that what all send together
/// while the mallet pushes cancels: else a list clicks, 40 dB over what then rings.
///
/// The pressures follow from one blow on a list in which all are alike: what its partials are
/// louder or softer than those found is taken back, twice, since near ones hide each other. All
/// modes together are heavier than the mallet: under a lighter list it chatters, and levels then
/// depend on the blow and the sample rate by up to 20 dB.
#include "fit_list.h"

#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MODES 160     // the strongest; chosen: of halls' recordings a third of all poles
#define MASS 0.1      // (kg) per mode: what all have together where it is struck, three mallets'
#define PRESSURE 2e-4 // (Pa s^2/m) per mode, of the loudest, at first; chosen
#define PEAK 0.2      // of a stroke mf; chosen: it is as loud as a drum's, and ff does not clip
#define ROUNDS 2
#define CLEAR 0.0           // (dB) a partial less clear is the room's
#define NEAR 1.5            // (Hz)
#define BEAT 1.1            // (s) before the blow
#define SECONDS 4.0         // after it
#define AT_ONCE 1.3         // of T60, in a round
#define ALIKE 0.2           // (dB) no more rounds ...
#define DECAY_DB 10.0       // ... a decay counts so much, per ln of T60
#define RATE 48000.0        // (Hz) of what is heard ...
#define LOWEST_RATE 16000.0 // ... if the recording's is lower

typedef struct list {
    const partial *of[MODES];
    double pressure[MODES], t60[MODES];
    int count;
    double louder; // factor of all pressures
} list;

// a stroke mf in free air; `peak`: its largest sample
static bool hear(const cli_file *file, double rate, partials_sound *out, double *peak,
                 himc_error *error)
{
    const char *path = file->temp[0] ? file->temp : file->path;
    size_t frames = (size_t)((BEAT + SECONDS) * rate);
    himc_performance_config config = himc_performance_default();
    himc_state_line line = himc_state_begin("instrument");
    himc_state_word(&line, "fitted");
    himc_state_word(&line, "modes");
    himc_state_word(&line, path);
    config.sample_rate = rate;
    config.physics_rate = fmin(config.physics_rate, rate);
    config.heard = true;
    float *heard = calloc(2 * frames, sizeof *heard);
    himc_performance *p = heard ? himc_performance_new(&config, error) : NULL;
    bool good = p && cli_tell(p, line.text, NULL, error) && cli_tell(p, "room 0", NULL, error) &&
                cli_tell(p, "tempo 120", NULL, error) &&
                cli_tell(p, "stroke 1 right legato mf", NULL, error) &&
                cli_tell(p, "play", NULL, error);
    if (good)
        *peak = himc_performance_read(p, heard, 2, (int)frames);
    else if (!heard)
        himc_error_set(error, "out of memory");
    good = good && partials_add(out, heard, frames, 2, rate, "the instrument made", error);
    himc_performance_free(p);
    free(heard);
    return good;
}

static bool write(const list *l, double radius, const char *path, cli_file *file, himc_error *error)
{
    double loudest = 0, sum = 0, strongest = -INFINITY, pitch = 0;
    cli_file_drop(file);
    if (!cli_file_open(file, path, error))
        return false;
    for (int i = 0; i < l->count; i++) {
        loudest = fmax(loudest, l->pressure[i]);
        pitch = l->of[i]->energy > strongest ? l->of[i]->frequency : pitch;
        strongest = fmax(strongest, l->of[i]->energy);
    }
    fprintf(file->stream,
            "# made by himc fit\npitch %.6g\nmallet 1e9 1.5 0.03\nsurface struck disc %g\n", pitch,
            radius);
    for (int i = 0; i < l->count; i++) {
        double p = PRESSURE * l->count * l->louder * l->pressure[i] / loudest;
        bool against = sum > 0;
        sum += against ? -p : p;
        fprintf(file->stream, "pressure %.4g\nmode %.7g %.4g %g %s\n", fmin(fmax(1e-12, p), 1),
                l->of[i]->frequency, fmin(l->t60[i], 60), MASS * l->count,
                against ? "-1 -1" : "1 1");
    }
    return cli_file_close(file, error);
}

static void choose(const partials_list *found, list *l)
{
    for (int i = 0; i < found->count; i++) {
        const partial *p = &found->row[i];
        int k = l->count;
        if (p->clear <= CLEAR)
            continue;
        for (; k > 0 && p->energy > l->of[k - 1]->energy; k--)
            if (k < MODES)
                l->of[k] = l->of[k - 1];
        if (k < MODES)
            l->of[k] = p;
        l->count += l->count < MODES;
    }
    for (int i = 0; i < l->count; i++) {
        l->t60[i] = l->of[i]->t60;
        l->pressure[i] = 1 / l->of[i]->frequency; // all alike
    }
}

static const partial *nearest(const partials_list *partials, double frequency, double within)
{
    const partial *best = NULL;
    for (int k = 0; k < partials->count; k++)
        if (fabs(partials->row[k].frequency - frequency) < within) {
            best = &partials->row[k];
            within = fabs(best->frequency - frequency);
        }
    return best;
}

static double beside(const list *l, int i, int k)
{
    return fabs(l->of[i]->frequency - l->of[k]->frequency);
}

// takes back what is louder or softer than found, or rings longer; the largest of that (dB)
static double correct(list *l, const partials_list *made)
{
    double louder[MODES] = {0}, largest = 0;
    for (int i = 0; i < l->count; i++) {
        const partial *p = l->of[i], *best = nearest(made, p->frequency, NEAR);
        louder[i] = best ? p->level - best->level : NAN;
        if (best && p->line && best->line) {
            double longer = fmin(fmax(p->t60 / best->t60, 1 / AT_ONCE), AT_ONCE);
            l->t60[i] *= longer;
            largest = fmax(largest, fabs(DECAY_DB * log(longer)));
        }
    }
    for (int i = 0; i < l->count; i++) {
        int from = i; // what is not heard of its own is changed as what is heard next to it
        for (int k = 0; k < l->count; k++)
            if (!isnan(louder[k]) && (isnan(louder[from]) || beside(l, k, i) < beside(l, from, i)))
                from = k;
        if (!isnan(louder[from])) {
            l->pressure[i] *= pow(10, louder[from] / 20);
            largest = fmax(largest, fabs(louder[from] - louder[0]));
        }
    }
    return isnan(louder[0]) ? INFINITY : largest;
}

bool fit_list(const partials_sound *sound, const partials_list *found, double radius,
              const char *path, cli_file *file, partials_list *made, himc_error *error)
{
    double peak;
    list l = {.louder = 1};
    choose(found, &l);
    if (l.count == 0)
        return himc_error_set(error,
                              "no partial is clear of the noise, expected a sound that rings");
    for (int round = 0;; round++) {
        partials_sound heard = {.tracks = 0};
        bool good =
            write(&l, radius, path, file, error) &&
            hear(file, sound->rate < LOWEST_RATE ? RATE : sound->rate, &heard, &peak, error) &&
            partials_find(&heard, FIT_LIST_HIGHEST, made, error);
        made->room = found->room; // what beats there is a line here as well
        if (good)
            partials_lines(&heard, made);
        partials_sound_free(&heard);
        l.louder *= good && peak > 0 ? PEAK / peak : 1;
        list tried = l; // but for its loudness
        if (!good || round == ROUNDS || correct(&l, made) < ALIKE)
            return good && write(&tried, radius, path, file, error);
    }
}
