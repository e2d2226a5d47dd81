/// plate.c: cymbals, gongs: a thin plate of bronze, whose modes are dense and exchange energy.
///
/// A free plate of area A has (A/2) sqrt(rho h/B) modes per Hz, B = E h^3/(12 (1 - nu^2)), .061 of
/// an 18 inch crash; bow and hammering put them anywhere, so each is at random in its part of the
/// frequencies. A diffuse field has waves k^2 = omega sqrt(rho h/B) of all directions: a mode's
/// shape is sqrt(2 g) cos(k . x + psi), direction and psi at random, fixed, smooth in place, of the
/// plate's mass. g is 1 on the bow, 3 at the free edge; the bell, thick and bent, moves with the
/// high ones.
///
/// A bow, bent with a radius R, stretches as it bends, as a shallow shell does: a flat plate's f
/// becomes sqrt(f^2 + f_r^2), f_r = sqrt(E/rho)/(2 pi R) (Soedel 2004, remembered). So a crash has
/// many modes just above f_r, 557 Hz of 18 inches, and its long waves sound well. What moves the
/// edge alone does not stretch: every second pair stays; chosen, as R is. Others are flat here: by
/// recordings a ride or a hi-hat gains nothing.
///
/// Sound. A mode of mean square speed v^2 radiates 2 rho c A sigma v^2 and loses that. Below the
/// coincidence frequency f_c = c^2 sqrt(rho h/B)/(2 pi) waves in the plate are shorter than in air;
/// only the edge radiates, as in a wall (Maidanik 1962, remembered)
///     P c/(4 pi^2 A f_c) ((1 - s^2) ln((1 + s)/(1 - s)) + 2 s)/(1 - s^2)^1.5,   s^2 = f/f_c,
/// and without a wall, around the whole and around each edge, that times (Oppenheimer & Dubowsky
/// 1997, remembered)
///     x/(1 + x),  x = 53 (f^2 A/c^2)^2;   y/(1 + y),  y = 49 s^2.
/// As a cymbal is thin at its edge and thick at its bell, f_c is spread: 1/sigma = 1/that + 1/PEAK.
/// Far away the pressure is that of a random direction, sqrt(2) cos(k_air a cos(elevation)
/// cos(az - az_i) + phase), times a log-normal level: lines stand out.
///
/// What is guessed: everything about the modes but their density, the bell, the spreads, PEAK, what
/// a splash has in common with a crash. Fitted on figures of recordings whose mallets and rooms are
/// unknown: rate and E_0 of a crash, the losses in bronze and felt (with those by sound a crash
/// then has T60 8, 7, 5, 3 s at 1, 2, 4, 8 kHz) and of china and hi-hat, which is one plate here,
/// whose pedal only damps it. The tam-tam's are from what is known of its bloom, .3 to 1 s. A
/// stick's click and the sway on the stand are left out.
#include "head/idiophone.h"

#include "bank/bank.h"
#include "base/argument.h"
#include "base/random.h"
#include "head/air.h"
#include "head/modes.h"
#include "head/pickup.h"

#include <math.h>
#include <string.h>

#define INCH 0.0254
#define YOUNG 1.1e11 // bronze (Pa); and Poisson's ratio, and (kg/m^3)
#define POISSON 0.34
#define BRONZE 8700.0
#define FIRST 1.8  // mean distances of two modes below the lowest; chosen
#define MIDDLE 0.4 // of its part of the frequencies that a mode may have: neighbours repel; chosen

#define AT_EDGE 3.0   // g there
#define EDGE_FROM 0.8 // it grows to that from here ...
#define EDGE_TO 0.92  // ... to here, per radius: where a shaft meets it; chosen
#define BELL 0.2      // per radius; chosen
#define STIFF 1000.0  // (Hz) below which a bell hardly moves; chosen
#define PEAK 0.1      // of sigma; chosen: loudness as set in a kit
#define LOWEST 5.25   // of a free disc: omega a^2 slow (Leissa 1969, remembered)
#define SOUND 3556.0  // sqrt(E/rho) of bronze (m/s)
#define LEVELS 0.75   // spread of sound (neper), well above ...
#define EVEN 1000.0   // ... this (Hz): below, a few modes are a band of the ear; chosen
#define LOSSES 0.4    // and of decay, ln 1/s; chosen: as many lines as recorded

