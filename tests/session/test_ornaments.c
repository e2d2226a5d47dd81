/// test_ornaments.c: what a listener expects of grace notes: the stroke that they decorate is as
/// strong as without them, at the same place, and they are heard, softer than it and even.
#include "session.h"

static const char *const nuance[] = {"legato", "tenuto", "accent", "vertical-accent", "staccato"};
static const char *const dynamic[] = {"ppp", "mp", "f", "fff"};
#define DYNAMICS 4

// a stroke of each dynamic, every two beats
static heard play_strokes(double tempo, const char *kind, const char *how)
{
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "tempo %g", tempo);
    for (int i = 0; i < DYNAMICS; i++)
        session_do(p, "%s %d %s %s %s", kind, 2 + 2 * i, i % 2 ? "left" : "right", how, dynamic[i]);
    session_do(p, "play");
    session_play(p, 2.2 * DYNAMICS * 60 / tempo + 1, &h);
    himc_performance_free(p);
    return h;
}

static void check_graces(const heard *plain, const heard *graced, int graces, const char *what)
{
    double within = graces == 1 ? 0.01 : 0.08; // of two the second is a bounce, and a third softer
    TEST_ASSERT_EQUAL_INT_MESSAGE((graces + 1) * plain->strikes, graced->strikes, what);
    for (int i = 0; i < plain->strikes; i++) {
        const himc_strike *note = &graced->strike[(graces + 1) * i], *own = &note[graces];
        double louder = 20 * log10(own->velocity / plain->strike[i].velocity);
        double gap = (own->time - note->time) / graces;
        TEST_ASSERT_EQUAL_INT(plain->strike[i].hand, own->hand);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1, 0, louder, what);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.002, plain->strike[i].time, own->time, what);
        for (int k = 0; k < graces; k++) {
            double share = note[k].velocity / own->velocity;
            TEST_ASSERT_TRUE_MESSAGE(share < 0.4 + within, what);
            // fingers cannot turn the fastest round for their bounce; a line says so
            TEST_ASSERT_TRUE_MESSAGE(share > (graced->notes > 0 ? 0.19 : 0.4 - within), what);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.1 * gap, gap, note[k + 1].time - note[k].time,
                                              what);
        }
    }
}

static void test_main_stroke_is_as_strong_as_without_its_grace_notes(void)
{
    static const struct {
        const char *name;
        int graces;
    } kind[] = {{"flam", 1}, {"drag", 2}, {"ruff", 2}};
    static const double tempo[] = {140, 62, 97.3, 140, 133.333};
    char what[128];
    for (int i = 0; i < 5; i++) {
        heard plain = play_strokes(tempo[i], "stroke", nuance[i]);
        for (int k = 0; k < 3; k++) {
            heard graced = play_strokes(tempo[i], kind[k].name, nuance[i]);
            snprintf(what, sizeof what, "%s %s at %g", kind[k].name, nuance[i], tempo[i]);
            check_graces(&plain, &graced, kind[k].graces, what);
            heard_free(&graced);
        }
        heard_free(&plain);
    }
}

// at a point that is written, as at a named spot, the grace notes give way
static void test_main_stroke_has_the_point_that_is_written(void)
{
    static const char *const kind[] = {"flam", "drag", "ruff"};
    for (int k = 0; k < 3; k++)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            heard h = {0};
            himc_performance *p = session_new();
            session_do(p, "%s 2 %s legato f -0.1 0.05", kind[k], hand ? "right" : "left");
            session_do(p, "play");
            session_play(p, 2, &h);
            himc_performance_free(p);
            const himc_strike *own = &h.strike[h.strikes - 1];
            TEST_ASSERT_EQUAL_INT(hand ? HIMC_RIGHT : HIMC_LEFT, own->hand);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.001, 0.05, own->y, kind[k]);
            for (int i = 0; i < h.strikes; i++)
                TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.001, -0.1, h.strike[i].x, kind[k]);
            heard_free(&h);
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_main_stroke_is_as_strong_as_without_its_grace_notes);
    RUN_TEST(test_main_stroke_has_the_point_that_is_written);
    return UNITY_END();
}
