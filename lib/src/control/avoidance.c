/// avoidance.c: the elbows swing out, the wrists rise and turn aside where arms come too near.
///
/// With the tip held, an arm still turns about the line from shoulder to wrist, and hand and stick
/// turn about the tip, up and aside. These six angles g of both arms descend the potential
///     F(g) = sum over pairs (D - gap)+^2 / (2 D)
/// of the gaps below D, summed over the postures foreseen: dg/dt = -K dF/dg - g / T. So they are
/// constant zero while nothing is nearer than D, and the posture has the same bits as without. The
/// body follows by a motion of third order (posture.h), so accelerations have no jumps. The tips'
/// errors do not change: all of this is the null-space target. The sticks themselves are kept apart
/// by the plan.
///
/// Of two crossed arms the one that is above when they first cross stays above until they are
/// uncrossed: the gaps of crossed parts are counted along the vertical, in that order.
#include "control/avoidance.h"

#include <math.h>
#include <string.h>

#define NEAR_ARM 0.06  // D of the two arms (m); chosen: uncrossed ones are 80 mm apart and more
#define NEAR_BODY 0.02 // D of arm and body (m); chosen: usual forearms pass the trunk at 39 mm
#define FOLDED \
    0.20 // wrist from shoulder (m); chosen: nearer, a small way of the wrist swings the elbow
#define LARGEST_LACK (-0.08) // of crossed parts in the wrong order (m); chosen: all is pushed alike
#define DESCENT 20.0    // K (rad^2/(m s)); chosen: a gap of -0.1 m is opened in a tenth of a second
#define RETURN_TIME 2.0 // T (s); chosen: long, so that the goal rests 5 mm inside D
#define LEAST_GOAL 1e-3 // a smaller goal of a clear body is 0 (rad)
#define PROBE 1e-3      // of the gradient (rad)
#define LONGEST_STEP 0.012 // (s); chosen: K dt stays below 1 / |F''|
#define FASTEST 8.0        // of each angle's goal (rad/s); chosen: as fast as a wrist is turned
// limits of the three angles of an arm; chosen: what shoulders and wrists allow
static const double least[HIMC_AVOIDANCE_PARTS / HIMC_HANDS] = {-0.5, -0.4, -0.6},
                                                 most[HIMC_AVOIDANCE_PARTS / HIMC_HANDS] = {
                                                     1.5, 1.0, 1.0};

static void put(const double *angle, himc_trunk_posture *trunk)
{
    memcpy(&trunk->value[HIMC_TRUNK_POSTURE_ELBOW], angle, HIMC_AVOIDANCE_PARTS * sizeof *angle);
}

void himc_avoidance_apply(const himc_avoidance *a, himc_trunk_posture *goal)
{
    put(a->goal, goal);
}

static double cost_of(double gap, double near)
{
    double lack = fmax(near - gap, 0);
    return lack * lack / (2 * near);
}

static double foreseen_capsules(const himc_posture *posture, const himc_foreseen *f,
                                const double *angle, himc_capsule capsule[HIMC_SEGMENTS])
{
    himc_posture then = *posture;
    then.trunk_posture = f->trunk;
    put(angle, &then.trunk_posture);
    return himc_posture_capsules(&then, f->tip, capsule);
}

// true if two parts cross as seen from above; `over` is the height of the first over the second (m)
static bool crosses(const himc_capsule *p, const himc_capsule *q, double *over)
{
    himc_vec3 d = himc_vec3_sub(p->b, p->a), e = himc_vec3_sub(q->b, q->a);
    himc_vec3 r = himc_vec3_sub(q->a, p->a);
    double across = d.x * e.y - d.y * e.x;
    double s = (r.x * e.y - r.y * e.x) / across, t = (r.x * d.y - r.y * d.x) / across;
    *over = p->a.z + s * d.z - q->a.z - t * e.z;
    return s >= 0 && s <= 1 && t >= 0 && t <= 1; // false where they are parallel
}

// the order of two arms that cross beyond the elbows, 0 if they do not
static int order_of(const himc_capsule capsule[HIMC_SEGMENTS])
{
    double over;
    for (int i = HIMC_ARM_JOINTS; i < HIMC_CAPSULE_ARM_PAIRS; i++) {
        himc_capsule_pair p = himc_capsule_pairs[i];
        if (p.other > HIMC_RIGHT_UPPER_ARM && crosses(&capsule[p.part], &capsule[p.other], &over))
            return over > 0 ? 1 : -1;
    }
    return 0;
}

