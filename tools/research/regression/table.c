/// table.c: writes lib/src/control/posture_regression_table.c from the motion database in a few
/// seconds (`make regression-table`); not a part of himc.
///
/// All 45 sequences of mocap/ (seed 1), each relative to its own means. So the weights contain the
/// motion of the arms with the sticks and not the positions of different players.
#include "mocap/mocap.h"

#include "control/posture_regression.h"

#include <stdio.h>
#include <stdlib.h>

#define SPOTS 3
#define TAKES (HIMC_MOCAP_PLAYERS * HIMC_NUANCES * SPOTS)

static bool make_take(int index, himc_posture_regression_take *take, himc_error *error)
{
    himc_mocap_config config = himc_mocap_default();
    config.player = index / (HIMC_NUANCES * SPOTS);
    config.nuance = (himc_nuance)(index / SPOTS % HIMC_NUANCES);
    config.spot = (himc_spot)(index % SPOTS);
    himc_mocap *mocap = himc_mocap_new(&config, error); // not freed: the take borrows its skeleton
    if (!mocap)
        return false;
    int frames = himc_mocap_frames(mocap);
    himc_pose *pose = malloc((size_t)frames * sizeof *pose);
    for (int i = 0; pose && i < frames; i++)
        pose[i] = himc_mocap_pose(mocap, i / HIMC_MOCAP_RATE);
    *take = (himc_posture_regression_take){.skeleton = himc_mocap_skeleton(mocap),
                                           .pose = pose,
                                           .frames = frames,
                                           .rate = HIMC_MOCAP_RATE};
    return pose || himc_error_set(error, "out of memory");
}

static void put_numbers(const char *name, const double *number, int count)
{
    printf("    .%s = {", name);
    for (int i = 0; i < count; i++)
        printf("%s%.4g,", i % 10 ? " " : "\n        ", number[i]);
    puts("\n    },");
}

static void put_all(const himc_posture_regression *regression)
{
    puts("/// posture_regression_table.c: the default posture regression "
         "(`make regression-table`).\n"
         "///\n"
         "/// Learned from three players, five nuances and three spots, each sequence relative to "
         "its\n"
         "/// own means. Invariant: the arrays have the shapes of himc_posture_regression.\n"
         "#include \"control/posture_regression.h\"\n\n"
         "// clang-format off\n"
         "const himc_posture_regression_numbers himc_posture_regression_table = {");
    put_numbers("weight", &regression->weight[0][0][0][0],
                HIMC_HANDS * HIMC_ARM_JOINTS * 3 * HIMC_REGRESSION_TERMS);
    put_numbers("trunk", &regression->trunk[0][0], 3 * HIMC_REGRESSION_TRUNK_TERMS);
    put_numbers("residual_covariance", &regression->residual_covariance[0][0][0],
                HIMC_HANDS * HIMC_REGRESSION_ANGLES * HIMC_REGRESSION_ANGLES);
    puts("};");
}

int main(void)
{
    static himc_posture_regression_take take[TAKES];
    himc_error error = {""};
    himc_posture_regression regression;
    bool good = true;
    for (int i = 0; good && i < TAKES; i++)
        good = make_take(i, &take[i], &error);
    good = good && himc_posture_regression_learn(&regression, take, TAKES, &error);
    if (good)
        put_all(&regression);
    else
        fprintf(stderr, "%s\n", error.text);
    return !good;
}
