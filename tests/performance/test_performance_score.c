/// test_performance_score.c: lines of a score that act on its strokes: hits, a take, a first beat;
/// and a take with exchanged sides.
#include "take_players.h"

#include "session.h"

#include "capture/take.h"

#define BVH "build/score-take.bvh"
#define TRC "build/score-take.trc"
#define SCORE "build/score-of-it.txt"
#define RECORD "build/score-record.bvh"
#define STATE 30000 // of the lines that dump tells, as bytes

static void write_text(const char *text)
{
    FILE *file = fopen(SCORE, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

static himc_take *made_take(const char *path)
{
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_take *take = beaten_file(path, &skeleton, 100, 1, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static void save(himc_take *take, const char *path)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, path, &error), error.text);
    himc_take_free(take);
}

// what a performer with nothing else to do makes of a score
static heard play_score(const char *text, double seconds)
{
    heard h = {0};
    himc_performance *p = session_new();
    write_text(text);
    session_do(p, "score " SCORE);
    session_play(p, seconds, &h);
    himc_performance_free(p);
    return h;
}

static void test_a_hit_in_a_score_is_played_when_it_is_loaded(void)
{
    heard h = play_score("drum kettle; hit right legato mf;", 0.6);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, h.strike[0].hand);
    heard_free(&h);
}

static void test_a_score_begins_at_its_seek(void)
{
    static const char *const text[] = {
        "tempo 240; stroke 0 left legato mf; stroke 2 right accent mf;"
        "stroke 3 left tenuto mf; play;",
        "tempo 240; seek 2; stroke 0 left legato mf; stroke 2 right accent mf;"
        "stroke 3 left tenuto mf; play;"};
    for (int i = 0; i < 2; i++) {
        heard h = play_score(text[i], 1.5);
        TEST_ASSERT_EQUAL_INT(i ? 2 : 3, h.strikes);
        TEST_ASSERT_EQUAL_STRING(i ? "accent" : "legato", h.strike[0].nuance);
        heard_free(&h);
    }
}

static void test_a_take_in_a_score_without_strokes_is_played(void)
{
    save(made_take(BVH), BVH);
    heard h = play_score("drum kettle;\ntake " BVH ";\nplay;\n", 2.1);
    TEST_ASSERT_EQUAL_INT(4, h.strikes);
    heard_free(&h);
}

static void test_a_take_in_a_score_with_strokes_is_refused_with_its_line(void)
{
    save(made_take(BVH), BVH);
    himc_performance *p = session_new();
    write_text("drum kettle;\ntake " BVH ";\nstroke 1 left legato mf;\n");
    TEST_ASSERT_FALSE(session_try(p, "score " SCORE));
    TEST_ASSERT_EQUAL_STRING(SCORE ":2: take: a score with strokes cannot play a take", error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 0));
    himc_performance_free(p);
}

// the notes of a command
static const char *notes_of(himc_performance *p, const char *command)
{
    static char text[4000];
    himc_event event;
    text[0] = 0;
    session_do(p, "%s", command);
    while (himc_performance_event(p, &event))
        if (event.kind == HIMC_EVENT_NOTE)
            strcat(strcat(text, event.text), "\n");
    return text;
}

static void test_repairs_of_a_take_are_told_when_it_is_loaded(void)
{
    himc_take *take = made_take(TRC);
    int tip = himc_take_find(take, "LeftStick_end");
    if (tip < 0)
        for (int i = 0; i < himc_take_points(take); i++)
            puts(himc_take_point_name(take, i));
    TEST_ASSERT_TRUE(tip >= 0);
    for (int f = 20; f < 24; f++)
        *himc_take_at(take, f, tip) = himc_vec3_make(NAN, NAN, NAN);
    save(take, TRC);
    himc_performance *p = session_new();
    const char *notes = notes_of(p, "take " TRC);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(notes, TRC ": LeftStick_end is missing in 4 frames, which are filled"), notes);
    himc_performance_free(p);
}

