/// posture.c: the natural posture. An arm has twelve degrees of freedom and its tip takes three;
/// this file chooses the other nine as a player does.
///
/// Built from the tip inwards. The stick is horizontal at impact and rises with the tip; the hand
/// rises less. Both lie in the vertical plane from a fixed point beside the shoulder through the
/// tip. This gives the wrist. Shoulder, elbow and wrist form a triangle that hangs below the line
/// from shoulder to wrist, turned a little outwards, and backwards where the wrist is under the
/// shoulder. Frames are as in the zero pose: z of each segment points back to its joint, y is the
/// axis of flexion. Everything is a smooth function of the tip, so rates are differences of the
/// map.
///
/// German grip: the wrist's flexion lifts the hand. French grip: forearm, hand and stick are rolled
/// about their lengths, the hand follows the forearm, and the fingers turn the stick more. The
/// trunk turns and leans towards the strike points and does not follow each motion of the tips,
/// since a player's trunk is slow.
#include "body/posture.h"

#include "base/limb_frame.h"
#include "body/stretch.h"

#include <string.h>

// The hand's share of the stick's elevation at rest. Chosen: in French grip the fingers raise the
// stick more; 72 degrees of roll bring the thumbs up.
#define FRENCH_WRIST 0.6 // in French grip, of that in German
#define FRENCH_ROLL 1.25 // of forearm, hand and stick about their lengths (rad)
// The elbow. Chosen: hangs a little outwards, less so with thumbs up; the stick's plane begins near
// the elbow of a playing arm.
#define ELBOW_OUT 0.35        // rotation of the elbow out of the vertical plane (rad)
#define FRENCH_ELBOW_OUT 0.15 // (rad)
#define PLANE_BEHIND 0.08     // origin of the stick's plane: behind the shoulder (m) ...
#define PLANE_BESIDE 0.05     // ... and outside it (m)
// Where the wrist comes under or behind the shoulder, front and back are ambiguous for a hanging
// elbow. Chosen: it moves backwards smoothly, before that happens.
#define BACK_BEGINS 0.5   // forward part of the unit vector from shoulder to wrist: begins here ...
#define BACK_ENDS (-0.35) // ... and is complete here
#define BACK_MOST 2.0     // backward part of the hanging direction, relative to its downward part
// The forearm's roll. Chosen: it follows the hand while the flexion axes of hand and elbow agree,
// as in every usual stroke, and more and more the elbow where they do not: it is always defined.
#define ROLL_AGREES 0.5 // cosine between these axes: the elbow's share begins below it ...
#define ROLL_PARTS 1.0  // ... grows while it falls by this ...
#define ELBOW_SHARE 1.2 // ... to this
// The triangle. Chosen: the limits keep its angles away from 0 and pi, where rates are infinite.
#define LONGEST_SHARE 0.985 // wrist's largest distance, of the straight arm
#define SHORTEST_EXTRA 0.05 // wrist's smallest distance, above the difference of the two bones (m)
#define STRAIGHT 0.15 // an elbow nearer to the line to the wrist is carried along by it (m); chosen
#define TOUCHES 0.4   // a stick that points up so far has left the head (rad); chosen
// The trunk. Chosen: nearly upright for a drum in front, and turned and leaning enough to reach
// four timpani in an arc.
#define TRUNK_LEAN 0.09         // (rad)
#define LEAN_BEGINS 0.60        // strike points farther than this make the trunk lean more (m) ...
#define LEAN_SLOPE 1.4          // ... by this (rad/m) ...
#define LEAN_LIMIT 0.55         // ... up to this (rad)
#define TURN_SHARE 0.85         // of the azimuth of the strike points; the arms do the rest
#define BOTH_SIDES (-0.5)       // cosine of the angle from which two places are on both sides
#define TURN_LIMIT 1.05         // (rad)
#define ARM_POSTURE_RATE 40.0   // chosen: a quarter of a second for elbow and wrist (rad/s)
#define TRUNK_POSTURE_RATE 11.0 // chosen: half a second from drum to drum (rad/s)
#define LONGEST_STEP 0.005 // chosen: of the motion to a goal (s); from 0.017 on it does not settle
#define FORESEEN_LONGEST 6.0 // after so long the trunk is at its goal (s)
// Rest of the body. Chosen: looks at a head half a metre ahead, sits with the feet flat.
#define LOOK_DOWN 0.22     // of neck and head together (rad)
#define KNEES_APART 0.45   // each, from straight ahead (rad)
#define THIGH_LIMIT (-0.2) // cosine of the steepest thigh on a low seat: knees above the hips
// The stool. Chosen: at 1.75 m a head at 0.85 m, and 0.1 m lower or higher, is played from the
// usual seat; hands of a lower one would strike through the thighs, arms of a higher one be raised.
#define HIGHEST_IMPACT 0.14 // over the seat, of the body's height
#define LOWEST_IMPACT 0.03  // (m)
// Who stands. Chosen: knees bent by 20 degrees, and the middle of the soles under the centre of
// mass; his shoulders are higher, so he leans to places that one who sits reaches upright, but not
// to those beside him: arms have no room under shoulders that are over a drum. Shares of the
// height.
#define STANDING_SHARE 0.53
#define CROUCHING_SHARE 0.40
#define STANDING_OVER 0.06       // hips over the lowest impact, else the knees bend more (m)
#define STANDING_ANKLES (-0.008) // before the hips
#define STANDING_APART 0.08      // each leg to its side (rad): feet a shoulder's width apart
#define STANDING_LEANS_BEYOND 0.20
#define LOWEST_STOOL 0.3 // (m)
// A point in reach of every body (himc_posture_reachable). Chosen: in front of the shoulder.
#define REACHED_AHEAD 0.27 // of the body's height, from the world's origin
#define REACHED_ABOVE 0.1  // above the level of impact (m)
#define PROBE 1e-4         // of the moves of an arm (rad)
#define GRIP_STEPS 60      // of himc_posture_tip_of_grip; chosen: to a millimetre in French grip
#define BISECTIONS 40      // chosen: to 1e-12 of the distance

