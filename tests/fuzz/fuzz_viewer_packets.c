/// fuzz_viewer_packets.c: the viewer's OSC, from packets to the frames that the page gets.
///
/// An input is a list of actions: a packet of raw bytes, a message or a bundle built from the
/// viewer's addresses with usual and unusual atoms, time that passes, frames for two readers. All
/// numbers in a frame are finite, all text is plain UTF-8, each event is JSON, and a packet counts
/// for no more messages than its length allows.
#include "base/line.h"
#include "fuzz.h"
#include "packets.h"

#include <ctype.h>
#include <math.h>

#define MOST_INPUT 1024 // the rest is left out; chosen: fifty actions
#define MOST_PACKET 4096
#define READERS 2

static scene s;
static uint8_t frame[SCENE_FRAME_MAX];

// --- the input

static const uint8_t *at, *end;

static uint8_t byte(void)
{
    return at < end ? *at++ : 0;
}

static size_t take(void *to, size_t size)
{
    size_t left = (size_t)(end - at);
    size = size < left ? size : left;
    memcpy(to, at, size);
    at += size;
    return size;
}

// --- packets from it

typedef struct packet {
    uint8_t bytes[MOST_PACKET];
    size_t size;
} packet;

static void put(packet *p, const void *bytes, size_t size)
{
    if (size > sizeof p->bytes - p->size)
        return;
    memcpy(p->bytes + p->size, bytes, size);
    p->size += size;
}

static void put_u32(packet *p, uint32_t value)
{
    uint8_t big[] = {(uint8_t)(value >> 24), (uint8_t)(value >> 16), (uint8_t)(value >> 8),
                     (uint8_t)value};
    put(p, big, sizeof big);
}

// with one to four zeros
static void put_string(packet *p, const char *text)
{
    size_t size = strlen(text) + 1;
    put(p, text, size);
    put(p, "\0\0\0", (4 - size % 4) % 4);
}

static const char *word(void)
{
    static const char *const words[] = {"left", "right",  "kettle", "legato",
                                        "load", "pelvis", "head",   "right-toes"};
    static char own[64];
    uint8_t choice = byte();
    if (choice < 192)
        return words[choice % 8];
    own[take(own, choice - 192u)] = 0;
    return own;
}

static double number(void)
{
    static const double strange[] = {NAN, INFINITY, -INFINITY, 1e9, -1001, 1e-310, 1e300, 0.1};
    uint8_t choice = byte();
    double own = 0;
    if (choice < 240)
        return (choice - 112) / 64.0; // among them 0, 1 and -1
    if (choice < 248)
        return strange[choice % 8];
    take(&own, sizeof own);
    return own;
}

static void put_atom(packet *p, char type)
{
    float single;
    double value;
    uint64_t bits = 0;
    uint32_t half;
    switch (type) {
    case 's':
    case 'S': put_string(p, word()); return;
    case 'i': put_u32(p, (uint32_t)(int32_t)(int8_t)byte()); return;
    case 'f':
        single = (float)number();
        memcpy(&half, &single, sizeof half);
        put_u32(p, half);
        return;
    case 'd':
        value = number();
        memcpy(&bits, &value, sizeof bits);
        break;
    case 'h': bits = (uint64_t)(int64_t)(int8_t)byte() << byte() % 56; break;
    case 'b': put_u32(p, byte() % 8); break; // a blob of 8 bytes, whatever it says
    case 't': break;
    default: return; // T F N I and unknown ones have no data
    }
    put_u32(p, (uint32_t)(bits >> 32));
    put_u32(p, (uint32_t)bits);
}