static void test_a_take_of_three_frames_is_refused(void)
{
    himc_performance *p = session_new();
    FILE *file = fopen(TRC, "w");
    fputs("PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t3\t1\tmm\n"
          "Frame#\tTime\tR_Stick_Tip\t\t\n\n"
          "1\t0\t500\t900\t0\n2\t0.01\t500\t910\t0\n3\t0.02\t500\t930\t0\n",
          file);
    fclose(file);
    TEST_ASSERT_FALSE(session_try(p, "take " TRC));
    TEST_ASSERT_EQUAL_STRING(TRC ": 3 frames, expected 8 or more", error.text);
    himc_performance_free(p);
}

static void test_units_of_a_take_without_strokes_and_too_many_units_are_refused(void)
{
    himc_performance *p = session_new();
    himc_take *take = made_take(TRC);
    save(take, TRC);
    int loaded = 0;
    while (loaded < 300 && session_try(p, "units " TRC " legato"))
        loaded++;
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, " more, expected 256 in all"), error.text);
    TEST_ASSERT_TRUE(loaded >= 256 / 8 && loaded < 256);
    session_do(p, "units clear");
    take = made_take(TRC);
    for (int f = 1; f < himc_take_frames(take); f++)
        for (int i = 0; i < himc_take_points(take); i++)
            *himc_take_at(take, f, i) = *himc_take_at(take, 0, i);
    save(take, TRC);
    TEST_ASSERT_FALSE(session_try(p, "units " TRC " legato"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, TRC), error.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(error.text, "0 strokes, expected at least one that is a clear fall"), error.text);
    himc_performance_free(p);
}

// markers named as if the player's left were right: so the player looks away from the drum
static void exchange_sides(himc_take *take)
{
    for (int i = 0; i < take->points; i++) {
        char *name = take->names[i], rest[TAKE_NAME];
        bool left = strncmp(name, "Left", 4) == 0, right = strncmp(name, "Right", 5) == 0;
        if (!left && !right)
            continue;
        snprintf(rest, sizeof rest, "%s", name + (left ? 4 : 5));
        snprintf(name, TAKE_NAME, "%s%.50s", left ? "Right" : "Left", rest);
    }
}

static void test_a_take_with_left_and_right_exchanged_is_refused(void)
{
    for (int exchanged = 0; exchanged < 2; exchanged++) {
        himc_take *take = made_take(TRC);
        if (exchanged)
            exchange_sides(take);
        save(take, TRC);
        himc_performance *p = session_new();
        bool played = session_try(p, "take " TRC);
        TEST_ASSERT_EQUAL_MESSAGE(!exchanged, played, error.text);
        TEST_ASSERT_EQUAL_STRING(exchanged ? TRC ": the sticks strike 0.76 m behind the player, "
                                                 "expected in front: are left and right exchanged?"
                                           : "",
                                 error.text);
        himc_performance_free(p);
    }
}

static void keep_line(void *user, const char *line)
{
    char *all = user;
    size_t used = strlen(all);
    snprintf(all + used, STATE - used, "%s\n", line);
}

static const char *state_of(const himc_performance *p, char *all)
{
    all[0] = 0;
    himc_performance_describe(p, HIMC_DESCRIBE_STATE, keep_line, all);
    TEST_ASSERT_TRUE(strlen(all) < STATE - 1);
    return all;
}

