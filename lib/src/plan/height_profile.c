/// height_profile.c: the height of a tip over a head: rebound, wait, rise to the apex, and when it
/// can fall at once.
///
/// With little time the rise is one quintic; with more, the rebound goes as high as its nuance
/// makes it and floats on upwards; with much, the tip sinks, waits low and is raised again. Trial
/// quintics are sampled: one that would dip or overshoot is replaced, or the motion is braked
/// first. A quintic from the speed v at height 0 to rest at the height h in the time T is monotone
/// while v T/h <= 2.5 (gesture.h).
#include "plan/stroke_plan.h"

#define TRIAL_SAMPLES 16 // of a trial quintic; chosen: it turns four times at most

// halting; chosen: as short as a wrist can, and never through the head
#define BRAKE_TIME 0.12         // (s)
#define LEAST_BRAKE_TIME 0.02   // (s)
#define BRAKE_FALL_SHARE 1.2    // of the time the tip would need to reach the head
#define BRAKE_LEAST_HEIGHT 0.02 // a lower tip is braked as if it were so high (m)
#define BRAKE_FLOOR 0.2         // it halts above this share of its height

// the rebound; the time it takes is the nuance's (himc_gesture.rebound_time) within these limits,
// chosen by eye
#define LEAST_REBOUND_TIME 0.08     // (s)
#define LONGEST_REBOUND_TIME 0.3    // (s)
#define REBOUND_SHARE 0.75          // of the time before the apex, at most
#define REBOUND_LEAST_WAY_TIME 0.09 // the rebound goes at least as high as its speed takes it ...
#define REBOUND_LEAST_WAY 2.2       // ... in this time, over this factor
#define BROKEN_RISE_TIME 2.0        // rebound_time of a rise that was broken off
#define FLOAT_STEEPNESS 1.5         // v T/h of the float from the rebound's top to the next apex
#define FLOAT_SHARE 0.5             // of the rebound's speed, at most, is left for the float

// the wait before a stroke; chosen by eye
#define SINK_TIME 0.5          // spare time after which a tip sinks (s)
#define SINK_FADE 0.5          // with so much more it sinks to the waiting height (s)
#define SINK_DURATION 0.6      // of the sinking, at most (s) ...
#define SINK_SHARE 0.5         // ... and this share of the spare time
#define RAISE_TIME 0.45        // of the last rise, at most (s)
#define LEAST_WAIT 0.05        // shorter waits are left out (s)
#define WAIT_LEAST_HEIGHT 0.05 // (m)
#define WAIT_SHARE 0.9         // the tip waits below this share of the next apex

// the rise; chosen: below 0.12 s nothing but one quintic fits, and 1.04 and 4 mm are not seen
#define HURRIED_RISE 0.12      // shorter rises are one quintic (s)
#define RISE_STEEPNESS 2.6     // v T/h of one quintic, at most: it overshoots a little
#define RISE_LEAST_WAY 0.01    // (m)
#define RISE_REBOUNDS 1.5      // one quintic may take so many rebounds' time
#define BRISK_MOVE 25.0        // peak acceleration from a rebound's top to the apex (m/s^2)
#define OVERSHOOT 1.04         // of the higher end ...
#define OVERSHOOT_MARGIN 0.004 // ... and so much more, or less than the lower end (m)
#define HELD_APEX_TIME 0.01    // an apex held for longer is at rest (s)
#define CALM_RISE 1.5          // a rise from rest in more than so many falls halts at the apex

// the fall at once; chosen: a stick that is high enough and in time is not raised again
#define LEAST_FALL_TIME 0.012      // falls this short are always tried (s)
#define LEAST_FALL_HEIGHT 0.01     // (m)
#define FALLING_SPEED 0.2          // a tip faster downwards has begun to fall (m/s)
#define BRAKED_PEAK 150.0          // acceleration of a high tip that falls to a soft touch ...
#define BRAKED_LIMIT 400.0         // ... and with so much it is not braked at all (m/s^2)
#define FALL_STEEPNESS 2.5         // v T/h of a fall from rest, at most ...
#define FALLING_STEEPNESS 3.5      // ... and of one that has begun
#define FALL_OVERSHOOT 1.1         // of the height ...
#define FALL_OVERSHOOT_MARGIN 0.02 // ... and so much more (m)

