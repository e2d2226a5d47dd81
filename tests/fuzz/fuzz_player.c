/// fuzz_player.c: takes of a whole player, damaged, made a player and a track with poses that must
/// be finite.
///
/// The format is known by the first bytes. What is too short to be a take is replaced by a good
/// one of a whole player, so the corpus needs no seeds.
#include "take_players.h"
#include "track/track.h"
#include "take.h"

#define RATE 60.0   // of the good takes (Hz)
#define SECONDS 0.2 // chosen: a player costs a time for each frame
#define LEAST 1000  // (bytes)

const long fuzz_runs = 100;

static void check_quats(const himc_quat *q)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        require(fabs(himc_quat_dot(q[j], q[j]) - 1) < 1e-6, "a joint has a rotation");
}

static void check_moment(const himc_track *track, const himc_skeleton *skeleton, double t)
{
    himc_target tip[HIMC_HANDS];
    himc_posture_motion m;
    memset(&m, 0, sizeof m);
    for (int j = 0; j < HIMC_JOINTS; j++)
        m.joint[j] = himc_quat_identity();
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        tip[hand] = himc_track_target(track, (himc_hand)hand, t);
        require(himc_vec3_finite(tip[hand].x) && himc_vec3_finite(tip[hand].a),
                "a target is finite");
    }
    himc_track_posture(track, skeleton, t, tip, &m);
    check_quats(m.joint);
    for (int j = 0; j < HIMC_JOINTS; j++)
        require(himc_vec3_finite(m.rate[j]) && himc_vec3_finite(m.acceleration[j]),
                "a joint's motion is finite");
}

static void check_track(himc_take *take, const himc_take_options *options,
                        const himc_player *player, const himc_head_frame *drum)
{
    himc_skeleton skeleton;
    himc_error error = {""};
    himc_track *track =
        himc_track_new(take, options, drum, player, player->config.mallet_radius, &error);
    require(himc_skeleton_init(&skeleton, &player->config, NULL), "a player's body can be built");
    if (!track) {
        require_line(&error);
        return;
    }
    for (int i = 0; i < 10; i++)
        check_moment(track, &skeleton, (i - 1) * himc_track_length(track) / 8);
    himc_track_free(track);
}

static void check_player(himc_take *take, const himc_take_options *options)
{
    himc_skeleton_config given = himc_skeleton_default();
    himc_head_frame drum = usual_drum;
    himc_error error = {""};
    himc_player *player = himc_player_new(take, options, &given, &error);
    if (!player) {
        require_line(&error);
        return;
    }
    check_quats(player->mean.joint);
    for (int i = 0; player->pose && i < player->frames; i++)
        check_quats(player->pose[i].joint);
    bool seated = himc_player_sit(player, take, options, &drum, NULL);
    require(!seated || (himc_vec3_finite(player->offset) && himc_vec3_finite(drum.center)),
            "a player sits somewhere");
    int lines = 0;
    himc_player_describe(player, &drum, hear, &lines);
    require(lines > 1, "a player is described");
    check_track(take, options, player, &drum);
    himc_player_free(player);
}

static const char *name_of(const uint8_t *data, size_t size)
{
    return size < 4 || data[1] == 0x50    ? "fuzz.c3d"
           : memcmp(data, "Path", 4) == 0 ? "fuzz.trc"
                                          : "fuzz.bvh";
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_take_options options = fuzz_options(data, size);
    himc_take *take = fuzz_take(name_of(data, size), data, size, &options);
    if (take)
        check_player(take, &options);
    himc_take_free(take);
    return 0;
}

// a whole player in one of the formats
static size_t good_take(uint8_t *data, size_t most, unsigned seed)
{
    static const struct {
        const char *name;
        bool (*write)(FILE *file, const himc_take *take, himc_error *error);
    } formats[] = {
        {"fuzz.bvh", himc_bvh_write}, {"fuzz.trc", himc_trc_write}, {"fuzz.c3d", himc_c3d_write}};
    himc_error error;
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    require(himc_skeleton_init(&skeleton, &config, NULL), "a body");
    himc_take *take = beaten_file(formats[seed % 3].name, &skeleton, RATE, SECONDS, &error);
    FILE *file = fmemopen(data, most, "wb");
    require(take && file && formats[seed % 3].write(file, take, &error), "a good take");
    long size = ftell(file);
    fclose(file);
    himc_take_free(take);
    return (size_t)size;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    if (size >= LEAST && seed % 50)
        return LLVMFuzzerMutate(data, size, most);
    return most < 1 << 14 ? size : good_take(data, most, seed / 50);
}
