/// test_one_body.c: arms and sticks pass neither through each other nor through the body; where
/// nothing is near, nothing changes.
#include "session.h"

#include "performance/performance_state.h"
#include "plan/planner_state.h"

/// Postures that a tick of 4 ms may rehearse: 50 000 a second, what is left of the tick before, and
/// one moment more.
#define MOST_WORK (200 + 16 + 30)

/// In make test-long: all tempi and leaps, and the whole of the tide.
static bool is_long(void)
{
    return getenv("HIMC_LONG") != NULL;
}

/// A simulated body, and its least gap so far.
typedef struct watched {
    himc_performance *p;
    double least; ///< (m)
    const himc_capsule_pair *pair;
    double shell; ///< least gap of a forearm, hand or stick from a drum's shell (m)
    bool avoided; ///< elbows or wrists have been moved
    long work;    ///< of the planner so far ...
    long most;    ///< ... and in one tick, at most
    long beside;  ///< ... and in blocks near contacts ...
    int busy;     ///< ... of which there were so many
    double most_rate, most_torque; ///< of a joint, allowed (rad/s, N m)
    heard heard;
} watched;

/// True if the hand strikes the drum now, or nearly so: its stick may reach over the rim.
static bool strikes(const watched *w, himc_hand hand, int drum)
{
    const planner_hand *h = &w->p->motion->planner->hand[hand];
    double t = (double)himc_performance_time(w->p) / 48000;
    for (int i = 0; i < h->planned_count; i++)
        if (h->planned[i].drum == drum && fabs(h->planned[i].goal.time - t) < 0.25)
            return true;
    return false;
}

/// Gap of the hands' sticks, but their last 15 %, from the shells of drums that they do not strike
/// (m).
static double stick_gap(const watched *w, const himc_capsule *capsule)
{
    double least = INFINITY;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; i < w->p->drums.count; i++) {
            himc_capsule stick = capsule[HIMC_LEFT_STICK + hand];
            stick.b = himc_vec3_madd(stick.b, 0.15, himc_vec3_sub(stick.a, stick.b));
            if (!strikes(w, (himc_hand)hand, i))
                least =
                    fmin(least, himc_capsule_shell(&stick, himc_drums_frame(&w->p->drums, i)).gap);
        }
    return least;
}

/// The capsules of the segments of a state; a stick ends at its mallet's centre.
static void capsules_of(const himc_skeleton *skeleton, const himc_body_state *s,
                        himc_capsule capsule[HIMC_SEGMENTS])
{
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 along = himc_vec3_scale(segment->axis, segment->length);
        bool stick = i == HIMC_LEFT_STICK || i == HIMC_RIGHT_STICK;
        capsule[i].a = s->origin[i];
        capsule[i].b = himc_vec3_add(s->origin[i], himc_mat3_apply(&s->rotation[i], along));
        if (stick)
            capsule[i].b = s->tip[i - HIMC_LEFT_STICK];
        capsule[i].radius = stick ? HIMC_ROD_RADIUS : segment->radius;
    }
}

/// The least gap of all pairs (m), and the pair.
static double capsules_least(const himc_capsule capsule[HIMC_SEGMENTS],
                             const himc_capsule_pair **pair)
{
    double least = INFINITY;
    for (int i = 0; i < HIMC_CAPSULE_PAIRS; i++) {
        const himc_capsule_pair *p = &himc_capsule_pairs[i];
        double gap = himc_capsule_nearest(&capsule[p->part], &capsule[p->other]).gap;
        if (gap < least) {
            least = gap;
            *pair = p;
        }
    }
    return least;
}

