/// test_hits.c: hits land so long after their message as `latency` says, whatever the interval, the
/// hand and the block; what cannot land in time is counted; `play` waits for its first stroke.
#include "take_files.h"

#include "session.h"

#define RATE 48000.0
#define LATENCY 0.15 // (s) as a performer is made

static himc_performance *with_kettle(const char *latency)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "latency %s", latency);
    session_play(p, 0.6, NULL);
    return p;
}

/// A run of taps at equal intervals.
typedef struct taps {
    heard h;
    double latest; ///< largest |strike - (message + latency)| (s)
    double speed;  ///< mean of impact (m/s)
    int left;      ///< strikes of the left hand
} taps;

/// `count` messages "hit HAND how", each hand of the two in turn.
static taps tap(himc_performance *p, int count, double interval, double latency,
                const char *const hands[2], const char *how)
{
    taps r = {.speed = 0};
    double begin = himc_performance_measure(p).seconds;
    for (int i = 0; i < count; i++) {
        session_do(p, "hit %s %s", hands[i % 2], how);
        session_play(p, interval, &r.h);
    }
    session_play(p, latency + 0.1, &r.h);
    for (int i = 0; i < r.h.strikes; i++) {
        double since = r.h.strike[i].time - begin - latency;
        r.latest = fmax(r.latest, fabs(since - interval * round(since / interval)));
        r.speed += r.h.strike[i].velocity / r.h.strikes;
        r.left += r.h.strike[i].hand == HIMC_LEFT;
    }
    return r;
}

static const char *const right[] = {"right", "right"}, *const both[] = {"left", "right"},
                         *const any[] = {"any", "any"};

static void test_taps_land_evenly_at_all_intervals_with_one_hand_and_two(void)
{
    static const double interval[] = {0.4, 0.25, 0.15, 0.1};
    static const char *const *const hands[] = {right, both, any};
    static const char *const how[] = {"legato mf", "accent ff", "staccato pp rim"};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 4; i++) {
            himc_performance *p = with_kettle("150");
            taps r = tap(p, 8, interval[i], LATENCY, hands[k], how[(i + k) % 3]);
            printf("%s, %s every %.0f ms: %d landed, %.3f ms off, %.2f m/s\n", hands[k][0],
                   how[(i + k) % 3], 1e3 * interval[i], r.h.strikes, 1e3 * r.latest, r.speed);
            TEST_ASSERT_EQUAL_INT(8, r.h.strikes);
            TEST_ASSERT_TRUE(r.latest <= 0.0005);
            TEST_ASSERT_TRUE_MESSAGE(r.h.notes <= r.h.softer + 1, r.h.note); // hands that pass
            TEST_ASSERT_TRUE(r.h.softer <= 1);
            heard_free(&r.h);
            himc_performance_free(p);
        }
}

static void test_a_run_too_fast_for_its_hand_is_shared_and_a_roll_of_hits_is_counted(void)
{
    himc_performance *p = with_kettle("150");
    taps r = tap(p, 12, 0.05, LATENCY, right, "legato mf");
    TEST_ASSERT_EQUAL_INT(12, r.h.strikes);
    TEST_ASSERT_EQUAL_INT(6, r.left);
    TEST_ASSERT_TRUE(r.latest <= 0.0005);
    // the other hand, once, and that mf is too much
    TEST_ASSERT_EQUAL_INT(r.h.softer + 1, r.h.notes);
    heard_free(&r.h);
    session_play(p, 2, NULL);
    r = tap(p, 40, 0.01, LATENCY, right, "legato mf");
    session_play(p, 2, &r.h);
    char line[80];
    snprintf(line, sizeof line, "hit: %d given up, no hand had the time", 40 - r.h.strikes);
    TEST_ASSERT_TRUE(r.h.strikes >= 8 && r.h.strikes < 40);
    TEST_ASSERT_TRUE(r.latest <= 0.0005);
    TEST_ASSERT_EQUAL_INT(1 + r.h.softer, r.h.notes);
    TEST_ASSERT_EQUAL_STRING(line, r.h.note);
    heard_free(&r.h);
    himc_performance_free(p);
}

