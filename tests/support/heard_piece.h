/// heard_piece.h: a fixed piece played by a performance, with all that is heard and seen of it, to
/// compare two performances bit by bit.
#ifndef HIMC_TESTS_HEARD_PIECE_H
#define HIMC_TESTS_HEARD_PIECE_H

#include "session.h"

#include "performance/performance_state.h"

#define LONGEST 48000 // samples of the piece
#define ROWS 300
#define STRIKES 16
#define DECLICK 0.0055 // a head brought to rest fades out so long (s)

/// What a piece sounds and looks like.
typedef struct heard_piece {
    himc_motion_row row[ROWS];
    himc_strike strike[STRIKES];
    double force[HIMC_HANDS][LONGEST], sound[LONGEST];
    int rows, strikes, samples;
    char info[2000];
    himc_performance_stats stats;
} heard_piece;

static inline void keep_row(void *user, const himc_motion_row *row)
{
    heard_piece *h = user;
    TEST_ASSERT_TRUE(h->rows < ROWS);
    h->row[h->rows++] = *row;
}

static inline void keep_line(void *user, const char *line)
{
    strncat(strcat(user, "\n"), line, 300);
}

static inline void take_events(himc_performance *p, heard_piece *h)
{
    himc_event event;
    while (himc_performance_event(p, &event))
        if (h && event.kind == HIMC_EVENT_STRIKE && h->strikes < STRIKES)
            h->strike[h->strikes++] = event.strike;
}

// plays the piece of the tests from the next step on
static inline void play_piece(himc_performance *p, double seconds, heard_piece *h)
{
    double rate = himc_performance_measure(p).sample_rate;
    himc_drum *kettle = himc_performance_drum(p, 0);
    int ahead = himc_clock_ahead(&p->clock);
    memset(h, 0, sizeof *h);
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, keep_line, h->info);
    take_events(p, NULL);
    himc_performance_on_motion(p, keep_row, h);
    session_do(p, "tempo 200");
    session_do(p, "stroke 0 left accent f");
    session_do(p, "stroke 1 right legato mf");
    session_do(p, "play");
    himc_performance_process(p, ahead, NULL);
    uint64_t begin = himc_drum_time(kettle);
    h->samples = (int)lround(seconds * rate);
    for (int done = 0; done < h->samples; done += 100) {
        int n = h->samples - done < 100 ? h->samples - done : 100;
        himc_performance_process(
            p, n, (double *[]){h->force[HIMC_LEFT] + done, h->force[HIMC_RIGHT] + done});
    }
    himc_drum_read(kettle, begin, h->samples, h->sound, NULL);
    take_events(p, h);
    h->stats = himc_performance_measure(p);
    himc_performance_on_motion(p, NULL, NULL);
}

static inline void check_piece(const heard_piece *want, const heard_piece *is, const char *story)
{
    int faded = (int)(DECLICK * want->stats.sample_rate);
    size_t bytes = (size_t)want->samples * sizeof(double);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(want->info, is->info, story);
    TEST_ASSERT_EQUAL_INT_MESSAGE(want->rows, is->rows, story);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(want->row, is->row, sizeof want->row, story);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(want->force[hand], is->force[hand], bytes, story);
    TEST_ASSERT_EQUAL_INT_MESSAGE(want->strikes, is->strikes, story);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(want->strike, is->strike, sizeof want->strike, story);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(want->sound + faded, is->sound + faded,
                                     bytes - (size_t)faded * sizeof(double), story);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&want->stats, &is->stats, sizeof want->stats, story);
}

#endif
