/// bvh.c: Biovision's BVH: a skeleton of offsets, and a row of channels per frame; read and
/// written.
///
/// A node's channels are applied in the file's order, the first outermost: R = R_1(c_1) R_2(c_2)
/// R_3(c_3), whatever axes they are and however nodes differ. Position channels replace the offset
/// component by component, as in the files of motion capture systems that write them for every
/// joint. Forward kinematics, for node i with parent p:
///     Q_i = Q_p R_i,  x_i = x_p + Q_p o_i
/// Every node becomes a point, end sites as "PARENT_end". The text is read line by line and word by
/// word, so any indentation and any line ends are accepted; a row must have exactly the channels of
/// the hierarchy.
///
/// Written are centimetres, y up, and angles of R = Rz Rx Ry, which makes sin x = R21, tan z =
/// -R01/R11, tan y = -R20/R22. The library's (x, y, z) becomes (x, z, -y), a rotation q becomes c q
/// c* with the quarter turn c about x that does this. A written file reads back to the last printed
/// digit.
#include "base/array.h"
#include "capture/take.h"
#include "capture/take_text.h"

#include <string.h>

#define MOST_NODES 4096 // chosen: far more than a body has
#define MOST_DEPTH 256  // chosen: far more than a body has; bounds the recursion of the writer

typedef struct node {
    char name[TAKE_NAME];
    int parent, depth;
    himc_vec3 offset;
    bool has_offset, has_channels, is_end;
    int count;              // channels
    unsigned char kinds[6]; // 0..2 position x y z, 3..5 rotation x y z
} node;

typedef struct bvh {
    himc_take *take;
    himc_text text;
    himc_span line; // rest of the current line
    node *nodes;
    int count, room, channels;
    himc_error *error;
} bvh;

static bool refuse(const bvh *r, const char *what, himc_span found, const char *expected)
{
    char text[44];
    return himc_error_set(r->error, "%s:%d: %s \"%s\", expected %s", r->take->file, r->text.line,
                          what, himc_span_text(found, text), expected);
}

// takes the next word, on this line or a later one
static bool word(bvh *r, const char *where, himc_span *w)
{
    while (!himc_span_word(&r->line, w))
        if (!himc_text_line(&r->text, &r->line))
            return himc_error_set(r->error, "%s:%d: the file ends too early: %s", r->take->file,
                                  r->text.line, where);
    return true;
}

static bool expect(bvh *r, const char *wanted, const char *where)
{
    himc_span w;
    return word(r, where, &w) && (himc_span_is(w, wanted) || refuse(r, where, w, wanted));
}

static bool number(bvh *r, const char *what, double *value)
{
    himc_span w;
    if (!word(r, what, &w))
        return false;
    return (himc_span_number(w, value) && fabs(*value) <= TAKE_LARGEST) ||
           refuse(r, what, w, "a number up to 1e8");
}

static bool read_channels(bvh *r, node *n)
{
    static const char *const kinds[6] = {"Xposition", "Yposition", "Zposition",
                                         "Xrotation", "Yrotation", "Zrotation"};
    himc_span w;
    long count;
    if (!word(r, "CHANNELS", &w))
        return false;
    if (n->has_channels || !himc_span_integer(w, 0, 6, &count))
        return refuse(r, "CHANNELS", w, "0 .. 6, once for each joint");
    n->has_channels = true;
    unsigned seen = 0;
    for (; n->count < count; n->count++) {
        unsigned kind = 0;
        if (!word(r, "CHANNELS", &w))
            return false;
        while (kind < 6 && !himc_span_is(w, kinds[kind]))
            kind++;
        if (kind == 6 || seen & 1u << kind)
            return refuse(r, "channel", w, "X, Y, Z position or rotation, each once");
        seen |= 1u << kind;
        n->kinds[n->count] = (unsigned char)kind;
    }
    r->channels += n->count;
    return true;
}

// opens ROOT, JOINT or End Site
static bool open_node(bvh *r, int parent, bool is_end)
{
    int depth = parent < 0 ? 1 : r->nodes[parent].depth + 1;
    if (depth > MOST_DEPTH)
        return himc_error_set(r->error, "%s:%d: joints are nested too deeply, expected %d levels",
                              r->take->file, r->text.line, MOST_DEPTH);
    if (r->count >= MOST_NODES)
        return himc_error_set(r->error, "%s:%d: too many joints, expected %d", r->take->file,
                              r->text.line, MOST_NODES);
    if (!himc_array_grow(&r->nodes, r->count, &r->room, sizeof *r->nodes, NULL))
        return himc_error_set(r->error, "%s: no memory", r->take->file);
    node *n = &r->nodes[r->count++];
    *n = (node){.parent = parent, .depth = depth, .is_end = is_end};
    if (is_end) {
        // named by its joint; a second one of the same joint must not have the same name
        char of[TAKE_NAME];
        int before = 0;
        memcpy(of, r->nodes[parent].name, sizeof of);
        for (const node *other = r->nodes; other < n; other++)
            before += other->parent == parent && other->is_end;
        if (before)
            snprintf(n->name, sizeof n->name, "%.48s_end%d", of, before + 1);
        else
            snprintf(n->name, sizeof n->name, "%.59s_end", of);
        return expect(r, "Site", "after End") && expect(r, "{", "before the end site's block");
    }
    // a name is the rest of its line, because some contain blanks; a brace at its end begins the
    // block
    himc_span rest = himc_span_trim(r->line);
    const char *brace = rest.length ? memchr(rest.at, '{', rest.length) : NULL;
    size_t length = brace ? (size_t)(brace - rest.at) : rest.length;
    himc_span name = himc_span_trim((himc_span){rest.at, length});
    if (name.length == 0)
        return refuse(r, "joint's name", rest, "a name on the same line");
    r->line = (himc_span){rest.at + length, rest.length - length};
    snprintf(n->name, sizeof n->name, "%.*s",
             (int)(name.length < TAKE_NAME ? name.length : TAKE_NAME - 1), name.at);
    return expect(r, "{", "before the joint's block");
}

