/// sounds.c: four short OGG files of the drum alone: `sounds FOLDER`.
///
/// scale: D3 to A3 on a 23 inch timpano; roll: 13 strokes a second from pp to ff and back;
/// glissando: a stroke, then the pedal from D3 to A3 and back; mallets: soft, medium, hard, wood.
/// The drum is in air. Stereo, one pickup on each side.
#define _POSIX_C_SOURCE 200809L // fileno
#include "base/file.h"
#include "himc/himc.h"

#include <math.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000
#define BLOCK 240
#define LONGEST_SOUND 8.0 // (s); the longest of the four lasts 7 s

typedef struct player {
    himc_drum *drum;
    double *sound; // (samples, 2)
    int at;
    himc_error error;
} player;

static void fail(const char *what)
{
    fprintf(stderr, "sounds: %s\n", what);
    exit(1);
}

static void say(player *p, const char *text)
{
    himc_command command;
    if (!himc_command_parse_text(&command, HIMC_DRUM, text, &p->error) ||
        !himc_drum_command(p->drum, &command, &p->error))
        fail(p->error.text);
}

static void say_number(player *p, const char *name, double number)
{
    char text[80];
    snprintf(text, sizeof text, name, number);
    say(p, text);
}

static void play(player *p, double seconds)
{
    for (int n = (int)(seconds * RATE / BLOCK); n > 0; n--, p->at += BLOCK) {
        double side[BLOCK];
        himc_drum_advance(p->drum, BLOCK, NULL, NULL, NULL);
        for (int k = 0; k < 2; k++) {
            himc_drum_read_channel(p->drum, k, (uint64_t)p->at, BLOCK, side);
            for (int i = 0; i < BLOCK; i++)
                p->sound[2 * (p->at + i) + k] = 2 * side[i];
        }
    }
}

static void scale(player *p)
{
    static const char *const notes[] = {"D3", "E3", "F#3", "G3", "A3", "G3", "F#3", "E3", "D3"};
    for (int i = 0; i < 9; i++) {
        char text[40];
        say(p, "damp 0.25");
        play(p, 0.1);
        say(p, "damp 0");
        snprintf(text, sizeof text, "tune %s", notes[i]);
        say(p, text);
        say(p, "strike -0.219 0.01 3");
        play(p, i < 8 ? 0.5 : 2);
    }
}

static void roll(player *p)
{
    for (int i = 0; i < 65; i++) {
        double t = i / 64.0, swell = t < 0.6 ? t / 0.6 : (1 - t) / 0.4;
        char text[80];
        snprintf(text, sizeof text, "strike -0.219 %g %g", i % 2 ? 0.03 : -0.03,
                 0.4 + 5 * swell * swell);
        say(p, text);
        play(p, 0.075 + 0.005 * (i % 3));
    }
    play(p, 1.5);
}

static void glissando(player *p)
{
    say(p, "tune D3");
    say(p, "strike -0.219 0 5");
    play(p, 0.5);
    for (int i = 0; i < 200; i++) {
        say_number(p, "tune %.6f",
                   146.832 * pow(2, 7 / 12.0 * (i < 140 ? i / 140.0 : (200 - i) / 60.0)));
        if (i == 100)
            say(p, "strike -0.219 0 4");
        play(p, 0.01);
    }
    play(p, 2);
}

static void mallets(player *p)
{
    himc_word mallet;
    for (int i = 0; (mallet = himc_command_word(HIMC_COMMAND_MALLET, 0, i)).text[0]; i++) {
        char text[64];
        snprintf(text, sizeof text, "mallet %s", mallet.text);
        say(p, text);
        say(p, "strike -0.219 0 4");
        play(p, 1.4);
    }
}

static void save(const player *p, const char *folder, const char *name)
{
    char path[400];
    SF_INFO info = {.samplerate = RATE, .channels = 2, .format = SF_FORMAT_OGG | SF_FORMAT_VORBIS};
    double quality = 0.4; // chosen: no difference to be heard, 40 kB a sound
    snprintf(path, sizeof path, "%s/%s.ogg", folder, name);
    himc_error error;
    FILE *stream = himc_file_write(path, HIMC_FILE_REPLACE, &error);
    if (!stream)
        fail(error.text);
    SNDFILE *file = sf_open_fd(fileno(stream), SFM_WRITE, &info, SF_FALSE);
    if (!file)
        fail(sf_strerror(NULL));
    sf_command(file, SFC_SET_VBR_ENCODING_QUALITY, &quality, sizeof quality);
    for (int at = 0; at < p->at; at += BLOCK)
        sf_writef_double(file, p->sound + 2 * at, BLOCK);
    sf_close(file);
    fclose(stream);
}

int main(int count, char **argument)
{
    static const struct {
        const char *name;
        void (*make)(player *);
    } pieces[] = {{"scale", scale}, {"roll", roll}, {"glissando", glissando}, {"mallets", mallets}};
    if (count != 2)
        fail("usage: sounds FOLDER");
    for (int i = 0; i < 4; i++) {
        player p = {.sound = calloc((size_t)(2 * LONGEST_SOUND * RATE), sizeof(double))};
        p.drum = himc_drum_new("sounds", 23, RATE, &p.error);
        if (!p.drum || !p.sound)
            fail("out of memory");
        say(&p, "tune D3");
        say(&p, "pickups 2");
        say(&p, "channel 1 air 1.2 0.4 1");
        say(&p, "channel 2 air -1.2 0.4 1");
        pieces[i].make(&p);
        save(&p, argument[1], pieces[i].name);
        himc_drum_release(p.drum);
        free(p.sound);
    }
    return 0;
}
