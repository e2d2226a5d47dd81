/// engine.c: the performer inside a page (WebAssembly), where viewer/page/worker.js calls it.
///
/// One performance at a time, as `himc play` makes it of a score, a MIDI file, a take or nothing.
/// page_play() computes samples for the loudspeaker and tells what happens meanwhile as a frame of
/// the viewer's stream (viewer/scene_encode.c), which the page draws as that of any live performer.
/// A line of text is a command as in Pure Data; what it is answered is a line, too.
#include "engine.h"
#include "drum/drum_performer.h"
#include "himc/body.h"
#include "himc/membrane.h"
#include "scene.h"
#include "tools/himc/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define KEY "page" // the sender, of which the page has one
#define EARS 2
#define BLOCK 64
#define LONGEST 9600     // samples at a time; chosen: a cell of `himc render`
#define LOOK_HZ 60.0     // poses and heads; chosen: as often as a screen shows them
#define SILENT_APART 0.2 // (s) chosen: the sound was off

static struct {
    himc_performance *performance;
    double rate;
    cli_ending ending; ///< of the piece
    scene scene;
    scene_reader reader;
    double wall;                 ///< now (s)
    double told;                 ///< the wall's time of the next sample, as the page is told it (s)
    double next_pose, next_look; ///< (samples of the piece)
    unsigned revision[HIMC_DRUMS];
    float sound[EARS * LONGEST];
    uint8_t frame[SCENE_FRAME_MAX];
    size_t frame_size;
    char input[PAGE_INPUT];
    himc_error error;
} e;

// --- what is seen

