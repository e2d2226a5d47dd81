/// network.c: sockets, addresses, names.
///
/// Packets to the network that we listen at leave from the listening socket, so that a receiver can
/// answer; all others leave from sockets that only send. No call waits but the one named so.
///
/// An IPv4 address mapped into IPv6 (::ffff:a.b.c.d), as a socket of both has it, is compared as
/// the IPv4 address, so that a host is one host, and this machine is not a stranger.
#define _POSIX_C_SOURCE 200809L // names of hosts, threads
#include "osc/network.h"
#include "system/thread.h"
#include "system/udp.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RECEIVE_BUFFER (1 << 20) // (bytes) chosen: 0.1 s of the 100,000 packets/s of the storm test

// --- addresses

static socklen_t to_socket(const osc_address *a, himc_udp_address *out)
{
    memset(out, 0, sizeof *out);
    if (a->v6) {
        out->v6.sin6_family = AF_INET6;
        out->v6.sin6_port = htons(a->port);
        out->v6.sin6_scope_id = a->scope;
        memcpy(&out->v6.sin6_addr, a->host, 16);
        return sizeof out->v6;
    }
    out->v4.sin_family = AF_INET;
    out->v4.sin_port = htons(a->port);
    memcpy(&out->v4.sin_addr, a->host, 4);
    return sizeof out->v4;
}

static osc_address from_socket(const himc_udp_address *in)
{
    osc_address a = {.v6 = in->any.sa_family == AF_INET6};
    if (a.v6) {
        a.port = ntohs(in->v6.sin6_port);
        a.scope = in->v6.sin6_scope_id;
        memcpy(a.host, &in->v6.sin6_addr, 16);
    } else {
        a.port = ntohs(in->v4.sin_port);
        memcpy(a.host, &in->v4.sin_addr, 4);
    }
    return a;
}

// IPv4 if it is IPv4 mapped into IPv6
static osc_address unmapped(const osc_address *a)
{
    static const unsigned char prefix[12] = {[10] = 0xff, [11] = 0xff};
    osc_address four = {.port = a->port};
    if (!a->v6 || memcmp(a->host, prefix, 12) != 0)
        return *a;
    memcpy(four.host, a->host + 12, 4);
    return four;
}

static bool resolve(const char *host, int port, int flags, osc_address *out)
{
    char service[16];
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = flags}, *found;
    himc_udp_address at = {0};
    himc_udp_begin();
    snprintf(service, sizeof service, "%d", port);
    if (getaddrinfo(host, service, &hints, &found) != 0)
        return false;
    memcpy(&at, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);
    *out = from_socket(&at);
    *out = unmapped(out);
    return true;
}

bool himc_osc_address_parse(const char *host, int port, osc_address *out)
{
    bool here = strcmp(host, "localhost") == 0;
    return resolve(here ? "127.0.0.1" : host, port, AI_NUMERICHOST | AI_NUMERICSERV, out);
}

bool himc_osc_address_find(const char *host, int port, osc_address *out)
{
    return resolve(host, port, AI_NUMERICSERV, out);
}

bool himc_osc_address_loopback(const osc_address *address)
{
    static const unsigned char loopback6[16] = {[15] = 1};
    osc_address a = unmapped(address);
    return a.v6 ? memcmp(a.host, loopback6, 16) == 0 : a.host[0] == 127;
}

static bool same_number(const osc_address *a, const osc_address *b)
{
    return a->v6 == b->v6 && memcmp(a->host, b->host, a->v6 ? 16 : 4) == 0;
}

bool himc_osc_address_same_host(const osc_address *x, const osc_address *y)
{
    osc_address a = unmapped(x), b = unmapped(y);
    return same_number(&a, &b) || (himc_osc_address_loopback(&a) && himc_osc_address_loopback(&b));
}

bool himc_osc_address_same(const osc_address *x, const osc_address *y)
{
    osc_address a = unmapped(x), b = unmapped(y);
    return same_number(&a, &b) && a.port == b.port;
}

