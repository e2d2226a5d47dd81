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
/// It is a job (base/job.h): the file is read, the player measured and the track made aside; what
/// is installed is a track, limits, settings and a body of 20 segments. All that can fail comes
/// before anything changes.
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

typedef struct take_job {
    himc_job job;
    himc_performance *performance; ///< borrowed
    himc_command command;
    const char *name; ///< begins notes and errors: of the file
    bool given;       ///< take and player are borrowed
    bool again;       ///< of the loaded take: the drum counts as not moved by it
    // of the performance, when the job was made
    himc_take_options options;
    performance_settings settings;
    himc_posture posture;
    double sample_rate;    ///< (Hz)
    bool has_drum;         ///< else a silent one is made
    bool own_regression;   ///< another one than a take's has been set
    himc_head_frame place; ///< of the drum
    // made from the take
    himc_drum *drum; ///< owned; to be added, NULL if there is one
    himc_take *take;
    himc_player *player;
    himc_track *track;     ///< after `install` the one that it has replaced
    himc_head_frame frame; ///< the drum under the strikes
    himc_limits learned;
    himc_take_tip tips[HIMC_HANDS];
    int placed, far;      ///< tips that were looked at, and those out of reach ...
    double farthest;      ///< ... by so much at most (m)
    int strikes, outside; ///< of the take, and those beside the drum
    double fastest, seen; ///< of the strikes, as found and between frames of the take (m/s)
    int left_out;         ///< motions as sharp as strikes, but off the head
    himc_posture_regression regression;
    bool fitted;
    himc_error unfitted; ///< why not; "" if no arm is shown
    int tries;
} take_job;

static bool same_place(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b)) < SAME_PLACE;
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

bool himc_performance_learn_limits(const himc_pose *pose, int frames, himc_limits *learned,
                                   himc_error *error)
{
    if (!himc_limits_learn(learned, pose, frames, LIMIT_MARGIN, error))
        return false;
    himc_limits_loosen(learned, LEAST_LIMIT);
    return true;
}

// The limits of the take's player, the sticks striking a head at that place. Those of arms without
// sticks are learned again, from the postures for the tips.
static bool learn_limits(const himc_player *player, const himc_track *track,
                         const himc_head_frame *place, himc_limits *learned, himc_error *error)
{
    himc_skeleton skeleton;
    himc_posture posture;
    himc_limits bent;
    bool lacks[HIMC_HANDS];
    if (!player->pose)
        return true;
    if (!himc_performance_learn_limits(player->pose, player->frames, learned, error) ||
        !himc_skeleton_init(&skeleton, &player->config, error))
        return false;
    himc_posture_init(&posture, &skeleton, place->center.z + skeleton.mallet_radius);
    posture.trunk_posture = mean_trunk(player);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int known = himc_player_known_arm(player, (himc_hand)hand);
        lacks[hand] =
            himc_track_present(track, (himc_hand)hand) && known > 0 && known < HIMC_ARM_JOINTS;
    }
    if (!lacks[HIMC_LEFT] && !lacks[HIMC_RIGHT])
        return true;
    himc_pose *pose = malloc(2 * POSTURES_SEEN * sizeof *pose);
    if (!pose)
        return himc_error_set(error, "limits: out of memory");
    for (int i = 0; i < POSTURES_SEEN;
         i++) { // the natural one, and the captured one bent to the tips
        himc_posture_motion motion;
        himc_target tip[HIMC_HANDS];
        double t = himc_track_length(track) * i / POSTURES_SEEN;
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            int seen = himc_track_present(track, (himc_hand)hand) ? hand : !hand;
            tip[hand] = himc_track_target(track, (himc_hand)seen, t);
        }
        himc_posture_moving(&posture, tip, &motion);
        memcpy(pose[2 * i].joint, motion.joint, sizeof motion.joint);
        himc_track_posture(track, &skeleton, t, tip, &motion);
        memcpy(pose[2 * i + 1].joint, motion.joint, sizeof motion.joint);
    }
    bool fitted = himc_performance_learn_limits(pose, 2 * POSTURES_SEEN, &bent, error);
    free(pose);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; fitted && lacks[hand] && k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint((himc_hand)hand, k);
            if (player->known[j])
                learned->joint[j] = bent.joint[j];
        }
    return fitted;
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

