/// sound_file.c: a table of formats. Which of them libsndfile can write is asked when it runs, as
/// it may have been built without some.
#define _POSIX_C_SOURCE 200809L // fileno
#include "sound_file.h"

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

/// What the 32-bit sizes in a WAV file can count, headers taken off (bytes).
#define BYTES_MAX (UINT32_MAX - 4096.0)

// libsndfile's since 1.1; a program compiled with an older one may run with it
enum { MPEG = 0x230000, LAYER_III = 0x0082 };

typedef struct sound_format {
    const char *ending;
    int format;
    bool has_end; ///< its sizes are numbers of 32 bits
    bool clips;
} sound_format;

// the first is that of a name without an ending; FLAC has no floats, the others lose what is not
// heard
static const sound_format formats[] = {
    {".wav", SF_FORMAT_WAV | SF_FORMAT_FLOAT, true, false},
    {".w64", SF_FORMAT_W64 | SF_FORMAT_FLOAT, false, false},
    {".aiff", SF_FORMAT_AIFF | SF_FORMAT_FLOAT, true, false},
    {".flac", SF_FORMAT_FLAC | SF_FORMAT_PCM_24, false, true},
    {".ogg", SF_FORMAT_OGG | SF_FORMAT_VORBIS, false, true},
    {".mp3", MPEG | LAYER_III, false, true},
};
#define FORMATS (sizeof formats / sizeof *formats)

static const sound_format *find_format(const char *path)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    for (size_t i = 0; dot && i < FORMATS; i++)
        if (strcasecmp(dot, formats[i].ending) == 0)
            return &formats[i];
    return dot ? NULL : &formats[0];
}

static bool can_write(const sound_format *format)
{
    int count = 0;
    sf_command(NULL, SFC_GET_FORMAT_MAJOR_COUNT, &count, sizeof count);
    for (int i = 0; i < count; i++) {
        SF_FORMAT_INFO info = {.format = i};
        sf_command(NULL, SFC_GET_FORMAT_MAJOR, &info, sizeof info);
        if (info.format == (format->format & SF_FORMAT_TYPEMASK))
            return true;
    }
    return false;
}

static bool refuse(const char *path, himc_error *error)
{
    char list[64] = "";
    for (size_t i = 0; i < FORMATS; i++)
        if (can_write(&formats[i]))
            snprintf(list + strlen(list), sizeof list - strlen(list), " %s", formats[i].ending);
    return himc_error_set(error, "%s: sound is written to a file that ends with%s", path, list);
}

SNDFILE *sound_file_begin(FILE *stream, const char *path, int rate, int channels, himc_error *error)
{
    const sound_format *format = find_format(path);
    if (!format || !can_write(format)) {
        refuse(path, error);
        return NULL;
    }
    SF_INFO info = {.samplerate = rate, .channels = channels, .format = format->format};
    SNDFILE *file = sf_open_fd(fileno(stream), SFM_WRITE, &info, SF_FALSE);
    if (!file) {
        himc_error_set(error, "%s: cannot be written with %d Hz and %d channels: %s", path, rate,
                       channels, sf_strerror(NULL));
        return NULL;
    }
    // libsndfile's PEAK chunk holds the date, and two renders would differ
    sf_command(file, SFC_SET_ADD_PEAK_CHUNK, NULL, SF_FALSE);
    sf_command(file, SFC_SET_CLIPPING, NULL, SF_TRUE); // where integers are written
    return file;
}

double sound_file_room(const char *path, int channels)
{
    const sound_format *format = find_format(path);
    return format && !format->has_end ? INFINITY
                                      : floor(BYTES_MAX / (double)sizeof(float) / channels);
}

bool sound_file_clips(const char *path)
{
    const sound_format *format = find_format(path);
    return format && format->clips;
}
