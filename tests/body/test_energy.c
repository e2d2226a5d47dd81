/// Energies and works in the rows of motion: their balance, what they mean, and that the hot path
/// does not change.
///
/// Everyday the first seconds of the improvisation; all of it with HIMC_LONG (make test-long).
#include "take_files.h"

#include "session.h"

#include "body/dynamics.h"
#include "himc/body.h"
#include "performance/performance_state.h"

#include <math.h>

typedef struct balance {
    const himc_performance *p;
    bool begun;
    double at_first, first_sum; // kinetic and potential energy and the works, in the first row (J)
    double work;                // of joints, contacts and pushes, all positive (J)
    double worst;               // of the balance (J)
    himc_energy before;         // of the last row
    double lost;                // largest fall of `lost` (J)
    double torque_size;         // sum over rows of the mean square torque of the joints (N^2 m^2)
    double mirror;              // largest distance of torques from inverse dynamics (N m)
    long rows;
} balance;

static double sum_of(const himc_energy *e)
{
    double sum = e->push + e->placed + e->numerical;
    for (int j = 0; j < HIMC_JOINTS; j++)
        sum += e->joint[j];
    return sum + e->contact[HIMC_LEFT] + e->contact[HIMC_RIGHT];
}

static void add_work(balance *b, const himc_energy *e)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        b->work += fabs(e->joint[j] - b->before.joint[j]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        b->work += fabs(e->contact[hand] - b->before.contact[hand]);
    b->work += fabs(e->push - b->before.push);
}

// the torques of a row by recursive Newton-Euler from nothing but its poses, rates, accelerations
// and outer forces
static void mirror(balance *b, const himc_motion_row *row)
{
    const himc_skeleton *plant = &b->p->body->plant;
    himc_body_state state;
    himc_pose pose;
    himc_vec3 torque[HIMC_JOINTS], load[HIMC_JOINTS], rate[HIMC_JOINTS];
    memcpy(pose.joint, row->rotation, sizeof pose.joint);
    memcpy(load, row->torque, sizeof load);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_quat parent = row->orientation[plant->segment[j + 1].parent];
        rate[j] = himc_quat_rotate(himc_quat_conj(parent), row->rate[j]);
    }
    himc_pose_to_state(plant, &pose, rate, &state);
    himc_inverse_dynamics(plant, &state, row->acceleration, false, torque);
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        himc_add_force(plant, &state, i, row->push_at[i], row->push[i], load);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        himc_add_force(plant, &state, himc_stick_segment((himc_hand)hand), state.tip[hand],
                       row->tip_force[hand], load);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        b->mirror = fmax(b->mirror, himc_vec3_length(himc_vec3_sub(load[j], torque[j])));
        b->torque_size += himc_vec3_dot(row->torque[j], row->torque[j]) / HIMC_JOINTS;
    }
}

static void ignore_row(void *user, const himc_motion_row *row)
{
    (void)user;
    (void)row;
}

static void keep_row(void *user, const himc_motion_row *row)
{
    *(himc_motion_row *)user = *row;
}

static void see(void *user, const himc_tick *tick)
{
    balance *b = user;
    TEST_ASSERT_NOT_NULL(tick->row);
    const himc_energy *e = &tick->row->energy;
    double held = e->kinetic + e->potential, sum = sum_of(e);
    if (!b->begun) {
        b->at_first = held;
        b->first_sum = sum;
    } else {
        add_work(b, e);
        b->lost = fmax(b->lost, b->before.lost - e->lost);
    }
    b->begun = true;
    b->worst = fmax(b->worst, fabs(held - b->at_first - (sum - b->first_sum)));
    mirror(b, tick->row);
    b->before = *e;
    b->rows++;
}

static himc_performance *accounted(balance *b, const char *score)
{
    himc_performance *p = session_new();
    *b = (balance){.p = p};
    session_do(p, "drum kettle");
    session_do(p, "score %s", score);
    himc_performance_on_motion(p, ignore_row, NULL);
    himc_performance_on_tick(p, see, b);
    session_do(p, "play");
    return p;
}

