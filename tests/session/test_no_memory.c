/// test_no_memory.c: what happens when an allocation fails. For n = 1, 2, ... the n-th allocation
/// of a setup function fails, until the function succeeds. Each time before, it must say so in one
/// line and leave no block behind; and what it was called on then plays on bit by bit as its twin
/// that was never asked.
///
/// The libraries' allocations fail too, with two exceptions. The Open Dynamics Engine aborts the
/// process when it gets no memory, and so does the C++ library under it: theirs never fail here.
/// Without its buffer libc reads and writes a file byte by byte, so nothing is refused there.
/// And a score that runs out of memory has carried out its first lines; it says so, and frees the
/// rest.
///
/// Everyday a long call is tried at some of its allocations, with HIMC_LONG at all.
#define _GNU_SOURCE
#include "allocations.h"
#include "disc_mesh.h"
#include "take_players.h"

#include "session.h"

#include "himc/membrane.h"
#include "himc/osc.h"

#include "capture/units.h"
#include "control/posture_regression.h"
#include "osc/stepped.h"

#include <link.h>
#include <sys/stat.h>

#define BVH "build/no_memory.bvh"
#define C3D "build/no_memory.c3d"
#define TRC "build/no_memory.trc"
#define MESH "build/no_memory_mesh"
#define SCORE "build/no_memory.txt"
#define OUT "build/no_memory_out"
#define RATE 8000.0
#define FEW 12 // allocations of a long call that are tried every day
#define MOST 5000
#define SMALLEST_BUFFER 1024 // of a libc file (bytes); a FILE itself is smaller

// a function under test: true if it succeeded
typedef bool setup(void *it, himc_error *error);

static int tried;

static int spare_library(struct dl_phdr_info *info, size_t size, void *user)
{
    (void)size, (void)user;
    bool aborts = strstr(info->dlpi_name, "libode") || strstr(info->dlpi_name, "libstdc++");
    bool buffers = strstr(info->dlpi_name, "libc.so");
    for (int i = 0; (aborts || buffers) && i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *part = &info->dlpi_phdr[i];
        uintptr_t from = info->dlpi_addr + part->p_vaddr;
        if (part->p_type == PT_LOAD && part->p_flags & PF_X)
            spared[spared_count++] = (struct spared_allocations){from, from + part->p_memsz,
                                                                 aborts ? 0 : SMALLEST_BUFFER};
    }
    return 0;
}

static bool is_one_line(const char *text)
{
    return text[0] && !strpbrk(text, "\n\r") && strlen(text) < sizeof error.text;
}

// the n-th allocation fails; true if there was one, and then the call must have been refused
static bool refuses(setup *run, void *it, const char *what, int n, bool changes)
{
    char where[100];
    himc_error why = {""};
    long before = blocks_held();
    snprintf(where, sizeof where, "%s, allocation %d", what, n);
    fail_allocation(n);
    bool done = run(it, &why);
    bool failed = has_failed();
    fail_allocation(0);
    if (!failed) {
        TEST_ASSERT_TRUE_MESSAGE(done, why.text);
        return false;
    }
    TEST_ASSERT_FALSE_MESSAGE(done, where);
    TEST_ASSERT_TRUE_MESSAGE(is_one_line(why.text), where);
    if (!changes)
        TEST_ASSERT_EQUAL_INT_MESSAGE(before, blocks_held(), where);
    tried++;
    return true;
}

// tries allocations until the call succeeds
static void exhaust(setup *run, void *it, const char *what)
{
    bool all = getenv("HIMC_LONG");
    int n = 1;
    for (int i = 1; n < MOST && refuses(run, it, what, n, false); i++)
        n += all || i < FEW ? 1 : 1 + n / 4;
    TEST_ASSERT_TRUE_MESSAGE(n > 1 && n < MOST, what);
}

// What a performance or a drum sounds and looks like, as a sum (FNV-1a).

static uint64_t heard_sum;

