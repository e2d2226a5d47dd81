/* [membrane~ [-save] [-m] [NAME [INCHES [CHANNELS]]]]: a drum: a membrane that [himc~ NAME], a
signal or a message strikes.

inlets   force at the spot (N, signal or float) and commands: tune radius mallet strike ...
         (himc/command.h); x and y of the spot (m from the head's centre, x away from the
         performer, signal or float)
outlets  sound, of two ears in front of it or of its performer's `listener`: the left one and the
         right one, or both in one of 1 channel; behind them pickups 3 to CHANNELS; after
         `pickup` or `listener off` all pickups; with -m all of them in one signal of several
         channels, from Pd 0.54 on; displacement under the spot (m); messages:
         strike TIME X Y VELOCITY FORCE DURATION   a `strike` of its own has ended (s, m, m/s, N, s)
         touch TIME X Y VELOCITY PLACE PITCH       a blow begins: distance from the centre
                                                   per radius, the principal mode's frequency (Hz)
         technique NAME                            the new technique of sound
         info ...
         dump WORD ATOMS...                        one of the commands that make its state again

A `touch` comes when its sample has been put out, by a block later than it sounds here and just as
late in each block, so that what a patch starts on it is exact to the sample ([vline~]).

Glue only. Without a performer the object advances its drum itself. With one, the performer steps
head and sticks together, so the inlet's force plays on a second head beside it (layer.h), and the
displacement outlet follows x and y from block to block. Further performers play guests: drums that
take the same commands and are heard with it. */
#include "channels.h"
#include "drum-link.h"
#include "layer.h"
#include "saved-state.h"
#include "silence.h"

#include "m_imp.h" /* obj_starttraverseoutlet */
#include <float.h>

#define GUESTS (DRUM_LINK_PLAYERS - 1) /* performers beside the first */

#define DRAWN_MOST 1000 /* points of a head in an array; chosen: 10 ms of a head of 2000 modes */

static t_class *membrane_class;
static t_set_channels *membrane_set_channels; /* NULL: this Pd has none */

typedef struct t_membrane {
    t_object x_obj;
    t_drum_link x_link; /* must follow: [himc~] looks for it here */
    t_float x_force;    /* the force inlet's value when nothing is connected */
    t_symbol *x_symbol; /* that the object is bound to; NULL if it has no name, or another has it */
    t_symbol *x_queue;  /* that it is bound to while another has its name, and after; or NULL */
    t_clock *x_clock;
    t_outlet *x_messages;
    bool x_multi;       /* all channels are in one signal of several */
    t_canvas *x_canvas; /* presets are beside its patch */
    int x_channels;
    bool x_saves; /* its state in the patch */

    himc_loader *x_loader; /* for heads that take long to compute */
    t_clock *x_load;       /* looks for what it has loaded */

    himc_drum *x_guest[GUESTS]; /* one without a performer is free for the next */
    int x_guests;
    t_layer x_layer;      /* plays the inlet's force while a performer plays the drum */
    t_clock *x_fit_clock; /* makes it equal to the drum */
    bool x_fits_soon;     /* that clock runs */

    t_stream x_stream;
    double x_before; /* what it has played before Pd last built its graph (s) */
    t_sample *x_in[3];
    double x_spot[2]; /* where the force acts at the end of a block (m) */
    t_sample *x_out[LAYER_OUTS];
    bool x_watched; /* the displacement's outlet is connected */

    bool x_waiting; /* x_report is to be sent */
    himc_contact_report x_report;
    t_clock *x_touch_clock; /* runs when x_touch is to be sent */
    bool x_touching;
    himc_contact_onset x_touch;
    himc_technique x_technique; /* that was told last */
    long x_refused;             /* samples of force or place that were not taken as they are */
    bool x_apart;               /* runs at another sample rate than its performer */
    bool x_told;                /* the user, of either, since the graph was built */
    t_silence x_silence;
} t_membrane;

_Static_assert(offsetof(t_membrane, x_link) == sizeof(t_object), "[himc~] looks for it there");

/* Guest `index` if a performer plays it, else NULL. */
static himc_drum *membrane_guest(const t_membrane *x, int index)
{
    return himc_drum_get_driver(x->x_guest[index]).performer ? x->x_guest[index] : NULL;
}

/* True if the drums beside the object's follow it. */
static bool membrane_fits(const t_membrane *x)
{
    const himc_drum *drum = x->x_link.l_drum;
    bool fits = himc_drum_follows(x->x_layer.l_drum, drum);
    for (int i = 0; i < x->x_guests; i++)
        if (membrane_guest(x, i))
            fits = fits && himc_drum_follows(x->x_guest[i], drum);
    return fits;
}

