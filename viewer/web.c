/// web.c: one thread, one loop: OSC comes in through an adopted descriptor, pages and news go out.
///
/// The stream is for our page alone (access.h). One gate decides on each request for an upgrade,
/// whatever its protocol: libwebsockets would otherwise accept h2c, and websockets without a
/// protocol. The page never sends data; clients that send anything but control frames are
/// disconnected. Another stream is for editing: it is for a page that knows the key in its address.
/// Its messages go to `himc edit` (editor.c), one line each, or are a file to be edited; and what
/// that program tells goes back, as fast as the page takes it; what this program itself says to the
/// page goes between, as text. It ends with its page; the piece's journal (tools/edit_journal.c)
/// brings the changes back to the next one. A piece that is dropped is played aside until it can be
/// heard, so that one that is refused disturbs nothing. A slow browser gets the
/// newest pose when it is ready for it, so no queue grows here. Invariant: connections are bounded
/// in number, and each that makes no progress in time.
#define _DEFAULT_SOURCE // getaddrinfo
#include "web.h"
#include "access.h"
#include "base/line.h"
#include "editor.h"
#include "receive.h"
#include "pages.h"

#include <errno.h>
#include <libwebsockets.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

// all chosen
enum {
    CLIENTS = 32,        // streams: more than one room has screens
    CONNECTIONS = 256,   // streams included; a browser opens six to fetch the page
    CHUNK = 32768,       // of a page in one write (bytes)
    BATCH = 512,         // packets received at once, so that a flood leaves time for the pages
    REQUEST_TIMEOUT = 5, // of a connection without a whole request (s)
    CLIENT_TIMEOUT = 20, // of a client that takes no more of a page or of the stream (s)
    CLOSE_TIMEOUT = 500, // from the decision to close a stream to its end (ms)
    PAUSE = 3,           // (ms), a tenth of the time between poses: waking up costs most
    PASSED = 65536,      // of what `himc edit` tells in one message (bytes)
    NOTE = 1024,         // of a line for the page (bytes)
    TAKEN = 4001,        // status of a close, for the page (edit.js)
    HEADER_SIZE = 264    // of a host or an origin with its zero; longer ones are refused
};

/// State of one connection.
typedef struct session {
    const char *at, *end; // rest of the page being sent
    scene_reader reader;
    bool counted; // among the clients
    bool closing; // gets nothing more but the close frame
    bool taken;   // another page edits now: closed with TAKEN
} session;

/// What a program has told, and nobody has taken.
typedef struct told {
    char *bytes; // owned
    size_t size, room, at;
} told;

struct web {
    struct lws_context *context;
    struct lws_vhost *vhost;
    scene *s;
    web_config config;
    int clients, connections;
    struct lws *osc; // the OSC socket in the loop
    uint64_t rejected;
    char session[1024];          // JSON: where OSC is received, what is played
    editor_pieces pieces;        // one after the other, as they were dropped
    editor edit, next;           // its program; that of one just dropped, until it can be heard
    struct lws *edited, *coming; // their output in the loop
    bool again;                  // it was started again after it had ended by itself
    struct lws *editing;         // the page that edits
    session *editing_own;        // of `editing`
    bool begun;                  // the page is to be told that another program begins
    char note[NOTE];             // JSON for the page, or ""
    char *heard;                 // owned: what has come of a message of that page
    size_t heard_size, heard_room;
    told early, first; // what the program of `next` has told; the rest of that, once it is `edit`
    size_t waiting;    // bytes of the program in `passed`
    unsigned char passed[LWS_PRE + PASSED];
    lws_sorted_usec_list_t pause, second, back;
    double cpu, clock; // at the last report (s)
    unsigned char out[LWS_PRE + SCENE_FRAME_MAX];
};

static const char security_policy[] =
    "default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' blob: data:; media-src blob:; "
    "connect-src 'self' ws:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

static web *web_of(struct lws *wsi)
{
    return lws_context_user(lws_get_context(wsi));
}

static bool add_header(struct lws *wsi, const char *name, const char *value, unsigned char **p,
                       unsigned char *end)
{
    return lws_add_http_header_by_name(wsi, (const unsigned char *)name,
                                       (const unsigned char *)value, (int)strlen(value), p,
                                       end) == 0;
}

