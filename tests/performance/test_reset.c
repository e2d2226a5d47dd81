/// test_reset.c: after `reset` a performance is as just made, bit for bit, whatever was going on;
/// and a `reset` that is refused changes nothing.
///
/// 200 random states, each from a seed: commands of all kinds between random numbers of samples in
/// random blocks. Then `reset` and a fixed piece: rows of motion, strikes, forces and the drum's
/// sound are compared with a new performance's. Most run at a physics rate of 1 kHz to save time, a
/// few (with HIMC_LONG all) at the default rates.
#include "allocations.h"
#include "take_players.h"

#include "heard_piece.h"

#include <sys/stat.h>

#define TAKE "build/reset.bvh"
#define SCORE "build/reset.txt"
#define STATES 200

#define PIECE                                                                         \
    "tempo 140; drum other 29; other tune 110; stroke 0 left legato f; grip french; " \
    "stroke 1 right accent ff normal other; stroke 1.5 left staccato mf; limits euler; play;"

static heard_piece expected[2], played;

static himc_performance_config config_of(bool full)
{
    himc_performance_config c = himc_performance_default();
    if (!full) {
        c.sample_rate = 16000;
        c.physics_rate = 1000;
    }
    return c;
}

static himc_performance *performer(const himc_performance_config *config)
{
    himc_performance *p = himc_performance_new(config, &error);
    himc_drum *drum = himc_drum_new("kettle", 23, config->sample_rate, &error);
    TEST_ASSERT_TRUE(p && drum && himc_performance_add_drum(p, drum, &error));
    himc_drum_release(drum);
    himc_performance_make_drums(p, true);
    return p;
}

static void process(himc_performance *p, unsigned *seed, double seconds)
{
    double rate = himc_performance_measure(p).sample_rate;
    for (int left = (int)(seconds * rate); left > 0;) {
        int n = 1 + choose(seed, 300);
        n = n < left ? n : left;
        himc_performance_process(p, n, NULL);
        left -= n;
    }
}

// a command of a random kind; some are refused in some states
// commands without random numbers
static const char *const plain_commands[] = {"play",
                                             "stop",
                                             "clear",
                                             "loop 1",
                                             "loop 0",
                                             "seek 1.5",
                                             "mode id",
                                             "mode ik",
                                             "mode himc",
                                             "solver sdls",
                                             "solver transpose",
                                             "law printed",
                                             "law feedforward",
                                             "damping 0.1",
                                             "posture 0",
                                             "bend 0",
                                             "elbow 1",
                                             "weights 1 0.5 2 1",
                                             "gain right-wrist 20 0.5",
                                             "gain frequency 2",
                                             "gain reset",
                                             "limits ellipsoid",
                                             "limits euler",
                                             "strength human",
                                             "strength left-elbow 3",
                                             "rate physics 700",
                                             "rate task 100",
                                             "coupling one-way",
                                             "engine ode",
                                             "latency 0",
                                             "latency auto",
                                             "hit any legato f",
                                             "grip french",
                                             "human 0.5 7",
                                             "human 0",
                                             "player 1.9 95",
                                             "player 1.6 50",
                                             "push trunk 100 -50 20 0.2",
                                             "push left-forearm 0 0 60 1",
                                             "take " TAKE,
                                             "take " TAKE,
                                             "drum tom 26",
                                             "drum tam 29",
                                             "units " TAKE " accent",
                                             "units clear",
                                             "score " SCORE,
                                             "record build/reset-out.bvh",
                                             "record stop",
                                             "reset"};

// writes one command of a random kind, with random atoms
static void random_text(char *text, size_t size, unsigned *seed)
{
    static const char *const hands[] = {"left", "right"},
                             *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent",
                                                 "staccato"},
                             *const drums[] = {"", " normal", " rim kettle", " 0.05 0.1"};
    const int plain = sizeof plain_commands / sizeof plain_commands[0];
    const char *hand = hands[choose(seed, 2)], *nuance = nuances[choose(seed, 5)],
               *drum = drums[choose(seed, 4)];
    double x = chance(seed), y = chance(seed), z = chance(seed);
    switch (choose(seed, 8)) {
    case 0: snprintf(text, size, "stroke %.2f %s %s %.2f%s", 3 * x, hand, nuance, y, drum); break;
    case 1: snprintf(text, size, "hit %s %s %.2f%s", hand, nuance, x, drum); break;
    case 2:
        snprintf(text, size, "target %s %.3f %.3f %.3f", hand, 0.3 + 0.5 * x, y - 0.5, 0.7 + z);
        break;
    case 3: snprintf(text, size, "tempo %.1f", 60 + 200 * x); break;
    default: snprintf(text, size, "%s", plain_commands[choose(seed, plain)]);
    }
}