static void membrane_refuses(t_membrane *x, const char *why)
{
    pd_error(x, "membrane~: %s: %s", himc_drum_name(x->x_link.l_drum), why);
}

static void membrane_fit(t_membrane *x, himc_drum *beside)
{
    himc_error error;
    if (!himc_drum_follow(beside, x->x_link.l_drum, &error))
        pd_error(x, "membrane~: %s: inlet: %s", himc_drum_name(x->x_link.l_drum), error.text);
}

/* A sample that is not a finite number becomes 0, one beyond `most` that, and both are counted. */
static double membrane_number(t_membrane *x, t_sample value, double most)
{
    if (fabs(value) <= most)
        return value;
    x->x_refused++;
    return isfinite(value) ? copysign(most, value) : 0;
}

/* Setting the layer may allocate and take long: never from perform. */
static void membrane_fit_heads(t_membrane *x)
{
    x->x_fits_soon = false;
    membrane_fit(x, x->x_layer.l_drum);
    for (int i = 0; i < x->x_guests; i++)
        membrane_fit(x, x->x_guest[i]);
}

/* After a change of the drum. A layer that has not felt a force waits until the pedal rests. */
static void membrane_refit(t_membrane *x, bool again)
{
    if (x->x_layer.l_sounds || x->x_guests > 0)
        clock_delay(x->x_fit_clock, 0);
    else if (again || !x->x_fits_soon)
        clock_delay(x->x_fit_clock, LAYER_PATIENCE);
    x->x_fits_soon = true;
}

/* Adds what further performers play; a guest whose performer has gone rings on. */
static void membrane_add_guests(t_membrane *x, int n, double out[LAYER_OUTS][LAYER_CHUNK])
{
    uint64_t start = x->x_stream.s_count;
    double heard[LAYER_OUTS][LAYER_CHUNK];
    for (int g = 0; g < x->x_guests; g++) {
        himc_drum *guest = x->x_guest[g];
        himc_drum_driver driver = himc_drum_get_driver(guest);
        if (driver.performer)
            driver.advance_to(driver.performer, start + (uint64_t)n);
        else
            himc_drum_advance(guest, n, NULL, NULL, NULL);
        layer_read(guest, x->x_channels, start, n, heard);
        for (int k = 0; k <= x->x_channels; k++)
            for (int i = 0; i < n; i++)
                out[k][i] += heard[k][i];
    }
}

static void membrane_play(t_membrane *x, int n, double in[3][LAYER_CHUNK],
                          double out[LAYER_OUTS][LAYER_CHUNK])
{
    himc_drum *drum = x->x_link.l_drum;
    himc_drum_driver driver = himc_drum_get_driver(drum);
    x->x_apart = x->x_link.l_rate != x->x_stream.s_rate;
    if (x->x_apart) {
        memset(out, 0, LAYER_OUTS * sizeof *out);
    } else if (driver.performer) {
        himc_membrane_watch(himc_drum_membrane(drum), in[1][0], in[2][0]);
        driver.advance_to(driver.performer, x->x_stream.s_count + (uint64_t)n);
        layer_read(drum, x->x_channels, x->x_stream.s_count, n, out);
        membrane_add_guests(x, n, out);
        x->x_layer.l_silent = himc_drum_technique(drum) != HIMC_TECHNIQUE_MODAL;
        layer_play(&x->x_layer, x->x_channels, n, in, out);
    } else {
        himc_drum_advance(drum, n, in[0], in[1], in[2]);
        layer_read(drum, x->x_channels, x->x_stream.s_count, n, out);
    }
    x->x_spot[0] = in[1][n - 1];
    x->x_spot[1] = in[2][n - 1];
    x->x_stream.s_count += (uint64_t)n;
}

/* True if perform has met trouble that the user has not been told. */
static bool membrane_troubled(const t_membrane *x)
{
    return (x->x_refused || x->x_apart) && !x->x_told;
}

/* The next touch of any performer. */
static bool membrane_next_touch(t_membrane *x)
{
    bool found = himc_drum_contact_next(x->x_link.l_drum, &x->x_touch);
    for (int i = 0; i < x->x_guests && !found; i++)
        found = himc_drum_contact_next(x->x_guest[i], &x->x_touch);
    return found;
}

/* Has the next touch sent a block after its sample, as any message's time is in the block to come.
Called when the stream is at the end of a block. */
static void membrane_await_touch(t_membrane *x)
{
    if (x->x_touching || !membrane_next_touch(x))
        return;
    x->x_touching = true;
    double samples = (double)(x->x_touch.at - (int64_t)x->x_stream.s_count) + x->x_stream.s_length;
    double passed = clock_gettimesince(x->x_stream.s_start);
    clock_delay(x->x_touch_clock, fmax(samples * 1000 / x->x_stream.s_rate - passed, 0));
}

