/// take_players.h: takes of a whole player with known joints, for the tests of players and tracks:
/// natural postures that strike a head with alternate hands.
#ifndef HIMC_TESTS_TAKE_PLAYERS_H
#define HIMC_TESTS_TAKE_PLAYERS_H

#include "take_files.h"

#include "capture/take.h"
#include "body/posture.h"

static const himc_head_frame usual_drum = {.center = {0.70, 0, 0.85}, .radius = 0.2921};

/// Height above the head at `t`: blows every 0.5 s at 0.5 k - 0.1 s, quintics between.
static inline himc_target beaten_height(double t, double speed)
{
    double high = 0.04 + 0.08 * speed, since = fmod(t + 0.1, 0.5), top = 0.5 - 2.1 * high / speed;
    himc_target hit = {.v = {0, 0, 0.85 * speed}}, up = {.x = {0, 0, high}};
    himc_target down = {.v = {0, 0, -speed}};
    himc_quintic q =
        since < top ? himc_quintic_make(&hit, &up, top) : himc_quintic_make(&up, &down, 0.5 - top);
    return himc_quintic_at(&q, since < top ? since : since - top);
}

/// The tips at `t`, 1 s on from the left blow to the next right one.
static inline void beaten_tips(double t, himc_target tip[HIMC_HANDS])
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        tip[hand] = beaten_height(t + (hand == HIMC_LEFT ? 0.25 : 0), 3);
        tip[hand].x = himc_vec3_add(tip[hand].x, himc_vec3_make(0.70 - 0.2 + 0.02 * sin(3 * t),
                                                                hand == HIMC_LEFT ? 0.06 : -0.06,
                                                                0.85 + 0.0175));
        tip[hand].v.x += 0.06 * cos(3 * t);
        tip[hand].a.x -= 0.18 * sin(3 * t);
    }
}

/// The true pose of the body at `t`, with a little sway of the trunk.
static inline himc_pose beaten_pose(const himc_skeleton *skeleton, double t)
{
    himc_posture posture;
    himc_target tip[HIMC_HANDS];
    himc_pose pose;
    himc_posture_init(&posture, skeleton, 0.85 + 0.0175);
    posture.trunk_posture.value[HIMC_TRUNK_POSTURE_TURN] = 0.1 * sin(2 * t);
    beaten_tips(t, tip);
    himc_vec3 x[HIMC_HANDS] = {tip[0].x, tip[1].x};
    himc_posture_at(&posture, x, &pose);
    return pose;
}

/// A take of this motion in memory, with the points of a file of that name (.bvh a skeleton, .c3d
/// markers); NULL with error.text.
static inline himc_take *beaten_file(const char *path, const himc_skeleton *skeleton, double rate,
                                     double seconds, himc_error *error)
{
    himc_recording *recording = himc_recording_new(path, skeleton, rate, seconds + 1, error);
    if (!recording)
        return NULL;
    for (int i = 0; i < (int)(seconds * rate); i++) {
        himc_body_state state;
        himc_pose pose = beaten_pose(skeleton, i / rate);
        himc_pose_to_state(skeleton, &pose, NULL, &state);
        himc_recording_add(recording, &state);
    }
    himc_take *take = himc_recording_take(recording, error);
    himc_recording_free(recording);
    return take;
}

static inline himc_take *beaten_take(const himc_skeleton *skeleton, double rate, double seconds,
                                     himc_error *error)
{
    return beaten_file("build/player.bvh", skeleton, rate, seconds, error);
}

#endif
