/// trial.c: a trial plays one captured sequence under one controller and compares it with the
/// original.
///
/// A sequence of the motion database is captured as in a laboratory: markers with the noise of a
/// tracker, through a file. It is played by a body with errors: its limbs are not exactly as long
/// as the player's, and its segments do not have exactly the masses that the controller assumes.
/// The body's measures (except for that error), its mean posture and its joint limits come from the
/// noisy take. `id` and `ik` follow the take's joints; `himc` follows its tips alone, with a
/// posture regression learned from the other two players in that nuance as null-space target. The
/// simulated motion is compared with the noiseless sequence.
///
/// Under the `printed` law `himc` is as published: nothing but the joint limits acts in the null
/// space. The servos are the default ones; a player's are a third as fast, `gain` 1/3.
#define _DEFAULT_SOURCE // mkstemps
#include "trial.h"

#include "mocap/parts.h"
#include "himc/performance.h"
#include "himc/mocap.h"
#include "control/posture_regression.h"
#include "control/controller.h"
#include "performance/research.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NOISE 2e-4        // chosen: of each marker coordinate, a good optical tracker (m)
#define MASS_ERROR 0.1    // chosen: of the segments' masses, the accuracy of anthropometric tables
#define LENGTH_ERROR 0.01 // chosen: of the limbs' lengths, 3 mm of a forearm
#define LEAST_FACTOR 0.5  // chosen: no random mass or length is below half of the true one
#define RATE 48000        // sample rate (Hz)
#define BLOCK 64          // Pd's block (samples)
#define SETTLED 0.3       // chosen: not compared after a take's begin and before its end (s)

/// Sums over the frames of a trial while it plays.
typedef struct tally {
    const trial_config *config;
    const himc_mocap *mocap;
    himc_vec3 offset; ///< from the take's coordinates to the library's (m)
    double begin;     ///< time of the take's first frame (s)
    double squares;   ///< squared distances of simulated and captured tips (m^2)
    double outside;   ///< squared distances of tips and targets, outside contact (m^2)
    long outside_count;
    double angle[3]; ///< squared angles of shoulder, elbow, wrist (rad^2)
    long count;
    double low[2][HIMC_HANDS], high[2][HIMC_HANDS]; ///< elbow heights: captured, simulated (m)
    himc_body_state body;                           ///< simulated, at the latest tick
} tally;

himc_word trial_controller_name(himc_pipeline controller)
{
    return himc_command_word(HIMC_COMMAND_MODE, 0, (int)controller);
}

himc_word trial_law_name(const trial_kind *kind)
{
    if (kind->controller == HIMC_PIPELINE_IK)
        return (himc_word){"none"};
    return himc_command_word(HIMC_COMMAND_LAW, 0, (int)kind->law);
}

trial_config trial_default(const trial_kind *kind, int number)
{
    return (trial_config){.kind = *kind,
                          .number = number,
                          .noise = NOISE,
                          .mass_error = MASS_ERROR,
                          .length_error = LENGTH_ERROR,
                          .gain = 1,
                          .pace = 1,
                          .limits = true};
}

himc_mocap_config trial_sequence(const trial_config *config)
{
    himc_mocap_config sequence = himc_mocap_default();
    sequence.player = (config->number - 1) % HIMC_MOCAP_PLAYERS;
    sequence.spot = (himc_spot)((config->number - 1) / HIMC_MOCAP_PLAYERS % TRIAL_SPOTS);
    sequence.nuance = config->kind.nuance;
    sequence.pace = config->pace;
    return sequence;
}

double trial_own_rate(const trial_config *config)
{
    himc_error error;
    himc_mocap_statistics statistics;
    memset(&statistics, 0, sizeof statistics);
    himc_mocap_config sequence = trial_sequence(config);
    himc_mocap *mocap = himc_mocap_new(&sequence, &error);
    if (!mocap)
        return NAN;
    himc_mocap_measure(mocap, &statistics);
    himc_mocap_free(mocap);
    return 1 / himc_mocap_mean(&statistics, HIMC_MOCAP_INTERVAL);
}

static uint64_t seed_of(const trial_config *config)
{
    return (uint64_t)config->kind.nuance << 32 | (uint64_t)config->number;
}

