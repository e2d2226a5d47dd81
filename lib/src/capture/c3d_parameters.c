/// c3d_parameters.c: C3D's parameter section: a chain of records, groups (negative number) and
/// parameters (positive), in any order; each gives the distance to the next, from its own place.
///
///     name length, +-group, name, distance to next, [type, dimensions, sizes..., data], text
///
/// Numbers are Intel's (little endian, IEEE), MIPS's (big endian, IEEE) or DEC's: little-endian
/// words, high word first, sign, 8 bits of exponent e and 23 of mantissa m with value (1/2 + m /
/// 2^24) 2^(e - 128) and no infinities; e = 0 is zero, or reserved if the sign is set. Reference:
/// the C3D file format user guide, Motion Lab Systems 2008. Invariant: for any contents
/// nothing outside [bytes, bytes + size) is read; the walk always moves forward.
#include "capture/c3d_parameters.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

unsigned himc_c3d_word(c3d_processor processor, const unsigned char *at)
{
    return processor == C3D_MIPS ? (unsigned)(at[0] << 8 | at[1]) : (unsigned)(at[1] << 8 | at[0]);
}

int himc_c3d_integer(c3d_processor processor, const unsigned char *at)
{
    int word = (int)himc_c3d_word(processor, at);
    return word < 32768 ? word : word - 65536;
}

double himc_c3d_real(c3d_processor processor, const unsigned char *at)
{
    uint32_t first = himc_c3d_word(processor, at), second = himc_c3d_word(processor, at + 2);
    uint32_t bits = processor == C3D_INTEL ? second << 16 | first : first << 16 | second;
    if (processor == C3D_DEC) {
        int exponent = (int)(bits >> 23 & 255);
        double mantissa = 0.5 + (double)(bits & 0x7FFFFF) / 16777216.0;
        if (exponent == 0)
            return bits >> 31 ? NAN : 0;
        return ldexp(bits >> 31 ? -mantissa : mantissa, exponent - 128);
    }
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

// reads the value at `at`; false if it goes beyond the end of the file
static bool read_value(c3d_parameter *q, const unsigned char *at, const unsigned char *end)
{
    if (end - at < 2)
        return false;
    q->type = at[0] < 128 ? at[0] : at[0] - 256;
    q->dimensions = at[1];
    at += 2;
    if ((q->type != -1 && q->type != 1 && q->type != 2 && q->type != 4) || q->dimensions > 7 ||
        end - at < q->dimensions)
        return false;
    int64_t count = 1;
    for (int i = 0; i < q->dimensions; i++) {
        q->size[i] = *at++;
        count *= q->size[i];
        if (count > end - at)
            return false;
    }
    if (count * abs(q->type) > end - at)
        return false;
    q->count = (int)count;
    q->data = at;
    return true;
}

// reads the record at *at and moves *at to the next, to NULL after the last
static bool read_record(c3d_parameters *p, const unsigned char **at,
                        const unsigned char *section_end, const unsigned char *end,
                        himc_error *error)
{
    const unsigned char *a = *at;
    bool fits = end - a >= 2;
    int length = fits ? abs(a[0] < 128 ? a[0] : a[0] - 256) : 0;
    int group = fits ? (a[1] < 128 ? a[1] : a[1] - 256) : 0;
    if (fits && (length == 0 || group == 0)) {
        *at = NULL;
        return true;
    }
    if (!fits || end - a < length + 4)
        return himc_error_set(error, "its parameters go beyond the end of the file");
    c3d_parameter q = {.group = abs(group)};
    for (int i = 0; i < length && i < (int)sizeof q.name - 1; i++) {
        int c = a[2 + i];
        q.name[i] = (char)(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    }
    const unsigned char *link = a + 2 + length;
    if (group < 0 && q.group < C3D_GROUPS)
        memcpy(p->groups[q.group], q.name, sizeof q.name);
    if (group > 0 && !read_value(&q, link + 2, end))
        return himc_error_set(error, "parameter %.23s does not fit into the file", q.name);
    if (group > 0 && (p->count & (p->count - 1)) == 0) { // grown by doubling
        c3d_parameter *grown =
            realloc(p->list, (size_t)(p->count ? 2 * p->count : 1) * sizeof *grown);
        if (!grown)
            return himc_error_set(error, "no memory");
        p->list = grown;
    }
    if (group > 0)
        p->list[p->count++] = q;
    unsigned distance = himc_c3d_word(p->processor, link);
    if (distance != 0 && (distance < 2 || distance >= (size_t)(end - link)))
        return himc_error_set(
            error, "the record after parameter %.23s is beyond the end of the file", q.name);
    *at = distance == 0 ? NULL : link + distance;
    // a next record outside the section that is not where this one ends is a remnant of an earlier
    // file: some of the format's own test suite have such behind their last
    if (group > 0 && *at > section_end) {
        const unsigned char *text = q.data + (size_t)q.count * (size_t)abs(q.type);
        if (text >= end || *at != text + 1 + *text)
            *at = NULL;
    }
    return true;
}

bool himc_c3d_parameters_read(c3d_parameters *p, const unsigned char *bytes, size_t size,
                              size_t offset, himc_error *error)
{
    *p = (c3d_parameters){.processor = C3D_INTEL};
    if (offset + 4 > size)
        return himc_error_set(error, "its parameters begin at byte %zu, but the file has %zu bytes",
                              offset, size);
    int processor = bytes[offset + 3];
    if (processor < C3D_INTEL || processor > C3D_MIPS)
        return himc_error_set(error, "processor is %d, expected 84 (Intel), 85 (DEC), 86 (MIPS)",
                              processor);
    p->processor = (c3d_processor)processor;
    size_t section = offset + (size_t)C3D_BLOCK * bytes[offset + 2];
    const unsigned char *at = bytes + offset + 4;
    const unsigned char *section_end = bytes + (section < size ? section : size);
    while (at)
        if (!read_record(p, &at, section_end, bytes + size, error))
            return false;
    return true;
}

void himc_c3d_parameters_free(c3d_parameters *p)
{
    free(p->list);
    p->list = NULL;
    p->count = 0;
}

const c3d_parameter *himc_c3d_find(const c3d_parameters *p, const char *group, const char *name)
{
    for (int i = 0; i < p->count; i++) {
        const c3d_parameter *q = &p->list[i];
        if (q->group < C3D_GROUPS && strcmp(p->groups[q->group], group) == 0 &&
            strcmp(q->name, name) == 0)
            return q;
    }
    return NULL;
}

double himc_c3d_number(const c3d_parameters *p, const c3d_parameter *q, int index, double fallback)
{
    assert(index >= 0);
    if (!q || index >= q->count || q->type == -1)
        return fallback;
    if (q->type == 1)
        return q->data[index];
    if (q->type == 2)
        return himc_c3d_word(p->processor, q->data + 2 * index);
    return himc_c3d_real(p->processor, q->data + 4 * index);
}

bool himc_c3d_string(const c3d_parameter *q, int index, const char **text, size_t *length)
{
    assert(index >= 0);
    if (!q || q->type != -1 || q->dimensions == 0)
        return false;
    int width = q->size[0], rows = width ? q->count / width : 0;
    if (index >= rows)
        return false;
    *text = (const char *)q->data + (size_t)index * (size_t)width;
    *length = (size_t)width;
    return true;
}
