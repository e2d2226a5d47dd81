/// drum.h: a membrane with a name, a place, a mallet and an ear; what `[membrane~ NAME]` and a
/// score's `drum` make.
///
/// A drum is shared by the object that shows it and the performer that strikes it, so it counts its
/// references. All calls come from one thread. Time is counted in samples since the drum was made
/// or realigned.
#ifndef HIMC_DRUM_H
#define HIMC_DRUM_H

#include "himc/command.h"

typedef struct himc_drum himc_drum;
typedef struct himc_membrane himc_membrane;       ///< membrane.h
typedef struct himc_mallet_head himc_mallet_head; ///< membrane.h
typedef struct himc_stick himc_stick;             ///< membrane.h

/// What a finished contact was.
typedef struct himc_contact_report {
    double time;     ///< of the first touch (s since the drum's realign)
    double x, y;     ///< place on the head (m)
    double velocity; ///< of impact, downward positive (m/s)
    double force;    ///< peak (N)
    double impulse;  ///< (N s)
    double duration; ///< (s)
} himc_contact_report;

/// A drum of the given diameter (inches, 12 .. 60; the timpani are 23, 26, 29, 32) at `sample_rate`
/// (Hz, 8000 .. 192000). One reference belongs to the caller.
himc_drum *himc_drum_new(const char *name, double inches, double sample_rate, himc_error *error);
himc_drum *himc_drum_retain(himc_drum *drum);
void himc_drum_release(himc_drum *drum);

const char *himc_drum_name(const himc_drum *drum);
HIMC_RT const himc_head_frame *himc_drum_head_frame(const himc_drum *drum);
/// Whether `place` has said where it stands.
HIMC_RT bool himc_drum_is_placed(const himc_drum *drum);
/// Puts a drum there until `place` says where.
HIMC_RT void himc_drum_stand(himc_drum *drum, himc_vec3 center);
HIMC_RT himc_membrane *himc_drum_membrane(himc_drum *drum);
/// The mallet that strikes it: `mallet soft|medium|hard|wood|K ALPHA MASS`.
HIMC_RT const himc_mallet_head *himc_drum_mallet(const himc_drum *drum);
/// Grows by one whenever place, radius or mallet change, so that a performer notices.
HIMC_RT unsigned himc_drum_revision(const himc_drum *drum);

/// Carries out a drum command now. False, and nothing changed, if it cannot be.
bool himc_drum_command(himc_drum *drum, const himc_command *command, himc_error *error);
/// The same `delay` samples from now (0 .. 8192), exact to the sample; at most 64 wait. `strike`
/// only.
HIMC_RT bool himc_drum_strike_at(himc_drum *drum, int delay, double x, double y, double velocity,
                                 himc_error *error);
HIMC_RT double himc_drum_rate(const himc_drum *drum);
/// Another sample rate; what sounds goes on sounding.
bool himc_drum_set_rate(himc_drum *drum, double sample_rate, himc_error *error);

/// Advances the head by `n` samples with the given sticks in micro-contact (0 .. HIMC_STICKS of
/// them), its own free mallets from `strike`, and an outside force. Fills the ring that
/// himc_drum_read reads.
/// @param sticks    their x, v, force evolve (contact.h); may be NULL when stick_count is 0
/// @param forces    forces[s][i] receives the force of stick s in sample i (N); NULL if unwanted
/// @param outside   force (N) applied at (x, y)[i], or NULL
HIMC_RT void himc_drum_advance(himc_drum *drum, int n, himc_stick *const *sticks, int stick_count,
                               double *const *forces, const double *outside, const double *x,
                               const double *y);

/// Copies the sound and the displacement under the spot (m; either may be NULL) of samples [start,
/// start + n) as counted since the last realign; silence for what is not there.
#define HIMC_DRUM_RING 32768
HIMC_RT void himc_drum_read(const himc_drum *drum, uint64_t start, int n, double *sound,
                            double *displacement);
/// The sound of one pickup, 0 .. HIMC_PICKUPS - 1 (`pickups CHANNELS` sets how many there are;
/// silence for those that are not).
HIMC_RT void himc_drum_read_channel(const himc_drum *drum, int channel, uint64_t start, int n,
                                    double *sound);
/// Samples advanced since the last realign.
HIMC_RT uint64_t himc_drum_time(const himc_drum *drum);
/// Counts from 0 again, the last `ahead` samples already made becoming samples 0 .. ahead - 1; the
/// sound goes on.
HIMC_RT void himc_drum_realign(himc_drum *drum, int ahead);

/// How blows become sound: by the head's modes, or by whoever asks for its touches (by signals, or
/// clips of recorded sound). The head goes on swinging and pushing back in any case. In the order
/// of the words of `technique`.
typedef enum himc_technique {
    HIMC_TECHNIQUE_MODAL,
    HIMC_TECHNIQUE_SIGNAL,
    HIMC_TECHNIQUE_CLIP
} himc_technique;

/// What `technique` has set; while it is not modal the sound has faded (10 ms).
HIMC_RT himc_technique himc_drum_technique(const himc_drum *drum);
/// Whether somebody asks for its touches and sounds them. Until then modal alone is allowed.
void himc_drum_set_answered(himc_drum *drum, bool answered);
HIMC_RT bool himc_drum_is_answered(const himc_drum *drum);

/// A blow as it begins, whoever strikes.
typedef struct himc_touch {
    int64_t at;      ///< its first sample, counted as himc_drum_time does
    double x, y;     ///< place on the head (m)
    double velocity; ///< of impact, downward positive (m/s)
    double place;    ///< distance from the centre per radius, 0 .. 1
    double pitch;    ///< of the head's principal mode (Hz)
} himc_touch;

/// The oldest touch that nobody has asked for; of more than 64 the latest are kept. False if none
/// waits.
HIMC_RT bool himc_drum_touch_next(himc_drum *drum, himc_touch *touch);

/// Who advances this drum: the performer that has taken it, or nobody (then its own object does).
typedef struct himc_drum_driver {
    void (*advance_to)(void *performer,
                       uint64_t time); ///< brings performer and drum to that sample
    void *performer;
} himc_drum_driver;
/// False if another performer drives it already. A driver with performer NULL gives it back.
bool himc_drum_set_driver(himc_drum *drum, himc_drum_driver driver);
HIMC_RT himc_drum_driver himc_drum_get_driver(const himc_drum *drum);

/// A hit made without a performer ended: for `strike` messages. False if none waits.
HIMC_RT bool himc_drum_strike_next(himc_drum *drum, himc_contact_report *report);

/// One line about its state: size, tuning, modes, mallet, place.
void himc_drum_describe(const himc_drum *drum, char *text, size_t size);

#endif
