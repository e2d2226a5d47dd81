/// drum_performer.h: what a performer (performance/) needs of a drum beyond himc/drum.h: its sticks
/// in contact with the head, and the drum's place and mallet.
#ifndef HIMC_DRUM_PERFORMER_H
#define HIMC_DRUM_PERFORMER_H

#include "base/job.h"
#include "base/text.h"
#include "drum/ears.h"
#include "drum/model.h"
#include "himc/drum.h"

/// Forces from outside, one of each for a sample.
typedef struct himc_outside_force {
    const double *force; ///< (N, down positive), or NULL
    const double *x, *y; ///< where it acts (m), or NULL: the point stays
} himc_outside_force;

/// himc_drum_advance with sticks (0 .. HIMC_STICKS) in contact with the head.
/// @param sticks   evolve (membrane.h); may be NULL when count is 0
/// @param forces   forces[s][i] receives the force of stick s in sample i (N); NULL if unwanted
/// @param outside  or NULL
/// Returns true if a sample was made by itself, with sticks near the head or a force; it costs as
/// much as several others.
HIMC_RT bool himc_drum_advance_sticks(himc_drum *drum, int n, himc_stick *const *sticks, int count,
                                      double *const *forces, const himc_outside_force *outside);

/// Memory for a listener's ears, which a drum has from the first listener on.
bool himc_drum_open_ears(himc_drum *drum, himc_error *error);
/// Who hears the drum by two ears: from now on they are its first two channels, instead of pickups.
/// A listener who is off, as at first, leaves them to the pickups; one who is on needs open ears.
/// NULL: the one that the drum has without a performer. It changes over in 5 ms.
HIMC_RT void himc_drum_listen(himc_drum *drum, const himc_listener *listener);

/// The walls around who hears it; at first HIMC_WALLS_USUAL. They change in 5 ms.
HIMC_RT void himc_drum_enclose(himc_drum *drum, const himc_walls *walls);

/// The fader of all drums of a performer: times the drum's own gain; at first 1. No click.
HIMC_RT void himc_drum_fade(himc_drum *drum, double factor);

/// True once the command `place` has set its place.
HIMC_RT bool himc_drum_is_placed(const himc_drum *drum);
/// Tells the state as himc_drum_describe does, `placed`: with the place where it stands.
void himc_drum_tell_state(const himc_drum *drum, bool placed, const himc_line_sink *to);
/// True for a kick that stands on the floor: a foot plays it, no hand.
HIMC_RT bool himc_drum_is_footed(const himc_drum *drum);
/// The inches with which it was made.
HIMC_RT double himc_drum_inches(const himc_drum *drum);
/// 8000 .. 192000 Hz, or false with the reason.
bool himc_drum_check_rate(double sample_rate, himc_error *error);
/// Where its pedal stands, or goes to: octaves over the usual pitch. Returns how long it takes, or
/// the last one took (s).
HIMC_RT double himc_drum_pedal(const himc_drum *drum, double *octaves);
/// Whether a drum may stand there: within 10 m of the origin on each axis.
bool himc_drum_check_place(himc_vec3 center, himc_error *error);
/// Brings the head to rest, without a click, and drops the drum's own mallets and waiting strikes.
HIMC_RT void himc_drum_rest(himc_drum *drum);
/// Moves the head's centre (m), until the command `place` does.
HIMC_RT void himc_drum_stand(himc_drum *drum, himc_vec3 center);
/// The mallet with which a hand strikes it, set by the command `mallet`; a strike without a
/// performer has the right one. Borrowed.
HIMC_RT const himc_mallet_head *himc_drum_mallet(const himc_drum *drum, himc_hand hand);
/// Grows by one with every change of place, radius or mallet, so that a performer notices.
HIMC_RT unsigned himc_drum_revision(const himc_drum *drum);
/// Frequency of the head's principal mode (Hz).
HIMC_RT double himc_drum_pitch(const himc_drum *drum);

/// For those who draw a head: displacement (m) of the first `count` shapes of a bare head with its
/// axes along x and y, of which the modes are made: of what the modes have now, or of `modal`
/// (count) (m) if it is not NULL.
HIMC_RT void himc_membrane_upright(const himc_membrane *membrane, int count, const double *modal,
                                   double *displacement);

