/// track.c: local fits (track_fit.c) give each frame a state, quintics join the frames.
///
/// A fit uses only frames on the same side of every strike; those from CUT before its lowest point
/// to CUT after are dropped. Approach: from the last good frame to the head's plane with an
/// acceleration that fades to nothing there gives the time of contact. Then a bridge: a quintic to
/// where the capture is rejoined, replaced at separation by one from the measured state.
#include "plan/track_state.h"

#include "base/noise.h"
#include "capture/player.h"
#include "base/head_frame.h"

#include <stdlib.h>
#include <string.h>

#define CUT 0.0125        // of the capture around a strike's lowest point (s)
#define TOO_LATE 0.015    // with less of the take left, its bridge is left as it is (s)
#define REJOIN 0.020      // from separation back to the capture (s) ...
#define ASTRAY 0.02       // ... but from farther off than the fastest stick goes, by this (m) ...
#define GENTLY 250.0      // ... as long as this peak acceleration takes (m/s^2)
#define FASTEST 12.0      // a stick that leaves the head faster has been thrown (m/s)
#define LONGEST_FALL 0.03 // the approach is carried on at most so long (s)
#define SLOWEST 0.2       // pace of a take's time from which on nothing is replanned
#define HOVER 0.08        // of a tip at rest above the head (m)
#define IN_THE_AIR 0.05   // a strike's tip is not so high above the head (m)
#define LEAST_FRAMES 8

// frames lo..hi: one stretch between strikes
static void fit_stretch(hand_track *h, const himc_vec3 *x, int lo, int hi, const himc_track *track)
{
    fit_series series = {track->frames, track->edge, track->rate};
    for (int k = lo; k <= hi; k++)
        h->frame[k] = himc_fit(x, himc_fit_window(k, lo, hi, &series), 1 / track->rate);
}

