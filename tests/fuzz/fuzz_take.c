/// fuzz_take.c: takes from arbitrary bytes. Nothing may crash, read out of bounds, hang or break
/// the promises of mocap.h: a take has finite positions or whole gaps, and its names are printable.
///
/// With libFuzzer (clang -fsanitize=fuzzer,address,undefined -DHIMC_LIBFUZZER) the first byte of an
/// input gives the format. Without libFuzzer this is a program that mutates seeds by itself, in the
/// same way for the same arguments:
///     fuzz_take [RUNS [SEED [FILE...]]]
/// FILEs (at most 64 KiB of each) join the seeds that are built in: a BVH, a TRC, six flavours of
/// C3D, and a whole player in each format. Each take is also made a player and a track, with poses
/// that must be finite.
#define _POSIX_C_SOURCE 200809L
#include "../c3d_files.h"
#include "../take_players.h"
#include "plan/track.h"

#include <stdio.h>
#include <time.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static long accepted;

static void require(bool promise, const char *what)
{
    if (promise)
        return;
    fprintf(stderr, "broken promise: %s\n", what);
    abort();
}

static void hear(void *user, const char *line)
{
    require(strlen(line) < 256, "a line is at most 255 characters");
    ++*(int *)user;
}

static void check_points(const himc_take *take)
{
    for (int frame = 0; frame < himc_take_frames(take); frame++)
        for (int i = 0; i < himc_take_points(take); i++) {
            himc_vec3 p = himc_take_point(take, frame, i);
            bool gap = isnan(p.x) && isnan(p.y) && isnan(p.z);
            require(gap || himc_vec3_finite(p), "a place is finite or a gap");
            himc_quat q = himc_take_rotation(take, frame, i);
            require(fabs(himc_quat_dot(q, q) - 1) < 1e-6, "a rotation is a unit quaternion");
        }
    for (int i = 0; i < himc_take_points(take); i++) {
        const char *name = himc_take_point_name(take, i);
        require(name[0] && strlen(name) < 64, "a point has a name");
        require(himc_take_find(take, name) >= 0, "a point is found by its name");
        require(himc_take_parent(take, i) < (himc_take_has_skeleton(take) ? i : 1),
                "parents come first");
    }
}

static void check_tips(himc_take *take, const himc_take_options *options)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_error error = {""};
    if (!himc_take_tips(take, options, tips, &error)) {
        require(error.text[0] && !strchr(error.text, '\n'), "an error is one line");
        return;
    }
    himc_take_strike strikes[16];
    int count = himc_take_strikes(take, tips, strikes, 16);
    for (int i = 0; i < count && i < 16; i++) {
        require(himc_vec3_finite(strikes[i].x) && isfinite(strikes[i].velocity),
                "a strike is finite");
        require(strikes[i].frame >= 0 && strikes[i].frame < himc_take_frames(take),
                "a strike is in the take");
        require(i == 0 || strikes[i].time >= strikes[i - 1].time, "strikes come in order");
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; tips[hand].present && i < himc_take_frames(take); i++)
            require(himc_vec3_finite(tips[hand].x[i]), "a tip has no gaps");
}

static void check_quats(const himc_quat *q)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        require(fabs(himc_quat_dot(q[j], q[j]) - 1) < 1e-6, "a joint has a rotation");
}

static void check_track(himc_take *take, const himc_take_options *options,
                        const himc_player *player, const himc_head_frame *drum)
{
    himc_skeleton skeleton;
    himc_error error = {""};
    himc_track *track = himc_track_new_played(take, options, drum, player, &error);
    require(track || (error.text[0] && !strchr(error.text, '\n')), "an error is one line");
    require(himc_skeleton_init(&skeleton, &player->config, NULL), "a player's body can be built");
    double length = track ? himc_track_length(track) : 0;
    for (int i = 0; track && i < 40; i++) {
        himc_target tip[HIMC_HANDS];
        himc_posture_motion m;
        double t = (i - 4) * length / 32;
        memset(&m, 0, sizeof m);
        for (int j = 0; j < HIMC_JOINTS; j++)
            m.joint[j] = himc_quat_identity();
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            tip[hand] = himc_track_target(track, (himc_hand)hand, t);
            require(himc_vec3_finite(tip[hand].x) && himc_vec3_finite(tip[hand].a),
                    "a target is finite");
        }
        himc_track_posture(track, &skeleton, t, tip, &m);
        check_quats(m.joint);
        for (int j = 0; j < HIMC_JOINTS; j++)
            require(himc_vec3_finite(m.rate[j]) && himc_vec3_finite(m.acceleration[j]),
                    "a joint's motion is finite");
    }
    himc_track_free(track);
}

