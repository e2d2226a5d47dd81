/// fuzz_osc.c: packets to a performance on the network, with a simulated clock.
///
/// The bytes are not the packet but the instructions to build one: bundles in bundles, addresses of
/// commands, atoms of every OSC type with words and numbers of the commands' grammars, wrong
/// lengths, and at last some bytes changed. So most packets get past the first checks. Each is
/// decoded alone and sent to a himc_osc, whose counters must agree; commands are carried out. What
/// comes back is one clean line a packet. A millisecond is played after each, and all motion stays
/// finite.
#include "fuzz.h"

#include "finite_watch.h"

#include "himc/osc.h"
#include "osc/decode.h"
#include "osc/stepped.h"

#include <arpa/inet.h>
#include <math.h>
#include <netinet/in.h>
#include <sys/socket.h>

#define MOST_PACKET 4096 // (bytes) chosen: an input stays quick
#define MOST_WORDS 256
#define DEEPEST 7   // of bundles; more than are accepted
#define STEP 1e-3   // from packet to packet (s); chosen: a command in some packets can be paid for
#define FRESH 16384 // packets to one performance; chosen: its score stays short

typedef struct builder {
    const uint8_t *in, *end; // instructions
    size_t size;
    _Alignas(8) char packet[MOST_PACKET + 64];
} builder;

static himc_word words[MOST_WORDS];
static int word_count;
static himc_osc *osc;
static himc_performance *performance;
static finite_watch motion;
static int ear = -1;
static double simulated;

// --- what is said

static uint8_t next(builder *b)
{
    return b->in < b->end ? *b->in++ : 0;
}

static void put(builder *b, const void *bytes, size_t size)
{
    if (b->size + size > MOST_PACKET)
        return;
    memcpy(b->packet + b->size, bytes, size);
    b->size += size;
}

static void put_int(builder *b, uint32_t value)
{
    value = htonl(value);
    put(b, &value, sizeof value);
}

// a string or blob's contents, filled up to four bytes
static void put_padded(builder *b, const char *text, size_t size)
{
    put(b, text, size);
    put(b, "\0\0\0", (4 - size % 4) % 4);
}

static void put_string(builder *b, const char *text)
{
    put_padded(b, text, strlen(text) + 1);
}

static void add_word(const char *text, size_t size)
{
    if (size > 0 && size < HIMC_NAME_SIZE && word_count < MOST_WORDS)
        snprintf(words[word_count++].text, HIMC_NAME_SIZE, "%.*s", (int)size, text);
}

static const char *any_word(builder *b)
{
    return words[next(b) % word_count].text;
}

// the words of all grammars, and some that are none
static void collect_words(void)
{
    static const char *const others[] = {
        "kettle",      "127.0.0.1", "::1",   "192.0.2.1", "nowhere.txt", "../secret.bvh",
        "/etc/passwd", "A2",        "trunk", "neck",      "\x1B[2J\n",   "\xC2\x9B",
        "ü",           " ",         "nan",   ";"};
    const himc_command_row *row;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        add_word(others[i], strlen(others[i]));
    for (int i = 0; (row = himc_command_table(i)); i++)
        for (const char *s = row->atoms; *s; s += strcspn(s, " |[]"), s += strspn(s, " |[]"))
            if (*s >= 'a' && *s <= 'z')
                add_word(s, strcspn(s, " |[]"));
}

static double number(builder *b)
{
    static const double usual[] = {0,   1,    -1,   0.5,   2,   9,   60,       110,  250,  1e3,
                                   1e6, -0.3, 1e30, 1e-30, 4e9, NAN, INFINITY, 9001, 0.08, 3528};
    uint8_t choice = next(b);
    return choice < 200 ? usual[choice % (sizeof usual / sizeof *usual)] : (choice - 228) / 8.0;
}

static void put_atom(builder *b, char type)
{
    double value;
    float single;
    uint64_t bits;
    switch (type) {
    case 'i':
    case 'c':
    case 'r':
    case 'm': put_int(b, (uint32_t)(int32_t)(next(b) - 8) * (next(b) % 8 ? 1 : 16843009)); break;
    case 'f':
        single = (float)number(b);
        memcpy(&bits, &single, 4);
        put_int(b, (uint32_t)bits);
        break;
    case 'd':
    case 'h':
    case 't':
        value = number(b);
        memcpy(&bits, &value, 8);
        put_int(b, (uint32_t)(bits >> 32));
        put_int(b, (uint32_t)bits);
        break;
    case 's':
    case 'S': put_string(b, any_word(b)); break;
    case 'b':
        put_int(b, next(b) % 8 ? 6 : 0xFFFFFFF0u + next(b));
        put_padded(b, "a blob", 6);
        break;
    default: break; // T F N I [ ] have no contents
    }
}

