/// c3d_files.h: writes small C3D files in memory, byte by byte from the format's description, for
/// all processors.
#ifndef HIMC_TESTS_C3D_FILES_H
#define HIMC_TESTS_C3D_FILES_H

#include "capture/take.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum c3d_processor { C3D_INTEL = 84, C3D_DEC = 85, C3D_MIPS = 86 } c3d_processor;

typedef struct maker {
    c3d_processor processor;
    bool floats;
    int points, frames, first, analog;
    double rate, scale; // mm per integer step
    const char *units, *x_screen, *y_screen;
    bool long_frames; // the count goes to TRIAL and the header says 65535
    int events;       // 0, or 2 in the group EVENT
    int header_events;
    double mass, height; // of the player (kg, mm), in the group PROCESSING if not 0
    unsigned char *bytes;
    size_t size;
} maker;

// the bits of DEC's number nearest to the value; the reserved one for infinity and NaN
static inline uint32_t dec_bits(double value)
{
    int exponent;
    double mantissa = frexp(fabs(value), &exponent);
    uint32_t m = (uint32_t)lround(mantissa * 16777216.0);
    // rounding may carry into the next power of two
    if (m == 16777216u) {
        m = 8388608u;
        exponent++;
    }
    if (value == 0 || exponent < -127)
        return 0;
    if (!isfinite(value) || exponent > 127)
        return 0x80000000u;
    return (value < 0 ? 0x80000000u : 0) | (uint32_t)(exponent + 128) << 23 | (m - 8388608u);
}

// writes a number as the processor does: the inverse of himc_c3d_real
static inline void write_real(c3d_processor processor, double value, unsigned char *at)
{
    uint32_t bits;
    float narrow = (float)value;
    memcpy(&bits, &narrow, sizeof bits);
    if (processor == C3D_DEC)
        bits = dec_bits(value);
    // byte k of the file is this byte of the number, counted from the highest
    static const int order[3][4] = {{3, 2, 1, 0}, {1, 0, 3, 2}, {0, 1, 2, 3}};
    for (int k = 0; k < 4; k++)
        at[k] = (unsigned char)(bits >> (24 - 8 * order[processor - C3D_INTEL][k]));
}

static inline maker maker_default(c3d_processor processor, bool floats)
{
    return (maker){.processor = processor,
                   .floats = floats,
                   .points = 3,
                   .frames = 5,
                   .first = 1,
                   .analog = 4,
                   .rate = 250,
                   .scale = 0.1,
                   .units = "mm",
                   .x_screen = "+X",
                   .y_screen = "+Z"};
}

// coordinates of point i in frame f (mm); multiples of 0.1, which integers can represent
static inline double coordinate(int f, int i, int axis)
{
    return 0.1 * (axis == 0 ? 3000 + 7 * f : axis == 1 ? -1234 + 2110 * i : 9000 - 13 * f + 17 * i);
}

static inline void put_word(const maker *m, unsigned char *at, int value)
{
    unsigned char low = (unsigned char)(value & 255), high = (unsigned char)(value >> 8 & 255);
    at[0] = m->processor == C3D_MIPS ? high : low;
    at[1] = m->processor == C3D_MIPS ? low : high;
}

static inline unsigned char *put_name(unsigned char *at, int group, const char *name)
{
    size_t n = strlen(name);
    at[0] = (unsigned char)n;
    at[1] = (unsigned char)group;
    memcpy(at + 2, name, n);
    return at + 2 + n;
}

static inline unsigned char *put_group(const maker *m, unsigned char *at, int number,
                                       const char *name)
{
    at = put_name(at, -number, name);
    put_word(m, at, 3);
    at[2] = 0;
    return at + 3;
}

// `data` has a * b elements of |type| bytes; a = 0 for a scalar, b = 0 for one dimension
static inline unsigned char *put(const maker *m, unsigned char *at, int group, const char *name,
                                 int type, int a, int b, const unsigned char *data)
{
    int dimensions = (a > 0) + (b > 0), bytes = abs(type) * (a ? a : 1) * (b ? b : 1);
    at = put_name(at, group, name);
    put_word(m, at, 2 + 2 + dimensions + bytes + 1);
    at[2] = (unsigned char)type;
    at[3] = (unsigned char)dimensions;
    at += 4;
    if (a > 0)
        *at++ = (unsigned char)a;
    if (b > 0)
        *at++ = (unsigned char)b;
    memcpy(at, data, (size_t)bytes);
    at += bytes;
    *at++ = 0;
    return at;
}

static inline unsigned char *put_real(const maker *m, unsigned char *at, int group,
                                      const char *name, double value)
{
    unsigned char data[4];
    write_real(m->processor, value, data);
    return put(m, at, group, name, 4, 0, 0, data);
}

static inline unsigned char *put_integer(const maker *m, unsigned char *at, int group,
                                         const char *name, int value)
{
    unsigned char data[2];
    put_word(m, data, value);
    return put(m, at, group, name, 2, 0, 0, data);
}

