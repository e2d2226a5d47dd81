/// test_seated.c: a player whose pelvis is free sits: he plays as one who is bolted, gives way to
/// pushes and comes back, stays where he sits, and if he falls is put back.
#include "session.h"

#include "performance/performance_state.h"
#include "performance/research.h"

#include <math.h>

/// Of the rows after the first half second.
typedef struct seen {
    long rows;
    himc_vec3 begun, last;        // place of the pelvis (m)
    double moved, tilt;           // largest (m, rad)
    double lowest, highest;       // of the pelvis (m)
    double foot[HIMC_HANDS];      // sums of the floor's forces up (N)
    double weight;                // ... and of all
    double friction;              // largest in a row
    double gap;                   // of the energy's balance, largest (J)
    double energy, work, largest; // at the first row; most work since (J)
    double apart;                 // of the force on the body from theirs, most in a row (N)
} seen;

static double work_of(const himc_energy *e)
{
    double sum = e->push + e->support + e->placed + e->numerical;
    for (int j = 0; j < HIMC_JOINTS; j++)
        sum += e->joint[j];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        sum += e->contact[hand];
    return sum;
}

static void see(void *user, const himc_motion_row *row)
{
    seen *s = user;
    double energy = row->energy.kinetic + row->energy.potential, work = work_of(&row->energy);
    himc_vec3 parts = row->seat_force;
    if (s->rows++ == 0) {
        s->begun = row->segment[HIMC_PELVIS];
        s->energy = energy;
        s->work = work;
        s->lowest = s->highest = s->begun.z;
    }
    s->largest = fmax(s->largest, fabs(work - s->work));
    s->gap = fmax(s->gap, fabs(energy - s->energy - (work - s->work)));
    s->last = row->segment[HIMC_PELVIS];
    s->lowest = fmin(s->lowest, s->last.z);
    s->highest = fmax(s->highest, s->last.z);
    s->moved = fmax(s->moved, himc_vec3_length(himc_vec3_sub(s->last, s->begun)));
    s->tilt = fmax(s->tilt, himc_vec3_length(himc_quat_log(row->orientation[HIMC_PELVIS])));
    s->friction = fmax(s->friction, row->root_friction);
    for (int i = 0; i < HIMC_HANDS; i++) {
        s->foot[i] += row->foot_force[i].z;
        parts = himc_vec3_add(parts, row->foot_force[i]);
    }
    s->weight += parts.z;
    s->apart = fmax(s->apart, himc_vec3_length(himc_vec3_sub(parts, row->root_force)));
}

static himc_performance *seated(const char *more)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "stance seated");
    if (more)
        session_do(p, "%s", more);
    return p;
}

static seen play(himc_performance *p, double seconds, heard *h)
{
    seen s = {.rows = 0};
    session_do(p, "play");
    session_play(p, 0.5, h);
    himc_performance_on_motion(p, see, &s);
    session_play(p, seconds - 0.5, h);
    himc_performance_on_motion(p, NULL, NULL);
    return s;
}

static void test_he_plays_as_one_who_is_bolted_and_stays(void)
{
    himc_performance *p = seated(NULL);
    session_strokes(p, 24, "ff");
    seen s = play(p, 9, NULL);
    himc_performance_stats stats = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(24, stats.strokes);
    TEST_ASSERT_EQUAL_INT(24, stats.played);
    TEST_ASSERT_EQUAL_INT(0, stats.recoveries);
    TEST_ASSERT_TRUE(stats.tip_rms < 5e-5);
    TEST_ASSERT_TRUE(s.moved > 1e-4 && s.moved < 0.010); // he gives way, a little
    TEST_ASSERT_TRUE(s.tilt > 1e-3 && s.tilt < 0.05);
    double feet = (s.foot[HIMC_LEFT] + s.foot[HIMC_RIGHT]) / s.weight;
    TEST_ASSERT_TRUE(feet > 0.15 && feet < 0.35);
    TEST_ASSERT_TRUE(s.friction < 0.5);
    himc_performance_free(p);
}

static void compare(void *user, const himc_tick *tick)
{
    const himc_motion_row *row = tick->row;
    const himc_support_forces *s = tick->support;
    double *apart = user;
    *apart = fmax(*apart, himc_vec3_length(himc_vec3_sub(s->seat, row->seat_force)));
    *apart = fmax(*apart, himc_vec3_length(himc_vec3_sub(s->center, row->root_center)));
    for (int i = 0; i < HIMC_HANDS; i++)
        *apart = fmax(*apart, himc_vec3_length(himc_vec3_sub(s->foot[i], row->foot_force[i])));
}

static void test_a_tick_has_the_forces_of_its_row(void)
{
    himc_performance *p = seated("rate physics 2000");
    double apart = 0;
    session_do(p, "rate task 2000");
    session_strokes(p, 4, "f");
    session_do(p, "play");
    session_play(p, 0.5, NULL);
    seen s = {.rows = 0};
    himc_performance_on_motion(p, see, &s);
    session_play(p, 0.01, NULL);
    himc_performance_on_tick(p, compare, &apart);
    session_play(p, 1.5, NULL);
    TEST_ASSERT_TRUE(s.rows > 3000 && apart < 1e-9 * s.weight / (double)s.rows);
    himc_performance_free(p);
}