// an atom that fits the token "a|b" or "ARGUMENT" of a grammar, or nearly
static void put_fitting(builder *b, const char *token, size_t size, char *tag)
{
    char text[HIMC_NAME_SIZE];
    uint8_t choice = next(b);
    bool argument = token[0] >= 'A' && token[0] <= 'Z';
    *tag = argument && choice % 8 ? 'f' : 's';
    if (argument) {
        put_atom(b, *tag);
        return;
    }
    for (const char *bar; choice % 4 && (bar = memchr(token, '|', size)); choice--) {
        size -= (size_t)(bar + 1 - token);
        token = bar + 1;
    }
    snprintf(text, sizeof text, "%.*s", (int)strcspn(token, "|] "), token);
    put_string(b, text);
}

// the atoms of one form of a row; returns how many
static int put_form(builder *b, const himc_command_row *row, char tags[16])
{
    const char *s = row->atoms, *other;
    int count = 0;
    for (int form = next(b) % 4; form > 0 && (other = strstr(s, " | ")); form--)
        s = other + 3;
    while (*s && *s != '|' && count < 14) {
        bool optional = *s == '[';
        size_t size = strcspn(s, " ");
        if (!optional || next(b) % 2)
            put_fitting(b, s + optional, size - 2 * (size_t)optional, &tags[count++]);
        s += size;
        s += *s == ' ';
    }
    return count;
}

static int put_any(builder *b, char tags[16])
{
    static const char types[] = "ffffffffssssssssiidhtScrmbTFNI[]x";
    int count = next(b) % 8;
    for (int i = 0; i < count; i++) {
        tags[i] = types[next(b) % (sizeof types - 1)];
        put_atom(b, tags[i]);
    }
    return count;
}

static void put_message(builder *b)
{
    const himc_command_row *row = himc_command_table(next(b) % HIMC_COMMANDS);
    char path[80], atoms[MOST_PACKET], tags[18] = ",";
    uint8_t kind = next(b);
    switch (kind % 32) {
    case 0: snprintf(path, sizeof path, "/%s/%s", any_word(b), row->name); break;
    case 1: snprintf(path, sizeof path, "/himc/%s", any_word(b)); break;
    case 2: snprintf(path, sizeof path, "/membrane/%s/%s", any_word(b), row->name); break;
    default:
        snprintf(path, sizeof path, "/%s/%s",
                 row->receiver == HIMC_PERFORMER ? "himc" : "membrane/kettle", row->name);
    }
    // the atoms are known before their tags, and stand behind them
    size_t begin = b->size;
    int count = kind < 192 ? put_form(b, row, tags + 1) : put_any(b, tags + 1);
    size_t size = b->size - begin;
    memcpy(atoms, b->packet + begin, size);
    b->size = begin;
    tags[1 + count] = '\0';
    put_string(b, path);
    put_string(b, tags);
    put(b, atoms, size);
}

static void put_element(builder *b, int depth)
{
    if (next(b) % 4 || depth == DEEPEST) {
        put_message(b);
        return;
    }
    put(b, "#bundle\0\0\0\0\0\0\0\0\1", 16);
    for (int count = next(b) % 4; count > 0; count--) {
        size_t at = b->size;
        uint8_t wrong = next(b);
        put_int(b, 0);
        put_element(b, depth + 1);
        uint32_t length = htonl(wrong < 240 ? (uint32_t)(b->size - at - 4) : (uint32_t)wrong << 24);
        if (at + 4 <= b->size)
            memcpy(b->packet + at, &length, 4);
    }
}

static void build(builder *b)
{
    put_element(b, 0);
    int spoilt = next(b) % 16;
    for (; spoilt < 4 && spoilt > 0 && b->size > 0; spoilt--)
        b->packet[(size_t)(next(b) * 16 + next(b)) % b->size] = (char)next(b);
    if (next(b) % 32 == 31)
        b->size -= b->size % (1 + next(b));
}

// --- what is heard

// of the messages of one packet
typedef struct verdicts {
    long of[OSC_WRONG + 1], subscriptions;
} verdicts;

static void check_request(const himc_command *c)
{
    himc_command again;
    himc_error error;
    for (int i = 0; i < c->count; i++)
        require(c->atom[i].kind == HIMC_ATOM_SYMBOL || isfinite(c->atom[i].number),
                "an atom is a word or finite");
    require(himc_command_check(&again, HIMC_PERFORMER, c, &error), error.text);
}

