/// performance_take.c: the command `take`: a capture's player becomes the performer, and sits where
/// the capture has it, before a drum that stands under the strikes.
///
/// In `id` and `ik` the joints follow the capture's postures, but for arms that hold no stick; in
/// `himc` only the tips are known, and the null space has the natural posture, with neck, head,
/// legs and the trunk's mean as this player holds them. Of an arm that the take shows it has the
/// player's own way instead: the mean and the habit, the usual one corrected by this take's
/// postures.
#include "performance/performance_state.h"
#include "capture/take.h"
#include "base/head_frame.h"
#include "performance/research.h"

#include <stdlib.h>
#include <string.h>

// says what was repaired in reading it
static void note_repairs(himc_performance *p, himc_take *take, const char *path)
{
    himc_take_tip tips[HIMC_HANDS];
    for (int i = 0; i < take->note_count; i++)
        himc_performance_note(p, "%s: %s", path, take->notes[i]);
    if (!himc_take_tips(take, &p->take_options, tips, NULL))
        return;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (tips[hand].present && tips[hand].filled > 0)
            himc_performance_note(p, "%s: %s is missing in %d frames, which are filled", path,
                                  tips[hand].name, tips[hand].filled);
}

// says how much of a take the player cannot follow; the arm then stretches towards it
static void note_reach(himc_performance *p, const himc_track *track, const char *path)
{
    double length = himc_track_length(track), farthest = 0;
    int far = 0, count = 0;
    for (double t = 0; t < length; t += 0.01)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            if (!himc_track_present(track, (himc_hand)hand))
                continue;
            himc_vec3 x = himc_track_target(track, (himc_hand)hand, t).x;
            himc_vec3 near = himc_posture_reachable(&p->posture, (himc_hand)hand, x);
            double missing = himc_vec3_length(himc_vec3_sub(x, near));
            count++;
            far += missing > 1e-3;
            farthest = fmax(farthest, missing);
        }
    if (far > 0)
        himc_performance_note(p, "%s: tips out of reach in %.0f %% of the take, by up to %.2f m",
                              path, 100.0 * far / count, farthest);
}

void himc_performance_posture(const himc_performance *p, double t,
                              const himc_target tip[HIMC_HANDS], himc_posture_motion *motion)
{
    himc_posture_moving(&p->posture, tip, motion);
    bool captured = p->controller.mode != HIMC_PIPELINE_HIMC && p->track &&
                    isfinite(p->track_start) && himc_track_has_posture(p->track);
    if (captured)
        himc_track_posture(p->track, &p->skeleton, t - p->track_start, p->unbent ? NULL : tip,
                           motion);
}

// a drum that the take's strikes would miss is put under them, one that is in its way is lowered
static bool move_drum(himc_performance *p, int index, const himc_head_frame *place,
                      const himc_track *track, const char *path, himc_error *error)
{
    bool strikes = himc_track_strikes(track, HIMC_LEFT) + himc_track_strikes(track, HIMC_RIGHT) > 0;
    himc_drum *drum = p->drum[index].drum;
    himc_vec3 to = place->center, from = himc_drum_head_frame(drum)->center;
    if (himc_vec3_length(himc_vec3_sub(to, from)) < 1e-6)
        return true;
    himc_command move = {.id = HIMC_COMMAND_PLACE, .count = 3};
    double x[3] = {to.x, to.y, to.z};
    for (int i = 0; i < 3; i++)
        move.atom[i] = (himc_atom){.kind = HIMC_ATOM_NUMBER, .number = x[i]};
    if (!himc_drum_command(drum, &move, error))
        return false;
    himc_performance_note(p, "%s: the %s is moved to %.3f %.3f %.3f, %s", path,
                          himc_drum_name(drum), to.x, to.y, to.z,
                          strikes ? "where the take strikes" : "out of the take's way");
    return true;
}

static himc_trunk_posture trunk_bearing(const himc_player *player)
{
    himc_trunk_posture b = {.value = {0}};
    himc_quat q = player->mean.joint[HIMC_TRUNK - 1];
    himc_vec3 up = himc_quat_rotate(q, himc_vec3_make(0, 0, 1)),
              left = himc_quat_rotate(q, himc_vec3_make(0, 1, 0));
    double turn = atan2(-left.x, left.y);
    b.value[HIMC_TRUNK_POSTURE_TURN] = turn;
    b.value[HIMC_TRUNK_POSTURE_LEAN] = asin(fmin(fmax(cos(turn) * up.x + sin(turn) * up.y, -1), 1));
    return b;
}

// the limits of the take's player, whose sticks strike a head at that place
static bool learn_limits(const himc_player *player, const himc_track *track,
                         const himc_head_frame *place, himc_limits *learned, himc_error *error)
{
    himc_skeleton skeleton;
    himc_posture posture;
    if (!player->pose)
        return true;
    if (!himc_performance_learn_limits(player, learned, error) ||
        !himc_skeleton_init(&skeleton, &player->config, error))
        return false;
    himc_posture_init(&posture, &skeleton, place->center.z + skeleton.mallet_radius);
    posture.trunk_posture = trunk_bearing(player);
    return himc_performance_learn_bent(player, track, &posture, learned, error);
}

// trunk, neck, head and legs as this player holds them
static void adopt_manner(himc_performance *p, const himc_player *player)
{
    memcpy(p->captured_rest_known, player->known, sizeof p->captured_rest_known);
    p->captured_rest_pose = player->mean;
    // one seated by the shoulders has them where they were seen with this trunk only
    p->captured_rest_known[HIMC_TRUNK - 1] = player->known[HIMC_TRUNK - 1] || player->placed;
    p->trunk_posture = trunk_bearing(player);
}

