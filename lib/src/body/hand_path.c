/// hand_path.c: a stroke has a phase. The tip's way is the score's; the hand's is a filter of it.
///
/// A player's hand leads: it is on its way up while the tip still hangs, and has come down when the
/// stick whips. So each part goes to the value G that a resting hand has with the tip's height of a
/// little later, by a critically damped filter of third order,
///     y''' = -3 w y'' - 3 w^2 y' - w^3 (y - G(z(t + 3/w + lead))),
/// whose impulse response w^3 t^2 exp(-w t)/2 is nowhere negative, has unit mass and the mean 3/w.
/// So y is never below the least G: no hand drops below the hoop, at any tempo, in any plan. `lead`
/// is the true lead, since 3/w makes up for the delay. In fast strokes the hand moves less, by
/// (1 + (2 pi f/w)^2)^(-3/2), and wrist and fingers have the rest. Value, rate and acceleration go
/// on through contacts, changes of plan and live targets, whose future is that they stay. On the
/// way up the grip goes higher by the tip's velocity times `rise`, without the delay made up for,
/// so that it begins in the contact: the tip points down until the hand slows.
///
/// The rows of nuances are chosen: what is published is that the hand leads, that louder strokes
/// come more from the arm, and that a tip lags and points down as the hand rises.
#include "body/hand_path.h"

#include <math.h>
#include <string.h>

#define RATE 70.0 // w (1/s); chosen: a stroke at 6 Hz keeps .68 of the hand's way
#define STEEP 3.7 // of the stick's elevation over the tip's height at rest (rad/m); chosen: .26 m
#define STEEPEST 1.2     // raises the stick by 45 degrees; up to this (rad)
#define FRENCH_STEEP 4.1 // of the stick's in French grip, whose fingers move it more (rad/m)
// of the grip over the mallet's centre at impact (m); chosen: the shaft passes the hoop by 12 mm
#define OVER 0.012
#define DROOP (-0.2)      // elevation of the hand at impact (rad); chosen: fingers a little lower
#define SWING 30.0        // of the elbow towards where it will hang (1/s) ...
#define FASTEST_SWING 8.0 // ... at most (rad/s); chosen: 2 m/s of the elbow's point
#define HIGHEST_RISE 0.08 // of the grip before the tip (m); chosen
// of a resting hand, as in a calm legato: share of the stick's elevation, and the elbow (rad/m)
#define RESTING_WRIST 0.53
#define RESTING_ELBOW 0.4
#define UPRIGHT 0.97 // sine of the steepest stick

// dynamics of the rows: p, f, ff of ppp = 0 to fff = 1
static const double dynamic_of[] = {2.0 / 7, 5.0 / 7, 6.0 / 7};
#define DYNAMICS ((int)(sizeof dynamic_of / sizeof *dynamic_of))

static const struct {
    double grip_lead[DYNAMICS], hand_lead[DYNAMICS]; // (s)
    double wrist[DYNAMICS], loop[DYNAMICS];          // see himc_hand_style
    double rise, elbow;                              // (s), (rad/m)
} rows[HIMC_NUANCES] = {
    [HIMC_LEGATO] = {{-0.010, -0.009, -0.008},
                     {-0.025, -0.028, -0.030},
                     {0.55, 0.52, 0.50},
                     {0.15, 0.30, 0.35},
                     0.060,
                     0.3},
    [HIMC_TENUTO] = {{-0.010, -0.008, -0.006},
                     {-0.025, -0.025, -0.025},
                     {0.50, 0.46, 0.45},
                     {0.10, 0.20, 0.25},
                     0.060,
                     0.3},
    [HIMC_ACCENT] = {{-0.005, -0.005, -0.005},
                     {-0.025, -0.025, -0.025},
                     {0.60, 0.58, 0.58},
                     {0.20, 0.35, 0.40},
                     0.060,
                     0.5},
    [HIMC_VERTICAL_ACCENT] = {{-0.008, -0.002, 0.002},
                              {-0.030, -0.030, -0.030},
                              {0.55, 0.50, 0.50},
                              {0.05, 0.09, 0.10},
                              0.045,
                              0.5},
    [HIMC_STACCATO] = {{-0.005, -0.014, -0.020},
                       {-0.020, -0.020, -0.020},
                       {0.65, 0.62, 0.60},
                       {0.05, 0.09, 0.10},
                       0.060,
                       0.1},
};