static void test_seat_and_floor_carry_him(void)
{
    himc_performance *p = seated("rate physics 2000");
    session_strokes(p, 4, "f");
    seen s = play(p, 2, NULL);
    double weight = 0;
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        weight += p->body->plant.segment[i].mass * HIMC_GRAVITY;
    TEST_ASSERT_TRUE(s.apart < 1e-9 * weight);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * weight, weight, s.weight / (double)s.rows);
    TEST_ASSERT_TRUE(s.largest > 1 && s.gap < 1e-11 * s.largest);
    himc_performance_free(p);
}

static double pushed(const char *push, int *played, long *fallen)
{
    himc_performance *p = seated(NULL);
    session_strokes(p, 8, "f");
    if (*push)
        session_do(p, "at 2.2 %s", push);
    seen s = play(p, 4, NULL);
    himc_performance_stats stats = himc_performance_measure(p);
    *played = (int)stats.played;
    *fallen = stats.recoveries;
    himc_performance_free(p);
    return s.moved;
}

static void test_a_push_at_the_chest_from_any_side_is_answered(void)
{
    int played;
    long fallen;
    double still = pushed("", &played, &fallen);
    for (int k = 0; k < 8; k += getenv("HIMC_LONG") ? 1 : 3) {
        char push[80];
        double x = cos(0.25 * HIMC_PI * k), y = sin(0.25 * HIMC_PI * k);
        snprintf(push, sizeof push, "push trunk %.3f %.3f 0 0.2", 20 * x, 20 * y);
        TEST_ASSERT_TRUE(pushed(push, &played, &fallen) < still + 0.010);
        TEST_ASSERT_EQUAL_INT(8, played);
        snprintf(push, sizeof push, "push trunk %.3f %.3f 0 0.2", 60 * x, 60 * y);
        pushed(push, &played, &fallen);
        TEST_ASSERT_EQUAL_INT(0, fallen);
        TEST_ASSERT_EQUAL_INT(8, played);
    }
}

static void test_a_foot_that_is_pushed_down_carries_more(void)
{
    static const char *const side[] = {"left", "right"};
    for (int foot = 0; foot < HIMC_HANDS; foot++) {
        himc_performance *p = seated(NULL);
        session_do(p, "at 1 push %s-foot 0 0 -50 1", side[foot]);
        seen s = play(p, 1.5, NULL);
        double more = (s.foot[foot] - s.foot[!foot]) / (double)s.rows;
        TEST_ASSERT_TRUE(more > 25);
        himc_performance_free(p);
    }
}

static void test_a_harder_push_moves_him_further(void)
{
    int played;
    long fallen;
    double little = pushed("push left-upper-leg 100 0 0 0.1", &played, &fallen);
    double much = pushed("push left-upper-leg 200 0 0 0.1", &played, &fallen);
    TEST_ASSERT_TRUE(much > 1.3 * little);
}

// way of the knee while the leg is pushed (m)
static double yielded(const char *gain)
{
    himc_performance *p = seated(gain);
    session_play(p, 0.5, NULL);
    himc_vec3 begun = p->body->state.origin[HIMC_LEFT_LOWER_LEG];
    session_do(p, "push left-lower-leg 0 100 0 0.2");
    session_play(p, 0.2, NULL);
    himc_vec3 end = p->body->state.origin[HIMC_LEFT_LOWER_LEG];
    himc_performance_free(p);
    return himc_vec3_length(himc_vec3_sub(end, begun));
}

static void test_gains_of_his_legs_act(void)
{
    double usual = yielded(NULL), stiff = yielded("gain left-hip 5000 500");
    printf("%g m, %g m with a stiff hip\n", usual, stiff);
    TEST_ASSERT_TRUE(stiff < 0.5 * usual);
}

static void test_a_pelvis_that_is_free_can_be_pushed(void)
{
    int played;
    long fallen;
    double still = pushed("", &played, &fallen);
    double moved = pushed("push pelvis 200 0 0 0.1", &played, &fallen);
    printf("%g m, %g m without the push\n", moved, still);
    TEST_ASSERT_TRUE(moved > 2 * still);
    TEST_ASSERT_EQUAL_INT(8, played);
    TEST_ASSERT_EQUAL_INT(0, fallen);
    himc_performance *p = seated("stance fixed");
    TEST_ASSERT_FALSE(session_try(p, "push pelvis 60 0 0 0.2"));
    TEST_ASSERT_EQUAL_STRING(
        "push: pelvis: `stance fixed` holds it, expected `stance seated` or `standing`",
        error.text);
    TEST_ASSERT_FALSE(session_try(p, "at 1 push pelvis 60 0 0 0.2"));
    static const char *const text =
        "stance fixed; stance seated; at 1 push pelvis 60 0 0 0.2; stroke 2 left legato f;";
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_load_text(p, text, "text", &error), error.text);
    TEST_ASSERT_TRUE(session_try(p, "push pelvis 60 0 0 0.2"));
    TEST_ASSERT_FALSE(himc_performance_load_text(p, "stance fixed; at 1 push pelvis 60 0 0 0.2;",
                                                 "text", &error));
    himc_performance_free(p);
}

