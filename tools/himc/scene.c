/// scene.c: the container: eight bytes, then chunks, each with its kind and its size, so that a
/// reader skips what it does not know and a file that was cut short is good up to there.
///
/// Motion is smooth, so a column is stored as the second differences of its rounded values: small
/// numbers, whose high bytes are nearly all zero. They go plane by plane, all lowest bytes of a
/// column first, through deflate. The arithmetic is modulo 2^32, so nothing can overflow, and each
/// chunk begins anew, so none needs another. The sound is Ogg Vorbis, which every browser's own
/// decoder but the oldest reads; or WAV, ten times as large, where libsndfile has no Vorbis.
#include "scene.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>
#ifdef HIMC_NO_SNDFILE // in a page, which plays the sound itself
typedef void SNDFILE;
#else
#include <sndfile.h>
#endif

enum {
    ROWS = 1024,     // in a chunk; chosen: 4 s, long against what a chunk costs beside its rows
    LIVE_ROWS = 250, // chosen: packed within a block of 2 ms
    FRAMES = 128     // of heads in a chunk; chosen: the same of one drum
};
#define VORBIS_QUALITY 0.7 // chosen: about 1 MB for a minute in stereo
#define STEADY 1e-6        // (s) rows this near to their period belong to one chunk; chosen

/// Bytes that grow; `failed` stays once memory has run out.
typedef struct bytes {
    unsigned char *data;
    size_t size, room, at; // `at`: where the sound is written
    bool failed;
} bytes;

typedef struct head_frame {
    double time;
    float scale;
    int drum, modes;
    signed char q[SCENE_MODES], s[SCENE_MODES];
} head_frame;

struct scene_writer {
    scene_config config;
    int32_t *row; // (ROWS, columns)
    int rows;
    double start, period, last; // of the rows that wait (s)
    head_frame head[FRAMES];
    int heads;
    bytes events, chunk, packed, sound;
    SNDFILE *file;
    int trouble; // errno of the first write that failed
};

static unsigned char *grow(bytes *b, size_t more)
{
    if (b->size + more > b->room && !b->failed) {
        size_t room = 2 * (b->size + more) + 4096;
        unsigned char *data = realloc(b->data, room);
        b->failed = !data;
        if (data) {
            b->data = data;
            b->room = room;
        }
    }
    return b->failed ? NULL : b->data + b->size;
}

static void put(bytes *b, const void *from, size_t size)
{
    unsigned char *at = grow(b, size);
    if (!at)
        return;
    memcpy(at, from, size);
    b->size += size;
}

static void put_number(bytes *b, uint64_t value, int size)
{
    unsigned char text[8];
    for (int i = 0; i < size; i++)
        text[i] = (unsigned char)(value >> (8 * i));
    put(b, text, (size_t)size);
}

static void put_double(bytes *b, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_number(b, bits, 8);
}

static void put_float(bytes *b, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_number(b, bits, 4);
}

static void write_all(scene_writer *s, const void *from, size_t size)
{
    errno = 0;
    if (!s->trouble && fwrite(from, 1, size, s->config.stream) != size)
        s->trouble = errno ? errno : EIO;
}

static void write_chunk(scene_writer *s, const char kind[4], const bytes *from)
{
    if (from->failed || from->size > UINT32_MAX) {
        s->trouble = s->trouble ? s->trouble : ENOMEM;
        return;
    }
    unsigned char head[8];
    memcpy(head, kind, 4);
    for (int i = 0; i < 4; i++)
        head[4 + i] = (unsigned char)(from->size >> (8 * i));
    write_all(s, head, sizeof head);
    write_all(s, from->data, from->size);
}

// the same, deflated; the bytes are taken
static void write_packed(scene_writer *s, const char kind[4], bytes *from)
{
    bytes *to = &s->packed;
    uLongf size = compressBound((uLong)from->size);
    to->size = 0;
    if (from->failed || !grow(to, size) ||
        compress2(to->data, &size, from->data, (uLong)from->size,
                  s->config.live ? Z_BEST_SPEED : Z_BEST_COMPRESSION) != Z_OK)
        to->failed = true;
    to->size = size;
    write_chunk(s, kind, to);
    from->size = 0;
}

// --- events

static void write_events(scene_writer *s)
{
    if (!s->events.size)
        return;
    put(&s->events, "]", 1);
    write_packed(s, "json", &s->events);
}

void scene_event(scene_writer *s, const char *format, ...)
{
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    put(&s->events, s->events.size ? ",\n{" : "[{", s->events.size ? 3 : 2);
    if (length >= 0 && grow(&s->events, (size_t)length + 1)) {
        vsnprintf((char *)s->events.data + s->events.size, (size_t)length + 1, format, again);
        s->events.size += (size_t)length;
    }
    va_end(again);
    put(&s->events, "}", 1);
}

