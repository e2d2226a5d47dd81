/* [himc~ DRUM ...]: the performer, a simulated percussionist who strikes [membrane~ DRUM].

inlet    commands, one message each: stroke hit tempo play stop score take ... (himc/command.h)
outlets  contact force of the left stick (N), of the right stick (N), messages:
         strike TIME HAND DRUM X Y VELOCITY FORCE DURATION   a contact has ended (s, m, m/s, N, s)
         beat N   done   info ...

Glue only: commands go to a himc_performance with the sample on which they arrived; each block
brings it forward and puts out what the sticks felt. A [membrane~] that comes earlier in the tick
asks for its sound first and so brings the performance forward itself (himc_tilde_advance); so the
forces wait in a ring. Nothing is sent from perform: a clock does, at the start of the next tick. */
#define _POSIX_C_SOURCE 200809L
#include "drum-link.h"

#include <time.h>

#define FORCE_RING HIMC_DRUM_RING
#define LOOK 2.0          /* how often the network's commands are taken (ms) */
#define COMMANDS_A_LOOK 8 /* and how many, so that no block is late for them */

static t_class *himc_tilde_class;

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
    t_sample *x_out[HIMC_HANDS];
    double x_force[HIMC_HANDS][FORCE_RING];

    himc_osc *x_osc;    /* NULL until somebody subscribes or listens */
    t_clock *x_network; /* looks for what came from there */

    bool x_waiting; /* x_event is to be sent */
    himc_event x_event;
} t_himc;

static double himc_tilde_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Brings the performance to sample `time`, for x's own perform or that of one of its drums. */
static void himc_tilde_advance(void *player, uint64_t time)
{
    t_himc *x = ((t_player *)player)->p_himc;
    for (uint64_t now; (now = himc_performance_time(x->x_performance)) < time;) {
        uint64_t at = now % FORCE_RING;
        uint64_t n = time - now < FORCE_RING - at ? time - now : FORCE_RING - at;
        double *force[HIMC_HANDS] = {x->x_force[HIMC_LEFT] + at, x->x_force[HIMC_RIGHT] + at};
        double start = x->x_osc ? himc_tilde_seconds() : 0;
        himc_performance_process(x->x_performance, (int)n, force);
        if (x->x_osc)
            himc_osc_publish(x->x_osc, x->x_performance, himc_tilde_seconds() - start);
    }
    x->x_player.p_time = himc_performance_time(x->x_performance);
    if (!x->x_waiting && himc_performance_event(x->x_performance, &x->x_event)) {
        x->x_waiting = true;
        clock_delay(x->x_clock, 0);
    }
}

static t_int *himc_tilde_perform(t_int *w)
{
    t_himc *x = (t_himc *)w[1];
    t_stream *s = &x->x_stream;
    stream_begin(s, himc_performance_time(x->x_performance));
    himc_tilde_advance(&x->x_player, s->s_count + (uint64_t)s->s_length);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; i < s->s_length; i++)
            x->x_out[hand][i] = (t_sample)x->x_force[hand][(s->s_count + (uint64_t)i) % FORCE_RING];
    s->s_count += (uint64_t)s->s_length;
    stream_end(s);
    return w + 2;
}

static void himc_tilde_let_go(t_himc *x, const t_himc_drum *d)
{
    if (d->d_drum && himc_drum_get_driver(d->d_drum).performer == &x->x_player)
        himc_drum_set_driver(d->d_drum, (himc_drum_driver){NULL, NULL});
}

/* Puts `drum` where another of its name was. */
static bool himc_tilde_take(t_himc *x, t_himc_drum *d, himc_drum *drum, himc_error *error)
{
    if (!himc_performance_add_drum(x->x_performance, drum, error))
        return false;
    himc_drum_set_driver(drum, (himc_drum_driver){himc_tilde_advance, &x->x_player});
    d->d_drum = drum;
    return true;
}

