/// contact.c: one sample of head and sticks.
///
/// One pair. Over a step of length h the compression goes from c0 to c0 + r and the force F(r) is
/// constant (felt.c). Its elastic part does exactly the work V(c0 + r) - V(c0), the rest only takes
/// energy, and F does not decrease with r. The bodies respond linearly: r = b - G F(r). So the
/// residual r - b + G F(r) of one pair rises with slope >= 1 and has one root, at most b; Newton's
/// steps find it, kept between the places known to be below and above. (Discrete gradient:
/// Chatziioannou & van Walstijn 2015; Bilbao, Torin & Chatziioannou 2015.)
///
/// Several pairs on one head. The residual is G times the gradient of the strictly convex
///     Psi(r) = (r - b)' G^-1 (r - b)/2 + sum_i int F_i dr_i,
/// so Newton's direction descends and a line search on Psi's slope makes it converge from anywhere.
///
/// The sample. All forces are constant over a step; the head's modes respond exactly (bank.c), a
/// stick of mass M as a free body:
///     free head and sticks: d_f, x_f;  c0 = d - x before;  b = (d_f - x_f) - c0;
///     G_ij = sum_modes phi_i phi_j b1 + (i = j) (C_res (1 - a11) + h^2/(2 M_i));
///     solve r = b - G F(r);  push the head by -F, the sticks by F.
/// The film's stretching acts between two steps (bank_film.c), so it is not in these equations.
///
/// The size. phi is a mode's mean over the patch that the mallet covers, and d has one silent
/// oscillator more for each stick, which yields as the modes do that the list lacks (patch.c). The
/// patch's radius is found while a stick comes down onto the head and holds for the blow; the
/// oscillator begins at rest. Then neither changes what is stored, as V = 0.
///
/// Passivity. With E the energy of head, sticks, contacts and their oscillators, E' - E = work of
/// the sticks' own acceleration - losses of the modes - losses of the felt <= that work: a linear
/// passive body under constant force gains just force times displacement, and the forces' work on
/// head and sticks together is -F r. No step size restricts it.
///
/// A stiff mallet meets a point of the head in a spike of a few samples, of which steps of 1/48000
/// s make 3 % less. So while one is near, a sample is divided into substeps of 5 microseconds (the
/// head's modes are exact in any step), and the sample's force is their mean. A patch is heavier
/// than a point and yields more: felt on it needs no substeps, and wood without them is 0.2 % off.
///
/// Between two samples anything may move head or stick: a change of the head, a step of the body, a
/// drum put elsewhere. The compression does not grow by it, and a stick in the air gets to the
/// surface at most (step). So a change, which gives the head no energy (membrane.c),
/// gives the contact none either. A blow ends when the stick is clear of the head (is_clear): its
/// patch and what the patch's oscillator holds are dropped, which only takes energy.
///
/// One-way: the stick meets a rigid head at rest (same law, G = h^2/(2 M) alone), which gives the
/// force of the motion F_m and the path of the stick. The head is then driven along that path by
/// F_s = k_s c^alpha, c = d - x, k_s proportional to the largest F_m so far (2012 paper, equation
/// 6). When the stick has left, F_m = 0 and F_s with it.
#include "drum/contact.h"
#include "drum/felt.h"
#include "drum/membrane_state.h"
#include "drum/strike_point.h"

#include <math.h>
#include <string.h>

#define MAX_PAIRS (2 * HIMC_STICKS)
#define NEWTON_STEPS 60       // chosen: bisection alone converges in them
#define LINE_STEPS 30         // halvings of a line search; chosen
#define NEAR_ROOT 1e-9        // relative; a step of Newton's so short ends within the square of it
#define PUSH_ROUNDING 1.6e-15 // relative, a pair; chosen: with less the search ends in rounding
#define WIRE_TURNS 8          // most of sticks and wires in a step; chosen: 2 are usual
#define CHATTER 0.0015        // (s) forces less than this apart are one contact; chosen
#define STIFF_POINT 100.0     // (N) at 1 mm, from which substeps are needed; medium has 4, hard 240
#define STIFF_PATCH 5e3       // the same for a mallet that has a patch; wood has 9487
// a stick in the air; chosen: a head is seldom steeper, and a push of 100 N on another place of it
// moves it less in a sample
#define WATCHED 0.001       // (m) it looks at the head from a place so near to its own ...
#define STEEPEST 0.3        // ... which may be so much higher per distance ...
#define PUSHED 1e-4         // (m) ... and by this after another stick's push,
#define FASTEST_HEAD 30.0   // (m/s) and the head rises no faster
#define CLOSE 0.001         // (m) nearer than this and two steps, a stick's patch is found; chosen
#define SAME_PATCH 0.005    // relative; chosen: less than the formula of the radius is worth
#define REACH_ROUNDING 1e-6 // (m) allowance in an estimate of future heights
#define HEIGHT_ROUNDING 1e-12 // (m) of a height that is computed again by the caller
#define REGULAR 1e-12         // of a compliance, added for a one-way stick, ...
#define REGULAR_LEAST 1e-30   // ... (m/N) at least: so G is regular with two sticks at one point

