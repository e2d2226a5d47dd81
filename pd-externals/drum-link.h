/* drum-link.h: how [himc~ NAME] finds [membrane~ NAME], and the code that both share.

A [membrane~] binds itself to the symbol "himc:NAME". [himc~] looks there, checks class name, magic
word and build, and takes the drum behind it. The two are separate binaries, each with its own
hidden copy of libhimc: they share data through pointers, and no statics. So both must come from one
build: HIMC_BUILD_ID, made by the Makefile, is a checksum of all sources of the library and of this
file. Partners of different builds refuse each other.

The first [himc~] plays the drum itself. Each further one gets a guest: a drum of its own with the
same settings, whose sound [membrane~] adds. So all are heard on one drum, and the sticks of each
feel the head as they move it.

Both are clocked by the samples they have put out since Pd last built its graph (t_stream). The
engine, a drum or a performance, counts in the same way; the first object in a tick advances it, the
other reads its ring. */
#ifndef DRUM_LINK_H
#define DRUM_LINK_H

#include "himc/himc.h"
#include "himc/loader.h"
#include "m_pd.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* for the one symbol that a binary shows, its setup function */
#ifdef _WIN32
#define EXPORTED __attribute__((dllexport))
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

#define DRUM_LINK_MAGIC 0x68696d63u /* "himc" */
#define DRUM_LINK_CLASS "membrane~"
#define DRUM_LINK_PLAYERS 4  /* chosen: more do not find room around a drum */
#define DRUM_LINK_ID_SIZE 32 /* chosen: room for two numbers of ten digits */
#define LOAD_PERIOD 1.0 /* between two looks for what is loaded (ms); chosen: less than a block */

/* Follows the t_object of a [membrane~]. */
typedef struct t_drum_link {
    uint32_t l_magic;
    char l_build[DRUM_LINK_ID_SIZE]; /* HIMC_BUILD_ID of the binary that made the drum */
    himc_drum *l_drum;
    double l_rate; /* sample rate of the drum; kept by the object that drives it (Hz) */
    int l_block;   /* of the [membrane~] (samples) */
    /* The guest of a further performer, borrowed; NULL with the reason. */
    himc_drum *(*l_guest)(struct t_drum_link *link, const void *performer, himc_error *error);
    /* The t_player of each performer, the one of l_drum first; NULL where there is none. */
    void (*l_players)(struct t_drum_link *link, void *player[DRUM_LINK_PLAYERS]);
    /* Before a command by way of a performer: its file is beside the [membrane~]'s patch. */
    bool (*l_locate)(struct t_drum_link *link, himc_command *command, himc_error *error);
    /* After it: the guests take it, too. */
    void (*l_commanded)(struct t_drum_link *link, const himc_command *command);
} t_drum_link;

/* True if a drum can have that name: to [himc~] a message that begins with it is for the drum. */
static inline bool drum_name_check(const char *name, himc_error *error)
{
    static const char *const own[] = {"comment", "save", "state", "dsp",
                                      "list",    "head", "pose",  "bang"};
    himc_command drum;
    himc_atom word = {HIMC_ATOM_SYMBOL, 0, name};
    bool taken = himc_command_find(HIMC_PERFORMER, name) != NULL;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        taken = taken || strcmp(name, own[i]) == 0;
    if (taken)
        return himc_error_set(error, "drum %s: the name of a command, expected another name", name);
    return himc_command_parse(&drum, HIMC_PERFORMER, "drum", &word, 1, error);
}

static inline t_symbol *drum_link_symbol(const char *name)
{
    char text[HIMC_NAME_SIZE + 8];
    snprintf(text, sizeof text, "himc:%s", name);
    return gensym(text);
}

/* The link of [membrane~ NAME]; NULL with the reason if there is none, or one of another build. */
static inline t_drum_link *drum_link_find(const char *name, himc_error *error)
{
    t_pd *thing = drum_link_symbol(name)->s_thing;
    t_drum_link *link = NULL;
    if (thing && strcmp(class_getname(*thing), DRUM_LINK_CLASS) == 0)
        link = (t_drum_link *)((char *)thing + sizeof(t_object));
    if (!link) {
        himc_error_set(error, "no [membrane~ %s]", name);
        return NULL;
    }
    bool known = link->l_magic == DRUM_LINK_MAGIC;
    if (known && strncmp(link->l_build, HIMC_BUILD_ID, DRUM_LINK_ID_SIZE) == 0)
        return link;
    himc_error_set(error,
                   "[membrane~ %s] is of another build (%.*s, [himc~] is %s), expected both from "
                   "one build",
                   name, DRUM_LINK_ID_SIZE - 1, known ? link->l_build : "an old one",
                   HIMC_BUILD_ID);
    return NULL;
}

