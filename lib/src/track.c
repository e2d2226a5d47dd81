/// track.c: local cubic fits give each frame position, velocity and acceleration; quintics join
/// the frames.
///
/// The fit at a frame uses the frames within +-WINDOW seconds on the same side of every strike
/// (least squares, one-sided near a strike), so noise is smoothed before it is differentiated and
/// no impact is smeared. A strike's frames from CUT before its lowest point to CUT after are
/// dropped. Approach: from the last good frame to the head's plane with an acceleration that
/// fades to nothing there gives the time of contact. Then a bridge: a quintic from there to where
/// the capture is rejoined; the bridge is what control sees while it is released, and is replaced
/// at separation by one from the measured state.
#include "himc/track.h"
#include "himc/quintic.h"

#include <stdlib.h>
#include <string.h>

#define WINDOW 0.025      // half width of the local fits (s)
#define EDGE 5            // frames of the one-sided fit beside a strike, less one
#define CUT 0.0125        // of the capture around a strike's lowest point (s)
#define TOO_LATE 0.015    // with less of the take left, its bridge is left as it is (s)
#define REJOIN 0.040      // from separation back to the capture (s)
#define LONGEST_FALL 0.03 // the approach is carried on at most so long (s)
#define SETTLE 0.4        // from a stop to rest (s)
#define EASE 0.1          // at both ends of the take time starts and stops so slowly (s)
#define SLOWEST 0.2       // pace of a take's time from which on nothing is replanned
#define HOVER 0.08        // of a tip at rest above the head (m)
#define LEAST_FRAMES 8
#define MAX_STRIKES 4096

typedef struct bridge {
    double contact, from, to; // time of contact; the bridge replaces the capture in [from, to) (s)
    himc_vec3 place;          // of the contact (m)
    himc_quintic approach;    // from `from` to `contact`
    himc_quintic path;        // from `contact`, or once struck from `restart`, to `to`
    double restart;           // when the tip left the head (s); `from` until then
} bridge;

typedef struct hand_track {
    bool present;
    himc_target *frame;        // (frames)
    bridge *bridges, *planned; // as they are played, as they were built
    int bridge_count;
    himc_quintic approach, settle; // before the first frame; after a stop
    double approach_time;          // length of the approach (s), 0 if there is none
} hand_track;

struct himc_track {
    double rate;
    int frames;
    himc_vec3 offset;
    himc_place place;
    double stop; // where the take is left (s); infinite if it is not
    hand_track hand[HIMC_HANDS];
};

// least squares polynomial of `order` coefficients through the frames range[0] .. range[2] about
// frame range[1]: the normal equations by Gauss elimination; fewer coefficients when there are
// few frames
static bool fit_polynomial(const himc_vec3 *x, const int range[3], int order, double dt,
                           himc_target *out)
{
    int lo = range[0], k = range[1], hi = range[2];
    double a[4][7] = {{0}};
    for (int i = lo; i <= hi; i++) {
        double u = (i - k), p[4] = {1, u, u * u, u * u * u}, v[3] = {x[i].x, x[i].y, x[i].z};
        for (int r = 0; r < 4; r++) {
            for (int c = 0; c < 4; c++)
                a[r][c] += p[r] * p[c];
            for (int c = 0; c < 3; c++)
                a[r][4 + c] += p[r] * v[c];
        }
    }
    int most = hi - lo >= 5 ? 4 : hi - lo >= 3 ? 3 : hi - lo >= 1 ? 2 : 1;
    order = order < most ? order : most;
    for (int r = 0; r < order; r++) {
        if (fabs(a[r][r]) < 1e-12)
            return false;
        for (int s = 0; s < order; s++) {
            double f = s == r ? 0 : a[s][r] / a[r][r];
            for (int c = 0; c < 7; c++)
                a[s][c] -= f * a[r][c];
        }
    }
    double c[4][3] = {{0}};
    for (int r = 0; r < order; r++)
        for (int d = 0; d < 3; d++)
            c[r][d] = a[r][4 + d] / a[r][r];
    out->x = himc_vec3_make(c[0][0], c[0][1], c[0][2]);
    out->v = himc_vec3_scale(himc_vec3_make(c[1][0], c[1][1], c[1][2]), 1 / dt);
    out->a = himc_vec3_scale(himc_vec3_make(c[2][0], c[2][1], c[2][2]), 2 / (dt * dt));
    return true;
}

