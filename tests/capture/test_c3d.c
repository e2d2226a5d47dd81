/// test_c3d.c: C3D files of all three processors, floats and integers, written here byte by byte
/// from the format's description, and a real file compared with its export as text.
#define _POSIX_C_SOURCE 200809L // alarm
#include "c3d_files.h"
#include "capture/take.h"
#include "take_files.h"
#include "unity.h"

#include <unistd.h>

static himc_error error;

void setUp(void)
{
}

void tearDown(void)
{
}

static himc_take *read_made(const maker *m)
{
    himc_take *take = himc_take_read(m->bytes, m->size, "made.c3d", NULL, &error);
    return take;
}

static himc_take *read_maker(maker m)
{
    make(&m);
    himc_take *take = read_made(&m);
    free(m.bytes);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

// the left tip is not left of the right one, so the take is rotated by half a turn: x and y change
// sign
static void check_places(const himc_take *take, int frames, double tolerance)
{
    TEST_ASSERT_EQUAL_INT(frames, himc_take_frames(take));
    TEST_ASSERT_EQUAL_INT(3, himc_take_points(take));
    for (int f = 0; f < frames; f++)
        for (int i = 0; i < 3; i++) {
            himc_vec3 p = himc_take_point(take, f, i);
            TEST_ASSERT_EQUAL(!(i == 1 && f == 3), himc_vec3_finite(p));
            if (!himc_vec3_finite(p))
                continue;
            TEST_ASSERT_DOUBLE_WITHIN(tolerance, -0.001 * coordinate(f, i, 0), p.x);
            TEST_ASSERT_DOUBLE_WITHIN(tolerance, -0.001 * coordinate(f, i, 1), p.y);
            TEST_ASSERT_DOUBLE_WITHIN(tolerance, 0.001 * coordinate(f, i, 2), p.z);
        }
}

static void check_flavour(c3d_processor processor, bool floats)
{
    himc_take *take = read_maker(maker_default(processor, floats));
    check_places(take, 5, 1e-7);
    TEST_ASSERT_EQUAL_DOUBLE(250, himc_take_rate(take));
    TEST_ASSERT_EQUAL_STRING("LTIP", himc_take_point_name(take, 0));
    TEST_ASSERT_EQUAL_STRING("RTIP", himc_take_point_name(take, 1));
    TEST_ASSERT_EQUAL_STRING("HEAD", himc_take_point_name(take, 2));
    TEST_ASSERT_EQUAL_INT(1, himc_take_missing(take, 1));
    himc_take_free(take);
}

static void test_intel_floats_are_read(void)
{
    check_flavour(C3D_INTEL, true);
}

static void test_intel_integers_are_read(void)
{
    check_flavour(C3D_INTEL, false);
}

static void test_dec_floats_are_read(void)
{
    check_flavour(C3D_DEC, true);
}

static void test_dec_integers_are_read(void)
{
    check_flavour(C3D_DEC, false);
}

static void test_mips_floats_are_read(void)
{
    check_flavour(C3D_MIPS, true);
}

static void test_mips_integers_are_read(void)
{
    check_flavour(C3D_MIPS, false);
}

static void test_dec_numbers_have_the_documented_bytes(void)
{
    // 1.0 is 0x4080 0000 in VAX F; its first word comes first, low byte first
    static const unsigned char one[4] = {0x80, 0x40, 0, 0}, minus[4] = {0xC0, 0xC1, 0, 0},
                               zero[4] = {0, 0, 0, 0};
    unsigned char bytes[4];
    TEST_ASSERT_EQUAL_DOUBLE(1, himc_c3d_real(C3D_DEC, one));
    TEST_ASSERT_EQUAL_DOUBLE(-6, himc_c3d_real(C3D_DEC, minus));
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_c3d_real(C3D_DEC, zero));
    write_real(C3D_DEC, -6, bytes);
    TEST_ASSERT_EQUAL_MEMORY(minus, bytes, 4);
    static const unsigned char reserved[4] = {0, 0x80, 1, 0};
    TEST_ASSERT_TRUE(isnan(himc_c3d_real(C3D_DEC, reserved)));
}

