/// bounce.c: the grip as a passive spring with a press.
///
/// After its first contact the tip is left to the fingers: y'' = -g - w^2 (y - y_r) - 2 zeta w y',
/// bounded by what fingers can do. The hand stands still, so between two contacts
///     E = y'^2 / 2 + w^2 (y - y_r)^2 / 2 + g (y - y_r)
/// (a mass of 1) only falls: the damping takes energy. The bound makes the spring weaker, which is
/// another spring, and as it is monotone the damping still acts against the velocity. w and y_r
/// change only at a separation, where w^2 (y - y_r)^2 is 0 after and not negative before; g changes
/// only at a touch, where the tip is back on the head and falls no further. The contact itself is
/// passive (membrane.h). So no impact is faster than the separation before it.
///
/// Players make doubles by the stiffness of their grasp, which sets the interval (Hajian, Sanchez &
/// Howe 1997), and buzzes by pressing. A double's w is found at the first separation, from the
/// speed measured there, by bisection of the flight's time. A buzz has w = 0 and a press that lets
/// five contacts fill its time: with a restitution e the flights fall as e^n, and their sum is
/// 2 v (1 - e^n) / (g (1 - e)).
#include "plan/bounce.h"

#include "plan/hand.h"

#define GRAVITY 10.9     // of a stick of 45 g about its fulcrum, at the tip (m/s^2)
#define FINGERS 169.0    // 1 N m at the fulcrum: 4 N at the tip's 23.7 g (m/s^2)
#define RESERVE 0.85     // share of that for a planned flight; chosen: a head that swings varies it
#define GRIP_DAMPING 0.1 // zeta; chosen: a loose grip, a double keeps .6 of its speed
#define RESTITUTION 0.9  // expected of a contact; measured: .85 to .95 of soft blows
#define LEAST_E 0.6      // of one contact on a head that swings, within these bounds; chosen: a ...
#define MOST_E 0.92      // ... head at rest has them
#define CONTACT 0.0105   // of a soft blow, until it is noticed that it has ended (s); as above
#define BUZZ_CONTACTS 5  // closed rolls have three and more; chosen: a full sound
#define FASTEST_BUZZ 2.0 // chosen: faster ones have no five contacts with any press (m/s)
#define FLIGHT_STEP 5e-4 // of a trial flight (s)
#define MOST_OMEGA 800.0 // of a grip that needs all of the fingers' bound (1/s)
#define BISECTIONS 16    // to 0.01 1/s
#define LATE_SHARE 1.5   // what lasts so many of its times is over; chosen: a drum may be moved

double himc_bounce_fastest(int bounces, double time)
{
    double e = RESTITUTION, flight = fmax(time - CONTACT, 0);
    if (bounces == 0)
        return HUGE_VAL;
    if (bounces != HIMC_BUZZ)
        return 0.5 * flight * RESERVE * FINGERS / e;
    double flights = fmax(time - (BUZZ_CONTACTS - 1) * CONTACT, 0);
    double most = 0.5 * FINGERS * flights * (1 - e) / (e * (1 - pow(e, BUZZ_CONTACTS - 1)));
    return fmin(most, FASTEST_BUZZ);
}

/// The press with which so many more flights fill the time that is left, from this impact on.
static double press_for(int flights, double left, double impact, double e)
{
    double air = fmax(left - flights * CONTACT, FLIGHT_STEP);
    double press = 2 * e * impact * (1 - pow(e, flights)) / ((1 - e) * air);
    return fmin(fmax(press, GRAVITY), FINGERS);
}

himc_bounce himc_bounce_begin(int bounces, double time, double t, double impact)
{
    himc_bounce b = {.on = true, .bounces = bounces, .time = time, .begin = t, .press = GRAVITY};
    if (bounces == HIMC_BUZZ)
        b.press = press_for(BUZZ_CONTACTS - 1, time, impact, RESTITUTION);
    b.impact = impact;
    return b;
}

void himc_bounce_touched(himc_bounce *b, double t, double impact)
{
    int flights = BUZZ_CONTACTS - 1 - b->contacts;
    double e = fmin(fmax(impact / b->impact, LEAST_E), MOST_E);
    if (b->bounces == HIMC_BUZZ && flights > 0)
        b->press = press_for(flights, b->begin + b->time - t, impact, e);
    b->impact = impact;
}

double himc_bounce_acceleration(const himc_bounce *b, double height, double velocity)
{
    double a = -b->press - b->stiffness * (height - b->rest) - b->damping * velocity;
    return fmin(fmax(a, -FINGERS), FINGERS);
}

static void set_omega(himc_bounce *b, double omega)
{
    b->stiffness = omega * omega;
    b->damping = 2 * GRIP_DAMPING * omega;
}

/// Time until a tip that leaves the height of rest at `v` is `below` it; `most` if it takes longer.
static double flight_time(const himc_bounce *b, double v, double below, double most)
{
    double y = b->rest, t = 0, before = y, bottom = b->rest - below;
    while (t < most && (y > bottom || t == 0)) {
        double a = himc_bounce_acceleration(b, y, v);
        before = y;
        y += FLIGHT_STEP * (v + 0.5 * FLIGHT_STEP * a);
        v += 0.5 * FLIGHT_STEP * (a + himc_bounce_acceleration(b, y, v + FLIGHT_STEP * a));
        t += FLIGHT_STEP;
    }
    return y > bottom ? most : t - FLIGHT_STEP * (bottom - y) / fmax(before - y, 1e-12);
}

/// The softest grip with which a flight takes no longer than `wanted`.
static void tune_grip(himc_bounce *b, double v, double below, double wanted)
{
    double low = 0, high = MOST_OMEGA, most = 2 * wanted + FLIGHT_STEP;
    set_omega(b, low);
    if (flight_time(b, v, below, most) <= wanted)
        return;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        set_omega(b, middle);
        if (flight_time(b, v, below, most) > wanted)
            low = middle;
        else
            high = middle;
    }
    set_omega(b, high);
}

void himc_bounce_separated(himc_bounce *b, double t, double since, double height, double velocity)
{
    b->contacts++;
    b->rest = height;
    if (b->bounces != HIMC_BUZZ)
        tune_grip(b, velocity, velocity * since, b->begin + b->time - t);
}

bool himc_bounce_is_over(const himc_bounce *b, double t, double velocity)
{
    double end = b->begin + b->time;
    bool full = b->contacts >= BUZZ_CONTACTS && t + 2 * velocity / b->press > end;
    if (t > b->begin + LATE_SHARE * b->time)
        return true;
    if (b->bounces == HIMC_BUZZ)
        return (t >= end || full) && velocity >= 0;
    return b->contacts > b->bounces;
}
