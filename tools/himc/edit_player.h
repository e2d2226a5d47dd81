/// edit_player.h: plays a piece under edit cell by cell, and tells it as frames (edit_play.h).
#ifndef EDIT_PLAYER_H
#define EDIT_PLAYER_H

#include "cli.h"
#include "himc/mocap.h"
#include "scene_record.h"

enum { EDIT_RATE = 48000 }; ///< (Hz)

/// A piece that is played.
typedef struct edit_player {
    const char *name;                 ///< begins errors; borrowed, as the next
    const himc_take_options *options; ///< for takes
    FILE *to;                         ///< of frames
    himc_performance *performance;    ///< owned
    scene_record *record;             ///< owned
    cli_ending ending;
    himc_performance
        *spare; ///< owned; the piece once more, whose drums a changed text is read with
} edit_player;

/// A frame.
void edit_player_put(edit_player *player, const char *kind, const void *bytes, size_t size);
/// The piece from its start, at rest; `record` is a file that gets the motion as a take, or NULL.
/// False with the reason.
bool edit_player_begin(edit_player *player, const char *text, const char *record,
                       himc_error *error);
/// Takes the strokes of another text. False with the reason; *late, and nothing has changed, if the
/// plan may rest already on what differs.
bool edit_player_exchange(edit_player *player, const char *text, bool *late, himc_error *error);
/// The time of a cell, and all that happens in it, as frames.
void edit_player_cell(edit_player *player);
/// Where a cell ends: true if nothing more can be heard.
bool edit_player_is_over(edit_player *player);
/// Tells the rest, and frees all. False with the reason if a recording could not be written.
bool edit_player_end(edit_player *player, himc_error *error);

#endif