void himc_posture_init(himc_posture *posture, const himc_skeleton *skeleton, double level)
{
    posture->skeleton = *skeleton;
    posture->rest = himc_pose_zero();
    posture->trunk_posture =
        (himc_trunk_posture){.value = {[HIMC_TRUNK_POSTURE_LEAN] = TRUNK_LEAN}};
    posture->rest.joint[HIMC_NECK - 1] = himc_quat_exp(himc_vec3_make(0, 0.5 * LOOK_DOWN, 0));
    posture->rest.joint[HIMC_HEAD - 1] = himc_quat_exp(himc_vec3_make(0, 0.5 * LOOK_DOWN, 0));
    posture->level = level;
    posture->leans_beyond = LEAN_BEGINS;
    posture->leans_beside = 0;
    memset(posture->hand, 0, sizeof posture->hand);
    // thighs lowered until the lower legs stand upright on the floor, knees apart; straight legs if
    // the seat is high
    double thigh = skeleton->segment[HIMC_LEFT_UPPER_LEG].length;
    double drop = skeleton->segment[HIMC_PELVIS].origin.z -
                  skeleton->segment[HIMC_LEFT_LOWER_LEG].length - HIMC_ANKLE_HEIGHT;
    double raise = acos(fmin(fmax(drop / thigh, THIGH_LIMIT), 1));
    for (int i = 0; i < HIMC_HANDS; i++) {
        double apart = i == HIMC_LEFT ? KNEES_APART : -KNEES_APART;
        posture->rest.joint[HIMC_LEFT_UPPER_LEG - 1 + i] =
            himc_quat_mul(himc_quat_exp(himc_vec3_make(0, 0, apart)),
                          himc_quat_exp(himc_vec3_make(0, -raise, 0)));
        posture->rest.joint[HIMC_LEFT_LOWER_LEG - 1 + i] =
            himc_quat_exp(himc_vec3_make(0, raise, 0));
    }
}

