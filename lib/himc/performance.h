/// performance.h: the performer and its drums, clocked by the sample count: commands in, sound and
/// strikes out.
///
/// The performance alone knows all stages; its step is algorithm 2 of the 2012 paper. The result
/// depends on the commands and on the sample at which each arrives, not on block size, clock or
/// thread.
#ifndef HIMC_PERFORMANCE_H
#define HIMC_PERFORMANCE_H

#include "himc/drum.h"
#include "himc/ranges.h"
#include "himc/score.h"

HIMC_BEGIN

/// The rates of a performance, and what its host has.
typedef struct himc_performance_config {
    double sample_rate;  ///< (Hz) 8000 .. 192000, default 48000
    double physics_rate; ///< (Hz) 500 .. 48000, default 10000; never above sample_rate
    double task_rate;    ///< (Hz) 50 .. 2000, default 250; never above physics_rate
    bool heard; ///< at first by two ears, as after the command `listener usual`; default: by the
                ///< drums' pickups
    /// Called where a command names a drum that the performance does not have, in the command's
    /// thread: it may add the drum and return true. NULL, the default: the host has no others.
    bool (*find_drum)(void *user, const char *name);
    void *find_user; ///< passed to it
} himc_performance_config;

/// The default rates; no further drums.
himc_performance_config himc_performance_default(void);

/// A performer with its drums. Made by himc_performance_new, freed by himc_performance_free.
typedef struct himc_performance himc_performance;

/// A performer at rest, without drums. NULL with the reason: a rate out of its range, or no memory.
himc_performance *himc_performance_new(const himc_performance_config *config, himc_error *error);
/// Frees it, and its references to drums. A recording under way is written first, without a word
/// if it cannot: himc_performance_end_recording says so. NULL is allowed.
void himc_performance_free(himc_performance *performance);

/// Writes a recording under way and ends it, as `record stop`. True also if there is none. False
/// with the reason: it cannot be written, and goes on.
bool himc_performance_end_recording(himc_performance *performance, himc_error *error);

/// Adds a drum (retained), or replaces the one of the same name. Strokes without a drum's name go
/// to the first drum; a performer without drums plays on a silent one. False with the reason:
/// another sample rate than the performance's, more than HIMC_DRUMS drums.
bool himc_performance_add_drum(himc_performance *performance, himc_drum *drum, himc_error *error);
/// Drum `index` (from 0), or NULL past the last. Borrowed.
HIMC_RT himc_drum *himc_performance_drum(himc_performance *performance, int index);

/// Carries out a performer's command `delay` samples from now (0 .. 8192), on the physics step at
/// that sample. Commands that may allocate or read a file (`score`, `take`, `stroke`, `player` ...)
/// act at once. Relative file names are relative to the process. A score's lines for drums go to
/// the drums of those names. False, and nothing changed, with the reason.
bool himc_performance_command(himc_performance *performance, const himc_command *command, int delay,
                              himc_error *error);
/// Takes the listener and the room of another performance. False, and nothing changed, with the
/// reason: no memory.
bool himc_performance_hear_as(himc_performance *performance, const himc_performance *other,
                              himc_error *error);
/// Whether drums made by the command `drum` sound (at first false: the host adds drums, and those
/// that it does not have are silent).
void himc_performance_make_drums(himc_performance *performance, bool make_drums);

/// Carries out a command given as text, now: "stroke 0 right legato mf", "tempo 120", "play", also
/// DRUM COMMAND ..., "kettle tune 110". May allocate or read a file. `info` and `dump` tell nothing:
/// himc_performance_describe does. False, and nothing changed, with the reason. From another thread
/// than the one that plays: himc_loader_post (loader.h).
bool himc_performance_send(himc_performance *performance, const char *text, himc_error *error);

// The commands `stroke` and `hit` for programs that have no text: they act now.

/// Adds a stroke to the score: beat 0 .. 1e9, dynamic 0 .. 1, x and y -1 .. 1 m. May allocate.
/// False if a field is out of its range, there is no drum of that name, the hand has another stroke
/// within 40 ms, there are too many strokes, or there is no memory.
bool himc_performance_add_stroke(himc_performance *performance, const himc_stroke *stroke,
                                 himc_error *error);
/// Plays a stroke (its beat is ignored), to land as the command `latency` says. Allocates only
/// if there is no drum yet. False if a field is out of its range, there is no drum of that name,
/// while a take plays, or without memory. A hit for which no hand has time is given up, and a note
/// counts it.
bool himc_performance_hit(himc_performance *performance, const himc_stroke *stroke,
                          himc_error *error);

