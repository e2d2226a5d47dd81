/// serve.c: `himc serve`: the physics manager alone, in real time, driven and heard over OSC.
///
/// The sample count is the clock: blocks of 2 ms, each started at its time on the monotonic clock.
/// The blocks after a late one start at once until they have caught up; a delay of more than 0.2 s
/// is given up and counted. No sound goes out: sound managers on other machines play the
/// `/himc/strike` messages.
#define _POSIX_C_SOURCE 200809L // nanosleep
#include "cli.h"
#include "himc/osc.h"
#include "scene_record.h"
#include "system/thread.h"

#include <math.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#define RATE 48000         // (Hz)
#define BLOCK 96           // samples; chosen: 2 ms, short against a reaction to a message
#define GIVE_UP 0.2        // (s); chosen: catching up with more would be seen as a jump
#define COMMANDS_A_BLOCK 8 // chosen: none makes a block late

enum { PORT, BIND, FILES, ALLOW, SCENE };

static const cli_option options[] = {
    {"port", 'p', "P", "UDP port, 0 .. 65535, 0 any free one (9000)"},
    {"bind", 0, "ADDR",
     "numeric address to listen at; 0.0.0.0 is all of this machine's (127.0.0.1)"},
    {"files", 0, "DIR", "folder from which `score` and `take` over the network may read (none)"},
    {"allow", 0, "HOST[,HOST]", "hosts that any host may subscribe (else only itself)"},
    {"scene", 0, "F.himc", "records all of it, until the end, for himc-viewer --play"},
    {0},
};

static volatile sig_atomic_t stopped;

static void stop(int signal)
{
    (void)signal;
    stopped = 1;
}

static void sleep_until(double t)
{
    double rest = t - cli_now();
    if (rest > 0)
        nanosleep(&(struct timespec){(time_t)rest, (long)((rest - floor(rest)) * 1e9)}, NULL);
}

/// What is served, and where it is recorded.
typedef struct server {
    himc_performance *performance;
    himc_osc *osc;
    himc_loader *loader;
    cli_file file;
    scene_record *record; ///< NULL without --scene
} server;

static void on_tick(void *user, const himc_tick *tick)
{
    server *s = user;
    himc_osc_tick(s->osc, tick);
    if (s->record)
        scene_record_tick(s->record, tick);
}

// both ears, or one pickup for both
static void record_block(server *s, float *out)
{
    bool one = true;
    for (int i = 0; i < BLOCK; i++)
        one &= out[2 * i + 1] == 0;
    for (int i = 0; one && i < BLOCK; i++)
        out[2 * i + 1] = out[2 * i];
    scene_record_block(s->record, out, BLOCK);
}

static void play_block(server *s)
{
    char line[HIMC_OSC_LINE];
    float out[2 * BLOCK];
    himc_event event;
    double start = cli_now();
    himc_loader_run(s->loader);
    himc_osc_receive(s->osc, s->performance, COMMANDS_A_BLOCK);
    himc_performance_read(s->performance, out, s->record ? 2 : 0, BLOCK);
    while (himc_performance_event(s->performance, &event)) {
        himc_osc_event(s->osc, &event);
        if (s->record)
            scene_record_event(s->record, &event);
        if (event.kind == HIMC_EVENT_NOTE)
            fprintf(stderr, "himc serve: %s\n", event.text);
    }
    if (s->record)
        record_block(s, out);
    himc_osc_publish(s->osc, s->performance, cli_now() - start);
    while (himc_osc_line(s->osc, line))
        fprintf(stderr, "himc serve: %s\n", line);
}

static bool begin_record(server *s, const char *path, const char *source, himc_error *error)
{
    if (!cli_ending_is("--scene", path, ".himc", error) || !cli_apart(path, &source, 1, error) ||
        !cli_file_open(&s->file, path, error))
        return false;
    scene_record_config config = {.performance = s->performance,
                                  .stream = s->file.stream,
                                  .source = source ? source : "",
                                  .name = "himc",
                                  .rate = RATE,
                                  .channels = 2,
                                  .live = true};
    s->record = scene_record_begin(&config, error);
    if (s->record)
        himc_performance_on_motion(s->performance, scene_record_row, s->record);
    return s->record != NULL;
}

