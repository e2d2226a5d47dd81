/// follow.c: live targets: a mouse at 10 Hz or a tracker at 1 kHz, made into smooth motion.
///
/// Each target x_k that comes T after the one before is met T later with the speed v_k the targets
/// have, on a quintic from wherever the tip is: so the tip lags by one period, whatever the rate,
/// and moves steadily while the targets do. Faster streams than 1/SHORTEST are met on longer
/// quintics, carried on by v_k to the same lag; v_k is smoothed over SMOOTHING.
///
/// A tracker's noise must not be differentiated. It shows in third differences, of variance 20
/// sigma^2, in which motion nearly cancels; sigma follows their median in steps that a single jump
/// cannot hurry. Targets that shake are replaced by a parabola fitted to all, weights fading
/// with a memory tau (Morrison 1969, the critically damped g-h-k filter; it does not lag behind
/// steady acceleration), which leaves of acceleration sigma_a^2 = 0.187 sigma^2 T / tau^5: tau is
/// what makes that RESTLESS. A target after a pause is a place to go to. When no more come,
/// the tip goes on for half a period and comes to rest. Invariant: position, velocity and
/// acceleration are continuous.
#include "plan/stroke_plan.h"
#include "plan/planner_state.h"

#define LOST 0.3         // a target later than this after the last begins anew (s)
#define SHORTEST 0.010   // quintic to meet a target on (s)
#define SMOOTHING 0.010  // of the speed (s)
#define RESTLESS 1.0     // acceleration that noise may make (m/s^2)
#define LONGEST 0.04     // memory (s)
#define CALMLY 3.0       // times the memory: quintic to meet a target that shakes on
#define LEARNING 20.0    // of the noise: its logarithm's rate (1/s)
#define LEAST_NOISE 1e-6 // (m)
#define PERIODS 0.25     // share of a new period in the estimate
#define HARDEST 250.0    // peak acceleration to meet a target (m/s^2)
#define BRAKING 20.0     // (m/s^2)
#define SHORT_BRAKE 0.15 // (s)
#define STROKE_AHEAD 0.6 // a stroke so near is played, not the targets (s)

void himc_hand_follow(himc_hand_plan *plan, double t, const himc_target *aim, double blend,
                      double hold)
{
    himc_hand_cut(plan, t);
    t = fmax(t, plan->end);
    himc_target from = himc_hand_at(plan, t), nothing = {0}, held = *aim, rest = {0};
    double brake = fmax(SHORT_BRAKE, himc_vec3_length(aim->v) / BRAKING);
    double coast = himc_vec3_length(himc_vec3_sub(aim->x, himc_vec3_madd(from.x, blend, from.v)));
    blend = fmax(blend, himc_move_time(coast, HARDEST));
    held.x = himc_vec3_madd(aim->x, hold, aim->v);
    rest.x = himc_vec3_madd(held.x, 0.5 * brake, held.v);
    plan->end = t + blend + hold + brake;
    himc_spline_add(&plan->ground, t, &from, t + blend, aim);
    himc_spline_add(&plan->ground, t + blend, aim, t + blend + hold, &held);
    himc_spline_add(&plan->ground, t + blend + hold, &held, plan->end, &rest);
    himc_spline_add(&plan->lift, t, &nothing, plan->end, &nothing);
    plan->home = rest.x;
    plan->struck = false;
    plan->away = true;
}

// whether a stroke of the hand comes so soon that it must be prepared now
static bool stroke_near(const himc_planner *planner, const planner_hand *h, double t)
{
    int index, round;
    double next;
    for (int i = 0; i < h->touches; i++)
        if (h->touch[i].goal.time > t && h->touch[i].goal.time < t + STROKE_AHEAD)
            return true;
    if (h->hits > 0 && h->hit[0].goal.time < t + STROKE_AHEAD)
        return true;
    return himc_planner_next(planner, h, 0, &index, &round, &next) && next < t + STROKE_AHEAD;
}

