/// c3d.c: C3D, the binary file of optical motion capture: a header, parameters, then per frame
/// every point's x, y, z and a residual, and the analog samples taken during the frame, which are
/// skipped; read and written.
///
/// Points are floats if POINT:SCALE is negative, else 16-bit integers times it; numbers are those
/// of three processors (c3d_parameters.c). A negative residual, or a coordinate that is not finite,
/// is a gap. Counts beyond 65535 frames come from TRIAL:ACTUAL_START_FIELD and ACTUAL_END_FIELD
/// (two words each) or POINT:LONG_FRAMES. Values that Vicon's models store among the points
/// (angles, forces, moments, powers, scalars) are not positions and are left out. Event times count
/// from frame 1, so a file that begins later subtracts its start. Reference: the C3D file format
/// user guide, Motion Lab Systems 2008.
#include "capture/c3d_parameters.h"
#include "capture/take.h"
#include "capture/take_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct c3d {
    himc_take *take;
    const unsigned char *bytes;
    size_t size;
    c3d_parameters parameters;
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

static unsigned header_word(const c3d *r, int number)
{
    return himc_c3d_word(r->parameters.processor, r->bytes + 2 * (number - 1));
}

static double parameter(const c3d *r, const char *group, const char *name, int index,
                        double fallback)
{
    return himc_c3d_number(&r->parameters, himc_c3d_find(&r->parameters, group, name), index,
                           fallback);
}

// a string without blanks at its ends, empty if there is none
static himc_span string(const c3d *r, const char *group, const char *name, int index)
{
    himc_span span = {"", 0};
    himc_c3d_string(himc_c3d_find(&r->parameters, group, name), index, &span.at, &span.length);
    return himc_span_trim(span);
}

static bool read_layout(c3d *r)
{
    r->points = (int)header_word(r, 2);
    r->analog = (int)header_word(r, 3);
    r->scale =
        parameter(r, "POINT", "SCALE", 0, himc_c3d_real(r->parameters.processor, r->bytes + 12));
    double used = parameter(r, "POINT", "USED", 0, r->points);
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
        block = (unsigned)fmin(65535, fmax(0, parameter(r, "POINT", "DATA_START", 0, 0)));
    r->data = (size_t)(block - 1) * C3D_BLOCK;
    if (block < 2 || r->data >= r->size)
        return himc_error_set(r->error,
                              "%s: the frames begin at block %u, but the file has %zu blocks",
                              r->take->file, block, (r->size + C3D_BLOCK - 1) / C3D_BLOCK);
    return true;
}

// a field number of TRIAL, of two words; 0 if there is none
static double field(const c3d *r, const char *name)
{
    double low = parameter(r, "TRIAL", name, 0, 0), high = parameter(r, "TRIAL", name, 1, 0);
    return low + 65536 * high;
}