// each is refused for a reason that lies in the state, not in the line
static void test_a_score_that_is_refused_names_its_line_and_changes_nothing(void)
{
    static const struct {
        const char *first, *bad, *why;
    } scores[] = {
        {"", "record stop", "record: stop: nothing is being recorded, expected FILE"},
        {"record " RECORD ";", "record " RECORD, "already recording, expected stop"},
        {"record " RECORD ";", "rate task 100", "rate task: 100: not possible while recording"},
        {"record " RECORD "; record stop;", "record stop", "nothing is being recorded"},
        {"record " RECORD "; reset;", "record stop", "nothing is being recorded"},
        {"", "push nose 1 0 0 0.1", "push: SEGMENT: nose, expected"},
        {"", "at 2 push nose 1 0 0 0.1", "push: SEGMENT: nose, expected"},
        {"", "at 2 push head 1 0 0", "push: SECONDS"},
        {"", "at 2 tempo 100", "at"},
        {"", "roll 4 755 single f", "roll: LENGTH: 588.3 s at this tempo, expected 180 s"},
        {"", "take " TRC, "are left and right exchanged?"},
        {"", "units " BVH " legato", "expected 256 in all"},
        {"", "tom dump " RECORD, "dump: not allowed in a score"},
        {"", "tom preset x", "preset: not allowed in a score"}};
    char text[600], before[STATE], after[STATE];
    save(made_take(BVH), BVH);
    himc_take *take = made_take(TRC);
    exchange_sides(take);
    save(take, TRC);
    for (size_t i = 0; i < sizeof scores / sizeof *scores; i++) {
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        for (bool more = strstr(scores[i].bad, "units"); more;)
            more = session_try(p, "units " BVH " legato");
        snprintf(text, sizeof text, "drum tom 26; grip french;\n%s\n%s;\ntempo 77;\n",
                 scores[i].first, scores[i].bad);
        write_text(text);
        state_of(p, before);
        TEST_ASSERT_FALSE_MESSAGE(session_try(p, "score " SCORE), scores[i].bad);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, SCORE ":3: "), error.text);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, scores[i].why), error.text);
        TEST_ASSERT_EQUAL_STRING(before, state_of(p, after));
        TEST_ASSERT_FALSE(session_try(p, "record stop"));
        himc_performance_free(p);
    }
}

// a score may come from anybody; what the user types may replace any take
static void test_a_score_records_over_a_recording_and_over_no_other_file(void)
{
    static const char *const files[] = {BVH, TRC, "build/score-take.c3d"};
    static const char head[] = "Forehead"; // a recording has no such point
    char text[200], why[200];
    for (int i = 0; i < 3; i++) {
        himc_performance *p = session_new();
        heard h = {0};
        himc_take *other = made_take(i == 0 ? BVH : TRC);
        himc_take_set_name(other, himc_take_find(other, "Head"), head, strlen(head));
        save(other, files[i]);
        snprintf(text, sizeof text, "drum kettle;\nrecord %s;\nstroke 1 left legato mf;\n",
                 files[i]);
        snprintf(why, sizeof why,
                 SCORE ":2: record: %s: not a recording, and a score overwrites no other file; "
                       "expected another name",
                 files[i]);
        write_text(text);
        TEST_ASSERT_FALSE(session_try(p, "score " SCORE));
        TEST_ASSERT_EQUAL_STRING(why, error.text);
        session_do(p, "drum kettle");
        session_do(p, "record %s", files[i]);
        session_play(p, 0.1, &h);
        heard_free(&h);
        session_do(p, "record stop");
        session_do(p, "score " SCORE);
        himc_performance_free(p);
        remove(files[i]);
    }
}

// what happens once is no reason to refuse a score
static void test_a_hit_that_a_score_cannot_have_is_left_out_with_a_note(void)
{
    himc_performance *p = session_new();
    save(made_take(BVH), BVH);
    write_text("drum kettle; take " BVH "; play;\nhit left legato f;\n");
    const char *notes = notes_of(p, "score " SCORE);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(notes, SCORE ":2: hit: not possible while"), notes);
    TEST_ASSERT_EQUAL_STRING("", error.text);
    himc_performance_free(p);
}

// the stroke before the whole beat, and the first of the next score on it, are of one hand
static void test_a_score_follows_a_stroke_just_before_its_first_beat(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "tempo 240");
    session_do(p, "stroke 7.9 left legato f");
    session_do(p, "play");
    write_text("tempo 240; drum tom; stroke 0 left legato f;");
    session_do(p, "score " SCORE);
    session_play(p, 3, &h);
    TEST_ASSERT_EQUAL_INT(2, h.strikes);
    heard_free(&h);
    himc_performance_free(p);
}

