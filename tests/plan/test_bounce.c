/// test_bounce.c: strokes that bounce: the fingers' law by itself, doubles and buzzes of a
/// performer, and the strokes that ornaments are made of.
#include "session.h"
#include "plan/bounce.h"

// the fingers' law

// energy of the tip (a mass of 1) in the spring of the fingers, which is bounded
static double energy_of(const himc_bounce *b, double y, double v)
{
    double most = -himc_bounce_acceleration(b, 1e6, 0), z = y - b->rest, k = b->stiffness;
    double bound = k > 0 ? (most - b->press) / k : HUGE_VAL, soft = fmin(z, bound);
    return 0.5 * v * v + b->press * soft + 0.5 * k * soft * soft + most * (z - soft);
}

// one bounce on a head at rest that keeps `e` of the speed, in steps of 10 us; returns the impacts
static int bounce_on(himc_bounce *b, double impact, double e, double speed[], int most)
{
    double h = 1e-5, contact = 7e-3, y = 0, v = e * impact, t = contact;
    int n = 0;
    speed[n++] = impact;
    himc_bounce_separated(b, t, 0, y, v);
    while (n < most && !himc_bounce_is_over(b, t, v) && t < 1) {
        double energy = energy_of(b, y, v);
        double a = himc_bounce_acceleration(b, y, v);
        y += h * (v + 0.5 * h * a);
        v += 0.5 * h * (a + himc_bounce_acceleration(b, y, v + h * a));
        t += h;
        TEST_ASSERT_TRUE(energy_of(b, y, v) <= energy + 1e-6 * (1 + energy));
        if (y > 0 || v > 0)
            continue;
        speed[n++] = -v;
        t += contact;
        v *= -e;
        y = 0;
        himc_bounce_separated(b, t, 0, y, v);
    }
    return n;
}

static void test_energy_of_a_bounce_never_grows_and_its_impacts_fall(void)
{
    double speed[40];
    unsigned seed = 5;
    for (int i = 0; i < 200; i++) {
        int bounces = i % 2 ? HIMC_BUZZ : 1;
        double time = 0.02 + 0.18 * chance(&seed), impact = 0.3 + 5 * chance(&seed);
        himc_bounce b = himc_bounce_begin(bounces, time, 0);
        int n = bounce_on(&b, impact, 0.55 + 0.4 * chance(&seed), speed, 40);
        for (int k = 1; k < n; k++)
            TEST_ASSERT_TRUE(speed[k] < speed[k - 1]);
    }
}

static void test_bounces_end_in_time_also_without_a_head(void)
{
    for (int bounces = HIMC_BUZZ; bounces <= 1; bounces += 2) {
        himc_bounce b = himc_bounce_begin(bounces, 0.1, 2);
        himc_bounce_separated(&b, 2.01, 0.001, 0, 0.8);
        TEST_ASSERT_FALSE(himc_bounce_is_over(&b, 2.05, -1));
        TEST_ASSERT_TRUE(himc_bounce_is_over(&b, 2.2, -1));
    }
}

static void test_a_double_comes_when_it_shall_unless_it_is_too_fast_for_fingers(void)
{
    double speed[4];
    for (double time = 0.02; time < 0.08; time += 0.01)
        for (double e = 0.6; e < 0.95; e += 0.1) {
            double impact = fmin(2, himc_bounce_fastest(1, time));
            himc_bounce b = himc_bounce_begin(1, time, 0);
            TEST_ASSERT_EQUAL_INT(2, bounce_on(&b, impact, e, speed, 2));
            himc_bounce hard = himc_bounce_begin(1, time, 0), again = b;
            himc_bounce_separated(&again, 7e-3, 0, 0, e * impact);
            himc_bounce_separated(&hard, 7e-3, 0, 0, 8 * e);
            TEST_ASSERT_TRUE(hard.stiffness > again.stiffness);
        }
    TEST_ASSERT_TRUE(himc_bounce_fastest(1, 0.025) < 1.8); // fast doubles are soft
    TEST_ASSERT_TRUE(himc_bounce_fastest(1, 0.0625) > 3.5);
    TEST_ASSERT_TRUE(isinf(himc_bounce_fastest(0, 0.02)));
}

// of a performer

static himc_performance *with_kettle(const char *mode)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "tempo 60");
    session_do(p, "mode %s", mode);
    return p;
}

// the contacts of a hand that follow a planned one
typedef struct group {
    double time[20], speed[20];
    int count;
} group;