static void take_verdict(void *object, osc_verdict verdict, himc_command *command,
                         const himc_error *error)
{
    verdicts *v = object;
    himc_error refusal;
    himc_command copy;
    int file;
    v->of[verdict]++;
    if (verdict == OSC_WRONG)
        require_line(error);
    if (verdict != OSC_REQUEST)
        return;
    check_request(command);
    v->subscriptions += himc_command_table((int)command->id)->when == HIMC_WHEN_NETWORK;
    himc_command_copy(&copy, command);
    if (!himc_osc_command_admit(&copy, "/some/folder", &refusal))
        require_line(&refusal);
    else if (himc_command_file(&copy, &file) != HIMC_FILE_NONE)
        require(himc_command_file(&copy, &file) == HIMC_FILE_READ && copy.folder &&
                    strcmp(copy.folder, "/some/folder") == 0,
                "a file over the network is read, and in the folder");
}

static void hear(void)
{
    char answer[2048];
    ssize_t size;
    while ((size = recv(ear, answer, sizeof answer - 1, 0)) >= 0) {
        answer[size] = '\0';
        bool error = memcmp(answer, "/himc/error\0,s\0", 16) == 0;
        require(error || memcmp(answer, "/himc/info\0\0,s\0", 16) == 0, "an answer is a line");
        require(answer[16] && himc_line_is_clean(answer + 16), "an answer is a clean line");
        require(!strstr(answer + 16, "root:"), "an answer quotes no file");
    }
}

// --- the performance

static double monotonic(void *user)
{
    (void)user;
    return simulated;
}

static void fresh(void)
{
    himc_error error;
    himc_osc_config config = {.files = "tests/fuzz"};
    osc_clock clock = {monotonic, monotonic, NULL};
    himc_performance_config rates = {
        .sample_rate = 16000, .physics_rate = 1000, .task_rate = 250}; // to save time
    himc_osc_free(osc);
    himc_performance_free(performance);
    performance = himc_performance_new(&rates, &error);
    himc_drum *drum = himc_drum_new("kettle", 23, rates.sample_rate, &error);
    require(performance && drum && himc_performance_add_drum(performance, drum, &error),
            "a performance");
    himc_drum_release(drum);
    motion.p = performance;
    himc_performance_on_motion(performance, watch_row, &motion);
    osc = himc_osc_new_stepped(&config, &clock, &error);
    require(osc != NULL, "a socket");
    if (ear < 0)
        ear = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)himc_osc_port(osc))};
    require(connect(ear, (struct sockaddr *)&to, sizeof to) == 0, "a way to it");
}

static long answered_for(himc_osc_counts c)
{
    return c.commands + c.malformed + c.foreign + c.refused + c.frequent;
}

// the himc_osc counts as many messages as the packet has; a subscription may be accepted as a
// command and then be refused
static void check_counts(const builder *b, const verdicts *v)
{
    himc_osc_counts before = himc_osc_count(osc), after;
    require(send(ear, b->packet, b->size, 0) == (ssize_t)b->size, "a packet is sent");
    require(!himc_osc_step(osc), "the share is not used up");
    after = himc_osc_count(osc);
    require(after.packets == before.packets + 1 && after.overrun == 0, "a packet is counted");
    require(after.malformed - before.malformed == v->of[OSC_MALFORMED], "malformed ones");
    require(after.foreign - before.foreign == v->of[OSC_FOREIGN], "foreign ones");
    long more = answered_for(after) - answered_for(before), all = 0;
    for (int i = 0; i <= OSC_WRONG; i++)
        all += v->of[i];
    require(more >= all && more <= all + v->subscriptions, "every message is counted once");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static builder b;
    static long packets;
    char copy[sizeof b.packet] __attribute__((aligned(8)));
    verdicts v = {.subscriptions = 0};
    if (word_count == 0)
        collect_words();
    if (packets++ % FRESH == 0)
        fresh();
    b.in = data;
    b.end = data + size;
    b.size = 0;
    build(&b);
    memcpy(copy, b.packet, b.size); // decoding swaps bytes
    himc_osc_decode(copy, b.size, take_verdict, &v);
    simulated += STEP;
    check_counts(&b, &v);
    himc_osc_receive(osc, performance, 1);
    himc_performance_process(performance, (int)(STEP * 16000), NULL);
    finite_watch_plans(&motion);
    require(!motion.bad, motion.bad ? motion.bad : "");
    hear();
    return 0;
}
