/* [himc~ [-signals] [-save] DRUM ...]: the performer, a simulated percussionist who strikes
[membrane~ DRUM].

inlet    commands, one message each: stroke hit tempo play stop score take ... (himc/command.h)
         a number 0 .. 127, or a list of two: a MIDI key and its velocity, as `note` plays it
         a number from 248 on: a byte of [midirealtimein], for `clock`
inlets   with -signals: target of the left stick's tip, x y z, and of the right one's (m, signals);
         while its three inlets are 0 a stick has no target
inlets   the last two: velocity of keys that come as a number alone, 0 .. 127, as [notein] gives it;
         phase of another's beat, 0 .. 1, for `sync phase` (signal)
outlets  contact force of the left stick (N), of the right stick (N), messages:
         strike TIME HAND DRUM X Y VELOCITY FORCE DURATION   a contact has ended (s, m, m/s, N, s)
         prepare TIME HAND DRUM   the gesture of a stroke begins that touches at TIME (s)
         missed BEAT HAND DRUM   a stroke is not played; BEAT -1: a hit
         beat N   done   info ...   WHAT VALUE   the answer to `get WHAT`
         phase of the beat, 0 .. 1 (signal)

Glue only: commands go to a himc_performance with the sample on which they arrived; those that take
long, by a file, are loaded in another thread while the sound goes on (himc/loader.h). Each block
advances it and puts out the forces of the sticks. A [membrane~] that comes earlier in the tick asks
for its sound first and so advances the performance itself (himc_tilde_advance); the forces wait in
a ring. Nothing is sent from perform: a clock sends it at the start of the next tick. */
#include "himc-tilde.h"
#include "himc/vec.h"
#include "saved-state.h"

#include <stdlib.h>

#define VELOCITY_USUAL 80 /* mf */

static t_class *himc_tilde_class;

/* The signals at the block's end are the targets of the tips. Unconnected inlets are 0 0 0, a point
under the player's seat: such a stick has no target. */
static void himc_tilde_follow(t_himc *x)
{
    int last = x->x_stream.s_length - 1;
    for (int hand = 0; x->x_signals && hand < HIMC_HANDS; hand++) {
        t_sample **in = x->x_in + 3 * hand;
        himc_vec3 tip = {in[0][last], in[1][last], in[2][last]};
        if (!himc_vec3_finite(tip))
            x->x_spoilt = true;
        else if (tip.x != 0 || tip.y != 0 || tip.z != 0)
            himc_performance_target(x->x_performance, (himc_hand)hand, tip);
    }
    if (x->x_spoilt && !x->x_told)
        clock_delay(x->x_clock, 0);
}

/* The phasor of the last inlet at the block's end, which the performer has been brought to; without
one it is 0 all the time. */
static void himc_tilde_sync(t_himc *x)
{
    himc_command clock = {.id = HIMC_COMMAND_CLOCK, .count = 1};
    double phase = x->x_phasor[x->x_stream.s_length - 1];
    if (phase == x->x_led || !(phase >= 0 && phase <= 1))
        return;
    x->x_led = phase;
    clock.atom[0].number = phase;
    himc_performance_command(x->x_performance, &clock, 0, NULL);
}

/* Phase of the beat, interpolated over the block; a jump of half a beat or more is not. */
static void himc_tilde_phase(t_himc *x)
{
    double beat = fmax(himc_performance_measure(x->x_performance).beat, 0);
    double phase = beat - floor(beat), way = phase - x->x_phase;
    way -= floor(way);
    double from = way < 0.5 ? x->x_phase : phase, step = way < 0.5 ? way / x->x_stream.s_length : 0;
    for (int i = 0; i < x->x_stream.s_length; i++) {
        double now = from + (i + 1) * step;
        x->x_beat[i] = (t_sample)(now - floor(now));
    }
    x->x_phase = phase;
}