static bool read_hierarchy(bvh *r)
{
    int current = -1;
    himc_span w;
    if (!expect(r, "HIERARCHY", "the first line"))
        return false;
    for (;;) {
        if (!word(r, "the hierarchy", &w))
            return false;
        node *n = current < 0 ? NULL : &r->nodes[current];
        bool joint = n && !n->is_end, is_end = himc_span_is(w, "End"), ok = true;
        bool root = !n && himc_span_is(w, "ROOT");
        if (himc_span_is(w, "MOTION") && !n)
            return r->count > 0 || refuse(r, "before any joint", w, "ROOT");
        if (root || (joint && (is_end || himc_span_is(w, "JOINT")))) {
            ok = open_node(r, current, is_end);
            current = r->count - 1;
        } else if (himc_span_is(w, "OFFSET") && n && !n->has_offset) {
            n->has_offset = true;
            ok = number(r, "OFFSET", &n->offset.x) && number(r, "OFFSET", &n->offset.y) &&
                 number(r, "OFFSET", &n->offset.z);
        } else if (himc_span_is(w, "CHANNELS") && joint) {
            ok = read_channels(r, n);
        } else if (himc_span_is(w, "}") && n) {
            if (!n->has_offset)
                return himc_error_set(r->error,
                                      "%s:%d: joint %s has no OFFSET, expected one for each joint",
                                      r->take->file, r->text.line, n->name);
            current = n->parent;
        } else {
            ok = refuse(r, n ? "in a joint" : "between joints", w,
                        n ? "one OFFSET, one CHANNELS, JOINT, End Site or }" : "ROOT or MOTION");
        }
        if (!ok)
            return false;
    }
}

static bool read_motion_header(bvh *r, int *frames, double *rate)
{
    himc_span w;
    long count;
    double time;
    if (!expect(r, "Frames:", "after MOTION") || !word(r, "Frames:", &w))
        return false;
    if (!himc_span_integer(w, 1, TAKE_MOST_FRAMES, &count))
        return refuse(r, "Frames:", w, "1 .. 1000000");
    if (!expect(r, "Frame", "after Frames:") || !expect(r, "Time:", "after Frame") ||
        !number(r, "Frame Time:", &time))
        return false;
    // the rates of himc_take_load, 20 .. 10000 Hz
    if (!(time >= 1e-4 && time <= 0.05))
        return himc_error_set(r->error, "%s:%d: Frame Time: %g s, expected 0.0001 .. 0.05 s",
                              r->take->file, r->text.line, time);
    himc_text rest = r->text;
    int rows = himc_span_trim(r->line).length > 0;
    while (himc_text_filled_line(&rest, &w))
        rows++;
    if (rows != count)
        return himc_error_set(r->error, "%s: the header says %ld frames, the file has %d rows",
                              r->take->file, count, rows);
    // a row has numbers for every joint that moves: counts larger than the text are not a body's
    if (r->channels == 0 || (size_t)(r->text.end - r->text.at) < (size_t)rows * (size_t)r->count)
        return himc_error_set(
            r->error,
            "%s: %d channels for %d joints, expected at least one channel for most joints",
            r->take->file, r->channels, r->count);
    *frames = rows;
    *rate = 1 / time;
    return true;
}

