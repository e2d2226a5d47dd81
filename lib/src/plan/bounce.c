/// bounce.c: the grip as a passive spring with a press.
///
/// After its first contact the tip is left to the fingers: y'' = -g - w^2 (y - y_r) - 2 zeta w y',
/// bounded by what fingers can do. The hand stands still, so between two contacts
///     E = y'^2 / 2 + w^2 (y - y_r)^2 / 2 + g (y - y_r)
/// (a mass of 1) only falls: the damping takes energy. The bound makes the spring weaker, which is
/// another spring, and as it is monotone the damping still acts against the velocity. w, g and y_r
/// change only at a separation, where y = y_r. The contact itself is passive (membrane.h). So no
/// impact is faster than the separation before it, over a head that is no lower by then.
///
/// Players make doubles by the stiffness of their grasp, which sets the interval (Hajian, Sanchez &
/// Howe 1997), and buzzes by pressing. A double's w is found at the first separation, from the
/// speed measured there, by bisection of the flight's time. A buzz has w = 0, and at each
/// separation, from the speed v there, the press that lets five contacts fill its time: each flight
/// is shorter than the one before by the restitution and by what the fingers' damping c takes, a
/// share 4 c v / (3 g) of the energy; with the ratio r those left last 2 v (1 - r^n) / (g (1 - r)).
/// So a head that swings does not throw the stick out of the buzz. Where fingers cannot press so
/// much the buzz has fewer contacts; none is begun that would come after its time.
#include "plan/bounce.h"

#include <math.h>

#define GRAVITY 10.9  // of a stick of 45 g about its fulcrum, at the tip (m/s^2)
#define FINGERS 169.0 // 1 N m at the fulcrum: 4 N at the tip's 23.7 g (m/s^2)
// a mallet that stays on the head; chosen: it falls back with a third of a m/s, no second blow
#define DEAD_PRESS 200.0   // 5 N at that tip (m/s^2)
#define DEAD_DAMPING 600.0 // (1/s)
#define ARM 500.0          // 12 N, of the arm behind the fingers (m/s^2)
#define RESERVE 0.85 // share of that for a planned flight; chosen: a head that swings varies it
#define GRIP_DAMPING 0.06      // zeta; chosen: a loose grip, a double keeps .7 to .8 of its speed
#define RESTITUTION 0.9        // expected of a contact; measured: .85 to .95 of soft blows
#define LEAST_RESTITUTION 0.77 // of the softest blows, on the largest drum
#define LEAST_CONTACT 0.006    // of theirs on the smallest (s)
#define CONTACT 0.0105   // of a soft blow, until it is noticed that it has ended (s); as above
#define LEAST_BUZZ 3     // contacts of a closed roll, at least ...
#define BUZZ_CONTACTS 5  // ... and of one with time enough; chosen: a full sound
#define BUZZ_KEPT 0.9    // of the speed in one of its flights; chosen: each is heard to be softer
#define FLIGHT_STEP 5e-4 // of a trial flight (s)
#define MOST_OMEGA 800.0 // of a grip that needs all of the fingers' bound (1/s)
#define BISECTIONS 16    // to 0.01 1/s
#define LATE_BUZZ 0.1    // a contact later by this share of a buzz's time is left out; chosen
#define LATE_SHARE 1.5   // what lasts so many of its times is over; chosen: a drum may be moved

/// The time of so many flights in the air, over that of the first: 1 + r + r^2 ...
static double flights_time(int flights)
{
    double r = RESTITUTION * BUZZ_KEPT;
    return (1 - pow(r, flights)) / (1 - r);
}

double himc_bounce_fastest(int bounces, double time)
{
    int flights = bounces == HIMC_BUZZ ? LEAST_BUZZ - 1 : bounces;
    double first = fmax(time - flights * CONTACT, 0) / flights_time(flights);
    return bounces == 0 || bounces == HIMC_DEAD ? HUGE_VAL
                                                : 0.5 * first * RESERVE * FINGERS / RESTITUTION;
}

double himc_bounce_longest(double speed)
{
    return LEAST_CONTACT + 2 * LEAST_RESTITUTION * speed / GRAVITY;
}

double himc_bounce_full_time(int bounces, double speed)
{
    int flights = bounces == HIMC_BUZZ ? BUZZ_CONTACTS - 1 : bounces;
    double first = 2 * RESTITUTION * speed / (RESERVE * FINGERS);
    return flights * CONTACT + first * flights_time(flights);
}

himc_bounce himc_bounce_begin(int bounces, double time, double t)
{
    return (himc_bounce){
        .on = true, .bounces = bounces, .time = time, .begin = t, .press = GRAVITY};
}

double himc_bounce_acceleration(const himc_bounce *b, double height, double velocity)
{
    double a = -b->press - b->stiffness * (height - b->rest) - b->damping * velocity;
    return fmin(fmax(a, -FINGERS), FINGERS);
}

double himc_bounce_dead(const himc_bounce *b, double t, double velocity)
{
    double left = fmin(fmax(2 * (1 - (t - b->begin) / b->time), 0), 1);
    return fmin(fmax(-left * DEAD_PRESS - DEAD_DAMPING * velocity, -ARM), 0);
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
    double left = b->begin + b->time - t;
    if (b->bounces == HIMC_DEAD)
        return;
    b->contacts++;
    b->rest = height;
    if (b->bounces != HIMC_BUZZ) {
        tune_grip(b, velocity, velocity * since, left);
        return;
    }
    // the press with which this flight and those after it fill the time that is left
    int flights = BUZZ_CONTACTS - b->contacts;
    if (flights <= 0 || !(velocity > 0))
        return;
    double air = fmax(left - (flights - 1) * CONTACT, FLIGHT_STEP);
    b->press = fmin(fmax(2 * velocity * flights_time(flights) / air, GRAVITY), FINGERS);
    b->damping = 0.75 * (1 - BUZZ_KEPT * BUZZ_KEPT) * b->press / velocity;
}

bool himc_bounce_is_over(const himc_bounce *b, double t, double velocity)
{
    double end = b->begin + b->time;
    if (b->bounces == HIMC_DEAD)
        return t > end;
    if (t > b->begin + LATE_SHARE * b->time)
        return true;
    if (b->bounces == HIMC_BUZZ)
        return velocity >= 0 && t + 2 * velocity / b->press > end + LATE_BUZZ * b->time;
    return b->contacts > b->bounces;
}
