/// fuzz_viewer_access.c: the lines of an input are the headers Host and Origin of a request. What
/// is admitted is checked by other means: it is a numeric address or this machine's name, with its
/// own Origin.
#include "access.h"
#include "fuzz.h"

// true for 127.0.0.1, ::1 and so on, of the characters of an address alone
static bool is_address(const char *name, size_t length)
{
    return strspn(name, "0123456789.") >= length ||
           strspn(name, "0123456789abcdefABCDEF:.") >= length;
}

static void check_host(const char *host)
{
    char own[256] = "", local[300];
    gethostname(own, sizeof own - 1);
    snprintf(local, sizeof local, "%s.local", own);
    const char *port = strrchr(host, ':'), *bracket = strchr(host, ']');
    bool ported = port && (!bracket || port > bracket);
    size_t length = ported ? (size_t)(port - host) : strlen(host);
    require(!ported || (port[1] && strspn(port + 1, "0123456789") == strlen(port + 1)),
            "a port is a number");
    if (host[0] == '[')
        require(host[length - 1] == ']' && is_address(host + 1, length - 2), "[address]");
    else
        require((length == 9 && !strncmp(host, "localhost", 9)) || is_address(host, length) ||
                    (length == strlen(own) && !strncmp(host, own, length)) ||
                    (length == strlen(local) && !strncmp(host, local, length)),
                "a host is this machine or a numeric address");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_text(data, size), *rest = text;
    const char *host = strsep(&rest, "\n"), *origin = rest ? rest : "";
    if (access_host_is_local(host))
        check_host(host);
    if (access_is_our_page(host, origin))
        require(access_host_is_local(host) && !strncmp(origin, "http://", 7) &&
                    !strcmp(origin + 7, host),
                "our page has the origin of its host");
    free(text);
    return 0;
}
