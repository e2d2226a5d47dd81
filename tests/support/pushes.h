/// pushes.h: shared by tests of pushes: a piece is played twice, once with a push of 200 N for 100
/// ms, and what is left of it a second later is how much farther the tips are from their targets.
#ifndef HIMC_TESTS_PUSHES_H
#define HIMC_TESTS_PUSHES_H

#include "take_files.h"

#include "session.h"
#include "body/posture.h"
#include "control/controller.h"

#define PUSH_FORCE 200.0
#define PUSH_TIME 0.1
#define RECOVERED 0.01 // farther from the target than without the push (m)

static const char *const push_laws[] = {"printed", "feedforward", "computed-torque"};
static const char *const push_modes[] = {"himc", "id"};

typedef struct push_piece {
    const char *load;         ///< the command, with %s for a capture's path
    const char *file;         ///< of the capture, under ../shared/mocap; NULL for none
    const char *left, *right; ///< names of its tips; NULL to look for them
    double at;                ///< when the push comes (s)
} push_piece;

static const push_piece push_pieces[] = {
    {"score patches/improvisation.txt", NULL, NULL, NULL, 1.65},
    {"take %s", "drumstroke_pearl_240hz/stroke.trc", NULL, NULL, 1.3},
    {"take %s", "cmu131_bvh_120hz/131_03.bvh", "LFingers_end", "RFingers_end", 1.5},
    {"take %s", "upperlimb_pyomeca_100hz/markers_analogs.c3d", NULL, "Daphnee:INDEX", 1.5},
};

typedef struct push_case {
    const push_piece *piece;
    int mode, law;  ///< of push_modes, push_laws
    double gain;    ///< all gains, times the default; 1 leaves them alone
    double physics; ///< rate (Hz)
    int segment;    ///< 0 for no push
    himc_vec3 direction;
} push_case;

typedef struct push_result {
    bool finite;
    long lost;      ///< times the body was put back
    double swerved; ///< farthest from the target in the second after the push began (m)
    double left;    ///< farthest in the quarter from a second after its end on (m)
} push_result;

typedef struct push_watch {
    double at;
    push_result result;
} push_watch;

static inline void push_row(void *user, const himc_motion_row *row)
{
    push_watch *w = user;
    double since = row->time - w->at;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double away = himc_vec3_length(himc_vec3_sub(row->tip[hand], row->target[hand]));
        w->result.finite = w->result.finite && isfinite(away);
        if (since > 0 && since < 1)
            w->result.swerved = fmax(w->result.swerved, away);
        if (since >= PUSH_TIME + 1 && since < PUSH_TIME + 1.25)
            w->result.left = fmax(w->result.left, away);
    }
    for (int j = 0; j < HIMC_JOINTS; j++)
        w->result.finite = w->result.finite && himc_vec3_finite(row->joint[j]);
}

// the default gains of a player of usual size, as the user would set them
static inline void push_gains(himc_performance *p, double factor)
{
    himc_skeleton body;
    himc_posture posture;
    himc_pose pose;
    himc_body_state state;
    himc_controller c;
    himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.05, 0.9}, {0.48, -0.05, 0.9}};
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&body, &config, &error));
    himc_posture_init(&posture, &body, 0.8675);
    himc_posture_at(&posture, tip, &pose);
    himc_pose_to_state(&body, &pose, NULL, &state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&c, &control, &body, &state);
    for (int j = 0; j < HIMC_JOINTS; j++)
        session_do(p, "gain %s %.6f %.6f", himc_joint_name(j), factor * c.gain[j].stiffness.y,
                   factor * c.gain[j].damping.y);
}

static inline push_result push_play(const push_case *c)
{
    himc_performance *p = session_new();
    push_watch watch = {.at = c->piece->at, .result = {.finite = true}};
    himc_take_options options = himc_take_default();
    options.left_tip = c->piece->left;
    options.right_tip = c->piece->right;
    himc_performance_take_options(p, &options);
    session_do(p, "drum kettle");
    session_do(p, "rate physics %g", c->physics);
    session_do(p, c->piece->load, c->piece->file ? shared_capture(c->piece->file) : "");
    session_do(p, "mode %s", push_modes[c->mode]);
    session_do(p, "law %s", push_laws[c->law]);
    if (c->gain != 1)
        push_gains(p, c->gain);
    himc_performance_on_motion(p, push_row, &watch);
    session_do(p, "play");
    session_play(p, c->piece->at, NULL);
    himc_vec3 f = himc_vec3_scale(c->direction, PUSH_FORCE);
    if (c->segment)
        session_do(p, "push %s %g %g %g %g", himc_segment_name(c->segment), f.x, f.y, f.z,
                   PUSH_TIME);
    session_play(p, PUSH_TIME + 1.25, NULL);
    watch.result.lost = himc_performance_measure(p).recoveries;
    himc_performance_free(p);
    return watch.result;
}

static inline bool push_available(const push_piece *piece)
{
    return !piece->file || shared_capture(piece->file);
}

/// `c` with its push against `still` without it.
static inline void push_recovers(const push_case *c, const push_result *still)
{
    char what[200];
    push_result r = push_play(c);
    snprintf(what, sizeof what,
             "%s, %s, %s, gains x %g, %g Hz, %s: swerved %.3f, left %.4f of %.4f",
             c->piece->file ? c->piece->file : "score", push_modes[c->mode], push_laws[c->law],
             c->gain, c->physics, himc_segment_name(c->segment), r.swerved, r.left, still->left);
    TEST_ASSERT_TRUE_MESSAGE(r.finite, what);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, r.lost, what);
    TEST_ASSERT_TRUE_MESSAGE(r.left < still->left + RECOVERED, what);
}

#endif
