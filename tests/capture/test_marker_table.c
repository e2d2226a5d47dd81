/// test_marker_table.c: tables of Vicon Nexus, of Qualisys and any CSV with NAME_x NAME_y NAME_z,
/// and the same with one thing wrong.
#include "take_files.h"
#include "unity.h"

static himc_error error;

void setUp(void)
{
    error.text[0] = 0;
}

void tearDown(void)
{
}

#define NEXUS_HEAD                                              \
    "Devices\n1000\n,,EMG\nFrame,Sub Frame,V\n,,V\n1,0,0.5\n\n" \
    "Trajectories,,,,,,,\n100,,,,,,,\n"                         \
    ",,Ida:LSHO,,,Ida:RTIP,,\n"                                 \
    "Frame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n"
#define NEXUS_ROWS "7,0,1,2,3,501,2,3\n8,0,11,12,13,,,\n\n1,2,nothing of this section\n"

#define TSV_HEAD                                                            \
    "NO_OF_FRAMES\t2\nNO_OF_CAMERAS\t8\nNO_OF_MARKERS\t2\nFREQUENCY\t200\n" \
    "DESCRIPTION\t--\nTIME_STAMP\t2020-01-01\nDATA_INCLUDED\t3D\n"          \
    "MARKER_NAMES\tLSHO\tRTIP\n"

static himc_take *read(const char *name, const char *text)
{
    himc_take *take = read_text(text, name, NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static void check_point(const himc_take *take, int frame, int i, double x, double y, double z)
{
    himc_vec3 p = himc_take_point(take, frame, i);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, x, p.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, y, p.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, z, p.z);
}

static void refused(const char *name, const char *text, const char *message)
{
    himc_take *take = read_text(text, name, NULL, &error);
    TEST_ASSERT_NULL(take);
    TEST_ASSERT_EQUAL_STRING(message, error.text);
}

static void test_nexus_trajectories_are_read_behind_another_section(void)
{
    himc_take *take = read("a.csv", NEXUS_HEAD NEXUS_ROWS);
    TEST_ASSERT_EQUAL_INT(2, himc_take_frames(take));
    TEST_ASSERT_EQUAL_INT(7, himc_take_first_frame(take));
    TEST_ASSERT_EQUAL_DOUBLE(100, himc_take_rate(take));
    TEST_ASSERT_EQUAL_STRING("Ida:RTIP", himc_take_point_name(take, 1));
    check_point(take, 0, 1, 0.501, 0.002, 0.003);
    check_point(take, 1, 0, 0.011, 0.012, 0.013);
    TEST_ASSERT_EQUAL_INT(1, himc_take_missing(take, 1));
    himc_take_free(take);
}

static void test_qualisys_tables_are_read_with_and_without_frame_and_time(void)
{
    static const char *const rows[] = {
        TSV_HEAD "1\t2\t3\t501\t2\t3\n11\t12\t13\t501\t2\t3\n",
        TSV_HEAD "TRAJECTORY_TYPES\tMeasured\tMixed\n"
                 "Frame\tTime\tLSHO X\tLSHO Y\tLSHO Z\tRTIP X\tRTIP Y\tRTIP Z\n"
                 "1\t0.0\t1\t2\t3\t501\t2\t3\n2\t0.005\t11\t12\t13\t501\t2\t3\n",
        TSV_HEAD "Frame\tLSHO X\tLSHO Y\tLSHO Z\tRTIP X\tRTIP Y\tRTIP Z\n"
                 "1\t1\t2\t3\t501\t2\t3\n2\t11\t12\t13\t501\t2\t3\n"};
    for (int i = 0; i < 3; i++) {
        himc_take *take = read("a.tsv", rows[i]);
        TEST_ASSERT_EQUAL_DOUBLE(200, himc_take_rate(take));
        TEST_ASSERT_EQUAL_STRING("RTIP", himc_take_point_name(take, 1));
        check_point(take, 1, 0, 0.011, 0.012, 0.013);
        check_point(take, 1, 1, 0.501, 0.002, 0.003);
        himc_take_free(take);
    }
}

static void test_columns_of_any_csv_are_found_by_name_and_unit(void)
{
    static const char *const heads[] = {
        "time,LSHO_x_cm,LSHO_y_cm,LSHO_z_cm,mood,RTIP_x_cm,RTIP_y_cm,RTIP_z_cm\n",
        "Time (s),LSHO X [cm],LSHO Y [cm],LSHO Z [cm],x,RTIP.x (cm),RTIP.y (cm),RTIP.z (cm)\n",
        "\"time_s\",\"LSHO_X_cm\",\"LSHO_Y_cm\",\"LSHO_Z_cm\",y,RTIP x cm,RTIP y cm,RTIP z cm\n"};
    for (int i = 0; i < 3; i++) {
        char text[600];
        snprintf(text, sizeof text, "%s0,1,2,3,good,51,2,3\n0.004,2,3,4,bad,51,2,3\n\n", heads[i]);
        himc_take *take = read("a.csv", text);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 250, himc_take_rate(take));
        TEST_ASSERT_EQUAL_INT(2, himc_take_points(take));
        TEST_ASSERT_EQUAL_STRING("RTIP", himc_take_point_name(take, 1));
        check_point(take, 1, 0, 0.02, 0.03, 0.04);
        check_point(take, 1, 1, 0.51, 0.02, 0.03);
        himc_take_free(take);
    }
}