static int groups_of(const heard *h, himc_hand hand, group *groups)
{
    int n = 0;
    for (int i = 0; i < h->strikes; i++) {
        const himc_strike *s = &h->strike[i];
        if (s->hand != hand)
            continue;
        n += isfinite(s->planned_time);
        TEST_ASSERT_TRUE(n > 0 && strcmp(s->nuance, "none") != 0);
        group *g = &groups[n - 1];
        g->time[g->count] = s->time;
        g->speed[g->count++] = s->velocity;
    }
    return n;
}

// Speeds of impact are relative to the head, which still swings by some centimetres a second: a
// contact may be that much faster than the one before, not than the second before.
static void gets_softer(const group *g)
{
    for (int k = 1; k < g->count; k++) {
        TEST_ASSERT_TRUE(g->speed[k] < g->speed[k - 1] + 0.05);
        TEST_ASSERT_TRUE(k < 2 || g->speed[k] < g->speed[k - 2]);
    }
}

// both hands in turn, so that all contacts are even
static void plays_doubles(const char *mode, double rate)
{
    himc_performance *p = with_kettle(mode);
    heard h = {0};
    group groups[2][8] = {{{.count = 0}}};
    double worst = 0, ratio = 0;
    for (int i = 0; i < 12; i++) {
        himc_stroke s = {.beat = 1 + i / (2 * rate),
                         .hand = i % 2 ? HIMC_LEFT : HIMC_RIGHT,
                         .nuance = HIMC_LEGATO,
                         .dynamic = 0.3,
                         .spot = HIMC_SPOT_NORMAL,
                         .bounces = 1,
                         .bounce_time = 0.25 / rate};
        TEST_ASSERT_TRUE_MESSAGE(himc_performance_add_stroke(p, &s, &error), error.text);
    }
    session_do(p, "play");
    session_play(p, 1.5 + 12 / (2 * rate), &h);
    TEST_ASSERT_EQUAL_INT(12, himc_performance_measure(p).played);
    for (int hand = 0; hand < 2; hand++) {
        TEST_ASSERT_EQUAL_INT(6, groups_of(&h, (himc_hand)hand, groups[hand]));
        for (int i = 0; i < 6; i++) {
            const group *g = &groups[hand][i];
            TEST_ASSERT_EQUAL_INT(2, g->count);
            worst = fmax(worst, fabs(4 * rate * (g->time[1] - g->time[0]) - 1));
            ratio += g->speed[1] / g->speed[0] / 12;
            gets_softer(g);
        }
    }
    printf("%s, doubles at %g Hz: intervals off by %.1f %% at most, %.2f of the speed\n", mode,
           rate, 100 * worst, ratio);
    TEST_ASSERT_TRUE(worst < 0.1);
    TEST_ASSERT_TRUE(ratio > 0.4 && ratio < 0.8);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_doubles_have_two_contacts_a_quarter_period_apart_at_4_to_12_Hz(void)
{
    plays_doubles("himc", 4);
    plays_doubles("id", 8);
    plays_doubles("ik", 8);
    plays_doubles("himc", 12);
}

#define ROLL_END 3.0 // of the press rolls (s)

// The last stroke of the roll has less time: three contacts or more, and all before the end. The
// head swings, more on a large drum and when loud, so contact by contact the mean gets softer.
static void plays_buzzes(const char *mode, const char *drum, const char *dynamic)
{
    himc_performance *p = session_new();
    heard h = {0};
    group groups[2][16] = {{{.count = 0}}};
    double mean[5] = {0}, last = 0;
    int strokes = 0, contacts = 0;
    session_do(p, "drum %s", drum);
    session_drum(p, 0, strstr(drum, "32") ? "tune C2" : "tune A2");
    session_do(p, "mode %s", mode);
    session_do(p, "tempo 60");
    session_do(p, "roll 1 2 press %s", dynamic);
    session_do(p, "play");
    session_play(p, 4.5, &h);
    for (int hand = 0; hand < 2; hand++) {
        int n = groups_of(&h, (himc_hand)hand, groups[hand]);
        for (int i = 0; i < n; i++, strokes++) {
            const group *g = &groups[hand][i];
            TEST_ASSERT_TRUE(g->count >= 3);
            for (int k = 1; k < g->count && k < 4; k++) // the soft ones after them may chatter
                TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.06, g->time[k] - g->time[k - 1]);
            for (int k = 0; k < g->count && k < 5; k++)
                mean[k] += g->speed[k];
            contacts += g->count;
        }
        last = fmax(last, groups[hand][n - 1].time[groups[hand][n - 1].count - 1]);
    }
    printf("%s, %s %s: %.1f contacts a stroke, the last %.0f ms before the end, speeds", mode, drum,
           dynamic, (double)contacts / strokes, 1e3 * (ROLL_END - last));
    for (int k = 0; k < 5; k++)
        printf(" %.2f", mean[k] / strokes);
    printf("\n");
    for (int k = 1; k < 5; k++)
        TEST_ASSERT_TRUE(mean[k] < mean[k - 1]);
    TEST_ASSERT_TRUE(contacts > 4.5 * strokes && last < ROLL_END);
    TEST_ASSERT_EQUAL_INT(himc_performance_measure(p).strokes, himc_performance_measure(p).played);
    TEST_ASSERT_TRUE(h.notes <= 1);
    TEST_ASSERT_TRUE(strokes > 8);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_strokes_of_a_press_roll_have_five_contacts_that_get_softer_and_end_in_time(void)
{
    plays_buzzes("himc", "kettle 26", "p");
    plays_buzzes("id", "kettle 26", "f");
    plays_buzzes("ik", "kettle 26", "mf");
    plays_buzzes("himc", "kettle 32", "pp");
    plays_buzzes("himc", "kettle 32", "mf");
}

// ornaments

static double time_of(const heard *h, int i, himc_hand hand)
{
    TEST_ASSERT_TRUE(i < h->strikes);
    TEST_ASSERT_EQUAL_INT(hand, h->strike[i].hand);
    return h->strike[i].time;
}

static int by_time(const void *a, const void *b)
{
    const himc_strike *x = a, *y = b;
    return (x->time > y->time) - (x->time < y->time);
}

static heard play_piece(const char *const lines[], double seconds, int block)
{
    himc_performance *p = with_kettle("himc");
    heard h = {0};
    himc_event event;
    for (int i = 0; lines[i]; i++)
        session_do(p, "%s", lines[i]);
    session_do(p, "play");
    for (long i = 0; i < lround(seconds * 48000); i += block) {
        himc_performance_process(p, block, NULL);
        while (himc_performance_event(p, &event))
            heard_event(&h, &event);
    }
    qsort(h.strike, (size_t)h.strikes, sizeof *h.strike, by_time);
    himc_performance_free(p);
    return h;
}

#define ABOUT(seconds, a, b) TEST_ASSERT_DOUBLE_WITHIN(0.0025, seconds, (b) - (a))

static void test_grace_notes_come_before_the_beat_by_their_hands_and_softer(void)
{
    static const char *const lines[] = {"tempo 80", "flam 2 right legato f",
                                        "drag 4 right legato f", "ruff 6 right legato f", NULL};
    heard h = play_piece(lines, 5.5, 480);
    TEST_ASSERT_EQUAL_INT(8, h.strikes);
    ABOUT(0.025, time_of(&h, 0, HIMC_LEFT), time_of(&h, 1, HIMC_RIGHT));
    ABOUT(0.040, time_of(&h, 2, HIMC_LEFT), time_of(&h, 3, HIMC_LEFT));
    ABOUT(0.080, time_of(&h, 2, HIMC_LEFT), time_of(&h, 4, HIMC_RIGHT));
    ABOUT(0.090, time_of(&h, 5, HIMC_LEFT), time_of(&h, 7, HIMC_RIGHT));
    ABOUT(0.045, time_of(&h, 6, HIMC_LEFT), time_of(&h, 7, HIMC_RIGHT));
    ABOUT(1.5, time_of(&h, 1, HIMC_RIGHT), time_of(&h, 4, HIMC_RIGHT));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.4, h.strike[0].velocity / h.strike[1].velocity);
    TEST_ASSERT_TRUE(isnan(h.strike[3].planned_time));
    heard_free(&h);
}