static void check(const balance *b, const char *what)
{
    char line[300];
    const himc_energy *e = &b->before;
    double torque = sqrt(b->torque_size / (double)b->rows);
    snprintf(line, sizeof line,
             "%s: work %.3f J, balance %.2g of it, integrator %.2g of it, push %.3g J, mirror %.2g "
             "of %.3g N m, lost %.4g J",
             what, b->work, b->worst / b->work, e->numerical / b->work, e->push, b->mirror / torque,
             torque, e->lost);
    if (getenv("HIMC_LONG"))
        puts(line);
    TEST_ASSERT_TRUE_MESSAGE(b->work > 1 && b->rows > 400, line);
    TEST_ASSERT_TRUE_MESSAGE(b->worst <= 1e-6 * b->work, line);
    TEST_ASSERT_TRUE_MESSAGE(b->mirror <= 1e-6 * torque, line);
    TEST_ASSERT_TRUE_MESSAGE(fabs(e->numerical) < 1e-2 * b->work, line);
}

static void test_the_balance_of_the_improvisation_closes(void)
{
    balance b;
    himc_performance *p = accounted(&b, "patches/improvisation.txt");
    session_play(p, getenv("HIMC_LONG") ? 45 : 4, NULL);
    himc_performance_free(p);
    check(&b, "improvisation");
    TEST_ASSERT_TRUE(b.before.lost > 0 && b.lost <= 1e-9);
    TEST_ASSERT_EQUAL_DOUBLE(0, b.before.push);
}

// pushes of 200 N and 30 N, a heavier player while it plays, and contacts
static void test_the_balance_of_a_disturbed_piece_closes(void)
{
    balance b;
    himc_performance *p = accounted(&b, "patches/improvisation.txt");
    session_play(p, 1.5, NULL);
    session_do(p, "push left-forearm 100 0 170 0.1 0.25");
    session_play(p, 1, NULL);
    session_do(p, "push right-lower-leg 30 0 0 0.05");
    session_do(p, "player 1.8 90");
    session_play(p, 1, NULL);
    himc_performance_free(p);
    check(&b, "disturbed");
    TEST_ASSERT_TRUE(b.before.push > 0.1 && b.before.placed > 10);
}

static void test_the_balance_of_a_pushed_take_closes_under_the_printed_law_and_ode(void)
{
    balance b = {0};
    const char *path = shared_capture("drumstroke_pearl_240hz/stroke.trc");
    if (!path)
        TEST_IGNORE_MESSAGE("needs ../shared/mocap");
    himc_performance *p = session_new();
    b.p = p;
    session_do(p, "drum kettle");
    session_do(p, "engine ode");
    session_do(p, "law printed");
    session_do(p, "take %s", path);
    himc_performance_on_motion(p, ignore_row, NULL);
    himc_performance_on_tick(p, see, &b);
    session_do(p, "play");
    session_play(p, 1.2, NULL);
    session_do(p, "push right-hand 0 30 30 0.1");
    session_play(p, 1, NULL);
    himc_performance_free(p);
    check(&b, "pushed take");
}

static void test_inverse_kinematics_has_no_forces_on_the_body(void)
{
    static himc_motion_row last;
    balance b;
    himc_performance *p = accounted(&b, "patches/improvisation.txt");
    session_do(p, "mode ik");
    himc_performance_on_tick(p, NULL, NULL);
    himc_performance_on_motion(p, keep_row, &last);
    session_play(p, 3, NULL);
    TEST_ASSERT_TRUE(isnan(last.torque[0].x) && isnan(last.power[3]) && isnan(last.energy.kinetic));
    TEST_ASSERT_TRUE(last.energy.lost > 0 && last.energy.heads > 0);
    himc_performance_free(p);
}

// rows cost time, but they change nothing
static void test_a_piece_with_rows_has_the_bits_of_one_without(void)
{
    himc_vec3 tip[2];
    for (int rows = 0; rows < 2; rows++) {
        balance b;
        himc_performance *p = accounted(&b, "patches/improvisation.txt");
        himc_performance_on_tick(p, NULL, NULL);
        himc_performance_on_motion(p, rows ? ignore_row : NULL, NULL);
        session_play(p, 2, NULL);
        tip[rows] = p->body->state.tip[HIMC_LEFT];
        himc_performance_free(p);
    }
    TEST_ASSERT_EQUAL_MEMORY(&tip[0], &tip[1], sizeof tip[0]);
}