static void test_any_hand_is_the_other_one_in_a_fast_run_and_so_louder(void)
{
    const double latency = 0.33; // time for all of its strength
    himc_performance *p = with_kettle("330"), *q = with_kettle("330");
    taps one = tap(p, 10, 0.07, latency, right, "legato f"),
         two = tap(q, 10, 0.07, latency, any, "legato f");
    for (int i = 1; i < two.h.strikes; i++)
        TEST_ASSERT_NOT_EQUAL(two.h.strike[i - 1].hand, two.h.strike[i].hand);
    TEST_ASSERT_TRUE(two.speed > 1.3 * one.speed);
    heard_free(&one.h);
    heard_free(&two.h);
    himc_performance_free(p);
    himc_performance_free(q);
}

// as a player does, at any tempo; two drums are played by sides
static void test_any_hand_goes_from_hand_to_hand_on_one_drum(void)
{
    static const double interval[] = {0.1, 0.2, 0.3, 0.5, 1, 1.5};
    static const char *const how[] = {"legato mf", "accent f rim", "staccato p center"};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 6; i++) {
            himc_performance *p = with_kettle("150");
            taps r = tap(p, 6, interval[i], LATENCY, any, how[k]);
            TEST_ASSERT_EQUAL_INT(6, r.h.strikes);
            TEST_ASSERT_EQUAL_INT(3, r.left);
            for (int n = 1; n < 6; n++) {
                TEST_ASSERT_NOT_EQUAL(r.h.strike[n - 1].hand, r.h.strike[n].hand);
                TEST_ASSERT_DOUBLE_WITHIN(0.06 * r.speed, r.speed, r.h.strike[n].velocity);
            }
            heard_free(&r.h);
            himc_performance_free(p);
        }
}

static void test_any_hand_is_that_of_the_side_on_two_drums(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = session_new();
    session_do(p, "drum west");
    session_do(p, "drum east");
    session_do(p, "west place 0.6 0.36 0.85");
    session_do(p, "east place 0.6 -0.36 0.85");
    session_play(p, 0.6, NULL);
    for (int i = 0; i < 8; i++) {
        session_do(p, "hit any legato mf %s", i % 2 ? "west" : "east");
        session_play(p, 0.4, &h);
    }
    for (int i = 0; i < h.strikes; i++)
        TEST_ASSERT_EQUAL_INT(strcmp(h.strike[i].drum, "west") == 0 ? HIMC_LEFT : HIMC_RIGHT,
                              h.strike[i].hand);
    TEST_ASSERT_EQUAL_INT(8, h.strikes);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_hit_is_as_strong_as_its_latency_allows(void)
{
    static const char *const latency[] = {"80", "150", "auto"}, *const dynamic[] = {"p", "ff"};
    static const double seconds[] = {0.08, 0.15, 0.33};
    double speed[2][3];
    for (int d = 0; d < 2; d++)
        for (int i = 0; i < 3; i++) {
            char how[32];
            himc_performance *p = with_kettle(latency[i]);
            snprintf(how, sizeof how, "legato %s", dynamic[d]);
            taps r = tap(p, 2, 0.8, seconds[i], right, how);
            TEST_ASSERT_EQUAL_INT(2, r.h.strikes);
            TEST_ASSERT_TRUE(r.latest <= 0.0005);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, seconds[i], himc_performance_measure(p).hit_latency);
            speed[d][i] = r.speed;
            heard_free(&r.h);
            himc_performance_free(p);
        }
    printf("ff after 80 ms %.2f, 150 ms %.2f, auto %.2f m/s\n", speed[1][0], speed[1][1],
           speed[1][2]);
    TEST_ASSERT_TRUE(speed[0][0] > 0.95 * speed[0][2]);
    TEST_ASSERT_TRUE(speed[1][1] > 1.15 * speed[1][0] && speed[1][2] > 1.15 * speed[1][1]);
    TEST_ASSERT_TRUE(speed[1][2] > 4.9); // 5.1 asked
}

