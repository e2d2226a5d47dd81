/// web.h: the page and its stream, on libwebsockets.
#ifndef VIEWER_WEB_H
#define VIEWER_WEB_H

#include "scene.h"

typedef struct web_config {
    const char *address; ///< numeric, to listen on
    int port;            ///< 0 takes a free one
    int ear;             ///< the OSC socket, read whenever something waits
    const char *play;    ///< a motion's text, served as /play.csv, or NULL
    size_t play_size;    ///< (bytes)
} web_config;

typedef struct web web;

/// Listens. NULL with a line in `error`. `s` is borrowed.
web *web_new(const web_config *config, scene *s, char error[256]);
int web_port(const web *w);
/// Serves until `*stop` is set (by a signal).
void web_run(web *w, const volatile int *stop);
void web_free(web *w);

#endif
