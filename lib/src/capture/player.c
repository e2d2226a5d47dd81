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
#include "himc/command.h"

#include <stdlib.h>
#include <string.h>

#define REFERENCE_HEIGHT 1.741 // de Leva 1996 (m)
#define LEAST_STICK 0.2        // range of himc_skeleton_config (m)
#define MOST_STICK 0.6
#define USUAL_BREADTH 0.37 // between the shoulder joints of that man (m)
#define LEAST_BREADTH 0.2  // range of himc_skeleton_config (m)
#define USUAL_HEAD 0.85    // chosen: height of a timpano's head, for the natural pose (m)
#define HAND_REACH 0.2     // chosen: a hand is shorter, a stick in it reaches farther (m)
#define WALK 0.15          // chosen: a seated player's hips sway by less, RMS (m)

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
        c->stick_length = fmin(fmax(c->grip + both + c->mallet_radius, LEAST_STICK), MOST_STICK);
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
    player->config.shoulders =
        breadth >= LEAST_BREADTH ? himc_player_plausible(breadth, USUAL_BREADTH) : 0;
}

// a tip within a hand's length of the wrist is no stick's: the body's stick is then to be put there
static void note_hands(const player_points *p, himc_player *player)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double far = himc_player_distance(p, POINT_WRIST + hand, POINT_TIP + hand, 0.5);
        int node = p->node[POINT_TIP + hand];
        bool shown = p->x[POINT_WRIST + hand] && p->x[POINT_TIP + hand] && node >= 0;
        if (shown && far < HAND_REACH)
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
        c->height = ratio * REFERENCE_HEIGHT;
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

// POINT_HIPS is the centre between the hip joints if both are there: a point called hips may be
// elsewhere
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

// a held pelvis replaces one that sways a little, not one that walks
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
    himc_player_note(
        player,
        "the player walks: the hips, which are held here, move by %.2f m RMS; all motion "
        "is relative to them",
        sqrt(square));
    player->walk = malloc((size_t)p->frames * sizeof *player->walk);
    for (int i = 0; player->walk && i < p->frames; i++)
        player->walk[i] = himc_vec3_sub(p->x[POINT_HIPS][i], mean);
    return player->walk != NULL;
}

// position of the player by the hips, else by the shoulders of a body in the natural pose; false
// without memory
static bool find_place(const player_points *p, const himc_skeleton *s, himc_player *player)
{
    himc_vec3 up = s->segment[HIMC_TRUNK].origin, sum = {0, 0, 0};
    int shown = 0;
    if (p->x[POINT_HIPS]) {
        bool waist = p->x[POINT_WAIST] && player->config.length[HIMC_PELVIS] > 0;
        player->hips =
            waist ? himc_vec3_sub(mean_position(p, POINT_WAIST), up) : mean_position(p, POINT_HIPS);
        player->placed = true;
        return find_walk(p, mean_position(p, POINT_HIPS), player);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        if (!p->x[POINT_SHOULDER + hand])
            continue;
        himc_vec3 model = himc_quat_rotate(player->mean.joint[HIMC_TRUNK - 1],
                                           s->segment[HIMC_LEFT_UPPER_ARM + hand].origin);
        sum = himc_vec3_add(
            sum, himc_vec3_sub(mean_position(p, POINT_SHOULDER + hand), himc_vec3_add(up, model)));
        shown++;
    }
    player->placed = shown > 0;
    if (shown)
        player->hips = himc_vec3_scale(sum, 1.0 / shown);
    return true;
}

// the pose of a body of which the take shows nothing
static himc_pose natural_pose(const himc_skeleton *skeleton)
{
    himc_posture posture;
    himc_posture_init(&posture, skeleton, USUAL_HEAD);
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
    note_hands(p, player);
    if (!find_height(p, player, error) || !himc_skeleton_init(&skeleton, &player->config, error))
        return false;
    player->mean = natural_pose(&skeleton);
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

// The seat.

#define ON_HEAD 0.97 // chosen: share of the radius within which strikes meet the head
#define DENT 0.012   // chosen: dent of a struck head; a smaller change of the seat is not made (m)
#define REST_OVER_HEAD 0.085 // of resting sticks (m), as the planner has them
#define APPROACH_PARTS 20    // of the way from there, in which it is looked at
#define OVER_HEAD 0.05       // chosen: height of the lowest position if nothing is struck (m)
#define LOWEST_HEAD 0.1      // chosen: of the drum above the floor (m)
#define BESIDE_HEAD 0.05     // chosen: a tip so near beside the head counts as over it (m)
#define REACH_STEPS 50       // chosen: most moves of a take that is partly out of reach ...
#define REACH_FRAMES 1000    // ... chosen: frames looked at in each
#define REACH_OVERSHOOT 1.01 // chosen: each a little farther than missing
#define LEAST_AWAY 0.1       // chosen: nearer to the player's axis a strike has no direction (m)
#define REACH_MISSING 1e-3   // chosen: less out of reach is in reach (m)

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

static himc_vec3 lowest_place(const himc_take *take, const himc_take_tip tips[HIMC_HANDS])
{
    const himc_vec3 *x = tips[HIMC_RIGHT].present ? tips[HIMC_RIGHT].x : tips[HIMC_LEFT].x;
    int lowest = 0;
    for (int i = 1; i < himc_take_frames(take); i++)
        if (x[i].z < x[lowest].z)
            lowest = i;
    return x[lowest];
}

static void usual_place(const himc_head_frame *drum, double *x, double *aside)
{
    himc_stroke usual = {.hand = HIMC_RIGHT, .spot = HIMC_SPOT_NORMAL};
    himc_stroke_spot(&usual, drum->radius, x, aside);
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
        struck = lowest_place(take, tips);
        spot.z += OVER_HEAD;
    }
    if (!tips[HIMC_LEFT].present || !tips[HIMC_RIGHT].present)
        spot.y += tips[HIMC_LEFT].present ? aside : -aside;
    *offset = himc_vec3_sub(spot, struck);
    return true;
}