static void test_between_their_bounces_tips_are_on_their_targets(void)
{
    static const char *const roll[] = {"press f", "double f"};
    for (int i = 0; i < 2; i++) {
        himc_performance *p = session_new();
        session_do(p, "roll 1 2 %s", roll[i]);
        session_do(p, "play");
        session_play(p, 2.5, NULL);
        double percent = himc_performance_measure(p).tip_rms_percent;
        printf("%s: %.4f %% off\n", roll[i], percent);
        TEST_ASSERT_TRUE(percent < 0.01);
        himc_performance_free(p);
    }
}

static void test_with_the_servo_grip_nothing_bounces(void)
{
    static const char *const lines[] = {"grip servo", "drag 1 right legato f", NULL};
    static const char *const freed[] = {"grip french servo", "grip german", "drag 1 right legato f",
                                        NULL};
    heard servo = play_piece(lines, 1.8, 480), bounced = play_piece(freed, 1.8, 480);
    TEST_ASSERT_EQUAL_INT(2, servo.strikes);
    TEST_ASSERT_EQUAL_INT(3, bounced.strikes);
    heard_free(&servo);
    heard_free(&bounced);
}

static void keep_line(void *user, const char *text)
{
    strncat(user, text, 400);
}

static void test_info_tells_the_servo_grip(void)
{
    himc_performance *p = with_kettle("himc");
    char told[4096] = "";
    session_do(p, "grip french servo");
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, keep_line, told);
    TEST_ASSERT_NOT_NULL(strstr(told, "grip french servo,"));
    himc_performance_free(p);
}

