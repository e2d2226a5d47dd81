/// performance_take.c: the command `take`: the performer gets the body and the seat of the captured
/// player, before a drum under the strikes.
///
/// In `id` and `ik` the joints follow the captured postures, except for arms without a stick. In
/// `himc` only the tips are given; the null space follows the natural posture, with neck, head,
/// legs and the mean trunk of this player. A completely captured arm follows a posture
/// regression instead: the default one, corrected by this take's postures.
///
/// Joint limits are learned from the captured postures. An arm without a stick was held differently
/// from one with a stick; its limits are learned from the postures for its tips: the natural ones
/// in `himc`, the captured ones bent to the tips in `id`.
///
/// All that can fail is made first (prepare_take); only then anything changes (play_prepared).
#include "performance/performance_state.h"
#include "base/head_frame.h"
#include "body/limits.h"
#include "capture/take.h"

#include <stdlib.h>
#include <string.h>

// chosen: a player goes a little further than one take shows
#define LIMIT_MARGIN 0.05     // beyond the captured range, as a share of it ...
#define LEAST_LIMIT 0.05      // ... and this far whatever the range (rad)
#define POSTURES_SEEN 1000    // frames of a take, for the limits of bent arms
#define REACH_CHECK_STEP 0.01 // from one check of a take's reach to the next (s)
#define OUT_OF_REACH 1e-3     // a tip further from its target is out of reach (m)
#define SAME_PLACE 1e-6       // a drum as near as this is not moved (m)

// notes on the repairs made while reading the take
static void note_repairs(himc_performance *p, himc_take *take, const char *path)
{
    himc_take_tip tips[HIMC_HANDS];
    for (int i = 0; i < take->note_count; i++)
        himc_events_note(&p->events, "%s: %s", path, take->notes[i]);
    if (!himc_take_tips(take, &p->host.take_options, tips, NULL))
        return;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (tips[hand].present && tips[hand].filled > 0)
            himc_events_note(&p->events, "%s: %s is missing in %d frames, which are filled", path,
                             tips[hand].name, tips[hand].filled);
}

// a note on the part of the take out of reach; there the arm stretches towards the tips
static void note_reach(himc_performance *p, const himc_track *track, const char *path)
{
    double length = himc_track_length(track), farthest = 0;
    int far = 0, count = 0;
    for (double t = 0; t < length; t += REACH_CHECK_STEP)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            if (!himc_track_present(track, (himc_hand)hand))
                continue;
            himc_vec3 x = himc_track_target(track, (himc_hand)hand, t).x;
            himc_vec3 near = himc_posture_reachable(&p->motion->posture, (himc_hand)hand, x);
            double missing = himc_vec3_length(himc_vec3_sub(x, near));
            count++;
            far += missing > OUT_OF_REACH;
            farthest = fmax(farthest, missing);
        }
    if (far > 0)
        himc_events_note(&p->events,
                         "%s: tips out of reach in %.0f %% of the take, by up to %.2f m", path,
                         100.0 * far / count, farthest);
}

/// What is made of a take before anything changes. Owned.
typedef struct prepared_take {
    wanted_drum drum;
    himc_head_frame frame; ///< of the drum as it will stand
    himc_track *track;
    himc_limits learned; ///< if the player shows postures
    body_parts body;     ///< if the player shows lengths
    performance_settings settings;
    himc_posture_regression regression; ///< of the arms, if `corrected`
    bool corrected;
    himc_error uncorrected; ///< why not, if the arms are shown
    int strikes, outside;   ///< of the take, and of these beside the drum
} prepared_take;

static bool is_same_place(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b)) < SAME_PLACE;
}

// moves the drum under the take's strikes, or lowers a drum that is in the way
static void move_drum(himc_performance *p, const prepared_take *made, const char *path)
{
    const himc_track *track = made->track;
    int index = made->drum.index;
    bool strikes = himc_track_strikes(track, HIMC_LEFT) + himc_track_strikes(track, HIMC_RIGHT) > 0;
    himc_vec3 to = made->frame.center;
    if (is_same_place(to, himc_drums_frame(&p->drums, index)->center) ||
        !himc_drums_move(&p->drums, index, to, NULL))
        return;
    himc_events_note(&p->events, "%s: the %s is moved to %.3f %.3f %.3f, %s", path,
                     himc_drum_name(p->drums.slot[index].drum), to.x, to.y, to.z,
                     strikes ? "under the take's strikes" : "out of the take's way");
}

static himc_trunk_posture mean_trunk(const himc_player *player)
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

bool himc_performance_learn_limits(const himc_player *player, himc_limits *learned,
                                   himc_error *error)
{
    if (!himc_limits_learn(learned, player->pose, player->frames, LIMIT_MARGIN, error))
        return false;
    himc_limits_loosen(learned, LEAST_LIMIT);
    return true;
}

