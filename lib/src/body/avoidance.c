/// avoidance.c: the elbows swing out, the wrists rise and turn aside where arms come too near.
///
/// With the tip held, an arm still turns about the line from shoulder to wrist, and hand and stick
/// turn about the tip, up and aside. These six angles g of both arms descend the potential
///     F(g) = sum over pairs (D - gap)+^3 / (3 D^2)
/// of the gaps below D, summed over the postures foreseen: dg/dt = -K dF/dg - g / T. Each gap below
/// D pushes on the joints beside its nearest points, along the line between these; dF/dg is the
/// work of all pushes (virtual work). So the angles are
/// constant zero while nothing is nearer than D, and the posture has the same bits as without. The
/// body follows by a motion of third order (posture.h), so accelerations have no jumps. The tips'
/// errors do not change: all of this is the null-space target. The sticks themselves are kept apart
/// by the plan.
///
/// Of two crossed arms the one that is above when they first cross stays above until they are
/// uncrossed: the gaps of crossed parts, sticks too, are counted along the vertical, in that order.
/// A raised wrist makes the shaft steep, which is as good as any other way while the stick is up,
/// but a head pushes a steep shaft with more impulse: at a touch a part of the raise is eased.
#include "body/avoidance.h"

#include <math.h>
#include <string.h>

#define NEAR_ARM 0.06 // D of the two arms (m); chosen: uncrossed ones are 80 mm apart and more
#define SEEN \
    0.1 // the arms' gaps are told below this (m); chosen: more than planner_clear.c asks for
#define NEAR_BODY 0.02 // D of arm and body (m); chosen: usual forearms pass the trunk at 39 mm
// wrist from shoulder (m), pushed apart from NEAR_ARM more; chosen: nearer, small ways of the wrist
// swing the elbow ...
#define FOLDED 0.20          // ... of arms that avoid something
#define FOLDED_FREE 0.14     // ... and of free ones, which then turn with up to 60 rad/s
#define LARGEST_LACK (-0.08) // of crossed parts in the wrong order (m); chosen: all is pushed alike
#define LEVEL 0.5            // of the vertical: parts beside each other are in no order
#define DESCENT 40.0    // K (rad^2/(m s)); chosen: a gap of -0.1 m is opened in a tenth of a second
#define RETURN_TIME 2.0 // T (s); chosen: long, so that the goal rests 5 mm inside D
#define AVOIDS 0.05     // goals up to it unfold no arm (rad); chosen: a push of 1 mm makes less
#define LEAST_GOAL 1e-3 // a smaller goal of a clear body is 0 (rad)
#define LONGEST_STEP 0.012 // (s); chosen: K dt stays below 1 / |F''|
#define FASTEST 8.0        // of each angle's goal (rad/s); chosen: as fast as a wrist is turned
#define PATH_KNOWN 0.07    // of a hand's path (s); chosen: its filter looks so far ahead
// A head pushes a shaft that is steeper by 20 degrees with a third more impulse, by 30 with twice as
// much, by 60 with nine times as much. Chosen: with less than RAISED_MOST crossed arms have no room.
#define RAISED_MOST 0.65                     // of a wrist at a touch (rad)
#define RAISED_FREE 0.03                     // ... of arms that were crossed before (rad)
#define EASE_TIME 0.2                        // (s)
#define DESCENT_WORK (1 + HIMC_ARM_ANGLES)   // postures of a descent
#define EASED (HIMC_ARM_ANGLES * HIMC_HANDS) // its part of the goal
// limits of the three angles of an arm; chosen: what shoulders and wrists allow
static const double least[HIMC_ARM_ANGLES] = {-0.5, -0.03, -0.6},
                    most[HIMC_ARM_ANGLES] = {1.5, 1.0, 1.0};

const double himc_avoidance_times[HIMC_FORESEEN] = {0.06, 0.14};

// the parts of the body that an arm may meet
static const unsigned char body_part[] = {HIMC_TRUNK, HIMC_HEAD, HIMC_LEFT_UPPER_LEG,
                                          HIMC_RIGHT_UPPER_LEG};

/// What is near in one posture: its pushes on the points of the arms, and the least gaps.
typedef struct field {
    himc_vec3 push[HIMC_HANDS][HIMC_ARM_POINTS]; // -dF/dx
    bool pushed;
    himc_clearance clear;
} field;