/// Plays hits at samples that are not the beginnings of steps, in blocks of that size.
static void play_blocks(int block, double *sound, int count, heard *h)
{
    himc_performance *p = session_new();
    himc_command hit;
    himc_event event;
    session_do(p, "drum kettle");
    TEST_ASSERT_TRUE(himc_command_parse_text(&hit, HIMC_PERFORMER, "hit any legato mf", &error));
    for (int done = 0; done < count; done += block) {
        int due = 20000 + 5003 * ((done - 20000 + 5002) / 5003);
        if (due < 20000)
            due = 20000;
        for (; due < done + block; due += 5003)
            TEST_ASSERT_TRUE(himc_performance_command(p, &hit, due - done, &error));
        himc_performance_process(p, block, NULL);
        himc_drum_read(himc_performance_drum(p, 0), (uint64_t)done, block, sound + done, NULL);
        while (himc_performance_event(p, &event))
            heard_event(h, &event);
    }
    himc_performance_free(p);
}

static void test_the_sample_of_the_message_counts_in_blocks_of_any_size(void)
{
    enum { COUNT = 61440 };
    static double one[COUNT], other[COUNT];
    heard h = {0};
    play_blocks(64, one, COUNT, &h);
    TEST_ASSERT_TRUE(h.strikes >= 6);
    for (int i = 0; i < h.strikes; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, (20000 + 5003 * i) / RATE + LATENCY,
                                  h.strike[i].planned_time);
    heard_free(&h);
    play_blocks(1, other, COUNT, &h);
    TEST_ASSERT_EQUAL_MEMORY(one, other, sizeof one);
    play_blocks(4096, other, COUNT, &h);
    TEST_ASSERT_EQUAL_MEMORY(one, other, sizeof one);
    heard_free(&h);
}

static void test_hits_leave_the_strokes_of_a_score_alone(void)
{
    himc_performance *p = with_kettle("150");
    session_do(p, "tempo 60");
    for (int i = 0; i < 8; i++)
        session_do(p, "stroke %g left tenuto f", 1 + 0.15 * i);
    session_do(p, "play");
    taps r = tap(p, 40, 0.05, LATENCY, right, "legato mf");
    int left = 0;
    for (int i = 0; i < r.h.strikes; i++)
        left += strcmp(r.h.strike[i].nuance, "tenuto") == 0;
    TEST_ASSERT_EQUAL_INT(8, left);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
    heard_free(&r.h);
    himc_performance_free(p);
}

static void test_a_drum_too_far_for_the_latency_is_struck_late_and_a_line_says_by_how_much(void)
{
    himc_performance *p = with_kettle("100");
    heard h = {0};
    session_do(p, "drum far");
    session_drum(p, 1, "place 0.25 -0.84 0.85");
    session_play(p, 0.5, NULL);
    session_do(p, "hit right legato mf normal far");
    session_play(p, 2, &h);
    double late = himc_performance_measure(p).hit_latency - 0.1;
    char line[80];
    snprintf(line, sizeof line, "hit: 1 late by up to %.0f ms, no hand had the time", 1e3 * late);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    TEST_ASSERT_TRUE(late > 0.02 && late < 0.2);
    TEST_ASSERT_DOUBLE_WITHIN(0.0005, h.strike[0].planned_time, h.strike[0].time);
    TEST_ASSERT_EQUAL_INT(1, h.notes);
    TEST_ASSERT_EQUAL_STRING(line, h.note);
    heard_free(&h);
    session_do(p, "latency auto");
    session_do(p, "hit right legato mf normal far");
    session_play(p, 2, &h);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.33, himc_performance_measure(p).hit_latency);
    TEST_ASSERT_EQUAL_INT(0, h.notes);
    heard_free(&h);
    himc_performance_free(p);
}