static void test_time_behind_the_markers_and_semicolons_are_read(void)
{
    himc_take *take = read("a.csv", "A_x_m;A_y_m;A_z_m;B_x_m;B_y_m;B_z_m;time_s\n"
                                    "0;0;1;0.5;0;1;0\n0;0;1;0.5;0;1;0.01\n");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100, himc_take_rate(take));
    check_point(take, 0, 1, 0.5, 0, 1);
    himc_take_free(take);
}

static void test_rows_at_uneven_times_are_read_at_even_ones(void)
{
    // A moves at 1 m/s; the row at 30 ms is not there, and for a second none is
    char text[4000] = "time_s,A_x_m,A_y_m,A_z_m\n";
    for (int row = 0; row < 100; row++) {
        double t = row == 3 ? 0.035 : 0.01 * row + (row > 50 ? 0.2 : 0);
        snprintf(text + strlen(text), sizeof text - strlen(text), "%.3f,%.3f,0,1\n", t, t);
    }
    himc_take *take = read("a.csv", text);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100, himc_take_rate(take));
    TEST_ASSERT_EQUAL_INT(120, himc_take_frames(take));
    check_point(take, 0, 3, 0.03, 0, 1);
    check_point(take, 0, 50, 0.5, 0, 1);
    check_point(take, 0, 71, 0.71, 0, 1);
    TEST_ASSERT_EQUAL_INT(20, himc_take_missing(take, 0));
    himc_take_free(take);
    strcpy(text, "time_s,A_x_m,A_y_m,A_z_m\n"); // 60 Hz in hundredths is even
    for (int row = 0; row < 61; row++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%.2f,0,0,%d\n", row / 60.0, row);
    take = read("a.csv", text);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 60, himc_take_rate(take));
    check_point(take, 0, 31, 0, 0, 31);
    himc_take_free(take);
}

static void test_decimal_commas_are_read_where_no_comma_parts_the_cells(void)
{
    himc_take *take = read("a.csv", "time_s;A_x_m;A_y_m;A_z_m\n0;0,25;-1,5e-1;1\n0,01;0;0;1\n");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100, himc_take_rate(take));
    check_point(take, 0, 0, 0.25, -0.15, 1);
    himc_take_free(take);
    refused(
        "a.csv", "time_s;A_x_m;A_y_m;A_z_m\n0;1.250,25;0;1\n0,01;0;0;1\n",
        "a.csv:2: A X is \"1.250,25\", expected a number up to 1e8, or an empty cell for a gap");
}

