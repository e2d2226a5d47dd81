/// reader.h: where the reader of a document is, for read.c (notes) and direction.c (signs, words).
#ifndef HIMC_MUSICXML_READER_H
#define HIMC_MUSICXML_READER_H

#include "musicxml/instruments.h"

typedef struct music_reader {
    music *music;
    himc_error *error;
    const xml_node *root, *list; ///< the part's entry in the part-list
    int part, bar, first;        ///< of the part the first note
    music_instruments instruments;
    double divisions, at, last, end; ///< the cursor, the last note, the bar's end (beats)
    double tail, tail_end;           ///< begin and end of the bar's last note or rest (beats)
    double time;                     ///< length of a bar (beats) ...
    int beats, unit;                 ///< ... and its metre, as far as a score can say it
    int transpose;                   ///< (semitones)
    int fifths;                      ///< of the key: sharps, below 0 flats
    bool line[MUSIC_LINES_MAX];      ///< a pedal's, which has begun
    bool ramp[MUSIC_LINES_MAX];      ///< the same of a ritardando or accelerando
    int head;                        ///< the first note of a chord, -1: it is left out
    int wavy;                        ///< 1 + the voice under a trill's wavy line, or 0
    int lane;                        ///< of a direction
    bool slashed, slashes;           ///< slashes stand for notes; in this bar
    int repeated;                    ///< bars back that a sign repeats; 0: none
    char hands[16];                  ///< of the next notes, 1 + himc_hand each, ...
    int hand, hand_count, hand_lane; ///< ... the next of them; the lane of those before it
    bool niente;                     ///< the open hairpin ends in nothing
    bool failed;
} music_reader;

static inline bool himc_music_yes(const xml_node *node, const char *attribute)
{
    return himc_xml_has(node, attribute, "yes");
}

/// direction.c. Of a note or a direction, see music_note.
int himc_music_lane(const xml_node *node);
void himc_music_sign(music_reader *r, double beat, music_meaning meaning, double value);
/// `own`: the part is played; tempi and jumps are of all parts.
void himc_music_direction(music_reader *r, const xml_node *direction, bool own);
void himc_music_sound(music_reader *r, const xml_node *sound, double beat, bool dynamic_too);
/// False if there is none that is known. `before`: words before it in one sign, "più".
bool himc_music_dynamics(music_reader *r, const xml_node *dynamics, double beat,
                         const char *before);

#endif
