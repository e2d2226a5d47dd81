/// test_standing.c: a player on his feet: he plays as one who is bolted, is pushed and comes back,
/// and if he falls is put back.
#include "session.h"

#include "performance/performance_state.h"

#include <math.h>
#include <string.h>

/// Of the rows after the first half second.
typedef struct seen {
    long rows;
    himc_vec3 begun, last; // place of the pelvis (m)
    double moved;          // largest way from there (m)
    double seat;           // largest force of a seat (N)
    double weight;         // sum of the floor's forces up (N)
    double outside;        // centre of pressure from the middle of the ankles, largest aside (m)
    double behind, ahead;  // ... and on the floor from heel to toe, largest (m)
    himc_vec3 stood[HIMC_HANDS]; // the ankles at first (m)
    double slid;                 // their largest way from there (m)
} seen;

static void see(void *user, const himc_motion_row *row)
{
    seen *s = user;
    himc_vec3 ankles = himc_vec3_scale(
        himc_vec3_add(row->segment[HIMC_LEFT_FOOT], row->segment[HIMC_RIGHT_FOOT]), 0.5);
    s->last = row->segment[HIMC_PELVIS];
    if (s->rows++ == 0) {
        s->begun = s->last;
        memcpy(s->stood, &row->segment[HIMC_LEFT_FOOT], sizeof s->stood);
    }
    s->moved = fmax(s->moved, himc_vec3_length(himc_vec3_sub(s->last, s->begun)));
    s->seat = fmax(s->seat, himc_vec3_length(row->seat_force));
    for (int i = 0; i < HIMC_HANDS; i++) {
        s->weight += row->foot_force[i].z;
        himc_vec3 way = himc_vec3_sub(row->segment[HIMC_LEFT_FOOT + i], s->stood[i]);
        s->slid = fmax(s->slid, himc_vec3_length(way));
    }
    s->behind = fmax(s->behind, ankles.x - row->root_center.x);
    s->ahead = fmax(s->ahead, row->root_center.x - ankles.x);
    TEST_ASSERT_FALSE(fabs(row->root_center.z) >= 0.01); // NaN while nothing presses
    s->outside = fmax(s->outside, fabs(row->root_center.y - ankles.y));
}

static himc_performance *standing(const char *more, int count, const char *dynamic)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "stance standing");
    session_do(p, "%s", more);
    session_strokes(p, count, dynamic);
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

static void check_playing(const char *more)
{
    himc_performance *p = standing(more, 24, "f");
    seen s = play(p, 14, NULL);
    himc_performance_stats stats = himc_performance_measure(p);
    double weight = 0;
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        weight += p->body->plant.segment[i].mass * HIMC_GRAVITY;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, stats.recoveries, more);
    TEST_ASSERT_EQUAL_INT_MESSAGE(24, stats.played, more);
    TEST_ASSERT_TRUE(stats.tip_rms < 1e-3);
    TEST_ASSERT_TRUE(s.moved > 1e-3 && s.moved < 0.080); // he sways
    TEST_ASSERT_TRUE(s.seat == 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * weight, weight, s.weight / (double)s.rows);
    TEST_ASSERT_TRUE(s.outside < 0.2); // within the feet, see support.c
    TEST_ASSERT_TRUE(s.behind < 0.055 && s.ahead < 0.15);
    himc_performance_free(p);
}

static void test_he_stands_and_plays(void)
{
    check_playing("strength human");
    check_playing("strength off");
}

static void test_the_small_and_the_tall_stand(void)
{
    check_playing("player 1.5 50");
    check_playing("player 1.95 100");
}

static void test_he_stands_higher_than_he_sits(void)
{
    himc_performance *p = standing("strength human", 0, "f");
    double stands = p->body->plant.segment[HIMC_PELVIS].origin.z;
    session_do(p, "stance seated");
    TEST_ASSERT_TRUE(stands > p->body->plant.segment[HIMC_PELVIS].origin.z + 0.1);
    session_do(p, "stance standing");
    TEST_ASSERT_EQUAL_DOUBLE(stands, p->body->plant.segment[HIMC_PELVIS].origin.z);
    himc_performance_free(p);
}