static void random_command(himc_performance *p, unsigned *seed, char *story)
{
    char text[200];
    random_text(text, sizeof text, seed);
    snprintf(story + strlen(story), 1000 - strlen(story), "%s; ", text);
    himc_command c;
    himc_error ignored;
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_PERFORMER, text, &error), error.text);
    himc_performance_command(p, &c, choose(seed, 3) ? 0 : choose(seed, 2000), &ignored);
}

// whatever a session may be doing: mostly in the middle of strokes
static himc_performance *random_state(unsigned *seed, const himc_performance_config *config,
                                      double most, char *story)
{
    himc_performance *p = performer(config);
    story[0] = 0;
    session_do(p, "hit left accent f"); // so that heads sound and sticks are in contact
    for (int i = 2 + choose(seed, 10); i > 0; i--) {
        random_command(p, seed, story);
        if (choose(seed, 4) == 0)
            himc_drum_strike_at(himc_performance_drum(p, 0), choose(seed, 3000), 0.1, 0, 3, &error);
        process(p, seed, chance(seed) < 0.3 ? 0 : most * chance(seed));
        if (choose(seed, 10) == 0)
            himc_performance_realign(p);
    }
    if (choose(seed, 4) == 0) // up to a contact, if one comes
        for (int i = 0; i < 400 && !himc_contacts_any(&p->contacts); i++)
            himc_performance_process(p, 1 + choose(seed, 40), NULL);
    return p;
}

static void test_reset_from_200_random_states_is_a_new_performance_bit_for_bit(void)
{
    bool all = getenv("HIMC_LONG");
    double seconds = 0.9;
    int touching = 0, taking = 0, midstep = 0, recording = 0;
    for (int full = 0; full < 2; full++) {
        himc_performance_config config = config_of(full);
        himc_performance *p = performer(&config);
        play_piece(p, seconds, &expected[full]);
        TEST_ASSERT_TRUE(expected[full].strikes >= 1);
        himc_performance_free(p);
    }
    for (int i = 0; i < STATES; i++) {
        unsigned seed = 1000u + (unsigned)i;
        bool full = all || i % 20 == 0;
        char story[1100];
        himc_performance_config config = config_of(full);
        himc_performance *p = random_state(&seed, &config, all ? 0.5 : 0.12, story);
        while (p->recording.file && himc_recording_frames(p->recording.file) == 0)
            himc_performance_process(p, 7, NULL); // an empty one cannot be written: refused
        uint64_t time = himc_performance_time(p);
        touching += himc_contacts_any(&p->contacts);
        taking += p->motion->track != NULL;
        midstep += himc_clock_ahead(&p->clock) > 0;
        recording += p->recording.file != NULL;
        session_do(p, "reset");
        TEST_ASSERT_EQUAL_UINT64(time, himc_performance_time(p));
        TEST_ASSERT_NULL(himc_performance_drum(p, 1));
        play_piece(p, seconds, &played);
        check_piece(&expected[full], &played, story);
        himc_performance_free(p);
    }
    printf(
        "%d states: %d with a stick on the head, %d with a take, %d within a step, %d recording\n",
        STATES, touching, taking, midstep, recording);
    TEST_ASSERT_TRUE(touching > 20 && taking > 20 && midstep > 50 && recording > 5);
    unlink("build/reset-out.bvh");
}

static void test_reset_in_the_middle_of_a_stroke_leaves_no_strike(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = performer(&config);
    heard h = {0};
    session_do(p, "latency 0");
    session_do(p, "hit right accent fff");
    while (p->body->state.tip_velocity[HIMC_RIGHT].z > -5)
        himc_performance_process(p, 7, NULL);
    session_do(p, "reset");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(0, h.strikes);
    heard_free(&h);
    himc_performance_free(p);
}

static void find_listener(void *user, const char *line)
{
    if (strncmp(line, "listener", 8) == 0)
        snprintf(user, 40, "%s", line);
}

