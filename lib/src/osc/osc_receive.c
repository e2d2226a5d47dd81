/// osc_receive.c: packets in: bundles taken apart (OSC 1.0: "#bundle", time tag, then size and
/// element in turn), messages read by liblo, commands checked by the one parser, here, so that the
/// audio's side only gets what fits the table.
///
/// Commands act as they come, whatever a bundle's time tag, so that nobody can pile up a future
/// here. A file is looked for in the folder of `files` and must be a regular one that lies there
/// after all links are followed; whatever else it is, the answer is the same. What we send
/// ourselves is not answered, so that two servers never talk in circles.
#define _GNU_SOURCE // realpath; the count of what the system dropped is Linux's own
#include "osc/osc_state.h"

#include <lo/lo.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define BATCH 256
#define DEPTH 4 // bundles in bundles
#define ATOMS (2 * HIMC_COMMAND_ATOMS)

static bool refuse(himc_osc *osc, const osc_address *from, const char *line)
{
    osc_counted(osc, COUNT_REFUSED, 1);
    himc_osc_answer(osc, from, true, line);
    return false;
}

static bool confine(himc_osc *osc, himc_command *command, himc_error *error)
{
    char wanted[2 * HIMC_PATH_SIZE];
    const char *name = himc_command_table((int)command->id)->name;
    struct stat about;
    if (!osc->files)
        return himc_error_set(error, "%s: no file over the network, allowed with --files", name);
    size_t length = strlen(osc->files);
    snprintf(wanted, sizeof wanted, "%s/%s", osc->files, command->atom[0].symbol);
    char *real = realpath(wanted, NULL);
    bool inside = real && strncmp(real, osc->files, length) == 0 &&
                  (real[length] == '/' || length == 1) && strlen(real) < HIMC_PATH_SIZE &&
                  stat(real, &about) == 0 && S_ISREG(about.st_mode);
    himc_atom atom = {HIMC_ATOM_SYMBOL, 0, real};
    himc_command found;
    bool good = inside && himc_command_parse(&found, HIMC_PERFORMER, name, &atom, 1, error);
    if (!inside)
        himc_error_set(error, "%s: no such file in the folder given by --files", name);
    if (good)
        himc_command_copy(command, &found);
    free(real);
    return good;
}

// from the network only scores and takes may be read, in the folder of `files`
static bool is_confined(const himc_command *c)
{
    return c->id == HIMC_COMMAND_SCORE || c->id == HIMC_COMMAND_TAKE;
}

// what a command costs of the 1000 a second; those that take long cost more
static double cost_of(himc_command_id id)
{
    switch (id) {
    case HIMC_COMMAND_TARGET: return 1;
    case HIMC_COMMAND_SCORE:
    case HIMC_COMMAND_TAKE: return 250;
    case HIMC_COMMAND_MODES:
    case HIMC_COMMAND_PLAYER:
    case HIMC_COMMAND_RESET:
    case HIMC_COMMAND_INFO:
    case HIMC_COMMAND_SUBSCRIBE:
    case HIMC_COMMAND_MAKE_DRUM: return 15;
    default: return 4;
    }
}

static void hand_on(himc_osc *osc, const osc_order *order)
{
    osc_order *slot = himc_osc_ring_slot(&osc->orders);
    if (!slot) {
        osc_counted(osc, COUNT_FREQUENT, 1);
        return;
    }
    *slot = *order;
    himc_command_copy(&slot->command, &order->command);
    himc_osc_ring_push(&osc->orders);
    osc_counted(osc, COUNT_COMMANDS, 1);
}

static void take_command(himc_osc *osc, osc_order *order)
{
    himc_error error;
    himc_command *c = &order->command;
    osc_wish wish = {.from = order->from};
    int atom;
    if (!himc_osc_afford(&osc->commands, cost_of(c->id))) {
        osc_counted(osc, COUNT_FREQUENT, 1);
    } else if (order->receiver == HIMC_PERFORMER && himc_osc_wish_from(&wish, c)) {
        osc_counted(osc, COUNT_COMMANDS, 1);
        himc_osc_wish(osc, &wish);
    } else if (order->receiver == HIMC_PERFORMER && c->id == HIMC_COMMAND_LISTEN) {
        refuse(osc, &order->from, "listen: not over the network");
    } else if (himc_command_file(c, &atom) != HIMC_FILE_NONE && !is_confined(c)) {
        refuse(osc, &order->from, "record, units and shapes from files: not over the network");
    } else if (is_confined(c) && !confine(osc, c, &error)) {
        refuse(osc, &order->from, error.text);
    } else {
        hand_on(osc, order);
    }
}

// atoms of a message; false if one is neither a number nor a word
static bool read_atoms(lo_message message, himc_atom atom[ATOMS], int *count)
{
    const char *types = lo_message_get_types(message);
    lo_arg **args = lo_message_get_argv(message);
    int n = lo_message_get_argc(message);
    *count = n < ATOMS ? n : ATOMS; // more than any command has: the parser says so
    for (int i = 0; i < *count; i++) {
        lo_type type = (lo_type)types[i];
        if (lo_is_numerical_type(type))
            atom[i] = (himc_atom){HIMC_ATOM_NUMBER, (double)lo_hires_val(type, args[i]), NULL};
        else if (lo_is_string_type(type))
            atom[i] = (himc_atom){HIMC_ATOM_SYMBOL, 0, (const char *)args[i]};
        else
            return false;
    }
    return true;
}

