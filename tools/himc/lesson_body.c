/// lesson_body.c: what arms do in a take that shows them whole.
///
/// Between two frames of a fall each joint alone is turned from its first to its second rotation;
/// the way that the tip then goes down is its share. Torques and work are those of the take played
/// in mode `id`. The wrist is bent where hand and forearm are more than 15 degrees out of line,
/// beyond which RULA (McAtamney and Corlett 1993) counts a wrist posture as strained. An elbow is
/// high where the upper arm is more than RULA's 45 degrees from hanging at the strokes of a hand.
#include "lesson_beat.h"

#include "cli.h"

#include <math.h>

#define BENT 0.966      // cos 15 degrees
#define RAISED 45.0     // (degrees)
#define CENTRES_OFF 3.0 // (degrees) chosen: 15 mm of joint centres, over an upper arm

// group of a joint: its index in an arm, the grip with the wrist, all else with the trunk
static int limb_of(himc_hand hand, int joint)
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        if (himc_arm_joint(hand, k) == joint)
            return k < 2 ? k : 2;
    return 3;
}

static void share_fall(lesson_played *p, const himc_player *player, const himc_skeleton *skeleton)
{
    const himc_hand hand = p->strike.hand;
    himc_body_state a, b;
    double down[LESSON_LIMBS] = {0}, all = 0;
    for (int k = p->top; k < p->strike.clear && k + 1 < player->frames; k++) {
        himc_pose_to_state(skeleton, &player->pose[k], NULL, &a);
        for (int limb = 0; limb < LESSON_LIMBS; limb++) {
            himc_pose pose = player->pose[k];
            for (int joint = 0; joint < HIMC_JOINTS; joint++)
                if (limb_of(hand, joint) == limb)
                    pose.joint[joint] = player->pose[k + 1].joint[joint];
            himc_pose_to_state(skeleton, &pose, NULL, &b);
            down[limb] += a.tip[hand].z - b.tip[hand].z;
            all += a.tip[hand].z - b.tip[hand].z;
        }
    }
    for (int limb = 0; limb < LESSON_LIMBS; limb++)
        p->share[limb] = all > 0.01 ? down[limb] / all : NAN;
}

static double bent_share(const himc_player *player, const himc_skeleton *skeleton, himc_hand hand)
{
    int bent = 0, wrist = himc_arm_joint(hand, 2);
    for (int k = 0; k < player->frames; k++)
        bent += himc_vec3_dot(himc_quat_rotate(player->pose[k].joint[wrist],
                                               skeleton->segment[wrist + 1].axis),
                              skeleton->segment[himc_arm_joint(hand, 1) + 1].axis) < BENT;
    return (double)bent / player->frames;
}

static double raised(const himc_player *player, const himc_skeleton *skeleton,
                     const lesson_played *p)
{
    int upper = himc_arm_joint(p->strike.hand, 0) + 1, fore = himc_arm_joint(p->strike.hand, 1) + 1;
    himc_body_state b;
    himc_pose_to_state(skeleton, &player->pose[p->strike.frame], NULL, &b);
    himc_vec3 arm = himc_vec3_sub(b.origin[fore], b.origin[upper]);
    return acos(-arm.z / himc_vec3_length(arm)) * 180 / HIMC_PI;
}

static void judge_elbow(lesson *l, himc_hand hand)
{
    double n = 0, mean = 0, ss = 0;
    for (const lesson_played *p = l->played; p < l->played + l->count; p++)
        if (p->strike.hand == hand && isfinite(p->raised)) {
            double d = p->raised - mean;
            mean += d / ++n;
            ss += d * (p->raised - mean);
        }
    double sd = n > 1 ? sqrt(ss / (n - 1)) : 0;
    lesson_fault *f = n < LESSON_FEWEST
                          ? NULL
                          : lesson_fault_add(l, "elbow", mean, hypot(sd / sqrt(n), CENTRES_OFF),
                                             LESSON_SURE, RAISED);
    if (!f)
        return;
    snprintf(
        f->what, sizeof f->what,
        "The %s elbow is high: at the strokes the upper arm is raised %.0f degrees from hanging",
        himc_hand_name(hand), mean);
    snprintf(f->how, sizeof f->how, "mean of %.0f strokes", n);
    lesson_fault_explain(f, sd, "degrees", "strained beyond 45: RULA, McAtamney and Corlett 1993");
}

