/// edit_play.c: a piece is played by a process that leaves a copy of itself behind every second.
///
/// fork() is the checkpoint: the copy holds the whole state of body, drums and plan, costs only the
/// pages that change, and waits. After a change the last copy before its first effect forks again,
/// takes the new strokes in place of the old ones, and plays on; copies after it are dismissed. A
/// copy whose plan rests on later strokes is not asked; if one refuses the strokes after all, an
/// earlier one is asked; the first one has not begun to play. If other lines have changed, a new
/// process loads the text. So the outcome is, bit by bit, that of playing the new text from the
/// start.
///
/// All processes write whole frames into one pipe, but one at a time: a process that plays looks at
/// a shared number before each frame and ends, with a last frame, once that is no longer its own.
#define _GNU_SOURCE // MAP_ANONYMOUS
#include "edit_play.h"
#include "cli.h"
#include "edit_player.h"
#include "performance/research.h"
#include "plan/score.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    COPIES = 100,     // that wait
    PATIENCE = 30000, // for a frame of a process that lives (ms); chosen: a loaded machine
    LARGEST = 1 << 26 // of a frame (bytes)
};

#define APART 1.0    // copies, at least (s); chosen: it is played again in a tenth of that
#define HEADROOM 2.0 // (s) a piece may begin so much later than its first beat

struct edit_play {
    edit_play *next; // of all in this process
    const char *name;
    const himc_take_options *options;
    atomic_int *turn; // shared: the playing whose process may write
    int frames[2];    // pipe
    int order[COPIES][2];
    bool waits[COPIES];               // a copy reads this pipe
    double rests[COPIES][HIMC_HANDS]; // until when the plan of each hand rests on strokes (s)
    bool plays;                       // a process writes
    double apart;                     // of the copies (s)
    unsigned char *bytes;
    size_t room;
    edit_frame held; // read before it was asked for, if `holds`
    bool holds;
};

// A process that plays holds no end of another one's pipes: whoever reads or writes there has to
// see when the process that gives orders has gone.
static edit_play *all;

/// A process that plays.
typedef struct player {
    const edit_play *of;
    edit_player piece;
    int turn, copies;
} player;

// --- in the process that plays

// the last frame of this process
static void leave(player *p, const char *kind, const char *text)
{
    edit_player_put(&p->piece, kind, text, strlen(text));
    fflush(p->piece.to);
    _exit(0);
}

