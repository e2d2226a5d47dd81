/// drum_state.h: what a drum is made of; shared by drum.c (sound), drum_strike.c (its own mallets),
/// drum_touch.c (blows told as they begin) and drum_command.c.
#ifndef HIMC_DRUM_STATE_H
#define HIMC_DRUM_STATE_H

#include "himc/drum.h"
#include "himc/membrane.h"

#define DRUM_WAITING 64
#define DRUM_REPORTS 64
#define DRUM_MAX_DELAY 8192
#define DRUM_TOUCHES 64

/// A strike that is to begin with sample `at`.
typedef struct drum_waiting {
    uint64_t at;
    double x, y, velocity;
} drum_waiting;

/// A mallet in the air or on the head, without a hand.
typedef struct drum_mallet {
    bool used;
    himc_stick stick;
    uint64_t touch;   ///< sample of the first force
    uint64_t release; ///< sample after the last force
    bool touched;
    int age; ///< samples since it was launched
    himc_contact_report report;
} drum_mallet;

struct himc_drum {
    char name[HIMC_NAME_SIZE];
    int references;
    himc_membrane *membrane;
    himc_mallet_head mallet;
    char mallet_name[16]; ///< "medium", or "own" when given by numbers
    himc_head_frame place;
    bool placed; ///< by `place`
    unsigned revision;
    himc_drum_driver driver;
    double rate;
    uint64_t time; ///< samples since it was made; what sample counts in here are
    uint64_t zero; ///< the one that counts as 0 outside, since the last realign
    double sound[HIMC_PICKUPS][HIMC_DRUM_RING], seen[HIMC_DRUM_RING];
    double spot_x, spot_y;              ///< of the force from outside
    drum_waiting waiting[DRUM_WAITING]; ///< unordered
    int waiting_count;
    drum_mallet mallets[HIMC_STICKS];
    himc_contact_report reports[DRUM_REPORTS]; ///< ring, oldest first
    int report_first, report_count;
    himc_technique technique;
    bool answered;
    double level;                     ///< that the head's own sound has faded to, 0 .. 1
    himc_touch touches[DRUM_TOUCHES]; ///< ring, oldest first; `at` is in samples of `time`
    int touch_first, touch_count;
};

/// Launches the strikes that are due while a mallet is free; the rest go on waiting.
HIMC_RT void himc_drum_launch(himc_drum *drum);
/// Samples until the next strike is due, at most `most`; 0 when one is due and a mallet free for
/// it.
HIMC_RT int himc_drum_until_launch(const himc_drum *drum, int most);
/// Adds the mallets in use to `sticks`; returns how many.
HIMC_RT int himc_drum_add_mallets(himc_drum *drum, himc_stick **sticks);
/// Keeps the books of the mallets after a sample: touch, peak, impulse, and the end.
HIMC_RT void himc_drum_follow_mallets(himc_drum *drum);

/// Keeps the touch that this stick has begun in the last sample.
HIMC_RT void himc_drum_keep_touch(himc_drum *drum, const himc_stick *stick);
/// Level of the head's own sound in the coming sample.
HIMC_RT double himc_drum_loudness(himc_drum *drum);

/// Whether a drum may stand there: within 10 m of the origin on each axis.
bool himc_drum_check_place(himc_vec3 center, himc_error *error);
/// Brings the head to rest, without a click, and drops the drum's own mallets and waiting strikes.
HIMC_RT void himc_drum_rest(himc_drum *drum);

/// The preset's numbers; false if there is none of that name.
bool himc_drum_mallet_preset(const char *name, himc_mallet_head *head);

#endif
