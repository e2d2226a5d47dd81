/// bench_ik.c: what inverse kinematics costs: a solver's step, and a posture from tips at a
/// distance, both arms and trunk, from rest with limits on (TRAC-IK's yardstick, Beeson & Ames
/// 2015: 99.6 to 99.99 % in about 0.5 ms).
#define _POSIX_C_SOURCE 200809L
#include "himc/ik.h"
#include "himc/reach.h"

#include "../ranges.h"

#include <stdio.h>
#include <time.h>

#define STEPS 200000
#define GOALS 10000

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

static void bench_reach(const char *name, const himc_limits *limits)
{
    himc_pose rest = rest_pose();
    int solved = 0, outside = 0;
    double seconds = 0, longest = 0;
    for (int n = 0; n < GOALS; n++) {
        himc_pose pose = rest;
        himc_reach_result result;
        himc_reach_goal goal = random_goal(limits, &rest);
        double start = cpu_seconds();
        himc_reach(&skeleton, limits, &goal, &pose, &result);
        double took = cpu_seconds() - start;
        seconds += took;
        longest = fmax(longest, took);
        solved += result.missing < 1e-5;
        for (int i = 0; i < REACH_JOINTS; i++)
            outside += himc_limit_measure(limits, reach_joint(i), pose.joint[reach_joint(i)]) > 1;
    }
    printf("%-34s %6.2f us, longest %.0f us, solved %.2f %%, outside limits %d\n", name,
           1e6 * seconds / GOALS, 1e6 * longest, 100.0 * solved / GOALS, outside);
}

int main(void)
{
    static const char *const solver[HIMC_SOLVERS] = {"dls", "pinv", "transpose", "nakamura",
                                                     "sdls"};
    default_skeleton(1);
    himc_pose rest = rest_pose();
    himc_limits table = himc_limits_table_1(&rest), ball = wide_ranges(HIMC_LIMITS_ELLIPSOID),
                box = wide_ranges(HIMC_LIMITS_EULER);
    for (int i = 0; i < HIMC_SOLVERS; i++)
        bench_solver(solver[i], (himc_solver)i);
    bench_reach("reach, table 1", &table);
    bench_reach("reach, anatomical ellipsoids", &ball);
    bench_reach("reach, anatomical boxes", &box);
    return 0;
}
