/// bench.c: `himc bench`: the speed of one core. It measures whole steps of a performance (alone,
/// with a drum that is struck, with joint limits) and the parts of a step; the solvers of inverse
/// kinematics; drums without a performer; the bank alone by its loops for each vector unit; the
/// performers with their drums that one core plays in real time; the worst of their blocks. With
/// --peers it runs other programs beside it (bench_peers.h).
///
/// It measures processor time, not elapsed time, and each figure is the median of five runs, so
/// other programs on the machine have little effect; of the bank alone the fastest of 40 parts of
/// a run, since what takes the caches away is not the bank.
#define _POSIX_C_SOURCE 200809L
#include "bench_peers.h"
#include "cli.h"
#include "himc/himc.h"
#include "body/posture.h"
#include "control/controller.h"
#include "control/setpoint.h"
#include "body/character.h"
#include "bank/bank.h"
#include "himc/membrane.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RUNS 5             // chosen: odd, for a median
#define RATE 48000         // sample rate (Hz)
#define PHYSICS 10000      // the default physics rate, and the repetitions of each part (Hz)
#define BLOCK 64           // Pd's block (samples)
#define SECONDS 2          // chosen: of each performance and drum (s)
#define MODES 1024         // chosen: of the drumhead that is measured alone
#define MODE_SAMPLES 24000 // chosen: half a second of it
#define BLOCKS (SECONDS * RATE / BLOCK)
#define BANK_MODES 960 // chosen: of the bank without a head, below a thousand
#define BANK_PARTS 40  // chosen: 20 s of it in all, 0.1 s of processor time
#define VERSIONS 3     // of the bank's loops
#define PARTS 6
#define ROWS (PARTS + HIMC_SOLVERS) // the parts of a step, then the solvers
#define DAMPING 0.01                // chosen: of DLS and Nakamura, in the range of use (m)

enum { JSON, PEERS };

static const cli_option options[] = {
    {"json", 0, NULL, "one JSON object instead of a table"},
    {"peers", 0, NULL, "other programs beside it, by the scripts of tests/bench/peers"},
    {0},
};

/// A performance that is measured.
typedef struct bench_piece {
    const char *key, *name;
    int drums;          ///< of the performer, with the default number of modes
    bool plays;         ///< four strokes a second, on its drums in turn
    const char *limits; ///< the atom of `limits`
} bench_piece;

static const bench_piece piece[] = {
    {"alone_us", "at rest, without a drum", 0, false, "off"},
    {"step_us", "one drum, four strokes a second", 1, true, "off"},
    {"limits_us", "at rest, limits ellipsoid", 0, false, "ellipsoid"},
    {"four_drums_us", "four drums, four strokes a second", 4, true, "off"},
};
enum { ALONE, STRUCK, LIMITED, FOUR_DRUMS, PIECES };

/// A drum without a performer that is measured.
typedef struct bench_drum {
    const char *key, *name, *settings[3];
    double strikes; ///< a second
} bench_drum;

static const bench_drum drum[] = {
    {"drum_200_ms",
     "a head of 200 modes, air, glide, four strikes a second",
     {"modes 200", "glide 1", "noise 0"},
     4},
    {"drum_200_no_glide_ms", "the same without glide", {"modes 200", "glide 0", "noise 0"}, 4},
    {"drum_auto_ms", "a drum as made, with its noise", {"modes auto", "glide 1", "noise 1"}, 4},
    {"drum_1000_ms", "a head of 1000 modes, air, glide", {"modes 1000", "glide 1", "noise 0"}, 4},
    {"silent_ms", "a silent one of 200 modes", {"modes 200", "glide 1", "noise 0"}, 0},
    {"snare_ms", "a snare, its wires on", {"shape shell snare", "wires 250", "modes auto"}, 4},
    {"crash_ms", "a crash of 18 inches", {"shape plate crash", "modes auto", "glide 1"}, 4},
    {"marimba_ms",
     "a marimba of three octaves",
     {"shape bar marimba 130.8 987.8", "modes auto", "glide 1"},
     4},
};
enum { DRUM_200, DRUM_NO_GLIDE, DRUM_AUTO, DRUM_1000, SILENT, SNARE, CRASH, MARIMBA, DRUMS };