static void test_reset_keeps_the_hosts_drums_where_their_owner_put_them(void)
{
    char listener[40] = "";
    static const char *const names[] = {"first", "second", "third"};
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    himc_drum *drum[3];
    himc_vec3 at[3];
    himc_performance_make_drums(p, true);
    session_do(p, "stroke 0 left legato mf"); // on the performer's own, silent: slot 0
    for (int i = 0; i < 3; i++) {
        drum[i] = himc_drum_new(names[i], 23, config.sample_rate, &error);
        TEST_ASSERT_TRUE(himc_performance_add_drum(p, drum[i], &error));
        himc_drum_release(drum[i]);
    }
    session_drum(p, 3, "place 0.3 0.9 0.8");
    session_drum(p, 2, "mallet wood");
    session_drum(p, 2, "listener off");
    session_do(p, "drum made 26");
    session_do(p, "reset");
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_PTR(drum[i], himc_performance_drum(p, i));
        at[i] = himc_drum_head_frame(drum[i])->center;
    }
    TEST_ASSERT_NULL(himc_performance_drum(p, 3));
    TEST_ASSERT_EQUAL_DOUBLE(0.7, at[0].x); // straight ahead, as the first drum of a new performer
    TEST_ASSERT_EQUAL_DOUBLE(0, at[0].y);
    TEST_ASSERT_TRUE(at[1].y < -0.3); // placed again, to its right
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9, at[2].y);
    TEST_ASSERT_EQUAL_DOUBLE(3e8, himc_drum_mallet(drum[1], HIMC_RIGHT)->stiffness);
    himc_drum_describe(drum[1], HIMC_DESCRIBE_STATE, find_listener, listener);
    TEST_ASSERT_EQUAL_STRING("listener off", listener);
    himc_performance_free(p);
}

static void test_reset_undoes_the_place_that_a_take_gave_a_drum(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = performer(&config);
    const himc_head_frame *frame = himc_drum_head_frame(himc_performance_drum(p, 0));
    session_drum(p, 0, "place 0.9 0.6 0.85");
    himc_vec3 owner = frame->center;
    session_do(p, "take " TAKE);
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(frame->center, owner)) > 1e-3);
    session_do(p, "reset");
    TEST_ASSERT_EQUAL_MEMORY(&owner, &frame->center, sizeof owner);
    session_do(p, "take " TAKE);
    session_drum(p, 0, "place 0.8 0.1 0.8"); // its owner's word is the last
    owner = frame->center;
    session_do(p, "reset");
    TEST_ASSERT_EQUAL_MEMORY(&owner, &frame->center, sizeof owner);
    himc_performance_free(p);
}

static void test_reset_is_heard_by_those_who_heard_it_at_first(void)
{
    for (int usual = 0; usual < 2; usual++) {
        himc_performance_config config = config_of(false);
        char first[40] = "", later[40] = "";
        config.heard = usual;
        himc_performance *p = performer(&config);
        himc_performance_describe(p, HIMC_DESCRIBE_STATE, find_listener, first);
        TEST_ASSERT_EQUAL_STRING(usual ? "listener usual" : "listener off", first);
        session_do(p, usual ? "listener off" : "listener 2 0 1");
        session_do(p, "reset");
        himc_performance_describe(p, HIMC_DESCRIBE_STATE, find_listener, later);
        TEST_ASSERT_EQUAL_STRING(first, later);
        himc_performance_free(p);
    }
}

static void test_reset_writes_a_recording_first_and_keeps_callbacks_and_events(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = performer(&config);
    static heard_piece rows;
    himc_event event = {.kind = HIMC_EVENT_DONE};
    rows.rows = 0;
    himc_performance_on_motion(p, keep_row, &rows);
    session_do(p, "record build/reset-out.bvh");
    himc_performance_process(p, 4800, NULL);
    for (int i = 0; i <= EVENTS_WAITING; i++)
        himc_events_add(&p->events, &event);
    TEST_ASSERT_TRUE(himc_performance_measure(p).events_lost > 0);
    session_do(p, "reset");
    TEST_ASSERT_EQUAL_INT(0, (int)himc_performance_measure(p).events_lost);
    while (himc_performance_event(p, &event) && event.kind == HIMC_EVENT_DONE)
        ;
    TEST_ASSERT_EQUAL_STRING("recorded 0.10 s in build/reset-out.bvh", event.text);
    TEST_ASSERT_EQUAL_INT(0, unlink("build/reset-out.bvh"));
    int before = rows.rows;
    himc_performance_process(p, 4800, NULL);
    TEST_ASSERT_EQUAL_INT(before + 25, rows.rows);
    TEST_ASSERT_EQUAL_DOUBLE(0, rows.row[before].time);
    himc_performance_free(p);
}