void himc_posture_stand(himc_posture *posture)
{
    const himc_skeleton *skeleton = &posture->skeleton;
    double thigh = skeleton->segment[HIMC_LEFT_UPPER_LEG].length,
           shank = skeleton->segment[HIMC_LEFT_LOWER_LEG].length,
           ahead = STANDING_ANKLES * skeleton->height,
           down =
               (skeleton->segment[HIMC_PELVIS].origin.z - HIMC_ANKLE_HEIGHT) / cos(STANDING_APART),
           leg = fmin(hypot(ahead, down), thigh + shank);
    double raise = himc_corner(thigh, leg, shank) + atan2(ahead, down);
    double knee = HIMC_PI - himc_corner(thigh, shank, leg);
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_quat *joint = posture->rest.joint;
        double apart = i == HIMC_LEFT ? STANDING_APART : -STANDING_APART;
        himc_quat out = himc_quat_exp(himc_vec3_make(apart, 0, 0)), in = himc_quat_conj(out);
        joint[HIMC_LEFT_UPPER_LEG - 1 + i] =
            himc_quat_mul(out, himc_quat_exp(himc_vec3_make(0, -raise, 0)));
        joint[HIMC_LEFT_LOWER_LEG - 1 + i] = himc_quat_exp(himc_vec3_make(0, knee, 0));
        joint[HIMC_LEFT_FOOT - 1 + i] =
            himc_quat_mul(himc_quat_exp(himc_vec3_make(0, raise - knee, 0)), in);
    }
    posture->leans_beyond = STANDING_LEANS_BEYOND * skeleton->height;
    posture->leans_beside = skeleton->segment[HIMC_LEFT_UPPER_ARM].origin.y;
}

double himc_posture_standing(const himc_skeleton_config *body, double lowest)
{
    return fmax(fmin(STANDING_SHARE * body->height, lowest + STANDING_OVER),
                CROUCHING_SHARE * body->height);
}

double himc_posture_seat(const himc_skeleton_config *body, double lowest, double highest)
{
    double seat = himc_skeleton_seat(body), standing = STANDING_SHARE * body->height;
    if (body->seat > 0 || lowest > highest)
        return seat;
    seat = fmax(seat, fmin(highest - HIGHEST_IMPACT * body->height, standing));
    return fmax(fmin(seat, lowest - LOWEST_IMPACT), LOWEST_STOOL);
}

// as far as the trunk turns
static double azimuth(himc_vec3 a)
{
    double most = TURN_LIMIT / TURN_SHARE;
    return fmin(fmax(atan2(a.y, a.x), -most), most);
}

himc_trunk_posture himc_posture_trunk(const himc_posture *posture,
                                      const himc_vec3 strike[HIMC_HANDS], himc_grip grip)
{
    himc_vec3 l = strike[HIMC_LEFT], r = strike[HIMC_RIGHT], both = himc_vec3_add(l, r);
    // the azimuth of the middle of the two places; of places on both sides, whose middle may lie
    // behind the player, the middle of their directions
    double azimuths = both.x * both.x + both.y * both.y > 1e-6 ? atan2(both.y, both.x) : 0;
    if (l.x * r.x + l.y * r.y < BOTH_SIDES * hypot(l.x, l.y) * hypot(r.x, r.y))
        azimuths = 0.5 * (azimuth(l) + azimuth(r));
    double turn = fmin(fmax(TURN_SHARE * azimuths, -TURN_LIMIT), TURN_LIMIT);
    double side = posture->leans_beside, x = -side * sin(turn), y = side * cos(turn);
    double far = fmax(hypot(l.x - x, l.y - y), hypot(r.x + x, r.y + y));
    double more = fmin(LEAN_SLOPE * fmax(far - posture->leans_beyond, 0), LEAN_LIMIT - TRUNK_LEAN);
    himc_trunk_posture b = {{0}, {0}, {0}};
    b.value[HIMC_TRUNK_POSTURE_TURN] = turn;
    b.value[HIMC_TRUNK_POSTURE_LEAN] = TRUNK_LEAN + more;
    b.value[HIMC_TRUNK_POSTURE_FRENCH_GRIP] = grip == HIMC_GRIP_FRENCH;
    return b;
}

static himc_trunk_posture trunk_posture_after(const himc_trunk_posture *b, double dt)
{
    himc_trunk_posture after = *b;
    for (int i = 0; i < HIMC_TRUNK_POSTURE_PARTS; i++) {
        after.value[i] += dt * (b->rate[i] + 0.5 * dt * b->acceleration[i]);
        after.rate[i] += dt * b->acceleration[i];
    }
    return after;
}

// x''' = -3 w x'' - 3 w^2 x' - w^3 (x - goal), constant during dt
static himc_trunk_posture step_towards(const himc_trunk_posture *now,
                                       const himc_trunk_posture *goal, double dt)
{
    himc_trunk_posture next = trunk_posture_after(now, dt);
    for (int i = 0; i < HIMC_TRUNK_POSTURE_PARTS; i++) {
        bool arms = i >= HIMC_TRUNK_POSTURE_ELBOW && i < HIMC_TRUNK_POSTURE_SIDE;
        double w = arms ? ARM_POSTURE_RATE : TRUNK_POSTURE_RATE;
        double jerk = w * (-3 * now->acceleration[i] +
                           w * (-3 * now->rate[i] + w * (goal->value[i] - now->value[i])));
        next.value[i] += jerk * dt * dt * dt / 6;
        next.rate[i] += jerk * dt * dt / 2;
        next.acceleration[i] += jerk * dt;
    }
    return next;
}