/// A noiseless sequence and the poses of all its frames. The caller frees `mocap` and `take->pose`.
static bool make_sequence(const himc_mocap_config *config, himc_posture_regression_take *take,
                          himc_mocap **mocap, himc_error *error)
{
    *mocap = himc_mocap_new(config, error);
    if (!*mocap)
        return false;
    int frames = himc_mocap_frames(*mocap);
    himc_pose *pose = malloc((size_t)frames * sizeof *pose);
    *take = (himc_posture_regression_take){.skeleton = himc_mocap_skeleton(*mocap),
                                           .pose = pose,
                                           .frames = frames,
                                           .rate = HIMC_MOCAP_RATE};
    for (int frame = 0; pose && frame < frames; frame++)
        pose[frame] = himc_mocap_pose(*mocap, frame / HIMC_MOCAP_RATE);
    return pose || himc_error_set(error, "out of memory");
}

/// Learns a posture regression from the other players in this nuance, all spots.
static bool learn_from_others(himc_mocap_config config, himc_posture_regression *regression,
                              himc_error *error)
{
    enum { TAKES = (HIMC_MOCAP_PLAYERS - 1) * TRIAL_SPOTS };
    himc_posture_regression_take take[TAKES] = {{0}};
    himc_mocap *mocap[TAKES] = {NULL};
    int unseen = config.player, count = 0;
    config.pace = 1; // learned from the original sequences, whatever the trial's pace
    bool good = true;
    for (config.player = 0; config.player < HIMC_MOCAP_PLAYERS; config.player++)
        for (int spot = 0; good && config.player != unseen && spot < TRIAL_SPOTS; spot++, count++) {
            config.spot = (himc_spot)spot;
            good = make_sequence(&config, &take[count], &mocap[count], error);
        }
    good = good && himc_posture_regression_learn(regression, take, TAKES, error);
    for (int i = 0; i < TAKES; i++) {
        free((void *)(uintptr_t)take[i].pose);
        himc_mocap_free(mocap[i]);
    }
    return good;
}

/// The regression for a player and nuance, learned once in each process; NULL with the reason.
static const himc_posture_regression *regression_without(const himc_mocap_config *config,
                                                         himc_error *error)
{
    static himc_posture_regression regression[HIMC_MOCAP_PLAYERS][HIMC_NUANCES];
    static bool known[HIMC_MOCAP_PLAYERS][HIMC_NUANCES];
    himc_posture_regression *learned = &regression[config->player][config->nuance];
    bool *k = &known[config->player][config->nuance];
    if (!*k)
        *k = learn_from_others(*config, learned, error);
    return *k ? learned : NULL;
}

/// The sequence as captured, with noise, through a file like a laboratory's.
static himc_take *capture(const trial_config *config, const himc_mocap *mocap, himc_error *error)
{
    char path[] = "/tmp/himc-trial-XXXXXX.c3d";
    int file = mkstemps(path, 4);
    if (file < 0) {
        himc_error_set(error, "%s: cannot be made: %s", path, strerror(errno));
        return NULL;
    }
    close(file);
    himc_take *take =
        himc_mocap_write(mocap, path, error) ? himc_take_load(path, NULL, error) : NULL;
    unlink(path);
    if (take)
        himc_take_add_noise(take, config->noise, seed_of(config));
    return take;
}

static bool do_command(himc_performance *p, himc_error *error, const char *text)
{
    himc_command c;
    return himc_command_parse_text(&c, HIMC_PERFORMER, text, error) &&
           himc_performance_command(p, &c, 0, error);
}

static bool use_regression(himc_performance *p, const himc_player *seen, double rate,
                           const himc_mocap_config *config, himc_error *error)
{
    const himc_posture_regression *learned = regression_without(config, error);
    himc_skeleton skeleton;
    if (!learned || !himc_skeleton_init(&skeleton, &seen->config, error))
        return false;
    himc_posture_regression regression = *learned;
    himc_posture_regression_take one = {
        .skeleton = &skeleton, .pose = seen->pose, .frames = seen->frames, .rate = rate};
    if (!himc_posture_regression_fit(&regression.player, &one, 1, error))
        return false;
    himc_performance_set_posture_regression(p, &regression);
    return true;
}

static double near_one(mocap_random *random, double deviation)
{
    return fmax(1 + deviation * himc_mocap_normal(random), LEAST_FACTOR);
}

static bool make_plant(himc_performance *p, const trial_config *config, himc_error *error)
{
    double factor[HIMC_SEGMENTS];
    mocap_random random = himc_mocap_random(seed_of(config), NULL, 0);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        factor[i] = near_one(&random, config->mass_error);
    return himc_performance_set_weights(p, factor, error);
}