static void test_reset_drops_a_recording_that_has_no_frames_yet(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = performer(&config);
    session_do(p, "record build/reset-out.bvh");
    session_do(p, "reset");
    TEST_ASSERT_NULL(p->recording.file);
    himc_performance_free(p);
}

// two performances in the same state; one is refused a reset, then both play on
static void check_refusal(unsigned seed, int allocation, const char *reason)
{
    static heard_piece a, b;
    himc_performance_config config = config_of(false);
    char story[1100];
    himc_performance *p[2];
    himc_command reset;
    TEST_ASSERT_TRUE(himc_command_parse_text(&reset, HIMC_PERFORMER, "reset", &error));
    for (int i = 0; i < 2; i++) {
        unsigned same = seed;
        p[i] = random_state(&same, &config, 0.1, story);
        session_try(p[i], "record stop");
        session_try(p[i], "record build/gone/out%d.bvh", i);
        himc_performance_process(p[i], 200, NULL); // a few frames
    }
    rmdir("build/gone");
    fail_allocation(allocation);
    bool done = himc_performance_command(p[0], &reset, 0, &error);
    fail_allocation(0);
    TEST_ASSERT_FALSE(done);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, reason), error.text);
    TEST_ASSERT_NOT_NULL(p[0]->recording.file);
    mkdir("build/gone", 0777);
    session_do(p[0], "clear");
    session_do(p[1], "clear");
    play_piece(p[0], 0.5, &a);
    play_piece(p[1], 0.5, &b);
    check_piece(&b, &a, story);
    himc_performance_free(p[0]);
    himc_performance_free(p[1]);
    unlink("build/gone/out0.bvh");
    unlink("build/gone/out1.bvh");
}

static void test_reset_without_memory_or_file_changes_nothing(void)
{
    mkdir("build/gone", 0777);
    for (int allocation = 1; CAN_FAIL_ALLOCATIONS && allocation <= 5; allocation++)
        check_refusal(70u + (unsigned)allocation, allocation, "reset: ");
    check_refusal(90, 0, "reset: record: build/gone/out0.bvh");
    rmdir("build/gone");
}

static void test_reset_lets_the_planner_think_as_in_a_new_performance(void)
{
    himc_performance_config config = config_of(false);
    long work[2];
    for (int again = 0; again < 2; again++) {
        himc_performance *p = performer(&config);
        session_drum(p, 0, "place 0.4 0.8 1.3");
        if (again) {
            himc_performance_process(p, 800, NULL); // no stick is near a head
            session_do(p, "reset");
        }
        long before = himc_planner_work(p->motion->planner);
        session_do(p, "stroke 0 left legato f");
        session_do(p, "play");
        himc_performance_process(p, 32, NULL);
        work[again] = himc_planner_work(p->motion->planner) - before;
        himc_performance_free(p);
    }
    TEST_ASSERT_TRUE(work[0] > 0);
    TEST_ASSERT_EQUAL_INT(work[0], work[1]);
}

int main(void)
{
    himc_skeleton body;
    himc_skeleton_config config = himc_skeleton_default();
    config.height = 1.82;
    UNITY_BEGIN();
    himc_take *take =
        himc_skeleton_init(&body, &config, &error) ? beaten_take(&body, 250, 1.5, &error) : NULL;
    if (!take || !himc_take_save(take, TAKE, &error))
        return 1;
    himc_take_free(take);
    FILE *score = fopen(SCORE, "w");
    if (!score || fputs(PIECE, score) < 0 || fclose(score) != 0)
        return 1;
    RUN_TEST(test_reset_from_200_random_states_is_a_new_performance_bit_for_bit);
    RUN_TEST(test_reset_in_the_middle_of_a_stroke_leaves_no_strike);
    RUN_TEST(test_reset_keeps_the_hosts_drums_where_their_owner_put_them);
    RUN_TEST(test_reset_undoes_the_place_that_a_take_gave_a_drum);
    RUN_TEST(test_reset_is_heard_by_those_who_heard_it_at_first);
    RUN_TEST(test_reset_writes_a_recording_first_and_keeps_callbacks_and_events);
    RUN_TEST(test_reset_drops_a_recording_that_has_no_frames_yet);
    RUN_TEST(test_reset_lets_the_planner_think_as_in_a_new_performance);
    RUN_TEST(test_reset_without_memory_or_file_changes_nothing);
    unlink(TAKE);
    unlink(SCORE);
    return UNITY_END();
}