// the pair of a stick's head and the drumhead during one step
typedef struct contact_pair {
    const himc_mallet_head *head;
    double scale; // of its forces
    double c0;    // compression before (m, negative: a gap)
    double b;     // change without force (m)
    double guess; // of the force (N)
    double force; // result (N)
    felt felt;    // at c0, set by the solver
} contact_pair;

// a stick near the head in this sample
typedef struct near_stick {
    himc_stick *stick;
    strike_point *point;
    double before; // displacement of the head there (m)
    himc_residual_step residual;
} near_stick;

static void solve_one(contact_pair *m, double g, double h)
{
    double slope, high = m->b, low = -INFINITY, r = fmin(m->b - g * m->guess, high);
    for (int i = 0; i < NEWTON_STEPS; i++) {
        m->force = himc_felt_force(&m->felt, r, h, &slope);
        double residual = r - m->b + g * m->force;
        if (residual > 0)
            high = r;
        else
            low = r;
        double next = r - residual / (1 + g * slope);
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        if (fabs(next - r) <= NEAR_ROOT * (fabs(r) + fabs(m->c0))) {
            m->force += slope * (next - r);
            return;
        }
        r = next;
    }
}

// A x = y by elimination with the largest pivot; A and y are used up
static void eliminate(double (*a)[MAX_PAIRS], double *y, int n)
{
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[best][k]))
                best = i;
        for (int j = k; j < n; j++) {
            double t = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = t;
        }
        double t = y[k];
        y[k] = y[best];
        y[best] = t;
        for (int i = k + 1; i < n; i++) {
            double f = a[i][k] / a[k][k];
            for (int j = k; j < n; j++)
                a[i][j] -= f * a[k][j];
            y[i] -= f * y[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++)
            y[k] -= a[k][j] * y[j];
        y[k] /= a[k][k];
    }
}

// the state of the search: forces, their slopes and the residual at r
typedef struct search {
    const contact_pair *m;
    double (*g)[MAX_PAIRS];
    int n;
    double h;
    double r[MAX_PAIRS], force[MAX_PAIRS], slope[MAX_PAIRS], residual[MAX_PAIRS];
} search;

// forces and residuals at r; true if every residual is rounding
static bool evaluate(search *s)
{
    bool done = true;
    for (int i = 0; i < s->n; i++)
        s->force[i] = himc_felt_force(&s->m[i].felt, s->r[i], s->h, &s->slope[i]);
    for (int i = 0; i < s->n; i++) {
        double pushed = 0;
        for (int j = 0; j < s->n; j++)
            pushed += s->g[i][j] * s->force[j];
        s->residual[i] = s->r[i] - s->m[i].b + pushed;
        double size = fabs(s->r[i]) + fabs(s->m[i].b) + fabs(s->m[i].c0) + fabs(pushed);
        done = done && fabs(s->residual[i]) <= s->n * PUSH_ROUNDING * size;
    }
    return done;
}

// slope of Psi along `step`, with dual = G^-1 step
static double descent(const search *s, const double *dual)
{
    double sum = 0;
    for (int i = 0; i < s->n; i++)
        sum += dual[i] * s->residual[i];
    return sum;
}

