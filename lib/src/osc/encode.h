/// encode.h: the performer's state as OSC packets. Values in, bytes out: no socket, no clock.
#ifndef HIMC_OSC_ENCODE_H
#define HIMC_OSC_ENCODE_H

#include "himc/osc.h"

#include <stdint.h>

#define HEAD_MODES 64     // chosen: modes sent of a head; 64 floats fit a small packet
#define SOUND_FRAMES 240  // of sound in a packet; chosen: 5 ms, which fit a small packet in stereo
#define SMALL_PACKET 1400 // off loopback (bytes); below Ethernet's 1500 with all headers
#define LARGE_PACKET 8192 // on loopback (bytes); chosen: a whole pose, bundled
#define PACKETS 4         // chosen: one state fills at most 4 packets (a VMC pose fills 2)

typedef struct osc_pose {
    float origin[HIMC_SEGMENTS][3];                  ///< (m)
    float orientation[HIMC_SEGMENTS][4];             ///< x y z w, world
    float target[HIMC_HANDS][3], tip[HIMC_HANDS][3]; ///< (m)
    bool sits;                                       ///< on a pelvis that is free
    float support[4][3]; ///< forces of seat, left and right foot (N), centre of pressure (m)
} osc_pose;

typedef struct osc_head {
    char name[HIMC_NAME_SIZE];
    int count;
    float amplitude[HEAD_MODES]; ///< (m)
} osc_head;

typedef struct osc_drum {
    char name[HIMC_NAME_SIZE];
    float place[7]; ///< x y z (m), tilt (rad), radius (m), of a rectangle length and width (m)
    double hz;      ///< principal mode (Hz)
} osc_drum;

typedef struct osc_sound {
    uint32_t first; ///< sample, modulo 2^32
    int rate;       ///< (Hz)
    int channels;   ///< 1 if only the first one sounds, else 2
    float sample[SOUND_FRAMES][2];
} osc_sound;

/// Strikes are numbered, so that a receiver knows how many were lost on the way.
typedef struct osc_strike {
    himc_strike strike;
    long number; ///< from 1
} osc_strike;

typedef struct osc_status {
    himc_performance_stats stats;
    double load; ///< share of real time
    long strikes;
} osc_status;

/// Packets being written: a bundle cut into packets, or single messages, a packet each.
typedef struct osc_packets {
    size_t limit, size[PACKETS]; ///< (bytes)
    int count;
    uint64_t time_tag;
    bool bundle;
    unsigned char data[PACKETS][LARGE_PACKET];
} osc_packets;

/// NTP's time of a wall clock's (s since 1970): seconds since 1900 in the upper 32 bits, the
/// fraction in the lower.
uint64_t himc_osc_time_tag(double wall);

/// Begins a state as of `wall` (s since 1970).
void himc_osc_encode_begin(osc_packets *p, size_t limit, bool bundle, double wall);
void himc_osc_encode_pose(osc_packets *p, const osc_pose *pose);
void himc_osc_encode_targets(osc_packets *p, const osc_pose *pose);
void himc_osc_encode_strike(osc_packets *p, const osc_strike *strike);
/// Beat (-1: a hit), hand, drum, and when it was due (s).
void himc_osc_encode_missed(osc_packets *p, const himc_strike *missed);
void himc_osc_encode_beat(osc_packets *p, double beat);
void himc_osc_encode_head(osc_packets *p, const osc_head *head);
/// The sound as 16-bit numbers, highest byte first; what is beyond 1.0 is cut off.
void himc_osc_encode_sound(osc_packets *p, const osc_sound *sound);
void himc_osc_encode_drum(osc_packets *p, const osc_drum *drum);
void himc_osc_encode_status(osc_packets *p, const osc_status *status,
                            const himc_osc_counts *counts);
void himc_osc_encode_line(osc_packets *p, bool error, const char *text);

/// The same for programs that show avatars (Virtual Motion Capture protocol); `time` of the
/// performance (s).
void himc_osc_encode_vmc_pose(osc_packets *p, const osc_pose *pose, double time);
/// A strike as a note; `hz` is the principal mode of its drum (Hz).
void himc_osc_encode_vmc_strike(osc_packets *p, const himc_strike *strike, double hz);

#endif