static bool end_record(server *s, himc_error *error)
{
    bool good = scene_record_end(s->record, error);
    s->record = NULL;
    return good && cli_file_close(&s->file, error) && cli_file_keep(&s->file, error);
}

/// Statistics of a run. A block that is late but not slow was begun late: the system woke us late,
/// or the blocks before it were late.
typedef struct punctuality {
    long blocks;
    long late;               ///< ended after the next was due
    long slow;               ///< took longer to make than they last
    double latest, given_up; ///< (s)
} punctuality;

static punctuality serve(server *s)
{
    punctuality p = {0};
    double period = (double)BLOCK / RATE, due = cli_now();
    while (!stopped) {
        sleep_until(due);
        double start = cli_now();
        play_block(s);
        due += period;
        double behind = cli_now() - due;
        p.blocks++;
        p.late += behind > 0;
        p.slow += behind + due - start > period;
        p.latest = fmax(p.latest, behind);
        if (behind > GIVE_UP) {
            p.given_up += behind;
            due += behind;
        }
    }
    return p;
}

static bool open_server(server *s, const cli_arguments *arguments, himc_error *error)
{
    himc_osc_config config = himc_osc_default();
    config.bind = arguments->value[BIND];
    config.files = arguments->value[FILES];
    config.allow = arguments->value[ALLOW];
    if (!cli_count("--port", arguments->value[PORT], 0, 65535, "", &config.port, error))
        return false;
    const char *source = cli_input(arguments->operand, error); // it may be left out
    s->performance = source || !arguments->operand ? cli_load(source, RATE, NULL, error) : NULL;
    s->loader = config.loader = s->performance ? himc_loader_new(error) : NULL;
    s->osc = config.loader ? himc_osc_new(&config, error) : NULL;
    return s->osc &&
           (!arguments->value[SCENE] || begin_record(s, arguments->value[SCENE], source, error));
}

static void close_server(server *s)
{
    himc_osc_free(s->osc);
    himc_loader_free(s->loader);
    himc_performance_free(s->performance);
    cli_file_drop(&s->file);
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    server s = {0};
    if (!open_server(&s, arguments, &error)) {
        close_server(&s);
        return cli_fail(&cli_serve, "%s", error.text);
    }
    signal(SIGINT, stop);
    signal(SIGTERM, stop);
    himc_system_go_first();
    himc_performance_on_tick(s.performance, on_tick, &s);
    printf("listening at %s port %d\n",
           arguments->value[BIND] ? arguments->value[BIND] : "127.0.0.1", himc_osc_port(s.osc));
    fflush(stdout);
    punctuality p = serve(&s);
    himc_osc_counts c = himc_osc_count(s.osc);
    bool kept = (!s.record || end_record(&s, &error)) &&
                (!s.performance || himc_performance_end_recording(s.performance, &error));
    close_server(&s);
    if (!kept)
        return cli_fail(&cli_serve, "%s", error.text);
    printf(
        "{\"blocks\": %ld, \"late\": %ld, \"slow\": %ld, \"latest_ms\": %.3f, \"given_up_s\": %.3f, "
        "\"packets\": %ld, \"commands\": %ld, \"malformed\": %ld, \"foreign\": %ld, "
        "\"refused\": %ld, \"frequent\": %ld, \"overrun\": %ld, \"sent\": %ld, \"unsent\": %ld, "
        "\"capped\": %ld, \"lost\": %ld}\n",
        p.blocks, p.late, p.slow, 1e3 * fmax(p.latest, 0), p.given_up, c.packets, c.commands,
        c.malformed, c.foreign, c.refused, c.frequent, c.overrun, c.sent, c.unsent, c.capped,
        c.lost);
    return cli_finish(&cli_serve);
}

const cli_call cli_serve = {
    "serve",
    "[SOURCE]",
    "",
    "the physics manager alone, driven and heard over OSC",
    "Loads a score or a take if one is given and waits: /himc/play begins,\n"
    "/himc/subscribe 127.0.0.1 9001 pose sends the body there. SIGINT or SIGTERM ends it;\n"
    "the last line printed is one JSON object.",
    options,
    run,
};
