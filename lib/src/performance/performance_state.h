/// performance_state.h: what a performance holds, shared by the files that are its rooms:
/// performance.c (the step), performance_touch.c (sticks on heads), performance_drums.c (what is
/// struck), performance_command.c, performance_play.c, performance_score.c and performance_take.c
/// (what is asked), performance_hands.c (of the planner or of the take), performance_habit.c (how
/// the arms go with it), performance_limits.c (how far joints turn and how strong they are),
/// performance_push.c (who pushes), performance_report.c (what is told).
#ifndef HIMC_PERFORMANCE_STATE_H
#define HIMC_PERFORMANCE_STATE_H

#include "body/character.h"
#include "himc/performance.h"
#include "himc/mocap.h"
#include "control/setpoint.h"
#include "plan/planner.h"
#include "plan/track.h"
#include "control/posture_regression.h"
#include "drum/drum_performer.h"

#define LONGEST_STEP 512 // samples of one physics step
#define WAITING_COMMANDS 256
#define WAITING_EVENTS 1024
#define PLAYED_TIME 0.005 // a stroke has landed if it touches within this of its time (s) ...
#define PLAYED_PLACE 0.02 // ... and within this of its place (m)

/// A drum the performer plays on; silent ones are its own, made for names nobody else has.
typedef struct slot {
    himc_drum *drum;
    bool silent;
    bool beside; // it stands where there was room, and the user does not know yet
    unsigned revision;
} slot;

/// What a hand's stick is doing on a head.
typedef struct touch {
    bool touching;      // from the first force to separation
    bool released;      // control lets go of the normal
    int drum;           // slot
    himc_stick stick;   // in micro-contact
    double offset;      // of the micro height from the body's own tip, while in contact (m)
    double last_force;  // when force was last felt (s)
    double peak_row;    // largest force since the last motion row (N)
    himc_strike strike; // being made
    double
        answered; // planned time of the last stroke that has been struck, given up or counted (s)
    double apex;  // highest target above the head since the last strike (m)
} touch;

/// The stroke a hand is on or comes to.
typedef struct planned_stroke {
    bool any;
    double time; // of contact (s)
    int drum;    // slot
    double x, y; // on the head (m)
    char nuance[HIMC_NAME_SIZE];
} planned_stroke;

typedef struct waiting_command {
    uint64_t due; // sample
    himc_command command;
} waiting_command;

struct himc_performance {
    himc_performance_config config;
    double physics_rate; // in force: never above the sample rate

    // the body
    himc_skeleton_config body;
    himc_skeleton skeleton;       // as control believes it to be
    himc_skeleton plant;          // as it is simulated: masses may differ
    double weight[HIMC_SEGMENTS]; // of each segment, plant over belief
    himc_posture posture;
    himc_pose captured_rest_pose;          // how the player of a take holds neck, head and legs ...
    bool captured_rest_known[HIMC_JOINTS]; // ... and which of them the take shows
    himc_trunk_posture trunk_posture;      // the mean of the trunk in the take
    himc_posture_regression
        regression; // what the null space is for instead of the posture, in `himc`
    bool has_regression;
    bool regression_of_take; // it goes with the take
    double regression_since; // when it was set or dropped (s)
    himc_grip grip;
    struct {
        himc_trunk_posture from, goal;
        double time;             // of `from` (s)
    } course;                    // of trunk and grip
    himc_limits limits, learned; // in force, and those of the take's player
    bool has_learned;
    bool human; // strength
    himc_saturation_counts saturation;
    himc_controller controller;
    himc_character *character;
    himc_body_state state;
    himc_vec3 torque[HIMC_JOINTS];
    himc_reference reference;
    bool one_way;
    struct {
        himc_vec3 force; // (N)
        double until;    // (s)
    } push[HIMC_SEGMENTS];
    double push_end; // of all pushes (s)

    // what to play
    himc_planner *planner;
    himc_track *track;  // instead of the planner when a take is loaded
    double track_start; // (s); infinite while the planner has the hands
    struct {
        bool due;     // to be made from the next tick on
        double since; // (s)
        himc_quintic off[HIMC_JOINTS];
    } ease;      // of the joint targets from one source to another
    bool unbent; // in `id` its joints are followed as captured
    himc_take_options take_options;
    double piece_start, end; // of the piece being played (s)
    bool playing;
    long last_beat;

    // the drums
    slot drum[HIMC_DRUMS];
    int drums;
    bool make_drums;
    touch touch[HIMC_HANDS];

    // time
    uint64_t sample;                        // played since the performance was made
    uint64_t aligned;                       // sample 0 of himc_performance_time
    uint64_t made;                          // samples simulated: the next step begins here
    uint64_t step_origin;                   // the sample at which step 0 began
    uint64_t step;                          // steps since then
    double force[HIMC_HANDS][LONGEST_STEP]; // of the last step
    int force_count;
    himc_setpoint from, to;
    bool replan;
    bool beyond[HIMC_HANDS]; // the last live target was out of reach

    himc_recording *recording; // owned; NULL when nothing is recorded
    bool recording_full;

    // what came in and what goes out
    waiting_command waiting[WAITING_COMMANDS];
    int waiting_count;
    long commands_dropped;
    himc_event event[WAITING_EVENTS];
    int event_first, event_count;
    long events_lost;
    void (*on_motion)(void *, const himc_motion_row *);
    void *motion_user;
    void (*on_tick)(void *, const himc_tick *);
    void *tick_user;