// reads a row of channels; `world` is room for the nodes' rotations in the world
static bool read_row(bvh *r, int frame, himc_quat *world)
{
    himc_span w;
    himc_take *take = r->take;
    himc_quat *local = take->rotations + (size_t)frame * (size_t)take->points;
    if (himc_span_trim(r->line).length == 0)
        himc_text_filled_line(&r->text, &r->line); // its rows were counted
    for (int i = 0; i < r->count; i++) {
        const node *n = &r->nodes[i];
        double v[6] = {n->offset.x, n->offset.y, n->offset.z, 0, 0, 0};
        local[i] = himc_quat_identity();
        for (int k = 0; k < n->count; k++) {
            int kind = n->kinds[k];
            if (!himc_span_word(&r->line, &w))
                return himc_error_set(
                    r->error,
                    "%s:%d: the row ends before channel %d of %s, expected rows of %d numbers",
                    take->file, r->text.line, k + 1, n->name, r->channels);
            if (!himc_span_number(w, &v[kind]) || !(fabs(v[kind]) <= TAKE_LARGEST))
                return refuse(r, n->name, w, "a number up to 1e8");
            if (kind < 3)
                continue;
            double half = v[kind] * HIMC_PI / 360, s = sin(half);
            himc_quat about = {cos(half), kind == 3 ? s : 0, kind == 4 ? s : 0, kind == 5 ? s : 0};
            local[i] = himc_quat_mul(local[i], about);
        }
        himc_vec3 place = himc_vec3_make(v[0], v[1], v[2]);
        world[i] = local[i];
        if (n->parent >= 0) {
            himc_quat parent = world[n->parent];
            world[i] = himc_quat_unit(himc_quat_mul(parent, local[i]));
            place = himc_vec3_add(*himc_take_at(take, frame, n->parent),
                                  himc_quat_rotate(parent, place));
        }
        *himc_take_at(take, frame, i) = place;
    }
    return !himc_span_word(&r->line, &w) ||
           refuse(r, "after the row's last channel", w, "a new line");
}

bool himc_bvh_read(himc_take *take, const void *bytes, size_t size, himc_error *error)
{
    bvh r = {.take = take, .text = himc_text_open(bytes, size), .line = {bytes, 0}, .error = error};
    int frames = 0;
    double rate = 0;
    memcpy(take->format, "BVH", 4);
    take->first_frame = 1;
    take->format_up = himc_vec3_make(0, 1, 0);
    bool ok = read_hierarchy(&r) && read_motion_header(&r, &frames, &rate) &&
              himc_take_allocate(take, rate, frames, r.count, true, error);
    for (int i = 0; i < r.count && ok; i++) {
        const node *n = &r.nodes[i];
        himc_take_set_name(take, i, n->name, strlen(n->name));
        take->parents[i] = n->parent;
        // the origin of the zero pose is arbitrary
        take->offsets[i] = n->parent < 0 ? himc_vec3_make(0, 0, 0) : n->offset;
    }
    himc_quat *world = ok ? calloc((size_t)r.count, sizeof *world) : NULL;
    ok = ok && (world || himc_error_set(error, "%s: no memory", take->file));
    for (int frame = 0; frame < frames && ok; frame++)
        ok = read_row(&r, frame, world);
    free(world);
    free(r.nodes);
    return ok;
}

#define CENTIMETRES 100.0

// from the library's axes to the file's: a quarter turn about -x
static const himc_quat y_up = {0.70710678118654752, -0.70710678118654752, 0, 0};

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
    char indent[80];
    snprintf(indent, sizeof indent, "%*s", depth < 70 ? depth : 70, "");
    if (leaf)
        fprintf(file, "%sEnd Site\n%s{\n%s\tOFFSET", indent, indent, indent);
    else
        fprintf(file, "%s%s %s\n%s{\n%s\tOFFSET", indent, root ? "ROOT" : "JOINT",
                take->names[point], indent, indent);
    himc_vec3 offset = himc_take_y_up(take->offsets[point]);
    himc_text_put_vec3(file, himc_vec3_scale(offset, CENTIMETRES), 6, ' ');
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

// one frame's channels of a joint and its descendants, in the order of the hierarchy
static void put_channels(FILE *file, const himc_take *take, int frame, int point)
{
    if (is_leaf(take, point))
        return;
    if (take->parents[point] < 0) {
        himc_vec3 x = himc_take_y_up(*himc_take_at(take, frame, point));
        himc_text_put_vec3(file, himc_vec3_scale(x, CENTIMETRES), 6, ' ');
    }
    himc_quat q = himc_quat_mul(y_up, himc_take_rotation(take, frame, point));
    himc_mat3 r = himc_mat3_from_quat(himc_quat_mul(q, himc_quat_conj(y_up)));
    himc_vec3 zxy = {atan2(-r.m[0][1], r.m[1][1]), asin(fmin(fmax(r.m[2][1], -1), 1)),
                     atan2(-r.m[2][0], r.m[2][2])};
    himc_text_put_vec3(file, himc_vec3_scale(zxy, 180 / HIMC_PI), 6, ' ');
    for (int i = point + 1; i < take->points; i++)
        if (take->parents[i] == point)
            put_channels(file, take, frame, i);
}

bool himc_bvh_write(FILE *file, const himc_take *take, himc_error *error)
{
    if (!take->parents)
        return himc_error_set(
            error, "%s: the take has no skeleton to write as .bvh, expected .c3d .trc", take->file);
    fputs("HIERARCHY\n", file);
    put_joint(file, take, 0, 0);
    fprintf(file, "MOTION\nFrames: %d\nFrame Time: ", take->frames);
    himc_text_put_number(file, 1 / take->rate, 9);
    fputc('\n', file);
    for (int frame = 0; frame < take->frames; frame++) {
        put_channels(file, take, frame, 0);
        fputc('\n', file);
    }
    return true;
}