/// Forces, impulses and works of contacts, with a row for each step.
typedef struct contact_sums {
    double step;      // (s)
    himc_vec3 body;   // impulse on the bodies' sticks (N s) ...
    himc_vec3 mallet; // ... and on the mallets' mass beyond them
    double impulse;   // as the rows have it (N s)
    himc_energy first, last;
    bool begun;
} contact_sums;

static void add_row(void *user, const himc_motion_row *row)
{
    contact_sums *s = user;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        s->body = himc_vec3_madd(s->body, s->step, row->tip_force[hand]);
        s->mallet = himc_vec3_madd(s->mallet, s->step, row->mallet_force[hand]);
        s->impulse += row->impulse[hand];
    }
    if (!s->begun)
        s->first = row->energy;
    s->begun = true;
    s->last = row->energy;
}

// work of the heads on both hands' sticks and mallets (J)
static double work_of_heads(const himc_energy *e)
{
    return e->contact[HIMC_LEFT] + e->contact[HIMC_RIGHT] + e->mallet[HIMC_LEFT] +
           e->mallet[HIMC_RIGHT];
}

static double held_by_heads(const himc_energy *e)
{
    return e->felt[HIMC_LEFT] + e->felt[HIMC_RIGHT] + e->heads + e->lost;
}

// The body feels the share of the head's force that moves its own stick; a drum's mallet has more
// or less mass. With that mass the sums close, to the rounding of forces and to the step of works.
static void test_forces_and_works_of_a_contact_add_up_with_any_mallet(void)
{
    static const char *const mallet[] = {"soft", "medium", "hard", "wood"};
    for (int k = 0; k < 4; k++) {
        contact_sums s = {.step = 1 / 2000.0};
        char line[200];
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        session_do(p, "rate physics 2000");
        session_do(p, "rate task 2000");
        session_do(p, "kettle mallet %s", mallet[k]);
        session_do(p, "stroke 1 right accent f");
        session_do(p, "stroke 2 left tenuto mf");
        himc_performance_on_motion(p, add_row, &s);
        session_do(p, "play");
        session_play(p, 2, NULL);
        himc_performance_free(p);
        double all = himc_vec3_length(himc_vec3_add(s.body, s.mallet)), body = s.body.z;
        double given = held_by_heads(&s.last) - held_by_heads(&s.first);
        double work = work_of_heads(&s.last) - work_of_heads(&s.first);
        double own = s.last.contact[HIMC_LEFT] + s.last.contact[HIMC_RIGHT];
        snprintf(line, sizeof line, "%s: impulse %.6g of %.6g N s, body %.6g; work %.6g of %.6g J",
                 mallet[k], all, s.impulse, body, work, -given);
        TEST_ASSERT_TRUE_MESSAGE(s.impulse > 0.1 && given > 0.01, line);
        TEST_ASSERT_TRUE_MESSAGE(fabs(all - s.impulse) < 1e-9 * s.impulse, line);
        TEST_ASSERT_TRUE_MESSAGE(fabs(work + given) < 3e-3 * given, line);
        // the head feels 9 to 12 g, the body moves a stick of 24.5
        TEST_ASSERT_TRUE_MESSAGE(body > 1.9 * s.impulse && -own > 1.9 * given, line);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_balance_of_the_improvisation_closes);
    RUN_TEST(test_the_balance_of_a_disturbed_piece_closes);
    RUN_TEST(test_the_balance_of_a_pushed_take_closes_under_the_printed_law_and_ode);
    RUN_TEST(test_inverse_kinematics_has_no_forces_on_the_body);
    RUN_TEST(test_forces_and_works_of_a_contact_add_up_with_any_mallet);
    RUN_TEST(test_a_piece_with_rows_has_the_bits_of_one_without);
    return UNITY_END();
}
