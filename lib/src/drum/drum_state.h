/// drum_state.h: the parts of a drum; shared by drum.c (sound), drum_strike.c (its own mallets,
/// contact onsets) and drum_command.c.
#ifndef HIMC_DRUM_STATE_H
#define HIMC_DRUM_STATE_H

#include "drum/drum_performer.h"
#include "drum/membrane_state.h"
#include "drum/stroke_noise.h"

#define DRUM_QUEUE 64       ///< strikes that wait, reports, onsets; this and the delay: chosen
#define DRUM_MAX_DELAY 8192 ///< (samples)

/// A strike that begins with sample `at`.
typedef struct drum_waiting {
    uint64_t at;
    double x, y, velocity;
    int kick; ///< as of himc_drum_kick; 0: not by a foot
} drum_waiting;

#define DRUM_NOT_TOLD (-1) ///< `kick` of a part of another stroke

/// A mallet in the air or on the head, without a hand.
typedef struct drum_mallet {
    bool used;
    himc_stick stick;
    uint64_t first;             ///< sample of the first force
    uint64_t end;               ///< sample after the last force
    int age;                    ///< samples since it was launched
    himc_contact_report report; ///< its force is 0 until it has felt one
    int kick;                   ///< as of drum_waiting
} drum_mallet;

/// A foot's stroke that is over.
typedef struct drum_kick {
    himc_contact_report report;
    uint64_t first; ///< sample of the first force
    int kick;
} drum_kick;

/// Entries of a ring, oldest first.
typedef struct drum_queue {
    int first, count;
} drum_queue;

/// The head of a drum that a score changes.
typedef struct drum_told_head {
    himc_head base;  ///< without the changes
    himc_head known; ///< of the drum, when it was last looked at
} drum_told_head;

/// A pedal on its way (drum_gliss.c).
typedef struct drum_gliss {
    himc_model *goal; ///< owned; the head at the end; else of no use, or NULL
    double tension;   ///< there (N/m)
    int left;         ///< steps to go; 0: the pedal rests
    uint64_t next;    ///< sample before which the next step is made
} drum_gliss;

struct himc_drum {
    himc_drum_settings set; ///< but for its head, which the membrane has
    int references;
    himc_membrane *membrane;
    drum_gliss gliss;
    const drum_told_head *told; ///< borrowed; of its changes in a score, NULL for none
    unsigned revision;
    himc_drum_driver driver;
    double rate;
    uint64_t time; ///< samples since the drum was made; all samples in here are counted so
    uint64_t zero; ///< the one that counts as 0 outside, since the last realign
    double ring[HIMC_PICKUPS + 1][HIMC_DRUM_RING]; ///< sound of each channel; the displacement
    uint64_t filled[HIMC_PICKUPS + 1]; ///< `time` after the last sample of a ring that may not be 0
    bool unwatched;                    ///< the displacement is not wanted
    double outside_x, outside_y;       ///< point of the outside force, the watched point
    drum_waiting waiting[DRUM_QUEUE];  ///< unordered
    int waiting_count;
    drum_mallet mallets[HIMC_STICKS];
    himc_contact_report reports[DRUM_QUEUE];
    drum_queue report_queue;
    drum_kick kicks[DRUM_QUEUE];
    drum_queue kick_queue;
    himc_contact_onset onsets[DRUM_QUEUE]; ///< `at` is in samples of `time`
    drum_queue onset_queue;
    double fader; ///< of all drums of its performer (factor)
    double level; ///< of the drum's own sound: on its way to the product, or to 0
    himc_stroke_noise noise;
    uint64_t laid_from, laid_until; ///< samples in which a hand lies on it, as a note ends
    double hold;                    ///< damp by that, and by sticks that are kept on the head
    double
        nearness[HIMC_PICKUPS]; ///< 1/distance of a pickup in the air, as its noise is heard (1/m)
    himc_listener listener;     ///< of its performer, or `alone`
    himc_listener alone;        ///< without a performer
    himc_walls walls;           ///< around the listener
    himc_ears *ears;            ///< owned; of the listener; NULL before the first one
};