/// Median of the runs.
typedef struct figures {
    double piece[PIECES];  ///< a step (us)
    double row[ROWS];      ///< (us)
    double drum[DRUMS];    ///< processor time for a second of sound (ms)
    double modes;          ///< that one core plays in real time
    double bank[VERSIONS]; ///< the same by each version of the bank's loops; 0: not on this machine
    double share, worst;   ///< of one performer with four drums, of the worst block's deadline (%)
} figures;

static const char *const part_name[PARTS] = {
    "targets between ticks",           "natural posture (at each tick)",
    "inverse kinematics and dynamics", "articulated inertia (in contact)",
    "reading the body back",           "physics engine alone"};

static double cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *value)
{
    qsort(value, RUNS, sizeof *value, by_size);
    return value[RUNS / 2];
}

/// Strokes on the drums in turn, hands in turn.
static bool add_strokes(himc_performance *p, int drums, himc_error *error)
{
    for (int i = 0; i < 4 * SECONDS; i++) {
        char text[64];
        snprintf(text, sizeof text, "stroke %g %s legato mf normal drum%d", 1 + i / 2.0,
                 himc_hand_name(i % 2 ? HIMC_LEFT : HIMC_RIGHT), i % drums);
        if (!cli_tell(p, text, NULL, error))
            return false;
    }
    return true;
}

static bool add_drums(himc_performance *p, int drums, himc_error *error)
{
    static const double left_most = 0.5, apart = 0.35; // of four, within reach (m)
    himc_performance_make_drums(p, true);
    for (int i = 0; i < drums; i++) {
        char text[64];
        snprintf(text, sizeof text, "drum drum%d 23", i);
        if (!cli_tell(p, text, NULL, error))
            return false;
        himc_command place;
        snprintf(text, sizeof text, "place 0.5 %g 0.85", left_most - apart * i);
        if (drums > 1 && (!himc_command_parse_text(&place, HIMC_DRUM, text, error) ||
                          !himc_drum_command(himc_performance_drum(p, i), &place, error)))
            return false;
    }
    return true;
}

/// A performance that begins with the next sample; NULL with the reason.
static himc_performance *begin_piece(const bench_piece *b, himc_error *error)
{
    himc_performance_config config = himc_performance_default();
    config.sample_rate = RATE;
    config.physics_rate = PHYSICS;
    himc_performance *p = himc_performance_new(&config, error);
    if (p && cli_tell(p, "tempo 120", NULL, error) && add_drums(p, b->drums, error) &&
        cli_tell(p, "limits", b->limits, error) &&
        (!b->plays || (add_strokes(p, b->drums, error) && cli_tell(p, "play", NULL, error)))) {
        cli_unwatch(p);
        return p;
    }
    himc_performance_free(p);
    return NULL;
}

/// Processor time of a step (us); negative with the reason.
static double time_piece(const bench_piece *b, himc_error *error)
{
    himc_performance *p = begin_piece(b, error);
    if (!p)
        return -1;
    double start = cpu_seconds();
    for (int done = 0; done < SECONDS * RATE; done += BLOCK)
        himc_performance_process(p, BLOCK, NULL);
    double taken = cpu_seconds() - start;
    himc_performance_free(p);
    return 1e6 * taken / (SECONDS * PHYSICS);
}

static void read_drums(himc_performance *p, uint64_t from)
{
    double sound[BLOCK];
    for (int i = 0; himc_performance_drum(p, i); i++)
        himc_drum_read(himc_performance_drum(p, i), from, BLOCK, sound, NULL);
}

/// One performer with four drums, block by block, as a host plays them. Each block counts with its
/// best of all runs, since what the piece asks of it is the same in all, and the rest is the
/// machine's.
static bool time_blocks(figures *f, himc_error *error)
{
    static double best[BLOCKS];
    const double deadline = (double)BLOCK / RATE;
    double sum = 0, worst = 0;
    for (int run = 0; run < RUNS; run++) {
        himc_performance *p = begin_piece(&piece[FOUR_DRUMS], error);
        if (!p)
            return false;
        for (int i = 0; i < BLOCKS; i++) {
            double start = cpu_seconds();
            himc_performance_process(p, BLOCK, NULL);
            read_drums(p, (uint64_t)i * BLOCK);
            double taken = cpu_seconds() - start;
            best[i] = run == 0 || taken < best[i] ? taken : best[i];
        }
        himc_performance_free(p);
    }
    for (int i = 0; i < BLOCKS; i++) {
        sum += best[i];
        worst = best[i] > worst ? best[i] : worst;
    }
    f->share = 100 * sum / (BLOCKS * deadline);
    f->worst = 100 * worst / deadline;
    return true;
}

