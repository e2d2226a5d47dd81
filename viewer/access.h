/// access.h: who may use the page and its stream, from the headers of a request.
#ifndef VIEWER_ACCESS_H
#define VIEWER_ACCESS_H

#include <stdbool.h>

/// True if a Host header ("name", "name:port" or "[address]:port") is a numeric address, localhost
/// or this machine's name, so that a rebound DNS name gets nothing.
bool access_host_is_local(const char *host);
/// True if a request with these headers comes from a page of ours: the Origin is the Host's.
bool access_is_our_page(const char *host, const char *origin);

#endif