/// Sets a live target (m) for a tip, like the command `target`, for signals. Call it once a block,
/// with the block's last sample of each coordinate: blocks of 64 samples give 750 Hz, more than the
/// task rate. A target that is not finite, or of no hand, is ignored.
HIMC_RT void himc_performance_target(himc_performance *performance, himc_hand hand, himc_vec3 tip);

/// Plays `n` samples. The force of each stick (N) goes to `force[hand]` (n); `force` and each of
/// its entries may be NULL. The sound is in the drums (himc_drum_read).
HIMC_RT void himc_performance_process(himc_performance *performance, int n,
                                      double *const force[HIMC_HANDS]);
/// Plays `n` samples and gives the sum of all drums as `frames` (n, channels), interleaved. Without
/// channels it only plays, and `frames` may be NULL; 1 is all that is heard; of more the first two
/// are the ears, or each is a pickup, and from the ninth on they are silent. Returns the largest
/// magnitude in `frames`. Full scale is 1, and may be exceeded.
HIMC_RT double himc_performance_read(himc_performance *performance, float *frames, int channels,
                                     int n);
/// Samples played since the last realign.
HIMC_RT uint64_t himc_performance_time(const himc_performance *performance);
/// Counts samples from 0 again, here and in all drums; the performance goes on.
HIMC_RT void himc_performance_realign(himc_performance *performance);
/// Sets another sample rate (Hz, 8000 .. 192000), here and in all drums; sound and motion go on.
/// False with the reason.
bool himc_performance_set_rate(himc_performance *performance, double sample_rate,
                               himc_error *error);

/// The kinds of events.
typedef enum himc_event_kind {
    HIMC_EVENT_STRIKE,  ///< a contact ended
    HIMC_EVENT_BEAT,    ///< a beat began, or a part of one (`subdivide`)
    HIMC_EVENT_DONE,    ///< the score's last contact has ended, or the take; no beat follows
    HIMC_EVENT_NOTE,    ///< a line for the user: a stroke given up, a target out of reach
    HIMC_EVENT_PREPARE, ///< the gesture of a stroke begins: hand, drum and time, of its contact
    HIMC_EVENT_MISSED   ///< a stroke is not played: told as soon as it is known
} himc_event_kind;

/// A contact of a stick with a drum.
typedef struct himc_strike {
    double time;                 ///< of the first force (s since the performance was made or reset)
    himc_hand hand;              ///< the hand that struck
    char drum[HIMC_NAME_SIZE];   ///< name of the drum that was struck
    char nuance[HIMC_NAME_SIZE]; ///< of the planned stroke, "none" without one
    double x;                    ///< on the head, away from the performer (m)
    double y;                    ///< on the head, to the left (m)
    double velocity;             ///< of impact, downward (m/s)
    double force;                ///< peak (N)
    double impulse;              ///< (N s)
    double duration;             ///< (s)
    double planned_time;         ///< of the planned stroke (s), NaN without one
    double planned_x;            ///< of the planned stroke, on the head (m)
    double planned_y;            ///< of the planned stroke, on the head (m)
    double beat;                 ///< of the planned stroke in the score, NaN without one
} himc_strike;

/// Something that has happened; the fields of its kind are valid.
typedef struct himc_event {
    himc_event_kind kind; ///< which fields are valid
    bool minor;           ///< of HIMC_EVENT_NOTE: about how strokes are played, all of which are
    bool refused; ///< of HIMC_EVENT_NOTE: a command that could not be carried out on its sample
    double beat;  ///< of HIMC_EVENT_BEAT ...
    double time;  ///< ... and when it began (s, as of a strike)
    /// Of HIMC_EVENT_STRIKE; of HIMC_EVENT_PREPARE time, hand and drum alone; and of
    /// HIMC_EVENT_MISSED: as planned, velocity, force, impulse and duration 0, the beat NaN of a
    /// hit.
    himc_strike strike;
    char text[sizeof((himc_error *)0)->text]; ///< of HIMC_EVENT_NOTE; of _MISSED, why
} himc_event;

/// Takes the oldest event; false if none waits. At most 1024 wait, of notes fewer if their
/// mean text is longer than 200 characters; the oldest are dropped and counted.
HIMC_RT bool himc_performance_event(himc_performance *performance, himc_event *event);