static void test_numbers_survive_writing_and_reading_on_every_processor(void)
{
    for (c3d_processor p = C3D_INTEL; p <= C3D_MIPS; p++)
        for (double v = 1e-30; v < 1e30; v *= -7.3) {
            unsigned char bytes[4];
            write_real(p, v, bytes);
            TEST_ASSERT_EQUAL_DOUBLE((double)(float)v, himc_c3d_real(p, bytes));
            double below = copysign(exp2(ceil(log2(fabs(v)))) * (1 - 1e-9), v); // rounds to a power
            write_real(p, below, bytes);
            TEST_ASSERT_EQUAL_DOUBLE((double)(float)below, himc_c3d_real(p, bytes));
        }
}

static void test_more_than_65535_frames_come_from_the_trial_fields(void)
{
    maker m = maker_default(C3D_MIPS, false);
    m.frames = 70001;
    m.first = 100;
    m.analog = 0;
    m.long_frames = true;
    // the falling point would leave the range of the integers
    make(&m);
    himc_take *take = read_made(&m);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(70001, himc_take_frames(take));
    TEST_ASSERT_EQUAL_INT(100, himc_take_first_frame(take));
    himc_take_free(take);
    free(m.bytes);
}

static void test_events_count_from_frame_one_and_carry_their_context(void)
{
    maker m = maker_default(C3D_DEC, true);
    m.events = 2;
    m.first = 26; // 0.1 s
    himc_take *take = read_maker(m);
    TEST_ASSERT_EQUAL_INT(2, take->event_count);
    TEST_ASSERT_EQUAL_STRING("Right Strike", take->events[0].label);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, take->events[0].time);
    TEST_ASSERT_EQUAL_STRING("Left Apex", take->events[1].label);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 62.15, take->events[1].time);
    himc_take_free(take);
}

static void test_header_events_are_read_if_there_is_no_group(void)
{
    maker m = maker_default(C3D_MIPS, true);
    m.header_events = 1;
    himc_take *take = read_maker(m);
    TEST_ASSERT_EQUAL_INT(1, take->event_count);
    TEST_ASSERT_EQUAL_STRING("RFS", take->events[0].label);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, take->events[0].time);
    himc_take_free(take);
}

static void test_screen_axes_give_the_up_axis(void)
{
    maker m = maker_default(C3D_INTEL, true);
    m.y_screen = "+Y";
    himc_take *take = read_maker(m);
    // y up: (x, -z, y); RTIP is then right of LTIP, so nothing is rotated
    himc_vec3 p = himc_take_point(take, 0, 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.001 * coordinate(0, 2, 1), p.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, -0.001 * coordinate(0, 2, 2), p.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.001 * coordinate(0, 2, 0), p.x);
    himc_take_free(take);
}