// frames lo..hi: one stretch between strikes
static void fit_stretch(hand_track *h, const himc_vec3 *x, int lo, int hi, int frames, double rate)
{
    int reach = (int)fmax(3, WINDOW * rate);
    for (int k = lo; k <= hi; k++) {
        int first = k - reach < lo ? lo : k - reach, last = k + reach > hi ? hi : k + reach;
        int order = k == lo || k == hi ? 3 : 4; // a parabola is not thrown as far as a cubic
        if (k == hi && hi < frames - 1 && k - EDGE > lo)
            first = k - EDGE;
        if (k == lo && lo > 0 && k + EDGE < hi)
            last = k + EDGE;
        if (!fit_polynomial(x, (int[]){first, k, last}, order, 1 / rate, &h->frame[k]))
            h->frame[k] = (himc_target){.x = x[k]};
    }
}

// when the approach from frame state `s` reaches the head, its acceleration fading to nothing on
// the way: the first root of height + v t + a t^2 / 3
static double fall_time(const himc_place *place, const himc_target *s, double mallet_radius)
{
    himc_vec3 n = himc_place_normal(place);
    double height = himc_place_from_world(place, s->x).z - mallet_radius;
    double v = himc_vec3_dot(n, s->v), a = himc_vec3_dot(n, s->a),
           under = v * v - 4 / 3.0 * a * height;
    if (v >= 0 || under < 0)
        return LONGEST_FALL;
    return fmin(2 * height / (-v + sqrt(under)), LONGEST_FALL);
}

static himc_target captured_at(const himc_track *track, const hand_track *h, double t)
{
    double u = t * track->rate;
    int k = (int)floor(u);
    if (k < 0)
        return (himc_target){.x = h->frame[0].x};
    if (k >= track->frames - 1) {
        k = track->frames - 2;
        u = k + 1;
    }
    const himc_target *a = &h->frame[k], *b = &h->frame[k + 1];
    himc_quintic q = himc_quintic_make(a, b, 1 / track->rate);
    return himc_quintic_at(&q, (u - k) / track->rate);
}

static void make_bridge(himc_track *track, hand_track *h, bridge *b, int last, int next,
                        double mallet_radius)
{
    himc_target before = h->frame[last];
    double start = last / track->rate,
           fall = fmax(fall_time(&track->place, &before, mallet_radius), 0);
    b->approach = (himc_quintic){{before.x, before.v, himc_vec3_scale(before.a, 0.5)}};
    if (fall > 0)
        b->approach.c[3] = himc_vec3_scale(before.a, -1 / (6 * fall));
    himc_target touch = himc_quintic_at(&b->approach, fall);
    b->from = b->restart = start;
    b->contact = start + fall;
    b->to = fmax(next / track->rate, b->contact + 0.02);
    b->to = fmin(b->to, (track->frames - 1) / track->rate);
    himc_target after = captured_at(track, h, b->to);
    b->place = himc_place_from_world(&track->place, touch.x);
    touch.a = himc_vec3_make(0, 0, 0);
    b->path = himc_quintic_make(&touch, &after, b->to - b->contact);
}

