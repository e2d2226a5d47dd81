/// take.h: the data of a take, shared by readers, writers and analysis. The other
/// rooms load one (take_file.c) and ask for tips and strikes.
///
/// A reader fills format, rate, frames, points, and the unit and axes that the file states, all in
/// the unit and axes of the file; himc_take_settle then converts everything into the library's
/// frame.
#ifndef HIMC_TAKE_H
#define HIMC_TAKE_H

#include "himc/mocap.h"

#include "capture/strike_heads.h"

#include <stdio.h>

#define TAKE_NAME 64  ///< bytes of a point's name, with the final 0
#define TAKE_NOTES 16 ///< chosen: notes kept

// chosen: an hour at 250 Hz has 900000 frames, and 30 million positions take 720 MB
#define TAKE_MOST_FRAMES 1000000
#define TAKE_MOST_POSITIONS 30000000 ///< frames x points
#define TAKE_MOST_POINTS 65536       ///< a C3D counts its points in 16 bits

// players (kg, m): the ranges of himc_skeleton_config
#define TAKE_LEAST_MASS 30.0
#define TAKE_MOST_MASS 200.0
#define TAKE_LEAST_HEIGHT 1.19
#define TAKE_MOST_HEIGHT 2.21
#define TAKE_LARGEST 1e8 ///< chosen: no coordinate, offset or angle of a real file is larger

typedef struct himc_take_event {
    char label[32]; ///< "Right Foot Strike": context and label
    double time;    ///< from the first frame (s)
} himc_take_event;

struct himc_take {
    char file[192];           ///< name of the file in error lines
    char format[48];          ///< "C3D (Intel, floats)"
    double rate;              ///< (Hz)
    int frames, points;       ///< counts
    int first_frame;          ///< number of frame 0 in the file
    char (*names)[TAKE_NAME]; ///< (points)
    himc_vec3 *x;             ///< (frames x points), NaN in gaps
    int *parents;             ///< (points), NULL without skeleton
    himc_vec3 *offsets;       ///< (points), NULL without skeleton
    himc_quat *rotations;     ///< (frames x points), NULL without skeleton
    himc_take_event *events;  ///< (event_count)
    int event_count;
    char (*analog_names)[TAKE_NAME]; ///< (analog_channels): "EMG1 (V)"
    double *analog; ///< (analog_samples x analog_channels) in the file's units, NULL without
    int analog_channels, analog_samples;
    double analog_rate; ///< (Hz)

    double mass, height;         ///< of the player as the file states (kg, m), 0 if it does not
    double file_unit;            ///< length unit that the file states (m), 0 if it does not
    himc_vec3 file_up;           ///< unit axis that the file states, 0 if it does not
    himc_vec3 file_right;        ///< axis towards the right of the screen, or 0
    himc_vec3 format_up;         ///< up axis that is usual in this format
    char units_text[128];        ///< the unit and its source, for himc_take_describe
    char axes_text[192];         ///< the axes and their source
    char notes[TAKE_NOTES][192]; ///< repairs and doubts
    int note_count;

    himc_vec3 *tip[HIMC_HANDS]; ///< (frames), gaps filled
};

// The data: take.c.

/// Checks rate and counts, and allocates; names are empty, positions 0. The limits are those of
/// himc_take_load.
bool himc_take_allocate(himc_take *take, double rate, int frames, int points, bool skeleton,
                        himc_error *error);
/// Sets a point's name: printable characters only, blanks at the ends removed; "P7" if nothing is
/// left.
void himc_take_set_name(himc_take *take, int point, const char *name, size_t length);
/// Keeps a line for himc_take_describe; drops it if TAKE_NOTES are there.
void himc_take_note(himc_take *take, const char *format, ...) __attribute__((format(printf, 2, 3)));
int himc_take_missing(const himc_take *take, int point); ///< frames in which the point is in a gap

static inline himc_vec3 *himc_take_at(const himc_take *take, int frame, int point)
{
    return &take->x[(size_t)frame * (size_t)take->points + (size_t)point];
}

static inline himc_vec3 himc_vec3_gap(void)
{
    return himc_vec3_make(NAN, NAN, NAN);
}

/// Copies letters and digits in lower case, without a prefix that ends in ':'.
void himc_take_plain_name(const char *name, char plain[TAKE_NAME]);
/// Reads a plain name as known words and at most one word for the side ("l", "left", "r", "right").
/// Returns the hand, HIMC_HANDS if no side is given, or -1 if anything else is in the name. `words`
/// ends with NULL; `rest` gets the words without the side.
int himc_take_side(const char *plain, const char *const *words, char rest[TAKE_NAME]);

// Several players: take_subject.c.

/// Keeps the points of the subject `wanted`, before anything is measured; NULL keeps all, and notes
/// if there are several. False with the names that there are.
bool himc_take_choose_subject(himc_take *take, const char *wanted, himc_error *error);

// Gaps: take_gaps.c.

/// Frames [begin, end) in which a point is not seen.
typedef struct himc_take_gap {
    int begin, end;
} himc_take_gap;

/// The point's first gap in the frames from `from` on; it begins behind the last frame if there is
/// none.
himc_take_gap himc_take_next_gap(const himc_take *take, int point, int from);
/// Turns runs of exact zeros to which a trajectory jumps into gaps, with a note (marker files, in
/// the file's unit).
void himc_take_drop_zeros(himc_take *take);
/// Turns frames in which a point jumps away and back into gaps, with a note (in metres).
void himc_take_drop_spikes(himc_take *take);
/// Writes the positions of a point (frames) with gaps bridged. Returns the number of bridged
/// frames; -1 if a gap is longer than `longest` (s) or the point is never seen, then `gap` is that
/// gap.
int himc_take_fill(const himc_take *take, int point, double longest, himc_vec3 *x,
                   himc_take_gap *gap);