static void test_what_is_written_is_read_again_with_its_analog_channels(void)
{
    himc_take *take = read_maker(maker_default(C3D_INTEL, true));
    enum { CHANNELS = 2, EACH = 3 };
    take->analog_channels = CHANNELS;
    take->analog_samples = EACH * take->frames;
    take->analog_rate = EACH * take->rate;
    free(take->analog_names);
    free(take->analog);
    take->analog_names = calloc(CHANNELS, sizeof *take->analog_names);
    take->analog = calloc((size_t)(CHANNELS * take->analog_samples), sizeof *take->analog);
    strcpy(take->analog_names[0], "left_force (N)");
    strcpy(take->analog_names[1], "counter");
    for (int i = 0; i < CHANNELS * take->analog_samples; i++)
        take->analog[i] = 0.25 * i - 3;
    char bytes[20000];
    FILE *file = tmpfile();
    TEST_ASSERT_TRUE_MESSAGE(himc_c3d_write(file, take, &error), error.text);
    rewind(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    himc_take *again = himc_take_read(bytes, size, "made.c3d", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(again, error.text);
    TEST_ASSERT_EQUAL_INT(CHANNELS, again->analog_channels);
    TEST_ASSERT_EQUAL_INT(take->analog_samples, again->analog_samples);
    TEST_ASSERT_EQUAL_DOUBLE(take->analog_rate, again->analog_rate);
    for (int i = 0; i < CHANNELS; i++)
        TEST_ASSERT_EQUAL_STRING(take->analog_names[i], again->analog_names[i]);
    for (int i = 0; i < CHANNELS * take->analog_samples; i++)
        TEST_ASSERT_EQUAL_DOUBLE(take->analog[i], again->analog[i]);
    check_places(again, 5, 1e-7);
    take->analog_channels = 256;
    TEST_ASSERT_FALSE(himc_c3d_write(NULL, take, &error));
    TEST_ASSERT_EQUAL_STRING("made.c3d: 256 analog channels, expected up to 255 in a .c3d",
                             error.text);
    take->analog_channels = CHANNELS;
    himc_take_free(take);
    himc_take_free(again);
}

// room for channels, but none
static void test_points_alone_are_written_and_read_again(void)
{
    himc_take *take = read_maker(maker_default(C3D_INTEL, true));
    free(take->analog);
    take->analog = calloc(1, sizeof *take->analog);
    take->analog_channels = take->analog_samples = 0;
    char bytes[20000];
    FILE *file = tmpfile();
    TEST_ASSERT_TRUE_MESSAGE(himc_c3d_write(file, take, &error), error.text);
    rewind(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    himc_take_free(take);
    take = himc_take_read(bytes, size, "made.c3d", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(0, take->analog_channels);
    check_places(take, 5, 1e-7);
    himc_take_free(take);
}

// makes a good file, damages it with `spoil`, and expects the reason
static void refuses(void (*spoil)(maker *), const char *reason)
{
    maker m = maker_default(C3D_INTEL, true);
    make(&m);
    spoil(&m);
    himc_take *take = read_made(&m);
    free(m.bytes);
    TEST_ASSERT_NULL_MESSAGE(take, reason);
    TEST_ASSERT_EQUAL_STRING(reason, error.text);
}

static void cut_header(maker *m)
{
    m->size = 100;
}

static void spoil_key(maker *m)
{
    m->bytes[1] = 7;
}

static void spoil_processor(maker *m)
{
    m->bytes[515] = 99;
}

static void spoil_points(maker *m)
{
    m->bytes[2] = 9;
}

static void spoil_frames(maker *m)
{
    m->bytes[8] = 0;
}

static void add_frames(maker *m)
{
    m->bytes[8] = 90;
}

static void spoil_start(maker *m)
{
    m->bytes[17] = 80;
}

static void test_broken_headers_are_refused_with_the_reason(void)
{
    refuses(cut_header, "made.c3d: 100 bytes, expected at least a header of 512");
    refuses(spoil_key, "made.c3d: begins with bytes 2 7, expected for C3D: 2 .. 255 and 80");
    refuses(spoil_processor, "made.c3d: processor is 99, expected 84 (Intel), 85 (DEC), 86 (MIPS)");
    refuses(spoil_points,
            "made.c3d: the header says 9 points, POINT:USED says 3, expected the same number");
    refuses(spoil_frames, "made.c3d: the header says 0 frames, expected 1 .. 1000000");
    refuses(add_frames, "made.c3d: the header says 90 frames of 64 bytes, the file has 5 frames");
    refuses(spoil_start, "made.c3d: the frames begin at block 20486, but the file has 6 blocks");
}

static void test_rates_of_1_hz_are_refused_and_2_khz_is_read(void)
{
    maker m = maker_default(C3D_INTEL, true);
    m.rate = 1;
    make(&m);
    TEST_ASSERT_NULL(read_made(&m));
    TEST_ASSERT_EQUAL_STRING("made.c3d: rate: 1 Hz, expected 20 .. 10000 Hz", error.text);
    free(m.bytes);
    m.rate = 2000;
    himc_take *take = read_maker(m);
    TEST_ASSERT_EQUAL_DOUBLE(2000, himc_take_rate(take));
    himc_take_free(take);
}

static void test_mass_and_height_of_the_player_are_read_if_plausible(void)
{
    maker m = maker_default(C3D_DEC, true);
    m.mass = 68.5;
    m.height = 1710;
    himc_take *take = read_maker(m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 68.5, take->mass);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.71, take->height);
    TEST_ASSERT_EQUAL_INT(0, take->note_count);
    himc_take_free(take);
    m.mass = 6850;
    take = read_maker(m);
    TEST_ASSERT_EQUAL_DOUBLE(0, take->mass);
    TEST_ASSERT_EQUAL_INT(1, take->note_count);
    TEST_ASSERT_EQUAL_STRING(
        "player: the file states 6850 kg and 1.71 m, ignored outside 30 .. 200 kg "
        "and 1.19 .. 2.21 m",
        take->notes[0]);
    himc_take_free(take);
}

static void test_units_in_metres_and_unknown_units(void)
{
    maker m = maker_default(C3D_INTEL, true);
    m.units = "furlong";
    make(&m);
    TEST_ASSERT_NULL(read_made(&m));
    TEST_ASSERT_EQUAL_STRING("made.c3d: POINT:UNITS is \"furlong\", expected mm, cm, m, in or ft",
                             error.text);
    free(m.bytes);
}

static void test_non_finite_coordinates_are_gaps(void)
{
    maker m = maker_default(C3D_INTEL, true);
    make(&m);
    memset(m.bytes + 512 * 5 + 4, 0xFF, 4);
    himc_take *take = read_made(&m);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(1, himc_take_missing(take, 0));
    TEST_ASSERT_FALSE(himc_vec3_finite(himc_take_point(take, 0, 0)));
    himc_take_free(take);
    free(m.bytes);
}

static void test_every_prefix_and_every_changed_byte_is_survived(void)
{
    for (int flavour = 0; flavour < 6; flavour++) {
        maker m = maker_default((c3d_processor)(C3D_INTEL + flavour / 2), flavour % 2);
        m.events = 2;
        make(&m);
        for (size_t size = 0; size < m.size; size++) {
            unsigned char *cut = malloc(size + (size == 0));
            memcpy(cut, m.bytes, size);
            TEST_ASSERT_NULL(himc_take_read(cut, size, "cut.c3d", NULL, &error));
            free(cut);
        }
        for (size_t i = 0; i < m.size; i++)
            for (int k = 0; k < 3; k++) {
                unsigned char old = m.bytes[i];
                m.bytes[i] = k == 0 ? 0 : k == 1 ? 255 : (unsigned char)(old ^ 0x80);
                himc_take_free(read_made(&m));
                m.bytes[i] = old;
            }
        free(m.bytes);
    }
}

static himc_take *load_trial(void)
{
    const char *path = shared_capture("upperlimb_pyomeca_100hz/markers_analogs.c3d");
    if (!path)
        TEST_IGNORE_MESSAGE("../shared/mocap is absent");
    himc_take *take = himc_take_load(path, NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static void test_real_file_has_as_many_gaps_as_its_source_says(void)
{
    himc_take *take = load_trial();
    TEST_ASSERT_EQUAL_INT(580, himc_take_frames(take));
    TEST_ASSERT_EQUAL_DOUBLE(100, himc_take_rate(take));
    TEST_ASSERT_EQUAL_INT(51, himc_take_points(take));
    static const struct {
        const char *name;
        int frames;
    } gaps[] = {{"SCAP_CP", 92}, {"LARMl", 49}, {"STERr", 32}, {"STERl", 31},
                {"STYLu", 29},   {"LASTC", 23}, {"MEDH", 22}};
    for (size_t i = 0; i < sizeof gaps / sizeof gaps[0]; i++)
        TEST_ASSERT_EQUAL_INT(gaps[i].frames,
                              himc_take_missing(take, himc_take_find(take, gaps[i].name)));
    himc_take_free(take);
}

// the exported text: after five lines, frame, sub frame, then x, y, z (mm) of each point; empty
// cells are gaps
static void read_export(himc_vec3 *x, int frames, int points)
{
    FILE *file = fopen(shared_capture("upperlimb_pyomeca_100hz/markers.csv"), "r");
    TEST_ASSERT_NOT_NULL(file);
    static char row[8192];
    for (int frame = -5; frame < frames; frame++) {
        TEST_ASSERT_NOT_NULL(fgets(row, sizeof row, file));
        char *at = row;
        for (int column = -2; frame >= 0 && column < 3 * points; column++) {
            char *end = at + strcspn(at, ",\r\n");
            double v = end > at ? atof(at) : NAN;
            himc_vec3 *p = &x[frame * points + (column < 0 ? 0 : column / 3)];
            if (column >= 0)
                *(column % 3 == 0 ? &p->x : column % 3 == 1 ? &p->y : &p->z) = v;
            at = *end == ',' ? end + 1 : end;
        }
    }
    fclose(file);
}

static void test_real_file_equals_its_export_as_text_to_a_micrometre(void)
{
    himc_take *take = load_trial();
    int frames = himc_take_frames(take), points = himc_take_points(take), compared = 0;
    himc_vec3 *known = calloc((size_t)(frames * points), sizeof *known);
    read_export(known, frames, points);
    // the take is rotated to the body's heading: the best rotation about the vertical, by least
    // squares
    double cosine = 0, sine = 0, worst = 0, worst_far = 0;
    for (int i = 0; i < frames * points; i++) {
        himc_vec3 p = himc_take_point(take, i / points, i % points), q = known[i];
        TEST_ASSERT_EQUAL(himc_vec3_finite(q), himc_vec3_finite(p));
        if (himc_vec3_finite(p)) {
            cosine += q.x * p.x + q.y * p.y;
            sine += q.x * p.y - q.y * p.x;
        }
    }
    double turn = atan2(sine, cosine);
    for (int i = 0; i < frames * points; i++) {
        himc_vec3 p = himc_vec3_scale(himc_take_point(take, i / points, i % points), 1000),
                  q = known[i];
        if (!himc_vec3_finite(p))
            continue;
        himc_vec3 back = {p.x * cos(turn) + p.y * sin(turn), p.y * cos(turn) - p.x * sin(turn),
                          p.z};
        himc_vec3 d = himc_vec3_sub(back, q);
        double most = fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z)));
        // the text has six digits: 0.001 mm below 1 m, 0.01 mm beyond
        bool far = fmax(fabs(q.x), fmax(fabs(q.y), fabs(q.z))) >= 1000;
        worst = far ? worst : fmax(worst, most);
        worst_far = far ? fmax(worst_far, most) : worst_far;
        compared++;
    }
    printf("c3d and csv: %d places, worst %.3g mm, beyond 1 m %.3g mm\n", compared, worst,
           worst_far);
    TEST_ASSERT_EQUAL_INT(580 * 51 - 305, compared);
    TEST_ASSERT_TRUE(worst < 1e-3);
    TEST_ASSERT_TRUE(worst_far < 6e-3);
    free(known);
    himc_take_free(take);
}

// a file of three points, of which the group POINT says that those with these labels are angles;
// and which states more frames than it has
static himc_take *read_with_angles(const char *labels, int count)
{
    maker m = maker_default(C3D_INTEL, true);
    make(&m);
    unsigned char *at = m.bytes + 512;
    while (at[0] || at[1]) // to the end of the parameters: each says how far it is to the next
        at += at == m.bytes + 512
                  ? 4
                  : 2 + abs((signed char)at[0]) + (at[2 + at[0]] | at[3 + at[0]] << 8);
    at = put(&m, at, 1, "ANGLES", -1, 4, count, (const unsigned char *)labels);
    put_integer(&m, at, 1, "LONG_FRAMES", 9);
    himc_take *take = read_made(&m);
    free(m.bytes);
    return take;
}

static const char *notes_of(const himc_take *take)
{
    static char text[1000];
    text[0] = 0;
    for (int i = 0; i < take->note_count; i++)
        strcat(strcat(text, take->notes[i]), "\n");
    return text;
}

static void test_values_of_a_model_are_no_points_and_missing_frames_are_told(void)
{
    himc_take *take = read_with_angles("HEADKNEE", 2);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(2, himc_take_points(take));
    TEST_ASSERT_EQUAL_INT(-1, himc_take_find(take, "HEAD"));
    TEST_ASSERT_EQUAL_STRING(
        "frames: the file states 9 but contains 5, 5 are read\n"
        "points: 1 of them are values of a model (angles, forces, ...) and left out\n",
        notes_of(take));
    himc_take_free(take);
    TEST_ASSERT_NULL(read_with_angles("HEADLTIPRTIP", 3));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "all points are values of a model"),
                                 error.text);
}

