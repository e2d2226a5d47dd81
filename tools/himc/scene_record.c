/// scene_record.c: from the performance's callbacks to the writer.
///
/// Poses are joint rotations at the task rate; where the segments are follows from them and from
/// the body's measures, which are taken from the first pose and again when they change. Heads are
/// looked at 33 times a second, as over OSC, while they move; with velocity, frequency and decay of
/// each mode a reader has their motion in between. The performance counts its time from 0 again
/// after `reset`; the recording's goes on.
#include "scene_record.h"
#include "drum/drum_performer.h"
#include "himc/body.h"
#include "himc/membrane.h"
#include "scene.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum {
    TARGET = 3 * HIMC_JOINTS, // columns
    FORCE = TARGET + 3 * HIMC_HANDS,
    TORQUE = FORCE + HIMC_HANDS,
    PELVIS = TORQUE + 3 * HIMC_JOINTS,
    SUPPORT = PELVIS + 6, // of seat, left foot and right foot
    CENTER = SUPPORT + 3 * (1 + HIMC_HANDS),
    COLUMNS = CENTER + 3
};
// chosen: at the mallets, 1 m from the joints, well below 0.01 mm; and as fine as anyone looks
#define ROTATION_STEP 1e-6 // (rad)
#define TARGET_STEP 1e-5   // (m)
#define FORCE_STEP 0.01    // (N)
#define TORQUE_STEP 0.02   // (N m)
#define PLACE_STEP 1e-6    // of the pelvis (m)
#define SUPPORT_STEP 0.1   // (N)
#define CENTER_STEP 1e-4   // (m)
#define HEAD_HZ 33.0       // as subscriptions have it
#define LEAST_PART 1e-4    // of a mode in a shape; chosen: less than a byte of an amplitude
#define STILL 1e-8         // (m) a head that moves less is at rest; chosen: far below a pixel
// (m) measures this near are those of the same body; chosen: in hard blows joints give way by some
// micrometres, and poses are to be exact to 10
#define SAME 1e-6

struct scene_record {
    himc_performance *performance;
    scene_writer *scene;
    FILE *captured_file; // the scene of the take itself
    scene_writer *captured;
    int captured_rows;
    scene_column column[COLUMNS];
    himc_vec3 origin[HIMC_SEGMENTS], tip[HIMC_HANDS]; // measures of the body that was told
    unsigned told[HIMC_DRUMS];                        // revision of each drum, plus 1
    double pitch[HIMC_DRUMS];                         // principal mode that was told (Hz)
    bool moving[HIMC_DRUMS];
    double next_head;
    char *lines; // of the score, JSON
    size_t size;
};

static void name_column(scene_column *column, const char *owner, const char *what, char axis,
                        const char *unit, double step)
{
    snprintf(column->name, sizeof column->name, "%s%s_%c_%s", owner, what, axis, unit);
    column->step = step;
}

static void name_columns(scene_column *column)
{
    for (int i = 0; i < TARGET; i++)
        name_column(&column[i], himc_joint_name(i / 3), "", (char)('x' + i % 3), "rad",
                    ROTATION_STEP);
    for (int i = 0; i < FORCE - TARGET; i++)
        name_column(&column[TARGET + i], himc_hand_name((himc_hand)(i / 3)), "_target",
                    (char)('x' + i % 3), "m", TARGET_STEP);
    for (int i = 0; i < HIMC_HANDS; i++) {
        snprintf(column[FORCE + i].name, sizeof column->name, "%s_force_n",
                 himc_hand_name((himc_hand)i));
        column[FORCE + i].step = FORCE_STEP;
    }
    for (int i = 0; i < PELVIS - TORQUE; i++)
        name_column(&column[TORQUE + i], himc_joint_name(i / 3), "_torque", (char)('x' + i % 3),
                    "n_m", TORQUE_STEP);
    static const struct {
        const char *owner, *what, *unit;
        double step;
    } root[] = {
        {"pelvis", "_position", "m", PLACE_STEP},    {"pelvis", "", "rad", ROTATION_STEP},
        {"seat", "_force", "n", SUPPORT_STEP},       {"left", "_foot_force", "n", SUPPORT_STEP},
        {"right", "_foot_force", "n", SUPPORT_STEP}, {"root", "_center", "m", CENTER_STEP}};
    for (int i = 0; i < COLUMNS - PELVIS; i++)
        name_column(&column[PELVIS + i], root[i / 3].owner, root[i / 3].what, (char)('x' + i % 3),
                    root[i / 3].unit, root[i / 3].step);
}

