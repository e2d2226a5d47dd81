/// receive.h: OSC from the network into the scene. liblo decodes; nothing is ever sent back.
#ifndef VIEWER_RECEIVE_H
#define VIEWER_RECEIVE_H

#include "scene.h"

/// Opens a UDP socket on `address` (numeric) and `port`; -1 with a line in `error` on failure.
int receive_open(const char *address, int port, char error[256]);
/// The port of the socket.
int receive_port(int fd);
/// Receives the waiting packets, at most `most`. True if the scene has a new complete pose, drum
/// state or event.
bool receive_waiting(int fd, scene *s, int most);
/// Stores one packet of the sender `key` in the scene; a malformed one is only counted.
void receive_packet(scene *s, const char *key, const void *packet, size_t size, double now);
/// The wall clock (s).
double wall_clock(void);

#endif