// a fall that comes too late; chosen by walks of the tempo (tests/plan/test_tempo_walk.c)
#define PLUNGE 1.6          // mean speed over the touch's, at most, with a peak above BRAKED_PEAK
#define HARDEST_FALL 300.0  // a body follows a higher peak late (m/s^2) ...
#define HARDEST_PLUNGE 1.25 // ... so the mean speed over the touch's is at most this
#define LOUDEST 1.5         // speed of the touch over the one asked for, at most

static himc_target along_normal(const stroke_plan *s, height_state at)
{
    return himc_target_along(s->n, at.h, at.v, at.a);
}

void himc_height_profile_to(stroke_plan *s, double t, height_state to)
{
    if (t <= s->height_end)
        return;
    himc_target a = along_normal(s, s->height), b = along_normal(s, to);
    himc_spline_add(&s->plan->height_profile, s->height_end, &a, t, &b);
    s->height_end = t;
    s->height = to;
}

bool himc_height_profile_stays(const stroke_plan *s, double t, height_state to, double low,
                               double high)
{
    himc_target a = along_normal(s, s->height), b = along_normal(s, to);
    himc_spline_segment trial = himc_spline_segment_make(s->height_end, &a, t, &b);
    for (int i = 1; i < TRIAL_SAMPLES; i++) {
        double at = trial.t0 + (t - trial.t0) * i / TRIAL_SAMPLES;
        double h = himc_vec3_dot(s->n, himc_spline_segment_at(&trial, at).x);
        if (h < low || h > high)
            return false;
    }
    return true;
}

void himc_height_profile_brake(stroke_plan *s, double limit)
{
    double h = s->height.h, v = s->height.v;
    double fall = BRAKE_FALL_SHARE * fmax(h, BRAKE_LEAST_HEIGHT);
    double T = v < 0 ? fmin(BRAKE_TIME, fall / -v) : BRAKE_TIME;
    T = fmin(fmax(T, LEAST_BRAKE_TIME), 0.5 * (limit - s->height_end));
    double stop = fmax(h + 0.5 * v * T, BRAKE_FLOOR * h);
    himc_height_profile_to(s, s->height_end + T, (height_state){stop, 0, 0});
}

void himc_height_profile_rebound(stroke_plan *s, double top, double next)
{
    const himc_gesture *g = &s->plan->last.gesture;
    double h = s->height.h, v = s->height.v;
    double high = g->rebound * g->height;
    if (!s->plan->rebounding)
        high = h; // a rise that was broken off: only halt it
    // no higher than the next stroke needs it, unless there is time to bounce freely and sink
    double spare = fmin(fmax((top - s->height_end - SINK_TIME) / SINK_TIME, 0), 1);
    if (high > next)
        high = next + spare * (high - next);
    high = fmax(high, h + v * REBOUND_LEAST_WAY_TIME / REBOUND_LEAST_WAY);
    double slowness = s->plan->rebounding ? g->rebound_time : BROKEN_RISE_TIME;
    double T = fmin(fmax(slowness * (high - h) / v, LEAST_REBOUND_TIME), LONGEST_REBOUND_TIME);
    T = fmin(T, REBOUND_SHARE * (top - s->height_end));
    high = fmin(fmax(high, h + v * T / HIMC_STEEPEST_QUINTIC), fmax(h, HIMC_HIGHEST_REBOUND));
    double rest = top - s->height_end - T;
    double on = 0;
    if (next > high && rest < SINK_TIME)
        on = fmin(FLOAT_STEEPNESS * (next - high) / rest, FLOAT_SHARE * v);
    himc_height_profile_to(s, s->height_end + T, (height_state){high, on, 0});
}

/// If there is time, sinks and waits low; returns the beginning of the last rise.
static double sink(stroke_plan *s, double top, double next)
{
    double spare = top - s->height_end;
    double raise = fmin(RAISE_TIME, 0.5 * spare);
    if (s->plan->at_home) {
        himc_height_profile_to(s, top - fmin(s->approach, spare),
                               (height_state){s->height.h, 0, 0});
        return s->height_end;
    }
    if (spare <= SINK_TIME)
        return s->height_end;
    double low = fmax(fmin(HIMC_WAIT_HEIGHT, WAIT_SHARE * next), WAIT_LEAST_HEIGHT);
    low += (s->height.h - low) * (1 - fmin((spare - SINK_TIME) / SINK_FADE, 1));
    double settle = fmin(SINK_DURATION, SINK_SHARE * spare);
    himc_height_profile_to(s, s->height_end + settle, (height_state){low, 0, 0});
    if (top - raise - s->height_end > LEAST_WAIT)
        himc_height_profile_to(s, top - raise, (height_state){low + HIMC_WAIT_SWAY, 0, 0});
    return top - raise;
}

