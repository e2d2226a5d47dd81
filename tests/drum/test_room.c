/// test_room.c: walls return as much sound as a room of their size, for as long, to each ear its
/// own; and what all drums of a performance share beside it: fader and mute.
#include "drum/ears.h"
#include "himc/himc.h"
#include "session.h"

#include <complex.h>
#include <math.h>

#define RATE 48000 // (Hz) of performances
#define SLOW 16000 // of the room alone
#define LONG (3 * SLOW)

static himc_room room;
static double answer[2][LONG];

static void hear_one(double drum[2], double ears[2])
{
    himc_room_hear(&room, 1, (double *[]){&drum[0], &drum[1]}, (double *[]){&ears[0], &ears[1]});
}

// the answer of a room to a click at both sides
static void click(himc_walls walls)
{
    double silence[2] = {0, 0}, now[2] = {1, 1}, ears[2];
    memset(&room, 0, sizeof room);
    himc_room_set(&room, &walls, SLOW);
    for (int i = 0; i < SLOW / 100; i++) {
        hear_one(silence, ears);
        TEST_ASSERT_TRUE(ears[0] == 0 && ears[1] == 0);
    }
    for (int i = 0; i < LONG; i++) {
        hear_one(i == 0 ? now : silence, ears);
        answer[0][i] = ears[0];
        answer[1][i] = ears[1];
    }
}

static double complex response(int ear, double hz, int from, int to)
{
    double complex sum = 0, turn = cexp(-2 * I * HIMC_PI * hz / SLOW), at = 1;
    for (int i = from; i < to; i++, at *= turn)
        sum += answer[ear][i] * at;
    return sum;
}

// energy between two frequencies, as a mean of its spectrum, from sample `from` on
static double power(int ear, double low, double high, int from)
{
    double sum = 0;
    int count = 0;
    for (double hz = low; hz < high; hz += (high - low) / 100, count++)
        sum += pow(cabs(response(ear, hz, from, LONG)), 2);
    return sum / count;
}

static void test_room_rings_for_its_time_and_less_above(void)
{
    static const double TIME[] = {0.5, 1.2, 2.5};
    for (int i = 0; i < 3; i++) {
        click((himc_walls){TIME[i], 600});
        int first = SLOW / 10, last = (int)((0.1 + 0.5 * TIME[i]) * SLOW);
        double low = power(0, 100, 800, last) / power(0, 100, 800, first);
        double high = power(1, 4000, 5000, last) / power(1, 4000, 5000, first);
        TEST_ASSERT_DOUBLE_WITHIN(3, -30, 10 * log10(low));
        TEST_ASSERT_DOUBLE_WITHIN(5, -30 / 0.6, 10 * log10(high));
    }
}

// Sabine: 16 pi/(4 A), A = .161 V/T60
static void test_room_returns_as_much_as_one_of_its_size(void)
{
    static const himc_walls ROOM[] = {{1.2, 600}, {0.6, 100}, {2, 5000}};
    for (int i = 0; i < 3; i++)
        for (int ear = 0; ear < 2; ear++) {
            click(ROOM[i]);
            double filled = 16 * HIMC_PI * ROOM[i].seconds / (4 * 0.161 * ROOM[i].volume);
            double is = power(ear, 60, 500, 0);
            TEST_ASSERT_DOUBLE_WITHIN(2, 0, 10 * log10(is / filled));
        }
}

// (cents) how far beside its pitch the tail of a note sounds
static double detuning(int ear, double hz)
{
    double best = hz, most = 0;
    for (double f = 0.96 * hz; f < 1.04 * hz; f += 0.1) {
        double level = cabs(response(ear, f, SLOW / 10, LONG / 2));
        if (level > most) {
            most = level;
            best = f;
        }
    }
    return 1200 * log2(best / hz);
}

// notes that lose 60 dB in 1.2 s, as (1,1) of a small drum; in an ideal hall (noise that dies in
// its time) tails are 8 cents beside them
static void test_room_keeps_a_note_in_tune(void)
{
    double sum = 0;
    int count = 0;
    for (double hz = 120; hz < 240; hz *= 1.03) {
        memset(&room, 0, sizeof room);
        himc_room_set(&room, &HIMC_WALLS_USUAL, SLOW);
        for (int i = 0; i < LONG; i++) {
            double t = (double)i / SLOW, note = exp(-6.9 / 1.2 * t) * sin(2 * HIMC_PI * hz * t);
            double drum[2] = {note, note}, ears[2];
            hear_one(drum, ears);
            answer[0][i] = ears[0];
            answer[1][i] = ears[1];
        }
        for (int ear = 0; ear < 2; ear++, count++)
            sum += pow(detuning(ear, hz), 2);
    }
    printf("%d tails, %.1f cents RMS\n", count, sqrt(sum / count));
    TEST_ASSERT_TRUE(sqrt(sum / count) < 12);
}

