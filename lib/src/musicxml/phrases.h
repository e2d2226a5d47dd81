/// phrases.h: texts of a score that are a pattern, not words of a table (names.h).
#ifndef HIMC_MUSICXML_PHRASES_H
#define HIMC_MUSICXML_PHRASES_H

#include "musicxml/names.h"

/// Of a text in small letters: a metronome mark ("♩. = 72", "q = 96", "c. 80"), MUSIC_TEMPO, or two
/// notes that are equal ("♩ = ♪"), MUSIC_TEMPO_SHARE. False if there is none.
bool himc_music_metronome(const char *text, music_meaning *meaning, double *value);
/// The way of a cresc. or dim. whose syllables are apart ("cre - scen - do"), or the first of them
/// alone; 0: it is none.
int himc_music_syllables(const char *text);
/// How often a repeat is played: "Play 4 times", "4x", "3 volte"; 0: the text is no such number.
int himc_music_times(const char *text);
/// Hands of a row of notes, at most `most`: "R L R R" or "RLRR", 1 + himc_hand each; 0: other text.
/// Small letters beside capitals are grace notes, which have no hand of their own here.
int himc_music_hands(const char *words, int most, char *hands);

#endif