/// The longest time (s) that a rise to `next` (m) may take as one quintic: it neither overshoots
/// much, nor is slower than the last nuance rebounds.
static double longest_single_rise(const stroke_plan *s, double next)
{
    const himc_gesture *last = &s->plan->last.gesture;
    double h = s->height.h, v = s->height.v;
    if (v <= HIMC_TURNING_SPEED)
        return SINK_TIME;
    double longest = RISE_STEEPNESS * fmax(next - h, RISE_LEAST_WAY) / v;
    if (!s->plan->rebounding)
        return longest;
    double high = last->rebound * last->height, T = last->rebound_time * high / v;
    return fmin(longest,
                fmax(RISE_REBOUNDS * T, T + himc_move_time(fmax(next - high, 0), BRISK_MOVE)));
}

static bool rises_within_bounds(const stroke_plan *s, double top, height_state apex, double high)
{
    return himc_height_profile_stays(s, top, apex, fmin(s->height.h, apex.h) - OVERSHOOT_MARGIN,
                                     OVERSHOOT * high + OVERSHOOT_MARGIN);
}

double himc_height_profile_rise(stroke_plan *s, double top, const himc_gesture *g)
{
    height_state apex = {g->height, 0, -g->arc * g->height / (g->down * g->down)};
    if (g->dwell > HELD_APEX_TIME)
        apex.a = 0;
    double begin = s->height_end, high = fmax(g->height, s->height.h);
    if (s->height.v < -HIMC_TURNING_SPEED)
        himc_height_profile_brake(s, top);
    bool moving = s->height.v > HIMC_TURNING_SPEED;
    bool single = top - begin < HURRIED_RISE || (top - begin <= longest_single_rise(s, g->height) &&
                                                 rises_within_bounds(s, top, apex, high));
    if (!single) {
        if (moving)
            himc_height_profile_rebound(s, top, g->height);
        begin = sink(s, top, g->height);
        if (s->height.v == 0 && top - s->height_end > CALM_RISE * g->down)
            apex.a = 0;
    }
    if (!rises_within_bounds(s, top, apex, high))
        apex.a = 0;
    himc_height_profile_to(s, top, apex);
    return begin;
}

double himc_height_profile_least_landing(double h, double T)
{
    double peak = HIMC_MOVE_PEAK * h / (T * T);
    double share = (peak - BRAKED_PEAK) / (BRAKED_LIMIT - BRAKED_PEAK);
    return fmin(fmax(share, 0), 1) * HIMC_LEAST_LANDING * h / T;
}

bool himc_height_profile_plunges(double h, double T, double speed)
{
    double mean = h / T, peak = HIMC_MOVE_PEAK * mean / T;
    double most = peak > HARDEST_FALL ? HARDEST_PLUNGE : PLUNGE;
    return (peak > BRAKED_PEAK && mean > most * speed) ||
           himc_height_profile_least_landing(fmax(h, 0), T) > LOUDEST * speed;
}

bool himc_height_profile_falls(const stroke_plan *s, double t, himc_gesture *g)
{
    double T = t - s->height_end, h = s->height.h;
    double steepness = s->height.v < -FALLING_SPEED ? FALLING_STEEPNESS : FALL_STEEPNESS;
    double longest = steepness * h / g->speed;
    if (h <= LEAST_FALL_HEIGHT || T > fmax(longest, LEAST_FALL_TIME))
        return false;
    if (g->speed * T < HIMC_LEAST_LANDING * h) {
        // a tip too high for its stroke sinks to the stroke's apex first, if it has the time
        himc_gesture low = himc_gesture_squeeze(*g, T, h);
        double time = T - low.down - low.dwell;
        if (HIMC_MOVE_PEAK * (h - low.height) <= HIMC_QUICK_MOVE * time * time)
            return false;
    }
    double speed = fmax(g->speed, himc_height_profile_least_landing(h, T));
    if (T <= LEAST_FALL_TIME)
        speed = fmin(speed, HIMC_STEEPEST_QUINTIC * h / T);
    if (!himc_height_profile_stays(s, t, (height_state){0, -speed, 0}, -1e-6,
                                   FALL_OVERSHOOT * h + FALL_OVERSHOOT_MARGIN))
        return false;
    g->speed = speed;
    g->height = h;
    return true;
}
