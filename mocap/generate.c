/// generate.c: writes the motion database: `generate [--seed N] [--strokes N] FOLDER`, or compares
/// it with measured strokes: `generate --measure`.
#define _POSIX_C_SOURCE 200809L
#include "mocap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool write_one(const himc_mocap_config *config, const char *folder, himc_error *error)
{
    himc_mocap *mocap = himc_mocap_new(config, error);
    bool ok = mocap != NULL;
    for (int i = 0; ok && i < 2; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s-%s-%s.%s", folder,
                 himc_mocap_player_name(config->player), himc_nuance_name(config->nuance),
                 himc_spot_name(config->spot), i ? "c3d" : "bvh");
        ok = himc_mocap_write(mocap, path, error);
    }
    himc_mocap_free(mocap);
    return ok;
}

static bool write_all(himc_mocap_config config, const char *folder, himc_error *error)
{
    int count = 0;
    bool ok = true;
    for (config.player = 0; config.player < HIMC_MOCAP_PLAYERS; config.player++)
        for (int nuance = 0; nuance < HIMC_NUANCES; nuance++)
            for (int spot = 0; ok && spot <= HIMC_SPOT_RIM; spot++) {
                config.nuance = (himc_nuance)nuance;
                config.spot = (himc_spot)spot;
                ok = write_one(&config, folder, error);
                count += ok;
            }
    printf("wrote %d sequences of %d strokes into %s\n", count, config.strokes, folder);
    return ok;
}

static bool print_comparison(uint64_t seed, himc_error *error)
{
    char text[8192];
    bool ok = himc_mocap_compare(seed, text, sizeof text, error);
    if (ok)
        fputs(text, stdout);
    return ok;
}

// a whole number that follows an option
static bool read_number(const char *name, const char *text, uint64_t least, uint64_t most,
                        uint64_t *number, himc_error *error)
{
    char *end;
    if (!text || !*text || strspn(text, "0123456789") != strlen(text))
        return himc_error_set(error, "%s: \"%s\", expected a whole number", name, text ? text : "");
    *number = strtoull(text, &end, 10);
    if (*number < least || *number > most)
        return himc_error_set(error, "%s: %s, expected %llu .. %llu", name, text,
                              (unsigned long long)least, (unsigned long long)most);
    return true;
}

int main(int argc, char **argv)
{
    himc_mocap_config config = himc_mocap_default();
    himc_error error = {""};
    const char *folder = NULL;
    bool measure = false, ok = true;
    for (int i = 1; ok && i < argc; i++) {
        uint64_t number = 0;
        if (strcmp(argv[i], "--measure") == 0) {
            measure = true;
        } else if (strcmp(argv[i], "--seed") == 0) {
            ok = read_number("--seed", argv[++i], 0, UINT64_MAX, &config.seed, &error);
        } else if (strcmp(argv[i], "--strokes") == 0) {
            ok = read_number("--strokes", argv[++i], 2, 200, &number, &error);
            config.strokes = (int)number;
        } else if (argv[i][0] == '-' || folder) {
            ok = himc_error_set(&error,
                                "%s: not known, expected --measure --seed N --strokes N "
                                "FOLDER",
                                argv[i]);
        } else {
            folder = argv[i];
        }
    }
    if (ok && !folder && !measure)
        ok = himc_error_set(&error, "usage: generate [--seed N] [--strokes N] FOLDER | --measure");
    if (ok && measure)
        ok = print_comparison(config.seed, &error);
    if (ok && folder)
        ok = write_all(config, folder, &error);
    if (!ok)
        fprintf(stderr, "generate: %s\n", error.text);
    return ok ? 0 : 1;
}