static void add_bytes(const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        heard_sum = (heard_sum ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3;
}

static void add_row(void *user, const himc_motion_row *row)
{
    (void)user;
    add_bytes(row, sizeof *row);
}

static void add_line(void *user, const char *line)
{
    (void)user;
    add_bytes(line, strlen(line));
}

static void add_drum(const himc_drum *drum, int samples)
{
    static double sound[HIMC_DRUM_RING], place[HIMC_DRUM_RING];
    himc_drum_read(drum, himc_drum_time(drum) - (uint64_t)samples, samples, sound, place);
    add_bytes(sound, (size_t)samples * sizeof *sound);
    add_bytes(place, (size_t)samples * sizeof *place);
    himc_drum_describe(drum, HIMC_DESCRIBE_INFO, add_line, NULL);
    himc_drum_describe(drum, HIMC_DESCRIBE_STATE, add_line, NULL);
}

static void add_event(const himc_event *event)
{
    add_bytes(&event->kind, sizeof event->kind);
    if (event->kind == HIMC_EVENT_NOTE)
        add_line(NULL, event->text);
    if (event->kind == HIMC_EVENT_STRIKE)
        add_bytes(&event->strike, sizeof event->strike);
}

static uint64_t play_performance(himc_performance *p, double seconds)
{
    himc_event event = {0};
    int samples = (int)(seconds * RATE);
    heard_sum = 0xcbf29ce484222325;
    himc_performance_on_motion(p, add_row, NULL);
    himc_performance_process(p, samples, NULL);
    while (himc_performance_event(p, &event))
        add_event(&event);
    himc_performance_stats stats = himc_performance_measure(p);
    add_bytes(&stats, sizeof stats);
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, add_line, NULL);
    himc_drum *drum;
    for (int i = 0; (drum = himc_performance_drum(p, i)); i++)
        add_drum(drum, samples);
    return heard_sum;
}

static uint64_t play_drum(himc_drum *drum)
{
    heard_sum = 0xcbf29ce484222325;
    himc_drum_strike_at(drum, 10, 0.1, 0.05, 2, NULL);
    himc_drum_advance(drum, 400, NULL, NULL, NULL);
    add_drum(drum, 400);
    return heard_sum;
}

// Commands to a performer.

static himc_performance *new_performance(const char *commands)
{
    himc_performance_config config = {.sample_rate = RATE, .physics_rate = 500, .task_rate = 100};
    himc_performance *p = himc_performance_new(&config, &error);
    char all[400], *rest = all;
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    himc_performance_make_drums(p, true);
    snprintf(all, sizeof all, "%s", commands);
    for (char *one; (one = strtok_r(rest, ";", &rest));)
        session_do(p, "%s", one);
    return p;
}

typedef struct sent_command {
    void *to;
    himc_command command;
    int delay;
} sent_command;

static bool send_performer(void *it, himc_error *why)
{
    sent_command *s = it;
    return himc_performance_command(s->to, &s->command, s->delay, why);
}

// twins in the state after `before`; one is refused `text` again and again
static void check_command(const char *before, const char *text, int delay)
{
    long blocks_before = blocks_held();
    himc_performance *p = new_performance(before), *twin = new_performance(before);
    sent_command sent = {.to = p, .delay = delay};
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(play_performance(twin, 0.05), play_performance(p, 0.05), text);
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&sent.command, HIMC_PERFORMER, text, &error),
                             error.text);
    bool all = getenv("HIMC_LONG"), score = sent.command.id == HIMC_COMMAND_SCORE;
    for (int n = 1, i = 1; refuses(send_performer, &sent, text, n, score); i++) {
        n += all || i < FEW ? 1 : 1 + n / 4;
        if (!score && (all || i % 4 == 0))
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(play_performance(twin, 0.02),
                                             play_performance(p, 0.02), text);
    }
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_command(twin, &sent.command, delay, &error),
                             error.text);
    if (!score)
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(play_performance(twin, 0.3), play_performance(p, 0.3),
                                         text);
    himc_performance_free(p);
    himc_performance_free(twin);
    TEST_ASSERT_EQUAL_INT_MESSAGE(blocks_before, blocks_held(), text);
}

static void test_a_performers_command_without_memory_changes_nothing(void)
{
    static const struct {
        const char *before, *text;
        int delay;
    } row[] = {{"", "stroke 0 left accent f", 0},
               {"drum side", "stroke 0 left accent f normal side", 0},
               {"", "hit right accent f", 0},
               {"", "hit right accent f", 400},
               {"", "play", 0},
               {"", "play", 400},
               {"stroke 0.1 left accent f; play", "drum tom 26", 0},
               {"hit left accent f", "player 1.9 95", 0},
               {"stroke 0.1 left accent f; play", "score " SCORE, 0},
               {"", "score " SCORE, 0},
               {"drum kettle", "take " BVH, 0},
               {"", "take " BVH, 0},
               {"take " BVH, "take " C3D, 0},
               {"", "take " TRC, 0},
               {"", "units " BVH " accent", 0},
               {"hit left accent f", "record " OUT ".bvh", 0},
               {"hit left accent f; record " OUT ".c3d", "reset", 0},
               {"hit left accent f", "reset", 0}};
    for (size_t i = 0; CAN_FAIL_ALLOCATIONS && i < sizeof row / sizeof row[0]; i++)
        check_command(row[i].before, row[i].text, row[i].delay);
}

