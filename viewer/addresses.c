/// addresses.c: one table of addresses.
///
///     /himc/body      segment x y z qw qx qy qz       joint (m), orientation
///     /himc/targets   hand x y z                      (m)
///     /himc/support   x y z of seat, left foot, right foot (N), centre of pressure (m)
///     /himc/strike    time hand drum x y velocity force duration nuance ...
///     /himc/beat      beat
///     /himc/sound     first sample, rate, channels, blob (16 bits, highest byte first)
///     /himc/status    name value ...
///     /himc/pose      (allowed before the bodies, without effect)
///     /membrane/NAME/head    amplitude ...            (m), in the order of Bessel's zeros
///     /membrane/NAME/place   x y z tilt radius [length width]  (m, rad)
///     /viewer/camera, /viewer/show, ...               for the page: see docs/viewer.md
///
/// A performer that shares its port with others puts a name into its addresses, /himc/NAME/body.
/// Numbers may have any numeric OSC type but must be finite. Types are written n for a number, s
/// for a word, * for any further atoms.
#include "addresses.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LARGEST_COORDINATE 1000.0 // (m); chosen: anything larger is an error of the sender
#define LARGEST_FORCE 1e6         // (N); chosen: the same

static const char *const segments[SCENE_SEGMENTS] = {SKELETON_SEGMENT_NAMES};

/// A message with its sender.
typedef struct received {
    scene *s;
    char key[SCENE_KEY];
    char name[SCENE_NAME]; // the middle of the address: a performer's or drum's name
    lo_message message;
    const char *types;
    lo_arg **args;
    int count;
    scene_time time;
} received;

/// /group/what or /group/NAME/what
typedef struct address {
    const char *group, *what, *types;
    bool (*act)(received *h); // false if malformed
} address;

// liblo aligns atoms to 4 bytes only, so members of its union must not be read directly
static const char *text(const received *h, int i)
{
    return (const char *)h->args[i];
}

static double number(const received *h, int i)
{
    return (double)lo_hires_val((lo_type)h->types[i], h->args[i]);
}

static bool is_number(char type)
{
    return type == LO_FLOAT || type == LO_DOUBLE || type == LO_INT32 || type == LO_INT64;
}

static bool is_string(char type)
{
    return type == LO_STRING || type == LO_SYMBOL;
}

// types as in the table, numbers finite
static bool types_match(const received *h, const char *wanted)
{
    int i = 0;
    for (; wanted[i] && wanted[i] != '*'; i++)
        if (i >= h->count ||
            (wanted[i] == 's' ? !is_string(h->types[i])
                              : !is_number(h->types[i]) || !isfinite(number(h, i))))
            return false;
    return wanted[i] == '*' || i == h->count;
}

static bool in_range(const received *h, int first, int count)
{
    for (int i = first; i < first + count; i++)
        if (fabs(number(h, i)) > LARGEST_COORDINATE)
            return false;
    return true;
}

static int find_hand(const char *name)
{
    return strcmp(name, "left") == 0 ? 0 : strcmp(name, "right") == 0 ? 1 : -1;
}

static int find_segment(const char *name)
{
    for (int i = 0; i < SCENE_SEGMENTS; i++)
        if (strcmp(name, segments[i]) == 0)
            return i;
    return -1;
}

static bool on_body(received *h)
{
    int segment = find_segment(text(h, 0));
    float body[7];
    double norm = 0;
    for (int i = 0; i < 7; i++)
        body[i] = (float)number(h, 1 + i);
    for (int i = 3; i < 7; i++)
        norm += (double)body[i] * (double)body[i];
    if (segment < 0 || !in_range(h, 1, 3) || norm < 0.5 || norm > 2)
        return false;
    for (int i = 3; i < 7; i++)
        body[i] /= (float)sqrt(norm);
    scene_performer *p = scene_find_performer(h->s, h->key, h->time.now);
    if (p)
        scene_set_body(p, segment, body, h->time);
    return true;
}

static bool on_pose(received *h)
{
    (void)h;
    return true;
}

static bool on_targets(received *h)
{
    int hand = find_hand(text(h, 0));
    if (hand < 0 || !in_range(h, 1, 3))
        return false;
    scene_performer *p = scene_find_performer(h->s, h->key, h->time.now);
    for (int i = 0; p && i < 3; i++)
        p->target[hand][i] = (float)number(h, 1 + i);
    if (p)
        p->targets |= UINT32_C(1) << hand;
    return true;
}