/// Multiplies the limbs' lengths by random errors; the sticks' length is known exactly.
static void add_length_errors(himc_skeleton_config *body, const trial_config *config)
{
    int stream = 1; // independent of the masses' random numbers
    mocap_random random = himc_mocap_random(seed_of(config), &stream, 1);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        if (i != HIMC_LEFT_STICK && i != HIMC_RIGHT_STICK)
            body->length[i] *= near_one(&random, config->length_error);
}

bool trial_set_control(himc_performance *p, const trial_config *config, himc_error *error)
{
    const trial_kind *kind = &config->kind;
    char text[64];
    bool published = kind->law == HIMC_LAW_PRINTED && kind->controller == HIMC_PIPELINE_HIMC;
    bool joints = kind->controller == HIMC_PIPELINE_ID && !config->bent;
    snprintf(text, sizeof text, "mode %s", trial_controller_name(kind->controller).text);
    if (!do_command(p, error, text) || (published && !do_command(p, error, "posture 0")) ||
        (joints && !do_command(p, error, "bend 0")) ||
        (config->limits && !do_command(p, error, "limits ellipsoid")))
        return false;
    snprintf(text, sizeof text, "gain frequency %.6f", config->gain);
    if (config->gain != 1 && !do_command(p, error, text))
        return false;
    snprintf(text, sizeof text, "law %s", trial_law_name(kind).text);
    return kind->controller == HIMC_PIPELINE_IK || do_command(p, error, text);
}

static bool play_as(himc_performance *p, const trial_config *config, himc_take *take,
                    himc_player *player, himc_error *error)
{
    himc_mocap_config sequence = trial_sequence(config);
    add_length_errors(&player->config, config);
    return himc_performance_play_player(p, take, player, "take", error) &&
           make_plant(p, config, error) && trial_set_control(p, config, error) &&
           (config->kind.controller != HIMC_PIPELINE_HIMC ||
            use_regression(p, player, himc_take_rate(take), &sequence, error)) &&
           do_command(p, error, "play");
}

/// The head of the 2012 paper, an ideal membrane: 23 inches of Christian et al.'s Mylar (1984) at
/// 3700 N/m, and its felt. At a point of 200 modes a 45 g mallet meets 65 N at 3.7 m/s and 108 N at
/// 6 m/s, the paper's 62 .. 65 and 106.9 N.
static himc_drum *published_drum(himc_error *error)
{
    static const char *const setting[] = {"air 0", "decay 2.2 3e-7", "tension 3700", "uniformity 1",
                                          "mallet 1.6e8 2.54 0.03"};
    himc_drum *drum = himc_drum_new("kettle", 23, RATE, error);
    himc_command command;
    bool good = drum;
    for (int i = 0; good && i < 5; i++)
        good = himc_command_parse_text(&command, HIMC_DRUM, setting[i], error) &&
               himc_drum_command(drum, &command, error);
    if (good)
        return drum;
    himc_drum_release(drum);
    return NULL;
}

static himc_performance *prepare(const trial_config *config, himc_take *take, himc_error *error)
{
    himc_skeleton_config given = himc_skeleton_default();
    himc_performance_config rates = himc_performance_default();
    rates.sample_rate = RATE;
    himc_performance *p = himc_performance_new(&rates, error);
    himc_drum *drum = p ? published_drum(error) : NULL;
    himc_player *player = drum ? himc_player_new(take, NULL, &given, error) : NULL;
    bool good = player && himc_performance_add_drum(p, drum, error) &&
                play_as(p, config, take, player, error);
    himc_player_free(player);
    himc_drum_release(drum);
    if (good)
        return p;
    himc_performance_free(p);
    return NULL;
}

static void extend_range(tally *t, int which, himc_hand hand, double z)
{
    t->low[which][hand] = fmin(t->low[which][hand], z);
    t->high[which][hand] = fmax(t->high[which][hand], z);
}

static void compare_hand(tally *t, const himc_motion_row *row, const himc_body_state *captured,
                         himc_hand hand)
{
    himc_vec3 miss = himc_vec3_sub(row->tip[hand], captured->tip[hand]);
    int elbow = himc_arm_joint(hand, 1) + 1;
    t->squares += himc_vec3_dot(miss, miss);
    t->count++;
    if (row->force[hand] == 0) {
        himc_vec3 away = himc_vec3_sub(row->tip[hand], row->target[hand]);
        t->outside += himc_vec3_dot(away, away);
        t->outside_count++;
    }
    extend_range(t, 0, hand, captured->origin[elbow].z);
    extend_range(t, 1, hand, row->elbow[hand].z);
}