/// Energies, and works since the rows began or since a reset (J). Step for step
///
///     kinetic + potential = what they were + sum of joint + contact + push + placed + numerical
///
/// to rounding. NaN in `ik`, whose body has no forces, but for felt, heads and lost.
typedef struct himc_energy {
    double joint[HIMC_JOINTS];  ///< work of each joint's torque
    double contact[HIMC_HANDS]; ///< work of the heads on the body's sticks
    double mallet[HIMC_HANDS];  ///< and on the mass that a drum's mallet has beyond them
    double push;                ///< work of the command `push`
    double support;             ///< work of seat and floor
    double placed;              ///< given to the body when it was put elsewhere: a new player ...
    double numerical;           ///< given by the integrator (docs/data.md)
    double kinetic;             ///< of all segments
    double potential;           ///< of all segments, 0 on the floor
    double felt[HIMC_HANDS];    ///< stored in the compressed mallet
    double heads;               ///< of all drumheads that the performer has, vibrating
    double lost; ///< given to heads by the sticks and no longer in them: felt, air, friction
} himc_energy;

/// One row of motion at the task rate: the state at `time`, and the forces of the physics step that
/// begins then. In the world frame unless stated. docs/data.md has the conventions.
typedef struct himc_motion_row {
    double time;                  ///< (s)
    himc_vec3 target[HIMC_HANDS]; ///< targets of the tips (m)
    himc_vec3 tip[HIMC_HANDS];    ///< simulated tips (m)
    double force[HIMC_HANDS];     ///< largest since the last row (N)
    himc_vec3 joint[HIMC_JOINTS]; ///< rotation vector from the zero pose, parent's frame (rad)
    himc_vec3 elbow[HIMC_HANDS];  ///< position (m)
    double limit[HIMC_JOINTS];    ///< himc_limit_measure: above 1 beyond the bounds; 0 without any

    himc_vec3 target_velocity[HIMC_HANDS]; ///< (m/s)
    himc_vec3 tip_velocity[HIMC_HANDS];    ///< (m/s)
    himc_vec3 tip_error[HIMC_HANDS];       ///< tip minus target (m)
    double joint_error[HIMC_JOINTS];       ///< angle to the joint's own target (rad)
    himc_quat rotation[HIMC_JOINTS];       ///< `joint` as unit quaternion
    himc_vec3 rate[HIMC_JOINTS];           ///< angular velocity, child minus parent (rad/s)
    himc_vec3 acceleration[HIMC_JOINTS];   ///< its derivative (rad/s^2); NaN in `ik`
    himc_vec3 torque[HIMC_JOINTS];         ///< on the child (N m); NaN in `ik`
    double power[HIMC_JOINTS];             ///< torque times rate (W); NaN in `ik`
    himc_vec3 segment[HIMC_SEGMENTS];      ///< the segment's joint to its parent (m)
    himc_quat orientation[HIMC_SEGMENTS];  ///< of the segment's frame
    himc_vec3 center[HIMC_SEGMENTS];       ///< of mass (m)
    himc_vec3 tip_force[HIMC_HANDS];       ///< of the heads on the body's sticks (N)
    himc_vec3 mallet_force[HIMC_HANDS];    ///< and on a mallet's mass beyond them (N)
    double impulse[HIMC_HANDS];            ///< of a head on the stick, since the last row (N s)
    himc_vec3 push[HIMC_SEGMENTS];         ///< force of the command `push` (N) ...
    himc_vec3 push_at[HIMC_SEGMENTS];      ///< ... and where it acts (m)
    double null_space[HIMC_HANDS]; ///< share of the arm's squared joint rates that moves no tip
    double co_contraction[HIMC_JOINTS]; ///< torque over the joint's strength; NaN in `ik`
    himc_vec3 root_force;  ///< of the world on a fixed pelvis, or of seat and floor on the body,
                           ///< mean since the last row (N); NaN in `ik`
    himc_vec3 root_moment; ///< the same about the midpoint of the hip joints (N m); NaN in `ik`
    himc_vec3 root_center; ///< of pressure on the plane of the seat, or on the floor for one who
                           ///< stands (m); NaN if nothing presses
    double root_friction;  ///< horizontal over vertical force; NaN if nothing presses
    himc_vec3 seat_force;  ///< of the stool on a body that sits, mean since the last row (N); 0 of
                           ///< one who stands or is fixed; NaN in `ik`
    himc_vec3 foot_force[HIMC_HANDS]; ///< of the floor on the left and right foot, likewise
    himc_energy energy;               ///< (J)
} himc_motion_row;

/// Calls `row` in himc_performance_process at each task tick; NULL stops it. Works and energies
/// are then added up in every physics step, which costs a tenth of its time.
void himc_performance_on_motion(himc_performance *performance,
                                void (*row)(void *, const himc_motion_row *), void *user);

/// The moving body (body.h).
typedef struct himc_body_state himc_body_state;