/* Of tests/watch/watch.c, when it is preloaded: what the DSP routines call between the two is
counted if it may wait. */
void watch_span_begin(void) __attribute__((weak));
void watch_span_end(void) __attribute__((weak));

static inline void watch_begin(void)
{
    if (watch_span_begin)
        watch_span_begin();
}

static inline void watch_end(void)
{
    if (watch_span_end)
        watch_span_end();
}

/* The performer in a drum that a [himc~] plays; [membrane~] reads its time. */
typedef struct t_player {
    void *p_himc;
    uint64_t p_time; /* of the performance; the head may be a few samples ahead (samples) */
    int (*p_block)(void *player); /* the longest block of those that advance it (samples) */
} t_player;

/* The longest block of the objects that advance a drum (samples). */
static inline int drum_link_block(const t_drum_link *link)
{
    t_player *player = himc_drum_get_driver(link->l_drum).performer;
    return player ? player->p_block(player) : link->l_block;
}

/* An object's place in the stream of samples. */
typedef struct t_stream {
    int s_length;     /* of a block (samples) */
    double s_rate;    /* (Hz) */
    uint64_t s_count; /* put out since the graph was built */
    uint64_t s_lag;   /* samples the engine was ahead when the last block began */
    double s_start;   /* logical time at which the next block starts */
} t_stream;

/* Samples of logical time since the last block ended; 0 when DSP or the object is off. */
static inline double stream_offset(const t_stream *s)
{
    double limit = s->s_length > sys_getblksize() ? s->s_length : sys_getblksize();
    double offset = clock_gettimesince(s->s_start) * 0.001 * s->s_rate;
    return offset <= limit + 0.5 ? offset : 0;
}

/* Called from a dsp method: counts from 0 again. */
static inline void stream_restart(t_stream *s, const t_signal *sp)
{
    s->s_length = sp->s_n;
    s->s_rate = sp->s_sr;
    s->s_count = s->s_lag = 0;
    if (stream_offset(s) == 0)
        s->s_start = clock_getlogicaltime();
}

/* Called first in a perform routine. After a time switched off, [switch~], the object rejoins the
engine, which may have gone on without it, with the lag it had; otherwise it just goes on. */
static inline void stream_begin(t_stream *s, uint64_t engine)
{
    bool away =
        clock_gettimesince(s->s_start) * 0.001 * s->s_rate > 1.5 * (s->s_length + sys_getblksize());
    if (away && engine > s->s_count + s->s_lag)
        s->s_count = engine - s->s_lag;
    else if (engine >= s->s_count)
        s->s_lag = engine - s->s_count;
}

/* Called last in a perform routine. */
static inline void stream_end(t_stream *s)
{
    s->s_start = clock_getlogicaltime();
}

#define STREAM_LONGEST_DELAY 8192 /* that the engine takes (samples) */

/* Samples from where the engine is to where a message that arrives now belongs: messages come
between blocks but have a time of their own. The longest block pulls the engine ahead of a shorter
one by up to their difference: all messages wait so long, and so come evenly. */
static inline int stream_delay(const t_stream *s, uint64_t engine, int longest)
{
    int own = s->s_length > sys_getblksize() ? s->s_length : sys_getblksize();
    int lead = s->s_count > 0 && pd_getdspstate() && longest > own ? longest - own : 0;
    double delay = (double)(int64_t)(s->s_count - engine) + stream_offset(s) + lead;
    return (int)lround(fmin(fmax(delay, 0), STREAM_LONGEST_DELAY));
}

/* True if the word is on Pd's command line; only Linux tells. */
static inline bool pd_was_given(const char *word)
{
    char text[4096];
    FILE *file = fopen("/proc/self/cmdline", "rb");
    size_t count = file ? fread(text, 1, sizeof text - 1, file) : 0;
    bool given = false;
    if (file)
        fclose(file);
    text[count] = 0;
    for (size_t at = 0; at < count && !given; at += strlen(text + at) + 1)
        given = strcmp(text + at, word) == 0;
    return given;
}

/* True while a command that takes long would hold up the sound: then a loader carries it out. While
DSP is off, and in `pd -batch`, which knows no clock, it acts at once, so that a batch gives the
same sound every time. */
static inline bool pd_in_real_time(void)
{
    static int batch = -1;
    if (batch < 0)
        batch = pd_was_given("-batch");
    return !batch && pd_getdspstate();
}

