/// channel.c: the page that edits, and the programs `himc edit` (editor.c) behind it.
///
/// The page's messages go to that program, one line each, or are a file to be edited; and what
/// that program tells goes back, as fast as the page takes it; what this program itself says to the
/// page goes between, as text. It ends with its page; the piece's journal
/// (tools/himc/edit_journal.c) brings the changes back to the next one. A piece that is dropped is
/// played aside until it can be heard, so that one that is refused disturbs nothing. Invariant: one
/// page edits, the newest; `passed` holds at most one message, and the program is not read before
/// the page has taken it.
#include "channel.h"
#include "base/line.h"
#include "editor.h"
#include "scene.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// all chosen
enum {
    PASSED = 65536, // of what `himc edit` tells in one message (bytes)
    NOTE = 1024,    // of a line for the page (bytes)
    TAKEN = 4001    // status of a close, for the page (piece.js)
};

/// What a program has told, and nobody has taken.
typedef struct told {
    char *bytes; // owned
    size_t size, room, at;
} told;

struct channel {
    struct lws_vhost *vhost;
    editor_pieces pieces;        // one after the other, as they were dropped
    editor edit, next;           // its program; that of one just dropped, until it can be heard
    struct lws *edited, *coming; // their output in the loop
    bool again;                  // it was started again after it had ended by itself
    struct lws *page;            // that edits; all others are being closed
    bool begun;                  // the page is to be told that another program begins
    char note[NOTE];             // JSON for the page, or ""
    char *heard;                 // owned: what has come of a message of that page
    size_t heard_size, heard_room;
    told early, first; // what the program of `next` has told; the rest of that, once it is `edit`
    size_t waiting;    // bytes of the program in `passed`
    unsigned char passed[LWS_PRE + PASSED];
    lws_sorted_usec_list_t back;
};

// a line for the page, between the messages of the program
static void tell_page(channel *c, const char *text)
{
    char line[NOTE - 64];
    scene_word(line, sizeof line, text);
    snprintf(c->note, sizeof c->note, "{\"event\":\"failed\",\"text\":\"%s\"}", line);
    if (c->page)
        lws_callback_on_writable(c->page);
}

// the callback of its end takes it for nobody's
static void close_output(struct lws **output)
{
    struct lws *closed = *output;
    *output = NULL;
    if (closed)
        lws_set_timeout(closed, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_SYNC);
}

// the program of a piece that was just dropped ends
static void end_next(channel *c)
{
    close_output(&c->coming);
    editor_stop(&c->next);
    c->early.size = 0;
}

// the programs and all their processes end
static void end_editing(channel *c)
{
    end_next(c);
    close_output(&c->edited);
    c->waiting = c->first.size = c->first.at = 0;
    editor_stop(&c->edit);
}

// a program plays its piece from the start
static struct lws *begin_program(channel *c, editor *e)
{
    himc_error error;
    if (!editor_start(e, &error)) {
        tell_page(c, error.text);
        return NULL;
    }
    lws_sock_file_fd_type from = {.filefd = e->from};
    editor_say(e, "hello", 5);
    return lws_adopt_descriptor_vhost(c->vhost, LWS_ADOPT_RAW_FILE_DESC, from, CHANNEL_PROGRAM,
                                      NULL);
}

static void begin_editing(channel *c)
{
    end_editing(c);
    if (c->pieces.count == 0)
        return;
    c->edit.piece = c->pieces.piece[c->pieces.at];
    c->begun = true;
    c->edited = begin_program(c, &c->edit);
    if (c->page)
        lws_callback_on_writable(c->page);
}

// the newest page edits; the one before is told so
void channel_take_over(channel *c, struct lws *wsi)
{
    if (c->page)
        lws_callback_on_writable(c->page);
    c->page = wsi;
    c->vhost = lws_get_vhost(wsi);
    c->heard_size = 0;
    c->note[0] = 0;
    c->again = false;
    begin_editing(c);
}

// --- pieces that are dropped

