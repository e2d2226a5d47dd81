/// take_data.h: what a take is made of, shared by its readers (and, later, writers); private.
///
/// A reader fills format, rate, frames, points and what the file says of units and axes, in the
/// file's own unit and axes; himc_take_settle then brings all of it into the library's frame.
#ifndef HIMC_TAKE_DATA_H
#define HIMC_TAKE_DATA_H

#include "himc/mocap.h"

#define TAKE_NAME 64
#define TAKE_NOTES 16
#define TAKE_FAR 1e8 ///< no coordinate, offset or angle of a real file is beyond it, in any unit

struct himc_take {
    char file[192];           ///< as errors name it
    char format[48];          ///< "C3D (Intel, floats)"
    double rate;              ///< (Hz)
    int frames, points;       ///< counts
    int first_frame;          ///< the file's number of frame 0
    char (*names)[TAKE_NAME]; ///< (points)
    himc_vec3 *x;             ///< (frames x points), NaN in gaps
    int *parents;             ///< (points), NULL without skeleton
    himc_vec3 *offsets;       ///< (points), NULL without skeleton
    himc_quat *rotations;     ///< (frames x points), NULL without skeleton
    himc_take_event *events;
    int event_count;

    double mass, height;  ///< of the player as the file says (kg, m), 0 if it does not
    double file_unit;     ///< (m), 0 if the file does not say
    himc_vec3 file_up;    ///< unit axis as the file says, 0 if it does not
    himc_vec3 file_right; ///< axis towards the right of the screen, or 0
    himc_vec3 habit_up;   ///< the format's habit
    char units_text[128]; ///< how units and axes were decided, for describe
    char axes_text[192];
    char notes[TAKE_NOTES][192]; ///< what was repaired, and where
    int note_count;

    himc_vec3 *tip[HIMC_HANDS]; ///< (frames), filled
};

/// Checks rate and size and allocates; names are empty, positions 0. The limits are those of
/// himc_take_load.
bool himc_take_allocate(himc_take *take, double rate, int frames, int points, bool skeleton,
                        himc_error *error);
/// Sets a point's name: printable characters only, blanks at the ends cut; "P7" if nothing is left.
void himc_take_set_name(himc_take *take, int point, const char *name, size_t length);
/// Keeps a line for describe; after TAKE_NOTES the rest are dropped.
void himc_take_note(himc_take *take, const char *format, ...) __attribute__((format(printf, 2, 3)));

static inline himc_vec3 *himc_take_at(const himc_take *take, int frame, int point)
{
    return &take->x[(size_t)frame * (size_t)take->points + (size_t)point];
}

static inline himc_vec3 himc_vec3_gap(void)
{
    return himc_vec3_make(NAN, NAN, NAN);
}

/// Readers: from the whole file's bytes. False with the error line complete.
bool himc_bvh_read(himc_take *take, const char *bytes, size_t size, himc_error *error);
bool himc_c3d_read(himc_take *take, const unsigned char *bytes, size_t size, himc_error *error);
bool himc_trc_read(himc_take *take, const char *bytes, size_t size, himc_error *error);

/// Metres per unit by its name ("mm", "Centimeters", "in"); 0 if unknown.
double himc_take_unit(const char *name);
/// Turns runs of exact zeros that a trajectory jumps to into gaps, with a note (marker files).
void himc_take_drop_zeros(himc_take *take);
/// Turns frames in which a point jumps away and back into gaps, with a note; in metres.
void himc_take_drop_spikes(himc_take *take);
/// Brings everything into metres and the library's axes.
bool himc_take_settle(himc_take *take, const himc_take_options *options, himc_error *error);
/// The same for lengths alone: finds the unit, says how in units_text, scales.
bool himc_take_settle_units(himc_take *take, const himc_take_options *options, himc_error *error);

/// Copies letters and digits in lower case, without a prefix that ends in ':'.
void himc_take_plain_name(const char *name, char plain[TAKE_NAME]);
/// Reads a plain name as words around at most one side ("l", "left", "r", "right"): the hand,
/// HIMC_HANDS for no side, or -1 if anything is left over. `words` ends with NULL; `rest` gets the
/// words without the side.
int himc_take_side(const char *plain, const char *const *words, char rest[TAKE_NAME]);
/// Frames [begin, end) in which a point is not seen.
typedef struct himc_take_gap {
    int begin, end;
} himc_take_gap;

/// A point's places (frames), gaps bridged. Returns how many frames were, or -1 at a gap longer
/// than `longest` (s), or if the point is never seen; `gap` is that one then.
int himc_take_fill(const himc_take *take, int point, double longest, himc_vec3 *x,
                   himc_take_gap *gap);
/// Index of a hand's tip by its name, or -1.
int himc_take_find_tip(const himc_take *take, himc_hand hand, const himc_take_options *options);

#endif
