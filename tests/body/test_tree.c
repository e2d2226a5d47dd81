/// test_tree.c: the tree solve against ODE's dWorldStep, its oracle.
///
/// Two characters of one random skeleton (lengths, masses, inertias, joints, centres of mass) begin
/// in one random state, one by each engine. In each step both have the same torques, pushes and
/// blows on the tips; after 1000 steps all numbers of their states differ by rounding. The roll of
/// a stick counts at its surface: about that axis it has 1e-6 kg m^2, so a rounding of 1e-14 N m
/// moves it. With HIMC_LONG (make test-long) 1000 cases, else a few.
#include "body/character.h"
#include "body/dynamics.h"
#include "performance/performance_state.h"

#include "session.h"
#include "bodies.h"
#include "step_with_tips.h"

#define STEPS 1000
#define STEP 1e-4     // of the default physics rate (s)
#define AGREED 1e-10  // of each number, over itself where it is above 1
#define BRAKE 50.0    // of relative spins (1/s)
#define BLOW_STEPS 80 // length of a blow, as a contact's

typedef struct twins {
    himc_character *tree, *ode;
} twins;

static void twins_new(twins *t, const himc_body_state *start)
{
    t->tree = himc_character_new(&skeleton, &error);
    t->ode = himc_character_new(&skeleton, &error);
    TEST_ASSERT_TRUE_MESSAGE(t->tree && t->ode, error.text);
    himc_character_use(t->ode, HIMC_ENGINE_ODE);
    himc_character_place(t->tree, start);
    himc_character_place(t->ode, start);
}

static void twins_free(twins *t)
{
    himc_character_free(t->tree);
    himc_character_free(t->ode);
}

static double random_factor(double most)
{
    return 1 + random_vector(most).x;
}

static himc_vec3 change(himc_vec3 v, double most)
{
    himc_vec3 r = random_vector(most);
    return himc_vec3_make(v.x * (1 + r.x), v.y * (1 + r.y), v.z * (1 + r.z));
}

// another tree: nothing in it is symmetric, no centre of mass lies on its segment's axis
static void random_skeleton(unsigned seed)
{
    default_skeleton(seed);
    himc_skeleton_config config = himc_skeleton_default();
    config.height *= random_factor(0.2);
    config.mass *= random_factor(0.4);
    TEST_ASSERT_TRUE_MESSAGE(himc_skeleton_init(&skeleton, &config, &error), error.text);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_segment *s = &skeleton.segment[i];
        double factor = random_factor(0.5);
        s->mass *= factor;
        s->inertia = change(himc_vec3_scale(s->inertia, factor), 0.15);
        s->origin = himc_vec3_add(change(s->origin, 0.3), random_vector(0.01));
        s->center = himc_vec3_add(change(s->center, 0.3), random_vector(0.005));
    }
}

typedef struct blow {
    himc_vec3 force;
    int start; // step
} blow;

/// What moves a case beside gravity.
typedef struct moves {
    himc_vec3 wanted[HIMC_JOINTS], torque[HIMC_JOINTS], push;
    int pushed;
    blow blow[HIMC_HANDS];
} moves;

// torques for wanted accelerations and a brake, else light limbs whirl
static void random_moves(const himc_body_state *s, int n, moves *m)
{
    himc_vec3 relative[HIMC_JOINTS];
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (n % 50 == 0)
            m->wanted[j] = random_vector(30);
        himc_vec3 spin = himc_vec3_sub(s->spin[j + 1], s->spin[skeleton.segment[j + 1].parent]);
        relative[j] = himc_vec3_madd(m->wanted[j], -BRAKE, spin);
    }
    himc_inverse_dynamics(&skeleton, s, relative, false, m->torque);
    if (n % 200 == 0) {
        m->pushed = 1 + rand() % (HIMC_SEGMENTS - 1);
        m->push = random_vector(20 * skeleton.segment[m->pushed].mass);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            m->blow[hand] = (blow){random_vector(10), n + rand() % (200 - BLOW_STEPS)};
    }
}