// 40 ms as the difference of beats far from 0
static void test_strokes_as_close_as_allowed_may_follow_at_any_beat(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "stroke 999999 left legato f");
    session_do(p, "seek 999990");
    session_do(p, "play");
    write_text("tempo 1; stroke 0.0006666667 left legato f; stroke 0.0013333334 left legato f;");
    session_do(p, "score " SCORE);
    himc_performance_free(p);
}

typedef struct push_seen {
    double begun[20]; ///< beginnings of pushes (s)
    double last;      ///< force in the row before (N)
    int count;
} push_seen;

static void see_push(void *user, const himc_motion_row *row)
{
    push_seen *seen = user;
    double now = row->push[HIMC_LEFT_FOREARM].z;
    if (now != 0 && seen->last == 0)
        seen->begun[seen->count++ % 20] = row->time;
    TEST_ASSERT_TRUE(now == 0 || now == 5);
    seen->last = now;
}

// when that performer's left forearm is pushed in that time
static push_seen pushes_in(himc_performance *p, double seconds)
{
    push_seen seen = {.count = 0};
    himc_performance_on_motion(p, see_push, &seen);
    session_play(p, seconds, NULL);
    return seen;
}

// beats of 0.25 s; the music begins at `play`, for its first stroke is late enough
static void test_pushes_of_a_score_begin_at_their_beats(void)
{
    static const struct {
        const char *more;
        int count;
        double at[6]; ///< (beats after `play`); a tick before its end the loop has its last one
    } cases[] = {{"", 4, {0.1, 2, 3.5, 6.995}}, // the last one after the last stroke
                 {"seek 3;", 2, {0.5, 3.995}},
                 {"seek 2;", 3, {0, 1.5, 4.995}},
                 {"loop 1;", 6, {0.1, 2, 3.5, 6.995, 7.1, 9}},
                 {"clear;", 0, {0}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[400];
        himc_performance *p = session_new();
        snprintf(
            text, sizeof text,
            "drum kettle; tempo 240; at 3.5 push left-forearm 0 0 5 0.02; stroke 6 left legato p;"
            "at 2 push left-forearm 0 0 5 0.02; at 0.1 push left-forearm 0 0 5 0.02;"
            "at 6.995 push left-forearm 0 0 5 0.02; %s play;",
            cases[i].more);
        write_text(text);
        session_do(p, "score " SCORE);
        push_seen seen = pushes_in(p, 2.4);
        TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].count, seen.count, cases[i].more);
        for (int k = 0; k < seen.count; k++)
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.0041, 0.25 * cases[i].at[k], seen.begun[k],
                                              cases[i].more);
        himc_performance_free(p);
    }
}

static void test_a_push_on_the_first_beat_comes_in_each_round(void)
{
    himc_performance *p = session_new();
    write_text("drum kettle; tempo 240; stroke 6 left legato p; at 0 push left-forearm 0 0 5 0.02;"
               "loop 1; play;");
    session_do(p, "score " SCORE);
    push_seen seen = pushes_in(p, 2.4);
    TEST_ASSERT_EQUAL_INT(2, seen.count);
    TEST_ASSERT_DOUBLE_WITHIN(0.0041, 1.75, seen.begun[1] - seen.begun[0]);
    himc_performance_free(p);
}