static void compare_joints(tally *t, const himc_motion_row *row, const himc_pose *captured,
                           himc_hand hand)
{
    for (int k = 0; k < 3; k++) {
        int j = himc_arm_joint(hand, k);
        himc_quat q = himc_quat_exp(row->joint[j]);
        double angle =
            himc_vec3_length(himc_quat_log(himc_quat_mul(himc_quat_conj(captured->joint[j]), q)));
        t->angle[k] += angle * angle;
    }
}

static void keep_body(void *user, const himc_tick *tick)
{
    ((tally *)user)->body = *tick->body;
}

static void compare(void *user, const himc_motion_row *row)
{
    tally *t = user;
    double time = row->time - t->begin;
    if (time < SETTLED || time > himc_mocap_length(t->mocap) - SETTLED)
        return;
    himc_pose pose = himc_mocap_pose(t->mocap, time);
    himc_body_state captured;
    himc_skeleton skeleton = *himc_mocap_skeleton(t->mocap);
    skeleton.segment[HIMC_PELVIS].origin =
        himc_vec3_add(skeleton.segment[HIMC_PELVIS].origin, t->offset);
    himc_pose_to_state(&skeleton, &pose, NULL, &captured);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        compare_hand(t, row, &captured, (himc_hand)hand);
        compare_joints(t, row, &pose, (himc_hand)hand);
    }
    trial_frame frame = {time, &skeleton, &pose, &captured, row, &t->body};
    if (t->config->frame)
        t->config->frame(t->config->user, &frame);
}

static void play(himc_performance *p)
{
    himc_event event = {.kind = HIMC_EVENT_BEAT};
    while (event.kind != HIMC_EVENT_DONE) {
        himc_performance_process(p, BLOCK, NULL);
        while (event.kind != HIMC_EVENT_DONE && himc_performance_event(p, &event)) {
        }
    }
}

static double mean_height(const himc_mocap *mocap)
{
    himc_mocap_statistics statistics;
    memset(&statistics, 0, sizeof statistics);
    himc_mocap_measure(mocap, &statistics);
    return himc_mocap_mean(&statistics, HIMC_MOCAP_TIP_HEIGHT);
}

static trial_result result_of(const tally *t, const himc_performance_stats *stats)
{
    double n = (double)t->count, captured = 0, simulated = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        captured += t->high[0][hand] - t->low[0][hand];
        simulated += t->high[1][hand] - t->low[1][hand];
    }
    return (trial_result){.rms = sqrt(t->squares / n),
                          .outside = sqrt(t->outside / (double)t->outside_count),
                          .amplitude = mean_height(t->mocap),
                          .elbow = simulated / captured,
                          .shoulder_error = sqrt(t->angle[0] / n),
                          .elbow_error = sqrt(t->angle[1] / n),
                          .wrist_error = sqrt(t->angle[2] / n),
                          .strokes = himc_mocap_touches(t->mocap),
                          .played = stats->played};
}

static bool run_sequence(const trial_config *config, himc_mocap *mocap, trial_result *result,
                         himc_error *error)
{
    himc_take *take = capture(config, mocap, error);
    himc_performance *p = take ? prepare(config, take, error) : NULL;
    himc_take_free(take);
    if (!p)
        return false;
    tally t = {.config = config,
               .mocap = mocap,
               .begin = HIMC_APPROACH,
               .offset = himc_performance_take_offset(p)};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int which = 0; which < 2; which++) {
            t.low[which][hand] = INFINITY;
            t.high[which][hand] = -INFINITY;
        }
    himc_performance_on_tick(p, keep_body, &t);
    himc_performance_on_motion(p, compare, &t);
    play(p);
    himc_performance_stats stats = himc_performance_measure(p);
    himc_performance_free(p);
    *result = result_of(&t, &stats);
    return true;
}

bool trial_run(const trial_config *config, trial_result *result, himc_error *error)
{
    himc_mocap_config sequence = trial_sequence(config);
    himc_mocap *mocap = himc_mocap_new(&sequence, error);
    bool good = mocap && run_sequence(config, mocap, result, error);
    himc_mocap_free(mocap);
    return good ||
           himc_error_prefix(error, "%s %s %s, trial %d", himc_nuance_name(config->kind.nuance),
                             trial_controller_name(config->kind.controller).text,
                             trial_law_name(&config->kind).text, config->number);
}
