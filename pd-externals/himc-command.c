/* himc-command.c: the commands to a [himc~], by message or over OSC.

A message becomes a command of the library (himc/command.h). This file does only what the library
leaves to its host: it finds files as Pd does, opens the network, answers `info`, keeps the state in
the patch. */
#include "himc-tilde.h"
#include "himc/osc.h"
#include "saved-state.h"

#include "g_canvas.h"
#include <stdlib.h>
#include <sys/stat.h>

#define NETWORK_PERIOD \
    2.0 /* between two looks for commands from the network (ms); chosen: shorter than a block of
           128 samples */
#define NETWORK_COMMANDS 8 /* most of them at one look; chosen: none makes a block late */

/* A search for a file. */
typedef struct _search {
    const char *name;
    char *path;
    size_t size;
    bool found;
    const char *other; /* what else has that name; or NULL */
} t_search;

/* Looks in one folder, "~" being the home folder; 0 ends the search. */
static int search_folder(const char *folder, void *user)
{
    t_search *search = user;
    const char *home = folder[0] == '~' ? getenv("HOME") : NULL;
    int length = snprintf(search->path, search->size, "%s%s/%s", home ? home : "",
                          folder + (home != NULL), search->name);
    struct stat status;
    bool any = length >= 0 && (size_t)length < search->size && stat(search->path, &status) == 0;
    search->found = any && S_ISREG(status.st_mode);
    if (any && !search->found)
        search->other = S_ISDIR(status.st_mode) ? "a folder" : "a device or FIFO";
    return !search->found;
}

/* Finds a file as Pd does: absolute, beside the patch, or along the search path. Opens nothing:
Pd's canvas_open would wait for the writer of a FIFO. */
static bool himc_tilde_locate(t_himc *x, const char *name, char *path, size_t size,
                              himc_error *error)
{
    bool absolute = sys_isabsolutepath(name);
    t_search search = {name + absolute, path, size, false, NULL};
    if (absolute)
        search_folder(name[0] == '~' ? "~" : "", &search);
    else
        canvas_path_iterate(x->x_canvas, search_folder, &search);
    if (!search.found && search.other)
        return himc_error_set(error, "%s: %s, expected a regular file", name, search.other);
    return search.found ||
           himc_error_set(error, "%s: no such file beside the patch or in Pd's search path", name);
}

/* Replaces the file name in a command by the full name: of an existing file to read, or beside the
patch to write. */
static bool himc_tilde_file(t_himc *x, himc_command *command, himc_error *error)
{
    char path[HIMC_PATH_SIZE];
    himc_atom atom[HIMC_COMMAND_ATOMS];
    himc_command found;
    int at;
    himc_file_use use = himc_command_file(command, &at);
    if (use == HIMC_FILE_NONE)
        return true;
    memcpy(atom, command->atom, sizeof atom);
    if (use == HIMC_FILE_WRITE)
        canvas_makefilename(x->x_canvas, atom[at].symbol, path, sizeof path);
    else if (!himc_tilde_locate(x, atom[at].symbol, path, sizeof path, error))
        return false;
    atom[at].symbol = path;
    if (!himc_command_parse(&found, HIMC_PERFORMER, himc_command_table((int)command->id)->name,
                            atom, command->count, error))
        return false;
    himc_command_copy(command, &found);
    return true;
}

static void himc_tilde_line(void *object, const char *line)
{
    outlet_words(((t_himc *)object)->x_messages, "info", line);
}

void himc_tilde_network(t_himc *x)
{
    char line[HIMC_OSC_LINE];
    himc_osc_receive(x->x_osc, x->x_performance, NETWORK_COMMANDS);
    himc_tilde_load(x);
    while (himc_osc_line(x->x_osc, line))
        pd_error(x, "himc~: %s", line);
    if (x->x_osc)
        clock_delay(x->x_network, NETWORK_PERIOD);
}

static bool himc_tilde_open(t_himc *x, int port, himc_error *error)
{
    himc_osc_config config = himc_osc_default();
    config.port = port;
    config.loader = x->x_loader;
    himc_osc *osc = himc_osc_reopen(x->x_osc, &config, error);
    if (!osc)
        return false;
    x->x_osc = osc;
    clock_delay(x->x_network, NETWORK_PERIOD);
    return true;
}

