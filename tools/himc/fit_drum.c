/// fit_drum.c: each size of timpano, tuned as the spectrum suggests (fit_comb.c), is set beside the
/// partials found.
///
/// The air over the head makes the ratios of (1,1) .. (6,1) depend on the drum's size at a pitch:
/// a size more is 1 % of (2,1), 1.5 % of (3,1), 2 % of (4,1), and a partial is found within a
/// tenth of that. So the size whose own modes fit best is the drum's, above all those that outlast
/// the room; all of its partials tune it. What the air takes follows from both; the losses S0 and
/// S1 are the rest. A room blurs each partial, so the last 0.1 % of the tuning and the losses are
/// those at which all of the drum's pairs are likeliest together, late, in narrow bands
/// (partials_likely). A pair that rings no longer than the room is not used: the room would hold
/// it up.
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
#define LASTING 2.0     // partials that ring so much longer than the room are the drum's ...
#define EXACT 0.0015    // ... and nearer to a mode (per frequency; counts half)
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

#define USUAL_WITHIN 0.25 // chosen
#define LONGER 1.3        // a pair rings longer than the room by this, or it is not used
#define RINGING 8         // (1,1) .. (8,1); early, the last two are among others as loud
#define PAIRS (RINGING + 4)
#define FINE 40              // tunings tried either way ...
#define EARLY_STEP 0.00025   // ... per frequency, coarsely ...
#define FINE_STEP 0.0001     // ... and finely
#define TUNED_WITHIN 0.002   // by one pair in a room that outlasts it; chosen, as in our room
#define STRANGE 0.05         // part of pairs that tell something else; chosen
#define SUREST 0.03          // (ln) of a decay; chosen: beats of a pair that stay unresolved ...
#define HELD 0.2             // ... and, in a room that outlasts it, so much more
#define ALONE_STEP 0.0002    // per frequency: in such steps one pair is looked for ...
#define ALONE_TRIED 301      // ... alone, 3 % either way
#define ALONE_CLEAR 60.0     // (ln) chosen: in a room that hides it 40, else 100 and more ...
#define ALONE_GAIN 20.0      // ... and likelier there by so much ...
#define ALONE_APART 0.0029   // ... and 5 cents away
#define MISTUNED 5           // a pair of an uneven head is beside its place; tried ...
#define MISTUNED_STEP 0.0001 // ... per frequency
#define DECAYS_TRIED 49
#define TRIED_MOST (2 * FINE + 1) // of tunings and decays
#define DECAY_STEP 0.05           // (ln)
#define LOSSES_MOST 3.0           // in units of those that they begin at
#define LOSSES_STEP 0.025
#define BEGIN_LEAST 0.1     // losses begin at so much of the usual ones ...
#define BEGIN_MOST 32.0     // ... up to so much ...
#define BEGIN_STEP 1.15     // ... in such steps ...
#define BEGIN_NEAR 2.0      // ... (ln) less likely so far from the usual ones
#define BEGIN_WITHIN 0.1    // (ln) of a found decay; chosen
#define BEGIN_SURE 5.0      // (dB of partials) less, and the room hides how they ring ...
#define HIDDEN_WITHIN 0.5   // ... so that losses are as likely farther from where they begin
#define BEGIN_FAR 0.6       // (ln of S0) those are far from the usual ones
#define BEGIN_USUAL_FAR 0.6 // the usual ones, if they explain so much of what such do, or ...
#define BEGIN_USUAL 0.25    // the usual ones, if they explain so much of what the best do

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
static double weight(const partial *p, double loudest)
{
    return worth(p) * fmax(0, 1 + (p->energy - loudest) / LOUD);
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

// what of the partials that outlast the room is the drum's (dB): their frequencies are exact
static double judge_lasting(const partials_list *partials, const fit_mode *modes, int count,
                            const fit_drum *d)
{
    double score = 0;
    for (int i = 0; i < partials->count; i++) {
        const partial *p = &partials->row[i];
        double most = 0;
        for (int k = 0; k < count; k++) {
            double apart = (p->frequency / modes[k].frequency - 1) / EXACT;
            if (modes[k].m > 0 && modes[k].n <= 2)
                most = fmax(most, 1 / (1 + apart * apart));
        }
        if (p->t60 > LASTING * partials->room && p->t60 < LONGEST &&
            p->frequency > DOWN_TO * d->tune && p->frequency < FINE_UP_TO * d->tune)
            score += most * worth(p);
    }
    return score;
}

// what of the clear partials is the drum's, less what is not and what is not there (dB)
static double judge(const partials_list *partials, const fit_mode *modes, int count,
                    const fit_drum *d)
{
    double score = judge_lasting(partials, modes, count, d), loudest = strongest(partials);
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
        score += weight(p, loudest) * (most - UNEXPLAINED * (1 - most));
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

// mean decay of the pair (m,n) of the drum's modes, 0 without it; its middle and its split
static double pair_of(const fit_mode *modes, int count, int m, int n, double *frequency,
                      double *apart)
{
    double decay = 0, low = INFINITY, high = 0;
    int found = 0;
    for (int i = 0; i < count; i++)
        if (modes[i].m == m && modes[i].n == n) {
            decay += log(1000) / modes[i].t60;
            low = fmin(low, modes[i].frequency), high = fmax(high, modes[i].frequency);
            found++;
        }
    *frequency = 0.5 * (low + high), *apart = high - low;
    return found ? decay / found : 0;
}

// the pairs that ring longer than the room, with what air and one unit of losses do to them
typedef struct ringing {
    double frequency, apart, air, load, due;
} ringing;

static double lost(const fit_drum *d, double frequency)
{
    return d->constant + d->square * pow(2 * HIMC_PI * frequency, 2);
}

static int find_ringing(double room, const fit_drum *d, ringing out[PAIRS], himc_error *error)
{
    fit_mode none[FIT_MODES], one[FIT_MODES];
    fit_drum bare = *d, lossy = *d;
    int kept = 0;
    bare.constant = bare.square = lossy.square = 0;
    lossy.constant = 1;
    int count = fit_drum_modes(&bare, none, error);
    if (count == 0 || fit_drum_modes(&lossy, one, error) == 0)
        return -1;
    for (int n = 1; n <= 2; n++)
        for (int m = 1; m <= (n == 2 ? 4 : room > 0 ? RINGING : FIT_ORDERS); m++) {
            ringing r;
            r.air = pair_of(none, count, m, n, &r.frequency, &r.apart);
            r.load = pair_of(one, count, m, n, &r.frequency, &r.apart) - r.air;
            r.due = r.air + r.load * lost(d, r.frequency);
            if (r.air > 0 && log(1000) / r.due > LONGER * room)
                out[kept++] = r;
        }
    return kept;
}

// as likely, of a number known within so many steps at best, unless it is another partial's
static void blur(double *likely, int count, double steps)
{
    double sharp[TRIED_MOST], most = -INFINITY, all = 0;
    for (int k = 0; k < count; k++)
        most = fmax(most, likely[k]);
    for (int k = 0; k < count; k++)
        all += sharp[k] = exp(likely[k] - most);
    for (int k = 0; k < count; k++) {
        double sum = 0, weights = 0;
        for (int i = 0; i < count; i++) {
            double w = exp(-0.5 * pow((i - k) / steps, 2));
            sum += w * sharp[i];
            weights += w;
        }
        likely[k] = log((1 - STRANGE) * sum / weights + STRANGE * all / count);
    }
}

// adds how likely tunings `step` apart are by all pairs that outlast a room, late; room 0: by all
// pairs, early
static bool add_tunings(const partials_sound *sound, double room, double step, const fit_drum *d,
                        double sum[2 * FINE + 1], himc_error *error)
{
    ringing pair[PAIRS];
    double likely[2 * FINE + 1], shift[2 * FINE + 1];
    int count = find_ringing(room, d, pair, error);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k <= 2 * FINE; k++)
            shift[k] = step * (k - FINE) * pair[i].frequency;
        if (!partials_likely(sound, room > 0 ? PARTIALS_LATE : PARTIALS_EARLY, room,
                             pair[i].frequency, pair[i].apart, shift, 2 * FINE + 1, &pair[i].due, 1,
                             likely, error))
            return false;
        double held = room * pair[i].due / log(1000); // by the room
        blur(likely, 2 * FINE + 1, TUNED_WITHIN * (room > 0 ? held * held : 1) / step);
        for (int k = 0; k <= 2 * FINE; k++)
            sum[k] += likely[k];
    }
    return count >= 0;
}

