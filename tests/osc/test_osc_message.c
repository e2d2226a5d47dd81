/// test_osc_message.c: messages of OSC are written and read as liblo does, byte by byte.
#include "osc/message.h"

#include "base/random.h"

#include <lo/lo.h>
#include <math.h>
#include <string.h>
#include <unity.h>

#define MOST 32

void setUp(void)
{
}
void tearDown(void)
{
}

static void test_message_is_written_as_by_liblo(void)
{
    static const char *const text[] = {"", "a", "abc", "abcd", "kettle drum"};
    unsigned char bytes[512];
    char theirs[512];
    for (int n = 0; n < 40; n++) {
        osc_message m;
        lo_message lo = lo_message_new();
        himc_osc_message_begin(&m, &"/himc/strike"[n % 8]);
        for (int i = 0; i < n; i++) {
            if (i % 3 == 0) {
                himc_osc_message_text(&m, text[i % 5]);
                lo_message_add_string(lo, text[i % 5]);
            } else if (i % 3 == 1) {
                himc_osc_message_int(&m, -77777 * i);
                lo_message_add_int32(lo, -77777 * i);
            } else {
                himc_osc_message_float(&m, -0.1f * (float)i);
                lo_message_add_float(lo, -0.1f * (float)i);
            }
        }
        size_t size = himc_osc_message_size(&m);
        TEST_ASSERT_EQUAL(lo_message_length(lo, m.path), size);
        himc_osc_message_write(&m, bytes);
        lo_message_serialise(lo, m.path, theirs, NULL);
        TEST_ASSERT_EQUAL_MEMORY(theirs, bytes, size);
        lo_message_free(lo);
    }
}

static void test_message_beyond_its_room_has_no_size(void)
{
    osc_message m;
    himc_osc_message_begin(&m, "/himc/head");
    for (int i = 0; i < OSC_MESSAGE_ATOMS; i++)
        himc_osc_message_int(&m, i);
    TEST_ASSERT_GREATER_THAN(0, himc_osc_message_size(&m));
    himc_osc_message_int(&m, 0);
    TEST_ASSERT_EQUAL(0, himc_osc_message_size(&m));
    himc_osc_message_begin(&m, "/himc/info");
    char line[OSC_MESSAGE_BYTES] = "";
    himc_osc_message_text(&m, memset(line, 'x', sizeof line - 1));
    TEST_ASSERT_GREATER_THAN(0, himc_osc_message_size(&m));
    himc_osc_message_text(&m, "");
    TEST_ASSERT_EQUAL(0, himc_osc_message_size(&m));
}

static int below(uint64_t *random, size_t n)
{
    return (int)(himc_random_bits(random) % n);
}

// a message of all types, of which some bytes may be changed, added or left out
static size_t make_bytes(uint64_t *random, char *bytes)
{
    static const char types[] = "ifsSbhdtcmTFNI";
    lo_message lo = lo_message_new();
    int count = below(random, 8);
    for (int i = 0; i < count; i++) {
        char type = types[below(random, sizeof types - 1)];
        double value = 1e5 * below(random, 100000) - 5e9;
        lo_blob blob;
        switch (type) {
        case 'i': lo_message_add_int32(lo, (int)(value / 10)); break;
        case 'f': lo_message_add_float(lo, (float)value); break;
        case 's': lo_message_add_string(lo, &"kettle"[i % 6]); break;
        case 'S': lo_message_add_symbol(lo, &"legato"[i % 6]); break;
        case 'h': lo_message_add_int64(lo, (int64_t)value); break;
        case 'd': lo_message_add_double(lo, value); break;
        case 't': lo_message_add_timetag(lo, LO_TT_IMMEDIATE); break;
        case 'c': lo_message_add_char(lo, 'c'); break;
        case 'm': lo_message_add_midi(lo, (uint8_t[4]){0, 1, 2, 3}); break;
        case 'T': lo_message_add_true(lo); break;
        case 'F': lo_message_add_false(lo); break;
        case 'N': lo_message_add_nil(lo); break;
        case 'I': lo_message_add_infinitum(lo); break;
        default:
            blob = lo_blob_new(i + 1, "12345678");
            lo_message_add_blob(lo, blob);
            lo_blob_free(blob);
        }
    }
    size_t size = lo_message_length(lo, "/himc/x");
    lo_message_serialise(lo, "/himc/x", bytes, NULL);
    lo_message_free(lo);
    for (int i = below(random, 4) - 1; i > 0; i--)
        bytes[below(random, size)] = (char)below(random, 256);
    if (below(random, 10) == 0)
        memset(bytes + size, 0, 4);
    return below(random, 10) == 0 ? size + 4 : below(random, 10) == 0 ? size - 4 : size;
}

static void check_atoms(lo_message lo, const himc_atom *atom, int count, bool plain)
{
    const char *types = lo_message_get_types(lo);
    bool words = true;
    TEST_ASSERT_EQUAL(lo_message_get_argc(lo), count);
    for (int i = 0; i < count; i++) {
        lo_arg *arg = lo_message_get_argv(lo)[i];
        if (lo_is_numerical_type((lo_type)types[i])) {
            double theirs = (double)lo_hires_val((lo_type)types[i], arg);
            TEST_ASSERT_EQUAL(HIMC_ATOM_NUMBER, atom[i].kind);
            TEST_ASSERT_TRUE(theirs == atom[i].number || (isnan(theirs) && isnan(atom[i].number)));
        } else if (lo_is_string_type((lo_type)types[i])) {
            TEST_ASSERT_EQUAL_STRING((const char *)arg, atom[i].symbol);
        } else {
            words = false;
        }
    }
    TEST_ASSERT_EQUAL(words, plain);
}

static void test_bytes_are_read_or_refused_as_by_liblo(void)
{
    uint64_t random = 1;
    int good = 0, bad = 0;
    for (int n = 0; n < 20000; n++) {
        _Alignas(8) char bytes[512] = {0}, theirs[512];
        himc_atom atom[MOST];
        int count = 0, result;
        bool plain;
        size_t size = make_bytes(&random, bytes);
        memcpy(theirs, bytes, sizeof theirs);
        lo_message lo = theirs[0] == '/' ? lo_message_deserialise(theirs, size, &result) : NULL;
        bool read = himc_osc_message_read(bytes, size, atom, MOST, &count, &plain);
        TEST_ASSERT_EQUAL_MESSAGE(lo != NULL, read, bytes);
        if (read)
            check_atoms(lo, atom, count, plain);
        good += read;
        bad += !read;
        lo_message_free(lo);
    }
    TEST_ASSERT_GREATER_THAN(5000, good);
    TEST_ASSERT_GREATER_THAN(5000, bad);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_message_is_written_as_by_liblo);
    RUN_TEST(test_message_beyond_its_room_has_no_size);
    RUN_TEST(test_bytes_are_read_or_refused_as_by_liblo);
    return UNITY_END();
}
