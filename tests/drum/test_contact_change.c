/// test_contact_change.c: a change of the head, the mallet or the drum's place while sticks touch,
/// or nearly do, gives no energy, and displacement and sound stay within what the energy allows.
#include "sound_scale.h"

#include "session.h"

#include "performance/performance_state.h"

#define RATE 48000
#define TOLERANCE 1e-9 // of the energy: the rounding of a stiff contact
#define STRIKE "strike 0.1 0.02 3"
#define AWAY "place 0 0 3 0.8"

// own mallets: as stiff, as light and heavy, as straight and bent a law as `mallet` allows
static const char *const mallets[] = {"mallet soft",       "mallet medium",       "mallet hard",
                                      "mallet wood",       "mallet 2e12 1.21 .4", "mallet 1e13 1 1",
                                      "mallet 1e13 4 1",   "mallet 1e13 1 0.001", "mallet 1e3 1 1",
                                      "mallet 1e13 2 0.03"};

static const char *const changes[] = {"tension 6000",
                                      "tension 10",
                                      "tension 1e5",
                                      "radius 0.667",
                                      "radius 0.1",
                                      "density 0.02",
                                      "density 5",
                                      "modes 1000",
                                      "modes 3",
                                      "modes 1",
                                      "shape circle",
                                      "shape rectangle 0.5 0.5",
                                      "air 1",
                                      "air 0",
                                      "kettle 0.1",
                                      "glide 0",
                                      "glide 1",
                                      "uniformity 0 5",
                                      "uniformity 0.5 6",
                                      "tune A3",
                                      "damp 1",
                                      "decay 0.1",
                                      "mallet wood",
                                      "mallet 1e3 1 1",
                                      "mallet 1e13 1 0.4",
                                      "place 0.7 0.2 0.8",
                                      AWAY,
                                      "pickups 8",
                                      "pickup 0.1 0.1"};

static himc_drum *new_drum(const char *mallet)
{
    himc_drum *drum = himc_drum_new("kettle", 23, RATE, &error);
    himc_command c;
    TEST_ASSERT_TRUE_MESSAGE(drum && himc_command_parse_text(&c, HIMC_DRUM, mallet, &error) &&
                                 himc_drum_command(drum, &c, &error),
                             error.text);
    return drum;
}

static bool tell(himc_drum *drum, const char *text)
{
    himc_command c;
    return himc_command_parse_text(&c, HIMC_DRUM, text, &error) &&
           himc_drum_command(drum, &c, &error);
}

// What must not be exceeded after a change.
typedef struct bounds {
    double energy; // in head and mallets (J)
    double scale;  // of a sample before the change
} bounds;

// Plays `n` samples; fails if one is larger than the energy allows, or the energy grows.
static void play_within(himc_drum *drum, bounds before, int n, const char *story)
{
    double energy = before.energy;
    double sound[64], seen[64], most = 0, deepest = 0;
    double sample = largest_declicked(drum, fmax(before.scale, largest_sample(drum, 0, energy))),
           depth = largest_displacement(drum, energy);
    for (int i = 0; i < n; i += 64) {
        himc_drum_advance(drum, 64, NULL, NULL, NULL);
        himc_drum_read(drum, himc_drum_time(drum) - 64, 64, sound, seen);
        for (int k = 0; k < 64; k++) {
            most = fmax(most, isfinite(sound[k]) ? fabs(sound[k]) : INFINITY);
            deepest = fmax(deepest, isfinite(seen[k]) ? fabs(seen[k]) : INFINITY);
        }
    }
    double after = drum_energy(drum);
    if (most <= sample && deepest <= depth && after <= energy * (1 + TOLERANCE))
        return;
    char text[1200];
    snprintf(text, sizeof text,
             "%s: sample %.3g of %.3g, depth %.3g of %.3g m, energy %.3g of %.3g J", story, most,
             sample, deepest, depth, after, energy);
    TEST_FAIL_MESSAGE(text);
}

// carries out `change`; the sample after it must not exceed the energy before it
static bounds change_once(himc_drum *drum, const char *change, const char *story)
{
    double before = drum_energy(drum), scale = largest_sample(drum, 0, before);
    tell(drum, change);
    himc_drum_advance(drum, 1, NULL, NULL, NULL);
    double after = drum_energy(drum);
    if (!(after <= before * (1 + TOLERANCE))) {
        char text[1200];
        snprintf(text, sizeof text, "%s: %.9g J became %.9g J", story, before, after);
        TEST_FAIL_MESSAGE(text);
    }
    return (bounds){before, scale};
}

