/// network.h: UDP sockets, addresses of hosts and the look-up of their names. The other files of
/// the room see addresses as plain values and know no socket.
#ifndef HIMC_OSC_NETWORK_H
#define HIMC_OSC_NETWORK_H

#include "himc/base.h"
#include "osc/counters.h"

/// Address and port of a host, as the network numbers them.
typedef struct osc_address {
    bool v6;
    uint16_t port;
    uint32_t scope;         ///< interface of a link-local IPv6 address, else 0
    unsigned char host[16]; ///< the first 4 if IPv4
} osc_address;

/// From a numeric address or "localhost", without a name server. False if `host` is neither.
bool himc_osc_address_parse(const char *host, int port, osc_address *out);
/// From any name; may wait seconds for a name server.
bool himc_osc_address_find(const char *host, int port, osc_address *out);
bool himc_osc_address_same(const osc_address *a, const osc_address *b);
/// The same but for the port; all loopback addresses are one host.
bool himc_osc_address_same_host(const osc_address *a, const osc_address *b);
bool himc_osc_address_loopback(const osc_address *a);
void himc_osc_address_print(const osc_address *a, char text[80]);

enum { OSC_SOCKETS = 3 };

typedef struct osc_network {
    /// listening; sending only, IPv4 and IPv6, opened when needed; -1: none
    int socket[OSC_SOCKETS];
    bool in_v6, in_loopback;       ///< the listening one's address
    int port;                      ///< listened at, or 0
    uint32_t overrun[OSC_SOCKETS]; ///< packets dropped by the system, as last reported
    osc_counters *counts;          ///< borrowed
} osc_network;

/// Listens at `port` (0 any free one, -1 does not listen) of the numeric address `bind`, NULL is
/// 127.0.0.1. To be closed also after an error.
bool himc_osc_network_open(osc_network *network, const char *bind, int port, osc_counters *counts,
                           himc_error *error);
void himc_osc_network_close(osc_network *network);
/// Waits until a packet or a report arrives, at most so long.
void himc_osc_network_wait(osc_network *network, int milliseconds);
/// The next packet: its size, or -1 if none waits.
long himc_osc_network_receive(osc_network *network, osc_address *from, void *data, size_t size);
/// Discards and counts a packet that arrived at a socket for sending; false if there is none.
bool himc_osc_network_discard(osc_network *network);
bool himc_osc_network_send(osc_network *network, const osc_address *to, const void *data,
                           size_t size);
/// The next report that nobody listens at an address we sent to; false if there is none.
bool himc_osc_network_unreachable(osc_network *network, osc_address *to);

/// The look-up of a host's name, in a thread of its own.
typedef struct osc_lookup osc_lookup;

osc_lookup *himc_osc_lookup_start(const char *host, int port); ///< NULL: no memory or no thread
/// True when it is over; then `found` says if there is such a host, and `to` where.
bool himc_osc_lookup_done(const osc_lookup *lookup, bool *found, osc_address *to);
/// Never waits; a look-up still under way ends by itself.
void himc_osc_lookup_free(osc_lookup *lookup);

#endif
