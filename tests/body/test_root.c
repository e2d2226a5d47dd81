/// The wrench that holds the pelvis: at rest the weights, in playing the change of momentum less
/// weights, contacts and pushes, step by step; and what a stool would have to do instead.
#include "session.h"

#include "base/rotations.h"
#include "body/dynamics.h"
#include "performance/performance_state.h"

#include <math.h>

#define STEP (1 / 2000.0) // of these tests, with a row for each (s)

/// Linear [0], and angular about the hips [1].
typedef struct sums {
    const himc_performance *p;
    long rows;
    himc_vec3 center[HIMC_SEGMENTS]; // of the row before (m)
    himc_vec3 begun[2];              // momentum at the second row (N s, N m s)
    himc_vec3 impulse[2];            // of wrench, weights, contacts and pushes since
    himc_vec3 root[2];               // of the wrench alone
    double size[2];                  // of the wrench without sign
    double unexplained[2];           // change of momentum less the impulse
    double push;                     // impulse of pushes (N s)
    double pressed;                  // largest horizontal moment about the centre of pressure (N m)
    double co_contraction;           // largest
    himc_vec3 weight[2];             // of the last row (N, N m)
    himc_motion_row row;             // the last one
} sums;

static void add(himc_vec3 sum[2], double scale, himc_vec3 at, himc_vec3 force)
{
    sum[0] = himc_vec3_madd(sum[0], scale, force);
    sum[1] = himc_vec3_madd(sum[1], scale, himc_vec3_cross(at, force));
}

// with the velocities of the step that led to this row
static void momentum(const sums *s, const himc_tick *tick, himc_vec3 hips, himc_vec3 out[2])
{
    out[0] = out[1] = himc_vec3_make(0, 0, 0);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &s->p->body->plant.segment[i];
        himc_vec3 c = tick->row->center[i], moved = himc_vec3_sub(c, s->center[i]);
        himc_vec3 turning =
            himc_mat3_scale_along(&tick->body->rotation[i], segment->inertia, tick->body->spin[i]);
        add(out, segment->mass / STEP, himc_vec3_sub(c, hips), moved);
        out[1] = himc_vec3_add(out[1], turning);
    }
}

static void add_forces(sums *s, const himc_motion_row *row, himc_vec3 hips)
{
    s->weight[0] = s->weight[1] = himc_vec3_make(0, 0, 0);
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        double mass = s->p->body->plant.segment[i].mass;
        add(s->weight, mass, himc_vec3_sub(row->center[i], hips),
            himc_vec3_make(0, 0, -HIMC_GRAVITY));
        add(s->impulse, STEP, himc_vec3_sub(row->push_at[i], hips), row->push[i]);
        s->push += STEP * himc_vec3_length(row->push[i]);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        add(s->impulse, STEP, himc_vec3_sub(row->tip[hand], hips), row->tip_force[hand]);
    const himc_vec3 root[2] = {row->root_force, row->root_moment};
    for (int k = 0; k < 2; k++) {
        s->root[k] = himc_vec3_madd(s->root[k], STEP, root[k]);
        s->impulse[k] = himc_vec3_madd(s->impulse[k], STEP, himc_vec3_add(root[k], s->weight[k]));
        s->size[k] += STEP * himc_vec3_length(root[k]);
    }
}

static void see(void *user, const himc_tick *tick)
{
    sums *s = user;
    const himc_motion_row *row = tick->row;
    himc_vec3 hips = s->p->body->plant.segment[HIMC_PELVIS].origin, now[2];
    momentum(s, tick, hips, now);
    if (s->rows++ == 1)
        memcpy(s->begun, now, sizeof now);
    for (int k = 0; k < 2 && s->rows > 1; k++) {
        himc_vec3 change = himc_vec3_sub(now[k], s->begun[k]);
        s->unexplained[k] = himc_vec3_length(himc_vec3_sub(change, s->impulse[k]));
    }
    if (s->rows > 1)
        add_forces(s, row, hips);
    himc_vec3 arm = himc_vec3_sub(row->root_center, hips);
    himc_vec3 rest = himc_vec3_sub(row->root_moment, himc_vec3_cross(arm, row->root_force));
    s->pressed = fmax(s->pressed, hypot(rest.x, rest.y));
    for (int j = 0; j < HIMC_JOINTS; j++)
        s->co_contraction = fmax(s->co_contraction, row->co_contraction[j]);
    memcpy(s->center, row->center, sizeof s->center);
    s->row = *row;
}

static void ignore(void *user, const himc_motion_row *row)
{
    (void)user;
    (void)row;
}

static himc_performance *summed(sums *s, const char *setting)
{
    himc_performance *p = session_new();
    *s = (sums){.p = p};
    session_do(p, "drum kettle");
    session_do(p, "rate physics 2000");
    session_do(p, "rate task 2000");
    session_do(p, "%s", setting);
    himc_performance_on_motion(p, ignore, NULL);
    return p;
}