static void test_no_change_at_any_moment_of_a_touch_adds_energy(void)
{
    static const int phases[] = {1, 3, 17, 60, 150, 260};
    int touching = 0;
    for (size_t m = 0; m < sizeof mallets / sizeof *mallets; m++)
        for (size_t c = 0; c < sizeof changes / sizeof *changes; c++) {
            size_t k = (m + c) % 6; // each change meets each phase, and each mallet most
            for (int twice = 0; twice < 2; twice++, k = (k + 3) % 6) {
                char story[100];
                himc_drum *drum = new_drum(mallets[m]);
                tell(drum, STRIKE);
                himc_drum_advance(drum, phases[k], NULL, NULL, NULL);
                touching += drum->mallets[0].used && drum->mallets[0].stick.touching;
                snprintf(story, sizeof story, "%s, %d samples, %s", mallets[m], phases[k],
                         changes[c]);
                play_within(drum, change_once(drum, changes[c], story), 256, story);
                himc_drum_release(drum);
            }
        }
    printf("%d of the changes during a touch\n", touching);
    TEST_ASSERT_TRUE(touching > 200);
}

// a number between two, most of them near the ends of several decades
static double between(unsigned *seed, double low, double high)
{
    return low * pow(high / low, chance(seed));
}

static void random_change(char *text, size_t size, unsigned *seed)
{
    double x = chance(seed);
    switch (choose(seed, 11)) {
    case 0: snprintf(text, size, "tension %.5g", between(seed, 10.1, 9.9e4)); break;
    case 1: snprintf(text, size, "radius %.4f", 0.06 + 0.9 * x); break;
    case 2: snprintf(text, size, "density %.4g", between(seed, 0.011, 9.9)); break;
    case 3: snprintf(text, size, "modes %d", 1 + choose(seed, 60)); break;
    case 4: snprintf(text, size, "shape rectangle %.3f %.3f", 0.06 + x, 0.06 + chance(seed)); break;
    case 5: snprintf(text, size, "shape circle"); break;
    case 6:
        snprintf(text, size, "mallet %.3g %.3f %.4g", between(seed, 1.1e3, 9e12), 1 + 3 * x,
                 between(seed, 0.0011, 0.99));
        break;
    case 7: snprintf(text, size, "air %d", choose(seed, 2)); break;
    case 8: snprintf(text, size, "decay %.3g %.3g", 100 * x, 1e-4 * chance(seed)); break;
    case 9: snprintf(text, size, "uniformity %.3f %d", x, choose(seed, 1000)); break;
    default: snprintf(text, size, "glide %.3f", x);
    }
}

// several mallets at once, and changes one after the other, a few samples apart
static void test_random_changes_of_drums_in_contact_add_no_energy(void)
{
    for (unsigned first = 1; first <= 60; first++) {
        unsigned seed = first * 7919;
        char story[1000] = "";
        himc_drum *drum = new_drum("modes 40");
        for (int i = 0; i < 12; i++) {
            char text[100];
            random_change(text, sizeof text, &seed);
            snprintf(story + strlen(story), sizeof story - strlen(story), "%s; ", text);
            bounds limits = change_once(drum, text, story);
            double x = 0.05 * chance(&seed), velocity = 0.1 + 29 * chance(&seed);
            if (drum->waiting_count == 0)
                himc_drum_strike_at(drum, 0, x, 0, velocity, &error);
            himc_drum_advance(drum, 1, NULL, NULL, NULL); // the mallet is there
            if (drum->waiting_count > 0) // for a free mallet: it brings energy later
                himc_drum_advance(drum, 500, NULL, NULL, NULL);
            limits.energy = drum_energy(drum);
            if (drum->waiting_count == 0)
                play_within(drum, limits, 64 * (1 + choose(&seed, 4)), story);
        }
        himc_drum_release(drum);
    }
}

// of all heads and of the sticks whose contacts last
static double stick_energy(const himc_performance *p)
{
    double sum = 0;
    for (int i = 0; i < p->drums.count; i++)
        sum += drum_energy(p->drums.slot[i].drum);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (p->contacts.hand[hand].touching)
            sum += himc_contact_energy(&p->contacts.hand[hand].stick);
    return sum;
}

static void one_step(himc_performance *p)
{
    himc_performance_process(p, himc_clock_ahead(&p->clock) + 1, NULL);
}

// The arm works on a touching stick too: a 30 g stick at 10 m/s, accelerated by 1000 m/s^2, takes
// up 0.03 J in a step of 0.1 ms.
#define ARMS_WORK 0.1 // (J)