// the gap of two parts of the arms, counted downwards from the right order if they cross
static double arm_gap(const himc_capsule *p, const himc_capsule *q, int order)
{
    double over;
    if (order != 0 && crosses(p, q, &over))
        return fmax(order * over - p->radius - q->radius, LARGEST_LACK);
    return himc_capsule_gap(p, q);
}

static bool is_active(const himc_avoidance *a)
{
    bool active = false;
    for (int i = 0; i < HIMC_AVOIDANCE_PARTS; i++)
        active = active || a->goal[i] != 0;
    return active;
}

// F of a posture
static double potential(const himc_avoidance *a, const himc_capsule capsule[HIMC_SEGMENTS],
                        double missing)
{
    double sum = cost_of(NEAR_BODY - missing, NEAR_BODY);
    for (int hand = 0; is_active(a) && hand < HIMC_HANDS; hand++) {
        himc_vec3 shoulder = capsule[HIMC_LEFT_UPPER_ARM + hand].a;
        himc_vec3 wrist = capsule[HIMC_LEFT_HAND + hand].a;
        sum += cost_of(himc_vec3_length(himc_vec3_sub(wrist, shoulder)) - FOLDED, NEAR_ARM);
    }
    for (int i = 0; i < HIMC_CAPSULE_PAIRS; i++) {
        himc_capsule_pair pair = himc_capsule_pairs[i];
        const himc_capsule *p = &capsule[pair.part], *q = &capsule[pair.other];
        bool sticks = pair.part == HIMC_LEFT_STICK && pair.other == HIMC_RIGHT_STICK;
        if (i >= HIMC_CAPSULE_ARM_PAIRS)
            sum += cost_of(himc_capsule_gap(p, q), NEAR_BODY);
        else if (!sticks)
            sum += cost_of(arm_gap(p, q, a->order), NEAR_ARM);
    }
    return sum;
}

static void add_descent(const himc_avoidance *a, const himc_posture *posture,
                        const himc_foreseen *f, double here, double rate[HIMC_AVOIDANCE_PARTS])
{
    himc_capsule capsule[HIMC_SEGMENTS];
    double angle[HIMC_AVOIDANCE_PARTS];
    memcpy(angle, a->goal, sizeof angle);
    for (int i = 0; i < HIMC_AVOIDANCE_PARTS; i++) {
        angle[i] += PROBE;
        double missing = foreseen_capsules(posture, f, angle, capsule);
        rate[i] -= DESCENT * (potential(a, capsule, missing) - here) / PROBE;
        angle[i] = a->goal[i];
    }
}

// The order in which the arms cross at first is kept until they do not cross any more. The last
// posture has no time, so it decides nothing.
static void foresee_order(himc_avoidance *a, himc_capsule capsule[HIMC_FORESEEN][HIMC_SEGMENTS])
{
    int order = 0;
    for (int i = 0; i < HIMC_FORESEEN - 1 && order == 0; i++)
        order = order_of(capsule[i]);
    if (order == 0 || a->order == 0)
        a->order = order;
}

void himc_avoidance_update(himc_avoidance *a, const himc_posture *posture,
                           const himc_foreseen foreseen[HIMC_FORESEEN], double dt)
{
    himc_capsule capsule[HIMC_FORESEEN][HIMC_SEGMENTS];
    double rate[HIMC_AVOIDANCE_PARTS] = {0}, missing[HIMC_FORESEEN];
    dt = fmin(dt, LONGEST_STEP);
    for (int k = 0; k < HIMC_FORESEEN; k++)
        missing[k] = foreseen_capsules(posture, &foreseen[k], a->goal, capsule[k]);
    foresee_order(a, capsule);
    for (int k = 0; k < HIMC_FORESEEN; k++) {
        double here = potential(a, capsule[k], missing[k]);
        if (here > 0)
            add_descent(a, posture, &foreseen[k], here, rate);
    }
    for (int i = 0; i < HIMC_AVOIDANCE_PARTS; i++) {
        bool clear = rate[i] == 0;
        double more = fmin(fmax(rate[i], -FASTEST), FASTEST) - a->goal[i] / RETURN_TIME;
        double goal = a->goal[i] + dt * more;
        goal = fmin(fmax(goal, least[i / HIMC_HANDS]), most[i / HIMC_HANDS]);
        a->goal[i] = clear && fabs(goal) < LEAST_GOAL ? 0 : goal;
    }
}
