/// limits.c: joint limits from motion (2012 paper, algorithm 1; Johnson 2003; Baerlocher & Boulic
/// 2001 for the formulation by angles).
///
///     q_mean = the largest eigenvector of sum q q'               (Markley et al. 2007)
///     t_i = log(q_mean^-1 q_i),  T = U S V'                      (singular values)
///     x = axes' t,  sum (x_k / radius_k)^2 <= 1                  (bounding ellipsoid)
///
/// The paper prints log(q_mean q), which is not relative to the mean; the inverse is meant. The
/// axes are those of the singular value decomposition; the radii have the proportions of the
/// singular values and are just large enough for the farthest sample. The nearest point y to an x
/// outside is y_k = r_k^2 x_k / (t + r_k^2), where t > 0 puts it on the surface (Eberly, Distance
/// from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid, 2013). With z_k = y_k / r_k the
/// root of f(t) = 1 / |z(t)| - 1 is found by Halley's method (Gander, On Halley's Iteration Method,
/// 1985), of third order, from where the largest single z_k is 1: f is nearly linear, rising and
/// concave, so Newton's steps from below go nowhere too far (More & Sorensen 1983), and Halley's,
/// which are longer, are held to twice those. Invariant: no divisor is smaller than THINNEST,
/// whatever the radii.
#include "body/limits.h"

#include "body/euler.h"
#include "base/linear.h"
#include "base/rotations.h"

#include <stdlib.h>

// least semi-axis and half interval (rad). Chosen: 0.06 degrees, below the noise of captures
#define THINNEST 1e-3
#define HALLEY_STEPS \
    64 // chosen: an upper bound, of two million random cases none takes more than 9
#define HALLEY_END 1e-5 // chosen: after a step this small in proportion the next is rounding
#define UNIT_TOLERANCE \
    1e-6 // chosen: of a unit quaternion's squared length, rounding of file formats
#define DEGREE (HIMC_PI / 180)

static double larger(double a, double b)
{
    return a > b ? a : b; // a call of fmax would take longer
}

static double least(himc_vec3 v)
{
    return -larger(-v.x, larger(-v.y, -v.z));
}

static himc_vec3 at_least(himc_vec3 v, double low)
{
    return himc_vec3_make(larger(v.x, low), larger(v.y, low), larger(v.z, low));
}

static himc_vec3 divide(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_make(a.x / b.x, a.y / b.y, a.z / b.z);
}

himc_vec3 himc_limit_closest_on_ellipsoid(himc_vec3 radius, himc_vec3 x)
{
    // r and s = t in units of the thinnest semi-axis squared
    double thin = least(radius), step = INFINITY;
    himc_vec3 a = himc_vec3_scale(radius, 1 / thin), u = divide(x, radius);
    himc_vec3 r = himc_vec3_make(a.x * a.x, a.y * a.y, a.z * a.z);
    himc_vec3 ru = himc_vec3_make(r.x * u.x, r.y * u.y, r.z * u.z);
    double s = larger(larger(fabs(ru.x) - r.x, fabs(ru.y) - r.y), larger(fabs(ru.z) - r.z, 0));
    for (int i = 0; i < HALLEY_STEPS && fabs(step) > HALLEY_END * (s + 1); i++) {
        himc_vec3 d = himc_vec3_make(1 / (s + r.x), 1 / (s + r.y), 1 / (s + r.z));
        himc_vec3 z = himc_vec3_make(ru.x * d.x, ru.y * d.y, ru.z * d.z);
        himc_vec3 y = himc_vec3_make(z.x * d.x, z.y * d.y, z.z * d.z);
        double square = himc_vec3_dot(z, z), length = sqrt(square);
        double slope = himc_vec3_dot(z, y), bend = square * himc_vec3_dot(y, y) - slope * slope;
        double divisor = 2 * slope * slope - 3 * (length - 1) * bend;
        step = 2 * (length - 1) * square * slope / larger(divisor, slope * slope);
        s = larger(s + step, 0);
    }
    return himc_vec3_make(r.x * x.x / (s + r.x), r.y * x.y / (s + r.y), r.z * x.z / (s + r.z));
}

static double clamp(double value, double low, double high)
{
    double middle = 0.5 * (low + high), half = fmax(0.5 * (high - low), THINNEST);
    return fmin(fmax(value, middle - half), middle + half);
}