/* `listen PORT` opens a port; `subscribe` and `unsubscribe` need none. */
static bool himc_tilde_osc(t_himc *x, const himc_command *command, himc_error *error)
{
    if (command->id == HIMC_COMMAND_LISTEN) {
        int port = (int)command->atom[0].number;
        return himc_tilde_open(x, port > 0 ? port : -1, error);
    }
    return (x->x_osc || himc_tilde_open(x, -1, error)) &&
           himc_osc_command(x->x_osc, command, error);
}

void himc_tilde_load(t_himc *x)
{
    himc_tilde_restore(x);
    if (!pd_in_real_time())
        himc_loader_finish(x->x_loader);
    else if (himc_loader_run(x->x_loader))
        clock_delay(x->x_load, LOAD_PERIOD);
}

static void himc_tilde_loaded(void *object, const char *error)
{
    if (error)
        pd_error(object, "himc~: %s", error);
}

/* What takes long, and what comes behind it, waits for the loader. */
static bool himc_tilde_perform_command(t_himc *x, himc_drum *drum, const himc_command *command,
                                       himc_error *error)
{
    int delay = stream_delay(&x->x_stream, himc_performance_time(x->x_performance),
                             himc_tilde_block(&x->x_player));
    himc_load_target target = {.performance = x->x_performance,
                               .drum = drum,
                               .delay = delay,
                               .done = himc_tilde_loaded,
                               .user = x};
    if (pd_in_real_time()) {
        bool good = himc_loader_command(x->x_loader, &target, command, error);
        himc_tilde_load(x);
        return good;
    }
    himc_loader_finish(x->x_loader);
    return drum ? himc_drum_command(drum, command, error)
                : himc_performance_command(x->x_performance, command, delay, error);
}

/* A drum of the performer, or any [membrane~ NAME]. */
static bool himc_tilde_has_drum(const t_himc *x, const char *name)
{
    himc_error none;
    bool has = !himc_command_find(HIMC_PERFORMER, name) && drum_link_find(name, &none);
    for (int i = 0; i < x->x_count; i++)
        has = has || strcmp(x->x_drum[i].d_name, name) == 0;
    return has;
}

/* `DRUM info`: as the drum itself answers it. */
static bool himc_tilde_drum_info(t_himc *x, const char *name, himc_error *error)
{
    himc_error none;
    himc_tilde_resolve(x, false);
    t_drum_link *link = drum_link_find(name, &none);
    himc_drum *drum = link ? link->l_drum : himc_performance_drum(x->x_performance, 0);
    for (int i = 1; drum && strcmp(himc_drum_name(drum), name) != 0; i++) /* a silent one */
        drum = himc_performance_drum(x->x_performance, i);
    if (drum)
        himc_drum_describe(drum, HIMC_DESCRIBE_INFO, himc_tilde_line, x);
    return drum || himc_error_set(error, "%s: info: no [membrane~ %s]", name, name);
}

/* DRUM COMMAND ...: of [membrane~ DRUM], whose own guests take it, too, or of a silent drum. */
static bool himc_tilde_command_drum(t_himc *x, const char *name, himc_command *command,
                                    himc_error *error)
{
    himc_error none;
    if (command->id == HIMC_COMMAND_DRUM_INFO)
        return himc_tilde_drum_info(x, name, error);
    himc_tilde_resolve(x, false);
    t_drum_link *link = drum_link_find(name, &none);
    bool good = !link || link->l_locate(link, command, error);
    snprintf(command->drum, sizeof command->drum, "%s", name);
    if (!link)
        return himc_tilde_perform_command(x, NULL, command, error);
    if (good && command->id == HIMC_COMMAND_DRUM_DUMP && command->count == 0) {
        t_answer answer = {.a_before = name};
        himc_drum_describe(link->l_drum, HIMC_DESCRIBE_STATE, answer_line, &answer);
        answer_send(&answer, x->x_messages, "dump");
        return true;
    }
    if (good && command->id == HIMC_COMMAND_STRIKE && !himc_loader_busy(x->x_loader))
        good = himc_drum_strike_at(
            link->l_drum,
            stream_delay(&x->x_stream, himc_drum_time(link->l_drum), drum_link_block(link)),
            command->atom[0].number, command->atom[1].number, command->atom[2].number, error);
    else
        good = good && himc_tilde_perform_command(x, link->l_drum, command, error);
    if (good)
        link->l_commanded(link, command);
    return good || himc_error_prefix(error, "%s", name);
}

/* The drums save their own state, and a word that is no command of the performer is a drum's
name. */
static void himc_tilde_save_line(void *saving, const char *line)
{
    char word[HIMC_NAME_SIZE];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(line, " "), line);
    const himc_command_row *row = himc_command_find(HIMC_PERFORMER, word);
    if (row && !(row->marks & HIMC_MAKES_DRUM))
        saved_line(saving, line);
}

