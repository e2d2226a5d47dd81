/// words.h: the OSC addresses that the viewer knows, and what each does to the scene.
#ifndef VIEWER_WORDS_H
#define VIEWER_WORDS_H

#include "scene.h"

#include <lo/lo.h>

/// Carries out one message from `key`, or counts it as unknown or malformed.
void words_hear(scene *s, const char *key, const char *address, lo_message message, double now);

#endif
