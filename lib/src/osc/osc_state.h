/// osc_state.h: what a himc_osc holds, shared by its files: osc.c (the thread), osc_host.c (the
/// audio's side), osc_ring.c (between them), osc_receive.c (packets in), osc_subscribe.c (who
/// gets what), osc_resolve.c (names of hosts), osc_send.c and osc_vmc.c (packets out).
#ifndef HIMC_OSC_STATE_H
#define HIMC_OSC_STATE_H

#include "himc/osc.h"
#include "plan/planner.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/socket.h>

#define SUBSCRIBERS 256
#define RESOLVERS 8
#define ALLOWED 32
#define HEAD_MODES 64     // amplitudes shown of a head
#define SMALL_PACKET 1400 // off loopback (bytes)
#define LARGE_PACKET 8192 // on it (bytes)
#define PACKETS 4         // that one state is cut into, at most

// wait-free, one writer, one reader; slots of one size
typedef struct osc_ring {
    char *data;
    size_t slot, count; // bytes; slots, a power of two
    _Atomic size_t written, read;
    _Atomic long lost;
} osc_ring;

bool himc_osc_ring_init(osc_ring *ring, size_t slot, size_t count);
void *himc_osc_ring_slot(osc_ring *ring); // to be filled, or NULL: full, counted
void himc_osc_ring_push(osc_ring *ring);
const void *himc_osc_ring_peek(osc_ring *ring); // oldest, or NULL
void himc_osc_ring_pop(osc_ring *ring);

typedef struct osc_address {
    struct sockaddr_storage at;
    socklen_t size;
} osc_address;

// in the order of the words of `subscribe`
typedef enum osc_what {
    OSC_POSE,
    OSC_TARGETS,
    OSC_STRIKES,
    OSC_HEAD,
    OSC_VMC,
    OSC_WHATS // anything, when unsubscribing
} osc_what;

// a subscription asked for
typedef struct osc_wish {
    char host[256];
    int port;
    osc_what what;
    double hz;
    bool remove;
    bool local;       // by the user of this machine
    bool granted;     // and by the osc before this one, to `from`
    osc_address from; // else by this one
} osc_wish;

// from host to network
typedef struct osc_pose {
    float origin[HIMC_SEGMENTS][3];      // (m)
    float orientation[HIMC_SEGMENTS][4]; // x y z w, world
    float target[HIMC_HANDS][3], tip[HIMC_HANDS][3];
} osc_pose;

typedef struct osc_head {
    char name[HIMC_NAME_SIZE];
    int count;
    float amplitude[HEAD_MODES]; // (m)
} osc_head;

typedef struct osc_drum {
    char name[HIMC_NAME_SIZE];
    float place[5]; // x y z (m), tilt (rad), radius (m)
    double hz;      // principal mode
} osc_drum;

// strikes are numbered, so that who receives them knows how many were lost on the way
typedef struct osc_strike {
    himc_strike strike;
    long number; // from 1
} osc_strike;

typedef struct osc_state {
    himc_performance_stats stats;
    double load; // share of real time
    long strikes;
} osc_state;

typedef struct osc_answer {
    osc_address to;
    bool error; // else info
    char text[HIMC_OSC_LINE];
} osc_answer;

typedef struct osc_record {
    enum {
        RECORD_POSE,
        RECORD_STRIKE,
        RECORD_BEAT,
        RECORD_HEAD,
        RECORD_DRUM,
        RECORD_STATE,
        RECORD_ANSWER,
        RECORD_WISH
    } kind;
    double time; // of the performance (s)
    double wall; // the same on the wall clock (s since 1970)
    union {
        osc_pose pose;
        osc_strike strike;
        double beat;
        osc_head head;
        osc_drum drum;
        osc_state state;
        osc_answer answer;
        osc_wish wish;
    };
} osc_record;

// from network to host
typedef struct osc_order {
    osc_address from;
    himc_receiver receiver;
    char drum[HIMC_NAME_SIZE];
    himc_command command;
} osc_order;

typedef struct osc_subscriber {
    bool used, lead; // lead: first of its address that wants more than vmc
    osc_address to;
    osc_what what;
    double hz, due;                     // (Hz; s, monotonic clock)
    double refused_since, refused_last; // (s); 0 while somebody listens
    bool local;                         // on loopback
} osc_subscriber;

// one state in OSC, cut into packets
typedef struct osc_packets {
    size_t limit, size[PACKETS];
    int count;
    uint64_t tag;
    bool bundle; // else single messages
    unsigned char data[PACKETS][LARGE_PACKET];
} osc_packets;