static void put_message(packet *p)
{
    static const char *const known[][2] = {
        {"/himc/body", ",sfffffff"},
        {"/himc/strike", ",fssfffffs"},
        {"/himc/targets", ",sfff"},
        {"/himc/beat", ",f"},
        {"/himc/status", ",sfsisd"},
        {"/membrane/kettle/head", ",ffffffff"},
        {"/membrane/kettle/place", ",fffff"},
        {"/viewer/camera", ",s"},
        {"/himc/ann/body", ",sddddddd"},
        {"/himc/pose", ","},
        {"/himc/sound", ",iiib"},
    };
    enum { KNOWN = sizeof known / sizeof *known };
    char address[80] = "/", types[80] = ",";
    uint8_t choice = byte();
    bool usual = choice < 192;
    snprintf(address + 1, sizeof address - 1, "%s", usual ? known[choice % KNOWN][0] + 1 : word());
    snprintf(types, sizeof types, "%s", known[choice % KNOWN][1]);
    if (choice % 16 == 15) // other atoms than usual
        types[1 + take(types + 1, byte() % 72)] = 0;
    put_string(p, address);
    put_string(p, types);
    for (const char *type = types + 1; *type; type++)
        put_atom(p, *type);
}

static void put_bundle(packet *p, int depth)
{
    put(p, "#bundle\0\0\0\0\0\0\0\0\1", 16);
    for (int count = byte() % 24; count > 0 && at < end; count--) {
        static packet inner[12];
        packet *element = &inner[depth];
        element->size = 0;
        if (depth < 11 && byte() % 4 == 0)
            put_bundle(element, depth + 1);
        else
            put_message(element);
        put_u32(p, (uint32_t)element->size);
        put(p, element->bytes, element->size);
    }
}

// --- what must be true of a frame

static const char *json_string(const char *text)
{
    require(*text == '"', "a string begins");
    text += 1 + strcspn(text + 1, "\"\\");
    require(*text == '"', "a string ends");
    return text + 1;
}

static const char *json_number(const char *text)
{
    text += *text == '-';
    require(isdigit((uint8_t)*text), "a number has digits");
    text += *text == '0' ? 1 : strspn(text, "0123456789");
    if (*text == '.') {
        require(isdigit((uint8_t)text[1]), "a fraction has digits");
        text += 1 + strspn(text + 1, "0123456789");
    }
    if (*text == 'e') {
        text += 1 + (text[1] == '+' || text[1] == '-');
        require(isdigit((uint8_t)*text), "an exponent has digits");
        text += strspn(text, "0123456789");
    }
    return text;
}

static const char *json_list(const char *text);

static const char *json_value(const char *text)
{
    return *text == '"' ? json_string(text) : *text == '[' ? json_list(text) : json_number(text);
}

static const char *json_list(const char *text)
{
    if (*++text == ']')
        return text + 1;
    for (text--; *text != ']';)
        text = json_value(text + 1),
        require(*text == ',' || *text == ']', "a list goes on or ends");
    return text + 1;
}

static void check_event(const char *text)
{
    require(strlen(text) < SCENE_TEXT && himc_line_is_clean(text), "an event is one line");
    require(*text == '{', "an event is an object");
    while (*text != '}') {
        text = json_string(text + 1);
        require(*text == ':', "a name has a value");
        text = json_value(text + 1);
        require(*text == ',' || *text == '}', "an object goes on or ends");
    }
    text += 1;
    require(text[strspn(text, " ")] == 0, "only blanks follow an event");
}

static void check_name(const char *name, size_t size)
{
    require(memchr(name, 0, size) && himc_line_is_clean(name), "a name is plain text");
}

static void check_floats(const uint8_t *bytes, size_t count, double most)
{
    for (size_t i = 0; i < count; i++) {
        float value;
        memcpy(&value, bytes + 4 * i, sizeof value);
        require(fabsf(value) <= most, "a number is finite and in range");
    }
}

