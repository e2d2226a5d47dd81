/* himc-tilde.h: what [himc~] holds, shared by its three files: himc~.c (the object in Pd's graph),
himc-drums.c (the drums it finds by name), himc-command.c (what it is told). */
#ifndef HIMC_TILDE_H
#define HIMC_TILDE_H

#include "drum-link.h"
#include "himc/osc.h"

#define FORCE_RING HIMC_DRUM_RING
#define COORDINATES 6 /* of both tips: left x y z, right x y z */

typedef struct t_himc_drum {
    const char *d_name;
    himc_drum *d_drum; /* borrowed from the performance; NULL before the first look-up */
    bool d_silent;     /* made here, for want of a [membrane~] */
    bool d_told;       /* and the user knows */
} t_himc_drum;

typedef struct t_himc {
    t_object x_obj;
    t_canvas *x_canvas;
    t_clock *x_clock;
    t_outlet *x_messages;

    himc_performance *x_performance;
    t_player x_player;
    double x_rate; /* of the performance (Hz) */
    int x_count;
    t_himc_drum x_drum[HIMC_DRUMS];

    t_stream x_stream;
    bool x_signals;              /* made with inlets for targets */
    bool x_spoilt, x_told;       /* a target was not a number, and the user knows */
    t_sample *x_in[COORDINATES]; /* targets of the tips (m) */
    t_sample *x_out[HIMC_HANDS];
    double x_force[HIMC_HANDS][FORCE_RING];

    himc_osc *x_osc;    /* NULL until somebody subscribes or listens */
    t_clock *x_network; /* looks for what came from there */

    bool x_waiting; /* x_event is to be sent */
    himc_event x_event;
} t_himc;

/* himc-drums.c: for the performance and each drum of it. */

/* Finds each drum by name, as [delread~] does; changes nothing where nothing has changed. */
void himc_tilde_resolve(t_himc *x, bool tell);
/* No drum calls x any more. */
void himc_tilde_leave(t_himc *x);
/* Brings the performance to sample `time`, for x's own perform or that of one of its drums. */
void himc_tilde_advance(void *player, uint64_t time);

/* himc-command.c */

/* Any message to the inlet. */
void himc_tilde_anything(t_himc *x, t_symbol *s, int argc, t_atom *argv);
/* What came over OSC, in Pd's own time, also while DSP is off. */
void himc_tilde_network(t_himc *x);

#endif