// the left hand is at the right; the right one would be there 10 ms sooner, but reach across for it
static void test_a_late_hit_stays_with_the_hand_that_was_asked_for(void)
{
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "drum tom 23");
    session_do(p, "drum tam 23");
    session_do(p, "target right 0.447 -0.227 1.165");
    session_do(p, "target left 0.45 -0.25 0.878");
    session_play(p, 2, NULL);
    session_do(p, "hit left legato mf normal tam");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    TEST_ASSERT_EQUAL_INT(HIMC_LEFT, h.strike[0].hand);
    TEST_ASSERT_EQUAL_INT(1, himc_performance_measure(p).played);
    heard_free(&h);
    himc_performance_free(p);
}

// half a newton that control does not know of carries the stick 1 mm away; the last 10 ms of the
// plan begin where it is
static void test_a_stick_that_drifts_is_brought_back_before_it_lands(void)
{
    himc_performance *p = with_kettle("150");
    session_do(p, "push right-stick 0 0 0.5 9");
    taps r = tap(p, 12, 0.1, LATENCY, right, "legato ff");
    printf("pushed: %.3f ms off\n", 1e3 * r.latest);
    TEST_ASSERT_EQUAL_INT(12, r.h.strikes);
    TEST_ASSERT_TRUE(r.latest < 0.0003);
    heard_free(&r.h);
    himc_performance_free(p);
}

static void test_the_hand_that_a_take_leaves_free_plays_what_any_hand_may(void)
{
    static const char name[] = "build/hits.trc";
    himc_performance *p = with_kettle("150");
    heard h = {0};
    TEST_ASSERT_TRUE(write_one_hand(name));
    session_do(p, "take %s", name);
    session_do(p, "play");
    session_play(p, 1.5, NULL);
    TEST_ASSERT_FALSE(session_try(p, "hit right legato mf"));
    session_do(p, "hit any tenuto mf");
    for (int i = 0; i < 4; i++) // too fast for one hand, and the other one is away
        session_do(p, "hit left tenuto mf");
    session_play(p, 1.5, &h);
    TEST_ASSERT_EQUAL_STRING("hit: 4 given up, no hand had the time", h.note);
    int hits = 0;
    for (int i = 0; i < h.strikes; i++)
        if (strcmp(h.strike[i].nuance, "tenuto") == 0) {
            hits++;
            TEST_ASSERT_EQUAL_INT(HIMC_LEFT, h.strike[i].hand);
        }
    TEST_ASSERT_EQUAL_INT(1, hits);
    TEST_ASSERT_TRUE(h.strikes > 1);
    heard_free(&h);
    himc_performance_free(p);
    unlink(name);
}

static void test_play_prepares_the_first_stroke_without_a_line_and_tells_beat_0_when_it_sounds(void)
{
    himc_performance *p = with_kettle("150");
    heard h = {0};
    double told = 0;
    session_do(p, "stroke 0 right legato f");
    session_do(p, "stroke 1 left legato f");
    session_do(p, "play");
    while (h.strikes == 0) {
        session_play(p, 0.01, &h);
        if (h.beats == 1 && told == 0)
            told = himc_performance_measure(p).seconds;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.0101, h.strike[0].planned_time, told); // a block
    session_play(p, 4, &h);
    TEST_ASSERT_EQUAL_INT(2, h.strikes);
    TEST_ASSERT_EQUAL_INT(0, h.notes);
    heard_free(&h);
    himc_performance_free(p);
}

