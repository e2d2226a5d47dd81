/// edit_play.h: plays a piece under edit offline, and again from shortly before each change.
#ifndef EDIT_PLAY_H
#define EDIT_PLAY_H

#include "edit_text.h"
#include "himc/mocap.h"

#include <stdint.h>

#define EDIT_ALL ((edit_span){-1, {-1, -1}}) ///< a piece changed everywhere

/// A piece and the processes that play it. Opaque.
typedef struct edit_play edit_play;

/// A message from the playing: four letters and bytes.
typedef struct edit_frame {
    char kind[5];
    uint32_t size;
    const unsigned char *bytes; ///< (size) borrowed until the next call
} edit_frame;

/// `name` begins errors, `options` are for takes; both borrowed. NULL with the reason.
edit_play *edit_play_new(const char *name, const himc_take_options *options, himc_error *error);
/// Ends all processes.
void edit_play_free(edit_play *play);

/// Plays `text` (a score); what the last call had begun is given up. The text differs from the last
/// one in strokes, nudges and pushes alone, from `changed` on (s from beat 0), or everywhere.
/// `record` is a file that gets the motion as a take, or NULL. False with
/// the reason if the playing is lost.
bool edit_play_start(edit_play *play, const char *text, edit_span changed, const char *record,
                     himc_error *error);
/// A descriptor that can be read when there is a frame.
int edit_play_descriptor(const edit_play *play);
/// True if there is one already, whatever the descriptor says.
bool edit_play_holds(const edit_play *play);
/// Waits for the next frame: `json`, `rows`, `head`, as in a scene; `pcm `: number of the first
/// sample (u32), hash of this part's exact bits (u64), 16-bit samples of two channels; `from`: all
/// that follows replaces what there was from this time (f64, s) on; `over`: the piece is complete;
/// `fail`: it cannot be played, with the reason. False with the reason if the playing is lost.
bool edit_play_next(edit_play *play, edit_frame *frame, himc_error *error);

#endif
