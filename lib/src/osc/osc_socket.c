/// osc_socket.c: the sockets. Ours and not liblo's, whose server always binds to every address of
/// the machine; liblo writes and reads the messages.
///
/// What goes to where we listen's own network leaves from there, so that a receiver can answer;
/// the rest leaves from sockets that send only. None ever waits. The system reports a port where
/// nobody listens on the error queue (IP_RECVERR), with the address that was meant.
#define _GNU_SOURCE // the error queue is Linux's own
#include "osc/osc_state.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/errqueue.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BACKLOG (1 << 20) // (bytes)

static int open_socket(int family)
{
    int fd = socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), on = 1, size = BACKLOG;
    if (fd < 0)
        return -1;
    // each is welcome, none is needed
    if (family == AF_INET6)
        setsockopt(fd, IPPROTO_IPV6, IPV6_RECVERR, &on, sizeof on);
    else
        setsockopt(fd, IPPROTO_IP, IP_RECVERR, &on, sizeof on);
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
    setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    return fd;
}

bool himc_osc_listen(himc_osc *osc, const himc_osc_config *config, himc_error *error)
{
    const char *bind_to = config->bind ? config->bind : "127.0.0.1";
    osc_address at;
    if (config->port < 0)
        return true;
    if (config->port > 65535)
        return himc_error_set(error, "port: %d, allowed 0 .. 65535", config->port);
    if (!himc_osc_address_parse(bind_to, config->port, &at))
        return himc_error_set(error, "bind: %.80s, allowed a numeric address of this machine",
                              bind_to);
    osc->in_family = at.at.ss_family;
    osc->in_loopback = himc_osc_address_loopback(&at);
    osc->in = open_socket(osc->in_family);
    if (osc->in < 0 || bind(osc->in, (struct sockaddr *)&at.at, at.size) != 0) {
        if (errno == EADDRINUSE)
            return himc_error_set(error, "port %d is taken by another program, allowed a free one",
                                  config->port);
        return himc_error_set(error, "%.80s port %d: %s", bind_to, config->port, strerror(errno));
    }
    osc_address bound = {.size = sizeof bound.at};
    getsockname(osc->in, (struct sockaddr *)&bound.at, &bound.size);
    osc->port = ntohs(osc->in_family == AF_INET6 ? ((struct sockaddr_in6 *)&bound.at)->sin6_port
                                                 : ((struct sockaddr_in *)&bound.at)->sin_port);
    return true;
}

static int socket_for(himc_osc *osc, const osc_address *to)
{
    int family = to->at.ss_family;
    if (osc->in >= 0 && family == osc->in_family &&
        osc->in_loopback == himc_osc_address_loopback(to))
        return osc->in;
    if (osc->in >= 0 && family == osc->in_family && !osc->in_loopback)
        return osc->in;
    int *out = &osc->out[family == AF_INET6];
    if (*out < 0)
        *out = open_socket(family);
    return *out;
}

bool himc_osc_send_to(himc_osc *osc, const osc_address *to, const void *data, size_t size)
{
    int fd = socket_for(osc, to);
    ssize_t sent = -1;
    // a first failure may be the report about an earlier packet to somebody else
    for (int i = 0; fd >= 0 && sent < 0 && i < 3; i++)
        sent = sendto(fd, data, size, MSG_DONTWAIT, (const struct sockaddr *)&to->at, to->size);
    bool good = sent == (ssize_t)size;
    osc_counted(osc, good ? COUNT_SENT : COUNT_UNSENT, 1);
    return good;
}

static void read_errors(himc_osc *osc, int fd, void (*refused)(himc_osc *, const osc_address *))
{
    char data[64], control[512];
    for (int i = 0; fd >= 0 && i < 64; i++) {
        osc_address to = {.size = 0};
        struct iovec part = {data, sizeof data};
        struct msghdr m = {.msg_name = &to.at,
                           .msg_namelen = sizeof to.at,
                           .msg_iov = &part,
                           .msg_iovlen = 1,
                           .msg_control = control,
                           .msg_controllen = sizeof control};
        if (recvmsg(fd, &m, MSG_ERRQUEUE | MSG_DONTWAIT) < 0)
            return;
        to.size = m.msg_namelen;
        refused(osc, &to);
    }
}

void himc_osc_read_errors(himc_osc *osc, void (*refused)(himc_osc *, const osc_address *))
{
    read_errors(osc, osc->in, refused);
    read_errors(osc, osc->out[0], refused);
    read_errors(osc, osc->out[1], refused);
}
