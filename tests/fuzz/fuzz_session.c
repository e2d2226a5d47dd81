/// fuzz_session.c: commands in play: an input is a session of a performer, from its `reset` on.
///
/// Four bytes are a command, made from the table of all commands and its grammar
/// (random_commands.h), and the time that is played after it: which row, a seed of its atoms, the
/// time. Commands that name a file are left out. All that the session shows is finite.
#include "fuzz.h"

#include "finite_watch.h"
#include "random_commands.h"

#define RATE 16000     // (Hz) of samples, physics at 1000 Hz: to save time
#define MOST 12        // commands; chosen: an input stays quick
#define LONGEST 0.2    // after a command (s)
#define AFTERWARDS 0.1 // (s)
#define TEMPO_ROWS 128 // of 256: half of the commands concern the tempo

const long fuzz_runs = 150;

static himc_performance *performance;
static finite_watch watch;

static himc_performance *make(void)
{
    static const char *const none[] = {"none", NULL};
    himc_error error;
    himc_performance_config rates = {.sample_rate = RATE, .physics_rate = 1000, .task_rate = 250};
    himc_performance *p = himc_performance_new(&rates, &error);
    himc_drum *drum = himc_drum_new("kettle", 23, RATE, &error);
    require(p && drum && himc_performance_add_drum(p, drum, &error), "a performance");
    himc_drum_release(drum);
    random_files = none;
    watch.p = p;
    himc_performance_on_motion(p, watch_row, &watch);
    return p;
}

static void play(double seconds)
{
    double sound[RATE / 250];
    himc_event event;
    for (double t = 0; t < seconds; t += 1 / 250.0) {
        himc_performance_process(performance, RATE / 250, NULL);
        while (himc_performance_event(performance, &event))
            if (event.kind == HIMC_EVENT_STRIKE)
                require(isfinite(event.strike.time + event.strike.force + event.strike.velocity),
                        "a strike is finite");
        himc_drum *drum = himc_performance_drum(performance, 0);
        himc_drum_read(drum, himc_drum_time(drum) - RATE / 250, RATE / 250, sound, NULL);
        require(all_finite(sound, sizeof sound), "the sound is finite");
        finite_watch_plans(&watch);
        require(!watch.bad, watch.bad ? watch.bad : "");
    }
}

static void carry_out(const spoken *s)
{
    himc_command c;
    himc_error error = {""};
    int file;
    if (!himc_command_parse(&c, s->receiver, s->name, s->atom, s->count, &error) ||
        himc_command_file(&c, &file) != HIMC_FILE_NONE)
        return;
    bool done = s->receiver == HIMC_PERFORMER
                    ? himc_performance_command(performance, &c, 0, &error)
                    : himc_drum_command(himc_performance_drum(performance, 0), &c, &error);
    if (!done)
        require_line(&error);
}

static const himc_command_row *row_of(uint8_t choice)
{
    static const himc_command_id of_tempo[] = {
        HIMC_COMMAND_TEMPO, HIMC_COMMAND_TEMPO, HIMC_COMMAND_ROLL, HIMC_COMMAND_ROLL,
        HIMC_COMMAND_FLAM,  HIMC_COMMAND_DRAG,  HIMC_COMMAND_PLAY, HIMC_COMMAND_TARGET};
    return himc_command_table(choice < TEMPO_ROWS ? (int)of_tempo[choice % 8]
                                                  : (choice - TEMPO_ROWS) % HIMC_COMMANDS);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_command reset;
    himc_error error;
    spoken s;
    performance = performance ? performance : make();
    require(himc_command_parse_text(&reset, HIMC_PERFORMER, "reset", &error) &&
                himc_performance_command(performance, &reset, 0, &error),
            error.text);
    for (int i = 0; i < MOST && size >= 4; i++, data += 4, size -= 4) {
        random_seed seed = 256 * data[1] + data[2];
        any(&seed);
        random_command(&s, row_of(data[0]), &seed);
        carry_out(&s);
        play(LONGEST * data[3] * data[3] / 65536);
    }
    play(AFTERWARDS);
    return 0;
}
