/// fit_drum.c: each size of timpano, tuned as the spectrum suggests (fit_comb.c), is set beside the
/// partials found.
///
/// The air over the head makes the ratios of (1,1) .. (6,1) depend on the drum's size at a pitch: a
/// size more is 1 % of (2,1), 1.5 % of (3,1), 2 % of (4,1), and a partial is found within a tenth
/// of that. So the size whose own modes fit best is the drum's; all of its partials tune it. What
/// the air takes follows from both; the losses S0 and S1 are the rest, by least squares over the
/// decays in narrow bands around the drum's own modes (partials_ring). A partial that rings no
/// longer than the room is not used: the room would hold it up.
#include "fit_drum.h"

#include <math.h>

#define LOWER 0.87 // tunings this far beyond the usual ones are tried
#define HIGHER 1.15
#define NEAR 0.015      // a partial this near a mode may be it (per frequency) ...
#define CLOSE 0.004     // ... and at this distance counts half
#define CLEAREST 25.0   // (dB) more counts no more
#define LEAST_CLEAR 6.  // (dB) less is no partial
#define STEADY 0.08     // (Hz) a partial that moves so much counts half
#define STEADY_PART 0.1 // ... beside so much of 1/T60
#define DECAYS 0.7      // of ln T60: counts half
#define UP_TO 2.6       // partials up to this multiple of (1,1) are judged; above modes are dense
#define DOWN_TO 0.6     // ... and so far below it: a room has poles everywhere
#define STRONG 10.0     // (dB) a partial so near the strongest is no room's, and no drum's below it
#define LONGEST 15.0    // (s) of a drum; what rings longer is hum
#define LOUD 40.0       // (dB) below the strongest a partial counts nothing
#define UNEXPLAINED 0.5 // a partial that the drum has not counts so much against it
#define NEEDED 3        // (1,1) .. (3,1) are heard of every timpano ...
#define MISSING 10.0    // ... or it is less likely (dB)
#define SHARP 0.001     // per frequency: a fine tuning
#define STEP 0.0002
#define SEARCHED 25 // steps either way
#define FINE_UP_TO 3.6
#define TUNINGS 2       // rounds
#define TAKEN_OUT 0.008 // per frequency, on either side of a mode
#define TAKEN_LINE 3.0  // (Hz) more: a line's width
#define ANOTHER 0.04    // per frequency: another tuning
#define SECOND 45.0 // (dB) of the comb of a second drum; chosen: of single drums 17 to 40 are left
#define UNLIKELY 20.0 // (dB) a drum that is so much less likely than another is not it

// what players tune them to: F3 to C4, D3 to A3, A2 to F3, F2 to C#3, C2 to A2 (Hz)
static const struct {
    double inches, low, high;
} sizes[] = {{20, 175, 262}, {23, 147, 220}, {26, 110, 175}, {29, 87, 139}, {32, 65, 110}};
#define SIZES (sizeof sizes / sizeof *sizes)
#define OUTSIDE 30.0 // an octave beyond them is less likely by so much (dB)

#define USUAL_WITHIN 0.35 // chosen
#define SUREST 0.04       // of a decay, relative; chosen: beats of a pair that stay unresolved
#define LONGER 1.3        // a partial rings longer than the room by this, or its decay is not used
#define HELD 1.8 // found at less of the room's decay time it is the room's; chosen: 20 drums

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

static double strongest(const partials_list *partials)
{
    double most = -INFINITY;
    for (int k = 0; k < partials->count; k++)
        if (worth(&partials->row[k]) > 0)
            most = fmax(most, partials->row[k].energy);
    return most;
}

// the same, less for what is softer than the strongest
static double weight(const partials_list *partials, int i)
{
    const partial *p = &partials->row[i];
    return worth(p) * fmax(0, 1 + (p->energy - strongest(partials)) / LOUD);
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
    double score = 0, loudest = strongest(partials);
    bool below = false;
    for (int i = 0; i < partials->count; i++) {
        const partial *p = &partials->row[i];
        double most = 0;
        bool low = p->frequency < DOWN_TO * d->tune;
        below |= low && worth(p) > 0 && p->energy > loudest - STRONG && p->t60 < LONGEST;
        if (low || p->frequency > UP_TO * d->tune)
            continue;
        for (int k = 0; k < count; k++)
            if (modes[k].m > 0 && modes[k].n <= 2)
                most = fmax(most, likeness(p, &modes[k]));
        score += weight(partials, i) * (most - UNEXPLAINED * (1 - most));
    }
    score -= below ? UNLIKELY : 0; // an octave too high
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
    double sum = 0, weights = 0;
    assign(partials, modes, count, d);
    for (int k = 0; k < 2 * FIT_ORDERS; k++) {
        if (d->of[k] < 0)
            continue;
        const fit_mode *mode = member(modes, count, k);
        const partial *p = &partials->row[d->of[k]];
        double part = fmax(p->frequency_error / p->frequency, 0.0005);
        double w = likeness(p, mode) * worth(p) / (1 + pow(part / 0.001, 2));
        sum += w * log(p->frequency / mode->frequency);
        weights += w;
    }
    d->tune *= weights > 0 ? exp(sum / weights) : 1; // of the next round
    return true;
}

