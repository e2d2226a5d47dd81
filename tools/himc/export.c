/// export.c: `himc export`: a score as notation, MusicXML or MIDI; or performer and set-up as a
/// model of MuJoCo (MJCF), for other engines to judge the body by.
///
/// A body element has the frame of its segment, so masses, centres and inertias are the skeleton's
/// own numbers, and a ball joint is where the skeleton has it. All geoms are for looking: they have
/// no mass and touch nothing. The key frame `rest` is the posture before the first stroke.
#include "base/head_frame.h"
#include "body/posture.h"
#include "cli.h"
#include "himc/drum.h"
#include "musicxml/export.h"
#include "musicxml/score_file.h"
#include "performance/research.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define RATE 48000.0 // every performance has one (Hz); the model does not depend on it
// the stool, as it is drawn: its radius, and its middle behind the hips (m)
#define STOOL_RADIUS 0.16
#define STOOL_BEHIND 0.11
#define PLATE 0.02 // thickness of a rectangular surface (m); chosen

typedef struct model {
    FILE *out;
    const himc_skeleton *body;
    bool free; // the pelvis moves
    himc_pose rest;
    himc_quat key[HIMC_JOINTS]; // of the joints, in the file's order
    int joints;
} model;

static void put_vector(const model *m, const char *name, himc_vec3 v)
{
    fprintf(m->out, " %s=\"%.17g %.17g %.17g\"", name, v.x, v.y, v.z);
}

static void put_rod(const model *m, const char *type, double radius, himc_vec3 from, himc_vec3 to)
{
    fprintf(m->out, " type=\"%s\" size=\"%.6g\" fromto=\"%.6g %.6g %.6g %.6g %.6g %.6g\"/>\n", type,
            radius, from.x, from.y, from.z, to.x, to.y, to.z);
}

static void put_looks(const model *m, int i)
{
    const himc_segment *s = &m->body->segment[i];
    bool stick = i == HIMC_LEFT_STICK || i == HIMC_RIGHT_STICK;
    fputs("<geom", m->out);
    put_rod(m, "capsule", s->radius, himc_vec3_make(0, 0, 0),
            stick ? m->body->tip : himc_vec3_scale(s->axis, s->length));
    if (!stick)
        return;
    fprintf(m->out, "<geom size=\"%.6g\"", m->body->mallet_radius);
    put_vector(m, "pos", m->body->tip);
    fprintf(m->out, "/>\n<site name=\"%s-tip\"", himc_hand_name(i - HIMC_LEFT_STICK));
    put_vector(m, "pos", m->body->tip);
    fputs("/>\n", m->out);
}

static void put_body(model *m, int i)
{
    const himc_segment *s = &m->body->segment[i];
    fprintf(m->out, "<body name=\"%s\"", himc_segment_name(i));
    put_vector(m, "pos", s->origin);
    fputs(">\n", m->out);
    if (i > 0) {
        fprintf(m->out, "<joint name=\"%s\" type=\"ball\"/>\n", himc_joint_name(i - 1));
        m->key[m->joints++] = m->rest.joint[i - 1];
    } else if (m->free)
        fputs("<freejoint name=\"root\"/>\n", m->out);
    fprintf(m->out, "<inertial mass=\"%.17g\"", s->mass);
    put_vector(m, "pos", s->center);
    put_vector(m, "diaginertia", s->inertia);
    fputs("/>\n", m->out);
    put_looks(m, i);
    for (int child = i + 1; child < HIMC_SEGMENTS; child++)
        if (m->body->segment[child].parent == i)
            put_body(m, child);
    fputs("</body>\n", m->out);
}

// a kettle as deep as its radius
static void put_drum(const model *m, const himc_drum *drum)
{
    const himc_head_frame *head = himc_drum_head_frame(drum);
    himc_head_axes axes = himc_head_axes_of(head);
    fprintf(m->out, "<geom name=\"%s\"", himc_drum_name(drum)); // letters and digits
    if (head->length == 0) {
        put_rod(m, "cylinder", head->radius, head->center,
                himc_vec3_madd(head->center, -head->radius, axes.normal));
        return;
    }
    fprintf(m->out, " type=\"box\" size=\"%.6g %.6g %.6g\"", 0.5 * head->length, 0.5 * head->width,
            0.5 * PLATE);
    put_vector(m, "pos", himc_vec3_madd(head->center, -0.5 * PLATE, axes.normal));
    fprintf(m->out, " xyaxes=\"%.9g %.9g %.9g %.9g %.9g %.9g\"/>\n", axes.x.x, axes.x.y, axes.x.z,
            axes.y.x, axes.y.y, axes.y.z);
}

static void put_rest(const model *m)
{
    himc_vec3 hips = m->body->segment[HIMC_PELVIS].origin;
    fputs("<keyframe><key name=\"rest\" qpos=\"", m->out);
    if (m->free)
        fprintf(m->out, "%.17g %.17g %.17g 1 0 0 0 ", hips.x, hips.y, hips.z);
    for (int j = 0; j < m->joints; j++)
        fprintf(m->out, "%.17g %.17g %.17g %.17g ", m->key[j].w, m->key[j].x, m->key[j].y,
                m->key[j].z);
    fputs("\"/></keyframe>\n", m->out);
}