// the recording's time of a time of the performance: `reset` leaves the count of samples as it is
static double own(const scene_record *r, double time)
{
    himc_performance_stats s = himc_performance_measure(r->performance);
    double played = (double)himc_performance_time(r->performance) / s.sample_rate;
    return time + (played - s.seconds);
}

static double now(const scene_record *r)
{
    return own(r, himc_performance_measure(r->performance).seconds);
}

// --- the body

static himc_vec3 in_frame(const himc_body_state *body, int segment, himc_vec3 at)
{
    return himc_quat_rotate(himc_quat_conj(body->orientation[segment]),
                            himc_vec3_sub(at, body->origin[segment]));
}

static bool differs(himc_vec3 *told, himc_vec3 now)
{
    bool far = himc_vec3_length(himc_vec3_sub(*told, now)) > SAME;
    if (far)
        *told = now;
    return far;
}

// the parents of the segments are those of any body
static const himc_skeleton *usual(void)
{
    static himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    if (!skeleton.mass)
        himc_skeleton_init(&skeleton, &config, NULL);
    return &skeleton;
}

static size_t put_point(char *out, size_t size, const char *before, himc_vec3 p)
{
    return (size_t)snprintf(out, size, "%s[%.9g,%.9g,%.9g]", before, p.x, p.y, p.z);
}

static void tell_body(scene_record *r, double time)
{
    char text[4096];
    size_t used = 0;
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        used += (size_t)snprintf(
            text + used, sizeof text - used,
            "%s{\"name\":\"%s\",\"joint\":\"%s\",\"parent\":%d,\"origin\":", i ? "," : "",
            himc_segment_name(i), i ? himc_joint_name(i - 1) : "", usual()->segment[i].parent);
        used += put_point(text + used, sizeof text - used, "", r->origin[i]);
        used += (size_t)snprintf(text + used, sizeof text - used, "}");
    }
    used += (size_t)snprintf(text + used, sizeof text - used, "],\"tips\":[");
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        used += put_point(text + used, sizeof text - used, hand ? "," : "", r->tip[hand]);
    for (int i = 0; i < 2; i++)
        if (i ? r->captured : r->scene)
            scene_event(i ? r->captured : r->scene,
                        "\"event\":\"body\",\"time\":%.6f,\"segments\":[%s]", time, text);
}

static double component(himc_vec3 v, int i)
{
    return i % 3 == 0 ? v.x : i % 3 == 1 ? v.y : v.z;
}

static void put_pelvis(double *value, himc_vec3 place, himc_quat orientation)
{
    himc_vec3 rotation = himc_quat_log(orientation);
    for (int i = 0; i < 6; i++)
        value[PELVIS + i] = component(i < 3 ? place : rotation, i);
}

// a row of the take itself: its joints, and the targets it was tracked by
static void captured_row(scene_record *r, const himc_tick *tick)
{
    double value[COLUMNS] = {0};
    for (int i = 0; i < FORCE; i++)
        value[i] = component(
            i < TARGET ? himc_quat_log(tick->captured[i / 3]) : tick->target[(i - TARGET) / 3], i);
    put_pelvis(value, tick->body->origin[HIMC_PELVIS], tick->body->orientation[HIMC_PELVIS]);
    scene_row(r->captured, own(r, tick->time), value);
    r->captured_rows++;
}