// mean decay of the pair (m,n) of the drum's modes, 0 without it; and its frequencies
static double pair_of(const fit_mode *modes, int count, int m, int n, double *frequency)
{
    double decay = 0, sum = 0;
    int found = 0;
    for (int i = 0; i < count; i++)
        if (modes[i].m == m && modes[i].n == n) {
            decay += log(1000) / modes[i].t60;
            sum += modes[i].frequency;
            found++;
        }
    *frequency = found ? sum / found : 0;
    return found ? decay / found : 0;
}

// S0 and S1 of least squares, drawn to the usual ones as if each were known within half of itself.
// What a room may hold up is not used.
static bool find_losses(const partials_sound *sound, const partials_list *partials, fit_drum *d,
                        himc_error *error)
{
    fit_mode none[FIT_MODES], one[FIT_MODES];
    fit_drum bare = *d, lossy = *d;
    bare.constant = bare.square = lossy.square = 0;
    lossy.constant = 1;
    int count = fit_drum_modes(&bare, none, error);
    if (count == 0 || fit_drum_modes(&lossy, one, error) == 0)
        return false;
    // unknowns in units of the usual ones
    double aa = 1 / (USUAL_WITHIN * USUAL_WITHIN), ab = 0, bb = aa, ay = aa, by = aa;
    for (int n = 1; n <= 2; n++)
        for (int m = 1; m <= (n == 1 ? FIT_ORDERS : 4); m++) {
            double f, decay, part;
            double air = pair_of(none, count, m, n, &f), load = pair_of(one, count, m, n, &f) - air;
            double due =
                air + load * (FIT_USUAL_CONSTANT + FIT_USUAL_SQUARE * pow(2 * HIMC_PI * f, 2));
            if (!(air > 0) || log(1000) / due < LONGER * partials->room)
                continue;
            if (!partials_ring(sound, f, due, &decay, &part, error))
                return false;
            if (log(1000) / decay < HELD * partials->room)
                continue;
            double known = decay * hypot(part, SUREST);
            double a = load * FIT_USUAL_CONSTANT / known, y = (decay - air) / known;
            double b = load * FIT_USUAL_SQUARE * pow(2 * HIMC_PI * f, 2) / known;
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
    d->constant = FIT_USUAL_CONSTANT * fmax(s0, 0);
    d->square = FIT_USUAL_SQUARE * fmax(s1, 0);
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
    d->score = judge(partials, modes, count, d);
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

int fit_drum_find(const partials_sound *sound, const fit_spectrum *spectrum,
                  const partials_list *partials, fit_drum choice[FIT_CHOICES], himc_error *error)
{
    int count = 0;
    for (size_t s = 0; s < SIZES; s++) {
        fit_drum best[FIT_TUNINGS];
        if (!fit_comb(spectrum, sizes[s].inches, LOWER * sizes[s].low, HIGHER * sizes[s].high, best,
                      error))
            return 0;
        for (int i = 0; i < FIT_TUNINGS; i++) {
            fit_drum d = best[i];
            for (int round = 0; round < TUNINGS; round++)
                if (!match(partials, &d, error))
                    return 0;
            if (!refine(partials, &d, error))
                return 0;
            double outside = fmax(log2(d.tune / sizes[s].high), log2(sizes[s].low / d.tune));
            d.score += d.comb - OUTSIDE * fmax(0, outside);
            count = add_choice(choice, count, &d);
        }
    }
    while (count > 0 && choice[count - 1].score < choice[0].score - UNLIKELY)
        count--;
    for (int i = 0; i < count; i++)
        if (!find_losses(sound, partials, &choice[i], error))
            return 0;
    return count;
}

bool fit_drum_second(const fit_drum *drum, const fit_spectrum *spectrum, fit_drum *second,
                     bool *sounds, himc_error *error)
{
    fit_mode modes[FIT_MODES];
    fit_spectrum rest = *spectrum;
    int count = fit_drum_modes(drum, modes, error);
    for (int k = 0; k < FIT_LINES; k++) {
        double f = FIT_LOWEST * exp(FIT_FINE * k);
        for (int i = 0; i < count; i++)
            if (fabs(f - modes[i].frequency) < TAKEN_OUT * f + TAKEN_LINE)
                rest.level[k] = 0;
        rest.mean += (rest.level[k] - spectrum->level[k]) / FIT_LINES;
    }
    *second = (fit_drum){.comb = -INFINITY};
    for (size_t s = 0; s < SIZES && count > 0; s++) {
        fit_drum best[FIT_TUNINGS];
        if (!fit_comb(&rest, sizes[s].inches, sizes[s].low, sizes[s].high, best, error))
            return false;
        for (int i = 0; i < FIT_TUNINGS; i++)
            if (best[i].comb > second->comb && fabs(best[i].tune / drum->tune - 1) > ANOTHER)
                *second = best[i];
    }
    *sounds = second->comb > SECOND;
    return count > 0;
}
