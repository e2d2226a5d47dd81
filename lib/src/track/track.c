/// track.c: the tips of a take: local fits (track_fit.c) give each frame a state, quintics join the
/// frames.
///
/// A fit uses only frames on the same side of every strike; frames that the head disturbs are
/// dropped: from the last one clear of it to CUT_TIME after the lowest. A bridge replaces them. It
/// begins with the approach: from the last good frame to the head's plane, with an acceleration
/// that fades to zero there; this gives the time of contact. Then a quintic leads back to the
/// capture; at separation another one, from the measured state, replaces it.
#include "track/track_state.h"
#include "track/track_time.h"

#include "base/noise.h"
#include "capture/player.h"
#include "base/head_frame.h"

#include <stdlib.h>
#include <string.h>

// the cut around a strike; chosen: a contact of 7 ms and a frame at 250 Hz on both sides
#define LEAD 0.25             // a gesture of a take is told so long before its contact (s); chosen
#define CUT_TIME 0.0125       // after a strike's lowest point, and at most before it (s)
#define LONGEST_APPROACH 0.03 // the approach is carried on at most so long (s)
#define AIRBORNE_HEIGHT 0.05  // no strike is so high above the head (m)
#define LEAST_BRIDGE 0.02     // from contact to the end of its bridge (s)

// the way back after a separation; chosen: as short as a stick can be led back without a jerk
#define REJOIN_TIME 0.020    // from separation to the capture (s) ...
#define REJOIN_DISTANCE 0.02 // ... but from this much further off than a stick goes in it (m) ...
#define REJOIN_PEAK 250.0    // ... as long as this peak acceleration takes (m/s^2)
#define FASTEST_STICK 12.0   // a stick that leaves the head faster has been thrown (m/s)
#define LATEST_REJOIN 0.1    // a capture under the head is rejoined within this time (s) ...
#define REJOIN_HEIGHT 0.02   // ... once it is so far above (m): the way there does not dip
#define NEXT_STRIKE_GAP 1e-3 // the way ends so much before the next bridge begins (s)
#define LEAST_REJOIN 0.015   // with less time left the path is not changed (s)
#define SLOWEST_REJOIN 0.2   // rate of the take's time below which nothing is replanned

// a stop; chosen: no tip falls on the head after it
#define HOVER_HEIGHT 0.08 // of a tip at rest above the head (m) ...
#define HOVER_FALL 0.25   // ... and this share of the fall's speed times the halt's duration

#define LOOKED_AHEAD 0.1 // what the motion at a time may rest on; chosen: some task periods (s)
#define LEAST_FRAMES 8   // of a take; chosen: enough for one local fit