// the number of frames: the first of the stated counts that fits into the length of the file
static bool count_frames(const c3d *r, int *frames)
{
    int first = (int)header_word(r, 4), last = (int)header_word(r, 5);
    double start = field(r, "ACTUAL_START_FIELD"), end = field(r, "ACTUAL_END_FIELD");
    double said[] = {start > 0 && end >= start ? end - start + 1 : 0,
                     parameter(r, "POINT", "LONG_FRAMES", 0, 0),
                     last >= first ? last - first + 1 : 0, parameter(r, "POINT", "FRAMES", 0, 0)};
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
    const c3d_parameter *list[5];
    size_t models = 0, most = 1;
    for (int k = 0; k < 5; k++) {
        list[k] = himc_c3d_find(&r->parameters, "POINT", lists[k]);
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
        for (int i = 0; himc_c3d_string(list[k], i, &label.at, &label.length); i++)
            model[models++] = himc_span_trim(label);
    qsort(model, models, sizeof *model, by_text);
    char name[24] = "LABELS";
    for (int k = 2, point = 0; k < 256; k++) {
        const c3d_parameter *labels = himc_c3d_find(&r->parameters, "POINT", name);
        if (!labels || labels->type != -1 || labels->dimensions == 0 || labels->size[0] == 0)
            break;
        for (int i = 0; point < r->points; i++, point++)
            if (!himc_c3d_string(labels, i, &r->label[point].at, &r->label[point].length))
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
    c3d_processor processor = r->parameters.processor;
    for (int i = 0; i < r->points; i++) {
        if (r->kept[i] < 0)
            continue;
        himc_take_set_name(r->take, r->kept[i], r->label[i].at, r->label[i].length);
        for (int frame = 0; frame < r->take->frames; frame++) {
            const unsigned char *at =
                r->bytes + r->data + (size_t)frame * r->stride + 4 * r->width * (size_t)i;
            double v[4]; // x, y, z, residual
            for (int k = 0; k < 4; k++)
                v[k] = r->is_float
                           ? himc_c3d_real(processor, at + 4 * k)
                           : himc_c3d_integer(processor, at + 2 * k) * (k < 3 ? r->scale : 1);
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
    const c3d_parameter *times = himc_c3d_find(&r->parameters, "EVENT", "TIMES");
    int group = times && times->dimensions == 2 && times->size[0] == 2 ? times->size[1] : 0;
    group = (int)fmin(group, fmax(0, parameter(r, "EVENT", "USED", 0, 0)));
    // without a group EVENT up to 18 events of the header; the key 12345 says they have labels
    int header = group == 0 && header_word(r, 150) == 12345 ? (int)header_word(r, 151) : 0;
    header = header < 18 ? header : 18;
    r->take->events = calloc((size_t)(group + header + 1), sizeof *r->take->events);
    if (!r->take->events)
        return himc_error_set(r->error, "%s: no memory", r->take->file);
    for (int i = 0; i < group; i++) {
        double minutes = himc_c3d_number(&r->parameters, times, 2 * i, 0);
        double seconds = himc_c3d_number(&r->parameters, times, 2 * i + 1, 0);
        add_event(r, 60 * minutes + seconds, string(r, "EVENT", "CONTEXTS", i),
                  string(r, "EVENT", "LABELS", i));
    }
    for (int i = 0; i < header; i++) {
        himc_span label = {(const char *)r->bytes + 396 + 4 * i, 4};
        add_event(r, himc_c3d_real(r->parameters.processor, r->bytes + 304 + 4 * i),
                  (himc_span){"", 0}, himc_span_trim(label));
    }
    return true;
}

// The analog samples behind the points of each frame: (raw - OFFSET) SCALE GEN_SCALE. Their counts
// were compared with the length of the file.
static bool read_analog(c3d *r)
{
    himc_take *take = r->take;
    c3d_processor processor = r->parameters.processor;
    int channels = (int)parameter(r, "ANALOG", "USED", 0, 0);
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
    double general = parameter(r, "ANALOG", "GEN_SCALE", 0, 1);
    for (int channel = 0; channel < channels; channel++) {
        double offset = parameter(r, "ANALOG", "OFFSET", channel, 0);
        double scale = general * parameter(r, "ANALOG", "SCALE", channel, 1);
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
            double raw = r->is_float   ? himc_c3d_real(processor, at)
                         : is_unsigned ? (double)himc_c3d_word(processor, at)
                                       : (double)himc_c3d_integer(processor, at);
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
    snprintf(take->format, sizeof take->format, "C3D (%s, %s)",
             processors[r->parameters.processor - C3D_INTEL], r->is_float ? "floats" : "integers");
    take->format_up = himc_vec3_make(0, 0, 1);
    take->file_up = read_axis(r, "Y_SCREEN");
    take->file_right = read_axis(r, "X_SCREEN");
    // the player's mass and height if the file has them; Vicon writes them in kg and mm
    double mass = 0, height = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3 && mass <= 0; k++)
            mass = parameter(r, groups[i], masses[k], 0, 0);
        if (height <= 0)
            height = parameter(r, groups[i], "HEIGHT", 0, 0);
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
    if (size < C3D_BLOCK)
        return himc_error_set(error, "%s: %zu bytes, expected at least a header of %d", take->file,
                              size, C3D_BLOCK);
    if (bytes[1] != 0x50 || bytes[0] < 2)
        return himc_error_set(error,
                              "%s: begins with bytes %d %d, expected for C3D: 2 .. 255 and 80",
                              take->file, bytes[0], bytes[1]);
    bool ok = himc_c3d_parameters_read(&r.parameters, bytes, size,
                                       (size_t)(bytes[0] - 1) * C3D_BLOCK, error) ||
              himc_error_prefix(error, "%s", take->file);
    ok = ok && read_layout(&r) && count_frames(&r, &frames) && choose_points(&r, &points);
    if (ok) {
        double rate =
            parameter(&r, "POINT", "RATE", 0, himc_c3d_real(r.parameters.processor, bytes + 20));
        ok = himc_take_allocate(take, rate, frames, points, false, error) && read_statements(&r);
    }
    if (ok)
        read_points(&r);
    ok = ok && read_events(&r) && read_analog(&r);
    free(r.kept);
    free(r.label);
    himc_c3d_parameters_free(&r.parameters);
    return ok;
}

// Writing: floats of an Intel processor in millimetres, so POINT:SCALE is -1 and its value has no
// meaning; a gap has the residual -1. X_SCREEN +X and Y_SCREEN +Z state the library's axes. More
// than 65535 frames are counted by TRIAL:ACTUAL_END_FIELD.

#define MOST_LABELS 255 // a parameter's dimension is one byte

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
    b->at = begin + (size_t)blocks * C3D_BLOCK;
}

bool himc_c3d_write(FILE *file, const himc_take *take, himc_error *error)
{
    if (take->points > MOST_LABELS)
        return himc_error_set(error, "%s: %d points, expected up to %d in a .c3d", take->file,
                              take->points, MOST_LABELS);
    int blocks = 2 + (take->points * TAKE_NAME + C3D_BLOCK - 1) / C3D_BLOCK;
    size_t before = (size_t)(1 + blocks) * C3D_BLOCK, row = 16 * (size_t)take->points;
    unsigned char *buffer = calloc(1, before > row ? before : row);
    if (!buffer)
        return himc_error_set(error, "%s: no memory", take->file);
    bytes b = {buffer, buffer + before};
    put_byte(&b, 2);
    put_byte(&b, 0x50);
    put_word(&b, (unsigned)take->points);
    put_word(&b, 0);
    put_word(&b, 1);
    put_word(&b, take->frames < 65535 ? (unsigned)take->frames : 65535);
    put_word(&b, 0);
    put_real(&b, -1);
    put_word(&b, (unsigned)(2 + blocks));
    put_word(&b, 0);
    put_real(&b, take->rate);
    b.at = buffer + C3D_BLOCK;
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
        fwrite(buffer, 1, row, file);
    }
    free(buffer);
    return true;
}
