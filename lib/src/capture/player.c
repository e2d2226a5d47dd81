/// player.c: measures, and where the player is.
///
/// Lengths are medians over the frames of the distance of two joint centres, so that gaps and a
/// few bad frames do not count. Arms and legs are measured side by side; what only one side shows
/// holds for the other, since players are nearly symmetric and a capture of one hand is common.
/// Height: de Leva's man of 1.741 m has legs and trunk of known lengths; the player is as much
/// taller as those the take shows are longer together (else the arms). Mass: what the file says,
/// else the body mass index of the given body.
#include "himc/mocap.h"

#include "capture/player_check.h"
#include "capture/player_pose.h"
#include "capture/take_data.h"
#include "body/posture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REFERENCE_HEIGHT 1.741 // de Leva 1996 (m)
#define WALK 0.15              // of the hips, RMS (m)

static void measure_limb(const player_points *p, const player_measure *m, himc_player *player)
{
    double length[HIMC_HANDS];
    himc_skeleton_config *c = &player->config;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        length[hand] = himc_player_plausible(
            himc_player_distance(p, (int)m->from + hand, (int)m->to + hand, 0.5), m->usual);
        player->lengths += length[hand] > 0;
    }
    double both =
        length[0] > 0 && length[1] > 0 ? 0.5 * (length[0] + length[1]) : fmax(length[0], length[1]);
    if (both > 0 && m->segment == HIMC_LEFT_STICK) // both sticks are alike
        c->stick_length = fmin(fmax(c->grip + both + c->mallet_radius, 0.2), 0.6);
    for (int hand = 0; hand < HIMC_HANDS && both > 0 && m->segment != HIMC_LEFT_STICK; hand++)
        c->length[m->segment + hand] = length[hand] > 0 ? length[hand] : both;
}

static void measure_lengths(const player_points *p, himc_player *player)
{
    for (size_t i = 0; i < PLAYER_LIMBS; i++)
        measure_limb(p, &himc_player_limbs[i], player);
    for (size_t i = 0; i < PLAYER_SPINE; i++) {
        double l = himc_player_plausible(
            himc_player_distance(p, himc_player_spine[i].from, himc_player_spine[i].to, 0.5),
            himc_player_spine[i].usual);
        player->lengths += l > 0;
        if (l > 0)
            player->config.length[himc_player_spine[i].segment] = l;
    }
    double breadth = himc_player_distance(p, POINT_SHOULDER, POINT_SHOULDER + 1, 0.5);
    player->config.shoulders = breadth >= 0.2 ? himc_player_plausible(breadth, 0.37) : 0;
}

// how much longer than the reference the named parts are together; 0 if none is known
static double ratio_of(const himc_player *player, const player_measure *parts, size_t count)
{
    double sum = 0, usual = 0;
    for (size_t i = 0; i < count; i++) {
        double l = player->config.length[parts[i].segment];
        if (l <= 0 || !parts[i].tells_size)
            continue;
        sum += l;
        usual += parts[i].usual;
    }
    return usual > 0 ? sum / usual : 0;
}

static bool find_height(const player_points *p, himc_player *player, himc_error *error)
{
    himc_skeleton_config *c = &player->config;
    player_measure parts[4] = {himc_player_limbs[4], himc_player_limbs[5], himc_player_spine[0],
                               himc_player_spine[1]};
    double legs = ratio_of(player, parts, 2), torso = ratio_of(player, parts + 2, 2);
    double arms = ratio_of(player, himc_player_limbs, 2), all = ratio_of(player, parts, 4);
    const char *from = legs > 0 && torso > 0 ? "legs and trunk"
                       : legs > 0            ? "legs"
                       : torso > 0           ? "trunk"
                                             : "arms";
    double ratio = all > 0 ? all : arms;
    double given = c->mass / (c->height * c->height);
    if (p->take->height > 0) {
        c->height = p->take->height;
        from = "the file";
    } else if (ratio > 0) {
        c->height = ratio * REFERENCE_HEIGHT;
    } else {
        from = "";
    }
    snprintf(player->height_from, sizeof player->height_from, "%s", from);
    if (from[0] && !himc_check_range("height", c->height, 1.19, 2.21, "m", error))
        return himc_error_prefix(error, "%s: player", p->take->file);
    player->mass_said = p->take->mass > 0;
    c->mass = player->mass_said ? p->take->mass : given * c->height * c->height;
    return himc_check_range("mass", c->mass, 30, 200, "kg", error) ||
           himc_error_prefix(error, "%s: player", p->take->file);
}

static himc_vec3 mean_place(const player_points *p, int which)
{
    himc_vec3 sum = {0, 0, 0};
    for (int i = 0; i < p->frames; i++)
        sum = himc_vec3_madd(sum, 1.0 / p->frames, p->x[which][i]);
    return sum;
}