static void watch(void *user, const himc_motion_row *row)
{
    watched *w = user;
    himc_capsule capsule[HIMC_SEGMENTS];
    const himc_capsule_pair *pair = NULL;
    (void)row;
    capsules_of(&w->p->body->skeleton, &w->p->body->state, capsule);
    double gap = capsules_least(capsule, &pair);
    if (gap < w->least) {
        w->least = gap;
        w->pair = pair;
    }
    for (int part = HIMC_LEFT_FOREARM; part <= HIMC_RIGHT_HAND; part++)
        for (int i = 0; i < w->p->drums.count; i++) {
            const himc_head_frame *head = himc_drums_frame(&w->p->drums, i);
            w->shell = fmin(w->shell, himc_capsule_shell(&capsule[part], head).gap);
        }
    w->shell = fmin(w->shell, stick_gap(w, capsule));
    for (int i = 0; i < HIMC_AVOIDANCE_PARTS; i++)
        w->avoided = w->avoided || w->p->motion->body.avoidance.goal[i] != 0;
    long work = himc_planner_work(w->p->motion->planner);
    w->most = work - w->work > w->most ? work - w->work : w->most;
    w->work = work;
}

/// Drum a is to the left, b to the right.
static watched begin_score(const char *const *drum, int drums, double tempo)
{
    watched w = {.p = session_new(), .least = INFINITY, .shell = INFINITY};
    w.most_rate = 60;
    w.most_torque = 1000;
    session_do(w.p, "strength off"); // of the plan; some of it no man plays
    for (int i = 0; i < drums; i++) {
        char name[2] = {(char)('a' + i), 0};
        session_do(w.p, "drum %s", name);
        session_drum(w.p, i, drum[i]);
    }
    session_do(w.p, "tempo %g", tempo);
    return w;
}

static void play_score(watched *w, double seconds, int strokes)
{
    char text[120];
    himc_performance_on_motion(w->p, watch, w);
    session_do(w->p, "play");
    session_play(w->p, seconds, &w->heard);
    free(w->heard.strike);
    himc_performance_stats s = himc_performance_measure(w->p);
    if (strokes > 0)
        TEST_ASSERT_EQUAL_INT(strokes, s.played);
    snprintf(text, sizeof text, "%s - %s: %.1f mm, %.0f rad/s, %.0f N m",
             himc_segment_name(w->pair->part), himc_segment_name(w->pair->other), 1e3 * w->least,
             s.peak_rate, s.peak_torque);
    TEST_ASSERT_TRUE_MESSAGE(w->least >= 0, text);
    TEST_ASSERT_TRUE(w->shell >= 0);
    TEST_ASSERT_TRUE(w->most <= MOST_WORK);
    TEST_ASSERT_TRUE(s.tip_rms < 3e-5);
    TEST_ASSERT_TRUE_MESSAGE(s.peak_rate < w->most_rate && s.peak_torque < w->most_torque, text);
    himc_performance_free(w->p);
}

static void test_hands_crossed_over_two_drums_pass_each_other(void)
{
    static const char *const drum[] = {"place 0.55 0.4 0.85", "place 0.55 -0.4 0.85"};
    static const double tempo[] = {55, 70, 50, 60, 65, 75, 80, 85, 90, 95, 100};
    for (int k = 0; k < (is_long() ? 11 : 2); k++) {
        watched w = begin_score(drum, 2, tempo[k]);
        for (int i = 0; i < 6; i++) {
            session_do(w.p, "stroke %g left legato mf normal %s", 1 + 2.0 * i, i % 2 ? "b" : "a");
            session_do(w.p, "stroke %g right legato mf normal %s", 1.5 + 2 * i, i % 2 ? "a" : "b");
        }
        session_do(w.p, "stroke 13 left legato f normal b");
        session_do(w.p, "stroke 13 right legato f normal a");
        play_score(&w, 13.5 * 60 / tempo[k] + 2.5, 14);
        TEST_ASSERT_TRUE(w.avoided);
        TEST_ASSERT_EQUAL_INT(0, w.heard.notes);
    }
}

static const char *const four_drums[] = {"place 0.35 0.75 0.82", "place 0.72 0.30 0.82",
                                         "place 0.72 -0.38 0.82", "place 0.35 -0.80 0.82"};

/// Strokes in turn, left and right, on these drums.
static void add_leaps(const watched *w, double apart, const char *drum)
{
    for (int i = 0; drum[i]; i++)
        session_do(w->p, "stroke %g %s legato mf normal %c", 1 + apart * i,
                   i % 2 ? "right" : "left", drum[i]);
}

