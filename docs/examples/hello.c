/* hello.c: a performer, a drum, four strokes; the sound as raw 32-bit floats on standard output.

    cc hello.c $(pkg-config --cflags --libs himc) -o hello && ./hello >hello.raw

The same text is a C++ program: c++ -x c++ hello.c ... */
#include <himc/himc.h>

#include <stdio.h>

static const char *const score[] = {"stroke 0 right legato mf", "stroke 1 left legato mf",
                                    "stroke 2 right accent ff", "stroke 3 left staccato p rim"};

/* A stroke of the score, written as in a score file. */
static bool add(himc_performance *performer, const char *text, himc_error *error)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_PERFORMER, text, error) &&
           himc_performance_command(performer, &command, 0, error);
}

/* Plays one block into `file`; false when everything has been played. */
static bool play_block(himc_performance *performer, himc_drum *drum, FILE *file)
{
    double sound[64];
    float out[64];
    bool playing = true;
    himc_event event;
    uint64_t start = himc_performance_time(performer);
    himc_performance_process(performer, 64, NULL);
    himc_drum_read(drum, start, 64, sound, NULL);
    for (int i = 0; i < 64; i++)
        out[i] = (float)sound[i];
    fwrite(out, sizeof *out, 64, file);
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
    for (size_t i = 0; good && i < sizeof score / sizeof *score; i++)
        good = add(performer, score[i], &error);
    good = good && himc_performance_set_tempo(performer, 120, &error) &&
           himc_performance_play(performer, &error);
    while (good && play_block(performer, drum, stdout))
        continue;
    if (!good)
        fprintf(stderr, "%s\n", error.text);
    himc_drum_release(drum);
    himc_performance_free(performer);
    return !good;
}
