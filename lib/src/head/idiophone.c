/// idiophone.c: modes, shapes and sound of an instrument that is known by the numbers of its modes.
///
/// A mode that a list gives f sounds at f sqrt(T/T0 sigma0/sigma), as z of a membrane does, so that
/// `tune` moves all of them by one ratio. Between the places of its shape that is linear, the same
/// for force and displacement, so energy never grows, however coarse it is.
///
/// Sound. A strip of width b that no baffle surrounds is a dipole while k b is small: far away, in
/// the direction th from its normal,
///     p = rho b/(2 pi R) |int phi exp(i k x sin th) dx| min(1, pi k b/8) q'',
/// by the air that it carries along, rho pi b^2/4 per length; wider, or, as of a glockenspiel,
/// close over the bottom of its case, it sounds as in a wall. Of the lowest mode, whose ends move
/// against its middle, that is nearly nothing. It is heard by its resonator, a tube tuned to it,
/// which takes part of the mode's loss d and sends a share s of all that is lost, s 2 d E = 4 pi
/// R^2 <p^2>/(rho c), as a point does,
///     p = sqrt(s d m rho c/(2 pi)) q'/R,
/// a quarter of a period from what drives it. So bars that have one energy are equally loud.
#include "head/idiophone.h"

#include "base/argument.h"
#include "base/head_frame.h"
#include "head/air.h"
#include "head/modes.h"
#include "head/two_heads.h"
#include "himc/vec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAME_PITCH 0.02 // chosen: a third of a semitone
#define SMALLEST 0.06   // (m) radius of what is around a small part; chosen: no matter, as z scales

himc_idiophone *himc_idiophone_new(const char *name, himc_error *error)
{
    himc_idiophone *body = calloc(1, sizeof *body);
    char *copy = malloc(strlen(name) + 1);
    if (!body || !copy) {
        free(body);
        free(copy);
        himc_error_set(error, "%s: out of memory", name);
        return NULL;
    }
    strcpy(copy, name);
    body->references = 1;
    body->name = copy;
    return body;
}

// room for `more` entries of a size after the first `count`; false, with the array as it was
static bool grow(void **array, int count, int more, size_t size, himc_error *error)
{
    void *bigger = realloc(*array, (size_t)(count + more) * size);
    if (!bigger)
        return himc_error_set(error, "out of memory for %d modes", count);
    *array = bigger;
    return true;
}

bool himc_idiophone_add_part(himc_idiophone *body, const himc_part *part, himc_error *error)
{
    if (body->parts == HIMC_PARTS)
        return himc_error_set(error, "one part too many, expected up to %d", HIMC_PARTS);
    if (!grow((void **)&body->part, body->parts, 1, sizeof *part, error))
        return false;
    body->part[body->parts++] = *part;
    return true;
}

bool himc_idiophone_add_mode(himc_idiophone *body, himc_partial mode, const double *shape,
                             int points, himc_error *error)
{
    if (body->modes == HIMC_MODES_MAX)
        return himc_error_set(error, "one mode too many, expected up to %d", HIMC_MODES_MAX);
    if (!grow((void **)&body->mode, body->modes, 1, sizeof mode, error) ||
        !grow((void **)&body->shape, body->points, points, sizeof *shape, error))
        return false;
    mode.part = body->parts - 1;
    mode.first = body->points;
    mode.points = points;
    memcpy(body->shape + body->points, shape, sizeof *shape * (size_t)points);
    body->points += points;
    body->mode[body->modes++] = mode;
    return true;
}

static int by_frequency(const void *a, const void *b)
{
    const himc_partial *p = a, *q = b;
    int order = (p->frequency > q->frequency) - (p->frequency < q->frequency);
    return order ? order : p->first - q->first;
}

void himc_idiophone_finish(himc_idiophone *body)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < body->parts; i++) {
        const himc_part *p = &body->part[i];
        double half[2] = {0.5 * (p->length > 0 ? p->length : p->width), 0.5 * p->width};
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], (k ? p->y : p->x) - half[k]);
            high[k] = fmax(high[k], (k ? p->y : p->x) + half[k]);
        }
    }
    for (int i = 0; i < body->parts; i++) {
        body->part[i].x -= 0.5 * (low[0] + high[0]);
        body->part[i].y -= 0.5 * (low[1] + high[1]);
    }
    bool disc = body->parts == 1 && body->part[0].length == 0;
    body->length = disc ? 0 : high[0] - low[0];
    body->width = high[1] - low[1];
    body->radius =
        disc ? 0.5 * body->width : fmax(0.5 * hypot(body->length, body->width), SMALLEST);
    qsort(body->mode, (size_t)body->modes, sizeof *body->mode, by_frequency);
    if (!(body->principal > 0))
        body->principal = body->mode[0].frequency;
}

