/// read_players.h: shared by the tests of players: a take made by a known body, the player read
/// from it, and the differences between the two.
#ifndef HIMC_TESTS_READ_PLAYERS_H
#define HIMC_TESTS_READ_PLAYERS_H

#include "take_players.h"

#include "capture/take.h"

#include "unity.h"

#define FRAMES 500

static himc_error error;
static himc_take *take;
static himc_player *player;
static himc_skeleton skeleton;
static himc_skeleton_config given;

void setUp(void)
{
    error.text[0] = 0;
    take = NULL;
    player = NULL;
    given = himc_skeleton_default();
}

void tearDown(void)
{
    himc_player_free(player);
    himc_take_free(take);
}

static inline void make_take(const himc_skeleton_config *config)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_skeleton_init(&skeleton, config, &error), error.text);
    take = beaten_take(&skeleton, 250, FRAMES / 250.0, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
}

static inline void read_player(void)
{
    player = himc_player_new(take, NULL, &given, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(player, error.text);
}

// a tall player with long forearms
static inline himc_skeleton_config another_player(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    config.height = 1.88;
    config.mass = 82;
    config.length[HIMC_LEFT_FOREARM] = config.length[HIMC_RIGHT_FOREARM] = 0.31;
    config.stick_length = 0.40;
    return config;
}

// the largest angle between the take's poses and the true ones, over the joints from .. to
static inline double worst_angle(int from, int to)
{
    double worst = 0;
    for (int i = 0; i < himc_take_frames(take); i++) {
        himc_pose pose = beaten_pose(&skeleton, i / himc_take_rate(take));
        for (int j = from; j < to; j++) {
            himc_quat back = himc_quat_conj(pose.joint[j]);
            himc_vec3 off = himc_quat_log(himc_quat_mul(back, player->pose[i].joint[j]));
            worst = fmax(worst, himc_vec3_length(off));
        }
    }
    return worst;
}

static inline double worst_tip(void)
{
    double worst = 0;
    himc_skeleton own;
    TEST_ASSERT_TRUE(himc_skeleton_init(&own, &player->config, &error));
    for (int i = 0; i < himc_take_frames(take); i++) {
        himc_body_state a, b;
        himc_pose pose = beaten_pose(&skeleton, i / himc_take_rate(take));
        himc_pose_to_state(&skeleton, &pose, NULL, &a);
        himc_pose_to_state(&own, &player->pose[i], NULL, &b);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_vec3 tip = himc_vec3_sub(b.tip[hand], b.origin[0]);
            himc_vec3 true_tip = himc_vec3_sub(a.tip[hand], a.origin[0]);
            worst = fmax(worst, himc_vec3_length(himc_vec3_sub(tip, true_tip)));
        }
    }
    return worst;
}

static inline int known_joints(void)
{
    int count = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        count += player->known[j];
    return count;
}

static inline void forget_skeleton(void)
{
    free(take->parents);
    free(take->offsets);
    free(take->rotations);
    take->parents = NULL;
    take->offsets = NULL;
    take->rotations = NULL;
}

static inline void exchange_names(const char *one, const char *other)
{
    int a = himc_take_find(take, one), b = himc_take_find(take, other);
    TEST_ASSERT_TRUE(a >= 0 && b >= 0);
    himc_take_set_name(take, a, other, strlen(other));
    himc_take_set_name(take, b, one, strlen(one));
}

static inline bool load_shared(const char *name)
{
    const char *path = shared_capture(name);
    if (path) {
        take = himc_take_load(path, NULL, &error);
        TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
        read_player();
    }
    return path != NULL;
}

#endif