static int refuse(struct lws *wsi, unsigned status)
{
    web_of(wsi)->rejected++;
    lws_return_http_status(wsi, status, NULL);
    return -1;
}

static bool header(struct lws *wsi, enum lws_token_indexes token, char out[HEADER_SIZE])
{
    return lws_hdr_copy(wsi, out, HEADER_SIZE, token) > 0;
}

// the file of that path; false if there is none
static bool find_file(const web *w, const char *path, session *own, const char **type)
{
    const page *found = pages_find(path);
    if (found) {
        own->at = found->begin;
        own->end = found->end;
        *type = found->type;
    } else if (w->config.play && strcmp(path, "/play.himc") == 0) {
        own->at = w->config.play;
        own->end = w->config.play + w->config.play_size;
        *type = "application/octet-stream";
    } else if (strcmp(path, "/session.json") == 0) {
        own->at = w->session;
        own->end = w->session + strlen(w->session);
        *type = "application/json";
    } else
        return false;
    return true;
}

static int begin_page(struct lws *wsi, session *own, const char *path)
{
    unsigned char buffer[LWS_PRE + 2048], *start = buffer + LWS_PRE, *p = start,
                                          *end = buffer + sizeof buffer;
    char host[HEADER_SIZE];
    const char *type;
    if (!header(wsi, WSI_TOKEN_HOST, host) || !access_host_is_local(host))
        return refuse(wsi, HTTP_STATUS_FORBIDDEN);
    if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0)
        return refuse(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED);
    // a body could be sent for ever; without its length it is taken for the next request
    if (lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH) > 0)
        return refuse(wsi, HTTP_STATUS_REQ_ENTITY_TOO_LARGE);
    if (!find_file(web_of(wsi), path, own, &type))
        return refuse(wsi, HTTP_STATUS_NOT_FOUND);
    if (lws_add_http_common_headers(wsi, HTTP_STATUS_OK, type, (lws_filepos_t)(own->end - own->at),
                                    &p, end) ||
        !add_header(wsi, "content-security-policy:", security_policy, &p, end) ||
        !add_header(wsi, "x-content-type-options:", "nosniff", &p, end) ||
        !add_header(wsi, "referrer-policy:", "no-referrer", &p, end) ||
        !add_header(wsi, "cross-origin-resource-policy:", "same-origin", &p, end) ||
        !add_header(wsi, "cache-control:", "no-cache", &p, end) ||
        lws_finalize_write_http_header(wsi, start, &p, end))
        return -1;
    lws_callback_on_writable(wsi);
    return 0;
}

static int send_chunk(struct lws *wsi, session *own)
{
    web *w = web_of(wsi);
    size_t left = (size_t)(own->end - own->at), size = left < CHUNK ? left : CHUNK;
    memcpy(w->out + LWS_PRE, own->at, size);
    own->at += size;
    bool last = own->at == own->end;
    // the limit is for a client without progress, not for the whole file
    lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, CLIENT_TIMEOUT);
    if (lws_write(wsi, w->out + LWS_PRE, size, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0)
        return -1;
    if (!last)
        return lws_callback_on_writable(wsi) < 0;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static int send_news(struct lws *wsi, session *own)
{
    web *w = web_of(wsi);
    size_t size = scene_encode(w->s, &own->reader, wall_clock(), w->out + LWS_PRE);
    // there is something to send each second, so a stream that is never ready for it is lost
    lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, CLIENT_TIMEOUT);
    if (size && lws_write(wsi, w->out + LWS_PRE, size, LWS_WRITE_BINARY) < 0)
        return -1;
    if (own->reader.events != w->s->events)
        lws_callback_on_writable(wsi);
    return 0;
}

static const struct lws_protocols protocols[5];

static void request_writes(web *w)
{
    lws_callback_on_writable_all_protocol(w->context, &protocols[1]);
}

// receives the waiting packets; clients get complete poses and events
static void receive(web *w)
{
    if (receive_waiting(w->config.osc, w->s, BATCH))
        request_writes(w);
}