/* The drum of [membrane~ NAME] at the performance's rate, or NULL and why not. */
static himc_drum *himc_tilde_find(t_himc *x, const char *name, himc_error *error)
{
    t_drum_link *link = drum_link_find(name);
    if (!link) {
        himc_error_set(error, "no [membrane~ %s]", name);
        return NULL;
    }
    void *performer = himc_drum_get_driver(link->l_drum).performer;
    if (performer && performer != &x->x_player) {
        himc_error_set(error, "[membrane~ %s] is played by another [himc~]", name);
        return NULL;
    }
    if (link->l_rate != x->x_rate && !himc_drum_set_rate(link->l_drum, x->x_rate, error))
        return NULL;
    link->l_rate = x->x_rate;
    return link->l_drum;
}

/* Finds each drum by name, as [delread~] does; changes nothing where nothing has changed. */
static void himc_tilde_resolve(t_himc *x, bool tell)
{
    for (t_himc_drum *d = x->x_drum; d < x->x_drum + x->x_count; d++) {
        himc_error error = {""};
        himc_drum *drum = himc_tilde_find(x, d->d_name, &error);
        if (drum && drum != d->d_drum) {
            himc_tilde_let_go(x, d);
            if (himc_tilde_take(x, d, drum, &error))
                d->d_silent = d->d_told = false;
            else
                drum = NULL;
        }
        if (!drum && !d->d_silent) {
            himc_error ignored;
            himc_drum *silent = himc_drum_new(d->d_name, 23, x->x_rate, &ignored);
            himc_tilde_let_go(x, d);
            d->d_silent = silent && himc_tilde_take(x, d, silent, &ignored);
            himc_drum_release(silent);
        }
        if (!drum && tell && !d->d_told) {
            pd_error(x, "himc~: %s: playing on a silent one", error.text);
            d->d_told = true;
        }
    }
}