static void test_ornaments_do_not_depend_on_the_block_size(void)
{
    static const char *const lines[] = {"roll 1 0.5 double mf", "drag 2 left legato f",
                                        "roll 2.5 1 press p f", NULL};
    heard a = play_piece(lines, 4, 64), b = play_piece(lines, 4, 1500);
    TEST_ASSERT_TRUE(a.strikes > 30);
    TEST_ASSERT_EQUAL_INT(a.strikes, b.strikes);
    TEST_ASSERT_EQUAL_MEMORY(a.strike, b.strike, (size_t)a.strikes * sizeof *a.strike);
    heard_free(&a);
    heard_free(&b);
}

static int strokes_of_roll(const char *dynamic, const char *tune)
{
    himc_performance *p = with_kettle("himc");
    session_drum(p, 0, tune);
    session_do(p, "roll 1 10 single %s", dynamic);
    heard h = {0};
    session_do(p, "play");
    session_play(p, 2.05, &h);
    himc_performance_free(p);
    int n = h.strikes;
    heard_free(&h);
    return n;
}

static void test_rolls_are_faster_when_loud_and_on_high_drums(void)
{
    int soft = strokes_of_roll("ppp", "tune A2"), loud = strokes_of_roll("f", "tune A2"),
        high = strokes_of_roll("f", "tune D3");
    printf("%d soft, %d loud, %d high strokes in a second\n", soft, loud, high);
    TEST_ASSERT_TRUE(soft < loud && loud < high);
    TEST_ASSERT_TRUE(soft >= 8 && high <= 16);
}

// the tempo doubles in the roll, and all of it is played again in a loop
static void test_rolls_follow_tempo_seek_and_loop(void)
{
    himc_performance *p = with_kettle("himc");
    heard h = {0};
    session_do(p, "roll 0 1 double mp");
    session_do(p, "loop 1");
    session_do(p, "play");
    session_play(p, 1.5, NULL);
    session_do(p, "tempo 90");
    session_do(p, "seek 0");
    session_play(p, 3, &h);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
    int asked = heard_asked(&h);
    printf("%d strokes, %d contacts\n", asked, h.strikes);
    // the rate of the roll stays: 8 a second and a little more
    TEST_ASSERT_TRUE(asked >= 24 && asked <= 30 && abs(h.strikes - 2 * asked) <= 2);
    heard_free(&h);
    himc_performance_free(p);
}

// the grace note of beat 0 comes before the round begins
static void test_in_a_loop_the_grace_notes_of_beat_0_come_at_the_end_of_the_round(void)
{
    static const char *const lines[] = {"tempo 240", "flam 0 right legato f",
                                        "drag 2 left legato f", "loop 1", NULL};
    heard h = play_piece(lines, 3.9, 480);
    int flams = 0;
    for (int i = 0; i + 4 < h.strikes; i += 5, flams++) {
        ABOUT(0.025, time_of(&h, i, HIMC_LEFT), time_of(&h, i + 1, HIMC_RIGHT));
        ABOUT(0.500, time_of(&h, i + 1, HIMC_RIGHT), time_of(&h, i + 4, HIMC_LEFT));
        ABOUT(0.750 * flams, time_of(&h, 1, HIMC_RIGHT), time_of(&h, i + 1, HIMC_RIGHT));
    }
    TEST_ASSERT_TRUE(flams >= 4);
    heard_free(&h);
}