static void test_room_has_place_for_its_delays_at_the_highest_rate(void)
{
    memset(&room, 0, sizeof room);
    himc_room_set(&room, &HIMC_WALLS_USUAL, 192000);
    for (int l = 0; l < HIMC_ROOM_LINES; l++)
        TEST_ASSERT_TRUE(room.delay[l] > HIMC_ROOM_RUN && room.delay[l] < HIMC_ROOM_LINE);
}

static double loudest_after_a_click(double seconds)
{
    double most = 0;
    click((himc_walls){seconds, 600});
    for (int i = 0; i < LONG; i++)
        most = fmax(most, fabs(answer[0][i]));
    return most;
}

static void test_room_of_a_short_time_is_soft(void)
{
    double usual = loudest_after_a_click(0.3);
    for (double seconds = 0.2; seconds > 1e-3; seconds /= 1.5) {
        double most = loudest_after_a_click(seconds);
        printf("%.4f s: %.3g of that of 0.3 s\n", seconds, most / usual);
        TEST_ASSERT_TRUE(most <= 1.2 * usual);
    }
}

static void test_room_gives_each_ear_its_own_at_any_frequency(void)
{
    static const double BAND[][2] = {{40, 200}, {200, 800}, {800, 3000}};
    click(HIMC_WALLS_USUAL);
    for (int b = 0; b < 3; b++) {
        double complex both = 0;
        double left = 0, right = 0;
        for (double hz = BAND[b][0]; hz < BAND[b][1]; hz *= 1.005) {
            double complex l = response(0, hz, 0, LONG), r = response(1, hz, 0, LONG);
            both += l * conj(r);
            left += l * conj(l);
            right += r * conj(r);
        }
        TEST_ASSERT_TRUE(cabs(both) < 0.25 * sqrt(left * right));
    }
}

// the energy in its delays
static double stored(void)
{
    double sum = 0;
    for (int l = 0; l < HIMC_ROOM_LINES; l++)
        for (int d = 0; d < room.delay[l]; d++)
            sum += pow(room.line[l][d], 2);
    return sum;
}

static void test_room_never_gains_energy_also_while_its_walls_change(void)
{
    double noise[2], silence[2] = {0, 0}, ears[2], before;
    unsigned seed = 1;
    memset(&room, 0, sizeof room);
    himc_room_set(&room, &HIMC_WALLS_USUAL, SLOW);
    for (int i = 0; i < SLOW / 10; i++) {
        noise[0] = chance(&seed) - 0.5;
        noise[1] = chance(&seed) - 0.5;
        hear_one(noise, ears);
    }
    before = stored();
    TEST_ASSERT_TRUE(before > 1);
    for (int i = 0; i < 100; i++) {
        himc_room_set(&room, &(himc_walls){0.05 + 9 * chance(&seed), 50 + 1e4 * chance(&seed)},
                      SLOW);
        for (int k = 0; k < 100; k++)
            hear_one(silence, ears);
        // a wall's filter holds a little of what passes it
        TEST_ASSERT_TRUE(stored() < before * 1.0001);
        before = stored();
    }
}

static void test_room_does_not_click_when_it_changes(void)
{
    static const himc_walls ROOM[] = {{2, 100}, {0.3, 3000}, {0, 600}, {1, 200}, {1.2, 600}};
    double most[2] = {0, 0}, past[2] = {0, 0};
    memset(&room, 0, sizeof room);
    himc_room_set(&room, &HIMC_WALLS_USUAL, SLOW);
    for (int i = 0; i < 4 * SLOW; i++) {
        double tone = sin(2 * HIMC_PI * 150 * i / SLOW), drum[2] = {tone, tone}, ears[2] = {0, 0};
        if (i >= SLOW && (i - SLOW) % (SLOW / 2) == 0 && (i - SLOW) / (SLOW / 2) < 5)
            himc_room_set(&room, &ROOM[(i - SLOW) / (SLOW / 2)], SLOW);
        if (himc_room_heard(&room))
            hear_one(drum, ears);
        double bend = fabs(ears[0] - 2 * past[0] + past[1]);
        most[i >= SLOW] = fmax(most[i >= SLOW], i > SLOW / 2 ? bend : 0);
        past[1] = past[0];
        past[0] = ears[0];
    }
    TEST_ASSERT_TRUE(most[0] > 0 && most[1] < 10 * most[0]);
}

