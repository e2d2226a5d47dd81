/// c3d_write.c: a take as C3D: a header, parameters, then x, y, z and a residual of every point.
///
/// Numbers are an Intel processor's floats in millimetres, so POINT:SCALE is -1 and of no meaning;
/// a gap has the residual -1. The library's axes are said by X_SCREEN +X, Y_SCREEN +Z. More than
/// 65535 frames are counted by TRIAL:ACTUAL_END_FIELD. Reference: the C3D file format user guide,
/// Motion Lab Systems 2008.
#include "capture/c3d_parameters.h"
#include "capture/take_write.h"

#include <stdlib.h>
#include <string.h>

#define BLOCK 512
#define MOST_LABELS 255 // a parameter's dimension is one byte
#define MILLIMETRES 1000.0

typedef struct bytes {
    unsigned char *at, *end;
} bytes;

static void put_byte(bytes *b, int value)
{
    if (b->at < b->end)
        *b->at++ = (unsigned char)value;
}

static void put_word(bytes *b, unsigned value)
{
    put_byte(b, (int)(value & 255));
    put_byte(b, (int)(value >> 8 & 255));
}

static void put_real(bytes *b, double value)
{
    unsigned char four[4];
    himc_c3d_put_real(C3D_INTEL, value, four);
    for (int i = 0; i < 4; i++)
        put_byte(b, four[i]);
}

static void put_text(bytes *b, const char *text, int width)
{
    size_t n = strlen(text);
    for (int i = 0; i < width; i++)
        put_byte(b, (size_t)i < n ? text[i] : ' ');
}

static void put_group(bytes *b, int group, const char *name)
{
    put_byte(b, (int)strlen(name));
    put_byte(b, -group);
    put_text(b, name, (int)strlen(name));
    put_word(b, 3);
    put_byte(b, 0);
}

// what comes before a parameter's data: `size` elements of |type| bytes, `other` of them; 0 for
// none
static void put_head(bytes *b, int group, const char *name, int type, int size, int other)
{
    int dimensions = (size > 0) + (other > 0);
    int data = abs(type) * (size ? size : 1) * (other ? other : 1);
    put_byte(b, (int)strlen(name));
    put_byte(b, group);
    put_text(b, name, (int)strlen(name));
    put_word(b, (unsigned)(2 + 2 + dimensions + data + 1));
    put_byte(b, type);
    put_byte(b, dimensions);
    if (size > 0)
        put_byte(b, size);
    if (other > 0)
        put_byte(b, other);
}

static void put_real_parameter(bytes *b, int group, const char *name, double value)
{
    put_head(b, group, name, 4, 0, 0);
    put_real(b, value);
    put_byte(b, 0);
}

static void put_word_parameter(bytes *b, int group, const char *name, int value)
{
    put_head(b, group, name, 2, 0, 0);
    put_word(b, (unsigned)value);
    put_byte(b, 0);
}

static void put_text_parameter(bytes *b, int group, const char *name, const char *text)
{
    put_head(b, group, name, -1, (int)strlen(text), 0);
    put_text(b, text, (int)strlen(text));
    put_byte(b, 0);
}

static void put_field(bytes *b, const char *name, unsigned value)
{
    put_head(b, 2, name, 2, 2, 0);
    put_word(b, value & 65535);
    put_word(b, value >> 16);
    put_byte(b, 0);
}

static void put_parameters(bytes *b, const himc_take *take, int blocks)
{
    int width = 1;
    for (int i = 0; i < take->points; i++)
        width = (int)strlen(take->names[i]) > width ? (int)strlen(take->names[i]) : width;
    unsigned char *begin = b->at;
    put_byte(b, 1);
    put_byte(b, 0x50);
    put_byte(b, blocks);
    put_byte(b, C3D_INTEL);
    put_group(b, 1, "POINT");
    put_word_parameter(b, 1, "USED", take->points);
    put_real_parameter(b, 1, "SCALE", -1);
    put_real_parameter(b, 1, "RATE", take->rate);
    put_word_parameter(b, 1, "DATA_START", 2 + blocks);
    put_word_parameter(b, 1, "FRAMES", take->frames < 65535 ? take->frames : 65535);
    put_text_parameter(b, 1, "UNITS", "mm");
    put_text_parameter(b, 1, "X_SCREEN", "+X");
    put_text_parameter(b, 1, "Y_SCREEN", "+Z");
    put_head(b, 1, "LABELS", -1, width, take->points);
    for (int i = 0; i < take->points; i++)
        put_text(b, take->names[i], width);
    put_byte(b, 0);
    put_group(b, 2, "TRIAL");
    put_field(b, "ACTUAL_START_FIELD", 1);
    put_field(b, "ACTUAL_END_FIELD", (unsigned)take->frames);
    b->at = begin + (size_t)blocks * BLOCK;
}

static void put_header(bytes *b, const himc_take *take, int blocks)
{
    unsigned char *begin = b->at;
    put_byte(b, 2);
    put_byte(b, 0x50);
    put_word(b, (unsigned)take->points);
    put_word(b, 0);
    put_word(b, 1);
    put_word(b, take->frames < 65535 ? (unsigned)take->frames : 65535);
    put_word(b, 0);
    put_real(b, -1);
    put_word(b, (unsigned)(2 + blocks));
    put_word(b, 0);
    put_real(b, take->rate);
    b->at = begin + BLOCK;
}

static void put_point(bytes *b, himc_vec3 x)
{
    bool seen = himc_vec3_finite(x);
    himc_vec3 mm = seen ? himc_vec3_scale(x, MILLIMETRES) : himc_vec3_make(0, 0, 0);
    put_real(b, mm.x);
    put_real(b, mm.y);
    put_real(b, mm.z);
    put_real(b, seen ? 0 : -1);
}

bool himc_c3d_write(FILE *file, const himc_take *take, himc_error *error)
{
    if (take->points > MOST_LABELS)
        return himc_error_set(error, "%s: %d points, a .c3d is written with up to %d", take->file,
                              take->points, MOST_LABELS);
    int blocks = 2 + (take->points * TAKE_NAME + BLOCK - 1) / BLOCK;
    size_t before = (size_t)(1 + blocks) * BLOCK, row = 16 * (size_t)take->points;
    unsigned char *room = calloc(1, before > row ? before : row);
    if (!room)
        return himc_error_set(error, "%s: no memory", take->file);
    bytes b = {room, room + before};
    put_header(&b, take, blocks);
    put_parameters(&b, take, blocks);
    fwrite(room, 1, before, file);
    for (int frame = 0; frame < take->frames; frame++) {
        b = (bytes){room, room + row};
        for (int i = 0; i < take->points; i++)
            put_point(&b, *himc_take_at(take, frame, i));
        fwrite(room, 1, row, file);
    }
    free(room);
    return true;
}
