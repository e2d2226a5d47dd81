/// player.c: the player of a take: measures, place, and the seat before a drum.
///
/// Measures. Lengths are medians over the frames of the distance of two joint centres, so that gaps
/// and a few bad frames have no influence. Left and right are measured separately; if only one side
/// is shown, its length is used for both, since players are nearly symmetric and a capture of one
/// hand is common. Height: de Leva's man of 1.741 m has legs and trunk of known lengths; the
/// player's height has the same ratio to his as the sums of the lengths that the take shows (legs
/// and trunk, else arms). Mass: as the file states, else from the body mass index of the given
/// body.
///
/// Seat. The world's origin is under the player. A player shown by the take is moved there, and
/// the seat is raised until the strikes meet the head; the drum moves only if strikes would miss
/// the head. A take of tips alone is moved until its strikes fall on the drum's usual strike place;
/// the player then sits where a player of that drum does. Without strikes the player keeps the
/// height above the floor, or, with tips alone, the take is moved until the player reaches all of
/// it; the drum is lowered out of its way. If the player walks, the motion of the hips is taken out
/// of the whole take.
#include "capture/player.h"

#include "base/head_frame.h"
#include "body/posture.h"
#include "capture/take.h"

#include <stdlib.h>
#include <string.h>

static void measure_lengths(const player_points *p, himc_player *player)
{
    himc_skeleton_config *c = &player->config;
    for (const player_measure *m = himc_player_limbs; m < himc_player_limbs + PLAYER_LIMBS; m++) {
        double l[HIMC_HANDS];
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            l[hand] = himc_player_plausible(
                himc_player_distance(p, (int)m->from + hand, (int)m->to + hand, 0.5), m->usual);
            player->lengths += l[hand] > 0;
        }
        double both = l[0] > 0 && l[1] > 0 ? 0.5 * (l[0] + l[1]) : fmax(l[0], l[1]);
        if (both <= 0)
            continue;
        // both sticks are alike, within the range of himc_skeleton_config
        if (m->segment == HIMC_LEFT_STICK)
            c->stick_length = fmin(fmax(c->grip + both + c->mallet_radius, 0.2), 0.6);
        for (int hand = 0; hand < HIMC_HANDS && m->segment != HIMC_LEFT_STICK; hand++)
            c->length[m->segment + hand] = l[hand] > 0 ? l[hand] : both;
    }
    for (const player_measure *m = himc_player_spine; m < himc_player_spine + PLAYER_SPINE; m++) {
        double l = himc_player_plausible(himc_player_distance(p, m->from, m->to, 0.5), m->usual);
        player->lengths += l > 0;
        c->length[m->segment] = l;
    }
    // 0.37 m between the shoulder joints of de Leva's man, at least 0.2 m by himc_skeleton_config
    double breadth = himc_player_distance(p, POINT_SHOULDER, POINT_SHOULDER + 1, 0.5);
    c->shoulders = breadth >= 0.2 ? himc_player_plausible(breadth, 0.37) : 0;
    // a tip within a hand's length of the wrist is no stick's: the body's stick is put there
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double far = himc_player_distance(p, POINT_WRIST + hand, POINT_TIP + hand, 0.5);
        int node = p->node[POINT_TIP + hand];
        bool shown = p->x[POINT_WRIST + hand] && p->x[POINT_TIP + hand] && node >= 0;
        if (shown && far < 0.2) // chosen: a hand is shorter, a stick in it reaches farther
            himc_player_note(player,
                             "%s is %.2f m from the wrist: a hand, not the tip of a stick; the "
                             "arms are bent until a stick's tip is there",
                             himc_take_point_name(p->take, node), far);
    }
}

// ratio of the summed lengths of the parts to the reference; 0 if no length is known
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
        c->height = ratio * 1.741; // de Leva 1996
    } else {
        from = "";
    }
    snprintf(player->height_from, sizeof player->height_from, "%s", from);
    if (from[0] &&
        !himc_check_range("height", c->height, TAKE_LEAST_HEIGHT, TAKE_MOST_HEIGHT, "m", error))
        return himc_error_prefix(error, "%s: player", p->take->file);
    player->mass_stated = p->take->mass > 0;
    c->mass = player->mass_stated ? p->take->mass : given * c->height * c->height;
    return himc_check_range("mass", c->mass, TAKE_LEAST_MASS, TAKE_MOST_MASS, "kg", error) ||
           himc_error_prefix(error, "%s: player", p->take->file);
}

