/// names.h: what the words of a score mean: names of instruments, and instructions to the player.
#ifndef HIMC_MUSICXML_NAMES_H
#define HIMC_MUSICXML_NAMES_H

#include "midi/smf.h"

#define MUSIC_NO_KEY (-1)  ///< of a drum set, whose notes say which drum they are
#define MUSIC_ANY_KEY (-2) ///< of percussion, whose words may say it, too

/// The instrument of a name in English, German, French or Italian, or of an instrument-sound id:
/// whose part it is, and of drums the key (midi/kit.c). MIDI_ANY if it is none that is played.
midi_choice himc_music_instrument(const char *name, int *key);

/// The same of words that tell the player to change to an instrument ("muta in Xilofono", "nimmt
/// Kl. Trommel"), or, `bare`, that are a name and no more.
midi_choice himc_music_change(const char *words, int *key, bool *bare);

/// Where the name in words is, in front of brackets and "with ..."; returns its length.
size_t himc_music_named(const char *words, size_t *begin);

/// True of a name that says an instrument, known or not; false of none, and of a program's sampler.
bool himc_music_names(const char *name);

/// Of `count` drums of one sort, whose common key it is, the key of the one of that index from the
/// highest; other keys stay.
int himc_music_of_sort(int key, int index, int count);

/// The timpano of a name as `himc export` writes it, "second timpano": 1 low .. 4 high; else 0.
int himc_music_drum(const char *name);

/// The notehead of a drum's note at a spot beyond its head: x, a cross-stick; slashed, a rim shot;
/// circle-x, a click; triangle, the shell. "" of the others.
const char *himc_music_notehead(himc_spot spot);

/// What a word or a sign asks for.
typedef enum music_meaning {
    MUSIC_DYNAMIC,    ///< value: 0 .. 1
    MUSIC_ATTACK,     ///< sf, sfz: of this note alone
    MUSIC_FORTEPIANO, ///< value: the dynamic after the attack, and twice the attack's step if not f
    MUSIC_LOUDER,     ///< value: steps above the dynamic before, or below 0
    MUSIC_WEDGE,      ///< value: 1 crescendo, -1 diminuendo, 0 its end
    MUSIC_GROWING,    ///< value: 1 or -1, -7 to nothing; as a word, to the next dynamic
    MUSIC_TEMPO,      ///< value: (beats per minute)
    MUSIC_TEMPO_WORD, ///< the same, by custom
    MUSIC_TEMPO_AGAIN, ///< value: the beat whose tempo returns, after a jump back
    MUSIC_TEMPO_SHARE, ///< value: of the tempo before
    MUSIC_SWING,       ///< value: share of the first of two eighths, 1 more: of two 16ths
    MUSIC_TEMPO_RAMP,  ///< value: share of the tempo at its end
    MUSIC_TEMPO_BACK,  ///< value: 0 a tempo, 1 tempo primo
    MUSIC_FERMATA,     ///< value: length of the note (beats)
    MUSIC_SPOT,        ///< value: himc_spot
    MUSIC_SPOT_HERE,   ///< the same, of this note alone
    MUSIC_RING,        ///< value: 1 rings on, -1 damped: this note; -key: the drum of that key here
    MUSIC_RING_ALWAYS, ///< from here on; value 0: as usual
    MUSIC_DAMP,        ///< what sounds is damped here
    MUSIC_PEDAL,       ///< a vibraphone's goes up here
    MUSIC_MALLET,      ///< value: 0 soft, 1 medium, 2 hard, 3 wood
    MUSIC_MUFFLE,      ///< value: 1 or 0
    MUSIC_WIRES,       ///< value: 1 or 0
    MUSIC_HAND,        ///< value: himc_hand, of the note here
    MUSIC_MEASURED,    ///< value: 1 tremolos are measured, 0 not
    MUSIC_TUNING,      ///< value: 100 from + to, as midi_order has them
    MUSIC_GLISS,       ///< the same, heard; up to the end of its line, if it has one
    MUSIC_GLISS_END,
    MUSIC_DA_CAPO,
    MUSIC_DAL_SEGNO,
    MUSIC_TO_CODA,
    MUSIC_FINE
} music_meaning;

/// Finds what a text asks for; at most `most` of `meaning` and `value`. Returns how many.
int himc_music_words(const char *text, int most, music_meaning *meaning, double *value);

/// The sign of a dynamic by its element's name ("mf", "sfz"), or by words ("subito p"); false if
/// there is none.
bool himc_music_dynamic(const char *name, music_meaning *meaning, double *value);

#endif