// the packets of the pause are received together; while a pose is incomplete the pauses go on, so
// that it is sent when it is complete or its time is over
static void on_pause_over(lws_sorted_usec_list_t *list)
{
    web *w = lws_container_of(list, web, pause);
    receive(w);
    if (scene_pose_pending(w->s))
        lws_sul_schedule(w->context, 0, list, on_pause_over, PAUSE * LWS_US_PER_MS);
    else
        lws_rx_flow_control(w->osc, 1);
}

// a packet after silence is received at once; then the socket pauses, because waking up costs most
static void on_packet(web *w, struct lws *wsi)
{
    w->osc = wsi;
    receive(w);
    lws_rx_flow_control(wsi, 0);
    lws_sul_schedule(w->context, 0, &w->pause, on_pause_over, PAUSE * LWS_US_PER_MS);
}

// the address of an editing page's stream is /edit/KEY
static bool knows_key(struct lws *wsi)
{
    static const char begin[] = "/edit/";
    char path[HEADER_SIZE];
    return header(wsi, WSI_TOKEN_GET_URI, path) && strncmp(path, begin, strlen(begin)) == 0 &&
           editor_is_key(web_of(wsi)->config.key, path + strlen(begin));
}

// the gate: each request for an upgrade passes here, whatever it wants to become
static int on_upgrade(struct lws *wsi)
{
    char host[HEADER_SIZE], origin[HEADER_SIZE], upgrade[16], protocol[16];
    bool ours = header(wsi, WSI_TOKEN_HOST, host) && header(wsi, WSI_TOKEN_ORIGIN, origin) &&
                access_is_our_page(host, origin);
    bool edits = lws_hdr_copy(wsi, protocol, sizeof protocol, WSI_TOKEN_PROTOCOL) > 0 &&
                 strcmp(protocol, protocols[2].name) == 0;
    bool stream = lws_hdr_copy(wsi, upgrade, sizeof upgrade, WSI_TOKEN_UPGRADE) > 0 &&
                  strcasecmp(upgrade, "websocket") == 0 &&
                  lws_hdr_copy(wsi, protocol, sizeof protocol, WSI_TOKEN_PROTOCOL) > 0 &&
                  (edits ? knows_key(wsi) : strcmp(protocol, protocols[1].name) == 0) &&
                  lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0;
    return !ours || !stream                  ? refuse(wsi, HTTP_STATUS_FORBIDDEN)
           : web_of(wsi)->clients >= CLIENTS ? refuse(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE)
                                             : 0;
}

static int on_connection(web *w)
{
    if (w->connections < CONNECTIONS)
        return 0;
    w->rejected++;
    return -1;
}

// libwebsockets also asks the first protocol about connections without a protocol
static int on_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                   size_t length)
{
    (void)length;
    switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION: return on_connection(web_of(wsi));
    case LWS_CALLBACK_WSI_CREATE: web_of(wsi)->connections++; return 0;
    case LWS_CALLBACK_WSI_DESTROY: web_of(wsi)->connections--; return 0;
    case LWS_CALLBACK_RAW_ADOPT: return -1; // the method CONNECT would leave HTTP
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE: return on_upgrade(wsi);
    case LWS_CALLBACK_HTTP: return begin_page(wsi, user, in);
    case LWS_CALLBACK_HTTP_WRITEABLE: return send_chunk(wsi, user);
    case LWS_CALLBACK_RAW_RX_FILE: on_packet(web_of(wsi), wsi); return 0;
    default: return 0;
    }
}

static int on_data(struct lws *wsi, const session *own)
{
    web_of(wsi)->rejected += !own->closing;
    lws_close_reason(wsi, LWS_CLOSE_STATUS_POLICY_VIOLATION, NULL, 0);
    return -1;
}

// what the end of a connection asks for, of both kinds
static int on_end(struct lws *wsi, enum lws_callback_reasons reason, session *own)
{
    switch (reason) {
    // a close begins here, whoever wanted it: the page, libwebsockets or this program
    case LWS_CALLBACK_WS_SERVER_DROP_PROTOCOL:
        own->closing = true;
        lws_set_timer_usecs(wsi, CLOSE_TIMEOUT * LWS_US_PER_MS);
        return 0;
    case LWS_CALLBACK_TIMER: return -1;
    case LWS_CALLBACK_CLOSED:
        web_of(wsi)->clients -= own->counted;
        own->counted = false;
        return 0;
    default: return 0;
    }
}

