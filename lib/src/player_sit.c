/// player_sit.c: player, drum and take are brought together. The origin of our world is under the
/// player, so a take whose player is seen is moved there, the seat raised until the strikes meet
/// the head; only strikes that would miss the head move the drum. A take of tips alone is moved so
/// that its strikes fall on the drum's usual spot: the player then sits where a player of that drum
/// does.
#include "player_sit.h"

#include "himc/player.h"

#include <stdlib.h>

#define LOWEST_SEAT 0.3  // (m)
#define HIGHEST_SEAT 1.3 // (m)
#define ON_HEAD 0.97     // of the radius: strikes further out would miss
#define DENT 0.012       // a head gives way by so much: a take this near our floor stands on it (m)
#define OVER_HEAD 0.05   // where nothing is struck, the lowest place is so high above the head (m)

// the middle of the take's strikes; false without any
static bool strike_place(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                         himc_vec3 *place)
{
    int count = himc_take_strikes(take, tips, NULL, 0);
    himc_take_strike *strikes = calloc((size_t)count + 1, sizeof *strikes);
    bool found = strikes && himc_take_strikes(take, tips, strikes, count) > 0 &&
                 himc_take_strike_place(strikes, count, place);
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

static void usual_spot(const himc_place *drum, double *x, double *aside)
{
    himc_stroke usual = {.hand = HIMC_RIGHT, .spot = HIMC_SPOT_NORMAL};
    himc_stroke_spot(&usual, drum->radius, x, aside);
    *aside = fabs(*aside);
}

himc_vec3 himc_strike_offset(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                             const himc_place *drum, double mallet_radius)
{
    double x, aside;
    himc_vec3 struck;
    usual_spot(drum, &x, &aside);
    himc_vec3 spot =
        himc_vec3_madd(himc_place_to_world(drum, x, 0), mallet_radius, himc_place_normal(drum));
    if (!strike_place(take, tips, &struck)) {
        struck = lowest_place(take, tips);
        spot.z += OVER_HEAD;
    }
    if (!tips[HIMC_LEFT].present || !tips[HIMC_RIGHT].present)
        spot.y += tips[HIMC_LEFT].present ? aside : -aside;
    return himc_vec3_sub(spot, struck);
}

// beyond the spot, on the line from the player through it
static void move_drum_under(himc_place *drum, himc_vec3 spot)
{
    double x, aside, far = hypot(spot.x, spot.y);
    usual_spot(drum, &x, &aside);
    himc_vec3 away =
        far > 0.1 ? himc_vec3_make(spot.x / far, spot.y / far, 0) : himc_vec3_make(1, 0, 0);
    drum->center.x = spot.x - x * away.x;
    drum->center.y = spot.y - x * away.y;
}

// on the head as seen from above: x, y of the drum, and z 0
static himc_vec3 seen_on_head(const himc_place *drum, himc_vec3 spot)
{
    himc_place level = *drum;
    level.tilt = 0;
    spot.z = drum->center.z;
    return himc_place_from_world(&level, spot);
}

static void seat_player(himc_player *player, himc_vec3 struck, himc_place *drum)
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

bool himc_player_sit(himc_player *player, himc_take *take, const himc_take_options *options,
                     himc_place *drum)
{
    himc_vec3 struck;
    himc_take_tip tips[HIMC_HANDS];
    if (!himc_take_tips(take, options, tips, NULL) || !strike_place(take, tips, &struck))
        return false;
    if (player->placed) {
        seat_player(player, struck, drum);
    } else {
        himc_vec3 root = {0, 0, himc_skeleton_seat(&player->config)};
        player->offset = himc_strike_offset(take, tips, drum, player->config.mallet_radius);
        player->hips = himc_vec3_sub(root, player->offset);
    }
    player->seated = true;
    return true;
}
