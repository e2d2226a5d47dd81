/// two_heads.c: drums with a shell: snare drum, toms, bass drum, hand drums.
///
/// Each head has the modes of a round one. The air that moves with it makes it heavier: a mode of
/// wave number k has the mass sigma + 1.07 rho/sqrt(k^2 - w^2/c^2) per area (air.c, one side). The
/// air between the heads is a spring of the change of volume,
///     K (sum S_i q_i)^2/2,   K = rho c^2/V,   S_i = +- 2 pi a^2 J_1(j)/j   of (0, n), up positive
/// with + on the upper and - on the lower head. So (0, n) of both heads are those of
///     diag(w_i^2) + K g g',   g_i = S_i/sqrt(m_i),
/// found once: each of them is again an oscillator, with a shape on both heads. Other modes keep to
/// their head; the mass of the air that sloshes for m = 1 is left out. The lower ones are exact,
/// those above statistical (statistical.c), on each head. Fletcher & Bassett (1978) measured a bass
/// drum whose modes this gives: (0,1) at 50 and 118 Hz.
///
/// Decay. A mode loses S0 + S1 w^2/(1 + S1 w^2/L) in the film of its head: as in any solid that
/// relaxes (Zener 1948), the loss does not grow for ever. (0, n) send out their volume U per unit
/// of velocity as a point does, rho w^2 U^2/(8 pi c m), and as a dipole what does not change the
/// volume; others a part of a wide head's rho c per mass and area. How much that is, is chosen,
/// as are the parts of the two heads in what is heard, by the distance to recorded strokes. So is
/// what statistical modes send: in a baffle they would be 10 to 25 dB softer; hoop and shell, which
/// they shake, are not modelled.
#include "head/two_heads.h"

#include "base/argument.h"
#include "base/jacobi.h"
#include "head/air.h"
#include "head/bessel.h"
#include "head/pickup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FROM 18.0 // radius times wave number up to which modes are exact; chosen: toms overlap
#define TO 220.0  // of the statistical ones; chosen: 12 kHz on a tom
#define EXACT 73  // so many are below
#define STATISTICAL 104 // above; chosen: with wires, each costs time
#define DISC (EXACT + STATISTICAL)
#define FITTING (-2) // order of modes that are of no head
#define RANKS 5      // modes (0, n) of a head among the exact ones
#define MOST (2 * RANKS)
#define LOADINGS 20    // iterations of a mode's mass in air; chosen: all digits
#define MOST_LOST 40.0 // L (1/s); chosen: 2 to 5 kHz of recorded toms and kicks fade in .15 s
#define LONGER 0.8     // power of 1/S0 in the radius, ...
#define LONGEST 1.8    // ... of 1/S1; chosen: toms of 12 and 16 inches
#define HIGHER 0.15    // of rho c per mass, by m > 0; chosen
#define DIPOLE 0.5 // of a point's, by what does not change the volume, while depth < 1/k; chosen
#define LOWER 0.7  // of the lower head's sound; chosen: the drum is in its way
#define WIRED 1.25 // of its statistical modes, which only wires shake; chosen: they are the snare

// A stick's tip, chosen so light as it turns about its fulcrum: a heavier one sounds too low. The
// others: chosen.
static const himc_mallet_head stick = {
    .stiffness = 1.5e8, .exponent = 1.5, .mass = 0.008, .radius = 0.008, .relaxation = 5e-6};
static const himc_mallet_head felt = {
    .stiffness = 4e7, .exponent = 2.4, .mass = 0.2, .radius = 0.04, .relaxation = 2e-4};
const himc_mallet_head himc_shell_beater = {
    .stiffness = 1e9, .exponent = 2.2, .mass = 0.06, .radius = 0.025, .relaxation = 2e-4};
static const himc_mallet_head rubber = {
    .stiffness = 1e8, .exponent = 2, .mass = 0.04, .radius = 0.015, .relaxation = 2e-5};

// Drummers aim at the middle third; a little beside the centre modes of all orders speak. Chosen.
static const double spots[] = {
    [HIMC_SPOT_CENTER] = 0, [HIMC_SPOT_NORMAL] = 0.3, [HIMC_SPOT_RIM] = 0.92};

