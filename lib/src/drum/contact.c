/// contact.c: one sample of head and sticks.
///
/// All forces are constant over a sample of length h; the head's modes answer exactly (bank.c), a
/// stick of mass M by x' = x + h v + h^2 (a - F/M)/2... as a free body does:
///     free head and sticks: d_f, x_f;  c0 = d - x before;  b = (d_f - x_f) - c0;
///     G_ij = sum_modes phi_i phi_j b1 + (i = j) h^2/(2 M_i);
///     solve r = b - G F(r) (meeting.c);  push the head by -F, the sticks by F.
///
/// The film's stretching (membrane_step.c) pulls with base - half (P . F) through its own shape,
/// which moves place i by P_i per newton: b_i loses P_i base, G_ij loses half P_i P_j (and stays
/// positive, by Cauchy and Schwarz), and the equation is the same.
///
/// Passivity. With E the energy of head, sticks and contacts, E' - E = work of the sticks' own
/// acceleration - losses of the modes - sum mu (V(c1) - V(c0)) r/h <= that work: a linear passive
/// body under constant force gains just force times displacement, and the forces' work on head and
/// sticks together is -F r. No step size restricts it.
///
/// Wood meets the head in a spike of a few samples, of which steps of 1/48000 s make 3 % less. So
/// as long as a stiff mallet is near, a sample is made of parts of 5 microseconds (the head's modes
/// are exact in any step), and the force told is their mean.
///
/// One-way: the stick meets a rigid head at rest (same law, G = h^2/(2 M) alone), which gives the
/// force of the motion F_m and the path of the stick. The head is then driven along that path by
/// F_s = k_s c^alpha, c = d - x, k_s proportional to the largest F_m so far (2012 paper, equation
/// 6). When the stick has left, F_m = 0 and F_s with it.
#include "drum/contact_pair.h"
#include "drum/strike_point.h"

#include <math.h>

// a stick near the head in this sample
typedef struct near {
    himc_stick *stick;
    spot *spot;
    double before; // displacement of the head there (m)
    double pull;   // P, what the film's pull moves there (m/N)
} near;

#define CHATTER 0.0015 // forces less than this apart are one touch (s)
#define STIFF 100.0    // a mallet of more at 1 mm is stepped in parts of a sample (N)

// a touch begins with the first force after some time without
static void count_touch(himc_stick *stick, double force, double h)
{
    if (force > 0 && stick->chatter <= 0) {
        stick->touches++;
        stick->impact = -stick->velocity;
    }
    stick->chatter = force > 0 ? CHATTER : stick->chatter - h;
}

void himc_stick_fly(himc_stick *stick, double h)
{
    count_touch(stick, 0, h);
    stick->height += h * (stick->velocity + 0.5 * h * stick->acceleration);
    stick->velocity += h * stick->acceleration;
    stick->force = 0;
    stick->peak = 0;
}

static bool within_reach(const himc_stick *stick, double h)
{
    double next = stick->height + h * (stick->velocity + 0.5 * h * stick->acceleration);
    return stick->touching || stick->height < HIMC_CONTACT_REACH || next < HIMC_CONTACT_REACH;
}

int himc_contact_clear(const himc_membrane *membrane, himc_stick *const *sticks, int count, int n)
{
    double h = 1 / himc_membrane_rate(membrane);
    for (int i = 0; i < count; i++) {
        const himc_stick *s = sticks[i];
        // lowest it can get if both velocity and acceleration were downward all the time
        double t = n * h;
        double lowest =
            s->height + t * fmin(s->velocity, 0) + 0.5 * t * t * fmin(s->acceleration, 0);
        for (; n > 0 && (s->touching || lowest < HIMC_CONTACT_REACH + 1e-6); n /= 2) {
            t = n / 2 * h;
            lowest = s->height + t * fmin(s->velocity, 0) + 0.5 * t * t * fmin(s->acceleration, 0);
        }
    }
    return n;
}

// the free body's step under `force`, constant
static void move(himc_stick *stick, double force, double h)
{
    double acceleration = stick->acceleration + force / stick->mass;
    count_touch(stick, force, h);
    stick->height += h * (stick->velocity + 0.5 * h * acceleration);
    stick->velocity += h * acceleration;
    stick->force = force;
    stick->peak = fmax(stick->peak, force);
}

// remembers the place of first touch, forgets it afterwards
static void hold(himc_stick *stick, bool touching)
{
    if (touching && !stick->touching) {
        stick->touch_x = stick->x;
        stick->touch_y = stick->y;
    }
    if (!touching)
        stick->peak = 0;
    stick->touching = touching;
}

// the stick against a head at rest: its path and F_m
static void strike_rigid(himc_stick *stick, double h)
{
    double g[1][MEETINGS] = {{0.5 * h * h / stick->mass}};
    meeting m = {.k = stick->head.stiffness,
                 .alpha = stick->head.exponent,
                 .mu = stick->head.loss,
                 .c0 = -stick->height,
                 .b = -h * (stick->velocity + 0.5 * h * stick->acceleration),
                 .guess = stick->force};
    himc_contact_pairs_solve(&m, 1, g, h);
    move(stick, m.force, h);
    hold(stick, stick->height < 0);
}

