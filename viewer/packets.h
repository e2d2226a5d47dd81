/// packets.h: OSC packets into the scene, from any source. liblo decodes; nothing is sent back.
#ifndef VIEWER_PACKETS_H
#define VIEWER_PACKETS_H

#include "scene.h"

/// Stores one packet of the sender `key` in the scene; a malformed one is only counted.
void packets_store(scene *s, const char *key, const void *packet, size_t size, double now);

#endif
