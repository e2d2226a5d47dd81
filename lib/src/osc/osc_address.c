/// osc_address.c: addresses of hosts, IPv4 and IPv6. One that is IPv4 in IPv6's clothes
/// (::ffff:a.b.c.d) is undressed first, so that a host is one host.
#define _POSIX_C_SOURCE 200809L
#include "osc/osc_state.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>

static void undress(osc_address *a)
{
    struct sockaddr_in6 *six = (struct sockaddr_in6 *)&a->at;
    if (a->at.ss_family != AF_INET6 || !IN6_IS_ADDR_V4MAPPED(&six->sin6_addr))
        return;
    struct sockaddr_in four = {.sin_family = AF_INET, .sin_port = six->sin6_port};
    memcpy(&four.sin_addr, six->sin6_addr.s6_addr + 12, 4);
    memset(&a->at, 0, sizeof a->at);
    memcpy(&a->at, &four, sizeof four);
    a->size = sizeof four;
}

static bool look_up(const char *host, int port, int flags, osc_address *out)
{
    char service[16];
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = flags}, *found;
    snprintf(service, sizeof service, "%d", port);
    if (getaddrinfo(host, service, &hints, &found) != 0)
        return false;
    memset(out, 0, sizeof *out);
    memcpy(&out->at, found->ai_addr, found->ai_addrlen);
    out->size = found->ai_addrlen;
    freeaddrinfo(found);
    undress(out);
    return true;
}

bool himc_osc_address_parse(const char *host, int port, osc_address *out)
{
    bool here = strcmp(host, "localhost") == 0;
    return look_up(here ? "127.0.0.1" : host, port, AI_NUMERICHOST | AI_NUMERICSERV, out);
}

bool himc_osc_address_find(const char *host, int port, osc_address *out)
{
    return look_up(host, port, AI_NUMERICSERV, out);
}

void himc_osc_address_set_port(osc_address *a, int port)
{
    if (a->at.ss_family == AF_INET6)
        ((struct sockaddr_in6 *)&a->at)->sin6_port = htons((uint16_t)port);
    else
        ((struct sockaddr_in *)&a->at)->sin_port = htons((uint16_t)port);
}

static in_port_t port_of(const osc_address *a)
{
    return a->at.ss_family == AF_INET6 ? ((const struct sockaddr_in6 *)&a->at)->sin6_port
                                       : ((const struct sockaddr_in *)&a->at)->sin_port;
}

bool himc_osc_address_loopback(const osc_address *a)
{
    if (a->at.ss_family == AF_INET6)
        return IN6_IS_ADDR_LOOPBACK(&((const struct sockaddr_in6 *)&a->at)->sin6_addr);
    uint32_t host = ntohl(((const struct sockaddr_in *)&a->at)->sin_addr.s_addr);
    return host >> 24 == 127;
}

static bool same_number(const osc_address *a, const osc_address *b)
{
    if (a->at.ss_family != b->at.ss_family)
        return false;
    if (a->at.ss_family == AF_INET6)
        return memcmp(&((const struct sockaddr_in6 *)&a->at)->sin6_addr,
                      &((const struct sockaddr_in6 *)&b->at)->sin6_addr, 16) == 0;
    return ((const struct sockaddr_in *)&a->at)->sin_addr.s_addr ==
           ((const struct sockaddr_in *)&b->at)->sin_addr.s_addr;
}

bool himc_osc_address_same_host(const osc_address *x, const osc_address *y)
{
    osc_address a = *x, b = *y;
    undress(&a);
    undress(&b);
    return same_number(&a, &b) || (himc_osc_address_loopback(&a) && himc_osc_address_loopback(&b));
}

bool himc_osc_address_same(const osc_address *x, const osc_address *y)
{
    osc_address a = *x, b = *y;
    undress(&a);
    undress(&b);
    return same_number(&a, &b) && port_of(&a) == port_of(&b);
}

void himc_osc_address_print(const osc_address *address, char text[80])
{
    osc_address a = *address;
    char host[64], port[8];
    undress(&a);
    if (getnameinfo((const struct sockaddr *)&a.at, a.size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        snprintf(text, 80, "?");
    else
        snprintf(text, 80, strchr(host, ':') ? "[%s]:%s" : "%s:%s", host, port);
}