/// A body in playing posture, on which the parts of a step work.
typedef struct bench_body {
    himc_skeleton skeleton;
    himc_posture posture;
    himc_setpoint from, to;
    himc_setpoint_course between;
    himc_body_state state;
    himc_controller controller;
    himc_reference reference;
    himc_character *character;
} bench_body;

static bool make_body(bench_body *b, himc_error *error)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_pose pose;
    *b = (bench_body){.to.time = 0.004};
    if (!himc_skeleton_init(&b->skeleton, &config, error))
        return false;
    himc_posture_init(&b->posture, &b->skeleton, 0.8675);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        b->from.tip[hand].x = himc_vec3_make(0.48, hand == HIMC_LEFT ? 0.1 : -0.1, 1.0);
    memcpy(b->to.tip, b->from.tip, sizeof b->to.tip);
    himc_posture_moving(&b->posture, b->from.tip, &b->from.posture);
    himc_posture_moving(&b->posture, b->to.tip, &b->to.posture);
    himc_setpoint_course_make(&b->between, &b->from, &b->to);
    memcpy(pose.joint, b->from.posture.joint, sizeof pose.joint);
    himc_pose_to_state(&b->skeleton, &pose, NULL, &b->state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&b->controller, &control, &b->skeleton, &b->state);
    b->character = himc_character_new(&b->skeleton, error);
    if (b->character)
        himc_character_place(b->character, &b->state);
    return b->character != NULL;
}

/// One tip's displacement as rotations of the arm's joints.
static void solve(const bench_body *b, himc_solver solver, int i)
{
    himc_arm_jacobian jacobian;
    himc_vec3 rotation[HIMC_ARM_JOINTS], error = {1e-3, 2e-3, -1e-6 * i};
    himc_arm_jacobian_at(&b->state, HIMC_RIGHT, &jacobian);
    himc_ik_solve(&jacobian, solver, DAMPING, error, rotation);
}

static void do_row(bench_body *b, int part, int i)
{
    himc_articulation articulation;
    himc_vec3 torque[HIMC_JOINTS] = {{0, 0, 0}}, relative[HIMC_JOINTS];
    if (part == 0)
        himc_setpoint_at(&b->between, 0.001 + 1e-9 * i, &b->reference);
    else if (part == 1)
        himc_posture_moving(&b->posture, b->to.tip, &b->to.posture);
    else if (part == 2)
        himc_controller_torques(&b->controller, &b->skeleton, &b->state, &b->reference, torque);
    else if (part == 3) {
        himc_articulate(&b->skeleton, &b->state, &articulation);
        himc_forward_dynamics(&b->skeleton, &b->state, &articulation, torque, NULL, relative);
    } else if (part == 4)
        himc_character_observe(b->character, &b->state);
    else if (part >= PARTS)
        solve(b, (himc_solver)(part - PARTS), i);
    else
        himc_character_step(b->character, torque, NULL, 0, 1.0 / PHYSICS);
}

static bool time_rows(double row[ROWS], himc_error *error)
{
    bench_body b;
    if (!make_body(&b, error))
        return false;
    for (int k = 0; k < ROWS; k++) {
        double start = cpu_seconds();
        for (int i = 0; i < PHYSICS; i++)
            do_row(&b, k, i);
        row[k] = 1e6 * (cpu_seconds() - start) / PHYSICS;
    }
    himc_character_free(b.character);
    return true;
}

