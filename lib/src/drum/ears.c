/// ears.c: the air between a drum and two ears: time, distance, the head's shadow, the floor.
///
/// A drum sends a ray to each ear, with the directivity of each mode in that direction (pickup.c),
/// and one to the floor. The floor is a mirror: the ray that it returns comes from the drum's image
/// below it, with the time and distance from there, weaker by FLOOR and by what a carpeted or
/// wooden floor takes of high frequencies. A drum's lower side is no baffle: below the plane of the
/// rim a direction has BELOW of the power (boundary elements: 0.64 to 0.73).
///
/// The head is a sphere of radius h around the listener's place. To an ear on it, the sound has the
/// way of Woodworth's formula: with t the angle between the ear's axis and the source, R from the
/// middle of the head,
///     r = R - h cos t (t < pi/2),   r = R + h (t - pi/2) beyond,
/// so that a source at the side has ears (h/c)(pi/2 + 1) apart, 0.66 ms. Time is r/c, gain 1/r. The
/// shadow is Brown and Duda's filter (1998) of one pole and one zero,
///     H = (1 + i a w/2w0)/(1 + i w/2w0),   w0 = c/h,   a = 1.05 + 0.95 cos(1.2 t),
/// which is a + (1 - a) L with one L for all sources: each ear has one L, whatever it hears.
///
/// What an ear hears of a drum, with its gain, is bent above half of full scale and never passes
/// it, as a sound card would cut it off: |y| = 1/2 + tanh(2 |x| - 1)/2. A lower gain leaves it
/// alone.
///
/// A time between two samples is Lagrange's cubic through four. When paths change, the old and the
/// new are both heard for a moment: no delay line ever jumps or slides. All is counted in samples,
/// so how many are asked for at a time does not matter.
#include "drum/ears.h"

#include "base/head_frame.h"
#include "head/air.h"

#include <math.h>
#include <string.h>

#define HEAD_RADIUS 0.0875 // h (m), Brown & Duda 1998
#define SHADOW_ANGLE 1.2   // 180/150 degrees: the darkest place lies before the far end; as there
#define SHADOW_MEAN 1.05   // as there, (1 + 0.1/2)
#define SHADOW_DEPTH 0.95  // as there, (1 - 0.1/2)
#define KEPT 2             // (fades) that part is longer than the paths; chosen: 10 ms, or 3 m
#define FLOOR 0.9          // chosen: a wooden floor returns nine tenths
#define FLOOR_CORNER 4e3   // (Hz) chosen: what it takes of high frequencies
#define BELOW 0.7          // of the power, below the rim
#define NEAREST HIMC_PICKUP_DISTANCE_MIN // (m) a far field holds no nearer
#define FADE 0.005                       // (s) chosen: no click, and no two places for long
#define AFTER 1024 // samples until the filters have forgotten; chosen: 1e-18 of it at 192 kHz

himc_listener himc_listener_at(himc_vec3 place)
{
    bool there = place.x == 0 && place.y == 0;
    return (himc_listener){true, false, place, there ? 0 : atan2(-place.y, -place.x)};
}

himc_listener himc_listener_usual(void)
{
    himc_listener usual = himc_listener_at(himc_vec3_make(2.3, 0.5, 1.3)); // (m) chosen
    usual.yields = true;
    return usual;
}

bool himc_listener_hears(const himc_listener *listener, bool picked)
{
    return listener->on && !(listener->yields && picked);
}

bool himc_listener_equal(const himc_listener *a, const himc_listener *b)
{
    return a->on == b->on &&
           (!a->on || (a->yields == b->yields && a->place.x == b->place.x &&
                       a->place.y == b->place.y && a->place.z == b->place.z && a->yaw == b->yaw));
}

// unit vector from the middle of the head out of an ear
static himc_vec3 ear_axis(const himc_listener *l, int ear)
{
    double side = ear == HIMC_EAR_LEFT ? 1 : -1;
    return himc_vec3_make(-side * sin(l->yaw), side * cos(l->yaw), 0);
}

// the ray that leaves a head for a point of the world, and whether it goes below the rim
static himc_pickup ray_to(const himc_head_frame *frame, himc_vec3 point, bool *below)
{
    himc_vec3 to = himc_head_frame_from_world(frame, point);
    *below = to.z < 0;
    return (himc_pickup){.kind = HIMC_PICKUP_AIR,
                         .azimuth = atan2(to.y, to.x),
                         .elevation = atan2(fabs(to.z), hypot(to.x, to.y)),
                         .distance = fmax(himc_vec3_length(to), NEAREST)};
}