static int on_stream(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                     size_t length)
{
    web *w = web_of(wsi);
    session *own = user;
    (void)in, (void)length;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
        w->clients++;
        own->counted = true;
        own->reader = scene_reader_new(w->s);
        return lws_callback_on_writable(wsi) < 0;
    case LWS_CALLBACK_SERVER_WRITEABLE: return own->closing ? 0 : send_news(wsi, own);
    case LWS_CALLBACK_RECEIVE: return on_data(wsi, own);
    default: return on_end(wsi, reason, own);
    }
}

// --- editing

// a line for the page, between the messages of the program
static void tell_page(web *w, const char *text)
{
    char line[NOTE - 64];
    scene_word(line, sizeof line, text);
    snprintf(w->note, sizeof w->note, "{\"event\":\"failed\",\"text\":\"%s\"}", line);
    if (w->editing)
        lws_callback_on_writable(w->editing);
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
static void end_next(web *w)
{
    close_output(&w->coming);
    editor_stop(&w->next);
    w->early.size = 0;
}

// the programs and all their processes end
static void end_editing(web *w)
{
    end_next(w);
    close_output(&w->edited);
    w->waiting = w->first.size = w->first.at = 0;
    editor_stop(&w->edit);
}

// a program plays its piece from the start
static struct lws *begin_program(web *w, editor *e)
{
    himc_error error;
    if (!editor_start(e, &error)) {
        tell_page(w, error.text);
        return NULL;
    }
    lws_sock_file_fd_type from = {.filefd = e->from};
    editor_say(e, "hello", 5);
    return lws_adopt_descriptor_vhost(w->vhost, LWS_ADOPT_RAW_FILE_DESC, from, protocols[3].name,
                                      NULL);
}

static void begin_editing(web *w)
{
    end_editing(w);
    if (w->pieces.count == 0)
        return;
    w->edit.piece = w->pieces.piece[w->pieces.at];
    w->begun = true;
    w->edited = begin_program(w, &w->edit);
    if (w->editing)
        lws_callback_on_writable(w->editing);
}

// the newest page edits; the one before is told so
static void take_over(web *w, struct lws *wsi, session *own)
{
    if (w->editing) {
        w->editing_own->taken = true;
        lws_callback_on_writable(w->editing);
    }
    w->editing = wsi;
    w->editing_own = own;
    w->heard_size = 0;
    w->note[0] = 0;
    w->again = false;
    folder_unlink(w->config.folder, WEB_DOOR);
    begin_editing(w);
}

// --- pieces that are dropped

// what was dropped is played aside until it can be heard, while the page goes on with what it has
static bool begin_next(web *w)
{
    himc_error error;
    end_next(w);
    bool good =
        editor_keep(&w->next, editor_free_place(&w->pieces), w->heard, w->heard_size, &error);
    if (good)
        w->coming = begin_program(w, &w->next);
    else
        tell_page(w, error.text);
    return good;
}

// the piece that was dropped is the one that is edited from now on
static void accept_next(web *w)
{
    close_output(&w->edited);
    editor_stop(&w->edit);
    editor_add_piece(&w->pieces, &w->next.piece);
    w->edit = w->next;
    w->edited = w->coming;
    w->next.process = 0;
    w->coming = NULL;
    told empty = w->first;
    w->first = w->early;
    w->early = empty;
    w->first.at = w->early.size = w->waiting = 0;
    w->begun = true;
    w->again = false;
    if (w->editing)
        lws_callback_on_writable(w->editing);
}

static void refuse_next(web *w)
{
    const char *why = w->next.told.failed;
    if (why[0]) {
        snprintf(w->note, sizeof w->note, "%s", why);
        himc_line_clean(w->note);
    } else
        tell_page(w, "what was dropped cannot be played");
    end_next(w);
    if (w->editing)
        lws_callback_on_writable(w->editing);
}

// what the program of a piece that was just dropped tells; false at its end
static bool hear_next(web *w)
{
    told *e = &w->early;
    if (e->size + PASSED > e->room) {
        char *more = realloc(e->bytes, e->room + 4 * PASSED);
        if (!more)
            return false;
        e->bytes = more;
        e->room += 4 * PASSED;
    }
    ssize_t got = editor_hear(&w->next, e->bytes + e->size, PASSED);
    e->size += got > 0 ? (size_t)got : 0;
    if (w->next.told.sounds)
        accept_next(w);
    return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

// to the piece before, or the one after
static void step_piece(web *w, int by)
{
    if (w->pieces.at + by < 0 || w->pieces.at + by >= w->pieces.count)
        return;
    w->pieces.at += by;
    begin_editing(w);
}

// A program has ended by itself. One whose piece had been heard is started again: the journal has
// all changes. If it ends again before the page has asked for anything, that is reported. After one
// that could not be played the piece before is edited again.
static void on_back(lws_sorted_usec_list_t *list)
{
    web *w = lws_container_of(list, web, back);
    if (w->edited || !w->editing)
        return;
    if (!w->edit.told.sounds)
        step_piece(w, -1);
    else if (w->again)
        tell_page(w, "himc edit has ended twice while it played this piece; the next change, undo "
                     "or piece starts it again");
    else {
        w->again = true;
        begin_editing(w);
    }
}

static int send_away(struct lws *wsi)
{
    static unsigned char why[] = "another page edits";
    lws_close_reason(wsi, (enum lws_close_status)TAKEN, why, sizeof why - 1);
    return -1;
}

static void leave_page(web *w, struct lws *wsi)
{
    if (w->editing != wsi)
        return;
    w->editing = NULL;
    end_editing(w);
}

// a whole message of the page: a line, or a file
static bool take_message(web *w, bool file)
{
    if (file)
        return begin_next(w), true;
    bool back = w->heard_size == 4 && !memcmp(w->heard, "back", 4),
         forth = w->heard_size == 5 && !memcmp(w->heard, "forth", 5);
    w->again = false;
    if (!back && !forth && !w->edited)
        begin_editing(w); // it has ended by itself
    if (!back && !forth)
        return editor_say(&w->edit, w->heard, w->heard_size);
    step_piece(w, back ? -1 : 1);
    return true;
}

// a part of a message; false if it is too long, or no line
static bool hear_page(web *w, struct lws *wsi, const char *in, size_t length)
{
    bool file = lws_frame_is_binary(wsi);
    size_t most = file ? EDITOR_UPLOAD : EDITOR_LINE, size = w->heard_size + length;
    if (wsi != w->editing || size > most)
        return false;
    if (size > w->heard_room) {
        char *more = realloc(w->heard, 2 * size);
        if (!more)
            return false;
        w->heard = more;
        w->heard_room = 2 * size;
    }
    memcpy(w->heard + w->heard_size, in, length);
    w->heard_size = size;
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0)
        return true;
    bool good = take_message(w, file);
    w->heard_size = 0;
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
static bool tell_begun(web *w, struct lws *wsi)
{
    char line[NOTE];
    w->begun = false;
    snprintf(line, sizeof line, "{\"event\":\"begun\",\"before\":%d,\"after\":%d}", w->pieces.at,
             w->pieces.count - 1 - w->pieces.at);
    return write_line(wsi, line);
}

// one message; more follow when the page has taken it
static int pass_on(web *w, struct lws *wsi)
{
    bool good = true;
    if (wsi != w->editing)
        return 0;
    if (w->begun)
        good = tell_begun(w, wsi);
    else if (w->note[0]) {
        good = write_line(wsi, w->note);
        w->note[0] = 0;
    } else if (w->waiting) {
        int size = (int)w->waiting;
        w->waiting = 0;
        good = lws_write(wsi, w->passed + LWS_PRE, (size_t)size, LWS_WRITE_BINARY) == size;
    } else if (w->first.at < w->first.size) {
        size_t left = w->first.size - w->first.at, size = left < PASSED ? left : PASSED;
        memcpy(w->passed + LWS_PRE, w->first.bytes + w->first.at, size);
        w->first.at += size;
        good = lws_write(wsi, w->passed + LWS_PRE, size, LWS_WRITE_BINARY) == (int)size;
    } else {
        if (w->edited)
            lws_rx_flow_control(w->edited, 1);
        return 0;
    }
    lws_set_timeout(wsi, NO_PENDING_TIMEOUT, 0);
    lws_callback_on_writable(wsi);
    return good ? 0 : -1;
}

static int on_edit(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                   size_t length)
{
    web *w = web_of(wsi);
    session *own = user;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
        w->clients++;
        own->counted = true;
        take_over(w, wsi, own);
        return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return own->closing ? 0 : own->taken ? send_away(wsi) : pass_on(w, wsi);
    case LWS_CALLBACK_RECEIVE:
        if (own->taken || (!own->closing && hear_page(w, wsi, in, length)))
            return 0;
        return on_data(wsi, own);
    case LWS_CALLBACK_CLOSED: leave_page(w, wsi); // fall through
    default: return on_end(wsi, reason, own);
    }
}

// what the program tells waits until the page has taken what came before
static bool hear_edited(web *w, struct lws *wsi)
{
    if (w->waiting || w->begun || !w->editing || w->first.at < w->first.size) {
        lws_rx_flow_control(wsi, 0);
        return true;
    }
    ssize_t got = editor_hear(&w->edit, w->passed + LWS_PRE, PASSED);
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR))
        return false;
    if (got > 0) {
        w->waiting = (size_t)got;
        lws_rx_flow_control(wsi, 0);
        lws_callback_on_writable(w->editing);
    }
    return true;
}