static bool lacks_stick(const himc_player *player, const himc_track *track, himc_hand hand)
{
    int known = himc_player_known_arm(player, hand);
    return himc_track_present(track, hand) && known > 0 && known < HIMC_ARM_JOINTS;
}

// the natural posture of the take's tips at `t`, and the captured one bent to them
static void postures_at(const himc_posture *posture, const himc_track *track, double t,
                        himc_pose pose[2])
{
    himc_posture_motion motion;
    himc_target tip[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int seen = himc_track_present(track, (himc_hand)hand) ? hand : !hand;
        tip[hand] = himc_track_target(track, (himc_hand)seen, t);
    }
    himc_posture_moving(posture, tip, &motion);
    memcpy(pose[0].joint, motion.joint, sizeof motion.joint);
    himc_track_posture(track, &posture->skeleton, t, tip, &motion);
    memcpy(pose[1].joint, motion.joint, sizeof motion.joint);
}

// learns the limits of arms without sticks again, from the postures for the tips
static bool learn_bent(const himc_player *player, const himc_track *track,
                       const himc_posture *posture, himc_limits *learned, himc_error *error)
{
    bool lacks[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        lacks[hand] = lacks_stick(player, track, (himc_hand)hand);
    if (!lacks[HIMC_LEFT] && !lacks[HIMC_RIGHT])
        return true;
    himc_limits bent;
    himc_pose *pose = malloc(2 * POSTURES_SEEN * sizeof *pose);
    for (int i = 0; pose && i < POSTURES_SEEN; i++)
        postures_at(posture, track, himc_track_length(track) * i / POSTURES_SEEN, &pose[2 * i]);
    if (!pose)
        himc_error_set(error, "limits: out of memory");
    bool fitted = pose && himc_limits_learn(&bent, pose, 2 * POSTURES_SEEN, LIMIT_MARGIN, error);
    free(pose);
    if (!fitted)
        return false;
    himc_limits_loosen(&bent, LEAST_LIMIT);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; lacks[hand] && k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint((himc_hand)hand, k);
            if (player->known[j])
                learned->joint[j] = bent.joint[j];
        }
    return true;
}

// the limits of the take's player, the sticks striking a head at that place
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
    posture.trunk_posture = mean_trunk(player);
    return learn_bent(player, track, &posture, learned, error);
}

// trunk, neck, head and legs of this player
static captured_player captured_of(const himc_player *player)
{
    captured_player c = {.rest = player->mean, .trunk = mean_trunk(player)};
    memcpy(c.known, player->known, sizeof c.known);
    // a seat found from the shoulders is valid with this trunk only
    c.known[HIMC_TRUNK - 1] = player->known[HIMC_TRUNK - 1] || player->placed;
    return c;
}

// the settings with the body of the take's player, if the take shows one
static bool prepare_body(const himc_performance *p, const himc_player *player, prepared_take *made,
                         himc_error *error)
{
    made->settings = p->settings;
    memset(made->settings.captured.known, 0, sizeof made->settings.captured.known);
    if (player->lengths == 0)
        return true;
    made->settings.skeleton = player->config;
    made->settings.captured = captured_of(player);
    return himc_body_make_parts(&made->body, &made->settings, error);
}

static void adopt_player(himc_performance *p, const himc_player *player, const prepared_take *made,
                         const char *path)
{
    const performance_settings *s = &made->settings;
    if (player->lengths == 0) {
        himc_performance_adopt(p, s);
        return;
    }
    himc_performance_embody(p, s, &made->body);
    himc_events_note(&p->events, "%s: the player's body: %d lengths from the take, %.2f m, %.0f kg",
                     path, player->lengths, s->skeleton.height, s->skeleton.mass);
}

// counts the strikes of a take, and those beside the drum as it will stand
static bool count_strikes(const himc_performance *p, himc_take *take, prepared_take *made,
                          himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    if (!himc_take_tips(take, &p->host.take_options, tips, error))
        return false;
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &made->strikes);
    if (!strikes)
        return himc_error_set(error, "out of memory");
    for (int i = 0; i < made->strikes; i++) {
        himc_vec3 at = himc_vec3_add(strikes[i].x, himc_track_offset(made->track));
        himc_vec3 local = himc_head_frame_from_world(&made->frame, at);
        made->outside += hypot(local.x, local.y) > made->frame.radius;
    }
    free(strikes);
    return true;
}

// an arm, its hand and stick included
static bool shows_arm(const himc_player *player, himc_hand hand)
{
    return player->pose && !player->walks && himc_player_known_arm(player, hand) == HIMC_ARM_JOINTS;
}

// another regression than that of a take has been set
static bool has_own_regression(const himc_performance *p)
{
    return p->motion->has_regression && !p->motion->regression_of_take;
}

