/// energy.h: the energy of the simulated body, the work on it added up step by step, and what
/// holds it; private.
#ifndef HIMC_BODY_ENERGY_H
#define HIMC_BODY_ENERGY_H

#include "body/tree.h"

/// Since the sums began (J).
typedef struct himc_body_work {
    double joint[HIMC_JOINTS];          ///< of each joint's torque
    double contact[HIMC_HANDS];         ///< of the forces on the tips, from their world_contact
    double push;                        ///< of the other contacts with the world, from theirs
    double support;                     ///< of seat and floor
    double placed;                      ///< energy given by putting the body elsewhere
    double numerical;                   ///< given by the integrator
    himc_vec3 root_impulse;             ///< of the world on the pelvis (N s) ...
    himc_vec3 root_angular;             ///< ... about the midpoint of the hip joints (N m s)
    himc_vec3 seat_impulse;             ///< of the stool on a body that sits (N s) ...
    himc_vec3 foot_impulse[HIMC_HANDS]; ///< ... and of the floor on its left and right foot
    double root_seconds;                ///< in so long; whoever reads these five sets them to 0
} himc_body_work;

/// The forces of one step, by their sources.
typedef struct himc_step_forces {
    const himc_vec3 *torque;      ///< of each joint on its child (world frame, N m) (HIMC_JOINTS)
    const world_contact *contact; ///< (contacts)
    int contacts;
} himc_step_forces;

/// Adds the work of a step of `h` seconds that led from `before`, of which spins, rotations and
/// velocities are read, to `after`; `art` is the articulation of `before`.
HIMC_RT void himc_body_work_add(himc_body_work *work, const himc_skeleton *skeleton,
                                const himc_articulation *art, const himc_step_forces *forces,
                                const segment_states *before, const segment_states *after,
                                double h);

/// Kinetic energy of all segments (J).
HIMC_RT double himc_segments_kinetic(const himc_skeleton *skeleton, const segment_states *s);
/// Potential energy of all segments (J), 0 with all centres of mass on the floor.
HIMC_RT double himc_segments_potential(const himc_skeleton *skeleton, const segment_states *s);

#endif