// the tuning at which the pairs are likeliest, together: coarsely by their early sound, in which a
// room only echoes them, then finely by the late sound as well
static bool find_tuning(const partials_sound *sound, double room, fit_drum *d, himc_error *error)
{
    for (int round = 0; round < 2; round++) {
        double sum[2 * FINE + 1] = {0}, step = round == 0 ? EARLY_STEP : FINE_STEP;
        int best = FINE;
        if (!add_tunings(sound, 0, step, d, sum, error) ||
            (room > 0 && !add_tunings(sound, room, step, d, sum, error)))
            return false;
        for (int k = 0; k <= 2 * FINE; k++)
            best = sum[k] > sum[best] ? k : best;
        d->tune *= 1 + step * (best - FINE);
    }
    return true;
}

// per frequency: how far from there a pair is by itself, if that is clear; or 0
static bool place(const partials_sound *sound, double room, const ringing *r, double *apart,
                  himc_error *error)
{
    double likely[ALONE_TRIED] = {0}, shift[ALONE_TRIED];
    int middle = ALONE_TRIED / 2, best = middle;
    for (int k = 0; k < ALONE_TRIED; k++)
        shift[k] = ALONE_STEP * (k - middle) * r->frequency;
    // a short recording has nothing late: all 0
    for (int late = room > 0 ? 1 : 0; late >= 0 && likely[best] == 0; late--) {
        if (!partials_likely(sound, late ? PARTIALS_LATE : PARTIALS_EARLY, late ? room : 0,
                             r->frequency, r->apart, shift, ALONE_TRIED, &r->due, 1, likely, error))
            return false;
        for (int k = 0; k < ALONE_TRIED; k++)
            best = likely[k] > likely[best] ? k : best;
    }
    bool clear = likely[best] > ALONE_CLEAR && likely[best] > likely[middle] + ALONE_GAIN;
    *apart = clear ? ALONE_STEP * (best - middle) : 0;
    return true;
}