void himc_osc_address_print(const osc_address *address, char text[80])
{
    osc_address a = unmapped(address);
    himc_udp_address at;
    socklen_t size = to_socket(&a, &at);
    char host[64], port[8];
    if (getnameinfo(&at.any, size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        snprintf(text, 80, "?");
    else
        snprintf(text, 80, a.v6 ? "[%s]:%s" : "%s:%s", host, port);
}

// --- sockets

bool himc_osc_network_open(osc_network *n, const char *bind_to, int port, osc_counters *counts,
                           himc_error *error)
{
    osc_address address;
    himc_udp_address at;
    *n = (osc_network){.socket = {-1, -1, -1}, .counts = counts};
    bind_to = bind_to ? bind_to : "127.0.0.1";
    if (port < 0)
        return true;
    if (port > 65535)
        return himc_error_set(error, "port: %d, expected 0 .. 65535", port);
    if (!himc_osc_address_parse(bind_to, port, &address))
        return himc_error_set(error, "bind: %.80s, expected a numeric address of this machine",
                              bind_to);
    n->in_v6 = address.v6;
    n->in_loopback = himc_osc_address_loopback(&address);
    n->socket[0] = himc_udp_open(n->in_v6 ? AF_INET6 : AF_INET, RECEIVE_BUFFER);
    socklen_t size = to_socket(&address, &at);
    if (n->socket[0] < 0 || !himc_udp_bind(n->socket[0], &at, size)) {
        if (errno == EADDRINUSE)
            return himc_error_set(error, "port %d is taken by another program, expected a free one",
                                  port);
        return himc_error_set(error, "%.80s port %d: %s", bind_to, port, strerror(errno));
    }
    size = sizeof at;
    getsockname(n->socket[0], &at.any, &size);
    n->port = from_socket(&at).port;
    return true;
}

void himc_osc_network_close(osc_network *n)
{
    for (int i = 0; i < OSC_SOCKETS; i++) {
        if (n->socket[i] >= 0)
            himc_udp_close(n->socket[i]);
        n->socket[i] = -1;
    }
}

void himc_osc_network_wait(osc_network *n, int milliseconds)
{
    himc_udp_wait(n->socket, OSC_SOCKETS, milliseconds);
}

bool himc_osc_network_send(osc_network *n, const osc_address *to, const void *data, size_t size)
{
    himc_udp_address at;
    socklen_t length = to_socket(to, &at);
    long sent = -1;
    bool listens = n->socket[0] >= 0 && to->v6 == n->in_v6 &&
                   (!n->in_loopback || himc_osc_address_loopback(to));
    int *from = &n->socket[listens ? 0 : 1 + to->v6];
    if (*from < 0)
        *from = himc_udp_open(to->v6 ? AF_INET6 : AF_INET, RECEIVE_BUFFER);
    // the first failures may report earlier packets, of each socket
    for (int i = 0; *from >= 0 && sent < 0 && i < OSC_SOCKETS; i++)
        sent = himc_udp_send(*from, &at, length, data, size);
    bool good = sent == (long)size;
    himc_osc_add(n->counts, good ? COUNT_SENT : COUNT_UNSENT, 1);
    return good;
}

static long receive(osc_network *n, int socket, osc_address *from, void *data, size_t size)
{
    int fd = n->socket[socket];
    himc_udp_address at = {0};
    uint32_t dropped = n->overrun[socket];
    long got = fd < 0 ? -1 : himc_udp_receive(fd, &at, data, size, &dropped);
    if (got < 0)
        return -1;
    *from = from_socket(&at);
    himc_osc_add(n->counts, COUNT_OVERRUN, (long)(uint32_t)(dropped - n->overrun[socket]));
    n->overrun[socket] = dropped;
    himc_osc_add(n->counts, COUNT_PACKETS, 1);
    return got;
}

long himc_osc_network_receive(osc_network *n, osc_address *from, void *data, size_t size)
{
    return receive(n, 0, from, data, size);
}

bool himc_osc_network_discard(osc_network *n)
{
    char data[16];
    osc_address from;
    bool any = receive(n, 1, &from, data, sizeof data) >= 0 ||
               receive(n, 2, &from, data, sizeof data) >= 0;
    himc_osc_add(n->counts, COUNT_FOREIGN, any);
    return any;
}

bool himc_osc_network_unreachable(osc_network *n, osc_address *to)
{
    himc_udp_address at = {0};
    for (int i = 0; i < OSC_SOCKETS; i++)
        if (n->socket[i] >= 0 && himc_udp_unreachable(n->socket[i], &at)) {
            *to = from_socket(&at);
            return true;
        }
    return false;
}

// --- names

// shared by the thread of the look-up and the caller; the last of the two frees it
struct osc_lookup {
    _Atomic int users;
    _Atomic bool done;
    bool found;
    char host[256];
    int port;
    osc_address to;
};

void himc_osc_lookup_free(osc_lookup *lookup)
{
    if (atomic_fetch_sub(&lookup->users, 1) == 1)
        free(lookup);
}

static void *look_up(void *object)
{
    osc_lookup *l = object;
    l->found = himc_osc_address_find(l->host, l->port, &l->to);
    atomic_store(&l->done, true);
    himc_osc_lookup_free(l);
    return NULL;
}

osc_lookup *himc_osc_lookup_start(const char *host, int port)
{
    osc_lookup *l = calloc(1, sizeof *l);
    pthread_t thread;
    if (!l)
        return NULL;
    l->users = 2;
    l->port = port;
    snprintf(l->host, sizeof l->host, "%s", host);
    if (!himc_system_start_thread(&thread, look_up, l)) {
        free(l);
        return NULL;
    }
    pthread_detach(thread);
    return l;
}

bool himc_osc_lookup_done(const osc_lookup *lookup, bool *found, osc_address *to)
{
    if (!atomic_load(&lookup->done))
        return false;
    *found = lookup->found;
    *to = lookup->to;
    return true;
}
