/// channel.h: the stream of the page that edits, on libwebsockets.
#ifndef VIEWER_CHANNEL_H
#define VIEWER_CHANNEL_H

#include "folder.h"

#include <libwebsockets.h>

#define CHANNEL_PROGRAM "edited" ///< protocol of the output of `himc edit`, channel_on_program

/// Between a page and the program that edits its piece. One for a vhost, whose user it is.
typedef struct channel channel;

/// `source` is the piece to be edited, or NULL; `place` is borrowed. NULL without memory.
channel *channel_new(const char *source, folder *place);
/// After the end of the loop; NULL is allowed.
void channel_free(channel *c);

/// A new page edits from now on; the one before is told so and closed.
void channel_take_over(channel *c, struct lws *page);
/// False once another page has taken over.
bool channel_edits(const channel *c, const struct lws *page);
/// The end of a page's stream: its programs end with it.
void channel_leave(channel *c, struct lws *page);
/// A part of a message has come; false if the message is too long, or is no line.
bool channel_hear(channel *c, struct lws *page, const char *in, size_t length);
/// The page takes a message: sends one, if any. As a callback of libwebsockets returns.
int channel_write(channel *c, struct lws *page);
/// The callback of CHANNEL_PROGRAM.
int channel_on_program(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t length);

#endif
