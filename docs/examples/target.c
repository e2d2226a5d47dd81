/* target.c: live targets for a drumstick, as a tracker would send them, and the body read back.

The right tip follows a circle above the drum for two seconds; at each task tick (250 Hz) the callback
gets the simulated body. Prints the largest distance of tip and target after the first half second (mm),
and the lowest height of the right elbow (m).

    cc target.c $(pkg-config --cflags --libs himc) -lm -o target && ./target */
#include <himc/body.h>
#include <himc/himc.h>

#include <math.h>
#include <stdio.h>

typedef struct readback {
    double farthest; /* distance of the right tip from its target (m) */
    double lowest;   /* height of the right elbow (m) */
} readback;

/* Called inside himc_performance_process, so it neither allocates nor prints. */
static void read_body(void *user, const himc_tick *tick)
{
    readback *seen = user;
    himc_vec3 off = himc_vec3_sub(tick->body->tip[HIMC_RIGHT], tick->target[HIMC_RIGHT]);
    if (tick->time > 0.5)
        seen->farthest = fmax(seen->farthest, himc_vec3_length(off));
    seen->lowest = fmin(seen->lowest, tick->body->origin[HIMC_RIGHT_FOREARM].z);
}

int main(void)
{
    himc_error error = {""};
    readback seen = {0, INFINITY};
    himc_performance_config config = himc_performance_default();
    himc_performance *performer = himc_performance_new(&config, &error);
    if (!performer) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    himc_performance_on_tick(performer, read_body, &seen);
    for (double t = 0; t < 2; t += 64 / config.sample_rate) {
        himc_vec3 place = {0.50, -0.10 + 0.05 * cos(6 * t), 1.05 + 0.05 * sin(6 * t)};
        himc_performance_target(performer, HIMC_RIGHT, place);
        himc_performance_process(performer, 64, NULL);
    }
    printf("tip within %.4f mm of its target, elbow down to %.3f m\n", 1e3 * seen.farthest,
           seen.lowest);
    himc_performance_free(performer);
    return 0;
}
