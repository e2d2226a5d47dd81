/// skeleton.h: the performer's body as a constant table: 20 rigid segments in a tree of 19 ball
/// joints (57 degrees of freedom), with masses, centres and inertias; sticks are segments like
/// any other (2012 paper, section 3.1).
///
/// Each segment's frame has its origin in the joint to its parent. In the zero pose the body
/// stands, arms and sticks hanging, and all frames are parallel to the world's: x forward, y
/// left, z up. Joint j joins segment j + 1 to its parent.
#ifndef HIMC_SKELETON_H
#define HIMC_SKELETON_H

#include "himc/vec.h"

typedef enum himc_segment_id {
    HIMC_PELVIS,
    HIMC_TRUNK,
    HIMC_NECK,
    HIMC_HEAD,
    HIMC_LEFT_UPPER_ARM, // the arms: left is even, right is the next
    HIMC_RIGHT_UPPER_ARM,
    HIMC_LEFT_FOREARM,
    HIMC_RIGHT_FOREARM,
    HIMC_LEFT_HAND,
    HIMC_RIGHT_HAND,
    HIMC_LEFT_STICK,
    HIMC_RIGHT_STICK,
    HIMC_LEFT_UPPER_LEG,
    HIMC_RIGHT_UPPER_LEG,
    HIMC_LEFT_LOWER_LEG,
    HIMC_RIGHT_LOWER_LEG,
    HIMC_LEFT_FOOT,
    HIMC_RIGHT_FOOT,
    HIMC_LEFT_TOES,
    HIMC_RIGHT_TOES,
    HIMC_SEGMENTS
} himc_segment_id;

#define HIMC_JOINTS (HIMC_SEGMENTS - 1)
#define HIMC_DOF (3 * HIMC_JOINTS)

/// The joints of an arm, from the body outwards: shoulder, elbow, wrist, grip.
#define HIMC_ARM_JOINTS 4

typedef enum himc_anthropometry {
    HIMC_DE_LEVA, ///< de Leva 1996, from height and mass
    HIMC_TABLE_1  ///< 2012 paper, table 1: each row once per body, scaled to sum to one
} himc_anthropometry;

typedef struct himc_skeleton_config {
    double height; ///< 1.19 .. 2.21 (m), default 1.75
    double mass;   ///< 30 .. 200 (kg), default 75, sticks not counted
    himc_anthropometry anthropometry;
    double stick_length;  ///< 0.2 .. 0.6 (m), default 0.36
    double shaft_mass;    ///< 0.005 .. 0.2 (kg), default 0.025
    double mallet_mass;   ///< 0.005 .. 0.2 (kg), default 0.020
    double mallet_radius; ///< 0.005 .. 0.05 (m), default 0.0175
    double grip;          ///< from the butt to where it is held (m), default 0.10
    double seat;          ///< height of the hip joints, on a stool (m); 0 takes 0.42 of the height
    double shoulders; ///< between the shoulder joints, 0.2 .. 0.6 (m); 0 takes it from the height
    double length[HIMC_SEGMENTS]; ///< measured lengths (m); 0 takes them from the height
} himc_skeleton_config;

himc_skeleton_config himc_skeleton_default(void);

/// Height of the hip joints above the floor (m).
double himc_skeleton_seat(const himc_skeleton_config *config);

typedef struct himc_segment {
    int parent;        ///< -1 for the pelvis
    double mass;       ///< (kg)
    double length;     ///< (m)
    double radius;     ///< of its capsule (m)
    himc_vec3 origin;  ///< its joint, in the parent's frame (m)
    himc_vec3 axis;    ///< unit vector from the joint towards the far end
    himc_vec3 center;  ///< of mass (m)
    himc_vec3 inertia; ///< about the centre of mass, about x, y, z (kg m^2)
} himc_segment;

typedef struct himc_skeleton {
    himc_segment segment[HIMC_SEGMENTS];
    himc_vec3 root;       ///< between the hip joints: where the held pelvis sits in the world (m)
    himc_vec3 tip;        ///< of the stick (centre of the mallet) in the stick's frame (m)
    double mallet_radius; ///< (m)
    double height, mass;  ///< (m, kg)
} himc_skeleton;

/// Builds the table; false if a field is out of its range.
bool himc_skeleton_init(himc_skeleton *skeleton, const himc_skeleton_config *config,
                        himc_error *error);

/// "pelvis", "trunk", ..., "left-stick".
const char *himc_segment_name(int segment);
/// "waist", "neck", "head", "left-shoulder", ..., "right-grip", ..., "right-toes".
const char *himc_joint_name(int joint);
/// Index of a joint by name, or -1.
int himc_joint_find(const char *name);

/// Joint `k` (0 shoulder .. 3 grip) of an arm.
static inline int himc_arm_joint(himc_hand hand, int k)
{
    return HIMC_LEFT_UPPER_ARM - 1 + 2 * k + (int)hand;
}

/// The stick segment of a hand.
static inline int himc_stick_segment(himc_hand hand)
{
    return HIMC_LEFT_STICK + (int)hand;
}

#endif