// what was dropped is played aside until it can be heard, while the page goes on with what it has
static bool begin_next(channel *c)
{
    himc_error error;
    end_next(c);
    bool good =
        editor_keep(&c->next, editor_free_place(&c->pieces), c->heard, c->heard_size, &error);
    if (good)
        c->coming = begin_program(c, &c->next);
    else
        tell_page(c, error.text);
    return good;
}

// the piece that was dropped is the one that is edited from now on
static void accept_next(channel *c)
{
    close_output(&c->edited);
    editor_stop(&c->edit);
    editor_add_piece(&c->pieces, &c->next.piece);
    c->edit = c->next;
    c->edited = c->coming;
    c->next.process = 0;
    c->coming = NULL;
    told empty = c->first;
    c->first = c->early;
    c->early = empty;
    c->first.at = c->early.size = c->waiting = 0;
    c->begun = true;
    c->again = false;
    if (c->page)
        lws_callback_on_writable(c->page);
}

static void refuse_next(channel *c)
{
    const char *why = c->next.told.failed;
    if (why[0]) {
        snprintf(c->note, sizeof c->note, "%s", why);
        himc_line_clean(c->note);
    } else
        tell_page(c, "what was dropped cannot be played");
    end_next(c);
    if (c->page)
        lws_callback_on_writable(c->page);
}

// what the program of a piece that was just dropped tells; false at its end
static bool hear_next(channel *c)
{
    told *e = &c->early;
    if (e->size + PASSED > e->room) {
        char *more = realloc(e->bytes, e->room + 4 * PASSED);
        if (!more)
            return false;
        e->bytes = more;
        e->room += 4 * PASSED;
    }
    ssize_t got = editor_hear(&c->next, e->bytes + e->size, PASSED);
    e->size += got > 0 ? (size_t)got : 0;
    if (c->next.told.sounds)
        accept_next(c);
    return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

// to the piece before, or the one after
static void step_piece(channel *c, int by)
{
    if (c->pieces.at + by < 0 || c->pieces.at + by >= c->pieces.count)
        return;
    c->pieces.at += by;
    begin_editing(c);
}

// A program has ended by itself. One whose piece had been heard is started again: the journal has
// all changes. If it ends again before the page has asked for anything, that is reported. After one
// that could not be played the piece before is edited again.
static void on_back(lws_sorted_usec_list_t *list)
{
    channel *c = lws_container_of(list, channel, back);
    if (c->edited || !c->page)
        return;
    if (!c->edit.told.sounds)
        step_piece(c, -1);
    else if (c->again)
        tell_page(c, "himc edit has ended twice while it played this piece; the next change, undo "
                     "or piece starts it again");
    else {
        c->again = true;
        begin_editing(c);
    }
}

static int send_away(struct lws *wsi)
{
    static unsigned char why[] = "another page edits";
    lws_close_reason(wsi, (enum lws_close_status)TAKEN, why, sizeof why - 1);
    return -1;
}

bool channel_edits(const channel *c, const struct lws *wsi)
{
    return c->page == wsi;
}

void channel_leave(channel *c, struct lws *wsi)
{
    if (c->page != wsi)
        return;
    c->page = NULL;
    end_editing(c);
}

// a whole message of the page: a line, or a file
static bool take_message(channel *c, bool file)
{
    if (file)
        return begin_next(c), true;
    bool back = c->heard_size == 4 && !memcmp(c->heard, "back", 4),
         forth = c->heard_size == 5 && !memcmp(c->heard, "forth", 5);
    c->again = false;
    if (!back && !forth && !c->edited)
        begin_editing(c); // it has ended by itself
    if (!back && !forth)
        return editor_say(&c->edit, c->heard, c->heard_size);
    step_piece(c, back ? -1 : 1);
    return true;
}

// a part of a message; false if it is too long, or no line
bool channel_hear(channel *c, struct lws *wsi, const char *in, size_t length)
{
    bool file = lws_frame_is_binary(wsi);
    size_t most = file ? EDITOR_UPLOAD : EDITOR_LINE, size = c->heard_size + length;
    if (size > most)
        return false;
    if (size > c->heard_room) {
        char *more = realloc(c->heard, 2 * size);
        if (!more)
            return false;
        c->heard = more;
        c->heard_room = 2 * size;
    }
    memcpy(c->heard + c->heard_size, in, length);
    c->heard_size = size;
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0)
        return true;
    bool good = take_message(c, file);
    c->heard_size = 0;
    return good;
}

