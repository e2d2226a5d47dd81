/// tree.h: one step of rigid segments on ball joints, as the Open Dynamics Engine's dWorldStep
/// makes it, solved along the tree; private.
#ifndef HIMC_TREE_H
#define HIMC_TREE_H

#include "body/dynamics.h"

/// Segments in the world, each a body of its own: joints may have gaps of rounding's size.
typedef struct segment_states {
    himc_body_state joints;            ///< all but the tips, which are not kept
    himc_vec3 position[HIMC_SEGMENTS]; ///< centres of mass (m)
    himc_vec3 velocity[HIMC_SEGMENTS]; ///< of the centres of mass (m/s)
} segment_states;

/// Forces on the segments in one step, without weight (world frame).
typedef struct segment_forces {
    himc_vec3 force[HIMC_SEGMENTS];  ///< on the centre of mass (N)
    himc_vec3 torque[HIMC_SEGMENTS]; ///< about the centre of mass (N m)
} segment_forces;

/// A contact with the world in one step: a force on a segment.
typedef struct world_contact {
    int segment;     ///< 0 .. HIMC_SEGMENTS - 1; 0 of a pelvis that is free
    himc_vec3 at;    ///< where it acts, in the segment's frame (m)
    himc_vec3 force; ///< in the world frame (N)
    double *work;    ///< takes its work if the body's is added up (J); NULL: none does
    bool supports;   ///< the body: seat or floor
} world_contact;

/// Moment of the implicit gyroscopic term of a segment (world frame, N m): of its inertia in the
/// world and about its own axes, and its spin, in a step of `h` seconds.
HIMC_RT himc_vec3 himc_gyroscopic_moment(const himc_symmetric *inertia, himc_vec3 own,
                                         himc_vec3 spin, double h);

/// One step of `h` seconds of the segments of the articulation, which belongs to this state. `erp`
/// is the share of a joint's gap that a step closes.
HIMC_RT void himc_tree_step(const himc_skeleton *skeleton, const himc_articulation *articulation,
                            const segment_forces *forces, double erp, double h,
                            segment_states *states);

#endif
