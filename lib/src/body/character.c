/// character.c: the state of the simulated body, moved by one of two engines: the tree (tree.c), or
/// ODE (engine_ode.c).
///
/// The state here is the body's only one. ODE's bodies receive it when ODE is to step and have not
/// made it themselves. ODE aborts the process for a quaternion without direction and accepts NaN
/// silently, so the state is checked where it is set and after each step; it aborts for an invalid
/// mass, so the skeleton is checked before. Legs at rest, under a fixed pelvis, keep their state to
/// the bit until a force on them changes: nothing else moves them.
#include "body/character.h"
#include "body/engine_ode.h"

#include <stdlib.h>
#include <string.h>

// chosen: beyond any motion of a limb and below the speeds at which ODE aborts
#define FASTEST_SPIN 3000 // (rad/s)
// chosen: far above any real value, and its square is still finite
#define LARGEST_SUM 1e30 // of squares: of all torques and forces, of all positions and velocities
#define UNIT_ERROR 0.01  // of a quaternion's square; chosen: engines keep 1e-12
// legs at rest. Chosen: above the noise of rounding, 1e-11 rad/s, and long enough that the turning
// point of a swing is none
#define STILL_SPIN 1e-9   // a leg that spins slower is still (rad/s)
#define STILL_STEPS 100   // steps after which still legs are at rest ...
#define STILL_TORQUE 1e-8 // ... while no torque on them changes by more (N m)

#define LEGS_SIZE ((HIMC_SEGMENTS - HIMC_LEGS) * sizeof(himc_vec3))

struct himc_character {
    himc_skeleton skeleton;
    himc_engine engine;
    segment_states state;
    himc_body_work *work; // borrowed, NULL when nobody asks
    himc_articulation articulation;
    bool articulated;       // the articulation belongs to this state
    bool given;             // ODE's bodies have this state
    bool sound;             // the engines take this state
    int still;              // steps in which no leg moved; above STILL_STEPS legs sleep
    segment_forces resting; // on the legs, in the last of these steps
    himc_ode *ode;          // owned; NULL in a library without ODE
    int first;              // segments that move: from the pelvis, 0, if it is free, else 1
};

// false if ODE's own checks would abort the process on one of segments first .. end - 1
static bool is_sound(const segment_states *s, int first, int end)
{
    double sum = 0;
    for (int i = first; i < end; i++) {
        himc_vec3 w = s->joints.spin[i], x = s->position[i], v = s->velocity[i];
        himc_quat q = s->joints.orientation[i];
        sum += himc_vec3_dot(x, x) + himc_vec3_dot(v, v);
        if (!(himc_vec3_dot(w, w) < FASTEST_SPIN * FASTEST_SPIN) ||
            !(fabs(himc_quat_dot(q, q) - 1) < UNIT_ERROR))
            return false;
    }
    return sum < LARGEST_SUM;
}

himc_character *himc_character_new(const himc_skeleton *skeleton, himc_error *error)
{
    himc_body_state state;
    himc_pose zero = himc_pose_zero();
    himc_character *c = calloc(1, sizeof *c);
    if (!c) {
        himc_error_set(error, "character: out of memory");
        return NULL;
    }
    c->skeleton = *skeleton;
    c->first = himc_first_moving(skeleton);
    himc_pose_to_state(skeleton, &zero, NULL, &state);
    himc_character_place(c, &state);
    c->ode = himc_ode_new(skeleton, &c->state, error);
    if (c->ode || !himc_ode_is_here())
        return c;
    free(c);
    return NULL;
}

void himc_character_free(himc_character *c)
{
    if (!c)
        return;
    himc_ode_free(c->ode);
    free(c);
}

void himc_character_use(himc_character *c, himc_engine engine)
{
    c->engine = engine;
}

himc_engine himc_character_engine(const himc_character *c)
{
    return c->engine;
}

double himc_character_kinetic(const himc_character *c)
{
    return himc_segments_kinetic(&c->skeleton, &c->state);
}