// In the order of HIMC_PLATES (himc/command_rows.h).
typedef struct plate_row {
    double inches, thickness;        // usual ones (inches, mm)
    double constant, rising;         // losses beside the sound's (1/s, per kHz)
    double bowed;                    // of sigma, by its bow
    double bent;                     // diameter per R
    double highest;                  // (Hz) no mode is above
    double spots[HIMC_SPOT_RIM + 1]; // per radius
    himc_cascade cascade;
    himc_mallet_head mallet;
} plate_row;

// Hertz's law of hickory on metal (1.2e9); a hi-hat is met by the tip and what is behind it.
#define STICK                                                                                   \
    {                                                                                           \
        .stiffness = 1.2e9, .exponent = 1.5, .mass = 0.012, .radius = 0.008, .relaxation = 2e-6 \
    }
// The side of a shaft on a thin edge: the wood dents, so the force is its strength p times the
// area, 2 pi p sqrt(R h/2) per metre, R = 7.2 mm the shaft's radius, h/2 the edge's; p = 60 MPa of
// hickory across the grain, between Brinell's 33 and Janka's 81 (static, remembered).
#define SHAFT                                                                               \
    {                                                                                       \
        .stiffness = 8e5, .exponent = 1, .mass = 0.016, .radius = 0.008, .relaxation = 2e-6 \
    }
#define TIP                                                                                     \
    {                                                                                           \
        .stiffness = 1.2e9, .exponent = 1.5, .mass = 0.008, .radius = 0.008, .relaxation = 2e-6 \
    }
#define BEATER                                                           \
    {                                                                    \
        .stiffness = 3e7, .exponent = 2.3, .mass = 0.35, .radius = 0.035 \
    }
#define AT_THE_EDGE     \
    {                   \
        0.1, 0.93, 0.93 \
    } // spots center, normal, rim
#define ON_THE_BOW     \
    {                  \
        0.1, 0.6, 0.93 \
    }

static const plate_row rows[] = {
    {18, 1.2, 0.75, 0.15, 0, 0.45, 18000, AT_THE_EDGE, {7, 240, 0.08}, SHAFT},
    {20, 2.1, 0.8, 0.3, 0.003, 0, 18000, ON_THE_BOW, {8, 240, 0.03}, TIP},
    {18, 1.0, 0.7, 1.1, 0, 0, 18000, AT_THE_EDGE, {45, 240, 0.04}, SHAFT},
    {10, 0.8, 2.4, 0.16, 0, 0, 18000, AT_THE_EDGE, {10, 240, 0.05}, SHAFT},
    {14, 1.3, 1.0, 0.2, 0.003, 0, 18000, ON_THE_BOW, {50, 240, 0.01}, STICK},
    {38, 2.8, 0.8, 0.35, 0, 0, 14000, AT_THE_EDGE, {20, 300, 0.15}, BEATER},
};

#define HAT 4       // of these
#define APART 0.03  // (m) of two, as drawn; chosen
#define CLOSED 16.4 // (1/s) of two plates that lie on each other; recorded: T60 = .42 s

// of a mode, in the body's list of shapes
enum { WAVE_X, WAVE_Y, PHASE, LEVEL, AZIMUTH, PHASE_IN_AIR, NUMBERS };

// rho h/B of waves: omega = k^2/slow (s/m^2)
static double slowness(double thickness)
{
    double bending = YOUNG * pow(thickness, 3) / (12 * (1 - POISSON * POISSON));
    return sqrt(BRONZE * thickness / bending);
}

// f_r
static double ring_of(const plate_row *row, double radius)
{
    return row->bent * SOUND / (4 * HIMC_PI * radius);
}

