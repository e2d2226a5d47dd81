/// air.c: closed forms for every mode, and a table that corrects them where the drum is a timpano.
///
/// In the head's own measures (air.h; x = w a/c, l = L/a) a mode whose zero is j = j_mn obeys
///     x^2 (1 + epsilon beta(x)) = tau j^2,   beta = (beta_out + beta_in)/sqrt(1 - x^2/j^2)
/// with beta the added mass of the two sides: at rest from the table, else 1.07/j each, the
/// infinite membrane's 1/j and a little for the rim; near the speed of sound it grows as an
/// infinite membrane's does. For m = 0 the kettle's air couples the modes by one spring k(x) =
/// (1/l) f(x l) for the volume, so their frequencies are the roots of
///     1 + epsilon k sum_n 4/(j_n^2 d_n) = 0,   d_n = tau j_n^2 - x^2 (1 + epsilon beta_n)
/// one between each two zeros of d; such a mode is a mixture of the bare ones, those of norm 1 with
/// shares 2/(j_n d_n). In a slack head the spring is the stiffer part, and the lowest mode moves
/// little air: its rim goes down as its middle goes up. f(x l) = x l cot(x l), kept positive: it
/// falls as the kettle's air begins to move as a column. Radiation is that of the shape in a
/// baffle,
///     delta = x epsilon R/(2 (1 + epsilon beta)),   R = (2/j^2) I_m(x)/(1 - g x^2/j^2)^2
///     I_m(x) = int_0^{pi/2} J_m(x sin t)^2 x sin t dt = J_{2m+1}(2x) + J_{2m+3}(2x) + ...
/// (by Neumann's integral for J_m^2; Watson 1944, section 5.43), g = (2m+2)/(2m+3) the mean of
/// sin^2 t for small x, where this is the monopole, dipole ... in x^(2m+1).
///
/// Friction. Along a face the air sticks in a layer of 0.1 to 0.3 mm, which takes R u^2/2 per area
/// from a flow of amplitude u, R = sqrt(w rho eta/2) (Landau & Lifshitz 1987, section 24). The flow
/// near a head is that of a potential, in which every plane wave goes along the head as fast as
/// across it. So, by Parseval, the mean of u^2 on each side of a wide head is that of its own
/// velocity, and a mode loses
///     delta = R (S_out + S_in)/(2 M),   S_out = 1 - 0.3/j,   S_in = 1 + 2.7/j^1.5
/// with M its mass per area; the rest is the rim's and the kettle's wall and bottom (for m > 0
/// within 2 %: test_air_galerkin). Below the first resonance of the kettle the air inside flows
/// 1/(1 - y) times as much, y = (x/beta_m)^2, and heat goes to the wall in a share 0.475 y. For
/// m = 0, where nothing counts beside the radiation, S = 2 - 1.8/j. Table and closed forms are
/// without friction.
///
/// The table holds ln(f/f_bare) and ln(delta) of five drums over log tension. Between its nodes:
/// monotone cubics (Fritsch & Butland 1984) along the tension; lines between drums. The ratio of
/// table and closed form at the table's kettle multiplies the closed form at the actual kettle.
/// Outside the table this ratio goes to 1 over a factor of four in tension, or two in epsilon: no
/// step and no bend while the pedal moves.
///
/// Mass. A loaded mode's stiffness is the bare head's and, for m = 0, that of the kettle's slow
/// spring epsilon/l (2/j)^2; its mass follows from the frequency. Thus static deflections are exact
/// and, for the preferred modes of a tuned drum, the mass is within a tenth of the mass with which
/// the whole problem responds to a blow (its residue).
#include "head/air.h"

#include "head/statistical.h"

#include <math.h>

// half to twice the usual kettle; chosen: docs/air.md gives the errors in this range
#define KETTLE_RANGE 2.0
// So far beyond the table's tensions (ln 4) and epsilons (ln 2) its correction ends; chosen:
// smooth.
#define TENSION_MARGIN 1.3862943611
#define LOADING_MARGIN 0.6931471806
// modes of order 0 that the kettle's spring couples; chosen: twice those in the table
#define COUPLED_MODES 8
#define BELOW_SOUND 0.99      // largest first guess of an iteration with a root below 1
#define SOUND_STEPS 5         // of that iteration, by Newton; chosen
#define BISECTIONS 40         // for a coupled mode: 1e-12 of the interval
#define LEAST_DIRECTIVITY 0.2 // chosen: keeps the radiation of a resonant mode finite
// -ln(z cot z) = z^2/3 + 7 z^4/90 + ...
#define COLUMN_2 (1 / 3.0)
#define COLUMN_4 (7 / 90.0)
#define USUAL_DEPTH (HIMC_AIR_KETTLE_SHAPE / HIMC_PI)
#define SLOPE_STEP 1e-4 // (nodes) for the slope at the table's end by a difference