// Chosen, by the distance to single strokes of free collections of samples, whose makers, mallets
// and rooms are not known; hand drums by their usual pitch.
const himc_shell himc_shell_rows[] = {
    {"snare", 0.178, 0.14, 3000, 0.36, 11, 8e-7, 0, 0, 0.83, 0.306, 3, 0.31, 0.35, 250, 0.3,
     &stick},
    {"tom", 0.152, 0.25, 950, 0.36, 2.5, 2.5e-6, 1.6, 1.4, 1.18, 0.75, 1, 1, 2, 0, 0.5, &stick},
    {"concert-tom", 0.152, 0.25, 950, 0.36, 2.5, 2.5e-6, 1.6, 1.4, 0, 0, 0, 0, 2, 0, 0, &stick},
    {"bass-drum", 0.457, 0.45, 2600, 0.42, 2, 4e-7, 1, 0, 0.77, 0.857, 1, 1, 0.7, 0, 0.3, &felt},
    {"kick", 0.279, 0.45, 700, 0.45, 16, 3e-5, 0, 0, 1.2, 0.8, 1, 1, 1, 0, 0.3, &himc_shell_beater},
    {"conga", 0.14, 0.7, 8500, 0.8, 5, 6e-7, 0, 0, 0, 0, 0, 0, 0.7, 0, 0, &rubber},
    {"bongo", 0.1, 0.17, 8000, 0.8, 6, 6e-7, 0, 0, 0, 0, 0, 0, 0.7, 0, 0, &rubber},
    {"timbale", 0.178, 0.17, 3000, 0.36, 4, 8e-7, 0, 0, 0, 0, 0, 0, 0.7, 0, 0, &stick},
};

bool himc_shell_has_hoop(const himc_shell *shell)
{
    return shell->mallet == &stick;
}

// of a mode in the list, the number of the fitting; negative: of a head
static int fitting_of(int source)
{
    return source - 2 * DISC;
}

// Frequencies of (0, n) in a drum, and what they were made of.
typedef struct coupled {
    int count;
    int index[MOST];                      // in the list, in order of frequency
    double mass[MOST], volume[MOST];      // m_i, S_i (kg, m^2) without the air between
    double square[MOST];                  // w^2 with it
    double part[MOST * MOST], film[MOST]; // columns: unit vectors; S0 + S1 w^2 without it
    bool lower[MOST];
} coupled;

// tension, density and losses of a head, as those of the drum's
static himc_head head_of(const himc_shell *shell, const himc_head *head, int lower)
{
    himc_head of = *head;
    if (!lower)
        return of;
    of.tension *= shell->lower_tension;
    of.density *= shell->lower_density;
    of.decay_constant *= shell->lower_constant;
    of.decay_square *= shell->lower_square;
    of.damp = of.muffle = 0; // hand and cloth are on the other one
    return of;
}

static int heads(const himc_shell *shell)
{
    return shell->lower_density > 0 ? 2 : 1;
}

static double depth_of(const himc_shell *shell, double radius)
{
    return shell->depth * pow(radius / shell->radius, shell->deeper);
}

// omega of a wave number in air, and the mass per area
static double load(const himc_head *head, double k, double *mass)
{
    double omega = k * sqrt(head->tension / head->density);
    for (int i = 0; i < LOADINGS; i++) {
        double q = k * k - omega * omega / (HIMC_AIR_SPEED * HIMC_AIR_SPEED);
        *mass = head->density + (q > 0 ? HIMC_AIR_RIM * HIMC_AIR_DENSITY / sqrt(q) : 0);
        omega = k * sqrt(head->tension / *mass);
    }
    return omega;
}

// what a mode loses in the film and to hand and cloth (1/s)
static double film_loss(himc_head head, double omega, double loading)
{
    head.decay_square /= 1 + head.decay_square * omega * omega / MOST_LOST;
    return himc_head_decay(&head, omega, loading);
}

// integral of a shape of order 0 over the head
static double volume_of(const himc_mode *mode, double radius)
{
    double next = (mode->n % 2 ? 1 : -1) * sqrt(mode->norm);
    return 2 * HIMC_PI * radius * radius * next / mode->zero;
}

