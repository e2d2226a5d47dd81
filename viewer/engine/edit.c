/// edit.c: a piece under edit in a page. What `himc edit` does in processes, the page does with
/// instances of this module and copies of their memory (viewer/page/workshop.js).
#include "base/file.h"
#include "engine.h"
#include "performance/research.h"
#include "tools/himc/edit_player.h"
#include "tools/himc/edit_session.h"

#include <stdlib.h>
#include <string.h>

enum { WASM_PAGE = 65536, PART = 65536 }; // (bytes)
enum {
    SPARE = 12 << 20
}; // (bytes) chosen: more than an exchange needs, and is added while a piece is played

struct edit_play {
    bool made;
};

static struct {
    edit_session session;
    edit_play play;
    edit_player player;
    char name[PAGE_INPUT], record[PAGE_INPUT];
} e;

// of a scene with another one in it, which is not made here; the library of WebAssembly has none
FILE *tmpfile(void)
{
    return NULL;
}

// --- edit_play.h: the page plays

edit_play *edit_play_new(const char *name, const himc_take_options *options, himc_error *error)
{
    (void)name, (void)options, (void)error;
    e.play.made = true;
    return &e.play;
}

void edit_play_free(edit_play *play)
{
    if (play)
        play->made = false;
}

bool edit_play_start(edit_play *play, const char *text, edit_span changed, const char *record,
                     himc_error *error)
{
    size_t length = strlen(text);
    char *order = malloc(sizeof changed + length);
    (void)play, (void)record;
    if (!order)
        return himc_error_set(error, "out of memory");
    memcpy(order, &changed, sizeof changed);
    memcpy(order + sizeof changed, text, length);
    edit_session_put("play", order, sizeof changed + length);
    free(order);
    return true;
}

// --- the text

// all that was told goes to the page; what cannot go on says why
static bool told(bool good)
{
    if (!good) {
        edit_session_name(&e.session, page_reason());
        edit_session_tell("failed", page_error(), NULL);
    }
    fflush(stdout);
    return good;
}

bool page_edit_open(void)
{
    edit_session_close(&e.session);
    snprintf(e.name, sizeof e.name, "%s", page_input());
    e.session = (edit_session){.source = e.name, .name = e.name, .sent = true};
    return told(edit_session_open(&e.session, false, page_reason()));
}

bool page_edit_line(void)
{
    bool fatal = false, good = edit_session_obey(&e.session, page_input(), &fatal, page_reason());
    if (!good && !fatal)
        edit_session_tell("refused", page_error(), page_input());
    return told(!fatal);
}

bool page_edit_hear(void)
{
    edit_frame frame = {.bytes = (const unsigned char *)page_input() + 4};
    snprintf(frame.kind, sizeof frame.kind, "%s", page_input());
    frame.size = (uint32_t)strlen((const char *)frame.bytes);
    return told(edit_session_hear(&e.session, &frame, page_reason()));
}

bool page_edit_proved(void)
{
    return !e.session.unproved;
}

// --- what is played

// Room for a second performance, which an exchange needs for a moment: a copy that comes back must
// find it there ...
static void make_room(void)
{
    void *volatile room = malloc(SPARE);
    free(room);
}

// ... and no rest of one in it, or copies would differ by that: what is free at the end is zero
static void clear_room(void)
{
    uintptr_t end = (uintptr_t)__builtin_wasm_memory_size(0) * WASM_PAGE, at = 0;
    void **first = NULL, **volatile part;
    while (at + 3 * (uintptr_t)PART < end && (part = malloc(PART))) {
        memset(part, 0, PART);
        *part = first;
        first = part;
        at = (uintptr_t)part;
    }
    while ((part = first)) {
        first = *part;
        *part = NULL;
        free(part);
    }
}

static char *text_to_play(void)
{
    size_t size;
    return himc_file_load(PAGE_TEXT, EDIT_LARGEST, &size, page_reason());
}

bool page_piece_begin(void)
{
    char *text = text_to_play(), *line;
    snprintf(e.name, sizeof e.name, "%s", page_input());
    if ((line = strchr(e.name, '\n'))) {
        *line = 0;
        snprintf(e.record, sizeof e.record, "%s", line + 1);
    }
    e.player = (edit_player){.name = e.name, .options = &e.session.take, .to = stdout};
    bool good = text && edit_player_begin(&e.player, text, line ? e.record : NULL, page_reason());
    free(text);
    make_room();
    fflush(stdout);
    return good;
}

bool page_piece_start(void)
{
    return cli_tell(e.player.performance, "play", NULL, page_reason());
}

int page_piece_exchange(void)
{
    char *text = text_to_play();
    bool late = false, good = text && edit_player_exchange(&e.player, text, &late, page_reason());
    free(text);
    clear_room();
    fflush(stdout);
    return good ? 1 : late ? -1 : 0;
}

double page_piece_rests_to(int hand)
{
    return himc_performance_rests_to(e.player.performance, (himc_hand)hand);
}

bool page_piece_cell(void)
{
    edit_player_cell(&e.player);
    return !edit_player_is_over(&e.player);
}

bool page_piece_end(void)
{
    bool good = edit_player_end(&e.player, page_reason());
    fflush(stdout);
    return good;
}
