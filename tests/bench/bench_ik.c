/// bench_ik.c: the processor time of one step of inverse kinematics for each solver.
#define _POSIX_C_SOURCE 200809L
#include "body/posture.h"

#include "../bodies.h"

#include <stdio.h>
#include <time.h>

#define STEPS 200000

// the natural posture of a player at rest over the drumhead
static himc_pose rest_pose(void)
{
    himc_posture posture;
    himc_pose pose;
    const himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.10, 1.0}, {0.48, -0.10, 1.0}};
    himc_posture_init(&posture, &skeleton, 0.8675);
    himc_posture_at(&posture, tip, &pose);
    return pose;
}

static double cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void bench_solver(const char *name, himc_solver solver)
{
    himc_body_state s;
    himc_pose rest = rest_pose();
    himc_pose_to_state(&skeleton, &rest, NULL, &s);
    double sum = 0, start = cpu_seconds();
    for (int i = 0; i < STEPS; i++) {
        himc_arm_jacobian j;
        himc_vec3 rotation[HIMC_ARM_JOINTS], error = {1e-3, 2e-3, -1e-6 * i};
        himc_arm_jacobian_at(&s, HIMC_RIGHT, &j);
        himc_ik_solve(&j, solver, 0.01, error, rotation);
        sum += rotation[0].x;
    }
    printf("%-34s %6.3f us%s\n", name, 1e6 * (cpu_seconds() - start) / STEPS,
           isfinite(sum) ? "" : " (not finite)");
}

int main(void)
{
    static const char *const solver[HIMC_SOLVERS] = {"dls", "pinv", "transpose", "nakamura",
                                                     "sdls"};
    default_skeleton(1);
    for (int i = 0; i < HIMC_SOLVERS; i++)
        bench_solver(solver[i], (himc_solver)i);
    return 0;
}