himc_trunk_posture himc_trunk_posture_approach(const himc_trunk_posture *now,
                                               const himc_trunk_posture *goal, double dt)
{
    himc_trunk_posture next = *now;
    double left = dt;
    for (; left > LONGEST_STEP; left -= LONGEST_STEP)
        next = step_towards(&next, goal, LONGEST_STEP);
    return step_towards(&next, goal, left);
}

himc_trunk_posture himc_trunk_posture_foreseen(const himc_trunk_posture *now,
                                               const himc_trunk_posture *goal, double time)
{
    // e = x - goal = (e + (v + w e) t + (a + 2 w v + w^2 e) t^2 / 2) exp(-w t); in the end it is 0
    double w = TRUNK_POSTURE_RATE, t = fmin(time, FORESEEN_LONGEST), fade = exp(-w * t);
    himc_trunk_posture then = *goal;
    for (int i = 0; i < HIMC_TRUNK_POSTURE_ELBOW; i++) {
        double e = now->value[i] - goal->value[i], b = now->rate[i] + w * e,
               c = now->acceleration[i] + 2 * w * now->rate[i] + w * w * e;
        double p = e + t * (b + 0.5 * t * c), v = b + t * c;
        then.value[i] += fade * p;
        then.rate[i] = fade * (v - w * p);
        then.acceleration[i] = fade * (c + w * (w * p - 2 * v));
    }
    return then;
}

typedef struct arm {
    himc_quat trunk;     // orientation in the world
    double turn, french; // of the trunk (rad); share of the French grip
    double out, raise;   // of elbow and wrist beyond the usual (rad)
    double eased;        // of the wrist's at a touch (rad)
    double touches;      // 1 at a touch .. 0 with the stick up
    double usually_out;  // of the elbow (rad)
    double aside;        // wrist to the left about the tip (rad)
    union {
        himc_vec3 point[HIMC_ARM_POINTS];
        struct {
            himc_vec3 shoulder, elbow, wrist, grip, tip;
        };
    };
    himc_vec3 stick, hand, side; // unit vectors; side is the flexion axis of wrist and grip
    himc_vec3 line, hang, rests; // from shoulder to wrist, to the elbow, there at rest
} arm;

static double blend_grips(double german, double french, double share)
{
    return german + share * (french - german);
}

static himc_quat trunk_of(const himc_trunk_posture *trunk_posture)
{
    double side = trunk_posture->value[HIMC_TRUNK_POSTURE_SIDE];
    himc_quat q = himc_quat_mul(
        himc_quat_exp(himc_vec3_make(0, 0, trunk_posture->value[HIMC_TRUNK_POSTURE_TURN])),
        himc_quat_exp(himc_vec3_make(0, trunk_posture->value[HIMC_TRUNK_POSTURE_LEAN], 0)));
    return side != 0 ? himc_quat_mul(q, himc_quat_exp(himc_vec3_make(side, 0, 0))) : q;
}

static arm arm_of(const himc_posture *posture, himc_hand hand)
{
    const double *value = posture->trunk_posture.value;
    arm a = {.trunk = trunk_of(&posture->trunk_posture),
             .turn = value[HIMC_TRUNK_POSTURE_TURN],
             .french = value[HIMC_TRUNK_POSTURE_FRENCH_GRIP],
             .out = value[HIMC_TRUNK_POSTURE_ELBOW + hand],
             .raise = value[HIMC_TRUNK_POSTURE_WRIST + hand],
             .eased = value[HIMC_TRUNK_POSTURE_EASED + hand],
             .aside = value[HIMC_TRUNK_POSTURE_ASIDE + hand] * (hand == HIMC_LEFT ? 1 : -1)};
    a.shoulder = himc_shoulder(&posture->skeleton, a.trunk, hand);
    return a;
}

// from 0 at 0 to 1 at 1, with no acceleration at either end
static double smooth_step(double x)
{
    x = fmin(fmax(x, 0), 1);
    return x * x * x * (10 + x * (-15 + x * 6));
}

