/// engine.h: what a page asks of the performer inside it, one at a time. Memory that is handed out
/// belongs to engine.c and is good until the next call.
#ifndef VIEWER_ENGINE_H
#define VIEWER_ENGINE_H

#include "himc/base.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __wasm__
#define PAGE_CALL(name) __attribute__((export_name(#name))) name
#else
#define PAGE_CALL(name) name
#endif

enum { PAGE_INPUT = 8192 }; ///< (bytes) chosen: more than the longest command

/// Where the page writes a line or a name, ended by 0 (PAGE_INPUT).
char *PAGE_CALL(page_input)(void);
/// Why the last call has returned false.
const char *PAGE_CALL(page_error)(void);
himc_error *page_reason(void); ///< the same, to be set

/// Another performance at `rate` (Hz), of the file whose name is the input ("": none), at rest.
/// False, and the one before goes on, with the reason.
bool PAGE_CALL(page_load)(double rate);
/// Carries the input out, a command as in Pure Data. False, and nothing changed, with the reason.
bool PAGE_CALL(page_command)(void);
/// Computes `samples` (a multiple of 64, at most 9600) of both ears; `wall` is now (s).
const float *PAGE_CALL(page_play)(int samples, double wall);
/// The time of the sample that comes next, as poses and strikes are told (ms).
double PAGE_CALL(page_told)(void);
/// The news since the last call, in the layout of viewer/scene_encode.c ...
const uint8_t *PAGE_CALL(page_frame)(void);
/// ... and how many bytes of it.
size_t PAGE_CALL(page_frame_size)(void);
/// True where a piece that is played offline ends; to be asked after each 0.2 s.
bool PAGE_CALL(page_is_over)(void);

// A piece under edit (edit.c). One instance of the module has its text: lines in and frames out, on
// the standard output, are those of `himc edit` (docs/viewer.md); a frame `play` is for the page:
// the times (f64) of an edit_span, then the text to be played. Another instance plays it: a copy of
// its memory is a copy of the whole state.

/// The piece in the file that is the input, as it was left. False with the reason.
bool PAGE_CALL(page_edit_open)(void);
/// Obeys the input, a line. False with the reason if nothing can be played any more.
bool PAGE_CALL(page_edit_line)(void);
/// Hears of the playing: the input is the kind of a frame, or `fail` and why. False as before.
bool PAGE_CALL(page_edit_hear)(void);
/// False until the text has been played or taken back: the next line has to wait.
bool PAGE_CALL(page_edit_proved)(void);

#define PAGE_TEXT "himc-text" ///< file with the text that is played
/// That text at rest. The input is its name and, in a line of its own, the file that gets the
/// motion as a take, if any. False with the reason.
bool PAGE_CALL(page_piece_begin)(void);
/// Plays from now on. False with the reason.
bool PAGE_CALL(page_piece_start)(void);
/// Takes the text's strokes: 1. 0 with the reason; -1 if the plan may rest already on what differs.
int PAGE_CALL(page_piece_exchange)(void);
/// Until when the plan of a hand (himc_hand) rests on strokes, if their beats and places stay (s of
/// the score).
double PAGE_CALL(page_piece_rests_to)(int hand);
/// A fifth of a second, as frames; false where the piece ends.
bool PAGE_CALL(page_piece_cell)(void);
/// Tells the rest, and writes the take. False with the reason.
bool PAGE_CALL(page_piece_end)(void);

#endif