// what an earlier program has left behind the last parameter: its link, of another processor, leads
// into the frames
static void test_remains_behind_the_parameters_are_not_read(void)
{
    maker m = maker_default(C3D_MIPS, true);
    m.analog = 40;
    m.frames = 30;
    make(&m);
    unsigned char *at = m.bytes + 516;
    while (at[0] || at[1])
        at += 2 + abs((signed char)at[0]) + (at[2 + at[0]] << 8 | at[3 + at[0]]);
    at = put_text(&m, at, 1, "LABELS", "no name at all");
    TEST_ASSERT_EQUAL_HEX8(20, at[-19]); // the link
    at[-20] = 0x0A;
    himc_take *take = read_made(&m);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_STRING("LTIP", himc_take_point_name(take, 0));
    himc_take_free(take);
    free(m.bytes);
}

static void test_units_may_be_filled_with_nul(void)
{
    maker m = maker_default(C3D_INTEL, true);
    m.units = "cm??";
    make(&m);
    for (size_t i = 0; i + 4 < m.size; i++)
        if (memcmp(m.bytes + i, "cm??", 4) == 0)
            memset(m.bytes + i + 2, 0, 2);
    himc_take *take = read_made(&m);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_DOUBLE(0.01, take->file_unit);
    himc_take_free(take);
    free(m.bytes);
}

