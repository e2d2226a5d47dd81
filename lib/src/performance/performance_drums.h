/// performance_drums.h: the drums of a performance: found by name, made, replaced, placed.
#ifndef HIMC_PERFORMANCE_DRUMS_H
#define HIMC_PERFORMANCE_DRUMS_H

#include "base/head_frame.h"
#include "drum/air_between.h"
#include "performance/performance_events.h"

#define FIRST_DRUM "drum" // name of a drum made for strokes without one

/// Where a drum comes from.
typedef enum drum_source {
    DRUM_GIVEN, ///< by the host
    DRUM_MADE,  ///< by the command `drum`
    DRUM_SILENT ///< by the performer, for a name that no drum has
} drum_source;

typedef struct drum_slot {
    himc_drum *drum; ///< a reference of the performance's own
    drum_source source;
    unsigned revision;      ///< last one given to the planner
    bool untold;            ///< auto-placed; the user has not been notified
    bool reach_told;        ///< out of reach there, and the user has been notified
    bool pedal_told;        ///< the same of its pedal
    bool moved;             ///< moved by the performer, see himc_drums_put_back
    bool placed;            ///< himc_drum_is_placed before that ...
    himc_vec3 found, at;    ///< ... its position then, and its new position (m)
    int behind;             ///< samples that it has not made yet
    himc_head_frame seen;   ///< where its head was when ...
    himc_head_axes axes;    ///< ... its axes were found
    himc_drum_heads *heads; ///< owned; its changes in the score, NULL for none
    int keys;               ///< of `note` that are held
    int waited;             ///< ticks that a change has waited for a stick to leave the head
} drum_slot;

/// Strokes refer to their drum by its slot. Only himc_drums_put_back frees slots.
typedef struct performance_drums {
    drum_slot slot[HIMC_DRUMS];
    int count;
    himc_listener listener; ///< of all of them, as what follows
    himc_walls walls;
    long hearings; ///< changes of the two, so far
    bool heard;    ///< by the usual listener, at first
    double gain;   ///< of their sound (factor)
    bool mute;
    long round;            ///< of a loop, at the last himc_drums_turn_heads
    himc_air_between *air; ///< owned; between those that are near, NULL before the second drum
} performance_drums;

/// No drums, no listener, the usual walls.
HIMC_RT void himc_drums_begin(performance_drums *drums, bool heard);
/// Slot of the drum with that name, -1 if there is none.
HIMC_RT int himc_drums_find(const performance_drums *drums, const char *name);
HIMC_RT const himc_head_frame *himc_drums_frame(const performance_drums *drums, int index);
/// The axes of that frame, found when it has changed.
HIMC_RT const himc_head_axes *himc_drums_axes(performance_drums *drums, int index);
/// Place of a world point on that head, z the height above it (m).
HIMC_RT himc_vec3 himc_drums_local(performance_drums *drums, int index, himc_vec3 point);
/// The reason why a word of a stroke on `spot` is wrong: no spot, if none was given, not `dead`,
/// none of the drums; returns false. HIMC_SPOT_XY: a drum is all that the word may be.
HIMC_RT bool himc_drums_refuse(const performance_drums *drums, const char *word, himc_spot spot,
                               himc_error *error);
/// The same with the names of all drums that there are, `count`.
HIMC_RT bool himc_drums_refuse_of(const char *const *names, int count, const char *word,
                                  himc_spot spot, himc_error *error);
/// The reason why there is no place for a drum of that name; returns false.
HIMC_RT bool himc_drums_full(const char *name, himc_error *error);
/// Takes a drum and its reference, in the slot of the same name or a new one. A drum without a
/// place is placed automatically. False, and nothing changed, if there is no slot left or no
/// memory.
bool himc_drums_add(performance_drums *drums, himc_drum *drum, drum_source source, int *index,
                    himc_error *error);
/// Moves a drum under a take's strikes, until its owner places it or himc_drums_put_back.
bool himc_drums_move(performance_drums *drums, int index, himc_vec3 center, himc_error *error);
/// A drum's head frame, with the place it had before himc_drums_move or an automatic place.
HIMC_RT himc_head_frame himc_drums_found(const performance_drums *drums, int index);
/// All drums, also those to come, are heard by this listener as long as they are the performance's.
/// False, and nothing changed, without memory for the ears of one.
bool himc_drums_listen(performance_drums *drums, const himc_listener *listener, himc_error *error);
/// All drums, as above, stand between these walls.
HIMC_RT void himc_drums_enclose(performance_drums *drums, const himc_walls *walls);
/// All drums, as above, sound by `gain` (factor) of their own, or not at all.
HIMC_RT void himc_drums_fade(performance_drums *drums, double gain, bool mute);
/// True if himc_drums_listen would take longer than an audio block can wait.
HIMC_RT bool himc_drums_listening_takes_long(const performance_drums *drums);
/// The same as a job; the drums must outlive it. NULL without memory.
himc_job *himc_drums_listen_job(performance_drums *drums, const himc_listener *listener,
                                himc_error *error);
/// Drops all drums except those given by the host, which keep their order, and the listener. They
/// are as when they were added: heads at rest, at the place of their owner or else placed
/// automatically.
void himc_drums_put_back(performance_drums *drums);
void himc_drums_release(performance_drums *drums);

/// Sets the changes of a drum's head in the score (NULL: none). Returns those before, which the
/// caller frees.
himc_drum_heads *himc_drums_set_heads(performance_drums *drums, int index, himc_drum_heads *heads);
void himc_drums_drop_heads(performance_drums *drums);
/// Gives the drums the heads that they have at that beat of a round; nothing if it is negative. A
/// loop begins again at beat `end`: what changes there acts with the next round. Notes a change
/// that cannot act.
HIMC_RT void himc_drums_turn_heads(performance_drums *drums, double beat, long round, double end,
                                   performance_events *events);

HIMC_RT bool himc_drums_damped(const performance_drums *drums, int index);
/// True if it is, or will be at that beat.
HIMC_RT bool himc_drums_will_be_damped(const performance_drums *drums, int index, double beat);

/// A drum that no stick is near makes its samples later, many at a time: they are the same. Now all
/// drums make theirs; before anything looks at them, or changes them.
HIMC_RT void himc_drums_catch_up(performance_drums *drums);
HIMC_RT void himc_drums_catch_up_one(performance_drums *drums, int index);

/// After a change of places or of the set: finds the drums that hear each other.
HIMC_RT void himc_drums_join(performance_drums *drums);
/// Whether a drum has changed since the last call.
HIMC_RT bool himc_drums_noticed(performance_drums *drums, int index);
/// Reports the place of each auto-placed drum once.
HIMC_RT void himc_drums_tell_places(performance_drums *drums, performance_events *events);

#endif
