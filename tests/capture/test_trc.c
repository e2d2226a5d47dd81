/// test_trc.c: TRC tables with every separator and unit, and tables with one wrong cell.
#include "take_files.h"

#include "capture/take.h"
#include "unity.h"

static himc_error error;

void setUp(void)
{
}

void tearDown(void)
{
}

// two markers 0.5 m apart; the header's frames, markers and units, and the rows are inserted
#define TABLE                                                            \
    "PathFileType\t4\t(X/Y/Z)\ta.trc\n"                                  \
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\n" \
    "100\t100\t%d\t%d\t%s\t100\n"                                        \
    "Frame#\tTime\tA\t\t\tB\t\t\n"                                       \
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n%s"

#define ROW_1 "1\t0.00\t1\t2\t3\t501\t2\t3\n"
#define ROW_2 "2\t0.01\t11\t12\t13\t501\t2\t3\n"

static himc_take *read_table(int frames, int markers, const char *units, const char *rows)
{
    char text[4000];
    snprintf(text, sizeof text, TABLE, frames, markers, units, rows);
    return read_text(text, "a.trc", NULL, &error);
}

static void check_point(const himc_take *take, int frame, int i, double x, double y, double z)
{
    himc_vec3 p = himc_take_point(take, frame, i);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, x, p.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, y, p.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, z, p.z);
}

static void test_y_up_millimetres_become_z_up_metres(void)
{
    himc_take *take = read_table(2, 2, "mm", ROW_1 ROW_2);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(2, himc_take_frames(take));
    TEST_ASSERT_EQUAL_INT(2, himc_take_points(take));
    TEST_ASSERT_EQUAL_DOUBLE(100, himc_take_rate(take));
    TEST_ASSERT_EQUAL_STRING("B", himc_take_point_name(take, 1));
    check_point(take, 0, 0, 0.001, -0.003, 0.002);
    check_point(take, 1, 0, 0.011, -0.013, 0.012);
    check_point(take, 1, 1, 0.501, -0.003, 0.002);
    himc_take_free(take);
}

static void test_commas_semicolons_and_line_ends_of_all_systems_are_read(void)
{
    static const char separators[] = ",;\t";
    static const char *const ends[] = {"\n", "\r\n", "\r"};
    char plain[2000], text[4000];
    snprintf(plain, sizeof plain, TABLE, 2, 2, "mm", ROW_1 ROW_2);
    for (int k = 0; k < 9; k++) {
        char *to = text;
        for (const char *c = plain; *c; c++)
            if (*c == '\n')
                to += sprintf(to, "%s", ends[k % 3]);
            else
                *to++ = *c == '\t' ? separators[k / 3] : *c;
        *to = 0;
        himc_take *take = read_text(text, "a.TRC", NULL, &error);
        TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
        check_point(take, 1, 0, 0.011, -0.013, 0.012);
        himc_take_free(take);
    }
}

static void test_centimetres_and_metres_are_scaled(void)
{
    static const char *const units[] = {"cm", "m", "Centimeters"};
    static const double size[] = {0.01, 1, 0.01};
    for (int i = 0; i < 3; i++) {
        char row[100];
        snprintf(row, sizeof row, "1\t0\t0\t0\t0\t%g\t0\t0\n", 0.7 / size[i]);
        himc_take *take = read_table(1, 2, units[i], row);
        TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
        check_point(take, 0, 1, 0.7, 0, 0);
        himc_take_free(take);
    }
}

