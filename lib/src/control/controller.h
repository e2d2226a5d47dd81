/// controller.h: the control of a physical body: tracking errors of the joints by mode (`himc`,
/// `id`), torques by law; HIMC is the cascade of the two inside every physics step (2012 paper,
/// section 3.2, algorithm 2).
#ifndef HIMC_CONTROLLER_H
#define HIMC_CONTROLLER_H

#include "himc/body.h"
#include "himc/command_rows.h"
#include "body/posture.h"

/// In the order of the words of `mode`.
typedef enum himc_pipeline {
    HIMC_PIPELINE_HIMC, ///< tips -> inverse kinematics -> inverse dynamics (2012, pipeline 2)
    HIMC_PIPELINE_ID,   ///< joint targets -> inverse dynamics (pipeline 3)
    HIMC_PIPELINE_IK    ///< inverse kinematics alone, no dynamics (pipeline 1)
} himc_pipeline;

/// In the order of HIMC_LAWS, which says what each does.
#define HIMC_LAW_ID(ID, name, word, accelerates) HIMC_LAW_##ID,
typedef enum himc_law { HIMC_LAWS(HIMC_LAW_ID) HIMC_LAW_COUNT } himc_law;

/// Stiffness and damping of a joint's servo about the child's axes x, y, z.
typedef struct himc_gain {
    himc_vec3 stiffness; ///< (N m/rad)
    himc_vec3 damping;   ///< (N m s/rad)
} himc_gain;

/// For each joint, how often and how far limits and strength acted since the last clearing.
typedef struct himc_saturation_counts {
    double measure[HIMC_JOINTS];  ///< himc_limit_measure at the last step
    bool held[HIMC_JOINTS];       ///< was at its bounds, and not well within since
    long hits[HIMC_JOINTS];       ///< number of times a joint reached its bounds
    double farthest[HIMC_JOINTS]; ///< largest angle beyond (rad)
    double torque[HIMC_JOINTS];   ///< largest asked for (N m)
    double given[HIMC_JOINTS];    ///< largest given, with the reserve (N m)
    long weak[HIMC_JOINTS];       ///< steps with a torque above the strength
    long steps;
} himc_saturation_counts;

/// The user's settings of control. Plain: change a copy and himc_controller_configure.
typedef struct himc_controller_config {
    himc_pipeline mode;
    himc_law law;
    himc_solver solver;
    double damping;                 ///< lambda of the inverse kinematics (m)
    double weight[HIMC_ARM_JOINTS]; ///< of shoulder, elbow, wrist, grip in the inverse kinematics
    bool posture;                   ///< in the null space of the tips; false: none, as published
    bool elbow;                     ///< the elbow's place has priority over the rest of the posture
    double bandwidth;               ///< of computed torque, critically damped (Hz)
    bool gain_set[HIMC_JOINTS];     ///< the joint has the gain below; computed torque uses it, too
    himc_gain gain[HIMC_JOINTS];
    bool human_strength;          ///< himc_controller_set_human_strength has set `strength`
    double strength[HIMC_JOINTS]; ///< largest torque of each joint (N m); 0: no maximum
} himc_controller_config;

/// What sleeping legs (character.h) were asked for in a step of this length, under these targets.
typedef struct himc_leg_torques {
    double step;                   ///< (s); 0: not known
    himc_posture_motion targets;   ///< of the legs
    himc_vec3 torque[HIMC_JOINTS]; ///< of the legs, before their strength (N m)
} himc_leg_torques;

/// Sleeping legs with the same targets are asked for the same, so it is not computed again.
typedef struct himc_sleeping_legs {
    himc_leg_torques known[2];     ///< steps have two lengths, in whole samples
    const himc_leg_torques *asked; ///< those of the present step; NULL: it computes all joints
} himc_sleeping_legs;

