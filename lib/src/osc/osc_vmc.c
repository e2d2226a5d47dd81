/// osc_vmc.c: the body as a humanoid avatar (Virtual Motion Capture protocol, protocol.vmc.info),
/// for programs that know bones by Unity's names.
///
/// World: x right, y up, z forward, left-handed: a vector (x, y, z) becomes (-y, z, x). That is a
/// reflection, so a turn's axis goes the other way: (x, y, z, w) becomes (y, -z, -x, w).
/// Rest: a humanoid's is the T, arms straight out, palms down; our zero pose has them hang. A turn
/// A of a quarter about x takes a T's arm to a hanging one, so a bone's rotation in the world is
/// R A, and in its parent's frame (R_p A_p)^-1 R A. Invariant: going along the bones from the
/// root with the positions and rotations sent gives our joints, mirrored.
#include "osc/osc_state.h"
#include "himc/body.h"

#include <math.h>

typedef struct bone {
    const char *name;
    int segment, parent; // parent among the bones, -1 for the root
    int arm;             // +1 left, -1 right, 0 none
    double along;        // of the way from its segment's joint to that of `towards`, 0 the joint
    int towards;
} bone;

enum {
    HIPS,
    SPINE,
    CHEST,
    NECK,
    HEAD,
    SHOULDER_L,
    SHOULDER_R,
    UPPER_ARM_L,
    UPPER_ARM_R,
    LOWER_ARM_L,
    LOWER_ARM_R,
    HAND_L,
    HAND_R,
    UPPER_LEG_L,
    UPPER_LEG_R,
    LOWER_LEG_L,
    LOWER_LEG_R,
    FOOT_L,
    FOOT_R,
    TOES_L,
    TOES_R,
    BONES
};

static const bone bones[BONES] = {
    {"Hips", HIMC_PELVIS, -1, 0, 0, 0},
    {"Spine", HIMC_TRUNK, HIPS, 0, 0, 0},
    {"Chest", HIMC_TRUNK, SPINE, 0, 0.4, HIMC_NECK},
    {"Neck", HIMC_NECK, CHEST, 0, 0, 0},
    {"Head", HIMC_HEAD, NECK, 0, 0, 0},
    {"LeftShoulder", HIMC_TRUNK, CHEST, 0, 0.85, HIMC_LEFT_UPPER_ARM},
    {"RightShoulder", HIMC_TRUNK, CHEST, 0, 0.85, HIMC_RIGHT_UPPER_ARM},
    {"LeftUpperArm", HIMC_LEFT_UPPER_ARM, SHOULDER_L, 1, 0, 0},
    {"RightUpperArm", HIMC_RIGHT_UPPER_ARM, SHOULDER_R, -1, 0, 0},
    {"LeftLowerArm", HIMC_LEFT_FOREARM, UPPER_ARM_L, 1, 0, 0},
    {"RightLowerArm", HIMC_RIGHT_FOREARM, UPPER_ARM_R, -1, 0, 0},
    {"LeftHand", HIMC_LEFT_HAND, LOWER_ARM_L, 1, 0, 0},
    {"RightHand", HIMC_RIGHT_HAND, LOWER_ARM_R, -1, 0, 0},
    {"LeftUpperLeg", HIMC_LEFT_UPPER_LEG, HIPS, 0, 0, 0},
    {"RightUpperLeg", HIMC_RIGHT_UPPER_LEG, HIPS, 0, 0, 0},
    {"LeftLowerLeg", HIMC_LEFT_LOWER_LEG, UPPER_LEG_L, 0, 0, 0},
    {"RightLowerLeg", HIMC_RIGHT_LOWER_LEG, UPPER_LEG_R, 0, 0, 0},
    {"LeftFoot", HIMC_LEFT_FOOT, LOWER_LEG_L, 0, 0, 0},
    {"RightFoot", HIMC_RIGHT_FOOT, LOWER_LEG_R, 0, 0, 0},
    {"LeftToes", HIMC_LEFT_TOES, FOOT_L, 0, 0, 0},
    {"RightToes", HIMC_RIGHT_TOES, FOOT_R, 0, 0, 0},
};

static himc_vec3 vector(const float x[3])
{
    return himc_vec3_make(x[0], x[1], x[2]);
}

static himc_quat rotation(const osc_pose *pose, int segment)
{
    const float *q = pose->orientation[segment];
    return (himc_quat){q[3], q[0], q[1], q[2]};
}

// where a bone begins, and how it is turned from the T, in our world
static void place_bone(const osc_pose *pose, const bone *b, himc_vec3 *x, himc_quat *q)
{
    *x = vector(pose->origin[b->segment]);
    *x = himc_vec3_madd(*x, b->along, himc_vec3_sub(vector(pose->origin[b->towards]), *x));
    himc_quat from_t = himc_quat_exp(himc_vec3_make(-b->arm * HIMC_PI / 2, 0, 0));
    *q = himc_quat_mul(rotation(pose, b->segment), from_t);
}

static void pack_place(osc_packets *p, const char *path, const char *name, himc_vec3 x, himc_quat q)
{
    himc_osc_pack(p, path, "sfffffff", name, -x.y, x.z, x.x, q.y, -q.z, -q.x, q.w);
}

void himc_osc_vmc_pose(osc_packets *p, const osc_record *r)
{
    static const char *const mallet[] = {"left-mallet", "right-mallet"};
    himc_vec3 x[BONES];
    himc_quat q[BONES];
    himc_osc_pack(p, "/VMC/Ext/OK", "iiii", 1, 3, 0, 1);
    himc_osc_pack(p, "/VMC/Ext/T", "f", r->time);
    pack_place(p, "/VMC/Ext/Root/Pos", "root", (himc_vec3){0, 0, 0}, himc_quat_identity());
    for (int i = 0; i < BONES; i++) {
        const bone *b = &bones[i];
        place_bone(&r->pose, b, &x[i], &q[i]);
        himc_vec3 local = x[i];
        himc_quat turn = q[i];
        if (b->parent >= 0) {
            himc_quat back = himc_quat_conj(q[b->parent]);
            local = himc_quat_rotate(back, himc_vec3_sub(x[i], x[b->parent]));
            turn = himc_quat_mul(back, q[i]);
        }
        pack_place(p, "/VMC/Ext/Bone/Pos", b->name, local, turn);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        pack_place(p, "/VMC/Ext/Tra/Pos", mallet[hand], vector(r->pose.tip[hand]),
                   rotation(&r->pose, himc_stick_segment((himc_hand)hand)));
}

void himc_osc_vmc_strike(osc_packets *p, const himc_strike *strike, double hz)
{
    double key = round(69 + 12 * log2(hz / 440)), loudness = strike->force / 200;
    int note = key < 0 ? 0 : key > 127 ? 127 : (int)key;
    loudness = loudness > 1 ? 1 : loudness;
    himc_osc_pack(p, "/VMC/Ext/Midi/Note", "iiif", 1, (int)strike->hand, note, loudness);
    himc_osc_pack(p, "/VMC/Ext/Midi/Note", "iiif", 0, (int)strike->hand, note, 0.0);
}