static void find_analog(void *user, const char *line)
{
    *(bool *)user |= strcmp(line, "analog: 2 channels of 4 samples at 500 Hz") == 0;
}

// two frames of three points and two channels of two samples: (raw - offset) scale general
static void test_analog_samples_are_scaled_and_named(void)
{
    static const unsigned char scale[] = {0, 0, 0, 0x3F, 0, 0, 0x80, 0x3F}; // 0.5, 1
    for (int floats = 0; floats < 2; floats++) {
        maker m = maker_default(C3D_INTEL, floats);
        m.frames = 2;
        make(&m);
        unsigned char *at = m.bytes + 516;
        while (at[0] || at[1])
            at += 2 + abs((signed char)at[0]) + (at[2 + at[0]] | at[3 + at[0]] << 8);
        at = put_group(&m, at, 9, "ANALOG");
        at = put_integer(&m, at, 9, "USED", 2);
        at = put_real(&m, at, 9, "GEN_SCALE", 0.1);
        at = put(&m, at, 9, "SCALE", 4, 2, 0, scale);
        at = put(&m, at, 9, "OFFSET", 2, 2, 0, (const unsigned char[]){10, 0, 0, 0});
        at = put(&m, at, 9, "LABELS", -1, 4, 2, (const unsigned char *)"EMG1Fz  ");
        put(&m, at, 9, "UNITS", -1, 2, 1, (const unsigned char *)"V ");
        size_t width = floats ? 4 : 2, stride = width * 16;
        for (int sample = 0; sample < 4; sample++)
            for (int channel = 0; channel < 2; channel++) {
                int raw = 100 * sample + channel;
                unsigned char *to = m.bytes + 512 * 5 + stride * (size_t)(sample / 2) +
                                    width * (12 + 2 * (size_t)(sample % 2) + (size_t)channel);
                if (floats)
                    write_real(C3D_INTEL, raw, to);
                else
                    put_word(&m, to, raw);
            }
        himc_take *take = read_made(&m);
        TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
        TEST_ASSERT_EQUAL_INT(4, take->analog_samples);
        TEST_ASSERT_EQUAL_DOUBLE(500, take->analog_rate);
        TEST_ASSERT_EQUAL_STRING("EMG1 (V)", take->analog_names[0]);
        TEST_ASSERT_EQUAL_STRING("Fz", take->analog_names[1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, (300 - 10) * 0.05, take->analog[6]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 201 * 0.1, take->analog[5]);
        bool told = false;
        himc_take_describe(take, NULL, find_analog, &told);
        TEST_ASSERT_TRUE(told);
        himc_take_free(take);
        free(m.bytes);
    }
}

static void test_one_of_several_subjects_is_chosen_by_name(void)
{
    static const char text[] =
        "Trajectories\n100\n,,Ida:A,,,Jon:A,,,Ida:B,,\nFrame,Sub Frame,X\n,,m,m,m\n"
        "1,0,.1,.2,.3,.4,.5,.6,.7,.8,.9\n2,0,.1,.2,.3,.4,.5,.6,.7,.8,.9\n";
    himc_take_options options = himc_take_default();
    options.subject = "ida";
    himc_take *take = himc_take_read(text, sizeof text - 1, "a.csv", &options, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(2, himc_take_points(take));
    TEST_ASSERT_EQUAL_STRING("Ida:B", himc_take_point_name(take, 1));
    TEST_ASSERT_EQUAL_DOUBLE(0.8, himc_take_point(take, 1, 1).y);
    himc_take_free(take);
    options.subject = "Max";
    TEST_ASSERT_NULL(himc_take_read(text, sizeof text - 1, "a.csv", &options, &error));
    TEST_ASSERT_EQUAL_STRING("a.csv: no subject Max, expected Ida Jon", error.text);
}

// a BVH of two roots: the second one's bones keep their parents
static void test_a_root_of_a_bvh_is_a_subject(void)
{
    static const char bones[] = "%s %s\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n"
                                "JOINT %sArm\n{\nOFFSET 30 0 0\nCHANNELS 0\n"
                                "End Site\n{\nOFFSET 30 0 0\n}\n}\n}\n";
    char one[400], two[400], text[1200];
    snprintf(one, sizeof one, bones, "ROOT", "Ida", "Ida");
    snprintf(two, sizeof two, bones, "ROOT", "Jon", "Jon");
    snprintf(text, sizeof text,
             "HIERARCHY\n%s%sMOTION\nFrames: 2\nFrame Time: 0.01\n0 90 0 50 90 0\n0 90 0 50 91 0\n",
             one, two);
    himc_take_options options = himc_take_default();
    options.subject = "Jon";
    himc_take *take = himc_take_read(text, strlen(text), "a.bvh", &options, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(3, himc_take_points(take));
    TEST_ASSERT_EQUAL_STRING("JonArm", himc_take_point_name(take, 1));
    TEST_ASSERT_EQUAL_INT(-1, himc_take_parent(take, 0));
    TEST_ASSERT_EQUAL_INT(0, himc_take_parent(take, 1));
    TEST_ASSERT_EQUAL_INT(1, himc_take_parent(take, 2));
    himc_take_free(take);
}

// 65025 labels of one character each
static unsigned char *put_labels(const maker *m, unsigned char *at, const char *name, int character)
{
    at = put_name(at, 1, name);
    put_word(m, at, 2 + 2 + 3 + 255 * 255 + 1);
    memcpy(at + 2, (unsigned char[]){0xFF, 3, 1, 255, 255}, 5);
    memset(at + 7, character, 255 * 255);
    at[7 + 255 * 255] = 0;
    return at + 7 + 255 * 255 + 1;
}

// compared one by one, 2e10 times, they took minutes: the alarm ends them
static void test_thousands_of_labels_and_of_model_outputs_take_no_time(void)
{
    static const char *const lists[] = {"ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS"};
    maker m = maker_default(C3D_INTEL, false);
    m.points = 65535;
    m.analog = 0;
    m.frames = 1;
    size_t parameters = 800 * 512;
    m.size = 512 + parameters + 8 * (size_t)m.points;
    m.bytes = calloc(1, m.size);
    put_header(&m, m.bytes);
    put_word(&m, m.bytes + 16, 802);
    unsigned char *at = m.bytes + 512;
    at[3] = C3D_INTEL;
    at = put_group(&m, at + 4, 1, "POINT");
    at = put_text(&m, at, 1, "UNITS", "mm");
    at = put_labels(&m, at, "LABELS", 'a');
    for (int k = 0; k < 5; k++)
        at = put_labels(&m, at, lists[k], 'b' + k);
    alarm(60);
    himc_take *take = read_made(&m);
    alarm(0);
    free(m.bytes);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(65535, himc_take_points(take));
    TEST_ASSERT_EQUAL_STRING("a", himc_take_point_name(take, 65024));
    TEST_ASSERT_EQUAL_STRING("P65026", himc_take_point_name(take, 65025));
    himc_take_free(take);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_intel_floats_are_read);
    RUN_TEST(test_what_is_written_is_read_again_with_its_analog_channels);
    RUN_TEST(test_points_alone_are_written_and_read_again);
    RUN_TEST(test_intel_integers_are_read);
    RUN_TEST(test_dec_floats_are_read);
    RUN_TEST(test_dec_integers_are_read);
    RUN_TEST(test_mips_floats_are_read);
    RUN_TEST(test_mips_integers_are_read);
    RUN_TEST(test_dec_numbers_have_the_documented_bytes);
    RUN_TEST(test_numbers_survive_writing_and_reading_on_every_processor);
    RUN_TEST(test_more_than_65535_frames_come_from_the_trial_fields);
    RUN_TEST(test_events_count_from_frame_one_and_carry_their_context);
    RUN_TEST(test_header_events_are_read_if_there_is_no_group);
    RUN_TEST(test_screen_axes_give_the_up_axis);
    RUN_TEST(test_broken_headers_are_refused_with_the_reason);
    RUN_TEST(test_rates_of_1_hz_are_refused_and_2_khz_is_read);
    RUN_TEST(test_mass_and_height_of_the_player_are_read_if_plausible);
    RUN_TEST(test_units_in_metres_and_unknown_units);
    RUN_TEST(test_non_finite_coordinates_are_gaps);
    RUN_TEST(test_every_prefix_and_every_changed_byte_is_survived);
    RUN_TEST(test_values_of_a_model_are_no_points_and_missing_frames_are_told);
    RUN_TEST(test_thousands_of_labels_and_of_model_outputs_take_no_time);
    RUN_TEST(test_real_file_has_as_many_gaps_as_its_source_says);
    RUN_TEST(test_real_file_equals_its_export_as_text_to_a_micrometre);
    RUN_TEST(test_remains_behind_the_parameters_are_not_read);
    RUN_TEST(test_units_may_be_filled_with_nul);
    RUN_TEST(test_analog_samples_are_scaled_and_named);
    RUN_TEST(test_one_of_several_subjects_is_chosen_by_name);
    RUN_TEST(test_a_root_of_a_bvh_is_a_subject);
    return UNITY_END();
}