#define VISCOSITY 1.81e-5 // eta of air at 20 degrees (Pa s)
#define CONDUCTION 0.475  // 0.4/sqrt(0.71): gamma - 1 and Prandtl's number of air
#define MOST_SLOSH 0.5    // of y; chosen: nearer the resonance its quality has the loss

#define FREE 0.7    // of a baffle's radiation: boundary elements, 0.64 to 0.73
#define HEIGHT 0.85 // of the head over the floor (m); chosen: as it stands at first
#define STAND 0.3   // of a rocking stand (1/s); guessed, at ...
#define STAND_OMEGA (2 * HIMC_PI * 100) // ... this (rad/s)

static const double SPEED2 = HIMC_AIR_SPEED * HIMC_AIR_SPEED;

// zeros j_0n
static const double ZERO[COUPLED_MODES] = {2.404825557695773, 5.520078110286311, 8.653727912911013,
                                           11.79153443901428, 14.93091770848779, 18.07106396791092,
                                           21.21163662987926, 24.35247153074930};

_Static_assert(HIMC_MIXED == HIMC_AIR_RANKS && HIMC_MIXED <= COUPLED_MODES, "all modes (0, n)");

// J_1 there
static const double VOLUME[HIMC_MIXED] = {0.519147497289467, -0.340264806558080, 0.271452299928382,
                                          -0.232459831434810};

// logarithms of a mode's frequency per bare frequency, and of delta a/c + HIMC_AIR_FLOOR
typedef struct log_pair {
    double ratio, decay;
} log_pair;

typedef struct mode_id {
    int m, n;
    double zero;
} mode_id;

double himc_air_kettle(double radius)
{
    return HIMC_AIR_KETTLE_SHAPE * radius * radius * radius;
}

bool himc_air_check(double kettle, double radius, himc_error *error)
{
    double usual = himc_air_kettle(radius);
    return himc_check_range("kettle", kettle, usual / KETTLE_RANGE, usual * KETTLE_RANGE, "m3",
                            error);
}

// J_{2m+1}(z) + J_{2m+3}(z) + ... by backward recurrence (bessel.c); below 1e-7 it may be 0
static double radiated(int m, double z)
{
    int top = (int)(z + 6 * cbrt(z) + 10), first = 2 * m + 1;
    if (first > top || !(z > 1e-3))
        return 0;
    double above = 0, here = 1e-200, sum = 0, odd = 0, two_over_z = 2 / z;
    for (int k = top; k > 0; k--) {
        if (k % 2 == 0)
            sum += 2 * here;
        else if (k >= first)
            odd += here;
        double below = k * two_over_z * here - above;
        above = here;
        here = below;
    }
    return odd / (sum + here);
}

// added mass of both sides of a mode at rest
static double added(int m, int n, double zero, double depth)
{
    if (m >= HIMC_AIR_ORDERS || n > HIMC_AIR_RANKS)
        return 2 * HIMC_AIR_RIM / zero;
    // in a kettle of another depth only the lowest mode, which reaches its bottom, changes
    double b = himc_air_slosh[m], z2 = zero * zero - b * b;
    double change = 1 / tanh(b * depth) - 1 / tanh(b * USUAL_DEPTH);
    double share = 4 * zero * zero / (z2 * z2 * (1 - m * m / (b * b)) * b);
    return himc_air_outer[m][n - 1] + himc_air_inner[m][n - 1] + share * change;
}

// y in (0, 1) with y (1 + b/sqrt(1 - y)) = t
static double below_sound(double b, double t)
{
    double y = fmin(t / (1 + b), BELOW_SOUND);
    for (int i = 0; i < SOUND_STEPS; i++) {
        double root = sqrt(1 - y);
        double value = y * (1 + b / root) - t, slope = 1 + b / root * (1 + 0.5 * y / (1 - y));
        double next = y - value / slope;
        y = next < 1 ? next : 0.5 * (1 + y);
    }
    return y;
}

static double directivity(int m, double x, double zero)
{
    return 1 - (2 * m + 2) / (2 * m + 3.0) * x * x / (zero * zero);
}

static log_pair logarithms(double x, double decay, double bare)
{
    return (log_pair){log(x / bare), log(decay + HIMC_AIR_FLOOR)};
}