/// Modes that a core computes in real time. The drumhead is tuned so low that all of them are below
/// half the sample rate, and has almost no losses, since modes that have died away cost nothing.
static double time_modes(himc_error *error)
{
    himc_head head = himc_head_default();
    static double first[BLOCK], *const sound = first;
    head.modes = MODES;
    head.air = false;
    head.decay_constant = 0.1;
    head.decay_square = 0;
    head.glide = 0;
    himc_membrane *membrane = himc_membrane_new(&head, RATE, error);
    if (!membrane)
        return -1;
    himc_membrane_push(membrane, 0.11, 0.07, 100);
    double start = cpu_seconds();
    for (int i = 0; i < MODE_SAMPLES; i += BLOCK)
        himc_membrane_run(membrane, BLOCK, &sound, NULL);
    double taken = cpu_seconds() - start;
    himc_membrane_free(membrane);
    return MODES * ((double)MODE_SAMPLES / RATE) / taken;
}

/// Modes that a core computes in real time with these loops: oscillators and one output alone.
/// Negative without memory.
static double time_bank(const himc_bank_kernel *kernel, himc_error *error)
{
    static _Alignas(64) double p[BANK_MODES], s[BANK_MODES], shape[BANK_MODES];
    static himc_oscillator many[BANK_MODES];
    double sound[BLOCK], *const out = sound;
    himc_readout heard = {.p = p, .s = s}, *const readouts = &heard;
    himc_bank *bank = himc_bank_new(BANK_MODES, error);
    if (!bank)
        return -1;
    for (int i = 0; i < BANK_MODES; i++) {
        many[i] = (himc_oscillator){500 + 100 * i, 0.1, 0.01};
        shape[i] = 1;
    }
    himc_bank_use(bank, kernel);
    himc_bank_set(bank, many, BANK_MODES, RATE);
    himc_bank_readout(bank, shape, shape, NULL, &heard);
    himc_bank_push(bank, shape, 1);
    double taken = INFINITY;
    for (int part = 0; part < BANK_PARTS; part++) {
        double start = cpu_seconds();
        for (int i = 0; i < MODE_SAMPLES; i += BLOCK)
            himc_bank_run(bank, BLOCK, &readouts, 1, &out);
        taken = fmin(taken, cpu_seconds() - start);
    }
    himc_bank_free(bank);
    return BANK_MODES * ((double)MODE_SAMPLES / RATE) / taken;
}

/// Processor time of a second of a drum's sound (ms); negative with the reason.
static double time_drum(const bench_drum *b, himc_error *error)
{
    static const double at = -0.17, velocity = 3; // chosen: near a rim (m), about f (m/s)
    himc_command command;
    himc_drum *d = himc_drum_new("drum", 26, RATE, error);
    if (d)
        himc_drum_watch(d, false);
    bool good = d;
    for (int i = 0; good && i < 3; i++)
        good = himc_command_parse_text(&command, HIMC_DRUM, b->settings[i], error) &&
               himc_drum_command(d, &command, error);
    int period = b->strikes > 0 ? (int)(RATE / b->strikes) / BLOCK * BLOCK : INT_MAX;
    double start = 0;
    for (int done = -SECONDS * (int)RATE; good && done < SECONDS * RATE; done += BLOCK) {
        if (done == 0) // the first seconds are not counted: memory is touched for the first time
            start = cpu_seconds();
        if (b->strikes > 0 && done % period == 0)
            good = himc_drum_strike_at(d, 0, at, 0, velocity, error);
        himc_drum_advance(d, BLOCK, NULL, NULL, NULL);
    }
    double taken = 1e3 * (cpu_seconds() - start) / SECONDS;
    himc_drum_release(d);
    return good ? taken : -1;
}

/// One run of everything. False with the reason.
static bool measure_once(figures *f, himc_error *error)
{
    f->modes = time_modes(error);
    f->share = f->worst = 0; // time_blocks
    bool good = f->modes >= 0 && time_rows(f->row, error);
    for (int i = 0; i < VERSIONS; i++) {
        const himc_bank_kernel *kernel = himc_bank_kernel_version(i);
        f->bank[i] = good && kernel ? time_bank(kernel, error) : 0;
        good = good && f->bank[i] >= 0;
    }
    for (int i = 0; i < PIECES; i++)
        good = good && (f->piece[i] = time_piece(&piece[i], error)) >= 0;
    for (int i = 0; i < DRUMS; i++)
        good = good && (f->drum[i] = time_drum(&drum[i], error)) >= 0;
    return good;
}

#define FIGURES ((int)(sizeof(figures) / sizeof(double))) // all members are doubles