// a cushion, not a spring: a second after he was pulled up he rests
static void test_he_does_not_bounce_on_his_seat(void)
{
    himc_performance *p = seated(NULL);
    session_do(p, "push trunk 0 0 500 0.1");
    seen pushed = play(p, 1.2, NULL), after = play(p, 1.2, NULL);
    TEST_ASSERT_TRUE(pushed.highest - pushed.lowest < 0.01);
    TEST_ASSERT_TRUE(after.highest - after.lowest < 2e-5);
    himc_performance_free(p);
}

static void test_muscles_hold_his_arms_and_he_keeps_his_seat(void)
{
    himc_performance *p = seated("strength human");
    session_strokes(p, 24, "ff");
    seen s = play(p, 14, NULL);
    himc_performance_stats stats = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(0, stats.recoveries);
    TEST_ASSERT_EQUAL_INT(24, stats.played);
    TEST_ASSERT_TRUE(s.moved < 0.010 && s.tilt < 0.05); // no more than without muscles
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(s.last, s.begun)) < 0.003);
    TEST_ASSERT_TRUE(stats.tip_rms < 1.5e-3);
    himc_performance_free(p);
}

static void test_a_fall_is_told_and_the_piece_goes_on(void)
{
    himc_performance *p = seated(NULL);
    heard h = {.strike = NULL};
    session_strokes(p, 16, "mf");
    session_do(p, "at 2 push trunk 1000 0 0 1");
    seen s = play(p, 6, &h);
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(s.last, s.begun)) < 0.1); // on his seat
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(h.all, "the player fell at 1."), h.all);
    TEST_ASSERT_TRUE(himc_performance_measure(p).recoveries > 0);
    TEST_ASSERT_TRUE(h.strikes > 10);
    TEST_ASSERT_TRUE(h.strike[h.strikes - 1].time > 4.5);
    free(h.strike);
    himc_performance_free(p);
}

static void test_both_engines_move_him_alike(void)
{
    himc_vec3 end[2];
    for (int ode = 0; ode < 2; ode++) {
        himc_performance *p = seated(ode ? "engine ode" : NULL);
        session_strokes(p, 4, "f");
        end[ode] = play(p, 2.2, NULL).last;
        himc_performance_free(p);
    }
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(end[0], end[1])) < 1e-9);
}

static void test_other_laws_and_modes_sit_too(void)
{
    static const char *const settings[] = {"law printed", "law feedforward", "mode id",
                                           "rate physics 2000"};
    for (int k = 0; k < 4; k++) {
        himc_performance *p = seated(settings[k]);
        session_strokes(p, 6, "mf");
        seen s = play(p, 4, NULL);
        TEST_ASSERT_TRUE_MESSAGE(s.moved < 0.02 && s.tilt < 0.1, settings[k]);
        TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
        himc_performance_free(p);
    }
}

static void test_he_sits_on_a_high_stool_too(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "stance seated");
    double usual = p->body->plant.segment[HIMC_PELVIS].origin.z;
    session_do(p, "kettle place 0.4 0 1.3");
    session_strokes(p, 4, "mf");
    seen s = play(p, 3, NULL);
    TEST_ASSERT_TRUE(p->body->plant.segment[HIMC_PELVIS].origin.z > usual + 0.1);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    TEST_ASSERT_TRUE(s.moved < 0.02);
    himc_performance_free(p);
}

static void test_fixed_is_bolted_again(void)
{
    himc_performance *p = seated("stance fixed");
    session_strokes(p, 4, "f");
    seen s = play(p, 2, NULL);
    TEST_ASSERT_TRUE(s.moved == 0 && s.tilt == 0 && (s.foot[HIMC_LEFT] + s.foot[HIMC_RIGHT]) == 0 &&
                     s.weight == 0);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_he_plays_as_one_who_is_bolted_and_stays);
    RUN_TEST(test_seat_and_floor_carry_him);
    RUN_TEST(test_a_tick_has_the_forces_of_its_row);
    RUN_TEST(test_a_push_at_the_chest_from_any_side_is_answered);
    RUN_TEST(test_a_foot_that_is_pushed_down_carries_more);
    RUN_TEST(test_a_harder_push_moves_him_further);
    RUN_TEST(test_gains_of_his_legs_act);
    RUN_TEST(test_a_pelvis_that_is_free_can_be_pushed);
    RUN_TEST(test_he_does_not_bounce_on_his_seat);
    RUN_TEST(test_muscles_hold_his_arms_and_he_keeps_his_seat);
    RUN_TEST(test_a_fall_is_told_and_the_piece_goes_on);
    RUN_TEST(test_both_engines_move_him_alike);
    RUN_TEST(test_other_laws_and_modes_sit_too);
    RUN_TEST(test_he_sits_on_a_high_stool_too);
    RUN_TEST(test_fixed_is_bolted_again);
    return UNITY_END();
}