// when the approach from frame state `s` reaches the head, its acceleration fading to nothing on
// the way: the first root of height + v t + a t^2 / 3
static double fall_time(const himc_head_frame *place, const himc_target *s, double mallet_radius)
{
    himc_vec3 n = himc_head_frame_normal(place);
    double height = himc_head_frame_from_world(place, s->x).z - mallet_radius;
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

static void make_bridge(himc_track *track, hand_track *h, bridge *b, double mallet_radius)
{
    himc_target before = h->frame[b->last];
    double start = b->last / track->rate,
           fall = fmax(fall_time(&track->place, &before, mallet_radius), 0);
    b->approach = (himc_quintic){{before.x, before.v, himc_vec3_scale(before.a, 0.5)}};
    if (fall > 0)
        b->approach.c[3] = himc_vec3_scale(before.a, -1 / (6 * fall));
    himc_target touch = himc_quintic_at(&b->approach, fall);
    b->from = b->restart = start;
    b->contact = start + fall;
    b->to = fmax(b->next / track->rate, b->contact + 0.02);
    b->to = fmin(b->to, (track->frames - 1) / track->rate);
    himc_target after = captured_at(track, h, b->to);
    b->place = himc_head_frame_from_world(&track->place, touch.x);
    touch.a = himc_vec3_make(0, 0, 0);
    b->path = himc_quintic_make(&touch, &after, b->to - b->contact);
}

// carried a little further, to a standstill; a tip that falls is caught above the head
static himc_quintic come_to_rest(const himc_head_frame *place, const himc_target *s)
{
    himc_vec3 n = himc_head_frame_normal(place);
    himc_target rest = {.x = himc_vec3_madd(s->x, 0.3 * SETTLE, s->v)};
    double fall = fmax(-himc_vec3_dot(n, s->v), 0);
    double height = himc_head_frame_from_world(place, rest.x).z,
           least = HOVER + 0.25 * SETTLE * fall;
    if (height < least)
        rest.x = himc_vec3_madd(rest.x, least - height, n);
    return himc_quintic_make(s, &rest, SETTLE);
}

// a stick pulled up sharply may look as if it had struck
static bool is_in_the_air(const himc_track *track, const himc_take_strike *strike)
{
    himc_vec3 x = himc_vec3_add(strike->x, track->offset);
    return himc_head_frame_from_world(&track->place, x).z > IN_THE_AIR;
}

// cuts the strikes of one hand out of its capture and fits what is between
static void cut_strikes(himc_track *track, himc_hand hand, const himc_vec3 *x,
                        const himc_take_strike *strikes, int count)
{
    hand_track *h = &track->hand[hand];
    int start = 0, cut = (int)ceil(CUT * track->rate);
    for (int i = 0; i < count; i++) {
        int frame = strikes[i].frame;
        if (strikes[i].hand != hand || frame - cut < start + 2 || frame + cut > track->frames - 3 ||
            is_in_the_air(track, &strikes[i]))
            continue;
        bridge *b = &h->planned[h->bridge_count++];
        b->last = frame - cut;
        b->next = frame + cut;
        fit_stretch(h, x, start, b->last, track);
        start = b->next;
    }
    fit_stretch(h, x, start, track->frames - 1, track);
}

static bool build_hand(himc_track *track, himc_hand hand, const himc_vec3 *captured,
                       const himc_take_strike *strikes, int count, double mallet_radius)
{
    hand_track *h = &track->hand[hand];
    himc_vec3 *x = malloc((size_t)track->frames * sizeof *x);
    h->frame = calloc((size_t)track->frames, sizeof *h->frame);
    h->bridges = calloc((size_t)count + 1, sizeof *h->bridges);
    h->planned = calloc((size_t)count + 1, sizeof *h->planned);
    h->present = x && h->frame && h->bridges && h->planned;
    if (h->present) {
        for (int i = 0; i < track->frames; i++)
            x[i] = himc_vec3_add(captured[i], track->offset);
        cut_strikes(track, hand, x, strikes, count);
        for (int i = 0; i < h->bridge_count; i++)
            make_bridge(track, h, &h->planned[i], mallet_radius);
        memcpy(h->bridges, h->planned, (size_t)h->bridge_count * sizeof *h->bridges);
    }
    free(x);
    return h->present;
}

static himc_track *build(himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                         const himc_head_frame *place, const himc_player *player,
                         double mallet_radius)
{
    int count;
    himc_track *track = calloc(1, sizeof *track);
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &count);
    bool ok = track && strikes;
    if (ok) {
        track->rate = himc_take_rate(take);
        track->frames = himc_take_frames(take);
        track->place = *place;
        track->stop = INFINITY;
        track->offset = player && player->seated
                            ? player->offset
                            : himc_strike_offset(take, tips, place, mallet_radius);
    }
    for (int hand = 0; ok && hand < HIMC_HANDS; hand++)
        if (tips[hand].present) {
            track->edge = himc_fit_edge(himc_noise(tips[hand].x, track->frames), track->rate);
            ok = build_hand(track, (himc_hand)hand, tips[hand].x, strikes, count, mallet_radius);
        }
    ok = ok && (!player || himc_track_fit_postures(track, player));
    free(strikes);
    if (ok)
        return track;
    himc_track_free(track);
    return NULL;
}

static himc_track *track_new(himc_take *take, const himc_take_options *options,
                             const himc_head_frame *place, const himc_player *player,
                             double mallet_radius, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    if (!himc_take_tips(take, options, tips, error))
        return NULL;
    if (himc_take_frames(take) < LEAST_FRAMES) {
        himc_error_set(error, "%d frames, allowed %d or more", himc_take_frames(take),
                       LEAST_FRAMES);
        return NULL;
    }
    himc_track *track = build(take, tips, place, player, mallet_radius);
    if (!track)
        himc_error_set(error, "out of memory");
    return track;
}

himc_track *himc_track_new(himc_take *take, const himc_take_options *options,
                           const himc_head_frame *place, double mallet_radius, himc_error *error)
{
    return track_new(take, options, place, NULL, mallet_radius, error);
}

