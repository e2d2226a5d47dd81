/// web.h: the page and its stream, on libwebsockets.
#ifndef VIEWER_WEB_H
#define VIEWER_WEB_H

#include "himc/base.h"
#include "folder.h"
#include "scene.h"

#define WEB_DOOR "open.html" ///< in the folder (folder.c): leads a browser to the page that edits

typedef struct web_config {
    const char *address;   ///< numeric
    int port;              ///< 0 takes any free one
    int osc;               ///< the OSC socket
    const char *play;      ///< bytes of a scene, served as /play.himc, or NULL
    size_t play_size;      ///< (bytes)
    const char *play_name; ///< its file
    const char *edit;      ///< file of a piece to be edited, or NULL
    const char *key;       ///< that a page must know to edit (editor.h)
    folder *folder;        ///< private, for files; borrowed
} web_config;

typedef struct web web;

/// Opens the port; NULL with a line in `error` on failure. `s` must live as long.
web *web_new(const web_config *config, scene *s, himc_error *error);
int web_port(const web *w);
/// Serves until `*stop` is set (by a signal).
void web_run(web *w, const volatile int *stop);
void web_free(web *w);

#endif
