/// subscribe.h: the subscriptions: which address gets which state, how often, and who may ask for
/// it. Sends the states too. Belongs to the network thread, but for `pose_hz`, `head_hz`,
/// `sounds` and `count`, which any thread may read.
#ifndef HIMC_OSC_SUBSCRIBE_H
#define HIMC_OSC_SUBSCRIBE_H

#include "osc/encode.h"
#include "osc/network.h"
#include "system/ring.h"

#define SUBSCRIPTIONS 256 // chosen: 50 receivers of all kinds
#define LOOKUPS 8         // chosen: names looked up at once
#define ALLOWED_HOSTS 32  // chosen: hosts of --allow

/// In the order of the words of `subscribe`.
typedef enum osc_stream {
    STREAM_POSE,
    STREAM_TARGETS,
    STREAM_STRIKES,
    STREAM_HEAD,
    STREAM_VMC,
    STREAM_SOUND,
    STREAM_ERRORS, ///< lines that refuse commands of anyone
    STREAMS,
    STREAM_ANY = STREAMS ///< when unsubscribing
} osc_stream;

/// A change of the table that somebody asked for: `subscribe` or `unsubscribe`.
typedef struct osc_change {
    char host[256];
    int port;
    osc_stream stream;
    double hz;
    bool remove;
    bool local;       ///< by the user of this machine
    bool granted;     ///< by the himc_osc before this one, for the address `from` ...
    double expires;   ///< ... until then, as below
    osc_address from; ///< the sender, unless local or granted
} osc_change;

/// A state of the performer, from the host to the network.
typedef struct osc_state {
    enum {
        STATE_POSE,
        STATE_STRIKE,
        STATE_BEAT,
        STATE_MISSED,
        STATE_HEAD,
        STATE_DRUM,
        STATE_STATUS,
        STATE_SOUND
    } kind;
    double time; ///< of the performance (s)
    double wall; ///< the same on the wall clock (s since 1970)
    union {
        osc_pose pose;
        osc_strike strike;
        double beat;
        himc_strike missed;
        osc_head head;
        osc_drum drum;
        osc_status status;
        osc_sound sound;
    };
} osc_state;

typedef struct osc_subscription {
    bool used;
    bool first; ///< first of its address that is not vmc: gets the states sent once per address
    bool local; ///< on loopback
    osc_address to;
    osc_stream stream;
    double hz, due;                             ///< (Hz; s, monotonic clock)
    double unreachable_since, unreachable_last; ///< (s); 0 while somebody listens
    double expires;                             ///< unless renewed (s); 0: never
} osc_subscription;

/// So much a second, so much at once.
typedef struct osc_bucket {
    double level, rate, size, last;
} osc_bucket;

/// A full one.
static inline osc_bucket himc_osc_bucket(double rate, double size, double now)
{
    return (osc_bucket){.level = size, .rate = rate, .size = size, .last = now};
}

/// Takes `cost` from the bucket; false if it has not so much.
static inline bool himc_osc_afford(osc_bucket *b, double now, double cost)
{
    b->level += b->rate * (now - b->last);
    b->level = b->level > b->size ? b->size : b->level;
    b->last = now;
    if (b->level < cost)
        return false;
    b->level -= cost;
    return true;
}

/// The bytes that a host elsewhere may still be sent.
typedef struct osc_allowance {
    osc_address host;
    osc_bucket bytes;
} osc_allowance;

typedef struct osc_subscriptions {
    _Atomic int pose_hz, head_hz; ///< highest rates asked for (Hz), 0 none
    _Atomic int sounds;           ///< subscriptions of the sound
    _Atomic int count;

    osc_network *network; ///< borrowed, as are the next two
    osc_counters *counts; ///< of the whole himc_osc
    system_ring *lines;   ///< for the user of this machine
    osc_subscription subscription[SUBSCRIPTIONS];
    osc_allowance allowance[SUBSCRIPTIONS];
    struct osc_pending {
        osc_lookup *lookup; ///< or NULL
        osc_change change;
    } pending[LOOKUPS];
    osc_address allowed[ALLOWED_HOSTS];
    int allowed_count;
    osc_drum drum[HIMC_DRUMS]; ///< as last sent
    int drums;
    osc_packets packets[2][2]; ///< of a pose, a vmc pose; small, large
    bool encoded[2][2];        ///< of the pose being sent
} osc_subscriptions;

/// The change that a command asks for; false if it is another command.
bool himc_osc_change_from(osc_change *change, const himc_command *command);

/// Hosts, separated by commas, that anyone may subscribe for; may wait for a name server.
bool himc_osc_allow(osc_subscriptions *s, const char *hosts, himc_error *error);
/// Makes a change, or begins to look up its host; false with one line if it is refused.
bool himc_osc_subscribe(osc_subscriptions *s, const osc_change *change, double now,
                        himc_error *error);
/// Makes the changes of which the look-up is over.
void himc_osc_subscribe_found(osc_subscriptions *s, double now);
void himc_osc_subscriptions_free(osc_subscriptions *s);

/// This machine, or a host of himc_osc_allow.
bool himc_osc_trusted(const osc_subscriptions *s, const osc_address *host);
/// True if the host may get so many bytes more this second, which are then taken from it; else the
/// packets are counted as capped.
bool himc_osc_allows(osc_subscriptions *s, const osc_address *to, double bytes, int packets,
                     double now);
/// Sends a state to its subscribers, and the counters with a status; `now` on the monotonic clock
/// (s).
void himc_osc_deliver(osc_subscriptions *s, const osc_state *state, const himc_osc_counts *counts,
                      double now);
/// The next subscriber of refusals after `one` (NULL: the first), or NULL.
const osc_subscription *himc_osc_errors_next(const osc_subscriptions *s,
                                             const osc_subscription *one);
/// Reads the reports of addresses where nobody listens; forgets those that stay so, and
/// subscriptions that were not renewed in time.
void himc_osc_forget(osc_subscriptions *s, double now);

/// A line for the user of this machine.
void himc_osc_tell(system_ring *lines, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