// sigma; no wave is longer than that of the lowest mode, (2,0) of a free disc
static double efficiency(const plate_row *row, double f, double radius, double thickness)
{
    double c = HIMC_AIR_SPEED, slow = slowness(thickness), ring = ring_of(row, radius);
    double coincidence = c * c * slow / (2 * HIMC_PI);
    double least = fmin(f, LOWEST / (2 * HIMC_PI * radius * radius * slow));
    double flat = sqrt(fmax(f * f - ring * ring, least * least));
    double square = fmin(f * (f / flat) / coincidence, 1 - 1e-6), s = sqrt(square), b = 1 - square;
    double edge = c / (2 * HIMC_PI * HIMC_PI * radius * coincidence) *
                  (b * log((1 + s) / (1 - s)) + 2 * s) / pow(b, 1.5);
    double around = f * radius / c, whole = 53 * pow(HIMC_PI * around * around, 2);
    double low = (edge * 49 * square / (1 + 49 * square) + row->bowed) * whole / (1 + whole);
    return low * PEAK / (low + PEAK);
}

static bool add_modes(himc_idiophone *body, const plate_row *row, double thickness, uint64_t seed,
                      himc_error *error)
{
    double slow = slowness(thickness), numbers[NUMBERS] = {0};
    double ring = ring_of(row, body->radius);
    double area = HIMC_PI * body->radius * body->radius, apart = 2 / (area * slow);
    for (int i = 0; i < HIMC_MODES_MAX; i++) {
        double at = i + FIRST + 0.5 + MIDDLE * (himc_random_uniform(&seed) - 0.5);
        double flat = at * apart, f = i % 4 < 2 ? flat : hypot(flat, ring);
        double loss = row->constant + row->rising * 1e-3 * f +
                      HIMC_AIR_DENSITY * HIMC_AIR_SPEED *
                          efficiency(row, f, body->radius, thickness) / (BRONZE * thickness);
        double wave = body->radius * sqrt(2 * HIMC_PI * flat * slow);
        double direction = 2 * HIMC_PI * himc_random_uniform(&seed),
               phase = 2 * HIMC_PI * himc_random_uniform(&seed);
        if (i % 2 == 0) { // two share a wave
            numbers[WAVE_X] = wave * cos(direction);
            numbers[WAVE_Y] = wave * sin(direction);
            numbers[PHASE] = phase;
        } else {
            numbers[PHASE] -= HIMC_PI / 2;
        }
        double spread = LEVELS * f * f / (f * f + EVEN * EVEN);
        numbers[LEVEL] =
            exp(spread * himc_random_normal(&seed) - spread * spread); // its mean square is 1
        numbers[AZIMUTH] = 2 * HIMC_PI * himc_random_uniform(&seed);
        numbers[PHASE_IN_AIR] = 2 * HIMC_PI * himc_random_uniform(&seed);
        himc_partial mode = {.frequency = f,
                             .loss = loss * exp(-LOSSES * himc_random_normal(&seed)),
                             .mass = BRONZE * thickness * area};
        if (i > 0 && f > row->highest)
            break;
        if (!himc_idiophone_add_mode(body, mode, numbers, NUMBERS, error))
            return false;
    }
    return true;
}

static bool add_parts(himc_idiophone *body, himc_error *error)
{
    static const char *const names[] = {"bell", "bow", "edge"};
    static const double out[] = {0.1, 0.6, 0.93}; // towards the performer, per radius
    for (int i = 0; i < 3; i++) {
        himc_part part = {.x = -out[i] * body->radius, .width = 2 * body->radius};
        strcpy(part.name, names[i]);
        if (i > 0 && !himc_idiophone_add_part(body, &part, error))
            return false;
        body->part[i] = part;
    }
    return true;
}

