/// clips.c: strokes of himc's own timpano as sound files, for patches/techniques: `clips FOLDER`.
///
/// A 23 inch timpano in air at D3, evenly tensioned, is struck at three places with three
/// velocities. Each stroke is a WAV file of 32-bit floats, in the units of `pickup air`, and ends
/// in silence. FOLDER/clips.txt lists them, one line each: distance from the centre per radius,
/// velocity (m/s), pitch (Hz), rate (Hz), file.
#define _POSIX_C_SOURCE 200809L // fileno
#include "base/file.h"
#include "himc/himc.h"

#include <math.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>

#define RATE 48000            // (Hz)
#define LENGTH (7 * RATE / 2) // (samples) chosen
#define FADE_OUT (RATE / 2)   // (samples) chosen
#define BLOCK 480             // (samples) chosen
#define PITCH 146.832         // D3

static const double places[] = {0, 0.75, 0.92}; // of the named spots, from the centre per radius

static const struct {
    const char *name;
    double velocity;
} dynamics[] = {{"pp", 0.7}, {"mf", 2}, {"ff", 6}};

static const char *const setting[] = {"tune D3", "uniformity 1"};

static double sound[LENGTH];

static void fail(const char *what)
{
    fprintf(stderr, "clips: %s\n", what);
    exit(1);
}

static himc_drum *timpano(void)
{
    himc_error error;
    himc_command command;
    himc_drum *drum = himc_drum_new("timpano", 23, RATE, &error);
    bool good = drum != NULL;
    for (size_t i = 0; good && i < sizeof setting / sizeof *setting; i++)
        good = himc_command_parse_text(&command, HIMC_DRUM, setting[i], &error) &&
               himc_drum_command(drum, &command, &error);
    if (!good)
        fail(error.text);
    return drum;
}

static void play(double place, double velocity)
{
    himc_error error;
    himc_drum *drum = timpano();
    double x = -place * himc_drum_head_frame(drum)->radius;
    if (!himc_drum_strike_at(drum, 0, x, 0, velocity, &error))
        fail(error.text);
    for (int at = 0; at < LENGTH; at += BLOCK) {
        himc_drum_advance(drum, BLOCK, NULL, NULL, NULL);
        himc_drum_read(drum, (uint64_t)at, BLOCK, sound + at, NULL);
    }
    for (int i = 0; i < FADE_OUT; i++)
        sound[LENGTH - FADE_OUT + i] *= 0.5 + 0.5 * cos(HIMC_PI * (i + 1) / FADE_OUT);
    himc_drum_release(drum);
}

static void keep(const char *path)
{
    SF_INFO info = {.samplerate = RATE, .channels = 1, .format = SF_FORMAT_WAV | SF_FORMAT_FLOAT};
    himc_error error;
    FILE *stream = himc_file_write(path, HIMC_FILE_REPLACE, &error);
    if (!stream)
        fail(error.text);
    SNDFILE *file = sf_open_fd(fileno(stream), SFM_WRITE, &info, SF_FALSE);
    if (!file || sf_writef_double(file, sound, LENGTH) != LENGTH || sf_close(file) ||
        fclose(stream))
        fail(sf_strerror(NULL));
}

int main(int count, char **argument)
{
    char path[400], name[40];
    if (count != 2)
        fail("takes a folder");
    snprintf(path, sizeof path, "%s/clips.txt", argument[1]);
    himc_error error;
    FILE *list = himc_file_write(path, HIMC_FILE_REPLACE, &error);
    if (!list)
        fail(error.text);
    for (int s = 0; s < 3; s++)
        for (int d = 0; d < 3; d++) {
            snprintf(name, sizeof name, "%s-%s.wav", himc_spot_name((himc_spot)s),
                     dynamics[d].name);
            snprintf(path, sizeof path, "%s/%s", argument[1], name);
            play(places[s], dynamics[d].velocity);
            keep(path);
            fprintf(list, "%g %g %.3f %d %s;\n", places[s], dynamics[d].velocity, PITCH, RATE,
                    name);
        }
    return fclose(list) != 0;
}