static int on_edited(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                     size_t length)
{
    web *w = web_of(wsi);
    (void)user, (void)in, (void)length;
    bool coming = wsi == w->coming, edited = wsi == w->edited;
    if (reason == LWS_CALLBACK_RAW_CLOSE_FILE && edited) {
        w->edited = NULL;
        lws_sul_schedule(w->context, 0, &w->back, on_back, 1);
    } else if (reason == LWS_CALLBACK_RAW_CLOSE_FILE && coming) {
        w->coming = NULL;
        refuse_next(w);
    } else if (reason == LWS_CALLBACK_RAW_RX_FILE && edited)
        return hear_edited(w, wsi) ? 0 : -1;
    else if (reason == LWS_CALLBACK_RAW_RX_FILE && coming)
        return hear_next(w) ? 0 : -1;
    return 0;
}

static const struct lws_protocols protocols[5] = {
    {.name = "http",
     .callback = on_http,
     .per_session_data_size = sizeof(session),
     .rx_buffer_size = 1024},
    {.name = "scene",
     .callback = on_stream,
     .per_session_data_size = sizeof(session),
     .rx_buffer_size = 256},
    {.name = "edit",
     .callback = on_edit,
     .per_session_data_size = sizeof(session),
     .rx_buffer_size = 4096},
    {.name = "edited", .callback = on_edited, .rx_buffer_size = 1024},
    {0},
};