static bool measure(figures *out, himc_error *error)
{
    union {
        figures f;
        double value[FIGURES];
    } run[RUNS], middle;
    for (int i = 0; i < RUNS; i++)
        if (!measure_once(&run[i].f, error))
            return false;
    for (int k = 0; k < FIGURES; k++) {
        double value[RUNS];
        for (int i = 0; i < RUNS; i++)
            value[i] = run[i].value[k];
        middle.value[k] = median(value);
    }
    *out = middle.f;
    return time_blocks(out, error);
}

/// Performers with one struck drum each that a core plays in real time; also the speed of such a
/// performance offline.
static double performers(const figures *f)
{
    return 1e6 / (f->piece[STRUCK] * PHYSICS);
}

static void print_table(const figures *f)
{
    printf("one step at %d Hz in all, with drums at %d Hz\n", PHYSICS, RATE);
    for (int k = 0; k < PIECES; k++)
        printf("  %-46s %8.2f us\n", piece[k].name, f->piece[k]);
    puts("parts of a step");
    for (int k = 0; k < PARTS; k++)
        printf("  %-46s %8.2f us\n", part_name[k], f->row[k]);
    printf("  %-46s %8.2f\n", "step with a drum / engine alone",
           f->piece[STRUCK] / f->row[PARTS - 1]);
    puts("inverse kinematics of one arm, by solver");
    for (int k = 0; k < HIMC_SOLVERS; k++)
        printf("  %-46s %9.3f us\n", himc_command_word(HIMC_COMMAND_SOLVER, 0, k).text,
               f->row[PARTS + k]);
    puts("a drum without a performer, for a second of sound");
    for (int k = 0; k < DRUMS; k++)
        printf("  %-46s %9.3f ms\n", drum[k].name, f->drum[k]);
    puts("one core plays in real time");
    printf("  %-46s %8.0f\n", "modes of a head, without glide and strokes", f->modes);
    for (int k = 0; k < VERSIONS && f->bank[k] > 0; k++)
        printf("  modes of the bank alone, %-21s %8.0f\n", himc_bank_kernel_version(k)->name,
               f->bank[k]);
    printf("  %-46s %8.2f\n", "performers with one drum", performers(f));
    puts("one performer, four drums, blocks of 64 samples");
    printf("  %-46s %8.2f %%\n", "of a core", f->share);
    printf("  %-46s %8.2f %%\n", "worst block, of its deadline", f->worst);
}

static void print_json(const figures *f)
{
    printf("{\"step_us\": %.3f, \"engine_step_us\": %.3f, \"step_ratio\": %.3f, "
           "\"modes_per_core\": %.0f, \"performers_per_core\": %.3f",
           f->piece[STRUCK], f->row[PARTS - 1], f->piece[STRUCK] / f->row[PARTS - 1], f->modes,
           performers(f));
    printf(", \"four_drums_percent\": %.3f, \"worst_block_percent\": %.3f", f->share, f->worst);
    for (int k = 0; k < VERSIONS && f->bank[k] > 0; k++)
        printf(", \"bank_%s_modes\": %.0f", himc_bank_kernel_version(k)->name, f->bank[k]);
    for (int k = 0; k < PIECES; k++)
        if (k != STRUCK)
            printf(", \"%s\": %.3f", piece[k].key, f->piece[k]);
    for (int k = 0; k < DRUMS; k++)
        printf(", \"%s\": %.4f", drum[k].key, f->drum[k]);
    puts("}");
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    figures f;
    if (!measure(&f, &error))
        return cli_fail(&cli_bench, "%s", error.text);
    if (arguments->value[JSON])
        print_json(&f);
    else
        print_table(&f);
    double ours[BENCH_PEER_ROWS] = {f.piece[ALONE], f.piece[STRUCK], f.modes, f.drum[DRUM_200]};
    if (arguments->value[PEERS] && !bench_print_peers(ours, &error))
        return cli_fail(&cli_bench, "%s", error.text);
    return cli_finish(&cli_bench);
}

const cli_call cli_bench = {
    "bench",
    "",
    "",
    "measures the cost of a step, of modes and of performers on this machine",
    "Processor time of one core, each figure the median of five runs.",
    options,
    run,
};
