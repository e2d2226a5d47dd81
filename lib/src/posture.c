/// posture.c: an arm has twelve freedoms and its tip takes three; this is where a player puts the
/// other nine.
///
/// Built from the far end inwards: the stick lies level at impact and rises with the tip, the
/// hand follows less, both in the vertical plane from the elbow's place through the tip; the
/// wrist is then known, and shoulder, elbow and wrist make a triangle that hangs below its long
/// side, turned outwards a little. Axes are set as in the zero pose: each segment's z points back
/// to its joint, its y is the axis of flexion. The slopes are choices that give the raised stick
/// and wrist seen in players; everything is a smooth function of the tip, so rates come from
/// differences of the map.
#include "himc/posture.h"

#define STICK_RISE 2.6     // stick's elevation per metre of the tip's height (rad/m)
#define STICK_MOST 1.25    // it never stands steeper (rad)
#define HAND_RISE 1.3      // the hand's
#define HAND_MOST 0.6      // (rad)
#define HAND_LEVEL (-0.25) // the hand's elevation at impact: fingers a little down (rad)
#define ELBOW_OUT 0.35     // turn of the elbow out of the vertical plane (rad)
#define ELBOW_BEHIND 0.08  // where the stick's plane begins: behind the shoulder (m) ...
#define ELBOW_BESIDE 0.05  // ... and outside it (m)
#define REACH 0.985        // of the straight arm
#define DIFFERENCE 1e-3    // step of the differences (s)
#define TRUNK_LEAN 0.09    // (rad)
#define LOOK_DOWN 0.22     // of neck and head together (rad)
#define ANKLE_HEIGHT 0.075 // (m)
#define KNEES_APART 0.45   // each, from straight ahead (rad)

// thighs down to where the lower legs stand upright on the floor, knees apart; standing straight
// if the seat is high
static void seat_legs(himc_pose *rest, const himc_skeleton *skeleton)
{
    double thigh = skeleton->segment[HIMC_LEFT_UPPER_LEG].length;
    double drop = skeleton->root.z - skeleton->segment[HIMC_LEFT_LOWER_LEG].length - ANKLE_HEIGHT;
    double raise = acos(fmin(fmax(drop / thigh, -0.2), 1));
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_quat apart =
            himc_quat_exp(himc_vec3_make(0, 0, (hand == HIMC_LEFT ? KNEES_APART : -KNEES_APART)));
        rest->joint[HIMC_LEFT_UPPER_LEG - 1 + hand] =
            himc_quat_mul(apart, himc_quat_exp(himc_vec3_make(0, -raise, 0)));
        rest->joint[HIMC_LEFT_LOWER_LEG - 1 + hand] = himc_quat_exp(himc_vec3_make(0, raise, 0));
    }
}

void himc_posture_init(himc_posture *posture, const himc_skeleton *skeleton, double level)
{
    himc_body_state state;
    posture->skeleton = *skeleton;
    posture->rest = himc_pose_zero();
    posture->rest.joint[HIMC_TRUNK - 1] = himc_quat_exp(himc_vec3_make(0, TRUNK_LEAN, 0));
    posture->rest.joint[HIMC_NECK - 1] = himc_quat_exp(himc_vec3_make(0, 0.5 * LOOK_DOWN, 0));
    posture->rest.joint[HIMC_HEAD - 1] = himc_quat_exp(himc_vec3_make(0, 0.5 * LOOK_DOWN, 0));
    posture->level = level;
    seat_legs(&posture->rest, skeleton);
    himc_pose_to_state(skeleton, &posture->rest, NULL, &state);
    posture->trunk = state.orientation[HIMC_TRUNK];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        posture->shoulder[hand] = state.origin[HIMC_LEFT_UPPER_ARM + hand];
}

// the frame with z against `along` and y as near to `flexion` as may be
static himc_quat frame_along(himc_vec3 along, himc_vec3 flexion)
{
    himc_vec3 z = himc_vec3_scale(along, -1);
    himc_vec3 y = himc_vec3_unit(himc_vec3_madd(flexion, -himc_vec3_dot(flexion, z), z));
    return himc_quat_from_mat3(himc_mat3_from_axes(himc_vec3_cross(y, z), y, z));
}

static himc_vec3 elevated(double azimuth, double elevation)
{
    return himc_vec3_make(cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth),
                          sin(elevation));
}

// a slope that flattens towards +-most
static double rise(double height, double slope, double most)
{
    return most * tanh(slope * height / most);
}

typedef struct arm {
    himc_vec3 shoulder, elbow, wrist, grip, tip;
    himc_vec3 stick, hand, side; // directions; side is the flexion axis of wrist and grip
} arm;

// from the tip to the wrist
static void place_hand(const himc_posture *posture, himc_hand hand, himc_vec3 tip, arm *a)
{
    double outside = hand == HIMC_LEFT ? ELBOW_BESIDE : -ELBOW_BESIDE;
    double dx = tip.x - (posture->shoulder[hand].x - ELBOW_BEHIND);
    double dy = tip.y - (posture->shoulder[hand].y + outside);
    double azimuth = atan2(dy, dx), height = tip.z - posture->level;
    a->tip = tip;
    a->stick = elevated(azimuth, rise(height, STICK_RISE, STICK_MOST));
    a->hand = elevated(azimuth, HAND_LEVEL + rise(height, HAND_RISE, HAND_MOST));
    a->side = himc_vec3_make(-sin(azimuth), cos(azimuth), 0);
    a->grip = himc_vec3_madd(tip, -himc_vec3_length(posture->skeleton.tip), a->stick);
    double palm = himc_vec3_length(posture->skeleton.segment[HIMC_LEFT_STICK + hand].origin);
    a->wrist = himc_vec3_madd(a->grip, -palm, a->hand);
}