static void test_he_leans_to_the_middle_of_the_head(void)
{
    himc_performance *p = standing("strength human", 0, "f");
    for (int i = 0; i < 6; i++)
        session_do(p, "stroke %d %s legato f center", 2 + i, i % 2 ? "left" : "right");
    seen s = play(p, 6, NULL);
    TEST_ASSERT_EQUAL_INT(6, himc_performance_measure(p).played);
    TEST_ASSERT_TRUE(fabs(s.last.x) < 0.02); // his hips stay
    himc_performance_free(p);
}

// four drums in a wide arc, played crosswise, loud and soft; mirrored: the other way round
static seen play_four(bool mirrored)
{
    static const char *const dynamic[] = {"ff", "p", "mf", "f", "pp"};
    himc_performance *p = session_new();
    for (int i = 0; i < 4; i++) {
        double azimuth = (mirrored ? -1 : 1) * (1.5 - i) * 0.6;
        session_do(p, "drum d%d 26", i);
        session_do(p, "d%d place %.17g %.17g 0.85", i, 0.85 * cos(azimuth), 0.85 * sin(azimuth));
    }
    session_do(p, "stance standing");
    session_do(p, "strength human");
    for (int i = 0; i < 40; i++)
        session_do(p, "stroke %g %s legato %s normal d%d", 1 + 0.75 * i,
                   (i % 2 == 0) == mirrored ? "left" : "right", dynamic[i % 5],
                   (i % 2 ? 0 : 2) + i / 3 % 2);
    seen s = play(p, 19, NULL);
    himc_performance_stats stats = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(0, stats.recoveries);
    TEST_ASSERT_EQUAL_INT(40, stats.played);
    himc_performance_free(p);
    return s;
}

static void test_he_plays_four_drums_and_mirrored_is_mirrored(void)
{
    seen left = play_four(false), right = play_four(true);
    TEST_ASSERT_TRUE(left.slid < 0.02);
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(left.stood[0], left.stood[1])) > 0.25);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * left.moved, left.moved, right.moved);
}

// five timpani in a half circle of 2 m; at 5.45 and 8.75 an arm is nearly straight
static void test_arms_at_the_end_of_their_reach_do_not_throw_him(void)
{
    static const char *const stroke[] = {
        "1.7 right staccato ff normal d2", "2 left legato mf normal d2",
        "2.3 right accent p normal d2",    "3.05 left accent mf normal d1",
        "3.5 right accent ff normal d2",   "4.25 left legato p normal d1",
        "4.85 right legato mf normal d2",  "5.45 left tenuto ff normal d2",
        "5.9 right legato ff normal d1",   "6.5 left legato ff normal d1",
        "6.95 right accent ff normal d0",  "7.55 left tenuto p normal d0",
        "8.15 right tenuto mf normal d1",  "8.75 left legato ff normal d2",
        "9.35 right legato f normal d1"};
    enum { STROKES = sizeof stroke / sizeof *stroke };
    himc_performance *p = session_new();
    for (int i = 0; i < 5; i++) {
        session_do(p, "drum d%d %d", i, 32 - 3 * i);
        session_do(p, "d%d place %.17g %.17g 0.85", i, sin(i * HIMC_PI / 4), cos(i * HIMC_PI / 4));
    }
    session_do(p, "stance standing");
    session_do(p, "strength human");
    session_do(p, "tempo 60");
    for (int i = 0; i < STROKES; i++)
        session_do(p, "stroke %s", stroke[i]);
    play(p, 12, NULL);
    himc_performance_stats stats = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(0, stats.recoveries);
    TEST_ASSERT_TRUE(stats.played >= STROKES - 1); // the last far one lands 20 mm off
    TEST_ASSERT_TRUE(stats.tip_rms < 3e-3);
    himc_performance_free(p);
}