static void put(const double *angle, himc_trunk_posture *trunk)
{
    memcpy(&trunk->value[HIMC_TRUNK_POSTURE_ELBOW], angle, HIMC_AVOIDANCE_PARTS * sizeof *angle);
}

void himc_avoidance_apply(const himc_avoidance *a, himc_trunk_posture *goal)
{
    put(a->goal, goal);
}

static himc_posture foreseen_posture(const himc_avoidance *a, const himc_posture *posture,
                                     const himc_foreseen *f, double in)
{
    himc_posture then = *posture;
    then.trunk_posture = f->trunk;
    // a hand's path is known as far as its goal holds; later it rests where the tip has it
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_hand_path *path = &then.hand[hand];
        *path = himc_hand_path_at(path, path->time + in);
        path->moving = path->moving && in <= PATH_KNOWN;
    }
    put(a->goal, &then.trunk_posture);
    return then;
}

// true if two parts cross as seen from above; then n is the vertical
static bool crosses(const himc_capsule *p, const himc_capsule *q, himc_capsule_near *near)
{
    himc_vec3 d = himc_vec3_sub(p->b, p->a), e = himc_vec3_sub(q->b, q->a);
    himc_vec3 r = himc_vec3_sub(q->a, p->a);
    double across = d.x * e.y - d.y * e.x;
    double s = (r.x * e.y - r.y * e.x) / across, t = (r.x * d.y - r.y * d.x) / across;
    double over = p->a.z + s * d.z - q->a.z - t * e.z;
    *near = (himc_capsule_near){over, s, t, {0, 0, 1}};
    return s >= 0 && s <= 1 && t >= 0 && t <= 1; // false where they are parallel
}

// pushes a part of an arm at a share of its length; other parts do not give way
static void push(field *f, int part, double share, double size, himc_vec3 n)
{
    int k = part - HIMC_LEFT_UPPER_ARM;
    if (k < 0 || k >= HIMC_HANDS * HIMC_ARM_JOINTS)
        return;
    himc_vec3 *at = &f->push[k % HIMC_HANDS][k / HIMC_HANDS];
    at[0] = himc_vec3_madd(at[0], size * (1 - share), n);
    at[1] = himc_vec3_madd(at[1], size * share, n);
    f->pushed = true;
}

static void push_apart(field *f, himc_capsule_pair pair, const himc_capsule_near *near, double D)
{
    double size = (D - near->gap) / D;
    if (size <= 0)
        return;
    size *= size;
    push(f, pair.part, near->s, size, near->n);
    push(f, pair.other, near->t, -size, near->n);
}

static bool is_stick(int part)
{
    return part == HIMC_LEFT_STICK || part == HIMC_RIGHT_STICK;
}

static void push_pairs(field *f, const himc_capsule capsule[HIMC_SEGMENTS],
                       const himc_ball ball[HIMC_SEGMENTS], int order)
{
    for (int i = 0; i < HIMC_CAPSULE_PAIRS; i++) {
        himc_capsule_pair pair = himc_capsule_pairs[i];
        const himc_capsule *p = &capsule[pair.part], *q = &capsule[pair.other];
        bool arms = i < HIMC_CAPSULE_ARM_PAIRS,
             sticks = is_stick(pair.part) || is_stick(pair.other);
        if (himc_balls_are_far(&ball[pair.part], &ball[pair.other], arms ? SEEN : NEAR_BODY) &&
            (!arms || order == 0))
            continue;
        himc_capsule_near near = himc_capsule_nearest(p, q), crossed;
        if (!arms || !sticks)
            f->clear.body = fmin(f->clear.body, near.gap);
        else if (near.gap < f->clear.sticks) {
            f->clear.sticks = near.gap;
            f->clear.across = near.n;
            f->clear.order = fabs(near.n.z) > LEVEL ? (near.n.z > 0 ? 1 : -1) : 0;
        }
        bool both = is_stick(pair.part) && is_stick(pair.other);
        if (both && (order == 0 || !crosses(p, q, &crossed)))
            continue;
        // of crossed parts the gap is counted downwards from the right order
        if (arms && order != 0 && crosses(p, q, &crossed)) {
            crossed.gap = fmax(order * crossed.gap - p->radius - q->radius, LARGEST_LACK);
            crossed.n.z = order;
            near = crossed;
        }
        push_apart(f, pair, &near, arms ? NEAR_ARM : NEAR_BODY);
    }
}