/// Strikes the drum as himc_drum_strike_at does, by its performer's foot; `kick` (> 0) is told by
/// himc_drum_kicked when the contact is over.
HIMC_RT bool himc_drum_kick(himc_drum *drum, int delay, double x, double y, double velocity,
                            int kick, himc_error *error);
/// Before a stick in the air strikes there: at a spot beyond the rim it meets hoop, shell or
/// another stick, and gets that contact's head and place; of a rim shot its shaft will, too.
HIMC_RT void himc_drum_meet(const himc_drum *drum, himc_spot spot, himc_stick *stick);
/// Lays a hand on the head `delay` >= 0 samples from now, for 0.15 s; or lifts it then.
HIMC_RT void himc_drum_lay(himc_drum *drum, int delay, bool hand);
/// Whether a pedal closes it, as a hi-hat.
HIMC_RT bool himc_drum_hats(const himc_drum *drum);
/// Takes the oldest of a foot's strokes that are over, and how long ago it began (s); its `kick`,
/// or 0 if there is none.
HIMC_RT int himc_drum_kicked(himc_drum *drum, himc_contact_report *report, double *ago);

#define METRES_PER_INCH 0.0254

/// True if a force acted on the head in its last sample.
HIMC_RT bool himc_drum_is_touched(const himc_drum *drum);

/// All of a drum that its commands set: plain data, on which commands act in any thread, and which
/// a drum then takes. It retains the grid of its outline.
typedef struct himc_drum_settings {
    char name[HIMC_NAME_SIZE];
    himc_membrane_config head;
    himc_head usual; ///< when the drum was made
    himc_head_frame place;
    bool placed;  ///< by the command `place`
    bool pedal;   ///< a command has moved the pedal, and not yet a drum's; ...
    double gliss; ///< ... in that time (s), 0: at once
    himc_mallet_head mallet[HIMC_HANDS];
    himc_word mallet_name[HIMC_HANDS]; ///< "medium", or "own" when given by numbers
    double noise;                      ///< its amount
    int noise_seed;                    ///< whose shell and stand answer
    double gain;                       ///< of its sound (factor)
    bool mute;
    bool picked; ///< its pickups have been asked for: a usual listener leaves it to them
    himc_technique technique;
    bool external_sound;
} himc_drum_settings;

/// Those of a drum; free them with himc_drum_settings_free.
HIMC_RT himc_drum_settings himc_drum_settings_of(const himc_drum *drum);
himc_drum_settings himc_drum_settings_copy(const himc_drum_settings *settings);
void himc_drum_settings_free(himc_drum_settings *settings);
/// Takes what commands that change the head have made of `from`: head, pedal, pickups, and the
/// mallet of another body.
HIMC_RT void himc_drum_settings_take_head(himc_drum_settings *settings,
                                          const himc_drum_settings *from);
/// Carries out a command, but for what it does once: a strike, an answer, a file, a preset. False
/// with the reason, and nothing changed, if it is refused.
bool himc_drum_settings_command(himc_drum_settings *settings, const himc_command *command,
                                himc_error *error);

/// Carries out the lines of a preset, NAME of NAME.txt.
bool himc_drum_settings_preset(himc_drum_settings *settings, const char *name, himc_error *error);

/// Those of a new drum, as of himc_drum_new. False with the reason.
bool himc_drum_settings_new(himc_drum_settings *settings, const char *name, double inches,
                            double sample_rate, himc_error *error);
/// A drum with these settings, at rest; NULL with the reason.
himc_drum *himc_drum_new_of(const himc_drum_settings *settings, himc_error *error);
/// Gives the drum these settings. *made, or NULL, is a model of their head, and then the one that
/// the drum had before; with it no memory is allocated. False with the reason, and nothing changed,
/// without memory.
bool himc_drum_set(himc_drum *drum, const himc_drum_settings *settings, himc_model **made,
                   himc_error *error);
HIMC_RT bool himc_drum_has_head(const himc_drum *drum, const himc_drum_settings *settings);

// Heads that a drum gets one after the other while a score plays (drum_heads.c).

typedef struct himc_drum_heads himc_drum_heads;

/// Changes of the head of a drum with these settings, none yet; NULL with the reason.
himc_drum_heads *himc_drum_heads_new(const himc_drum_settings *settings, himc_error *error);
/// Adds a command that is marked HIMC_AT_BEAT, for a beat at or after the last one's: it acts on
/// what the ones before left. False with the reason if the drum refuses it.
bool himc_drum_heads_add(himc_drum_heads *heads, double beat, const himc_command *command,
                         himc_error *error);
