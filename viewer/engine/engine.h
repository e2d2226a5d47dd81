/// engine.h: what a page asks of the performer inside it, one at a time. Memory that is handed out
/// belongs to engine.c and is good until the next call.
#ifndef VIEWER_ENGINE_H
#define VIEWER_ENGINE_H

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

#endif