    // what is measured
    double square_sum, height_sum;
    long square_count, height_count;
    int strokes, played, hits;
    double hit_latency,
        longest_latency; // from a hit's command to its touch, of the last and of all (s)
    double peak_force;
    long recoveries;
};

/// Time of the next step (s since the performance was made).
static inline double step_time(const himc_performance *p)
{
    return (double)p->made / p->config.sample_rate;
}

// performance.c
bool himc_performance_build_body(himc_performance *p, himc_error *error);
/// As it is for this body at rest, whatever it is doing now.
void himc_performance_fresh_controller(const himc_performance *p, himc_controller *controller);
void himc_performance_reset_clock(himc_performance *p);
void himc_performance_notice_drums(himc_performance *p);
himc_target himc_performance_planned(const himc_performance *p, himc_hand hand, double t);

// performance_habit.c
/// A take's player bears himself as the take has it, not as the strokes ask: from there the habit's
/// trunk departs.
void himc_performance_fit_posture_regression(himc_performance *p);
void himc_performance_follow_posture_regression(const himc_performance *p, himc_setpoint *tick);

// performance_touch.c
planned_stroke himc_performance_plan(const himc_performance *p, himc_hand hand, double t);
void himc_performance_contact(himc_performance *p, int n, himc_vec3 tip_force[HIMC_HANDS]);
void himc_performance_after_contact(himc_performance *p, double t);
void himc_performance_release(himc_performance *p, double t);
void himc_performance_forget_touch(himc_performance *p);

// performance_command.c
/// Carries out a command now; false, and nothing changed, with the reason.
typedef bool performance_action(himc_performance *p, const himc_command *command,
                                himc_error *error);
/// In the order of the words of `coupling`.
typedef enum himc_coupling { HIMC_COUPLING_TWO_WAY, HIMC_COUPLING_ONE_WAY } himc_coupling;
void himc_performance_run_due_commands(himc_performance *p);

// performance_score.c
performance_action himc_performance_do_score;

// performance_drums.c
performance_action himc_performance_do_drum;
bool himc_performance_ensure_drum(himc_performance *p, const char *name, int *index,
                                  himc_error *error);
void himc_performance_tell_places(himc_performance *p);

// performance_play.c
bool himc_performance_add_stroke(himc_performance *p, const himc_stroke *stroke, himc_error *error);
performance_action himc_performance_do_loop, himc_performance_do_stroke, himc_performance_do_hit,
    himc_performance_do_tempo, himc_performance_do_clear, himc_performance_do_play,
    himc_performance_do_stop, himc_performance_do_seek, himc_performance_do_target,
    himc_performance_do_units;
void himc_performance_drop_track(himc_performance *p);

// performance_hands.c
/// Whether the take has that hand now.
bool himc_performance_tracks(const himc_performance *p, himc_hand hand);
/// The planner goes on with what hands the take has.
void himc_performance_take_hands_back(himc_performance *p);
/// The hand for a hit or a live target, if its take is over; false while that plays.
bool himc_performance_lend_hand(himc_performance *p, himc_hand hand);
/// Joint targets are as their source has them, from now on.
void himc_performance_forget_ease(himc_performance *p);
/// Eases a tick's joint targets from the source before to this one, while that is due.
void himc_performance_ease(himc_performance *p, himc_setpoint *tick);

// performance_take.c
performance_action himc_performance_do_take;
/// What the joints are to do as the tips do `tip` at `t`: the take's postures, else natural ones.
void himc_performance_posture(const himc_performance *p, double t,
                              const himc_target tip[HIMC_HANDS], himc_posture_motion *motion);

// performance_limits.c
performance_action himc_performance_do_limits, himc_performance_do_strength;
bool himc_performance_find_joint(const himc_command *c, const char *command, int *joint,
                                 himc_error *error);
/// Whose limits they are may have changed: the body, the drum's place, the take.
void himc_performance_renew_limits(himc_performance *p);
/// Those of a player with postures, as captured.
bool himc_performance_learn_limits(const himc_player *player, himc_limits *learned,
                                   himc_error *error);
/// Those of arms without sticks anew, from what the tips ask of a body in that posture.
bool himc_performance_learn_bent(const himc_player *player, const himc_track *track,
                                 const himc_posture *posture, himc_limits *learned,
                                 himc_error *error);
void himc_performance_keep_strength(himc_performance *p, const himc_controller *old);
/// Takes a posture that is only shown into the limits, and stops the joints that it moves.
void himc_performance_clamp_kinematic_pose(himc_performance *p, himc_pose *pose,
                                           himc_vec3 rate[HIMC_JOINTS]);
long himc_performance_limit_hits(const himc_performance *p);
void himc_performance_describe_limits(const himc_performance *p, void (*line)(void *, const char *),
                                      void *user);

// performance_push.c
performance_action himc_performance_do_push;
void himc_performance_push_body(himc_performance *p, double t);

// performance_report.c
void himc_performance_emit(himc_performance *p, const himc_event *event);
void himc_performance_note(himc_performance *p, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void himc_performance_measure_step(himc_performance *p);
void himc_performance_watch(himc_performance *p, double t);
void himc_performance_motion_row(himc_performance *p, double t);

#endif
