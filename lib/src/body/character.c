/// character.c: 19 ODE bodies for the segments beyond the pelvis, 19 ball joints, one loop over
/// the table.
///
/// The frame of an ODE body is its segment's, moved to the centre of mass, as ODE requires. The
/// pelvis is ODE's world (body 0), so the trunk and each leg are separate islands and ODE solves
/// three small systems. dWorldStep is deterministic to the bit (QuickStep draws random numbers).
/// ODE aborts the process on an invalid mass, so the skeleton is checked before; it accepts NaN
/// silently, so himc_performance checks the state after each step.
#include "body/character.h"

#include <ode/ode.h>
#include <stdlib.h>

// share of a joint's drift that ODE corrects per step. Chosen: the drift then measures 3e-8 m
#define JOINT_ERP 0.8
// chosen: beyond any motion of a limb and below the speeds at which ODE aborts
#define FASTEST_SPIN 3000 // (rad/s)
// chosen: far above any real value, and its square is still finite
#define LARGEST_SUM 1e30 // of the squares of all torques, forces, positions and velocities
#define FIRST_STEP 1e-4  // chosen: any valid step makes the engine allocate (s)

struct himc_character {
    himc_skeleton skeleton;
    dWorldID world;
    dBodyID body[HIMC_SEGMENTS]; // [0], the pelvis, is NULL: the world
};

static void make_body(himc_character *c, int i)
{
    const himc_segment *segment = &c->skeleton.segment[i];
    dMass mass;
    c->body[i] = dBodyCreate(c->world);
    dMassSetParameters(&mass, segment->mass, 0, 0, 0, segment->inertia.x, segment->inertia.y,
                       segment->inertia.z, 0, 0, 0);
    dBodySetMass(c->body[i], &mass);
    dBodySetAutoDisableFlag(c->body[i], 0);
    dBodySetGyroscopicMode(c->body[i], 1);
}

static void make_joint(himc_character *c, int i, const himc_body_state *state)
{
    dJointID joint = dJointCreateBall(c->world, 0);
    dJointAttach(joint, c->body[i], c->body[c->skeleton.segment[i].parent]);
    dJointSetBallAnchor(joint, state->origin[i].x, state->origin[i].y, state->origin[i].z);
}

himc_character *himc_character_new(const himc_skeleton *skeleton, himc_error *error)
{
    himc_character *c = calloc(1, sizeof *c);
    if (!c || !dInitODE2(0) || !dAllocateODEDataForThread(dAllocateMaskAll)) {
        free(c);
        himc_error_set(error, "character: out of memory for the physics engine");
        return NULL;
    }
    c->skeleton = *skeleton;
    c->world = dWorldCreate();
    dWorldSetGravity(c->world, 0, 0, -HIMC_GRAVITY);
    dWorldSetERP(c->world, JOINT_ERP);
    dWorldSetCFM(c->world, 0);
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        make_body(c, i);
    himc_body_state state;
    himc_pose zero = himc_pose_zero();
    himc_pose_to_state(skeleton, &zero, NULL, &state);
    himc_character_place(c, &state);
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        make_joint(c, i, &state);
    // the engine allocates its working memory in the first step: make it here, not in the audio
    // callback
    static const himc_vec3 none[HIMC_JOINTS];
    himc_character_step(c, none, none, FIRST_STEP);
    himc_character_place(c, &state);
    return c;
}

void himc_character_free(himc_character *c)
{
    if (!c)
        return;
    dWorldDestroy(c->world);
    dCloseODE();
    free(c);
}

// velocity of each joint: the sum of w x r from the pelvis outwards
static void origin_velocities(const himc_skeleton *skeleton, const himc_body_state *s,
                              himc_vec3 v[HIMC_SEGMENTS])
{
    v[0] = himc_vec3_make(0, 0, 0);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        int p = skeleton->segment[i].parent;
        himc_vec3 r = himc_vec3_sub(s->origin[i], s->origin[p]);
        v[i] = himc_vec3_add(v[p], himc_vec3_cross(s->spin[p], r));
    }
}

void himc_character_place(himc_character *c, const himc_body_state *state)
{
    himc_body_state s = *state;
    himc_vec3 v[HIMC_SEGMENTS];
    himc_body_state_complete(&c->skeleton, &s);
    origin_velocities(&c->skeleton, &s, v);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_vec3 center = himc_mat3_apply(&s.rotation[i], c->skeleton.segment[i].center);
        himc_vec3 x = himc_vec3_add(s.origin[i], center);
        himc_vec3 u = himc_vec3_add(v[i], himc_vec3_cross(s.spin[i], center));
        const dQuaternion q = {s.orientation[i].w, s.orientation[i].x, s.orientation[i].y,
                               s.orientation[i].z};
        dBodySetPosition(c->body[i], x.x, x.y, x.z);
        dBodySetQuaternion(c->body[i], q);
        dBodySetLinearVel(c->body[i], u.x, u.y, u.z);
        dBodySetAngularVel(c->body[i], s.spin[i].x, s.spin[i].y, s.spin[i].z);
        dBodySetForce(c->body[i], 0, 0, 0);
        dBodySetTorque(c->body[i], 0, 0, 0);
    }
}