static void test_a_stroke_that_would_meet_the_other_arm_goes_to_the_other_hand(void)
{
    watched w = begin_score(four_drums, 4, 60);
    add_leaps(&w, 0.225, "abcdbcbd");
    play_score(&w, 5, 8);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(w.heard.all, "would meet, the left hand plays it"),
                                 w.heard.all);
}

static int choose_third(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (int)((*seed >> 8) % 3);
}

/// Leaps from a seed over four drums, a stroke every 0.225 s: the left hand on three, the right
/// hand on three. None is given up.
static void test_leaps_at_random_are_all_played_and_no_part_meets_another(void)
{
    for (unsigned score = is_long() ? 1 : 13; score <= (is_long() ? 15 : 13); score++) {
        watched w = begin_score(four_drums, 4, 60);
        unsigned seed = score;
        char drum[41] = {0};
        for (int i = 0; i < 40; i++)
            drum[i] = (char)((i % 2 ? 'b' : 'a') + choose_third(&seed));
        add_leaps(&w, 0.225, drum);
        play_score(&w, 12, 40);
    }
}

/// Leaps with a change of tempo and a jump, in blocks of so many samples.
static watched play_in_blocks(int block)
{
    watched w = begin_score(four_drums, 4, 60);
    add_leaps(&w, 0.225, "cdcdaccdccbdbcbd");
    himc_performance_on_motion(w.p, watch, &w);
    session_do(w.p, "play");
    for (int k = 0; k < 144000; k += block) {
        if (k == 72000)
            session_do(w.p, "tempo 75");
        if (k == 96000)
            session_do(w.p, "seek 1.5");
        bool busy = himc_contacts_busy(&w.p->contacts);
        long work = himc_planner_work(w.p->motion->planner);
        himc_performance_process(w.p, block, NULL);
        if (busy && himc_contacts_busy(&w.p->contacts)) {
            w.beside += himc_planner_work(w.p->motion->planner) - work;
            w.busy++;
        }
    }
    return w;
}

static void test_planning_is_spread_over_ticks_and_the_same_in_all_blocks(void)
{
    watched a = play_in_blocks(48), b = play_in_blocks(2400);
    TEST_ASSERT_TRUE(a.most > 100 && a.most <= MOST_WORK);
    // at most 5 a millisecond; mostly there is nothing to look at
    TEST_ASSERT_TRUE(a.busy > 30 && a.beside < 1.5 * a.busy);
    TEST_ASSERT_EQUAL_INT64(a.work, b.work);
    TEST_ASSERT_EQUAL_MEMORY(a.p->body->state.tip, b.p->body->state.tip,
                             sizeof a.p->body->state.tip);
    himc_performance_free(a.p);
    himc_performance_free(b.p);
}

/// Both hands at once on the other's side: no way is free, so one of two is left out.
static void test_a_stroke_that_no_hand_has_room_for_is_left_out_and_told(void)
{
    static const char *const drum[] = {"place 0.35 0.75 0.82", "place 0.35 -0.80 0.82"};
    watched w = begin_score(drum, 2, 60);
    for (int i = 0; i < 2; i++) {
        session_do(w.p, "stroke %g right legato mf normal %c", 1.5 + 1.5 * i, i ? 'b' : 'a');
        session_do(w.p, "stroke %g left legato mf normal %c", 1.5 + 1.5 * i, i ? 'a' : 'b');
    }
    play_score(&w, 5.5, 3);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(w.heard.note, "given up"), w.heard.note);
}

/// At beat 71 the left arm is folded up; at 84 from the right to the far left, past the left
/// shoulder, while the right hand is far on the right.
static void test_in_tide_a_tip_passes_its_shoulder_at_a_distance_and_no_joint_whips(void)
{
    static const int begin[] = {70, 84};
    for (int i = 0; i < (is_long() ? 1 : 2); i++) {
        watched w = begin_score(NULL, 0, 60);
        session_do(w.p, "score patches/pieces/tide.txt");
        if (!is_long())
            session_do(w.p, "seek %d", begin[i]);
        w.most_rate = 40;
        w.most_torque = 400;
        play_score(&w, is_long() ? 128 : i ? 5 : 2, is_long() ? 605 : 0);
    }
}

