/// editor.h: the program `himc edit` beside this one: it changes a piece and plays it.
#ifndef VIEWER_EDITOR_H
#define VIEWER_EDITOR_H

#include "chunks.h"
#include "folder.h"

#include <sys/types.h>

#define EDITOR_KEY 32                    ///< characters of a key
#define EDITOR_LINE 4000                 ///< of a line to it (bytes); as `himc edit` takes
#define EDITOR_UPLOAD ((size_t)64 << 20) ///< of a file with its name (bytes); chosen: an hour
#define EDITOR_PIECES 8                  ///< that undo goes back to; 64 MB each at most

/// A file to be edited.
typedef struct editor_piece {
    char source[512]; ///< "" for none
    char name[128];   ///< under which a page has sent it; "": none has
    int place;        ///< of what pages have sent
} editor_piece;

/// The pieces of a page, one after the other. All zero: none.
typedef struct editor_pieces {
    editor_piece piece[EDITOR_PIECES];
    int count, at; ///< how many; the one that is edited
} editor_pieces;

/// A program that edits a piece. All zero: none.
typedef struct editor {
    editor_piece piece;
    folder *folder; ///< borrowed; of what came from pages, and of files that are being made
    pid_t process;  ///< 0: none runs
    int to, from;   ///< its standard input and output
    chunks told;    ///< what it has told since it was started
} editor;

/// A random key, hexadecimal; false with the reason.
bool editor_key(char key[EDITOR_KEY + 1], himc_error *error);
/// Compares in a time that does not depend on where they differ.
bool editor_is_key(const char *key, const char *given);

/// Asks `himc edit` whether it takes the source; if not its line is on standard error.
bool editor_check(const char *source);

/// Starts the program for the source; one that runs ends first. False with the reason.
bool editor_start(editor *e, himc_error *error);
/// Sends a line, "" to 4000 bytes without a newline; false if it is none, or not taken.
bool editor_say(const editor *e, const char *line, size_t size);
/// Reads what the program tells, as read() does, and follows it.
ssize_t editor_hear(editor *e, void *bytes, size_t most);
/// Keeps a file that came from a page (name, 0, bytes) as the source, in a place of those that
/// pages have sent (from 0), which is taken from what was there; false with the reason.
bool editor_keep(editor *e, int place, const char *bytes, size_t size, himc_error *error);
/// A place (as for editor_keep) that no piece has.
int editor_free_place(const editor_pieces *pieces);
/// Adds a piece after the one that is edited, and makes it that one. Those that followed go, and of
/// too many the second: the first one is the user's own.
void editor_add_piece(editor_pieces *pieces, const editor_piece *piece);
/// Ends the program, and with it all processes that play.
void editor_stop(editor *e);

#endif