#define MOTIVE_FIRST                                                        \
    "Format Version,1.23,Take Name,\"a, b\",Capture Frame Rate,240.000000," \
    "Export Frame Rate,120.000000,Rotation Type,Quaternion,Length Units,Centimeters\n\n"
#define MOTIVE_HEAD                                                                       \
    MOTIVE_FIRST                                                                          \
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,"            \
    "Rigid Body,Rigid Body,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,"        \
    "Marker,Marker,Marker\n"                                                              \
    ",Name,Stick,Stick,Stick,Stick,Stick,Stick,Stick,Stick,\"S:1\",\"S:1\",\"S:1\","      \
    "\"S:1\",\"S:1\",\"S:1\"\n,ID,1,1,1,1,1,1,1,1,2,2,2,2,2,2\n"                          \
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error," \
    "Position,Position,Position,Position,Position,Position\n"                             \
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,X,Y,Z\n"

static void test_motive_is_read_with_the_markers_as_measured(void)
{
    himc_take *take = read("a.csv", MOTIVE_HEAD "3,0.025,0,0,0,1,10,20,30,0.1,7,7,7,1,2,3\n"
                                                "4,0.033,,,,,,,,,7,7,7,4,5,6\n");
    TEST_ASSERT_EQUAL_INT(2, himc_take_points(take));
    TEST_ASSERT_EQUAL_STRING("Stick", himc_take_point_name(take, 0));
    TEST_ASSERT_EQUAL_STRING("S:1", himc_take_point_name(take, 1));
    TEST_ASSERT_EQUAL_DOUBLE(120, himc_take_rate(take));
    TEST_ASSERT_EQUAL_INT(3, himc_take_first_frame(take));
    TEST_ASSERT_EQUAL_INT(1, himc_take_missing(take, 0));
    // y is up in the file, z here
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.2, himc_take_point(take, 0, 0).z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.05, himc_take_point(take, 1, 1).z);
    himc_take_free(take);
}

static void test_motive_without_markers_or_header_is_refused(void)
{
    refused("a.csv", MOTIVE_FIRST "0,0.0,1,2,3\n",
            "a.csv:3: no line Frame,Time (Seconds),X,Y,Z,..., expected an export with a header");
    refused("a.csv",
            MOTIVE_FIRST ",,Bone,Bone,Bone\n,,A,A,A\n,,Rotation,Rotation,Rotation\n"
                         "Frame,Time (Seconds),X,Y,Z\n0,0,1,2,3\n",
            "a.csv:6: no columns Position, expected an export with markers, rigid bodies or bones");
    refused("a.csv", "Format Version,1.23,Export Frame Rate,fast\n",
            "a.csv:1: Export Frame Rate is no number (Hz)");
}

static void test_wrong_tables_are_refused_where_they_are_wrong(void)
{
    refused("a.csv", "Devices\n1000\n",
            "a.csv: no section Trajectories, expected an export with trajectories");
    refused("a.csv", "Trajectories\nfast\n", "a.csv:2: no rate, expected frames per second (Hz)");
    refused("a.csv", "Trajectories\n100\n,,,\n",
            "a.csv:3: no names of markers, expected one above each first column");
    refused("a.csv", "Trajectories\n100\n,,A,B,C\n",
            "a.csv:3: two names less than three columns apart");
    refused("a.csv", NEXUS_HEAD "\n", "a.csv:12: no rows");
    refused(
        "a.csv", NEXUS_HEAD "7,0,1,2,3,soon,2,3\n",
        "a.csv:13: Ida:RTIP X is \"soon\", expected a number up to 1e8, or an empty cell for a gap");
    refused("a.csv", NEXUS_HEAD "7,0,1,2,3,1,2\n",
            "a.csv:13: Ida:RTIP has 2 of its 3 coordinates, expected all or none");
    refused("a.csv", "Trajectories\n100\n,,A,,,B\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,m,m,m\n",
            "a.csv:5: markers in several units, expected one");
    refused("a.tsv", TSV_HEAD, "a.tsv:8: no rows, expected a TSV with MARKER_NAMES, then numbers");
    refused("a.tsv", "NO_OF_FRAMES\t1\n1\t2\t3\n", "a.tsv:1: no MARKER_NAMES before the rows");
    refused("a.csv", "A_x_m,A_y_m,A_z_m\n1,2,3\n", "a.csv:1: no column time (s)");
    refused("a.csv", "time,A_x_m,A_y_m,A_z_m\n0,1,2,3\n", "a.csv:1: one row: no rate");
    refused("a.csv", "time,A_x_m,A_y_m,A_z_m\n0,1,2,3\nx,1,2,3\n",
            "a.csv:3: the time is \"x\", expected a number");
    refused("a.csv", "A_x_m,A_y_m,A_z_m,time\n1,2,3,0\n1,2,3\n",
            "a.csv:3: the time is \"\", expected a number");
    refused("a.csv", "time,A_x_m,A_y_m,A_z_m,B_x_mm,B_y_mm,B_z_mm\n",
            "a.csv:1: markers in several units, expected one");
}