static void put(float *out, himc_vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void on_tick(void *user, const himc_tick *tick)
{
    (void)user;
    if ((double)e.ending.samples < e.next_pose)
        return;
    e.next_pose = (double)e.ending.samples + e.rate / LOOK_HZ;
    const himc_body_state *body = tick->body;
    scene_performer *p = scene_find_performer(&e.scene, KEY, e.wall);
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        himc_quat q = body->orientation[i];
        p->body[i][3] = (float)q.w;
        put(p->body[i], body->origin[i]);
        put(p->body[i] + 4, himc_quat_vector(q));
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        put(p->target[hand], tick->target[hand]);
    if (tick->support) {
        const himc_support_forces *f = tick->support;
        put(p->support, f->seat);
        put(p->support + 3, f->foot[HIMC_LEFT]);
        put(p->support + 6, f->foot[HIMC_RIGHT]);
        put(p->support + 9, isfinite(f->center.z) ? f->center : body->origin[HIMC_PELVIS]);
    } else
        memset(p->support, 0, sizeof p->support);
    p->known = (UINT32_C(1) << HIMC_SEGMENTS) - 1;
    p->targets = (UINT32_C(1) << HIMC_HANDS) - 1;
    p->told = e.told;
    p->version++;
}

static void look_at_drum(int index, himc_drum *drum)
{
    const himc_head_frame *f = himc_drum_head_frame(drum);
    himc_membrane *membrane = himc_drum_membrane(drum);
    int modes = himc_membrane_audible(membrane);
    double q[SCENE_MODES];
    scene_drum *d = scene_find_drum(&e.scene, KEY, himc_drum_name(drum), e.wall);
    if (!d)
        return;
    if (!d->placed || e.revision[index] != himc_drum_revision(drum)) {
        put(d->place, f->center);
        d->place[3] = (float)f->tilt;
        d->place[4] = (float)f->radius;
        d->place[5] = (float)f->length;
        d->place[6] = (float)f->width;
        d->placed = true;
        e.revision[index] = himc_drum_revision(drum);
    }
    d->modes = (uint32_t)(modes < SCENE_MODES ? modes : SCENE_MODES);
    himc_membrane_upright(membrane, (int)d->modes, NULL, q);
    for (uint32_t i = 0; i < d->modes; i++)
        d->amplitude[i] = (float)q[i];
    d->told = e.told;
    d->version++;
}

static void look(void)
{
    himc_drum *drum;
    if ((double)e.ending.samples < e.next_look)
        return;
    e.next_look = (double)e.ending.samples + e.rate / LOOK_HZ;
    for (int i = 0; (drum = himc_performance_drum(e.performance, i)); i++)
        look_at_drum(i, drum);
}

static void tell_line(const char *event, const char *line)
{
    char clean[1200];
    scene_word(clean, sizeof clean, line);
    scene_add_event(&e.scene, e.wall, "{\"event\":\"%s\",\"text\":\"%s\"}", event, clean);
}

static void tell_strike(const himc_strike *s)
{
    char drum[HIMC_NAME_SIZE], nuance[HIMC_NAME_SIZE];
    double ago = himc_performance_measure(e.performance).seconds - s->time;
    scene_word(drum, sizeof drum, s->drum);
    scene_word(nuance, sizeof nuance, s->nuance);
    scene_add_event(
        &e.scene, e.wall,
        "{\"event\":\"strike\",\"from\":\"" KEY
        "\",\"told\":%.3f,\"time\":%.6f,\"hand\":\"%s\",\"drum\":\"%s\",\"x\":%.5f,"
        "\"y\":%.5f,\"velocity\":%.4g,\"force\":%.5g,\"duration\":%.5g,\"nuance\":\"%s\"}",
        1e3 * (e.told - ago), s->time, himc_hand_name(s->hand), drum, s->x, s->y, s->velocity,
        s->force, s->duration, nuance);
}

static void take_events(void)
{
    himc_event event;
    while (himc_performance_event(e.performance, &event))
        switch (event.kind) {
        case HIMC_EVENT_STRIKE: tell_strike(&event.strike); break;
        case HIMC_EVENT_BEAT:
            scene_add_event(&e.scene, e.wall,
                            "{\"event\":\"beat\",\"from\":\"" KEY "\",\"beat\":%.6g}", event.beat);
            break;
        case HIMC_EVENT_DONE:
            e.ending.done = true;
            tell_line("done", "");
            break;
        case HIMC_EVENT_NOTE: tell_line(event.refused ? "refused" : "note", event.text); break;
        case HIMC_EVENT_MISSED: tell_line("missed", event.text); break;
        case HIMC_EVENT_PREPARE: break; // the picture shows it
        }
}

// --- what the page asks for

char *page_input(void)
{
    return e.input;
}

const char *page_error(void)
{
    return e.error.text;
}

himc_error *page_reason(void)
{
    return &e.error;
}

bool page_load(double rate)
{
    himc_performance *p = cli_load(e.input[0] ? e.input : NULL, rate, CLI_LISTENER, &e.error);
    if (!p)
        return false;
    himc_performance_free(e.performance);
    e.performance = p;
    e.rate = rate;
    e.ending = (cli_ending){0};
    e.next_pose = e.next_look = 0;
    memset(&e.scene, 0, sizeof e.scene);
    memset(&e.reader, 0, sizeof e.reader);
    himc_performance_on_tick(p, on_tick, NULL);
    return true;
}

static void answer(void *user, const char *line)
{
    (void)user;
    tell_line("line", line);
}

static bool obey(const himc_command *c)
{
    himc_performance *p = e.performance;
    if ((c->id == HIMC_COMMAND_INFO || c->id == HIMC_COMMAND_DUMP) && c->count == 0) {
        himc_performance_describe(
            p, c->id == HIMC_COMMAND_INFO ? HIMC_DESCRIBE_INFO : HIMC_DESCRIBE_STATE, answer, NULL);
        return true;
    }
    himc_drum *drum = NULL;
    bool asks = c->id == HIMC_COMMAND_DRUM_INFO || c->id == HIMC_COMMAND_DRUM_DUMP;
    for (int i = 0; asks && (drum = himc_performance_drum(p, i)); i++)
        if (!strcmp(himc_drum_name(drum), c->drum))
            break;
    if (!drum)
        return himc_performance_command(p, c, 0, &e.error);
    himc_drum_describe(drum,
                       c->id == HIMC_COMMAND_DRUM_INFO ? HIMC_DESCRIBE_INFO : HIMC_DESCRIBE_STATE,
                       answer, NULL);
    return true;
}

bool page_command(void)
{
    himc_command command;
    if (!e.performance)
        return himc_error_set(&e.error, "no performer yet, expected a score first");
    if (!himc_command_parse_text(&command, HIMC_PERFORMER, e.input, &e.error) || !obey(&command))
        return false;
    if (command.id == HIMC_COMMAND_PLAY || command.id == HIMC_COMMAND_RESET)
        e.ending.done = false;
    cli_unwatch(e.performance); // drums may be new
    return true;
}

const float *page_play(int samples, double wall)
{
    e.wall = wall;
    if (fabs(wall - e.told) > SILENT_APART && wall > 0)
        e.told = wall;
    for (int at = 0; at < samples; at += BLOCK) {
        double peak = himc_performance_read(e.performance, e.sound + EARS * at, EARS, BLOCK);
        e.ending.cell_peak = fmax(e.ending.cell_peak, peak);
        look();
        e.ending.samples += BLOCK;
        e.told += BLOCK / e.rate;
        take_events();
    }
    return e.sound;
}

double page_told(void)
{
    return 1e3 * e.told;
}

const uint8_t *page_frame(void)
{
    e.frame_size = scene_encode(&e.scene, &e.reader, e.wall, e.frame);
    return e.frame;
}

size_t page_frame_size(void)
{
    return e.frame_size;
}

bool page_is_over(void)
{
    return cli_is_over(&e.ending, (int)e.rate);
}
