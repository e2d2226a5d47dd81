/// motion.c: a sequence is made: random strokes, their two postures, and the joints between them.
///
/// Each stroke has a posture of its impact and one of its apex, which sequence.c interpolates.
/// Strokes vary in height, speed, timing, aim and posture by first-order autoregressive noise. Only
/// the joints are moved; the tips follow by forward kinematics.
#include "motion.h"
#include "body/posture.h"

#include <stdlib.h>

// all chosen, with the spreads so that strokes vary like measured ones (README.md)
#define FIRST_IMPACT 1.0     // (s)
#define TAIL 0.8             // after the last impact (s)
#define MEMORY 0.4           // correlation of the variation from stroke to stroke
#define WITH_HEIGHT 0.8      // part of a speed's variation that follows the height's ...
#define OWN 0.6              // ... and the independent part: the squares sum to one
#define AIM_SPREAD 0.003     // standard deviations: of the aim (m)
#define OUT_SPREAD 0.006     // of the elbow's angle (rad)
#define HAND_SPREAD 0.005    // of the hand's elevation (rad)
#define SHOULDER_SPREAD 0.03 // of the shoulder's share of the flexion
#define RISE_SPREAD 0.025    // of the wrist's share of the flexion of wrist and fingers
#define LEVEL_SPREAD 0.006   // of the stick's elevation at impact (rad)
#define TIME_SPREAD 0.012    // of intervals (shares)
#define MOST_FLEXION 1.6     // of the elbow, searched in ...
#define FLEXION_STEP 0.02    // ... steps (rad)

himc_mocap_config himc_mocap_default(void)
{
    return (himc_mocap_config){
        .nuance = HIMC_LEGATO, .spot = HIMC_SPOT_NORMAL, .seed = 1, .strokes = 16, .pace = 1};
}

// variations of one hand's strokes
typedef struct variation {
    double height, down, up, x, y, out, hand, rise, level;
} variation;

static void next_variation(variation *now, mocap_random *random)
{
    double *number = (double *)now;
    for (size_t i = 0; i < sizeof *now / sizeof *number; i++)
        number[i] = MEMORY * number[i] + sqrt(1 - MEMORY * MEMORY) * himc_mocap_normal(random);
}

static mocap_gesture vary_gesture(const himc_mocap *m, const variation *now)
{
    mocap_gesture g = himc_mocap_gesture[m->config.nuance];
    const mocap_player *p = m->player;
    double height = p->size * exp(p->looseness * g.spread[0] * now->height);
    double down = exp(p->looseness * g.spread[1] * (WITH_HEIGHT * now->height + OWN * now->down));
    double up = exp(p->looseness * g.spread[2] * (WITH_HEIGHT * now->height + OWN * now->up));
    double fingers = p->fingers * g.wrist, rise = 1 + RISE_SPREAD * p->looseness * now->rise;
    g.height *= height;
    g.wrist = height * rise * (g.wrist - fingers);
    g.grip = height * (2 - rise) * (g.grip + fingers);
    g.shoulder *= p->shoulder * (1 + SHOULDER_SPREAD * p->looseness * now->hand);
    g.down *= down;
    g.impact *= down;
    g.up *= up;
    g.rebound *= up;
    g.fall *= p->pace;
    g.lift *= p->pace;
    g.interval *= p->pace;
    return g;
}

static void draw_stroke(const himc_mocap *m, himc_hand hand, const variation *now, mocap_stroke *s)
{
    const mocap_player *p = m->player;
    double side = hand == HIMC_LEFT ? 1 : -1, loose = p->looseness;
    s->gesture = vary_gesture(m, now);
    s->aim = himc_vec3_make(p->edge + himc_mocap_spot(m->config.spot) + AIM_SPREAD * loose * now->x,
                            side * p->apart + AIM_SPREAD * loose * now->y,
                            HIMC_MOCAP_HEAD + m->skeleton.mallet_radius);
    s->low = (mocap_key){.tip = s->aim,
                         .stick = LEVEL_SPREAD * loose * now->level,
                         .hand = p->palm + HAND_SPREAD * loose * now->hand,
                         .out = p->out + OUT_SPREAD * loose * now->out,
                         .french = p->french};
}

// the flexion of all joints from the posture of impact, for an elbow flexed by `elbow` (rad)
static void flex(const mocap_gesture *g, const himc_vec3 axis[], double elbow,
                 himc_vec3 way[HIMC_ARM_JOINTS])
{
    double angle[HIMC_ARM_JOINTS] = {g->shoulder * elbow, elbow, g->wrist, g->grip};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        way[k] = himc_vec3_scale(axis[k], angle[k]);
}

