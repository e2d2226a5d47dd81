/// test_roll_loudness.c: a roll is as loud as it is written: louder with each dynamic, of each kind
/// and on each drum, and as loud when it is a little longer.
#include "session.h"

#include <math.h>

#define CHUNK 480
#define BEGIN 1.0 // of the roll (s)
#define SWELL 0.5 // until the head has its energy (s)

typedef struct played {
    double level; ///< of the drum's sound, once it rings, to the end of the roll (dB)
    double speed; ///< mean of all contacts (m/s)
    heard heard;
} played;

static const struct {
    const char *drum, *tune;
} kettle[] = {{"kettle 32", "tune C2"}, {"kettle 26", "tune D3"}, {"kettle 23", "tune A3"}};

static const char *const dynamic[] = {"ppp", "pp", "p", "mp", "mf", "f", "ff", "fff"};

static played play_roll(int drum, const char *kind, const char *loud, double length)
{
    played r = {0};
    double sum = 0, sound[CHUNK];
    himc_performance *p = session_new();
    session_do(p, "drum %s", kettle[drum].drum);
    session_drum(p, 0, kettle[drum].tune);
    session_do(p, "tempo 60");
    session_do(p, "roll %g %g %s %s", BEGIN, length, kind, loud);
    session_do(p, "play");
    session_play(p, BEGIN + SWELL, &r.heard);
    int chunks = (int)((length - SWELL) * 48000 / CHUNK);
    for (int i = 0; i < chunks; i++) {
        himc_drum *head = himc_performance_drum(p, 0);
        session_play(p, CHUNK / 48000.0, &r.heard);
        himc_drum_read(head, himc_drum_time(head) - CHUNK, CHUNK, sound, NULL);
        for (int k = 0; k < CHUNK; k++)
            sum += sound[k] * sound[k];
    }
    r.level = 10 * log10(sum / (chunks * CHUNK));
    for (int i = 0; i < r.heard.strikes; i++)
        r.speed += r.heard.strike[i].velocity / r.heard.strikes;
    himc_performance_free(p);
    return r;
}

// everyday on one drum, with HIMC_LONG on all
static void gets_louder(const char *kind, int everyday)
{
    bool all = getenv("HIMC_LONG");
    for (int drum = all ? 0 : everyday; drum < (all ? 3 : everyday + 1); drum++) {
        played softer = {.level = -HUGE_VAL};
        printf("%s, %s:", kind, kettle[drum].tune);
        for (int i = 0; i < 8; i++) {
            played r = play_roll(drum, kind, dynamic[i], 3);
            printf(" %.1f dB %.2f m/s,", r.level, r.speed);
            heard_free(&r.heard);
            TEST_ASSERT_TRUE_MESSAGE(r.level > softer.level, dynamic[i]);
            TEST_ASSERT_TRUE_MESSAGE(r.speed > softer.speed, dynamic[i]);
            softer = r;
        }
        printf("\n");
    }
}

static void test_single_rolls_are_louder_and_faster_struck_with_each_dynamic(void)
{
    gets_louder("single", 0);
}

static void test_double_rolls_are_louder_and_faster_struck_with_each_dynamic(void)
{
    gets_louder("double", 1);
}

static void test_press_rolls_are_louder_and_faster_struck_with_each_dynamic(void)
{
    gets_louder("press", 2);
}

// a machine's strokes, quite even, were up to 10 dB louder at one length than at the next
static void test_a_roll_is_as_loud_at_any_length(void)
{
    static const double most[] = {4.5, 2, 1}; // the lowest mode sums up fewer of its strokes (dB)
    for (int drum = 0; drum < 3; drum++) {
        double least = HUGE_VAL, loudest = -HUGE_VAL;
        for (int i = 0; i < 8; i += getenv("HIMC_LONG") ? 1 : 2) {
            played r = play_roll(drum, "single", "mf", 2 + 0.13 * i);
            least = fmin(least, r.level);
            loudest = fmax(loudest, r.level);
            heard_free(&r.heard);
        }
        printf("%s: %.1f .. %.1f dB\n", kettle[drum].tune, least, loudest);
        TEST_ASSERT_TRUE(loudest - least < most[drum]);
    }
}

// arms have no fff in the time from stroke to stroke
static void test_a_roll_struck_softer_than_written_is_named_once(void)
{
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "drum kettle 23");
    session_do(p, "kettle tune A3"); // the fastest
    session_do(p, "tempo 60");
    session_do(p, "roll 1 2 single p");
    session_do(p, "roll 4 2 single fff");
    session_do(p, "play");
    session_play(p, 3.8, &h);
    TEST_ASSERT_EQUAL_INT(0, h.notes);
    session_play(p, 1.5, &h);
    TEST_ASSERT_EQUAL_INT(1, h.notes);
    TEST_ASSERT_EQUAL_STRING_LEN("roll at beat 4: too little time for 6 m/s", h.note, 41);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_single_rolls_are_louder_and_faster_struck_with_each_dynamic);
    RUN_TEST(test_double_rolls_are_louder_and_faster_struck_with_each_dynamic);
    RUN_TEST(test_press_rolls_are_louder_and_faster_struck_with_each_dynamic);
    RUN_TEST(test_a_roll_is_as_loud_at_any_length);
    RUN_TEST(test_a_roll_struck_softer_than_written_is_named_once);
    return UNITY_END();
}