// couples what is in `c` by the air between
static void couple(coupled *c, const himc_shell *shell, double radius)
{
    double a[MOST * MOST], v[MOST * MOST];
    double spring = HIMC_AIR_DENSITY * HIMC_AIR_SPEED * HIMC_AIR_SPEED /
                    (HIMC_PI * radius * radius * depth_of(shell, radius));
    int n = c->count;
    if (heads(shell) == 1)
        spring = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            a[i * n + j] = (i == j ? c->square[i] : 0) +
                           spring * c->volume[i] * c->volume[j] / sqrt(c->mass[i] * c->mass[j]);
    himc_jacobi(n, a, v);
    for (int i = 0; i < n; i++) {
        int least = i; // the next in order of frequency
        for (int j = i + 1; j < n; j++)
            least = a[j * n + j] < a[least * n + least] ? j : least;
        c->square[i] = a[least * n + least];
        a[least * n + least] = a[i * n + i];
        for (int j = 0; j < n; j++) {
            c->part[j * n + i] = v[j * n + least];
            v[j * n + least] = v[j * n + i];
        }
    }
}

// adds mode (0, n) of a head, number `index` in a list
static void add(coupled *c, const himc_shell *shell, const himc_head *head, bool lower,
                const himc_mode *mode, int index)
{
    int k = c->count++;
    himc_head of = head_of(shell, head, lower);
    double mass, omega = load(&of, mode->zero / head->radius, &mass);
    c->index[k] = index;
    c->lower[k] = lower;
    c->mass[k] = mass * HIMC_PI * head->radius * head->radius * mode->norm;
    c->volume[k] = (lower ? -1 : 1) * volume_of(mode, head->radius);
    c->square[k] = omega * omega;
    c->film[k] = film_loss(of, omega, mass / of.density);
}

// what a mode of order 0 loses: in the films by its parts, and what it sends out
static double decay_of(const coupled *c, int i, const himc_shell *shell, const himc_head *head)
{
    double film = 0, apart = 0, along = 0, omega = sqrt(c->square[i]);
    for (int j = 0; j < c->count; j++) {
        double part = c->part[j * c->count + i], volume = part * c->volume[j] / sqrt(c->mass[j]);
        film += part * part * c->film[j];
        apart += volume;
        along += c->lower[j] ? -volume : volume;
    }
    double wide = fmin(1, omega * depth_of(shell, head->radius) / HIMC_AIR_SPEED);
    return film + HIMC_AIR_DENSITY * c->square[i] / (8 * HIMC_PI * HIMC_AIR_SPEED) *
                      (apart * apart + DIPOLE * wide * wide * along * along);
}

// decay of a mode of order m > 0 by its sound
static double sent(int m, double x, double mass)
{
    double part = 2;
    for (int i = 1; i <= m; i++)
        part *= x * x / (4.0 * i * i);
    return HIGHER * HIMC_AIR_DENSITY * HIMC_AIR_SPEED / mass * fmin(1, part);
}

static void sounds(himc_modes *modes, const himc_head *head, himc_oscillator *out)
{
    const himc_shell *shell = modes->shape.shell;
    double area = HIMC_PI * head->radius * head->radius;
    coupled c = {0};
    for (int i = 0; i < modes->count; i++) {
        bool lower = modes->source[i] / DISC;
        if (fitting_of(modes->source[i]) >= 0) {
            out[i] = himc_fittings_oscillator(fitting_of(modes->source[i]), head->radius);
            continue;
        }
        himc_head of = head_of(shell, head, lower);
        himc_mode mode = himc_modes_get(modes->disc, &of, modes->source[i] % DISC);
        double mass, omega = load(&of, mode.zero / head->radius, &mass);
        double decay = film_loss(of, omega, mass / of.density);
        if (mode.m > 0)
            decay += sent(mode.m, omega * head->radius / HIMC_AIR_SPEED, mass);
        out[i] = (himc_oscillator){omega, decay, mass * area * mode.norm};
        if (mode.m == 0)
            add(&c, shell, head, lower, &mode, i);
    }
    couple(&c, shell, head->radius);
    himc_uneven_block *block = &modes->block[0];
    block->count = c.count;
    for (int i = 0; i < c.count; i++) {
        himc_oscillator *o = &out[c.index[i]];
        double sign = c.part[i * c.count + i] < 0 ? -1 : 1;
        *o = (himc_oscillator){sqrt(c.square[i]), decay_of(&c, i, shell, head), c.mass[i]};
        block->index[i] = c.index[i];
        for (int j = 0; j < c.count; j++)
            block->part[i][j] = sign * c.part[j * c.count + i] * sqrt(c.mass[i] / c.mass[j]);
    }
    for (int i = 0; i < modes->count; i++)
        out[i].decay = fmin(out[i].decay, HIMC_LARGEST_DECAY * out[i].omega);
}