// from a source to an ear
static himc_ear_path path_to(const himc_listener *l, int ear, himc_vec3 source, double strength)
{
    himc_vec3 to = himc_vec3_sub(source, l->place);
    double distance = himc_vec3_length(to);
    double side = distance > 0 ? himc_vec3_dot(ear_axis(l, ear), to) / distance : 0;
    double angle = acos(fmin(fmax(side, -1), 1));
    double around = side > 0 ? -side : angle - HIMC_PI / 2;
    double way = fmax(distance + HEAD_RADIUS * around, NEAREST);
    return (himc_ear_path){.delay = way / HIMC_AIR_SPEED,
                           .gain = strength * HIMC_EARS_LEVEL / way,
                           .shelf = SHADOW_MEAN + SHADOW_DEPTH * cos(SHADOW_ANGLE * angle)};
}

static himc_vec3 mirrored(himc_vec3 point)
{
    return himc_vec3_make(point.x, point.y, -point.z);
}

himc_ear_paths himc_ears_trace(const himc_listener *l, const himc_head_frame *frame)
{
    himc_ear_paths p;
    bool below;
    p.ray[HIMC_RAY_FLOOR] = ray_to(frame, mirrored(l->place), &below);
    double returned = FLOOR * (below ? sqrt(BELOW) : 1);
    for (int ear = 0; ear < HIMC_EARS; ear++) {
        himc_vec3 at = himc_vec3_madd(l->place, HEAD_RADIUS, ear_axis(l, ear));
        p.floor[ear] = path_to(l, ear, mirrored(frame->center), returned);
        p.floor[ear].delay -= 1 / (2 * HIMC_PI * FLOOR_CORNER); // the filter's own
        p.ray[HIMC_RAY_LEFT + ear] = ray_to(frame, at, &below);
        p.direct[ear] = path_to(l, ear, frame->center, below ? sqrt(BELOW) : 1);
    }
    return p;
}

// Lagrange's weights for `x` of a sample (0 .. 1) after the second of four
static himc_ear_tap tap_of(const himc_ear_path *path, double rate)
{
    double samples = fmin(path->delay * rate, HIMC_EARS_LINE - 4), x = samples - floor(samples);
    himc_ear_tap t = {.whole = (int)floor(samples), .shelf = path->shelf};
    t.weight[0] = -path->gain * x * (x - 1) * (x - 2) / 6;
    t.weight[1] = path->gain * (x + 1) * (x - 1) * (x - 2) / 2;
    t.weight[2] = -path->gain * (x + 1) * x * (x - 2) / 2;
    t.weight[3] = path->gain * (x + 1) * x * (x - 1) / 6;
    return t;
}

// the trapezoidal rule for a pole at `hz`; the state stays
static void set_pole(himc_one_pole *p, double hz, double rate)
{
    double q = HIMC_PI * hz / rate;
    p->keep = (1 - q) / (1 + q);
    p->take = q / (1 + q);
}

static double low_pass(himc_one_pole *p, double x)
{
    p->y = p->keep * p->y + p->take * (x + p->x);
    p->x = x;
    return p->y;
}

static void forget(himc_one_pole *p)
{
    p->x = p->y = 0;
}

static int longest(const himc_ear_taps *taps)
{
    int most = 0;
    for (int ear = 0; ear < HIMC_EARS; ear++) {
        most = taps->direct[ear].whole > most ? taps->direct[ear].whole : most;
        most = taps->floor[ear].whole > most ? taps->floor[ear].whole : most;
    }
    return most;
}

// Only a part of each line is in use: as much as the paths reach back, and some for the next
// ones. It gets longer if these need more, and is silent where it has no sound so old.
static void set_span(himc_ears *e, const himc_ear_taps *taps)
{
    int before = e->span, needed = longest(taps) + 2 * HIMC_ROOM_RUN + (int)(KEPT / e->step);
    e->span = before > 0 ? before : 1;
    while (e->span < needed && e->span < HIMC_EARS_LINE)
        e->span *= 2;
    for (int k = 1; k <= e->span && e->span > before; k++) {
        int at = (e->at - k) & (e->span - 1), was = (e->at - k) & (before - 1);
        for (int ray = 0; ray < HIMC_RAYS; ray++)
            e->line[ray][at] = k <= before ? e->line[ray][was] : 0;
    }
}