// distance along an axis to the ellipsoid, from a point z (by semi-axes) with |z|^2 = 1 + excess:
// radius (z_k - sqrt(z_k^2 - excess)), or a little more
static double along_axis(double radius, double z, double excess)
{
    return z * z >= excess ? radius * excess / fabs(z) : INFINITY;
}

// The surface is no farther from a point outside than on the way to the centre or along an axis,
// and rotations are no farther apart than their logarithms.
static double most_beyond(himc_vec3 radius, himc_vec3 t, double measure)
{
    double excess = measure * measure - 1;
    himc_vec3 z = divide(t, radius);
    himc_vec3 way =
        himc_vec3_make(along_axis(radius.x, z.x, excess), along_axis(radius.y, z.y, excess),
                       along_axis(radius.z, z.z, excess));
    return fmin(himc_vec3_length(t) * (1 - 1 / measure), least(way));
}

// A rotation of the joint is in the tangent space at most HIMC_PI / 2 times as long, and the
// measure grows by its length over the thinnest semi-axis.
static himc_limit_place locate_in_ellipsoid(const himc_limit *l, himc_quat rotation)
{
    himc_quat away = himc_quat_mul(himc_quat_conj(l->mean), rotation);
    himc_vec3 v = himc_mat3_apply_transposed(&l->axes, himc_quat_vector(away));
    himc_vec3 radius = at_least(l->radius, THINNEST);
    double ratio = himc_quat_log_ratio(away);
    himc_limit_place place = {.at = himc_vec3_scale(v, ratio)};
    place.measure = fabs(ratio) * himc_vec3_length(divide(v, radius));
    if (place.measure <= 1)
        place.room = (1 - place.measure) * least(radius) / (HIMC_PI / 2);
    else
        place.most_beyond = most_beyond(radius, place.at, place.measure);
    return place;
}

static himc_limit_place locate_in_box(const himc_limit *l, himc_quat rotation)
{
    himc_quat away = himc_quat_mul(himc_quat_conj(l->mean), rotation);
    himc_limit_place place = {.at = himc_euler_from_quat(away)};
    himc_vec3 middle = himc_vec3_scale(himc_vec3_add(l->lower, l->upper), 0.5);
    himc_vec3 half = at_least(himc_vec3_scale(himc_vec3_sub(l->upper, l->lower), 0.5), THINNEST);
    himc_vec3 z = divide(himc_vec3_sub(place.at, middle), half);
    place.measure = fmax(fabs(z.x), fmax(fabs(z.y), fabs(z.z)));
    if (place.measure > 1)
        place.most_beyond = HIMC_PI;
    return place;
}

himc_limit_place himc_limit_locate(const himc_limits *limits, int joint, himc_quat rotation)
{
    const himc_limit *l = &limits->joint[joint];
    if (limits->kind == HIMC_LIMITS_OFF || !l->bound)
        return (himc_limit_place){.measure = 0};
    return limits->kind == HIMC_LIMITS_EULER ? locate_in_box(l, rotation)
                                             : locate_in_ellipsoid(l, rotation);
}

// the nearest rotation within of a place outside
static himc_quat project(const himc_limits *limits, int joint, const himc_limit_place *place)
{
    const himc_limit *l = &limits->joint[joint];
    himc_vec3 t = place->at;
    if (limits->kind == HIMC_LIMITS_EULER) {
        t = himc_vec3_make(clamp(t.x, l->lower.x, l->upper.x), clamp(t.y, l->lower.y, l->upper.y),
                           clamp(t.z, l->lower.z, l->upper.z));
        return himc_quat_mul(l->mean, himc_euler_to_quat(t));
    }
    t = himc_limit_closest_on_ellipsoid(at_least(l->radius, THINNEST), t);
    return himc_quat_mul(l->mean, himc_quat_exp(himc_mat3_apply(&l->axes, t)));
}

himc_vec3 himc_limit_back(const himc_limits *limits, int joint, himc_quat rotation, double farther,
                          double *room)
{
    himc_limit_place place = himc_limit_locate(limits, joint, rotation);
    *room = place.room;
    if (place.measure <= 1 || place.most_beyond < farther)
        return himc_vec3_make(0, 0, 0);
    himc_quat near = project(limits, joint, &place);
    return himc_quat_log(himc_quat_mul(near, himc_quat_conj(rotation)));
}

double himc_limit_measure(const himc_limits *limits, int joint, himc_quat rotation)
{
    return himc_limit_locate(limits, joint, rotation).measure;
}