// carried a little further, to a standstill; a tip that falls is caught above the head
static himc_quintic come_to_rest(const himc_place *place, const himc_target *s)
{
    himc_vec3 n = himc_place_normal(place);
    himc_target rest = {.x = himc_vec3_madd(s->x, 0.3 * SETTLE, s->v)};
    double fall = fmax(-himc_vec3_dot(n, s->v), 0);
    double height = himc_place_from_world(place, rest.x).z, least = HOVER + 0.25 * SETTLE * fall;
    if (height < least)
        rest.x = himc_vec3_madd(rest.x, least - height, n);
    return himc_quintic_make(s, &rest, SETTLE);
}

// cuts the strikes of one hand out of its capture and fits what is between
static bool build_hand(himc_track *track, himc_hand hand, const himc_vec3 *captured,
                       const himc_take_strike *strikes, int count, double mallet_radius)
{
    hand_track *h = &track->hand[hand];
    himc_vec3 *x = malloc((size_t)track->frames * sizeof *x);
    h->frame = calloc((size_t)track->frames, sizeof *h->frame);
    h->bridges = calloc((size_t)count + 1, sizeof *h->bridges);
    h->planned = calloc((size_t)count + 1, sizeof *h->planned);
    bool ok = x && h->frame && h->bridges && h->planned;
    for (int i = 0; ok && i < track->frames; i++)
        x[i] = himc_vec3_add(captured[i], track->offset);
    int start = 0, cut = (int)ceil(CUT * track->rate), last[MAX_STRIKES], next[MAX_STRIKES];
    for (int i = 0; ok && i < count; i++) {
        if (strikes[i].hand != hand || strikes[i].frame - cut < start + 2 ||
            strikes[i].frame + cut > track->frames - 3)
            continue;
        last[h->bridge_count] = strikes[i].frame - cut;
        next[h->bridge_count] = strikes[i].frame + cut;
        fit_stretch(h, x, start, last[h->bridge_count], track->frames, track->rate);
        start = next[h->bridge_count++];
    }
    if (ok)
        fit_stretch(h, x, start, track->frames - 1, track->frames, track->rate);
    for (int i = 0; ok && i < h->bridge_count; i++)
        make_bridge(track, h, &h->planned[i], last[i], next[i], mallet_radius);
    if (ok)
        memcpy(h->bridges, h->planned, (size_t)h->bridge_count * sizeof *h->bridges);
    h->present = ok;
    free(x);
    return ok;
}

// moves the mean of the strikes' places onto the head's usual spot
static himc_vec3 find_offset(const himc_take_strike *strikes, int count,
                             const himc_take_tip tips[HIMC_HANDS], int frames,
                             const himc_place *place, double mallet_radius)
{
    himc_stroke usual = {.hand = HIMC_RIGHT, .spot = HIMC_SPOT_NORMAL};
    double sx, sy;
    himc_stroke_spot(&usual, place->radius, &sx, &sy);
    himc_vec3 spot = himc_place_to_world(place, sx, 0), mean = {0, 0, 0};
    spot = himc_vec3_madd(spot, mallet_radius, himc_place_normal(place));
    himc_take_strike_place(strikes, count, &mean);
    bool one_handed = !tips[HIMC_LEFT].present || !tips[HIMC_RIGHT].present;
    if (count == 0) { // nothing struck: the lowest point above the spot
        const himc_vec3 *x = tips[HIMC_RIGHT].present ? tips[HIMC_RIGHT].x : tips[HIMC_LEFT].x;
        mean = x[0];
        for (int i = 1; i < frames; i++)
            if (x[i].z < mean.z)
                mean = x[i];
        spot.z += 0.05;
    }
    if (one_handed)
        spot.y += tips[HIMC_LEFT].present ? fabs(sy) : -fabs(sy);
    return himc_vec3_sub(spot, mean);
}