static t_int *membrane_perform(t_int *w)
{
    t_membrane *x = (t_membrane *)w[1];
    double in[3][LAYER_CHUNK], out[LAYER_OUTS][LAYER_CHUNK];
    const t_player *player = himc_drum_get_driver(x->x_link.l_drum).performer;
    watch_begin();
    stream_begin(&x->x_stream, player ? player->p_time : himc_drum_time(x->x_link.l_drum));
    for (int done = 0, n; done < x->x_stream.s_length; done += n) {
        n = x->x_stream.s_length - done < LAYER_CHUNK ? x->x_stream.s_length - done : LAYER_CHUNK;
        /* all inlets are read before an outlet is written: they may be the same memory */
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < n; i++)
                in[k][i] =
                    membrane_number(x, x->x_in[k][done + i], k == 0 ? HIMC_FORCE_MAX : DBL_MAX);
        membrane_play(x, n, in, out);
        for (int k = 0; k <= x->x_channels; k++)
            for (int i = 0; i < n; i++)
                x->x_out[k][done + i] = (t_sample)out[k][i];
    }
    stream_end(&x->x_stream);
    membrane_await_touch(x);
    if (!x->x_waiting)
        x->x_waiting = himc_drum_strike_next(x->x_link.l_drum, &x->x_report);
    if (x->x_waiting || membrane_troubled(x) ||
        himc_drum_technique(x->x_link.l_drum) != x->x_technique)
        clock_delay(x->x_clock, 0);
    if (!membrane_fits(x))
        membrane_refit(x, false);
    watch_end();
    return w + 2;
}

/* Outlets of sound. */
static int membrane_sounds(const t_membrane *x)
{
    return x->x_multi ? 1 : x->x_channels;
}

/* The graph is built anew after each change of a connection. */
static void membrane_notice_connections(t_membrane *x)
{
    t_outlet *outlet;
    x->x_watched = obj_starttraverseoutlet(&x->x_obj, &outlet, membrane_sounds(x)) != NULL;
    himc_drum_watch(x->x_link.l_drum, x->x_watched);
    himc_drum_watch(x->x_layer.l_drum, x->x_watched);
    for (int i = 0; i < x->x_guests; i++)
        himc_drum_watch(x->x_guest[i], x->x_watched);
}

static void membrane_dsp(t_membrane *x, t_signal **sp)
{
    himc_error error;
    membrane_notice_connections(x);
    for (int k = 0; membrane_set_channels && k <= membrane_sounds(x); k++)
        membrane_set_channels(&sp[3 + k], x->x_multi && k == 0 ? x->x_channels : 1);
    bool driven = himc_drum_get_driver(x->x_link.l_drum).performer != NULL;
    if (sp[0]->s_n > HIMC_DRUM_RING) {
        pd_error(x, "membrane~: %s: block size: %d samples, expected 1 .. %d",
                 himc_drum_name(x->x_link.l_drum), sp[0]->s_n, HIMC_DRUM_RING);
    } else if (!himc_drum_set_rate(x->x_layer.l_drum, sp[0]->s_sr, &error) ||
               (!driven && !himc_drum_set_rate(x->x_link.l_drum, sp[0]->s_sr, &error))) {
        membrane_refuses(x, error.text);
    } else {
        for (int k = 0; k < 3; k++)
            x->x_in[k] = sp[k]->s_vec;
        for (int k = 0; k < x->x_channels; k++)
            x->x_out[k] = x->x_multi ? sp[3]->s_vec + k * sp[0]->s_n : sp[3 + k]->s_vec;
        x->x_out[x->x_channels] = sp[3 + membrane_sounds(x)]->s_vec;
        if (x->x_stream.s_count > 0)
            x->x_before += (double)x->x_stream.s_count / x->x_stream.s_rate;
        stream_restart(&x->x_stream, sp[0]);
        x->x_link.l_block = sp[0]->s_n;
        if (!driven) {
            x->x_link.l_rate = sp[0]->s_sr;
            himc_drum_realign(x->x_link.l_drum, 0);
        }
        for (int i = 0; i < x->x_guests; i++)
            if (!membrane_guest(x, i))
                himc_drum_realign(x->x_guest[i], 0);
        x->x_told = false;
        silence_over(&x->x_silence);
        membrane_fit_heads(x);
        dsp_add(membrane_perform, 1, x);
        return;
    }
    for (int k = 0; k <= membrane_sounds(x); k++)
        dsp_add_zero(sp[3 + k]->s_vec, sp[3 + k]->s_n * (x->x_multi && k == 0 ? x->x_channels : 1));
}