char *scene_text(char *out, size_t size, const char *text)
{
    char *to = out, *end = out + size - 7; // room for one character more and the zero
    for (; *text && to < end; text++) {
        unsigned char c = (unsigned char)*text;
        if (c < 0x20)
            to += snprintf(to, 7, "\\u%04x", c);
        else {
            if (c == '"' || c == '\\')
                *to++ = '\\';
            *to++ = *text;
        }
    }
    // a character of several bytes is not cut in two
    while (*text && to > out && ((unsigned char)*text & 0xC0) == 0x80)
        text--, to--;
    *to = 0;
    return out;
}

// --- rows

// low bytes of the column's residuals, then the next, up to the high ones
static void put_column(bytes *b, const int32_t *row, int rows, int columns)
{
    unsigned char *at = grow(b, 4 * (size_t)rows);
    uint32_t before = 0, slope = 0;
    for (int i = 0; i < rows && at; i++) {
        uint32_t value = (uint32_t)row[(size_t)i * (size_t)columns], step = value - before,
                 bend = step - slope;
        uint32_t folded = bend << 1 ^ (bend & 0x80000000u ? UINT32_MAX : 0); // 0 -1 1 -2 ...
        for (int plane = 0; plane < 4; plane++)
            at[plane * rows + i] = (unsigned char)(folded >> (8 * plane));
        before = value;
        slope = step;
    }
    b->size += at ? 4 * (size_t)rows : 0;
}

static void write_rows(scene_writer *s)
{
    write_events(s); // they stand before what they explain
    if (!s->rows)
        return;
    put_double(&s->chunk, s->start);
    put_double(&s->chunk, s->period);
    put_number(&s->chunk, (uint32_t)s->rows, 4);
    for (int i = 0; i < s->config.columns; i++)
        put_column(&s->chunk, s->row + i, s->rows, s->config.columns);
    write_packed(s, "rows", &s->chunk);
    s->rows = 0;
}

static int32_t rounded(double value, double step)
{
    if (isnan(value)) // what a pipeline does not have
        return 0;
    return (int32_t)fmax(-INT32_MAX, fmin(INT32_MAX, nearbyint(value / step)));
}

void scene_row(scene_writer *s, double time, const double *value)
{
    if (s->rows == (s->config.live ? LIVE_ROWS : ROWS) ||
        (s->rows > 1 && fabs(time - s->last - s->period) > STEADY))
        write_rows(s);
    if (s->rows == 0)
        s->start = time;
    if (s->rows == 1)
        s->period = time - s->start;
    int32_t *row = s->row + (size_t)s->rows * (size_t)s->config.columns;
    for (int i = 0; i < s->config.columns; i++)
        row[i] = rounded(value[i], s->config.column[i].step);
    s->last = time;
    s->rows++;
}

// --- heads

static void write_heads(scene_writer *s)
{
    write_events(s);
    if (!s->heads)
        return;
    put_number(&s->chunk, (uint32_t)s->heads, 4);
    for (const head_frame *f = s->head; f < s->head + s->heads; f++) {
        put_double(&s->chunk, f->time);
        put_float(&s->chunk, f->scale);
        put_number(&s->chunk, (uint32_t)f->drum, 2);
        put_number(&s->chunk, (uint32_t)f->modes, 2);
        put(&s->chunk, f->q, (size_t)f->modes);
        put(&s->chunk, f->s, (size_t)f->modes);
    }
    write_packed(s, "ring", &s->chunk);
    s->heads = 0;
}

void scene_head(scene_writer *s, int drum, double time, const scene_ring *ring)
{
    double most = 0;
    if (s->heads == FRAMES)
        write_heads(s);
    head_frame *f = &s->head[s->heads++];
    *f = (head_frame){.time = time, .drum = drum, .modes = ring->modes};
    for (int i = 0; i < f->modes; i++)
        most = fmax(most, fmax(fabs(ring->q[i]), fabs(ring->s[i])));
    f->scale = (float)(most / 127);
    for (int i = 0; i < f->modes && most > 0; i++) {
        f->q[i] = (signed char)nearbyint(127 * ring->q[i] / most);
        f->s[i] = (signed char)nearbyint(127 * ring->s[i] / most);
    }
}

// --- sound

#ifdef HIMC_NO_SNDFILE

static bool open_sound(const scene_writer *s, himc_error *error)
{
    return himc_error_set(error, "the scene's sound at %d Hz: no library for it", s->config.rate);
}

static void sf_close(SNDFILE *file)
{
    (void)file;
}

void scene_sound(scene_writer *s, const float *frames, int n)
{
    (void)s, (void)frames, (void)n;
}

#else

static sf_count_t sound_size(void *user)
{
    return (sf_count_t)((bytes *)user)->size;
}

