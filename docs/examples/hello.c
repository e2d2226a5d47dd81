/* hello.c: a performer, a drum, four strokes; the sound as raw 32-bit floats on standard output.

    cc hello.c $(pkg-config --cflags --libs himc) -o hello && ./hello >hello.raw

The same text is a C++ program: c++ -x c++ hello.c ... */
#include <himc/himc.h>

#include <stdio.h>

/* The same texts as in a score file, from Pure Data and over OSC. */
static const char *const commands[] = {"stroke 0 right legato mf",
                                       "stroke 1 left legato mf",
                                       "stroke 2 right accent ff",
                                       "stroke 3 left staccato p rim",
                                       "kettle mallet hard",
                                       "tempo 120",
                                       "play"};

/* Plays one block into `file`; false when everything has been played. */
static bool play_block(himc_performance *performer, FILE *file)
{
    float sound[64];
    bool playing = true;
    himc_event event;
    himc_performance_read(performer, sound, 1, 64);
    fwrite(sound, sizeof *sound, 64, file);
    while (himc_performance_event(performer, &event))
        if (event.kind == HIMC_EVENT_STRIKE)
            fprintf(stderr, "%.3f s %s %.0f N\n", event.strike.time,
                    himc_hand_name(event.strike.hand), event.strike.force);
        else if (event.kind == HIMC_EVENT_DONE)
            playing = false;
    return playing;
}

int main(void)
{
    himc_error error = {""};
    himc_performance_config config = himc_performance_default();
    himc_performance *performer = himc_performance_new(&config, &error);
    himc_drum *drum = himc_drum_new("kettle", 26, config.sample_rate, &error);
    bool good = performer && drum && himc_performance_add_drum(performer, drum, &error);
    for (size_t i = 0; good && i < sizeof commands / sizeof *commands; i++)
        good = himc_performance_send(performer, commands[i], &error);
    while (good && play_block(performer, stdout))
        continue;
    if (!good)
        fprintf(stderr, "%s\n", error.text);
    himc_drum_release(drum);
    himc_performance_free(performer);
    return !good;
}
