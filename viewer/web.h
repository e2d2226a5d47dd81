/// web.h: the page and its stream, on libwebsockets.
#ifndef VIEWER_WEB_H
#define VIEWER_WEB_H

#include "himc/base.h"
#include "scene.h"

typedef struct web_config {
    const char *address;   ///< numeric
    int port;              ///< 0 takes any free one
    int osc;               ///< the OSC socket
    const char *play;      ///< bytes of a scene, served as /play.himc, or NULL
    size_t play_size;      ///< (bytes)
    const char *play_name; ///< its file
    const char *edit;      ///< file of a piece to be edited, or NULL
    const char *key;       ///< that a page must know to edit (editor.h)
} web_config;

typedef struct web web;

/// Opens the port; NULL with a line in `error` on failure. `s` must live as long.
web *web_new(const web_config *config, scene *s, himc_error *error);
int web_port(const web *w);
/// Serves until `*stop` is set (by a signal).
void web_run(web *w, const volatile int *stop);
void web_free(web *w);

#endif