himc_quat himc_limit_closest(const himc_limits *limits, int joint, himc_quat rotation)
{
    himc_limit_place place = himc_limit_locate(limits, joint, rotation);
    return place.measure > 1 ? project(limits, joint, &place) : rotation;
}

/// A joint of the table: eigen values, and their axes as printed.
typedef struct printed {
    double lambda[3];  // half the angle (degrees)
    double axis[3][3]; // a row each, the captures' frame
} printed;

// clang-format off
static const printed neck = {{5.7, 2.9, 2.3},
    {{0.111, 0.993, 0.045}, {-0.978, 0.117, -0.173}, {0.177, 0.025, -0.984}}};
static const printed arm[3] = {
    {{4.4, 2.7, 0.1}, {{0.291, 0.018, -0.957}, {-0.955, -0.062, -0.291}, {0.064, -0.998, 0.001}}},
    {{14.6, 8.9, 4.4}, {{0.337, -0.684, 0.647}, {-0.889, -0.004, 0.458}, {-0.311, -0.729, -0.609}}},
    {{19.9, 9.1, 2.1}, {{0.231, -0.932, 0.278}, {0.003, -0.285, -0.958}, {-0.973, -0.222, 0.063}}},
};
// clang-format on

// The paper does not state its frames. With y up and z forward the neck's longest axis is the
// rotation of the head to the side; with the arms held sideways the wrist's shortest axis is its
// own length and its longest the flexion. In this library arms hang in the zero pose: x, the left
// arm's length, becomes -z, and y stays the axis of flexion.
static himc_limit printed_limit(const printed *p, bool is_arm, bool right, himc_quat mean)
{
    himc_vec3 e[3];
    for (int k = 0; k < 3; k++) {
        const double *v = p->axis[k];
        e[k] = is_arm ? himc_vec3_make(v[2], v[1], -v[0]) : himc_vec3_make(v[2], v[0], v[1]);
        // mirrored, a rotation axis (x, y, z) becomes (-x, y, -z): the same line as (x, -y, z)
        if (right)
            e[k].y = -e[k].y;
        // Gram-Schmidt, since axes of three digits are not quite orthonormal
        for (int i = 0; i < k; i++)
            e[k] = himc_vec3_madd(e[k], -himc_vec3_dot(e[k], e[i]), e[i]);
        e[k] = himc_vec3_unit(e[k]);
    }
    himc_limit l = {.bound = true, .mean = mean, .axes = himc_mat3_from_axes(e[0], e[1], e[2])};
    l.radius =
        himc_vec3_scale(himc_vec3_make(p->lambda[0], p->lambda[1], p->lambda[2]), 2 * DEGREE);
    double half[3]; // of the box around the ellipsoid
    for (int i = 0; i < 3; i++) {
        const double *a = l.axes.m[i];
        half[i] =
            sqrt(a[0] * a[0] * l.radius.x * l.radius.x + a[1] * a[1] * l.radius.y * l.radius.y +
                 a[2] * a[2] * l.radius.z * l.radius.z);
    }
    l.upper = himc_vec3_make(half[0], half[1], half[2]);
    l.lower = himc_vec3_scale(l.upper, -1);
    return l;
}

himc_limits himc_limits_table_1(const himc_pose *mean)
{
    himc_limits limits = {.kind = HIMC_LIMITS_ELLIPSOID};
    int j = HIMC_NECK - 1;
    limits.joint[j] = printed_limit(&neck, false, false, mean->joint[j]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < 3; k++) {
            j = himc_arm_joint((himc_hand)hand, k);
            limits.joint[j] = printed_limit(&arm[k], true, hand == HIMC_RIGHT, mean->joint[j]);
        }
    return limits;
}

static himc_quat mean_rotation(const himc_pose *pose, int frames, int joint)
{
    himc_rotations all = {{0}};
    for (int f = 0; f < frames; f++)
        himc_rotations_add(&all, pose[f].joint[joint]);
    return himc_rotations_mean(&all);
}

himc_pose himc_limits_mean(const himc_pose *pose, int frames)
{
    himc_pose mean;
    for (int j = 0; j < HIMC_JOINTS; j++)
        mean.joint[j] = mean_rotation(pose, frames, j);
    return mean;
}

