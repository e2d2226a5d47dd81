/// drum.h: a drum: a membrane with a name, a place, a mallet and pickups; what `[membrane~ NAME]`
/// and a score's `drum` make.
///
/// A drum is shared by the object that shows it and the performer that strikes it, so it counts
/// references. All calls come from one thread. Time is counted in samples since the drum was made
/// or realigned. Positions (x, y) on the head are in metres from its centre, x away from the
/// performer, y to the left. Functions with a himc_error return NULL or false if they refuse, write
/// one line into it (which may be NULL), and change nothing.
#ifndef HIMC_DRUM_H
#define HIMC_DRUM_H

#include "himc/command.h"

HIMC_BEGIN

/// A drum. Opaque; freed with its last reference.
typedef struct himc_drum himc_drum;
typedef struct himc_membrane himc_membrane; ///< membrane.h

/// A drum of the given diameter (inches, 12 .. 60; the timpani have 20, 23, 26, 29, 32) at
/// `sample_rate` (Hz, 8000 .. 192000). The name has less than HIMC_NAME_SIZE characters. One
/// reference belongs to the caller.
himc_drum *himc_drum_new(const char *name, double inches, double sample_rate, himc_error *error);
/// Adds a reference; returns `drum`.
himc_drum *himc_drum_retain(himc_drum *drum);
/// Gives a reference back; the last one frees the drum. NULL is allowed.
void himc_drum_release(himc_drum *drum);

/// Its name, borrowed.
const char *himc_drum_name(const himc_drum *drum);
/// Where the head stands. Borrowed.
HIMC_RT const himc_head_frame *himc_drum_head_frame(const himc_drum *drum);
/// Its head, for himc/membrane.h. Borrowed; to change it, send commands to the drum.
HIMC_RT himc_membrane *himc_drum_membrane(himc_drum *drum);

/// Carries out a drum command now.
bool himc_drum_command(himc_drum *drum, const himc_command *command, himc_error *error);
/// Calls `line` with one line about its state for a person (size, tuning, modes, mallet, place), or
/// with a command for each setting.
void himc_drum_describe(const himc_drum *drum, himc_description what,
                        void (*line)(void *, const char *), void *user);

/// Sample rate (Hz).
HIMC_RT double himc_drum_rate(const himc_drum *drum);
/// Sets another sample rate (Hz, 8000 .. 192000); the sound goes on.
bool himc_drum_set_rate(himc_drum *drum, double sample_rate, himc_error *error);

/// Delay of himc_drum_strike_at that checks the other arguments and strikes nothing.
#define HIMC_STRIKE_NEVER (-2147483647 - 1)

/// Strikes the drum `delay` samples from now (0 .. 8192, or HIMC_STRIKE_NEVER), exact to the
/// sample, with a free mallet at (x, y) on the head (m) and a downward velocity of 0.001 .. 30 m/s.
/// At most 64 strikes wait. False with the reason if an argument is out of range or too many wait.
HIMC_RT bool himc_drum_strike_at(himc_drum *drum, int delay, double x, double y, double velocity,
                                 himc_error *error);

/// Advances a drum that no performer drives by `n` samples, with its own strikes and an outside
/// force. Fills the ring that himc_drum_read reads. `force` (N, down positive) (n) may be NULL for
/// none; a value that is not finite counts as 0, one beyond HIMC_FORCE_MAX as that. It acts at `x`,
/// `y` (m) (n), which is also the watched point; NULL: the point stays where it is, at first 0.75
/// of the radius towards the performer.
HIMC_RT void himc_drum_advance(himc_drum *drum, int n, const double *force, const double *x,
                               const double *y);

#ifndef HIMC_DRUM_RING
#define HIMC_DRUM_RING 32768 ///< samples that can be read back
#endif

/// Has the drum heard by two ears at the usual place while no performer has it, as the performer's
/// `listener usual` does; at first it is heard by its pickups. False with the reason: no memory.
bool himc_drum_set_usual_listener(himc_drum *drum, himc_error *error);
/// Copies the sound in one channel (of the first pickup, 1.0 as it says, membrane.h; or of both
/// ears, their mean) and the displacement of the watched point (m, up positive) of samples
/// [start, start + n), counted since the last realign. Either may be NULL. Samples outside the ring
/// are 0.
HIMC_RT void himc_drum_read(const himc_drum *drum, uint64_t start, int n, double *sound,
                            double *displacement);
