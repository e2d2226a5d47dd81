/// fit_drum.c: each size of timpano, tuned to each strong partial, is set beside what was found.
///
/// The air over the head makes the ratios of (1,1) .. (6,1) depend on the drum's size at a pitch: a
/// size more is 1 % of (2,1), 1.5 % of (3,1), 2 % of (4,1), and a partial is found within a tenth
/// of that. So the size whose own modes fit best is the drum's; all of its partials tune it. What
/// the air takes follows from both; the losses S0 and S1 are the rest, by least squares. A room
/// that rings longer than a partial hides its decay, which then counts less.
#include "fit_drum.h"

#include "himc/drum.h"
#include "himc/membrane.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define RATE 48000.0
#define LOWEST 55.0     // of (1,1) (Hz)
#define HIGHEST 290.0   // (Hz)
#define STRONGEST 10    // partials that may be (1,1)
#define NEAR 0.015      // a partial this near a mode may be it (per frequency) ...
#define CLOSE 0.004     // ... and at this distance counts half
#define CLEAREST 25.0   // (dB) more counts no more
#define LEAST_CLEAR 6.  // (dB) less is no partial
#define STEADY 0.08     // (Hz) a partial that moves so much counts half
#define STEADY_PART 0.1 // ... beside so much of 1/T60
#define DECAYS 0.7      // of ln T60: counts half
#define UP_TO 2.6       // partials up to this multiple of (1,1) are judged; above modes are dense
#define DOWN_TO 0.6     // ... and so far below it: a room has poles everywhere
#define LOUD 40.0       // (dB) below the strongest a partial counts nothing
#define UNEXPLAINED 0.5 // a partial that the drum has not counts so much against it
#define NEEDED 3        // (1,1) .. (3,1) are heard of every timpano ...
#define MISSING 10.0    // ... or it is less likely (dB)
#define SHARP 0.001     // per frequency: a fine tuning
#define STEP 0.0002
#define SEARCHED 25 // steps either way
#define FINE_UP_TO 3.6
#define TUNINGS 3 // rounds

const char *const fit_mallets[] = {"soft", "medium", "hard", "wood", NULL};
const char *const fit_dynamics[] = {"p", "mp", "mf", "f", "ff", NULL};
const double fit_speeds[] = {1.3, 2, 2.9, 3.9, 5.1}; // of legato strokes

// what players tune them to: F3 to C4, D3 to A3, A2 to F3, F2 to C#3, C2 to A2 (Hz)
static const struct {
    double inches, low, high;
} sizes[] = {{20, 175, 262}, {23, 147, 220}, {26, 110, 175}, {29, 87, 139}, {32, 65, 110}};
#define SIZES (sizeof sizes / sizeof *sizes)
#define OUTSIDE 30.0 // an octave beyond them is less likely by so much (dB)

// usual losses, which a drum has where nothing else is known (himc_head_default)
#define USUAL_CONSTANT 0.3
#define USUAL_SQUARE 5e-8

static bool tell(himc_drum *drum, himc_error *error, const char *format, double a, double b)
{
    char text[128];
    himc_command command;
    snprintf(text, sizeof text, format, a, b);
    return himc_command_parse_text(&command, HIMC_DRUM, text, error) &&
           himc_drum_command(drum, &command, error);
}

himc_drum *fit_drum_make(const fit_drum *d, int mallet, double rate, himc_error *error)
{
    char felt[32];
    snprintf(felt, sizeof felt, "mallet %s", fit_mallets[mallet]);
    himc_drum *drum = himc_drum_new("fit", d->inches, rate, error);
    if (drum && tell(drum, error, "decay %.9g %.9g", d->constant, d->square) &&
        tell(drum, error, "tune %.9g", d->tune, 0) && tell(drum, error, felt, 0, 0))
        return drum;
    himc_drum_release(drum);
    return NULL;
}

int fit_drum_modes(const fit_drum *drum, fit_mode modes[FIT_MODES], himc_error *error)
{
    himc_drum *made = fit_drum_make(drum, 0, RATE, error);
    int count = 0;
    for (int i = 0; made && count < FIT_MODES; i++) {
        himc_mode mode = himc_membrane_mode(himc_drum_membrane(made), i);
        if (!(mode.mass > 0))
            break;
        if (mode.m >= 0)
            modes[count++] =
                (fit_mode){mode.m, mode.n, mode.sine, mode.frequency, log(1000) / mode.decay};
    }
    himc_drum_release(made);
    return count;
}

// member `k` of the pairs (m,1), as `of` counts them; a head of any size has it among its modes
static const fit_mode *member(const fit_mode *modes, int count, int k)
{
    for (int i = 0; i < count; i++)
        if (modes[i].m == k / 2 + 1 && modes[i].n == 1 && modes[i].sine == k % 2)
            return &modes[i];
    return NULL;
}

