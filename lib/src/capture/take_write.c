/// take_write.c: a take into a file: text formats by printf in the C locale's way, C3D byte by
/// byte.
///
/// BVH and TRC are written y up, as their habit is: (x, y, z) of the library becomes (x, z, -y),
/// a rotation q becomes c q c* with c that quarter turn about x. BVH is in centimetres with the
/// angles of R = Rz Rx Ry, which makes sin x = R21, tan z = -R01/R11, tan y = -R20/R22; TRC is in
/// millimetres. What is written reads back to the last digit that is printed. Invariant: a file
/// that could not be written completely is removed.
#define _POSIX_C_SOURCE 200809L
#include "capture/take_write.h"

#include "capture/take_text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CENTIMETRES 100.0
#define MILLIMETRES 1000.0
#define DEGREES (180 / HIMC_PI)

// lib to file axes: a quarter turn about -x
static const himc_quat y_up = {0.70710678118654752, -0.70710678118654752, 0, 0};

static himc_vec3 upright(himc_vec3 x)
{
    return himc_vec3_make(x.x, x.z, -x.y);
}

// a number without the locale's decimal comma
static void put_number(FILE *file, double value, int digits)
{
    char text[64];
    snprintf(text, sizeof text, "%.*f", digits, value);
    for (char *c = text; *c; c++)
        if (*c == ',')
            *c = '.';
    fputs(text, file);
}

static void put_row(FILE *file, const double *value, int count, int digits, char separator)
{
    for (int i = 0; i < count; i++) {
        fputc(separator, file);
        put_number(file, value[i], digits);
    }
}

// Euler angles z, x, y (degrees) of a rotation in the library's axes
static void put_angles(FILE *file, himc_quat q)
{
    himc_mat3 r = himc_mat3_from_quat(himc_quat_mul(himc_quat_mul(y_up, q), himc_quat_conj(y_up)));
    double x = asin(fmin(fmax(r.m[2][1], -1), 1));
    double angles[3] = {atan2(-r.m[0][1], r.m[1][1]) * DEGREES, x * DEGREES,
                        atan2(-r.m[2][0], r.m[2][2]) * DEGREES};
    put_row(file, angles, 3, 6, ' ');
}

static bool is_leaf(const himc_take *take, int point)
{
    for (int i = point + 1; i < take->points; i++)
        if (take->parents[i] == point)
            return false;
    return take->parents[point] >= 0;
}

static void put_joint(FILE *file, const himc_take *take, int point, int depth)
{
    bool root = take->parents[point] < 0, leaf = is_leaf(take, point);
    himc_vec3 o = himc_vec3_scale(upright(take->offsets[point]), CENTIMETRES);
    double offset[3] = {o.x, o.y, o.z};
    char indent[80];
    snprintf(indent, sizeof indent, "%*s", depth < 70 ? depth : 70, "");
    if (leaf)
        fprintf(file, "%sEnd Site\n%s{\n%s\tOFFSET", indent, indent, indent);
    else
        fprintf(file, "%s%s %s\n%s{\n%s\tOFFSET", indent, root ? "ROOT" : "JOINT",
                take->names[point], indent, indent);
    put_row(file, offset, 3, 6, ' ');
    if (!leaf)
        fprintf(file, "\n%s\tCHANNELS %s", indent,
                root ? "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
                     : "3 Zrotation Xrotation Yrotation");
    fputc('\n', file);
    for (int i = point + 1; i < take->points; i++)
        if (take->parents[i] == point)
            put_joint(file, take, i, depth + 1);
    fprintf(file, "%s}\n", indent);
}

// one frame's channels of a joint and of what hangs on it, in the order of the hierarchy
static void put_channels(FILE *file, const himc_take *take, int frame, int point)
{
    if (is_leaf(take, point))
        return;
    if (take->parents[point] < 0) {
        himc_vec3 x = himc_vec3_scale(upright(*himc_take_at(take, frame, point)), CENTIMETRES);
        double place[3] = {x.x, x.y, x.z};
        put_row(file, place, 3, 6, ' ');
    }
    put_angles(file, himc_take_rotation(take, frame, point));
    for (int i = point + 1; i < take->points; i++)
        if (take->parents[i] == point)
            put_channels(file, take, frame, i);
}

