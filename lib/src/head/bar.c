/// bar.c: bars of marimba, xylophone, vibraphone, glockenspiel, and tubular bells; one, or a row of
/// naturals with one of accidentals behind it.
///
/// A bar is a beam that bends, shears and turns (Timoshenko 1921), free at its ends, of thickness
///     h(x) = h0 (1 - d (1 - |2 x/(c L)|^3)),  |2 x| < c L,
/// and h0 elsewhere: the undercut of depth d tunes mode 2 to a given ratio, the length L mode 1. It
/// is symmetric, so half of it, of elements whose shear does not lock (Przemieniecki 1968), gives
/// the even modes (no rotation in the middle) and the odd ones (no displacement there). Of a steel
/// bar of 180 x 8.5 mm it makes 1 : 2.716 : 5.21, as recorded; of a thin one 1 : 2.756 : 5.404.
///
/// A glockenspiel's bars also twist, as mallets land beside the axis: of its recorded lines of 1050
/// Hz the strongest, 6.88 times that, is the second of torsion, which gives the width. A bar lies
/// close over the bottom of its case and sounds as in a wall, and each mode loses what it sends and
/// what its cords take. Of other bars torsion, whose two sides cancel without a wall, is left out.
///
/// A tubular bell is a beam of a tube's section: modes 4, 5, 6 sound one tone, an octave below the
/// fourth, 2 : 2.89 : 3.87 of C5. It hangs, and is struck on the cap at its top, which is all
/// that is laid out of it; but all of it sounds, each mode by the mean of all directions.
///
/// Losses are S0 + b omega + S1 omega^2, found on recorded T60: of a marimba's lowest modes, 131,
/// 370 and 739 Hz, 2.07, 1.35 and 0.99 s. Sizes, mallets, and that resonators send
/// 0.3 of what a bar of wood loses and 0.6 of one of metal, which loses little itself: chosen.
#include "head/idiophone.h"

#include "base/argument.h"
#include "base/linear.h"
#include "head/air.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HALF 35 // elements of half a bar; chosen: mode 7 is exact to 0.1 %
#define POINTS (2 * HALF + 1)
#define FREE (2 * HALF + 1) // unknowns of a half: displacement and rotation at each node, less one
#define MODES 7             // of a bar; chosen: the seventh of C4 is at 9 kHz; ...
#define MODES_OF_TUBE 14    // ... of a tube
#define STRIKE 3            // the mode of a tube that is an octave over what is heard
#define CAP 3               // elements that are struck; chosen: 5 cm of C5
#define TUBES_APART 0.02    // (m); chosen
#define HIGHEST 20000.0     // (Hz) no mode above is kept
#define SHEAR (5.0 / 6)     // of a rectangular section, ...
#define SHEAR_OF_TUBE 0.5   // ... of a thin round one
#define CUT 0.62            // c; chosen: as bars look
#define DEEPEST 0.92        // of h0; chosen: no bar is thinner
#define STEPS 40            // most of a search; it takes eight
#define LENGTH 0.3          // at which it begins (m)
#define EXACT 1e-6          // of a ratio; chosen: 0.002 cent
#define GAP 0.008           // between two bars (m)
#define NODE 0.224          // of a free bar, where it lies on its cords; ...
#define CORD 1.0            // ... their resistance (N s/m); chosen: T60 of modes 2 and 3
#define SEMITONE 1.0594630943592953

// A kind of bar. Size at f: at `from`, times (from/f)^exponent.
typedef struct bar_row {
    double young, density, shear; // (Pa, kg/m^3, Pa)
    double from;                  // (Hz)
    double thickness, thinner;    // h0 there, or a tube's wall (m), and the exponent
    double width, narrower;       // (m)
    double ratio;                 // of mode 2; 0: not undercut
    bool tube;
    double constant, hysteresis, square; // of the decay
    double share;                        // of what mode 1 loses, sent by its resonator
    double low, high;                    // pitches that are made (Hz)
    himc_mallet_head mallet;
} bar_row;

#define ROSEWOOD 2.0e10, 1080, 1.35e9
#define ALUMINIUM 7.0e10, 2700, 2.6e10
#define STEEL 2.0e11, 7850, 7.7e10
#define BRASS 1.0e11, 8500, 3.7e10