/* A Pd message as a checked command. `list stroke ...` is taken as `stroke ...`. */
static inline bool command_from_pd(himc_command *command, himc_receiver receiver, t_symbol *s,
                                   int argc, const t_atom *argv, himc_error *error)
{
    himc_atom atom[2 * HIMC_COMMAND_ATOMS]; /* more than any command has: the parser says so */
    int count = 0;
    if (s == &s_list && argc > 0 && argv->a_type == A_SYMBOL) {
        s = argv->a_w.w_symbol;
        argc--, argv++;
    }
    if (s == &s_list || s == &s_float)
        return himc_error_set(error, "%s: expected a message that begins with a word, as [%s(",
                              argc > 0 ? "a number" : "an empty list",
                              receiver == HIMC_DRUM ? "strike 0.1 0 2" : "hit any legato f");
    for (; count < argc && count < 2 * HIMC_COMMAND_ATOMS; count++) {
        const t_atom *a = argv + count;
        if (a->a_type == A_FLOAT)
            atom[count] = (himc_atom){HIMC_ATOM_NUMBER, a->a_w.w_float, NULL};
        else
            atom[count] = (himc_atom){
                HIMC_ATOM_SYMBOL, 0, a->a_type == A_SYMBOL ? a->a_w.w_symbol->s_name : "(pointer)"};
    }
    return himc_command_parse(command, receiver, s->s_name, atom, count, error);
}

/* The points of Pd's array ARRAY, of `least` at least; NULL with the reason. After a change
garray_redraw shows them. */
static inline t_word *array_find(t_garray **array, int *size, int argc, const t_atom *argv,
                                 int least, const char *command, himc_error *error)
{
    t_word *points = NULL;
    t_symbol *name = argc == 1 && argv->a_type == A_SYMBOL ? argv->a_w.w_symbol : &s_;
    *array = (t_garray *)pd_findbyclass(name, garray_class);
    if (*array && garray_getfloatwords(*array, size, &points) && *size >= least)
        return points;
    char given[MAXPDSTRING] = "no name";
    if (argc > 0)
        atom_string(argv, given, sizeof given);
    himc_error_set(error, "%s: %s: no array of %d points or more, expected %s ARRAY", command,
                   given, least, command);
    return NULL;
}

/* Takes a flag off the front of an object's arguments. */
static inline bool take_flag(int *argc, t_atom **argv, const char *flag)
{
    if (*argc == 0 || (*argv)->a_type != A_SYMBOL || (*argv)->a_w.w_symbol != gensym(flag))
        return false;
    (*argc)--, (*argv)++;
    return true;
}

/* The lines of an answer. What is sent may come back as a command, so all are written first. */
typedef struct t_answer {
    const char *a_before; /* a drum's name before each line, or NULL */
    char *a_text;         /* owned; lines that end with \n */
    size_t a_size;
} t_answer;

static inline void answer_line(void *answer, const char *line)
{
    t_answer *a = answer;
    size_t size = strlen(line) + (a->a_before ? strlen(a->a_before) : 0) + 3;
    char *text = realloc(a->a_text, a->a_size + size);
    if (!text)
        return;
    a->a_text = text;
    a->a_size += (size_t)snprintf(text + a->a_size, size, "%s%s%s\n",
                                  a->a_before ? a->a_before : "", a->a_before ? " " : "", line);
}

/* Sends `selector` and the words of `line` as one message, without commas and semicolons, which
mean something else in Pd. */
static inline void outlet_words(t_outlet *outlet, const char *selector, const char *line)
{
    char text[MAXPDSTRING];
    snprintf(text, sizeof text, "%s", line);
    for (char *mark = text; (mark = strpbrk(mark, ",;"));)
        *mark = ' ';
    t_binbuf *words = binbuf_new();
    binbuf_text(words, text, strlen(text));
    outlet_anything(outlet, gensym(selector), binbuf_getnatom(words), binbuf_getvec(words));
    binbuf_free(words);
}

/* Sends the lines of an answer, and frees it. */
static inline void answer_send(t_answer *answer, t_outlet *outlet, const char *selector)
{
    char *line = answer->a_text;
    for (char *end; line && (end = strchr(line, '\n')); line = end + 1) {
        *end = '\0';
        outlet_words(outlet, selector, line);
    }
    free(answer->a_text);
}

#endif