// a mode that changes the volume little or not at all
static log_pair uncoupled(const himc_air *air, double depth, mode_id s)
{
    double square = s.zero * s.zero, b = air->loading * added(s.m, s.n, s.zero, depth);
    double spring = s.m == 0 ? 4 * air->loading / (depth * square * square) : 0;
    double y = below_sound(b, air->tension + spring), x = s.zero * sqrt(y),
           d = directivity(s.m, x, s.zero);
    double decay =
        air->loading * x * radiated(s.m, 2 * x) / (square * d * d * (1 + b / sqrt(1 - y)));
    return logarithms(x, decay, s.zero * sqrt(air->tension));
}

// the modes of order 0 with the added masses at rest, and one of those that the kettle's spring
// makes of them
typedef struct coupled_mode {
    double x;                                         // its frequency
    double mass[COUPLED_MODES], share[COUPLED_MODES]; // of bare modes whose norm is 1
} coupled_mode;

static double detuning(const himc_air *air, const coupled_mode *c, int n)
{
    return air->tension * ZERO[n] * ZERO[n] - c->x * c->x * c->mass[n];
}

// mode (0, rank) as the kettle's spring makes it
static coupled_mode couple(const himc_air *air, double depth, int rank)
{
    coupled_mode c;
    for (int n = 0; n < COUPLED_MODES; n++)
        c.mass[n] = 1 + air->loading * added(0, n + 1, ZERO[n], depth);
    double low = ZERO[rank - 1] * sqrt(air->tension / c.mass[rank - 1]);
    double high = ZERO[rank] * sqrt(air->tension / c.mass[rank]);
    c.x = low;
    for (int i = 0; i < BISECTIONS; i++) {
        double sum = 0;
        c.x = 0.5 * (low + high);
        for (int n = 0; n < COUPLED_MODES; n++)
            sum += 4 / (ZERO[n] * ZERO[n] * detuning(air, &c, n));
        // the kettle's spring for a change of volume
        double s = c.x * c.x * depth * depth;
        double spring = exp(-s * (COLUMN_2 + s * COLUMN_4)) / depth;
        // from -infinity to +infinity, rising
        if (1 + air->loading * spring * sum < 0)
            low = c.x;
        else
            high = c.x;
    }
    for (int n = 0; n < COUPLED_MODES; n++)
        c.share[n] = 2 / (ZERO[n] * detuning(air, &c, n));
    return c;
}

// a mode of order 0, coupled to the others by the kettle's spring
static log_pair coupled(const himc_air *air, double depth, mode_id s)
{
    coupled_mode c = couple(air, depth, s.n);
    double volume = 0, inertia = 0;
    for (int n = 0; n < COUPLED_MODES; n++) {
        volume += c.share[n] / (ZERO[n] * fmax(directivity(0, c.x, ZERO[n]), LEAST_DIRECTIVITY));
        inertia += 0.5 * c.mass[n] * c.share[n] * c.share[n];
    }
    double decay = 0.5 * air->loading * c.x * volume * volume * radiated(0, 2 * c.x) / inertia;
    return logarithms(c.x, decay, s.zero * sqrt(air->tension));
}

static log_pair closed_form(const himc_air *air, double depth, mode_id s)
{
    return s.m == 0 && s.n <= HIMC_AIR_RANKS ? coupled(air, depth, s) : uncoupled(air, depth, s);
}

static double log_step(void)
{
    return log(HIMC_AIR_TABLE_HIGH / HIMC_AIR_TABLE_LOW) / (HIMC_AIR_NODES - 1);
}