static void move(himc_character *c, const moves *m, int n, double h)
{
    himc_vec3 force[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double part = (double)(n - m->blow[hand].start) / BLOW_STEPS;
        bool on = part > 0 && part < 1;
        force[hand] = himc_vec3_scale(m->blow[hand].force, on ? sin(HIMC_PI * part) : 0);
    }
    world_contact contact[] = {
        {.segment = m->pushed, .at = himc_vec3_make(0, 0.01, -0.1), .force = m->push},
        himc_tip_contact(&skeleton, HIMC_LEFT, force[HIMC_LEFT], NULL),
        himc_tip_contact(&skeleton, HIMC_RIGHT, force[HIMC_RIGHT], NULL),
    };
    TEST_ASSERT_TRUE(himc_character_step(c, m->torque, contact, 3, h));
}

// a stick's spin with the part about the line from grip to centre of mass, its lightest axis, as
// the speed of its surface (m/s)
static void roll_as_speed(himc_body_state *s)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int i = himc_stick_segment((himc_hand)hand);
        himc_vec3 axis =
            himc_mat3_apply(&s->rotation[i], himc_vec3_unit(skeleton.segment[i].center));
        double roll = himc_vec3_dot(axis, s->spin[i]);
        s->spin[i] = himc_vec3_madd(s->spin[i], -(1 - skeleton.segment[i].radius) * roll, axis);
    }
}

static double difference(const twins *t)
{
    himc_body_state a, b;
    himc_character_observe(t->tree, &a);
    himc_character_observe(t->ode, &b);
    roll_as_speed(&a);
    roll_as_speed(&b);
    const double *x = (const double *)&a, *y = (const double *)&b;
    double worst = 0;
    for (size_t i = 0; i < sizeof a / sizeof *x; i++)
        worst = fmax(worst, fabs(x[i] - y[i]) / fmax(1, fabs(y[i])));
    TEST_ASSERT_TRUE(himc_body_state_finite(&a));
    return worst;
}

static double play_case(unsigned seed, double h)
{
    twins t;
    himc_body_state s;
    moves m = {.pushed = 0};
    random_skeleton(seed);
    random_state(&s, 2);
    twins_new(&t, &s);
    for (int n = 0; n < STEPS; n++) {
        himc_character_observe(t.tree, &s);
        random_moves(&s, n, &m);
        move(t.tree, &m, n, h);
        move(t.ode, &m, n, h);
    }
    double worst = difference(&t);
    twins_free(&t);
    return worst;
}

static void test_tree_makes_the_motion_of_dworldstep_on_random_trees(void)
{
    int cases = getenv("HIMC_LONG") ? 1000 : 40;
    double worst = 0;
    for (int i = 0; i < cases; i++) {
        char what[64];
        double away = play_case(1000 + (unsigned)i, STEP);
        snprintf(what, sizeof what, "case %d: %.3g", i, away);
        TEST_ASSERT_TRUE_MESSAGE(away <= AGREED, what);
        worst = fmax(worst, away);
    }
    printf("%d cases: at most %.3g\n", cases, worst);
}

// the gyroscopic moment decides the motion of a body that spins
static void test_tree_has_the_implicit_gyroscopic_moment_of_dworldstep(void)
{
    twins t;
    himc_body_state s;
    himc_pose pose = himc_pose_zero();
    himc_vec3 rate[HIMC_JOINTS] = {{0, 0, 0}}, torque[HIMC_JOINTS] = {{0, 0, 0}};
    default_skeleton(1);
    rate[HIMC_HEAD - 1] = himc_vec3_make(20, 30, 100);
    rate[HIMC_LEFT_STICK - 1] = himc_vec3_make(5, 3, 200);
    himc_pose_to_state(&skeleton, &pose, rate, &s);
    twins_new(&t, &s);
    for (int n = 0; n < 200; n++) {
        himc_character_step(t.tree, torque, NULL, 0, STEP);
        himc_character_step(t.ode, torque, NULL, 0, STEP);
    }
    TEST_ASSERT_TRUE(difference(&t) <= AGREED);
    himc_character_observe(t.ode, &s); // the spin has moved the axis
    TEST_ASSERT_TRUE(fabs(s.spin[HIMC_HEAD].x - 20) > 1);
    twins_free(&t);
}