// one more target's part in what is known of the noise; the median length of third differences of
// three normal coordinates is 1.5382 sqrt(20) sigma
static void learn_noise(planner_stream *s, double gap, himc_vec3 x)
{
    himc_vec3 inner = himc_vec3_sub(s->x, s->before[0]), outer = himc_vec3_sub(x, s->before[1]);
    if (s->heard >= 2) {
        double size = himc_vec3_length(himc_vec3_madd(outer, -3, inner)) / (1.5382 * sqrt(20));
        double step = exp(fmin(LEARNING * gap, 1));
        s->noise = fmax(size > s->noise ? s->noise * step : s->noise / step, LEAST_NOISE);
    }
    s->heard++;
    s->before[1] = s->before[0];
    s->before[0] = s->x;
}

// the fading parabola
static void filter(planner_stream *s, double gap, himc_vec3 x)
{
    himc_target *f = &s->filtered;
    s->memory = fmin(pow(0.187 * s->noise * s->noise * gap / (RESTLESS * RESTLESS), 0.2), LONGEST);
    double q = exp(-gap / s->memory), p = 1 - q;
    himc_vec3 v = himc_vec3_madd(f->v, gap, f->a);
    himc_vec3 now = himc_vec3_madd(himc_vec3_madd(f->x, gap, f->v), 0.5 * gap * gap, f->a);
    himc_vec3 off = himc_vec3_sub(x, now);
    f->x = himc_vec3_madd(now, 1 - q * q * q, off);
    f->v = himc_vec3_madd(v, 1.5 * p * p * (1 + q) / gap, off);
    f->a = himc_vec3_madd(f->a, p * p * p / (gap * gap), off);
}

// what the stream does with one more target; true if it is a stream already
static bool listen(planner_stream *s, double t, himc_vec3 x)
{
    double gap = t - s->time;
    bool on = gap < LOST;
    if (!on)
        *s = (planner_stream){.noise = LEAST_NOISE, .filtered = {.x = x}};
    if (on && gap > 0) {
        learn_noise(s, gap, x);
        filter(s, gap, x);
        himc_vec3 v = himc_vec3_scale(himc_vec3_sub(x, s->x), 1 / gap);
        s->period = s->period > 0 ? s->period + PERIODS * (gap - s->period) : gap;
        double share = s->moving ? gap / (gap + SMOOTHING) : 1;
        s->v = himc_vec3_madd(himc_vec3_scale(s->v, 1 - share), share, v);
        s->moving = true;
    }
    s->time = t;
    s->x = x;
    return on && s->period > 0;
}

// whether more than one target is worth remembering
static bool shakes(const planner_stream *s)
{
    return s->memory >= s->period;
}

// the last target carried on for `ahead`
static himc_target aim_at(const planner_stream *s, double ahead)
{
    const himc_target *f = &s->filtered;
    if (!shakes(s))
        return (himc_target){himc_vec3_madd(s->x, ahead, s->v), s->v, {0, 0, 0}};
    himc_vec3 x = himc_vec3_madd(f->x, ahead, f->v);
    return (himc_target){himc_vec3_madd(x, 0.5 * ahead * ahead, f->a),
                         himc_vec3_madd(f->v, ahead, f->a), f->a};
}

void himc_planner_reach(himc_planner *planner, double t, himc_hand hand, himc_vec3 x)
{
    if (!isfinite(t) || !himc_vec3_finite(x))
        return;
    planner_hand *h = &planner->hand[hand];
    bool stream = listen(&h->stream, t, x);
    if (stroke_near(planner, h, t))
        return;
    himc_planner_cut(planner, hand, t);
    if (stream && himc_hand_room(&h->plan)) {
        const planner_stream *s = &h->stream;
        double blend = fmax(fmax(s->period, SHORTEST), shakes(s) ? CALMLY * s->memory : 0);
        himc_target aim = aim_at(s, blend - s->period);
        himc_hand_follow(&h->plan, t, &aim, blend, 0.5 * s->period);
    } else {
        himc_hand_reach(&h->plan, x);
    }
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
}