// puts the drum under a strike place, on the line from the player through it
static void move_drum_under(himc_head_frame *drum, himc_vec3 spot)
{
    double x, aside, far = hypot(spot.x, spot.y);
    usual_place(drum, &x, &aside);
    himc_vec3 away =
        far > LEAST_AWAY ? himc_vec3_make(spot.x / far, spot.y / far, 0) : himc_vec3_make(1, 0, 0);
    drum->center.x = spot.x - x * away.x;
    drum->center.y = spot.y - x * away.y;
}

// a strike place on the head as seen from above: x, y in the drum's frame, z 0
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
    double seat = head - spot.z, kept = fmin(fmax(seat, PLAYER_LOWEST_SEAT), PLAYER_HIGHEST_SEAT);
    if (fabs(kept - player->hips.z) < DENT)
        kept = seat = player->hips.z;
    drum->center.z += kept - seat;
    player->config.seat = kept;
    player->offset = himc_vec3_make(-player->hips.x, -player->hips.y, kept - player->hips.z);
}

// a player without strikes keeps the captured height above the floor
static void keep_player(himc_player *player)
{
    double seat = fmin(fmax(player->hips.z, PLAYER_LOWEST_SEAT), PLAYER_HIGHEST_SEAT);
    player->config.seat = seat;
    player->offset = himc_vec3_make(-player->hips.x, -player->hips.y, seat - player->hips.z);
}

// the shift that brings the farthest position of the tips, moved by `offset`, into reach
static himc_vec3 back_into_reach(const himc_posture *posture, const himc_take *take,
                                 const himc_take_tip tips[HIMC_HANDS], himc_vec3 offset)
{
    himc_vec3 back = {0, 0, 0};
    int frames = himc_take_frames(take), step = frames / REACH_FRAMES + 1;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; tips[hand].present && i < frames; i += step) {
            himc_vec3 x = himc_vec3_add(tips[hand].x[i], offset);
            himc_vec3 near = himc_posture_reachable(posture, (himc_hand)hand, x);
            himc_vec3 shift = himc_vec3_sub(near, x);
            if (himc_vec3_length(shift) > himc_vec3_length(back))
                back = shift;
        }
    return back;
}

// finds an offset with all positions in reach if there is one, else one with little out of reach
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
    for (int i = 0; i < REACH_STEPS && least > REACH_MISSING; i++) {
        himc_vec3 back = back_into_reach(&posture, take, tips, player->offset);
        if (himc_vec3_length(back) < least) {
            least = himc_vec3_length(back);
            best = player->offset;
        }
        player->offset = himc_vec3_add(player->offset, himc_vec3_scale(back, REACH_OVERSHOOT));
    }
    player->offset = best;
    return true;
}

// how far a head is to be lowered for a stick that comes from rest over it to the take's first
// place `first`, in the head's frame (m)
static double under_approach(const himc_head_frame *drum, himc_hand hand, himc_vec3 first)
{
    double under = 0, x, aside;
    usual_place(drum, &x, &aside);
    const himc_vec3 rest = himc_vec3_make(x, hand == HIMC_LEFT ? aside : -aside, REST_OVER_HEAD);
    for (int i = 1; i <= APPROACH_PARTS; i++) {
        double part = (double)i / APPROACH_PARTS;
        himc_vec3 at = himc_vec3_madd(rest, part, himc_vec3_sub(first, rest));
        if (hypot(at.x, at.y) < drum->radius + BESIDE_HEAD)
            under = fmax(under, (OVER_HEAD - at.z) / part);
    }
    return under;
}

// lowers a head under a take that strikes nothing until no tip touches it, nor on the way there
static void clear_drum(himc_head_frame *drum, const himc_take *take,
                       const himc_take_tip tips[HIMC_HANDS], himc_vec3 offset)
{
    double under = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; tips[hand].present && i < himc_take_frames(take); i++) {
            himc_vec3 x = himc_head_frame_from_world(drum, himc_vec3_add(tips[hand].x[i], offset));
            if (i == 0)
                under = fmax(under, under_approach(drum, (himc_hand)hand, x));
            if (hypot(x.x, x.y) < drum->radius + BESIDE_HEAD)
                under = fmax(under, OVER_HEAD - x.z);
        }
    drum->center.z = fmax(drum->center.z - under / cos(drum->tilt), LOWEST_HEAD);
}

// takes the hips' motion over the floor out of the take
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
                     himc_head_frame *drum, himc_error *error)
{
    himc_vec3 struck, offset = player->offset;
    himc_take_tip tips[HIMC_HANDS];
    bool strikes;
    hold_hips(player, take);
    if (!himc_take_tips(take, options, tips, error))
        return false;
    if (!strike_place(take, tips, &strikes, &struck) ||
        (!player->placed &&
         !himc_strike_offset(take, tips, drum, player->config.mallet_radius, &offset)))
        return himc_error_set(error, "%s: out of memory", take->file);
    player->offset = offset;
    if (player->placed && strikes)
        seat_player(player, struck, drum);
    else if (player->placed)
        keep_player(player);
    else if (!strikes && !bring_into_reach(player, take, tips, drum, error))
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