void himc_ears_set(himc_ears *e, const himc_ear_paths *paths, const himc_walls *walls, double rate)
{
    e->step = 1 / (FADE * rate);
    set_pole(&e->floor, FLOOR_CORNER, rate);
    for (int ear = 0; ear < HIMC_EARS; ear++) {
        set_pole(&e->shadow[ear], HIMC_AIR_SPEED / HEAD_RADIUS / HIMC_PI, rate); // 2 w0
        e->next.direct[ear] = tap_of(&paths->direct[ear], rate);
        e->next.floor[ear] = tap_of(&paths->floor[ear], rate);
    }
    e->changes = himc_ears_heard(e);
    if (!e->changes) { // begins to listen, to an empty room
        e->span = 0;
        set_span(e, &e->next);
        forget(&e->shadow[HIMC_EAR_LEFT]);
        forget(&e->shadow[HIMC_EAR_RIGHT]);
        forget(&e->floor);
        e->faded = 1;
        e->now = e->next;
        e->reach = longest(&e->now);
        e->at = e->silent = 0;
        himc_room_leave(&e->room);
    }
    himc_room_set(&e->room, walls, rate);
    e->on = true;
}

void himc_ears_close(himc_ears *e)
{
    e->on = false;
}

bool himc_ears_at_rest(const himc_ears *e)
{
    return e->silent >= HIMC_EARS_LINE && e->faded == 1 && !e->changes &&
           e->level == (e->on ? 1 : 0) && himc_room_at_rest(&e->room);
}

// what a path brings in n samples from `at` on: each is four of its line
static void arrive(const himc_ears *e, int ray, const himc_ear_tap *tap, int n, double *out)
{
    double around[HIMC_ROOM_RUN + 3];
    int first = (e->at - tap->whole - 2) & (e->span - 1), more = first + n + 3 - e->span;
    const double *x = e->line[ray] + first;
    if (more > 0) { // the line ends in between
        memcpy(around, x, (size_t)(n + 3 - more) * sizeof *x);
        memcpy(around + n + 3 - more, e->line[ray], (size_t)more * sizeof *x);
        x = around;
    }
    for (int i = 0; i < n; i++)
        out[i] = tap->weight[0] * x[i + 3] + tap->weight[1] * x[i + 2] + tap->weight[2] * x[i + 1] +
                 tap->weight[3] * x[i];
}

// an ear's sound as it passes the head, and as its filter takes it
typedef struct ear_sound {
    double passing[HIMC_ROOM_RUN], filtered[HIMC_ROOM_RUN];
} ear_sound;

// adds `part` of what the paths bring to an ear
static void gather(const himc_ears *e, const himc_ear_taps *taps, int ear, double part, int n,
                   ear_sound *sound)
{
    double direct[HIMC_ROOM_RUN], floor[HIMC_ROOM_RUN];
    double shelf = taps->direct[ear].shelf, floor_shelf = taps->floor[ear].shelf;
    arrive(e, ear, &taps->direct[ear], n, direct);
    arrive(e, HIMC_RAY_FLOOR, &taps->floor[ear], n, floor);
    for (int i = 0; i < n; i++) {
        double near = part * direct[i], far = part * floor[i];
        sound->passing[i] += shelf * near + floor_shelf * far;
        sound->filtered[i] += (1 - shelf) * near + (1 - floor_shelf) * far;
    }
}

static double smooth(double x)
{
    return x * x * (3 - 2 * x);
}

// takes n samples of each ray into the lines, from `at` on
static void take_in(himc_ears *e, int n, double *const *ray)
{
    himc_one_pole carpet = e->floor;
    int quiet = e->silent;
    for (int i = 0; i < n; i++) {
        double left = ray[HIMC_RAY_LEFT][i], right = ray[HIMC_RAY_RIGHT][i];
        double floor = ray[HIMC_RAY_FLOOR][i];
        int at = (e->at + i) & (e->span - 1);
        bool silent = left == 0 && right == 0 && floor == 0;
        quiet = !silent ? 0 : quiet < HIMC_EARS_LINE ? quiet + 1 : quiet;
        if (quiet == AFTER)
            forget(&carpet);
        e->line[HIMC_RAY_LEFT][at] = left;
        e->line[HIMC_RAY_RIGHT][at] = right;
        e->line[HIMC_RAY_FLOOR][at] = low_pass(&carpet, floor);
    }
    e->floor = carpet;
    e->silent = quiet;
}