// The principal is what players tune. Where it is not where all pairs together say, the drum has
// not quite this one's ratios, and is tuned by it alone.
static bool tune_principal(const partials_sound *sound, double room, fit_drum *d, himc_error *error)
{
    ringing pair[PAIRS];
    double apart = 0;
    if (find_ringing(0, d, pair, error) < 1 || !place(sound, room, &pair[0], &apart, error))
        return false;
    d->strange = fabs(apart) > ALONE_APART;
    d->tune *= d->strange ? 1 + apart : 1;
    return true;
}

// the pairs that outlast the room, each where it is
static int find_placed(const partials_sound *sound, double outlast, double room, const fit_drum *d,
                       ringing pair[PAIRS], himc_error *error)
{
    int count = find_ringing(outlast, d, pair, error);
    for (int i = 0; d->strange && i < count; i++) {
        double apart;
        if (!place(sound, room, &pair[i], &apart, error))
            return -1;
        pair[i].frequency *= 1 + apart;
    }
    return count;
}

// how far the decays found near the pairs are a drum's
static double begun(const partials_list *partials, const ringing *pair, int count,
                    const fit_drum *d)
{
    double sum = 0;
    for (int i = 0; i < count; i++) {
        const ringing *r = &pair[i];
        double t60 = log(1000) / (r->air + r->load * lost(d, r->frequency));
        for (int k = 0; k < partials->count; k++) {
            const partial *p = &partials->row[k];
            if (fabs(p->frequency - r->frequency) > fmax(CLOSE * r->frequency, r->apart))
                continue;
            double part = p->t60_error / p->t60 / BEGIN_WITHIN;
            double wrong = log(p->t60 / t60) / BEGIN_WITHIN;
            sum += worth(p) / (1 + part * part) / (1 + wrong * wrong);
        }
    }
    double s0 = log(d->constant / FIT_USUAL_CONSTANT), s1 = log(d->square / FIT_USUAL_SQUARE);
    return sum * exp(-(s0 * s0 + s1 * s1) / (2 * BEGIN_NEAR * BEGIN_NEAR));
}

