/* drum.c: a drum of one's own, struck without a performer: 32 inches, tuned to 73.4 Hz, one blow with
a hard mallet; one second of sound as raw 32-bit floats on standard output.

    cc drum.c $(pkg-config --cflags --libs himc) -o drum && ./drum >drum.raw */
#include <himc/himc.h>

#include <stdio.h>

static bool send(himc_drum *drum, const char *text, himc_error *error)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_DRUM, text, error) &&
           himc_drum_command(drum, &command, error);
}

int main(void)
{
    enum { RATE = 48000 };
    himc_error error = {""};
    himc_contact_report blow;
    himc_drum *drum = himc_drum_new("low", 32, RATE, &error);
    bool good = drum && send(drum, "tune 73.4", &error) && send(drum, "mallet hard", &error) &&
                send(drum, "strike -0.25 0.1 3", &error);
    for (int done = 0; good && done < RATE; done += 64) {
        double sound[64];
        float out[64];
        uint64_t start = himc_drum_time(drum);
        himc_drum_advance(drum, 64, NULL, NULL, NULL);
        himc_drum_read(drum, start, 64, sound, NULL);
        for (int i = 0; i < 64; i++)
            out[i] = (float)sound[i];
        fwrite(out, sizeof *out, 64, stdout);
    }
    while (good && himc_drum_strike_next(drum, &blow))
        fprintf(stderr, "%.0f N for %.1f ms\n", blow.force, 1e3 * blow.duration);
    if (!good)
        fprintf(stderr, "%s\n", error.text);
    himc_drum_release(drum);
    return !good;
}
