/// track.h: plays a take: the captured paths of the drumstick tips, and of the joints if the take
/// has them, as smooth targets with impacts.
///
/// A capture at 250 Hz contains the bounce and, filtered, a blunted impact. So each strike is cut
/// out: before it the approach is carried on to the head, in contact control lets go, after it the
/// motion starts from the measured state of the tip and rejoins the capture.
#ifndef HIMC_TRACK_H
#define HIMC_TRACK_H

#include "himc/mocap.h"
#include "body/source.h"

/// The command `nudge`: a tip is `way` off its captured path at `time`, and on it again `span`
/// before and after. With it path, velocity and acceleration stay continuous. The height is left
/// alone at strikes: they stay strikes of the same speed.
typedef struct himc_nudge {
    himc_hand hand;
    double time;       ///< in the take (s)
    double span;       ///< (s)
    himc_vec3 way;     ///< (m)
    double rise, fall; ///< span of the height before and after, between the strikes around (s)
} himc_nudge;

#define HIMC_NUDGES 256 ///< of a take; chosen: more than anyone drags

typedef struct himc_track himc_track;
/// Of a himc_track. After a separation a quintic of 20 ms, or a longer one from far off, leads back
/// to the capture; after a stop the tips leave the take and come to rest.
extern const himc_source himc_track_source;

/// Builds the track of a take for a drumhead at `head`; the take is moved (not turned or scaled) so
/// that its strikes fall on the head's usual spot, or by player->offset if a player is seated.
/// `player`, made from the same take, gives the postures; NULL: tips alone. The take may be freed
/// afterwards. NULL, with the reason, if it has no tips or too long a gap.
himc_track *himc_track_new(himc_take *take, const himc_take_options *options,
                           const himc_head_frame *head, const himc_player *player,
                           double mallet_radius, himc_error *error);
void himc_track_free(himc_track *track);

/// Before its first frame the tip comes from `now` on a quintic of `duration` seconds.
HIMC_RT void himc_track_approach(himc_track *track, himc_hand hand, const himc_target *now,
                                 double duration);
/// Before its first frame the joints come from `now` as long as the tips take.
HIMC_RT void himc_track_approach_posture(himc_track *track, const himc_posture_motion *now);
/// Back to the state before the first strike: its first frame comes at `start` (s) of the
/// performance.
HIMC_RT void himc_track_rewind(himc_track *track, double start);
/// Difference of the world's coordinates and the take's (m).
himc_vec3 himc_track_offset(const himc_track *track);
/// When its first frame comes (s of the performance), since himc_track_rewind.
HIMC_RT double himc_track_start(const himc_track *track);
bool himc_track_present(const himc_track *track, himc_hand hand);
/// Length (s), with the halt after the last frame.
double himc_track_length(const himc_track *track);
int himc_track_strikes(const himc_track *track, himc_hand hand);

/// Leads a tip aside from now on; the nudge's `rise` and `fall` are found here. The height is given
/// up where a strike is at its very time. False with the reason: that hand is not in the take, not
/// in its time, or too many nudges.
bool himc_track_nudge(himc_track *track, const himc_nudge *nudge, himc_error *error);
/// Takes the nudges of another track of the same take while it is played at `t`. False, and nothing
/// changed, if one differs that has begun.
bool himc_track_exchange(himc_track *track, const himc_track *other, double t);
/// The nudges (*count), borrowed.
const himc_nudge *himc_track_nudges(const himc_track *track, int *count);

/// State of the tip at `t` (s from the take's start): on its approach before 0, at rest soon after
/// the end.
HIMC_RT himc_target himc_track_target(const himc_track *track, himc_hand hand, double t);
/// Place of the tip in the capture itself, with its strikes, at `t` (m); false before the take's
/// first frame, after its last, after a stop, and for a hand that is not in it.
HIMC_RT bool himc_track_captured(const himc_track *track, himc_hand hand, double t, himc_vec3 *x);
bool himc_track_has_posture(const himc_track *track);
/// Replaces the joints in `motion` by the captured ones at `t`, as far as the take has them; arms
/// of hands without tips stay as they are. Then the arms are bent as little as brings the tips to
/// `tip`, so the joints meet the strikes, and leave them, as the tips do. An arm without a stick
/// (its end 0.15 m or more from the tip in most frames) is bent from its state in `motion`. With
/// `tip` NULL all joints are as captured, bounces included.
HIMC_RT void himc_track_posture(const himc_track *track, const himc_skeleton *skeleton, double t,
                                const himc_target tip[HIMC_HANDS], himc_posture_motion *motion);
/// Time of the hand's present or next strike at `t`, and its point (x, y) on the head; false if
/// there is none.
HIMC_RT bool himc_track_current(const himc_track *track, himc_hand hand, double t,
                                double *contact_time, double *x, double *y);

#endif