static bool on_support(received *h)
{
    float support[SCENE_SUPPORT];
    for (int i = 0; i < SCENE_SUPPORT; i++) {
        if (fabs(number(h, i)) > (i < SCENE_SUPPORT - 3 ? LARGEST_FORCE : LARGEST_COORDINATE))
            return false;
        support[i] = (float)number(h, i);
    }
    scene_performer *p = scene_find_performer(h->s, h->key, h->time.now);
    if (p)
        scene_set_support(p, support);
    return true;
}

static bool on_strike(received *h)
{
    char drum[SCENE_NAME], nuance[SCENE_NAME];
    if ((find_hand(text(h, 1)) < 0 && strcmp(text(h, 1), "foot") != 0) || !in_range(h, 3, 2))
        return false;
    scene_word(drum, sizeof drum, text(h, 2));
    scene_word(nuance, sizeof nuance, text(h, 8));
    scene_add_event(
        h->s, h->time.now,
        "{\"event\":\"strike\",\"from\":\"%s\",\"told\":%.3f,\"time\":%.6f,"
        "\"hand\":\"%s\",\"drum\":\"%s\",\"x\":%.5f,"
        "\"y\":%.5f,\"velocity\":%.4g,\"force\":%.5g,\"duration\":%.5g,\"nuance\":\"%s\"}",
        h->key, 1e3 * h->time.told, number(h, 0), text(h, 1), drum, number(h, 3), number(h, 4),
        number(h, 5), number(h, 6), number(h, 7), nuance);
    return true;
}

static bool on_beat(received *h)
{
    scene_add_event(h->s, h->time.now, "{\"event\":\"beat\",\"from\":\"%s\",\"beat\":%.6g}", h->key,
                    number(h, 0));
    return true;
}

// all atoms as the elements of a JSON array; false if JSON cannot express one of them
static bool json_list(const received *h, char *out, size_t size)
{
    size_t used = 0;
    for (int i = 0; i < h->count; i++) {
        char atom[64];
        if (is_string(h->types[i])) {
            char clean[48];
            scene_word(clean, sizeof clean, text(h, i));
            snprintf(atom, sizeof atom, "\"%s\"", clean);
        } else if (is_number(h->types[i]) && isfinite(number(h, i)))
            snprintf(atom, sizeof atom, "%.7g", number(h, i));
        else
            return false;
        int n = snprintf(out + used, size - used, "%s%s", i ? "," : "", atom);
        if (n < 0 || (size_t)n >= size - used)
            return false;
        used += (size_t)n;
    }
    return true;
}

static bool on_status(received *h)
{
    char values[1000] = "";
    if (!json_list(h, values, sizeof values))
        return false;
    scene_add_event(h->s, h->time.now, "{\"event\":\"status\",\"from\":\"%s\",\"values\":[%s]}",
                    h->key, values);
    return true;
}

static bool on_view(received *h)
{
    char values[1000] = "", what[SCENE_NAME];
    if (!json_list(h, values, sizeof values))
        return false;
    scene_word(what, sizeof what, h->name);
    scene_add_event(h->s, h->time.now, "{\"event\":\"view\",\"what\":\"%s\",\"values\":[%s]}", what,
                    values);
    return true;
}

static bool on_head(received *h)
{
    for (int i = 0; i < h->count; i++)
        if (!is_number(h->types[i]) || !isfinite(number(h, i)) || fabs(number(h, i)) > 1)
            return false;
    scene_drum *d = scene_find_drum(h->s, h->key, h->name, h->time.now);
    if (!d)
        return true;
    d->modes = (uint32_t)(h->count < SCENE_MODES ? h->count : SCENE_MODES);
    d->told = h->time.told;
    for (int i = 0; i < SCENE_MODES; i++)
        d->amplitude[i] = i < h->count ? (float)number(h, i) : 0;
    d->version++;
    return true;
}

static bool on_place(received *h)
{
    double radius = number(h, 4);
    bool sides = h->count > 5; // of a rectangle, or 0 of a disc
    if (!in_range(h, 0, 3) || fabs(number(h, 3)) > 2 || radius < 0.02 || radius > 2)
        return false;
    if (sides &&
        !(h->count == 7 && is_number(h->types[5]) && is_number(h->types[6]) && number(h, 5) >= 0 &&
          number(h, 5) <= 4 && number(h, 6) >= 0 && number(h, 6) <= 4))
        return false;
    scene_drum *d = scene_find_drum(h->s, h->key, h->name, h->time.now);
    if (!d)
        return true;
    for (int i = 0; i < 7; i++)
        d->place[i] = i < 5 || sides ? (float)number(h, i) : 0;
    d->placed = true;
    d->told = h->time.told;
    d->version++;
    return true;
}