/// The head after a checked command that changes it, but for `shape`. False with the reason if the
/// drum refuses it.
HIMC_RT bool himc_drum_find_head(const himc_shape *shape, const himc_head *usual,
                                 const himc_command *checked, himc_head *head, himc_error *error);
/// False with the reason if that surface cannot be struck so.
HIMC_RT bool himc_drum_may_strike(const himc_head_frame *surface, double x, double y,
                                  double velocity, himc_error *error);

/// True if the drum is heard by two ears, and not by its pickups.
HIMC_RT bool himc_drum_is_heard(const himc_drum *drum);
/// True while the pedal moves.
HIMC_RT bool himc_drum_glides(const himc_drum *drum);
/// Its head, with the tension to which the pedal moves.
HIMC_RT himc_membrane_config himc_drum_head_config(const himc_drum *drum);
/// Time that the pedal still needs (s).
HIMC_RT double himc_drum_gliss_rest(const himc_drum *drum);
/// Gives the drum that head: at once, or with a pedal that takes `seconds`; if they are negative, a
/// pedal that moves to the same tension goes on. *made, or NULL, is a model of the head, and
/// afterwards one that is of no use, or NULL; with it no memory is allocated. False with the
/// reason.
bool himc_drum_take_head(himc_drum *drum, const himc_membrane_config *to, double seconds,
                         himc_model **made, himc_error *error);
/// Samples until the pedal's next step, at most `most`.
HIMC_RT int himc_drum_until_gliss(const himc_drum *drum, int most);
HIMC_RT void himc_drum_go_gliss(himc_drum *drum);

/// Of a stroke's noise a cloth all over the head takes this part; chosen: 10 dB.
#define HIMC_MUFFLED_NOISE 0.7

/// How loud the noise of a stroke with that mallet is, and whose: none but where a timpanist's
/// mallet is usual, as its bands are a timpano's.
static inline void himc_drum_find_noise(himc_drum *drum, const himc_mallet_head *mallet)
{
    double bare = 1 - HIMC_MUFFLED_NOISE * himc_membrane_head(drum->membrane)->muffle;
    bool other = himc_membrane_config_of(drum->membrane)->shape.kind->mallet;
    drum->noise.amount = other ? 0 : drum->set.noise * mallet->noise * bare;
    drum->noise.seed = drum->set.noise_seed;
}

/// After the drum's place, its rate or its rays have changed: finds the ways to the listener anew.
HIMC_RT void himc_drum_find_ways(himc_drum *drum);

/// Launches the strikes that are due, as long as a mallet is free; the others go on waiting.
HIMC_RT void himc_drum_launch(himc_drum *drum);
/// After the tip of a rim shot has met the head: its shaft falls on the hoop. The hand does not
/// feel that.
HIMC_RT void himc_drum_launch_shaft(himc_drum *drum, himc_stick *stick);
/// Samples until the next strike is due, at most `most`; 0 if one is due.
HIMC_RT int himc_drum_until_launch(const himc_drum *drum, int most);
/// Adds the mallets in use to `sticks`; returns their number.
HIMC_RT int himc_drum_add_mallets(himc_drum *drum, himc_stick **sticks);
/// After a sample: updates the reports of the mallets, and ends those that have left.
HIMC_RT void himc_drum_follow_mallets(himc_drum *drum);

/// Queues the onset of the contact that this stick has begun in the last sample.
HIMC_RT void himc_drum_keep_onset(himc_drum *drum, const himc_stick *stick);

/// In the order of the words of `mallet`.
typedef enum drum_mallet_preset {
    DRUM_MALLET_SOFT,
    DRUM_MALLET_MEDIUM,
    DRUM_MALLET_HARD,
    DRUM_MALLET_WOOD,
    DRUM_MALLET_USUAL ///< that of the instrument's kind
} drum_mallet_preset;

void himc_drum_take_mallet(himc_drum_settings *settings, drum_mallet_preset preset);

#endif
