/* doubles.c: what two ears hear of a score on one drum, as computed, in 64-bit
floats, and rounded to 32 bits as in a WAV file.
    doubles SCORE SAMPLES OUT.f64 OUT.f32 */
#include <himc/himc.h>

#include <stdio.h>
#include <stdlib.h>

#define BLOCK 64

static bool play(himc_performance *performer, const himc_drum *drum, int samples, FILE *out[2])
{
    double sound[2][BLOCK];
    for (int done = 0; done < samples; done += BLOCK) {
        himc_performance_process(performer, BLOCK, NULL);
        for (int ear = 0; ear < 2; ear++)
            himc_drum_read_channel(drum, ear, (uint64_t)done, BLOCK, sound[ear]);
        for (int i = 0; i < BLOCK && done + i < samples; i++) {
            fwrite((double[]){sound[0][i], sound[1][i]}, sizeof(double), 2, out[0]);
            fwrite((float[]){(float)sound[0][i], (float)sound[1][i]}, sizeof(float), 2, out[1]);
        }
    }
    return fclose(out[0]) == 0 && fclose(out[1]) == 0;
}

int main(int argc, char **argv)
{
    if (argc != 5)
        return 2;
    himc_error error = {""};
    himc_performance_config config = himc_performance_default();
    himc_performance *performer = himc_performance_new(&config, &error);
    himc_drum *drum = himc_drum_new("kettle", 26, config.sample_rate, &error);
    FILE *out[2] = {fopen(argv[3], "wb"), fopen(argv[4], "wb")};
    himc_atom score = {HIMC_ATOM_SYMBOL, 0, argv[1]};
    himc_command command;
    bool good = out[0] && out[1] && performer && drum &&
                himc_performance_add_drum(performer, drum, &error) &&
                himc_command_parse(&command, HIMC_PERFORMER, "score", &score, 1, &error) &&
                himc_performance_command(performer, &command, 0, &error) &&
                play(performer, drum, atoi(argv[2]), out);
    if (!good)
        fprintf(stderr, "doubles: %s\n", error.text);
    himc_drum_release(drum);
    himc_performance_free(performer);
    return !good;
}