#define VIBRAPHONE 2   // of the rows; tubes have dampers, too; ...
#define GLOCKENSPIEL 3 // ... in a case
#define FELT 40.0      // that they take (1/s); chosen: T60 = .17 s

// In the order of HIMC_BARS (himc/command_rows.h). Mallets: yarn, plastic, cord, hard plastic,
// rawhide.
// Losses of a tube as recorded: T60 8.1, 3.7, 1.7 s at 1402, 2043, 2768 Hz.
static const bar_row rows[] = {
    {ROSEWOOD,
     131,
     0.022,
     0.12,
     0.060,
     0.22,
     4,
     false,
     2.4,
     8e-4,
     9e-8,
     0.3,
     65,
     2100,
     {.stiffness = 1e9, .exponent = 2.2, .mass = 0.022, .relaxation = 2e-4}},
    {ROSEWOOD,
     440,
     0.021,
     0,
     0.038,
     0,
     3,
     false,
     3,
     6.5e-3,
     2e-7,
     0.3,
     174,
     4200,
     {.stiffness = 4e9, .exponent = 2, .mass = 0.020, .relaxation = 20e-6}},
    {ALUMINIUM,
     262,
     0.0127,
     0,
     0.045,
     0.25,
     4,
     false,
     0.5,
     4e-5,
     6e-9,
     0.6,
     130,
     1400,
     {.stiffness = 1e9, .exponent = 2.2, .mass = 0.022, .relaxation = 2e-4}},
    {STEEL,
     880,
     0.0085,
     0,
     0.0317,
     0,
     0,
     false,
     0.3,
     8e-5,
     0,
     0,
     390,
     4200,
     {.stiffness = 2e9, .exponent = 1.5, .mass = 0.008, .relaxation = 2e-6}},
    {BRASS,
     523,
     0.0015,
     0,
     0.038,
     0,
     0,
     true,
     0.2,
     0,
     1.2e-8,
     0,
     250,
     800,
     {.stiffness = 1.2e10, .exponent = 2, .mass = 0.1}},
};

// a bar as it is being tuned
typedef struct bar {
    const bar_row *row;
    double length, thickness, width, depth;
    double k[FREE * FREE], m[FREE * FREE];         // of a half
    double lambda[2][FREE], shape[2][FREE * FREE]; // of the even, of the odd modes
} bar;

// adds an element of length l at node i of the half; unknown -1 does not move
static void add_element(bar *b, bool odd, int i)
{
    const bar_row *r = b->row;
    double l = 0.5 * b->length / HALF, out = 2 * (i + 0.5) * l / (CUT * b->length);
    double h = b->thickness * (out < 1 ? 1 - b->depth * (1 - out * out * out) : 1);
    double hollow = b->width - 2 * h, area = b->width * h, turning = h * h / 12; // gyration^2
    if (r->tube) {
        area = HIMC_PI * h * (b->width - h);
        turning = (b->width * b->width + hollow * hollow) / 16;
    }
    double bending = r->young * area * turning;
    double phi = 12 * bending / ((r->tube ? SHEAR_OF_TUBE : SHEAR) * r->shear * area * l * l),
           s = bending / (l * l * l * (1 + phi));
    double mass = r->density * area * l / 420, turn = r->density * area * turning / (30 * l);
    const double k[4][4] = {{12, 6 * l, -12, 6 * l},
                            {6 * l, (4 + phi) * l * l, -6 * l, (2 - phi) * l * l},
                            {-12, -6 * l, 12, -6 * l},
                            {6 * l, (2 - phi) * l * l, -6 * l, (4 + phi) * l * l}};
    const double m[4][4] = {{156, 22 * l, 54, -13 * l},
                            {22 * l, 4 * l * l, 13 * l, -3 * l * l},
                            {54, 13 * l, 156, -22 * l},
                            {-13 * l, -3 * l * l, -22 * l, 4 * l * l}};
    const double t[4][4] = {{36, 3 * l, -36, 3 * l},
                            {3 * l, 4 * l * l, -3 * l, -l * l},
                            {-36, -3 * l, 36, -3 * l},
                            {3 * l, -l * l, -3 * l, 4 * l * l}};
    for (int p = 0; p < 4; p++)
        for (int q = 0; q < 4; q++) {
            // in the middle an even mode has no rotation (1), an odd one no displacement (0)
            int at = 2 * i + p - 1, to = 2 * i + q - 1;
            bool held = i == 0 && (p == !odd || q == !odd);
            if (i == 0 && p == 0)
                at = 0;
            if (i == 0 && q == 0)
                to = 0;
            if (held)
                continue;
            b->k[at * FREE + to] += s * k[p][q];
            b->m[at * FREE + to] += mass * m[p][q] + turn * t[p][q];
        }
}

