/// posture.c: an arm has twelve freedoms and its tip takes three; this is where a player puts the
/// other nine.
///
/// Built from the far end inwards: the stick lies level at impact and rises with the tip, the
/// hand follows less, both in the vertical plane from the elbow's place through the tip; the
/// wrist is then known, and shoulder, elbow and wrist make a triangle that hangs below its long
/// side, turned outwards a little, and behind where the wrist is under the shoulder. Axes are set
/// as in the zero pose: each segment's z points back to its joint, its y is the axis of flexion.
/// The slopes are choices that give the raised stick and wrist seen in players; everything is a
/// smooth function of the tip, so rates come from differences of the map.
///
/// Palms down (german) the hand is lifted by the wrist's flexion; thumbs up (french) forearm,
/// hand and stick are rolled about their lengths, the hand follows the forearm and the fingers
/// turn the stick more. The trunk turns and leans towards where the sticks shall strike, not
/// after each motion of the tips: a player's trunk is slow.
#include "body/posture.h"

#include "base/difference.h"

#define STICK_RISE 2.6        // stick's elevation per metre of the tip's height (rad/m)
#define STICK_MOST 1.25       // it never stands steeper (rad)
#define HAND_RISE 1.3         // the hand's
#define HAND_MOST 0.6         // (rad)
#define HAND_LEVEL (-0.25)    // the hand's elevation at impact: fingers a little down (rad)
#define FRENCH_STICK_RISE 3.5 // with thumbs up: the stick's
#define FRENCH_HAND_RISE 1.35 // and the hand's
#define FRENCH_ROLL 1.25      // of forearm, hand and stick, thumbs up (rad)
#define ELBOW_OUT 0.35        // turn of the elbow out of the vertical plane (rad)
#define FRENCH_ELBOW_OUT 0.15 // (rad)
#define ELBOW_BEHIND 0.08     // where the stick's plane begins: behind the shoulder (m) ...
#define ELBOW_BESIDE 0.05     // ... and outside it (m)
#define AHEAD 0.12            // ahead of the shoulder, of their distance: from here a wrist ...
#define BEHIND (-0.35)        // ... (at most from here)
#define MOST_BACK 2.0         // ... has its elbow so far behind, not just below
#define REACH 0.985           // of the straight arm
#define TRUNK_LEAN 0.09       // (rad)
#define NEAR_ENOUGH 0.60      // farther strokes make the trunk lean (m)
#define LEAN_MORE 1.4         // by so much (rad/m)
#define LEAN_MOST 0.55        // (rad)
#define TURN_SHARE 0.85       // of the azimuth of what is struck
#define TURN_MOST 1.05        // (rad)
#define BEARING_SPEED 11.0    // of the trunk's motion (rad/s)
#define LOOK_DOWN 0.22        // of neck and head together (rad)
#define ANKLE_HEIGHT 0.075    // (m)
#define KNEES_APART 0.45      // each, from straight ahead (rad)

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
    posture->skeleton = *skeleton;
    posture->rest = himc_pose_zero();
    posture->trunk_posture =
        (himc_trunk_posture){.value = {[HIMC_TRUNK_POSTURE_LEAN] = TRUNK_LEAN}};
    posture->rest.joint[HIMC_NECK - 1] = himc_quat_exp(himc_vec3_make(0, 0.5 * LOOK_DOWN, 0));
    posture->rest.joint[HIMC_HEAD - 1] = himc_quat_exp(himc_vec3_make(0, 0.5 * LOOK_DOWN, 0));
    posture->level = level;
    seat_legs(&posture->rest, skeleton);
}

himc_trunk_posture himc_posture_trunk(const himc_vec3 place[HIMC_HANDS], himc_grip grip)
{
    himc_vec3 both = himc_vec3_add(place[HIMC_LEFT], place[HIMC_RIGHT]);
    double turn = both.x * both.x + both.y * both.y > 1e-6 ? TURN_SHARE * atan2(both.y, both.x) : 0;
    double far = fmax(hypot(place[HIMC_LEFT].x, place[HIMC_LEFT].y),
                      hypot(place[HIMC_RIGHT].x, place[HIMC_RIGHT].y));
    double more = fmin(LEAN_MORE * fmax(far - NEAR_ENOUGH, 0), LEAN_MOST - TRUNK_LEAN);
    himc_trunk_posture b = {{0}, {0}, {0}};
    b.value[HIMC_TRUNK_POSTURE_TURN] = fmin(fmax(turn, -TURN_MOST), TURN_MOST);
    b.value[HIMC_TRUNK_POSTURE_LEAN] = TRUNK_LEAN + more;
    b.value[HIMC_TRUNK_POSTURE_FRENCH_GRIP] = grip == HIMC_GRIP_FRENCH;
    return b;
}