/// Forces of stool and floor on a body whose pelvis is free (N), in one physics step.
typedef struct himc_support_forces {
    himc_vec3 seat, foot[HIMC_HANDS];
    himc_vec3 center; ///< of pressure (m), as himc_motion_row.root_center
} himc_support_forces;

/// The body and its targets at a task tick; borrowed for the call.
typedef struct himc_tick {
    double time;                  ///< (s since the performance was made or reset)
    const himc_body_state *body;  ///< all segments in the world
    himc_vec3 target[HIMC_HANDS]; ///< targets of the tips (m)
    const himc_motion_row *row;   ///< all else; NULL unless himc_performance_on_motion is in use
    const himc_support_forces *support; ///< NULL of a pelvis that is fixed, and in `ik`
    /// Rotations of the joints in the take itself, each in its parent's frame (HIMC_JOINTS);
    /// the joint's target where the take shows none. NULL unless a take with joints plays.
    const himc_quat *captured;
} himc_tick;

/// Calls `tick` in himc_performance_process at each task tick, beside himc_performance_on_motion;
/// NULL stops it. `tick` must be HIMC_RT.
void himc_performance_on_tick(himc_performance *performance,
                              void (*tick)(void *, const himc_tick *), void *user);

/// Figures since the performance was made or reset.
typedef struct himc_performance_stats {
    double seconds;         ///< time played (s)
    int strokes;            ///< of the score, due so far
    int played;             ///< landed within 5 ms, on the planned drum, within 2 cm of the point
    int missed;             ///< strokes that did not
    int moved;              ///< struck beside the point asked for, as the hands would have met ...
    double moved_most;      ///< ... by so much at most (m); they count as played there
    double tip_rms;         ///< distance of tip and target outside contact (m)
    double stroke_height;   ///< mean over strokes, apex to contact (m)
    double tip_rms_percent; ///< tip_rms / stroke_height (%), NaN before the first stroke
    double peak_force;      ///< largest contact force (N)
    int unplanned_contacts; ///< of a stick and a head that no stroke asked for
    double longest_contact; ///< time from a stick's first touch to its last (s)
    /// RMS distance of the tip from its place in the take itself, contacts and all, not from a
    /// target that was planned again after a contact (m). At the task rate; NaN if no take was
    /// played, in percent also before a stroke.
    double captured_rms;
    double captured_most;         ///< the largest such distance (m)
    double captured_rms_percent;  ///< captured_rms / stroke_height (%)
    double captured_most_percent; ///< captured_most / stroke_height (%)
    double captured_speed_ratio;  ///< mean speed of a take's strikes, played / captured, or NaN
    double peak_rate;             ///< largest rate of a joint, of its axes together (rad/s) ...
    int peak_rate_joint;          ///< ... and the joint
    double peak_torque;           ///< largest torque of a joint (N m), 0 in `ik` ...
    int peak_torque_joint;        ///< ... and the joint
    double reserve;               ///< largest torque of a joint over its strength: the reserve is
                                  ///< used above 1; 0 without strengths ...
    int reserve_joint;            ///< ... and the joint
    double beat;                  ///< of the score, or second of the take, now; -1 while stopped
    double bpm;                   ///< the tempo now (beats per minute)
    int hits;                     ///< accepted hits
    double hit_latency;           ///< of the last hit, from its command to its planned contact (s)
    double longest_latency;       ///< of all hits (s)
    long recoveries;     ///< times the body was put back: it fell, or its state was not finite
    long limit_hits;     ///< times a joint came to its bounds
    long events_lost;    ///< events dropped since the reset because the host did not take them
    long hearings;       ///< changes of the listener or the room
    double sample_rate;  ///< in force (Hz)
    double physics_rate; ///< in force (Hz)
    double task_rate;    ///< in force (Hz)
} himc_performance_stats;

/// The figures now.
HIMC_RT himc_performance_stats himc_performance_measure(const himc_performance *performance);

/// Calls `line` with each of several lines about the state (mode, law, rates, drums, player,
/// transport) for a person, or with the lines of a score that makes its settings, its drums and its
/// score again.
void himc_performance_describe(const himc_performance *performance, himc_description what,
                               void (*line)(void *, const char *), void *user);
/// Answers the command `get`: calls `line` with each line "WHAT VALUE ..." of a setting, as the
/// command that sets it, or of tempo, beat, state, drums, loop, room, listener, mute. False with
/// the reason if there is none.
bool himc_performance_get(const himc_performance *performance, const char *what,
                          void (*line)(void *, const char *), void *user, himc_error *error);

HIMC_END

#endif