static void put_model(model *m, himc_performance *p)
{
    himc_vec3 hips = m->body->segment[HIMC_PELVIS].origin;
    himc_vec3 seat = {hips.x - STOOL_BEHIND, hips.y, himc_posture_stool(m->body)};
    const himc_drum *drum;
    fprintf(m->out,
            "<mujoco model=\"himc\">\n<compiler angle=\"radian\"/>\n"
            "<option timestep=\"0.0001\" gravity=\"0 0 %.17g\"/>\n"
            "<default><geom contype=\"0\" conaffinity=\"0\" mass=\"0\"/></default>\n"
            "<worldbody>\n<geom type=\"plane\" size=\"3 3 0.1\"/>\n<geom",
            -HIMC_GRAVITY);
    put_rod(m, "cylinder", STOOL_RADIUS, himc_vec3_make(seat.x, seat.y, 0), seat);
    for (int i = 0; (drum = himc_performance_drum(p, i)); i++)
        put_drum(m, drum);
    put_body(m, HIMC_PELVIS);
    fputs("</worldbody>\n", m->out);
    put_rest(m);
    fputs("</mujoco>\n", m->out);
}

static void keep_pose(void *user, const himc_tick *tick)
{
    model *m = user;
    m->rest = himc_pose_from_state(m->body, tick->body);
}

static bool write_model(model *m, himc_performance *p, const char *path, himc_error *error)
{
    cli_file file;
    m->body = himc_performance_plant(p);
    himc_performance_on_tick(p, keep_pose, m);
    himc_performance_process(p, 1, NULL); // the stool finds its height
    if (!cli_file_open(&file, path, error))
        return false;
    m->out = file.stream;
    put_model(m, p);
    bool good = cli_file_close(&file, error) && cli_file_keep(&file, error);
    cli_file_drop(&file);
    return good;
}

// notation

static bool ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), end = strlen(ending);
    return length >= end && strcasecmp(name + length - end, ending) == 0;
}

// the title of a piece: its file's name without what XML would take for more
static void title_of(char *title, size_t size, const char *path)
{
    const char *slash = strrchr(path, '/');
    snprintf(title, size, "%s", slash ? slash + 1 : path);
    title[strcspn(title, ".")] = '\0';
    for (char *c = title; *c; c++)
        *c = isalnum((unsigned char)*c) || *c == '-' ? *c : ' ';
}

static void put_bytes(const void *from, FILE *out)
{
    const himc_text_lines *text = from;
    fwrite(text->bytes, 1, text->size, out);
}

static bool write_notation(const char *path, const char *out, bool midi, himc_error *error)
{
    himc_text_lines text = {0};
    midi_file notes = {0};
    char title[64];
    himc_score *score = himc_score_load(path, error);
    bool good = score && (himc_music_notes(&notes, score, midi, error) ||
                          himc_error_prefix(error, "%s", path));
    title_of(title, sizeof title, path);
    if (good &&
        !(midi ? himc_music_write_midi(&text, &notes) : himc_music_write(&text, &notes, title)))
        good = himc_error_set(error, "out of memory for the notes");
    good = good && cli_write(out, put_bytes, &text, error);
    if (good && notes.said)
        cli_say("%s", notes.said);
    free(text.bytes);
    himc_midi_file_free(&notes);
    himc_score_free(score);
    return good;
}

enum { OUT, STANCE };

static const cli_option options[] = {
    {"output", 'o', "FILE", "notation: .musicxml, .mid; the model: .xml, - is standard output"},
    {"stance", 0, "STANCE",
     "fixed: the pelvis is held; seated, standing: it has a free joint; else as SETUP says"},
    {0},
};

static bool export(const cli_arguments *arguments, himc_error *error)
{
    const char *path = arguments->operand, *out = arguments->value[OUT];
    const char *stance = arguments->value[STANCE];
    model m = {.free = false};
    if (!out)
        return himc_error_set(error, "no -o FILE given (himc export --help)");
    bool midi = ends_with(out, ".mid");
    if (midi || ends_with(out, ".musicxml")) {
        if (!path)
            return himc_error_set(error, "no SCORE given, expected one to write as notes");
        if (stance)
            return himc_error_set(error, "--stance: %s, expected with a model alone (.xml)",
                                  stance);
        return (path = cli_input(path, error)) && cli_apart(out, &path, 1, error) &&
               write_notation(path, out, midi, error);
    }
    if (!cli_is_standard(out) && !ends_with(out, ".xml"))
        return himc_error_set(
            error, "-o: %s, expected a name that ends with .musicxml, .mid or .xml", out);
    if ((path && (!(path = cli_input(path, error)) || !cli_apart(out, &path, 1, error))))
        return false;
    himc_performance *p = cli_load(path, RATE, NULL, error);
    bool good = p && (!stance || cli_tell(p, "stance", stance, error));
    if (good) {
        m.free = himc_performance_plant(p)->segment[HIMC_PELVIS].joint == HIMC_JOINT_FREE;
        good = write_model(&m, p, out, error);
    }
    himc_performance_free(p);
    return good;
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    return export(arguments, &error) ? cli_finish(&cli_export)
                                     : cli_fail(&cli_export, "%s", error.text);
}

const cli_call cli_export = {
    "export",
    "[SCORE]",
    " -o FILE",
    "writes a score as MusicXML or MIDI, or body and drums as a model of MuJoCo (MJCF)",
    "-o F.musicxml, F.mid: the strokes of a score as a part to print; what notation does not\n"
    "have is counted on stderr. `himc import` reads it back: a pedal is \"C3 muta in D3\", a hand\n"
    "on the head \"secco\", sticking a fingering, dynamics are steps; MIDI keeps times, pitches and\n"
    "velocities.\n"
    "-o F.xml: player and drums of a score or a take; without it the usual ones. Segments have\n"
    "their masses, centres and inertias and ball joints; all geoms are for looking and touch\n"
    "nothing. Sites are at the sticks' tips, the key frame `rest` is the posture before a stroke.\n"
    "With a free joint, the columns `root` of `himc render --motion` are the force and moment on\n"
    "the pelvis.",
    options,
    run,
};
