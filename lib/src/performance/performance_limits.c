/// performance_limits.c: the commands `limits` and `strength`, and what is told of them.
///
/// Limits are those learned from the take that is loaded; else table 1 of the 2012 paper around the
/// mean of the postures that strokes of all heights have where the tips are planned to be just
/// then, from the first drum's height up. They are made anew when a drum is moved or the body
/// changes, in the audio callback too. An arm that a take shows without a stick was held otherwise
/// than one with a stick is: its limits are of the postures that its tips ask for, in `himc` and,
/// bent from the captured ones, in `id`. They are off until asked for: the table is of a player and
/// a drum of its own, and a piece need not keep to it.
#include "performance/performance_state.h"

#include "body/limits.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MARGIN 0.05         // beyond what a take shows ...
#define LEAST 0.05          // ... and this far whatever it shows (rad)
#define HIGHEST_STROKE 0.35 // tips in the mean posture go from the first head up to here (m)
#define HEIGHTS 8
#define LOOKED_AT 1000 // frames of a take, at most

// the mean of a stroke's postures, tips above and below where they are planned to be now
static himc_pose natural_mean(const himc_performance *p)
{
    himc_pose pose[HEIGHTS];
    for (int i = 0; i < HEIGHTS; i++) {
        himc_vec3 tip[HIMC_HANDS];
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            tip[hand] = himc_performance_planned(p, (himc_hand)hand, step_time(p)).x;
            tip[hand].z = p->posture.level + HIGHEST_STROKE * i / (HEIGHTS - 1);
        }
        himc_posture_at(&p->posture, tip, &pose[i]);
    }
    return himc_limits_mean(pose, HEIGHTS);
}

void himc_performance_renew_limits(himc_performance *p)
{
    himc_limits_kind kind = p->limits.kind;
    p->controller.saturation = &p->saturation;
    p->controller.limits = kind == HIMC_LIMITS_OFF ? NULL : &p->limits;
    if (kind == HIMC_LIMITS_OFF)
        return;
    himc_pose mean = natural_mean(p);
    p->limits = p->has_learned ? p->learned : himc_limits_table_1(&mean);
    p->limits.kind = kind;
}