static void test_a_body_taken_apart_comes_together_as_by_dworldstep(void)
{
    twins t;
    himc_body_state s;
    himc_vec3 torque[HIMC_JOINTS] = {{0, 0, 0}}, hard[HIMC_HANDS];
    random_skeleton(3);
    random_state(&s, 200); // a few steps of 10 ms open the joints
    twins_new(&t, &s);
    hard[0] = random_vector(30);
    hard[1] = random_vector(30);
    for (int n = 0; n < 20; n++) {
        step_with_tips(t.tree, &skeleton, torque, hard, n < 3 ? 0.01 : STEP);
        step_with_tips(t.ode, &skeleton, torque, hard, n < 3 ? 0.01 : STEP);
    }
    TEST_ASSERT_TRUE(difference(&t) <= 1e-8); // spins of hundreds of rad/s
    twins_free(&t);
}

static void test_engines_can_change_in_the_middle_of_a_motion(void)
{
    twins t;
    himc_body_state s;
    moves m = {.pushed = 0};
    random_skeleton(4);
    random_state(&s, 2);
    twins_new(&t, &s);
    for (int n = 0; n < STEPS; n++) {
        himc_character_observe(t.ode, &s);
        random_moves(&s, n, &m);
        himc_character_use(t.tree, n / 37 % 2 ? HIMC_ENGINE_ODE : HIMC_ENGINE_TREE);
        move(t.tree, &m, n, STEP);
        move(t.ode, &m, n, STEP);
    }
    TEST_ASSERT_TRUE(difference(&t) <= AGREED);
    twins_free(&t);
}

static void listen(void *user, const char *line)
{
    strncat(user, line, 200);
}

static void test_another_body_keeps_the_engine(void)
{
    char info[8192] = "";
    himc_performance *p = session_new();
    session_do(p, "engine ode");
    session_do(p, "player 1.9 90");
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, listen, info);
    TEST_ASSERT_NOT_NULL(strstr(info, "engine ode"));
    TEST_ASSERT_EQUAL_INT(HIMC_ENGINE_ODE, himc_character_engine(p->body->character));
    session_do(p, "reset");
    TEST_ASSERT_EQUAL_INT(HIMC_ENGINE_TREE, himc_character_engine(p->body->character));
    himc_performance_free(p);
}

// a body built anew, with other bytes between the fields of its segments
static bool shares(himc_performance *p)
{
    body_parts parts;
    TEST_ASSERT_TRUE_MESSAGE(himc_body_make_parts(&parts, &p->settings, &error), error.text);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        memset(&parts.plant.segment[i].parent + 1, 0x55,
               offsetof(himc_segment, mass) - sizeof(int));
    himc_body_adopt(p->body, &parts);
    return p->body->shares;
}

static void test_the_controller_shares_a_body_of_its_own_weights(void)
{
    himc_performance *p = session_new();
    TEST_ASSERT_TRUE(shares(p));
    p->settings.weight[HIMC_RIGHT_HAND] = 1.1;
    TEST_ASSERT_FALSE(shares(p));
    himc_performance_free(p);
}

typedef struct tips {
    himc_vec3 at[2000][HIMC_HANDS];
    int rows;
} tips;

static void keep_tips(void *user, const himc_motion_row *row)
{
    tips *t = user;
    memcpy(t->at[t->rows++ % 2000], row->tip, sizeof row->tip);
}

static void play_piece(const char *engine, const char *law, tips *t, heard *h)
{
    himc_performance *p = session_new();
    t->rows = 0;
    session_do(p, "drum kettle");
    session_do(p, "engine %s", engine);
    session_do(p, "law %s", law);
    session_do(p, "score patches/improvisation.txt");
    session_do(p, "push left-forearm 10 0 20 0.05");
    himc_performance_on_motion(p, keep_tips, t);
    session_do(p, "play");
    session_play(p, 4, h);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    himc_performance_free(p);
}

