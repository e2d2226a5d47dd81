/* embed.c: a program that contains Pure Data (libpd) and both objects, and prints what a patch
prints while it plays as fast as it can. With a third argument, that many instances play at once, a
thread each. Classes are made and patches are opened by one thread: Pd keeps lists for both that all
its instances share without a lock.
    embed PATCH SECONDS [INSTANCES] */
#include "z_libpd.h"
#include "z_print_util.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000
#define BLOCK 64

void himc_setup(void);

static const char *patch;
static double seconds;

typedef struct player {
    FILE *out;
    t_pdinstance *instance;
    pthread_t thread;
} player;

static _Thread_local FILE *out;

static void print(const char *line)
{
    fprintf(out, "%s", line);
}

static void choose(const player *p)
{
    out = p->out;
    if (p->instance)
        libpd_set_instance(p->instance);
}

static void prepare(const player *p)
{
    choose(p);
    libpd_set_printhook(print);
    libpd_init_audio(0, 1, RATE);
    if (!libpd_openfile(patch, ".")) {
        fprintf(stderr, "%s: cannot be opened\n", patch);
        exit(1);
    }
}

static void *play(void *object)
{
    float sound[BLOCK];
    choose(object);
    for (long n = 0; n < (long)(seconds * RATE); n += BLOCK)
        libpd_process_float(1, NULL, sound);
    return NULL;
}

int main(int argc, char **argv)
{
    player players[16] = {{0}};
    int count = argc > 3 ? atoi(argv[3]) : 1;
    if (argc < 3 || count < 1 || count > 16)
        return 2;
    patch = argv[1];
    seconds = atof(argv[2]);
    libpd_init();
    for (int i = 0; i < count; i++) {
        players[i].out = count > 1 ? tmpfile() : stdout;
        players[i].instance = count > 1 ? libpd_new_instance() : NULL;
    }
    himc_setup();
    for (int i = 0; i < count; i++)
        prepare(&players[i]);
    if (count == 1) {
        play(&players[0]);
        return 0;
    }
    for (int i = 0; i < count; i++)
        pthread_create(&players[i].thread, NULL, play, &players[i]);
    for (int i = 0; i < count; i++) {
        char line[256];
        pthread_join(players[i].thread, NULL);
        rewind(players[i].out);
        printf("instance %d\n", i);
        while (fgets(line, sizeof line, players[i].out))
            fputs(line, stdout);
    }
    return 0;
}