// height of the point at the apex over that at impact, the elbow flexed by `elbow`
static double rise_of(const himc_mocap *m, himc_hand hand, const himc_quat low[],
                      const himc_vec3 way[])
{
    himc_quat trunk = himc_mocap_trunk_mean(m), high[HIMC_ARM_JOINTS];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        high[k] = himc_quat_mul(low[k], himc_quat_exp(way[k]));
    return himc_mocap_stick_point(&m->skeleton, trunk, hand, high, MOCAP_POINT).z -
           himc_mocap_stick_point(&m->skeleton, trunk, hand, low, MOCAP_POINT).z;
}

// the elbow's flexion that lifts the point to the wanted height, or as high as possible
static double find_flexion(const himc_mocap *m, himc_hand hand, const mocap_gesture *g,
                           const himc_quat low[], const himc_vec3 axis[])
{
    himc_vec3 way[HIMC_ARM_JOINTS];
    double best = 0, highest = -HUGE_VAL, from = 0, to = 0;
    for (to = 0; to < MOST_FLEXION; from = to, to += FLEXION_STEP) {
        flex(g, axis, to, way);
        double height = rise_of(m, hand, low, way);
        if (height >= g->height)
            break;
        best = height > highest ? to : best;
        highest = fmax(highest, height);
    }
    if (to >= MOST_FLEXION)
        return best;
    while (to - from > 1e-9) {
        double middle = 0.5 * (from + to);
        flex(g, axis, middle, way);
        if (rise_of(m, hand, low, way) < g->height)
            from = middle;
        else
            to = middle;
    }
    return to;
}

static void find_apex(const himc_mocap *m, himc_hand hand, mocap_stroke *s, const himc_quat low[])
{
    himc_vec3 axis[HIMC_ARM_JOINTS], way[HIMC_ARM_JOINTS];
    himc_mocap_flexion(himc_mocap_trunk_mean(m), low, axis);
    flex(&s->gesture, axis, find_flexion(m, hand, &s->gesture, low, axis), way);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_quat high = himc_quat_mul(low[k], himc_quat_exp(way[k]));
        double loop = k == 0 ? -s->gesture.loop : k == 1 ? s->gesture.loop : 0;
        s->apex[k] = himc_quat_log(himc_quat_mul(himc_quat_conj(m->arm[hand].mean[k]), high));
        s->loop[k] = himc_vec3_scale(axis[k], loop);
    }
}

// the aim moves with the trunk, except up and down
static void carry_aim(const himc_mocap *m, himc_hand hand, mocap_stroke *s)
{
    const himc_quat *mean = m->arm[hand].mean;
    himc_vec3 there =
        himc_mocap_stick_point(&m->skeleton, himc_mocap_trunk(m, s->touch), hand, mean, 0);
    himc_vec3 usual = himc_mocap_stick_point(&m->skeleton, himc_mocap_trunk_mean(m), hand, mean, 0);
    s->aim.x += there.x - usual.x;
    s->aim.y += there.y - usual.y;
    s->low.tip = s->aim;
}

static bool find_postures(const himc_mocap *m, himc_hand hand, mocap_stroke *s)
{
    himc_quat low[HIMC_ARM_JOINTS];
    carry_aim(m, hand, s);
    if (!himc_mocap_arm(&m->skeleton, himc_mocap_trunk(m, s->touch), hand, &s->low, low))
        return false;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        s->impact[k] = himc_quat_log(himc_quat_mul(himc_quat_conj(m->arm[hand].mean[k]), low[k]));
    find_apex(m, hand, s, low);
    return true;
}

// strokes of both hands in turn, the right one first
static void draw_strokes(himc_mocap *m, mocap_random *random)
{
    variation now[HIMC_HANDS] = {0};
    double t = FIRST_IMPACT;
    for (int i = 0; i < m->config.strokes; i++) {
        himc_hand hand = i % 2 ? HIMC_LEFT : HIMC_RIGHT;
        mocap_stroke *s = &m->arm[hand].stroke[m->arm[hand].count++];
        next_variation(&now[hand], random);
        draw_stroke(m, hand, &now[hand], s);
        s->touch = t;
        t += 0.5 * s->gesture.interval * (1 + TIME_SPREAD * himc_mocap_normal(random));
    }
    m->length = t - 0.5 * himc_mocap_gesture[m->config.nuance].interval + TAIL;
}

