/// sender.c: plays what `himc render --motion M.csv --strokes S.csv` wrote as OSC, as a performer
/// would send it: poses at 33 Hz by the library's forward kinematics, strikes when they happen, the
/// drumhead's modes from the library's membrane under these strikes. For the viewer's tests and for
/// looking at it.
///
///     sender PORT M.csv S.csv [--performers N] [--seconds T] [--start T] [--still] [--expect FILE]
///
/// --still sends the pose of --start over and over; --expect writes its segments' joints, a line
/// each. Strikes carry the wall clock (s) as their time, so that the page can tell the latency.
#define _POSIX_C_SOURCE 200809L
#include "himc/membrane.h"
#include "himc/body.h"

#include "../support/heads.h"

#include <lo/lo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    COLUMNS = 80,
    JOINT_COLUMN = 13,
    PERFORMERS = 16,
    STROKES = 4096,
    SENT_MODES = 40,
    HEAD_RATE = 8000
};
#define POSE_PERIOD (1 / 33.0)

typedef struct stroke {
    double time, x, y, velocity, force, impulse, duration;
    char hand[8], drum[32], nuance[32];
} stroke;

typedef struct motion {
    double (*row)[COLUMNS];
    int rows, strokes;
    stroke stroke[STROKES];
} motion;

typedef struct player {
    lo_server server; // its port is the performer's
    himc_membrane *head;
    int next; // stroke
    double offset;
} player;

static void die(const char *what)
{
    fprintf(stderr, "sender: %s\n", what);
    exit(1);
}

static void load_motion(motion *m, const char *path)
{
    static char line[65536];
    FILE *file = fopen(path, "r");
    if (!file || !fgets(line, sizeof line, file))
        die("cannot read the motion");
    while (fgets(line, sizeof line, file)) {
        m->row = realloc(m->row, (size_t)(m->rows + 1) * sizeof *m->row);
        char *at = line;
        for (int i = 0; m->row && i < COLUMNS; i++, at += *at == ',')
            m->row[m->rows][i] = strtod(at, &at);
        m->rows++;
    }
    fclose(file);
}

static void load_strokes(motion *m, const char *path)
{
    char line[512];
    FILE *file = fopen(path, "r");
    if (!file || !fgets(line, sizeof line, file))
        die("cannot read the strokes");
    while (fgets(line, sizeof line, file) && m->strokes < STROKES) {
        stroke *s = &m->stroke[m->strokes];
        m->strokes += sscanf(line, "%lf,%7[^,],%31[^,],%31[^,],%lf,%lf,%lf,%lf,%lf,%lf", &s->time,
                             s->hand, s->drum, s->nuance, &s->x, &s->y, &s->velocity, &s->force,
                             &s->impulse, &s->duration) == 10;
    }
    fclose(file);
}

