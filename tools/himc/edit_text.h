/// edit_text.h: a score's text under edit: its statements, undo, redo.
#ifndef EDIT_TEXT_H
#define EDIT_TEXT_H

#include "himc/score.h"

#include <stdio.h>

/// A score's text as statements: each has its bytes, white space before it and the `;` at its end.
/// Opaque.
typedef struct edit_text edit_text;

/// Where a change begins.
typedef struct edit_span {
    double from; ///< anything of it; below 0: everywhere
    double
        strokes[HIMC_HANDS]; ///< what is for that hand; for pushes, on which no plan rests: never
} edit_span;

/// Splits a text (copied). NULL without memory.
edit_text *edit_text_new(const char *text, himc_error *error);
void edit_text_free(edit_text *text);
/// All bytes, owned by the caller; NULL without memory.
char *edit_text_join(const edit_text *text);
/// The same for playing: `record` is left out, so that an edit overwrites no file.
char *edit_text_played(const edit_text *text);
/// True if a command of the score, of the performer or of a drum, at once or at a beat, names a
/// file; `*line` is where.
bool edit_text_names_file(const himc_score *score, int *line);

/// Gives statement `index` these words (without `;`; none removes it); one past the last adds it.
/// Words that stay keep their white space. Old and new must be a stroke, an ornament, a `nudge` or
/// a `push` at a beat. False, and nothing changed, with the reason. Words that are there already
/// change nothing.
bool edit_text_set(edit_text *text, int index, const char *words, himc_error *error);
/// Takes the last change back, or makes it again; false if there is none.
bool edit_text_undo(edit_text *text);
bool edit_text_redo(edit_text *text);
/// Takes all changes back; false if there are none.
bool edit_text_revert(edit_text *text);
/// True if the last of these calls has changed something, and has not been settled. It is to be
/// settled before the next one.
bool edit_text_is_open(const edit_text *text);
/// Keeps what the last call has changed, or takes it back as if it had never been, with what undo
/// and redo could do before; false if nothing is open.
bool edit_text_settle(edit_text *text, bool keep);
/// Changes that undo can take back.
int edit_text_changes(const edit_text *text);
/// Where what the last of these calls has changed begins: beats, or times of the take (s).
edit_span edit_text_changed(const edit_text *text);

/// Prints, as JSON fields: how many changes can be undone (`undo`) and made again (`redo`),
/// `count`, and the list `statements` of those that can be edited.
void edit_text_print(const edit_text *text, FILE *to);

#endif
