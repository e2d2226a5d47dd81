/// engine_ode.c: ODE's dWorldStep with 19 bodies and 19 ball joints, one loop over the table.
///
/// The frame of an ODE body is its segment's, moved to the centre of mass, as ODE requires. A fixed
/// pelvis is ODE's world (body 0), so the trunk and each leg are separate islands and ODE solves
/// three small systems; one that is free is one body more. dWorldStep is deterministic to the bit
/// (QuickStep draws random numbers).
#include "body/engine_ode.h"

#include <stdlib.h>

#ifdef HIMC_NO_ODE

bool himc_ode_is_here(void)
{
    return false;
}

himc_ode *himc_ode_new(const himc_skeleton *skeleton, const segment_states *zero, himc_error *error)
{
    (void)skeleton, (void)zero, (void)error;
    return NULL;
}

void himc_ode_free(himc_ode *ode)
{
    (void)ode;
}

void himc_ode_give(himc_ode *ode, const segment_states *state)
{
    (void)ode, (void)state;
}

void himc_ode_seat(himc_ode *ode, const segment_states *state)
{
    (void)ode, (void)state;
}

void himc_ode_step(himc_ode *ode, const segment_forces *forces, double h, segment_states *state)
{
    (void)ode, (void)forces, (void)h, (void)state;
}

#else
#include <ode/ode.h>

#define FIRST_STEP 1e-4 // chosen: any valid step makes the engine allocate (s)

struct himc_ode {
    himc_skeleton skeleton;
    dWorldID world;
    int first;                   // segments that move: from the pelvis, 0, if it is free, else 1
    dBodyID body[HIMC_SEGMENTS]; // of a fixed pelvis NULL: the world
};

bool himc_ode_is_here(void)
{
    return true;
}

static himc_vec3 from_ode(const dReal *v)
{
    return himc_vec3_make(v[0], v[1], v[2]);
}

void himc_ode_give(himc_ode *o, const segment_states *state)
{
    const himc_body_state *s = &state->joints;
    for (int i = o->first; i < HIMC_SEGMENTS; i++) {
        himc_vec3 x = state->position[i], v = state->velocity[i], w = s->spin[i];
        himc_quat q = s->orientation[i];
        dBodySetPosition(o->body[i], x.x, x.y, x.z);
        dBodySetQuaternion(o->body[i], (const dQuaternion){q.w, q.x, q.y, q.z});
        dBodySetLinearVel(o->body[i], v.x, v.y, v.z);
        dBodySetAngularVel(o->body[i], w.x, w.y, w.z);
    }
}

himc_ode *himc_ode_new(const himc_skeleton *skeleton, const segment_states *zero, himc_error *error)
{
    himc_ode *o = calloc(1, sizeof *o);
    if (!o || !dInitODE2(0) || !dAllocateODEDataForThread(dAllocateMaskAll)) {
        free(o);
        himc_error_set(error, "character: out of memory for the physics engine");
        return NULL;
    }
    o->skeleton = *skeleton;
    o->first = himc_first_moving(skeleton);
    o->world = dWorldCreate();
    dWorldSetGravity(o->world, 0, 0, -HIMC_GRAVITY);
    dWorldSetERP(o->world, HIMC_JOINT_ERP);
    dWorldSetCFM(o->world, 0);
    for (int i = o->first; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 inertia = segment->inertia;
        dMass mass;
        o->body[i] = dBodyCreate(o->world);
        dMassSetParameters(&mass, segment->mass, 0, 0, 0, inertia.x, inertia.y, inertia.z, 0, 0, 0);
        dBodySetMass(o->body[i], &mass);
        dBodySetAutoDisableFlag(o->body[i], 0);
        dBodySetGyroscopicMode(o->body[i], 1);
    }
    himc_ode_give(o, zero);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_vec3 at = zero->joints.origin[i];
        dJointID joint = dJointCreateBall(o->world, 0);
        dJointAttach(joint, o->body[i], o->body[skeleton->segment[i].parent]);
        dJointSetBallAnchor(joint, at.x, at.y, at.z);
    }
    // the engine allocates its working memory in the first step: make it here, not in the audio
    // callback
    dWorldStep(o->world, FIRST_STEP);
    return o;
}

void himc_ode_free(himc_ode *o)
{
    if (!o)
        return;
    dWorldDestroy(o->world);
    dCloseODE();
    free(o);
}

void himc_ode_seat(himc_ode *o, const segment_states *state)
{
    himc_ode_give(o, state);
    // the joints of the pelvis are anchored in ODE's world
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_vec3 at = state->joints.origin[i];
        for (int k = 0; k < dBodyGetNumJoints(o->body[i]); k++)
            if (!dJointGetBody(dBodyGetJoint(o->body[i], k), 1))
                dJointSetBallAnchor(dBodyGetJoint(o->body[i], k), at.x, at.y, at.z);
    }
}

void himc_ode_step(himc_ode *o, const segment_forces *f, double h, segment_states *state)
{
    himc_body_state *s = &state->joints;
    for (int i = o->first; i < HIMC_SEGMENTS; i++) {
        dBodySetForce(o->body[i], f->force[i].x, f->force[i].y, f->force[i].z);
        dBodySetTorque(o->body[i], f->torque[i].x, f->torque[i].y, f->torque[i].z);
    }
    dWorldStep(o->world, h);
    for (int i = o->first; i < HIMC_SEGMENTS; i++) {
        const dReal *q = dBodyGetQuaternion(o->body[i]), *r = dBodyGetRotation(o->body[i]);
        s->orientation[i] = (himc_quat){q[0], q[1], q[2], q[3]};
        s->rotation[i] = (himc_mat3){{{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, {r[8], r[9], r[10]}}};
        s->spin[i] = from_ode(dBodyGetAngularVel(o->body[i]));
        state->position[i] = from_ode(dBodyGetPosition(o->body[i]));
        state->velocity[i] = from_ode(dBodyGetLinearVel(o->body[i]));
        himc_vec3 center = himc_mat3_apply(&s->rotation[i], o->skeleton.segment[i].center);
        s->origin[i] = himc_vec3_sub(state->position[i], center);
    }
}
#endif