// how surely it is a partial (dB): clear of others, and in one place in all windows
static double worth(const partial *p)
{
    double moves = p->frequency_error / (STEADY + STEADY_PART / p->t60);
    return fmax(0, fmin(p->clear, CLEAREST) - LEAST_CLEAR) / (1 + moves * moves);
}

// the same, less for what is softer than the strongest
static double weight(const partials_list *partials, int i)
{
    double strongest = -INFINITY;
    for (int k = 0; k < partials->count; k++)
        if (worth(&partials->row[k]) > 0)
            strongest = fmax(strongest, partials->row[k].energy);
    const partial *p = &partials->row[i];
    return worth(p) * fmax(0, 1 + (p->energy - strongest) / LOUD);
}

// how near a partial is to a mode, and it rings as long: 1, or less
static double likeness(const partial *p, const fit_mode *mode)
{
    double apart = (p->frequency / mode->frequency - 1) / CLOSE;
    double decay = log(p->t60 / mode->t60) / DECAYS;
    return 1 / (1 + apart * apart) / (1 + decay * decay);
}

// which partials the drum's orders are
static void assign(const partials_list *partials, const fit_mode *modes, int count, fit_drum *d)
{
    for (int k = 0; k < 2 * FIT_ORDERS; k++) {
        const fit_mode *mode = member(modes, count, k);
        double most = 0;
        d->of[k] = -1;
        for (int i = 0; mode && i < partials->count; i++) {
            const partial *p = &partials->row[i];
            double value = likeness(p, mode) * worth(p);
            if (fabs(p->frequency / mode->frequency - 1) < NEAR && value > most) {
                most = value;
                d->of[k] = i;
            }
        }
    }
}

// what of the clear partials is the drum's, less what is not and what is not there (dB)
static double judge(const partials_list *partials, const fit_mode *modes, int count,
                    const fit_drum *d)
{
    double score = 0;
    for (int i = 0; i < partials->count; i++) {
        const partial *p = &partials->row[i];
        double most = 0;
        if (p->frequency < DOWN_TO * d->tune || p->frequency > UP_TO * d->tune)
            continue;
        for (int k = 0; k < count; k++)
            if (modes[k].m > 0 && modes[k].n <= 2)
                most = fmax(most, likeness(p, &modes[k]));
        score += weight(partials, i) * (most - UNEXPLAINED * (1 - most));
    }
    for (int k = 0; k < 2 * NEEDED; k += 2)
        score -= d->of[k] < 0 && d->of[k + 1] < 0 ? MISSING : 0;
    return score;
}

static bool match(const partials_list *partials, fit_drum *d, himc_error *error)
{
    fit_mode modes[FIT_MODES];
    int count = fit_drum_modes(d, modes, error);
    if (count == 0)
        return false;
    double sum = 0, weights = 0, squares = 0;
    assign(partials, modes, count, d);
    for (int k = 0; k < 2 * FIT_ORDERS; k++) {
        if (d->of[k] < 0)
            continue;
        const fit_mode *mode = member(modes, count, k);
        const partial *p = &partials->row[d->of[k]];
        double part = fmax(p->frequency_error / p->frequency, 0.0005);
        double w = likeness(p, mode) * worth(p) / (1 + pow(part / 0.001, 2));
        double apart = log(p->frequency / mode->frequency);
        sum += w * apart;
        squares += w * apart * apart;
        weights += w;
    }
    d->score = judge(partials, modes, count, d);
    d->cents = weights > 0 ? 1200 / log(2) * sqrt(squares / weights) : 0;
    d->tune *= weights > 0 ? exp(sum / weights) : 1; // of the next round
    return true;
}

// in the order of weight
static int strongest(const partials_list *partials, int *out)
{
    int count = 0;
    for (int i = 0; i < partials->count; i++) {
        const partial *p = &partials->row[i];
        int k = count;
        if (p->frequency < LOWEST || p->frequency > HIGHEST || worth(p) == 0)
            continue;
        for (; k > 0 && weight(partials, i) > weight(partials, out[k - 1]); k--)
            if (k < STRONGEST)
                out[k] = out[k - 1];
        if (k < STRONGEST)
            out[k] = i;
        count += count < STRONGEST;
    }
    return count;
}

