/* himc-tilde.h: the state of [himc~], shared by its three files: himc~.c (the object in Pd's
graph), himc-drums.c (the drums it finds by name), himc-command.c (its commands). */
#ifndef HIMC_TILDE_H
#define HIMC_TILDE_H

#include "drum-link.h"
#include "himc/body.h"
#include "himc/osc.h"
#include "silence.h"

#define FORCE_RING HIMC_DRUM_RING
#define POSE_NUMBERS (3 * (HIMC_SEGMENTS + HIMC_HANDS)) /* places of joints and tips */
#define COORDINATES 6                                   /* of both tips: left x y z, right x y z */

typedef struct t_himc_drum {
    const char *d_name;
    himc_drum *d_drum; /* borrowed from the performance; NULL before the first look-up */
    bool d_silent;     /* made here because no [membrane~] has that name */
    bool d_told;       /* and the user has been told */
} t_himc_drum;

typedef struct t_himc {
    t_object x_obj;
    t_canvas *x_canvas;
    t_clock *x_clock;
    t_outlet *x_messages;
    t_float x_velocity; /* of a key that comes as a number alone */

    himc_performance *x_performance;
    t_player x_player;
    double x_rate; /* of the performance (Hz) */
    int x_count;
    t_himc_drum x_drum[HIMC_DRUMS];
    long x_hearings; /* changes of listener and room that those at its drums have taken */

    t_stream x_stream;
    bool x_signals;              /* made with inlets for targets */
    bool x_spoilt, x_told;       /* a target was not a number; the user has been told */
    t_sample *x_in[COORDINATES]; /* targets of the tips (m) */
    t_sample *x_out[HIMC_HANDS];
    t_sample *x_phasor, *x_beat; /* phase of a beat that leads, and of the performer's own */
    double x_led, x_phase;       /* the last of them */
    double x_force[HIMC_HANDS][FORCE_RING];

    himc_loader *x_loader; /* for commands that take long, of messages and of the network */
    t_clock *x_load;       /* looks for what it has loaded */

    double x_pose[POSE_NUMBERS]; /* at the last task tick (m) */
    himc_osc *x_osc;             /* NULL until `subscribe` or `listen` */
    t_clock *x_network;          /* looks for commands from there */
    t_silence x_silence;

    bool x_saves;   /* its state in the patch */
    char *x_state;  /* from there, to be restored when all drums of the patch are made; or NULL */
    bool x_waiting; /* x_event is to be sent */
    himc_event x_event;
} t_himc;

/* himc-drums.c */

/* Finds each drum by name, as [delread~] does, and replaces those that have changed. */
void himc_tilde_resolve(t_himc *x, bool tell);
/* Takes the drum of [membrane~ NAME] that a command names and the arguments do not; false if there
is none. */
bool himc_tilde_find_drum(void *x, const char *name);
/* Those who share a drum are in one room: the last `listener` or `room` of any of them holds. */
void himc_tilde_share_room(t_himc *x);
/* From now on no drum calls x. */
void himc_tilde_leave(t_himc *x);
/* Advances the performance to sample `time`; called by the perform of x or of one of its drums. */
void himc_tilde_advance(void *player, uint64_t time);
/* The longest block of those that do so (samples). */
int himc_tilde_block(void *player);

/* himc-command.c */

/* Any message to the inlet. */
void himc_tilde_anything(t_himc *x, t_symbol *s, int argc, t_atom *argv);
/* A task tick: to the network, and kept for `pose`. */
void himc_tilde_body(void *object, const himc_tick *tick);
/* Writes the object into a patch, with its state if it keeps it there. */
void himc_tilde_save(t_gobj *object, t_binbuf *to);
/* The message that himc_tilde_save has written. */
void himc_tilde_saved(t_himc *x, t_symbol *s, int argc, t_atom *argv);
/* Restores a state that waits. */
void himc_tilde_restore(t_himc *x);
/* Installs what has been loaded. */
void himc_tilde_load(t_himc *x);
/* Carries out commands from OSC, in Pd's own time, also while DSP is off. */
void himc_tilde_network(t_himc *x);

#endif