typedef struct osc_resolver {
    bool used;
    struct osc_lookup *lookup;
} osc_resolver;

typedef struct osc_bucket {
    double level, rate, size, last;
} osc_bucket;

enum {
    COUNT_PACKETS,
    COUNT_COMMANDS,
    COUNT_MALFORMED,
    COUNT_FOREIGN,
    COUNT_REFUSED,
    COUNT_FREQUENT,
    COUNT_OVERRUN,
    COUNT_SENT,
    COUNT_UNSENT,
    COUNT_SUBSCRIPTIONS,
    COUNTERS
};

struct himc_osc {
    osc_ring records, orders, lines;
    _Atomic bool stop;
    _Atomic int pose_hz, head_hz; // what is wanted, 0 nothing
    _Atomic long count[COUNTERS];
    int port;

    // the host's side
    double offset, next_pose, next_head, next_state, last_publish, busy;
    bool aligned;
    long strikes;    // so far
    osc_bucket work; // seconds
    unsigned revision[HIMC_DRUMS];

    // the thread's side
    pthread_t thread;
    bool running;
    int in, out[2]; // listening; sending only, IPv4 and IPv6
    bool in_loopback;
    int in_family;
    char *files; // real path, or NULL
    osc_address allowed[ALLOWED];
    int allowed_count;
    osc_subscriber subscriber[SUBSCRIBERS];
    osc_resolver resolver[RESOLVERS];
    osc_bucket packets, commands, answers;
    unsigned dropped; // the system's counter, last seen
    osc_drum drum[HIMC_DRUMS];
    int drums;
    osc_record pose;          // the last one
    osc_packets packet[2][2]; // pose, vmc; small, large
    bool packed[2][2];
};

static inline void osc_counted(himc_osc *osc, int which, long n)
{
    atomic_fetch_add_explicit(&osc->count[which], n, memory_order_relaxed);
}

// osc.c
double himc_osc_clock(int clock); // CLOCK_MONOTONIC or CLOCK_REALTIME (s)
void himc_osc_tell(himc_osc *osc, const char *format, ...) __attribute__((format(printf, 2, 3)));
void himc_osc_answer(himc_osc *osc, const osc_address *to, bool error, const char *text);
bool himc_osc_afford(osc_bucket *bucket, double cost);

// osc_address.c
bool himc_osc_address_parse(const char *host, int port, osc_address *out);
bool himc_osc_address_find(const char *host, int port, osc_address *out); // may wait for a server
void himc_osc_address_set_port(osc_address *a, int port);
bool himc_osc_address_same(const osc_address *a, const osc_address *b);
bool himc_osc_address_same_host(const osc_address *a, const osc_address *b);
bool himc_osc_address_loopback(const osc_address *a);
void himc_osc_address_print(const osc_address *a, char text[80]);

// osc_socket.c
bool himc_osc_listen(himc_osc *osc, const himc_osc_config *config, himc_error *error);
bool himc_osc_send_to(himc_osc *osc, const osc_address *to, const void *data, size_t size);
void himc_osc_read_errors(himc_osc *osc, void (*refused)(himc_osc *, const osc_address *));

// osc_receive.c
bool himc_osc_take_packets(himc_osc *osc); // true if the flood is such that a pause is due

// osc_subscribe.c
void himc_osc_wish(himc_osc *osc, const osc_wish *wish);
void himc_osc_grant(himc_osc *osc, const osc_wish *wish, const osc_address *to);
bool himc_osc_wish_from(osc_wish *wish, const himc_command *command);
void himc_osc_refused(himc_osc *osc, const osc_address *to);
void himc_osc_forget_gone(himc_osc *osc, double now);
bool himc_osc_due(osc_subscriber *s, double now);
int himc_osc_allowed_hosts(himc_osc *osc, const char *list, himc_error *error);

// osc_resolve.c
bool himc_osc_resolve(himc_osc *osc, const osc_wish *wish);
void himc_osc_resolved(himc_osc *osc);
void himc_osc_resolve_drop(himc_osc *osc);

// osc_pack.c
uint64_t himc_osc_tag(double wall);
void himc_osc_pack_begin(osc_packets *p, size_t limit, bool bundle, double wall);
void himc_osc_pack(osc_packets *p, const char *path, const char *types, ...);
void himc_osc_pack_message(osc_packets *p, const char *path, void *message);

// osc_send.c
void himc_osc_send_record(himc_osc *osc, const osc_record *record);

// osc_vmc.c
void himc_osc_vmc_pose(osc_packets *p, const osc_record *pose);
void himc_osc_vmc_strike(osc_packets *p, const himc_strike *strike, double hz);

#endif
