/// human.c: a player's variation, from published statistics of drummers and of tapping.
///
/// Time is Wing & Kristofferson's (1973): a clock that both hands share gives intervals C_j, each
/// hand's motor system adds a delay D_j, so an interval is C_j + D_j - D_{j-1} and neighbours are
/// anticorrelated: lag 1 of -s_D^2/(s_C^2 + 2 s_D^2). The clock also drifts like 1/f (Hennig et
/// al. 2011), and each stroke corrects a share of the last error, so the player stays with the
/// written tempo (Vorberg & Wing 1996; Repp 2005). With t_j the written time,
///
///     late_j = K_j + D_j + bias of the hand
///     K_j = K_{j-1} - alpha (K_{j-1} + D_{j-1}) + C_j + F_j
///
/// Force has white noise with a small anticorrelation between the hands, and drift (Räsänen et al.
/// 2015); the place scatters about each hand's own point.
///
/// There is no state. Each random number is a hash of the seed, of what it is for and of the beat,
/// and K_j is summed over the last HISTORY beats anew, since (1 - alpha)^HISTORY forgets the rest.
/// So it does not matter in which order strokes are planned, how often, or from where on.
/// Invariant: every number is bounded, nearly normal and within 3 standard deviations.
#include "plan/human.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

#define HISTORY 64 // chosen: (1 - alpha)^64 = 0.001

// time; standard deviations at amount 1. Chosen within what is published: experts tap with 10 to 15
// ms about a metronome, motor delays do not depend on the interval and the clock's error grows with
// it (Doumas & Wing 2007); means of hands differ by some ms (Fujii et al. 2011)
#define CLOCK_SHARE 0.02     // of the interval
#define ROLL_SHARE 0.03      // ... in a roll, whose intervals are shorter than
#define ROLL_INTERVAL 0.13   // this (s)
#define LONGEST_INTERVAL 1.0 // longer ones are subdivided (s)
#define MOTOR_DELAY 0.004    // (s)
#define CLOCK_DRIFT 0.002    // (s); below the motor delay, else neighbours are not anticorrelated
#define HAND_BIAS 0.003      // largest (s)
#define CORRECTION 0.1       // alpha of a player without a leader
#define MOST_OF_GAP 0.2      // chosen: no stroke moves by more of the time to its neighbours
#define TOGETHER 0.05        // chosen: so near in time both mallets are low (s)

// force, place, angle; chosen: captured timpani strokes of all hands and spots together vary by 13
// to 24 % in speed, an upper bound; place and angle of real strokes have not been published
#define SPEED_WHITE 0.08        // of the impact speed, log-normal
#define SPEED_DRIFT 0.04        // (the same)
#define SPEED_ALTERNATION 0.101 // weight of the other hand's stroke before: lag 1 of -0.1
#define PLACE_OUTWARDS 0.009    // (m)
#define PLACE_ASIDE 0.006       // (m)
#define PLACE_OF_HAND 0.015     // distance of a hand's own point from the written one (m)
#define SWING_TURN 0.09         // (rad)

// drift: 1/f^0.9 as a sum of noises that are renewed with periods of 1/4 to 32 beats, a phrase
#define SHORTEST_PERIOD 0.25 // (beats)
#define OCTAVES 8
#define OCTAVE_WEIGHT 0.96593633 // 2^-0.05: power per octave falls with the period to the 0.1

#define HITS_A_BEAT 4 // chosen: of a player without a score, for the drift

/// What a random number is for.
enum {
    CLOCK,
    MOTOR,
    BIAS,
    SPEED,
    OUTWARDS,
    ASIDE,
    DIRECTION,
    TURN,
    HIT, ///< added for hits
    CLOCK_OCTAVE = 32,
    SPEED_OCTAVE = 48,
};

/// 64 random bits for a stream, a hand and a place in it.
static uint64_t bits_of(const himc_human *human, int stream, int hand, double at)
{
    uint64_t state = human->seed, place;
    memcpy(&place, &at, sizeof place);
    state = himc_random_bits(&state) ^ (uint64_t)(stream * HIMC_HANDS + hand);
    state = himc_random_bits(&state) ^ place;
    return himc_random_bits(&state);
}

/// A uniform number, 0 .. 1.
static double share(const himc_human *human, int stream, int hand)
{
    return (double)(bits_of(human, stream, hand, 0) >> 11) * 0x1p-53;
}

/// A nearly normal number, standard deviation 1, within 3: the sum of three uniform ones.
static double normal(const himc_human *human, int stream, int hand, double at)
{
    const uint64_t most = 0x1fffff;
    uint64_t bits = bits_of(human, stream, hand, at);
    uint64_t sum = (bits & most) + (bits >> 21 & most) + (bits >> 42 & most);
    return 2.0 * (double)sum / (double)most - 3;
}

/// 1/f noise, standard deviation 1, as Voss makes it: octaves of held noise. Each keeps the cell
/// that it was last read in.
typedef struct drift {
    int stream;
    double size;           // of the sum
    double begin[OCTAVES]; // of the cells, in cells
    double cell[OCTAVES], held[OCTAVES];
} drift;

static drift drift_of(const himc_human *human, int stream)
{
    drift d = {.stream = stream};
    double power = 0, weight = 1;
    for (int i = 0; i < OCTAVES; i++, weight *= OCTAVE_WEIGHT) {
        d.begin[i] = share(human, stream + i, 0);
        d.cell[i] = NAN;
        power += weight * weight;
    }
    d.size = sqrt(power);
    return d;
}