// the triangle shoulder - elbow - wrist; moves the wrist into reach and returns by how much
static double place_elbow(const himc_posture *posture, himc_hand hand, arm *a)
{
    double upper = himc_vec3_length(posture->skeleton.segment[HIMC_LEFT_FOREARM + hand].origin);
    double lower = himc_vec3_length(posture->skeleton.segment[HIMC_LEFT_HAND + hand].origin);
    himc_vec3 d = himc_vec3_sub(a->wrist, a->shoulder);
    double distance = himc_vec3_length(d), longest = REACH * (upper + lower);
    double shortest = fabs(upper - lower) + 0.05, used = fmin(fmax(distance, shortest), longest);
    himc_vec3 u = distance > 0 ? himc_vec3_scale(d, 1 / distance) : himc_vec3_make(1, 0, 0);
    double along = (used * used + upper * upper - lower * lower) / (2 * used);
    double away = sqrt(fmax(upper * upper - along * along, 0));
    himc_vec3 down = {0, 0, -1};
    down = himc_vec3_unit(himc_vec3_madd(down, -himc_vec3_dot(down, u), u));
    himc_vec3 out = himc_vec3_cross(down, u);
    double turn = hand == HIMC_LEFT ? -ELBOW_OUT : ELBOW_OUT;
    himc_vec3 hang = himc_vec3_madd(himc_vec3_scale(down, cos(turn)), sin(turn), out);
    a->elbow = himc_vec3_madd(himc_vec3_madd(a->shoulder, along, u), away, hang);
    a->wrist = himc_vec3_madd(a->shoulder, used, u);
    return fabs(used - distance);
}

static double arm_joints(const himc_posture *posture, himc_hand hand, himc_vec3 tip,
                         himc_pose *pose)
{
    arm a = {.shoulder = posture->shoulder[hand]};
    place_hand(posture, hand, tip, &a);
    double missing = place_elbow(posture, hand, &a);
    himc_vec3 upper = himc_vec3_unit(himc_vec3_sub(a.elbow, a.shoulder));
    himc_vec3 lower = himc_vec3_unit(himc_vec3_sub(a.wrist, a.elbow));
    himc_quat frame[HIMC_ARM_JOINTS + 1] = {
        posture->trunk, frame_along(upper, himc_vec3_cross(lower, upper)),
        frame_along(lower, a.side), frame_along(a.hand, a.side), frame_along(a.stick, a.side)};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        pose->joint[himc_arm_joint(hand, k)] =
            himc_quat_mul(himc_quat_conj(frame[k]), frame[k + 1]);
    return missing;
}

double himc_posture_at(const himc_posture *posture, const himc_vec3 tip[HIMC_HANDS],
                       himc_pose *pose)
{
    *pose = posture->rest;
    double left = arm_joints(posture, HIMC_LEFT, tip[HIMC_LEFT], pose);
    double right = arm_joints(posture, HIMC_RIGHT, tip[HIMC_RIGHT], pose);
    return fmax(left, right);
}

static himc_vec3 along_path(const himc_target *t, double dt)
{
    return himc_vec3_madd(himc_vec3_madd(t->x, dt, t->v), 0.5 * dt * dt, t->a);
}

// angular velocity and acceleration at the middle of three orientations, in the parent's frame
static void differentiate(himc_quat before, himc_quat now, himc_quat after, himc_vec3 *rate,
                          himc_vec3 *acceleration)
{
    himc_quat back = himc_quat_conj(now);
    himc_vec3 to = himc_quat_log(himc_quat_mul(after, back)),
              from = himc_quat_log(himc_quat_mul(before, back));
    *rate = himc_vec3_scale(himc_vec3_sub(to, from), 0.5 / DIFFERENCE);
    *acceleration = himc_vec3_scale(himc_vec3_add(to, from), 1 / (DIFFERENCE * DIFFERENCE));
}

void himc_posture_moving(const himc_posture *posture, const himc_target tip[HIMC_HANDS],
                         himc_posture_motion *motion)
{
    himc_pose pose[3];
    for (int k = 0; k < 3; k++) {
        himc_vec3 x[HIMC_HANDS];
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            x[hand] = along_path(&tip[hand], (k - 1) * DIFFERENCE);
        himc_posture_at(posture, x, &pose[k]);
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        motion->joint[j] = pose[1].joint[j];
        differentiate(pose[0].joint[j], pose[1].joint[j], pose[2].joint[j], &motion->rate[j],
                      &motion->acceleration[j]);
    }
}

static bool in_reach(const himc_posture *posture, himc_hand hand, himc_vec3 tip)
{
    himc_pose pose = posture->rest;
    return arm_joints(posture, hand, tip, &pose) == 0;
}

himc_vec3 himc_posture_reachable(const himc_posture *posture, himc_hand hand, himc_vec3 tip)
{
    if (in_reach(posture, hand, tip))
        return tip;
    // on the way there from a place surely in reach, by bisection
    himc_vec3 from = {posture->shoulder[hand].x + 0.45, 0.5 * posture->shoulder[hand].y,
                      posture->level + 0.1};
    himc_vec3 way = himc_vec3_sub(tip, from);
    double reached = 0, missed = 1;
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (reached + missed);
        if (in_reach(posture, hand, himc_vec3_madd(from, middle, way)))
            reached = middle;
        else
            missed = middle;
    }
    return himc_vec3_madd(from, reached, way);
}