void himc_tilde_save(t_gobj *object, t_binbuf *to)
{
    t_himc *x = (t_himc *)object;
    t_saving saving = {&x->x_obj, x->x_canvas, to};
    saved_object(&saving);
    if (!x->x_saves)
        return;
    himc_tilde_restore(x);
    himc_loader_finish(x->x_loader);
    binbuf_addv(to, "ss", gensym("#A"), gensym("state"));
    himc_performance_describe(x->x_performance, HIMC_DESCRIBE_STATE, himc_tilde_save_line, &saving);
    binbuf_addsemi(to);
}

void himc_tilde_saved(t_himc *x, t_symbol *s, int argc, t_atom *argv)
{
    (void)s;
    free(x->x_state);
    x->x_state = saved_text(x->x_canvas, argc, argv);
    x->x_saves = true;
    clock_delay(x->x_load, 0);
}

void himc_tilde_restore(t_himc *x)
{
    himc_error error;
    himc_load_target target = {.performance = x->x_performance};
    char *state = x->x_state;
    if (!state)
        return;
    x->x_state = NULL;
    himc_tilde_resolve(x, false);
    if (!himc_loader_restore(x->x_loader, &target, state, &error))
        pd_error(x, "himc~: %s", error.text);
    free(state);
}

/* Reports that nothing plays while DSP is off. True for a hit or a note: it is left out, and
`missed` is sent. */
static bool himc_tilde_waits(t_himc *x, const himc_command *command)
{
    static const himc_stroke any = {.hand = HIMC_HAND_ANY};
    bool note = command->id == HIMC_COMMAND_NOTE && command->atom[1].number > 0;
    const himc_stroke *hit = command->id == HIMC_COMMAND_HIT ? &command->stroke
                             : note                          ? &any
                                                             : NULL;
    bool plays = hit || command->id == HIMC_COMMAND_PLAY || command->id == HIMC_COMMAND_TARGET ||
                 command->id == HIMC_COMMAND_PUSH;
    if (!plays || !silence_holds(&x->x_silence, note ? "note" : hit ? "hit" : NULL) || !hit)
        return false;
    himc_drum *drum = himc_performance_drum(x->x_performance, 0);
    t_atom atom[3];
    SETFLOAT(atom, -1);
    SETSYMBOL(atom + 1, gensym(note ? "any" : command->atom[0].symbol));
    SETSYMBOL(atom + 2, gensym(note                    ? "any"
                               : hit->drum[0] || !drum ? hit->drum
                                                       : himc_drum_name(drum)));
    outlet_anything(x->x_messages, gensym("missed"), 3, atom);
    return true;
}

/* A key with its velocity, or alone as the left outlet of [notein] gives it, or a byte of
[midirealtimein]: the command's name and atoms; NULL for a byte that asks for nothing. */
static t_symbol *himc_tilde_midi(t_himc *x, int *argc, t_atom **argv, t_atom own[2])
{
    enum { TICK = 248, START = 250, CONTINUE, STOP, LAST = 255 };
    t_float byte = (*argv)->a_w.w_float;
    if (*argc > 1 || !(byte >= TICK && byte <= LAST)) {
        own[0] = **argv;
        SETFLOAT(own + 1, x->x_velocity);
        *argv = *argc == 1 ? own : *argv;
        *argc = *argc == 1 ? 2 : *argc;
        return gensym("note");
    }
    *argv = own;
    *argc = byte != TICK;
    if (byte != TICK && (byte < START || byte > STOP))
        return NULL;
    SETSYMBOL(own, gensym(byte == START ? "start" : byte == STOP ? "stop" : "continue"));
    return gensym("clock");
}

/* pose ARRAY: x y z (m) of the joint of each segment to its parent, and of both tips. */
static bool himc_tilde_pose(t_himc *x, int argc, t_atom *argv, himc_error *error)
{
    t_garray *array;
    int size;
    t_word *points = array_find(&array, &size, argc, argv, POSE_NUMBERS, "pose", error);
    if (!points)
        return false;
    for (int i = 0; i < POSE_NUMBERS; i++)
        points[i].w_float = (t_float)x->x_pose[i];
    garray_redraw(array);
    return true;
}

