/// performance_body.h: the body of a performance, as the controller assumes it and as it is
/// simulated, with its controller, joint limits and pushes.
#ifndef HIMC_PERFORMANCE_BODY_H
#define HIMC_PERFORMANCE_BODY_H

#include "control/balance.h"
#include "control/muscle.h"
#include "control/setpoint.h"
#include "himc/drive.h"
#include "performance/performance_settings.h"

/// A push of a score.
typedef struct planned_push {
    double beat; ///< (beats; of a take s)
    int segment;
    himc_vec3 force; ///< (N)
    double seconds;
    double along; ///< from the segment's joint towards its centre of mass (m); negative: there
} planned_push;

/// A constant force on a segment.
typedef struct body_push {
    himc_vec3 force; ///< (N)
    himc_vec3 at;    ///< in the segment's frame (m)
    double until;    ///< (s)
} body_push;

#define HIMC_PUSHES 256 ///< of a score; chosen: more than anyone drags

typedef struct performance_body {
    himc_skeleton skeleton;          ///< assumed by the controller
    himc_skeleton plant;             ///< simulated: masses may differ
    bool shares;                     ///< they do not: the controller has the plant's articulation
    himc_character *character;       ///< owned
    himc_body_state state;           ///< at the beginning of the last step
    himc_vec3 torque[HIMC_JOINTS];   ///< of the last step (N m)
    himc_vec3 tip_force[HIMC_HANDS]; ///< of the last step (N)
    bool accounting;                 ///< `work` is added up
    himc_body_work work;
    himc_controller controller; ///< borrows `limits`, `legs` and `saturation`
    himc_limits limits;         ///< in force
    himc_saturation_counts saturation;
    himc_sleeping_legs legs;
    himc_muscles muscles;
    himc_support support; ///< of a pelvis that is free
    himc_balance balance;
    himc_drive drive; ///< of joints, from outside ...
    bool aimed;       ///< ... any of them to a rotation
    body_push push[HIMC_SEGMENTS];
    double push_end;                   ///< of all pushes (s)
    planned_push planned[HIMC_PUSHES]; ///< by beat
    int planned_count;
    double pushed_to; ///< beat; earlier planned pushes have begun
} performance_body;

/// A body for these settings; NULL with the reason.
performance_body *himc_body_new(const performance_settings *settings, himc_error *error);
void himc_body_free(performance_body *body);

/// The segments of a body.
typedef struct body_parts {
    himc_skeleton skeleton, plant;
    himc_character *character; ///< owned until a body has them
} body_parts;
/// Makes segments for these settings, for himc_body_adopt or himc_character_free.
bool himc_body_make_parts(body_parts *parts, const performance_settings *settings,
                          himc_error *error);
void himc_body_adopt(performance_body *body, const body_parts *parts);
/// Puts the body into the posture of a tick: at rest, or back from a state that was not finite.
HIMC_RT void himc_body_place(performance_body *body, const himc_setpoint *at);
/// Sets the simulated body to the last kinematic pose.
HIMC_RT void himc_body_take_up(performance_body *body);
/// Puts the pelvis at this height (m); himc_body_place then puts the body there.
HIMC_RT void himc_body_seat(performance_body *body, double height);
/// A new controller for this body, made for the resting posture; and the engine of the settings.
void himc_body_init_controller(performance_body *body, const performance_settings *settings,
                               const himc_pose *rest);
/// Other settings of controller and engine for the same body.
HIMC_RT void himc_body_configure(performance_body *body, const performance_settings *settings);
/// Joint limits from now on; NULL for none.
HIMC_RT void himc_body_set_limits(performance_body *body, const himc_limits *limits);
HIMC_RT void himc_body_clear_limit_counts(performance_body *body);
/// Begins a push at `t` (s); another one of that segment ends.
HIMC_RT void himc_body_push(performance_body *body, const planned_push *push, double t);
/// What the pushes of a score do to those planned before.
typedef enum push_order {
    PUSHES_ANEW,    ///< nothing is played: they replace them
    PUSHES_INSTEAD, ///< while it is played: they replace them
    PUSHES_AFTER    ///< they follow them
} push_order;

/// Makes room for `count` pushes that follow: if there is none, those that have begun are dropped.
/// False, with the reason and nothing changed, if that is not enough.
HIMC_RT bool himc_body_make_push_room(performance_body *body, int count, himc_error *error);
/// Plans the pushes of a score (count), sorted by beat. False with the reason if there is no room
/// for them.
HIMC_RT bool himc_body_plan_pushes(performance_body *body, const planned_push *list, int count,
                                   push_order order, himc_error *error);
/// Plans one more push of the score that plays or will be played. False with the reason if there is
/// no room.
HIMC_RT bool himc_body_insert_push(performance_body *body, const planned_push *push,
                                   himc_error *error);
/// True if these pushes may take the place of the planned ones: all that differ are to come.
HIMC_RT bool himc_body_may_exchange_pushes(const performance_body *body, const planned_push *list,
                                           int count);
/// Begins the planned pushes of this tick at `t` (s): from beat `now` to that of the next tick.
HIMC_RT void himc_body_begin_pushes(performance_body *body, double now, double next, double t);

/// True if a body that sits is off its stool, or lies.
HIMC_RT bool himc_body_has_fallen(const performance_body *body);

/// Reads the simulated body's state. With `check`, false if joints have come apart.
HIMC_RT bool himc_body_observe(performance_body *body, bool check);
/// Drives joints from outside; NULL: none. False with the reason.
HIMC_RT bool himc_body_drive(performance_body *body, const himc_drive *drive, himc_error *error);
/// The torques for this state, in a step of `h` (s).
HIMC_RT void himc_body_control(performance_body *body, const himc_reference *reference, double h);
/// Moves the simulated body by `h` (s) from time `t` (s), under its torques, tip forces and pushes.
/// False if the engine fails.
HIMC_RT bool himc_body_simulate(performance_body *body, double t, double h);
/// The push on a segment at time `t`; without one it is 0, at the centre of mass.
HIMC_RT body_push himc_body_pushed(const performance_body *body, int segment, double t);
/// Adds up the work on the body from 0 on, or no longer.
HIMC_RT void himc_body_account(performance_body *body, bool on);
/// Moves the body by inverse kinematics, by `h` (s). False if the state is not finite.
HIMC_RT bool himc_body_follow(performance_body *body, const himc_reference *reference, double h);
/// Clamps a kinematic pose to the joint limits and stops the joints that this moves.
HIMC_RT void himc_body_clamp(performance_body *body, himc_pose *pose, himc_vec3 rate[HIMC_JOINTS]);

/// Number of times that a joint reached its bounds.
HIMC_RT long himc_body_limit_hits(const performance_body *body);

/// The joint of that name; false if there is none, `what` begins the error.
bool himc_body_find_joint(const char *name, const char *what, int *joint, himc_error *error);
/// Reads the command `push` but for its beat; false with the names of segments allowed, or if the
/// stance holds the segment.
bool himc_body_read_push(const himc_command *command, himc_stance stance, planned_push *out,
                         himc_error *error);

#endif
