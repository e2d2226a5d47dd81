/// test_shaft.c: how a stroke looks: the shaft passes over the hoop, a soft stroke comes from wrist
/// and fingers and a loud one from the arm, too.
#include "session.h"

#include "performance/performance_state.h"

#include <math.h>

#define HOOP 0.0035 // its top over the head, as drawn (m)
#define SHAFT 0.006 // its radius (m)
#define WIDER 1.035 // of the hoop than the head

static const char *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent", "staccato"};

/// Of strokes: the least gap of shaft and hoop at the first force (m), and the mean shares of the
/// elbow, and of wrist and grip, in the tip's speed down.
typedef struct seen {
    himc_performance *p;
    bool touched[HIMC_HANDS];
    double gap, elbow, hand;
    double last[HIMC_HANDS][2]; // shares in the row before
    int strokes;
} seen;

static double share(const himc_body_state *s, himc_hand hand, int k, double down)
{
    int j = himc_arm_joint(hand, k), parent = k == 0 ? HIMC_TRUNK : himc_arm_joint(hand, k - 1) + 1;
    himc_vec3 spin = himc_vec3_sub(s->spin[j + 1], s->spin[parent]);
    return himc_vec3_cross(spin, himc_vec3_sub(s->tip[hand], s->origin[j + 1])).z / down;
}

static void see(void *user, const himc_motion_row *row)
{
    seen *w = user;
    const himc_body_state *s = &w->p->body->state;
    const himc_head_frame *head = himc_drums_frame(&w->p->drums, 0);
    (void)row;
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        bool touches = w->p->contacts.hand[i].touching, first = touches && !w->touched[i];
        himc_vec3 tip = himc_head_frame_from_world(head, s->tip[hand]),
                  grip = himc_head_frame_from_world(head, s->origin[himc_stick_segment(hand)]);
        w->touched[i] = touches;
        for (int k = 0; first && k <= 100; k++) {
            himc_vec3 at = himc_vec3_madd(tip, k / 100.0, himc_vec3_sub(grip, tip));
            if (fabs(hypot(at.x, at.y) - WIDER * head->radius) < 0.008)
                w->gap = fmin(w->gap, at.z - SHAFT - HOOP);
        }
        if (first) {
            w->elbow += w->last[i][0];
            w->hand += w->last[i][1];
            w->strokes++;
        }
        double down = s->tip_velocity[hand].z;
        w->last[i][0] = share(s, hand, 1, down);
        w->last[i][1] = share(s, hand, 2, down) + share(s, hand, 3, down);
    }
}

static seen play(const char *grip, const char *nuance, const char *dynamic, const char *spot)
{
    seen w = {.p = session_new(), .gap = INFINITY};
    session_do(w.p, "drum kettle 26");
    session_do(w.p, "grip %s", grip);
    session_do(w.p, "rate task 1000"); // a row each millisecond
    session_do(w.p, "tempo 60");
    for (int i = 0; i < 4; i++)
        session_do(w.p, "stroke %d %s %s %s %s", 1 + i, i % 2 ? "right" : "left", nuance, dynamic,
                   spot);
    himc_performance_on_motion(w.p, see, &w);
    session_do(w.p, "play");
    session_play(w.p, 5.3, NULL);
    TEST_ASSERT_EQUAL_INT(4, himc_performance_measure(w.p).played);
    himc_performance_free(w.p);
    w.elbow /= w.strokes;
    w.hand /= w.strokes;
    return w;
}

static void test_no_shaft_touches_the_hoop(void)
{
    static const char *const dynamics[] = {"pp", "p", "f", "ff"},
                             *const spots[] = {"normal", "rim", "center"},
                             *const grips[] = {"german", "french"};
    int from = getenv("HIMC_LONG") ? 0 : 2; // everyday the loud ones of each nuance
    for (int n = 0; n < 5; n++)
        for (int d = from; d < 4; d++)
            for (int k = 0; k < (from ? 1 : 6); k++) {
                int spot = from ? (n + d) % 3 : k % 3, grip = from ? n % 2 : k / 3;
                char text[100];
                seen w = play(grips[grip], nuances[n], dynamics[d], spots[spot]);
                snprintf(text, sizeof text, "%s %s %s %s: %.1f mm", grips[grip], nuances[n],
                         dynamics[d], spots[spot], 1e3 * w.gap);
                TEST_ASSERT_TRUE_MESSAGE(w.gap > (spot == 1 ? 0.005 : 0.008), text);
            }
}

static void test_soft_strokes_are_of_the_hand_and_loud_ones_of_the_arm_too(void)
{
    for (int n = 0; n < 5; n++) {
        seen soft = play("german", nuances[n], "p", "normal"),
             loud = play("german", nuances[n], "ff", "normal");
        printf("%s: elbow %.2f, %.2f; wrist and grip %.2f, %.2f\n", nuances[n], soft.elbow,
               loud.elbow, soft.hand, loud.hand);
        TEST_ASSERT_TRUE(soft.elbow < 0.45 && soft.hand > 0.8);
        TEST_ASSERT_TRUE(loud.elbow > soft.elbow + 0.1 && loud.elbow < 0.75);
    }
}

// Four strokes of both hands in turn on a drum at the left, four on one at the right: at each change
// of drum one hand reaches over the other. A steep shaft would stab the head, a shaft that stays
// steep after a crossing would make equal strokes unequal.
static void test_a_stroke_after_a_crossing_is_as_any_other_and_a_crossed_one_no_stab(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "strength off");
    session_do(p, "tempo 60");
    for (int i = 0; i < 2; i++) {
        session_do(p, "instrument %c tom 12", 'a' + i);
        session_do(p, "%c place 0.6 %g 0.85", 'a' + i, 0.3 - 0.6 * i);
    }
    for (int i = 0; i < 24; i++)
        session_do(p, "stroke %g %s legato f %c", 2 + 0.5 * i, i % 2 ? "right" : "left",
                   "ab"[i / 4 % 2]);
    session_do(p, "play");
    session_play(p, 15, &h);
    TEST_ASSERT_EQUAL_INT(24, h.strikes);
    double least = INFINITY, most = 0, crossed = 0; // mass that strikes (kg)
    for (int i = 0; i < h.strikes; i++) {
        double mass = h.strike[i].impulse / h.strike[i].velocity;
        least = fmin(least, mass);
        if (i % 8 == 3) // at the left, while the left hand goes to the right
            crossed = fmax(crossed, mass);
        else
            most = fmax(most, mass);
    }
    printf("masses: %.2f, crossed %.2f of the least\n", most / least, crossed / least);
    TEST_ASSERT_TRUE(most < 1.2 * least);    // 8.4 with wrists that stay raised
    TEST_ASSERT_TRUE(crossed < 4.5 * least); // 5.4 with wrists that are raised without a limit
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_stroke_after_a_crossing_is_as_any_other_and_a_crossed_one_no_stab);
    RUN_TEST(test_no_shaft_touches_the_hoop);
    RUN_TEST(test_soft_strokes_are_of_the_hand_and_loud_ones_of_the_arm_too);
    return UNITY_END();
}