// counts the strikes of a take, those beside the drum as it will stand, and the part of the take
// out of reach, where the arm stretches towards the tips
static bool survey(take_job *j, const himc_posture *posture, himc_error *error)
{
    if (!himc_take_tips(j->take, &j->options, j->tips, error))
        return false;
    himc_strike_survey s;
    if (!himc_take_strikes(j->take, j->tips, &s))
        return himc_error_set(error, "out of memory");
    j->strikes = s.count;
    j->left_out = s.left_out;
    j->outside = j->placed = j->far = 0;
    j->fastest = j->seen = j->farthest = 0;
    for (int i = 0; i < s.count; i++) {
        himc_vec3 at = himc_vec3_add(s.strikes[i].x, himc_track_offset(j->track));
        himc_vec3 local = himc_head_frame_from_world(&j->frame, at);
        j->outside += !himc_head_frame_contains(&j->frame, local.x, local.y);
        j->fastest = fmax(j->fastest, s.strikes[i].velocity);
        j->seen = fmax(j->seen,
                       himc_take_fastest_fall(j->take, &j->tips[s.strikes[i].hand], &s.strikes[i]));
    }
    free(s.strikes);
    double length = himc_track_length(j->track);
    for (double t = 0; t < length; t += REACH_CHECK_STEP)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            if (!himc_track_present(j->track, (himc_hand)hand))
                continue;
            himc_vec3 x = himc_track_target(j->track, (himc_hand)hand, t).x;
            himc_vec3 near = himc_posture_reachable(posture, (himc_hand)hand, x);
            double missing = himc_vec3_length(himc_vec3_sub(x, near));
            j->placed++;
            j->far += missing > OUT_OF_REACH;
            j->farthest = fmax(j->farthest, missing);
        }
    return true;
}

// an arm, its hand and stick included
static bool shows_arm(const himc_player *player, himc_hand hand)
{
    return player->pose && !player->walks && himc_player_known_arm(player, hand) == HIMC_ARM_JOINTS;
}

// the default regression, corrected by this take; false without memory
static bool fit_regression(take_job *j, const himc_skeleton *skeleton, himc_error *error)
{
    bool memory = true;
    const himc_player *player = j->player;
    himc_posture_regression_take seen = {
        .skeleton = skeleton,
        .pose = player->pose,
        .frames = player->frames,
        .rate = himc_take_rate(j->take),
        .unseen_arm = {!shows_arm(player, HIMC_LEFT), !shows_arm(player, HIMC_RIGHT)},
        .unseen_trunk = !player->known[HIMC_TRUNK - 1]};
    j->fitted = false;
    j->unfitted.text[0] = 0;
    if (j->own_regression || (seen.unseen_arm[HIMC_LEFT] && seen.unseen_arm[HIMC_RIGHT]))
        return true;
    himc_posture_regression_default(&j->regression);
    j->fitted = himc_posture_regression_correct(&j->regression, &seen, &memory, &j->unfitted);
    return memory || himc_error_set(error, "%s", j->unfitted.text);
}

// all that is made from take and player
static bool make_track(take_job *j, himc_error *error)
{
    himc_skeleton skeleton;
    himc_player *player = j->player;
    himc_drum_release(j->drum);
    j->drum = NULL;
    if (!j->has_drum) {
        j->drum = himc_drum_new(FIRST_DRUM, HIMC_INCHES_USUAL, j->sample_rate, error);
        if (!j->drum)
            return false;
        j->place = *himc_drum_head_frame(j->drum);
    }
    j->frame = j->place;
    if (!himc_player_sit(player, j->take, &j->options, &j->frame, error))
        return false;
    // if left and right are exchanged in a capture, its drum is behind the player
    if (player->placed && !player->walks && j->frame.center.x < 0)
        return himc_error_set(error,
                              "the sticks strike %.2f m behind the player, expected in front: are "
                              "left and right exchanged?",
                              -j->frame.center.x);
    himc_track_free(j->track);
    j->track = himc_track_new(j->take, &j->options, &j->frame, player, player->config.mallet_radius,
                              error);
    bool moves = !same_place(j->frame.center, j->place.center);
    if (!j->track || !learn_limits(player, j->track, &j->frame, &j->learned, error) ||
        (moves && !himc_drum_check_place(j->frame.center, error)) ||
        !himc_skeleton_init(&skeleton,
                            player->lengths > 0 ? &player->config : &j->settings.skeleton, error))
        return false;
    // the natural posture of the player before the drum
    captured_player captured = captured_of(player);
    himc_posture posture = j->posture;
    if (player->lengths > 0)
        himc_motion_init_posture(&posture, &skeleton, &captured, posture.level, j->settings.stance);
    if (moves)
        posture.level = j->frame.center.z + skeleton.mallet_radius;
    return survey(j, &posture, error) && fit_regression(j, &skeleton, error);
}