// arms off the drums' shells, but a hand may lie on a head; sticks are the plan's
static void push_off_drums(field *f, const himc_capsule capsule[HIMC_SEGMENTS],
                           const himc_ball ball[HIMC_SEGMENTS], const himc_shells *shells)
{
    for (int i = 0; i < shells->count; i++)
        for (int part = HIMC_LEFT_FOREARM; part <= HIMC_RIGHT_HAND; part++) {
            himc_vec3 away = himc_vec3_sub(ball[part].middle, shells->head[i].center);
            double reach = shells->head[i].radius + ball[part].radius + NEAR_BODY;
            if (away.x * away.x + away.y * away.y > reach * reach || away.z > reach)
                continue;
            himc_capsule_near near = himc_capsule_shell(&capsule[part], &shells->head[i]);
            if (part >= HIMC_LEFT_HAND && near.n.z > LEVEL)
                continue;
            push_apart(f, (himc_capsule_pair){(unsigned char)part, HIMC_PELVIS}, &near, NEAR_BODY);
        }
}

// arms are not folded up, least of all those that avoid something
static void unfold(field *f, const himc_avoidance *a, const himc_capsule capsule[HIMC_SEGMENTS])
{
    bool active = false; // what unfolds an arm turns its hand aside only
    for (int i = 0; i < HIMC_HANDS * (HIMC_ARM_ANGLES - 1); i++)
        active = active || fabs(a->goal[i]) > AVOIDS;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 way =
            himc_vec3_sub(capsule[HIMC_LEFT_HAND + hand].a, capsule[HIMC_LEFT_UPPER_ARM + hand].a);
        double gap = himc_vec3_length(way) - (active ? FOLDED : FOLDED_FREE), lack = NEAR_ARM - gap;
        himc_vec3 to_tip =
            himc_vec3_sub(capsule[HIMC_LEFT_STICK + hand].b, capsule[HIMC_LEFT_UPPER_ARM + hand].a);
        f->clear.folded[hand] = hypot(to_tip.x, to_tip.y);
        if (lack > 0)
            push(f, HIMC_LEFT_HAND + hand, 0, lack / NEAR_ARM, himc_vec3_unit(way));
    }
}

static field field_of(const himc_avoidance *a, const himc_capsule capsule[HIMC_SEGMENTS],
                      const himc_shells *shells)
{
    field f = {.clear = {.sticks = INFINITY, .body = INFINITY}};
    himc_ball ball[HIMC_SEGMENTS];
    for (int i = HIMC_LEFT_UPPER_ARM; i <= HIMC_RIGHT_STICK; i++)
        ball[i] = himc_capsule_ball(&capsule[i]);
    for (size_t i = 0; i < sizeof body_part / sizeof *body_part; i++)
        ball[body_part[i]] = himc_capsule_ball(&capsule[body_part[i]]);
    unfold(&f, a, capsule);
    push_pairs(&f, capsule, ball, a->order);
    push_off_drums(&f, capsule, ball, shells);
    return f;
}

// -K dF/dg of a posture
static void add_descent(const himc_posture *then, const himc_foreseen *foreseen, const field *f,
                        double rate[HIMC_AVOIDANCE_PARTS])
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_arm_moves moves = himc_posture_arm_moves(then, (himc_hand)hand, foreseen->tip[hand]);
        for (int i = 0; i < HIMC_ARM_ANGLES; i++) {
            double work = -moves.beyond * moves.missing[i] / NEAR_BODY;
            for (int k = 0; k < HIMC_ARM_POINTS; k++)
                work += himc_vec3_dot(f->push[hand][k], moves.by[i][k]);
            rate[i * HIMC_HANDS + hand] += DESCENT * work;
            if (i == 1)
                rate[EASED + hand] -= DESCENT * work * moves.touches;
        }
    }
}

