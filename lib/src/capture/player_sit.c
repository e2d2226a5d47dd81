/// player_sit.c: player, drum and take are brought together. The origin of our world is under the
/// player, so a take whose player is seen is moved there, the seat raised until the strikes meet
/// the head; only strikes that would miss the head move the drum. A take of tips alone is moved so
/// that its strikes fall on the drum's usual spot: the player then sits where a player of that drum
/// does.
///
/// A take that strikes nothing keeps the player's height above the floor, or, of tips alone, is
/// moved until the player reaches all of it; the drum goes down out of its way. A player who walks
/// is held by the hips, which do not move here, and the take with them.
#include "capture/player_sit.h"

#include "himc/mocap.h"

#include "capture/take_data.h"
#include "base/head_frame.h"
#include "body/posture.h"

#include <stdlib.h>

#define LOWEST_SEAT 0.3  // (m)
#define HIGHEST_SEAT 1.3 // (m)
#define ON_HEAD 0.97     // of the radius: strikes further out would miss
#define DENT 0.012       // a head gives way by so much: a take this near our floor stands on it (m)
#define OVER_HEAD 0.05   // where nothing is struck, the lowest place is so high above the head (m)
#define LOWEST_HEAD 0.1  // (m)
#define BESIDE_HEAD 0.05 // what passes so near beside a head is over it (m)
#define SHIFTS 50        // of a take, each as far as the worst of it is out of reach ...
#define LOOKED_AT 1000   // ... of so many of its frames

// the middle of the take's strikes; false without any
static bool strike_place(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                         himc_vec3 *place)
{
    int count;
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &count);
    bool found = count > 0 && himc_take_strike_place(strikes, count, place);
    free(strikes);
    return found;
}

static himc_vec3 lowest_place(const himc_take *take, const himc_take_tip tips[HIMC_HANDS])
{
    const himc_vec3 *x = tips[HIMC_RIGHT].present ? tips[HIMC_RIGHT].x : tips[HIMC_LEFT].x;
    int lowest = 0;
    for (int i = 1; i < himc_take_frames(take); i++)
        if (x[i].z < x[lowest].z)
            lowest = i;
    return x[lowest];
}

static void usual_spot(const himc_head_frame *drum, double *x, double *aside)
{
    himc_stroke usual = {.hand = HIMC_RIGHT, .spot = HIMC_SPOT_NORMAL};
    himc_stroke_spot(&usual, drum->radius, x, aside);
    *aside = fabs(*aside);
}

himc_vec3 himc_strike_offset(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                             const himc_head_frame *drum, double mallet_radius)
{
    double x, aside;
    himc_vec3 struck;
    usual_spot(drum, &x, &aside);
    himc_vec3 spot = himc_vec3_madd(himc_head_frame_to_world(drum, x, 0), mallet_radius,
                                    himc_head_frame_normal(drum));
    if (!strike_place(take, tips, &struck)) {
        struck = lowest_place(take, tips);
        spot.z += OVER_HEAD;
    }
    if (!tips[HIMC_LEFT].present || !tips[HIMC_RIGHT].present)
        spot.y += tips[HIMC_LEFT].present ? aside : -aside;
    return himc_vec3_sub(spot, struck);
}

// beyond the spot, on the line from the player through it
static void move_drum_under(himc_head_frame *drum, himc_vec3 spot)
{
    double x, aside, far = hypot(spot.x, spot.y);
    usual_spot(drum, &x, &aside);
    himc_vec3 away =
        far > 0.1 ? himc_vec3_make(spot.x / far, spot.y / far, 0) : himc_vec3_make(1, 0, 0);
    drum->center.x = spot.x - x * away.x;
    drum->center.y = spot.y - x * away.y;
}

// on the head as seen from above: x, y of the drum, and z 0
static himc_vec3 seen_on_head(const himc_head_frame *drum, himc_vec3 spot)
{
    himc_head_frame level = *drum;
    level.tilt = 0;
    spot.z = drum->center.z;
    return himc_head_frame_from_world(&level, spot);
}

static void seat_player(himc_player *player, himc_vec3 struck, himc_head_frame *drum)
{
    himc_vec3 spot = himc_vec3_sub(struck, player->hips), local = seen_on_head(drum, spot);
    if (hypot(local.x, local.y) > ON_HEAD * drum->radius) {
        move_drum_under(drum, spot);
        local = seen_on_head(drum, spot);
    }
    double head =
        drum->center.z + local.x * tan(drum->tilt) + player->config.mallet_radius / cos(drum->tilt);
    double seat = head - spot.z, kept = fmin(fmax(seat, LOWEST_SEAT), HIGHEST_SEAT);
    if (fabs(kept - player->hips.z) < DENT)
        kept = seat = player->hips.z;
    drum->center.z += kept - seat;
    player->config.seat = kept;
    player->offset = himc_vec3_make(-player->hips.x, -player->hips.y, kept - player->hips.z);
}

