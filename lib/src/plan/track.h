/// track.h: plays a take: the captured places of the drumstick tips, and where the take shows them
/// the joints, made into smooth targets that know of impacts.
///
/// A capture at 250 Hz contains the bounce and, filtered, a blunted impact. So each strike is cut
/// out: before it the approach is carried on to the head, in contact control lets go, after it
/// the motion starts from the tip as it really is and rejoins the capture.
#ifndef HIMC_TRACK_H
#define HIMC_TRACK_H

#include "himc/mocap.h"
#include "body/posture.h"

typedef struct himc_track himc_track;

/// Builds the track of a take for a drum standing at `place`; the take is moved (not turned or
/// scaled) so that its strikes fall on the head's usual spot. The take may be freed afterwards.
/// NULL if it has no tips or a gap too long.
himc_track *himc_track_new(himc_take *take, const himc_take_options *options,
                           const himc_head_frame *place, double mallet_radius, himc_error *error);
/// The same with the postures of a player made from the same take. The take is moved by
/// player->offset if the player is seated.
himc_track *himc_track_new_played(himc_take *take, const himc_take_options *options,
                                  const himc_head_frame *place, const himc_player *player,
                                  himc_error *error);
void himc_track_free(himc_track *track);

/// Before its first frame the tip comes from `now` on a quintic of `duration` seconds.
HIMC_RT void himc_track_approach(himc_track *track, himc_hand hand, const himc_target *now,
                                 double duration);
/// Before its first frame the joints come from `now` as long as the tips take.
HIMC_RT void himc_track_approach_posture(himc_track *track, const himc_posture_motion *now);
/// At `t` the tips, now moving as given, leave the take and come to rest.
HIMC_RT void himc_track_stop(himc_track *track, double t, const himc_target now[HIMC_HANDS]);
/// Forgets the strikes already played, to play it again.
HIMC_RT void himc_track_rewind(himc_track *track);
/// Added to the take's coordinates to make ours (m).
himc_vec3 himc_track_offset(const himc_track *track);
/// True if the take has that hand's tip.
bool himc_track_present(const himc_track *track, himc_hand hand);
/// Length (s), the coming to rest after the last frame included.
double himc_track_length(const himc_track *track);
/// Strikes found for that hand.
int himc_track_strikes(const himc_track *track, himc_hand hand);

/// State of the tip at `t` (s from the take's start): on its approach before it, at rest soon
/// after its end.
HIMC_RT himc_target himc_track_target(const himc_track *track, himc_hand hand, double t);
/// True if the take moves joints.
bool himc_track_has_posture(const himc_track *track);
/// Replaces in `motion` the joints that the take shows (the others, and the arms of hands without
/// tips, stay as they are) by those it has at `t`, the arms then bent by the least that brings the
/// tips to `tip`: so the joints meet the strikes, and leave them, as the tips do. An arm whose tip
/// is no stick's end (mostly 0.15 m off) is bent from where it is in `motion`. With `tip` NULL all
/// go as they were captured, bounces included.
HIMC_RT void himc_track_posture(const himc_track *track, const himc_skeleton *skeleton, double t,
                                const himc_target tip[HIMC_HANDS], himc_posture_motion *motion);
/// Time of the strike that hand is on or comes to at `t`, and where on the head; false if there
/// is none ahead.
HIMC_RT bool himc_track_current(const himc_track *track, himc_hand hand, double t,
                                double *contact_time, double *x, double *y);
/// The tip left the head at `t` in this state: a quintic of 20 ms, from far off a longer one, leads
/// back to the capture.
HIMC_RT void himc_track_separated(himc_track *track, himc_hand hand, double t,
                                  const himc_target *measured);

#endif