bool himc_performance_learn_limits(const himc_player *player, himc_limits *learned,
                                   himc_error *error)
{
    if (!himc_limits_learn(learned, player->pose, player->frames, MARGIN, error))
        return false;
    himc_limits_loosen(learned, LEAST);
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

bool himc_performance_learn_bent(const himc_player *player, const himc_track *track,
                                 const himc_posture *posture, himc_limits *learned,
                                 himc_error *error)
{
    bool lacks[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        lacks[hand] = lacks_stick(player, track, (himc_hand)hand);
    if (!lacks[HIMC_LEFT] && !lacks[HIMC_RIGHT])
        return true;
    himc_limits bent;
    himc_pose *pose = malloc(2 * LOOKED_AT * sizeof *pose);
    for (int i = 0; pose && i < LOOKED_AT; i++)
        postures_at(posture, track, himc_track_length(track) * i / LOOKED_AT, &pose[2 * i]);
    if (!pose)
        himc_error_set(error, "limits: out of memory");
    bool fitted = pose && himc_limits_learn(&bent, pose, 2 * LOOKED_AT, MARGIN, error);
    free(pose);
    if (!fitted)
        return false;
    himc_limits_loosen(&bent, LEAST);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; lacks[hand] && k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint((himc_hand)hand, k);
            if (player->known[j])
                learned->joint[j] = bent.joint[j];
        }
    return true;
}

// in the order of the words of `strength`
enum { STRENGTH_HUMAN, STRENGTH_OFF };

// what has been counted was of other limits
static void forget_hits(himc_performance *p)
{
    memset(p->saturation.held, 0, sizeof p->saturation.held);
    memset(p->saturation.hits, 0, sizeof p->saturation.hits);
    memset(p->saturation.farthest, 0, sizeof p->saturation.farthest);
}

bool himc_performance_do_limits(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->limits.kind = (himc_limits_kind)c->choice[0];
    himc_performance_renew_limits(p);
    forget_hits(p);
    return true;
}

bool himc_performance_find_joint(const himc_command *c, const char *command, int *joint,
                                 himc_error *error)
{
    *joint = himc_joint_find(c->atom[0].symbol);
    if (*joint >= 0)
        return true;
    himc_error_set(error, "%s: JOINT: %s, allowed", command, c->atom[0].symbol);
    size_t used = error ? strlen(error->text) : 0;
    for (int j = 0; error && j < HIMC_JOINTS; j++)
        used += (size_t)snprintf(error->text + used, sizeof error->text - used, " %s",
                                 himc_joint_name(j));
    return false;
}

bool himc_performance_do_strength(himc_performance *p, const himc_command *c, himc_error *error)
{
    enum { ALL, ONE };
    int joint;
    if (c->form == ONE) {
        if (!himc_performance_find_joint(c, "strength", &joint, error))
            return false;
        p->controller.strength[joint] = c->atom[1].number;
        return true;
    }
    p->human = c->choice[0] == STRENGTH_HUMAN;
    memset(p->controller.strength, 0, sizeof p->controller.strength);
    if (p->human)
        himc_controller_set_human_strength(&p->controller, p->body.mass);
    return true;
}

void himc_performance_keep_strength(himc_performance *p, const himc_controller *old)
{
    memcpy(p->controller.strength, old->strength, sizeof old->strength);
    if (p->human)
        himc_controller_set_human_strength(&p->controller, p->body.mass);
}

void himc_performance_clamp_kinematic_pose(himc_performance *p, himc_pose *pose,
                                           himc_vec3 rate[HIMC_JOINTS])
{
    for (int j = 0; p->controller.limits && j < HIMC_JOINTS; j++) {
        himc_quat near = himc_limit_closest(&p->limits, j, pose->joint[j]);
        double measure = himc_limit_measure(&p->limits, j, pose->joint[j]);
        himc_quat off = himc_quat_mul(himc_quat_conj(near), pose->joint[j]);
        p->saturation.measure[j] = measure;
        if (measure <= 1) {
            p->saturation.held[j] = false;
            continue;
        }
        p->saturation.hits[j] += !p->saturation.held[j];
        p->saturation.held[j] = true;
        p->saturation.farthest[j] =
            fmax(p->saturation.farthest[j], himc_vec3_length(himc_quat_log(off)));
        pose->joint[j] = near;
        rate[j] = himc_vec3_make(0, 0, 0);
    }
}

long himc_performance_limit_hits(const himc_performance *p)
{
    long hits = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        hits += p->saturation.hits[j];
    return hits;
}

static void describe_strength(const himc_performance *p, void (*line)(void *, const char *),
                              void *user)
{
    char text[256];
    const himc_saturation_counts *s = &p->saturation;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (s->weak[j] == 0)
            continue;
        snprintf(text, sizeof text,
                 "strength %s %g N m: too weak in %.3g %% of steps, %.1f N m asked",
                 himc_joint_name(j), p->controller.strength[j],
                 100.0 * (double)s->weak[j] / (double)s->steps, s->torque[j]);
        line(user, text);
    }
}

static himc_word strength_word(const himc_performance *p)
{
    bool any = false;
    for (int j = 0; j < HIMC_JOINTS; j++)
        any = any || p->controller.strength[j] > 0;
    if (any && !p->human)
        return (himc_word){"as set"};
    return himc_command_word(HIMC_COMMAND_STRENGTH, 0, p->human ? STRENGTH_HUMAN : STRENGTH_OFF);
}

void himc_performance_describe_limits(const himc_performance *p, void (*line)(void *, const char *),
                                      void *user)
{
    char text[256];
    const himc_saturation_counts *s = &p->saturation;
    snprintf(text, sizeof text, "limits %s%s, hit %ld times, strength %s",
             himc_command_word(HIMC_COMMAND_LIMITS, 0, (int)p->limits.kind).text,
             p->limits.kind == HIMC_LIMITS_OFF ? ""
             : p->has_learned                  ? " of the take"
                                               : " of table 1",
             himc_performance_limit_hits(p), strength_word(p).text);
    line(user, text);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (s->hits[j] == 0)
            continue;
        snprintf(text, sizeof text, "limit %s: hit %ld times, up to %.2f degrees beyond",
                 himc_joint_name(j), s->hits[j], s->farthest[j] * 180 / HIMC_PI);
        line(user, text);
    }
    describe_strength(p, line, user);
}