// a large drum near him: behind its spot is his face
static void test_a_loud_stroke_near_his_body_lands(void)
{
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "drum low 29");
    session_do(p, "low place 0.3 0.55 0.85");
    session_do(p, "drum mid 26");
    session_do(p, "mid place 0.5 -0.1 0.85");
    session_do(p, "stance standing");
    session_do(p, "strength human");
    session_do(p, "tempo 112");
    session_do(p, "stroke 0 left vertical-accent fff mid");
    session_do(p, "stroke 4 left legato mf mid");
    play(p, 5, &h);
    himc_performance_stats stats = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_STRING("", h.all);
    TEST_ASSERT_EQUAL_INT(2, stats.played);
    TEST_ASSERT_TRUE(stats.tip_rms < 5e-3);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_he_is_quiet_after_a_loud_stroke(void)
{
    himc_performance *p = standing("stroke 0 right accent fff", 0, "f");
    seen loud = play(p, 20, NULL), late = {.rows = 0};
    himc_performance_on_motion(p, see, &late);
    session_play(p, 30, NULL);
    TEST_ASSERT_TRUE(loud.moved > 0.002);
    TEST_ASSERT_TRUE(late.moved < 0.002);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    himc_performance_free(p);
}

static seen pushed(double x, double y)
{
    himc_performance *p = standing("strength human", 8, "f");
    session_do(p, "at 2.2 push trunk %g %g 0 0.2", x, y);
    seen s = play(p, 6, NULL);
    himc_performance_stats stats = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(0, stats.recoveries);
    TEST_ASSERT_EQUAL_INT(8, stats.played);
    himc_performance_free(p);
    return s;
}

static void test_a_push_from_any_side_is_answered(void)
{
    seen still = pushed(0, 0);
    for (int k = 0; k < 8; k += getenv("HIMC_LONG") ? 1 : 3) {
        seen hard = pushed(75 * cos(0.25 * HIMC_PI * k), 75 * sin(0.25 * HIMC_PI * k));
        TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(hard.last, still.last)) < 0.02);
    }
    TEST_ASSERT_TRUE(pushed(0, 80).moved > 1.2 * pushed(0, 40).moved);
}

static void test_a_fall_is_told_and_the_piece_goes_on(void)
{
    himc_performance *p = standing("strength human", 16, "mf");
    heard h = {.strike = NULL};
    session_do(p, "at 2 push trunk 400 0 0 0.5");
    seen s = play(p, 6, &h);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(h.all, "the player fell at 1."), h.all);
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(s.last, s.begun)) < 0.1);
    TEST_ASSERT_TRUE(h.strikes > 10);
    TEST_ASSERT_TRUE(h.strike[h.strikes - 1].time > 4.5);
    free(h.strike);
    himc_performance_free(p);
}

static void test_a_leg_that_is_pushed_to_the_other_makes_him_fall_in_one_piece(void)
{
    himc_performance *p = standing("strength human", 4, "f");
    heard h = {.strike = NULL};
    session_do(p, "at 4 push left-lower-leg 0 -300 100 0.3");
    play(p, 4, &h);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(h.all, "the player fell at"), h.all);
    TEST_ASSERT_NULL_MESSAGE(strstr(h.all, "flew apart"), h.all);
    free(h.strike);
    himc_performance_free(p);
}

static void test_tall_and_low_are_played_with_bent_knees(void)
{
    static const char *const setting[] = {"player 2.2 110", "kettle place 0.65 0 0.65"};
    for (int i = 0; i < 2; i++) {
        himc_performance *p = standing(setting[i], 8, "f");
        play(p, 6, NULL);
        TEST_ASSERT_EQUAL_INT_MESSAGE(8, himc_performance_measure(p).played, setting[i]);
        TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
        himc_performance_free(p);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_he_stands_and_plays);
    RUN_TEST(test_the_small_and_the_tall_stand);
    RUN_TEST(test_he_stands_higher_than_he_sits);
    RUN_TEST(test_he_leans_to_the_middle_of_the_head);
    RUN_TEST(test_he_plays_four_drums_and_mirrored_is_mirrored);
    RUN_TEST(test_arms_at_the_end_of_their_reach_do_not_throw_him);
    RUN_TEST(test_a_loud_stroke_near_his_body_lands);
    RUN_TEST(test_he_is_quiet_after_a_loud_stroke);
    RUN_TEST(test_a_push_from_any_side_is_answered);
    RUN_TEST(test_tall_and_low_are_played_with_bent_knees);
    RUN_TEST(test_a_leg_that_is_pushed_to_the_other_makes_him_fall_in_one_piece);
    RUN_TEST(test_a_fall_is_told_and_the_piece_goes_on);
    return UNITY_END();
}