static void test_empty_cells_nan_and_missing_cells_at_the_end_are_gaps(void)
{
    himc_take *take = read_table(3, 2, "mm",
                                 "1\t0.00\t\t\t\t501\t2\t3\n"
                                 "2\t0.01\tNaN\tNaN\tNaN\t501\t2\t3\n"
                                 "3\t0.02\t1\t2\t3\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(2, himc_take_missing(take, 0));
    TEST_ASSERT_EQUAL_INT(1, himc_take_missing(take, 1));
    TEST_ASSERT_TRUE(isnan(himc_take_point(take, 0, 0).x));
    TEST_ASSERT_TRUE(isnan(himc_take_point(take, 2, 1).z));
    himc_take_free(take);
}

static void test_zeros_after_a_jump_are_gaps_but_a_marker_at_zero_is_not(void)
{
    himc_take *take = read_table(3, 2, "mm",
                                 "1\t0.00\t0\t0\t0\t501\t2\t3\n"
                                 "2\t0.01\t0\t0\t0\t0\t0\t0\n"
                                 "3\t0.02\t0\t0\t0\t501\t2\t3\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(0, himc_take_missing(take, 0));
    TEST_ASSERT_EQUAL_INT(1, himc_take_missing(take, 1));
    himc_take_free(take);
}

static void test_the_note_of_zeros_names_the_first_marker_that_has_them(void)
{
    static const char *const rows[] = {"1\t0.00\t501\t2\t3\t501\t2\t3\n"
                                       "2\t0.01\t0\t0\t0\t0\t0\t0\n"
                                       "3\t0.02\t501\t2\t3\t501\t2\t3\n",
                                       "1\t0.00\t501\t2\t3\t501\t2\t3\n"
                                       "2\t0.01\t501\t2\t3\t0\t0\t0\n"
                                       "3\t0.02\t501\t2\t3\t501\t2\t3\n"};
    for (int first = 0; first < 2; first++) {
        char expected[160];
        himc_take *take = read_table(3, 2, "mm", rows[first]);
        TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
        snprintf(expected, sizeof expected,
                 "gaps: %d positions of exactly 0 0 0 after a jump are read as gaps, the first of "
                 "%s",
                 2 - first, himc_take_point_name(take, first));
        TEST_ASSERT_EQUAL_STRING(expected, take->notes[0]);
        himc_take_free(take);
    }
}

static void test_numbers_are_read_like_strtod(void)
{
    static const char *const numbers[] = {"0.1",
                                          "-123.456",
                                          "1e-3",
                                          ".5",
                                          "7.",
                                          "299.999",
                                          "1.5E2",
                                          "+12.25",
                                          "0.30000000000000004",
                                          "99.99999999999999",
                                          "123456789012345678901e-18",
                                          "2.5e-10"};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        char row[200];
        snprintf(row, sizeof row, "1\t0\t%s\t0\t0\t501\t0\t700\n", numbers[i]);
        himc_take *take = read_table(1, 2, "mm", row);
        TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
        double expected = strtod(numbers[i], NULL) * 0.001;
        TEST_ASSERT_DOUBLE_WITHIN(3e-16 * fabs(expected), expected, himc_take_point(take, 0, 0).x);
        himc_take_free(take);
    }
}

static void test_several_tabs_between_the_values_of_the_header_are_read(void)
{
    himc_take *take = read_text(
        "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
        "  100.0\t\t  100.0\t\t    1\t\t     1\t\t mm\nFrame#\tTime\tA\n\t\tX1\tY1\tZ1\n"
        "1\t0,00\t1,5\t2\t3\n",
        "a.trc", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_DOUBLE(100, himc_take_rate(take));
    TEST_ASSERT_EQUAL_INT(1, himc_take_points(take));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0015, fabs(himc_take_point(take, 0, 0).x));
    himc_take_free(take);
}

static void refuses(int frames, int markers, const char *units, const char *rows,
                    const char *reason)
{
    himc_take *take = read_table(frames, markers, units, rows);
    TEST_ASSERT_NULL_MESSAGE(take, reason);
    TEST_ASSERT_EQUAL_STRING(reason, error.text);
}

static void test_headers_that_disagree_with_the_rows_are_refused(void)
{
    refuses(3, 2, "mm", ROW_1 ROW_2, "a.trc: the header says 3 frames, the file has 2 rows");
    refuses(1, 2, "mm", ROW_1 ROW_2, "a.trc: the header says 1 frames, the file has 2 rows");
    refuses(1, 2, "mm", "", "a.trc: the header says 1 frames, the file has 0 rows");
    refuses(0, 2, "mm", "", "a.trc:3: NumFrames is \"0\", expected 1 .. 1000000");
    refuses(2, 3, "mm", ROW_1 ROW_2, "a.trc:4: the header says 3 markers, the file names 2");
    refuses(2, 1, "mm", ROW_1 ROW_2,
            "a.trc:4: marker \"B\" is above column 6, expected every third column, 3 .. 3");
    refuses(2, 9999, "mm", ROW_1 ROW_2,
            "a.trc:3: NumMarkers is 9999, more than the rows have cells for");
    refuses(2, 2, "ell", ROW_1 ROW_2, "a.trc:3: Units is \"ell\", expected mm, cm, m, in or ft");
}

static void test_a_rate_of_1_hz_is_refused(void)
{
    error.text[0] = 0;
    himc_take *take =
        read_text("PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n1\t1\t1\tmm\n"
                  "Frame#\tTime\tA\t\t\n\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n",
                  "a.trc", NULL, &error);
    TEST_ASSERT_NULL(take);
    TEST_ASSERT_EQUAL_STRING("a.trc: rate: 1 Hz, expected 20 .. 10000 Hz", error.text);
}

static void test_bad_cells_are_refused_with_line_and_marker(void)
{
    refuses(1, 2, "mm", "1\t0\t1\t2\tx\t1\t2\t3\n",
            "a.trc:7: A Z is \"x\", expected a number up to 1e8, or an empty cell for a gap");
    refuses(1, 2, "mm", "1\t0\t1\t2\t3\tinf\t2\t3\n",
            "a.trc:7: B X is \"inf\", expected a number up to 1e8, or an empty cell for a gap");
    refuses(1, 2, "mm", "1\t0\t1\t2\t3\t1e999\t2\t3\n",
            "a.trc:7: B X is \"1e999\", expected a number up to 1e8, or an empty cell for a gap");
    refuses(1, 2, "mm", "1\t0\t1\t2\t3\t0,5,1\t2\t3\n",
            "a.trc:7: B X is \"0,5,1\", expected a number up to 1e8, or an empty cell for a gap");
    refuses(1, 2, "mm", "1\t0\t1\t\t3\t1\t2\t3\n",
            "a.trc:7: A has 2 of its 3 coordinates, expected all or none");
    refuses(1, 2, "mm", "1\t0\t1\t2\t3\t1\t2\t3\t4\n",
            "a.trc:7: the cell after the last marker is \"4\", expected an empty cell");
    refuses(1, 2, "mm", "x\t0\t1\t2\t3\t1\t2\t3\n",
            "a.trc:7: Frame# is \"x\", expected a whole number");
}

static void test_every_prefix_of_a_file_is_refused_or_read(void)
{
    char text[2000];
    snprintf(text, sizeof text, TABLE, 2, 2, "mm", ROW_1 ROW_2);
    size_t whole = strlen(text), readable = 0;
    for (size_t size = 0; size <= whole; size++) {
        char *bytes = malloc(size + (size == 0));
        memcpy(bytes, text, size);
        himc_take *take = himc_take_read(bytes, size, "cut.trc", NULL, &error);
        readable += take != NULL;
        himc_take_free(take);
        free(bytes);
    }
    // only a prefix that ends between the last row's cells can pass for a whole file
    TEST_ASSERT_TRUE(readable >= 2 && readable < 20);
}

static void test_real_stroke_agrees_with_its_source(void)
{
    const char *path = shared_capture("drumstroke_pearl_240hz/stroke.trc");
    if (!path)
        TEST_IGNORE_MESSAGE("../shared/mocap is absent");
    himc_take *take = himc_take_load(path, NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(160, himc_take_frames(take));
    TEST_ASSERT_EQUAL_DOUBLE(240, himc_take_rate(take));
    check_point(take, 0, himc_take_find(take, "shoulder"), 0, 0, 0);
    check_point(take, 0, himc_take_find(take, "RTIP"), 0.55533, 0, -0.4356834);
    check_point(take, 159, himc_take_find(take, "ELBOW"), -0.0770491, 0, -0.2517718);
    himc_take_free(take);
}

static void test_real_table_of_652_frames_with_93_rows_is_refused(void)
{
    const char *path = shared_capture("upperlimb_pyomeca_100hz/markers.trc");
    if (!path)
        TEST_IGNORE_MESSAGE("../shared/mocap is absent");
    TEST_ASSERT_NULL(himc_take_load(path, NULL, &error));
    TEST_ASSERT_NOT_NULL(
        strstr(error.text, "markers.trc: the header says 652 frames, the file has 93 rows"));
}

// the same table with a correct header: z up by its own bodies, comma separated
static void test_real_table_with_a_correct_header_is_read_with_z_up(void)
{
    const char *path = shared_capture("upperlimb_pyomeca_100hz/markers.trc");
    if (!path)
        TEST_IGNORE_MESSAGE("../shared/mocap is absent");
    size_t size = 0;
    char *bytes = read_all(path, &size), *count = strstr(bytes, "100,100,652,");
    TEST_ASSERT_NOT_NULL(count);
    memcpy(count + 8, "93 ", 3);
    himc_take *take = himc_take_read(bytes, size, "markers.trc", NULL, &error);
    free(bytes);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(51, himc_take_points(take));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1918668,
                              himc_take_point(take, 0, himc_take_find(take, "ASISl")).z);
    himc_vec3 l = himc_take_point(take, 0, himc_take_find(take, "ASISl"));
    himc_vec3 r = himc_take_point(take, 0, himc_take_find(take, "ASISr"));
    TEST_ASSERT_TRUE(l.y - r.y > 0.2);
    himc_take_free(take);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_y_up_millimetres_become_z_up_metres);
    RUN_TEST(test_several_tabs_between_the_values_of_the_header_are_read);
    RUN_TEST(test_commas_semicolons_and_line_ends_of_all_systems_are_read);
    RUN_TEST(test_centimetres_and_metres_are_scaled);
    RUN_TEST(test_empty_cells_nan_and_missing_cells_at_the_end_are_gaps);
    RUN_TEST(test_zeros_after_a_jump_are_gaps_but_a_marker_at_zero_is_not);
    RUN_TEST(test_the_note_of_zeros_names_the_first_marker_that_has_them);
    RUN_TEST(test_numbers_are_read_like_strtod);
    RUN_TEST(test_headers_that_disagree_with_the_rows_are_refused);
    RUN_TEST(test_a_rate_of_1_hz_is_refused);
    RUN_TEST(test_bad_cells_are_refused_with_line_and_marker);
    RUN_TEST(test_every_prefix_of_a_file_is_refused_or_read);
    RUN_TEST(test_real_stroke_agrees_with_its_source);
    RUN_TEST(test_real_table_of_652_frames_with_93_rows_is_refused);
    RUN_TEST(test_real_table_with_a_correct_header_is_read_with_z_up);
    return UNITY_END();
}