// stick and hand: from the tip to the wrist
static void solve_wrist(const himc_posture *posture, himc_hand hand, himc_vec3 tip, arm *a)
{
    double outside = hand == HIMC_LEFT ? PLANE_BESIDE : -PLANE_BESIDE;
    double dx = tip.x - (a->shoulder.x - PLANE_BEHIND * cos(a->turn) - outside * sin(a->turn));
    double dy = tip.y - (a->shoulder.y - PLANE_BEHIND * sin(a->turn) + outside * cos(a->turn));
    double azimuth = atan2(dy, dx) - a->aside;
    double length = himc_vec3_length(posture->skeleton.tip), resting[HIMC_HAND_PATH_PARTS];
    const double *path = posture->hand[hand].moving ? posture->hand[hand].value : resting;
    if (!posture->hand[hand].moving)
        himc_hand_path_rest(tip.z - posture->level, posture->level, length, a->french, resting);
    a->tip = tip;
    azimuth += (hand == HIMC_LEFT ? 1 : -1) * path[HIMC_HAND_PATH_LOOP];
    a->usually_out =
        blend_grips(ELBOW_OUT, FRENCH_ELBOW_OUT, a->french) + path[HIMC_HAND_PATH_ELBOW];
    double lower = tip.z - path[HIMC_HAND_PATH_GRIP];
    double bent = blend_grips(1, FRENCH_WRIST, a->french) * path[HIMC_HAND_PATH_HAND];
    double up = himc_hand_path_stick(lower, length);
    a->touches = 1 - smooth_step(up / TOUCHES);
    double raise = a->raise - a->touches * a->eased;
    a->stick = himc_vec3_elevated(azimuth, up - raise);
    a->hand = himc_vec3_elevated(azimuth, bent - raise);
    a->side = himc_vec3_make(-sin(azimuth), cos(azimuth), 0);
    a->grip = himc_vec3_madd(tip, -length, a->stick);
    double palm = himc_vec3_length(posture->skeleton.segment[HIMC_LEFT_STICK + hand].origin);
    a->wrist = himc_vec3_madd(a->grip, -palm, a->hand);
}

static himc_vec3 about(himc_vec3 axis, double angle, himc_vec3 v)
{
    return himc_quat_rotate(himc_quat_exp(himc_vec3_scale(axis, angle)), v);
}

// the triangle shoulder - elbow - wrist; moves the wrist into reach and returns the distance (m)
static double solve_elbow(const himc_posture *posture, himc_hand hand, arm *a)
{
    double upper = himc_vec3_length(posture->skeleton.segment[HIMC_LEFT_FOREARM + hand].origin);
    double lower = himc_vec3_length(posture->skeleton.segment[HIMC_LEFT_HAND + hand].origin);
    himc_vec3 d = himc_vec3_sub(a->wrist, a->shoulder);
    double distance = himc_vec3_length(d), longest = LONGEST_SHARE * (upper + lower);
    double shortest = fabs(upper - lower) + SHORTEST_EXTRA,
           used = fmin(fmax(distance, shortest), longest);
    himc_vec3 u = distance > 0 ? himc_vec3_scale(d, 1 / distance) : himc_vec3_make(1, 0, 0);
    double along = (used * used + upper * upper - lower * lower) / (2 * used);
    double away = sqrt(fmax(upper * upper - along * along, 0));
    // the elbow hangs down, and backwards too when the wrist comes under or behind the shoulder
    double ahead = u.x * cos(a->turn) + u.y * sin(a->turn);
    double back = BACK_MOST * smooth_step((BACK_BEGINS - ahead) / (BACK_BEGINS - BACK_ENDS));
    himc_vec3 down = himc_vec3_make(-back * cos(a->turn), -back * sin(a->turn), -1);
    down = himc_vec3_unit(himc_vec3_madd(down, -himc_vec3_dot(down, u), u));
    himc_vec3 out = himc_vec3_cross(down, u);
    double side = hand == HIMC_LEFT ? -1 : 1, turn = side * a->usually_out;
    a->rests = a->hang = himc_vec3_madd(himc_vec3_scale(down, cos(turn)), sin(turn), out);
    a->line = u;
    const himc_hand_path *path = &posture->hand[hand];
    if (path->moving && himc_vec3_dot(path->hang, path->hang) > 0) {
        himc_vec3 across = himc_vec3_madd(path->hang, -himc_vec3_dot(path->hang, u), u);
        a->hang = about(u, path->value[HIMC_HAND_PATH_SWING], himc_vec3_unit(across));
    }
    a->elbow = himc_vec3_madd(himc_vec3_madd(a->shoulder, along, u), away,
                              about(u, -side * a->out, a->hang));
    a->wrist = himc_vec3_madd(a->shoulder, used, u);
    return fabs(used - distance);
}

