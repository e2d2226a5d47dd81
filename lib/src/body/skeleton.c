/// skeleton.c: a body from height and mass.
///
/// Lengths, mass fractions, centres of mass and radii of gyration are de Leva's (J. Biomech.
/// 29(9), 1996, table 4, men: reference height 1.741 m), scaled with the height. Where this body
/// has more or fewer segments: de Leva's head becomes head and neck (masses 4 : 1), his upper and
/// middle trunk become one segment (by the parallel axis theorem), his lower trunk is the pelvis,
/// and his foot becomes foot and toes (85 : 15). Invariant: the masses sum to the performer's mass
/// exactly. Table 1 of the 2012 paper sums to 100 % if a row of limbs is both of a pair, sticks
/// included; those have their own masses here, so its other 99.5 % are scaled to 1.
#include "himc/body.h"
#include "himc/ranges.h"

#include <string.h>

#define DE_LEVA_HEIGHT 1.741 // de Leva 1996, men (m)
// hip joints of a timpanist on a stool, of the body's height. Chosen: the elbows are above the
// drumhead
#define SEAT_SHARE 0.42

/// A row of the anthropometry at de Leva's reference height; limbs have one row, the left side's.
/// Chosen where de Leva has no value: capsule radii, joint positions across the trunk, split parts.
typedef struct row {
    int parent;
    double length;      // (m)
    double origin[3];   // the joint in the parent's frame (m)
    double axis[3];     // towards the far end
    double fraction;    // of the body's mass, de Leva
    double table1;      // 2012 paper, table 1: half of the printed row for a limb of a pair (%)
    double center;      // of mass, fraction of the length from the joint
    double gyration[3]; // about x, y, z, fraction of the length
    double radius;      // of the capsule (m)
} row;

// clang-format off
#define HEAD_AND_NECK 0.0694 // de Leva 1996, of the body's mass
#define FOOT_AND_TOES 0.0137 // de Leva 1996
static const row rows[] = {
    // pelvis, trunk (centre and gyration set by merge_trunk), neck, head
    {-1, 0.1457, {0, 0, 0}, {0, 0, 1}, 0.1117, 18, 0.3885, {0.615, 0.551, 0.587}, 0.11},
    {HIMC_PELVIS, 0.3862, {0, 0, 0.1457}, {0, 0, 1}, 0.3229, 46, 0, {0, 0, 0}, 0.13},
    {HIMC_TRUNK, 0.0696, {0, 0, 0.3862}, {0, 0, 1},
     0.2 * HEAD_AND_NECK, 4, 0.5, {0.7, 0.7, 0.6}, 0.05},
    {HIMC_NECK, 0.2033, {0, 0, 0.0696}, {0, 0, 1},
     0.8 * HEAD_AND_NECK, 4, 0.4024, {0.362, 0.376, 0.312}, 0.09},
    // upper arm, forearm, hand, stick (set by build_stick)
    {HIMC_TRUNK, 0.2817, {0, 0.185, 0.345}, {0, 0, -1},
     0.0271, 0.5 * 4, 0.5772, {0.285, 0.269, 0.158}, 0.045},
    {HIMC_LEFT_UPPER_ARM, 0.2689, {0, 0, -0.2817}, {0, 0, -1},
     0.0162, 0.5 * 2, 0.4574, {0.276, 0.265, 0.121}, 0.036},
    {HIMC_LEFT_FOREARM, 0.0862, {0, 0, -0.2689}, {0, 0, -1},
     0.0061, 0.5 * 1, 0.79, {0.628, 0.513, 0.401}, 0.025},
    {HIMC_LEFT_HAND, 0, {0, 0, -0.0862}, {0, 0, -1}, 0, 0, 0, {0, 0, 0}, 0.006},
    // upper leg, lower leg, foot, toes
    {HIMC_PELVIS, 0.4222, {0, 0.085, 0}, {0, 0, -1},
     0.1416, 0.5 * 14, 0.4095, {0.329, 0.329, 0.149}, 0.075},
    {HIMC_LEFT_UPPER_LEG, 0.434, {0, 0, -0.4222}, {0, 0, -1},
     0.0433, 0.5 * 5, 0.4459, {0.255, 0.249, 0.103}, 0.05},
    {HIMC_LEFT_LOWER_LEG, 0.2194, {0, 0, -0.434}, {1, 0, 0},
     0.85 * FOOT_AND_TOES, 0.85 * 0.5 * 1.5, 0.33, {0.124, 0.257, 0.245}, 0.03},
    {HIMC_LEFT_FOOT, 0.07, {0.16, 0, -0.05}, {1, 0, 0},
     0.15 * FOOT_AND_TOES, 0.15 * 0.5 * 1.5, 0.5, {0.3, 0.35, 0.35}, 0.02},
};