static void check_player(himc_take *take, const himc_take_options *options)
{
    himc_skeleton_config given = himc_skeleton_default();
    himc_head_frame drum = usual_drum;
    himc_error error = {""};
    himc_player *player = himc_player_new(take, options, &given, &error);
    if (!player) {
        require(error.text[0] && !strchr(error.text, '\n'), "an error is one line");
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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const names[] = {"fuzz.bvh", "fuzz.trc", "fuzz.c3d"};
    if (size < 2)
        return 0;
    himc_take_options options = himc_take_default();
    options.up = (himc_up)(data[0] / 3 % 3);
    options.longest_gap = data[0] & 128 ? 10 : 0.05;
    options.unit = data[0] & 64 ? 0.01 : 0;
    himc_error error = {""};
    himc_take *take = himc_take_read(data + 1, size - 1, names[data[0] % 3], &options, &error);
    if (!take) {
        require(error.text[0] && !strchr(error.text, '\n'), "an error is one line");
        return 0;
    }
    accepted++;
    check_points(take);
    // the first point is also named as a tip, so that filling and strikes are always reached
    check_tips(take, &options);
    options.right_tip = himc_take_point_name(take, 0);
    check_tips(take, &options);
    check_player(take, &options);
    int lines = 0;
    himc_take_describe(take, &options, hear, &lines);
    require(lines > 4, "a take is described");
    himc_take_free(take);
    return 0;
}

#ifndef HIMC_LIBFUZZER

#define MOST_SEEDS 64
#define MOST_BYTES (1 << 17)

typedef struct seed {
    uint8_t *bytes;
    size_t size;
} seed;

static seed seeds[MOST_SEEDS];
static int seed_count;
static uint64_t state;

static uint32_t next(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (uint32_t)(state >> 32);
}

static size_t below(size_t n)
{
    return n ? next() % n : 0;
}

static void add_seed(int format, const void *bytes, size_t size)
{
    if (seed_count >= MOST_SEEDS)
        return;
    seed *s = &seeds[seed_count++];
    s->size = size + 1;
    s->bytes = malloc(s->size);
    s->bytes[0] = (uint8_t)format;
    memcpy(s->bytes + 1, bytes, size);
}

static void add_built_in(void)
{
    static const char bvh[] =
        "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition "
        "Zposition Zrotation Yrotation Xrotation\n"
        " JOINT LeftArm\n {\n OFFSET 0.2 0.5 0\n CHANNELS 3 Zrotation Xrotation Yrotation\n"
        " End Site\n {\n OFFSET 0.6 0 0\n"
        " }\n }\n"
        " JOINT RightArm\n {\n OFFSET -0.2 0.5 0\n CHANNELS 3 Zrotation Xrotation Yrotation\n"
        " JOINT RightStick\n {\n"
        " OFFSET -0.6 0 0\n CHANNELS 0\n End Site\n {\n OFFSET -0.4 0 0\n }\n }\n }\n}\n"
        "MOTION\nFrames: 4\n"
        "Frame Time: 0.004\n0 1 0 1 2 3 10 20 30 40 50 60\n0 1 .1 1 2 3 1e1 20 30 40 50 60\n"
        "0 1 0 1 2 3 10 20 30 40 50 60\n0 1 0 -1 2 3 10 20 30 40 50 60\n";
    static const char trc[] =
        "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
        "100\t100\t6\t2\tmm\n"
        "Frame#\tTime\tRTIP\t\t\tLTIP\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"
        "1\t0.00\t500\t900\t100\t500\t700\t-200\n"
        "2\t0.01\t500\t850\t100\t\t\t\n"
        "3\t0.02\t500\t800\t100\t500\t700\t-200\n4\t0.03\t500\t750\t100\t500\t700\t-200\n"
        "5\t0.04\t500\t790\t100\tnan\tnan\tnan\n6\t0.05\t500\t830\t100\t500\t1e2\t-200\n";
    add_seed(0, bvh, sizeof bvh - 1);
    add_seed(1, trc, sizeof trc - 1);
    for (int i = 0; i < 6; i++) {
        maker m = maker_default((c3d_processor)(C3D_INTEL + i / 2), i % 2);
        m.events = i % 3 ? 2 : 0;
        m.header_events = i % 3 ? 0 : 1;
        m.long_frames = i == 4;
        m.frames = 30;
        make(&m);
        add_seed(2, m.bytes, m.size);
        free(m.bytes);
    }
}

static void add_file(const char *path)
{
    static uint8_t bytes[1 << 16];
    size_t n = strlen(path);
    const char *suffix = n > 4 ? path + n - 4 : "";
    FILE *file = fopen(path, "rb");
    if (!file)
        return;
    add_seed(strcmp(suffix, ".c3d") == 0 ? 2 : strcmp(suffix, ".trc") == 0, bytes,
             fread(bytes, 1, sizeof bytes, file));
    fclose(file);
}

// a whole player in every format
static void add_players(void)
{
    static const char *const files[] = {"build/fuzz.bvh", "build/fuzz.trc", "build/fuzz.c3d"};
    himc_error error;
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton_init(&skeleton, &config, NULL);
    himc_take *take = beaten_take(&skeleton, 100, 0.6, &error);
    for (int i = 0; i < 3; i++)
        if (take && himc_take_save(take, files[i], &error))
            add_file(files[i]);
    himc_take_free(take);
}

// one typical damage of a file: bits, bytes, numbers, parts lost, doubled or from elsewhere
static size_t mutate(uint8_t *b, size_t size)
{
    static const char *const pieces[] = {
        "-1",   "0",      "65535",    "1e999",     "nan",       "99999999999", "\t\t",
        "\n",   "{",      "}",        "End",       "JOINT",     "CHANNELS 6",  ",",
        "-0.0", "1e-320", "\xff\xff", "Frames: 3", "2147483648"};
    size_t at = 1 + below(size - 1), length = 1 + below(below(4) ? 8 : 400);
    length = length < size - at ? length : size - at;
    const char *piece = pieces[below(sizeof pieces / sizeof pieces[0])];
    const seed *other = &seeds[below((size_t)seed_count)];
    switch (below(9)) {
    case 0: b[at] ^= (uint8_t)(1u << below(8)); break;
    case 1: b[at] = (uint8_t)next(); break;
    case 2: b[at] = below(2) ? 0 : 255; break;
    case 3: memset(b + at, (int)below(256), length); break;
    case 4: memmove(b + at, b + at + length, size - at - length); return size - length;
    case 5: return below(4) ? size : at + 1;
    case 6:
        if (size + length < MOST_BYTES) {
            memmove(b + at + length, b + at, size - at);
            return size + length;
        }
        break;
    case 7:
        length = strlen(piece);
        if (size + length < MOST_BYTES) {
            memmove(b + at + length, b + at, size - at);
            memcpy(b + at, piece, length);
            return size + length;
        }
        break;
    default:
        length = length < other->size ? length : other->size;
        memcpy(b + at, other->bytes + below(other->size - length), length);
    }
    return size;
}

static void run_one(void)
{
    static uint8_t buffer[MOST_BYTES];
    const seed *s = &seeds[below((size_t)seed_count)];
    size_t size = s->size;
    memcpy(buffer, s->bytes, size);
    buffer[0] = (uint8_t)(s->bytes[0] + 3 * below(85));
    for (size_t n = 1 + below(below(3) ? 4 : 24); n > 0 && size > 2; n--)
        size = mutate(buffer, size);
    // a copy of exact size lets the address sanitizer detect a byte too far
    uint8_t *input = malloc(size);
    memcpy(input, buffer, size);
    struct timespec before, after;
    clock_gettime(CLOCK_MONOTONIC, &before);
    LLVMFuzzerTestOneInput(input, size);
    clock_gettime(CLOCK_MONOTONIC, &after);
    // an input takes milliseconds; this is for one that never ends, on any machine
    require(after.tv_sec - before.tv_sec < 60, "an input takes less than 60 s");
    free(input);
}

int main(int count, char **arguments)
{
    long runs = count > 1 ? atol(arguments[1]) : 20000;
    state = 0x9E3779B97F4A7C15u ^ (count > 2 ? strtoull(arguments[2], NULL, 10) : 1);
    add_built_in();
    add_players();
    for (int i = 3; i < count; i++)
        add_file(arguments[i]);
    for (long i = 0; i < runs; i++)
        run_one();
    for (int i = 0; i < seed_count; i++)
        free(seeds[i].bytes);
    printf("%ld inputs survived, %ld of them were read as takes\n", runs, accepted);
    return 0;
}

#endif