static bool write_line(struct lws *wsi, const char *json)
{
    unsigned char line[LWS_PRE + NOTE];
    size_t size = strlen(json);
    memcpy(line + LWS_PRE, json, size);
    return lws_write(wsi, line + LWS_PRE, size, LWS_WRITE_TEXT) == (int)size;
}

// the page forgets what came of the program before, and is told to which pieces undo and redo go
static bool tell_begun(channel *c, struct lws *wsi)
{
    char line[NOTE];
    c->begun = false;
    snprintf(line, sizeof line, "{\"event\":\"begun\",\"before\":%d,\"after\":%d}", c->pieces.at,
             c->pieces.count - 1 - c->pieces.at);
    return write_line(wsi, line);
}

// one message; more follow when the page has taken it
int channel_write(channel *c, struct lws *wsi)
{
    bool good = true;
    if (wsi != c->page)
        return send_away(wsi);
    if (c->begun)
        good = tell_begun(c, wsi);
    else if (c->note[0]) {
        good = write_line(wsi, c->note);
        c->note[0] = 0;
    } else if (c->waiting) {
        int size = (int)c->waiting;
        c->waiting = 0;
        good = lws_write(wsi, c->passed + LWS_PRE, (size_t)size, LWS_WRITE_BINARY) == size;
    } else if (c->first.at < c->first.size) {
        size_t left = c->first.size - c->first.at, size = left < PASSED ? left : PASSED;
        memcpy(c->passed + LWS_PRE, c->first.bytes + c->first.at, size);
        c->first.at += size;
        good = lws_write(wsi, c->passed + LWS_PRE, size, LWS_WRITE_BINARY) == (int)size;
    } else {
        if (c->edited)
            lws_rx_flow_control(c->edited, 1);
        return 0;
    }
    lws_set_timeout(wsi, NO_PENDING_TIMEOUT, 0);
    lws_callback_on_writable(wsi);
    return good ? 0 : -1;
}

// what the program tells waits until the page has taken what came before
static bool hear_edited(channel *c, struct lws *wsi)
{
    if (c->waiting || c->begun || !c->page || c->first.at < c->first.size) {
        lws_rx_flow_control(wsi, 0);
        return true;
    }
    ssize_t got = editor_hear(&c->edit, c->passed + LWS_PRE, PASSED);
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR))
        return false;
    if (got > 0) {
        c->waiting = (size_t)got;
        lws_rx_flow_control(wsi, 0);
        lws_callback_on_writable(c->page);
    }
    return true;
}

int channel_on_program(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t length)
{
    channel *c = lws_vhost_user(lws_get_vhost(wsi));
    (void)user, (void)in, (void)length;
    bool coming = wsi == c->coming, edited = wsi == c->edited;
    if (reason == LWS_CALLBACK_RAW_CLOSE_FILE && edited) {
        c->edited = NULL;
        lws_sul_schedule(lws_get_context(wsi), 0, &c->back, on_back, 1);
    } else if (reason == LWS_CALLBACK_RAW_CLOSE_FILE && coming) {
        c->coming = NULL;
        refuse_next(c);
    } else if (reason == LWS_CALLBACK_RAW_RX_FILE && edited)
        return hear_edited(c, wsi) ? 0 : -1;
    else if (reason == LWS_CALLBACK_RAW_RX_FILE && coming)
        return hear_next(c) ? 0 : -1;
    return 0;
}

channel *channel_new(const char *source, folder *place)
{
    channel *c = calloc(1, sizeof *c);
    if (!c)
        return NULL;
    c->edit.folder = c->next.folder = place;
    if (source) {
        editor_piece own = {.name = ""};
        snprintf(own.source, sizeof own.source, "%s", source);
        editor_add_piece(&c->pieces, &own);
    }
    return c;
}

void channel_free(channel *c)
{
    if (!c)
        return;
    editor_stop(&c->edit);
    editor_stop(&c->next);
    free(c->heard);
    free(c->early.bytes);
    free(c->first.bytes);
    free(c);
}