static double drift_at(const himc_human *human, drift *d, double beat)
{
    double sum = 0, weight = 1, cells = 1 / SHORTEST_PERIOD;
    for (int i = 0; i < OCTAVES; i++, cells *= 0.5, weight *= OCTAVE_WEIGHT) {
        double at = beat * cells + d->begin[i];
        if (!(at >= d->cell[i] && at < d->cell[i] + 1)) {
            d->cell[i] = floor(at);
            d->held[i] = normal(human, d->stream + i, 0, d->cell[i]);
        }
        sum += weight * d->held[i];
    }
    return sum / d->size;
}

/// The clock's error K at the last of `count` onsets, newest first (s at amount 1); a beat takes
/// `period` (s).
static double clock_error(const himc_human *human, const planner_onset *onset, int count,
                          double period)
{
    drift slow = drift_of(human, CLOCK_OCTAVE);
    double error = 0;
    for (int i = count - 2; i >= 0; i--) {
        double interval = fmin((onset[i].beat - onset[i + 1].beat) * period, LONGEST_INTERVAL);
        double sd = interval * (interval < ROLL_INTERVAL ? ROLL_SHARE : CLOCK_SHARE);
        double delays = 0; // of the hands that struck on the beat before
        int hands = 0;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            if (onset[i + 1].strikes[hand]) {
                delays += MOTOR_DELAY * normal(human, MOTOR, hand, onset[i + 1].beat);
                hands++;
            }
        error -= CORRECTION * (error + delays / hands);
        error += sd * normal(human, CLOCK, 0, onset[i].beat);
        error += CLOCK_DRIFT * drift_at(human, &slow, onset[i].beat);
    }
    return error;
}

/// The log of the speed's factor: the stroke's own noise, less a share of the other hand's before.
static double log_speed(const himc_human *human, int hand, double beat, const planner_onset *before)
{
    drift slow = drift_of(human, SPEED_OCTAVE);
    double noise = normal(human, SPEED, hand, beat), weight = 0;
    int other = HIMC_HANDS - 1 - hand;
    if (before && before->strikes[other] && !before->strikes[hand]) {
        weight = SPEED_ALTERNATION;
        noise -= weight * normal(human, SPEED, other, before->beat);
    }
    return human->amount * (SPEED_WHITE * noise / sqrt(1 + weight * weight) +
                            SPEED_DRIFT * drift_at(human, &slow, beat));
}

/// All but time and speed. `kind`: 0 or HIT.
static himc_variation place_of(const himc_human *human, himc_hand hand, int kind, double at)
{
    double amount = human->amount, direction = 2 * HIMC_PI * share(human, DIRECTION, hand);
    return (himc_variation){.outwards =
                                amount * PLACE_OUTWARDS * normal(human, kind + OUTWARDS, hand, at),
                            .aside = amount * PLACE_ASIDE * normal(human, kind + ASIDE, hand, at),
                            .hand_x = amount * PLACE_OF_HAND * cos(direction),
                            .hand_y = amount * PLACE_OF_HAND * sin(direction),
                            .turn = amount * SWING_TURN * normal(human, kind + TURN, hand, at)};
}

himc_variation himc_human_stroke(const himc_human *human, const planner_score *score,
                                 himc_hand hand, int round, double beat)
{
    planner_walk walk = himc_planner_score_walk(score, round, beat);
    double at = himc_planner_score_total_beat(score, round, beat);
    planner_onset onset[HISTORY];
    int count = 1;
    onset[0] = (planner_onset){.beat = at};
    onset[0].strikes[hand] = true;
    // the stroke's own beat, then the beats before it; the score may no longer have a planned
    // stroke, or have it later: a change of tempo moves the strokes of a roll
    while (count < HISTORY && himc_planner_score_back(score, &walk, &onset[count]))
        if (onset[count].beat < at)
            count++;
        else
            for (int h = 0; h < HIMC_HANDS; h++)
                onset[0].strikes[h] |= onset[count].strikes[h];
    himc_variation v = place_of(human, hand, 0, at);
    v.log_speed = log_speed(human, hand, at, count > 1 ? &onset[1] : NULL);
    double late = clock_error(human, onset, count, himc_planner_score_period(score, beat)) +
                  MOTOR_DELAY * normal(human, MOTOR, hand, at) +
                  HAND_BIAS * (2 * share(human, BIAS, hand) - 1);
    double most = MOST_OF_GAP * himc_planner_score_gap(score, hand, round, beat);
    v.late = fmax(fmin(human->amount * late, most), -most);
    himc_hand other = (himc_hand)(HIMC_HANDS - 1 - hand);
    v.together =
        onset[0].strikes[other] || himc_planner_score_gap(score, other, round, beat) < TOGETHER;
    return v;
}

himc_variation himc_human_hit(const himc_human *human, himc_hand hand, int count)
{
    double at = (double)count / HITS_A_BEAT;
    drift slow = drift_of(human, SPEED_OCTAVE);
    himc_variation v = place_of(human, hand, HIT, at);
    v.log_speed = human->amount * (SPEED_WHITE * normal(human, HIT + SPEED, hand, at) +
                                   SPEED_DRIFT * drift_at(human, &slow, at));
    v.late = human->amount * MOTOR_DELAY * fabs(normal(human, HIT + MOTOR, hand, at));
    v.together = true;
    return v;
}

void himc_variation_place(const himc_variation *v, himc_hand hand, double *x, double *y)
{
    double r = hypot(*x, *y), out_x = r > 0 ? *x / r : -1, out_y = r > 0 ? *y / r : 0;
    double dx = v->hand_x + v->outwards * out_x - v->aside * out_y,
           dy = v->hand_y + v->outwards * out_y + v->aside * out_x;
    if (v->together) // left is towards +y
        dy = hand == HIMC_LEFT ? fmax(dy, 0) : fmin(dy, 0);
    *x += dx;
    *y += dy;
}