/// The sound of pickup `channel` (0 .. HIMC_PICKUPS - 1; the command `pickups CHANNELS` sets how
/// many there are, the others are silent, but a single one is also channel 1). While a `listener`
/// hears the drum, channel 0 is the left ear, 1 the right one; the others stay pickups.
HIMC_RT void himc_drum_read_channel(const himc_drum *drum, int channel, uint64_t start, int n,
                                    double *sound);
/// Whether the displacement of the watched point is computed, as it is at first; without, it reads
/// as 0 and the drum costs less.
HIMC_RT void himc_drum_watch(himc_drum *drum, bool on);
/// Takes outline, head and pickups of `other`, and, unless a performer has the drum, its place and
/// who hears it: for a second drum that sounds together with it. Its own sound goes on. Memory is
/// allocated.
bool himc_drum_follow(himc_drum *drum, const himc_drum *other, himc_error *error);
/// True if there is nothing to follow.
HIMC_RT bool himc_drum_follows(const himc_drum *drum, const himc_drum *other);
/// Samples advanced since the last realign.
HIMC_RT uint64_t himc_drum_time(const himc_drum *drum);
/// Counts time from 0 again; the last `ahead` samples become samples 0 .. ahead - 1. The sound goes
/// on.
HIMC_RT void himc_drum_realign(himc_drum *drum, int ahead);

/// A finished contact.
typedef struct himc_contact_report {
    double time;     ///< of the first force (s since the drum's realign)
    double x;        ///< on the head, away from the performer (m)
    double y;        ///< on the head, to the left (m)
    double velocity; ///< of impact, downward positive (m/s)
    double force;    ///< peak (N)
    double impulse;  ///< integral of the force (N s)
    double duration; ///< from first to last force (s)
} himc_contact_report;

/// Takes the oldest report of a finished strike (himc_drum_strike_at); false if none waits. Of more
/// than 64 the latest are kept.
HIMC_RT bool himc_drum_strike_next(himc_drum *drum, himc_contact_report *report);

/// A contact as it begins, of any stick or mallet.
typedef struct himc_contact_onset {
    int64_t at;      ///< its first sample, counted as himc_drum_time does
    double x;        ///< on the head, away from the performer (m)
    double y;        ///< on the head, to the left (m)
    double velocity; ///< of impact, downward positive (m/s)
    double distance; ///< from the centre, per radius, 0 .. 1
    double pitch;    ///< of the head's principal mode (Hz)
} himc_contact_onset;

/// Takes the oldest contact onset; false if none waits. Of more than 64 the latest are kept.
HIMC_RT bool himc_drum_contact_next(himc_drum *drum, himc_contact_onset *onset);

/// How contacts become sound: by the head's modes, or outside the library from contact onsets (by
/// signals, or by clips of recorded sound). The head vibrates and pushes back in any case.
/// In the order of the words of `technique`.
typedef enum himc_technique {
    HIMC_TECHNIQUE_MODAL,  ///< by the head's modes
    HIMC_TECHNIQUE_SIGNAL, ///< by signals outside the library
    HIMC_TECHNIQUE_CLIP    ///< by clips of recorded sound outside the library
} himc_technique;

/// The technique that the command `technique` has set. While it is not modal, the head's own sound
/// is off (faded in 10 ms).
HIMC_RT himc_technique himc_drum_technique(const himc_drum *drum);
/// Tells the drum whether its contact onsets are sounded outside the library, at first false. Only
/// then `technique` accepts signal and clip.
void himc_drum_set_external_sound(himc_drum *drum, bool external);

/// The performer that has taken a drum and advances it; with performer NULL the drum's own object
/// advances it (himc_drum_advance).
typedef struct himc_drum_driver {
    /// brings performer and drum to sample `time`, counted as himc_drum_time does
    void (*advance_to)(void *performer, uint64_t time);
    void *performer; ///< borrowed; NULL: nobody drives the drum
} himc_drum_driver;
/// False if another performer drives the drum already. A driver with performer NULL gives it back.
bool himc_drum_set_driver(himc_drum *drum, himc_drum_driver driver);
/// The driver that was set last; its performer is NULL if there is none.
HIMC_RT himc_drum_driver himc_drum_get_driver(const himc_drum *drum);

HIMC_END

#endif