himc_track *himc_track_new_played(himc_take *take, const himc_take_options *options,
                                  const himc_head_frame *place, const himc_player *player,
                                  himc_error *error)
{
    return track_new(take, options, place, player, player->config.mallet_radius, error);
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
    for (int j = 0; j < TRACK_JOINTS; j++)
        free(track->joint[j]), free(track->uncut[j]);
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

int himc_track_bridge_at(const bridge *list, int count, double t)
{
    int lo = 0, hi = count;
    while (lo < hi) {
        int mid = (lo + hi) / 2;
        if (list[mid].to > t)
            hi = mid;
        else
            lo = mid + 1;
    }
    return lo;
}

// the take as it is played, strikes bridged
static himc_target played_at(const himc_track *track, const hand_track *h, double t)
{
    int i = himc_track_bridge_at(h->bridges, h->bridge_count, t);
    if (i == h->bridge_count || t < h->bridges[i].from)
        return captured_at(track, h, t);
    const bridge *b = &h->bridges[i];
    if (b->restart > b->from)
        return himc_quintic_at(&b->path, t - b->restart);
    if (t < b->contact)
        return himc_quintic_at(&b->approach, t - b->from);
    return himc_quintic_at(&b->path, t - b->contact);
}

void himc_track_warp(const himc_track *track, double t, double at[3])
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
    if (t >= track->stop)
        return himc_quintic_at(&h->settle, fmin(t - track->stop, SETTLE));
    if (t < -0.5 * EASE && h->approach_time > 0)
        return himc_quintic_at(&h->approach, fmax(t + 0.5 * EASE + h->approach_time, 0));
    himc_track_warp(track, t, at);
    himc_target s = played_at(track, h, at[0]);
    s.a = himc_vec3_madd(himc_vec3_scale(s.a, at[1] * at[1]), at[2], s.v);
    s.v = himc_vec3_scale(s.v, at[1]);
    return s;
}

// when a time of the take is played: by bisection where time itself starts or stops
static double unwarp(const himc_track *track, double taken)
{
    double lo = taken - EASE, hi = taken + EASE, at[3];
    himc_track_warp(track, taken, at);
    if (at[0] == taken && at[1] == 1)
        return taken;
    for (int i = 0; i < 50; i++) {
        double middle = 0.5 * (lo + hi);
        himc_track_warp(track, middle, at);
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
    himc_track_warp(track, t, at);
    int i = h->present ? himc_track_bridge_at(h->bridges, h->bridge_count, at[0]) : 0;
    if (i < h->bridge_count && h->bridges[i].restart > h->bridges[i].from)
        i++; // already struck
    if (!h->present || i >= h->bridge_count)
        return false;
    *contact_time = unwarp(track, h->bridges[i].contact);
    if (fmax(t, *contact_time) >= track->stop)
        return false;
    *x = h->bridges[i].place.x;
    *y = h->bridges[i].place.y;
    return true;
}

void himc_track_separated(himc_track *track, himc_hand hand, double now,
                          const himc_target *measured)
{
    hand_track *h = &track->hand[hand];
    double at[3];
    himc_track_warp(track, now, at);
    if (at[1] < SLOWEST)
        return;
    double t = at[0];
    int i = himc_track_bridge_at(h->bridges, h->bridge_count, t);
    if (i == h->bridge_count || t < h->bridges[i].from) {
        if (i == 0 || h->bridges[i - 1].to < t - REJOIN)
            return;
        i--; // separated after the bridge's end: it is lengthened
    }
    bridge *b = &h->bridges[i];
    double to = fmax(t + REJOIN, b->next / track->rate); // between last and next nothing is known
    himc_vec3 way = himc_vec3_sub(captured_at(track, h, to).x, measured->x);
    if (himc_vec3_length(way) > ASTRAY + FASTEST * (to - t))
        to = t + himc_move_time(himc_vec3_length(way), GENTLY);
    if (i + 1 < h->bridge_count)
        to = fmin(to, h->bridges[i + 1].from - 1e-3);
    to = fmin(to, (track->frames - 1) / track->rate);
    if (to < t + TOO_LATE)
        return;
    b->to = to;
    himc_target back = captured_at(track, h, b->to), from = *measured;
    double speed = himc_vec3_length(from.v);
    from.v = himc_vec3_scale(from.v, fmin(1, FASTEST / speed) / at[1]);
    from.a = himc_vec3_scale(himc_vec3_madd(from.a, -at[2], from.v), 1 / (at[1] * at[1]));
    b->restart = t;
    b->path = himc_quintic_make(&from, &back, b->to - t);
}
