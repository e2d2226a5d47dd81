/// lift.c: the height of a tip: rebound, waiting, rise to the apex, and when it may just fall.
///
/// With little time the rise is one quintic; with more, the rebound goes as high as its nuance
/// makes it and floats up; with much, the tip sinks, waits low and is raised again. A trial
/// quintic is sampled: if it would dip or overshoot, the motion is braked first. A quintic from
/// speed v at 0 to rest at the height h in the time T rises without turning as long as v T/h <=
/// 2.5.
#include "plan/stroke_plan.h"

#define LEAST_DOWN 0.012  // no lift is planned in less (s)
#define HURRIED_RISE 0.12 // shorter rises are one quintic (s)
#define SINK_TIME 0.5     // spare time after which a tip sinks (s)
#define BRISK_MOVE 25.0   // (m/s^2)

static himc_spline_segment trial(const chunk *c, double t, chunk_height to)
{
    himc_target a = along(c->n, c->at.h, c->at.v, c->at.a), b = along(c->n, to.h, to.v, to.a);
    return himc_spline_segment_make(c->lift_end, &a, t, &b);
}

void himc_stroke_plan_lift_to(chunk *c, double t, chunk_height to)
{
    if (t <= c->lift_end)
        return;
    himc_target a = along(c->n, c->at.h, c->at.v, c->at.a), b = along(c->n, to.h, to.v, to.a);
    himc_spline_add(&c->plan->lift, c->lift_end, &a, t, &b);
    c->lift_end = t;
    c->at = to;
}

/// Whether the way to a height stays within bounds.
bool himc_stroke_plan_stays(const chunk *c, double t, chunk_height to, double low, double high)
{
    himc_spline_segment piece = trial(c, t, to);
    for (int i = 1; i < 16; i++) {
        double at = piece.t0 + (t - piece.t0) * i / 16;
        double h = himc_vec3_dot(c->n, himc_spline_segment_at(&piece, at).x);
        if (h < low || h > high)
            return false;
    }
    return true;
}

/// Comes to a halt from whatever the height is doing, before `limit`.
void himc_stroke_plan_brake(chunk *c, double limit)
{
    double h = c->at.h, v = c->at.v;
    double T = v < 0 ? fmin(0.12, 1.2 * fmax(h, 0.02) / -v) : 0.12;
    T = fmin(fmax(T, 0.02), 0.5 * (limit - c->lift_end));
    double stop = fmax(h + 0.5 * v * T, 0.2 * h);
    himc_stroke_plan_lift_to(c, c->lift_end + T, (chunk_height){stop, 0, 0});
}

/// The rebound as its nuance makes it: how high, how fast, and with what speed it floats on to
/// `next`.
void himc_stroke_plan_rebound(chunk *c, double top, double next)
{
    const himc_gesture *g = &c->plan->last.gesture;
    double h = c->at.h, v = c->at.v;
    double high = g->rebound * g->height;
    if (!c->plan->struck)
        high = h; // a rise that was broken off: only halt it
    // no higher than the next stroke needs it, unless there is time to bounce freely and sink
    double spare = fmin(fmax((top - c->lift_end - SINK_TIME) / SINK_TIME, 0), 1);
    if (high > next)
        high = next + spare * (high - next);
    high = fmax(high, h + v * 0.09 / 2.2);
    double pull = c->plan->struck ? g->pull : 2.0;
    double T = fmin(fmax(pull * (high - h) / v, 0.08), 0.3);
    T = fmin(T, 0.75 * (top - c->lift_end));
    high = fmin(fmax(high, h + v * T / 2.4), fmax(h, 0.9));
    double rest = top - c->lift_end - T;
    double on = 0;
    if (next > high && rest < SINK_TIME)
        on = fmin(1.5 * (next - high) / rest, 0.5 * v);
    himc_stroke_plan_lift_to(c, c->lift_end + T, (chunk_height){high, on, 0});
}

/// Sinks, waits low and is raised again, if there is time for that; returns when the last rise
/// begins.
static double sink(chunk *c, double top, double next)
{
    double spare = top - c->lift_end;
    double raise = fmin(0.45, 0.5 * spare);
    if (c->plan->away) {
        himc_stroke_plan_lift_to(c, top - fmin(c->approach, spare), (chunk_height){c->at.h, 0, 0});
        return c->lift_end;
    }
    if (spare <= SINK_TIME)
        return c->lift_end;
    double low = fmax(fmin(LOW, 0.9 * next), 0.05);
    low += (c->at.h - low) * (1 - fmin((spare - SINK_TIME) / 0.5, 1));
    double settle = fmin(0.6, 0.5 * spare);
    himc_stroke_plan_lift_to(c, c->lift_end + settle, (chunk_height){low, 0, 0});
    if (top - raise - c->lift_end > 0.05)
        himc_stroke_plan_lift_to(c, top - raise, (chunk_height){low + SWAY, 0, 0});
    return top - raise;
}

/// The longest rise that is one quintic (s): not slower than the way is long, nor than the last
/// nuance has it.
static double single_rise(const chunk *c, double next)
{
    const himc_gesture *last = &c->plan->last.gesture;
    if (c->at.v <= 0.3)
        return SINK_TIME;
    double longest = 2.6 * fmax(next - c->at.h, 0.01) / c->at.v;
    if (!c->plan->struck)
        return longest;
    double high = last->rebound * last->height, T = last->pull * high / c->at.v;
    return fmin(longest, fmax(1.5 * T, T + himc_move_time(fmax(next - high, 0), BRISK_MOVE)));
}

/// From the chunk's start to the apex of the stroke at time `top`; returns when the preparation
/// began.
double himc_stroke_plan_rise(chunk *c, double top, const himc_gesture *g)
{
    chunk_height apex = {g->height, 0, -g->arc * g->height / (g->down * g->down)};
    if (g->dwell > 0.01)
        apex.a = 0;
    double begin = c->lift_end, high = fmax(g->height, c->at.h);
    if (c->at.v < -0.3)
        himc_stroke_plan_brake(c, top);
    bool moving = c->at.v > 0.3;
    bool single = top - begin < HURRIED_RISE ||
                  (top - begin <= single_rise(c, g->height) &&
                   himc_stroke_plan_stays(c, top, apex, fmin(c->at.h, g->height) - 0.004,
                                          1.04 * high + 0.004));
    if (!single) {
        if (moving)
            himc_stroke_plan_rebound(c, top, g->height);
        begin = sink(c, top, g->height);
        if (c->at.v == 0 && top - c->lift_end > 1.5 * g->down)
            apex.a = 0;
    }
    if (!himc_stroke_plan_stays(c, top, apex, fmin(c->at.h, g->height) - 0.004,
                                1.04 * high + 0.004))
        apex.a = 0;
    himc_stroke_plan_lift_to(c, top, apex);
    return begin;
}

/// Whether the tip may simply fall from where it is, and how fast it then lands.
bool himc_stroke_plan_falls(const chunk *c, double t, himc_gesture *g)
{
    double T = t - c->lift_end, h = c->at.h;
    double longest = (c->at.v < -0.2 ? 3.5 : 2.5) * h / g->speed;
    if (h <= 0.01 || T > fmax(longest, LEAST_DOWN))
        return false;
    double speed = fmin(fmax(g->speed, SLOWEST_FALL * h / T), 2.4 * h / T);
    if (!himc_stroke_plan_stays(c, t, (chunk_height){0, -speed, 0}, -1e-6, 1.1 * h + 0.02))
        return false;
    g->speed = speed;
    g->height = h;
    return true;
}