// Commands to a drum.

static bool send_drum(void *it, himc_error *why)
{
    sent_command *s = it;
    return himc_drum_command(s->to, &s->command, why);
}

static void test_a_drums_command_without_memory_changes_nothing(void)
{
    static const char *const text[] = {"modes 60",
                                       "shape rectangle 0.5 0.4",
                                       "shape " MESH "/head.txt",
                                       "shape circle",
                                       "radius 0.33",
                                       "tension 3000",
                                       "air 0",
                                       "decay 2",
                                       "pickups 4",
                                       "air 1",
                                       "tune A2"};
    himc_drum *drum = himc_drum_new("kettle", 23, RATE, &error);
    himc_drum *twin = himc_drum_new("kettle", 23, RATE, &error);
    for (size_t i = 0; CAN_FAIL_ALLOCATIONS && i < sizeof text / sizeof text[0]; i++) {
        sent_command sent = {.to = drum};
        TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&sent.command, HIMC_DRUM, text[i], &error),
                                 error.text);
        for (int n = 1; refuses(send_drum, &sent, text[i], n, false); n++)
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(play_drum(twin), play_drum(drum), text[i]);
        TEST_ASSERT_TRUE_MESSAGE(himc_drum_command(twin, &sent.command, &error), error.text);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(play_drum(twin), play_drum(drum), text[i]);
    }
    himc_drum_release(drum);
    himc_drum_release(twin);
}

// Functions that make something. `made` is what they made; it is freed here.

typedef struct maker {
    const char *name;
    void *(*make)(himc_error *error);
    void (*free)(void *made);
} maker;

static himc_take *sample_take; // of a whole player
static himc_skeleton sample_body;

static bool run_maker(void *it, himc_error *why)
{
    maker *m = it;
    void *made = m->make(why);
    if (made && m->free)
        m->free(made);
    return made;
}

static void *make_performance(himc_error *why)
{
    himc_performance_config config = himc_performance_default();
    return himc_performance_new(&config, why);
}

static void *make_drum(himc_error *why)
{
    return himc_drum_new("kettle", 26, RATE, why);
}

static void *make_membrane(himc_error *why)
{
    himc_head head = himc_head_default();
    return himc_membrane_new(&head, RATE, why);
}

static void *load_bvh(himc_error *why)
{
    return himc_take_load(BVH, NULL, why);
}

static void *load_c3d(himc_error *why)
{
    return himc_take_load(C3D, NULL, why);
}

static void *load_trc(himc_error *why)
{
    return himc_take_load(TRC, NULL, why);
}

static void *save_bvh(himc_error *why)
{
    return himc_take_save(sample_take, OUT ".bvh", why) ? sample_take : NULL;
}

static void *save_c3d(himc_error *why)
{
    return himc_take_save(sample_take, OUT ".c3d", why) ? sample_take : NULL;
}

static void *save_trc(himc_error *why)
{
    return himc_take_save(sample_take, OUT ".trc", why) ? sample_take : NULL;
}

static void *load_score(himc_error *why)
{
    return himc_score_load(SCORE, why);
}

static void *load_midi(himc_error *why)
{
    return himc_score_load("tests/midi/pedals.mid", why);
}

static void *load_musicxml(himc_error *why)
{
    return himc_score_load("tests/fuzz/corpus/musicxml/compressed", why);
}

static void *make_player(himc_error *why)
{
    himc_skeleton_config given = himc_skeleton_default();
    return himc_player_new(sample_take, NULL, &given, why);
}

static void *make_recording(himc_error *why)
{
    return himc_recording_new(OUT ".bvh", &sample_body, 100, 1, why);
}

static void *learn_limits(himc_error *why)
{
    static himc_limits limits;
    himc_pose pose[50];
    for (int i = 0; i < 50; i++)
        pose[i] = beaten_pose(&sample_body, i * 0.02);
    return himc_limits_learn(&limits, pose, 50, 0.05, why) ? &limits : NULL;
}