static void membrane_send(t_membrane *x, const char *selector, const double value[6])
{
    t_atom atom[6];
    for (int i = 0; i < 6; i++)
        SETFLOAT(atom + i, (t_float)value[i]);
    outlet_anything(x->x_messages, gensym(selector), 6, atom);
}

static void membrane_send_strike(t_membrane *x, const himc_contact_report *r)
{
    const double value[] = {x->x_before + r->time, r->x, r->y, r->velocity, r->force, r->duration};
    membrane_send(x, "strike", value);
}

/* A message that is sent may come back as a command, so the state is written first. */
static void membrane_touch_tick(t_membrane *x)
{
    const himc_contact_onset t = x->x_touch;
    const double time = x->x_before + (double)t.at / himc_drum_rate(x->x_link.l_drum);
    const double value[] = {time, t.x, t.y, t.velocity, t.distance, t.pitch};
    x->x_touching = false;
    membrane_await_touch(x);
    membrane_send(x, "touch", value);
}

static void membrane_tell_technique(t_membrane *x)
{
    himc_technique now = himc_drum_technique(x->x_link.l_drum);
    if (now == x->x_technique)
        return;
    t_atom atom;
    x->x_technique = now;
    SETSYMBOL(&atom, gensym(himc_command_word(HIMC_COMMAND_TECHNIQUE, 0, (int)now).text));
    outlet_anything(x->x_messages, gensym("technique"), 1, &atom);
}

static void membrane_tick(t_membrane *x)
{
    const char *name = himc_drum_name(x->x_link.l_drum);
    if (membrane_troubled(x) && x->x_apart)
        pd_error(x, "membrane~: %s: silent at %g Hz, for [himc~] plays it at %g Hz", name,
                 x->x_stream.s_rate, x->x_link.l_rate);
    else if (membrane_troubled(x))
        pd_error(
            x,
            "membrane~: %s: inlet: a sample that is not a finite number is taken as 0, a force "
            "beyond %g N as that",
            name, HIMC_FORCE_MAX);
    x->x_told |= membrane_troubled(x);
    membrane_tell_technique(x);
    while (x->x_waiting) {
        himc_contact_report report = x->x_report;
        x->x_waiting = himc_drum_strike_next(x->x_link.l_drum, &x->x_report);
        membrane_send_strike(x, &report);
    }
}

static void membrane_line(void *object, const char *line)
{
    outlet_words(((t_membrane *)object)->x_messages, "info", line);
}

static void membrane_dump(t_membrane *x)
{
    t_answer answer = {NULL};
    himc_drum_describe(x->x_link.l_drum, HIMC_DESCRIBE_STATE, answer_line, &answer);
    answer_send(&answer, x->x_messages, "dump");
}

static void membrane_info(t_membrane *x)
{
    char text[80];
    himc_drum_describe(x->x_link.l_drum, HIMC_DESCRIBE_INFO, membrane_line, x);
    if (x->x_refused) {
        snprintf(text, sizeof text, "refused %ld samples", x->x_refused);
        membrane_line(x, text);
    }
}

static void membrane_load(t_membrane *x)
{
    if (!pd_in_real_time())
        himc_loader_finish(x->x_loader);
    else if (himc_loader_run(x->x_loader))
        clock_delay(x->x_load, LOAD_PERIOD);
}

/* After a command: what follows from it. */
static void membrane_changed(void *object, const char *refusal)
{
    t_membrane *x = object;
    if (refusal)
        membrane_refuses(x, refusal);
    membrane_refit(x, true);
    membrane_tell_technique(x);
}

/* A preset and a dump are beside the patch. */
static bool membrane_file(t_membrane *x, himc_command *command, himc_error *error)
{
    char path[HIMC_PATH_SIZE];
    himc_command found;
    bool preset = command->id == HIMC_COMMAND_DRUM_PRESET;
    if (command->count == 0 || (!preset && command->id != HIMC_COMMAND_DRUM_DUMP))
        return true;
    const char *name = command->atom[0].symbol;
    if (preset && strpbrk(name, "/\\"))
        return himc_error_set(error, "preset: %.80s, expected a name, without a folder", name);
    canvas_makefilename(x->x_canvas, name, path, sizeof path);
    if (!himc_command_parse(&found, HIMC_DRUM, himc_command_table((int)command->id)->name,
                            &(himc_atom){HIMC_ATOM_SYMBOL, 0, path}, 1, error))
        return false;
    himc_command_copy(command, &found);
    return true;
}

