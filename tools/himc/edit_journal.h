/// edit_journal.h: the changes of a piece under edit, in a file, so that no end of a program or of
/// a page loses them.
#ifndef EDIT_JOURNAL_H
#define EDIT_JOURNAL_H

#include "himc/base.h"

#include <stdint.h>
#include <stdio.h>

/// A sum (FNV-1a) that goes on over more bytes; begins with UINT64_C(0xcbf29ce484222325).
uint64_t edit_hash(uint64_t sum, const void *bytes, size_t size);

/// A journal. All zero: none.
typedef struct edit_journal {
    char path[4096]; ///< its file; "": changes are not kept
    FILE *stream;    ///< owned; NULL before the first change
    uint64_t hash;   ///< of the source's bytes
    char *base;      ///< owned; the text before all changes
    char *lines;     ///< owned; of the journal that was found, each ends with \n; NULL for none
    char *old;       ///< owned; the text to which they belong, if it is another one than `base`
    bool damaged;    ///< the journal that was found cannot be read, but kept
} edit_journal;

/// Finds the journal of `source`, beside it, or, if its folder cannot be written or the file has
/// been `sent` under that `name` by a page, in the user's folder for states. `text` is the score.
/// False with the reason if changes cannot be kept.
bool edit_journal_open(edit_journal *journal, const char *source, const char *name, bool sent,
                       const char *text, himc_error *error);
/// Adds a line (without newline); it is on the disk when this returns. False with the reason.
bool edit_journal_add(edit_journal *journal, const char *line, himc_error *error);
/// Keeps a text of another journal as a score beside it, whose name becomes `kept`; the journal
/// itself if `text` is NULL.
bool edit_journal_keep(const edit_journal *journal, const char *text, char kept[4096],
                       himc_error *error);
/// Forgets the journal that was found: the next change begins another one.
void edit_journal_forget(edit_journal *journal);
void edit_journal_close(edit_journal *journal);

#endif
