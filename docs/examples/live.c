/* live.c: commands typed by a person, played by an audio callback: PortAudio's thread plays, this one
reads the commands. Nothing in it waits for the other.

    cc live.c $(pkg-config --cflags --libs himc portaudio-2.0) -o live && ./live

then lines like `hit right legato f`, `stroke 1 left accent ff`, `play`, `kettle tune 110`; `quit` or the
end of the input ends it. */
#include <himc/himc.h>
#include <himc/loader.h>
#include <portaudio.h>

#include <stdio.h>
#include <string.h>

enum { EARS = 2, RATE = 48000 };

typedef struct player {
    himc_performance *performer; /* of the callback, once the stream runs */
    himc_loader *loader;
} player;

/* PortAudio's thread, which must not wait. */
static int play(const void *in, void *out, unsigned long frames,
                const PaStreamCallbackTimeInfo *time, PaStreamCallbackFlags flags, void *user)
{
    player *p = user;
    (void)in, (void)time, (void)flags;
    himc_loader_run(p->loader);
    himc_performance_read(p->performer, out, EARS, (int)frames);
    return paContinue;
}

/* Reads commands up to the end; the reason of each one that is refused goes to the person. */
static void obey(player *p)
{
    char line[256];
    himc_error error;
    while (fgets(line, sizeof line, stdin) && strcmp(line, "quit\n") != 0) {
        if (line[0] != '\n' && !himc_loader_post(p->loader, p->performer, line, &error))
            printf("%s\n", error.text); /* not a command: told at once */
        Pa_Sleep(50);
        while (himc_loader_refused(p->loader, &error))
            printf("%s\n", error.text); /* it could not be carried out */
    }
}

static bool start(player *p, PaStream **stream, himc_error *error)
{
    himc_performance_config config = himc_performance_default();
    config.sample_rate = RATE;
    config.heard = true; /* by two ears */
    p->performer = himc_performance_new(&config, error);
    p->loader = himc_loader_new(error);
    if (!p->performer || !p->loader)
        return false;
    himc_performance_make_drums(p->performer, true);
    if (!himc_performance_send(p->performer, "drum kettle", error))
        return false;
    PaError code = Pa_Initialize();
    if (code == paNoError)
        code = Pa_OpenDefaultStream(stream, 0, EARS, paFloat32, RATE, 256, play, p);
    if (code == paNoError)
        code = Pa_StartStream(*stream);
    return code == paNoError || himc_error_set(error, "PortAudio: %s", Pa_GetErrorText(code));
}

int main(void)
{
    himc_error error = {""};
    PaStream *stream = NULL;
    player p = {NULL, NULL};
    bool good = start(&p, &stream, &error);
    if (good)
        obey(&p);
    else
        fprintf(stderr, "%s\n", error.text);
    if (stream)
        Pa_CloseStream(stream);
    Pa_Terminate();
    himc_loader_free(p.loader); /* before what its commands are for */
    himc_performance_free(p.performer);
    return !good;
}