static void test_captures_that_are_not_read_are_refused_with_the_way_out(void)
{
    refused(
        "a.AMC", "x",
        "a.AMC: Acclaim motion, which is not read: convert it with its .asf to .bvh (Blender, amc2bvh)");
    refused("a.fbx", "x",
            "a.fbx: Autodesk FBX, which is not read: import it into Blender and export .bvh");
}

static void test_tables_are_not_written(void)
{
    himc_take *take = read("a.csv", NEXUS_HEAD NEXUS_ROWS);
    TEST_ASSERT_FALSE(himc_take_save(take, "build/a.csv", &error));
    TEST_ASSERT_EQUAL_STRING("build/a.csv: a format that is not written, expected .bvh .c3d .trc",
                             error.text);
    himc_take_free(take);
}

// the same trial as TRC's sister by Nexus itself
static void test_nexus_own_export_is_the_c3d_of_the_same_trial(void)
{
    const char *path = shared_capture("upperlimb_pyomeca_100hz/markers.csv");
    if (!path)
        TEST_IGNORE_MESSAGE("needs ../shared/mocap");
    himc_take *csv = himc_take_load(path, NULL, &error);
    himc_take *c3d =
        himc_take_load(shared_capture("upperlimb_pyomeca_100hz/markers_analogs.c3d"), NULL, &error);
    TEST_ASSERT_TRUE_MESSAGE(csv && c3d, error.text);
    TEST_ASSERT_EQUAL_INT(himc_take_frames(c3d), himc_take_frames(csv));
    for (int i = 0; i < himc_take_points(csv); i++) {
        int other = himc_take_find(c3d, himc_take_point_name(csv, i));
        himc_vec3 a = himc_take_point(csv, 100, i), b = himc_take_point(c3d, 100, other);
        TEST_ASSERT_TRUE(other >= 0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, b.x, a.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, b.z, a.z);
    }
    himc_take_free(csv);
    himc_take_free(c3d);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_nexus_trajectories_are_read_behind_another_section);
    RUN_TEST(test_qualisys_tables_are_read_with_and_without_frame_and_time);
    RUN_TEST(test_columns_of_any_csv_are_found_by_name_and_unit);
    RUN_TEST(test_time_behind_the_markers_and_semicolons_are_read);
    RUN_TEST(test_rows_at_uneven_times_are_read_at_even_ones);
    RUN_TEST(test_decimal_commas_are_read_where_no_comma_parts_the_cells);
    RUN_TEST(test_motive_is_read_with_the_markers_as_measured);
    RUN_TEST(test_motive_without_markers_or_header_is_refused);
    RUN_TEST(test_wrong_tables_are_refused_where_they_are_wrong);
    RUN_TEST(test_captures_that_are_not_read_are_refused_with_the_way_out);
    RUN_TEST(test_tables_are_not_written);
    RUN_TEST(test_nexus_own_export_is_the_c3d_of_the_same_trial);
    return UNITY_END();
}