void himc_idiophone_fit(const himc_shape *shape, himc_head *head)
{
    const himc_idiophone *body = shape->body;
    head->radius = body->radius;
    head->tension = HIMC_IDIOPHONE_TENSION;
    head->density = HIMC_IDIOPHONE_DENSITY;
    head->decay_constant = body->constant;
    head->decay_square = body->square;
    head->modes = head->modes < body->modes ? head->modes : body->modes;
}

// A bar is struck in its middle; a twentieth of its length nearer to the performer mode 2 speaks,
// too; near its end mode 1, which rests at .22 of the length, is weaker. Chosen. Per half length.
static const double spots[] = {
    [HIMC_SPOT_CENTER] = 0, [HIMC_SPOT_NORMAL] = 0.1, [HIMC_SPOT_RIM] = 0.7};

void himc_idiophone_surface(const himc_shape *shape, himc_head_frame *surface)
{
    double scale = surface->radius / shape->body->radius;
    surface->length = scale * shape->body->length;
    surface->width = scale * shape->body->width;
    surface->spots = surface->length > 0 ? spots : NULL;
}

// the part of that name, or of the same pitch in another spelling; NULL: none
static const himc_part *find_part(const himc_idiophone *body, const char *name)
{
    double wanted, hz;
    bool pitch = himc_note_frequency(name, &wanted);
    for (int i = 0; body && i < body->parts; i++) {
        const himc_part *p = &body->part[i];
        if (strcmp(p->name, name) == 0 ||
            (pitch && himc_note_frequency(p->name, &hz) && fabs(hz / wanted - 1) < SAME_PITCH))
            return p;
    }
    return NULL;
}

bool himc_idiophone_place(const himc_shape *shape, double radius, himc_stroke *stroke,
                          himc_error *error)
{
    const himc_idiophone *body = shape->body;
    const himc_part *part = stroke->part[0] ? find_part(body, stroke->part) : NULL;
    if (himc_spot_is_beyond(stroke->spot) && !(shape->shell && himc_shell_has_hoop(shape->shell)))
        return himc_error_set(error,
                              "%s: %s has no hoop and shell for a stick, expected a snare, "
                              "a tom, a timbale",
                              himc_spot_name(stroke->spot),
                              stroke->drum[0] ? stroke->drum : "the first drum");
    if (!stroke->part[0])
        return true;
    if (!part && stroke->ornament >= HIMC_ROLL_SINGLE && himc_is_hand(stroke->part))
        return himc_error_set(error, "roll: %s: both hands play it, expected no HAND",
                              stroke->part);
    if (!part && (!body || body->parts == 1))
        return himc_error_set(error, "%s: %s has no parts", stroke->part, stroke->drum);
    if (!part)
        return himc_error_set(error, "%s: no part of %s, expected %s .. %s", stroke->part,
                              stroke->drum, body->part[0].name, body->part[body->parts - 1].name);
    double scale = radius / body->radius, x = stroke->x, y = stroke->y;
    bool placed = stroke->spot == HIMC_SPOT_XY;
    if (placed)
        stroke->part[0] = '\0'; // there, with either hand
    stroke->x = scale * part->x + (placed ? x : -0.5 * scale * part->length * spots[stroke->spot]);
    stroke->y = scale * part->y + (placed ? y : 0);
    stroke->spot = HIMC_SPOT_XY;
    return true;
}

// radius times wavenumber, of waves of the speed sqrt(T0/sigma0)
static double zero_of(const himc_idiophone *body, double frequency)
{
    return 2 * HIMC_PI * frequency * body->radius /
           sqrt(HIMC_IDIOPHONE_TENSION / HIMC_IDIOPHONE_DENSITY);
}

double himc_idiophone_principal(const himc_shape *shape)
{
    return zero_of(shape->body, shape->body->principal);
}

double himc_idiophone_film(const himc_shape *shape)
{
    (void)shape;
    return 0;
}

bool himc_idiophone_list(himc_modes *modes, bool automatic)
{
    const himc_idiophone *body = modes->shape.body;
    double area = HIMC_PI * body->radius * body->radius;
    (void)automatic;
    modes->entries = malloc(sizeof *modes->entries * (size_t)modes->count);
    for (int i = 0; modes->entries && i < modes->count; i++)
        modes->entries[i] = (himc_mode_entry){0, i + 1, zero_of(body, body->mode[i].frequency),
                                              body->mode[i].mass / (HIMC_IDIOPHONE_DENSITY * area)};
    modes->entry_count = modes->count;
    return modes->entries;
}