// the trunk's sway, which depends on the strokes' times alone and is needed for the postures
static void add_effort(mocap_arm *arm)
{
    for (int i = 0; i < arm->count; i++) {
        const mocap_stroke *s = &arm->stroke[i];
        himc_mocap_curve_add(&arm->effort, (mocap_knot){s->touch - s->gesture.fall, 1, 0, 0});
        himc_mocap_curve_add(&arm->effort, (mocap_knot){s->touch, 0, 0, 0});
        himc_mocap_curve_add(&arm->effort, (mocap_knot){s->touch + s->gesture.lift, 1, 0, 0});
    }
}

static void wander_all(himc_mocap *m, mocap_random *random)
{
    m->turn = himc_mocap_wander(random);
    m->lean = himc_mocap_wander(random);
    m->nod = himc_mocap_wander(random);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            for (int axis = 0; axis < 3; axis++)
                m->arm[hand].wander[k][axis] = himc_mocap_wander(random);
}

// the reference of all postures: the impact of a stroke without variation
static bool find_mean(himc_mocap *m, himc_hand hand)
{
    variation none = {0};
    mocap_stroke usual;
    draw_stroke(m, hand, &none, &usual);
    return himc_mocap_arm(&m->skeleton, himc_mocap_trunk_mean(m), hand, &usual.low,
                          m->arm[hand].mean);
}

static bool make_motion(himc_mocap *m, himc_error *error)
{
    int which[3] = {m->config.player, (int)m->config.nuance, (int)m->config.spot};
    mocap_random random = himc_mocap_random(m->config.seed, which, 3);
    wander_all(m, &random);
    draw_strokes(m, &random);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        add_effort(&m->arm[hand]);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        bool reached = find_mean(m, (himc_hand)hand);
        for (int i = 0; reached && i < m->arm[hand].count; i++)
            reached = find_postures(m, (himc_hand)hand, &m->arm[hand].stroke[i]);
        if (!reached)
            return himc_error_set(error, "%s, %s: the drum is out of reach", m->player->name,
                                  himc_nuance_name(m->config.nuance));
    }
    himc_mocap_coordinate(m);
    return true;
}

static bool make_room(himc_mocap *m)
{
    int room = m->config.strokes / 2 + 1;
    bool ok = true;
    for (int hand = 0; ok && hand < HIMC_HANDS; hand++) {
        mocap_arm *arm = &m->arm[hand];
        arm->stroke = calloc((size_t)room, sizeof *arm->stroke);
        ok = arm->stroke && himc_mocap_curve_init(&arm->loop, 3 * room) &&
             himc_mocap_curve_init(&arm->effort, 3 * room);
        for (int k = 0; ok && k < HIMC_ARM_JOINTS; k++)
            ok = himc_mocap_curve_init(&arm->share[k], MOCAP_GRIP_KNOTS * room + 1);
    }
    return ok;
}

static bool check_config(const himc_mocap_config *c, himc_error *error)
{
    return himc_check_range("player", c->player, 0, HIMC_MOCAP_PLAYERS - 1, "", error) &&
           himc_check_range("nuance", c->nuance, 0, HIMC_NUANCES - 1, "", error) &&
           himc_check_range("spot", c->spot, 0, HIMC_SPOT_RIM, "", error) &&
           himc_check_range("strokes", c->strokes, 2, 200, "", error) &&
           himc_check_range("pace", c->pace, 0.25, 4, "", error);
}

himc_mocap *himc_mocap_new(const himc_mocap_config *config, himc_error *error)
{
    himc_skeleton_config body;
    himc_posture posture;
    if (!check_config(config, error))
        return NULL;
    himc_mocap *m = calloc(1, sizeof *m);
    if (!m) {
        himc_error_set(error, "no memory for a sequence");
        return NULL;
    }
    m->config = *config;
    m->player = &himc_mocap_player[config->player];
    body = himc_mocap_body(config->player);
    bool ok = himc_skeleton_init(&m->skeleton, &body, error);
    if (ok && !make_room(m))
        ok = himc_error_set(error, "no memory for %d strokes", config->strokes);
    if (ok) {
        himc_posture_init(&posture, &m->skeleton, HIMC_MOCAP_HEAD);
        m->rest = posture.rest;
        ok = make_motion(m, error);
    }
    if (ok)
        return m;
    himc_mocap_free(m);
    return NULL;
}

void himc_mocap_free(himc_mocap *m)
{
    for (int hand = 0; m && hand < HIMC_HANDS; hand++) {
        free(m->arm[hand].stroke);
        himc_mocap_curve_free(&m->arm[hand].loop);
        himc_mocap_curve_free(&m->arm[hand].effort);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            himc_mocap_curve_free(&m->arm[hand].share[k]);
    }
    free(m);
}