/* A guest takes the drum's commands, but for those that act once. */
static void membrane_command_guests(t_membrane *x, const himc_command *command)
{
    himc_error error;
    bool once = command->id == HIMC_COMMAND_STRIKE || command->id == HIMC_COMMAND_DRUM_DUMP;
    for (int i = 0; i < x->x_guests && !once; i++) {
        himc_load_target target = {.drum = x->x_guest[i]};
        bool good = pd_in_real_time() ? himc_loader_command(x->x_loader, &target, command, &error)
                                      : himc_drum_command(target.drum, command, &error);
        if (!good)
            membrane_refuses(x, error.text);
    }
}

static bool membrane_command(t_membrane *x, t_symbol *s, int argc, t_atom *argv, himc_error *error)
{
    himc_command command;
    himc_drum *drum = x->x_link.l_drum;
    himc_load_target target = {.drum = drum, .done = membrane_changed, .user = x};
    if (!command_from_pd(&command, HIMC_DRUM, s, argc, argv, error) ||
        !membrane_file(x, &command, error))
        return false;
    if (command.id == HIMC_COMMAND_DRUM_INFO)
        membrane_info(x);
    if (command.id == HIMC_COMMAND_DRUM_DUMP && command.count == 0)
        membrane_dump(x);
    if (command.id == HIMC_COMMAND_DRUM_INFO ||
        (command.id == HIMC_COMMAND_DRUM_DUMP && command.count == 0))
        return true;
    if (!pd_in_real_time())
        himc_loader_finish(x->x_loader);
    if (command.id == HIMC_COMMAND_STRIKE && !himc_loader_busy(x->x_loader)) {
        int delay =
            silence_holds(&x->x_silence, "strike")
                ? HIMC_STRIKE_NEVER
                : stream_delay(&x->x_stream, himc_drum_time(drum), drum_link_block(&x->x_link));
        return himc_drum_strike_at(drum, delay, command.atom[0].number, command.atom[1].number,
                                   command.atom[2].number, error);
    }
    bool good = pd_in_real_time() ? himc_loader_command(x->x_loader, &target, &command, error)
                                  : himc_drum_command(drum, &command, error);
    if (good)
        membrane_command_guests(x, &command);
    if (himc_loader_busy(x->x_loader))
        membrane_load(x);
    else if (good)
        membrane_changed(x, NULL);
    return good;
}

static t_membrane *membrane_of(t_drum_link *link)
{
    return (t_membrane *)((char *)link - offsetof(t_membrane, x_link));
}

static void membrane_players(t_drum_link *link, void *player[DRUM_LINK_PLAYERS])
{
    const t_membrane *x = membrane_of(link);
    player[0] = himc_drum_get_driver(link->l_drum).performer;
    for (int i = 0; i < GUESTS; i++)
        player[1 + i] = i < x->x_guests ? himc_drum_get_driver(x->x_guest[i]).performer : NULL;
}

static bool membrane_locate(t_drum_link *link, himc_command *command, himc_error *error)
{
    return membrane_file(membrane_of(link), command, error);
}

static void membrane_commanded(t_drum_link *link, const himc_command *command)
{
    t_membrane *x = membrane_of(link);
    membrane_command_guests(x, command);
    if (himc_loader_busy(x->x_loader))
        membrane_load(x);
    membrane_changed(x, NULL);
}

static void membrane_save(t_gobj *object, t_binbuf *to)
{
    t_membrane *x = (t_membrane *)object;
    t_saving saving = {&x->x_obj, x->x_canvas, to};
    saved_object(&saving);
    if (!x->x_saves)
        return;
    himc_loader_finish(x->x_loader);
    binbuf_addv(to, "ss", gensym("#A"), gensym("state"));
    himc_drum_describe(x->x_link.l_drum, HIMC_DESCRIBE_STATE, saved_line, &saving);
    binbuf_addsemi(to);
}

/* Gives `drum` the state of the object's. */
static bool membrane_copy_state(t_membrane *x, himc_drum *drum, himc_error *error)
{
    t_saving saving = {&x->x_obj, x->x_canvas, binbuf_new()};
    himc_load_target target = {.drum = drum};
    himc_loader_finish(x->x_loader);
    himc_drum_describe(x->x_link.l_drum, HIMC_DESCRIBE_STATE, saved_line, &saving);
    char *state = saved_text(x->x_canvas, binbuf_getnatom(saving.s_to), binbuf_getvec(saving.s_to));
    binbuf_free(saving.s_to);
    himc_error_set(error, "state: out of memory");
    bool good = state && himc_loader_restore(x->x_loader, &target, state, error);
    free(state);
    return good;
}

