/* take.c: a motion capture, read and not played: the highest place of each point (forward, left and up, m;
nan if it was never seen), and the strikes of both stick tips.

    cc take.c $(pkg-config --cflags --libs himc) -o take && ./take capture.c3d */
#include <himc/mocap.h>

#include <stdio.h>
#include <stdlib.h>

/* Where the point is highest; gaps are NaN. */
static himc_vec3 highest(const himc_take *take, int point)
{
    himc_vec3 top = himc_take_point(take, 0, point);
    for (int frame = 1; frame < himc_take_frames(take); frame++) {
        himc_vec3 p = himc_take_point(take, frame, point);
        if (p.z > top.z || !himc_vec3_finite(top))
            top = p;
    }
    return top;
}

static void list_points(const himc_take *take)
{
    for (int i = 0; i < himc_take_points(take); i++) {
        himc_vec3 top = highest(take, i);
        printf("%s: %.3f %.3f %.3f m\n", himc_take_point_name(take, i), top.x, top.y, top.z);
    }
}

/* False if the take has no stick tips. */
static bool list_strikes(himc_take *take, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    int count;
    if (!himc_take_tips(take, NULL, tips, error))
        return false;
    himc_take_strike *strike = himc_take_find_strikes(take, tips, &count);
    for (int i = 0; i < count; i++)
        printf("%.3f s %s %.2f m/s at %.3f %.3f %.3f m\n", strike[i].time,
               himc_hand_name(strike[i].hand), strike[i].velocity, strike[i].x.x, strike[i].x.y,
               strike[i].x.z);
    free(strike);
    return true;
}

int main(int argc, char **argv)
{
    himc_error error = {""};
    if (argc != 2) {
        fprintf(stderr, "usage: take FILE.bvh|.c3d|.trc\n");
        return 1;
    }
    himc_take *take = himc_take_load(argv[1], NULL, &error);
    if (take)
        list_points(take);
    bool good = take && list_strikes(take, &error);
    if (!good)
        fprintf(stderr, "%s\n", error.text);
    himc_take_free(take);
    return !good;
}