static double pitch(const himc_shape *shape, const himc_head *head)
{
    coupled c = {0};
    for (int i = 0; i < heads(shape->shell) * RANKS; i++) {
        himc_mode mode = {.n = i % RANKS + 1, .zero = himc_bessel_zero(0, i % RANKS + 1)};
        mode.norm = pow(himc_bessel_j(1, mode.zero), 2);
        add(&c, shape->shell, head, i / RANKS, &mode, i);
    }
    couple(&c, shape->shell, head->radius);
    return sqrt(c.square[0]) / (2 * HIMC_PI);
}

// a mode of one of the heads, before it has a place in the list
typedef struct candidate {
    double omega;
    int source;
} candidate;

static int by_frequency(const void *a, const void *b)
{
    const candidate *p = a, *q = b;
    int order = (p->omega > q->omega) - (p->omega < q->omega);
    return order ? order : p->source - q->source;
}

static himc_modes *new_disc(void)
{
    himc_shape round = {.kind = &himc_kind_round};
    himc_modes *disc = himc_modes_new(&round, EXACT, NULL);
    if (disc)
        disc->statistical = malloc(sizeof *disc->statistical);
    if (!disc || !disc->statistical) {
        himc_modes_free(disc);
        return NULL;
    }
    himc_statistical_list(disc->statistical, FROM, TO, STATISTICAL);
    disc->count += STATISTICAL;
    return disc;
}

static void fit(const himc_shape *shape, himc_head *head)
{
    const himc_shell *shell = shape->shell;
    double radius = shape->width > 0 ? shape->width / 2 : shell->radius;
    double larger = radius / shell->radius;
    // as commands can say it again
    head->radius = himc_argument_single(radius);
    head->tension = himc_argument_single(shell->tension * pow(larger, -shell->slacker));
    head->density = himc_argument_single(shell->density);
    head->decay_constant = himc_argument_single(shell->constant * pow(larger, -LONGER));
    head->decay_square = himc_argument_single(shell->square * pow(larger, -LONGEST));
    head->wires = shell->wires;
}

// in the order of a drum of that kind as it is usually tuned
static bool list(himc_modes *modes, bool automatic)
{
    const himc_shell *shell = modes->shape.shell;
    candidate all[2 * DISC + HIMC_FITTINGS];
    himc_head head = {0};
    int found = 0;
    modes->disc = new_disc();
    if (!modes->disc)
        return false;
    fit(&modes->shape, &head);
    for (int i = 0; i < heads(shell) * DISC; i++) {
        himc_head of = head_of(shell, &head, i / DISC);
        double mass, zero = himc_modes_get(modes->disc, &of, i % DISC).zero;
        all[found++] = (candidate){load(&of, zero / head.radius, &mass), i};
    }
    for (int i = 0; i < HIMC_FITTINGS && himc_shell_has_hoop(shell); i++)
        all[found++] = (candidate){himc_fittings_oscillator(i, head.radius).omega, 2 * DISC + i};
    qsort(all, (size_t)found, sizeof *all, by_frequency);
    if (automatic || modes->count > found)
        modes->count = found;
    modes->exact = modes->entry_count = modes->count;
    modes->entries = malloc(sizeof *modes->entries * (size_t)found);
    modes->source = malloc(sizeof *modes->source * (size_t)found);
    for (int i = 0; modes->entries && modes->source && i < found; i++) {
        int lower = all[i].source / DISC;
        modes->source[i] = all[i].source;
        if (fitting_of(all[i].source) >= 0) {
            double z = all[i].omega * head.radius / sqrt(head.tension / head.density);
            modes->entries[i] = (himc_mode_entry){FITTING, 1 + fitting_of(all[i].source), z, 1};
            continue;
        }
        himc_mode mode = himc_modes_get(modes->disc, &head, all[i].source % DISC);
        double stiffer = lower ? shell->lower_tension / shell->lower_density : 1;
        double heavier = lower ? shell->lower_density : 1;
        modes->entries[i] =
            (himc_mode_entry){mode.m, mode.n, mode.zero * sqrt(stiffer), mode.norm * heavier};
    }
    return modes->entries && modes->source;
}