static bool read_all(int from, void *to, size_t size)
{
    char *at = to;
    while (size > 0) {
        ssize_t got = read(from, at, size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

/// What a frame `copy` holds.
typedef struct copy_frame {
    uint32_t copy;
    double rests[HIMC_HANDS];
} copy_frame;

/// What a waiting copy is told, before the text.
typedef struct order {
    int turn;      // -1: leave
    uint32_t size; // of the text, with its final 0
} order;

// plays on with another text, or says why not
static void resume(player *p, const char *text)
{
    himc_error error;
    bool late;
    if (!edit_player_exchange(&p->piece, text, &late, &error))
        leave(p, late ? "late" : "fail", late ? "" : error.text);
}

// a copy of this process waits here for ever; returns in its children, with new orders
static void wait_as_copy(player *p)
{
    int me = p->copies;
    for (order o; read_all(p->of->order[me][0], &o, sizeof o) && o.turn >= 0;) {
        char *text = malloc(o.size);
        if (!text || !read_all(p->of->order[me][0], text, o.size))
            _exit(1);
        if (fork() == 0) {
            p->turn = o.turn;
            resume(p, text);
            free(text);
            return;
        }
        free(text);
    }
    leave(p, "gone", "");
}

// leaves a copy of this process behind
static void leave_copy(player *p)
{
    copy_frame me = {.copy = (uint32_t)p->copies};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        me.rests[hand] = himc_performance_rests_to(p->piece.performance, (himc_hand)hand);
    pid_t child = fork();
    if (child > 0)
        wait_as_copy(p);
    else if (child == 0)
        edit_player_put(&p->piece, "copy", &me, sizeof me);
    p->copies++;
}

static void play_on(player *p)
{
    while (!edit_player_is_over(&p->piece)) {
        if (atomic_load(p->of->turn) != p->turn)
            leave(p, "bye!", "");
        double next = p->of->apart * p->copies; // the first one waits before `play`
        if (p->copies < COPIES && (double)p->piece.ending.samples >= next * EDIT_RATE)
            leave_copy(p);
        edit_player_cell(&p->piece);
    }
    himc_error error;
    if (!edit_player_end(&p->piece, &error))
        cli_say("himc edit: %s\n", error.text);
    leave(p, "over", "");
}

// closes the ends of its pipes that the process that gives orders has, and, if it is not its `own`
// playing, all of them
static void close_ends(const edit_play *play, bool own)
{
    for (int i = 0; i < COPIES; i++) {
        close(play->order[i][1]);
        if (!own)
            close(play->order[i][0]);
    }
    close(play->frames[0]);
    if (!own)
        close(play->frames[1]);
}

static void play_from_start(const edit_play *of, int turn, const char *text, const char *record)
{
    himc_error error;
    player p = {
        .of = of,
        .turn = turn,
        .piece = {.name = of->name, .options = of->options, .to = fdopen(of->frames[1], "wb")}};
    for (const edit_play *play = all; play; play = play->next)
        close_ends(play, play == of);
    signal(SIGCHLD, SIG_IGN);
    signal(SIGPIPE, SIG_DFL); // nobody listens any more
    if (!p.piece.to)
        _exit(1);
    if (!edit_player_begin(&p.piece, text, record, &error))
        leave(&p, "fail", error.text);
    fflush(p.piece.to);
    if (!record)
        leave_copy(&p);
    if (!cli_tell(p.piece.performance, "play", NULL, &error))
        leave(&p, "fail", error.text);
    play_on(&p);
}

// --- in the process that gives orders

// gives back all but the processes
static void release(edit_play *play)
{
    edit_play **at = &all;
    while (*at && *at != play)
        at = &(*at)->next;
    if (*at)
        *at = play->next;
    for (int i = 0; i < 2 * (COPIES + 1); i++) {
        int *pipe = i < 2 ? play->frames : play->order[i / 2 - 1];
        if (pipe[i % 2] >= 0)
            close(pipe[i % 2]);
    }
    if (play->turn != MAP_FAILED)
        munmap(play->turn, sizeof *play->turn);
    free(play->bytes);
    free(play);
}

edit_play *edit_play_new(const char *name, const himc_take_options *options, himc_error *error)
{
    edit_play *play = malloc(sizeof *play);
    if (!play) {
        himc_error_set(error, "out of memory");
        return NULL;
    }
    *play = (edit_play){.name = name, .options = options};
    memset(play->frames, -1, sizeof play->frames);
    memset(play->order, -1, sizeof play->order);
    play->turn =
        mmap(NULL, sizeof *play->turn, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    bool good = play->turn != MAP_FAILED && pipe(play->frames) == 0;
    for (int i = 0; good && i < COPIES; i++)
        good = pipe(play->order[i]) == 0;
    if (!good) {
        himc_error_set(error, "%s", strerror(errno));
        release(play);
        return NULL;
    }
    play->next = all;
    all = play;
    signal(SIGCHLD, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    return play;
}

bool edit_play_holds(const edit_play *play)
{
    return play->holds;
}

int edit_play_descriptor(const edit_play *play)
{
    return play->frames[0];
}

static bool lost(himc_error *error)
{
    return himc_error_set(error, "the process that plays has ended without a word");
}

// the next frame, also those for this file alone
static bool read_frame(edit_play *play, edit_frame *frame, himc_error *error)
{
    struct pollfd ready = {.fd = play->frames[0], .events = POLLIN};
    if (poll(&ready, 1, PATIENCE) <= 0 || !read_all(play->frames[0], frame->kind, 4) ||
        !read_all(play->frames[0], &frame->size, sizeof frame->size) || frame->size > LARGEST)
        return lost(error);
    if (frame->size > play->room) {
        unsigned char *bytes = realloc(play->bytes, frame->size);
        if (!bytes)
            return himc_error_set(error, "out of memory");
        play->bytes = bytes;
        play->room = frame->size;
    }
    frame->kind[4] = 0;
    frame->bytes = play->bytes;
    if (frame->size && !read_all(play->frames[0], play->bytes, frame->size))
        return lost(error);
    if (!strcmp(frame->kind, "copy")) {
        copy_frame left;
        memcpy(&left, frame->bytes, sizeof left);
        play->waits[left.copy] = true;
        memcpy(play->rests[left.copy], left.rests, sizeof left.rests);
    }
    if (!strcmp(frame->kind, "over") || !strcmp(frame->kind, "fail") ||
        !strcmp(frame->kind, "bye!") || !strcmp(frame->kind, "late"))
        play->plays = false;
    return true;
}

bool edit_play_next(edit_play *play, edit_frame *frame, himc_error *error)
{
    bool good = true;
    if (play->holds) {
        play->holds = false;
        *frame = play->held;
        return true;
    }
    do
        good = read_frame(play, frame, error);
    while (good && !strcmp(frame->kind, "copy"));
    return good;
}

static bool give(int to, const void *bytes, size_t size)
{
    const char *at = bytes;
    while (size > 0) {
        ssize_t given = write(to, at, size);
        if (given < 0 && errno != EINTR)
            return false;
        at += given > 0 ? given : 0;
        size -= given > 0 ? (size_t)given : 0;
    }
    return true;
}

// no process writes any more
static bool stop_playing(edit_play *play, himc_error *error)
{
    edit_frame old;
    bool good = true;
    play->holds = false;
    atomic_fetch_add(play->turn, 1);
    while (good && play->plays)
        good = read_frame(play, &old, error);
    return good;
}

// the copy has gone, so that another one may read its orders
static bool dismiss(edit_play *play, int copy, himc_error *error)
{
    edit_frame frame = {.kind = ""};
    order leave = {-1, 0};
    if (!play->waits[copy])
        return true;
    play->waits[copy] = false;
    bool good = give(play->order[copy][1], &leave, sizeof leave) || lost(error);
    while (good && strcmp(frame.kind, "gone") != 0)
        good = read_frame(play, &frame, error);
    return good;
}

// has a copy play; *late if its plan rests on what has changed
static bool ask(edit_play *play, int copy, const char *text, bool *late, himc_error *error)
{
    order o = {atomic_load(play->turn), (uint32_t)strlen(text) + 1};
    play->plays = true;
    if (!give(play->order[copy][1], &o, sizeof o) || !give(play->order[copy][1], text, o.size))
        return lost(error);
    if (!read_frame(play, &play->held, error))
        return false;
    *late = !strcmp(play->held.kind, "late");
    play->holds = !*late;
    return true;
}

static bool dismiss_after(edit_play *play, int copy, himc_error *error)
{
    bool good = true;
    for (int i = COPIES - 1; i > copy && good; i--)
        good = dismiss(play, i, error);
    return good;
}

// how long the strokes last
static double length_of(const char *text)
{
    himc_error unused;
    himc_score *score = himc_score_parse(text, "", NULL, &unused);
    double seconds = 0;
    if (score && score->stroke_count)
        seconds = himc_score_seconds(score->tempi, score->tempo_count,
                                     score->strokes[score->stroke_count - 1].beat);
    himc_score_free(score);
    return seconds;
}

static bool play_anew(edit_play *play, const char *text, const char *record, himc_error *error)
{
    if (!dismiss_after(play, -1, error))
        return false;
    play->apart = record ? HUGE_VAL : fmax(APART, length_of(text) / COPIES);
    pid_t child = fork();
    if (child == 0)
        play_from_start(play, atomic_load(play->turn), text, record);
    play->plays = child > 0;
    return child > 0 || himc_error_set(error, "%s", strerror(errno));
}

bool edit_play_start(edit_play *play, const char *text, edit_span changed, const char *record,
                     himc_error *error)
{
    if (!stop_playing(play, error))
        return false;
    int copy = -1;
    if (changed.from >= 0 && !record)
        copy = (int)fmin((changed.from + HEADROOM) / play->apart, COPIES - 1);
    for (bool late = true; copy >= 0; copy--) {
        const double *rests = play->rests[copy];
        bool rest = rests[HIMC_LEFT] > changed.strokes[HIMC_LEFT] ||
                    rests[HIMC_RIGHT] > changed.strokes[HIMC_RIGHT];
        if (!play->waits[copy] || (copy > 0 && rest))
            continue;
        if (!dismiss_after(play, copy, error) || !ask(play, copy, text, &late, error))
            return false;
        if (!late)
            return true;
    }
    return play_anew(play, text, record, error);
}

void edit_play_free(edit_play *play)
{
    himc_error unused;
    if (!play)
        return;
    if (stop_playing(play, &unused))
        for (int i = 0; i < COPIES; i++)
            dismiss(play, i, &unused);
    release(play);
}