double himc_character_potential(const himc_character *c)
{
    return himc_segments_potential(&c->skeleton, &c->state);
}

static double energy(const himc_character *c)
{
    return himc_character_kinetic(c) + himc_character_potential(c);
}

void himc_character_account(himc_character *c, himc_body_work *work)
{
    c->work = work;
}

bool himc_character_place(himc_character *c, const himc_body_state *state)
{
    double before = c->work ? energy(c) : 0;
    himc_body_state *s = &c->state.joints;
    himc_vec3 v[HIMC_SEGMENTS]; // of the joints: the sum of w x r from the pelvis outwards
    *s = *state;
    s->orientation[0] = himc_quat_identity();
    s->spin[0] = v[0] = himc_vec3_make(0, 0, 0);
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        s->orientation[i] = himc_quat_unit(s->orientation[i]);
    himc_body_state_complete(&c->skeleton, s);
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        int p = c->skeleton.segment[i].parent;
        if (p >= 0) {
            himc_vec3 r = himc_vec3_sub(s->origin[i], s->origin[p]);
            v[i] = himc_vec3_add(v[p], himc_vec3_cross(s->spin[p], r));
        }
        himc_vec3 center = himc_mat3_apply(&s->rotation[i], c->skeleton.segment[i].center);
        c->state.position[i] = himc_vec3_add(s->origin[i], center);
        c->state.velocity[i] = himc_vec3_add(v[i], himc_vec3_cross(s->spin[i], center));
    }
    c->sound = is_sound(&c->state, c->first, HIMC_SEGMENTS);
    if (c->work && isfinite(before))
        c->work->placed += energy(c) - before;
    c->still = 0;
    c->articulated = c->given = false;
    return c->sound;
}

bool himc_character_seat(himc_character *c, double height)
{
    himc_pose zero = himc_pose_zero();
    if (!isfinite(height))
        return false;
    himc_body_state state = c->state.joints;
    c->skeleton.segment[HIMC_PELVIS].origin.z = height;
    if (!c->sound)
        himc_pose_to_state(&c->skeleton, &zero, NULL, &state);
    himc_character_place(c, &state);
    himc_ode_seat(c->ode, &c->state);
    return true;
}

void himc_character_observe(const himc_character *c, himc_body_state *s)
{
    *s = c->state.joints;
    if (c->first == 0) {
        himc_vec3 r = himc_mat3_apply(&s->rotation[0], c->skeleton.segment[0].center);
        s->velocity = himc_vec3_sub(c->state.velocity[0], himc_vec3_cross(s->spin[0], r));
    }
    // the tips from the stick's centre; along the joints their drift would add up
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int i = himc_stick_segment((himc_hand)hand);
        himc_vec3 center = c->skeleton.segment[i].center;
        himc_vec3 r = himc_mat3_apply(&s->rotation[i], himc_vec3_sub(c->skeleton.tip, center));
        s->tip[hand] = himc_vec3_add(c->state.position[i], r);
        s->tip_velocity[hand] = himc_vec3_add(c->state.velocity[i], himc_vec3_cross(s->spin[i], r));
    }
}

const himc_articulation *himc_character_articulation(himc_character *c)
{
    bool asleep = c->engine == HIMC_ENGINE_TREE && c->still > STILL_STEPS;
    if (!c->articulated)
        (asleep ? himc_articulate_upper : himc_articulate)(&c->skeleton, &c->state.joints,
                                                           &c->articulation);
    c->articulated = true;
    return &c->articulation;
}

static void fill_forces(const himc_character *c, const himc_step_forces *sources, segment_forces *f)
{
    f->force[0] = f->torque[0] = himc_vec3_make(0, 0, 0);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        int p = c->skeleton.segment[i].parent;
        f->force[i] = himc_vec3_make(0, 0, 0);
        f->torque[i] = sources->torque[i - 1];
        f->torque[p] = himc_vec3_sub(f->torque[p], sources->torque[i - 1]);
    }
    for (int k = 0; k < sources->contacts; k++) {
        const world_contact *contact = &sources->contact[k];
        int i = contact->segment;
        himc_vec3 at = himc_vec3_sub(contact->at, c->skeleton.segment[i].center);
        at = himc_mat3_apply(&c->state.joints.rotation[i], at);
        f->force[i] = himc_vec3_add(f->force[i], contact->force);
        f->torque[i] = himc_vec3_add(f->torque[i], himc_vec3_cross(at, contact->force));
    }
}

