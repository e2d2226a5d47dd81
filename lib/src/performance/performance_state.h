/// performance_state.h: the parts of a performance, and the functions of the files that work on
/// several of them.
///
/// Each part has its own type and one file that writes it; other files read it or call that file's
/// functions. In the order of the calls:
///
///     performance_settings        the settings: one table
///     performance_clock, _events, _queue, _statistics, _drums, _body, _motion    the parts alone
///     performance_contacts        sticks on heads: acts on motion, statistics and events
///     performance_report.c        reports: figures, rows of motion, `info`; the recording
///     performance_pedal.c         the foot on a pedal: acts on motion
///     performance_setup.c         new, rebuild, reset: puts the parts together
///     performance_change.c        what a score has at beats: pedals, hands, pushes
///     performance_play.c, _take.c, _score.c     playing strokes, takes and scores
///     performance_command.c       the commands
///     performance_dump.c          the state as commands, for `dump` and saved states
///     performance.c               the step
#ifndef HIMC_PERFORMANCE_STATE_H
#define HIMC_PERFORMANCE_STATE_H

#include "base/job.h"
#include "base/line.h"
#include "base/text.h"
#include "himc/mocap.h"
#include "performance/performance_body.h"
#include "performance/performance_clock.h"
#include "performance/performance_contacts.h"
#include "performance/performance_drums.h"
#include "performance/performance_events.h"
#include "performance/performance_motion.h"
#include "performance/performance_queue.h"
#include "performance/performance_settings.h"
#include "performance/performance_statistics.h"
#include "plan/score.h"

/// The host's settings; `reset` keeps them.
typedef struct performance_host {
    himc_performance_config config; ///< given to himc_performance_new
    himc_take_options take_options;
    performance_settings usual;                         ///< of `reset`
    bool make_drums;                                    ///< `drum` makes one that sounds
    void (*on_motion)(void *, const himc_motion_row *); ///< at each task tick; NULL: none
    void *motion_user;
    void (*on_tick)(void *, const himc_tick *); ///< as well
    void *tick_user;
} performance_host;

typedef struct performance_recording {
    himc_recording *file; ///< owned; NULL when nothing is recorded
    bool full;            ///< and the user was notified
} performance_recording;

/// What commands have written, for `dump`.
typedef struct performance_written {
    himc_text_lines score;     ///< strokes, ornaments and changes of heads
    himc_text_lines units;     ///< the commands `units`
    himc_dynamics dynamics;    ///< of strokes to come; they are written with theirs
    char take[HIMC_PATH_SIZE]; ///< the file of the take; "" without one
    himc_command take_command; ///< that has loaded it; without atoms if it came from memory
} performance_written;

#define SYNC_TICKS 24 // of a beat of MIDI

/// The clock that tempo and beat follow.
typedef struct performance_sync {
    double beat; ///< of it
    double halt; ///< its beat when it was stopped, NAN: it was not
    struct {
        double time, beat; ///< (s, beats)
    } seen[SYNC_TICKS];    ///< a ring of the last `count`
    long count;
    double bpm; ///< its mean tempo, while it is followed; else 0
} performance_sync;

struct himc_performance {
    himc_runner runner; ///< the first, for loader.c; a score's lines are carried out by it, too
    performance_host host;
    performance_settings settings;
    performance_clock clock;
    performance_queue queue;
    performance_sync sync;
    performance_drums drums;
    performance_motion *motion;
    performance_body *body;
    performance_contacts contacts;
    performance_statistics statistics;
    himc_energy energy; ///< at the last task tick, if rows of motion are asked for
    performance_recording recording;
    performance_written written;
    performance_events events;
};

/// Time of the next step (s).
static inline double step_time(const himc_performance *p)
{
    return himc_clock_time(&p->clock);
}

// A function whose name ends with _job makes the job of a command; NULL with the reason.

