/// export.h: a score as notation: MusicXML or MIDI.
#ifndef HIMC_MUSICXML_EXPORT_H
#define HIMC_MUSICXML_EXPORT_H

#include "base/text.h"
#include "midi/smf.h"

/// The notes of a score, each of its own part (choice) and key, for MIDI or for MusicXML; strokes
/// and places that it does not have are counted in `said`. `bars` (and one more, which begins where
/// the last ends) are those that its comments say. Free with himc_midi_file_free. False
/// with one line.
bool himc_music_notes(midi_file *file, const himc_score *score, bool midi, himc_error *error);

/// True if a bar of such a file, before another one, is shorter than its metre.
static inline bool himc_music_is_short(const midi_bar *bar)
{
    return bar[1].beat - bar->beat < 4.0 * bar->beats / bar->unit - 1e-6;
}

/// write.c: notes as MusicXML 4.0, a part for each choice; false without memory.
bool himc_music_write(himc_text_lines *out, const midi_file *file, const char *title);

/// write_midi.c: notes as a MIDI file of format 1; false without memory.
bool himc_music_write_midi(himc_text_lines *out, const midi_file *file);

#endif