static double cpu_seconds(void)
{
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static void on_second(lws_sorted_usec_list_t *list)
{
    web *w = lws_container_of(list, web, second);
    const scene_counts *c = &w->s->count;
    double now = wall_clock(), cpu = cpu_seconds();
    scene_add_event(w->s, now,
                    "{\"event\":\"bridge\",\"packets\":%llu,\"messages\":%llu,"
                    "\"malformed\":%llu,\"unknown\":%llu,"
                    "\"refused\":%llu,\"rejected\":%llu,\"clients\":%d,\"load\":%.4f}",
                    (unsigned long long)c->packets, (unsigned long long)c->messages,
                    (unsigned long long)c->malformed, (unsigned long long)c->unknown,
                    (unsigned long long)c->refused, (unsigned long long)w->rejected, w->clients,
                    now > w->clock ? (cpu - w->cpu) / (now - w->clock) : 0);
    w->cpu = cpu;
    w->clock = now;
    request_writes(w);
    lws_sul_schedule(w->context, 0, list, on_second, LWS_US_PER_SEC);
}

// libwebsockets gives the reason for a refused port only in its log, so the port is tried first
static bool port_free(const web_config *c, himc_error *error)
{
    char service[16];
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_PASSIVE},
                    *found;
    snprintf(service, sizeof service, "%d", c->port);
    if (getaddrinfo(c->address, service, &hints, &found) != 0)
        return himc_error_set(error, "--bind %s: not a numeric address", c->address);
    int fd = socket(found->ai_family, SOCK_STREAM, 0), yes = 1;
    bool bound = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
                 bind(fd, found->ai_addr, found->ai_addrlen) == 0 && listen(fd, 1) == 0;
    if (!bound && errno == EADDRINUSE)
        himc_error_set(error,
                       "port %d is taken: perhaps by another viewer; choose one with --http PORT",
                       c->port);
    else if (!bound)
        himc_error_set(error, "cannot serve the page on %s port %d: %s", c->address, c->port,
                       strerror(errno));
    freeaddrinfo(found);
    if (fd >= 0)
        close(fd);
    return bound;
}