/* The place for a guest of that performer: its own, or one that is free; -1 if there is none. */
static int membrane_guest_place(const t_membrane *x, const void *performer)
{
    int place = x->x_guests < GUESTS ? x->x_guests : -1;
    for (int i = x->x_guests - 1; i >= 0; i--)
        if (!membrane_guest(x, i))
            place = i;
    for (int i = 0; i < x->x_guests; i++)
        if (himc_drum_get_driver(x->x_guest[i]).performer == performer)
            return i;
    return place;
}

static himc_drum *membrane_invite(t_drum_link *link, const void *performer, himc_error *error)
{
    t_membrane *x = membrane_of(link);
    const char *name = himc_drum_name(link->l_drum);
    int place = membrane_guest_place(x, performer);
    if (place < 0) {
        himc_error_set(error, "[membrane~ %s] is played by %d others", name, GUESTS + 1);
        return NULL;
    }
    if (place < x->x_guests && membrane_guest(x, place))
        return x->x_guest[place];
    himc_drum *guest = himc_drum_new(name, HIMC_INCHES_USUAL, link->l_rate, error);
    if (!guest || !membrane_copy_state(x, guest, error)) {
        himc_drum_release(guest);
        return NULL;
    }
    himc_drum_set_external_sound(guest, true);
    if (place < x->x_guests)
        himc_drum_release(x->x_guest[place]);
    x->x_guests = place < x->x_guests ? x->x_guests : place + 1;
    himc_drum_watch(guest, x->x_watched);
    return x->x_guest[place] = guest;
}

/* The message that membrane_save has written. */
static void membrane_saved(t_membrane *x, t_symbol *s, int argc, t_atom *argv)
{
    (void)s;
    himc_error error = {"state: out of memory"};
    himc_load_target target = {.drum = x->x_link.l_drum};
    char *state = saved_text(x->x_canvas, argc, argv);
    bool good = state && himc_loader_restore(x->x_loader, &target, state, &error);
    free(state);
    x->x_saves = true;
    membrane_changed(x, good ? NULL : error.text);
}

/* True if a message begins with the drum's name, as one to [himc~], and not with a command: a drum
may be called kettle. */
static bool membrane_is_named(const t_membrane *x, t_symbol *s, int argc, const t_atom *argv)
{
    if (argc == 0 || argv->a_type != A_SYMBOL ||
        strcmp(s->s_name, himc_drum_name(x->x_link.l_drum)) != 0)
        return false;
    const char *word = argv->a_w.w_symbol->s_name;
    return !himc_command_find(HIMC_DRUM, s->s_name) || himc_command_find(HIMC_DRUM, word) ||
           strcmp(word, "save") == 0 || strcmp(word, "head") == 0;
}

/* head ARRAY: the head's displacement now (m) along its diameter, from the performer's side on. */
static bool membrane_draw(t_membrane *x, int argc, t_atom *argv, himc_error *error)
{
    t_garray *array;
    int size;
    t_word *points = array_find(&array, &size, argc, argv, 2, "head", error);
    if (!points)
        return false;
    if (size > DRAWN_MOST)
        return himc_error_set(error, "head: %d points, expected 2 .. %d", size, DRAWN_MOST);
    himc_drum *drum = x->x_link.l_drum;
    himc_membrane *head = himc_drum_membrane(drum);
    double radius = himc_drum_head_frame(drum)->radius;
    for (int i = 0; i < size; i++) {
        himc_membrane_watch(head, radius * (2.0 * i / (size - 1) - 1), 0);
        points[i].w_float = (t_float)himc_membrane_watched(head);
    }
    himc_membrane_watch(head, x->x_spot[0], x->x_spot[1]);
    garray_redraw(array);
    return true;
}

static void membrane_anything(t_membrane *x, t_symbol *s, int argc, t_atom *argv)
{
    himc_error error;
    bool good;
    if (membrane_is_named(x, s, argc, argv)) {
        s = argv->a_w.w_symbol;
        argc--;
        argv++;
    }
    if (s == gensym("save"))
        good = saved_switch(&x->x_saves, argc, argv, &error);
    else if (s == gensym("head"))
        good = membrane_draw(x, argc, argv, &error);
    else
        good = membrane_command(x, s, argc, argv, &error);
    if (!good)
        membrane_refuses(x, error.text);
}

/* The object's arguments; all are optional, and without a name no performer finds it. */
typedef struct t_wish {
    const char *w_name;
    double w_inches, w_channels;
    int w_count; /* of arguments, if they name a kind; else 0 */
    t_atom *w_atoms;
} t_wish;

/* Argument `index` (from 1), a number, if it is there. */
static bool membrane_number_argument(int argc, const t_atom *argv, int index, const char *what,
                                     double *number, himc_error *error)
{
    char text[80] = "";
    if (argc < index)
        return true;
    atom_string(argv + index - 1, text, sizeof text);
    if (argv[index - 1].a_type != A_FLOAT)
        return himc_error_set(error, "argument %d: %s, expected %s", index, text, what);
    *number = argv[index - 1].a_w.w_float;
    return true;
}