void scene_record_tick(void *record, const himc_tick *tick)
{
    scene_record *r = record;
    const himc_body_state *b = tick->body;
    // where a free pelvis goes is in the rows
    bool changed = !tick->support && differs(&r->origin[HIMC_PELVIS], b->origin[HIMC_PELVIS]);
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        changed |= differs(&r->origin[i], in_frame(b, usual()->segment[i].parent, b->origin[i]));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        changed |=
            differs(&r->tip[hand], in_frame(b, himc_stick_segment((himc_hand)hand), b->tip[hand]));
    if (changed) {
        r->origin[HIMC_PELVIS] = b->origin[HIMC_PELVIS];
        tell_body(r, own(r, tick->time));
    }
    if (r->captured && tick->captured)
        captured_row(r, tick);
}

void scene_record_row(void *record, const himc_motion_row *row)
{
    scene_record *r = record;
    double value[COLUMNS];
    for (int i = 0; i < FORCE; i++)
        value[i] = component(i < TARGET ? row->joint[i / 3] : row->target[(i - TARGET) / 3], i);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        value[FORCE + hand] = row->force[hand];
    for (int i = 0; i < PELVIS - TORQUE; i++)
        value[TORQUE + i] = component(row->torque[i / 3], i);
    put_pelvis(value, row->segment[HIMC_PELVIS], row->orientation[HIMC_PELVIS]);
    const himc_vec3 support[] = {row->seat_force, row->foot_force[HIMC_LEFT],
                                 row->foot_force[HIMC_RIGHT], row->root_center};
    for (int i = 0; i < COLUMNS - SUPPORT; i++)
        value[SUPPORT + i] = component(support[i / 3], i);
    scene_row(r->scene, own(r, row->time), value);
}

// --- events

void scene_record_event(scene_record *r, const himc_event *event)
{
    char text[6 * sizeof event->text], nuance[6 * HIMC_NAME_SIZE], drum[6 * HIMC_NAME_SIZE];
    char beat[40] = "null";
    const himc_strike *s = &event->strike;
    bool stroke = event->kind == HIMC_EVENT_STRIKE || event->kind == HIMC_EVENT_MISSED;
    if (stroke && isfinite(s->beat))
        snprintf(beat, sizeof beat, "%.9g", s->beat);
    if (event->kind == HIMC_EVENT_BEAT)
        scene_event(r->scene, "\"event\":\"beat\",\"time\":%.6f,\"beat\":%.9g", own(r, event->time),
                    event->beat);
    else if (event->kind == HIMC_EVENT_NOTE)
        scene_event(r->scene, "\"event\":\"note\",\"time\":%.6f,\"text\":\"%s\"", now(r),
                    scene_text(text, sizeof text, event->text));
    else if (event->kind == HIMC_EVENT_MISSED)
        scene_event(
            r->scene,
            "\"event\":\"missed\",\"time\":%.6f,\"due\":%.6f,\"hand\":\"%s\",\"drum\":\"%s\","
            "\"nuance\":\"%s\",\"beat\":%s,\"x\":%.6f,\"y\":%.6f,\"why\":\"%s\"",
            now(r), own(r, s->time), himc_hand_name(s->hand),
            scene_text(drum, sizeof drum, s->drum), scene_text(nuance, sizeof nuance, s->nuance),
            beat, s->x, s->y, scene_text(text, sizeof text, event->text));
    else if (event->kind == HIMC_EVENT_STRIKE)
        scene_event(r->scene,
                    "\"event\":\"strike\",\"time\":%.6f,\"hand\":\"%s\",\"drum\":\"%s\","
                    "\"nuance\":\"%s\",\"beat\":%s,\"x\":%.6f,\"y\":%.6f,\"velocity\":%.5g,"
                    "\"force\":%.6g,\"impulse\":%.6g,\"duration\":%.6g",
                    own(r, s->time), himc_hand_name(s->hand),
                    scene_text(drum, sizeof drum, s->drum),
                    scene_text(nuance, sizeof nuance, s->nuance), beat, s->x, s->y, s->velocity,
                    s->force, s->impulse, s->duration);
}