static void test_at_rest_the_pelvis_carries_the_weights(void)
{
    sums s;
    char line[200];
    himc_performance *p = summed(&s, "human 0");
    session_play(p, 1, NULL);
    himc_performance_on_tick(p, see, &s);
    session_play(p, 1, NULL);
    double seconds = (double)(s.rows - 1) * STEP, weight = -s.weight[0].z;
    himc_vec3 missing = himc_vec3_madd(s.root[1], seconds, s.weight[1]);
    snprintf(line, sizeof line, "%.9g N of %.9g, moment %.3g N m off", s.root[0].z / seconds,
             weight, himc_vec3_length(missing) / seconds);
    TEST_ASSERT_TRUE_MESSAGE(fabs(weight - 75.09 * HIMC_GRAVITY) < 1e-6, line);
    TEST_ASSERT_TRUE_MESSAGE(fabs(s.root[0].z / seconds / weight - 1) < 1e-6, line);
    TEST_ASSERT_TRUE_MESSAGE(himc_vec3_length(missing) < 1e-6 * s.size[1], line);
    TEST_ASSERT_TRUE_MESSAGE(s.row.root_friction < 1e-6 && s.pressed < 1e-9, line);
    // the weights press where they are: 0.649 m is the seat below hips at 0.735 m
    double ahead = -s.weight[1].y / weight;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -ahead, s.row.root_center.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.735 - 0.086, s.row.root_center.z);
    himc_performance_free(p);
}

// a second with both hands and a push of the trunk, by either engine: the sums of forces are exact,
// those of moments have the integrator's error, as a step turns inertias after it
static void test_in_playing_the_wrench_explains_all_momentum(void)
{
    static const char *const engine[] = {"engine tree", "engine ode"};
    for (int k = 0; k < 2; k++) {
        sums s;
        char line[200];
        himc_performance *p = summed(&s, engine[k]);
        session_do(p, "stroke 1 right accent f");
        session_do(p, "stroke 2 left tenuto mf");
        session_do(p, "play");
        session_play(p, 0.6, NULL);
        himc_performance_on_tick(p, see, &s);
        session_do(p, "push trunk 20 -10 30 0.2");
        session_play(p, 1, NULL);
        himc_performance_free(p);
        snprintf(line, sizeof line, "%s: %.2g of %.4g N s, %.2g of %.4g N m s, push %.4g N s",
                 engine[k], s.unexplained[0], s.size[0], s.unexplained[1], s.size[1], s.push);
        if (getenv("HIMC_LONG"))
            puts(line);
        TEST_ASSERT_TRUE_MESSAGE(s.unexplained[0] < 1e-6 * s.size[0], line);
        TEST_ASSERT_TRUE_MESSAGE(s.unexplained[1] < 1e-5 * s.size[1], line);
        TEST_ASSERT_TRUE_MESSAGE(fabs(s.push - 0.2 * sqrt(1400)) < 1e-3 && s.pressed < 1e-9, line);
    }
}

typedef struct sum {
    double weight, size; // (N), (N s)
    himc_vec3 impulse;   // of wrench and weight (N s)
} sum;

static void add_row(void *user, const himc_motion_row *row)
{
    sum *s = user;
    himc_vec3 f = row->root_force;
    f.z -= s->weight;
    s->size += 0.004 * himc_vec3_length(f);
    s->impulse = himc_vec3_madd(s->impulse, 0.004, f);
}

// at the usual rates, with steps of 4 and 5 samples and 40 in a row: from rest to rest
static void test_rows_miss_no_step_between_them(void)
{
    sum s = {.weight = 75.09 * HIMC_GRAVITY};
    char line[100];
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_play(p, 1, NULL);
    himc_performance_on_motion(p, add_row, &s);
    session_play(p, 0.1, NULL);
    session_do(p, "push left-hand 10 0 20 0.2");
    session_play(p, 4, NULL);
    himc_performance_free(p);
    himc_vec3 push = himc_vec3_scale(himc_vec3_make(10, 0, 20), 0.2); // to a step
    double off = himc_vec3_length(himc_vec3_add(s.impulse, push));
    snprintf(line, sizeof line, "%.2g of %.3g N s", off, s.size);
    if (getenv("HIMC_LONG"))
        puts(line);
    TEST_ASSERT_TRUE_MESSAGE(s.size > 4 && off < 1e-3 * s.size, line);
}

static void test_co_contraction_is_that_of_human_strength(void)
{
    static const char *const setting[] = {"strength human", "strength off"};
    for (int k = 0; k < 2; k++) {
        sums s;
        himc_performance *p = summed(&s, setting[k]);
        himc_performance_on_tick(p, see, &s);
        session_do(p, "stroke 1 right accent f");
        session_do(p, "play");
        session_play(p, 1.2, NULL);
        himc_performance_free(p);
        TEST_ASSERT_TRUE(k ? s.co_contraction == 0 : s.co_contraction > 0.1);
    }
}

static void test_inverse_kinematics_has_no_wrench(void)
{
    sums s;
    himc_performance *p = summed(&s, "mode ik");
    himc_performance_on_tick(p, see, &s);
    session_play(p, 0.1, NULL);
    TEST_ASSERT_TRUE(isnan(s.row.root_force.z) && isnan(s.row.root_moment.x) &&
                     isnan(s.row.seat_force.z) && isnan(s.row.foot_force[1].z));
    TEST_ASSERT_TRUE(isnan(s.row.root_center.z) && isnan(s.row.root_friction));
    TEST_ASSERT_TRUE(isnan(s.row.co_contraction[0]));
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_at_rest_the_pelvis_carries_the_weights);
    RUN_TEST(test_in_playing_the_wrench_explains_all_momentum);
    RUN_TEST(test_rows_miss_no_step_between_them);
    RUN_TEST(test_co_contraction_is_that_of_human_strength);
    RUN_TEST(test_inverse_kinematics_has_no_wrench);
    return UNITY_END();
}
