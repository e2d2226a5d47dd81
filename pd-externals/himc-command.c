/* himc-command.c: what a [himc~] is told, by message or over OSC.

A message becomes a command of the library's vocabulary. Here is only what the library leaves to its
host: names of files are looked for as Pd does it, the network is opened, `info` is answered. */
#include "himc-tilde.h"
#include "himc/osc.h"

#define LOOK 2.0          /* how often the network's commands are taken (ms) */
#define COMMANDS_A_LOOK 8 /* and how many, so that no block is late for them */

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

/* Gives a command that names a file its full name: one that is there for reading, or beside the
patch for writing. */
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
    himc_command_when when = himc_command_table((int)command.id)->when;
    if (command.id == HIMC_COMMAND_INFO) {
        himc_performance_describe(x->x_performance, himc_tilde_line, x);
        return true;
    }
    if (when == HIMC_WHEN_NETWORK)
        return himc_tilde_osc(x, &command, error);
    if (!himc_tilde_file(x, &command, error))
        return himc_error_prefix(error, "%s", s->s_name);
    /* a command may come before DSP is on, and its drums should be there */
    himc_tilde_resolve(x, false);
    int delay = stream_delay(&x->x_stream, himc_performance_time(x->x_performance));
    return himc_performance_command(x->x_performance, &command, delay, error);
}

void himc_tilde_anything(t_himc *x, t_symbol *s, int argc, t_atom *argv)
{
    himc_error error;
    if (!himc_tilde_command(x, s, argc, argv, &error))
        pd_error(x, "himc~: %s", error.text);
}