static t_int *himc_tilde_perform(t_int *w)
{
    t_himc *x = (t_himc *)w[1];
    t_stream *s = &x->x_stream;
    watch_begin();
    himc_tilde_follow(x);
    stream_begin(s, himc_performance_time(x->x_performance));
    himc_tilde_advance(&x->x_player, s->s_count + (uint64_t)s->s_length);
    himc_tilde_sync(x);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; i < s->s_length; i++)
            x->x_out[hand][i] = (t_sample)x->x_force[hand][(s->s_count + (uint64_t)i) % FORCE_RING];
    himc_tilde_phase(x);
    s->s_count += (uint64_t)s->s_length;
    stream_end(s);
    watch_end();
    return w + 2;
}

static void himc_tilde_dsp(t_himc *x, t_signal **sp)
{
    himc_error error;
    t_signal **in = sp + (x->x_signals ? COORDINATES : 0), **out = in + 1;
    if (sp[0]->s_n > FORCE_RING) {
        pd_error(x, "himc~: block size: %d samples, expected 1 .. %d", sp[0]->s_n, FORCE_RING);
    } else if (sp[0]->s_sr != x->x_rate &&
               !himc_performance_set_rate(x->x_performance, sp[0]->s_sr, &error)) {
        pd_error(x, "himc~: %s", error.text);
    } else {
        x->x_rate = sp[0]->s_sr;
        for (int i = 0; x->x_signals && i < COORDINATES; i++)
            x->x_in[i] = sp[i]->s_vec;
        x->x_phasor = in[0]->s_vec;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            x->x_out[hand] = out[hand]->s_vec;
        x->x_beat = out[HIMC_HANDS]->s_vec;
        stream_restart(&x->x_stream, sp[0]);
        himc_tilde_restore(x);
        himc_tilde_resolve(x, true);
        x->x_spoilt = x->x_told = false;
        silence_over(&x->x_silence);
        himc_performance_realign(x->x_performance);
        x->x_player.p_time = 0;
        dsp_add(himc_tilde_perform, 1, x);
        return;
    }
    for (int hand = 0; hand <= HIMC_HANDS; hand++)
        dsp_add_zero(out[hand]->s_vec, out[hand]->s_n);
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
    case HIMC_EVENT_PREPARE:
        SETFLOAT(atom, (t_float)strike->time);
        SETSYMBOL(atom + 1, gensym(himc_hand_name(strike->hand)));
        SETSYMBOL(atom + 2, gensym(strike->drum));
        outlet_anything(x->x_messages, gensym("prepare"), 3, atom);
        break;
    case HIMC_EVENT_MISSED:
        SETFLOAT(atom, isfinite(strike->beat) ? (t_float)strike->beat : -1);
        SETSYMBOL(atom + 1, gensym(himc_hand_name(strike->hand)));
        SETSYMBOL(atom + 2, gensym(strike->drum));
        outlet_anything(x->x_messages, gensym("missed"), 3, atom);
        break;
    case HIMC_EVENT_DONE: outlet_anything(x->x_messages, gensym("done"), 0, NULL); break;
    case HIMC_EVENT_NOTE:
        if (event->refused)
            pd_error(x, "himc~: %s", event->text);
        else
            logpost(x, event->minor ? PD_VERBOSE : PD_NORMAL, "himc~: %s", event->text);
        break;
    }
}

static void himc_tilde_tick(t_himc *x)
{
    himc_tilde_share_room(x);
    if (x->x_spoilt && !x->x_told) {
        x->x_told = true;
        pd_error(x, "himc~: a target signal is not a finite number and is ignored");
    }
    while (x->x_waiting) {
        /* an event that is sent may come back as a command, so the state is written first */
        himc_event event = x->x_event;
        x->x_waiting = himc_performance_event(x->x_performance, &x->x_event);
        himc_tilde_send(x, &event);
    }
}

