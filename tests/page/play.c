/// play.c: plays pieces through viewer/engine as a page does, but natively: what a page must equal.
///
///     play PIECE ...
///
/// Prints a line for each: samples, strikes, a hash of the floats, a hash of the same in 16 bits.
#include "viewer/engine/engine.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { RATE = 48000, CELL = RATE / 5, EARS = 2 };

// Fowler, Noll and Vo's, by words
static uint32_t hash(uint32_t sum, uint32_t word)
{
    return (sum ^ word) * 16777619u;
}

static int count(const uint8_t *bytes, size_t size, const char *what)
{
    int found = 0;
    size_t length = strlen(what);
    for (size_t i = 0; i + length <= size; i++)
        found += memcmp(bytes + i, what, length) == 0;
    return found;
}

static int fail(const char *piece)
{
    fprintf(stderr, "%s: %s\n", piece, page_error());
    return 1;
}

int main(int pieces, char **piece)
{
    for (int i = 1; i < pieces; i++) {
        uint32_t exact = 2166136261u, coarse = exact, word;
        long samples = 0;
        int strikes = 0;
        snprintf(page_input(), PAGE_INPUT, "%s", piece[i]);
        if (!page_load(RATE))
            return fail(piece[i]);
        strcpy(page_input(), "play");
        if (!page_command())
            return fail(piece[i]);
        do {
            const float *sound = page_play(CELL, 0);
            for (int k = 0; k < EARS * CELL; k++) {
                memcpy(&word, &sound[k], sizeof word);
                exact = hash(exact, word);
                double whole = floor(32767 * fmax(-1, fmin(1, (double)sound[k])) + 0.5);
                coarse = hash(coarse, (uint32_t)(int32_t)whole);
            }
            samples += CELL;
            const uint8_t *frame = page_frame();
            strikes += count(frame, page_frame_size(), "\"event\":\"strike\"");
        } while (!page_is_over());
        printf("%ld %d %08x %08x\n", samples, strikes, (unsigned)exact, (unsigned)coarse);
        fflush(stdout);
    }
    return 0;
}