// axes and radii of the ellipsoid around the tangent vectors `t` (count): the singular values of T
// are the roots of the eigenvalues of T T'
static bool fit_ellipsoid(himc_limit *l, const himc_vec3 *t, int count)
{
    double square[9] = {0}, lambda[3], axis[3][3], value[3], farthest = 0;
    for (int f = 0; f < count; f++) {
        const double x[3] = {t[f].x, t[f].y, t[f].z};
        for (int i = 0; i < 9; i++)
            square[i] += x[i / 3] * x[i % 3];
    }
    if (himc_linear_eigenvalues(3, square, lambda, axis[0]) != HIMC_LINEAR_SOLVED)
        return false;
    for (int k = 0; k < 3; k++) { // the largest first
        value[k] = sqrt(fmax(lambda[2 - k], 0));
        for (int i = 0; i < 3; i++)
            l->axes.m[i][k] = axis[2 - k][i];
    }
    double root = sqrt(count);
    himc_vec3 sigma = himc_vec3_make(value[0] / root, value[1] / root, value[2] / root);
    sigma = at_least(sigma, THINNEST);
    for (int f = 0; f < count; f++) {
        himc_vec3 z = divide(himc_mat3_apply_transposed(&l->axes, t[f]), sigma);
        farthest = fmax(farthest, himc_vec3_length(z));
    }
    l->radius = himc_vec3_scale(sigma, farthest);
    return true;
}

void himc_limits_loosen(himc_limits *limits, double least)
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_limit *l = &limits->joint[j];
        l->radius = at_least(l->radius, least);
        l->upper = at_least(l->upper, least);
        l->lower = himc_vec3_scale(at_least(himc_vec3_scale(l->lower, -1), least), -1);
    }
}

// ellipsoid and box around a joint's rotations; `tangent` has room for the frames
static bool learn_joint(himc_limit *l, const himc_pose *pose, int frames, int joint, double margin,
                        himc_vec3 *tangent)
{
    double most = 0;
    *l = (himc_limit){.mean = mean_rotation(pose, frames, joint)};
    for (int f = 0; f < frames; f++) {
        himc_quat away = himc_quat_mul(himc_quat_conj(l->mean), pose[f].joint[joint]);
        tangent[f] = himc_quat_log(away);
        most = fmax(most, himc_vec3_length(tangent[f]));
        himc_vec3 e = himc_euler_from_quat(away);
        himc_vec3 low = f ? l->lower : e, high = f ? l->upper : e;
        l->lower = himc_vec3_make(fmin(low.x, e.x), fmin(low.y, e.y), fmin(low.z, e.z));
        l->upper = himc_vec3_make(fmax(high.x, e.x), fmax(high.y, e.y), fmax(high.z, e.z));
    }
    l->bound = most > THINNEST;
    himc_vec3 more = himc_vec3_scale(himc_vec3_sub(l->upper, l->lower), 0.5 * margin);
    l->lower = himc_vec3_sub(l->lower, more);
    l->upper = himc_vec3_add(l->upper, more);
    bool fitted = fit_ellipsoid(l, tangent, frames);
    l->radius = at_least(himc_vec3_scale(l->radius, 1 + margin), THINNEST);
    return fitted;
}

bool himc_limits_learn(himc_limits *limits, const himc_pose *pose, int frames, double margin,
                       himc_error *error)
{
    himc_limits learned = {.kind = HIMC_LIMITS_ELLIPSOID};
    if (frames < 1)
        return himc_error_set(error, "limits: %d frames, expected at least 1", frames);
    if (!himc_check_range("limits: margin", margin, 0, 1, "", error))
        return false;
    for (int f = 0; f < frames; f++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            double square = himc_quat_dot(pose[f].joint[j], pose[f].joint[j]);
            if (!(fabs(square - 1) < UNIT_TOLERANCE))
                return himc_error_set(error,
                                      "limits: frame %d: %s: a quaternion of length %g, "
                                      "expected 1",
                                      f + 1, himc_joint_name(j), sqrt(square));
        }
    himc_vec3 *tangent = malloc(sizeof *tangent * (size_t)frames);
    bool fitted = tangent != NULL;
    for (int j = 0; fitted && j < HIMC_JOINTS; j++)
        fitted = learn_joint(&learned.joint[j], pose, frames, j, margin, tangent);
    free(tangent);
    if (!fitted)
        return himc_error_set(error, "limits: out of memory for %d frames", frames);
    *limits = learned;
    return true;
}