static bool prepare(himc_job *job, himc_error *error)
{
    take_job *j = (take_job *)job;
    if (!j->given) {
        himc_player_free(j->player); // it sits before another place
        j->player = NULL;
        if (!j->take && !himc_take_is_capture(j->name))
            return himc_error_set(error,
                                  "take: %s: not a take by its suffix, expected" HIMC_TAKE_SUFFIXES
                                  "; a score, MIDI or MusicXML is loaded by score",
                                  j->name);
        if (!j->take)
            j->take = himc_take_load_in(j->command.folder, j->name, &j->options, error);
        if (!j->take)
            return false;
        j->player = himc_player_new(j->take, &j->options, &j->settings.skeleton, error);
        if (j->player && j->settings.asked_height > 0) { // by `player`, not those measured
            j->player->config.height = j->settings.asked_height;
            j->player->config.mass = j->settings.asked_mass;
        }
    }
    return (j->player && make_track(j, error)) || himc_take_name_error(j->name, error);
}

// moves the drum under the take's strikes, or lowers a drum that is in the way
static void move_drum(const take_job *j)
{
    himc_performance *p = j->performance;
    himc_vec3 to = j->frame.center;
    bool strikes =
        himc_track_strikes(j->track, HIMC_LEFT) + himc_track_strikes(j->track, HIMC_RIGHT) > 0;
    if (same_place(to, himc_drums_frame(&p->drums, 0)->center) ||
        !himc_drums_move(&p->drums, 0, to, NULL))
        return;
    himc_events_note(&p->events, "%s: the %s is moved to %.3f %.3f %.3f, %s", j->name,
                     himc_drum_name(p->drums.slot[0].drum), to.x, to.y, to.z,
                     strikes ? "under the take's strikes" : "out of the take's way");
}

// notes on the repairs made while reading the take, and on the parts that cannot be played
static void note_repairs(const take_job *j)
{
    himc_performance *p = j->performance;
    for (int i = 0; i < j->take->note_count; i++)
        himc_events_note(&p->events, "%s: %s", j->name, j->take->notes[i]);
    for (int i = 0; i < j->player->note_count; i++)
        himc_events_note(&p->events, "%s: %s", j->name, j->player->notes[i]);
    if (j->strikes == 0)
        himc_events_note(
            &p->events,
            "%s: silent: no tip falls onto a head (%s; if another axis is up, say --up)", j->name,
            j->take->axes_text);
    if (j->fastest > HIMC_TAKE_CARRIED_ON * j->seen)
        himc_events_note(&p->events,
                         "%s: strikes up to %.2f m/s, extrapolated from falls up to %.2f in the "
                         "take",
                         j->name, j->fastest, j->seen);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (j->tips[hand].present && j->tips[hand].filled > 0)
            himc_events_note(&p->events, "%s: %s is missing in %d frames, which are filled",
                             j->name, j->tips[hand].name, j->tips[hand].filled);
    if (j->far > 0)
        himc_events_note(&p->events,
                         "%s: tips out of reach in %.0f %% of the take, by up to %.2f m", j->name,
                         100.0 * j->far / j->placed, j->farthest);
    if (j->left_out > 0)
        himc_events_note(&p->events, "%s: %d motions as sharp as strikes end off the head", j->name,
                         j->left_out);
    if (j->outside > 0)
        himc_events_note(&p->events, "%s: %d of %d strikes are beside drum %s and silent", j->name,
                         j->outside, j->strikes, himc_drum_name(p->drums.slot[0].drum));
}

static bool has_own_regression(const himc_performance *p)
{
    return p->motion->has_regression && !p->motion->regression_of_take;
}

// the drum before the take
static himc_head_frame drum_place(const take_job *j)
{
    const performance_drums *drums = &j->performance->drums;
    return j->again ? himc_drums_found(drums, 0) : *himc_drums_frame(drums, 0);
}

static void copy_performance(take_job *j)
{
    const himc_performance *p = j->performance;
    j->options = p->host.take_options;
    j->settings = p->settings;
    j->posture = p->motion->body.posture;
    j->sample_rate = p->clock.sample_rate;
    j->own_regression = has_own_regression(p);
    j->has_drum = p->drums.count > 0;
    if (j->has_drum)
        j->place = drum_place(j);
}