static bool write_bvh(FILE *file, const himc_take *take, himc_error *error)
{
    if (!take->parents)
        return himc_error_set(error, "%s: has no skeleton, which a .bvh needs; allowed .c3d .trc",
                              take->file);
    fputs("HIERARCHY\n", file);
    put_joint(file, take, 0, 0);
    fprintf(file, "MOTION\nFrames: %d\nFrame Time: ", take->frames);
    put_number(file, 1 / take->rate, 9);
    fputc('\n', file);
    for (int frame = 0; frame < take->frames; frame++) {
        put_channels(file, take, frame, 0);
        fputc('\n', file);
    }
    return true;
}

static void put_marker_names(FILE *file, const himc_take *take)
{
    fputs("Frame#\tTime", file);
    for (int i = 0; i < take->points; i++)
        fprintf(file, "\t%s\t\t", take->names[i]);
    fputs("\n\t", file);
    for (int i = 1; i <= take->points; i++)
        fprintf(file, "\tX%d\tY%d\tZ%d", i, i, i);
    fputc('\n', file);
}

static bool write_trc(FILE *file, const himc_take *take, himc_error *error)
{
    (void)error;
    fprintf(file, "PathFileType\t4\t(X/Y/Z)\t%s\n", take->file);
    fputs("DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
          "OrigNumFrames\n",
          file);
    put_number(file, take->rate, 6);
    fputc('\t', file);
    put_number(file, take->rate, 6);
    fprintf(file, "\t%d\t%d\tmm\t", take->frames, take->points);
    put_number(file, take->rate, 6);
    fprintf(file, "\t1\t%d\n", take->frames);
    put_marker_names(file, take);
    for (int frame = 0; frame < take->frames; frame++) {
        fprintf(file, "%d\t", frame + 1);
        put_number(file, frame / take->rate, 6);
        for (int i = 0; i < take->points; i++) {
            himc_vec3 x = himc_vec3_scale(upright(*himc_take_at(take, frame, i)), MILLIMETRES);
            double place[3] = {x.x, x.y, x.z};
            if (himc_vec3_finite(x))
                put_row(file, place, 3, 4, '\t');
            else
                fputs("\t\t\t", file);
        }
        fputc('\n', file);
    }
    return true;
}

typedef bool (*writer)(FILE *file, const himc_take *take, himc_error *error);

static writer writer_of(const char *path)
{
    static const struct {
        const char *suffix;
        writer write;
    } formats[] = {{".bvh", write_bvh}, {".c3d", himc_c3d_write}, {".trc", write_trc}};
    size_t n = strlen(path);
    for (int i = 0; i < 3; i++)
        if (n > 4 && himc_span_is((himc_span){path + n - 4, 4}, formats[i].suffix))
            return formats[i].write;
    return NULL;
}

bool himc_take_is_writable(const char *path, himc_error *error)
{
    return writer_of(path) ||
           himc_error_set(error, "%s: not a take by its name, allowed .bvh .c3d .trc", path);
}

bool himc_take_save(const himc_take *take, const char *path, himc_error *error)
{
    writer write = writer_of(path);
    if (!write)
        return himc_take_is_writable(path, error);
    FILE *file = fopen(path, "wb");
    if (!file)
        return himc_error_set(error, "%s: cannot be written: %s", path, strerror(errno));
    errno = 0;
    bool good = write(file, take, error), lost = ferror(file);
    lost = fclose(file) != 0 || lost;
    if (good && lost)
        himc_error_set(error, "%s: cannot be written: %s", path, strerror(errno ? errno : EIO));
    if (!good || lost)
        remove(path);
    return good && !lost;
}