static himc_trunk_posture bearing_after(const himc_trunk_posture *b, double dt)
{
    himc_trunk_posture after = *b;
    for (int i = 0; i < HIMC_TRUNK_POSTURE_PARTS; i++) {
        after.value[i] += dt * (b->rate[i] + 0.5 * dt * b->acceleration[i]);
        after.rate[i] += dt * b->acceleration[i];
    }
    return after;
}

// x''' = -3 w x'' - 3 w^2 x' - w^3 (x - goal), held for dt
himc_trunk_posture himc_trunk_posture_approach(const himc_trunk_posture *now,
                                               const himc_trunk_posture *goal, double dt)
{
    double w = BEARING_SPEED;
    himc_trunk_posture next = bearing_after(now, dt);
    for (int i = 0; i < HIMC_TRUNK_POSTURE_PARTS; i++) {
        double jerk = w * (-3 * now->acceleration[i] +
                           w * (-3 * now->rate[i] + w * (goal->value[i] - now->value[i])));
        next.value[i] += jerk * dt * dt * dt / 6;
        next.rate[i] += jerk * dt * dt / 2;
        next.acceleration[i] += jerk * dt;
    }
    return next;
}

// a slope that flattens towards +-most
static double rise(double height, double slope, double most)
{
    return most * tanh(slope * height / most);
}

typedef struct arm {
    himc_quat trunk; // in the world
    double turn, french;
    himc_vec3 shoulder, elbow, wrist, grip, tip;
    himc_vec3 stick, hand, side; // directions; side is the flexion axis of wrist and grip
} arm;

static double between(double german, double french, double share)
{
    return german + share * (french - german);
}

static himc_quat trunk_of(const himc_trunk_posture *trunk_posture)
{
    return himc_quat_mul(
        himc_quat_exp(himc_vec3_make(0, 0, trunk_posture->value[HIMC_TRUNK_POSTURE_TURN])),
        himc_quat_exp(himc_vec3_make(0, trunk_posture->value[HIMC_TRUNK_POSTURE_LEAN], 0)));
}

static arm arm_of(const himc_posture *posture, himc_hand hand)
{
    const himc_segment *segment = posture->skeleton.segment;
    arm a = {.trunk = trunk_of(&posture->trunk_posture),
             .turn = posture->trunk_posture.value[HIMC_TRUNK_POSTURE_TURN],
             .french = posture->trunk_posture.value[HIMC_TRUNK_POSTURE_FRENCH_GRIP]};
    himc_vec3 waist = himc_vec3_add(posture->skeleton.root, segment[HIMC_TRUNK].origin);
    a.shoulder =
        himc_vec3_add(waist, himc_quat_rotate(a.trunk, segment[HIMC_LEFT_UPPER_ARM + hand].origin));
    return a;
}

// from the tip to the wrist
static void place_hand(const himc_posture *posture, himc_hand hand, himc_vec3 tip, arm *a)
{
    double outside = hand == HIMC_LEFT ? ELBOW_BESIDE : -ELBOW_BESIDE;
    double dx = tip.x - (a->shoulder.x - ELBOW_BEHIND * cos(a->turn) - outside * sin(a->turn));
    double dy = tip.y - (a->shoulder.y - ELBOW_BEHIND * sin(a->turn) + outside * cos(a->turn));
    double azimuth = atan2(dy, dx), height = tip.z - posture->level;
    double hand_rise = between(HAND_RISE, FRENCH_HAND_RISE, a->french);
    a->tip = tip;
    double stick_rise = between(STICK_RISE, FRENCH_STICK_RISE, a->french);
    a->stick = himc_vec3_elevated(azimuth, rise(height, stick_rise, STICK_MOST));
    a->hand = himc_vec3_elevated(azimuth, HAND_LEVEL + rise(height, hand_rise, HAND_MOST));
    a->side = himc_vec3_make(-sin(azimuth), cos(azimuth), 0);
    a->grip = himc_vec3_madd(tip, -himc_vec3_length(posture->skeleton.tip), a->stick);
    double palm = himc_vec3_length(posture->skeleton.segment[HIMC_LEFT_STICK + hand].origin);
    a->wrist = himc_vec3_madd(a->grip, -palm, a->hand);
}