static bool on_sound(received *h)
{
    if (h->count != 4 || strcmp(h->types, "iiib") != 0)
        return false;
    lo_blob blob = (lo_blob)h->args[3];
    const unsigned char *from = lo_blob_dataptr(blob);
    uint32_t count = lo_blob_datasize(blob) / 2;
    double rate = number(h, 1), channels = number(h, 2);
    if (rate < 8000 || rate > 192000 || (channels != 1 && channels != 2) || count > SCENE_SAMPLES)
        return false;
    scene_sound *s = &h->s->sound[h->s->sounds++ % SCENE_SOUNDS];
    *s = (scene_sound){.told = h->time.told,
                       .first = (uint32_t)(int64_t)number(h, 0),
                       .rate = (uint32_t)rate,
                       .channels = (uint32_t)channels,
                       .count = count};
    snprintf(s->key, sizeof s->key, "%s", h->key);
    for (uint32_t i = 0; i < count; i++)
        s->sample[i] = (int16_t)(from[2 * i] << 8 | from[2 * i + 1]);
    return true;
}

static const address addresses[] = {
    {"himc", "body", "snnnnnnn", on_body},
    {"himc", "pose", "*", on_pose},
    {"himc", "targets", "snnn", on_targets},
    {"himc", "strike", "nssnnnnns*", on_strike},
    {"himc", "beat", "n", on_beat},
    {"himc", "status", "*", on_status},
    {"himc", "sound", "*", on_sound},
    {"membrane", "head", "*", on_head},
    {"membrane", "place", "nnnnn*", on_place},
    {"himc", "support", "nnnnnnnnnnnn", on_support},
};

// copies the next "/part" of an address and returns the rest; NULL if there is none or it is too
// long
static const char *next_part(const char *at, char part[SCENE_NAME])
{
    size_t length = *at == '/' ? strcspn(at + 1, "/") : 0;
    if (length == 0 || length >= SCENE_NAME)
        return NULL;
    memcpy(part, at + 1, length);
    part[length] = 0;
    return at + 1 + length;
}

// "/group/name/what" or "/group/what" (then the name is empty); false if it is neither
static bool split(const char *path, char group[SCENE_NAME], char name[SCENE_NAME],
                  char what[SCENE_NAME])
{
    const char *rest = next_part(path, group);
    rest = rest ? next_part(rest, what) : NULL;
    name[0] = 0;
    if (!rest || !*rest)
        return rest != NULL;
    memcpy(name, what, SCENE_NAME);
    rest = next_part(rest, what);
    return rest && !*rest;
}

static const address *find_address(const char *group, const char *what, bool named)
{
    for (size_t i = 0; i < sizeof addresses / sizeof *addresses; i++)
        if (strcmp(group, addresses[i].group) == 0 && strcmp(what, addresses[i].what) == 0 &&
            (named || strcmp(group, "membrane") != 0))
            return &addresses[i];
    return NULL;
}

void address_dispatch(scene *s, const char *key, const char *path, lo_message message,
                      scene_time time)
{
    static const address view = {"viewer", "", "*", on_view};
    char group[SCENE_NAME], name[SCENE_NAME], what[SCENE_NAME] = "";
    received h = {.s = s,
                  .message = message,
                  .types = lo_message_get_types(message),
                  .args = lo_message_get_argv(message),
                  .count = lo_message_get_argc(message),
                  .time = time};
    const address *w = NULL;
    if (split(path, group, name, what))
        w = strcmp(group, "viewer") == 0 && !name[0] ? &view
                                                     : find_address(group, what, name[0] != 0);
    if (!w) {
        s->count.unknown++;
        return;
    }
    scene_word(h.name, sizeof h.name, w == &view ? what : name);
    bool named = w != &view && strcmp(group, "himc") == 0 && name[0];
    snprintf(h.key, sizeof h.key, "%.46s%s%s", key, named ? "/" : "", named ? h.name : "");
    if (!types_match(&h, w->types) || !w->act(&h))
        s->count.malformed++;
}