// the losses at which the search begins: the usual ones, unless the partials found ring otherwise
static bool begin_losses(const partials_sound *sound, const partials_list *partials, fit_drum *d,
                         himc_error *error)
{
    ringing pair[PAIRS];
    int count = find_placed(sound, 0, partials->room, d, pair, error);
    double usual = begun(partials, pair, count, d), best = 0;
    fit_drum begin = *d, tried = *d;
    for (double s0 = BEGIN_LEAST; s0 < BEGIN_MOST; s0 *= BEGIN_STEP)
        for (double s1 = BEGIN_LEAST; s1 < BEGIN_MOST; s1 *= BEGIN_STEP) {
            tried.constant = s0 * FIT_USUAL_CONSTANT, tried.square = s1 * FIT_USUAL_SQUARE;
            double here = begun(partials, pair, count, &tried);
            if (here > best)
                best = here, begin = tried;
        }
    bool sure = best > BEGIN_SURE;
    bool far = sure && fabs(log(begin.constant / FIT_USUAL_CONSTANT)) > BEGIN_FAR;
    if (usual < (far ? BEGIN_USUAL_FAR : BEGIN_USUAL) * best) {
        *d = begin;
        d->hidden = !sure;
    }
    return count > 0;
}

// S0 and S1, in units of those they begin at, at which the decays of those pairs are likeliest;
// drawn to these as if each were known within a part of itself. `outlast` 0: by the early sound.
static bool find_losses(const partials_sound *sound, double room, double outlast, fit_drum *d,
                        himc_error *error)
{
    ringing pair[PAIRS];
    double likely[PAIRS][DECAYS_TRIED], decay[DECAYS_TRIED], best = -INFINITY, at[2] = {1, 1};
    double each[MISTUNED][DECAYS_TRIED], shift[MISTUNED];
    double within = outlast > 0 || room == 0 ? USUAL_WITHIN : HIDDEN_WITHIN;
    int count = find_placed(sound, outlast, room, d, pair, error);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < DECAYS_TRIED; k++)
            decay[k] = pair[i].due * exp(DECAY_STEP * (k - DECAYS_TRIED / 2));
        for (int j = 0; j < MISTUNED; j++)
            shift[j] = MISTUNED_STEP * (j - MISTUNED / 2) * pair[i].frequency;
        if (!partials_likely(sound, outlast > 0 ? PARTIALS_LAST : PARTIALS_EARLY, outlast,
                             pair[i].frequency, pair[i].apart, shift, MISTUNED, decay, DECAYS_TRIED,
                             each[0], error))
            return false;
        for (int k = 0; k < DECAYS_TRIED; k++) {
            likely[i][k] = -INFINITY;
            for (int j = 0; j < MISTUNED; j++)
                likely[i][k] = fmax(likely[i][k], each[j][k]);
        }
        double held = outlast * pair[i].due / log(1000); // by the room
        blur(likely[i], DECAYS_TRIED, (SUREST + HELD * held * held) / DECAY_STEP);
    }
    for (double s0 = 0; s0 < LOSSES_MOST; s0 += LOSSES_STEP)
        for (double s1 = 0; s1 < LOSSES_MOST; s1 += LOSSES_STEP) {
            double sum = -0.5 * (pow((s0 - 1) / within, 2) + pow((s1 - 1) / within, 2));
            for (int i = 0; i < count; i++) {
                double due =
                    pair[i].air + pair[i].load * lost(&(fit_drum){.constant = s0 * d->constant,
                                                                  .square = s1 * d->square},
                                                      pair[i].frequency);
                double k = log(due / pair[i].due) / DECAY_STEP + DECAYS_TRIED / 2;
                int low = (int)fmin(fmax(k, 0), DECAYS_TRIED - 2);
                sum += likely[i][low] + (k - low) * (likely[i][low + 1] - likely[i][low]);
            }
            if (sum > best)
                best = sum, at[0] = s0, at[1] = s1;
        }
    d->constant *= at[0];
    d->square *= at[1];
    return count >= 0;
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
    double weights[PARTIALS_MOST], loudest = strongest(partials);
    for (int i = 0; i < partials->count; i++)
        weights[i] = weight(&partials->row[i], loudest);
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
    for (int i = 0; i < count; i++) {
        fit_drum *d = &choice[i];
        double room = partials->room;
        fit_mode modes[FIT_MODES];
        if (!find_tuning(sound, room, d, error) || !tune_principal(sound, room, d, error) ||
            !begin_losses(sound, partials, d, error) ||
            !find_losses(sound, room, d->hidden ? 0 : room, d, error))
            return 0;
        int found = fit_drum_modes(d, modes, error);
        if (found == 0)
            return 0;
        assign(partials, modes, found, d);
    }
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