static void test_hands_on_four_drums_pass_each_other(void)
{
    static const char left[] = "ababbabcab", right[] = "dcbdcbcddc";
    watched w = begin_score(four_drums, 4, 50);
    for (int i = 0; i < 10; i++) {
        session_do(w.p, "stroke %g left legato mf normal %c", 2 + 2.0 * i, left[i]);
        session_do(w.p, "stroke %g right accent f normal %c", 3 + 2.0 * i, right[i]);
    }
    play_score(&w, 27, 20);
}

static void test_no_joint_whips_where_a_leap_passes_under_the_shoulder(void)
{
    static const char *const drum[] = {"place 0.251 0.843 0.85", "place 0.832 0.287 0.85",
                                       "place 0.763 -0.439 0.85"};
    watched w = begin_score(drum, 3, 126);
    session_do(w.p, "stroke 1.5 left legato mf normal b");
    session_do(w.p, "stroke 2 left accent f normal a");
    session_do(w.p, "stroke 2 right accent f normal c");
    session_do(w.p, "play");
    session_play(w.p, 2, NULL);
    himc_performance_stats s = himc_performance_measure(w.p);
    TEST_ASSERT_EQUAL_INT(3, s.played);
    char text[80];
    snprintf(text, sizeof text, "%.0f rad/s, %.0f N m", s.peak_rate, s.peak_torque);
    TEST_ASSERT_TRUE_MESSAGE(s.peak_rate < 50 && s.peak_torque < 600, text);
    himc_performance_free(w.p);
}

static void test_forearms_do_not_pass_through_the_back_for_drums_behind(void)
{
    static const char *const drum[] = {"place -0.35 0.606 0.85", "place -0.35 -0.606 0.85"};
    for (int side = 0; side < 2; side++) {
        watched w = begin_score(&drum[side], 1, 50);
        for (int i = 0; i < 4; i++)
            session_do(w.p, "stroke %d %s legato mf", 2 + i, i % 2 ? "right" : "left");
        play_score(&w, 7, 4);
        TEST_ASSERT_TRUE(w.avoided);
    }
}

static void test_where_nothing_is_near_nothing_is_avoided(void)
{
    static const char *const drum[] = {"place 0.70 0 0.85"};
    watched w = begin_score(drum, 1, 50);
    for (int i = 0; i < 8; i++)
        session_do(w.p, "stroke %d %s legato mf", 1 + i, i % 2 ? "right" : "left");
    play_score(&w, 11, 8);
    TEST_ASSERT_FALSE(w.avoided);
}

/// The right hand is raised, its wrist 22 cm from the shoulder; the left elbow is out of the way a
/// little or far.
static void test_an_arm_is_not_unfolded_for_a_hairs_breadth(void)
{
    static const double out[] = {0.04, 0.4};
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton skeleton;
    himc_posture posture;
    himc_shells none = {.count = 0};
    himc_foreseen f = {.tip = {{0.3, 0.32, 0.995}, {0.313, -0.333, 1.2}}};
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_posture_init(&posture, &skeleton, 0.8675);
    f.trunk = himc_posture_trunk(&posture, f.tip, HIMC_GRIP_GERMAN);
    const himc_foreseen same[HIMC_FORESEEN] = {f, f};
    for (int i = 0; i < 2; i++) {
        himc_avoidance a = {.goal = {out[i]}};
        for (int k = 0; k < 50; k++)
            himc_avoidance_update(&a, &posture, &none, same, 0.004);
        double wrist = a.goal[HIMC_HANDS + HIMC_RIGHT];
        TEST_ASSERT_TRUE(i ? wrist < -0.02 : wrist == 0);
    }
}