// n samples of both ears at present
static void hear(himc_ears *e, int n, double *const *out)
{
    ear_sound sound[HIMC_EARS];
    double part = smooth(e->faded);
    bool silent = e->silent > e->reach + 2 * AFTER;
    for (int ear = 0; ear < HIMC_EARS; ear++) {
        memset(sound[ear].passing, 0, (size_t)n * sizeof(double));
        memset(sound[ear].filtered, 0, (size_t)n * sizeof(double));
        if (silent)
            forget(&e->shadow[ear]);
        if (!silent && e->faded < 1)
            gather(e, &e->before, ear, 1 - part, n, &sound[ear]);
        if (!silent)
            gather(e, &e->now, ear, part, n, &sound[ear]);
    }
    himc_one_pole left = e->shadow[HIMC_EAR_LEFT], right = e->shadow[HIMC_EAR_RIGHT];
    for (int i = 0; i < n; i++) { // neither filter waits for the other
        out[HIMC_EAR_LEFT][i] =
            sound[HIMC_EAR_LEFT].passing[i] + low_pass(&left, sound[HIMC_EAR_LEFT].filtered[i]);
        out[HIMC_EAR_RIGHT][i] =
            sound[HIMC_EAR_RIGHT].passing[i] + low_pass(&right, sound[HIMC_EAR_RIGHT].filtered[i]);
    }
    e->shadow[HIMC_EAR_LEFT] = left;
    e->shadow[HIMC_EAR_RIGHT] = right;
}

// of the next n samples those that are heard in one way: nothing fades, and no silence gets so long
// that it counts
static int steady(const himc_ears *e, int n)
{
    n = n < HIMC_ROOM_RUN ? n : HIMC_ROOM_RUN;
    bool fades = e->changes || e->faded < 1 || e->level != (e->on ? 1 : 0);
    if (fades || e->silent + n > e->reach + 2 * AFTER)
        return 1;
    return himc_room_steady(&e->room, n);
}

// never above full scale once it has that gain
static double bend(double x, double gain)
{
    double loud = gain * fabs(x) - HIMC_EARS_LINEAR;
    return loud <= 0 ? x : copysign((0.5 + 0.5 * tanh(2 * loud)) / gain, x);
}

void himc_ears_hear(himc_ears *e, int n, double *const *rays, double *const *rows, double gain)
{
    static double silence[HIMC_ROOM_RUN];
    for (int from = 0, run; from < n; from += run) {
        double *ray[HIMC_RAYS], heard[HIMC_EARS][HIMC_ROOM_RUN], walls[HIMC_EARS][HIMC_ROOM_RUN];
        for (int k = 0; k < HIMC_RAYS; k++)
            ray[k] = rays ? rays[k] + from : silence;
        if (e->changes && e->faded == 1) {
            int before = longest(&e->now), now = longest(&e->next);
            e->changes = false;
            e->before = e->now;
            e->now = e->next;
            set_span(e, &e->now);
            e->reach = before > now ? before : now;
            e->faded = 0;
        }
        run = steady(e, n - from);
        e->level = fmin(fmax(e->level + (e->on ? e->step : -e->step), 0), 1);
        e->faded = fmin(e->faded + e->step, 1);
        take_in(e, run, ray);
        hear(e, run, (double *[]){heard[0], heard[1]});
        if (himc_room_heard(&e->room))
            himc_room_hear(&e->room, run, ray, (double *[]){walls[0], walls[1]});
        else
            memset(walls, 0, sizeof walls);
        double level = smooth(e->level);
        for (int k = 0; k < HIMC_EARS; k++)
            for (int i = 0; i < run; i++) {
                double ear = bend(heard[k][i] + HIMC_EARS_LEVEL * walls[k][i], gain);
                rows[k][from + i] = rows[k][from + i] * (1 - level) + level * ear;
            }
        e->at = (e->at + run) & (HIMC_EARS_LINE - 1);
    }
}