/// The score's strikes are on the spots as written, whenever a hit is asked for between them.
static void test_a_hit_moves_no_stroke_of_the_playing_score_aside(void)
{
    static const struct {
        const char *hit;
        double at; // (s) after play
    } asked[] = {{"hit left legato f", 0.69},
                 {"hit left legato f", 0.7},
                 {"hit right legato f", 1.27},
                 {"hit right legato f", 1.3}};
    for (int i = 0; i < 4; i++) {
        heard h = {0};
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        session_do(p, "tempo 100");
        for (int beat = 0; beat < 5; beat++)
            session_do(p, "stroke %d %s legato mf", beat, beat % 2 ? "left" : "right");
        session_play(p, 0.01, NULL);
        session_do(p, "play");
        session_play(p, asked[i].at, &h);
        session_do(p, "%s", asked[i].hit);
        session_play(p, 3.2 - asked[i].at, &h);
        TEST_ASSERT_EQUAL_INT(6, h.strikes);
        for (int k = 1; k < h.strikes; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(0.002, h.strike[0].x, h.strike[k].x);
            TEST_ASSERT_DOUBLE_WITHIN(0.002, fabs(h.strike[0].y), fabs(h.strike[k].y));
        }
        heard_free(&h);
        himc_performance_free(p);
    }
}

/// Nor softer: a hand that has no time for both leaves the hit to the other one.
static void test_a_hit_makes_no_stroke_of_the_playing_score_softer(void)
{
    for (int gap = 60; gap <= 200; gap += 35) { // ms before the third stroke
        heard h = {0};
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        session_do(p, "tempo 60");
        for (int beat = 0; beat < 4; beat++)
            session_do(p, "stroke %d right legato f", beat);
        session_do(p, "play");
        session_play(p, 1, &h);
        double third = h.strike[0].time + 2;
        session_play(p, third - 0.15 - 1e-3 * gap - himc_performance_measure(p).seconds, &h);
        session_do(p, "latency 150");
        session_do(p, "hit right legato f");
        session_play(p, 2, &h);
        TEST_ASSERT_EQUAL_INT(5, h.strikes);
        for (int k = 1; k < h.strikes; k++)
            if (h.strike[k].beat >= 0)
                TEST_ASSERT_DOUBLE_WITHIN(0.03 * h.strike[0].velocity, h.strike[0].velocity,
                                          h.strike[k].velocity);
        heard_free(&h);
        himc_performance_free(p);
    }
}

// anywhere on the head and beyond it: what lands more than 2 cm beside the place of a point on the
// head, or is not played, has a line
static void test_a_hit_elsewhere_than_asked_is_told(void)
{
    static const double place[][2] = {{0, 0},    {0.2, 0},   {0.22, 0},   {0.25, 0},
                                      {0.3, 0},  {0.5, 0},   {-0.5, 0.1}, {0, 0.32},
                                      {0, -0.4}, {0.2, 0.2}, {-0.3, 0}};
    int aside = 0;
    for (size_t i = 0; i < sizeof place / sizeof *place; i++)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_performance *p = with_kettle("150");
            heard h = {.strikes = 0};
            session_do(p, "hit %s legato f %g %g", himc_hand_name((himc_hand)hand), place[i][0],
                       place[i][1]);
            session_play(p, 0.8, &h);
            bool off = heard_asked(&h) == 0;
            for (int k = 0; k < h.strikes; k++) {
                const himc_strike *s = &h.strike[k];
                off = off || hypot(s->x - place[i][0], s->y - place[i][1]) > 0.02;
                TEST_ASSERT_TRUE(isnan(s->beat)); // it is on none
            }
            aside += off;
            TEST_ASSERT_TRUE_MESSAGE(!off || strstr(h.all, "landed at") ||
                                         strstr(h.all, "beyond the rim") ||
                                         strstr(h.all, "out of reach"),
                                     h.all);
            heard_free(&h);
            himc_performance_free(p);
        }
    TEST_ASSERT_TRUE(aside >= 8); // those beyond the rim, at least
}

/// A hit by either hand at a time of the session.
typedef struct timed_hit {
    double at; // (s)
    const char *drum;
} timed_hit;