// --- drums

// a list of JSON strings that grows
static void add_line(void *user, const char *line)
{
    scene_record *r = user;
    size_t room = 6 * strlen(line) + 16;
    char *lines = realloc(r->lines, r->size + room);
    if (!lines)
        return; // the list is for the reader only
    r->lines = lines;
    r->size += (size_t)sprintf(lines + r->size, "%s\"", r->size ? "," : "");
    scene_text(lines + r->size, room - 4, line);
    r->size += strlen(lines + r->size);
    lines[r->size++] = '"';
    lines[r->size] = 0;
}

static const char *listed(const scene_record *r)
{
    return r->size ? r->lines : "";
}

// adds text of numbers to a buffer that is large enough
static size_t put_numbers(char *out, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int n = vsprintf(out, format, args);
    va_end(args);
    return (size_t)n;
}

static int shown_modes(const himc_membrane *membrane)
{
    int modes = himc_membrane_audible(membrane);
    return modes < SCENE_MODES ? modes : SCENE_MODES;
}

// frequency and decay of each mode; then what each adds to the bare head's shapes: shape, mode,
// part
static void tell_modes(scene_record *r, int index, const himc_membrane *membrane, double time)
{
    enum { ROOM = SCENE_MODES * 48 };
    char modes[ROOM], *parts = malloc(SCENE_MODES * ROOM);
    int count = shown_modes(membrane);
    size_t used = 0, more = 0;
    for (int i = 0; parts && i < count; i++) {
        himc_mode mode = himc_membrane_mode(membrane, i);
        double unit[SCENE_MODES] = {0}, shape[SCENE_MODES];
        unit[i] = 1;
        himc_membrane_upright(membrane, count, unit, shape);
        used +=
            put_numbers(modes + used, "%s[%.8g,%.4g]", i ? "," : "", mode.frequency, mode.decay);
        for (int k = 0; k < count; k++)
            if (fabs(shape[k]) > LEAST_PART)
                more +=
                    put_numbers(parts + more, "%s[%d,%d,%.5g]", more ? "," : "", k, i, shape[k]);
    }
    if (parts && count)
        scene_event(r->scene,
                    "\"event\":\"modes\",\"time\":%.6f,\"drum\":%d,\"modes\":[%s],\"shapes\":[%s]",
                    time, index, modes, parts);
    free(parts);
}

static void tell_drum(scene_record *r, int index, const himc_drum *drum, double time)
{
    const himc_head_frame *f = himc_drum_head_frame(drum);
    char name[6 * HIMC_NAME_SIZE];
    r->size = 0;
    himc_drum_describe(drum, HIMC_DESCRIBE_STATE, add_line, r);
    scene_event(r->scene,
                "\"event\":\"drum\",\"time\":%.6f,\"drum\":%d,\"name\":\"%s\","
                "\"place\":[%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g],\"hz\":%.6g,\"settings\":[%s]",
                time, index, scene_text(name, sizeof name, himc_drum_name(drum)), f->center.x,
                f->center.y, f->center.z, f->tilt, f->radius, f->length, f->width,
                himc_drum_pitch(drum), listed(r));
    tell_modes(r, index, himc_drum_membrane((himc_drum *)drum), time);
    r->told[index] = himc_drum_revision(drum) + 1;
    r->pitch[index] = himc_drum_pitch(drum);
}