static void shapes(const himc_modes *modes, double radius, double x, double y, double *out)
{
    double on[DISC], far = hypot(x, y) / radius;
    himc_modes_shapes(modes->disc, radius, x, y, on);
    for (int i = 0; i < modes->count; i++) {
        int of = fitting_of(modes->source[i]);
        out[i] = modes->source[i] < DISC ? on[modes->source[i]] : 0;
        if (of >= 0)
            out[i] = himc_fittings_shape(of, far);
    }
}

// In a step no wave comes from one wire to another. So neighbours of the statistical modes have
// signs at the wires as the rows of Hadamard's matrix, in which one cancels what the others carry.
void himc_two_heads_under(const himc_modes *modes, int wire, double *out)
{
    double on[DISC];
    himc_modes_shapes(modes->disc, 1, himc_wires_place[wire][0], himc_wires_place[wire][1], on);
    for (int i = EXACT; i < DISC; i++) {
        int both = i & wire;
        on[i] = (both ^ both >> 1 ^ both >> 2) & 1 ? -1 : 1;
    }
    for (int i = 0; i < modes->count; i++)
        out[i] = modes->source[i] / DISC == 1 ? on[modes->source[i] - DISC] : 0;
}

int himc_two_heads_upper(const himc_modes *modes, int index)
{
    for (int i = 0; i < modes->count; i++)
        if (modes->source[i] == index)
            return i;
    return -1;
}

// pressure of a mode of one head, at the frequency of `mode`
static double pressure_of(const himc_pickup *pickup, const himc_head *head, const himc_modes *modes,
                          int index, const himc_mode *mode)
{
    int lower = modes->source[index] / DISC, i = modes->source[index] % DISC;
    if (fitting_of(modes->source[index]) >= 0)
        return himc_fittings_pressure(fitting_of(modes->source[index])) / pickup->distance;
    himc_mode bare = himc_modes_get(modes->disc, head, i);
    bare.frequency = mode->frequency;
    double part = !lower ? 1 : bare.m < 0 ? WIRED : LOWER;
    if (bare.m == 0 && heads(modes->shape.shell) == 2)
        part = modes->shape.shell->unequal + (lower ? -1 : 1);
    if (bare.m < 0)
        part *= modes->shape.shell->rim * sqrt(bare.zero);
    return part * himc_pickup_pressure(pickup, head, modes->disc, i, &bare);
}

static pickup_weights heard(const himc_pickup *pickup, const himc_head *head,
                            const himc_modes *modes, int index, const himc_mode *mode)
{
    int row;
    const himc_uneven_block *block = himc_uneven_of(modes, index, &row);
    double pressure = block ? 0 : pressure_of(pickup, head, modes, index, mode);
    for (int j = 0; block && j < block->count; j++)
        pressure += block->part[row][j] * pressure_of(pickup, head, modes, block->index[j], mode);
    return himc_pickup_of_gain(mode, pressure / HIMC_PICKUP_PRESSURE);
}

static bool read(const himc_command *command, himc_shape *shape, himc_error *error)
{
    (void)error;
    shape->shell = &himc_shell_rows[command->choice[1]];
    shape->width = command->count > 2 ? 0.0254 * command->atom[2].number : 0;
    return true;
}

static const himc_mallet_head *mallet(const himc_shape *shape)
{
    return shape->shell->mallet;
}

static void surface(const himc_shape *shape, himc_head_frame *surface)
{
    surface->length = 0;
    surface->spots = shape->shell->mallet == &rubber ? NULL : spots; // hands play near the rim
    surface->width = depth_of(shape->shell, surface->radius);
}

static double principal(const himc_shape *shape)
{
    return himc_kind_round.principal(shape);
}

static double film(const himc_shape *shape)
{
    (void)shape;
    return 0;
}

static double patch(const himc_head *head, double x, double y, double b)
{
    return himc_kind_round.patch(head, x, y, b);
}

static double compliance(const himc_head *head, double x, double y, double b)
{
    return himc_kind_round.compliance(head, x, y, b);
}

const himc_kind himc_kind_two_heads = {.name = "shell",
                                       .usual = 2 * DISC + HIMC_FITTINGS,
                                       .read = read,
                                       .fit = fit,
                                       .surface = surface,
                                       .mallet = mallet,
                                       .principal = principal,
                                       .pitch = pitch,
                                       .film = film,
                                       .list = list,
                                       .sounds = sounds,
                                       .shapes = shapes,
                                       .patch = patch,
                                       .compliance = compliance,
                                       .far = heard,
                                       .form = himc_pickup_form};