// slope at a node that keeps the curve monotone between its neighbours
static double node_slope(double before, double after)
{
    return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

// slope at an end of the table: the smaller of the two nearest, so the curve does not run away
static double end_slope(double at, double beside)
{
    return at * beside <= 0 ? 0 : fabs(at) < fabs(beside) ? at : beside;
}

// A row of the table at node + t. Before the interpolation `rise` per node is added, which makes
// frequencies monotone; afterwards it is subtracted.
static double along_row(const short *row, double unit, double rise, int node, double t)
{
    double step = unit * (row[node + 1] - row[node]) + rise;
    double before = node > 0 ? unit * (row[node] - row[node - 1]) + rise : 0;
    double after = node + 2 < HIMC_AIR_NODES ? unit * (row[node + 2] - row[node + 1]) + rise : 0;
    double first = node > 0 ? node_slope(before, step) : end_slope(step, after);
    double last = node + 2 < HIMC_AIR_NODES ? node_slope(step, after) : end_slope(step, before);
    double u = 1 - t;
    return unit * row[node] + t * t * (1 + 2 * u) * step + t * u * (u * first - t * last) -
           t * rise;
}

// difference of table and closed form, at a tension t nodes after the cell's first and an epsilon
// inside the table
static log_pair difference(const himc_air *air, mode_id s, double t)
{
    himc_air there = *air;
    double log_low = log(HIMC_AIR_TABLE_LOW / (HIMC_AIR_TABLE_FILM * SPEED2));
    there.tension = exp(log_low + (air->node + t) * log_step());
    const double *a = himc_air_radius + air->drum;
    there.loading =
        (a[0] + air->between * (a[1] - a[0])) * (HIMC_AIR_DENSITY / HIMC_AIR_TABLE_FILM);
    double value[2][2], rise = 0.5 * log_step(), u = 1 - air->between;
    for (int i = 0; i < 2; i++) {
        int row = HIMC_AIR_ROW(air->drum + i, s.m, s.n - 1);
        value[i][0] = along_row(himc_air_ratio + row, HIMC_AIR_RATIO_UNIT, rise, air->node, t);
        value[i][1] = along_row(himc_air_decay + row, HIMC_AIR_DECAY_UNIT, 0, air->node, t);
    }
    log_pair form = closed_form(&there, USUAL_DEPTH, s);
    return (log_pair){u * value[0][0] + air->between * value[1][0] - form.ratio,
                      u * value[0][1] + air->between * value[1][1] - form.decay};
}

// from 1 at s = 0 to 0 at s = 1, without slope at both ends
static double smooth_end(double s)
{
    return s < 1 ? (1 - s) * (1 - s) * (1 + 2 * s) : 0;
}

static log_pair correction(const himc_air *air, mode_id s)
{
    log_pair q = difference(air, s, air->along);
    double cells = fabs(air->beyond) / log_step();
    if (cells > 0) {
        // the slope at the table's end, which may be steep, is gone within one cell
        double inward = air->beyond > 0 ? -SLOPE_STEP : SLOPE_STEP,
               kept = smooth_end(cells * log_step() / TENSION_MARGIN);
        double run = cells < 1 ? cells * (1 - cells) * (1 - cells) / SLOPE_STEP : 0;
        log_pair inside = difference(air, s, air->along + inward);
        q.ratio = kept * q.ratio + run * (q.ratio - inside.ratio);
        q.decay = kept * q.decay + run * (q.decay - inside.decay);
    }
    return (log_pair){air->weight * q.ratio, air->weight * q.decay};
}

himc_air himc_air_around(const himc_head *head, double kettle)
{
    double r = head->radius;
    himc_air air = {.radius = r,
                    .tension = head->tension / (head->density * SPEED2),
                    .loading = HIMC_AIR_DENSITY * r / head->density,
                    .depth = kettle / (HIMC_PI * r * r * r)};
    // the cell of the table, or the nearest one
    double low = log(HIMC_AIR_TABLE_LOW / (HIMC_AIR_TABLE_FILM * SPEED2));
    double at = (log(air.tension) - low) / log_step();
    double inside = fmin(fmax(at, 0), HIMC_AIR_NODES - 1);
    air.node = (int)fmin(inside, HIMC_AIR_NODES - 2);
    air.along = inside - air.node;
    air.beyond = (at - inside) * log_step();
    // radius of a head of the table's film with this epsilon
    double like = air.loading * HIMC_AIR_TABLE_FILM / HIMC_AIR_DENSITY;
    const double *a = himc_air_radius;
    double held = fmin(fmax(like, a[0]), a[HIMC_AIR_DRUMS - 1]);
    while (air.drum < HIMC_AIR_DRUMS - 2 && held > a[air.drum + 1])
        air.drum++;
    air.between = (held - a[air.drum]) / (a[air.drum + 1] - a[air.drum]);
    air.weight = smooth_end(fabs(log(like / held)) / LOADING_MARGIN);
    return air;
}

// decay by friction (1/s) of a mode at x whose air flows `flow` times its velocity squared
static double friction(const himc_air *air, double x, double mass, double flow)
{
    double resistance = sqrt(0.5 * x * HIMC_AIR_SPEED / air->radius * HIMC_AIR_DENSITY * VISCOSITY);
    return resistance * flow * air->loading / (2 * mass * HIMC_AIR_DENSITY * air->radius);
}

// S_out + S_in
static double flow_along(mode_id s, double x)
{
    if (s.m == 0)
        return 2 - 1.8 / s.zero;
    double beta = s.m < HIMC_AIR_ORDERS ? himc_air_slosh[s.m] : s.zero;
    double y = s.n == 1 ? fmin(x * x / (beta * beta), MOST_SLOSH) : 0;
    return 1 - 0.3 / s.zero + (1 + 2.7 / (s.zero * sqrt(s.zero))) * (1 + CONDUCTION * y) / (1 - y);
}

// a mode of statistical.c, which changes no volume and has no table
static himc_air_load on_statistical(const himc_air *air, double zero)
{
    double b = air->loading * 2 * HIMC_AIR_RIM / zero, y = below_sound(b, air->tension);
    double mass = air->tension / y;
    return (himc_air_load){
        .frequency = sqrt(y / air->tension),
        .radiation = air->loading * HIMC_AIR_SPEED / (air->radius * mass) *
                     himc_statistical_radiation(zero, y),
        .friction = friction(air, zero * sqrt(y), mass, 2),
        .mass = mass,
        .stretch = 1,
        .stiffness = 1,
    };
}

himc_mixture himc_air_mixture(const himc_air *air)
{
    himc_mixture mix = {.count = 0};
    for (int n = 0; n < HIMC_MIXED; n++) {
        coupled_mode c = couple(air, air->depth, n + 1);
        for (int k = 0; k < HIMC_MIXED; k++)
            mix.part[n][k] = c.share[k] / c.share[n] * (VOLUME[n] / VOLUME[k]);
    }
    return mix;
}

// The stiffnesses of a mode per that of its bare shape: of the film in the mixture's shape, and the
// kettle's slow spring for its change of volume.
static void find_stiffness(const himc_air *air, mode_id s, himc_air_load *load)
{
    double square = s.zero * s.zero, film = square, volume = s.m == 0 ? 2 / s.zero : 0;
    if (s.m == 0 && s.n <= HIMC_MIXED) {
        coupled_mode c = couple(air, air->depth, s.n);
        film = volume = 0;
        for (int k = 0; k < HIMC_MIXED; k++) {
            double share = c.share[k] / c.share[s.n - 1];
            film += share * share * ZERO[k] * ZERO[k];
            volume += share * 2 / ZERO[k];
        }
    }
    load->stretch = film / square;
    load->stiffness =
        (film + air->loading / (air->depth * air->tension) * volume * volume) / square;
    load->mass = load->stiffness / (load->frequency * load->frequency);
}

himc_air_load himc_air_on(const himc_air *air, int m, int n, double zero)
{
    if (m < 0)
        return on_statistical(air, zero);
    mode_id s = {m, n, zero};
    log_pair found = closed_form(air, air->depth, s);
    if (m < HIMC_AIR_ORDERS && n <= HIMC_AIR_RANKS && air->weight > 0 &&
        fabs(air->beyond) < TENSION_MARGIN) {
        log_pair q = correction(air, s);
        found.ratio += q.ratio;
        found.decay += q.decay;
    }
    himc_air_load load = {
        .frequency = exp(found.ratio),
        .radiation = fmax(exp(found.decay) - HIMC_AIR_FLOOR, 0) * HIMC_AIR_SPEED / air->radius,
    };
    find_stiffness(air, s, &load);
    double x = load.frequency * zero * sqrt(air->tension);
    load.friction = friction(air, x, load.mass, flow_along(s, x));
    return load;
}

// radiation of a kettle that stands free over a floor, per that of the head in a baffle
static double free_over_floor(int m, double omega)
{
    double z = 2 * omega / HIMC_AIR_SPEED * HEIGHT;
    double image = m == 0 ? sin(z) / z : m == 1 ? 3 * (sin(z) / z - cos(z)) / (z * z) : 0;
    return FREE * (1 + image);
}

// guessed: the rocking of kettle and stand, which the moment of (1,1) alone drives
static double stand(int m, int n, double omega)
{
    double ratio = STAND_OMEGA / omega;
    return m == 1 && n == 1 ? STAND * ratio * ratio * ratio : 0;
}

himc_mode himc_air_loaded(const himc_air_load *load, const himc_head *head, const himc_mode *bare)
{
    himc_mode mode = *bare;
    mode.frequency *= load->frequency;
    mode.mass *= load->mass;
    mode.stiffness *= load->stiffness;
    double omega = 2 * HIMC_PI * mode.frequency;
    double air = free_over_floor(bare->m, omega) * load->radiation + load->friction;
    mode.decay =
        fmin(himc_head_decay(head, omega, load->mass) + air + stand(bare->m, bare->n, omega),
             HIMC_LARGEST_DECAY * omega);
    return mode;
}

himc_mode himc_air_mode(const himc_air *air, const himc_head *head, const himc_mode *bare)
{
    himc_air_load load = himc_air_on(air, bare->m, bare->n, bare->zero);
    return himc_air_loaded(&load, head, bare);
}
