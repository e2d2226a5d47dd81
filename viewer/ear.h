/// ear.h: OSC from the network into the scene. liblo decodes; nothing is ever sent back.
#ifndef VIEWER_EAR_H
#define VIEWER_EAR_H

#include "scene.h"

/// A UDP socket bound to `address` (numeric) and `port`. -1 with a line in `error`.
int ear_open(const char *address, int port, char error[256]);
/// The port it is bound to.
int ear_port(int fd);
/// Hears what waits, at most `most` packets. True if the scene has a whole pose, a drum or an event
/// more.
bool ear_listen(int fd, scene *s, int most);
/// One packet, as if it had come from `key`. Malformed ones are counted.
void ear_hear(scene *s, const char *key, const void *packet, size_t size, double now);
/// The wall clock (s).
double ear_clock(void);

#endif