// The order in which the arms cross at first is kept until they do not cross any more. The last
// posture has no time, so it decides nothing.
static void foresee_order(himc_avoidance *a, himc_capsule capsule[HIMC_FORESEEN][HIMC_SEGMENTS])
{
    himc_capsule_near near;
    int order = 0;
    for (int k = 0; k < HIMC_FORESEEN; k++)
        for (int i = HIMC_ARM_JOINTS; i < HIMC_CAPSULE_ARM_PAIRS && order == 0; i++) {
            himc_capsule_pair p = himc_capsule_pairs[i];
            if (p.other > HIMC_RIGHT_UPPER_ARM && // beyond the elbows
                crosses(&capsule[k][p.part], &capsule[k][p.other], &near))
                order = near.gap > 0 ? 1 : -1;
        }
    if (order == 0 || a->order == 0)
        a->order = order;
}

// At a touch a wrist is raised less, by what is eased: of crossed arms by no more than is needed
// there, of arms that were crossed before soon by nearly all of it.
static void ease_touches(himc_avoidance *a, const double rate[HIMC_HANDS], double dt)
{
    const double *wrist = &a->goal[HIMC_HANDS];
    a->crossed = a->order != 0 || (a->crossed && fmax(wrist[HIMC_LEFT], wrist[HIMC_RIGHT]) > 0);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double up = wrist[hand], *eased = &a->goal[EASED + hand];
        double all = a->crossed ? fmax(up - RAISED_FREE, 0) : 0, goal = a->order == 0 ? all : 0;
        double more = (goal - *eased) / EASE_TIME + fmax(fmin(rate[hand], 0), -FASTEST);
        *eased = fmin(fmax(*eased + dt * more, fmax(up - RAISED_MOST, 0)), all);
    }
}

int himc_avoidance_update(himc_avoidance *a, const himc_posture *posture, const himc_shells *shells,
                          const himc_foreseen foreseen[HIMC_FORESEEN], double dt)
{
    himc_capsule capsule[HIMC_FORESEEN][HIMC_SEGMENTS];
    double rate[HIMC_AVOIDANCE_PARTS] = {0}, missing[HIMC_FORESEEN];
    himc_posture then;
    int work = HIMC_FORESEEN;
    for (int k = 0; k < HIMC_FORESEEN; k++) {
        then = foreseen_posture(a, posture, &foreseen[k], himc_avoidance_times[k]);
        missing[k] = himc_posture_capsules(&then, foreseen[k].tip, capsule[k]);
    }
    foresee_order(a, capsule);
    for (int k = 0; k < HIMC_FORESEEN; k++) {
        field f = field_of(a, capsule[k], shells);
        if (!f.pushed && missing[k] == 0)
            continue;
        then = foreseen_posture(a, posture, &foreseen[k], himc_avoidance_times[k]);
        add_descent(&then, &foreseen[k], &f, rate);
        work += DESCENT_WORK;
    }
    dt = fmin(dt, LONGEST_STEP);
    for (int i = 0; i < EASED; i++) {
        double more = fmin(fmax(rate[i], -FASTEST), FASTEST) - a->goal[i] / RETURN_TIME;
        double goal = a->goal[i] + dt * more;
        goal = fmin(fmax(goal, least[i / HIMC_HANDS]), most[i / HIMC_HANDS]);
        a->goal[i] = rate[i] == 0 && fabs(goal) < LEAST_GOAL ? 0 : goal;
    }
    ease_touches(a, &rate[EASED], dt);
    return work;
}

int himc_avoidance_look_ahead(himc_avoidance *a, const himc_posture *posture,
                              const himc_shells *shells, const himc_trunk_posture *now,
                              const himc_trunk_posture *goal,
                              himc_vec3 tip[HIMC_FORESEEN][HIMC_HANDS], double dt)
{
    himc_foreseen foreseen[HIMC_FORESEEN];
    for (int k = 0; k < HIMC_FORESEEN; k++) {
        memcpy(foreseen[k].tip, tip[k], sizeof foreseen[k].tip);
        foreseen[k].trunk = himc_trunk_posture_foreseen(now, goal, himc_avoidance_times[k]);
    }
    return himc_avoidance_update(a, posture, shells, foreseen, dt);
}

himc_clearance himc_avoidance_gaps(const himc_avoidance *a, const himc_posture *posture,
                                   const himc_shells *shells, const himc_vec3 tip[HIMC_HANDS])
{
    himc_capsule capsule[HIMC_SEGMENTS];
    double missing = himc_posture_capsules(posture, tip, capsule);
    field f = field_of(a, capsule, shells);
    f.clear.beyond = missing;
    return f.clear;
}
