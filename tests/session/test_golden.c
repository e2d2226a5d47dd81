/// test_golden.c: the bits of what is played and said. Each script in tests/golden is a session of
/// commands; hashes of its strikes, motion, sound and words are in tests/golden/bits.txt. A change
/// that is to change nothing changes none of them, on any processor and in any build. `make golden`
/// writes the table; the commit says which rows change, and why.
///
/// Four words of a script are its own: `wait SECONDS` plays; `sequence N` writes that sequence of
/// the motion database to build/golden.bvh; `file ENDING PATH` reads a copy with that ending, as a
/// take or a score; `DRUM COMMAND` is for that drum. The answer to a refused command is among the
/// words.
#include "take_files.h"

#include "himc/himc.h"
#include "mocap_sequences.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define FOLDER "tests/golden"
#define TABLE FOLDER "/bits.txt"
#define MADE "build/golden.bvh"
#define BLOCK 480                 // samples
#define BASIS 0xcbf29ce484222325u // of FNV-1a, as is the factor

enum { STRIKES, MOTION, SOUND, WORDS, PARTS };
static const char *const parts[] = {"strikes", "motion", "sound", "words"};

/// The hashes of a script (FNV-1a).
typedef struct bits {
    uint64_t part[PARTS];
} bits;

static bits now;
static himc_performance *p;

void setUp(void)
{
}

void tearDown(void)
{
}

static void mix(int part, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        now.part[part] = (now.part[part] ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u;
}

// all quiet NaN are one; so are both zeros
static void mix_numbers(int part, const double *x, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        double number = isnan(x[i]) ? 0.123 : x[i] + 0.0;
        mix(part, &number, sizeof number);
    }
}

static void mix_line(void *user, const char *line)
{
    (void)user;
    mix(WORDS, line, strlen(line) + 1);
}

// all of a row are numbers
static void mix_row(void *user, const himc_motion_row *row)
{
    (void)user;
    mix_numbers(MOTION, (const double *)row, sizeof *row / sizeof(double));
}

static void mix_event(const himc_event *e)
{
    const himc_strike *s = &e->strike;
    mix(WORDS, &e->kind, sizeof e->kind);
    if (e->kind == HIMC_EVENT_NOTE)
        mix_line(NULL, e->text);
    if (e->kind == HIMC_EVENT_BEAT)
        mix_numbers(WORDS, (double[]){e->beat, e->time}, 2);
    if (e->kind != HIMC_EVENT_STRIKE && e->kind != HIMC_EVENT_MISSED)
        return;
    mix(STRIKES, &s->hand, sizeof s->hand);
    mix(STRIKES, s->drum, strlen(s->drum) + 1);
    mix(STRIKES, s->nuance, strlen(s->nuance) + 1);
    mix_numbers(STRIKES,
                (double[]){s->time, s->x, s->y, s->velocity, s->force, s->impulse, s->duration,
                           s->planned_time, s->planned_x, s->planned_y, s->beat},
                11);
}

static void mix_drums(int n)
{
    double sound[BLOCK], displacement[BLOCK];
    himc_drum *drum;
    for (int i = 0; (drum = himc_performance_drum(p, i)); i++) {
        uint64_t start = himc_drum_time(drum) - (uint64_t)n;
        himc_drum_read(drum, start, n, sound, displacement);
        mix_numbers(SOUND, sound, (size_t)n);
        mix_numbers(SOUND, displacement, (size_t)n);
        for (int k = 1; k < 2; k++) {
            himc_drum_read_channel(drum, k, start, n, sound);
            mix_numbers(SOUND, sound, (size_t)n);
        }
    }
}

static void play(double seconds)
{
    double force[2][BLOCK];
    himc_event event;
    for (long left = lround(seconds * 48000); left > 0; left -= BLOCK) {
        int n = left < BLOCK ? (int)left : BLOCK;
        himc_performance_process(p, n, (double *[]){force[0], force[1]});
        mix_numbers(SOUND, force[0], (size_t)n);
        mix_numbers(SOUND, force[1], (size_t)n);
        mix_drums(n);
        while (himc_performance_event(p, &event))
            mix_event(&event);
    }
}

static void carry_out(const char *line);

static void copy_file(const char *from, const char *to)
{
    size_t size;
    char *bytes = read_all(from, &size);
    FILE *file = fopen(to, "wb");
    TEST_ASSERT_TRUE_MESSAGE(bytes && file && fwrite(bytes, 1, size, file) == size, from);
    fclose(file);
    free(bytes);
}

static void describe_file(const char *text)
{
    char ending[8], from[200], path[40], line[60];
    TEST_ASSERT_EQUAL_INT(2, sscanf(text, "%7s %199s", ending, from));
    snprintf(path, sizeof path, "build/golden.%s", ending);
    copy_file(from, path);
    if (strcmp(ending, "txt") == 0 || strcmp(ending, "mid") == 0) {
        snprintf(line, sizeof line, "score %s", path);
        carry_out(line);
        return;
    }
    himc_take_options options = himc_take_default();
    himc_error why = {""};
    himc_take *take = himc_take_load(path, &options, &why);
    if (!take)
        mix_line(NULL, why.text);
    else
        himc_take_describe(take, &options, mix_line, NULL);
    himc_take_free(take);
}

static void write_sequence(int index)
{
    himc_mocap *m = sequence(index);
    TEST_ASSERT_TRUE_MESSAGE(himc_mocap_write(m, MADE, &error), error.text);
    himc_mocap_free(m);
}

static himc_drum *drum_named(const char *line, const char **command)
{
    himc_drum *drum;
    for (int i = 0; (drum = himc_performance_drum(p, i)); i++) {
        size_t length = strlen(himc_drum_name(drum));
        *command = line + length + 1;
        if (strncmp(line, himc_drum_name(drum), length) == 0 && line[length] == ' ')
            return drum;
    }
    return NULL;
}