static double arm_joints(const himc_posture *posture, himc_hand hand, himc_vec3 tip,
                         himc_pose *pose)
{
    arm a = arm_of(posture, hand);
    solve_wrist(posture, hand, tip, &a);
    double missing = solve_elbow(posture, hand, &a);
    himc_vec3 upper = himc_vec3_unit(himc_vec3_sub(a.elbow, a.shoulder));
    himc_vec3 lower = himc_vec3_unit(himc_vec3_sub(a.wrist, a.elbow));
    himc_vec3 flexion = himc_vec3_cross(lower, upper), elbow = himc_vec3_unit(flexion);
    double apart = (ROLL_AGREES - himc_vec3_dot(a.side, elbow)) / ROLL_PARTS;
    himc_vec3 forearm = himc_vec3_madd(a.side, ELBOW_SHARE * smooth_step(apart), elbow);
    himc_quat frame[HIMC_ARM_JOINTS + 1] = {
        a.trunk, himc_quat_from_limb(upper, flexion), himc_quat_from_limb(lower, forearm),
        himc_quat_from_limb(a.hand, a.side), himc_quat_from_limb(a.stick, a.side)};
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
    const double *value = posture->trunk_posture.value;
    double left = value[HIMC_TRUNK_POSTURE_LOOK_LEFT], down = value[HIMC_TRUNK_POSTURE_LOOK_DOWN];
    if (left != 0 || down != 0) { // neck and head share the look
        himc_quat half = himc_quat_mul(himc_quat_exp(himc_vec3_make(0, 0, 0.5 * left)),
                                       himc_quat_exp(himc_vec3_make(0, 0.5 * down, 0)));
        pose->joint[HIMC_NECK - 1] = himc_quat_mul(half, pose->joint[HIMC_NECK - 1]);
        pose->joint[HIMC_HEAD - 1] = himc_quat_mul(half, pose->joint[HIMC_HEAD - 1]);
    }
    double missing = arm_joints(posture, HIMC_LEFT, tip[HIMC_LEFT], pose);
    return fmax(missing, arm_joints(posture, HIMC_RIGHT, tip[HIMC_RIGHT], pose));
}

// a segment's capsule from its joint to another point
static himc_capsule reach_to(const himc_posture *posture, int segment, himc_vec3 from, himc_vec3 to)
{
    return (himc_capsule){from, to, posture->skeleton.segment[segment].radius};
}

static double solve_arm(const himc_posture *posture, himc_hand hand, himc_vec3 tip, arm *a)
{
    solve_wrist(posture, hand, tip, a);
    himc_vec3 wrist = a->wrist;
    double missing = solve_elbow(posture, hand, a);
    a->wrist = wrist; // the hand's own, in reach or not
    return missing;
}

static double arm_capsules(const himc_posture *posture, himc_hand hand, himc_vec3 tip,
                           himc_capsule *capsule)
{
    arm a = arm_of(posture, hand);
    double missing = solve_arm(posture, hand, tip, &a);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int i = himc_arm_joint(hand, k) + 1;
        capsule[i] = reach_to(posture, i, a.point[k], a.point[k + 1]);
    }
    capsule[himc_stick_segment(hand)].radius = HIMC_ROD_RADIUS;
    return missing;
}

himc_arm_moves himc_posture_arm_moves(const himc_posture *posture, himc_hand hand, himc_vec3 tip)
{
    himc_arm_moves moves;
    arm here = arm_of(posture, hand), a = here;
    moves.beyond = solve_arm(posture, hand, tip, &a);
    moves.touches = a.touches;
    for (int i = 0; i < HIMC_ARM_ANGLES; i++) {
        arm b = here;
        double probe = i == 2 && hand == HIMC_RIGHT ? -PROBE : PROBE;
        *(i == 0 ? &b.out : i == 1 ? &b.raise : &b.aside) += probe;
        moves.missing[i] = (solve_arm(posture, hand, tip, &b) - moves.beyond) / PROBE;
        for (int k = 0; k < HIMC_ARM_POINTS; k++)
            moves.by[i][k] = himc_vec3_scale(himc_vec3_sub(b.point[k], a.point[k]), 1 / PROBE);
    }
    return moves;
}