/// Computes the heads, so that himc_drum_heads_turn need not. False without memory.
bool himc_drum_heads_prepare(himc_drum_heads *heads, himc_error *error);
/// Beat of the last change, -1 without one.
HIMC_RT double himc_drum_heads_last(const himc_drum_heads *heads);
/// True if the head at that beat is not the one that was last given.
HIMC_RT bool himc_drum_heads_due(const himc_drum_heads *heads, double beat);
/// The damping of the head at that beat (himc_head.damp).
HIMC_RT double himc_drum_heads_damp(const himc_drum_heads *heads, double beat);
/// True if a change behind beat `from`, up to `to`, moves the pedal.
HIMC_RT bool himc_drum_heads_pedal(const himc_drum_heads *heads, double from, double to);
/// Gives the drum the head that it has at that beat: that of the form before the first change.
/// Quick where the drum has still the pickups and the listener of the form, else the head is
/// computed now. Between two samples. False with the reason if a change cannot act on the drum as
/// it is by now; the others do.
bool himc_drum_heads_turn(himc_drum_heads *heads, himc_drum *drum, double beat, himc_error *error);
/// A loop begins again at beat `end`: of the changes there, where no beat of a round is, the drum
/// has the head at the beginning of this round. False as of himc_drum_heads_turn.
bool himc_drum_heads_begin_again(himc_drum_heads *heads, himc_drum *drum, double end,
                                 himc_error *error);
/// Play has begun anew: nothing is left of that.
HIMC_RT void himc_drum_heads_begin_anew(himc_drum_heads *heads);
/// Notices what commands have changed on the drum: it stays until a change sets the same.
HIMC_RT void himc_drum_heads_notice(himc_drum_heads *heads, const himc_drum *drum);
/// Before beat `from` the drum has the heads of `before` (NULL: none), which are `heads`' own from
/// now on. Returns those that are over at beat `now`, to be freed, or NULL.
himc_drum_heads *himc_drum_heads_follow(himc_drum_heads *heads, himc_drum_heads *before,
                                        double from, double now);
/// From now on these are the drum's (NULL: none): its state is told without their changes.
HIMC_RT void himc_drum_set_heads(himc_drum *drum, const himc_drum_heads *heads);
/// Frees them, and those before. NULL is allowed.
void himc_drum_heads_free(himc_drum_heads *heads);

/// A change that is added to those of a drum while they are in use.
typedef struct himc_head_insertion himc_head_insertion;
/// Begins, between two blocks, with those that the drum has (NULL: none); see himc_drum_heads_add.
himc_head_insertion *himc_head_insertion_new(himc_drum_heads *heads, himc_drum *drum, double beat,
                                             const himc_command *command, himc_error *error);
/// Computes the heads; touches the insertion alone. False with the reason if the drum refuses one.
bool himc_head_insertion_prepare(himc_head_insertion *insertion, himc_error *error);
/// Puts it in its place at beat `now`, between two blocks; it acts from the next time on that its
/// beat comes. False, and nothing changed, if the changes or the drum are others by now.
HIMC_RT bool himc_head_insertion_install(himc_head_insertion *insertion, himc_drum_heads **heads,
                                         double now);
/// Frees it, and what it has replaced. NULL is allowed.
void himc_head_insertion_free(himc_head_insertion *insertion);

/// True if a command would take longer than an audio block can wait: a file, or many modes.
HIMC_RT bool himc_drum_takes_long(const himc_drum *drum, const himc_command *command);
/// Such a command as a job; the drum must outlive it. NULL without memory.
himc_job *himc_drum_job(himc_drum *drum, const himc_command *command, himc_error *error);

/// A preset's lines, borrowed, as a job. NULL without memory.
himc_job *himc_drum_state_job(himc_drum *drum, const char *state, himc_error *error);

/// True if himc_drum_listen would take longer than an audio block can wait.
HIMC_RT bool himc_drum_listening_takes_long(const himc_drum *drum);
/// himc_drum_listen as a job; the drum must outlive it, but for `free`. NULL without memory.
himc_job *himc_drum_listen_job(himc_drum *drum, const himc_listener *listener, himc_error *error);

#endif
