/// fit_list.c: partials as a list of modes: all of one mass, with shape 1 everywhere, so that only
/// the pressure of each says how loud it is.
///
/// The pressures follow from one blow on a list in which all are alike: what its partials are
/// louder or softer than those found is taken back, twice, since near ones hide each other.
#include "fit_list.h"

#include "fit_drum.h"
#include "himc/drum.h"

#include <math.h>
#include <string.h>

#define MODES 160     // the strongest; chosen: of halls' recordings a third of all poles
#define RADIUS 0.1    // (m) of the struck disc, chosen
#define MASS 0.05     // (kg) chosen
#define PRESSURE 1e-4 // of the loudest mode (Pa s^2/m); as of the lists of lists.c
#define ROUNDS 2
#define CLEAR 0.0 // (dB) a partial less clear is the room's
#define NEAR 1.5  // (Hz)
#define SECONDS 4.0

typedef struct list {
    const partial *of[MODES];
    double pressure[MODES];
    int count;
} list;

himc_drum *fit_list_drum(const cli_file *file, double rate, himc_error *error)
{
    const char *path = file->temp[0] ? file->temp : file->path;
    himc_command command;
    himc_drum *drum = himc_drum_new("fit", 26, rate, error);
    himc_atom atom[] = {{HIMC_ATOM_SYMBOL, 0, "modes"}, {HIMC_ATOM_SYMBOL, 0, path}};
    if (drum && himc_command_parse(&command, HIMC_DRUM, "shape", atom, 2, error) &&
        himc_drum_command(drum, &command, error))
        return drum;
    himc_drum_release(drum);
    return NULL;
}

static bool write(const list *l, const char *path, cli_file *file, himc_error *error)
{
    double loudest = 0, strongest = -INFINITY, pitch = 0;
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
            RADIUS);
    for (int i = 0; i < l->count; i++)
        fprintf(file->stream, "pressure %.4g\nmode %.7g %.4g %g 1 1\n",
                fmax(1e-12, PRESSURE * l->pressure[i] / loudest), l->of[i]->frequency,
                fmin(l->of[i]->t60, 60), MASS);
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
    for (int i = 0; i < l->count; i++)
        l->pressure[i] = pow(10, l->of[i]->level / 20) / l->of[i]->frequency;
}

static bool correct(list *l, const cli_file *file, double rate, himc_error *error)
{
    static partials_list made; // large
    partials_sound heard = {.tracks = 0};
    himc_drum *drum = fit_list_drum(file, rate, error);
    bool good = drum && fit_hear(drum, 0, fit_speeds[2], SECONDS, &heard, error) &&
                partials_find(&heard, FIT_LIST_HIGHEST, &made, error);
    for (int i = 0; good && i < l->count; i++) {
        const partial *best = NULL;
        double apart = NEAR;
        for (int k = 0; k < made.count; k++) {
            double d = fabs(made.row[k].frequency - l->of[i]->frequency);
            if (d < apart) {
                apart = d;
                best = &made.row[k];
            }
        }
        if (best)
            l->pressure[i] *= pow(10, (l->of[i]->level - best->level) / 20);
    }
    partials_sound_free(&heard);
    himc_drum_release(drum);
    return good;
}

bool fit_list(const partials_sound *sound, const partials_list *found, const char *path,
              cli_file *file, himc_error *error)
{
    list l = {.count = 0};
    choose(found, &l);
    if (l.count == 0)
        return himc_error_set(error,
                              "no partial is clear of the noise, expected a sound that rings");
    bool good = write(&l, path, file, error);
    for (int round = 0; good && round < ROUNDS; round++)
        good = correct(&l, file, sound->rate, error) && write(&l, path, file, error);
    return good;
}