/// a + b u + c u^2, u in frames from `origin`.
typedef struct himc_parabola {
    himc_vec3 a, b, c;
    int origin;
} himc_parabola;

/// Least squares over n samples origin, origin + step (1 or -1), ...; fewer than 3 give a line or a
/// constant.
himc_parabola himc_take_parabola(const himc_vec3 *x, int origin, int step, int n);

// Stick tips and strikes: take_tips.c, take_strikes.c.

/// Index of the point that is a hand's tip by its name, or -1.
int himc_take_find_tip(const himc_take *take, himc_hand hand, const himc_take_options *options);
/// The strikes of a take, the drumheads under them, and what was taken for none. A place on a head
/// is that of a tip that touches it: the mean over the hands of the median place of their strikes
/// there, at the height of the plane through all strikes on it. A fall and its rebound meet below
/// the head: on the simulated head a mallet stays some 7 ms, and the place is so high that such a
/// contact joins the two.
typedef struct himc_strike_survey {
    himc_take_strike *strikes;         ///< in order of time (count), to be freed by the caller
    int count, heads;                  ///< of strikes; of heads, 0 without strikes
    himc_vec3 head[HIMC_STRIKE_HEADS]; ///< places on them, the most struck first (m)
    int left_out;                      ///< falls that end as abruptly as strikes, but on no head
    double lowest, highest;            ///< of their ends above head 0 (m)
    double fastest;                    ///< of them (m/s)
} himc_strike_survey;

/// Finds the strikes of both tips. False without memory; then nothing is to be freed.
bool himc_take_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                       himc_strike_survey *survey);

/// The fastest fall of the tip between two frames just before the strike (m/s).
double himc_take_fastest_fall(const himc_take *take, const himc_take_tip *tip,
                              const himc_take_strike *strike);
/// A strike that is faster by more than this is extrapolated; chosen: a frame's own acceleration.
#define HIMC_TAKE_CARRIED_ON 1.02

// The library's frame: take_frame.c.

/// Metres per unit by the unit's name ("mm", "Centimeters", "in"); 0 if unknown.
double himc_take_unit(const char *name);
/// Converts everything into metres and the library's axes.
bool himc_take_settle(himc_take *take, const himc_take_options *options, himc_error *error);

/// Library axes to those of BVH and TRC files, which are y up: (x, y, z) becomes (x, z, -y).
static inline himc_vec3 himc_take_y_up(himc_vec3 x)
{
    return himc_vec3_make(x.x, x.z, -x.y);
}

// Formats: bvh.c, c3d.c, marker_table.c.

/// A row a format, READ of one that is only read: its suffix, and how its files begin, several ways
/// joined by '|', where \a stands for any byte below 8. himc_SUFFIX_read gets the bytes of the
/// whole file; it and himc_SUFFIX_write return false with a complete error line.
#define HIMC_TAKE_FORMATS(READ, BOTH)              \
    BOTH(bvh, "HIERARCHY")                         \
    BOTH(c3d, "\aP")                               \
    BOTH(trc, "PathFileType")                      \
    READ(csv, "Trajectories|Format Version|time,") \
    READ(tsv, "NO_OF_FRAMES")

#define HIMC_TAKE_READER(suffix, begins) \
    bool himc_##suffix##_read(himc_take *take, const void *bytes, size_t size, himc_error *error);
#define HIMC_TAKE_WRITER(suffix, begins) \
    HIMC_TAKE_READER(suffix, begins)     \
    bool himc_##suffix##_write(FILE *file, const himc_take *take, himc_error *error);
HIMC_TAKE_FORMATS(HIMC_TAKE_READER, HIMC_TAKE_WRITER)
#define HIMC_C3D_LABELS 255 ///< most points or channels written; a parameter's dimension is a byte
/// A number of 32 bits of a C3D's processor (84 Intel, 85 DEC, 86 MIPS); NaN where reserved.
double himc_c3d_real(int processor, const unsigned char *at);

// Files: take_file.c.

/// Begins an error about the take of that path with it, unless it does already; returns false.
bool himc_take_name_error(const char *path, himc_error *error);

/// himc_take_load from memory; `name` gives the suffix and begins the error line. The bytes are not
/// kept.
himc_take *himc_take_read(const void *bytes, size_t size, const char *name,
                          const himc_take_options *options, himc_error *error);
/// As himc_take_load; with a `folder` (not NULL) only a file inside it (himc_file_load_in).
himc_take *himc_take_load_in(const char *folder, const char *path, const himc_take_options *options,
                             himc_error *error);
/// True if the suffix is that of a motion capture, also of one that is refused.
bool himc_take_is_capture(const char *path);
/// The suffix of the format that begins so, with its dot; NULL if none does.
const char *himc_take_suffix_of(const void *bytes, size_t size);
/// Suffixes of the formats that are read: " .bvh .c3d ...".
#define HIMC_TAKE_SUFFIX(suffix, begins) " ." #suffix
#define HIMC_TAKE_SUFFIXES HIMC_TAKE_FORMATS(HIMC_TAKE_SUFFIX, HIMC_TAKE_SUFFIX)
/// True if the suffix is that of a format that is written; else the error line lists them.
bool himc_take_can_save(const char *path, himc_error *error);

// Recordings: recording.c.

/// The recording so far as a take, to be freed by the caller; NULL if there are no frames or no
/// memory.
himc_take *himc_recording_take(const himc_recording *recording, himc_error *error);
/// Path of the file, owned by the recording.
const char *himc_recording_path(const himc_recording *recording);
/// True if no file or a recording has that path. A score may not record over any other file: it may
/// come from somebody else.
bool himc_recording_may_replace(const char *path, himc_error *error);

#endif