static himc_vec3 from_ode(const dReal *v)
{
    return himc_vec3_make(v[0], v[1], v[2]);
}

// the tips from ODE's stick bodies; along the joints their drift would add up
static void observe_tips(const himc_character *c, himc_body_state *s)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int i = himc_stick_segment((himc_hand)hand);
        himc_vec3 center = c->skeleton.segment[i].center;
        himc_vec3 r = himc_mat3_apply(&s->rotation[i], himc_vec3_sub(c->skeleton.tip, center));
        s->tip[hand] = himc_vec3_add(from_ode(dBodyGetPosition(c->body[i])), r);
        s->tip_velocity[hand] =
            himc_vec3_add(from_ode(dBodyGetLinearVel(c->body[i])), himc_vec3_cross(s->spin[i], r));
    }
}

void himc_character_observe(const himc_character *c, himc_body_state *s)
{
    s->orientation[0] = himc_quat_identity();
    s->rotation[0] = himc_mat3_from_quat(s->orientation[0]);
    s->spin[0] = himc_vec3_make(0, 0, 0);
    s->origin[0] = c->skeleton.root;
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        const dReal *q = dBodyGetQuaternion(c->body[i]), *r = dBodyGetRotation(c->body[i]);
        s->orientation[i] = (himc_quat){q[0], q[1], q[2], q[3]};
        s->rotation[i] = (himc_mat3){{{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, {r[8], r[9], r[10]}}};
        s->spin[i] = from_ode(dBodyGetAngularVel(c->body[i]));
        himc_vec3 center = himc_mat3_apply(&s->rotation[i], c->skeleton.segment[i].center);
        s->origin[i] = himc_vec3_sub(from_ode(dBodyGetPosition(c->body[i])), center);
    }
    observe_tips(c, s);
}

static void apply_torques(himc_character *c, const himc_vec3 torque[HIMC_JOINTS])
{
    himc_vec3 sum[HIMC_SEGMENTS] = {{0, 0, 0}};
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        int p = c->skeleton.segment[i].parent;
        sum[i] = himc_vec3_add(sum[i], torque[i - 1]);
        sum[p] = himc_vec3_sub(sum[p], torque[i - 1]);
    }
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        dBodyAddTorque(c->body[i], sum[i].x, sum[i].y, sum[i].z);
}

// false for any input on which the engine's own checks would abort the process
static bool can_step(const himc_character *c, const himc_vec3 torque[HIMC_JOINTS],
                     const himc_vec3 tip_force[HIMC_HANDS])
{
    double sum = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        sum += himc_vec3_dot(torque[j], torque[j]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        sum += himc_vec3_dot(tip_force[hand], tip_force[hand]);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_vec3 w = from_ode(dBodyGetAngularVel(c->body[i]));
        himc_vec3 x = from_ode(dBodyGetPosition(c->body[i]));
        himc_vec3 v = from_ode(dBodyGetLinearVel(c->body[i]));
        himc_vec3 pushed = from_ode(dBodyGetForce(c->body[i]));
        sum += himc_vec3_dot(x, x) + himc_vec3_dot(v, v) + himc_vec3_dot(pushed, pushed);
        if (!(himc_vec3_dot(w, w) < FASTEST_SPIN * FASTEST_SPIN))
            return false;
    }
    return sum < LARGEST_SUM;
}

void himc_character_push(himc_character *c, int segment, himc_vec3 force)
{
    if (segment > 0 && segment < HIMC_SEGMENTS)
        dBodyAddForce(c->body[segment], force.x, force.y, force.z);
}

bool himc_character_step(himc_character *c, const himc_vec3 torque[HIMC_JOINTS],
                         const himc_vec3 tip_force[HIMC_HANDS], double h)
{
    if (!can_step(c, torque, tip_force))
        return false;
    apply_torques(c, torque);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int i = himc_stick_segment((himc_hand)hand);
        himc_vec3 f = tip_force[hand],
                  at = himc_vec3_sub(c->skeleton.tip, c->skeleton.segment[i].center);
        if (f.x != 0 || f.y != 0 || f.z != 0)
            dBodyAddForceAtRelPos(c->body[i], f.x, f.y, f.z, at.x, at.y, at.z);
    }
    dWorldStep(c->world, h);
    return true;
}
