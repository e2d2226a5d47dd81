/// player_check.c: what joint centres of one body must do, whatever the file calls them.
///
/// Bones keep their length: two centres whose distance varies by more than VARIES of a usual bone's
/// length between its 10 % and 90 % quantiles are not the ends of one, as when names are permuted;
/// the farther one is dropped. Bones are of human size: if most are not, the file's unit is not
/// what it says. A player's left shoulder is on the side of the left hip.
#include "capture/player_check.h"

#include "capture/take_data.h"

#include <stdlib.h>

#define LEAST 0.5 // of the reference: shorter and longer segments are not believed
#define MOST 1.6
#define VARIES 0.25 // of a bone's length

const player_measure himc_player_limbs[PLAYER_LIMBS] = {
    {HIMC_LEFT_UPPER_ARM, POINT_SHOULDER, POINT_ELBOW, 0.2817, true},
    {HIMC_LEFT_FOREARM, POINT_ELBOW, POINT_WRIST, 0.2689, true},
    {HIMC_LEFT_HAND, POINT_WRIST, POINT_GRIP, 0.12, false},
    {HIMC_LEFT_STICK, POINT_GRIP, POINT_TIP, 0.24, false},
    {HIMC_LEFT_UPPER_LEG, POINT_HIP, POINT_KNEE, 0.4222, true},
    {HIMC_LEFT_LOWER_LEG, POINT_KNEE, POINT_ANKLE, 0.434, true},
};
const player_measure himc_player_spine[PLAYER_SPINE] = {
    {HIMC_PELVIS, POINT_HIPS, POINT_WAIST, 0.1457, true},
    {HIMC_TRUNK, POINT_WAIST, POINT_NECK, 0.3862, true},
    {HIMC_NECK, POINT_NECK, POINT_HEAD, 0.0696, false},
};

double himc_player_plausible(double length, double usual)
{
    return length >= LEAST * usual && length <= MOST * usual ? length : 0;
}

static void drop_loose_end(player_points *p, const player_measure *m, int hand, himc_player *player)
{
    int from = (int)m->from + hand, to = (int)m->to + hand;
    double low = himc_player_distance(p, from, to, 0.1),
           high = himc_player_distance(p, from, to, 0.9);
    if (high - low <= VARIES * m->usual)
        return;
    himc_player_note(player,
                     "%s: from %.3f to %.3f m long, which no bone is: are the points' names right?",
                     himc_segment_name(m->segment + hand), low, high);
    free(p->x[to]);
    p->x[to] = NULL;
}

// most of the limbs of no human size: a file in a unit nobody has told of
static bool check_size(const player_points *p, himc_error *error)
{
    int good = 0, bad = 0;
    const player_measure *first = NULL;
    int side = 0;
    double length = 0;
    for (int i = 0; i < PLAYER_LIMBS; i++)
        for (int hand = 0; hand < HIMC_HANDS && himc_player_limbs[i].tells_size; hand++) {
            const player_measure *m = &himc_player_limbs[i];
            double l = himc_player_distance(p, (int)m->from + hand, (int)m->to + hand, 0.5);
            bool fits = himc_player_plausible(l, m->usual) > 0;
            good += fits;
            bad += l > 0 && !fits;
            if (l > 0 && !fits && !first) {
                first = m;
                side = hand;
                length = l;
            }
        }
    if (bad <= good)
        return true;
    return himc_error_set(error,
                          "%s: player: %s of %.3g m, allowed %.2f .. %.2f m: is the unit right?",
                          p->take->file, himc_segment_name(first->segment + side), length,
                          LEAST * first->usual, MOST * first->usual);
}

static bool check_sides(const player_points *p, himc_error *error)
{
    himc_vec3 *const *x = p->x;
    double same = 0;
    if (!x[POINT_SHOULDER] || !x[POINT_SHOULDER + 1] || !x[POINT_HIP] || !x[POINT_HIP + 1])
        return true;
    for (int i = 0; i < p->frames; i++)
        same += himc_vec3_dot(himc_vec3_sub(x[POINT_SHOULDER][i], x[POINT_SHOULDER + 1][i]),
                              himc_vec3_sub(x[POINT_HIP][i], x[POINT_HIP + 1][i]));
    return same >= 0 ||
           himc_error_set(error,
                          "%s: player: the left shoulder is over the right hip, allowed "
                          "over the left one: are left and right exchanged?",
                          p->take->file);
}

bool himc_player_check(player_points *p, himc_player *player, himc_error *error)
{
    if (!check_size(p, error) || !check_sides(p, error))
        return false;
    for (int i = 0; i < PLAYER_LIMBS; i++)
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            drop_loose_end(p, &himc_player_limbs[i], hand, player);
    return true;
}
