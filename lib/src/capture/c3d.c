/// c3d.c: C3D, the binary file of optical motion capture: a header, parameters, then per frame
/// every point's x, y, z and a residual, and the analog samples taken during the frame; read and
/// written.
///
/// Parameters are a chain of records, groups (negative number) and parameters (positive), in any
/// order; each gives the distance to the next, from its own place.
///
///     name length, +-group, name, distance to next, [type, dimensions, sizes..., data], text
///
/// Numbers are Intel's (little endian, IEEE), MIPS's (big endian, IEEE) or DEC's: little-endian
/// words, high word first, sign, 8 bits of exponent e and 23 of mantissa m with value (1/2 + m /
/// 2^24) 2^(e - 128) and no infinities; e = 0 is zero, or reserved if the sign is set. Invariant:
/// for any contents nothing outside the file's bytes is read; the walk always moves forward.
///
/// Points are floats if POINT:SCALE is negative, else 16-bit integers times it. A negative
/// residual, or a coordinate that is not finite, is a gap. Counts beyond 65535 frames come from
/// TRIAL:ACTUAL_START_FIELD and ACTUAL_END_FIELD (two words each) or POINT:LONG_FRAMES. Values that
/// Vicon's models store among the points (angles, forces, moments, powers, scalars) are not
/// positions and are left out. Event times count from frame 1, so a file that begins later
/// subtracts its start. Reference: the C3D file format user guide, Motion Lab Systems 2008.
#include "base/array.h"
#include "capture/take.h"
#include "capture/take_text.h"

#include <string.h>

// by the format
#define BLOCK 512  // (bytes)
#define GROUPS 128 // most

enum { INTEL = 84, DEC = 85, MIPS = 86 }; // processors

typedef struct parameter {
    int group;
    char name[24];             // upper case, cut to 23 letters
    int type;                  // bytes of an element: -1 characters, 1, 2, 4 (real)
    int dimensions;            // 0 .. 7
    unsigned char size[7];     // of each dimension, the first runs fastest
    int count;                 // elements: product of sizes, 1 without dimensions
    const unsigned char *data; // in the file, count x |type| bytes
} parameter;

typedef struct c3d {
    himc_take *take;
    const unsigned char *bytes;
    size_t size;
    int processor;
    char groups[GROUPS][24]; // names by number, "" if there is none
    parameter *list;         // owned
    int count, room;
    int points; // in the file
    int analog; // samples per frame
    double scale;
    bool is_float;
    size_t width;        // bytes of a value
    size_t data, stride; // where frames begin, bytes of one
    int *kept;           // (points) index in the take, or -1
    himc_span *label;    // (points) empty if a point has none
    himc_error *error;
} c3d;

// numbers

// 16 bits, unsigned
static unsigned word_at(int processor, const unsigned char *at)
{
    return processor == MIPS ? (unsigned)(at[0] << 8 | at[1]) : (unsigned)(at[1] << 8 | at[0]);
}

// 16 bits, signed
static int integer_at(int processor, const unsigned char *at)
{
    int word = (int)word_at(processor, at);
    return word < 32768 ? word : word - 65536;
}