static himc_vec3 mean_position(const player_points *p, int which)
{
    himc_vec3 sum = {0, 0, 0};
    for (int i = 0; i < p->frames; i++)
        sum = himc_vec3_madd(sum, 1.0 / p->frames, p->x[which][i]);
    return sum;
}

// position of the player by the hips, else by the shoulders of a body in the natural pose; false
// without memory
static bool find_place(const player_points *p, const himc_skeleton *s, himc_player *player)
{
    himc_vec3 up = s->segment[HIMC_TRUNK].origin, sum = {0, 0, 0};
    const himc_vec3 *hips = p->x[POINT_HIPS];
    int shown = 0;
    for (int hand = 0; hand < HIMC_HANDS && !hips; hand++) {
        if (!p->x[POINT_SHOULDER + hand])
            continue;
        himc_vec3 model = himc_quat_rotate(player->mean.joint[HIMC_TRUNK - 1],
                                           s->segment[HIMC_LEFT_UPPER_ARM + hand].origin);
        sum = himc_vec3_add(
            sum, himc_vec3_sub(mean_position(p, POINT_SHOULDER + hand), himc_vec3_add(up, model)));
        shown++;
    }
    player->placed = hips || shown > 0;
    if (shown)
        player->hips = himc_vec3_scale(sum, 1.0 / shown);
    if (!hips)
        return true;
    bool waist = p->x[POINT_WAIST] && player->config.length[HIMC_PELVIS] > 0;
    double square = 0;
    himc_vec3 mean = mean_position(p, POINT_HIPS);
    player->hips = waist ? himc_vec3_sub(mean_position(p, POINT_WAIST), up) : mean;
    for (int i = 0; i < p->frames; i++) {
        himc_vec3 d = himc_vec3_sub(hips[i], mean);
        square += himc_vec3_dot(d, d) / p->frames;
    }
    // a held pelvis replaces one that sways a little, not one that walks
    player->walks = sqrt(square) > 0.15; // chosen: a seated player's hips sway by less
    if (!player->walks)
        return true;
    himc_player_note(
        player,
        "the player walks: the hips, which are held here, move by %.2f m RMS; all motion "
        "is relative to them",
        sqrt(square));
    player->walk = malloc((size_t)p->frames * sizeof *player->walk);
    for (int i = 0; player->walk && i < p->frames; i++)
        player->walk[i] = himc_vec3_sub(hips[i], mean);
    return player->walk != NULL;
}