/* Checks the names of the drums; nothing has been made yet. */
static bool himc_tilde_arguments(int argc, const t_atom *argv, himc_error *error)
{
    if (argc > HIMC_DRUMS)
        return himc_error_set(error, "%d drums, expected 0 .. %d", argc, HIMC_DRUMS);
    for (int i = 0; i < argc; i++) {
        char text[80];
        atom_string(argv + i, text, sizeof text);
        if (argv[i].a_type == A_SYMBOL && text[0] == '-')
            return himc_error_set(
                error, "%s: unknown flag, expected -signals and -save, before the drums", text);
        if (argv[i].a_type != A_SYMBOL || strlen(text) >= HIMC_NAME_SIZE)
            return himc_error_set(error,
                                  "argument %d: %s, expected a drum's name of up to %d characters",
                                  i + 1, text, HIMC_NAME_SIZE - 1);
        if (!drum_name_check(text, error))
            return false;
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
    bool saves = take_flag(&argc, &argv, "-save"), signals = take_flag(&argc, &argv, "-signals");
    saves |= take_flag(&argc, &argv, "-save");
    t_himc *x = (t_himc *)pd_new(himc_tilde_class);
    x->x_canvas = canvas_getcurrent();
    x->x_clock = clock_new(x, (t_method)himc_tilde_tick);
    x->x_network = clock_new(x, (t_method)himc_tilde_network);
    x->x_load = clock_new(x, (t_method)himc_tilde_load);
    silence_init(&x->x_silence, &x->x_obj);
    saved_bind(&x->x_obj.ob_pd);
    himc_performance_config config = himc_performance_default();
    config.sample_rate = sys_getsr();
    config.heard = true;
    config.find_drum = himc_tilde_find_drum;
    config.find_user = x;
    if (himc_tilde_arguments(argc, argv, &error))
        x->x_performance = himc_performance_new(&config, &error);
    x->x_loader = x->x_performance ? himc_loader_new(&error) : NULL;
    if (!x->x_loader) {
        pd_error(NULL, "himc~: %s", error.text);
        pd_free(&x->x_obj.ob_pd);
        return NULL;
    }
    x->x_player.p_himc = x;
    himc_performance_on_tick(x->x_performance, himc_tilde_body, x);
    x->x_player.p_block = himc_tilde_block;
    x->x_rate = config.sample_rate;
    x->x_count = argc;
    for (int i = 0; i < argc; i++)
        x->x_drum[i].d_name = argv[i].a_w.w_symbol->s_name;
    x->x_signals = signals;
    x->x_saves = saves;
    for (int i = 0; signals && i < COORDINATES; i++)
        inlet_new(&x->x_obj, &x->x_obj.ob_pd, &s_signal, &s_signal);
    floatinlet_new(&x->x_obj, &x->x_velocity);
    inlet_new(&x->x_obj, &x->x_obj.ob_pd, &s_signal, &s_signal);
    x->x_velocity = VELOCITY_USUAL;
    outlet_new(&x->x_obj, &s_signal);
    outlet_new(&x->x_obj, &s_signal);
    x->x_messages = outlet_new(&x->x_obj, NULL);
    outlet_new(&x->x_obj, &s_signal);
    return x;
}

static void himc_tilde_free(t_himc *x)
{
    himc_tilde_leave(x);
    saved_unbind(&x->x_obj.ob_pd);
    free(x->x_state);
    himc_osc_free(x->x_osc);
    himc_loader_free(x->x_loader);
    himc_error error;
    if (x->x_performance && !himc_performance_end_recording(x->x_performance, &error))
        pd_error(NULL, "himc~: %s", error.text);
    himc_performance_free(x->x_performance);
    clock_free(x->x_network);
    clock_free(x->x_load);
    silence_free(&x->x_silence);
    clock_free(x->x_clock);
}

EXPORTED void himc_tilde_setup(void);

void himc_tilde_setup(void)
{
    himc_tilde_class =
        class_new(gensym("himc~"), (t_newmethod)himc_tilde_new, (t_method)himc_tilde_free,
                  sizeof(t_himc), CLASS_DEFAULT, A_GIMME, A_NULL);
    if (!himc_tilde_class)
        return; /* a Pd of another float size has refused it and said so */
    class_addmethod(himc_tilde_class, (t_method)himc_tilde_dsp, gensym("dsp"), A_CANT, A_NULL);
    class_addmethod(himc_tilde_class, (t_method)himc_tilde_saved, gensym("state"), A_GIMME, A_NULL);
    class_addanything(himc_tilde_class, (t_method)himc_tilde_anything);
    class_setsavefn(himc_tilde_class, himc_tilde_save);
    post("himc~ " HIMC_VERSION);
}