// one who strikes nothing is as high above the floor as in the take
static void keep_player(himc_player *player)
{
    double seat = fmin(fmax(player->hips.z, LOWEST_SEAT), HIGHEST_SEAT);
    player->config.seat = seat;
    player->offset = himc_vec3_make(-player->hips.x, -player->hips.y, seat - player->hips.z);
}

// how the farthest place of the tips, moved by `offset`, must be moved to come into reach
static himc_vec3 back_into_reach(const himc_posture *posture, const himc_take *take,
                                 const himc_take_tip tips[HIMC_HANDS], himc_vec3 offset)
{
    himc_vec3 back = {0, 0, 0};
    int frames = himc_take_frames(take), step = frames / LOOKED_AT + 1;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; tips[hand].present && i < frames; i += step) {
            himc_vec3 x = himc_vec3_add(tips[hand].x[i], offset);
            himc_vec3 near = himc_posture_reachable(posture, (himc_hand)hand, x);
            himc_vec3 way = himc_vec3_sub(near, x);
            if (himc_vec3_length(way) > himc_vec3_length(back))
                back = way;
        }
    return back;
}

// if all of it can be reached from one place, that is found; else one from which little is missing
static bool bring_into_reach(himc_player *player, const himc_take *take,
                             const himc_take_tip tips[HIMC_HANDS], const himc_head_frame *drum)
{
    himc_skeleton skeleton;
    himc_posture posture;
    himc_vec3 best = player->offset;
    double least = INFINITY;
    if (!himc_skeleton_init(&skeleton, &player->config, NULL))
        return false;
    himc_posture_init(&posture, &skeleton, drum->center.z + player->config.mallet_radius);
    for (int i = 0; i < SHIFTS && least > 1e-3; i++) {
        himc_vec3 back = back_into_reach(&posture, take, tips, player->offset);
        if (himc_vec3_length(back) < least) {
            least = himc_vec3_length(back);
            best = player->offset;
        }
        player->offset = himc_vec3_add(player->offset, himc_vec3_scale(back, 1.01));
    }
    player->offset = best;
    return true;
}

// a head under a take that strikes nothing is lowered until it is not struck
static void clear_drum(himc_head_frame *drum, const himc_take *take,
                       const himc_take_tip tips[HIMC_HANDS], himc_vec3 offset)
{
    double under = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; tips[hand].present && i < himc_take_frames(take); i++) {
            himc_vec3 x = himc_head_frame_from_world(drum, himc_vec3_add(tips[hand].x[i], offset));
            if (hypot(x.x, x.y) < drum->radius + BESIDE_HEAD)
                under = fmax(under, OVER_HEAD - x.z);
        }
    drum->center.z = fmax(drum->center.z - under / cos(drum->tilt), LOWEST_HEAD);
}

// takes the hips' way over the floor out of everything
static void hold_hips(himc_player *player, himc_take *take)
{
    for (int i = 0; player->walk && i < take->frames; i++)
        for (int k = 0; k < take->points; k++) {
            himc_vec3 *x = himc_take_at(take, i, k);
            x->x -= player->walk[i].x;
            x->y -= player->walk[i].y;
        }
    free(player->walk);
    player->walk = NULL;
}

bool himc_player_sit(himc_player *player, himc_take *take, const himc_take_options *options,
                     himc_head_frame *drum)
{
    himc_vec3 struck;
    himc_take_tip tips[HIMC_HANDS];
    hold_hips(player, take);
    if (!himc_take_tips(take, options, tips, NULL))
        return false;
    bool strikes = strike_place(take, tips, &struck);
    if (player->placed && strikes)
        seat_player(player, struck, drum);
    else if (player->placed)
        keep_player(player);
    else
        player->offset = himc_strike_offset(take, tips, drum, player->config.mallet_radius);
    if (!player->placed && !strikes && !bring_into_reach(player, take, tips, drum))
        return false;
    if (!strikes)
        clear_drum(drum, take, tips, player->offset);
    if (!player->placed) {
        himc_vec3 root = {0, 0, himc_skeleton_seat(&player->config)};
        player->hips = himc_vec3_sub(root, player->offset);
    }
    player->seated = true;
    return true;
}