static const char *const segment_names[HIMC_SEGMENTS] = {
    "pelvis", "trunk", "neck", "head",
    "left-upper-arm", "right-upper-arm", "left-forearm", "right-forearm",
    "left-hand", "right-hand", "left-stick", "right-stick",
    "left-upper-leg", "right-upper-leg", "left-lower-leg", "right-lower-leg",
    "left-foot", "right-foot", "left-toes", "right-toes",
};

static const char *const joint_names[HIMC_JOINTS] = {
    "waist", "neck", "head",
    "left-shoulder", "right-shoulder", "left-elbow", "right-elbow",
    "left-wrist", "right-wrist", "left-grip", "right-grip",
    "left-hip", "right-hip", "left-knee", "right-knee",
    "left-ankle", "right-ankle", "left-toes", "right-toes",
};
// clang-format on

// the row of a segment; the right side mirrors the left
static row row_of(int segment)
{
    if (segment < HIMC_LEFT_UPPER_ARM)
        return rows[segment];
    int right = (segment - HIMC_LEFT_UPPER_ARM) % 2;
    row r = rows[HIMC_LEFT_UPPER_ARM + (segment - HIMC_LEFT_UPPER_ARM) / 2];
    if (right)
        r.origin[1] = -r.origin[1];
    if (r.parent >= HIMC_LEFT_UPPER_ARM)
        r.parent += right;
    return r;
}

himc_skeleton_config himc_skeleton_default(void)
{
    return (himc_skeleton_config){.height = 1.75,
                                  .mass = 75,
                                  .anthropometry = HIMC_DE_LEVA,
                                  .stick_length = 0.36,
                                  .shaft_mass = 0.025,
                                  .mallet_mass = 0.020,
                                  .mallet_radius = 0.0175,
                                  .grip = 0.10};
}

static bool config_valid(const himc_skeleton_config *c, himc_error *error)
{
    bool valid =
        himc_check_range("height", c->height, 1.19, 2.21, "m", error) &&
        himc_check_range("mass", c->mass, HIMC_BODY_MASS_MIN, HIMC_BODY_MASS_MAX, "kg", error) &&
        himc_check_range("stick length", c->stick_length, 0.2, 0.6, "m", error) &&
        himc_check_range("shaft mass", c->shaft_mass, 0.005, 0.2, "kg", error) &&
        himc_check_range("mallet mass", c->mallet_mass, 0.005, 0.2, "kg", error) &&
        himc_check_range("mallet radius", c->mallet_radius, 0.005, 0.05, "m", error) &&
        himc_check_range("grip", c->grip, 0.02, 0.5 * c->stick_length, "m", error);
    valid = valid && (c->shoulders == 0 ||
                      himc_check_range("shoulders", c->shoulders, 0.2, 0.6, "m", error));
    valid = valid && (c->seat == 0 || himc_check_range("seat", c->seat, 0.3, 1.3, "m", error));
    for (int hand = 0; valid && hand < HIMC_HANDS; hand++)
        if (c->length[HIMC_LEFT_STICK + hand] != 0)
            valid = himc_error_set(error, "%s: a measured length, expected 0: set the stick length",
                                   segment_names[HIMC_LEFT_STICK + hand]);
    for (int i = 0; valid && i < HIMC_SEGMENTS; i++)
        valid = c->length[i] == 0 ||
                himc_check_range(segment_names[i], c->length[i], 0.02, 1, "m", error);
    return valid;
}

// a segment's share of the mass in its table, which may not sum up to 1
static double share(int segment, himc_anthropometry anthropometry)
{
    row r = row_of(segment);
    return anthropometry == HIMC_TABLE_1 ? r.table1 : r.fraction;
}

// de Leva's upper and middle trunk as one segment: centre and inertia by the parallel axis theorem
static void merge_trunk(himc_segment *trunk)
{
    static const struct {
        double share, length;
        double below;  // the part's lower end above the waist (m)
        double center; // from the part's top, fraction of its length
        double gyration[3];
    } part[2] = {{0.1596, 0.1707, 0.2155, 0.2999, {0.716, 0.454, 0.659}},
                 {0.1633, 0.2155, 0, 0.4502, {0.482, 0.383, 0.468}}};
    double scale = trunk->length / rows[HIMC_TRUNK].length, z[2];
    double sum = part[0].share + part[1].share;
    trunk->center = himc_vec3_make(0, 0, 0);
    for (int i = 0; i < 2; i++) {
        z[i] = scale * (part[i].below + (1 - part[i].center) * part[i].length);
        trunk->center.z += z[i] * part[i].share / sum;
    }
    trunk->inertia = himc_vec3_make(0, 0, 0);
    for (int i = 0; i < 2; i++) {
        double m = trunk->mass * part[i].share / sum, l = scale * part[i].length;
        double away = (z[i] - trunk->center.z) * (z[i] - trunk->center.z);
        const double *g = part[i].gyration;
        trunk->inertia.x += m * (g[0] * g[0] * l * l + away);
        trunk->inertia.y += m * (g[1] * g[1] * l * l + away);
        trunk->inertia.z += m * g[2] * g[2] * l * l;
    }
}