// the equation of one stick on the head; a one-way stick has moved already, along `from` to its
// height
static meeting meet(const himc_membrane *m, const near *n, double from, double h)
{
    const himc_stick *s = n->stick;
    double to = s->one_way ? s->height : from + h * (s->velocity + 0.5 * h * s->acceleration);
    double k = s->head.stiffness * (s->one_way ? s->peak / HIMC_ONE_WAY_FORCE : 1);
    if (s->one_way && s->force == 0)
        k = 0;
    return (meeting){.k = k,
                     .alpha = s->head.exponent,
                     .mu = s->head.loss,
                     .c0 = n->before - from,
                     .b = himc_strike_point_displacement(m, n->spot) - n->before - (to - from),
                     .guess = s->one_way ? 0 : s->force};
}

static void compliances(const himc_membrane *m, const near *nears, int count, double (*g)[MEETINGS],
                        double half, double h)
{
    for (int i = 0; i < count; i++) {
        const himc_stick *s = nears[i].stick;
        double yields = himc_strike_point_effect(m, nears[i].spot)->compliance;
        // a hair more for one-way sticks keeps the matrix regular when two are at one place
        double own = s->one_way ? 1e-12 * yields + 1e-30 : 0.5 * h * h / s->mass;
        double p = nears[i].pull;
        g[i][i] = yields + own - half * p * p;
        for (int j = 0; j < i; j++)
            g[i][j] = g[j][i] = himc_strike_point_compliance(m, nears[i].spot, nears[j].spot) -
                                half * p * nears[j].pull;
    }
}

// `taken` is P . F of the forces so far, and afterwards of the sticks' too
static void step_near(himc_membrane *membrane, near *nears, int count, double *taken, double h)
{
    meeting meetings[MEETINGS];
    double g[MEETINGS][MEETINGS], from[MEETINGS], half;
    double pull = himc_membrane_tension(membrane, &half) - half * *taken;
    bool apart = true;
    for (int i = 0; i < count; i++) {
        himc_stick *s = nears[i].stick;
        from[i] = s->height;
        if (s->one_way)
            strike_rigid(s, h);
        meetings[i] = meet(membrane, &nears[i], from[i], h);
        nears[i].pull = himc_strike_point_pull(membrane, nears[i].spot);
        meetings[i].b -= nears[i].pull * pull;
        apart = apart && meetings[i].c0 <= 0 && meetings[i].c0 + meetings[i].b <= 0;
    }
    if (!apart)
        compliances(membrane, nears, count, g, half, h);
    himc_contact_pairs_solve(meetings, count, g, h);
    for (int i = 0; i < count; i++) {
        himc_stick *s = nears[i].stick;
        // one-way, the head is driven along a path that does not yield: no harder than the motion
        if (s->one_way)
            meetings[i].force = fmin(meetings[i].force, s->force);
        himc_strike_point_apply(membrane, nears[i].spot, -meetings[i].force);
        *taken += nears[i].pull * meetings[i].force;
        if (!s->one_way)
            move(s, meetings[i].force, h);
    }
}

// a step of length h: a sample, or a part of one
static void step(himc_membrane *membrane, himc_stick *const *sticks, int count, double h)
{
    near nears[MEETINGS];
    int near_count = 0;
    for (int i = 0; i < count && i < MEETINGS; i++) {
        himc_stick *s = sticks[i];
        if (!within_reach(s, h)) {
            himc_stick_fly(s, h);
            continue;
        }
        double x = s->touching ? s->touch_x : s->x, y = s->touching ? s->touch_y : s->y;
        spot *place = himc_membrane_strike_point(membrane, x, y);
        double before = himc_strike_point_displacement(membrane, place);
        // a head changed since the last sample takes the sticks on it along
        if (s->touching && !s->one_way)
            s->height += before - s->dent;
        nears[near_count++] = (near){s, place, before, 0};
    }
    double taken = himc_membrane_free_step(membrane);
    if (near_count > 0)
        step_near(membrane, nears, near_count, &taken, h);
    himc_membrane_settle(membrane, taken);
    for (int i = 0; i < near_count; i++) {
        himc_stick *s = nears[i].stick;
        s->dent = himc_strike_point_displacement(membrane, nears[i].spot);
        if (!s->one_way)
            hold(s, s->dent > s->height);
    }
}

static bool any_stiff(himc_stick *const *sticks, int count, double h)
{
    for (int i = 0; i < count; i++) {
        const himc_mallet_head *head = &sticks[i]->head;
        if (within_reach(sticks[i], h) && head->stiffness * pow(0.001, head->exponent) > STIFF)
            return true;
    }
    return false;
}

void himc_contact_step(himc_membrane *membrane, himc_stick *const *sticks, int count)
{
    double h = 1 / himc_membrane_rate(membrane), mean[MEETINGS] = {0};
    count = count < MEETINGS ? count : MEETINGS;
    int parts = any_stiff(sticks, count, h) ? himc_membrane_parts(membrane) : 1;
    for (int i = 0; i < parts; i++) {
        himc_membrane_part(membrane, i, parts);
        step(membrane, sticks, count, h / parts);
        for (int k = 0; k < count; k++)
            mean[k] += sticks[k]->force / parts;
    }
    himc_membrane_part(membrane, 0, 1);
    for (int k = 0; k < count; k++)
        sticks[k]->force = mean[k];
}

double himc_contact_energy(const himc_membrane *membrane, const himc_stick *stick)
{
    double x = stick->touching ? stick->touch_x : stick->x,
           y = stick->touching ? stick->touch_y : stick->y;
    double c = stick->one_way ? -stick->height
                              : himc_membrane_displacement(membrane, x, y) - stick->height;
    return 0.5 * stick->mass * stick->velocity * stick->velocity +
           himc_contact_pair_potential(stick->head.stiffness, stick->head.exponent, c);
}