// where the elbow hangs: down, but back too when the wrist, in the direction u from the shoulder,
// comes under or behind it, where nothing else would tell front from back
static himc_vec3 downward(himc_vec3 u, double turn)
{
    double ahead = u.x * cos(turn) + u.y * sin(turn);
    double x = fmin(fmax((AHEAD - ahead) / (AHEAD - BEHIND), 0), 1);
    double back = MOST_BACK * x * x * x * (10 + x * (-15 + x * 6));
    return himc_vec3_make(-back * cos(turn), -back * sin(turn), -1);
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
    himc_vec3 down = downward(u, a->turn);
    down = himc_vec3_unit(himc_vec3_madd(down, -himc_vec3_dot(down, u), u));
    himc_vec3 out = himc_vec3_cross(down, u);
    double elbow_out = between(ELBOW_OUT, FRENCH_ELBOW_OUT, a->french);
    double turn = hand == HIMC_LEFT ? -elbow_out : elbow_out;
    himc_vec3 hang = himc_vec3_madd(himc_vec3_scale(down, cos(turn)), sin(turn), out);
    a->elbow = himc_vec3_madd(himc_vec3_madd(a->shoulder, along, u), away, hang);
    a->wrist = himc_vec3_madd(a->shoulder, used, u);
    return fabs(used - distance);
}

static double arm_joints(const himc_posture *posture, himc_hand hand, himc_vec3 tip,
                         himc_pose *pose)
{
    arm a = arm_of(posture, hand);
    place_hand(posture, hand, tip, &a);
    double missing = place_elbow(posture, hand, &a);
    himc_vec3 upper = himc_vec3_unit(himc_vec3_sub(a.elbow, a.shoulder));
    himc_vec3 lower = himc_vec3_unit(himc_vec3_sub(a.wrist, a.elbow));
    himc_quat frame[HIMC_ARM_JOINTS + 1] = {
        a.trunk, himc_quat_from_limb(upper, himc_vec3_cross(lower, upper)),
        himc_quat_from_limb(lower, a.side), himc_quat_from_limb(a.hand, a.side),
        himc_quat_from_limb(a.stick, a.side)};
    double roll = (hand == HIMC_LEFT ? FRENCH_ROLL : -FRENCH_ROLL) * a.french;
    for (int k = 2; k <= HIMC_ARM_JOINTS; k++)
        frame[k] = himc_quat_mul(frame[k], himc_quat_exp(himc_vec3_make(0, 0, roll)));
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        pose->joint[himc_arm_joint(hand, k)] =
            himc_quat_mul(himc_quat_conj(frame[k]), frame[k + 1]);
    return missing;
}

double himc_posture_at(const himc_posture *posture, const himc_vec3 tip[HIMC_HANDS],
                       himc_pose *pose)
{
    *pose = posture->rest;
    pose->joint[HIMC_TRUNK - 1] = trunk_of(&posture->trunk_posture);
    double left = arm_joints(posture, HIMC_LEFT, tip[HIMC_LEFT], pose);
    double right = arm_joints(posture, HIMC_RIGHT, tip[HIMC_RIGHT], pose);
    return fmax(left, right);
}

void himc_posture_moving(const himc_posture *posture, const himc_target tip[HIMC_HANDS],
                         himc_posture_motion *motion)
{
    himc_pose pose[3];
    for (int k = 0; k < 3; k++) {
        himc_vec3 x[HIMC_HANDS];
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            x[hand] = himc_target_after(&tip[hand], (k - 1) * HIMC_DIFFERENCE_STEP).x;
        himc_posture now = *posture;
        now.trunk_posture = bearing_after(&posture->trunk_posture, (k - 1) * HIMC_DIFFERENCE_STEP);
        himc_posture_at(&now, x, &pose[k]);
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        motion->joint[j] = pose[1].joint[j];
        himc_differentiate(pose[0].joint[j], pose[1].joint[j], pose[2].joint[j],
                           HIMC_DIFFERENCE_STEP, &motion->rate[j], &motion->acceleration[j]);
    }
}

// with the trunk turned towards it
static bool in_reach(const himc_posture *posture, himc_hand hand, himc_vec3 tip)
{
    himc_vec3 both[HIMC_HANDS] = {tip, tip};
    himc_posture towards = *posture;
    himc_pose pose = posture->rest;
    towards.trunk_posture = himc_posture_trunk(both, HIMC_GRIP_GERMAN);
    return arm_joints(&towards, hand, tip, &pose) == 0;
}

himc_vec3 himc_posture_reachable(const himc_posture *posture, himc_hand hand, himc_vec3 tip)
{
    if (in_reach(posture, hand, tip))
        return tip;
    // on the way there from a place surely in reach, by bisection
    double side = posture->skeleton.segment[HIMC_LEFT_UPPER_ARM + hand].origin.y;
    himc_vec3 from = {0.27 * posture->skeleton.height, 0.5 * side, posture->level + 0.1};
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