/// A configuration in force for one body; made by himc_controller_init.
typedef struct himc_controller {
    himc_controller_config config;
    double step; ///< of the physics (s), over which servos are implicit; 0: explicit
    himc_vec3 inertia[HIMC_JOINTS];     ///< of all segments moved by each joint, about the child's
                                        ///< axes (kg m^2)
    himc_gain gain[HIMC_JOINTS];        ///< in force: the user's, else the default
    const himc_limits *limits;          ///< borrowed; NULL (default) for none
    himc_saturation_counts *saturation; ///< borrowed, counted up at each step; may be NULL
    const himc_articulation *articulation; ///< borrowed, of this body in the state of the next
                                           ///< call; may be NULL
    himc_sleeping_legs *legs;     ///< borrowed; NULL (default): each step computes all joints
    struct himc_muscles *muscles; ///< borrowed, act with human strength; may be NULL (default)
    struct himc_balance *balance; ///< borrowed, of a pelvis that is free, else NULL (default)
} himc_controller;

/// The present targets of the body.
typedef struct himc_reference {
    himc_target tip[HIMC_HANDS];
    himc_posture_motion posture;  ///< joint targets of `id`; in `himc` the null-space target
    bool released[HIMC_HANDS];    ///< the tip is in contact: along the normal it has `yield`
    double yield[HIMC_HANDS];     ///< its acceleration there but for the contact's force (m/s^2)
    himc_vec3 normal[HIMC_HANDS]; ///< of the head it touches
    bool struck[HIMC_HANDS];      ///< it touches in a stroke
} himc_reference;

/// himc, computed torque at 20 Hz, damped least squares with 0.01 m, all weights 1, no gain set, no
/// maximum of strength.
HIMC_RT himc_controller_config himc_controller_config_default(void);

/// Makes a controller for a body, with the inertia in the given state; no limits, no counts.
HIMC_RT void himc_controller_init(himc_controller *controller, const himc_controller_config *config,
                                  const himc_skeleton *skeleton, const himc_body_state *posture);

/// Sets another configuration for the same body.
HIMC_RT void himc_controller_configure(himc_controller *controller,
                                       const himc_controller_config *config);

/// Default gain of a joint: stiffness I w^2 and damping 2 I w, critically damped, I the joint's
/// inertia about each axis, w three times 2 pi 8 Hz at the shoulder, 10 elbow, 14 wrist, 18 grip,
/// 5 elsewhere.
HIMC_RT himc_gain himc_controller_usual_gain(const himc_controller *controller, int joint);

/// Gain with this stiffness (N m/rad) and damping (N m s/rad) about the joint's axes of flexion;
/// about its length both shrink with the inertia.
HIMC_RT himc_gain himc_controller_gain(const himc_controller *controller, int joint,
                                       double stiffness, double damping);

/// The strength of a healthy man's joints, in proportion to the body's mass (kg): isometric maxima
/// of shoulder, elbow and wrist after Holzbaur et al. 2007 and Delp, Grierson & Buchanan 1996, of
/// the neck after Fice, Siegmund & Blouin 2014.
HIMC_RT void himc_controller_set_human_strength(himc_controller_config *config, double mass);

/// InverseKinematics and InverseDynamics of algorithm 2: the torques (world frame, N m) for this
/// state and reference.
HIMC_RT void himc_controller_torques(const himc_controller *controller,
                                     const himc_skeleton *skeleton, const himc_body_state *state,
                                     const himc_reference *reference,
                                     himc_vec3 torque[HIMC_JOINTS]);

/// Inverse kinematics without dynamics (2012, pipeline 1): from the state at the last step to the
/// pose and its rates (in the parents' frames, rad/s) `controller->step` later, for the reference
/// of that time. `state` is changed on the way and of no further use.
HIMC_RT void himc_controller_kinematic_step(const himc_controller *controller,
                                            const himc_skeleton *skeleton,
                                            const himc_reference *reference, himc_body_state *state,
                                            himc_pose *pose, himc_vec3 rate[HIMC_JOINTS]);

#endif