// Goes along `step` until Psi's slope has fallen, nearly always all the way. True at the solution,
// and where no part of the step lowers the slope: what remains is rounding.
static bool line_search(search *s, const double *step)
{
    double a[MAX_PAIRS][MAX_PAIRS], dual[MAX_PAIRS], from[MAX_PAIRS];
    memcpy(a, s->g, sizeof(double) * MAX_PAIRS * (size_t)s->n);
    memcpy(dual, step, sizeof(double) * (size_t)s->n);
    memcpy(from, s->r, sizeof from);
    eliminate(a, dual, s->n);
    double start = fabs(descent(s, dual)), low = 0, high = 1, t = 1;
    for (int i = 0; i < LINE_STEPS; i++) {
        for (int k = 0; k < s->n; k++)
            s->r[k] = from[k] + t * step[k];
        if (evaluate(s))
            return true;
        double now = descent(s, dual);
        if (!(fabs(now) > 0.9 * start))
            return false;
        if (now > 0)
            high = t;
        else
            low = t;
        t = 0.5 * (low + high);
    }
    return true;
}

static void solve_together(contact_pair *pairs, int n, double (*g)[MAX_PAIRS], double h)
{
    search s = {.m = pairs, .g = g, .n = n, .h = h};
    for (int i = 0; i < n; i++) {
        s.r[i] = pairs[i].b;
        for (int j = 0; j < n; j++)
            s.r[i] -= g[i][j] * pairs[j].guess;
    }
    bool done = evaluate(&s);
    for (int k = 0; k < NEWTON_STEPS && !done; k++) {
        // Newton's direction from here: (1 + G D) step = -residual
        double a[MAX_PAIRS][MAX_PAIRS], step[MAX_PAIRS];
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++)
                a[i][j] = (i == j) + g[i][j] * s.slope[j];
            step[i] = -s.residual[i];
        }
        eliminate(a, step, n);
        done = line_search(&s, step);
    }
    for (int i = 0; i < n; i++)
        pairs[i].force = s.force[i];
}

// Solves r_i = b_i - sum_j G_ij F_j(r_j); G (count x count) in m/N, symmetric positive.
static void solve_pairs(contact_pair *pairs, int count, double (*g)[MAX_PAIRS], double h)
{
    bool apart = true;
    for (int i = 0; i < count; i++) {
        contact_pair *m = &pairs[i];
        m->force = 0;
        apart = apart && m->c0 <= 0 && m->c0 + m->b <= 0;
    }
    if (apart)
        return;
    for (int i = 0; i < count; i++)
        pairs[i].felt = himc_felt_at(pairs[i].head, pairs[i].scale, pairs[i].c0);
    if (count == 1)
        solve_one(pairs, g[0][0], h);
    else
        solve_together(pairs, count, g, h);
    for (int i = 0; i < count; i++)
        if (!isfinite(pairs[i].force))
            pairs[i].force = 0;
}

// a contact begins with the first force after some time without
static void count_contact(himc_stick *stick, double force, double h)
{
    if (force > 0 && stick->chatter <= 0) {
        stick->contacts++;
        stick->impact = -stick->velocity;
    }
    stick->chatter = force > 0 ? CHATTER : stick->chatter - h;
}

void himc_stick_fly(himc_stick *stick, double h)
{
    count_contact(stick, 0, h);
    stick->height += h * (stick->velocity + 0.5 * h * stick->acceleration);
    stick->velocity += h * stick->acceleration;
    stick->force = 0;
    stick->peak = 0;
    stick->patch = stick->residual_x = stick->residual_y = 0; // no blow lasts so long
}

static bool within_reach(const himc_stick *stick, double h)
{
    double next = stick->height + h * (stick->velocity + 0.5 * h * stick->acceleration);
    return stick->touching || stick->height < HIMC_CONTACT_REACH || next < HIMC_CONTACT_REACH;
}

static bool is_stiff(const himc_mallet_head *head)
{
    double stiff = head->radius > 0 ? STIFF_PATCH : STIFF_POINT;
    double most = head->exponent >= 2 ? 1e-6 : 1; // a bound of the power, which takes long
    return head->stiffness * most > stiff && head->stiffness * pow(0.001, head->exponent) > stiff;
}

