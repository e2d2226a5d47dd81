/// edit_session.h: a piece under edit: its text, what was changed before, and the lines and frames
/// of `himc edit` (docs/viewer.md), wherever they come from and go to.
#ifndef EDIT_SESSION_H
#define EDIT_SESSION_H

#include "edit_journal.h"
#include "edit_play.h"
#include "edit_text.h"

#define EDIT_LARGEST ((size_t)64 << 20) ///< of a text (bytes); as himc_score_load

/// A piece under edit.
typedef struct edit_session {
    const char *source; ///< borrowed, as the next
    const char *name;   ///< for people: that of the source, or under which it was sent
    bool sent;          ///< from a page
    bool confined;      ///< the score may name no file
    himc_take_options take;
    edit_text *text;
    edit_journal journal;
    himc_error restored, unkept; ///< a line about the journal for the page, or ""
    himc_error held;             ///< a line about what is not carried out in an edit, or ""
    edit_play *play;
    bool played;   ///< once, at least a part
    bool unproved; ///< the text has not been played yet, nor failed; its last change is open
} edit_session;

/// Reads the source, if not `only_check` also what was changed before. False with the reason, and
/// to be closed in any case.
bool edit_session_open(edit_session *session, bool only_check, himc_error *error);
void edit_session_close(edit_session *session);
/// Obeys a line, but for `take`. False with the reason, and *fatal if nothing can be played any
/// more.
bool edit_session_obey(edit_session *session, const char *line, bool *fatal, himc_error *error);
/// Follows a frame of the playing; one that says `fail` takes the last change back. False with the
/// reason if nothing can be played any more.
bool edit_session_hear(edit_session *session, const edit_frame *frame, himc_error *error);
/// A source by the name that people know.
void edit_session_name(const edit_session *session, himc_error *error);

/// A frame on the standard output.
void edit_session_put(const char *kind, const void *bytes, size_t size);
/// A line of JSON about the edit; `line` is what it answers, or NULL.
void edit_session_tell(const char *event, const char *text, const char *line);
/// A file for the page.
void edit_session_put_file(const char *name, const char *bytes, size_t size);

#endif