// the even or the odd modes; a search needs no shapes, which take most of the time
static bool solve(bar *b, bool odd, bool shapes, himc_error *error)
{
    memset(b->k, 0, sizeof b->k);
    memset(b->m, 0, sizeof b->m);
    for (int i = 0; i < HALF; i++)
        add_element(b, odd, i);
    return himc_linear_vibrations(FREE, b->k, b->m, b->lambda[odd],
                                  shapes ? b->shape[odd] : NULL) == HIMC_LINEAR_SOLVED ||
           himc_error_set(error, "bar: no modes found");
}

// Of mode i, 0 .. : the first of the even ones and of the odd ones move without bending.
static double frequency(const bar *b, int i)
{
    return sqrt(fmax(b->lambda[i % 2][i / 2 + 1], 0)) / (2 * HIMC_PI);
}

// that is heard
static double pitch(const bar *b)
{
    return b->row->tube ? 0.5 * frequency(b, STRIKE) : frequency(b, 0);
}

// Finds the length at which mode 1 sounds there, about as 1/L^2; `ratio`: of mode 2 then.
static bool find_length(bar *b, double hz, double *ratio, himc_error *error)
{
    bool odd = b->row->tube; // is the mode that is heard
    for (int i = 0; i < STEPS; i++) {
        if (!solve(b, odd, false, error))
            return false;
        double off = pitch(b) / hz;
        if (fabs(off - 1) < EXACT) {
            bool good = solve(b, !odd, false, error);
            *ratio = frequency(b, 1) / frequency(b, 0);
            return good;
        }
        b->length *= sqrt(off);
    }
    return himc_error_set(error, "bar: %g Hz cannot be tuned", hz);
}

// Finds the depth by false position (Illinois): a deeper cut has a higher ratio.
static bool tune(bar *b, double hz, himc_error *error)
{
    double goal = b->row->ratio, low = 0, high = DEEPEST, below, above, ratio;
    b->length = LENGTH;
    b->depth = high;
    if (goal > 0 && !find_length(b, hz, &above, error))
        return false;
    b->depth = low;
    if (!find_length(b, hz, &below, error))
        return false;
    for (int i = 0, side = 0; goal > 0 && i < STEPS; i++) {
        b->depth = low + (high - low) * (goal - below) / (above - below);
        if (!(b->depth > 0 && b->depth < DEEPEST))
            break;
        if (!find_length(b, hz, &ratio, error))
            return false;
        if (fabs(ratio / goal - 1) < EXACT)
            return true;
        bool over = ratio > goal;
        *(over ? &high : &low) = b->depth;
        *(over ? &above : &below) = ratio;
        if (side == (over ? 1 : -1)) // the other end has stayed twice
            *(over ? &below : &above) = 0.5 * (goal + (over ? below : above));
        side = over ? 1 : -1;
    }
    return goal == 0 || himc_error_set(error, "bar: %g Hz cannot be tuned", hz);
}

// of the mode at the points from end to end
static void find_shape(const bar *b, int i, double *shape)
{
    bool odd = i % 2;
    const double *v = b->shape[odd] + (size_t)(i / 2 + 1) * FREE;
    for (int node = 0; node <= HALF; node++) {
        double w = node > 0 ? v[2 * node - 1] : odd ? 0 : v[0];
        shape[HALF + node] = w / sqrt(2); // v is of half the mass
        shape[HALF - node] = odd ? -shape[HALF + node] : shape[HALF + node];
    }
}