static double wall(void)
{
    struct timespec t;
    clock_gettime(CLOCK_REALTIME, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void sleep_until(double time)
{
    double left = time - wall();
    struct timespec t = {(time_t)left, (long)(1e9 * (left - floor(left)))};
    if (left > 0)
        nanosleep(&t, NULL);
}

static const double *row_at(const motion *m, double time)
{
    long i = lround((time - m->row[0][0]) / (m->row[1][0] - m->row[0][0]));
    return m->row[i < 0 ? 0 : i < m->rows ? i : m->rows - 1];
}

static himc_body_state state_at(const motion *m, const himc_skeleton *k, double time)
{
    himc_body_state state;
    himc_pose pose;
    const double *r = row_at(m, time) + JOINT_COLUMN;
    for (int j = 0; j < HIMC_JOINTS; j++)
        pose.joint[j] = himc_quat_exp(himc_vec3_make(r[3 * j], r[3 * j + 1], r[3 * j + 2]));
    himc_pose_to_state(k, &pose, NULL, &state);
    return state;
}

static void send_pose(const player *p, lo_address to, const himc_body_state *state,
                      const double *row)
{
    lo_bundle bundle = lo_bundle_new(LO_TT_IMMEDIATE);
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        lo_message m = lo_message_new();
        himc_vec3 at = state->origin[i];
        himc_quat q = state->orientation[i];
        lo_message_add(m, "sfffffff", himc_segment_name(i), at.x, at.y, at.z, q.w, q.x, q.y, q.z);
        lo_bundle_add_message(bundle, "/himc/body", m);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        lo_message m = lo_message_new();
        lo_message_add(m, "sfff", himc_hand_name(hand), row[1 + 3 * hand], row[2 + 3 * hand],
                       row[3 + 3 * hand]);
        lo_bundle_add_message(bundle, "/himc/targets", m);
    }
    lo_send_bundle_from(to, p->server, bundle);
    lo_bundle_free_recursive(bundle);
}

// a half sine as long as the contact was
static void hit_head(player *p, const stroke *s)
{
    double sound, watched, *const out = &sound;
    int n = (int)(s->duration * HEAD_RATE) + 1;
    for (int i = 0; i < n; i++) {
        himc_membrane_push(p->head, s->x, s->y, s->force * sin(HIMC_PI * (i + 0.5) / n));
        himc_membrane_run(p->head, 1, &out, &watched);
    }
}

static void send_head(player *p, lo_address to, int index)
{
    static double sound[HEAD_RATE], watched[HEAD_RATE], *const out = sound;
    char path[64];
    himc_membrane_run(p->head, (int)(HEAD_RATE * POSE_PERIOD), &out, watched);
    snprintf(path, sizeof path, "/membrane/kettle%d/head", index);
    lo_message m = lo_message_new();
    for (int i = 0; i < SENT_MODES; i++) {
        double q, v;
        himc_membrane_state(p->head, i, &q, &v);
        lo_message_add_float(m, (float)q);
    }
    lo_send_message_from(to, p->server, path, m);
    lo_message_free(m);
}

static void send_strike(const player *p, lo_address to, const stroke *s, int index)
{
    char drum[32];
    snprintf(drum, sizeof drum, "kettle%d", index);
    lo_send_from(to, p->server, LO_TT_IMMEDIATE, "/himc/strike", "dssfffffs", wall(), s->hand, drum,
                 s->x, s->y, s->velocity, s->force, s->duration, s->nuance);
}

static void send_rest(const player *p, lo_address to, const motion *m, double time, int index)
{
    char path[64];
    snprintf(path, sizeof path, "/membrane/kettle%d/place", index);
    lo_send_from(to, p->server, LO_TT_IMMEDIATE, path, "fffff", 0.70, 0.0, 0.85, 0.0, 0.29210);
    lo_send_from(to, p->server, LO_TT_IMMEDIATE, "/himc/status", "sfsisi", "load", 0.17, "strokes",
                 p->next, "rows", m->rows);
    lo_send_from(to, p->server, LO_TT_IMMEDIATE, "/himc/beat", "f", floor(time * 92 / 60));
}

static void expect(const char *path, const himc_body_state *state)
{
    FILE *file = fopen(path, "w");
    if (!file)
        die("cannot write what is expected");
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        fprintf(file, "%s %.6f %.6f %.6f\n", himc_segment_name(i), state->origin[i].x,
                state->origin[i].y, state->origin[i].z);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        fprintf(file, "%s-tip %.6f %.6f %.6f\n", himc_hand_name(hand), state->tip[hand].x,
                state->tip[hand].y, state->tip[hand].z);
    fclose(file);
}

typedef struct plan {
    const char *port, *expect;
    int performers;
    double seconds, start;
    bool still;
} plan;

static void open_players(player *players, const plan *p, const motion *m)
{
    himc_head head = dry_head();
    for (int i = 0; i < p->performers; i++) {
        players[i] = (player){.server = lo_server_new(NULL, NULL), .offset = 0.37 * i};
        players[i].head = himc_membrane_new(&head, HEAD_RATE, NULL);
        if (!players[i].server || !players[i].head)
            die("cannot open a performer");
        while (players[i].next < m->strokes &&
               m->stroke[players[i].next].time < p->start + players[i].offset)
            players[i].next++;
    }
}

// everything one performer says up to `time` of the motion
static void play(player *p, int index, lo_address to, const motion *m, const himc_skeleton *k,
                 double time, long tick, bool still)
{
    double last = m->row[m->rows - 1][0], at = still ? time : fmod(time + p->offset, last);
    himc_body_state state = state_at(m, k, at);
    send_pose(p, to, &state, row_at(m, at));
    if (!still && p->next >= m->strokes && at < m->stroke[m->strokes - 1].time)
        p->next = 0;
    while (!still && p->next < m->strokes && m->stroke[p->next].time <= at) {
        hit_head(p, &m->stroke[p->next]);
        send_strike(p, to, &m->stroke[p->next++], index);
    }
    send_head(p, to, index);
    if (tick % 20 == 0)
        send_rest(p, to, m, at, index);
}

static plan parse(int argc, char **argv)
{
    plan p = {.performers = 1, .seconds = 1e9};
    if (argc < 4)
        die("usage: sender PORT M.csv S.csv [--performers N] [--seconds T] [--start T] [--still] "
            "[--expect FILE]");
    p.port = argv[1];
    for (int i = 4; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (!strcmp(argv[i], "--still"))
            p.still = true;
        else if (!strcmp(argv[i], "--performers"))
            p.performers = atoi(value), i++;
        else if (!strcmp(argv[i], "--seconds"))
            p.seconds = atof(value), i++;
        else if (!strcmp(argv[i], "--start"))
            p.start = atof(value), i++;
        else if (!strcmp(argv[i], "--expect"))
            p.expect = value, i++;
        else
            die(argv[i]);
    }
    if (p.performers < 1 || p.performers > PERFORMERS)
        die("--performers: expected 1 .. 16");
    return p;
}

int main(int argc, char **argv)
{
    static motion m;
    static player players[PERFORMERS];
    plan p = parse(argc, argv);
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton_init(&skeleton, &config, NULL);
    load_motion(&m, argv[2]);
    load_strokes(&m, argv[3]);
    if (m.rows < 2 || !m.strokes)
        die("nothing to play");
    lo_address to = lo_address_new("127.0.0.1", p.port);
    open_players(players, &p, &m);
    if (p.expect) {
        himc_body_state state = state_at(&m, &skeleton, p.start);
        expect(p.expect, &state);
    }
    double begin = wall();
    for (long tick = 0; (double)tick * POSE_PERIOD < p.seconds; tick++) {
        double time = (double)tick * POSE_PERIOD;
        sleep_until(begin + time);
        for (int i = 0; i < p.performers; i++)
            play(&players[i], i, to, &m, &skeleton, p.start + (p.still ? 0 : time), tick, p.still);
    }
    return 0;
}