// the default regression, corrected by this take; false without memory
static bool prepare_regression(const himc_performance *p, const himc_player *player,
                               const himc_take *take, prepared_take *made, himc_error *error)
{
    bool memory = true;
    himc_posture_regression_take seen = {
        .skeleton = player->lengths > 0 ? &made->body.skeleton : &p->body->skeleton,
        .pose = player->pose,
        .frames = player->frames,
        .rate = himc_take_rate(take),
        .unseen_arm = {!shows_arm(player, HIMC_LEFT), !shows_arm(player, HIMC_RIGHT)},
        .unseen_trunk = !player->known[HIMC_TRUNK - 1]};
    if (has_own_regression(p) || (seen.unseen_arm[HIMC_LEFT] && seen.unseen_arm[HIMC_RIGHT]))
        return true;
    himc_posture_regression_default(&made->regression);
    made->corrected =
        himc_posture_regression_correct(&made->regression, &seen, &memory, &made->uncorrected);
    return memory || himc_error_set(error, "%s", made->uncorrected.text);
}

static void adopt_regression(himc_performance *p, const prepared_take *made, const char *path)
{
    if (has_own_regression(p)) {
        himc_motion_set_regression(p->motion, &p->settings, &p->motion->regression, false);
        return;
    }
    if (made->uncorrected.text[0])
        himc_events_note(&p->events, "%s: %s: the arms follow the natural posture", path,
                         made->uncorrected.text);
    himc_motion_set_regression(p->motion, &p->settings, made->corrected ? &made->regression : NULL,
                               made->corrected);
}

// if left and right are exchanged in a capture, its drum is behind the player
static bool check_side(const himc_player *player, const himc_head_frame *frame, himc_error *error)
{
    if (!player->placed || player->walks || frame->center.x >= 0)
        return true;
    return himc_error_set(error,
                          "the sticks strike %.2f m behind the player, allowed before: are left "
                          "and right exchanged?",
                          -frame->center.x);
}

static void free_prepared(prepared_take *made)
{
    himc_drum_release(made->drum.fresh);
    himc_track_free(made->track);
    himc_character_free(made->body.character);
}

static bool prepare_take(himc_performance *p, himc_take *take, himc_player *player,
                         prepared_take *made, himc_error *error)
{
    const himc_take_options *options = &p->host.take_options;
    if (!himc_performance_want_drum(p, "", &made->drum, error))
        return false;
    made->frame = made->drum.fresh ? *himc_drum_head_frame(made->drum.fresh)
                                   : *himc_drums_frame(&p->drums, made->drum.index);
    himc_vec3 from = made->frame.center;
    if (!himc_player_sit(player, take, options, &made->frame, error) ||
        !check_side(player, &made->frame, error))
        return false;
    made->track = himc_track_new_played(take, options, &made->frame, player, error);
    return made->track && learn_limits(player, made->track, &made->frame, &made->learned, error) &&
           (is_same_place(made->frame.center, from) ||
            himc_drum_check_place(made->frame.center, error)) &&
           prepare_body(p, player, made, error) && count_strikes(p, take, made, error) &&
           prepare_regression(p, player, take, made, error);
}

static void play_prepared(himc_performance *p, himc_take *take, const himc_player *player,
                          const prepared_take *made, const char *path)
{
    himc_performance_keep_drum(p, &made->drum);
    move_drum(p, made, path);
    adopt_player(p, player, made, path);
    himc_performance_notice_drums(p);
    note_repairs(p, take, path);
    note_reach(p, made->track, path);
    if (made->outside > 0)
        himc_events_note(&p->events, "%s: %d of %d strikes are beside drum %s and silent", path,
                         made->outside, made->strikes,
                         himc_drum_name(p->drums.slot[made->drum.index].drum));
    himc_performance_drop_track(p);
    himc_motion_set_track(p->motion, made->track, player->pose ? &made->learned : NULL,
                          step_time(p));
    himc_performance_renew_limits(p);
    adopt_regression(p, made, path);
}

static bool play_take(himc_performance *p, himc_take *take, himc_player *player, const char *path,
                      himc_error *error)
{
    prepared_take made = {.strikes = 0};
    if (!prepare_take(p, take, player, &made, error)) {
        free_prepared(&made);
        return false;
    }
    play_prepared(p, take, player, &made, path);
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

// plays a take with the body of its player
static bool play_own_player(himc_performance *p, himc_take *take, const char *name,
                            himc_error *error)
{
    himc_player *player =
        himc_player_new(take, &p->host.take_options, &p->settings.skeleton, error);
    bool played = himc_performance_play_player(p, take, player, name, error);
    himc_player_free(player);
    return played;
}

bool himc_performance_load_take(himc_performance *p, const char *path, const char *folder,
                                himc_error *error)
{
    himc_take *take = himc_take_load_in(folder, path, &p->host.take_options, error);
    bool played = take && play_own_player(p, take, path, error);
    himc_take_free(take);
    return played;
}

himc_vec3 himc_performance_take_offset(const himc_performance *p)
{
    return p->motion->track ? himc_track_offset(p->motion->track) : himc_vec3_make(0, 0, 0);
}
