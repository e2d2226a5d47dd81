/// player_pose.h: postures from joint centres; private.
#ifndef HIMC_PLAYER_POSE_H
#define HIMC_PLAYER_POSE_H

#include "capture/player_points.h"

/// Fills pose, known and, for the known joints, mean; the others keep the mean they come with.
/// `waist` is where the held pelvis ends (m, in the take), NULL if the take does not show it. False
/// without memory.
bool himc_player_read_poses(himc_player *player, const player_points *points,
                            const himc_skeleton *skeleton, const himc_vec3 *waist);

/// player_fit.c: turns the arms that are wholly shown so that their joint centres are nearest to
/// the captured and their tips are there.
void himc_player_fit_arms(himc_player *player, const player_points *points,
                          const himc_skeleton *skeleton);

#endif