// fits frames lo .. hi, one stretch between strikes
static void fit_stretch(hand_track *h, const himc_vec3 *x, int lo, int hi, const himc_track *track)
{
    fit_series series = {track->frames, track->edge, track->rate};
    for (int k = lo; k <= hi; k++)
        h->frame[k] = himc_fit(x, himc_fit_window(k, lo, hi, &series), 1 / track->rate);
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

// The approach falls from the last good frame to the head with an acceleration that fades to zero
// on the way: its time is the first root of height + v t + a t^2 / 3.
static void make_bridge(himc_track *track, hand_track *h, bridge *b, double mallet_radius)
{
    himc_target before = h->frame[b->last];
    himc_vec3 n = himc_head_frame_normal(&track->head);
    double height = himc_head_frame_from_world(&track->head, before.x).z - mallet_radius;
    double v = himc_vec3_dot(n, before.v), a = himc_vec3_dot(n, before.a),
           under = v * v - 4 / 3.0 * a * height, fall = LONGEST_APPROACH;
    if (v < 0 && under >= 0)
        fall = fmax(fmin(2 * height / (-v + sqrt(under)), LONGEST_APPROACH), 0);
    b->approach = (himc_quintic){{before.x, before.v, himc_vec3_scale(before.a, 0.5)}};
    if (fall > 0)
        b->approach.c[3] = himc_vec3_scale(before.a, -1 / (6 * fall));
    himc_target touch = himc_quintic_at(&b->approach, fall);
    b->from = b->restart = b->last / track->rate;
    b->contact = b->from + fall;
    b->to = fmax(b->next / track->rate, b->contact + LEAST_BRIDGE);
    b->to = fmin(b->to, himc_track_take_length(track));
    himc_target after = captured_at(track, h, b->to);
    b->spot = himc_head_frame_from_world(&track->head, touch.x);
    touch.a = himc_vec3_make(0, 0, 0);
    b->path = himc_quintic_make(&touch, &after, b->to - b->contact);
}

// a hand's capture with its strikes cut out: fits of the stretches between them, and the bridges
static bool build_hand(himc_track *track, himc_hand hand, const himc_vec3 *captured,
                       const himc_take_strike *strikes, int count, double mallet_radius)
{
    hand_track *h = &track->hand[hand];
    himc_vec3 *x = h->captured = malloc((size_t)track->frames * sizeof *x);
    h->frame = calloc((size_t)track->frames, sizeof *h->frame);
    h->bridges = calloc((size_t)count + 1, sizeof *h->bridges);
    h->built = calloc((size_t)count + 1, sizeof *h->built);
    h->present = x && h->frame && h->bridges && h->built;
    if (!h->present)
        return false;
    for (int i = 0; i < track->frames; i++)
        x[i] = himc_vec3_add(captured[i], track->offset);
    int start = 0, cut = (int)ceil(CUT_TIME * track->rate);
    for (int i = 0; i < count; i++) {
        int frame = strikes[i].frame, clear = strikes[i].clear;
        himc_vec3 low = himc_vec3_add(strikes[i].x, track->offset);
        // a stick pulled up sharply in the air may look like a strike
        if (strikes[i].hand != hand || frame - cut < start + 2 || frame + cut > track->frames - 3 ||
            himc_head_frame_from_world(&track->head, low).z > AIRBORNE_HEIGHT)
            continue;
        bridge *b = &h->built[h->bridge_count++];
        b->last = clear < frame && clear > frame - cut ? clear : frame - cut;
        b->next = frame + cut;
        b->speed = strikes[i].velocity;
        fit_stretch(h, x, start, b->last, track);
        start = b->next;
    }
    fit_stretch(h, x, start, track->frames - 1, track);
    for (int i = 0; i < h->bridge_count; i++)
        make_bridge(track, h, &h->built[i], mallet_radius);
    memcpy(h->bridges, h->built, (size_t)h->bridge_count * sizeof *h->bridges);
    return true;
}

himc_track *himc_track_new(himc_take *take, const himc_take_options *options,
                           const himc_head_frame *head, const himc_player *player,
                           double mallet_radius, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    int count, frames = himc_take_frames(take);
    if (!himc_take_tips(take, options, tips, error))
        return NULL;
    if (frames < LEAST_FRAMES) {
        himc_error_set(error, "%d frames, expected %d or more", frames, LEAST_FRAMES);
        return NULL;
    }
    himc_track *track = calloc(1, sizeof *track);
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &count);
    bool good = track && strikes;
    if (good) {
        track->rate = himc_take_rate(take);
        track->frames = frames;
        track->head = *head;
        track->stop = INFINITY;
        if (player && player->seated)
            track->offset = player->offset;
        else
            good = himc_strike_offset(take, tips, head, mallet_radius, &track->offset);
    }
    for (int hand = 0; good && hand < HIMC_HANDS; hand++) {
        double noise;
        if (!tips[hand].present)
            continue;
        good = himc_noise(tips[hand].x, frames, &noise);
        track->edge = himc_fit_edge(noise, track->rate);
        good =
            good && build_hand(track, (himc_hand)hand, tips[hand].x, strikes, count, mallet_radius);
    }
    free(strikes);
    if (good && (!player || himc_track_fit_postures(track, player)))
        return track;
    himc_track_free(track);
    himc_error_set(error, "out of memory");
    return NULL;
}

void himc_track_free(himc_track *track)
{
    if (!track)
        return;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        free(track->hand[hand].captured);
        free(track->hand[hand].frame);
        free(track->hand[hand].bridges);
        free(track->hand[hand].built);
    }
    himc_track_free_postures(track);
    free(track);
}

void himc_track_approach(himc_track *track, himc_hand hand, const himc_target *now, double duration)
{
    hand_track *h = &track->hand[hand];
    himc_target begin = {.x = h->frame[0].x};
    h->approach_time = duration - 0.5 * HIMC_TRACK_RAMP;
    h->approach = himc_quintic_make(now, &begin, h->approach_time);
}

double himc_track_start(const himc_track *track)
{
    return track->start;
}

