/// sound_file.h: sound files, in the format that a name's ending says.
#ifndef SOUND_FILE_H
#define SOUND_FILE_H

#include "himc/base.h"

#include <sndfile.h>
#include <stdio.h>

/// Begins a sound file named `path` in `stream`: WAV with 32-bit floats if the name has no ending.
/// NULL with the reason: an ending of no format that this libsndfile can write, or a rate (Hz) or
/// number of channels that the format does not have.
SNDFILE *sound_file_begin(FILE *stream, const char *path, int rate, int channels,
                          himc_error *error);

/// What the file can hold (samples of one channel); infinite where the format has no end.
double sound_file_room(const char *path, int channels);

/// True if samples beyond 1 .. -1 are cut off.
bool sound_file_clips(const char *path);

#endif