// the centre between the hip joints, when both are there: the point called hips may lie elsewhere
static bool center_hips(player_points *p)
{
    himc_vec3 *left = p->x[POINT_HIP], *right = p->x[POINT_HIP + 1];
    if (!left || !right)
        return true;
    if (!p->x[POINT_HIPS])
        p->x[POINT_HIPS] = malloc((size_t)p->frames * sizeof(himc_vec3));
    if (!p->x[POINT_HIPS])
        return false;
    for (int i = 0; i < p->frames; i++)
        p->x[POINT_HIPS][i] = himc_vec3_scale(himc_vec3_add(left[i], right[i]), 0.5);
    return true;
}

// a held pelvis stands for one that sways a little, not for one that goes somewhere
static bool find_walk(const player_points *p, himc_vec3 mean, himc_player *player)
{
    double square = 0;
    for (int i = 0; i < p->frames; i++) {
        himc_vec3 d = himc_vec3_sub(p->x[POINT_HIPS][i], mean);
        square += himc_vec3_dot(d, d) / p->frames;
    }
    player->walks = sqrt(square) > WALK;
    if (!player->walks)
        return true;
    himc_player_note(player,
                     "the player walks: the hips move by %.2f m RMS, here they are held and all "
                     "moves about them",
                     sqrt(square));
    player->walk = malloc((size_t)p->frames * sizeof *player->walk);
    for (int i = 0; player->walk && i < p->frames; i++)
        player->walk[i] = himc_vec3_sub(p->x[POINT_HIPS][i], mean);
    return player->walk != NULL;
}

// where the player is, by the hips, else by the shoulders of a body that sits as usual; false
// without memory
static bool find_place(const player_points *p, const himc_skeleton *s, himc_player *player)
{
    himc_vec3 up = s->segment[HIMC_TRUNK].origin, sum = {0, 0, 0};
    int shown = 0;
    if (p->x[POINT_HIPS]) {
        bool waist = p->x[POINT_WAIST] && player->config.length[HIMC_PELVIS] > 0;
        player->hips =
            waist ? himc_vec3_sub(mean_place(p, POINT_WAIST), up) : mean_place(p, POINT_HIPS);
        player->placed = true;
        return find_walk(p, mean_place(p, POINT_HIPS), player);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        if (!p->x[POINT_SHOULDER + hand])
            continue;
        himc_vec3 model = himc_quat_rotate(player->mean.joint[HIMC_TRUNK - 1],
                                           s->segment[HIMC_LEFT_UPPER_ARM + hand].origin);
        sum = himc_vec3_add(
            sum, himc_vec3_sub(mean_place(p, POINT_SHOULDER + hand), himc_vec3_add(up, model)));
        shown++;
    }
    player->placed = shown > 0;
    if (shown)
        player->hips = himc_vec3_scale(sum, 1.0 / shown);
    return true;
}

// the posture of a body nothing is known of
static himc_pose natural(const himc_skeleton *skeleton)
{
    himc_posture posture;
    himc_posture_init(&posture, skeleton, 0.85);
    himc_pose pose = posture.rest;
    pose.joint[HIMC_TRUNK - 1] =
        himc_quat_exp(himc_vec3_make(0, posture.trunk_posture.value[HIMC_TRUNK_POSTURE_LEAN], 0));
    return pose;
}

static bool read_player(himc_player *player, player_points *p, himc_error *error)
{
    himc_skeleton skeleton;
    if (!center_hips(p))
        return himc_error_set(error, "%s: no memory", p->take->file);
    if (!himc_player_check(p, player, error))
        return false;
    measure_lengths(p, player);
    if (!find_height(p, player, error) || !himc_skeleton_init(&skeleton, &player->config, error))
        return false;
    player->mean = natural(&skeleton);
    bool found = find_place(p, &skeleton, player);
    himc_vec3 waist = himc_vec3_add(player->hips, skeleton.segment[HIMC_TRUNK].origin);
    if (!found || !himc_player_read_poses(player, p, &skeleton, p->x[POINT_HIPS] ? &waist : NULL))
        return himc_error_set(error, "%s: no memory for %d postures", p->take->file, p->frames);
    return true;
}

himc_player *himc_player_new(himc_take *take, const himc_take_options *options,
                             const himc_skeleton_config *given, himc_error *error)
{
    himc_take_options usual = himc_take_default();
    player_points points = {.frames = 0};
    himc_player *player = calloc(1, sizeof *player);
    if (!player || !himc_player_points_find(&points, take, options ? options : &usual, player)) {
        himc_player_points_free(&points);
        himc_player_free(player);
        himc_error_set(error, "%s: no memory", take->file);
        return NULL;
    }
    player->config = *given;
    player->config.seat = player->config.shoulders = 0;
    memset(player->config.length, 0, sizeof player->config.length);
    player->frames = himc_take_frames(take);
    bool ok = read_player(player, &points, error);
    himc_player_points_free(&points);
    if (ok)
        return player;
    himc_player_free(player);
    return NULL;
}

void himc_player_free(himc_player *player)
{
    if (!player)
        return;
    free(player->pose);
    free(player->walk);
    free(player);
}