// Whether in the coming n samples a stick certainly is in the air, over a head that may be `pushed`
// in them. The substeps of a stiff one change the last digits of the head, so their beginning must
// not hang on an estimate.
static bool is_clear(himc_membrane *membrane, himc_stick *s, int n, double h, bool pushed)
{
    himc_bank_bounds head = {INFINITY, INFINITY};
    // at most: the stick's velocity and acceleration are downward all the time
    double t = n * h, down = fmax(-s->velocity, 0), faster = fmax(-s->acceleration, 0);
    double lowest = s->height - t * (down + 0.5 * t * faster) - REACH_ROUNDING;
    double near = 2 * h * (down + t * faster) + PUSHED;
    if (s->touching || lowest >= HIMC_CONTACT_REACH)
        return !s->touching;
    if (!pushed)
        head = himc_membrane_bounds(membrane);
    double over = near + head.swing;
    double moves = near + STEEPEST * WATCHED + t * fmin(head.speed, FASTEST_HEAD);
    if (!(lowest > fmin(over, moves)) || is_stiff(&s->head))
        return false;
    if (lowest > over)
        return true;
    // The head near the stick, at a place that is kept while the stick is near it: most places on
    // its way are not worth the shapes of all modes.
    double x = s->x - s->watched_x, y = s->y - s->watched_y;
    if (!(x * x + y * y < WATCHED * WATCHED)) {
        s->watched_x = s->x;
        s->watched_y = s->y;
    }
    strike_point *watched = himc_membrane_strike_point(membrane, s->watched_x, s->watched_y, 0);
    return lowest > moves + himc_strike_point_displacement(membrane, watched);
}

int himc_contact_clear(himc_membrane *membrane, himc_stick *const *sticks, int count, int n)
{
    double h = 1 / himc_membrane_rate(membrane);
    if (membrane->wires.awake)
        return 0;
    for (int i = 0; i < count; i++)
        if (sticks[i]->touching)
            return 0;
    for (int i = 0; i < count; i++)
        while (n > 0 && !is_clear(membrane, sticks[i], n, h, false))
            n /= 2;
    return n;
}

// the step of a free body under a constant force
static void move(himc_stick *stick, double force, double h)
{
    double acceleration = stick->acceleration + force / stick->mass;
    count_contact(stick, force, h);
    stick->height += h * (stick->velocity + 0.5 * h * acceleration);
    stick->velocity += h * acceleration;
    stick->force = force;
    stick->peak = fmax(stick->peak, force);
}

// keeps the point of first contact while the contact lasts
static void hold_point(himc_stick *stick, bool touching)
{
    if (touching && !stick->touching) {
        stick->contact_x = stick->x;
        stick->contact_y = stick->y;
    }
    if (!touching)
        stick->peak = 0;
    stick->touching = touching;
}

// a step of a one-way stick on a head at rest: its path and F_m
static void strike_rigid(himc_stick *stick, double h)
{
    double g[1][MAX_PAIRS] = {{0.5 * h * h / stick->mass}};
    contact_pair m = {.head = &stick->head,
                      .scale = 1,
                      .c0 = -stick->height,
                      .b = -h * (stick->velocity + 0.5 * h * stick->acceleration),
                      .guess = stick->force};
    solve_pairs(&m, 1, g, h);
    move(stick, m.force, h);
    hold_point(stick, stick->height < 0);
}

// displacement of the head under a stick, with what its residual oscillator adds
static double displacement(const himc_membrane *m, const himc_stick *s, strike_point *point)
{
    return himc_strike_point_displacement(m, point) + s->residual_root * s->residual_x;
}

// a step of a stick's residual oscillator without force
static void swing(const near_stick *n)
{
    const himc_residual_step *r = &n->residual;
    himc_stick *s = n->stick;
    double x = s->residual_x;
    s->residual_x = r->stay * x + r->turn * s->residual_y;
    s->residual_y = r->back * s->residual_y - r->turn * x;
}

// The pair of one stick and the head. A one-way stick has moved already, from `from` to its height.
static contact_pair make_pair(const himc_membrane *m, const near_stick *n, double from, double h)
{
    const himc_stick *s = n->stick;
    double to = s->one_way ? s->height : from + h * (s->velocity + 0.5 * h * s->acceleration);
    double scale = !s->one_way ? 1 : s->force > 0 ? s->peak / HIMC_ONE_WAY_FORCE : 0;
    return (contact_pair){.head = &s->head,
                          .scale = scale,
                          .c0 = n->before - from,
                          .b = displacement(m, s, n->point) - n->before - (to - from),
                          .guess = s->one_way ? 0 : s->force};
}