// Of a mode of a tube at 1 m per acceleration (Pa s^2/m): the root mean square of all directions of
// what idiophone.c says of a strip.
static double pressure(const bar *b, double omega, const double *shape)
{
    enum { DIRECTIONS = 24 };
    double wave = omega / HIMC_AIR_SPEED, step = b->length / (POINTS - 1), sum = 0;
    for (int k = 0; k < DIRECTIONS; k++) {
        double even = 0, odd = 0, along = wave * step * (k + 0.5) / DIRECTIONS; // of a sphere
        for (int i = 0; i < POINTS; i++) {
            double part = shape[i] * step * (i == 0 || i == POINTS - 1 ? 0.5 : 1);
            even += part * cos(along * i);
            odd += part * sin(along * i);
        }
        sum += (even * even + odd * odd) / DIRECTIONS;
    }
    return HIMC_AIR_DENSITY * b->width / (2 * HIMC_PI) * fmin(1, HIMC_PI / 8 * wave * b->width) *
           sqrt(sum);
}

// the note that is nearest
static void name_part(himc_part *part, double hz)
{
    char note[HIMC_NOTE_SIZE] = "";
    int key = (int)lround(12 * log2(hz / 440)) + 12 * 4 + 9; // from C0
    himc_note_name(440 * pow(2, (key % 12 - 9) / 12.0 + (key / 12 - 4)), note);
    snprintf(part->name, sizeof part->name, "%s", note);
}

// Of a mode of a bar in a case, as in a wall, the same: rho/(2 pi) |int phi exp(i k . x) dx dy|,
// all directions of half a sphere, whose four quarters are alike.
static double walled(const bar *b, double omega, const double *shape, bool twists)
{
    enum { RINGS = 6, SPOKES = 6 };
    double wave = omega / HIMC_AIR_SPEED, step = b->length / (POINTS - 1), sum = 0;
    for (int k = 0; k < RINGS * SPOKES; k++) {
        double height = (k / SPOKES + 0.5) / RINGS, flat = wave * sqrt(1 - height * height);
        double azimuth = HIMC_PI / 2 * (k % SPOKES + 0.5) / SPOKES, even = 0, odd = 0;
        double along = flat * cos(azimuth) * step, u = flat * sin(azimuth) * b->width / 2;
        double across = twists ? (sin(u) - u * cos(u)) / (u * u) : sin(u) / u;
        for (int i = 0; i < POINTS; i++) {
            double part = shape[i] * step * (i == 0 || i == POINTS - 1 ? 0.5 : 1);
            even += part * cos(along * i);
            odd += part * sin(along * i);
        }
        sum += across * across * (even * even + odd * odd) / (RINGS * SPOKES);
    }
    return HIMC_AIR_DENSITY * b->width / (2 * HIMC_PI) * sqrt(sum);
}

// what such a mode loses by its sound, 2 d m v^2/2 = 2 pi p^2/(rho c) of half a sphere (1/s)
static double sent(double pressure, double omega, double mass)
{
    return HIMC_PI * pow(pressure * omega, 2) / (HIMC_AIR_DENSITY * HIMC_AIR_SPEED * mass);
}

// A mode that twists a bar in a case, n half waves from end to end: theta = cos(n pi x/L), at
// n/(2 L) sqrt(G K/(rho I)), K = b h^3/3 (1 - .63 h/b), I = b h (b^2 + h^2)/12.
static himc_partial twist(const bar *b, int n, double *shape)
{
    double h = b->thickness, flat = h / b->width, square = flat * flat;
    double speed =
        sqrt(b->row->shear / b->row->density * 4 * square * (1 - 0.63 * flat) / (1 + square));
    double mass = b->row->density * h * b->width * b->length;
    himc_partial mode = {
        .frequency = n * speed / (2 * b->length), .mass = mass * (1 + square) / 6, .twists = true};
    for (int i = 0; i < POINTS; i++)
        shape[i] = cos(n * HIMC_PI * i / (POINTS - 1));
    mode.pressure = walled(b, 2 * HIMC_PI * mode.frequency, shape, true);
    mode.loss = sent(mode.pressure, 2 * HIMC_PI * mode.frequency, mode.mass);
    return mode;
}

