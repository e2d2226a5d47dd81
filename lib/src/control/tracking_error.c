/// tracking_error.c: missing angles and rates of the joints. For `id` to the joint targets. For the
/// tips of `himc` (and of `ik`, kinematic_step.c) those of an arm come from its tip alone,
///     dq = J+ (X_t - X),  q'_t = J+ X'_t,  q''_t = J+ (X''_t - J' q') (equation 3, differentiated)
/// plus those of the posture, in the null space of J.
#include "control/tracking_error.h"

#include "body/stretch.h"
#include "control/balance.h"
#include "control/solvers.h"

// chosen: the Jacobian is true within a fraction of the arm's length
#define LARGEST_TIP_STEP 0.20 // of the tip, one step of inverse kinematics (m)
#define JOINTS_BEGIN 0.20     // a tip this far from its target begins to follow the joints ...
#define JOINTS_ALONE 0.40     // ... and this far follows them alone (m)

static himc_vec3 mix(himc_vec3 a, himc_vec3 b, double share)
{
    return himc_vec3_madd(a, share, himc_vec3_sub(b, a));
}

// errors to the joint targets, from the parent's frame into the world
void himc_tracking_error_joints(const himc_skeleton *skeleton, const himc_body_state *s,
                                const himc_posture_motion *target, int joints, tracking_error *e)
{
    for (int j = 0; j < joints; j++) {
        int p = skeleton->segment[j + 1].parent;
        himc_quat q = himc_quat_mul(himc_quat_conj(s->orientation[p]), s->orientation[j + 1]);
        himc_vec3 missing = himc_quat_log(himc_quat_mul(target->joint[j], himc_quat_conj(q)));
        himc_vec3 wanted = himc_mat3_apply(&s->rotation[p], target->rate[j]);
        e->angle[j] = himc_mat3_apply(&s->rotation[p], missing);
        e->rate[j] = himc_vec3_sub(wanted, himc_relative_spin(skeleton, s, j));
        e->acceleration[j] =
            himc_vec3_add(himc_mat3_apply(&s->rotation[p], target->acceleration[j]),
                          himc_vec3_cross(s->spin[p], wanted));
    }
}

typedef struct arm_tasks {
    const himc_controller *controller;
    const himc_arm_jacobian *jacobian;
    himc_mat3 inverse; // of J W J', by the solver
    himc_elbow_task elbow;
    himc_hand hand;
} arm_tasks;

// The demand of the tip through the Jacobian, then the elbow's place and the posture in its null
// space; the solution is linear in all of them. What the posture moves the tip by is taken back
// with the demand: W J' (inverse demand - (J W J')^-1 J posture) + posture.
static void solve_demand(const arm_tasks *tasks, himc_vec3 demand, himc_vec3 *all)
{
    const himc_controller_config *c = &tasks->controller->config;
    himc_mat3 inverse = tasks->inverse;
    himc_vec3 posture[HIMC_ARM_JOINTS], solution[HIMC_ARM_JOINTS];
    himc_arm_gather(all, tasks->hand, posture);
    for (int k = 0; !c->posture && k < HIMC_ARM_JOINTS; k++)
        posture[k] = himc_vec3_make(0, 0, 0);
    if (himc_solvers[c->solver].own_step)
        inverse = himc_solvers[c->solver].inverse(tasks->jacobian, c->damping, demand);
    himc_vec3 moved = himc_ik_forward(tasks->jacobian, posture);
    himc_vec3 f = himc_vec3_sub(himc_mat3_apply(&inverse, demand),
                                himc_mat3_apply(&tasks->jacobian->inverse, moved));
    himc_ik_apply_transposed(tasks->jacobian, f, solution);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        solution[k] = himc_vec3_add(solution[k], posture[k]);
    if (c->elbow)
        himc_ik_add_elbow(tasks->jacobian, &tasks->elbow,
                          himc_vec3_cross(posture[0], tasks->elbow.lever), solution);
    himc_arm_scatter(solution, tasks->hand, all);
}

// equation 3
void himc_tracking_error_tip(const himc_controller *c, const himc_skeleton *skeleton,
                             const himc_body_state *s, const himc_target *asked, himc_hand hand,
                             const himc_arm_jacobian *jacobian, tracking_error *e)
{
    const himc_controller_config *config = &c->config;
    himc_vec3 shoulder = s->origin[himc_arm_joint(hand, 0) + 1];
    himc_target target = himc_stretch_towards(asked, shoulder, himc_stretch(skeleton, hand));
    himc_vec3 way = himc_vec3_sub(target.x, s->tip[hand]);
    double away = himc_vec3_length(way);
    tracking_error joints;
    if (away > JOINTS_BEGIN)
        joints = *e;
    himc_vec3 missing = way;
    if (away > LARGEST_TIP_STEP)
        missing = himc_vec3_scale(way, LARGEST_TIP_STEP / away);
    himc_vec3 slower = himc_vec3_sub(target.v, s->tip_velocity[hand]);
    himc_vec3 a = himc_vec3_sub(target.a, himc_tip_carried(skeleton, s, hand, e->acceleration,
                                                           himc_pelvis_acceleration(c)));
    arm_tasks tasks = {.controller = c, .jacobian = jacobian, .hand = hand};
    tasks.inverse = himc_solvers[config->solver].inverse(jacobian, config->damping, missing);
    if (config->elbow)
        himc_elbow_task_init(&tasks.elbow, jacobian,
                             himc_vec3_sub(s->origin[himc_arm_joint(hand, 1) + 1], shoulder),
                             config->damping);
    solve_demand(&tasks, missing, e->angle);
    solve_demand(&tasks, slower, e->rate);
    solve_demand(&tasks, a, e->acceleration);
    // The Jacobian is true near the target only: an arm pushed far away would follow it in circles.
    // So the arm returns by its joint targets; their posture has the tip at the target.
    double share = fmin((away - JOINTS_BEGIN) / (JOINTS_ALONE - JOINTS_BEGIN), 1);
    for (int k = 0; k < HIMC_ARM_JOINTS && away > JOINTS_BEGIN; k++) {
        int j = himc_arm_joint(hand, k);
        e->angle[j] = mix(e->angle[j], joints.angle[j], share);
        e->rate[j] = mix(e->rate[j], joints.rate[j], share);
        e->acceleration[j] = mix(e->acceleration[j], joints.acceleration[j], share);
    }
}