double himc_posture_capsules(const himc_posture *posture, const himc_vec3 tip[HIMC_HANDS],
                             himc_capsule capsule[HIMC_SEGMENTS])
{
    const himc_segment *s = posture->skeleton.segment;
    himc_vec3 root = posture->skeleton.segment[HIMC_PELVIS].origin,
              waist = himc_vec3_add(root, s[HIMC_TRUNK].origin);
    himc_quat trunk = trunk_of(&posture->trunk_posture);
    himc_vec3 up = himc_quat_rotate(trunk, himc_vec3_make(0, 0, 1));
    himc_vec3 top = himc_vec3_madd(waist, s[HIMC_TRUNK].length, up);
    himc_vec3 head =
        himc_vec3_madd(himc_vec3_add(waist, himc_quat_rotate(trunk, s[HIMC_NECK].origin)),
                       s[HIMC_NECK].length, up);
    capsule[HIMC_TRUNK] = reach_to(posture, HIMC_TRUNK, waist, top);
    capsule[HIMC_HEAD] =
        reach_to(posture, HIMC_HEAD, head, himc_vec3_madd(head, s[HIMC_HEAD].length, up));
    for (int i = HIMC_LEFT_UPPER_LEG; i <= HIMC_RIGHT_UPPER_LEG; i++) {
        himc_vec3 hip = himc_vec3_add(root, s[i].origin);
        himc_vec3 thigh =
            himc_quat_rotate(posture->rest.joint[i - 1], himc_vec3_scale(s[i].axis, s[i].length));
        capsule[i] = reach_to(posture, i, hip, himc_vec3_add(hip, thigh));
    }
    double left = arm_capsules(posture, HIMC_LEFT, tip[HIMC_LEFT], capsule);
    return fmax(left, arm_capsules(posture, HIMC_RIGHT, tip[HIMC_RIGHT], capsule));
}

himc_quat himc_posture_joint_after(const himc_posture_motion *m, int j, double dt)
{
    himc_vec3 turn =
        himc_vec3_madd(himc_vec3_scale(m->rate[j], dt), 0.5 * dt * dt, m->acceleration[j]);
    return himc_quat_mul(himc_quat_exp(turn), m->joint[j]);
}

void himc_posture_differentiate(const himc_pose pose[3], double step, int first, int end,
                                himc_posture_motion *motion)
{
    for (int j = first; j < end; j++) {
        himc_quat now = motion->joint[j] = pose[1].joint[j], back = himc_quat_conj(now);
        himc_vec3 to = himc_quat_log(himc_quat_mul(pose[2].joint[j], back)),
                  from = himc_quat_log(himc_quat_mul(pose[0].joint[j], back));
        motion->rate[j] = himc_vec3_scale(himc_vec3_sub(to, from), 0.5 / step);
        motion->acceleration[j] = himc_vec3_scale(himc_vec3_add(to, from), 1 / (step * step));
    }
}

himc_arm_levers himc_arm_levers_at(himc_vec3 waist, himc_quat trunk,
                                   const himc_vec3 joint[HIMC_ARM_JOINTS], himc_vec3 stick,
                                   const himc_pose *pose, himc_hand hand)
{
    himc_arm_levers a = {.frame = {trunk}};
    himc_vec3 at = waist;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        a.at[k] = at = himc_vec3_add(at, himc_quat_rotate(a.frame[k], joint[k]));
        a.frame[k + 1] = himc_quat_mul(a.frame[k], pose->joint[himc_arm_joint(hand, k)]);
    }
    himc_vec3 tip = a.at[HIMC_ARM_JOINTS] =
        himc_vec3_add(at, himc_quat_rotate(a.frame[HIMC_ARM_JOINTS], stick));
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        a.lever[k] = himc_vec3_sub(tip, a.at[k]);
    return a;
}

himc_arm_levers himc_arm_levers_of(const himc_skeleton *skeleton, himc_vec3 waist,
                                   const himc_pose *pose, himc_hand hand)
{
    himc_vec3 joint[HIMC_ARM_JOINTS];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        joint[k] = skeleton->segment[himc_arm_joint(hand, k) + 1].origin;
    return himc_arm_levers_at(waist, pose->joint[HIMC_TRUNK - 1], joint, skeleton->tip, pose, hand);
}

