/// room.h: what the walls of a room return of a drum's sound, to two ears.
#ifndef HIMC_ROOM_H
#define HIMC_ROOM_H

#include "himc/base.h"

/// A room.
typedef struct himc_walls {
    double seconds; ///< reverberation time T60 below 1 kHz (s), 0 .. 10; 0: no walls
    double volume;  ///< (m^3), 20 .. 100000; a larger room is softer
} himc_walls;

/// Walls around a performer as it is made. Chosen: a stage, where a listener 2 m away hears a
/// little more of the room than of the drum.
#define HIMC_WALLS_USUAL \
    (himc_walls)         \
    {                    \
        2.0, 1500        \
    }

#define HIMC_ROOM_LINES 32
#define HIMC_ROOM_RUN 32 ///< (samples) at a time; chosen: less than the shortest delay at 8 kHz
#ifndef HIMC_ROOM_RATE
#define HIMC_ROOM_RATE 192000 ///< (Hz) the highest
#endif
#define HIMC_ROOM_LONGEST 77                                              ///< (ms) of a delay
#define HIMC_ROOM_LINE (HIMC_ROOM_LONGEST * (HIMC_ROOM_RATE / 1000) + 16) ///< (samples), and more
#define HIMC_ROOM_EMPTY INT32_MAX

/// What a change of the room changes.
typedef struct himc_room_form {
    double out;                                          ///< of what an ear hears of each delay
    double take[HIMC_ROOM_LINES], keep[HIMC_ROOM_LINES]; ///< y = keep y + take x, of a wall
} himc_room_form;

/// The room of a listener. 0: no walls.
typedef struct himc_room {
    bool on;
    himc_room_form from, to; ///< it fades from one to the other
    double faded, step;      ///< 0 .. 1, and a sample's part of it
    double rate;
    int silent, forget; ///< samples since a sound entered, or EMPTY; and as many make it so
    int delay[HIMC_ROOM_LINES], at[HIMC_ROOM_LINES]; ///< (samples); in it, of the coming sample
    double y[HIMC_ROOM_LINES];
    double line[HIMC_ROOM_LINES][HIMC_ROOM_LINE];
} himc_room;

/// Sets the walls, at a sample rate. They change over in 5 ms.
HIMC_RT void himc_room_set(himc_room *room, const himc_walls *walls, double rate);
/// Nobody hears it any more: it ends at once.
HIMC_RT void himc_room_leave(himc_room *room);
/// True if it sounds, or may.
static inline bool himc_room_heard(const himc_room *room)
{
    return room->on || room->faded < 1;
}
/// True if it is empty, and nothing about to change.
static inline bool himc_room_at_rest(const himc_room *room)
{
    return !himc_room_heard(room) || (room->faded == 1 && room->silent == HIMC_ROOM_EMPTY);
}
/// Of the next n samples (at most HIMC_ROOM_RUN), those that may be asked for at once.
HIMC_RT int himc_room_steady(const himc_room *room, int n);
/// So many samples at both ears (2 rows), from those of a drum at 1 m, to the left and to the right
/// (2 rows).
HIMC_RT void himc_room_hear(himc_room *room, int n, double *const *drum, double *const *ears);

#endif