static void step_ode(himc_character *c, const segment_forces *f, double h)
{
    if (!c->given)
        himc_ode_give(c->ode, &c->state);
    himc_ode_step(c->ode, f, h, &c->state);
    c->still = 0;
}

// true if the legs are at rest and no force on them has changed: then nothing moves them
static bool legs_rest(const himc_character *c, const segment_forces *f)
{
    bool same = c->first > 0 && c->still >= STILL_STEPS;
    for (int i = HIMC_LEGS; same && i < HIMC_SEGMENTS; i++) {
        himc_vec3 force = himc_vec3_sub(f->force[i], c->resting.force[i]);
        himc_vec3 torque = himc_vec3_sub(f->torque[i], c->resting.torque[i]);
        same = himc_vec3_dot(force, force) == 0 &&
               himc_vec3_dot(torque, torque) < STILL_TORQUE * STILL_TORQUE;
    }
    return same;
}

static void step_tree(himc_character *c, const segment_forces *f, double h)
{
    bool rest = legs_rest(c, f);
    c->articulated = c->articulated && rest == (c->still > STILL_STEPS);
    c->still = rest ? STILL_STEPS + 1 : c->still < STILL_STEPS ? c->still : STILL_STEPS;
    himc_character_articulation(c);
    himc_tree_step(&c->skeleton, &c->articulation, f, HIMC_JOINT_ERP, h, &c->state);
    if (rest)
        return;
    bool still = true;
    for (int i = HIMC_LEGS; i < HIMC_SEGMENTS; i++) {
        himc_vec3 w = c->state.joints.spin[i];
        still = still && himc_vec3_dot(w, w) < STILL_SPIN * STILL_SPIN;
    }
    c->still = still ? c->still + (c->still < STILL_STEPS) : 0;
    memcpy(&c->resting.force[HIMC_LEGS], &f->force[HIMC_LEGS], LEGS_SIZE);
    memcpy(&c->resting.torque[HIMC_LEGS], &f->torque[HIMC_LEGS], LEGS_SIZE);
}

bool himc_character_step(himc_character *c, const himc_vec3 torque[HIMC_JOINTS],
                         const world_contact *contact, int contacts, double h)
{
    const himc_step_forces sources = {torque, contact, contacts};
    segment_forces f;
    segment_states before; // what himc_body_work_add reads of it
    himc_body_work work;
    double sum = 0;
    fill_forces(c, &sources, &f);
    for (int i = c->first; i < HIMC_SEGMENTS; i++)
        sum += himc_vec3_dot(f.force[i], f.force[i]) + himc_vec3_dot(f.torque[i], f.torque[i]);
    if (!c->sound || !(sum < LARGEST_SUM))
        return false;
    if (c->work) {
        work = *c->work;
        memcpy(before.joints.spin, c->state.joints.spin, sizeof before.joints.spin);
        memcpy(before.joints.rotation, c->state.joints.rotation, sizeof before.joints.rotation);
        memcpy(before.velocity, c->state.velocity, sizeof before.velocity);
        himc_character_articulation(c);
    }
    if (c->engine == HIMC_ENGINE_ODE)
        step_ode(c, &f, h);
    else
        step_tree(c, &f, h);
    if (c->work)
        himc_body_work_add(c->work, &c->skeleton, &c->articulation, &sources, &before, &c->state,
                           h);
    c->articulated = false;
    c->given = c->engine == HIMC_ENGINE_ODE;
    c->sound = is_sound(&c->state, c->first, c->still > STILL_STEPS ? HIMC_LEGS : HIMC_SEGMENTS);
    if (c->work && !c->sound)
        *c->work = work;
    return c->sound;
}