static bool listen_to_all(web *w)
{
    struct lws_context_creation_info info = {.port = w->config.port,
                                             .iface = w->config.address,
                                             .protocols = protocols,
                                             .user = w,
                                             .gid = (gid_t)-1,
                                             .uid = (uid_t)-1,
                                             .timeout_secs_ah_idle = REQUEST_TIMEOUT,
                                             .keepalive_timeout = REQUEST_TIMEOUT,
                                             .pt_serv_buf_size = SCENE_FRAME_MAX,
                                             .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                                                        LWS_SERVER_OPTION_DISABLE_IPV6 *
                                                            !strchr(w->config.address, ':')};
    lws_sock_file_fd_type osc = {.filefd = w->config.osc};
    w->context = lws_create_context(&info);
    w->vhost = w->context ? lws_create_vhost(w->context, &info) : NULL;
    return w->vhost && lws_adopt_descriptor_vhost(w->vhost, LWS_ADOPT_RAW_FILE_DESC, osc,
                                                  protocols[0].name, NULL);
}

// the page tells the user where to send OSC; all addresses are reached at any of them
static void describe_session(web *w)
{
    const char *address = w->config.address, *name = w->config.play_name;
    char file[256] = "";
    bool all = !strcmp(address, "0.0.0.0") || !strcmp(address, "::");
    if (name) {
        const char *slash = strrchr(name, '/');
        scene_word(file, sizeof file, slash ? slash + 1 : name);
    }
    snprintf(w->session, sizeof w->session, "{\"host\":\"%s\",\"osc\":%d,\"play\":\"%s\"}",
             all ? "127.0.0.1" : address, receive_port(w->config.osc), file);
}

web *web_new(const web_config *config, scene *s, himc_error *error)
{
    lws_set_log_level(0, NULL);
    if (!port_free(config, error))
        return NULL;
    web *w = calloc(1, sizeof *w);
    if (!w) {
        himc_error_set(error, "out of memory");
        return NULL;
    }
    w->s = s;
    w->config = *config;
    describe_session(w);
    w->edit.folder = w->next.folder = config->folder;
    if (config->edit) {
        editor_piece own = {.name = ""};
        snprintf(own.source, sizeof own.source, "%s", config->edit);
        editor_add_piece(&w->pieces, &own);
    }
    if (!listen_to_all(w)) {
        himc_error_set(error, "cannot serve the page on %s port %d", config->address, config->port);
        web_free(w);
        return NULL;
    }
    w->clock = wall_clock();
    w->cpu = cpu_seconds();
    on_second(&w->second);
    return w;
}

int web_port(const web *w)
{
    return lws_get_vhost_listen_port(w->vhost);
}

void web_run(web *w, const volatile int *stop)
{
    while (!*stop && lws_service(w->context, 0) >= 0)
        ;
}

void web_free(web *w)
{
    if (w && w->context)
        lws_context_destroy(w->context);
    if (w) {
        editor_stop(&w->edit);
        editor_stop(&w->next);
        free(w->heard);
        free(w->early.bytes);
        free(w->first.bytes);
    }
    free(w);
}
