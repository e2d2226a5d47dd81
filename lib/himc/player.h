/// player.h: the player of a take: how large, how heavy, in what posture in every frame, and seated
/// where; from any full-body take, skeleton or markers, as far as it shows them.
///
/// Joint centres are found by the names that motion capture software and laboratories use, a centre
/// between two markers as their middle. A segment lies along the line between its joint centres;
/// its turn about that line comes from the skeleton's frames, else from a marker beside it, else
/// from the plane of the bent elbow or knee, and for forearm, hand and stick from the vertical
/// plane of the stroke. An arm that is shown to its tip is then bent a little, so that its tip is
/// where it was captured and its joints as near as can be, for captured limbs stretch. The
/// simulated pelvis is held, so the trunk's and the thighs' rotations are those in the world.
#ifndef HIMC_PLAYER_H
#define HIMC_PLAYER_H

#include "himc/posture.h"
#include "himc/take.h"

typedef struct himc_player {
    himc_skeleton_config config; ///< the measures: the given ones where the take shows none
    int lengths;                 ///< segments measured
    char height_from[64];        ///< "legs and trunk", or "" if the height is the given one
    bool mass_said;              ///< by the file; else by the given body's mass index
    bool known[HIMC_JOINTS];     ///< joints the take shows
    himc_pose mean;              ///< default posture: means of the known, the natural ones else
    int frames;                  ///< of the take
    himc_pose *pose;    ///< (frames), owned; NULL if no joint is known. Joints not known as in mean
    bool walks;         ///< too far for a held pelvis: postures are those about the moving hips
    himc_vec3 *walk;    ///< (frames), owned: the hips from their mean (m), if they walk; NULL once
                        ///< himc_player_sit has taken it out of the take
    bool placed;        ///< the take shows where the player is: hips or shoulders
    himc_vec3 hips;     ///< between the hip joints, in the take (m); mean, or by himc_player_sit
    bool seated;        ///< himc_player_sit has put the player where config.seat and offset say
    himc_vec3 offset;   ///< to be added to the take's coordinates to make ours (m)
    char notes[8][192]; ///< what is missing or was repaired
    int note_count;
} himc_player;

/// From a take that was read with these options; `given` (its ranges checked) stands in for what
/// the take does not show. Gaps of markers up to options->longest_gap are bridged, a joint with a
/// longer one is not known and a note says where. NULL with the reason: no memory, or a player of
/// no human size.
himc_player *himc_player_new(himc_take *take, const himc_take_options *options,
                             const himc_skeleton_config *given, himc_error *error);
void himc_player_free(himc_player *player);

/// How many of an arm's joints the take shows: HIMC_ARM_JOINTS with its stick, 0 without the arm.
HIMC_RT static inline int himc_player_known_arm(const himc_player *player, himc_hand hand)
{
    int known = 0;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        known += player->known[himc_arm_joint(hand, k)];
    return known;
}

/// Puts the player over the world's origin. One that the take places has the seat raised or lowered
/// so that the take's strikes meet a head at the drum's height; `drum` is moved under the strikes
/// where they would miss the head, or where no seat (0.3 .. 1.3 m) would do. One that it does not
/// place sits where the strikes fall on the drum's usual spot. Without strikes the one has the seat
/// that the take shows, the other sits where all of it is in reach, if there is such a place, and
/// `drum` is lowered out of the way. If the player walks, the hips' way is taken out of the take.
/// False, and nothing else changed, if the take has no tips, or a gap in them.
bool himc_player_sit(himc_player *player, himc_take *take, const himc_take_options *options,
                     himc_place *drum);

/// One line per fact, for `himc info`; with `drum` (NULL if the player is not seated) where it
/// stands. A line is at most 255 characters.
void himc_player_describe(const himc_player *player, const himc_place *drum,
                          void (*line)(void *, const char *), void *user);

#endif
