/// udp.h: datagram sockets, as the systems differ. No call waits but himc_udp_wait.
///
/// Two things are Linux's own. It counts the packets dropped because nobody read them in time;
/// elsewhere none is counted. And it reports the address where nobody listens; elsewhere a
/// subscriber that has gone is not noticed, and gets packets until it is unsubscribed.
#ifndef HIMC_SYSTEM_UDP_H
#define HIMC_SYSTEM_UDP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#ifdef _WIN32
#include <winsock2.h>
#include <ws2tcpip.h>
#else
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#endif

typedef union himc_udp_address {
    struct sockaddr any;
    struct sockaddr_in v4;
    struct sockaddr_in6 v6;
    struct sockaddr_storage storage;
} himc_udp_address;

/// To be called before any other function of sockets or names; again is harmless.
void himc_udp_begin(void);
/// A socket with room for `room` bytes of packets that nobody has read yet; -1 if there is none.
int himc_udp_open(int family, int room);
void himc_udp_close(int socket);
/// False with errno, EADDRINUSE if another program listens there.
bool himc_udp_bind(int socket, const himc_udp_address *address, socklen_t size);
/// Waits until a packet or a report arrives at one of the sockets (those below 0 left out).
void himc_udp_wait(const int *sockets, int count, int milliseconds);
/// Bytes sent, or -1.
long himc_udp_send(int socket, const himc_udp_address *to, socklen_t length, const void *data,
                   size_t size);
/// The next packet: its size, or -1 if none waits. `dropped`: packets dropped at this socket so
/// far, set if the system tells.
long himc_udp_receive(int socket, himc_udp_address *from, void *data, size_t size,
                      uint32_t *dropped);
/// The next report that nobody listens at an address we sent to; false if there is none.
bool himc_udp_unreachable(int socket, himc_udp_address *to);

#endif
