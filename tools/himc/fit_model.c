/// fit_model.c: a timpano made of the numbers that a fit has.
#include "fit_drum.h"

#include "himc/drum.h"
#include "himc/membrane.h"

#include <math.h>
#include <stdio.h>

#define RATE 48000.0

const char *const fit_mallets[] = {"soft", "medium", "hard", "wood", NULL};
const char *const fit_dynamics[] = {"p", "mp", "mf", "f", "ff", NULL};
const double fit_speeds[] = {1.3, 2, 2.9, 3.9, 5.1}; // of legato strokes

static bool tell(himc_drum *drum, himc_error *error, const char *format, double a, double b)
{
    char text[128];
    himc_command command;
    snprintf(text, sizeof text, format, a, b);
    return himc_command_parse_text(&command, HIMC_DRUM, text, error) &&
           himc_drum_command(drum, &command, error);
}

static bool tell_all(himc_drum *drum, const fit_drum *d, int mallet, himc_error *error)
{
    char felt[32];
    snprintf(felt, sizeof felt, "mallet %s", fit_mallets[mallet]);
    return tell(drum, error, "decay %.9g %.9g", d->constant, d->square) &&
           tell(drum, error, "tune %.9g", d->tune, 0) && tell(drum, error, felt, 0, 0);
}

himc_drum *fit_drum_make(const fit_drum *d, int mallet, double rate, himc_error *error)
{
    himc_drum *drum = himc_drum_new("fit", d->inches, rate, error);
    if (drum && tell_all(drum, d, mallet, error))
        return drum;
    himc_drum_release(drum);
    return NULL;
}

fit_drum fit_drum_usual(double inches, double tune)
{
    return (fit_drum){
        .inches = inches, .tune = tune, .constant = FIT_USUAL_CONSTANT, .square = FIT_USUAL_SQUARE};
}

int fit_drum_modes(const fit_drum *drum, fit_mode modes[FIT_MODES], himc_error *error)
{
    static himc_drum *made; // the last one: to tune it takes a fifth of the time to make it
    static double inches;
    int count = 0;
    if (!made || inches != drum->inches) {
        himc_drum_release(made);
        made = himc_drum_new("fit", drum->inches, RATE, error);
        inches = drum->inches;
    }
    if (!made || !tell_all(made, drum, 0, error))
        return 0;
    for (int i = 0; count < FIT_MODES; i++) {
        himc_mode mode = himc_membrane_mode(himc_drum_membrane(made), i);
        if (!(mode.mass > 0))
            break;
        if (mode.m >= 0)
            modes[count++] =
                (fit_mode){mode.m, mode.n, mode.sine, mode.frequency, log(1000) / mode.decay};
    }
    return count;
}
