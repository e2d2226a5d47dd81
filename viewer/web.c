/// web.c: one thread, one loop: OSC comes in through an adopted descriptor, pages and news go out.
///
/// The stream is for our page alone (access.h). One gate decides on each request for an upgrade,
/// whatever its protocol: libwebsockets would otherwise accept h2c, and websockets without a
/// protocol. The page never sends data; clients that send anything but control frames are
/// disconnected. Another stream is for editing (channel.c): it is for a page that knows the key in
/// its address. A slow browser gets the newest pose when it is ready for it, so no queue grows
/// here. Invariant: connections are bounded in number, and each that makes no progress in time.
/// When all are taken, the one without progress for the longest time gives way to a new one, but
/// no stream does: these have a limit of their own.
#define _DEFAULT_SOURCE // getaddrinfo
#include "web.h"
#include "access.h"
#include "channel.h"
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
    HEADER_SIZE = 264    // of a host or an origin with its zero; longer ones are refused
};

/// State of one connection.
typedef struct session {
    const char *at, *end; // rest of the page being sent
    scene_reader reader;
    bool counted; // among the clients
    bool closing; // gets nothing more but the close frame
} session;

struct web {
    struct lws_context *context;
    struct lws_vhost *vhost;
    scene *s;
    web_config config;
    int clients, connections;
    struct lws *idle[CONNECTIONS]; // no streams; in the order of their last progress
    int idles;
    channel *channel;
    struct lws *osc; // the OSC socket in the loop
    uint64_t rejected;
    char session[1024]; // JSON: where OSC is received, what is played
    lws_sorted_usec_list_t pause, second;
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

static void forget(web *w, const struct lws *wsi)
{
    int i = 0;
    while (i < w->idles && w->idle[i] != wsi)
        i++;
    if (i == w->idles)
        return;
    w->idles--;
    memmove(&w->idle[i], &w->idle[i + 1], (size_t)(w->idles - i) * sizeof *w->idle);
}

// it is the last to give way
static void progress(web *w, struct lws *wsi)
{
    forget(w, wsi);
    if (w->idles < CONNECTIONS)
        w->idle[w->idles++] = wsi;
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
    progress(w, wsi);
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

// one more may come: of too many, the one without progress for the longest time gives way
static int on_connection(web *w)
{
    if (w->connections < CONNECTIONS)
        return 0;
    w->rejected++;
    if (w->idles == 0)
        return -1;
    lws_set_timeout(w->idle[0], PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_SYNC);
    return 0;
}

// libwebsockets also asks the first protocol about connections without a protocol
static int on_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                   size_t length)
{
    (void)length;
    switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION: return on_connection(web_of(wsi));
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED: progress(web_of(wsi), wsi); return 0;
    case LWS_CALLBACK_WSI_CREATE: web_of(wsi)->connections++; return 0;
    case LWS_CALLBACK_WSI_DESTROY:
        web_of(wsi)->connections--;
        forget(web_of(wsi), wsi);
        return 0;
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

static void count_stream(web *w, struct lws *wsi, session *own)
{
    w->clients++;
    own->counted = true;
    forget(w, wsi);
}

static int on_stream(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                     size_t length)
{
    web *w = web_of(wsi);
    session *own = user;
    (void)in, (void)length;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
        count_stream(w, wsi, own);
        own->reader = scene_reader_new(w->s);
        return lws_callback_on_writable(wsi) < 0;
    case LWS_CALLBACK_SERVER_WRITEABLE: return own->closing ? 0 : send_news(wsi, own);
    case LWS_CALLBACK_RECEIVE: return on_data(wsi, own);
    default: return on_end(wsi, reason, own);
    }
}

static int on_edit(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                   size_t length)
{
    web *w = web_of(wsi);
    session *own = user;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
        count_stream(w, wsi, own);
        folder_unlink(w->config.folder, WEB_DOOR);
        channel_take_over(w->channel, wsi);
        return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE: return own->closing ? 0 : channel_write(w->channel, wsi);
    case LWS_CALLBACK_RECEIVE:
        if (!channel_edits(w->channel, wsi) ||
            (!own->closing && channel_hear(w->channel, wsi, in, length)))
            return 0;
        return on_data(wsi, own);
    case LWS_CALLBACK_CLOSED: channel_leave(w->channel, wsi); // fall through
    default: return on_end(wsi, reason, own);
    }
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
    {.name = CHANNEL_PROGRAM, .callback = channel_on_program, .rx_buffer_size = 1024},
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
    info.user = w->channel;
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
    w->channel = channel_new(config->edit, config->folder);
    if (!w->channel || !listen_to_all(w)) {
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
    if (w)
        channel_free(w->channel);
    free(w);
}