/// A performer with four drums, where they stand by themselves or in an arc in front.
static himc_performance *with_four(bool arc)
{
    static const char *const drum[] = {"second 29", "third 26", "low 32", "high 23"},
                             *const place[] = {
                                 "second place 0.832 0.287 0.85", "third place 0.763 -0.439 0.85",
                                 "low place 0.251 0.843 0.85", "high place 0.251 -0.843 0.85"};
    himc_performance *p = session_new();
    for (int i = 0; i < 4; i++) {
        session_do(p, "drum %s", drum[i]);
        if (arc)
            session_do(p, "%s", place[i]);
    }
    return p;
}

/// Plays hits up to the first without a drum, and a second more.
static void play_hits(himc_performance *p, const timed_hit *hit, heard *h)
{
    for (; hit->drum; hit++) {
        session_play(p, hit->at - himc_performance_measure(p).seconds, h);
        session_do(p, "hit any legato mf %s", hit->drum);
    }
    session_play(p, 1, h);
}

// drums on both sides of the player, one a little behind: the trunk turns to none of them alone, so
// no arm is folded up on its way
static void test_no_arm_whips_from_drum_to_drum_where_they_stand_by_themselves(void)
{
    static const timed_hit hits[][9] = {
        {{0.5, "second"}, {1, "third"}, {4, "low"}, {4.5, "high"}, {5, "low"}, {6.2, "second"}},
        {{0.5, "second"},
         {1, "third"},
         {4, "low"},
         {4.5, "high"},
         {5, "low"},
         {5.4, "third"},
         {5.8, "high"},
         {6.2, "second"}},
        {{0.5, "second"}, {1, "third"}, {2.5, "low"}, {3, "high"}, {3.5, "high"}, {3.9, "second"}}};
    for (int i = 0; i < 3; i++) {
        heard h = {.strikes = 0};
        himc_performance *p = with_four(false);
        play_hits(p, hits[i], &h);
        himc_performance_stats m = himc_performance_measure(p);
        printf("%d strikes, %.0f rad/s\n", h.strikes, m.peak_rate);
        TEST_ASSERT_EQUAL_INT(i == 1 ? 8 : 6, heard_asked(&h));
        TEST_ASSERT_TRUE(m.peak_rate < 80); // half of what a person can
        heard_free(&h);
        himc_performance_free(p);
    }
}

// along four drums in an arc: each hit by the hand of its side or the one that comes from next to
// it, and no later than that hand would be if it were asked for
static void test_any_hand_along_an_arc_of_drums_crosses_nothing_and_is_as_early_as_can_be(void)
{
    static const char *const drum[] = {"low", "second", "third", "high"};
    static const double interval[] = {0.4, 0.3, 0.25};
    for (int k = 0; k < 3; k++) {
        timed_hit hit[9] = {{0}};
        heard h = {.strikes = 0};
        himc_performance *p = with_four(true);
        for (int i = 0; i < 8; i++)
            hit[i] = (timed_hit){0.5 + interval[k] * i, drum[i < 4 ? i : 7 - i]};
        play_hits(p, hit, &h);
        TEST_ASSERT_EQUAL_INT(8, h.strikes);
        for (int i = 0; i < 8; i++) {
            double late = h.strike[i].time - hit[i].at - LATENCY;
            printf("%s %s %.0f ms late\n", himc_hand_name(h.strike[i].hand), hit[i].drum,
                   1e3 * late);
            TEST_ASSERT_EQUAL_STRING(hit[i].drum, h.strike[i].drum);
            TEST_ASSERT_TRUE(late < 0.015);
            if (strcmp(hit[i].drum, "low") == 0)
                TEST_ASSERT_EQUAL_INT(HIMC_LEFT, h.strike[i].hand);
            if (strcmp(hit[i].drum, "high") == 0)
                TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, h.strike[i].hand);
        }
        heard_free(&h);
        himc_performance_free(p);
    }
}