// the body of the take's player, if it shows one
static bool adopt_player(himc_performance *p, const himc_player *player, const char *path,
                         himc_error *error)
{
    if (player->lengths == 0) {
        memset(p->captured_rest_known, 0, sizeof p->captured_rest_known);
        return true;
    }
    himc_skeleton_config old = p->body;
    p->body = player->config;
    adopt_manner(p, player);
    if (!himc_performance_build_body(p, error)) {
        p->body = old;
        memset(p->captured_rest_known, 0, sizeof p->captured_rest_known);
        return false;
    }
    himc_performance_note(p, "%s: the player's body has %d lengths from it, %.2f m, %.0f kg", path,
                          player->lengths, p->body.height, p->body.mass);
    return true;
}

// says how many strikes of a take are on none of the drum it is played on
static void note_outside(himc_performance *p, himc_take *take, const himc_track *track,
                         const himc_drum *drum, const char *path)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_error ignored;
    const himc_head_frame *place = himc_drum_head_frame(drum);
    if (!himc_take_tips(take, &p->take_options, tips, &ignored))
        return;
    int count, outside = 0;
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &count);
    for (int i = 0; i < count; i++) {
        himc_vec3 at = himc_vec3_add(strikes[i].x, himc_track_offset(track));
        himc_vec3 local = himc_head_frame_from_world(place, at);
        outside += hypot(local.x, local.y) > place->radius;
    }
    free(strikes);
    if (outside > 0)
        himc_performance_note(p, "%s: %d of %d strikes are beside drum %s: a take is played on one",
                              path, outside, count, himc_drum_name(drum));
}

// an arm, its hand and stick included
static bool shows_arm(const himc_player *player, himc_hand hand)
{
    return player->pose && !player->walks && himc_player_known_arm(player, hand) == HIMC_ARM_JOINTS;
}

// the usual habit, corrected by what the take shows of this player's, unless another has been set
static void adopt_habit(himc_performance *p, const himc_player *player, const himc_take *take,
                        const char *path)
{
    himc_posture_regression regression;
    himc_error error = {""};
    himc_posture_regression_take seen = {
        .skeleton = &p->skeleton,
        .pose = player->pose,
        .frames = player->frames,
        .rate = himc_take_rate(take),
        .unseen_arm = {!shows_arm(player, HIMC_LEFT), !shows_arm(player, HIMC_RIGHT)},
        .unseen_trunk = !player->known[HIMC_TRUNK - 1]};
    if (p->has_regression && !p->regression_of_take)
        return;
    himc_posture_regression_default(&regression);
    bool shown = !seen.unseen_arm[HIMC_LEFT] || !seen.unseen_arm[HIMC_RIGHT];
    bool met = shown && himc_posture_regression_correct(&regression, &seen, &error);
    if (shown && !met)
        himc_performance_note(p, "%s: %s: the arms go as is natural", path, error.text);
    himc_performance_set_posture_regression(p, met ? &regression : NULL);
    p->regression_of_take = met;
}

static bool play_take(himc_performance *p, himc_take *take, himc_player *player, const char *path,
                      himc_error *error)
{
    int drum;
    if (!himc_performance_ensure_drum(p, "", &drum, error))
        return false;
    himc_limits learned;
    himc_head_frame place = *himc_drum_head_frame(p->drum[drum].drum);
    himc_player_sit(player, take, &p->take_options, &place);
    if (player->placed && !player->walks && place.center.x < 0)
        return himc_error_set(
            error,
            "the sticks strike %.2f m behind the player, allowed before: are left "
            "and right exchanged?",
            -place.center.x);
    himc_track *track = himc_track_new_played(take, &p->take_options, &place, player, error);
    if (!track)
        return false;
    if (!learn_limits(player, track, &place, &learned, error) ||
        !move_drum(p, drum, &place, track, path, error) || !adopt_player(p, player, path, error)) {
        himc_track_free(track);
        return false;
    }
    himc_performance_notice_drums(p);
    note_repairs(p, take, path);
    note_reach(p, track, path);
    note_outside(p, take, track, p->drum[drum].drum, path);
    himc_performance_drop_track(p);
    p->track = track;
    p->has_learned = player->pose != NULL;
    if (p->has_learned)
        p->learned = learned;
    himc_performance_renew_limits(p);
    adopt_habit(p, player, take, path);
    himc_performance_fit_posture_regression(p);
    p->replan = true;
    return true;
}

bool himc_performance_play_player(himc_performance *p, himc_take *take, himc_player *player,
                                  const char *name, himc_error *error)
{
    bool played = player && play_take(p, take, player, name, error);
    if (!played && error && strncmp(error->text, name, strlen(name)) != 0)
        himc_error_prefix(error, "%s", name);
    return played;
}

// plays a take by the player it shows
static bool play_own_player(himc_performance *p, himc_take *take, const char *name,
                            himc_error *error)
{
    himc_player *player = himc_player_new(take, &p->take_options, &p->body, error);
    bool played = himc_performance_play_player(p, take, player, name, error);
    himc_player_free(player);
    return played;
}

bool himc_performance_do_take(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_take *take = himc_take_load(c->atom[0].symbol, &p->take_options, error);
    bool played = take && play_own_player(p, take, c->atom[0].symbol, error);
    himc_take_free(take);
    return played;
}

himc_vec3 himc_performance_take_offset(const himc_performance *p)
{
    return p->track ? himc_track_offset(p->track) : himc_vec3_make(0, 0, 0);
}