// performance_report.c
/// Notes the energies at a task tick, before the step, if rows of motion are asked for.
HIMC_RT void himc_performance_take_energy(himc_performance *p);
/// Gives the state to host and recording, at a task tick.
HIMC_RT void himc_performance_tell_tick(himc_performance *p, double t);
void himc_performance_drop_recording(himc_performance *p);
/// True if the command is allowed while recording, or while not: `record` and `rate` may not be.
bool himc_performance_allows(bool recording, const himc_command *command, himc_error *error);
himc_job *himc_performance_record_job(himc_performance *p, const himc_command *command,
                                      himc_error *error);

void himc_performance_inform(const himc_performance *p, himc_line_sink to);
/// Tells a drum's state, each line after its name (himc_drum_tell_state).
void himc_performance_tell_drum(const himc_drum *drum, bool placed, const himc_line_sink *to);

// performance_dump.c
himc_job *himc_performance_dump_job(himc_performance *p, const himc_command *command,
                                    himc_error *error);

/// Room for one more line; false with the reason, which begins with `command`.
bool himc_written_room(himc_text_lines *lines, const char *command, himc_error *error);
/// A stroke as it is asked for, with its ornament.
void himc_written_stroke(himc_text_lines *lines, const himc_stroke *stroke);
/// A change of a head in a score whose beat 0 is at beat `from`.
void himc_written_change(himc_text_lines *lines, const himc_score_line *change, double from);
void himc_written_units(himc_text_lines *lines, const himc_command *command);

// performance_pedal.c
/// Sends a foot of one who sits to the pedal that moves next, or back; a take shows its own.
HIMC_RT void himc_performance_move_foot(himc_performance *p, double t);

// performance_setup.c
/// A performance that takes no commands yet; NULL with the reason.
himc_performance *himc_performance_make(const himc_performance_config *config, himc_error *error);
/// Sets other settings for the same body.
HIMC_RT void himc_performance_adopt(himc_performance *p, const performance_settings *settings);
/// Sets other settings with these segments of a body, which begins at the targets.
void himc_performance_embody(himc_performance *p, const performance_settings *settings,
                             const body_parts *parts);
/// Sets other settings with another body, which begins at the targets. False, and nothing changed,
/// if it cannot be made.
bool himc_performance_rebuild(himc_performance *p, const performance_settings *settings,
                              himc_error *error);
/// Resets everything except the host's drums, callbacks and events. False, and nothing changed,
/// if there is no memory or a recording cannot be written.
bool himc_performance_reset(himc_performance *p, himc_error *error);
/// Applies the rates of the settings; a step begins now.
HIMC_RT void himc_performance_restart_steps(himc_performance *p);
/// Updates the joint limits after a change of a drum, the take or the settings.
HIMC_RT void himc_performance_renew_limits(himc_performance *p);
/// Gives the drums that have changed to the planner.
HIMC_RT void himc_performance_notice_drums(himc_performance *p);
/// True if the performance has the drum, or the host has one for it.
bool himc_performance_find_drum(himc_performance *p, const char *name);
/// Index of the drum of that name ("": the first, which may be still to be made). The name is the
/// last word of a stroke on `spot`; if there is no such drum, and no spot was given, the word may
/// be a misspelt spot.
bool himc_performance_index_drum(himc_performance *p, const char *name, himc_spot spot, int *index,
                                 himc_error *error);
/// The same; without any drum a silent one is made for "".
bool himc_performance_ensure_drum(himc_performance *p, const char *name, himc_spot spot, int *index,
                                  himc_error *error);
/// Puts a stroke for a part of that drum (no drum: one without parts) at its place.
bool himc_performance_place_stroke(const himc_performance *p, himc_stroke *stroke, int drum,
                                   himc_error *error);
/// Adds a drum and its reference, which is given back if there is no place for it.
bool himc_performance_adopt_drum(himc_performance *p, himc_drum *drum, drum_source source,
                                 int *index, himc_error *error);
himc_job *himc_performance_drum_job(himc_performance *p, const himc_command *command,
                                    himc_error *error);