// S0 and S1 of least squares, drawn to the usual ones as if each were known within itself
static bool find_losses(const partials_list *partials, fit_drum *d, himc_error *error)
{
    fit_mode none[FIT_MODES], one[FIT_MODES];
    fit_drum bare = *d, lossy = *d;
    bare.constant = bare.square = lossy.square = 0;
    lossy.constant = 1;
    int count = fit_drum_modes(&bare, none, error);
    if (count == 0 || fit_drum_modes(&lossy, one, error) == 0)
        return false;
    // unknowns in units of the usual ones
    double aa = 1, ab = 0, bb = 1, ay = 1, by = 1;
    for (int k = 0; k < 2 * FIT_ORDERS; k++) {
        const fit_mode *mode = member(none, count, k);
        if (d->of[k] < 0 || !mode)
            continue;
        const partial *p = &partials->row[d->of[k]];
        double decay = log(1000) / p->t60, air = log(1000) / mode->t60;
        double load = log(1000) / one[mode - none].t60 - air;
        double hidden = 0.4 / (1 + pow(p->t60 / fmax(partials->room, 1e-3), 3));
        double known = decay * sqrt(pow(p->t60_error / p->t60, 2) + hidden * hidden + 0.03 * 0.03);
        double a = load * USUAL_CONSTANT / known, y = (decay - air) / known;
        double b = load * USUAL_SQUARE * pow(2 * HIMC_PI * mode->frequency, 2) / known;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ay += a * y;
        by += b * y;
    }
    double det = aa * bb - ab * ab, s0 = (ay * bb - by * ab) / det, s1 = (by * aa - ay * ab) / det;
    if (s0 < 0)
        s1 = by / bb;
    if (s1 < 0)
        s0 = ay / aa;
    d->constant = USUAL_CONSTANT * fmax(s0, 0);
    d->square = USUAL_SQUARE * fmax(s1, 0);
    return true;
}

// how well all modes tuned by a factor are partials, sharply
static double accord(const partials_list *partials, const double *weights, const fit_mode *modes,
                     int count, double most, double factor)
{
    double sum = 0;
    for (int k = 0; k < count && modes[k].frequency < most; k++) {
        double best = 0;
        for (int i = 0; i < partials->count && modes[k].m > 0 && modes[k].n <= 2; i++) {
            const partial *p = &partials->row[i];
            double apart = (p->frequency / (factor * modes[k].frequency) - 1) / SHARP;
            double decay = log(p->t60 / modes[k].t60) / DECAYS;
            best = fmax(best, weights[i] * exp(-apart * apart) / (1 + decay * decay));
        }
        sum += best;
    }
    return sum;
}

// tunes a drum so that most of its modes are partials, and says which
static bool refine(const partials_list *partials, fit_drum *d, himc_error *error)
{
    fit_mode modes[FIT_MODES];
    double weights[PARTIALS_MOST];
    for (int i = 0; i < partials->count; i++)
        weights[i] = weight(partials, i);
    for (int round = 0; round < 2; round++) {
        double best = 0, tune = d->tune;
        int count = fit_drum_modes(d, modes, error);
        if (count == 0)
            return false;
        for (int i = -SEARCHED; i <= SEARCHED; i++) {
            double factor = 1 + STEP * i;
            double value = accord(partials, weights, modes, count, FINE_UP_TO * d->tune, factor);
            if (value > best) {
                best = value;
                tune = d->tune * factor;
            }
        }
        d->tune = tune;
    }
    int count = fit_drum_modes(d, modes, error);
    assign(partials, modes, count, d);
    return count > 0;
}

// keeps the likeliest, each size and pitch once; they are in order
static int add_choice(fit_drum *choice, int count, const fit_drum *d)
{
    for (int i = 0; i < count; i++)
        if (choice[i].inches == d->inches && fabs(choice[i].tune / d->tune - 1) < NEAR) {
            if (d->score > choice[i].score)
                choice[i] = *d;
            return count;
        }
    int k = count;
    for (; k > 0 && d->score > choice[k - 1].score; k--)
        if (k < FIT_CHOICES)
            choice[k] = choice[k - 1];
    if (k < FIT_CHOICES)
        choice[k] = *d;
    return count < FIT_CHOICES ? count + 1 : count;
}

int fit_drum_find(const partials_list *partials, fit_drum choice[FIT_CHOICES], himc_error *error)
{
    int candidates[STRONGEST], count = 0;
    int first = strongest(partials, candidates);
    for (size_t s = 0; s < SIZES; s++)
        for (int i = 0; i < first; i++) {
            double tune = partials->row[candidates[i]].frequency;
            fit_drum d = {.inches = sizes[s].inches,
                          .tune = tune,
                          .constant = USUAL_CONSTANT,
                          .square = USUAL_SQUARE};
            for (int round = 0; round < TUNINGS; round++) {
                tune = d.tune;
                if (!match(partials, &d, error))
                    return 0;
            }
            d.tune = tune; // that `of` belongs to
            d.score -=
                OUTSIDE * fmax(0, fmax(log2(tune / sizes[s].high), log2(sizes[s].low / tune)));
            count = add_choice(choice, count, &d);
        }
    for (int i = 0; i < count; i++)
        if (!refine(partials, &choice[i], error) || !find_losses(partials, &choice[i], error))
            return 0;
    if (count == 0)
        himc_error_set(error, "no partial is clear of the noise, expected a stroke that rings");
    return count;
}