static himc_capsule random_capsule(unsigned *seed)
{
    himc_vec3 a = {chance(seed), chance(seed), chance(seed)};
    himc_vec3 b = {chance(seed), chance(seed), chance(seed)};
    return (himc_capsule){a, b, 0.1 * chance(seed)};
}

static void test_gap_of_two_capsules_is_that_of_their_nearest_points(void)
{
    unsigned seed = 7;
    for (int k = 0; k < 60; k++) {
        himc_capsule p = random_capsule(&seed), q = random_capsule(&seed);
        double least = INFINITY;
        for (int i = 0; i <= 200; i++)
            for (int j = 0; j <= 200; j++) {
                himc_vec3 x = himc_vec3_madd(p.a, i / 200.0, himc_vec3_sub(p.b, p.a));
                himc_vec3 y = himc_vec3_madd(q.a, j / 200.0, himc_vec3_sub(q.b, q.a));
                least = fmin(least, himc_vec3_length(himc_vec3_sub(x, y)));
            }
        double gap = himc_capsule_nearest(&p, &q).gap + p.radius + q.radius;
        TEST_ASSERT_TRUE(gap <= least + 1e-12);
        TEST_ASSERT_DOUBLE_WITHIN(8e-3, least, gap); // the samples' distance
    }
}

static void test_posture_has_the_capsules_of_its_pose(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton skeleton;
    himc_posture posture;
    himc_pose pose;
    himc_body_state state;
    himc_capsule from_posture[HIMC_SEGMENTS], from_state[HIMC_SEGMENTS];
    himc_vec3 tip[HIMC_HANDS] = {{0.4, 0.2, 1.0}, {0.5, -0.1, 0.9}};
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_posture_init(&posture, &skeleton, 0.8675);
    for (int i = 0; i < HIMC_AVOIDANCE_PARTS; i++)
        posture.trunk_posture.value[HIMC_TRUNK_POSTURE_ELBOW + i] = 0.05 * (i + 1);
    posture.trunk_posture.value[HIMC_TRUNK_POSTURE_TURN] = 0.3;
    TEST_ASSERT_TRUE(himc_posture_at(&posture, tip, &pose) == 0);
    himc_pose_to_state(&skeleton, &pose, NULL, &state);
    capsules_of(&skeleton, &state, from_state);
    himc_posture_capsules(&posture, tip, from_posture);
    for (int i = 0; i < HIMC_CAPSULE_PAIRS; i++) {
        himc_capsule_pair pair = himc_capsule_pairs[i];
        double a = himc_capsule_nearest(&from_posture[pair.part], &from_posture[pair.other]).gap;
        double b = himc_capsule_nearest(&from_state[pair.part], &from_state[pair.other]).gap;
        if (pair.other != HIMC_HEAD) // it looks down a little
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, b, a);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_hands_crossed_over_two_drums_pass_each_other);
    RUN_TEST(test_a_stroke_that_would_meet_the_other_arm_goes_to_the_other_hand);
    RUN_TEST(test_leaps_at_random_are_all_played_and_no_part_meets_another);
    RUN_TEST(test_planning_is_spread_over_ticks_and_the_same_in_all_blocks);
    RUN_TEST(test_a_stroke_that_no_hand_has_room_for_is_left_out_and_told);
    RUN_TEST(test_in_tide_a_tip_passes_its_shoulder_at_a_distance_and_no_joint_whips);
    RUN_TEST(test_hands_on_four_drums_pass_each_other);
    RUN_TEST(test_no_joint_whips_where_a_leap_passes_under_the_shoulder);
    RUN_TEST(test_forearms_do_not_pass_through_the_back_for_drums_behind);
    RUN_TEST(test_where_nothing_is_near_nothing_is_avoided);
    RUN_TEST(test_an_arm_is_not_unfolded_for_a_hairs_breadth);
    RUN_TEST(test_gap_of_two_capsules_is_that_of_their_nearest_points);
    RUN_TEST(test_posture_has_the_capsules_of_its_pose);
    return UNITY_END();
}
