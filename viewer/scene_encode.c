/// scene_encode.c: the news for one reader as one binary frame.
///
/// A frame is a sequence of blocks, each a multiple of 8 bytes, in the byte order of the machine
/// (little-endian everywhere this runs; the page reads so):
///
///     u32 kind, u32 bytes that follow the head, f64 time (ms), the sender's, or of an event
///     when it came, then
///     1 pose   key[80], u32 segments known, u32 targets known, f32[20][7], f32[2][3], f32[12]
///     2 drum   key[80], name[32], u32 placed, f32[7] place, u32 modes, u32 0, f32[64]
///     3 event  JSON, padded with spaces
///     4 sound  key[80], u32 first sample, u32 rate, u32 channels, u32 samples, i16[512]
#include "scene.h"

#include <string.h>

enum {
    HEAD = 16,
    POSE = SCENE_KEY + 8 + 4 * (SCENE_SEGMENTS * 7 + SCENE_HANDS * 3 + SCENE_SUPPORT),
    DRUM = SCENE_KEY + SCENE_NAME + 4 * (1 + 7 + 2 + SCENE_MODES),
    SOUND = SCENE_KEY + 4 * 4 + 2 * SCENE_SAMPLES
};

_Static_assert(SCENE_SEGMENTS <= 32, "a bit for each segment");
_Static_assert(POSE % 8 == 0 && DRUM % 8 == 0 && SOUND % 8 == 0,
               "blocks keep the alignment of doubles");
// all events may be left for the next frame, all poses and drums must fit into one
_Static_assert(SCENE_PERFORMERS *(HEAD + POSE) + SCENE_DRUMS * (HEAD + DRUM) + HEAD + SCENE_TEXT +
                       8 <=
                   SCENE_FRAME_MAX,
               "one frame holds the scene");

typedef struct writer {
    uint8_t *at;
} writer;

static void put(writer *p, const void *bytes, size_t size)
{
    memcpy(p->at, bytes, size);
    p->at += size;
}

static void put_u32(writer *p, uint32_t value)
{
    put(p, &value, sizeof value);
}

static void put_head(writer *p, uint32_t kind, size_t bytes, double time)
{
    double milliseconds = 1e3 * time;
    put_u32(p, kind);
    put_u32(p, (uint32_t)bytes);
    put(p, &milliseconds, sizeof milliseconds);
}

static void put_pose(writer *p, const scene_performer *from)
{
    put_head(p, 1, POSE, from->told);
    put(p, from->key, sizeof from->key);
    put_u32(p, from->known);
    put_u32(p, from->targets);
    put(p, from->body, sizeof from->body);
    put(p, from->target, sizeof from->target);
    put(p, from->support, sizeof from->support);
}

static void put_drum(writer *p, const scene_drum *drum)
{
    put_head(p, 2, DRUM, drum->told);
    put(p, drum->key, sizeof drum->key);
    put(p, drum->name, sizeof drum->name);
    put_u32(p, drum->placed);
    put(p, drum->place, sizeof drum->place);
    put_u32(p, drum->modes);
    put_u32(p, 0);
    put(p, drum->amplitude, sizeof drum->amplitude);
}

static void put_event(writer *p, const scene_event *e)
{
    static const char spaces[8] = "        ";
    size_t length = strlen(e->text), padding = (8 - length % 8) % 8;
    put_head(p, 3, length + padding, e->time);
    put(p, e->text, length);
    put(p, spaces, padding);
}

static void put_sound(writer *p, const scene_sound *s)
{
    put_head(p, 4, SOUND, s->told);
    put(p, s->key, sizeof s->key);
    put_u32(p, s->first);
    put_u32(p, s->rate);
    put_u32(p, s->channels);
    put_u32(p, s->count);
    put(p, s->sample, sizeof s->sample);
}

scene_reader scene_reader_new(const scene *s)
{
    return (scene_reader){.events = s->events, .sounds = s->sounds};
}

size_t scene_encode(const scene *s, scene_reader *reader, double now, uint8_t *frame)
{
    writer p = {frame};
    for (int i = 0; i < SCENE_PERFORMERS; i++) {
        const scene_performer *performer = &s->performer[i];
        if (reader->performer[i] != performer->version && now - performer->received < SCENE_SILENCE)
            put_pose(&p, performer);
        reader->performer[i] = performer->version;
    }
    for (int i = 0; i < SCENE_DRUMS; i++) {
        const scene_drum *drum = &s->drum[i];
        if (reader->drum[i] != drum->version && now - drum->received < SCENE_SILENCE)
            put_drum(&p, drum);
        reader->drum[i] = drum->version;
    }
    if (s->sounds - reader->sounds > SCENE_SOUNDS)
        reader->sounds = s->sounds - SCENE_SOUNDS;
    while (reader->sounds < s->sounds &&
           p.at + HEAD + SOUND + HEAD + SCENE_TEXT + 8 <= frame + SCENE_FRAME_MAX)
        put_sound(&p, &s->sound[reader->sounds++ % SCENE_SOUNDS]);
    // a reader that the ring has overtaken continues with the oldest event
    if (s->events - reader->events > SCENE_EVENTS)
        reader->events = s->events - SCENE_EVENTS;
    while (reader->events < s->events && p.at + HEAD + SCENE_TEXT + 8 <= frame + SCENE_FRAME_MAX)
        put_event(&p, &s->event[reader->events++ % SCENE_EVENTS]);
    return (size_t)(p.at - frame);
}