/// Drops the take with its limits and posture regression; the planner moves the hands. Returns its
/// track (or NULL), which the caller frees.
himc_track *himc_performance_drop_track(himc_performance *p);

// performance_change.c
/// Tells the planner up to which beat the score has changes of heads and pushes.
HIMC_RT void himc_performance_find_end(himc_performance *p);
himc_job *himc_performance_change_job(himc_performance *p, const himc_command *command,
                                      himc_error *error);

// performance_play.c
/// Adds an event for each stroke that the planner has given up.
HIMC_RT void himc_performance_tell_misses(himc_performance *p);
/// himc_performance_add_stroke, but nothing is written, and the beat may be any.
bool himc_performance_put_stroke(himc_performance *p, const himc_stroke *stroke, himc_error *error);
// the commands `tempo BPM`, `play`, `stop`
bool himc_performance_set_tempo(himc_performance *p, double bpm, himc_error *error);
bool himc_performance_play(himc_performance *p, himc_error *error);
void himc_performance_stop(himc_performance *p);
/// Writes the name of drum `drum` (below 0: none) into a stroke that is no roll, for lines.
HIMC_RT void himc_performance_name_drum(const himc_performance *p, himc_stroke *stroke, int drum);
/// Adds the strokes of an ornament but its own (ornament.h), on drum `drum`; a note tells how many
/// are left out.
void himc_performance_add_ornament(himc_performance *p, const himc_stroke *stroke, int drum);
himc_job *himc_performance_units_job(himc_performance *p, const himc_command *command,
                                     himc_error *error);
/// The command `clock`.
bool himc_performance_clock(himc_performance *p, const himc_command *command, himc_error *error);
/// A clock that is no longer heard leaves its mean tempo; each step asks.
HIMC_RT void himc_performance_leave_clock(himc_performance *p, double t);
/// The command `tempo`; refused while a clock is heard.
bool himc_performance_tempo(himc_performance *p, const himc_command *command, himc_error *error);
/// Says so if the loop begins behind the last stroke.
void himc_performance_tell_loop(himc_performance *p);
/// The command `note`; what it plays becomes `hit`, if anything: it has a drum then.
bool himc_performance_note(himc_performance *p, const himc_command *command, int delay,
                           himc_stroke *hit, himc_error *error);
/// How many units it would add; -1 with the reason.
int himc_performance_count_units(const himc_command *command, const himc_take_options *options,
                                 himc_error *error);

// performance_take.c
/// The command `take` as a job; without a command one to try takes with, as the performance is now.
/// NULL with the reason.
himc_job *himc_performance_take_job(himc_performance *p, const himc_command *command,
                                    himc_error *error);
/// Loads the take once more, for the player of the settings, as if its drum still stood where the
/// take found it. NULL without memory.
himc_job *himc_performance_take_again_job(himc_performance *p, himc_error *error);
/// The command `nudge` for a take; NULL: there is none, and it is refused.
bool himc_performance_nudge(himc_track *track, const himc_command *command, himc_error *error);
/// True if a job could play this command's take, the first drum being at `place` (NULL: there is
/// none). Touches the job alone.
bool himc_performance_try_take(himc_job *job, const himc_command *command,
                               const himc_head_frame *place, himc_error *error);
/// The same for a `nudge` after it.
bool himc_performance_try_nudge(himc_job *job, const himc_command *command, himc_error *error);
/// Joint limits of a player with these postures.
bool himc_performance_learn_limits(const himc_pose *pose, int frames, himc_limits *learned,
                                   himc_error *error);

// performance_score.c
/// All of the score, or nothing. Without a command it is a text, borrowed; `name` begins errors.
himc_job *himc_performance_score_job(himc_performance *p, const char *text, const char *name,
                                     const himc_command *command, himc_error *error);

// performance_command.c
/// How a performance takes commands.
extern const himc_runner himc_performance_runner;
/// Commands that are due at the next step.
void himc_performance_run_due_commands(himc_performance *p);

#endif
