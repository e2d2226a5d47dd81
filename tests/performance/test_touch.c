/// test_touch.c: sticks of a performer on heads: the point that meets the head is the body's own
/// tip, as heavy, as fast, and where it was left; and the blows that a drum tells of.
#define _GNU_SOURCE
#include "himc/himc.h"
#include "himc/membrane.h"
#include "performance/performance_state.h"

#include "unity.h"
#include "base/head_frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PIECE                                                                     \
    "tempo 120; drum kettle; "                                                    \
    "stroke 2 right legato mf; stroke 3 left tenuto f; stroke 4 right accent f; " \
    "stroke 5 left vertical-accent mf rim;"
#define SAMPLES (4 * 48000)

static himc_performance *performance;
static himc_error error;

static void command(const char *text)
{
    himc_command c;
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) &&
                                 himc_performance_command(performance, &c, 0, &error),
                             error.text);
}

static void load(const char *text)
{
    char path[] = "/tmp/himc-test-XXXXXX", line[64];
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text));
    close(file);
    snprintf(line, sizeof line, "score %s", path);
    command(line);
    unlink(path);
}

void setUp(void)
{
    himc_performance_config config = himc_performance_default();
    performance = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(performance, error.text);
    himc_performance_make_drums(performance, true);
    load(PIECE);
    command("play");
}

void tearDown(void)
{
    himc_performance_free(performance);
    performance = NULL;
}

// one physics step; returns its seconds
static double step(void)
{
    int64_t from = performance->clock.made;
    himc_performance_process(performance, (int)(from - performance->clock.played) + 1, NULL);
    return (double)(performance->clock.made - from) / 48000;
}

static double along_normal(himc_vec3 v, const stick_contact *c)
{
    himc_drum *drum = performance->drums.slot[c->drum].drum;
    return himc_vec3_dot(himc_head_frame_normal(himc_drum_head_frame(drum)), v);
}

static void test_contact_point_moves_like_the_bodys_tip(void)
{
    double apart = 0, largest = 0;
    stick_contact before[HIMC_HANDS] = {{0}};
    while (performance->clock.made < SAMPLES) {
        double h = step();
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            const stick_contact *c = &performance->contacts.hand[hand];
            // the state is from the beginning of this step, the stick before from the end of the
            // last
            double tip = along_normal(performance->body->state.tip_velocity[hand], c);
            if (before[hand].stick.force > 1) {
                apart = fmax(apart, fabs(before[hand].stick.velocity - tip));
                largest = fmax(largest, before[hand].stick.force * h / before[hand].stick.mass);
            }
            before[hand] = *c;
        }
    }
    // a force gives it up to `largest` (m/s) in a step: a mass a hundredth wrong would show
    printf("apart by %.2g m/s of %.2g\n", apart, largest);
    TEST_ASSERT_TRUE(largest > 0.1);
    TEST_ASSERT_TRUE(apart < 0.01 * largest);
}

static void test_contact_point_continues_from_the_last_step(void)
{
    double jump = 0, offset = 0;
    stick_contact before[HIMC_HANDS] = {{0}};
    while (performance->clock.made < SAMPLES) {
        double h = step();
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            const stick_contact *c = &performance->contacts.hand[hand];
            const himc_stick *s = &c->stick;
            if (before[hand].touching && c->touching) {
                double start = along_normal(performance->body->state.tip_velocity[hand], c);
                double way = 0.5 * (start + s->velocity) * h;
                jump = fmax(jump, fabs(s->height - before[hand].stick.height - way));
                offset = fmax(offset, fabs(c->offset));
            }
            before[hand] = *c;
        }
    }
    printf("jumps of %.2g m, offset up to %.2g m\n", jump, offset);
    TEST_ASSERT_TRUE(offset > 2e-5);
    TEST_ASSERT_TRUE(jump < 1e-6);
}

// the stick flies off as it left the head: nothing is asked of it along the normal that it has not
static void test_plan_goes_on_from_the_stick_without_acceleration_along_the_normal(void)
{
    bool released[HIMC_HANDS] = {false};
    int parted = 0;
    while (performance->clock.made < SAMPLES) {
        step();
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            const stick_contact *c = &performance->contacts.hand[hand];
            const himc_target *plan = &performance->motion->reference.tip[hand];
            bool now = performance->motion->reference.released[hand];
            if (released[hand] && !now) {
                himc_vec3 v = himc_vec3_sub(performance->body->state.tip_velocity[hand], plan->v);
                TEST_ASSERT_DOUBLE_WITHIN(0.05, 0, along_normal(plan->a, c));
                TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, along_normal(v, c));
                parted++;
            }
            released[hand] = now;
        }
    }
    TEST_ASSERT_EQUAL_INT(4, parted);
}

static void test_contact_keeps_its_mallet_to_its_end(void)
{
    himc_command wood;
    himc_drum *drum = himc_performance_drum(performance, 0);
    const stick_contact *c = &performance->contacts.hand[HIMC_RIGHT];
    const double medium = himc_drum_mallet(drum, HIMC_RIGHT)->stiffness;
    TEST_ASSERT_TRUE(himc_command_parse_text(&wood, HIMC_DRUM, "mallet wood", &error));
    while (c->stick.force < 20 && performance->clock.made < SAMPLES)
        step();
    TEST_ASSERT_TRUE(himc_drum_command(drum, &wood, &error));
    for (double before = c->stick.force; c->stick.touching; before = c->stick.force) {
        step();
        TEST_ASSERT_EQUAL_DOUBLE(medium, c->stick.head.stiffness);
        TEST_ASSERT_DOUBLE_WITHIN(5, before, c->stick.force);
    }
    while (!c->stick.touching && performance->clock.made < SAMPLES)
        step();
    TEST_ASSERT_EQUAL_DOUBLE(3e8, c->stick.head.stiffness);
}

static void test_contact_onsets_are_reported_at_each_stroke(void)
{
    himc_drum *drum = himc_performance_drum(performance, 0);
    const himc_membrane *head = himc_drum_membrane(drum);
    himc_strike struck[8];
    himc_event event;
    himc_contact_onset told;
    int strikes = 0, touches = 0;
    himc_performance_process(performance, SAMPLES, NULL);
    while (himc_performance_event(performance, &event))
        if (event.kind == HIMC_EVENT_STRIKE && strikes < 8)
            struck[strikes++] = event.strike;
    TEST_ASSERT_EQUAL_INT(4, strikes);
    for (; himc_drum_contact_next(drum, &told); touches++) {
        const himc_strike *s = &struck[touches];
        TEST_ASSERT_TRUE(touches < strikes);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, s->time, (double)told.at / 48000);
        TEST_ASSERT_EQUAL_DOUBLE(s->x, told.x);
        TEST_ASSERT_EQUAL_DOUBLE(s->y, told.y);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * s->velocity, s->velocity, told.velocity);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, hypot(s->x, s->y) / himc_drum_head_frame(drum)->radius,
                                  told.distance);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, himc_membrane_principal(head, himc_membrane_head(head)),
                                  told.pitch);
    }
    TEST_ASSERT_EQUAL_INT(strikes, touches);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_contact_point_moves_like_the_bodys_tip);
    RUN_TEST(test_contact_point_continues_from_the_last_step);
    RUN_TEST(test_plan_goes_on_from_the_stick_without_acceleration_along_the_normal);
    RUN_TEST(test_contact_keeps_its_mallet_to_its_end);
    RUN_TEST(test_contact_onsets_are_reported_at_each_stroke);
    return UNITY_END();
}