static himc_idiophone *make(int index, const char *name, double inches, double mm,
                            himc_error *error)
{
    himc_part disc = {.name = "plate", .width = INCH * inches};
    himc_idiophone *body = himc_idiophone_new(name, error);
    if (!body)
        return NULL;
    body->radius = 0.5 * disc.width;
    if (himc_idiophone_add_part(body, &disc, error) &&
        add_modes(body, &rows[index], 1e-3 * mm, (uint64_t)(1000 * index + 10 * inches), error)) {
        himc_idiophone_finish(body);
        body->row = index;
        body->pitches[0] = inches;
        body->pitches[1] = mm;
        body->mallet = rows[index].mallet;
        body->dampers = index == HAT ? CLOSED : 0;
        if (add_parts(body, error))
            return body;
    }
    himc_shape_release(&(himc_shape){.body = body});
    return NULL;
}

static bool read(const himc_command *c, himc_shape *shape, himc_error *error)
{
    const plate_row *row = &rows[c->choice[1]];
    double inches = c->count > 2 ? c->atom[2].number : row->inches;
    double mm = c->count > 3 ? c->atom[3].number : row->thickness;
    // as another command can say it
    shape->body = make(c->choice[1], c->atom[1].symbol, inches, himc_argument_single(mm), error);
    return shape->body;
}

static void fit(const himc_shape *shape, himc_head *head)
{
    himc_idiophone_fit(shape, head);
    head->dampers = shape->body->dampers; // a foot is on the pedal
}

static void surface(const himc_shape *shape, himc_head_frame *surface)
{
    himc_idiophone_surface(shape, surface);
    surface->width = shape->body->row == HAT ? APART : 1e-3 * shape->body->pitches[1];
    surface->spots = rows[shape->body->row].spots;
}

static void shapes(const himc_modes *modes, double radius, double x, double y, double *out)
{
    const himc_idiophone *body = modes->shape.body;
    double r = hypot(x, y) / radius, size = 0;
    if (r < 1) {
        double edge = fmin(fmax((r - EDGE_FROM) / (EDGE_TO - EDGE_FROM), 0), 1);
        size = sqrt(2 * (1 + (AT_EDGE - 1) * edge));
    }
    for (int i = 0; i < modes->count; i++) {
        const double *n = body->shape + body->mode[i].first;
        double f = body->mode[i].frequency / STIFF;
        out[i] = size * cos((n[WAVE_X] * x + n[WAVE_Y] * y) / radius + n[PHASE]);
        if (r < BELL)
            out[i] *= f * f / (1 + f * f);
    }
}

static pickup_weights far(const himc_pickup *pickup, const himc_head *head, const himc_modes *modes,
                          int index, const himc_mode *mode)
{
    const double *n = modes->shape.body->shape + modes->shape.body->mode[index].first;
    double omega = 2 * HIMC_PI * mode->frequency, x = omega / HIMC_AIR_SPEED * head->radius;
    double angle = x * cos(pickup->elevation) * cos(pickup->azimuth - n[AZIMUTH]) + n[PHASE_IN_AIR];
    // per speed: the root of 2 rho c A sigma v^2 rho c/(4 pi R^2)
    double sigma = efficiency(&rows[modes->shape.body->row], mode->frequency, head->radius,
                              1e-3 * modes->shape.body->pitches[1]);
    double loud =
        HIMC_AIR_DENSITY * HIMC_AIR_SPEED * head->radius * sqrt(sigma) * n[LEVEL] * cos(angle);
    double gain = loud / (omega * HIMC_PICKUP_PRESSURE * pickup->distance);
    pickup_weights w = himc_pickup_form(mode);
    return (pickup_weights){.displacement = gain * w.displacement,
                            .velocity = gain * w.velocity,
                            .force = gain * w.force,
                            .gain = gain};
}

static const himc_cascade *cascade(const himc_shape *shape)
{
    return &rows[shape->body->row].cascade;
}

const himc_kind himc_kind_plate = {.name = "plate",
                                   .usual = HIMC_MODES_MAX,
                                   .read = read,
                                   .fit = fit,
                                   .surface = surface,
                                   .loss = himc_idiophone_loss,
                                   .mallet = himc_idiophone_mallet,
                                   .principal = himc_idiophone_principal,
                                   .film = himc_idiophone_film,
                                   .list = himc_idiophone_list,
                                   .shapes = shapes,
                                   .far = far,
                                   .form = himc_pickup_form,
                                   .cascade = cascade};
