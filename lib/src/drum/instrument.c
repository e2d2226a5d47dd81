/// instrument.c: what the commands `drum` and `instrument` make: a drum's settings, and then those
/// of its kind, by the commands that a user would give.
#include "drum/drum_performer.h"

#include "himc/command_rows.h"
#include "himc/ranges.h"
#include "himc/loader.h"

#include <math.h>
#include <stdio.h>

enum { OF_SIZE, OF_PITCH, OF_FILE }; // forms of `instrument`
#define COUNT(word) +1
// words: the timpano, then the bars, the lists, the shells, the plates; the last of each
enum {
    TIMPANO = 0,
    BARS = HIMC_BARS(COUNT),
    LISTS = BARS HIMC_LISTS(COUNT),
    SHELLS = LISTS HIMC_SHELLS(COUNT)
};

// a bar, if no pitch is given, sounds that (Hz), in the order of HIMC_BARS; chosen: mid range
static const double usual[BARS] = {261.6256, 523.2511, 261.6256, 1046.502, 523.2511};

// of the timpani that an orchestra has, that in the middle of whose range a pitch (Hz) is
static double inches_for(double hz)
{
    static const struct {
        double inches, below; // (Hz) between the middles of two ranges
    } size[] = {{32, 98}, {29, 127}, {26, 165}, {23, 235}, {20, INFINITY}};
    int i = 0;
    while (hz >= size[i].below)
        i++;
    return size[i].inches;
}

static bool carry_out(himc_drum_settings *s, const char *name, const himc_atom *atoms, int count,
                      himc_error *error)
{
    himc_command command;
    return himc_command_parse(&command, HIMC_DRUM, name, atoms, count, error) &&
           himc_drum_settings_command(s, &command, error);
}

// makes of a new drum the instrument that the command names
static bool change(himc_drum_settings *s, const himc_command *c, himc_error *error)
{
    int word = c->choice[1];
    bool bar = word <= BARS, listed = !bar && word <= LISTS;
    const char *shape = bar ? "bar" : listed ? "listed" : word <= SHELLS ? "shell" : "plate";
    himc_atom atoms[4] = {{HIMC_ATOM_SYMBOL, 0, shape}, c->atom[1]};
    if (c->form == OF_FILE)
        return carry_out(s, "shape", c->atom + 1, 2, error);
    if (listed || (!bar && c->form == OF_PITCH))
        return carry_out(s, "shape", atoms, 2, error) &&
               (c->count == 2 || carry_out(s, "tune", c->atom + 2, c->count - 2, error));
    if (bar)
        atoms[2] = (himc_atom){HIMC_ATOM_NUMBER, usual[c->choice[1] - 1], NULL};
    for (int i = 2; i < c->count; i++)
        atoms[i] = c->atom[i];
    return carry_out(s, "shape", atoms, bar && c->count == 2 ? 3 : c->count, error);
}

himc_drum *himc_drum_made(const himc_command *c, double sample_rate, himc_error *error)
{
    himc_drum_settings s;
    himc_drum *drum = NULL;
    const char *name = c->atom[0].symbol;
    bool instrument = c->id == HIMC_COMMAND_INSTRUMENT;
    bool skin = !instrument || (c->form != OF_FILE && c->choice[1] == TIMPANO);
    int size = instrument ? 2 : 1;
    bool tuned = instrument && skin && c->form == OF_PITCH;
    double inches = skin && c->count > size ? c->atom[size].number : HIMC_INCHES_USUAL;
    if (tuned)
        inches = inches_for(c->atom[size].number);
    if (!himc_drum_settings_new(&s, name, inches, sample_rate, error))
        return NULL;
    if (tuned && c->count > size + 1)
        himc_error_set(error, "timpano: a second note, expected one");
    else if (tuned ? carry_out(&s, "tune", c->atom + size, 1, error)
                   : skin || change(&s, c, error)) {
        if (!skin) // a dump tells the size as that of a drum, within the sizes of drums
            s.usual.radius = fmin(fmax(s.head.head.radius, 0.5 * HIMC_INCHES_MIN * METRES_PER_INCH),
                                  0.5 * HIMC_INCHES_MAX * METRES_PER_INCH);
        drum = himc_drum_new_of(&s, error);
    } else
        himc_error_prefix(error, "instrument %s", name);
    himc_drum_settings_free(&s);
    return drum;
}