himc_track *himc_track_new(himc_take *take, const himc_take_options *options,
                           const himc_place *place, double mallet_radius, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    if (!himc_take_tips(take, options, tips, error))
        return NULL;
    if (himc_take_frames(take) < LEAST_FRAMES) {
        himc_error_set(error, "%d frames, allowed %d or more", himc_take_frames(take),
                       LEAST_FRAMES);
        return NULL;
    }
    himc_track *track = calloc(1, sizeof *track);
    himc_take_strike *strikes = calloc(MAX_STRIKES, sizeof *strikes);
    bool ok = track && strikes;
    if (ok) {
        int count = himc_take_strikes(take, tips, strikes, MAX_STRIKES);
        count = count > MAX_STRIKES ? MAX_STRIKES : count;
        track->rate = himc_take_rate(take);
        track->frames = himc_take_frames(take);
        track->place = *place;
        track->stop = INFINITY;
        track->offset = find_offset(strikes, count, tips, track->frames, place, mallet_radius);
        for (int hand = 0; ok && hand < HIMC_HANDS; hand++)
            if (tips[hand].present)
                ok =
                    build_hand(track, (himc_hand)hand, tips[hand].x, strikes, count, mallet_radius);
    }
    free(strikes);
    if (!ok) {
        himc_track_free(track);
        himc_error_set(error, "out of memory");
        return NULL;
    }
    return track;
}

void himc_track_free(himc_track *track)
{
    if (!track)
        return;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        free(track->hand[hand].frame);
        free(track->hand[hand].bridges);
        free(track->hand[hand].planned);
    }
    free(track);
}

void himc_track_approach(himc_track *track, himc_hand hand, const himc_target *now, double duration)
{
    hand_track *h = &track->hand[hand];
    himc_target begin = {.x = h->frame[0].x};
    h->approach_time = duration - 0.5 * EASE;
    h->approach = himc_quintic_make(now, &begin, h->approach_time);
}

void himc_track_stop(himc_track *track, double t, const himc_target now[HIMC_HANDS])
{
    if (t >= track->stop || t > himc_track_length(track))
        return;
    track->stop = t;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        track->hand[hand].settle = come_to_rest(&track->place, &now[hand]);
}

void himc_track_rewind(himc_track *track)
{
    track->stop = INFINITY;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        hand_track *h = &track->hand[hand];
        if (!h->present)
            continue;
        memcpy(h->bridges, h->planned, (size_t)h->bridge_count * sizeof *h->bridges);
    }
}

himc_vec3 himc_track_offset(const himc_track *track)
{
    return track->offset;
}

bool himc_track_present(const himc_track *track, himc_hand hand)
{
    return track->hand[hand].present;
}

double himc_track_length(const himc_track *track)
{
    return fmin((track->frames - 1) / track->rate + 0.5 * EASE, track->stop + SETTLE);
}

int himc_track_strikes(const himc_track *track, himc_hand hand)
{
    return track->hand[hand].bridge_count;
}

// the first bridge that is not over at `t`, by bisection; bridge_count if there is none
static int bridge_at(const hand_track *h, double t)
{
    int lo = 0, hi = h->bridge_count;
    while (lo < hi) {
        int mid = (lo + hi) / 2;
        if (h->bridges[mid].to > t)
            hi = mid;
        else
            lo = mid + 1;
    }
    return lo;
}

// the take as it is played, strikes bridged
static himc_target played_at(const himc_track *track, const hand_track *h, double t)
{
    int i = bridge_at(h, t);
    if (i == h->bridge_count || t < h->bridges[i].from)
        return captured_at(track, h, t);
    const bridge *b = &h->bridges[i];
    if (b->restart > b->from)
        return himc_quintic_at(&b->path, t - b->restart);
    if (t < b->contact)
        return himc_quintic_at(&b->approach, t - b->from);
    return himc_quintic_at(&b->path, t - b->contact);
}