// the other hand is over the neighbour at first: from the third stroke on they take turns
static void test_any_hand_takes_turns_on_a_drum_after_strokes_on_its_neighbour(void)
{
    static const timed_hit hit[] = {{0.5, "second"}, {0.5, "third"}, {1.5, "third"},
                                    {1.6, "third"},  {1.7, "third"}, {1.8, "third"},
                                    {1.9, "third"},  {2, "third"},   {0, NULL}};
    heard h = {.strikes = 0};
    himc_performance *p = with_four(false);
    play_hits(p, hit, &h);
    TEST_ASSERT_EQUAL_INT(8, h.strikes);
    for (int i = 2; i < 8; i++) {
        printf("%s %.2f m/s %.0f ms late\n", himc_hand_name(h.strike[i].hand), h.strike[i].velocity,
               1e3 * (h.strike[i].time - hit[i].at - LATENCY));
        TEST_ASSERT_DOUBLE_WITHIN(0.0005, hit[i].at + LATENCY, h.strike[i].time);
        TEST_ASSERT_TRUE(i < 4 || h.strike[i].hand != h.strike[i - 1].hand);
    }
    heard_free(&h);
    himc_performance_free(p);
}

// a stranger's first message: the trunk has to bend for it, and the stick missed the head
static void test_a_hit_beyond_the_centre_comes_when_the_body_can_be_there(void)
{
    static const char *const hit[] = {"hit left tenuto mf 0.24 0", "hit right tenuto mf 0.24 0",
                                      "hit left legato mf 0.18 -0.23"};
    for (int i = 0; i < 6; i++) {
        heard h = {.strikes = 0};
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        session_do(p, "latency %d", i % 2 ? 150 : 60);
        session_do(p, "%s", hit[i / 2]);
        session_play(p, 1, &h);
        TEST_ASSERT_EQUAL_INT(1, h.strikes);
        TEST_ASSERT_DOUBLE_WITHIN(0.005, i < 4 ? 0.24 : 0.18, h.strike[0].x);
        heard_free(&h);
        himc_performance_free(p);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_taps_land_evenly_at_all_intervals_with_one_hand_and_two);
    RUN_TEST(test_a_run_too_fast_for_its_hand_is_shared_and_a_roll_of_hits_is_counted);
    RUN_TEST(test_any_hand_is_the_other_one_in_a_fast_run_and_so_louder);
    RUN_TEST(test_any_hand_goes_from_hand_to_hand_on_one_drum);
    RUN_TEST(test_any_hand_is_that_of_the_side_on_two_drums);
    RUN_TEST(test_a_hit_is_as_strong_as_its_latency_allows);
    RUN_TEST(test_the_sample_of_the_message_counts_in_blocks_of_any_size);
    RUN_TEST(test_hits_leave_the_strokes_of_a_score_alone);
    RUN_TEST(test_a_drum_too_far_for_the_latency_is_struck_late_and_a_line_says_by_how_much);
    RUN_TEST(test_a_late_hit_stays_with_the_hand_that_was_asked_for);
    RUN_TEST(test_a_stick_that_drifts_is_brought_back_before_it_lands);
    RUN_TEST(test_the_hand_that_a_take_leaves_free_plays_what_any_hand_may);
    RUN_TEST(test_play_prepares_the_first_stroke_without_a_line_and_tells_beat_0_when_it_sounds);
    RUN_TEST(test_a_hit_moves_no_stroke_of_the_playing_score_aside);
    RUN_TEST(test_a_hit_makes_no_stroke_of_the_playing_score_softer);
    RUN_TEST(test_a_hit_elsewhere_than_asked_is_told);
    RUN_TEST(test_no_arm_whips_from_drum_to_drum_where_they_stand_by_themselves);
    RUN_TEST(test_any_hand_along_an_arc_of_drums_crosses_nothing_and_is_as_early_as_can_be);
    RUN_TEST(test_any_hand_takes_turns_on_a_drum_after_strokes_on_its_neighbour);
    RUN_TEST(test_a_hit_beyond_the_centre_comes_when_the_body_can_be_there);
    return UNITY_END();
}