static bool membrane_arguments(int argc, t_atom *argv, t_wish *wish, himc_error *error)
{
    char text[80] = "";
    if (argc > 0)
        atom_string(argv, text, sizeof text);
    if (argc > 0 && argv[0].a_type != A_SYMBOL)
        return himc_error_set(error, "argument 1: %s, expected a name, as in [membrane~ kettle 26]",
                              text);
    if (argc > 0 && !drum_name_check(argv[0].a_w.w_symbol->s_name, error))
        return false;
    if (argc > 0)
        wish->w_name = argv[0].a_w.w_symbol->s_name;
    if (argc > 1 && argv[1].a_type == A_SYMBOL) {
        wish->w_count = argc;
        wish->w_atoms = argv;
        wish->w_channels = 2;
        return true;
    }
    if (!membrane_number_argument(argc, argv, 2, "a diameter in inches", &wish->w_inches, error) ||
        !membrane_number_argument(argc, argv, 3, "a number of channels", &wish->w_channels,
                                  error) ||
        !himc_check_range("channels", wish->w_channels, 1, HIMC_PICKUPS, "", error))
        return false;
    if (wish->w_channels != floor(wish->w_channels))
        return himc_error_set(error, "channels: %g, expected a whole number", wish->w_channels);
    return argc <= 3 ||
           himc_error_set(error, "%d arguments, expected [-save] NAME [INCHES [CHANNELS]]", argc);
}

/* The drum, or the instrument of the kind that the arguments name. */
static himc_drum *membrane_drum(const t_wish *wish, const char *name, double rate,
                                himc_error *error)
{
    himc_command made;
    if (wish->w_count == 0)
        return himc_drum_new(name, wish->w_inches, rate, error);
    if (!command_from_pd(&made, HIMC_PERFORMER, gensym("instrument"), wish->w_count, wish->w_atoms,
                         error))
        return NULL;
    return himc_drum_made(&made, rate, error);
}

/* A drum with as many pickups as the object has outlets, and the head beside it. */
static himc_drum *membrane_make(const t_wish *wish, double rate, t_layer *layer, himc_error *error)
{
    const char *name = wish->w_name ? wish->w_name : "nameless";
    himc_atom channels = {HIMC_ATOM_NUMBER, wish->w_channels, NULL};
    himc_command pickups;
    himc_drum *drum = membrane_drum(wish, name, rate, error);
    if (drum && himc_command_parse(&pickups, HIMC_DRUM, "pickups", &channels, 1, error) &&
        himc_drum_command(drum, &pickups, error) && himc_drum_set_usual_listener(drum, error))
        layer->l_drum = membrane_drum(wish, name, rate, error);
    if (layer->l_drum) {
        himc_drum_set_external_sound(drum, true);
        return drum;
    }
    himc_drum_release(drum);
    return NULL;
}

/* The symbol of those who wait for a name; as it takes several, it needs no list of ours. */
static t_symbol *membrane_queue(const char *name)
{
    char text[HIMC_NAME_SIZE + 16];
    snprintf(text, sizeof text, "himc-waiting:%s", name);
    return gensym(text);
}

/* Takes the object's name if it is free; true if it has it then. Sent to all who wait when one of
their name is deleted, as after a copy whose original goes. */
static bool membrane_take_name(t_membrane *x)
{
    t_symbol *symbol = drum_link_symbol(himc_drum_name(x->x_link.l_drum));
    if (!symbol->s_thing) {
        pd_bind(&x->x_obj.ob_pd, symbol);
        x->x_symbol = symbol;
    }
    return x->x_symbol;
}

static void membrane_name_free(t_membrane *x)
{
    membrane_take_name(x);
}

static void membrane_bind(t_membrane *x, const char *name)
{
    if (membrane_take_name(x))
        return;
    x->x_queue = membrane_queue(name);
    pd_bind(&x->x_obj.ob_pd, x->x_queue);
    pd_error(
        x,
        "membrane~: %s: there is one of this name already: [himc~] finds this one when that is gone",
        name);
}

/* Gives the name to the next. */
static void membrane_unbind(t_membrane *x)
{
    if (x->x_queue)
        pd_unbind(&x->x_obj.ob_pd, x->x_queue);
    if (!x->x_symbol)
        return;
    pd_unbind(&x->x_obj.ob_pd, x->x_symbol);
    t_symbol *queue = membrane_queue(himc_drum_name(x->x_link.l_drum));
    if (queue->s_thing)
        pd_typedmess(queue->s_thing, gensym("name-free"), 0, NULL);
}