// The part at a point, how far along it that is, 0 .. 1, and how far off its axis, -1 .. 1; -1
// outside. Between parts a mallet, as wide as the gap, meets the nearer one.
static int part_at(const himc_idiophone *body, double x, double y, double *along, double *aside)
{
    int nearest = -1;
    double least = INFINITY;
    *aside = 0;
    if (body->length == 0) {
        *along = hypot(x, y) / body->radius;
        return *along < 1 ? 0 : -1;
    }
    if (2 * fabs(x) >= body->length || 2 * fabs(y) >= body->width)
        return -1;
    for (int i = 0; i < body->parts; i++) {
        const himc_part *p = &body->part[i];
        double u = (x - p->x) / p->length, v = y - p->y;
        double away = hypot(fmax(fabs(u) - 0.5, 0) * p->length, fmax(fabs(v) - 0.5 * p->width, 0));
        if (away >= least)
            continue;
        least = away;
        nearest = i;
        *along = fmin(fmax(u + 0.5, 0), 1 - 1e-9); // the last value has none behind it
        *aside = fmin(fmax(2 * v / p->width, -1), 1);
    }
    return nearest;
}

void himc_idiophone_shapes(const himc_modes *modes, double radius, double x, double y, double *out)
{
    const himc_idiophone *body = modes->shape.body;
    double along = 0, aside, scale = body->radius / radius;
    int part = part_at(body, scale * x, scale * y, &along, &aside);
    for (int i = 0; i < modes->count; i++) {
        const himc_partial *m = &body->mode[i];
        const double *w = body->shape + m->first;
        double at = along * (m->points - 1);
        int k = (int)at;
        out[i] = m->part != part ? 0 : m->points == 1 ? w[0] : w[k] + (at - k) * (w[k + 1] - w[k]);
        out[i] *= m->twists ? aside : 1;
    }
}

// pressure of a strip at 1 m per acceleration, in phase and a quarter of a period apart; `wave` is
// its wave number in air (1/m)
static void strip(const himc_idiophone *body, const himc_partial *m, double scale, double wave,
                  const himc_pickup *to, double *even, double *odd)
{
    const himc_part *p = &body->part[m->part];
    double width = scale * p->width, length = scale * p->length, step = length / (m->points - 1);
    double across = wave * cos(to->elevation) * cos(to->azimuth);
    *even = *odd = 0;
    for (int i = 0; i < m->points; i++) {
        double part = body->shape[m->first + i] * step * (i == 0 || i == m->points - 1 ? 0.5 : 1);
        double phase = across * (i * step - 0.5 * length);
        *even += part * cos(phase);
        *odd += part * sin(phase);
    }
    double around = body->cased ? 1 : fmin(1, HIMC_PI / 8 * wave * width);
    double loud = HIMC_AIR_DENSITY * width / (2 * HIMC_PI) * around;
    *even *= loud;
    *odd *= loud;
}

// the same of the resonator of a mode of that mass (kg)
static double tube(const himc_idiophone *body, const himc_partial *m, double omega, double mass)
{
    double loss = body->constant + body->hysteresis * omega + body->square * omega * omega;
    return sqrt(m->share * loss * mass * HIMC_AIR_DENSITY * HIMC_AIR_SPEED / (2 * HIMC_PI)) / omega;
}

pickup_weights himc_idiophone_far(const himc_pickup *pickup, const himc_head *head,
                                  const himc_modes *modes, int index, const himc_mode *mode)
{
    const himc_idiophone *body = modes->shape.body;
    const himc_partial *m = &body->mode[index];
    double omega = 2 * HIMC_PI * mode->frequency, even = m->pressure, odd = 0;
    if (!(even > 0))
        strip(body, m, head->radius / body->radius, omega / HIMC_AIR_SPEED, pickup, &even, &odd);
    odd += tube(body, m, omega, mode->mass);
    even /= HIMC_PICKUP_PRESSURE * pickup->distance;
    odd /= HIMC_PICKUP_PRESSURE * pickup->distance;
    return (pickup_weights){.displacement = -even * omega * omega,
                            .velocity = -(2 * mode->decay * even + omega * odd),
                            .force = even / mode->mass};
}

double himc_idiophone_tube(const himc_modes *modes, int index, const himc_mode *mode)
{
    const himc_idiophone *body = modes->shape.body;
    double omega = 2 * HIMC_PI * mode->frequency;
    return body->discs
               ? -omega * tube(body, &body->mode[index], omega, mode->mass) / HIMC_PICKUP_PRESSURE
               : 0;
}

double himc_idiophone_loss(const himc_modes *modes, int index, double omega)
{
    const himc_idiophone *body = modes->shape.body;
    return body->mode[index].loss + body->hysteresis * omega;
}

const himc_mallet_head *himc_idiophone_mallet(const himc_shape *shape)
{
    return &shape->body->mallet;
}