// Solves the sticks near together with the wires on the lower head, if they rattle: in turn, each
// with the forces of the others, until those of the wires stay. One sees the other across the air
// between the heads, so little in a step that few rounds are needed.
static void solve_with_wires(himc_membrane *m, const near_stick *near, contact_pair *pairs,
                             int count, double (*g)[MAX_PAIRS], double h)
{
    double free[MAX_PAIRS], under[HIMC_WIRES], b[HIMC_WIRES], pull = m->model->config.head.wires;
    const double *across[MAX_PAIRS];
    himc_membrane_begin_wires(m, h, under);
    for (int i = 0; i < count; i++) {
        himc_strike_point_response(m, near[i].point, m->step);
        across[i] = near[i].point->under[m->step];
        free[i] = pairs[i].b;
    }
    for (int turn = 0; turn < WIRE_TURNS; turn++) {
        double change = 0, size = 0;
        for (int i = 0; i < count; i++) {
            pairs[i].b = free[i];
            for (int k = 0; k < HIMC_WIRES; k++)
                pairs[i].b += across[i][k] * m->wires.force[k];
            pairs[i].guess = turn > 0 ? pairs[i].force : pairs[i].guess;
            size += pairs[i].guess;
        }
        solve_pairs(pairs, count, g, h);
        for (int i = 0; i < count; i++)
            change += fabs(pairs[i].force - pairs[i].guess);
        if (turn > 0 && change <= NEAR_ROOT * size)
            break;
        for (int k = 0; k < HIMC_WIRES; k++) {
            b[k] = under[k];
            for (int i = 0; i < count; i++)
                b[k] += across[i][k] * pairs[i].force;
        }
        himc_wires_solve(&m->wires, pull, h, m->model->under.compliance[m->step], b);
    }
    himc_membrane_end_wires(m, h, b);
}

// G of all sticks near
static void find_compliances(himc_membrane *m, const near_stick *near, int count,
                             double (*g)[MAX_PAIRS], double h)
{
    for (int i = 0; i < count; i++) {
        const himc_stick *s = near[i].stick;
        double at_point = himc_strike_point_compliance(m, near[i].point, near[i].point) +
                          (1 - near[i].residual.stay) * s->residual_root * s->residual_root;
        double own = s->one_way ? REGULAR * at_point + REGULAR_LEAST : 0.5 * h * h / s->mass;
        g[i][i] = at_point + own;
        for (int j = 0; j < i; j++)
            g[i][j] = g[j][i] = himc_strike_point_compliance(m, near[i].point, near[j].point);
    }
}

// solves the sticks near the head
static void step_near(himc_membrane *membrane, const near_stick *near, int count, double h)
{
    contact_pair pairs[MAX_PAIRS];
    double g[MAX_PAIRS][MAX_PAIRS], from[MAX_PAIRS];
    bool apart = true;
    for (int i = 0; i < count; i++) {
        himc_stick *s = near[i].stick;
        from[i] = s->height;
        if (s->one_way)
            strike_rigid(s, h);
        swing(&near[i]);
        pairs[i] = make_pair(membrane, &near[i], from[i], h);
        apart = apart && pairs[i].c0 <= 0 && pairs[i].c0 + pairs[i].b <= 0;
    }
    if (!apart || membrane->wires.awake)
        find_compliances(membrane, near, count, g, h);
    if (membrane->wires.awake)
        solve_with_wires(membrane, near, pairs, count, g, h);
    else
        solve_pairs(pairs, count, g, h);
    for (int i = 0; i < count; i++) {
        himc_stick *s = near[i].stick;
        const himc_residual_step *r = &near[i].residual;
        // the path of a one-way stick is rigid: the force is limited to that of the motion
        double force = s->one_way ? fmin(pairs[i].force, s->force) : pairs[i].force;
        himc_strike_point_apply(membrane, near[i].point, -force);
        s->residual_x -= (1 - r->stay) * s->residual_root * force;
        s->residual_y -= r->turn * s->residual_root * force;
        if (!s->one_way)
            move(s, force, h);
    }
}

