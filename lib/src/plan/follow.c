/// follow.c: live targets, from a mouse at 10 Hz to a tracker at 1 kHz, made into smooth motion.
///
/// Each target x_k that comes T after the one before is met T later with the velocity v_k of the
/// targets, on a quintic from the tip's present state: so the tip lags by one period at any rate,
/// and moves steadily while the targets do. Streams faster than 1/SHORTEST_BLEND are met on longer
/// quintics, carried on by v_k to the same lag; v_k is smoothed over VELOCITY_TIME.
///
/// A tracker's noise must not be differentiated. It shows in third differences, of variance 20
/// sigma^2, in which motion nearly cancels; sigma follows their median in steps that a single jump
/// cannot hurry. Targets that shake are replaced by a parabola fitted to all, with weights that
/// fade with a memory tau (Morrison 1969, the critically damped g-h-k filter; it does not lag
/// behind steady acceleration). The noise that is left in the acceleration is sigma_a^2 = 0.187
/// sigma^2 T / tau^5; tau is chosen so that sigma_a is NOISE_ACCELERATION.
///
/// A target after a pause is a place to go to. So is one from which the tip is still far away: its
/// velocity is scaled down. The first two targets, and targets that arrive in a burst after a delay
/// of the network, do not tell the velocity: it is at most what half of the period allows. When no
/// more targets come, the tip goes on for half a period and comes to rest at the last one.
/// Invariant: position, velocity and acceleration are continuous.
#include "plan/follow.h"

// the stream; chosen: steady for a mouse (60 Hz) and a tracker (1 kHz) alike, see
// tests/performance/test_live.c
#define STREAM_PAUSE 0.3       // a target later than this after the last begins anew (s)
#define PERIOD_SHARE 0.25      // of a new period in the estimate
#define VELOCITY_TIME 0.010    // smooths the velocity (s)
#define BURST_SHARE 0.5        // of the period: a shorter gap is a burst and counts as this; chosen
#define FIRST_GAP 0.03         // the gap of the first two counts as this at least (s); chosen
#define SHORTEST_BLEND 0.010   // quintic to meet a target on (s)
#define NOISE_ACCELERATION 1.0 // that noise may cause (m/s^2)
#define LONGEST_MEMORY 0.04    // of the filter (s)
#define BLEND_MEMORIES 3.0     // a target that shakes is met on a quintic of so many memories
#define NOISE_RATE 20.0        // of learning the noise: change of its logarithm (1/s)
#define LEAST_NOISE 1e-6       // (m)

// the tip; chosen: within the limits of an arm, and a halt without a jerk
#define BRAKING 60.0 // mean acceleration of the halt (m/s^2)
// A tip follows the stream if its own velocity brings it so near to the next meeting.
#define FOLLOWED 0.05              // (m) chosen: one target at 250 Hz in a stroke of 10 m/s
#define FOLLOWED_ACCELERATION 30.0 // ... and what this changes meanwhile (m/s^2); chosen: a mouse
#define SHORTEST_HALT 0.15         // (s)
#define FASTEST_STREAM 10.0 // (m/s) as captured sticks; faster targets jump, and are not carried on

/// Takes in one more target. The median length of third differences of three normal coordinates,
/// which gives the noise, is 1.5382 sqrt(20) sigma (chi distribution of three degrees of freedom).
static void filter(himc_stream *s, double gap, himc_vec3 x)
{
    himc_target *f = &s->filtered;
    himc_vec3 inner = himc_vec3_sub(s->x, s->before[0]), outer = himc_vec3_sub(x, s->before[1]);
    if (s->heard++ >= 2) {
        double size = himc_vec3_length(himc_vec3_madd(outer, -3, inner)) / (1.5382 * sqrt(20));
        double step = exp(fmin(NOISE_RATE * gap, 1));
        s->noise = fmax(size > s->noise ? s->noise * step : s->noise / step, LEAST_NOISE);
    }
    s->before[1] = s->before[0];
    s->before[0] = s->x;
    // one step of the fading-memory parabola
    double least = NOISE_ACCELERATION * NOISE_ACCELERATION;
    s->memory = fmin(pow(0.187 * s->noise * s->noise * gap / least, 0.2), LONGEST_MEMORY);
    double q = exp(-gap / s->memory), p = 1 - q;
    himc_target now = himc_target_after(f, gap);
    himc_vec3 off = himc_vec3_sub(x, now.x);
    f->x = himc_vec3_madd(now.x, 1 - q * q * q, off);
    f->v = himc_vec3_madd(now.v, 1.5 * p * p * (1 + q) / gap, off);
    f->a = himc_vec3_madd(f->a, p * p * p / (gap * gap), off);
}