static sf_count_t sound_seek(sf_count_t offset, int whence, void *user)
{
    bytes *b = user;
    sf_count_t from = whence == SEEK_SET   ? 0
                      : whence == SEEK_CUR ? (sf_count_t)b->at
                                           : (sf_count_t)b->size;
    b->at = (size_t)(from + offset);
    return from + offset;
}

static sf_count_t sound_read(void *to, sf_count_t count, void *user)
{
    (void)to, (void)count, (void)user;
    return 0;
}

static sf_count_t sound_write(const void *from, sf_count_t count, void *user)
{
    bytes *b = user;
    size_t end = b->at + (size_t)count;
    if (end > b->size && !grow(b, end - b->size))
        return 0;
    memcpy(b->data + b->at, from, (size_t)count);
    b->at = end;
    b->size = end > b->size ? end : b->size;
    return count;
}

static sf_count_t sound_tell(void *user)
{
    return (sf_count_t)((bytes *)user)->at;
}

static bool open_sound(scene_writer *s, himc_error *error)
{
    int rate = s->config.rate;
    SF_VIRTUAL_IO memory = {sound_size, sound_seek, sound_read, sound_write, sound_tell};
    SF_INFO info = {.samplerate = rate,
                    .channels = s->config.channels,
                    .format = SF_FORMAT_OGG | SF_FORMAT_VORBIS};
    double quality = VORBIS_QUALITY;
    SF_FORMAT_INFO ogg = {.format = SF_FORMAT_OGG};
    // a libsndfile without Ogg does not list it; sf_format_check allows it all the same
    if (sf_command(NULL, SFC_GET_FORMAT_INFO, &ogg, sizeof ogg) != 0)
        info.format = SF_FORMAT_WAV | SF_FORMAT_PCM_16;
    s->file = sf_open_virtual(&memory, SFM_WRITE, &info, &s->sound);
    if (!s->file)
        return himc_error_set(error, "the scene's sound at %d Hz: %s", rate, sf_strerror(NULL));
    sf_command(s->file, SFC_SET_VBR_ENCODING_QUALITY, &quality, sizeof quality);
    sf_command(s->file, SFC_SET_CLIPPING, NULL, SF_TRUE);
    return true;
}

void scene_sound(scene_writer *s, const float *frames, int n)
{
    if (sf_writef_float(s->file, frames, n) != n)
        s->sound.failed = true;
}

#endif

// --- the whole

void scene_more(scene_writer *s, FILE *stream)
{
    bytes all = {0};
    unsigned char *at;
    write_rows(s);
    rewind(stream);
    while ((at = grow(&all, 65536))) {
        size_t got = fread(at, 1, 65536, stream);
        if (!got)
            break;
        all.size += got;
    }
    all.failed |= ferror(stream) != 0;
    write_chunk(s, "more", &all);
    free(all.data);
}

static void free_writer(scene_writer *s)
{
    if (s->file)
        sf_close(s->file);
    bytes *all[] = {&s->events, &s->chunk, &s->packed, &s->sound};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]->data);
    free(s->row);
    free(s);
}

static void begin(scene_writer *s)
{
    const scene_config *c = &s->config;
    bytes names = {0};
    for (int i = 0; i < c->columns; i++) {
        char one[96];
        int length = snprintf(one, sizeof one, "%s[\"%s\",%g]", i ? "," : "", c->column[i].name,
                              c->column[i].step);
        put(&names, one, (size_t)length);
    }
    put(&names, "", 1);
    if (!c->bare)
        write_all(s, "himcscn\x01", 8);
    scene_event(
        s,
        "\"event\":\"scene\",\"time\":0,\"version\":%d,\"program\":\"himc %s\",\"name\":\"%s\","
        "\"sound\":%d,\"channels\":%d,\"columns\":[%s]",
        SCENE_VERSION, himc_version(), c->name, c->rate, c->channels,
        names.failed ? "" : (char *)names.data);
    free(names.data);
}

scene_writer *scene_open(const scene_config *config, himc_error *error)
{
    scene_writer *s = calloc(1, sizeof *s);
    int32_t *row = s ? malloc(sizeof *row * ROWS * (size_t)config->columns) : NULL;
    if (!row) {
        free(s);
        himc_error_set(error, "out of memory");
        return NULL;
    }
    s->config = *config;
    s->row = row;
    if (config->channels && !open_sound(s, error)) {
        free_writer(s);
        return NULL;
    }
    begin(s);
    return s;
}

void scene_flush(scene_writer *s)
{
    write_rows(s);
    write_heads(s);
}

bool scene_close(scene_writer *s, himc_error *error)
{
    scene_flush(s);
    if (s->file) {
        sf_close(s->file);
        s->file = NULL;
        write_chunk(s, "snd ", &s->sound);
    }
    int trouble = s->trouble;
    free_writer(s);
    return !trouble || himc_error_set(error, "the scene cannot be written: %s", strerror(trouble));
}
