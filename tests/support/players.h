/// players.h: drummers made in joint space without the library's models: strokes in which the
/// shoulder leads, then elbow, wrist and grip follow, of three people of different build and style.
///
/// The proximal joints swing smoothly through the blow; wrist and grip reverse in it.
#ifndef HIMC_TESTS_PLAYERS_H
#define HIMC_TESTS_PLAYERS_H

#include "control/posture_regression.h"
#include "body/posture.h"

#include <stdlib.h>

#define PLAYERS 3
#define PLAYER_RATE 250.0
#define PLAYER_LEVEL 0.8675

typedef struct player {
    himc_skeleton skeleton;
    himc_pose low;                    // posture at impact
    himc_vec3 swing[HIMC_ARM_JOINTS]; // rotation of the left arm's joints to the apex (rad)
    double lead[HIMC_ARM_JOINTS];     // (s)
    double period;                    // of a hand's strokes (s)
} player;

static inline player make_player(int who)
{
    static const double height[PLAYERS] = {1.62, 1.74, 1.88};
    static const double vary[PLAYERS][4] = {
        {1.0, 1.04, 0.97, 1.0}, {0.95, 1.0, 1.0, 1.05}, {1.04, 0.97, 1.03, 0.96}};
    player p = {.period = 0.5 + 0.03 * who};
    himc_skeleton_config config = himc_skeleton_default();
    config.height = height[who];
    himc_skeleton_init(&p.skeleton, &config, NULL);
    himc_posture posture;
    himc_posture_init(&posture, &p.skeleton, PLAYER_LEVEL);
    double far = 0.27 * height[who] + 0.01 * who;
    himc_vec3 tip[HIMC_HANDS] = {{far, 0.10, PLAYER_LEVEL}, {far, -0.10, PLAYER_LEVEL}};
    himc_posture_at(&posture, tip, &p.low);
    const double rise[HIMC_ARM_JOINTS] = {0.18, 0.30, 0.45, 0.25},
                 lead[HIMC_ARM_JOINTS] = {0.020, 0.015, 0.005, 0};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        p.swing[k] =
            himc_vec3_make(k == 0 ? 0.22 * vary[who][k] : 0.02, -rise[k] * vary[who][k], 0.02);
        p.lead[k] = lead[k] + (k < 2 ? 0.001 * (who - 1) : 0);
    }
    return p;
}

// from 0 at a strike over 1 back to 0; `smooth` swings through the strike, else it reverses in it
static inline double stroke_shape(double phase, bool smooth)
{
    phase -= floor(phase);
    return smooth ? 0.5 - 0.5 * cos(2 * HIMC_PI * phase) : sin(HIMC_PI * phase);
}

// height of a hand's strokes, changing smoothly from stroke to stroke
static inline double stroke_height(double count)
{
    static const double height[] = {0.5, 0.7, 1.0, 0.6, 0.9, 0.4, 0.8};
    int n = (int)floor(count);
    double u = count - n, s = u * u * u * (10 - 15 * u + 6 * u * u);
    return height[n % 7] * (1 - s) + height[(n + 1) % 7] * s;
}

static inline himc_pose player_at(const player *p, double t)
{
    himc_pose pose = p->low;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            double phase = 2 + (t + p->lead[k]) / p->period + 0.5 * hand;
            double s = stroke_height(phase) * stroke_shape(phase, k < 2);
            himc_vec3 w = p->swing[k];
            if (hand == HIMC_RIGHT)
                w = himc_vec3_make(-w.x, w.y, -w.z);
            int j = himc_arm_joint((himc_hand)hand, k);
            pose.joint[j] = himc_quat_mul(pose.joint[j], himc_quat_exp(himc_vec3_scale(w, s)));
        }
    return pose;
}

/// A take of `seconds`; free its pose.
static inline himc_posture_regression_take player_take(const player *p, double seconds)
{
    int frames = (int)(seconds * PLAYER_RATE);
    himc_pose *pose = malloc((size_t)frames * sizeof *pose);
    for (int i = 0; i < frames; i++)
        pose[i] = player_at(p, 1 + i / PLAYER_RATE);
    return (himc_posture_regression_take){
        .skeleton = &p->skeleton, .pose = pose, .frames = frames, .rate = PLAYER_RATE};
}

#endif