himc_player *himc_player_new(himc_take *take, const himc_take_options *options,
                             const himc_skeleton_config *given, himc_error *error)
{
    himc_take_options usual = himc_take_default();
    player_points p = {.frames = 0};
    himc_skeleton skeleton;
    himc_posture natural;
    himc_player *player = calloc(1, sizeof *player);
    bool memory = player && himc_player_points_find(&p, take, options ? options : &usual, player);
    bool good = memory && himc_player_check(&p, player, error);
    if (good) {
        player->config = *given;
        player->config.seat = player->config.shoulders = 0;
        memset(player->config.length, 0, sizeof player->config.length);
        player->frames = himc_take_frames(take);
        measure_lengths(&p, player);
        good =
            find_height(&p, player, error) && himc_skeleton_init(&skeleton, &player->config, error);
    }
    if (good) {
        // what the take does not show is in the natural pose, before a timpano's head
        himc_posture_init(&natural, &skeleton, 0.85);
        double lean = natural.trunk_posture.value[HIMC_TRUNK_POSTURE_LEAN];
        player->mean = natural.rest;
        player->mean.joint[HIMC_TRUNK - 1] = himc_quat_exp(himc_vec3_make(0, lean, 0));
        memory = find_place(&p, &skeleton, player) && himc_player_read_poses(player, &p, &skeleton);
    }
    himc_player_points_free(&p);
    if (good && memory)
        return player;
    himc_player_free(player);
    if (!memory)
        himc_error_set(error, "%s: no memory for %d postures", take->file, himc_take_frames(take));
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

// The seat.

#define OVER_HEAD 0.05   // chosen: height of the lowest position if nothing is struck (m)
#define BESIDE_HEAD 0.05 // chosen: a tip so near beside the head counts as over it (m)

// the centre of the take's strikes, if there are any; false without memory
static bool strike_place(const himc_take *take, const himc_take_tip tips[HIMC_HANDS], bool *any,
                         himc_vec3 *place)
{
    himc_strike_survey survey;
    if (!himc_take_strikes(take, tips, &survey))
        return false;
    free(survey.strikes);
    *any = survey.heads > 0;
    *place = survey.head[0];
    return true;
}

static void usual_place(const himc_head_frame *drum, double *x, double *aside)
{
    himc_stroke usual = {.hand = HIMC_RIGHT, .spot = HIMC_SPOT_NORMAL};
    himc_head_frame_spot(drum, &usual, x, aside);
    *aside = fabs(*aside);
}

bool himc_strike_offset(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                        const himc_head_frame *drum, double mallet_radius, himc_vec3 *offset)
{
    double x, aside;
    himc_vec3 struck;
    bool strikes;
    if (!strike_place(take, tips, &strikes, &struck))
        return false;
    usual_place(drum, &x, &aside);
    himc_vec3 spot = himc_vec3_madd(himc_head_frame_to_world(drum, x, 0), mallet_radius,
                                    himc_head_frame_normal(drum));
    if (!strikes) {
        const himc_vec3 *tip = tips[HIMC_RIGHT].present ? tips[HIMC_RIGHT].x : tips[HIMC_LEFT].x;
        struck = tip[0];
        for (int i = 1; i < himc_take_frames(take); i++)
            struck = tip[i].z < struck.z ? tip[i] : struck;
        spot.z += OVER_HEAD;
    }
    if (!tips[HIMC_LEFT].present || !tips[HIMC_RIGHT].present)
        spot.y += tips[HIMC_LEFT].present ? aside : -aside;
    *offset = himc_vec3_sub(spot, struck);
    return true;
}

// a strike place on the head as seen from above: x, y in the drum's frame, z 0
static himc_vec3 seen_on_head(const himc_head_frame *drum, himc_vec3 spot)
{
    himc_head_frame level = *drum;
    level.tilt = 0;
    spot.z = drum->center.z;
    return himc_head_frame_from_world(&level, spot);
}

// sets the seat so that the strikes meet the head; the drum is moved if they would miss it there,
// or if no seat is low or high enough
static void seat_player(himc_player *player, himc_vec3 struck, himc_head_frame *drum)
{
    himc_vec3 spot = himc_vec3_sub(struck, player->hips), local = seen_on_head(drum, spot);
    if (himc_head_frame_out(drum, local.x, local.y) > 0.97) { // chosen: strikes near the rim miss
        // under the strikes, on the line from the player, known from 0.1 m on (chosen)
        double x, aside, far = hypot(spot.x, spot.y);
        usual_place(drum, &x, &aside);
        drum->center.x = spot.x - x * (far > 0.1 ? spot.x / far : 1);
        drum->center.y = spot.y - x * (far > 0.1 ? spot.y / far : 0);
        local = seen_on_head(drum, spot);
    }
    double head =
        drum->center.z + local.x * tan(drum->tilt) + player->config.mallet_radius / cos(drum->tilt);
    double seat = head - spot.z, kept = fmin(fmax(seat, PLAYER_LOWEST_SEAT), PLAYER_HIGHEST_SEAT);
    if (fabs(kept - player->hips.z) < 0.012) // chosen: no more than the dent of a struck head
        kept = seat = player->hips.z;
    drum->center.z += kept - seat;
    player->config.seat = kept;
}

// finds an offset with all positions in reach if there is one, else one with little out of reach:
// moves the take by what its farthest position misses, again and again
static bool bring_into_reach(himc_player *player, const himc_take *take,
                             const himc_take_tip tips[HIMC_HANDS], const himc_head_frame *drum,
                             himc_error *error)
{
    himc_skeleton skeleton;
    himc_posture posture;
    himc_vec3 best = player->offset;
    double least = INFINITY;
    if (!himc_skeleton_init(&skeleton, &player->config, error))
        return false;
    himc_posture_init(&posture, &skeleton, drum->center.z + player->config.mallet_radius);
    // chosen: 50 moves at most, each by some 1000 frames, until less than 1 mm is missing
    int frames = himc_take_frames(take), step = frames / 1000 + 1;
    for (int move = 0; move < 50 && least > 1e-3; move++) {
        himc_vec3 back = {0, 0, 0};
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            for (int i = 0; tips[hand].present && i < frames; i += step) {
                himc_vec3 x = himc_vec3_add(tips[hand].x[i], player->offset);
                himc_vec3 near = himc_posture_reachable(&posture, (himc_hand)hand, x);
                himc_vec3 shift = himc_vec3_sub(near, x);
                if (himc_vec3_length(shift) > himc_vec3_length(back))
                    back = shift;
            }
        if (himc_vec3_length(back) < least) {
            least = himc_vec3_length(back);
            best = player->offset;
        }
        player->offset =
            himc_vec3_madd(player->offset, 1.01, back); // a little farther than missing
    }
    player->offset = best;
    return true;
}

// lowers a head under a take that strikes nothing until no tip touches it, nor on the way there
static void clear_drum(himc_head_frame *drum, const himc_take *take,
                       const himc_take_tip tips[HIMC_HANDS], himc_vec3 offset)
{
    const int parts = 20; // of the way from rest over the head, where the planner has the stick
    double under = 0, x, aside;
    usual_place(drum, &x, &aside);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 rest = himc_vec3_make(x, hand == HIMC_LEFT ? aside : -aside, 0.085), first = rest;
        for (int i = 0; tips[hand].present && i < himc_take_frames(take); i++) {
            himc_vec3 at = himc_head_frame_from_world(drum, himc_vec3_add(tips[hand].x[i], offset));
            first = i == 0 ? at : first;
            if (hypot(at.x, at.y) < drum->radius + BESIDE_HEAD)
                under = fmax(under, OVER_HEAD - at.z);
        }
        for (int i = 1; tips[hand].present && i <= parts; i++) {
            double part = (double)i / parts;
            himc_vec3 at = himc_vec3_madd(rest, part, himc_vec3_sub(first, rest));
            if (hypot(at.x, at.y) < drum->radius + BESIDE_HEAD)
                under = fmax(under, (OVER_HEAD - at.z) / part);
        }
    }
    // chosen: 0.1 m above the floor at least
    drum->center.z = fmax(drum->center.z - under / cos(drum->tilt), 0.1);
}