static void test_no_change_while_a_performer_touches_adds_energy(void)
{
    unsigned seed = 3;
    int touching = 0;
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    himc_drum *drum = himc_performance_drum(p, 0);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        const char *change = changes[i];
        int hand = (int)i % 2, into = choose(&seed, 20);
        const stick_contact *c = &p->contacts.hand[hand];
        tell(drum, mallets[choose(&seed, 10)]);
        session_do(p, "hit %s legato %.2f", himc_hand_name((himc_hand)hand), chance(&seed));
        for (int k = 0; k < 8000 && !c->touching; k++)
            one_step(p);
        for (int k = 0; k < into; k++)
            one_step(p);
        touching += c->stick.touching;
        double before = stick_energy(p);
        tell(drum, change);
        one_step(p);
        double after = stick_energy(p);
        char text[200];
        snprintf(text, sizeof text, "%s, %d steps, %s: %.6g J became %.6g J",
                 himc_hand_name((himc_hand)hand), into, change, before, after);
        TEST_ASSERT_TRUE_MESSAGE(after <= before * 1.001 + ARMS_WORK, text);
        TEST_ASSERT_TRUE_MESSAGE(himc_performance_measure(p).recoveries == 0, text);
        TEST_ASSERT_FALSE(c->stick.touching && strcmp(change, AWAY) == 0);
        session_do(p, "reset");
        session_do(p, "drum kettle");
        drum = himc_performance_drum(p, 0);
    }
    printf("%d of the changes during a touch\n", touching);
    TEST_ASSERT_TRUE(touching > 10);
    himc_performance_free(p);
}

// Hertz: the largest force on a head that does not yield is k^(1/(a+1)) ((a+1)/2 m v^2)^(a/(a+1))
static double hertz(const himc_mallet_head *h, double mass, double v)
{
    double a = h->exponent;
    return pow(h->stiffness, 1 / (a + 1)) * pow((a + 1) / 2 * mass * v * v, a / (a + 1));
}

// with the stick up to 3 cm below its head; a felt pressed in so far would push with 20 kN
static void test_a_drum_put_over_a_stick_does_not_press_it_in(void)
{
    static const double deep[] = {0.001, 0.005, 0.012, 0.02, 0.028};
    for (int i = 0; i < 5; i++) {
        himc_performance *p = session_new();
        char place[80];
        session_do(p, "drum kettle");
        session_play(p, 0.05, NULL);
        himc_vec3 tip = p->body->state.tip[HIMC_LEFT];
        snprintf(place, sizeof place, "place %.4f %.4f %.4f", tip.x + 0.1, tip.y,
                 tip.z - p->body->skeleton.mallet_radius + deep[i]);
        session_drum(p, 0, place);
        session_play(p, 0.02, NULL);
        double most = himc_performance_measure(p).peak_force;
        const himc_stick *s = &p->contacts.hand[HIMC_LEFT].stick;
        printf("%.0f mm below the head: %.1f N\n", 1e3 * deep[i], most);
        TEST_ASSERT_TRUE(s->mass > 0); // the stick has been simulated
        TEST_ASSERT_TRUE(most < 1);
        himc_performance_free(p);
    }
}

// A body that gains and rates cannot hold is thrown about. Here all its velocities are made 8
// times larger 1 cm above the head, which then feels a stick of 30 m/s.
static void test_a_thrown_stick_strikes_like_the_fastest_mallet(void)
{
    himc_performance *p = session_new();
    const himc_stick *s = &p->contacts.hand[HIMC_LEFT].stick;
    performance_body *b = p->body;
    double radius = b->skeleton.mallet_radius, thrown = 0, fastest = 0;
    session_do(p, "drum kettle");
    session_do(p, "latency 0");
    session_do(p, "hit left vertical-accent fff");
    while (b->state.tip_velocity[HIMC_LEFT].z > -4 || b->state.tip[HIMC_LEFT].z > 0.86 + radius)
        one_step(p);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        b->state.spin[i] = himc_vec3_scale(b->state.spin[i], 8);
    himc_body_take_up(b);
    for (int i = 0; i < 100; i++) {
        one_step(p);
        thrown = fmax(thrown, -b->state.tip_velocity[HIMC_LEFT].z);
        fastest = fmax(fastest, s->impact);
    }
    double most = himc_performance_measure(p).peak_force;
    printf("thrown at %.1f m/s, felt as %.1f m/s, %.0f N\n", thrown, fastest, most);
    TEST_ASSERT_TRUE(thrown > 1.2 * HIMC_STRIKE_VELOCITY_MAX);
    TEST_ASSERT_TRUE(fastest > 10 && fastest <= 1.01 * HIMC_STRIKE_VELOCITY_MAX);
    TEST_ASSERT_TRUE(most <= hertz(&s->head, 0.1, HIMC_STRIKE_VELOCITY_MAX));
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_change_at_any_moment_of_a_touch_adds_energy);
    RUN_TEST(test_random_changes_of_drums_in_contact_add_no_energy);
    RUN_TEST(test_no_change_while_a_performer_touches_adds_energy);
    RUN_TEST(test_a_drum_put_over_a_stick_does_not_press_it_in);
    RUN_TEST(test_a_thrown_stick_strikes_like_the_fastest_mallet);
    return UNITY_END();
}