void himc_track_rewind(himc_track *track, double start)
{
    track->start = start;
    track->stop = INFINITY;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        hand_track *h = &track->hand[hand];
        if (h->present)
            memcpy(h->bridges, h->built, (size_t)h->bridge_count * sizeof *h->bridges);
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
    return fmin(himc_track_take_length(track) + 0.5 * HIMC_TRACK_RAMP,
                track->stop + HIMC_TRACK_HALT);
}

int himc_track_strikes(const himc_track *track, himc_hand hand)
{
    return track->hand[hand].bridge_count;
}

// the first bridge of the list that is not over at `t`, by bisection; `count` if there is none
static int bridge_at(const bridge *list, int count, double t)
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

// Value and derivatives of a nudge whose sides last `before` and `after`, 0 where a side has no
// length: two quintics from rest to rest, 10 s^3 - 15 s^4 + 6 s^5 up, the same down. Velocity and
// acceleration are zero at both ends and at the top, so the sides may have different lengths.
static void bump(double t, double before, double after, double out[3])
{
    double side = t < 0 ? before : after, s = side > 0 ? 1 - fabs(t) / side : 0,
           sign = t < 0 ? 1 : -1;
    bool in = s > 0 && before > 0 && after > 0;
    out[0] = in ? s * s * s * (10 + s * (-15 + 6 * s)) : 0;
    out[1] = in ? sign * 30 * s * s * (1 - s) * (1 - s) / side : 0;
    out[2] = in ? 60 * s * (1 - s) * (1 - 2 * s) / (side * side) : 0;
}

// all nudges of a hand at take time `t`
static himc_target aside_at(const himc_track *track, himc_hand hand, double t)
{
    himc_target sum = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < track->nudges; i++) {
        const himc_nudge *n = &track->nudge[i];
        double across[3], up[3];
        himc_target s;
        himc_vec3 *part[3] = {&s.x, &s.v, &s.a};
        if (n->hand != hand || fabs(t - n->time) >= n->span)
            continue;
        bump(t - n->time, n->span, n->span, across);
        bump(t - n->time, n->rise, n->fall, up);
        for (int k = 0; k < 3; k++)
            *part[k] = himc_vec3_make(across[k] * n->way.x, across[k] * n->way.y, up[k] * n->way.z);
        sum = himc_target_add(sum, s);
    }
    return sum;
}

himc_target himc_track_target(const himc_track *track, himc_hand hand, double t)
{
    const hand_track *h = &track->hand[hand];
    double at[3];
    if (!h->present)
        return (himc_target){.x = track->head.center}; // any place does: the hand is not played
    if (t >= track->stop)
        return himc_quintic_at(&h->settle, fmin(t - track->stop, HIMC_TRACK_HALT));
    if (t < -0.5 * HIMC_TRACK_RAMP && h->approach_time > 0)
        return himc_quintic_at(&h->approach, fmax(t + 0.5 * HIMC_TRACK_RAMP + h->approach_time, 0));
    himc_track_warp(himc_track_take_length(track), t, at);
    // the take with its strikes bridged
    const bridge *b = &h->bridges[bridge_at(h->bridges, h->bridge_count, at[0])];
    himc_target s;
    if (b == h->bridges + h->bridge_count || at[0] < b->from)
        s = captured_at(track, h, at[0]);
    else if (b->restart == b->from && at[0] < b->contact)
        s = himc_quintic_at(&b->approach, at[0] - b->from);
    else
        s = himc_quintic_at(&b->path, at[0] - (b->restart > b->from ? b->restart : b->contact));
    s = himc_target_add(s, aside_at(track, hand, at[0]));
    s.a = himc_vec3_madd(himc_vec3_scale(s.a, at[1] * at[1]), at[2], s.v);
    s.v = himc_vec3_scale(s.v, at[1]);
    return s;
}

bool himc_track_captured(const himc_track *track, himc_hand hand, double t, himc_vec3 *x)
{
    const hand_track *h = &track->hand[hand];
    double at[3], length = himc_track_take_length(track);
    if (!h->present || t >= track->stop || t < -0.5 * HIMC_TRACK_RAMP ||
        t > length + 0.5 * HIMC_TRACK_RAMP)
        return false;
    himc_track_warp(length, t, at);
    double u = fmin(fmax(at[0], 0), length) * track->rate;
    int k = (int)fmin(u, track->frames - 2);
    *x = himc_vec3_madd(h->captured[k], u - k, himc_vec3_sub(h->captured[k + 1], h->captured[k]));
    *x = himc_vec3_add(*x, aside_at(track, hand, at[0]).x);
    return true;
}

