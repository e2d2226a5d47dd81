/// body.c: which pairs of points are the ends of which segment, and how far they lie apart.
///
/// A skeleton file says lengths outright (a joint's offset from its parent); of markers the
/// median over all frames is taken, so that gaps and a few bad frames do not count. Arms are
/// measured one by one; what only one side shows holds for the other, since players are nearly
/// symmetric and a capture of one hand is common.
#include "himc/body.h"

#include <stdio.h>
#include <stdlib.h>

#define NAMES 4

typedef struct pair {
    int segment;             // of the left side
    const char *from[NAMES]; // joint at the body's side, without left or right
    const char *to[NAMES];   // joint at the far side
    double usual;            // (m)
} pair;

static const pair pairs[] = {
    {HIMC_LEFT_UPPER_ARM, {"Shoulder", "Arm", "UpperArm"}, {"Elbow", "ForeArm", "LowerArm"}, 0.28},
    {HIMC_LEFT_FOREARM, {"Elbow", "ForeArm", "LowerArm"}, {"Wrist", "Hand"}, 0.27},
    {HIMC_LEFT_HAND, {"Wrist", "Hand"}, {"Finger", "Grip", "Knuckle"}, 0.12},
    {HIMC_LEFT_STICK, {"Finger", "Grip", "Knuckle"}, {"Tip", "Bead", "StickTip"}, 0.24},
    {HIMC_LEFT_UPPER_LEG, {"Hip", "UpLeg", "Thigh"}, {"Knee", "Leg", "Shin"}, 0.42},
    {HIMC_LEFT_LOWER_LEG, {"Knee", "Leg", "Shin"}, {"Ankle", "Foot"}, 0.43},
};

// "LeftElbow", "LElbow", or "Elbow" for a take that names no sides
static int find_joint(const himc_take *take, const char *const names[NAMES],
                      const char *const sides[3])
{
    char name[64];
    for (int s = 0; s < 3; s++)
        for (int i = 0; i < NAMES && names[i]; i++) {
            snprintf(name, sizeof name, "%s%s", sides[s], names[i]);
            int point = himc_take_find(take, name);
            if (point >= 0)
                return point;
        }
    return -1;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// median distance over the frames that show both; 0 if none does
static double median_distance(const himc_take *take, int from, int to)
{
    int frames = himc_take_frames(take), count = 0;
    double *distance = malloc((size_t)frames * sizeof *distance), median = 0;
    for (int i = 0; distance && i < frames; i++) {
        himc_vec3 d = himc_vec3_sub(himc_take_point(take, i, to), himc_take_point(take, i, from));
        if (himc_vec3_finite(d))
            distance[count++] = himc_vec3_length(d);
    }
    if (count > 0) {
        qsort(distance, (size_t)count, sizeof *distance, by_size);
        median = distance[count / 2];
    }
    free(distance);
    return median;
}

static double segment_length(const himc_take *take, const pair *p, int hand)
{
    static const char *const sides[HIMC_HANDS][3] = {{"Left", "L", ""}, {"Right", "R", ""}};
    int to = find_joint(take, p->to, sides[hand]);
    if (to < 0)
        return 0;
    if (himc_take_has_skeleton(take) && himc_take_parent(take, to) >= 0)
        return himc_vec3_length(himc_take_offset(take, to));
    int from = find_joint(take, p->from, sides[hand]);
    return from < 0 || from == to ? 0 : median_distance(take, from, to);
}

int himc_body_measure(const himc_take *take, himc_skeleton_config *config)
{
    int found = 0;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        double length[HIMC_HANDS];
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            length[hand] = segment_length(take, &pairs[i], hand);
            if (length[hand] < 0.5 * pairs[i].usual || length[hand] > 1.6 * pairs[i].usual)
                length[hand] = 0;
            found += length[hand] > 0;
        }
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            double l = length[hand] > 0 ? length[hand] : length[1 - hand];
            if (l > 0 && pairs[i].segment == HIMC_LEFT_STICK)
                config->stick_length =
                    config->grip + l + config->mallet_radius; // both sticks are alike
            else if (l > 0)
                config->length[pairs[i].segment + hand] = l;
        }
    }
    return found;
}