void himc_stream_init(himc_stream *s)
{
    *s = (himc_stream){.time = -HUGE_VAL};
}

bool himc_stream_add(himc_stream *s, double t, himc_vec3 x)
{
    double gap = t - s->time;
    bool on = gap < STREAM_PAUSE;
    if (!on)
        *s = (himc_stream){.noise = LEAST_NOISE, .filtered = {.x = x}};
    if (on && gap > 0) {
        filter(s, gap, x);
        double least = s->period > 0 ? BURST_SHARE * s->period : FIRST_GAP;
        double share = s->period > 0 ? gap / (gap + VELOCITY_TIME) : 1;
        himc_vec3 v = himc_vec3_scale(himc_vec3_sub(x, s->x), 1 / fmax(gap, least));
        s->period = s->period > 0 ? s->period + PERIOD_SHARE * (gap - s->period) : gap;
        s->v = himc_vec3_madd(himc_vec3_scale(s->v, 1 - share), share, v);
    }
    s->time = t;
    s->x = x;
    return on && s->period > 0;
}

/// True if the noise is worth a filter: its memory is longer than a period.
static bool shakes(const himc_stream *s)
{
    return s->memory >= s->period;
}

/// The last target, carried on for `ahead` (s).
static himc_target aim_at(const himc_stream *s, double ahead)
{
    himc_target last = shakes(s) ? s->filtered : (himc_target){s->x, s->v, {0, 0, 0}};
    double speed = himc_vec3_length(last.v);
    if (speed > FASTEST_STREAM)
        last = (himc_target){last.x, himc_vec3_scale(last.v, FASTEST_STREAM / speed), {0, 0, 0}};
    return himc_target_after(&last, ahead);
}

void himc_stream_follow(const himc_stream *s, himc_hand_plan *plan, double t)
{
    double blend =
        fmax(fmax(s->period, SHORTEST_BLEND), shakes(s) ? BLEND_MEMORIES * s->memory : 0);
    double hold = 0.5 * s->period;
    himc_target met = aim_at(s, blend - s->period), rest = himc_target_at_rest(aim_at(s, 0).x);
    himc_hand_cut(plan, t);
    t = fmax(t, plan->end);
    himc_target from = himc_hand_at(plan, t), nothing = {0};
    double coast = himc_vec3_length(himc_vec3_sub(met.x, himc_vec3_madd(from.x, blend, from.v)));
    double near = FOLLOWED + 0.5 * FOLLOWED_ACCELERATION * blend * blend;
    if (coast > near) {
        met.v = himc_vec3_scale(met.v, near / coast);
        met.x = himc_vec3_madd(rest.x, near / coast, himc_vec3_sub(met.x, rest.x));
    }
    plan->lift.count = 0; // `from` contains it
    double halt = fmax(SHORTEST_HALT, himc_vec3_length(met.v) / BRAKING);
    blend = fmax(blend, himc_move_time(coast, HIMC_HARDEST_MOVE));
    himc_target held = met;
    held.x = himc_vec3_madd(met.x, hold, met.v);
    plan->end = t + blend + hold + halt;
    himc_spline_add(&plan->tangential_path, t, &from, t + blend, &met);
    himc_spline_add(&plan->tangential_path, t + blend, &met, t + blend + hold, &held);
    himc_spline_add(&plan->tangential_path, t + blend + hold, &held, plan->end, &rest);
    himc_spline_add(&plan->height_profile, t, &nothing, plan->end, &nothing);
    plan->home = rest.x;
    plan->rebounding = false;
    plan->at_home = true;
}