static void *correct_regression(himc_error *why)
{
    static himc_posture_regression regression;
    himc_pose pose[100];
    for (int i = 0; i < 100; i++)
        pose[i] = beaten_pose(&sample_body, i * 0.01);
    himc_posture_regression_take seen = {
        .skeleton = &sample_body, .pose = pose, .frames = 100, .rate = 100};
    himc_posture_regression_default(&regression);
    return himc_posture_regression_correct(&regression, &seen, NULL, why) ? &regression : NULL;
}

static double no_time(void *user)
{
    (void)user;
    return 0;
}

static void *make_osc(himc_error *why)
{
    himc_osc_config config = himc_osc_default();
    osc_clock clock = {no_time, no_time, NULL};
    config.port = 0;
    config.files = "build"; // and no `allow`: an address that is not read is looked up again
    return himc_osc_new_stepped(&config, &clock, why);
}

static void free_performance(void *it)
{
    himc_performance_free(it);
}

static void free_drum(void *it)
{
    himc_drum_release(it);
}

static void free_membrane(void *it)
{
    himc_membrane_free(it);
}

static void free_take(void *it)
{
    himc_take_free(it);
}

static void free_score(void *it)
{
    himc_score_free(it);
}

static void free_player(void *it)
{
    himc_player_free(it);
}

static void free_recording(void *it)
{
    himc_recording_free(it);
}

static void free_osc(void *it)
{
    himc_osc_free(it);
}

static void test_nothing_is_made_without_memory_and_nothing_is_left(void)
{
    static maker row[] = {{"performance", make_performance, free_performance},
                          {"drum", make_drum, free_drum},
                          {"membrane", make_membrane, free_membrane},
                          {"BVH", load_bvh, free_take},
                          {"C3D", load_c3d, free_take},
                          {"TRC", load_trc, free_take},
                          {"BVH written", save_bvh, NULL},
                          {"C3D written", save_c3d, NULL},
                          {"TRC written", save_trc, NULL},
                          {"score", load_score, free_score},
                          {"MIDI file", load_midi, free_score},
                          {"MusicXML file", load_musicxml, free_score},
                          {"player", make_player, free_player},
                          {"recording", make_recording, free_recording},
                          {"limits", learn_limits, NULL},
                          {"regression", correct_regression, NULL},
                          {"OSC", make_osc, free_osc}};
    for (size_t i = 0; CAN_FAIL_ALLOCATIONS && i < sizeof row / sizeof row[0]; i++) {
        long before = blocks_held();
        exhaust(run_maker, &row[i], row[i].name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(before, blocks_held(), row[i].name);
    }
}

static void test_many_allocations_were_tried(void)
{
    printf("%d calls with a failing allocation\n", tried);
    TEST_ASSERT_TRUE(!CAN_FAIL_ALLOCATIONS || tried > 300);
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    TEST_ASSERT_TRUE(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static bool make_files(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    config.height = 1.82;
    if (!himc_skeleton_init(&sample_body, &config, &error))
        return false;
    sample_take = beaten_take(&sample_body, 100, 1.2, &error);
    himc_take *markers = beaten_file(C3D, &sample_body, 100, 1.2, &error);
    if (!sample_take || !markers || !himc_take_save(sample_take, BVH, &error) ||
        !himc_take_save(markers, C3D, &error) || !himc_take_save(markers, TRC, &error))
        return false;
    himc_take_free(markers);
    disc_mesh mesh = disc_mesh_new(3, 0.3, 3000, 0.3);
    mkdir(MESH, 0777);
    disc_mesh_write(&mesh, MESH, 3000, 0.3);
    disc_mesh_free(&mesh);
    write_text(
        SCORE,
        "drum tom 29; drum kettle 26; kettle modes 30; tempo 120; tempo 90 2; at 1 tom tune A2;\n"
        "stroke 0.5 left accent f normal kettle; stroke 1 right tenuto mf; play;\n");
    return true;
}

int main(void)
{
    dl_iterate_phdr(spare_library, NULL);
    puts("without memory:"); // so that stdout has its buffer before any count
    UNITY_BEGIN();
    if (!make_files())
        return 1;
    RUN_TEST(test_nothing_is_made_without_memory_and_nothing_is_left);
    RUN_TEST(test_a_drums_command_without_memory_changes_nothing);
    RUN_TEST(test_a_performers_command_without_memory_changes_nothing);
    RUN_TEST(test_many_allocations_were_tried);
    himc_take_free(sample_take);
    static const char *const files[] = {BVH, C3D, TRC, SCORE, OUT ".bvh", OUT ".c3d", OUT ".trc"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        unlink(files[i]);
    return system("rm -r " MESH) == 0 ? UNITY_END() : 1;
}