// Where the line to the wrist turns, an elbow whose direction across it is carried along moves with
// it. The elbow stays where it is instead if the direction kept is that from the shoulder, whose
// part along the line fades for a straight arm.
void himc_posture_swing(const himc_posture *posture, himc_hand hand, himc_vec3 tip, himc_vec3 soon,
                        himc_hand_path *path)
{
    himc_posture now = *posture, then = *posture;
    now.hand[hand] = *path;
    then.hand[hand].moving = false;
    arm a = arm_of(&now, hand);
    a.out = 0;
    arm b = a;
    solve_wrist(&now, hand, tip, &a);
    solve_elbow(&now, hand, &a);
    solve_wrist(&then, hand, soon, &b);
    solve_elbow(&then, hand, &b);
    himc_vec3 across = himc_vec3_cross(a.line, a.hang), to = himc_vec3_sub(b.elbow, b.shoulder),
              upper = himc_vec3_sub(a.elbow, a.shoulder);
    double along = himc_vec3_dot(upper, a.line), away = himc_vec3_dot(upper, a.hang);
    double share = along * away / (away * away + STRAIGHT * STRAIGHT);
    himc_hand_path_swing(path, himc_vec3_unit(himc_vec3_madd(a.hang, share, a.line)),
                         atan2(himc_vec3_dot(to, across), himc_vec3_dot(to, a.hang)));
}

// before and after, as both sides of a tick have the same derivatives
static himc_hand_path hand_path_after(const himc_hand_path *path, double dt)
{
    himc_hand_path after = *path;
    for (int i = 0; i < HIMC_HAND_PATH_PARTS; i++)
        after.value[i] += dt * (path->rate[i] + 0.5 * dt * path->acceleration[i]);
    return after;
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
        now.trunk_posture =
            trunk_posture_after(&posture->trunk_posture, (k - 1) * HIMC_DIFFERENCE_STEP);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            now.hand[hand] = hand_path_after(&posture->hand[hand], (k - 1) * HIMC_DIFFERENCE_STEP);
        himc_posture_at(&now, x, &pose[k]);
    }
    himc_posture_differentiate(pose, HIMC_DIFFERENCE_STEP, 0, HIMC_JOINTS, motion);
}

// whether the arm reaches the tip with the trunk turned towards it
static bool in_reach(const himc_posture *posture, himc_hand hand, himc_vec3 tip)
{
    himc_vec3 both[HIMC_HANDS] = {tip, tip};
    himc_posture towards = *posture;
    himc_pose pose = posture->rest;
    towards.trunk_posture = himc_posture_trunk(posture, both, HIMC_GRIP_GERMAN);
    return arm_joints(&towards, hand, tip, &pose) == 0;
}

himc_vec3 himc_posture_reachable(const himc_posture *posture, himc_hand hand, himc_vec3 tip)
{
    if (in_reach(posture, hand, tip))
        return tip;
    // bisection on the line from a point in reach of every body
    double side = posture->skeleton.segment[HIMC_LEFT_UPPER_ARM + hand].origin.y;
    double seat = posture->skeleton.segment[HIMC_PELVIS].origin.z,
           high = HIGHEST_IMPACT * posture->skeleton.height;
    double level = fmin(fmax(posture->level, seat + LOWEST_IMPACT), seat + high);
    himc_vec3 from = {REACHED_AHEAD * posture->skeleton.height, 0.5 * side, level + REACHED_ABOVE};
    himc_vec3 line = himc_vec3_sub(tip, from);
    double reached = 0, missed = 1;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (reached + missed);
        if (in_reach(posture, hand, himc_vec3_madd(from, middle, line)))
            reached = middle;
        else
            missed = middle;
    }
    return himc_vec3_madd(from, reached, line);
}

// the tip moves by what the grip misses, again and again; the stick rises by less than one with the
// tip, so this converges
himc_vec3 himc_posture_tip_of_grip(const himc_posture *posture, himc_hand hand, himc_vec3 grip)
{
    arm a = arm_of(posture, hand);
    himc_vec3 tip = grip;
    for (int i = 0; i < GRIP_STEPS; i++) {
        solve_wrist(posture, hand, tip, &a);
        tip = himc_vec3_add(tip, himc_vec3_sub(grip, a.grip));
    }
    return tip;
}