double himc_c3d_real(int processor, const unsigned char *at)
{
    uint32_t first = word_at(processor, at), second = word_at(processor, at + 2);
    uint32_t bits = processor == INTEL ? second << 16 | first : first << 16 | second;
    if (processor == DEC) {
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

// parameters

// reads the value at `at`; false if it goes beyond the end of the file
static bool read_value(parameter *q, const unsigned char *at, const unsigned char *end)
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
static bool read_record(c3d *r, const unsigned char **at, const unsigned char *section_end)
{
    const unsigned char *end = r->bytes + r->size;
    const unsigned char *a = *at;
    bool fits = end - a >= 2;
    int length = fits ? abs(a[0] < 128 ? a[0] : a[0] - 256) : 0;
    int group = fits ? (a[1] < 128 ? a[1] : a[1] - 256) : 0;
    if (fits && (length == 0 || group == 0)) {
        *at = NULL;
        return true;
    }
    if (!fits || end - a < length + 4)
        return himc_error_set(r->error, "its parameters go beyond the end of the file");
    parameter q = {.group = abs(group)};
    for (int i = 0; i < length && i < (int)sizeof q.name - 1; i++) {
        int c = a[2 + i];
        q.name[i] = (char)(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    }
    const unsigned char *link = a + 2 + length;
    if (group < 0 && q.group < GROUPS)
        memcpy(r->groups[q.group], q.name, sizeof q.name);
    if (group > 0 && !read_value(&q, link + 2, end))
        return himc_error_set(r->error, "parameter %.23s does not fit into the file", q.name);
    if (group > 0 && !himc_array_grow(&r->list, r->count, &r->room, sizeof q, NULL))
        return himc_error_set(r->error, "no memory");
    if (group > 0)
        r->list[r->count++] = q;
    unsigned distance = word_at(r->processor, link);
    if (distance != 0 && (distance < 2 || distance >= (size_t)(end - link)))
        return himc_error_set(
            r->error, "the record after parameter %.23s is beyond the end of the file", q.name);
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

// false with the reason, without file name
static bool read_parameters(c3d *r)
{
    size_t offset = (size_t)(r->bytes[0] - 1) * BLOCK;
    if (offset + 4 > r->size)
        return himc_error_set(r->error,
                              "its parameters begin at byte %zu, but the file has %zu bytes",
                              offset, r->size);
    r->processor = r->bytes[offset + 3];
    if (r->processor < INTEL || r->processor > MIPS)
        return himc_error_set(r->error, "processor is %d, expected 84 (Intel), 85 (DEC), 86 (MIPS)",
                              r->processor);
    size_t section = offset + (size_t)BLOCK * r->bytes[offset + 2];
    const unsigned char *at = r->bytes + offset + 4;
    const unsigned char *section_end = r->bytes + (section < r->size ? section : r->size);
    while (at)
        if (!read_record(r, &at, section_end))
            return false;
    return true;
}

// NULL if there is none
static const parameter *find(const c3d *r, const char *group, const char *name)
{
    for (int i = 0; i < r->count; i++) {
        const parameter *q = &r->list[i];
        if (q->group < GROUPS && strcmp(r->groups[q->group], group) == 0 &&
            strcmp(q->name, name) == 0)
            return q;
    }
    return NULL;
}

// an element as a number, whatever its type (2-byte integers unsigned); `fallback` where there is
// none
static double element(const c3d *r, const parameter *q, int index, double fallback)
{
    if (!q || index >= q->count || q->type == -1)
        return fallback;
    return q->type == 1   ? q->data[index]
           : q->type == 2 ? word_at(r->processor, q->data + 2 * index)
                          : himc_c3d_real(r->processor, q->data + 4 * index);
}

static double number(const c3d *r, const char *group, const char *name, int index, double fallback)
{
    return element(r, find(r, group, name), index, fallback);
}

// string `index` of a table of characters; false if there is none
static bool row_of(const parameter *q, int index, himc_span *row)
{
    int width = q && q->type == -1 && q->dimensions > 0 ? q->size[0] : 0;
    if (width == 0 || index >= q->count / width)
        return false;
    *row = (himc_span){(const char *)q->data + (size_t)index * (size_t)width, (size_t)width};
    return true;
}

// a string without blanks at its ends, empty if there is none
static himc_span string(const c3d *r, const char *group, const char *name, int index)
{
    himc_span span = {"", 0};
    row_of(find(r, group, name), index, &span);
    return himc_span_trim(span);
}

static unsigned header_word(const c3d *r, int index)
{
    return word_at(r->processor, r->bytes + 2 * (index - 1));
}

// frames

static bool read_layout(c3d *r)
{
    r->points = (int)header_word(r, 2);
    r->analog = (int)header_word(r, 3);
    r->scale = number(r, "POINT", "SCALE", 0, himc_c3d_real(r->processor, r->bytes + 12));
    double used = number(r, "POINT", "USED", 0, r->points);
    if (r->points < 1)
        return himc_error_set(r->error, "%s: the header says 0 points, expected 1 .. 65535",
                              r->take->file);
    if (used != r->points)
        return himc_error_set(
            r->error, "%s: the header says %d points, POINT:USED says %g, expected the same number",
            r->take->file, r->points, used);
    if (!isfinite(r->scale) || r->scale == 0)
        return himc_error_set(
            r->error,
            "%s: POINT:SCALE is %g, expected a negative number for floats, a positive factor for "
            "integers",
            r->take->file, r->scale);
    r->is_float = r->scale < 0;
    r->width = r->is_float ? 4 : 2;
    r->stride = r->width * (4 * (size_t)r->points + (size_t)r->analog);
    unsigned block = header_word(r, 9);
    if (block < 2)
        block = (unsigned)fmin(65535, fmax(0, number(r, "POINT", "DATA_START", 0, 0)));
    r->data = (size_t)(block - 1) * BLOCK;
    if (block < 2 || r->data >= r->size)
        return himc_error_set(r->error,
                              "%s: the frames begin at block %u, but the file has %zu blocks",
                              r->take->file, block, (r->size + BLOCK - 1) / BLOCK);
    return true;
}

// a field number of TRIAL, of two words; 0 if there is none
static double field(const c3d *r, const char *name)
{
    double low = number(r, "TRIAL", name, 0, 0), high = number(r, "TRIAL", name, 1, 0);
    return low + 65536 * high;
}

// the number of frames: the first of the stated counts that fits into the length of the file
static bool count_frames(const c3d *r, int *frames)
{
    int first = (int)header_word(r, 4), last = (int)header_word(r, 5);
    double start = field(r, "ACTUAL_START_FIELD"), end = field(r, "ACTUAL_END_FIELD");
    double said[] = {start > 0 && end >= start ? end - start + 1 : 0,
                     number(r, "POINT", "LONG_FRAMES", 0, 0), last >= first ? last - first + 1 : 0,
                     number(r, "POINT", "FRAMES", 0, 0)};
    double there = floor((double)(r->size - r->data) / (double)r->stride), most = 0;
    for (int i = 0; i < 4; i++) {
        most = said[i] >= 1 && most == 0 ? said[i] : most;
        if (said[i] >= 1 && said[i] <= there && said[i] <= TAKE_MOST_FRAMES) {
            *frames = (int)said[i];
            if (said[i] < most)
                himc_take_note(r->take,
                               "frames: the file states %.0f but contains %.0f, %d are read", most,
                               there, *frames);
            r->take->first_frame = start > 0 && start < 1e9 ? (int)start : first;
            return true;
        }
    }
    if (most < 1)
        return himc_error_set(r->error, "%s: the header says 0 frames, expected 1 .. 1000000",
                              r->take->file);
    return himc_error_set(r->error,
                          "%s: the header says %.0f frames of %zu bytes, the file has %.0f frames",
                          r->take->file, most, r->stride, there);
}

static int by_text(const void *a, const void *b)
{
    const himc_span *x = a, *y = b;
    if (x->length != y->length)
        return x->length < y->length ? -1 : 1;
    return x->length ? memcmp(x->at, y->at, x->length) : 0;
}

// labels the points, from POINT:LABELS, LABELS2, ..., and keeps those that are positions
static bool choose_points(c3d *r, int *count)
{
    static const char *const lists[] = {"ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS"};
    const parameter *list[5];
    size_t models = 0, most = 1;
    for (int k = 0; k < 5; k++) {
        list[k] = find(r, "POINT", lists[k]);
        most += list[k] ? (size_t)list[k]->count : 0; // a label has a byte at least
    }
    himc_span *model = malloc(most * sizeof *model), label;
    r->kept = malloc((size_t)r->points * sizeof *r->kept);
    r->label = calloc((size_t)r->points, sizeof *r->label);
    if (!model || !r->kept || !r->label) {
        free(model);
        return himc_error_set(r->error, "%s: no memory", r->take->file);
    }
    // the trimmed labels of a model's values, sorted
    for (int k = 0; k < 5; k++)
        for (int i = 0; row_of(list[k], i, &label); i++)
            model[models++] = himc_span_trim(label);
    qsort(model, models, sizeof *model, by_text);
    char name[24] = "LABELS";
    for (int k = 2, point = 0; k < 256; k++) {
        const parameter *labels = find(r, "POINT", name);
        if (!labels || labels->type != -1 || labels->dimensions == 0 || labels->size[0] == 0)
            break;
        for (int i = 0; point < r->points; i++, point++)
            if (!row_of(labels, i, &r->label[point]))
                break;
        snprintf(name, sizeof name, "LABELS%d", k);
    }
    *count = 0;
    for (int i = 0; i < r->points; i++) {
        label = himc_span_trim(r->label[i]);
        bool is_model = label.length && bsearch(&label, model, models, sizeof label, by_text);
        r->kept[i] = is_model ? -1 : (*count)++;
    }
    free(model);
    if (*count < r->points)
        himc_take_note(
            r->take, "points: %d of them are values of a model (angles, forces, ...) and left out",
            r->points - *count);
    return *count > 0 ||
           himc_error_set(r->error,
                          "%s: all points are values of a model (angles, forces, ...), expected at "
                          "least one position",
                          r->take->file);
}

static void read_points(const c3d *r)
{
    for (int i = 0; i < r->points; i++) {
        if (r->kept[i] < 0)
            continue;
        himc_take_set_name(r->take, r->kept[i], r->label[i].at, r->label[i].length);
        for (int frame = 0; frame < r->take->frames; frame++) {
            const unsigned char *at =
                r->bytes + r->data + (size_t)frame * r->stride + 4 * r->width * (size_t)i;
            double v[4]; // x, y, z, residual
            for (int k = 0; k < 4; k++)
                v[k] = r->is_float ? himc_c3d_real(r->processor, at + 4 * k)
                                   : integer_at(r->processor, at + 2 * k) * (k < 3 ? r->scale : 1);
            bool seen = v[3] >= 0;
            for (int k = 0; k < 3; k++)
                seen = seen && fabs(v[k]) <= TAKE_LARGEST;
            *himc_take_at(r->take, frame, r->kept[i]) =
                seen ? himc_vec3_make(v[0], v[1], v[2]) : himc_vec3_gap();
        }
    }
}

// "+X", "-Z", "Y" as a unit vector; 0 for anything else
static himc_vec3 read_axis(const c3d *r, const char *name)
{
    himc_span s = string(r, "POINT", name, 0);
    bool has_sign = s.length == 2 && (s.at[0] == '+' || s.at[0] == '-');
    int axis = s.length == 1 || has_sign ? s.at[s.length - 1] | 32 : 0;
    double sign = has_sign && s.at[0] == '-' ? -1 : 1;
    return himc_vec3_make(axis == 'x' ? sign : 0, axis == 'y' ? sign : 0, axis == 'z' ? sign : 0);
}

static void add_event(c3d *r, double time, himc_span context, himc_span label)
{
    himc_take *take = r->take;
    time -= (take->first_frame - 1) / take->rate;
    if (!isfinite(time) || fabs(time) > 1e6) // no take is so long
        return;
    char a[44], b[44];
    himc_take_event *event = &take->events[take->event_count++];
    event->time = time;
    snprintf(event->label, sizeof event->label, "%.12s%s%.18s", himc_span_text(context, a),
             context.length ? " " : "", himc_span_text(label, b));
}

static bool read_events(c3d *r)
{
    const parameter *times = find(r, "EVENT", "TIMES");
    int group = times && times->dimensions == 2 && times->size[0] == 2 ? times->size[1] : 0;
    group = (int)fmin(group, fmax(0, number(r, "EVENT", "USED", 0, 0)));
    // without a group EVENT up to 18 events of the header; the key 12345 says they have labels
    int header = group == 0 && header_word(r, 150) == 12345 ? (int)header_word(r, 151) : 0;
    header = header < 18 ? header : 18;
    r->take->events = calloc((size_t)(group + header + 1), sizeof *r->take->events);
    if (!r->take->events)
        return himc_error_set(r->error, "%s: no memory", r->take->file);
    for (int i = 0; i < group; i++) {
        double minutes = element(r, times, 2 * i, 0);
        double seconds = element(r, times, 2 * i + 1, 0);
        add_event(r, 60 * minutes + seconds, string(r, "EVENT", "CONTEXTS", i),
                  string(r, "EVENT", "LABELS", i));
    }
    for (int i = 0; i < header; i++) {
        himc_span label = {(const char *)r->bytes + 396 + 4 * i, 4};
        add_event(r, himc_c3d_real(r->processor, r->bytes + 304 + 4 * i), (himc_span){"", 0},
                  himc_span_trim(label));
    }
    return true;
}

// The analog samples behind the points of each frame: (raw - OFFSET) SCALE GEN_SCALE. Their counts
// were compared with the length of the file.
static bool read_analog(c3d *r)
{
    himc_take *take = r->take;
    int channels = (int)number(r, "ANALOG", "USED", 0, 0);
    if (r->analog == 0 || channels < 1 || r->analog % channels != 0)
        return true;
    int each = r->analog / channels;
    take->analog_names = calloc((size_t)channels, sizeof *take->analog_names);
    take->analog = calloc((size_t)take->frames * (size_t)r->analog, sizeof *take->analog);
    if (!take->analog_names || !take->analog)
        return himc_error_set(r->error, "%s: no memory for analog channels", take->file);
    take->analog_channels = channels;
    take->analog_samples = take->frames * each;
    take->analog_rate = take->rate * each;
    bool is_unsigned = himc_span_is(string(r, "ANALOG", "FORMAT", 0), "unsigned");
    double general = number(r, "ANALOG", "GEN_SCALE", 0, 1);
    for (int channel = 0; channel < channels; channel++) {
        double offset = number(r, "ANALOG", "OFFSET", channel, 0);
        double scale = general * number(r, "ANALOG", "SCALE", channel, 1);
        // "EMG1 (V)"
        himc_span label = string(r, "ANALOG", "LABELS", channel),
                  unit = string(r, "ANALOG", "UNITS", channel);
        char a[44], b[44];
        himc_span_text(label, a);
        if (label.length == 0)
            snprintf(a, sizeof a, "channel %d", channel + 1);
        snprintf(take->analog_names[channel], TAKE_NAME, "%s%s%.15s%s", a, unit.length ? " (" : "",
                 himc_span_text(unit, b), unit.length ? ")" : "");
        for (int i = 0; i < take->analog_samples; i++) {
            size_t frame = (size_t)(i / each), sample = (size_t)(i % each);
            const unsigned char *at =
                r->bytes + r->data + frame * r->stride +
                r->width * (4 * (size_t)r->points + sample * (size_t)channels + (size_t)channel);
            double raw = r->is_float   ? himc_c3d_real(r->processor, at)
                         : is_unsigned ? (double)word_at(r->processor, at)
                                       : (double)integer_at(r->processor, at);
            take->analog[(size_t)i * (size_t)channels + (size_t)channel] = (raw - offset) * scale;
        }
    }
    return true;
}

// what the file says of its unit, axes, numbers and player
static bool read_statements(c3d *r)
{
    static const char *const processors[] = {"Intel", "DEC", "MIPS"};
    static const char *const groups[] = {"SUBJECT", "SUBJECTS", "PROCESSING"};
    static const char *const masses[] = {"MASS", "BODYMASS", "WEIGHT"};
    himc_take *take = r->take;
    char text[44];
    himc_span unit = string(r, "POINT", "UNITS", 0);
    const char *nul = memchr(unit.at, 0, unit.length); // some fill with it
    if (nul)
        unit = himc_span_trim((himc_span){unit.at, (size_t)(nul - unit.at)});
    take->file_unit = himc_take_unit(himc_span_text(unit, text));
    snprintf(take->format, sizeof take->format, "C3D (%s, %s)", processors[r->processor - INTEL],
             r->is_float ? "floats" : "integers");
    take->format_up = himc_vec3_make(0, 0, 1);
    take->file_up = read_axis(r, "Y_SCREEN");
    take->file_right = read_axis(r, "X_SCREEN");
    // the player's mass and height if the file has them; Vicon writes them in kg and mm
    double mass = 0, height = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3 && mass <= 0; k++)
            mass = number(r, groups[i], masses[k], 0, 0);
        if (height <= 0)
            height = number(r, groups[i], "HEIGHT", 0, 0);
    }
    height *= height > 100 ? 0.001 : 1;
    take->mass = mass >= TAKE_LEAST_MASS && mass <= TAKE_MOST_MASS ? mass : 0;
    take->height = height >= TAKE_LEAST_HEIGHT && height <= TAKE_MOST_HEIGHT ? height : 0;
    if ((mass > 0 && take->mass == 0) || (height > 0 && take->height == 0))
        himc_take_note(take,
                       "player: the file states %g kg and %g m, ignored outside %g .. %g kg and "
                       "%g .. %g m",
                       mass, height, TAKE_LEAST_MASS, TAKE_MOST_MASS, TAKE_LEAST_HEIGHT,
                       TAKE_MOST_HEIGHT);
    return unit.length == 0 || take->file_unit > 0 ||
           himc_error_set(r->error, "%s: POINT:UNITS is \"%s\", expected mm, cm, m, in or ft",
                          take->file, text);
}

bool himc_c3d_read(himc_take *take, const void *file, size_t size, himc_error *error)
{
    const unsigned char *bytes = file;
    c3d r = {.take = take, .bytes = bytes, .size = size, .error = error};
    int frames = 0, points = 0;
    if (size < BLOCK)
        return himc_error_set(error, "%s: %zu bytes, expected at least a header of %d", take->file,
                              size, BLOCK);
    if (bytes[1] != 0x50 || bytes[0] < 2)
        return himc_error_set(error,
                              "%s: begins with bytes %d %d, expected for C3D: 2 .. 255 and 80",
                              take->file, bytes[0], bytes[1]);
    bool ok = read_parameters(&r) || himc_error_prefix(error, "%s", take->file);
    ok = ok && read_layout(&r) && count_frames(&r, &frames) && choose_points(&r, &points);
    if (ok) {
        double rate = number(&r, "POINT", "RATE", 0, himc_c3d_real(r.processor, bytes + 20));
        ok = himc_take_allocate(take, rate, frames, points, false, error) && read_statements(&r);
    }
    if (ok)
        read_points(&r);
    ok = ok && read_events(&r) && read_analog(&r);
    free(r.kept);
    free(r.label);
    free(r.list);
    return ok;
}

// Writing: floats of an Intel processor in millimetres, so POINT:SCALE is -1 and its value has no
// meaning; a gap has the residual -1. X_SCREEN +X and Y_SCREEN +Z state the library's axes. More
// than 65535 frames are counted by TRIAL:ACTUAL_END_FIELD.

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
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, sizeof bits);
    put_word(b, bits & 65535);
    put_word(b, bits >> 16);
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

// the part of a parameter before its data: dimensions `size` and `other` (0: none), elements of
// |type| bytes
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

// a parameter of the points: a text, else a real or a word
static void put_point(bytes *b, const char *name, const char *text, bool real, double value)
{
    put_head(b, 1, name, text ? -1 : real ? 4 : 2, text ? (int)strlen(text) : 0, 0);
    if (text)
        put_text(b, text, (int)strlen(text));
    else if (real)
        put_real(b, value);
    else
        put_word(b, (unsigned)value);
    put_byte(b, 0);
}

static void put_field(bytes *b, const char *name, unsigned value)
{
    put_head(b, 2, name, 2, 2, 0);
    put_word(b, value & 65535);
    put_word(b, value >> 16);
    put_byte(b, 0);
}

// bytes of an analog channel's name in "NAME (UNIT)", whose unit follows
static int name_length(const char *name)
{
    const char *unit = strstr(name, " (");
    return (int)(unit ? unit - name : (long)strlen(name));
}

// labels or units of the analog channels
static void put_names(bytes *b, const himc_take *take, const char *name, bool unit)
{
    char text[TAKE_NAME];
    put_head(b, 3, name, -1, TAKE_NAME, take->analog_channels);
    for (int i = 0; i < take->analog_channels; i++) {
        const char *whole = take->analog_names[i];
        int length = name_length(whole), rest = (int)strlen(whole) - length - 3; // " (" and ")"
        snprintf(text, sizeof text, "%.*s", unit ? rest > 0 ? rest : 0 : length,
                 unit ? whole + length + (rest > 0 ? 2 : 0) : whole);
        put_text(b, text, TAKE_NAME);
    }
    put_byte(b, 0);
}

static void put_analog(bytes *b, const himc_take *take)
{
    put_group(b, 3, "ANALOG");
    put_head(b, 3, "USED", 2, 0, 0);
    put_word(b, (unsigned)take->analog_channels);
    put_byte(b, 0);
    for (int i = 0; i < 2; i++) {
        put_head(b, 3, i ? "RATE" : "GEN_SCALE", 4, 0, 0);
        put_real(b, i ? take->analog_rate : 1);
        put_byte(b, 0);
    }
    for (int i = 0; i < 2; i++) {
        put_head(b, 3, i ? "OFFSET" : "SCALE", i ? 2 : 4, take->analog_channels, 0);
        for (int k = 0; k < take->analog_channels; k++)
            i ? put_word(b, 0) : put_real(b, 1);
        put_byte(b, 0);
    }
    put_names(b, take, "LABELS", false);
    put_names(b, take, "UNITS", true);
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
    put_byte(b, INTEL);
    put_group(b, 1, "POINT");
    put_point(b, "USED", NULL, false, take->points);
    put_point(b, "SCALE", NULL, true, -1);
    put_point(b, "RATE", NULL, true, take->rate);
    put_point(b, "DATA_START", NULL, false, 2 + blocks);
    put_point(b, "FRAMES", NULL, false, take->frames < 65535 ? take->frames : 65535);
    put_point(b, "UNITS", "mm", false, 0);
    put_point(b, "X_SCREEN", "+X", false, 0);
    put_point(b, "Y_SCREEN", "+Z", false, 0);
    put_head(b, 1, "LABELS", -1, width, take->points);
    for (int i = 0; i < take->points; i++)
        put_text(b, take->names[i], width);
    put_byte(b, 0);
    put_group(b, 2, "TRIAL");
    put_field(b, "ACTUAL_START_FIELD", 1);
    put_field(b, "ACTUAL_END_FIELD", (unsigned)take->frames);
    if (take->analog && take->analog_channels > 0)
        put_analog(b, take);
    b->at = begin + (size_t)blocks * BLOCK;
}

bool himc_c3d_write(FILE *file, const himc_take *take, himc_error *error)
{
    int channels = take->analog ? take->analog_channels : 0,
        each = channels ? take->analog_samples / take->frames : 0, samples = channels * each;
    if (take->points > HIMC_C3D_LABELS || channels > HIMC_C3D_LABELS)
        return himc_error_set(error, "%s: %d %s, expected up to %d in a .c3d", take->file,
                              channels > HIMC_C3D_LABELS ? channels : take->points,
                              channels > HIMC_C3D_LABELS ? "analog channels" : "points",
                              HIMC_C3D_LABELS);
    // a channel has a label, a unit, a scale and an offset
    int blocks =
        2 + (take->points * TAKE_NAME + channels * (2 * TAKE_NAME + 6) + BLOCK - 1) / BLOCK;
    size_t before = (size_t)(1 + blocks) * BLOCK;
    size_t row = 16 * (size_t)take->points + 4 * (size_t)samples;
    unsigned char *buffer = calloc(1, before > row ? before : row);
    if (!buffer)
        return himc_error_set(error, "%s: no memory", take->file);
    bytes b = {buffer, buffer + before};
    put_byte(&b, 2);
    put_byte(&b, 0x50);
    put_word(&b, (unsigned)take->points);
    put_word(&b, (unsigned)samples);
    put_word(&b, 1);
    put_word(&b, take->frames < 65535 ? (unsigned)take->frames : 65535);
    put_word(&b, 0);
    put_real(&b, -1);
    put_word(&b, (unsigned)(2 + blocks));
    put_word(&b, (unsigned)each);
    put_real(&b, take->rate);
    b.at = buffer + BLOCK;
    put_parameters(&b, take, blocks);
    fwrite(buffer, 1, before, file);
    for (int frame = 0; frame < take->frames; frame++) {
        b = (bytes){buffer, buffer + row};
        for (int i = 0; i < take->points; i++) {
            himc_vec3 x = *himc_take_at(take, frame, i);
            bool seen = himc_vec3_finite(x);
            himc_vec3 mm = seen ? himc_vec3_scale(x, 1000) : himc_vec3_make(0, 0, 0);
            put_real(&b, mm.x);
            put_real(&b, mm.y);
            put_real(&b, mm.z);
            put_real(&b, seen ? 0 : -1);
        }
        for (int i = 0; i < samples; i++)
            put_real(&b, take->analog[(size_t)frame * (size_t)samples + (size_t)i]);
        fwrite(buffer, 1, row, file);
    }
    free(buffer);
    return true;
}
