/// receive.h: OSC from the network into the scene. Nothing is ever sent back.
#ifndef VIEWER_RECEIVE_H
#define VIEWER_RECEIVE_H

#include "himc/base.h"
#include "scene.h"

/// Opens a UDP socket on `address` (numeric) and `port`; -1 with a line in `error` on failure.
int receive_open(const char *address, int port, himc_error *error);
/// The port of the socket.
int receive_port(int fd);
/// Receives the waiting packets, at most `most`. True if the scene has a new complete pose, drum
/// state or event.
bool receive_waiting(int fd, scene *s, int most);
/// The wall clock (s).
double wall_clock(void);

#endif