// strokes, contacts, a push and the laws of control close the loop around both engines
static void test_a_piece_is_the_same_by_both_engines(void)
{
    static const char *const laws[] = {"computed-torque", "feedforward"};
    static tips a, b;
    for (int l = 0; l < 2; l++) {
        heard x = {0}, y = {0};
        play_piece("tree", laws[l], &a, &x);
        play_piece("ode", laws[l], &b, &y);
        TEST_ASSERT_EQUAL_INT(x.strikes, y.strikes);
        TEST_ASSERT_TRUE(x.strikes >= 5 && a.rows == b.rows && a.rows < 2000);
        for (int i = 0; i < x.strikes; i++) {
            TEST_ASSERT_EQUAL_DOUBLE(y.strike[i].time, x.strike[i].time);
            TEST_ASSERT_DOUBLE_WITHIN(1e-7 * y.strike[i].force, y.strike[i].force,
                                      x.strike[i].force);
        }
        for (int i = 0; i < a.rows; i++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                TEST_ASSERT_DOUBLE_WITHIN(
                    1e-9, 0, himc_vec3_length(himc_vec3_sub(a.at[i][hand], b.at[i][hand])));
        heard_free(&x);
        heard_free(&y);
    }
}

typedef struct leg_rows {
    himc_vec3 joint[2000][HIMC_SEGMENTS - HIMC_LEGS];
    int rows;
} leg_rows;

static void keep_legs(void *user, const himc_motion_row *row)
{
    leg_rows *l = user;
    memcpy(l->joint[l->rows++ % 2000], &row->joint[HIMC_LEGS - 1], sizeof l->joint[0]);
}

// the right hand plays while the left knee is kicked at 1.5 s
static void play_kick(const char *engine, leg_rows *l)
{
    himc_performance *p = session_new();
    l->rows = 0;
    session_do(p, "engine %s", engine);
    session_do(p, "drum kettle");
    session_do(p, "stroke 1 right accent f");
    session_do(p, "play");
    himc_performance_on_motion(p, keep_legs, l);
    session_play(p, 1.5, NULL);
    session_do(p, "push left-lower-leg 200 60 0 0.05");
    session_play(p, 1.5, NULL);
    himc_performance_free(p);
}

// rows in which the legs have the bits of the row before
static int rows_at_rest(const leg_rows *l, int from, int to)
{
    int equal = 0;
    for (int i = from + 1; i < to; i++)
        equal += memcmp(l->joint[i], l->joint[i - 1], sizeof l->joint[i]) == 0;
    return equal;
}

static double farthest(const leg_rows *a, int i, const leg_rows *b, int k)
{
    double most = 0;
    for (int j = 0; j < HIMC_SEGMENTS - HIMC_LEGS; j++)
        most = fmax(most,
                    himc_vec3_length(himc_vec3_sub(a->joint[i % 2000][j], b->joint[k % 2000][j])));
    return most;
}

static void test_legs_at_rest_are_not_computed_and_wake_as_if_they_had_been(void)
{
    static leg_rows tree, ode;
    double apart = 0, moved = 0;
    play_kick("tree", &tree);
    play_kick("ode", &ode);
    TEST_ASSERT_EQUAL_INT(ode.rows, tree.rows);
    TEST_ASSERT_EQUAL_INT(750, tree.rows); // 250 a second
    for (int i = 0; i < tree.rows; i++) {
        apart = fmax(apart, farthest(&tree, i, &ode, i));
        moved = fmax(moved, farthest(&tree, i, &tree, 0));
    }
    TEST_ASSERT_TRUE(apart <= AGREED);
    TEST_ASSERT_TRUE(moved > 0.01);
    TEST_ASSERT_EQUAL_INT(349, rows_at_rest(&tree, 20, 370));
    TEST_ASSERT_EQUAL_INT(0, rows_at_rest(&tree, 376, 420));
    TEST_ASSERT_EQUAL_INT(99, rows_at_rest(&tree, 650, 750));
    TEST_ASSERT_TRUE(rows_at_rest(&ode, 20, 370) < 300); // its rounding goes on
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tree_makes_the_motion_of_dworldstep_on_random_trees);
    RUN_TEST(test_tree_has_the_implicit_gyroscopic_moment_of_dworldstep);
    RUN_TEST(test_a_body_taken_apart_comes_together_as_by_dworldstep);
    RUN_TEST(test_engines_can_change_in_the_middle_of_a_motion);
    RUN_TEST(test_another_body_keeps_the_engine);
    RUN_TEST(test_the_controller_shares_a_body_of_its_own_weights);
    RUN_TEST(test_a_piece_is_the_same_by_both_engines);
    RUN_TEST(test_legs_at_rest_are_not_computed_and_wake_as_if_they_had_been);
    return UNITY_END();
}