static uint32_t u32(const uint8_t *bytes)
{
    uint32_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static void check_block(uint32_t kind, const uint8_t *bytes, size_t size)
{
    static char text[SCENE_TEXT + 8];
    const uint8_t *body = bytes + SCENE_KEY;
    require(kind >= 1 && kind <= 4, "a block is of a known kind");
    if (kind == 3) {
        require(size < sizeof text, "an event has room");
        memcpy(text, bytes, size);
        text[size] = 0;
        check_event(text);
        return;
    }
    check_name((const char *)bytes, SCENE_KEY);
    if (kind == 1) {
        require(u32(body) < 1u << SCENE_SEGMENTS && u32(body + 4) < 4, "segments and hands exist");
        check_floats(body + 8, (size - SCENE_KEY - 8) / 4, 1000);
    } else if (kind == 4) {
        require(u32(body + 4) >= 8000 && u32(body + 4) <= 192000, "a sound has a rate");
        require(u32(body + 8) - 1 < 2, "and one or two channels");
        require(u32(body + 12) <= SCENE_SAMPLES, "and so many samples");
    } else {
        check_name((const char *)body, SCENE_NAME);
        check_floats(body + SCENE_NAME + 4, 5, 1000);
        require(u32(body + SCENE_NAME + 24) <= SCENE_MODES, "a head has so many modes");
        check_floats(body + SCENE_NAME + 32, SCENE_MODES, 1);
    }
}

static void check_frame(scene_reader *reader, double now)
{
    size_t size = scene_encode(&s, reader, now, frame);
    require(size <= sizeof frame, "a frame has room");
    for (size_t from = 0; from < size;) {
        require(size - from >= 16, "a block has a head");
        size_t length = u32(frame + from + 4);
        require(length % 8 == 0 && length <= size - from - 16, "a block ends in the frame");
        check_block(u32(frame + from), frame + from + 16, length);
        from += 16 + length;
    }
}

// --- actions

static void store(const packet *p, uint8_t sender, double now)
{
    char key[SCENE_KEY];
    // of the exact size, so that the address sanitizer sees a byte too far
    uint8_t *bytes = malloc(p->size ? p->size : 1);
    uint64_t packets = s.count.packets, messages = s.count.messages;
    require(bytes != NULL, "memory for a packet");
    memcpy(bytes, p->bytes, p->size);
    snprintf(key, sizeof key, "127.0.0.1:%d", 9000 + sender % 20);
    packets_store(&s, key, bytes, p->size, now);
    require(s.count.packets == packets + 1, "a packet is counted");
    require(s.count.messages - messages <= p->size / 4, "messages are parts of the packet");
    free(bytes);
}

static void act(scene_reader reader[READERS], double *now)
{
    static packet p;
    uint8_t action = byte(), size[2] = {0};
    p.size = 0;
    switch (action % 8) {
    case 0:
        take(size, 2);
        p.size = take(p.bytes, (size[0] * 256u + size[1]) % MOST_PACKET);
        break;
    case 1: put_bundle(&p, 0); break;
    case 2: *now += byte() / 50.0; return;
    case 3: scene_complete_poses(&s, *now); return;
    case 4: check_frame(&reader[action / 8 % READERS], *now); return;
    default: put_message(&p);
    }
    if (action >= 224 && p.size > 0) // damaged
        p.bytes[byte() % p.size] ^= byte();
    store(&p, action < 128 ? 0 : byte(), *now);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    double now = 1e9;
    at = data;
    end = data + (size < MOST_INPUT ? size : MOST_INPUT);
    // all but the texts of the events, which count only once they are added
    memset(s.performer, 0, sizeof s.performer);
    memset(s.drum, 0, sizeof s.drum);
    memset(&s.count, 0, sizeof s.count);
    s.events = 0;
    scene_reader reader[READERS] = {scene_reader_new(&s), scene_reader_new(&s)};
    while (at < end)
        act(reader, &now);
    scene_complete_poses(&s, now + 1);
    for (int i = 0; i < READERS; i++)
        do
            check_frame(&reader[i], now + 1);
        while (reader[i].events < s.events);
    return 0;
}