// the present or next strike; NULL if there is none
static const bridge *current(const himc_track *track, himc_hand hand, double t)
{
    const hand_track *h = &track->hand[hand];
    double at[3];
    himc_track_warp(himc_track_take_length(track), t, at);
    int i = h->present ? bridge_at(h->bridges, h->bridge_count, at[0]) : 0;
    if (i < h->bridge_count && h->bridges[i].restart > h->bridges[i].from)
        i++; // already struck
    return h->present && i < h->bridge_count ? &h->bridges[i] : NULL;
}

bool himc_track_current(const himc_track *track, himc_hand hand, double t, double *contact_time,
                        double *x, double *y)
{
    const bridge *b = current(track, hand, t);
    if (!b)
        return false;
    *contact_time = himc_track_unwarp(himc_track_take_length(track), b->contact);
    if (fmax(t, *contact_time) >= track->stop)
        return false;
    himc_vec3 aside = aside_at(track, hand, b->contact).x;
    *x = b->spot.x + aside.x;
    *y = b->spot.y + aside.y;
    return true;
}

bool himc_track_nudge(himc_track *track, const himc_nudge *nudge, himc_error *error)
{
    double length = himc_track_take_length(track);
    if (!track->hand[nudge->hand].present)
        return himc_error_set(error, "nudge: HAND: the take has no %s tip",
                              himc_hand_name(nudge->hand));
    if (nudge->time - nudge->span < 0 || nudge->time + nudge->span > length)
        return himc_error_set(error, "nudge: TIME: %g s, %g s before and after, expected 0 .. %g s",
                              nudge->time, nudge->span, length);
    if (track->nudges >= HIMC_NUDGES)
        return himc_error_set(error, "nudge: one too many, expected %d", HIMC_NUDGES);
    // the height rises after the strike before, and is back before the strike after
    const hand_track *h = &track->hand[nudge->hand];
    himc_nudge *n = &track->nudge[track->nudges++];
    *n = *nudge;
    n->rise = n->fall = n->span;
    for (int i = 0; i < h->bridge_count; i++) {
        const bridge *b = &h->built[i];
        n->rise = b->contact <= n->time ? fmin(n->rise, n->time - b->to) : n->rise;
        n->fall = b->contact > n->time ? fmin(n->fall, b->from - n->time) : n->fall;
    }
    n->rise = fmax(n->rise, 0);
    n->fall = fmax(n->fall, 0);
    return true;
}

const himc_nudge *himc_track_nudges(const himc_track *track, int *count)
{
    *count = track->nudges;
    return track->nudge;
}

bool himc_track_exchange(himc_track *track, const himc_track *other, double t)
{
    const himc_track *both[] = {track, other};
    double at[3];
    int same = 0;
    himc_track_warp(himc_track_take_length(track), t, at);
    for (; same < track->nudges && same < other->nudges; same++) {
        const himc_nudge *a = &track->nudge[same], *b = &other->nudge[same];
        if (a->hand != b->hand || a->time != b->time || a->span != b->span ||
            himc_vec3_length(himc_vec3_sub(a->way, b->way)) != 0)
            break;
    }
    for (int k = 0; k < 2; k++)
        for (int i = same; i < both[k]->nudges; i++)
            if (both[k]->nudge[i].time - both[k]->nudge[i].span < at[0] + LOOKED_AHEAD)
                return false;
    memcpy(track->nudge, other->nudge, sizeof track->nudge);
    track->nudges = other->nudges;
    return true;
}

// the source of motion (body/source.h), with times of the performance

static himc_target target(const void *source, himc_hand hand, double t)
{
    const himc_track *track = source;
    return himc_track_target(track, hand, t - track->start);
}

static himc_source_stroke stroke(const void *source, himc_hand hand, double t)
{
    const himc_track *track = source;
    const bridge *b = current(track, hand, t - track->start);
    himc_source_stroke next = {
        .lead = LEAD, .beat = NAN, .speed = b ? b->speed : NAN, .nuance = "none"};
    next.any = himc_track_current(track, hand, t - track->start, &next.time, &next.x, &next.y);
    next.time += track->start;
    return next;
}