// The strike point under a stick. Until a blow has begun, its patch is that of a blow as fast as
// the stick comes down; it is found anew in the last two steps, and kept while it hardly changes: a
// stick that follows a head on its way down is in its last two steps for a long time, and weighing
// all modes anew in each of them would take a block's time.
static strike_point *point_under(himc_membrane *m, himc_stick *s, double h)
{
    double x = s->touching ? s->contact_x : s->x, y = s->touching ? s->contact_y : s->y;
    strike_point *point = himc_membrane_strike_point(m, x, y, s->patch);
    if (s->touching || (s->chatter > 0 && s->patch > 0))
        return point;
    double speed = fmax(-s->velocity, 0), last = 2 * h * speed;
    double gap = s->height - (s->one_way ? 0 : himc_strike_point_displacement(m, point));
    if (gap > CLOSE + last) {
        s->patch = 0;
    } else if (s->patch == 0 || !(gap > last)) {
        double radius =
            himc_patch_radius(himc_membrane_head(m), &s->head, s->mass, hypot(x, y), speed);
        if (s->patch == 0 || fabs(radius - s->patch) > SAME_PATCH * s->patch)
            s->patch = radius;
    }
    point = himc_membrane_strike_point(m, x, y, s->patch);
    himc_residual residual = himc_strike_point_residual(point);
    s->residual_root = residual.root;
    s->residual_omega = residual.omega;
    s->residual_x = s->residual_y = 0;
    return point;
}

void himc_stick_put(himc_membrane *membrane, himc_stick *stick)
{
    stick->height = 0;
    stick->height = displacement(membrane, stick, point_under(membrane, stick, 0));
}

// a step of length h: a sample or a substep
static void step(himc_membrane *membrane, himc_stick *const *sticks, int count, double h)
{
    near_stick near[MAX_PAIRS];
    int near_count = 0;
    himc_membrane_ready(membrane);
    for (int i = 0; i < count; i++) {
        // in the air in this step, whatever the others do
        if (!within_reach(sticks[i], h) || is_clear(membrane, sticks[i], 1, h, true))
            himc_stick_fly(sticks[i], h);
        else
            near[near_count++].stick = sticks[i];
    }
    for (int i = 0; i < near_count; i++) {
        himc_stick *s = near[i].stick;
        strike_point *point = point_under(membrane, s, h);
        double before = displacement(membrane, s, point);
        // head or stick may have been moved from outside since the last sample: it stays on a head
        // that was changed, and no compression grows; a one-way stick meets the head at rest
        if (s->touching && !s->one_way)
            s->height += before - s->dent;
        double surface = s->one_way ? 0 : before, most = s->touching ? s->compression : 0;
        if (surface - s->height > most + HEIGHT_ROUNDING)
            s->height = surface - most;
        himc_residual residual = {s->residual_root, s->residual_omega};
        near[i] = (near_stick){s, point, before, himc_residual_in(&residual, h)};
    }
    himc_membrane_free_step(membrane);
    if (near_count > 0)
        step_near(membrane, near, near_count, h);
    else
        himc_membrane_rattle(membrane, h);
    for (int i = 0; i < near_count; i++) {
        himc_stick *s = near[i].stick;
        s->dent = displacement(membrane, s, near[i].point);
        s->compression = (s->one_way ? 0 : s->dent) - s->height;
        if (!s->one_way)
            hold_point(s, s->compression > 0);
    }
}

void himc_contact_step(himc_membrane *membrane, himc_stick *const *sticks, int count)
{
    double rate = himc_membrane_rate(membrane), h = 1 / rate, mean[MAX_PAIRS] = {0};
    count = count < MAX_PAIRS ? count : MAX_PAIRS;
    int substeps = 1;
    for (int i = 0; i < count && substeps == 1; i++)
        if (within_reach(sticks[i], h) && is_stiff(&sticks[i]->head))
            substeps = himc_membrane_substeps(rate);
    for (int i = 0; i < substeps; i++) {
        himc_membrane_set_substep(membrane, i, substeps);
        step(membrane, sticks, count, h / substeps);
        for (int k = 0; k < count; k++)
            mean[k] += sticks[k]->force / substeps;
    }
    himc_membrane_set_substep(membrane, 0, 1);
    for (int k = 0; k < count; k++)
        sticks[k]->force = mean[k];
}

double himc_contact_energy(const himc_stick *stick)
{
    felt pressed = himc_felt_at(&stick->head, 1, stick->compression);
    return 0.5 * stick->mass * stick->velocity * stick->velocity + himc_felt_potential(&pressed) +
           0.5 * (stick->residual_x * stick->residual_x + stick->residual_y * stick->residual_y);
}