static double between(const double row[DYNAMICS], double dynamic)
{
    int i = 1;
    while (i < DYNAMICS - 1 && dynamic > dynamic_of[i])
        i++;
    double share = (dynamic - dynamic_of[i - 1]) / (dynamic_of[i] - dynamic_of[i - 1]);
    return row[i - 1] + fmin(fmax(share, 0), 1) * (row[i] - row[i - 1]);
}

himc_hand_style himc_hand_style_of(himc_nuance nuance, double dynamic)
{
    himc_nuance n = nuance < HIMC_NUANCES ? nuance : HIMC_LEGATO;
    return (himc_hand_style){.grip_lead = between(rows[n].grip_lead, dynamic),
                             .hand_lead = between(rows[n].hand_lead, dynamic),
                             .wrist = between(rows[n].wrist, dynamic),
                             .rise = rows[n].rise,
                             .loop = between(rows[n].loop, dynamic),
                             .elbow = rows[n].elbow};
}

himc_hand_style himc_hand_style_roll(void)
{
    return (himc_hand_style){.hand_lead = -0.010, .wrist = 0.6, .loop = 0.05};
}

static double elevation(double height, double french)
{
    return STEEPEST * tanh((STEEP + french * (FRENCH_STEEP - STEEP)) * height / STEEPEST);
}

static double grip_height(double height, double level, double stick, double french)
{
    return level + OVER + height - stick * sin(elevation(height, french));
}

void himc_hand_path_rest(double height, double level, double stick, double french,
                         double value[HIMC_HAND_PATH_PARTS])
{
    memset(value, 0, HIMC_HAND_PATH_PARTS * sizeof *value);
    value[HIMC_HAND_PATH_GRIP] = grip_height(height, level, stick, french);
    value[HIMC_HAND_PATH_HAND] = DROOP + RESTING_WRIST * elevation(height, french);
    value[HIMC_HAND_PATH_ELBOW] = RESTING_ELBOW * height;
}

double himc_hand_path_stick(double lower, double stick)
{
    return asin(UPRIGHT * tanh(lower / (stick * UPRIGHT)));
}

double himc_hand_path_foresight(double lead)
{
    return 3 / RATE + lead;
}

void himc_hand_path_aim(himc_hand_path *p, const himc_hand_style *style,
                        const himc_hand_ahead *ahead, double stick)
{
    double grip = fmax(ahead->grip, 0), hand = fmax(ahead->hand, 0); // a pressed tip turns nothing
    if (!p->moving)
        himc_hand_path_rest(ahead->now, ahead->level, stick, ahead->french, p->value);
    p->moving = true;
    p->goal[HIMC_HAND_PATH_GRIP] =
        grip_height(grip, ahead->level, stick, ahead->french) +
        HIGHEST_RISE * tanh(style->rise * fmax(ahead->up, 0) / HIGHEST_RISE);
    p->goal[HIMC_HAND_PATH_HAND] = DROOP + style->wrist * elevation(hand, ahead->french);
    p->goal[HIMC_HAND_PATH_LOOP] =
        style->loop * (elevation(hand, ahead->french) - elevation(grip, ahead->french));
    p->goal[HIMC_HAND_PATH_ELBOW] = style->elbow * grip;
}

void himc_hand_path_swing(himc_hand_path *p, himc_vec3 hang, double angle)
{
    double most = 3 * FASTEST_SWING / SWING;
    p->hang = hang;
    p->value[HIMC_HAND_PATH_SWING] = 0;
    p->goal[HIMC_HAND_PATH_SWING] = most * tanh(angle / most);
}

himc_hand_path himc_hand_path_at(const himc_hand_path *p, double time)
{
    // e = y - goal = (e + (v + w e) t + (a + 2 w v + w^2 e) t^2 / 2) exp(-w t)
    himc_hand_path then = *p;
    double t = time - p->time;
    then.time = time;
    for (int i = 0; p->moving && i < HIMC_HAND_PATH_PARTS; i++) {
        double w = i == HIMC_HAND_PATH_SWING ? SWING : RATE, fade = exp(-w * t);
        double e = p->value[i] - p->goal[i], b = p->rate[i] + w * e,
               c = p->acceleration[i] + 2 * w * p->rate[i] + w * w * e;
        double q = e + t * (b + 0.5 * t * c), v = b + t * c;
        then.value[i] = p->goal[i] + fade * q;
        then.rate[i] = fade * (v - w * q);
        then.acceleration[i] = fade * (c + w * (w * q - 2 * v));
    }
    return then;
}
