/// edit_text.h: a score's text under edit: its statements, undo, redo.
#ifndef EDIT_TEXT_H
#define EDIT_TEXT_H

#include "himc/score.h"

#include <stdio.h>

/// A score's text as statements: each has its bytes, white space before it and the `;` at its end.
/// Opaque.
typedef struct edit_text edit_text;

/// Splits a text (copied). NULL without memory.
edit_text *edit_text_new(const char *text, himc_error *error);
void edit_text_free(edit_text *text);
/// All bytes, owned by the caller; NULL without memory.
char *edit_text_join(const edit_text *text);
/// True if a statement names a file.
bool edit_text_names_file(const edit_text *text);

/// Replaces statement `index` by `words` (without `;`; "" removes it); one past the last adds it.
/// Old and new must be a stroke, an ornament, a `nudge` or a `push` at a beat. False, and nothing
/// changed, with the reason.
bool edit_text_set(edit_text *text, int index, const char *words, himc_error *error);
/// Takes the last change back, or makes it again; false if there is none.
bool edit_text_undo(edit_text *text);
bool edit_text_redo(edit_text *text);
/// What the last of these three calls has changed begins here: a beat, or a time of the take (s).
double edit_text_changed_from(const edit_text *text);

/// Prints, as JSON fields: can_undo, can_redo, count, and the list `statements` of those that can
/// be edited.
void edit_text_print(const edit_text *text, FILE *to);

#endif