static void himc_tilde_dsp(t_himc *x, t_signal **sp)
{
    himc_error error;
    if (sp[0]->s_n > FORCE_RING) {
        pd_error(x, "himc~: block size: %d samples, allowed 1 .. %d", sp[0]->s_n, FORCE_RING);
    } else if (sp[0]->s_sr != x->x_rate &&
               !himc_performance_set_rate(x->x_performance, sp[0]->s_sr, &error)) {
        pd_error(x, "himc~: %s", error.text);
    } else {
        x->x_rate = sp[0]->s_sr;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            x->x_out[hand] = sp[hand]->s_vec;
        stream_restart(&x->x_stream, sp[0]);
        himc_tilde_resolve(x, true);
        himc_performance_realign(x->x_performance);
        x->x_player.p_time = 0;
        dsp_add(himc_tilde_perform, 1, x);
        return;
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        dsp_add_zero(sp[hand]->s_vec, sp[hand]->s_n);
}

static void himc_tilde_send(t_himc *x, const himc_event *event)
{
    if (x->x_osc)
        himc_osc_event(x->x_osc, event);
    const himc_strike *strike = &event->strike;
    t_atom atom[8];
    switch (event->kind) {
    case HIMC_EVENT_STRIKE:
        SETFLOAT(atom, (t_float)strike->time);
        SETSYMBOL(atom + 1, gensym(himc_hand_name(strike->hand)));
        SETSYMBOL(atom + 2, gensym(strike->drum));
        SETFLOAT(atom + 3, (t_float)strike->x);
        SETFLOAT(atom + 4, (t_float)strike->y);
        SETFLOAT(atom + 5, (t_float)strike->velocity);
        SETFLOAT(atom + 6, (t_float)strike->force);
        SETFLOAT(atom + 7, (t_float)strike->duration);
        outlet_anything(x->x_messages, gensym("strike"), 8, atom);
        break;
    case HIMC_EVENT_BEAT:
        SETFLOAT(atom, (t_float)event->beat);
        outlet_anything(x->x_messages, gensym("beat"), 1, atom);
        break;
    case HIMC_EVENT_DONE: outlet_anything(x->x_messages, gensym("done"), 0, NULL); break;
    case HIMC_EVENT_NOTE: logpost(x, PD_NORMAL, "himc~: %s", event->text); break;
    }
}

static void himc_tilde_tick(t_himc *x)
{
    while (x->x_waiting) {
        /* what is sent may come back as a command, so the state is written first */
        himc_event event = x->x_event;
        x->x_waiting = himc_performance_event(x->x_performance, &x->x_event);
        himc_tilde_send(x, &event);
    }
}

/* Pd's own way to a file: absolute, beside the patch, or along its search path. */
static bool himc_tilde_locate(t_himc *x, const char *name, char *path, size_t size,
                              himc_error *error)
{
    char folder[MAXPDSTRING], *base;
    int file = canvas_open(x->x_canvas, name, "", folder, &base, MAXPDSTRING, 0);
    if (file < 0)
        return himc_error_set(error, "%s: no such file beside the patch or in Pd's search path",
                              name);
    sys_close(file);
    if ((size_t)snprintf(path, size, "%s/%s", folder, base) >= size)
        return himc_error_set(error, "%s: its full name is longer than %zu characters", name,
                              size - 1);
    return true;
}

/* Gives a command that names a file its full name: one that is there for reading, or beside the patch for writing. */
static bool himc_tilde_file(t_himc *x, himc_command *command, himc_error *error)
{
    char path[HIMC_PATH_SIZE];
    himc_atom atom[HIMC_COMMAND_ATOMS];
    himc_command found;
    bool record =
        command->id == HIMC_COMMAND_RECORD && strcmp(command->atom[0].symbol, "stop") != 0;
    bool units = command->id == HIMC_COMMAND_UNITS && command->count > 1;
    bool read = units || command->id == HIMC_COMMAND_SCORE || command->id == HIMC_COMMAND_TAKE;
    if (!record && !read)
        return true;
    if (read && !himc_tilde_locate(x, command->atom[0].symbol, path, sizeof path, error))
        return false;
    if (record)
        canvas_makefilename(x->x_canvas, command->atom[0].symbol, path, sizeof path);
    memcpy(atom, command->atom, sizeof atom);
    atom[0].symbol = path;
    const char *name = record                              ? "record"
                       : units                             ? "units"
                       : command->id == HIMC_COMMAND_SCORE ? "score"
                                                           : "take";
    if (!himc_command_parse(&found, HIMC_PERFORMER, name, atom, command->count, error))
        return false;
    himc_command_copy(command, &found);
    return true;
}

static void himc_tilde_line(void *object, const char *line)
{
    outlet_words(((t_himc *)object)->x_messages, "info", line);
}

/* What came over OSC, in Pd's own time, also while DSP is off. */
static void himc_tilde_network(t_himc *x)
{
    char line[HIMC_OSC_LINE];
    himc_osc_receive(x->x_osc, x->x_performance, COMMANDS_A_LOOK);
    while (himc_osc_line(x->x_osc, line))
        pd_error(x, "himc~: %s", line);
    if (x->x_osc)
        clock_delay(x->x_network, LOOK);
}

static bool himc_tilde_open(t_himc *x, int port, himc_error *error)
{
    himc_osc_config config = himc_osc_default();
    config.port = port;
    himc_osc *osc = himc_osc_reopen(x->x_osc, &config, error);
    if (!osc)
        return false;
    x->x_osc = osc;
    himc_performance_on_tick(x->x_performance, himc_osc_tick, osc);
    clock_delay(x->x_network, LOOK);
    return true;
}

/* `listen PORT` begins anew; `subscribe` and `unsubscribe` need no port of our own. */
static bool himc_tilde_osc(t_himc *x, const himc_command *command, himc_error *error)
{
    if (command->id == HIMC_COMMAND_LISTEN) {
        int port = (int)command->atom[0].number;
        return himc_tilde_open(x, port > 0 ? port : -1, error);
    }
    return (x->x_osc || himc_tilde_open(x, -1, error)) &&
           himc_osc_command(x->x_osc, command, error);
}

static bool himc_tilde_command(t_himc *x, t_symbol *s, int argc, t_atom *argv, himc_error *error)
{
    himc_command command;
    if (!command_from_pd(&command, HIMC_PERFORMER, s, argc, argv, error))
        return false;
    if (command.id == HIMC_COMMAND_INFO) {
        himc_performance_describe(x->x_performance, himc_tilde_line, x);
        return true;
    }
    if (command.id == HIMC_COMMAND_SUBSCRIBE || command.id == HIMC_COMMAND_UNSUBSCRIBE ||
        command.id == HIMC_COMMAND_LISTEN)
        return himc_tilde_osc(x, &command, error);
    if (!himc_tilde_file(x, &command, error))
        return himc_error_prefix(error, "%s", s->s_name);
    /* a command may come before DSP is on, and its drums should be there */
    himc_tilde_resolve(x, false);
    int delay = stream_delay(&x->x_stream, himc_performance_time(x->x_performance));
    return himc_performance_command(x->x_performance, &command, delay, error);
}

static void himc_tilde_anything(t_himc *x, t_symbol *s, int argc, t_atom *argv)
{
    himc_error error;
    if (!himc_tilde_command(x, s, argc, argv, &error))
        pd_error(x, "himc~: %s", error.text);
}

/* Checks the names of the drums; nothing has been made yet. */
static bool himc_tilde_arguments(int argc, const t_atom *argv, himc_error *error)
{
    if (argc > HIMC_DRUMS)
        return himc_error_set(error, "%d drums, allowed 0 .. %d", argc, HIMC_DRUMS);
    for (int i = 0; i < argc; i++) {
        char text[80];
        atom_string(argv + i, text, sizeof text);
        if (argv[i].a_type != A_SYMBOL || strlen(text) >= HIMC_NAME_SIZE)
            return himc_error_set(error,
                                  "argument %d: %s, allowed: a drum's name of up to %d characters",
                                  i + 1, text, HIMC_NAME_SIZE - 1);
        for (int k = 0; k < i; k++)
            if (argv[k].a_w.w_symbol == argv[i].a_w.w_symbol)
                return himc_error_set(error, "argument %d: %s is named twice", i + 1, text);
    }
    return true;
}

static void *himc_tilde_new(t_symbol *s, int argc, t_atom *argv)
{
    (void)s;
    himc_error error;
    himc_performance_config config = himc_performance_default();
    config.sample_rate = sys_getsr();
    himc_performance *performance = NULL;
    if (himc_tilde_arguments(argc, argv, &error))
        performance = himc_performance_new(&config, &error);
    if (!performance) {
        pd_error(NULL, "himc~: %s", error.text);
        return NULL;
    }
    t_himc *x = (t_himc *)pd_new(himc_tilde_class);
    x->x_canvas = canvas_getcurrent();
    x->x_clock = clock_new(x, (t_method)himc_tilde_tick);
    x->x_network = clock_new(x, (t_method)himc_tilde_network);
    x->x_performance = performance;
    x->x_player.p_himc = x;
    x->x_rate = config.sample_rate;
    x->x_count = argc;
    for (int i = 0; i < argc; i++)
        x->x_drum[i].d_name = argv[i].a_w.w_symbol->s_name;
    outlet_new(&x->x_obj, &s_signal);
    outlet_new(&x->x_obj, &s_signal);
    x->x_messages = outlet_new(&x->x_obj, NULL);
    return x;
}

static void himc_tilde_free(t_himc *x)
{
    for (int i = 0; i < x->x_count; i++)
        himc_tilde_let_go(x, x->x_drum + i);
    himc_osc_free(x->x_osc);
    himc_performance_free(x->x_performance);
    clock_free(x->x_network);
    clock_free(x->x_clock);
}

/* the one symbol this binary exports */
__attribute__((visibility("default"))) void himc_tilde_setup(void);

void himc_tilde_setup(void)
{
    himc_tilde_class =
        class_new(gensym("himc~"), (t_newmethod)himc_tilde_new, (t_method)himc_tilde_free,
                  sizeof(t_himc), CLASS_DEFAULT, A_GIMME, A_NULL);
    if (!himc_tilde_class)
        return; /* a Pd of another float size has refused it and said so */
    class_addmethod(himc_tilde_class, (t_method)himc_tilde_dsp, gensym("dsp"), A_CANT, A_NULL);
    class_addanything(himc_tilde_class, (t_method)himc_tilde_anything);
    post("himc~ " HIMC_VERSION);
}