static void *membrane_new(t_symbol *s, int argc, t_atom *argv)
{
    (void)s;
    himc_error error;
    t_wish wish = {NULL, HIMC_INCHES_USUAL, 1, 0, NULL};
    double rate = sys_getsr();
    t_layer layer = {.l_level = 1};
    himc_drum *drum = NULL;
    bool saves = take_flag(&argc, &argv, "-save"), multi = take_flag(&argc, &argv, "-m");
    saves |= take_flag(&argc, &argv, "-save");
    himc_loader *loader = himc_loader_new(&error);
    if (loader && membrane_arguments(argc, argv, &wish, &error)) {
        if (multi && !membrane_set_channels) {
            pd_error(NULL, "membrane~: -m: Pd has several channels in a signal from 0.54 on: one");
            wish.w_channels = 1;
        }
        drum = membrane_make(&wish, rate, &layer, &error);
    }
    if (!drum) {
        himc_loader_free(loader);
        pd_error(NULL, "membrane~: %s%s%s", wish.w_name ? wish.w_name : "", wish.w_name ? ": " : "",
                 error.text);
        return NULL;
    }
    t_membrane *x = (t_membrane *)pd_new(membrane_class);
    x->x_link = (t_drum_link){.l_magic = DRUM_LINK_MAGIC,
                              .l_build = HIMC_BUILD_ID,
                              .l_drum = drum,
                              .l_rate = rate,
                              .l_guest = membrane_invite,
                              .l_players = membrane_players,
                              .l_locate = membrane_locate,
                              .l_commanded = membrane_commanded};
    x->x_layer = layer;
    x->x_loader = loader;
    x->x_load = clock_new(x, (t_method)membrane_load);
    x->x_canvas = canvas_getcurrent();
    x->x_channels = (int)wish.w_channels;
    x->x_multi = multi;
    x->x_saves = saves;
    saved_bind(&x->x_obj.ob_pd);
    x->x_clock = clock_new(x, (t_method)membrane_tick);
    x->x_fit_clock = clock_new(x, (t_method)membrane_fit_heads);
    x->x_touch_clock = clock_new(x, (t_method)membrane_touch_tick);
    silence_init(&x->x_silence, &x->x_obj);
    himc_stroke normal = {.spot = HIMC_SPOT_NORMAL};
    double spot_x, spot_y;
    himc_stroke_spot(&normal, himc_drum_head_frame(drum)->radius, &spot_x, &spot_y);
    signalinlet_new(&x->x_obj, (t_float)spot_x);
    signalinlet_new(&x->x_obj, 0);
    for (int k = 0; k <= membrane_sounds(x); k++)
        outlet_new(&x->x_obj, &s_signal);
    x->x_messages = outlet_new(&x->x_obj, NULL);
    if (wish.w_name)
        membrane_bind(x, wish.w_name);
    return x;
}

static void membrane_free(t_membrane *x)
{
    membrane_unbind(x);
    saved_unbind(&x->x_obj.ob_pd);
    himc_loader_free(x->x_loader);
    /* a performer that plays it keeps it until the graph is built anew */
    himc_drum_release(x->x_link.l_drum);
    himc_drum_release(x->x_layer.l_drum);
    for (int i = 0; i < x->x_guests; i++)
        himc_drum_release(x->x_guest[i]);
    clock_free(x->x_clock);
    clock_free(x->x_fit_clock);
    clock_free(x->x_load);
    clock_free(x->x_touch_clock);
    silence_free(&x->x_silence);
}

EXPORTED void membrane_tilde_setup(void);

void membrane_tilde_setup(void)
{
    membrane_set_channels = pd_find_function("signal_setmultiout");
    membrane_class =
        class_new(gensym(DRUM_LINK_CLASS), (t_newmethod)membrane_new, (t_method)membrane_free,
                  sizeof(t_membrane), membrane_set_channels ? CLASS_OF_CHANNELS : CLASS_DEFAULT,
                  A_GIMME, A_NULL);
    if (!membrane_class)
        return; /* a Pd of another float size has refused it and said so */
    CLASS_MAINSIGNALIN(membrane_class, t_membrane, x_force);
    class_addmethod(membrane_class, (t_method)membrane_dsp, gensym("dsp"), A_CANT, A_NULL);
    class_addmethod(membrane_class, (t_method)membrane_name_free, gensym("name-free"), A_NULL);
    class_addmethod(membrane_class, (t_method)membrane_saved, gensym("state"), A_GIMME, A_NULL);
    class_addanything(membrane_class, (t_method)membrane_anything);
    class_setsavefn(membrane_class, membrane_save);
}