static himc_job_state install(himc_job *job, himc_error *error)
{
    take_job *j = (take_job *)job;
    himc_performance *p = j->performance;
    body_parts parts = {.character = NULL};
    performance_settings s = p->settings;
    int first;
    bool measured = j->player->lengths > 0;
    himc_head_frame now = p->drums.count > 0 ? drum_place(j) : j->place;
    // the drum should be that for which the track was made
    bool same = j->has_drum == (p->drums.count > 0) &&
                (j->has_drum ? himc_head_frame_equal(&now, &j->place)
                             : j->sample_rate == p->clock.sample_rate);
    if (!same && (++j->tries < HIMC_JOB_TRIES || !j->has_drum || p->drums.count == 0)) {
        copy_performance(j);
        return HIMC_JOB_AGAIN;
    }
    // the settings with the body of the take's player, if the take shows one
    memset(s.captured.known, 0, sizeof s.captured.known);
    if (measured) {
        s.skeleton = j->player->config;
        s.skeleton.seat = himc_skeleton_seat(&s.skeleton); // as captured, whatever the drum
        s.captured = captured_of(j->player);
    }
    // in this thread: the engine keeps data for each
    if (measured && !himc_body_make_parts(&parts, &s, error)) {
        himc_take_name_error(j->name, error);
        return HIMC_JOB_FAILED;
    }
    if (j->drum)
        himc_performance_adopt_drum(p, j->drum, DRUM_SILENT, &first, NULL);
    j->drum = NULL;
    move_drum(j);
    if (measured) {
        himc_performance_embody(p, &s, &parts);
        himc_events_note(&p->events,
                         "%s: the player's body: %d lengths from the take, %.2f m, %.0f kg",
                         j->name, j->player->lengths, s.skeleton.height, s.skeleton.mass);
    } else {
        himc_performance_adopt(p, &s);
    }
    himc_performance_notice_drums(p);
    note_repairs(j);
    himc_track *dropped = himc_performance_drop_track(p);
    himc_motion_set_track(p->motion, j->track, j->player->pose ? &j->learned : NULL, step_time(p));
    j->track = dropped;
    himc_body_plan_pushes(p->body, NULL, 0, PUSHES_ANEW, NULL);
    snprintf(p->written.take, sizeof p->written.take, "%s", j->name);
    himc_command_copy(&p->written.take_command, &j->command);
    himc_performance_renew_limits(p);
    // the take's regression, unless another has been set
    bool own = has_own_regression(p), fitted = !own && j->fitted;
    if (!own && j->unfitted.text[0])
        himc_events_note(&p->events, "%s: %s: the arms follow the natural posture", j->name,
                         j->unfitted.text);
    const himc_posture_regression *regression = own ? &p->motion->regression : &j->regression;
    himc_motion_set_regression(p->motion, &p->settings, own || fitted ? regression : NULL, fitted);
    return HIMC_JOB_DONE;
}

static void free_job(himc_job *job)
{
    take_job *j = (take_job *)job;
    himc_drum_release(j->drum);
    himc_track_free(j->track);
    if (!j->given) {
        himc_player_free(j->player);
        himc_take_free(j->take);
    }
    free(j);
}

// of the file that the command names; else `name` begins errors
static take_job *job_of(himc_performance *p, const himc_command *command, const char *name,
                        bool again, himc_error *error)
{
    take_job *j = himc_job_new(sizeof *j, "take", (himc_job){prepare, install, free_job}, error);
    if (!j)
        return NULL;
    j->performance = p;
    if (command)
        himc_command_copy(&j->command, command);
    j->name = command ? j->command.atom[0].symbol : name;
    j->again = again;
    copy_performance(j);
    return j;
}

himc_job *himc_performance_take_job(himc_performance *p, const himc_command *command,
                                    himc_error *error)
{
    return (himc_job *)job_of(p, command, "take", false, error);
}

himc_job *himc_performance_take_again_job(himc_performance *p, himc_error *error)
{
    return (himc_job *)job_of(p, &p->written.take_command, NULL, true, error);
}

bool himc_performance_try_take(himc_job *job, const himc_command *command,
                               const himc_head_frame *place, himc_error *error)
{
    take_job *j = (take_job *)job;
    himc_command_copy(&j->command, command);
    j->name = j->command.atom[0].symbol;
    himc_take_free(j->take);
    j->take = NULL;
    j->own_regression = true; // a fit does not refuse a take
    j->has_drum = place;
    if (place)
        j->place = *place;
    return prepare(job, error);
}

bool himc_performance_play_player(himc_performance *p, himc_take *take, himc_player *player,
                                  const char *name, himc_error *error)
{
    take_job *j = player ? job_of(p, NULL, name, false, error) : NULL;
    if (!j)
        return false;
    j->given = true;
    j->take = take;
    j->player = player;
    return himc_job_carry_out(&j->job, error);
}

himc_vec3 himc_performance_take_offset(const himc_performance *p)
{
    return p->motion->track ? himc_track_offset(p->motion->track) : himc_vec3_make(0, 0, 0);
}

bool himc_performance_nudge(himc_track *track, const himc_command *c, himc_error *error)
{
    himc_nudge nudge = {.hand = (himc_hand)c->choice[0],
                        .time = c->atom[1].number,
                        .span = c->atom[2].number,
                        .way = {c->atom[3].number, c->atom[4].number, c->atom[5].number}};
    return track ? himc_track_nudge(track, &nudge, error)
                 : himc_error_set(error, "nudge: no take is loaded");
}

bool himc_performance_try_nudge(himc_job *job, const himc_command *command, himc_error *error)
{
    return himc_performance_nudge(((take_job *)job)->track, command, error);
}
