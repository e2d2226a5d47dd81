/// addresses.h: the OSC addresses of the viewer and their action on the scene.
#ifndef VIEWER_ADDRESSES_H
#define VIEWER_ADDRESSES_H

#include "scene.h"

#include <lo/lo.h>

/// Stores one message of the sender `key` in the scene, or counts it as unknown or malformed.
void address_dispatch(scene *s, const char *key, const char *path, lo_message message,
                      scene_time time);

#endif