static void carry_out(const char *line)
{
    himc_command c;
    himc_error why = {""};
    const char *rest;
    himc_drum *drum = drum_named(line, &rest);
    bool good = drum ? himc_command_parse_text(&c, HIMC_DRUM, rest, &why) &&
                           himc_drum_command(drum, &c, &why)
                     : himc_command_parse_text(&c, HIMC_PERFORMER, line, &why) &&
                           himc_performance_command(p, &c, 0, &why);
    if (!good)
        mix_line(NULL, why.text);
}

static void do_line(const char *line)
{
    if (strncmp(line, "wait ", 5) == 0)
        play(atof(line + 5));
    else if (strncmp(line, "sequence ", 9) == 0)
        write_sequence(atoi(line + 9));
    else if (strncmp(line, "file ", 5) == 0)
        describe_file(line + 5);
    else if (line[0] != '#' && line[0] != '\0')
        carry_out(line);
}

static void describe_all(void)
{
    static const himc_description both[] = {HIMC_DESCRIBE_INFO, HIMC_DESCRIBE_STATE};
    himc_drum *drum;
    for (int k = 0; k < 2; k++) {
        himc_performance_describe(p, both[k], mix_line, NULL);
        for (int i = 0; (drum = himc_performance_drum(p, i)); i++)
            himc_drum_describe(drum, both[k], mix_line, NULL);
    }
    himc_performance_stats stats = himc_performance_measure(p);
    mix_numbers(WORDS,
                (double[]){stats.tip_rms, stats.stroke_height, stats.peak_force, stats.captured_rms,
                           stats.captured_most, stats.captured_speed_ratio, stats.peak_rate,
                           stats.peak_torque},
                8);
    mix(WORDS, &stats.limit_hits, sizeof stats.limit_hits);
}

static bits run(const char *name)
{
    char path[200], line[600];
    himc_performance_config config = himc_performance_default();
    now = (bits){{BASIS, BASIS, BASIS, BASIS}};
    snprintf(path, sizeof path, FOLDER "/%s.txt", name);
    FILE *script = fopen(path, "r");
    p = himc_performance_new(&config, &error);
    TEST_ASSERT_TRUE_MESSAGE(script && p, path);
    himc_performance_make_drums(p, true);
    himc_performance_on_motion(p, mix_row, NULL);
    while (fgets(line, sizeof line, script)) {
        line[strcspn(line, "\n")] = '\0';
        do_line(line);
    }
    describe_all();
    fclose(script);
    himc_performance_free(p);
    return now;
}

/// Of the C library's functions, by their addresses: on another library all bits differ.
static uint64_t library_bits(void)
{
    static double (*volatile const one[])(double) = {sin,  cos,  tan,  exp,  log,  expm1, log1p,
                                                     sinh, tanh, acos, asin, atan, cbrt};
    static double (*volatile const two[])(double, double) = {pow, atan2, hypot, fmod};
    now.part[0] = BASIS;
    for (int i = 1; i < 500; i++) {
        for (size_t k = 0; k < sizeof one / sizeof *one; k++)
            mix_numbers(0, (double[]){one[k](0.0019 * i)}, 1);
        for (size_t k = 0; k < sizeof two / sizeof *two; k++)
            mix_numbers(0, (double[]){two[k](0.019 * i, 1.7)}, 1);
    }
    return now.part[0];
}

static void write_row(FILE *table, const char *name)
{
    bits b = run(name);
    fprintf(table, "%-14s", name);
    for (int k = 0; k < PARTS; k++)
        fprintf(table, " %016llx", (unsigned long long)b.part[k]);
    fputc('\n', table);
}

// `names` are those of all scripts
static void write_table(char *const *names, int count)
{
    FILE *table = fopen(TABLE, "w");
    TEST_ASSERT_NOT_NULL(table);
    fprintf(table, "libm           %016llx\n", (unsigned long long)library_bits());
    for (int i = 0; i < count; i++)
        write_row(table, names[i]);
    fclose(table);
}

static void compare(const char *name, const unsigned long long want[PARTS])
{
    char what[200] = "";
    bits is = run(name);
    for (int k = 0; k < PARTS; k++)
        if (is.part[k] != want[k])
            snprintf(what + strlen(what), sizeof what - strlen(what), " %s", parts[k]);
    if (what[0] == '\0')
        return;
    printf("%s: other bits:%s\n", name, what);
    TEST_FAIL_MESSAGE(name);
}

static void test_the_same_commands_give_the_same_bits(void)
{
    char line[200], name[40];
    unsigned long long want[PARTS];
    int rows = 0;
    FILE *table = fopen(TABLE, "r");
    TEST_ASSERT_NOT_NULL(table);
    while (fgets(line, sizeof line, table)) {
        int fields =
            sscanf(line, "%39s %llx %llx %llx %llx", name, &want[0], &want[1], &want[2], &want[3]);
        if (fields == 2 && strcmp(name, "libm") == 0 && want[0] != library_bits()) {
            fclose(table);
            TEST_IGNORE_MESSAGE("the C library has other sines than that of the table");
        }
        if (fields == 1 + PARTS)
            compare(name, want), rows++;
    }
    fclose(table);
    printf("%d sessions\n", rows);
    TEST_ASSERT_TRUE(rows >= 20);
}

// with names as arguments the table is written, else compared
int main(int argc, char **argv)
{
    UNITY_BEGIN();
    if (argc > 1)
        write_table(argv + 1, argc - 1);
    else
        RUN_TEST(test_the_same_commands_give_the_same_bits);
    return UNITY_END();
}