static void test_room_is_empty_some_time_after_the_last_sound(void)
{
    double silence[2] = {0, 0}, ears[2];
    click((himc_walls){0.2, 100});
    TEST_ASSERT_TRUE(himc_room_at_rest(&room));
    for (int i = 0; i < 5000; i++) {
        hear_one(silence, ears);
        TEST_ASSERT_TRUE(ears[0] == 0 && ears[1] == 0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, stored());
}

// commands to a performance

// what two channels of the first drum sound in `samples`, after these commands and a strike
static void play(himc_performance *p, double *left, double *right, int samples)
{
    for (int i = 0; i < samples; i += 480) {
        himc_performance_process(p, 480, NULL);
        himc_drum *drum = himc_performance_drum(p, 0);
        himc_drum_read_channel(drum, 0, himc_drum_time(drum) - 480, 480, left + i);
        himc_drum_read_channel(drum, 1, himc_drum_time(drum) - 480, 480, right + i);
    }
}

static himc_performance *with_a_drum(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum timpano");
    session_drum(p, 0, "pickups 2");
    return p;
}

static double largest(const double *x, int n)
{
    double most = 0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

static void test_room_0_is_no_room_bit_by_bit(void)
{
    static double with[2][RATE], without[2][RATE];
    for (int k = 0; k < 2; k++) {
        himc_performance *p = with_a_drum();
        double(*into)[RATE] = k ? with : without;
        session_do(p, k ? "room 2 100" : "room 0");
        session_do(p, "listener 2.2 0.4 1.3");
        play(p, into[0], into[1], 4800);
        session_do(p, "room 0");
        play(p, into[0], into[1], 4800);
        session_drum(p, 0, "strike -0.2 0 3");
        play(p, into[0], into[1], RATE);
        himc_performance_free(p);
    }
    TEST_ASSERT_TRUE(largest(with[0], RATE) > 0.01);
    TEST_ASSERT_EQUAL_MEMORY(without, with, sizeof with);
}

static void test_room_is_around_every_listener_until_reset(void)
{
    static double usual[2][RATE], other[2][RATE], again[2][RATE];
    himc_performance *p = with_a_drum();
    session_do(p, "listener 2.2 0.4 1.3");
    session_drum(p, 0, "strike -0.2 0 3");
    play(p, usual[0], usual[1], RATE);
    himc_performance_free(p);
    p = with_a_drum();
    session_do(p, "room 3");
    session_do(p, "listener 2.2 0.4 1.3");
    session_drum(p, 0, "strike -0.2 0 3");
    play(p, other[0], other[1], RATE);
    TEST_ASSERT_TRUE(memcmp(usual, other, sizeof usual) != 0);
    TEST_ASSERT_FALSE(session_try(p, "room 1 5"));
    TEST_ASSERT_FALSE(session_try(p, "room -1"));
    session_do(p, "reset");
    session_do(p, "drum timpano");
    session_drum(p, 0, "pickups 2");
    session_do(p, "listener 2.2 0.4 1.3");
    session_drum(p, 0, "strike -0.2 0 3");
    play(p, again[0], again[1], RATE);
    TEST_ASSERT_EQUAL_MEMORY(usual, again, sizeof usual);
    himc_performance_free(p);
}

// the largest second difference
static double bend(const double *x, int n)
{
    double most = 0;
    for (int i = 2; i < n; i++)
        most = fmax(most, fabs(x[i] - 2 * x[i - 1] + x[i - 2]));
    return most;
}

// a command for all drums beside none, and after it the one that takes it back
static void compare_faders(const char *change, const char *back, bool to_the_drum, double factor)
{
    static double plain[2][RATE], faded[2][RATE];
    for (int k = 0; k < 2; k++) {
        himc_performance *p = with_a_drum();
        double(*into)[RATE] = k ? faded : plain;
        session_drum(p, 0, "noise 0");
        session_drum(p, 0, "strike -0.2 0 3");
        for (int part = 0; part < 4; part++) {
            const char *word = !k ? NULL : part == 1 ? change : part == 2 ? back : NULL;
            if (word && to_the_drum)
                session_drum(p, 0, word);
            else if (word)
                session_do(p, "%s", word);
            play(p, into[0] + part * RATE / 4, into[1] + part * RATE / 4, RATE / 4);
        }
        himc_performance_free(p);
    }
    int quarter = RATE / 4, ramp = RATE / 25;
    TEST_ASSERT_EQUAL_MEMORY(plain[0], faded[0], sizeof(double) * (size_t)quarter);
    for (int i = quarter + ramp; i < 2 * quarter; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, factor * plain[0][i], faded[0][i]);
    TEST_ASSERT_EQUAL_MEMORY(plain[0] + 3 * quarter, faded[0] + 3 * quarter,
                             sizeof(double) * (size_t)quarter);
    double loud = fmax(factor, 1) * bend(plain[0] + quarter - 480, 480);
    TEST_ASSERT_TRUE_MESSAGE(bend(faded[0] + quarter - 2, 2 * quarter) < 3 * loud, "a click");
}

static void test_mute_silences_drums_without_a_click_and_they_play_on(void)
{
    compare_faders("mute 1", "mute 0", false, 0);
    compare_faders("mute 1", "mute 0", true, 0);
}

static void test_gain_of_all_drums_is_a_fader(void)
{
    compare_faders("gain -6", "gain 0", false, pow(10, -0.3));
    compare_faders("gain 6", "gain 0", false, pow(10, 0.3));
    compare_faders("gain -6", "gain 0", true, pow(10, -0.3));
}

static void test_fader_and_mute_hold_for_drums_to_come_until_reset(void)
{
    static double x[2][RATE];
    himc_performance *p = session_new();
    session_do(p, "mute 1");
    session_do(p, "drum timpano");
    session_drum(p, 0, "strike -0.2 0 3");
    play(p, x[0], x[1], 9600);
    TEST_ASSERT_TRUE(largest(x[0] + 4800, 4800) == 0);
    session_do(p, "reset");
    session_do(p, "drum timpano");
    session_drum(p, 0, "strike -0.2 0 3");
    play(p, x[0], x[1], 9600);
    TEST_ASSERT_TRUE(largest(x[0] + 4800, 4800) > 0.01);
    TEST_ASSERT_FALSE(session_try(p, "mute 2"));
    TEST_ASSERT_FALSE(session_try(p, "gain 200"));
    himc_performance_free(p);
}

// level (dB) of the strongest line between two frequencies, 60 to 300 ms after the start
static double line_level(const double *x, double low, double high)
{
    double most = 0;
    for (double hz = low; hz < high; hz += 1) {
        double complex sum = 0, turn = cexp(-2 * I * HIMC_PI * hz / RATE), at = 1;
        for (int i = RATE * 6 / 100; i < RATE * 3 / 10; i++, at *= turn)
            sum += x[i] * at * pow(sin(HIMC_PI * (i - RATE * 0.06) / (RATE * 0.24)), 2);
        most = fmax(most, cabs(sum));
    }
    return 20 * log10(most);
}

// A hall lifts some tones and swallows others; the usual one must leave every note its fifth.
// Recorded timpani have it at -11 to 0 dB beside the principal tone.
static void test_every_semitone_has_its_fifth_in_the_usual_room(void)
{
    static double x[2][34 * 480];
    for (int note = 0; note < 22; note++) {
        double hz = 65.406 * pow(2, note / 12.0);
        int inches = hz < 80 ? 32 : hz < 115 ? 29 : hz < 150 ? 26 : 23;
        char text[40];
        himc_performance *p = session_new();
        session_do(p, "listener usual");
        session_do(p, "drum kettle %d", inches);
        snprintf(text, sizeof text, "tune %.3f", hz);
        session_drum(p, 0, text);
        snprintf(text, sizeof text, "strike %.4f 0 2.9", -0.75 * inches * 0.0127);
        session_drum(p, 0, text);
        play(p, x[0], x[1], 34 * 480);
        double fifth = 0;
        for (int ear = 0; ear < 2; ear++)
            fifth += 0.5 * (line_level(x[ear], 1.44 * hz, 1.56 * hz) -
                            line_level(x[ear], 0.97 * hz, 1.03 * hz));
        printf("%d inches, %.1f Hz: fifth %.1f dB\n", inches, hz, fifth);
        TEST_ASSERT_TRUE(fifth > -12 && fifth < 3);
        himc_performance_free(p);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_room_rings_for_its_time_and_less_above);
    RUN_TEST(test_room_returns_as_much_as_one_of_its_size);
    RUN_TEST(test_room_keeps_a_note_in_tune);
    RUN_TEST(test_every_semitone_has_its_fifth_in_the_usual_room);
    RUN_TEST(test_room_has_place_for_its_delays_at_the_highest_rate);
    RUN_TEST(test_room_of_a_short_time_is_soft);
    RUN_TEST(test_room_gives_each_ear_its_own_at_any_frequency);
    RUN_TEST(test_room_never_gains_energy_also_while_its_walls_change);
    RUN_TEST(test_room_does_not_click_when_it_changes);
    RUN_TEST(test_room_is_empty_some_time_after_the_last_sound);
    RUN_TEST(test_room_0_is_no_room_bit_by_bit);
    RUN_TEST(test_room_is_around_every_listener_until_reset);
    RUN_TEST(test_mute_silences_drums_without_a_click_and_they_play_on);
    RUN_TEST(test_gain_of_all_drums_is_a_fader);
    RUN_TEST(test_fader_and_mute_hold_for_drums_to_come_until_reset);
    return UNITY_END();
}