static bool add_bar(himc_idiophone *body, bar *b, double hz, himc_error *error)
{
    const bar_row *r = b->row;
    himc_part part;
    double shape[POINTS];
    b->thickness = r->thickness * pow(r->from / hz, r->thinner);
    b->width = r->width * pow(r->from / hz, r->narrower);
    if (!tune(b, hz, error) || !solve(b, false, true, error) || !solve(b, true, true, error))
        return false;
    int modes = r->tube ? MODES_OF_TUBE : MODES, from = r->tube ? POINTS - 1 - CAP : 0;
    part =
        (himc_part){.length = b->length * (r->tube ? CAP / (POINTS - 1.0) : 1), .width = b->width};
    name_part(&part, hz);
    if (!himc_idiophone_add_part(body, &part, error))
        return false;
    for (int i = 0; i < modes && frequency(b, i) < HIGHEST; i++) {
        himc_partial mode = {
            .frequency = frequency(b, i), .mass = 1, .share = i == 0 ? r->share : 0};
        find_shape(b, i, shape);
        double omega = 2 * HIMC_PI * mode.frequency;
        if (r->tube)
            mode.pressure = pressure(b, omega, shape);
        if (r == &rows[GLOCKENSPIEL])
            mode.loss = sent(walled(b, omega, shape, false), omega, mode.mass) +
                        CORD * pow(shape[(int)lround(NODE * (POINTS - 1))], 2);
        if (!himc_idiophone_add_mode(body, mode, shape + from, POINTS - from, error))
            return false;
    }
    for (int n = 1; r == &rows[GLOCKENSPIEL]; n++) {
        himc_partial mode = twist(b, n, shape);
        if (mode.frequency > HIGHEST)
            break;
        if (!himc_idiophone_add_mode(body, mode, shape, POINTS, error))
            return false;
    }
    return true;
}

static bool is_natural(const himc_part *part)
{
    return part->name[1] != '#';
}

// The low bars are on the left; an accidental is behind the gap that it belongs to. In each row the
// middles of the bars are in a line.
static void lay_out(himc_idiophone *body, double gap)
{
    double y = 0, reach[2] = {0};
    for (int i = 0; i < body->parts; i++) {
        himc_part *p = &body->part[i];
        double *of_row = &reach[is_natural(p)];
        *of_row = fmax(*of_row, p->length / 2);
        if (is_natural(p)) {
            p->y = y - p->width / 2;
            y -= p->width + gap;
        } else {
            p->y = y + gap / 2;
        }
    }
    for (int i = 0; i < body->parts; i++)
        body->part[i].x = is_natural(&body->part[i]) ? 0 : reach[0] + reach[1] + gap;
}

// of bars from a pitch to another in semitones
static himc_idiophone *make(const bar_row *row, const char *name, double low, double high,
                            himc_error *error)
{
    himc_idiophone *body = himc_idiophone_new(name, error);
    bar *b = calloc(1, sizeof *b);
    bool good = body && b;
    if (body && !b)
        himc_error_set(error, "bar: out of memory");
    int bars = 1 + (int)lround(log(high / low) / log(SEMITONE));
    for (int i = 0; good && i < bars; i++) {
        b->row = row;
        good = add_bar(body, b, low * pow(SEMITONE, i), error);
    }
    free(b);
    if (!good) {
        himc_shape_release(&(himc_shape){.body = body});
        return NULL;
    }
    body->pitches[0] = low;
    body->pitches[1] = high > low ? high : 0;
    body->constant = row->constant;
    body->hysteresis = row->hysteresis;
    body->square = row->square;
    body->mallet = row->mallet;
    body->dampers = row->tube || row == &rows[VIBRAPHONE] ? FELT : 0;
    body->pedal_lifts = true;
    body->discs = row == &rows[VIBRAPHONE];
    body->cased = row == &rows[GLOCKENSPIEL];
    if (row->tube)
        body->principal = low;
    lay_out(body, row->tube ? TUBES_APART : GAP);
    himc_idiophone_finish(body);
    return body;
}

static bool read(const himc_command *c, himc_shape *shape, himc_error *error)
{
    const bar_row *row = &rows[c->choice[1]];
    double low = c->atom[2].number, high = c->count > 3 ? c->atom[3].number : low;
    const char *name = c->atom[1].symbol;
    if (!himc_check_range(name, low, row->low, row->high, "Hz", error) ||
        !himc_check_range(name, high, low, row->high, "Hz", error))
        return false;
    shape->body = make(row, name, low, high, error);
    return shape->body;
}

const himc_kind himc_kind_bar = {.name = "bar", .read = read, HIMC_IDIOPHONE_KIND};