// "/himc/NAME" or "/membrane/DRUM/NAME"; false if it is neither
static bool read_path(const char *path, osc_order *order, const char **name)
{
    if (strncmp(path, "/himc/", 6) == 0) {
        order->receiver = HIMC_PERFORMER;
        *name = path + 6;
        return !strchr(*name, '/');
    }
    if (strncmp(path, "/membrane/", 10) != 0)
        return false;
    const char *drum = path + 10, *slash = strchr(drum, '/');
    if (!slash || slash == drum || slash - drum >= HIMC_NAME_SIZE)
        return false;
    order->receiver = HIMC_DRUM;
    snprintf(order->drum, sizeof order->drum, "%.*s", (int)(slash - drum), drum);
    *name = slash + 1;
    return !strchr(*name, '/');
}

static bool is_ours(himc_receiver receiver, const char *name)
{
    static const char *const sent[] = {"error", "pose",   "body", "targets", "strike",
                                       "beat",  "status", "head", "info"};
    if (receiver == HIMC_DRUM)
        return strcmp(name, "head") == 0;
    for (size_t i = 0; i < sizeof sent / sizeof *sent; i++)
        if (strcmp(sent[i], name) == 0)
            return true;
    return false;
}

static void take_message(himc_osc *osc, const osc_address *from, const char *path,
                         lo_message message)
{
    osc_order order = {.from = *from};
    himc_atom atom[ATOMS];
    himc_error error;
    const char *name;
    int count;
    if (!read_path(path, &order, &name))
        osc_counted(osc, COUNT_FOREIGN, 1);
    else if (!read_atoms(message, atom, &count))
        osc_counted(osc, COUNT_MALFORMED, 1);
    else if (himc_command_parse(&order.command, order.receiver, name, atom, count, &error))
        take_command(osc, &order);
    else if (is_ours(order.receiver, name))
        osc_counted(osc, COUNT_FOREIGN, 1);
    else {
        if (order.receiver == HIMC_DRUM)
            himc_error_prefix(&error, "%s", order.drum);
        refuse(osc, from, error.text);
    }
}

static void take_element(himc_osc *osc, const osc_address *from, char *data, size_t size, int depth)
{
    if (size < 16 || memcmp(data, "#bundle", 8) != 0) {
        int trouble = 0;
        lo_message message =
            size >= 8 && data[0] == '/' ? lo_message_deserialise(data, size, &trouble) : NULL;
        if (message)
            take_message(osc, from, data, message);
        else
            osc_counted(osc, COUNT_MALFORMED, 1);
        lo_message_free(message);
        return;
    }
    for (size_t at = 16; at < size;) {
        const unsigned char *b = (const unsigned char *)data + at;
        uint32_t length = 0;
        if (size - at >= 4)
            length = (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
        at += 4;
        if (length == 0 || length % 4 || at > size || length > size - at || depth == DEPTH) {
            osc_counted(osc, COUNT_MALFORMED, 1);
            return;
        }
        take_element(osc, from, data + at, length, depth + 1);
        at += length;
    }
}

// what the system dropped since the last look
static void count_overrun(himc_osc *osc, struct msghdr *m)
{
    for (struct cmsghdr *c = CMSG_FIRSTHDR(m); c; c = CMSG_NXTHDR(m, c))
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL) {
            uint32_t dropped;
            memcpy(&dropped, CMSG_DATA(c), sizeof dropped);
            osc_counted(osc, COUNT_OVERRUN, (long)(uint32_t)(dropped - osc->dropped));
            osc->dropped = dropped;
        }
}

static ssize_t next_packet(himc_osc *osc, int fd, osc_address *from, void *data, size_t size)
{
    _Alignas(struct cmsghdr) char control[256];
    struct iovec part = {data, size};
    struct msghdr m = {.msg_name = &from->at,
                       .msg_namelen = sizeof from->at,
                       .msg_iov = &part,
                       .msg_iovlen = 1,
                       .msg_control = control,
                       .msg_controllen = sizeof control};
    ssize_t got = recvmsg(fd, &m, MSG_DONTWAIT);
    if (got < 0)
        return got;
    from->size = m.msg_namelen;
    count_overrun(osc, &m);
    osc_counted(osc, COUNT_PACKETS, 1);
    return got;
}

// nothing is heard where we only send; it must not stay in the queue
static void drop_strangers(himc_osc *osc, int fd)
{
    char data[16];
    osc_address from;
    for (int i = 0; fd >= 0 && i < BATCH && next_packet(osc, fd, &from, data, sizeof data) >= 0;
         i++)
        osc_counted(osc, COUNT_FOREIGN, 1);
}

bool himc_osc_take_packets(himc_osc *osc)
{
    _Alignas(8) char data[65536];
    bool flood = false;
    for (int i = 0; osc->in >= 0 && i < BATCH; i++) {
        osc_address from = {.size = 0};
        ssize_t size = next_packet(osc, osc->in, &from, data, sizeof data);
        if (size < 0)
            break;
        if (!himc_osc_afford(&osc->packets, 1)) {
            osc_counted(osc, COUNT_FREQUENT, 1);
            flood = true;
        } else if (size % 4) {
            osc_counted(osc, COUNT_MALFORMED, 1);
        } else {
            take_element(osc, &from, data, (size_t)size, 0);
        }
    }
    drop_strangers(osc, osc->out[0]);
    drop_strangers(osc, osc->out[1]);
    return flood;
}