// a uniform shaft with a ball at its end, held at the grip
static void build_stick(himc_segment *stick, himc_vec3 tip, const himc_skeleton_config *c)
{
    double shaft = 0.5 * c->stick_length - c->grip, ball = -tip.z;
    double mass = c->shaft_mass + c->mallet_mass;
    double center = (c->shaft_mass * shaft + c->mallet_mass * ball) / mass;
    double sphere = 0.4 * c->mallet_mass * c->mallet_radius * c->mallet_radius;
    double across = c->shaft_mass * (c->stick_length * c->stick_length / 12 +
                                     (shaft - center) * (shaft - center)) +
                    sphere + c->mallet_mass * (ball - center) * (ball - center);
    double along = sphere + 0.5 * c->shaft_mass * stick->radius * stick->radius;
    stick->mass = mass;
    stick->length = c->stick_length - c->grip;
    stick->center = himc_vec3_make(0, 0, -center);
    stick->inertia = himc_vec3_make(across, across, along);
}

// `sum`: of all segments' shares
static void build_segment(himc_skeleton *skeleton, int i, const himc_skeleton_config *c, double sum)
{
    row r = row_of(i);
    himc_segment *s = &skeleton->segment[i];
    double scale = c->height / DE_LEVA_HEIGHT;
    bool stick = r.length == 0;
    s->parent = r.parent;
    s->joint = r.parent < 0 ? HIMC_JOINT_FIXED : HIMC_JOINT_BALL;
    s->axis = himc_vec3_make(r.axis[0], r.axis[1], r.axis[2]);
    s->radius = stick ? r.radius : r.radius * scale;
    s->length = c->length[i] > 0 ? c->length[i] : r.length * scale;
    s->mass = c->mass * (share(i, c->anthropometry) / sum);
    // positions along the parent scale with its length, positions across it with the body's height
    double stretch = scale;
    if (r.parent >= 0)
        stretch = skeleton->segment[r.parent].length / row_of(r.parent).length;
    s->origin = himc_vec3_make(r.origin[0] * stretch, r.origin[1] * scale, r.origin[2] * stretch);
    if (c->shoulders > 0 && r.parent == HIMC_TRUNK && r.origin[1] != 0)
        s->origin.y = copysign(0.5 * c->shoulders, r.origin[1]);
    s->center = himc_vec3_scale(s->axis, r.center * s->length);
    double ml2 = s->mass * s->length * s->length;
    const double *g = r.gyration;
    s->inertia = himc_vec3_make(ml2 * g[0] * g[0], ml2 * g[1] * g[1], ml2 * g[2] * g[2]);
}

double himc_skeleton_seat(const himc_skeleton_config *config)
{
    return config->seat > 0 ? config->seat : SEAT_SHARE * config->height;
}

bool himc_skeleton_init(himc_skeleton *skeleton, const himc_skeleton_config *config,
                        himc_error *error)
{
    double sum = 0;
    if (!config_valid(config, error))
        return false;
    skeleton->height = config->height;
    skeleton->mass = config->mass;
    skeleton->mallet_radius = config->mallet_radius;
    skeleton->tip =
        himc_vec3_make(0, 0, -(config->stick_length - config->mallet_radius - config->grip));
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        sum += share(i, config->anthropometry);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        build_segment(skeleton, i, config, sum);
    merge_trunk(&skeleton->segment[HIMC_TRUNK]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        build_stick(&skeleton->segment[HIMC_LEFT_STICK + hand], skeleton->tip, config);
    skeleton->segment[HIMC_PELVIS].origin = himc_vec3_make(0, 0, himc_skeleton_seat(config));
    return true;
}

const char *himc_segment_name(int segment)
{
    return segment_names[segment];
}

const char *himc_joint_name(int joint)
{
    return joint_names[joint];
}

int himc_joint_find(const char *name)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (strcmp(name, himc_joint_name(j)) == 0)
            return j;
    return -1;
}
