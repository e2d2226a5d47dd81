/// udp.c: datagram sockets of Linux, of other systems of POSIX, and of Windows.
#define _GNU_SOURCE // the error queue and the count of dropped packets are Linux's own
#include "system/udp.h"

#include <errno.h>
#include <string.h>

#ifdef _WIN32

void himc_udp_begin(void)
{
    WSADATA about;
    WSAStartup(MAKEWORD(2, 2), &about); // counted by the system; the process's end ends it
}

// a handle of Windows fits an int, in programs of 64 bits, too
int himc_udp_open(int family, int room)
{
    himc_udp_begin();
    SOCKET fd = socket(family, SOCK_DGRAM, 0);
    if (fd == INVALID_SOCKET)
        return -1;
    u_long on = 1;
    BOOL report = FALSE; // a port where nobody listens would end the next receive with an error
    DWORD got;
    ioctlsocket(fd, FIONBIO, &on);
    WSAIoctl(fd, _WSAIOW(IOC_VENDOR, 12), &report, sizeof report, NULL, 0, &got, NULL, NULL);
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, (const char *)&room, sizeof room);
    SetHandleInformation((HANDLE)fd, HANDLE_FLAG_INHERIT, 0);
    return (int)fd;
}

void himc_udp_close(int fd)
{
    closesocket((SOCKET)fd);
}

bool himc_udp_bind(int fd, const himc_udp_address *address, socklen_t size)
{
    if (bind((SOCKET)fd, &address->any, size) == 0)
        return true;
    int why = WSAGetLastError();
    errno = why == WSAEADDRINUSE || why == WSAEACCES ? EADDRINUSE : EADDRNOTAVAIL;
    return false;
}

void himc_udp_wait(const int *sockets, int count, int milliseconds)
{
    fd_set readable;
    FD_ZERO(&readable);
    for (int i = 0; i < count; i++)
        if (sockets[i] >= 0)
            FD_SET((SOCKET)sockets[i], &readable);
    if (readable.fd_count == 0)
        Sleep((DWORD)milliseconds);
    else
        select(0, &readable, NULL, NULL, &(struct timeval){0, 1000 * milliseconds});
}

long himc_udp_send(int fd, const himc_udp_address *to, socklen_t length, const void *data,
                   size_t size)
{
    return sendto((SOCKET)fd, data, (int)size, 0, &to->any, length);
}

long himc_udp_receive(int fd, himc_udp_address *from, void *data, size_t size, uint32_t *dropped)
{
    socklen_t length = sizeof *from;
    (void)dropped;
    return recvfrom((SOCKET)fd, data, (int)size, 0, &from->any, &length);
}

bool himc_udp_unreachable(int fd, himc_udp_address *to)
{
    (void)fd, (void)to;
    return false;
}

#else
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>
#ifdef __linux__
#include <linux/errqueue.h>
#endif

void himc_udp_begin(void)
{
}

// all options are useful, none is required
int himc_udp_open(int family, int room)
{
    int fd = socket(family, SOCK_DGRAM, 0);
    if (fd < 0)
        return -1;
    fcntl(fd, F_SETFL, O_NONBLOCK);
    fcntl(fd, F_SETFD, FD_CLOEXEC);
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
#ifdef __linux__
    int on = 1;
    if (family == AF_INET6)
        setsockopt(fd, IPPROTO_IPV6, IPV6_RECVERR, &on, sizeof on);
    else
        setsockopt(fd, IPPROTO_IP, IP_RECVERR, &on, sizeof on);
    setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
#endif
    return fd;
}

void himc_udp_close(int fd)
{
    close(fd);
}

bool himc_udp_bind(int fd, const himc_udp_address *address, socklen_t size)
{
    return bind(fd, &address->any, size) == 0;
}

void himc_udp_wait(const int *sockets, int count, int milliseconds)
{
    struct pollfd at[8];
    for (int i = 0; i < count; i++)
        at[i] = (struct pollfd){sockets[i], POLLIN, 0};
    poll(at, (nfds_t)count, milliseconds);
}

long himc_udp_send(int fd, const himc_udp_address *to, socklen_t length, const void *data,
                   size_t size)
{
    return sendto(fd, data, size, 0, &to->any, length);
}

static long receive(int fd, int flags, himc_udp_address *from, void *data, size_t size,
                    uint32_t *dropped)
{
    _Alignas(struct cmsghdr) char control[512];
    struct iovec part = {data, size};
    struct msghdr m = {.msg_name = from,
                       .msg_namelen = sizeof *from,
                       .msg_iov = &part,
                       .msg_iovlen = 1,
                       .msg_control = control,
                       .msg_controllen = sizeof control};
    long got = recvmsg(fd, &m, flags);
#ifdef __linux__
    for (struct cmsghdr *c = got < 0 || !dropped ? NULL : CMSG_FIRSTHDR(&m); c;
         c = CMSG_NXTHDR(&m, c))
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL)
            memcpy(dropped, CMSG_DATA(c), sizeof *dropped);
#else
    (void)dropped;
#endif
    return got;
}

long himc_udp_receive(int fd, himc_udp_address *from, void *data, size_t size, uint32_t *dropped)
{
    return receive(fd, 0, from, data, size, dropped);
}

bool himc_udp_unreachable(int fd, himc_udp_address *to)
{
#ifdef __linux__
    char data[64];
    return receive(fd, MSG_ERRQUEUE, to, data, sizeof data, NULL) >= 0;
#else
    (void)fd, (void)to;
    return false;
#endif
}
#endif
