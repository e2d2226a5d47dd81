/// access.c: a browser sends each request's Host as the user's address bar has it, and the Origin
/// of the page that asks. A foreign page has another Origin, and a rebound DNS name another Host.
#define _POSIX_C_SOURCE 200809L
#include "access.h"

#include <arpa/inet.h>
#include <string.h>
#include <unistd.h>

enum { NAME_SIZE = 256 }; // of a host with its zero, DNS's limit; longer ones are refused

// nothing, or ":8080"
static bool is_port(const char *text)
{
    return !*text || (text[0] == ':' && text[1] && !text[1 + strspn(text + 1, "0123456789")]);
}

// this machine's name, alone or as a neighbour calls it
static bool is_own(const char *name)
{
    char own[NAME_SIZE] = "";
    gethostname(own, sizeof own - 1);
    size_t length = strlen(own);
    return length && strncmp(name, own, length) == 0 &&
           (!name[length] || strcmp(name + length, ".local") == 0);
}

bool access_host_is_local(const char *host)
{
    char name[NAME_SIZE];
    unsigned char address[16];
    bool bracket = host[0] == '[';
    size_t length = strcspn(host += bracket, bracket ? "]" : ":");
    const char *rest = host + length;
    if (length >= NAME_SIZE || (bracket && !*rest) || !is_port(rest + bracket))
        return false;
    memcpy(name, host, length);
    name[length] = 0;
    return bracket ? inet_pton(AF_INET6, name, address) == 1
                   : inet_pton(AF_INET, name, address) == 1 || strcmp(name, "localhost") == 0 ||
                         is_own(name);
}

bool access_is_our_page(const char *host, const char *origin)
{
    return access_host_is_local(host) && strncmp(origin, "http://", 7) == 0 &&
           strcmp(origin + 7, host) == 0;
}