// the head is as far as the last physics step, so it has a time of its own
static void look_at_head(scene_record *r, int index, himc_drum *drum)
{
    double most = 0, v, time = (double)himc_drum_time(drum) / himc_drum_rate(drum);
    const himc_membrane *membrane = himc_drum_membrane(drum);
    scene_ring ring = {.modes = shown_modes(membrane)};
    for (int i = 0; i < ring.modes; i++) {
        himc_membrane_state(membrane, i, &ring.q[i], &v);
        ring.s[i] = v / (2 * HIMC_PI * himc_membrane_mode(membrane, i).frequency);
        most = fmax(most, fmax(fabs(ring.q[i]), fabs(ring.s[i])));
    }
    bool moves = most > STILL;
    if (moves || r->moving[index]) // the last one tells that it is still
        scene_head(r->scene, index, time, &ring);
    r->moving[index] = moves;
}

void scene_record_block(scene_record *r, const float *frames, int n)
{
    himc_drum *drum;
    double time = now(r);
    bool heads = time >= r->next_head;
    for (int i = 0; (drum = himc_performance_drum(r->performance, i)); i++) {
        bool tuned = heads && himc_drum_pitch(drum) != r->pitch[i];
        if (tuned || r->told[i] != himc_drum_revision(drum) + 1)
            tell_drum(r, i, drum, time);
        if (heads)
            look_at_head(r, i, drum);
    }
    if (heads)
        r->next_head = time + 1 / HEAD_HZ;
    if (frames)
        scene_sound(r->scene, frames, n);
}

// --- the whole

static void tell_score(scene_record *r, const char *source)
{
    char text[4096];
    r->size = 0;
    himc_performance_describe(r->performance, HIMC_DESCRIBE_STATE, add_line, r);
    scene_event(r->scene, "\"event\":\"score\",\"time\":0,\"source\":\"%s\",\"lines\":[%s]",
                scene_text(text, sizeof text, source), listed(r));
}

static scene_writer *open_scene(scene_record *r, const scene_record_config *c, himc_error *error)
{
    scene_config scene = {.stream = c->stream,
                          .name = c->name,
                          .column = r->column,
                          .columns = COLUMNS,
                          .rate = c->rate,
                          .channels = c->channels,
                          .live = c->live,
                          .bare = c->bare};
    return scene_open(&scene, error);
}

static bool open_captured(scene_record *r, himc_error *error)
{
    r->captured_file = tmpfile();
    scene_record_config own = {.stream = r->captured_file, .name = "captured"};
    if (!r->captured_file)
        return himc_error_set(error, "no temporary file: %s", strerror(errno));
    r->captured = open_scene(r, &own, error);
    return r->captured != NULL;
}

scene_record *scene_record_begin(const scene_record_config *config, himc_error *error)
{
    scene_record *r = calloc(1, sizeof *r);
    if (!r) {
        himc_error_set(error, "out of memory");
        return NULL;
    }
    name_columns(r->column);
    r->performance = config->performance;
    r->scene = open_scene(r, config, error);
    if (!r->scene || (config->captured && !open_captured(r, error))) {
        scene_record_end(r, NULL);
        return NULL;
    }
    tell_score(r, config->source);
    return r;
}

void scene_record_flush(scene_record *r)
{
    scene_flush(r->scene);
}

void scene_record_more(scene_record *r, FILE *stream)
{
    scene_more(r->scene, stream);
}

static bool end_captured(scene_record *r, himc_error *error)
{
    bool good = !r->captured || scene_close(r->captured, error);
    if (good && r->captured_rows)
        scene_more(r->scene, r->captured_file);
    if (r->captured_file)
        fclose(r->captured_file);
    return good;
}

bool scene_record_end(scene_record *r, himc_error *error)
{
    if (!r)
        return true;
    bool good = end_captured(r, error);
    if (r->scene) {
        scene_event(r->scene, "\"event\":\"end\",\"time\":%.6f", now(r));
        good &= scene_close(r->scene, error);
    }
    free(r->lines);
    free(r);
    return good;
}