void himc_tilde_body(void *object, const himc_tick *tick)
{
    t_himc *x = object;
    if (x->x_osc)
        himc_osc_tick(x->x_osc, tick);
    for (int i = 0; i < HIMC_SEGMENTS + HIMC_HANDS; i++) {
        int hand = i - HIMC_SEGMENTS;
        himc_vec3 at = hand < 0 ? tick->body->origin[i] : tick->body->tip[hand];
        memcpy(x->x_pose + 3 * i, (double[]){at.x, at.y, at.z}, 3 * sizeof(double));
    }
}

/* gliss DRUM PITCH BEATS: DRUM gliss PITCH SECONDS, at the tempo now. */
static bool himc_tilde_gliss(t_himc *x, const himc_command *asked, himc_error *error)
{
    double seconds = asked->atom[2].number * 60 / himc_performance_measure(x->x_performance).bpm;
    himc_atom atoms[] = {asked->atom[1], {HIMC_ATOM_NUMBER, seconds, NULL}};
    himc_command gliss;
    return himc_command_parse(&gliss, HIMC_DRUM, "gliss", atoms, 2, error) &&
           himc_tilde_command_drum(x, asked->atom[0].symbol, &gliss, error);
}

/* The values of WHAT, behind its name. */
static void himc_tilde_value(void *answer, const char *line)
{
    answer_line(answer, line + strcspn(line, " "));
}

static bool himc_tilde_get(t_himc *x, const char *what, himc_error *error)
{
    t_answer values = {NULL};
    bool found = himc_performance_get(x->x_performance, what, himc_tilde_value, &values, error);
    /* not as the beats that begin are told */
    answer_send(&values, x->x_messages, strcmp(what, "beat") == 0 ? "beat-now" : what);
    return found;
}

static bool himc_tilde_command(t_himc *x, t_symbol *s, int argc, t_atom *argv, himc_error *error)
{
    himc_command command;
    himc_tilde_restore(x);
    if (s == gensym("pose"))
        return himc_tilde_pose(x, argc, argv, error);
    if (s == gensym("save"))
        return saved_switch(&x->x_saves, argc, argv, error);
    if (s == &s_bang)
        s = gensym("play");
    t_atom midi[2];
    if (argc > 0 && argv->a_type == A_FLOAT && (s == &s_float || s == &s_list))
        s = himc_tilde_midi(x, &argc, &argv, midi);
    if (!s)
        return true;
    if (argc > 0 && argv->a_type == A_SYMBOL && himc_tilde_has_drum(x, s->s_name))
        return (command_from_pd(&command, HIMC_DRUM, argv->a_w.w_symbol, argc - 1, argv + 1,
                                error) ||
                himc_error_prefix(error, "%s", s->s_name)) &&
               himc_tilde_command_drum(x, s->s_name, &command, error);
    if (himc_tilde_has_drum(x, s->s_name))
        return himc_error_set(error,
                              "%s: a drum, expected a command behind its name, as in %s damp 1",
                              s->s_name, s->s_name);
    if (!command_from_pd(&command, HIMC_PERFORMER, s, argc, argv, error))
        return false;
    himc_command_when when = himc_command_table((int)command.id)->when;
    if (command.id == HIMC_COMMAND_INFO) {
        himc_performance_describe(x->x_performance, HIMC_DESCRIBE_INFO, himc_tilde_line, x);
        return true;
    }
    if (command.id == HIMC_COMMAND_GET) {
        himc_tilde_resolve(x, false);
        return himc_tilde_get(x, command.atom[0].symbol, error);
    }
    if (command.id == HIMC_COMMAND_DRUM_GLISS) /* of [membrane~ DRUM], as its own command */
        return himc_tilde_gliss(x, &command, error);
    if (command.id == HIMC_COMMAND_DUMP && command.count == 0) {
        himc_tilde_resolve(x, false);
        t_answer answer = {NULL};
        himc_performance_describe(x->x_performance, HIMC_DESCRIBE_STATE, answer_line, &answer);
        answer_send(&answer, x->x_messages, "dump");
        return true;
    }
    if (when == HIMC_WHEN_NETWORK)
        return himc_tilde_osc(x, &command, error);
    if (!himc_tilde_file(x, &command, error))
        return himc_error_prefix(error, "%s", s->s_name);
    /* a command may come before DSP is on, and needs its drums */
    himc_tilde_resolve(x, false);
    return himc_tilde_waits(x, &command) || himc_tilde_perform_command(x, NULL, &command, error);
}

void himc_tilde_anything(t_himc *x, t_symbol *s, int argc, t_atom *argv)
{
    himc_error error;
    if (!himc_tilde_command(x, s, argc, argv, &error))
        pd_error(x, "himc~: %s", error.text);
    himc_tilde_share_room(x);
}
