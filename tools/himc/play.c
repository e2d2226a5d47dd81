/// play.c: `himc play`: as `himc render`, to the sound card.
///
/// PortAudio takes blocks when it has room for them, so its clock is the performance's. A block
/// that comes too late is an under-run, which is heard and counted. The card is known only where
/// the program was built with PortAudio (HIMC_PORTAUDIO).
#define _POSIX_C_SOURCE 200809L
#include "base/file.h"
#include "cli.h"

#ifdef HIMC_PORTAUDIO
#include <math.h>
#include <portaudio.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { DEVICE, RATE, LATENCY, LIST };
enum { BLOCK = 256, EARS = 2 }; // samples; chosen: 5 ms, short against the latency

static const cli_option options[] = {
    {"device", 0, "N", "the sound card, a number of --list (the system's usual one)"},
    {"rate", 0, "HZ", "sample rate, 8000 .. 192000 (48000)"},
    {"latency", 0, "MS", "wanted from here to the loudspeaker, 5 .. 500 ms (40)"},
    {"list", 0, NULL, "lists the sound cards"},
    {0},
};

static volatile sig_atomic_t stopped;

static void stop(int number)
{
    (void)number;
    stopped = 1;
}

static bool check(PaError code, const char *what, himc_error *error)
{
    return code == paNoError || himc_error_set(error, "%s: %s", what, Pa_GetErrorText(code));
}

// ALSA and JACK tell on stderr of all that they do not find
static PaError initialize(void)
{
    FILE *nothing = himc_file_write("/dev/null", HIMC_FILE_REPLACE, NULL);
    int told = dup(STDERR_FILENO);
    if (nothing && told >= 0)
        dup2(fileno(nothing), STDERR_FILENO);
    PaError code = Pa_Initialize();
    if (told >= 0) {
        dup2(told, STDERR_FILENO);
        close(told);
    }
    if (nothing)
        fclose(nothing);
    return code;
}

static void list_devices(void)
{
    int cards = 0;
    for (int i = 0; i < Pa_GetDeviceCount(); i++) {
        const PaDeviceInfo *d = Pa_GetDeviceInfo(i);
        if (d->maxOutputChannels >= EARS && ++cards)
            printf("%3d%s %s (%s, %g Hz, %.0f ms)\n", i,
                   i == Pa_GetDefaultOutputDevice() ? "*" : " ", d->name,
                   Pa_GetHostApiInfo(d->hostApi)->name, d->defaultSampleRate,
                   1e3 * d->defaultLowOutputLatency);
    }
    if (cards == 0)
        cli_say("this machine has no sound card\n");
}

static bool open_device(PaStream **stream, const char *wanted, int rate, int latency,
                        himc_error *error)
{
    int device = Pa_GetDefaultOutputDevice(), most = Pa_GetDeviceCount() - 1;
    if (most < 0 || (device < 0 && !wanted))
        return himc_error_set(error, "this machine has no sound card (himc play --list)");
    if (!cli_count("--device", wanted, 0, most, "(himc play --list)", &device, error))
        return false;
    PaStreamParameters to = {.device = device,
                             .channelCount = EARS,
                             .sampleFormat = paFloat32,
                             .suggestedLatency = latency / 1e3};
    return check(Pa_OpenStream(stream, NULL, &to, rate, BLOCK, paClipOff, NULL, NULL),
                 Pa_GetDeviceInfo(device)->name, error) &&
           check(Pa_StartStream(*stream), Pa_GetDeviceInfo(device)->name, error);
}

/// What a playing came to.
typedef struct outcome {
    cli_ending ending;
    bool over;
    long underruns;
    double busy; ///< time spent computing (s)
} outcome;

static bool play_block(himc_performance *p, PaStream *stream, int rate, outcome *o,
                       himc_error *error)
{
    uint64_t cell = (uint64_t)(CLI_CELL * rate);
    float out[EARS * BLOCK];
    himc_event event;
    double start = cli_now();
    double loudest = himc_performance_read(p, out, EARS, BLOCK);
    o->ending.cell_peak = fmax(o->ending.cell_peak, loudest);
    o->ending.samples += BLOCK;
    while (himc_performance_event(p, &event)) {
        if (event.kind == HIMC_EVENT_NOTE)
            cli_say("note: %s\n", event.text);
        o->ending.done |= event.kind == HIMC_EVENT_DONE;
    }
    if (o->ending.samples % cell < BLOCK)
        o->over = cli_is_over(&o->ending, rate);
    o->busy += cli_now() - start;
    PaError code = Pa_WriteStream(stream, out, BLOCK);
    o->underruns += code == paOutputUnderflowed;
    return code == paOutputUnderflowed || check(code, "the sound card", error);
}

static bool play(const cli_arguments *arguments, himc_error *error)
{
    int rate = 48000, latency = 40;
    PaStream *stream = NULL;
    outcome o = {0};
    if (!arguments->operand)
        return himc_error_set(error, "no SOURCE given (himc play --help)");
    if (!cli_count("--rate", arguments->value[RATE], 8000, 192000, "Hz", &rate, error) ||
        !cli_count("--latency", arguments->value[LATENCY], 5, 500, "ms", &latency, error))
        return false;
    const char *source = cli_input(arguments->operand, error);
    himc_performance *p = source ? cli_load(source, rate, CLI_LISTENER, error) : NULL;
    bool good = p && cli_tell(p, "play", NULL, error) &&
                open_device(&stream, arguments->value[DEVICE], rate, latency, error);
    signal(SIGINT, stop);
    signal(SIGTERM, stop);
    while (good && !stopped && !o.over)
        good = play_block(p, stream, rate, &o, error);
    if (stream) {
        double seconds = (double)o.ending.samples / rate;
        printf("{\"seconds\": %.3f, \"underruns\": %ld, \"latency_ms\": %.1f, \"load\": %.3f}\n",
               seconds, o.underruns, 1e3 * Pa_GetStreamInfo(stream)->outputLatency,
               seconds > 0 ? o.busy / seconds : 0);
        Pa_CloseStream(stream);
    }
    good = good && himc_performance_end_recording(p, error);
    himc_performance_free(p);
    return good;
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    if (!check(initialize(), "PortAudio", &error))
        return cli_fail(&cli_play, "%s", error.text);
    bool good = true;
    if (arguments->value[LIST])
        list_devices();
    else
        good = play(arguments, &error);
    Pa_Terminate();
    return good ? cli_finish(&cli_play) : cli_fail(&cli_play, "%s", error.text);
}
#else
static const cli_option options[] = {{0}};

static int run(const cli_arguments *arguments)
{
    (void)arguments;
    return cli_fail(&cli_play, "this himc was built without PortAudio (Debian: portaudio19-dev)");
}
#endif

const cli_call cli_play = {
    "play",
    "[SOURCE]",
    "",
    "plays a score, MIDI, MusicXML or a take to the sound card",
    "Ends after the last stroke, or by Ctrl-C. The last line printed is one JSON object: seconds\n"
    "underruns latency_ms load. A score that loops goes on.",
    options,
    run,
};