static void test_a_roll_leaves_out_strokes_too_near_to_others_and_says_so(void)
{
    himc_performance *p = with_kettle("himc");
    heard h = {0};
    session_do(p, "stroke 1.5 right accent f");
    session_do(p, "roll 1 1 single mf");
    session_play(p, 0.1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.notes);
    TEST_ASSERT_NOT_NULL(strstr(h.note, "1 of its strokes left out"));
    TEST_ASSERT_FALSE(session_try(p, "roll 1 1000 single mf"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "expected 180 s"));
    TEST_ASSERT_FALSE(session_try(p, "roll 1 0 single mf"));
    TEST_ASSERT_FALSE(session_try(p, "roll 1 1 triple mf"));
    himc_stroke s = {.beat = 5, .dynamic = 0.5, .bounces = 2, .bounce_time = 0.05};
    TEST_ASSERT_FALSE(himc_performance_add_stroke(p, &s, &error));
    s.bounces = 1;
    s.bounce_time = 0.9;
    TEST_ASSERT_FALSE(himc_performance_add_stroke(p, &s, &error));
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_roll_for_no_drum_or_too_long_is_refused_and_makes_no_drum(void)
{
    himc_performance *p = with_kettle("himc");
    TEST_ASSERT_FALSE(session_try(p, "roll 4 2 double f pp normal other"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "other: no spot"), error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 1));
    TEST_ASSERT_FALSE(session_try(p, "roll 4 755 double f pp normal kettle"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "roll: LENGTH"), error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 1));
    TEST_ASSERT_TRUE_MESSAGE(session_try(p, "roll 4 2 double f pp normal kettle"), error.text);
    himc_performance_free(p);
}

static void test_a_roll_has_one_dynamic_or_two_and_a_place_or_none(void)
{
    himc_command c;
    struct {
        const char *text;
        double first, last;
        bool placed;
        const char *drum;
    } rolls[] = {{"roll 0 4 single mf", 4 / 7.0, 4 / 7.0, false, ""},
                 {"roll 0 4 double p ff rim", 2 / 7.0, 6 / 7.0, false, ""},
                 {"roll 0 4 press 0.25 0.5 kettle", 0.25, 0.5, false, "kettle"},
                 {"roll 0 4 press 0.25 0.5 0.125 kettle", 0.25, 0.25, true, "kettle"},
                 {"roll 0 4 press 0.25 1 0.5 0.125", 0.25, 1, true, ""}};
    for (int i = 0; i < 5; i++) {
        TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_PERFORMER, rolls[i].text, &error),
                                 error.text);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, rolls[i].first, c.stroke.dynamic);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, rolls[i].last, c.stroke.last_dynamic);
        TEST_ASSERT_EQUAL_INT(rolls[i].placed, c.stroke.spot == HIMC_SPOT_XY);
        TEST_ASSERT_EQUAL_STRING(rolls[i].drum, c.stroke.drum);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4, c.stroke.length);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_energy_of_a_bounce_never_grows_and_its_impacts_fall);
    RUN_TEST(test_bounces_end_in_time_also_without_a_head);
    RUN_TEST(test_a_double_comes_when_it_shall_unless_it_is_too_fast_for_fingers);
    RUN_TEST(test_doubles_have_two_contacts_a_quarter_period_apart_at_4_to_12_Hz);
    RUN_TEST(test_strokes_of_a_press_roll_have_five_contacts_that_get_softer_and_end_in_time);
    RUN_TEST(test_grace_notes_come_before_the_beat_by_their_hands_and_softer);
    RUN_TEST(test_between_their_bounces_tips_are_on_their_targets);
    RUN_TEST(test_with_the_servo_grip_nothing_bounces);
    RUN_TEST(test_info_tells_the_servo_grip);
    RUN_TEST(test_ornaments_do_not_depend_on_the_block_size);
    RUN_TEST(test_rolls_are_faster_when_loud_and_on_high_drums);
    RUN_TEST(test_rolls_follow_tempo_seek_and_loop);
    RUN_TEST(test_in_a_loop_the_grace_notes_of_beat_0_come_at_the_end_of_the_round);
    RUN_TEST(test_a_roll_leaves_out_strokes_too_near_to_others_and_says_so);
    RUN_TEST(test_a_roll_for_no_drum_or_too_long_is_refused_and_makes_no_drum);
    RUN_TEST(test_a_roll_has_one_dynamic_or_two_and_a_place_or_none);
    return UNITY_END();
}