bool himc_player_sit(himc_player *player, himc_take *take, const himc_take_options *options,
                     himc_head_frame *drum, himc_error *error)
{
    himc_vec3 struck, *hips = &player->hips, offset = player->offset;
    himc_take_tip tips[HIMC_HANDS];
    bool strikes;
    // takes the hips' motion over the floor out of the take
    for (int i = 0; player->walk && i < take->frames; i++)
        for (int k = 0; k < take->points; k++) {
            himc_vec3 *x = himc_take_at(take, i, k);
            x->x -= player->walk[i].x;
            x->y -= player->walk[i].y;
        }
    free(player->walk);
    player->walk = NULL;
    if (!himc_take_tips(take, options, tips, error))
        return false;
    if (!strike_place(take, tips, &strikes, &struck) ||
        (!player->placed &&
         !himc_strike_offset(take, tips, drum, player->config.mallet_radius, &offset)))
        return himc_error_set(error, "%s: out of memory", take->file);
    player->offset = offset;
    if (player->placed) {
        // without strikes the captured height above the floor is kept
        player->config.seat = fmin(fmax(hips->z, PLAYER_LOWEST_SEAT), PLAYER_HIGHEST_SEAT);
        if (strikes)
            seat_player(player, struck, drum);
        player->offset = himc_vec3_make(-hips->x, -hips->y, player->config.seat - hips->z);
    } else {
        if (!strikes && !bring_into_reach(player, take, tips, drum, error))
            return false;
        himc_vec3 root = {0, 0, himc_skeleton_seat(&player->config)};
        *hips = himc_vec3_sub(root, player->offset);
    }
    if (!strikes)
        clear_drum(drum, take, tips, player->offset);
    player->seated = true;
    return true;
}