static himc_source_contact next(const void *source, himc_hand hand, double t)
{
    const himc_track *track = source;
    himc_source_contact next = {.any = false};
    double x, y;
    next.any = himc_track_current(track, hand, t - track->start, &next.time, &x, &y);
    next.time += track->start;
    return next;
}

static void separated(void *source, himc_hand hand, double now, const himc_target *measured)
{
    himc_track *track = source;
    hand_track *h = &track->hand[hand];
    double at[3];
    himc_track_warp(himc_track_take_length(track), now - track->start, at);
    double t = at[0];
    if (at[1] < SLOWEST_REJOIN)
        return;
    himc_target from = *measured;
    from.v = himc_vec3_scale(from.v, fmin(1, FASTEST_STICK / himc_vec3_length(from.v)) / at[1]);
    from.a = himc_vec3_scale(himc_vec3_madd(from.a, -at[2], from.v), 1 / (at[1] * at[1]));
    from = himc_target_sub(from, aside_at(track, hand, t));
    int i = bridge_at(h->bridges, h->bridge_count, t);
    if (i == h->bridge_count || t < h->bridges[i].from) {
        if (i == 0 || h->bridges[i - 1].to < t - REJOIN_TIME)
            return;
        i--; // separated after the bridge's end: it is lengthened
    }
    bridge *b = &h->bridges[i];
    // between last and next nothing is known
    double first = fmax(t + REJOIN_TIME, b->next / track->rate), to = first, least = b->spot.z;
    // where the capture is then below the level of a contact, the time at which it is well above: a
    // way back to a place under the head would strike it again. One that stays there is pressed
    while (himc_head_frame_from_world(&track->head, captured_at(track, h, to).x).z < least) {
        least = b->spot.z + REJOIN_HEIGHT;
        to += 1 / track->rate;
        if (to >= first + LATEST_REJOIN) {
            to = first;
            break;
        }
    }
    himc_vec3 way = himc_vec3_sub(captured_at(track, h, to).x, from.x);
    if (himc_vec3_length(way) > REJOIN_DISTANCE + FASTEST_STICK * (to - t))
        to = t + himc_move_time(himc_vec3_length(way), REJOIN_PEAK);
    if (i + 1 < h->bridge_count)
        to = fmin(to, h->bridges[i + 1].from - NEXT_STRIKE_GAP);
    to = fmin(to, himc_track_take_length(track));
    if (to < t + LEAST_REJOIN)
        return;
    b->to = to;
    himc_target back = captured_at(track, h, b->to);
    b->restart = t;
    b->path = himc_quintic_make(&from, &back, b->to - t);
}

static void play(void *source, double t, const himc_target *tip, const himc_posture_motion *joints)
{
    himc_track *track = source;
    himc_track_rewind(track, t + HIMC_APPROACH);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (himc_track_present(track, (himc_hand)hand))
            himc_track_approach(track, (himc_hand)hand, &tip[hand], HIMC_APPROACH);
    himc_track_approach_posture(track, joints);
}

static void stop(void *source, double t, const himc_target *now)
{
    himc_track *track = source;
    t -= track->start;
    if (t >= track->stop || t > himc_track_length(track))
        return;
    track->stop = t;
    // the motion goes on a little and comes to rest; a tip that falls is caught above the head
    himc_vec3 n = himc_head_frame_normal(&track->head);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const himc_target *s = &now[hand];
        himc_target rest = {.x = himc_vec3_madd(s->x, HIMC_TRACK_HALT_WAY * HIMC_TRACK_HALT, s->v)};
        double fall = fmax(-himc_vec3_dot(n, s->v), 0);
        double height = himc_head_frame_from_world(&track->head, rest.x).z,
               least = HOVER_HEIGHT + HOVER_FALL * HIMC_TRACK_HALT * fall;
        if (height < least)
            rest.x = himc_vec3_madd(rest.x, least - height, n);
        track->hand[hand].settle = himc_quintic_make(s, &rest, HIMC_TRACK_HALT);
    }
}

static double beat(const void *source, double t)
{
    const himc_track *track = source;
    return t - track->start;
}

static double end(const void *source)
{
    const himc_track *track = source;
    return track->start + himc_track_length(track);
}

const himc_source himc_track_source = {target, next, stroke, separated, NULL,
                                       play,   stop, beat,   end};