static void keep_torques(void *user, const himc_motion_row *row)
{
    lesson *l = user;
    double t = row->time - HIMC_APPROACH;
    for (int hand = 0; hand < HIMC_HANDS && t >= 0; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            l->work[hand] += fabs(row->power[himc_arm_joint((himc_hand)hand, k)]) / 250;
    for (int i = 0; i < l->count; i++) {
        lesson_played *p = &l->played[i];
        if (!isfinite(p->share[0]) || t < p->top / l->rate || t > p->strike.time)
            continue;
        for (int k = 0; k < 3; k++)
            p->torque[k] = fmax(isfinite(p->torque[k]) ? p->torque[k] : 0,
                                himc_vec3_length(row->torque[himc_arm_joint(p->strike.hand, k)]));
    }
}

static bool play_take(lesson *l, himc_take *take, himc_player *player,
                      const himc_take_options *options)
{
    himc_performance_config config = himc_performance_default();
    himc_error error;
    config.sample_rate = config.physics_rate = LESSON_RATE;
    himc_performance *p = himc_performance_new(&config, &error);
    himc_event event = {.kind = HIMC_EVENT_BEAT};
    if (p)
        himc_performance_take_options(p, options);
    bool good = p && cli_add_drum(p, LESSON_RATE, &error) &&
                himc_performance_play_player(p, take, player, l->take, &error) &&
                cli_tell(p, "mode id", NULL, &error) && cli_tell(p, "play", NULL, &error);
    if (good)
        himc_performance_on_motion(p, keep_torques, l);
    while (good && event.kind != HIMC_EVENT_DONE) {
        himc_performance_process(p, LESSON_BLOCK, NULL);
        while (event.kind != HIMC_EVENT_DONE && himc_performance_event(p, &event)) {
        }
    }
    himc_performance_free(p);
    if (!good)
        cli_say("note: no joint torques: %s\n", error.text);
    return good;
}

void lesson_body(lesson *l, himc_take *take, const himc_take_options *options)
{
    himc_skeleton_config given = himc_skeleton_default();
    himc_skeleton skeleton;
    himc_error error;
    himc_player *player = himc_player_new(take, options, &given, &error);
    bool arm[HIMC_HANDS] = {false};
    for (int h = 0; player && player->pose && h < HIMC_HANDS; h++)
        arm[h] = l->seen[h] && himc_player_known_arm(player, (himc_hand)h) == HIMC_ARM_JOINTS;
    l->body = (arm[0] || arm[1]) && himc_skeleton_init(&skeleton, &player->config, &error);
    for (int h = 0; h < HIMC_HANDS; h++)
        l->bent[h] = l->body && arm[h] ? bent_share(player, &skeleton, (himc_hand)h) : NAN;
    int count[HIMC_HANDS] = {0};
    for (int i = 0; i < l->count && l->body; i++)
        if (arm[l->played[i].strike.hand]) {
            share_fall(&l->played[i], player, &skeleton);
            l->played[i].raised = raised(player, &skeleton, &l->played[i]);
            count[l->played[i].strike.hand]++;
        }
    for (int h = 0; h < HIMC_HANDS; h++)
        judge_elbow(l, (himc_hand)h);
    l->torques = l->body && play_take(l, take, player, options);
    for (int h = 0; h < HIMC_HANDS; h++)
        l->work[h] = l->torques && count[h] ? l->work[h] / count[h] : NAN;
    himc_player_free(player);
}