// of a take at their seconds; a score that follows brings its own; dump tells them
static void test_pushes_of_a_take_and_of_the_next_score_are_played_and_told(void)
{
    char all[STATE];
    save(made_take(BVH), BVH);
    himc_performance *p = session_new();
    write_text("drum kettle; at 0.5 push left-forearm 0 0 5 0.02; take " BVH "; play;");
    session_do(p, "score " SCORE);
    TEST_ASSERT_NOT_NULL(strstr(state_of(p, all), "\nat 0.5 push left-forearm 0 0 5 0.02\n"));
    push_seen seen = pushes_in(p, 2);
    TEST_ASSERT_EQUAL_INT(1, seen.count);
    TEST_ASSERT_DOUBLE_WITHIN(0.0041, 1.5, seen.begun[0]); // it comes to the first frame in 1 s
    session_do(p, "stop");
    write_text("tempo 240; at 0 push left-forearm 0 0 5 0.02; stroke 3 left legato p; play;");
    session_do(p, "score " SCORE);
    session_do(p, "score " SCORE);
    TEST_ASSERT_NOT_NULL(strstr(state_of(p, all), "\nat 4 push left-forearm 0 0 5 0.02"));
    TEST_ASSERT_EQUAL_INT(2, pushes_in(p, 2).count);
    session_do(p, "reset");
    TEST_ASSERT_NULL(strstr(state_of(p, all), "push"));
    himc_performance_free(p);
}

static void write_pushes(const char *before, int count)
{
    FILE *file = fopen(SCORE, "w");
    TEST_ASSERT_NOT_NULL(file);
    fprintf(file, "tempo 240; %s stroke 6 left legato p;", before);
    for (int i = 0; i < count; i++)
        fprintf(file, "at %.9g push left-forearm 0 0 5 0.001;", 0.02 * i);
    fputs("play;", file);
    fclose(file);
}

// begun ones are kept, as the strokes are, until there is no room for them
static void test_a_following_score_with_too_many_pushes_changes_nothing(void)
{
    static char before[STATE], after[STATE];
    himc_performance *p = session_new();
    write_pushes("drum kettle;", 200);
    session_do(p, "score " SCORE);
    write_pushes("gain frequency 2; drum side;", 57);
    state_of(p, before);
    TEST_ASSERT_FALSE(session_try(p, "score " SCORE));
    TEST_ASSERT_EQUAL_STRING(SCORE ": push: one too many, expected 256", error.text);
    TEST_ASSERT_EQUAL_STRING(before, state_of(p, after));
    session_play(p, 1, NULL);
    write_pushes("", 56);
    session_do(p, "score " SCORE);
    TEST_ASSERT_NOT_NULL(strstr(state_of(p, after), "\nat 0 push"));
    write_pushes("", 1);
    session_do(p, "score " SCORE);
    TEST_ASSERT_NULL(strstr(state_of(p, after), "\nat 0 push"));
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_following_score_with_too_many_pushes_changes_nothing);
    RUN_TEST(test_pushes_of_a_score_begin_at_their_beats);
    RUN_TEST(test_a_push_on_the_first_beat_comes_in_each_round);
    RUN_TEST(test_pushes_of_a_take_and_of_the_next_score_are_played_and_told);
    RUN_TEST(test_a_hit_in_a_score_is_played_when_it_is_loaded);
    RUN_TEST(test_a_score_begins_at_its_seek);
    RUN_TEST(test_a_take_in_a_score_without_strokes_is_played);
    RUN_TEST(test_a_take_in_a_score_with_strokes_is_refused_with_its_line);
    RUN_TEST(test_repairs_of_a_take_are_told_when_it_is_loaded);
    RUN_TEST(test_a_take_of_three_frames_is_refused);
    RUN_TEST(test_units_of_a_take_without_strokes_and_too_many_units_are_refused);
    RUN_TEST(test_a_take_with_left_and_right_exchanged_is_refused);
    RUN_TEST(test_a_score_that_is_refused_names_its_line_and_changes_nothing);
    RUN_TEST(test_a_score_records_over_a_recording_and_over_no_other_file);
    RUN_TEST(test_a_hit_that_a_score_cannot_have_is_left_out_with_a_note);
    RUN_TEST(test_a_score_follows_a_stroke_just_before_its_first_beat);
    RUN_TEST(test_strokes_as_close_as_allowed_may_follow_at_any_beat);
    return UNITY_END();
}