static inline unsigned char *put_text(const maker *m, unsigned char *at, int group,
                                      const char *name, const char *text)
{
    return put(m, at, group, name, -1, (int)strlen(text), 0, (const unsigned char *)text);
}

static inline unsigned char *put_field(const maker *m, unsigned char *at, const char *name,
                                       int value)
{
    unsigned char data[4];
    put_word(m, data, value & 65535);
    put_word(m, data + 2, value >> 16);
    return put(m, at, 3, name, 2, 2, 0, data);
}

static inline unsigned char *put_events(const maker *m, unsigned char *at)
{
    unsigned char times[16];
    write_real(m->processor, 0, times);
    write_real(m->processor, 0.5, times + 4);
    write_real(m->processor, 1, times + 8);
    write_real(m->processor, 2.25, times + 12);
    at = put_group(m, at, 2, "EVENT");
    at = put_integer(m, at, 2, "USED", 2);
    at = put(m, at, 2, "TIMES", 4, 2, 2, times);
    at = put(m, at, 2, "LABELS", -1, 6, 2, (const unsigned char *)"StrikeApex  ");
    return put(m, at, 2, "CONTEXTS", -1, 5, 2, (const unsigned char *)"RightLeft ");
}

static inline void put_parameters(const maker *m, unsigned char *at)
{
    static const char labels[] = "LTIP  RTIP  HEAD  ";
    at[0] = 1;
    at[1] = 0x50;
    at[2] = 4;
    at[3] = (unsigned char)m->processor;
    at += 4;
    // a parameter before its group, as is allowed
    at = put_integer(m, at, 1, "USED", m->points);
    at = put_group(m, at, 1, "POINT");
    at = put_real(m, at, 1, "SCALE", m->floats ? -m->scale : m->scale);
    at = put_real(m, at, 1, "RATE", m->rate);
    at = put_text(m, at, 1, "UNITS", m->units);
    at = put(m, at, 1, "labels", -1, 6, m->points < 2 ? m->points : 2,
             (const unsigned char *)labels);
    at = put(m, at, 1, "LABELS2", -1, 6, 1, (const unsigned char *)labels + 12);
    at = put_text(m, at, 1, "X_SCREEN", m->x_screen);
    at = put_text(m, at, 1, "Y_SCREEN", m->y_screen);
    if (m->events)
        at = put_events(m, at);
    if (m->mass > 0) {
        at = put_group(m, at, 4, "PROCESSING");
        at = put_real(m, at, 4, "Bodymass", m->mass);
        at = put_real(m, at, 4, "Height", m->height);
    }
    if (m->long_frames) {
        at = put_group(m, at, 3, "TRIAL");
        at = put_field(m, at, "ACTUAL_START_FIELD", m->first);
        at = put_field(m, at, "ACTUAL_END_FIELD", m->first + m->frames - 1);
    }
    at[0] = 0;
    at[1] = 0;
}

static inline void put_header(const maker *m, unsigned char *at)
{
    int last = m->first + m->frames - 1;
    at[0] = 2;
    at[1] = 0x50;
    put_word(m, at + 2, m->points);
    put_word(m, at + 4, m->analog);
    put_word(m, at + 6, m->long_frames ? 1 : m->first);
    put_word(m, at + 8, m->long_frames ? 65535 : last);
    write_real(m->processor, m->floats ? -m->scale : m->scale, at + 12);
    put_word(m, at + 16, 6);
    put_word(m, at + 18, 2);
    write_real(m->processor, m->rate, at + 20);
    if (m->header_events) {
        put_word(m, at + 298, 12345);
        put_word(m, at + 300, m->header_events);
        write_real(m->processor, 0.25, at + 304);
        memcpy(at + 396, "RFS ", 4);
    }
}

static inline void put_frame(const maker *m, unsigned char *at, int f)
{
    for (int i = 0; i < m->points; i++)
        for (int k = 0; k < 4; k++) {
            // point 1 is lost in frame 3: zeros with residual -1
            bool lost = i == 1 && f == 3;
            double v = k == 3 ? (lost ? -1 : 0) : lost ? 0 : coordinate(f, i, k);
            int n = 4 * i + k;
            if (m->floats)
                write_real(m->processor, v, at + 4 * n);
            else
                put_word(m, at + 2 * n, k == 3 ? (int)v : (int)lround(v / m->scale));
        }
    // analog samples must not matter to the reader: NaNs and odd numbers
    size_t width = m->floats ? 4 : 2;
    memset(at + width * 4 * (size_t)m->points, 0xFF, width * (size_t)m->analog);
}

/// Makes m->bytes (to be freed) and m->size.
static inline void make(maker *m)
{
    size_t stride = (m->floats ? 4u : 2u) * (4 * (size_t)m->points + (size_t)m->analog);
    m->size = 512 * 5 + stride * (size_t)m->frames;
    m->bytes = calloc(1, m->size);
    put_header(m, m->bytes);
    put_parameters(m, m->bytes + 512);
    for (int f = 0; f < m->frames; f++)
        put_frame(m, m->bytes + 512 * 5 + stride * (size_t)f, f);
}

#endif
