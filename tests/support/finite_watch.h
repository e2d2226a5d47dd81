/// finite_watch.h: whether all that a performance shows is finite: its rows of motion, the plans of
/// the tips ahead, and the packets of every stream, which are sent to a socket here and read.
///
/// finite_watch_begin, then finite_watch_played after each call of himc_performance_process.
#ifndef HIMC_TESTS_FINITE_WATCH_H
#define HIMC_TESTS_FINITE_WATCH_H

#include "himc/osc.h"
#include "osc/stepped.h"
#include "performance/performance_state.h"
#include "plan/planner_state.h"

#include <arpa/inet.h>
#include <math.h>
#include <netinet/in.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define PLANNED_AHEAD 0.4 // (s) the planner's horizon is .45 s

typedef struct finite_watch {
    himc_performance *p;
    himc_osc *osc;
    int ear;
    double clock;       ///< of the himc_osc (s)
    long rows, packets; ///< seen
    const char *bad;    ///< the first that was not finite, or NULL
} finite_watch;

static inline bool all_finite(const void *doubles, size_t bytes)
{
    const double *x = doubles;
    double sum = 0;
    for (size_t i = 0; i < bytes / sizeof *x; i++)
        sum += x[i] - x[i];
    return sum == 0;
}

static inline void watch_row(void *user, const himc_motion_row *row)
{
    finite_watch *w = user;
    himc_motion_row all = *row;
    w->rows++;
    if (w->p->settings.control.mode == HIMC_PIPELINE_IK) { // without forces
        memset(all.acceleration, 0, sizeof all.acceleration);
        memset(all.torque, 0, sizeof all.torque);
        memset(all.power, 0, sizeof all.power);
        memset(all.co_contraction, 0, sizeof all.co_contraction);
        memset(&all.energy, 0, sizeof all.energy);
        memset(&all.root_force, 0, sizeof all.root_force);
        memset(&all.root_moment, 0, sizeof all.root_moment);
        memset(&all.seat_force, 0, sizeof all.seat_force);
        memset(all.foot_force, 0, sizeof all.foot_force);
    }
    if (!(all.root_force.z > 0)) { // nothing presses on the seat
        memset(&all.root_center, 0, sizeof all.root_center);
        all.root_friction = 0;
    }
    if (!w->bad && !all_finite(row->target, sizeof row->target))
        w->bad = "a target";
    if (!w->bad && !all_finite(row->tip, sizeof row->tip))
        w->bad = "a tip";
    if (!w->bad && !all_finite(row->joint, sizeof row->joint))
        w->bad = "a joint";
    if (!w->bad && !all_finite(&all, sizeof all))
        w->bad = "a row of motion";
}

static inline double watch_clock(void *user)
{
    return *(double *)user;
}

static inline bool osc_atoms_finite(const char *tags, const unsigned char *data)
{
    for (; *tags; tags++) {
        uint32_t bits = (uint32_t)data[0] << 24 | data[1] << 16 | data[2] << 8 | data[3];
        float value;
        memcpy(&value, &bits, sizeof value);
        if (*tags == 'f' && !isfinite(value))
            return false;
        if (*tags == 's')
            data += (strlen((const char *)data) + 4) / 4 * 4;
        else
            data += *tags == 'b' ? 4 + (bits + 3) / 4 * 4 : 4;
    }
    return true;
}

// of a message, or of all in a bundle
static inline bool osc_packet_finite(const unsigned char *data, size_t size)
{
    if (size < 8 || memcmp(data, "#bundle", 8) != 0) {
        const char *path = (const char *)data, *tags = path + (strlen(path) + 4) / 4 * 4;
        return osc_atoms_finite(tags + 1, (const unsigned char *)tags + (strlen(tags) + 4) / 4 * 4);
    }
    for (size_t at = 16; at + 4 <= size;) {
        size_t n = (size_t)data[at] << 24 | (size_t)data[at + 1] << 16 | (size_t)data[at + 2] << 8 |
                   data[at + 3];
        if (!osc_packet_finite(data + at + 4, n))
            return false;
        at += 4 + n;
    }
    return true;
}

/// False if the network cannot be used.
static inline bool finite_watch_begin(finite_watch *w, himc_performance *p)
{
    static const char *const stream[] = {"pose", "targets", "strikes", "head", "vmc"};
    himc_error error;
    himc_command c;
    char text[64];
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof at;
    *w = (finite_watch){.p = p, .ear = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)};
    osc_clock clock = {watch_clock, watch_clock, &w->clock};
    w->osc = himc_osc_new_stepped(&(himc_osc_config){.port = -1}, &clock, &error);
    if (!w->osc || bind(w->ear, (struct sockaddr *)&at, sizeof at) != 0 ||
        getsockname(w->ear, (struct sockaddr *)&at, &size) != 0)
        return false;
    for (size_t i = 0; i < sizeof stream / sizeof *stream; i++) {
        snprintf(text, sizeof text, "subscribe 127.0.0.1 %d %s", ntohs(at.sin_port), stream[i]);
        if (!himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) ||
            !himc_osc_command(w->osc, &c, &error))
            return false;
    }
    himc_osc_step(w->osc);
    himc_performance_on_motion(p, watch_row, w);
    himc_performance_on_tick(p, himc_osc_tick, w->osc);
    return true;
}

/// An event that has been taken from the performance.
static inline void finite_watch_event(finite_watch *w, const himc_event *event)
{
    himc_osc_event(w->osc, event);
}

/// The plans of the tips, now and ahead.
static inline void finite_watch_plans(finite_watch *w)
{
    double t = himc_clock_time(&w->p->clock);
    for (int i = 0; !w->bad && i < 2 * HIMC_HANDS; i++) {
        himc_target s =
            himc_motion_planned(w->p->motion, (himc_hand)(i / 2), t + (i % 2) * PLANNED_AHEAD);
        if (!himc_target_finite(&s))
            w->bad = "a planned target";
    }
    for (int i = 0; !w->bad && !w->p->motion->track && i < HIMC_HANDS; i++)
        if (w->p->motion->planner->hand[i].plan.end < t)
            w->bad = "the end of a plan";
}

/// After `seconds` have been played; `bad` then says what was not finite, if anything.
static inline void finite_watch_played(finite_watch *w, double seconds)
{
    _Alignas(8) unsigned char data[65536];
    w->clock += seconds;
    himc_osc_publish(w->osc, w->p, 0);
    himc_osc_step(w->osc);
    for (ssize_t n; (n = recv(w->ear, data, sizeof data - 1, 0)) > 0; w->packets++) {
        data[n] = 0;
        if (!w->bad && !osc_packet_finite(data, (size_t)n))
            w->bad = "a packet";
    }
    finite_watch_plans(w);
}

static inline void finite_watch_end(finite_watch *w)
{
    himc_performance_on_motion(w->p, NULL, NULL);
    himc_performance_on_tick(w->p, NULL, NULL);
    himc_osc_free(w->osc);
    close(w->ear);
}

#endif