// Takes begin and end in motion; time itself starts from a stand and comes to one, over EASE
// around each end. `at` is the take's time when it is `t`, with its rate and second derivative.
static void warp_time(const himc_track *track, double t, double at[3])
{
    double length = (track->frames - 1) / track->rate, half = 0.5 * EASE;
    himc_target from = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, to = {{half, 0, 0}, {1, 0, 0}, {0, 0, 0}};
    double u = t + half;
    at[0] = t;
    at[1] = 1;
    at[2] = 0;
    if (t > half && t < length - half)
        return;
    if (t >= length - half) {
        from = (himc_target){{length - half, 0, 0}, {1, 0, 0}, {0, 0, 0}};
        to = (himc_target){{length, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        u = t - (length - half);
    }
    himc_quintic q = himc_quintic_make(&from, &to, EASE);
    himc_target s = himc_quintic_at(&q, fmin(fmax(u, 0), EASE));
    at[0] = s.x.x;
    at[1] = s.v.x;
    at[2] = s.a.x;
}

himc_target himc_track_target(const himc_track *track, himc_hand hand, double t)
{
    const hand_track *h = &track->hand[hand];
    double at[3];
    if (!h->present)
        return (himc_target){.x = track->place.center}; // nobody asks
    if (t < -0.5 * EASE && h->approach_time > 0)
        return himc_quintic_at(&h->approach, fmax(t + 0.5 * EASE + h->approach_time, 0));
    if (t >= track->stop)
        return himc_quintic_at(&h->settle, fmin(t - track->stop, SETTLE));
    warp_time(track, t, at);
    himc_target s = played_at(track, h, at[0]);
    s.a = himc_vec3_madd(himc_vec3_scale(s.a, at[1] * at[1]), at[2], s.v);
    s.v = himc_vec3_scale(s.v, at[1]);
    return s;
}

// when a time of the take is played: by bisection where time itself starts or stops
static double unwarp(const himc_track *track, double taken)
{
    double lo = taken - EASE, hi = taken + EASE, at[3];
    warp_time(track, taken, at);
    if (at[0] == taken && at[1] == 1)
        return taken;
    for (int i = 0; i < 50; i++) {
        double middle = 0.5 * (lo + hi);
        warp_time(track, middle, at);
        if (at[0] < taken)
            lo = middle;
        else
            hi = middle;
    }
    return hi;
}

bool himc_track_current(const himc_track *track, himc_hand hand, double t, double *contact_time,
                        double *x, double *y)
{
    const hand_track *h = &track->hand[hand];
    double at[3];
    warp_time(track, t, at);
    int i = h->present ? bridge_at(h, at[0]) : 0;
    if (i < h->bridge_count && h->bridges[i].restart > h->bridges[i].from)
        i++; // already struck
    if (!h->present || i >= h->bridge_count)
        return false;
    *contact_time = unwarp(track, h->bridges[i].contact);
    *x = h->bridges[i].place.x;
    *y = h->bridges[i].place.y;
    return true;
}

void himc_track_separated(himc_track *track, himc_hand hand, double now,
                          const himc_target *measured)
{
    hand_track *h = &track->hand[hand];
    double at[3];
    warp_time(track, now, at);
    if (at[1] < SLOWEST)
        return;
    double t = at[0];
    int i = bridge_at(h, t);
    if (i == h->bridge_count || t < h->bridges[i].from) {
        if (i == 0 || h->bridges[i - 1].to < t - REJOIN)
            return;
        i--; // separated after the bridge's end: it is lengthened
    }
    bridge *b = &h->bridges[i];
    b->to = t + REJOIN;
    if (i + 1 < h->bridge_count)
        b->to = fmin(b->to, h->bridges[i + 1].from - 1e-3);
    b->to = fmin(b->to, (track->frames - 1) / track->rate);
    if (b->to < t + TOO_LATE)
        return;
    himc_target back = captured_at(track, h, b->to), from = *measured;
    from.v = himc_vec3_scale(from.v, 1 / at[1]);
    from.a = himc_vec3_scale(himc_vec3_madd(from.a, -at[2], from.v), 1 / (at[1] * at[1]));
    b->restart = t;
    b->path = himc_quintic_make(&from, &back, b->to - t);
}
