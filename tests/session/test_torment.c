/// test_torment.c: random commands of the whole vocabulary, half of them spoilt, to a performance
/// that plays: sound, strikes, targets, tips, joints, rows and packets are finite, no sample is
/// 20 dB above the loudest real stroke (40 dB once gains or a push have thrown an arm), a refused
/// command is answered by one line and without effect, and `reset` is as good as new.
///
/// `make torment` sends a million: HIMC_TORMENT is their number, HIMC_SEED the first seed. Rounds
/// of 500 commands begin with a `reset` and the fixed piece of test_reset.c, compared bit by bit
/// with that of a new performance. In one round of four the new performance goes on beside the
/// other and gets only the commands that were not refused: it must stay equal to the last bit.
#define _GNU_SOURCE
#include "disc_mesh.h"
#include "finite_watch.h"
#include "loudest_stroke.h"
#include "random_commands.h"
#include "sound_scale.h"
#include "take_players.h"

#include "heard_piece.h"

#define ROUND 500        // commands
#define LONGEST_BLOCK 64 // samples between two commands
#define RATE 16000  // (Hz) of samples; physics at 1000 Hz until `rate` changes it: to save time
#define SPOILT 0.5  // share of commands
#define TWINS 4     // one round of so many has a twin
#define PLAYED 0.3  // (s) of the piece
#define LOUDER 10.0 // 20 dB above the loudest real stroke
#define THROWN 15.0 // (m/s) a tip that has been so fast was thrown: gains that hold no arm ...
// of full scale: what the noise of a blow leaves in a channel that is made after it
#define INAUDIBLE 1e-5
#define PUSHED 500.0        // (N) ... or by a push: a player's own shoulder gives 200 N to the hand
#define THROWN_LOUDER 100.0 // ... and the weight of that arm is behind its blows
#define OF_TEMPO 0.2        // share of commands that change the tempo, or what depends on it
#define HEAVIEST_BLOW 450   // (J) a mallet of 1 kg, the heaviest, at 30 m/s
#define LOUDEST_ARM 3600    // (J) a stick that weighs as much as an arm, 2 kg, at 60 m/s

static char folder[] = "/tmp/himc-torment-XXXXXX", files[8][64];
static const char *file_list[9];
static char *take_text;

/// The performer under test; its twin, or NULL.
typedef struct pair {
    himc_performance *p, *twin;
    finite_watch watch; // of p
} pair;

/// What was seen of all commands.
typedef struct counts {
    long said, accepted, refused, spoilt[SPOILINGS], answered[SPOILINGS], notes;
    double loudest, share, energy; // sample, of the loudest stroke; (J) in a head
    long measured;                 // loudest strokes
    long rows, packets;            // that were finite
} counts;

static counts seen;
// seed and number with which the round began; with them it comes again, unless the drums that
// earlier rounds have made matter
static random_seed begun;
static int round_begun;
#define RECENT 12
static char recent[RECENT][600]; // the last commands with their answers, for a failure
static heard_piece expected, played;

static void write_file(const char *name, const char *text)
{
    char path[300];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    TEST_ASSERT_TRUE(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

// files that commands name: good ones, strange ones, and one that is not there
static void make_files(void)
{
    static const char *const names[] = {"take.bvh", "score.txt", "head.txt",  "broken.bvh",
                                        "bad.txt",  "gone.txt",  "record.bvh"};
    himc_skeleton body;
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(mkdtemp(folder) && himc_skeleton_init(&body, &config, &error));
    for (int i = 0; i < 7; i++) {
        snprintf(files[i], sizeof files[i], "%s/%s", folder, names[i]);
        file_list[i] = files[i];
    }
    himc_take *take = beaten_take(&body, 100, 1.2, &error);
    TEST_ASSERT_TRUE(take && himc_take_save(take, files[0], &error));
    himc_take_free(take);
    size_t size;
    take_text = read_all(files[0], &size);
    disc_mesh disc = disc_mesh_new(4, 0.3, 4000, 0.3);
    disc_mesh_write(&disc, folder, 4000, 0.3);
    disc_mesh_free(&disc);
    random_files = file_list;
}

// as commands may have left them no longer
static void write_files(void)
{
    write_file("take.bvh", take_text);
    write_file("score.txt", "tempo 140; drum tom 26; tom tune 110; stroke 0 left legato f;\n"
                            "kettle mallet wood; stroke 0.5 right accent ff normal tom; play;\n");
    write_file("broken.bvh", "HIERARCHY\nROOT a\n{\nOFFSET 0 0 nan\n\x1b[31m");
    write_file("bad.txt", "stroke 1 left \x1b[31m\n f;");
    unlink(files[6]);
}

static void remove_files(void)
{
    char all[80];
    snprintf(all, sizeof all, "rm -rf %s", folder);
    TEST_ASSERT_EQUAL_INT(0, system(all));
    free(take_text);
}

static char *story(long back)
{
    return recent[(seen.said + RECENT - back) % RECENT];
}

static void fail(const char *what)
{
    char text[1200];
    for (long back = RECENT - 1; back >= 0; back--)
        printf("%s\n", story(back));
    printf("again: HIMC_SEED=%llu HIMC_ROUND=%d\n", begun, round_begun);
    snprintf(text, sizeof text, "%.600s: %s", story(0), what);
    TEST_FAIL_MESSAGE(text);
}

// a line for a person: some text, no control characters
static bool is_one_line(const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        if (*c < 0x20 || *c == 0x7f || (*c == 0xc2 && c[1] < 0xa0))
            return false;
    return text[0] != 0;
}

// carries out a parsed command; `drum` is the slot, if it is for a drum
static bool carry_out(himc_performance *p, const himc_command *c, himc_receiver receiver, int drum,
                      int delay, himc_error *out)
{
    if (receiver == HIMC_PERFORMER)
        return himc_performance_command(p, c, delay, out);
    return himc_drum_command(himc_performance_drum(p, drum), c, out);
}

static void remember(const spoken *s, int drum, int delay)
{
    char *text = story(0);
    size_t used = (size_t)snprintf(text, sizeof recent[0], "command %ld, drum %d, delay %d: %.30s",
                                   seen.said, drum, delay, s->name);
    for (int i = 0; i < s->count && used < sizeof recent[0] - 80; i++)
        used += (size_t)(s->atom[i].kind == HIMC_ATOM_NUMBER
                             ? snprintf(text + used, 60, " %g", s->atom[i].number)
                             : snprintf(text + used, 60, " %.50s", s->atom[i].symbol));
}

// The loudest real stroke of each channel, of all settings of a drum since the round began: a head
// that is set to be softer still rings as it did.
static double loudest[HIMC_DRUMS][HIMC_PICKUPS];
static bool thrown;  // since the round began
static double swung; // since the round began: fastest `strike`, of the loudest stroke's speed

// what a drum has had: energy in its head (J), now and at most since the round began; level of its
// sound since then. What was most, delays and the room may still hold.
typedef struct past {
    double energy, most, level;
} past;

static past highest[HIMC_DRUMS]; // since the round began

static past past_of(const himc_drum *d, int slot)
{
    past *h = &highest[slot];
    h->energy = drum_energy(d);
    h->most = fmax(h->most, h->energy);
    h->level = fmax(h->level, d->level);
    return *h;
}

// the sound of an output with the most energy that the head has had in the mode that is loudest
// there, at the highest level that the sound has had
static double loudest_ringing_of(const himc_drum *d, int k, past before)
{
    const himc_membrane *m = d->membrane;
    const himc_readout *r = &m->model->outputs[k].readout;
    double most = 0;
    if (!himc_membrane_has(m, k))
        return 0;
    for (int i = 0; i < himc_membrane_audible(m); i++)
        most = fmax(most, hypot(r->p[i], r->s[i]) / sqrt(m->model->oscillators[i].mass));
    return fmax(d->set.gain, before.level) * sqrt(2 * before.most) * most;
}

// sound that a room returns of a source that sends 1 at 1 m (Sabine), at most
static double room_of(const himc_walls *walls)
{
    return walls->seconds > 0 ? sqrt(4 * HIMC_PI * walls->seconds / (0.161 * walls->volume)) : 0;
}

// of a pickup, or of the ear in its place, which hears rays, the floor and the room
static double loudest_ringing(const himc_drum *d, int channel, past before)
{
    if (!d->listener.on || channel >= HIMC_EARS)
        return loudest_ringing_of(d, channel, before);
    himc_ear_paths p = himc_ears_trace(&d->listener, &d->set.place);
    double ray = 0;
    for (int k = 0; k < HIMC_RAYS; k++)
        ray = fmax(ray, loudest_ringing_of(d, HIMC_PICKUPS + k, before));
    return ray *
           (p.direct[channel].gain + p.floor[channel].gain + HIMC_EARS_LEVEL * room_of(&d->walls));
}

// `before` is of before its setting changed. Made slacker, heavier or much lighter, or with a
// lighter mallet, it is louder with that energy than by a stroke of today: as the root of it, or as
// the energy may be in other modes than those of a stroke.
static void hear_loudest(const himc_drum *d, int slot, past before)
{
    double now[HIMC_PICKUPS], struck;
    seen.measured++;
    TEST_ASSERT_TRUE(loudest_stroke(d, before.level, now, &struck));
    for (int k = 0; k < HIMC_PICKUPS; k++)
        loudest[slot][k] =
            fmax(loudest[slot][k], now[k] * (struck > 0 ? fmax(1, sqrt(before.most / struck)) : 1));
    for (int k = 0; k < HIMC_PICKUPS; k++)
        loudest[slot][k] = fmax(loudest[slot][k], loudest_ringing(d, k, before));
}

// a channel that is new hears at first what the others do, of the settings before it
static double scale_of(int slot, int channel)
{
    double most = 0;
    for (int k = 0; k < HIMC_PICKUPS; k++)
        most = fmax(most, loudest[slot][k]);
    return fmax(1, swung) *
           fmax(loudest[slot][channel] > 0 ? loudest[slot][channel] : most, INAUDIBLE);
}

static const himc_command_id of_tempo[10] = {
    HIMC_COMMAND_TEMPO, HIMC_COMMAND_TEMPO, HIMC_COMMAND_TEMPO, HIMC_COMMAND_TEMPO,
    HIMC_COMMAND_ROLL,  HIMC_COMMAND_ROLL,  HIMC_COMMAND_FLAM,  HIMC_COMMAND_DRAG,
    HIMC_COMMAND_PLAY,  HIMC_COMMAND_PLAY};

// says one command, half of the time spoilt; what is refused is answered by one line
static void say_one(pair *of, random_seed *seed)
{
    spoken s;
    himc_command c;
    himc_error answer = {""};
    const himc_command_row *row = any(seed) < OF_TEMPO
                                      ? himc_command_table((int)of_tempo[any_of(seed, 10)])
                                      : himc_command_table(any_of(seed, HIMC_COMMANDS));
    random_command(&s, row, seed);
    bool hostile = any(seed) < SPOILT, must = false;
    spoiling how = hostile ? (spoiling)any_of(seed, SPOILINGS) : SPOILINGS;
    if (hostile)
        must = spoil(&s, how, seed);
    int drum = of->p->drums.count > 0 ? any_of(seed, of->p->drums.count) : -1;
    int delay = hostile || any(seed) < 0.5 ? 0 : any_of(seed, 2000);
    seen.said++;
    remember(&s, drum, delay);
    if (s.receiver == HIMC_DRUM && drum < 0)
        return;
    bool parsed = himc_command_parse(&c, s.receiver, s.name, s.atom, s.count, &answer);
    past before = drum < 0 ? (past){0} : past_of(himc_performance_drum(of->p, drum), drum);
    if (parsed && c.id == HIMC_COMMAND_STRIKE)
        swung = fmax(swung, s.atom[2].number / himc_gesture_of(HIMC_VERTICAL_ACCENT, 1).speed);
    // ears that move away still hear what was near, and what a room holds
    for (int i = 0; parsed && c.id == HIMC_COMMAND_LISTENER && i < of->p->drums.count; i++)
        hear_loudest(of->p->drums.slot[i].drum, i, past_of(of->p->drums.slot[i].drum, i));
    bool done = parsed && carry_out(of->p, &c, s.receiver, drum, delay, &answer);
    seen.accepted += done;
    seen.refused += !done;
    if (hostile) {
        seen.spoilt[how]++;
        seen.answered[how] += !done;
    }
    size_t used = strlen(story(0));
    snprintf(story(0) + used, sizeof recent[0] - used, " -> %s", done ? "done" : answer.text);
    if (done && must)
        fail("accepted");
    if (done ? answer.text[0] != 0 : !is_one_line(answer.text))
        fail(done ? "carried out, and an error besides" : "not one line");
    if (done && of->twin && !carry_out(of->twin, &c, s.receiver, drum, delay, &answer))
        fail("refused by the twin");
    if (done && s.receiver == HIMC_DRUM)
        hear_loudest(himc_performance_drum(of->p, drum), drum, before);
}

// notes are single lines too; all other figures of events are finite
static void take_notes(himc_performance *p, finite_watch *watch)
{
    himc_event e;
    while (himc_performance_event(p, &e)) {
        const himc_strike *s = &e.strike;
        if (watch)
            finite_watch_event(watch, &e);
        if (e.kind == HIMC_EVENT_NOTE && ++seen.notes && !is_one_line(e.text))
            fail("a note of more than one line");
        if (e.kind == HIMC_EVENT_STRIKE &&
            !isfinite(s->time + s->x + s->y + s->velocity + s->force + s->impulse + s->duration))
            fail("a strike that is not finite");
    }
}

// the samples of a drum's pickup against the loudest real stroke; `before` is of before them
static void check_sound(const himc_drum *d, int slot, int pickup, int n, past before)
{
    double sound[LONGEST_BLOCK], most = 0, sum = 0;
    himc_drum_read_channel(d, pickup, himc_drum_time(d) - (uint64_t)n, n, sound);
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(sound[i]));
        sum += sound[i];
    }
    double louder = thrown ? THROWN_LOUDER : LOUDER;
    if (most > louder * scale_of(slot, pickup)) // the head may have changed by itself
        hear_loudest(d, slot, before);
    double scale = scale_of(slot, pickup);
    seen.loudest = fmax(seen.loudest, most);
    seen.share = fmax(seen.share, most / scale);
    if (!isfinite(sum) || most > louder * scale) {
        printf("%s, channel %d: %g, the loudest stroke %g\n", d->set.name, pickup, most, scale);
        fail(thrown ? "a sample 40 dB above the loudest real stroke, after an arm was thrown"
                    : "a sample 20 dB above the loudest real stroke");
    }
}

static void check_drum(const himc_drum *d, int slot, int n, past before)
{
    int pickups;
    double after = drum_energy(d),
           most = before.energy + 2 * LOUDEST_ARM + HEAVIEST_BLOW * HIMC_STICKS;
    himc_membrane_pickups(d->membrane, &pickups);
    seen.energy = fmax(seen.energy, after);
    if (!(after <= most))
        fail("more energy than sticks can bring");
    for (int k = 0; k < (pickups > HIMC_EARS ? pickups : HIMC_EARS); k++)
        check_sound(d, slot, k, n, before);
}

// true if both drums have sounded the same; -0 is the same sample as 0
static bool sound_alike(const himc_drum *a, const himc_drum *b, int n)
{
    double ours[LONGEST_BLOCK], theirs[LONGEST_BLOCK];
    himc_drum_read(a, himc_drum_time(a) - (uint64_t)n, n, ours, NULL);
    himc_drum_read(b, himc_drum_time(b) - (uint64_t)n, n, theirs, NULL);
    for (int i = 0; i < n; i++)
        if (!(ours[i] == theirs[i]))
            return false;
    return true;
}

static void check_twin(const pair *of, int n, double *const a[2], double *const b[2])
{
    const performance_drums *ours = &of->p->drums, *theirs = &of->twin->drums;
    size_t bytes = (size_t)n * sizeof(double);
    if (ours->count != theirs->count)
        fail("a refused command changed the number of drums");
    if (memcmp(a[0], b[0], bytes) != 0 || memcmp(a[1], b[1], bytes) != 0)
        fail("a refused command changed a force");
    for (int i = 0; i < ours->count; i++)
        if (!sound_alike(ours->slot[i].drum, theirs->slot[i].drum, n))
            fail("a refused command changed a sound");
}

// plays up to LONGEST_BLOCK samples
static void play_on(pair *of, random_seed *seed)
{
    char what[80];
    double force[2][HIMC_HANDS][LONGEST_BLOCK];
    past before[HIMC_DRUMS];
    double *ours[] = {force[0][0], force[0][1]}, *theirs[] = {force[1][0], force[1][1]};
    int n = any_of(seed, LONGEST_BLOCK), count = of->p->drums.count;
    for (int i = 0; i < count; i++)
        before[i] = past_of(of->p->drums.slot[i].drum, i);
    himc_performance_process(of->p, n, ours);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        thrown |= himc_vec3_length(of->p->body->state.tip_velocity[hand]) > THROWN;
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        thrown |= himc_clock_time(&of->p->clock) < of->p->body->push[i].until + n / (double)RATE &&
                  himc_vec3_length(of->p->body->push[i].force) > PUSHED;
    for (int i = 0; i < count && n > 0; i++)
        check_drum(of->p->drums.slot[i].drum, i, n, before[i]);
    for (int i = 0; i < n; i++)
        if (!isfinite(ours[0][i] + ours[1][i]))
            fail("a force that is not finite");
    if (of->twin) {
        himc_performance_process(of->twin, n, theirs);
        check_twin(of, n, ours, theirs);
        take_notes(of->twin, NULL);
    }
    take_notes(of->p, of->watch.osc ? &of->watch : NULL);
    if (of->watch.osc)
        finite_watch_played(&of->watch, n / (double)RATE);
    if (of->watch.bad) {
        snprintf(what, sizeof what, "%s that is not finite", of->watch.bad);
        fail(what);
    }
}

static himc_performance *performer(himc_drum *drum)
{
    himc_performance_config config = {.sample_rate = RATE, .physics_rate = 1000, .task_rate = 250};
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_TRUE_MESSAGE(p && himc_performance_add_drum(p, drum, &error), error.text);
    himc_drum_release(drum);
    himc_performance_make_drums(p, true);
    return p;
}

// A new drum with the same settings. `reset` sends the listener away, whose ears still fade out;
// the new drum never had any.
static himc_drum *drum_like(const himc_drum *d)
{
    himc_drum_settings settings = himc_drum_settings_of(d);
    himc_drum *c = himc_drum_new_of(&settings, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(c, error.text);
    himc_drum_settings_free(&settings);
    himc_membrane_set_rays(c->membrane, NULL);
    c->level = d->level;
    return c;
}

static void unread(void *user, const himc_motion_row *row)
{
    (void)user;
    (void)row;
}

// `reset`, then the piece by this performance and by a new one; returns that. A pedal on its way is
// the drum's, which no reset stops: it arrives first.
static himc_performance *reset_and_compare(himc_performance *p)
{
    while (himc_drum_glides(himc_performance_drum(p, 0)))
        himc_performance_process(p, RATE / 10, NULL);
    session_do(p, "reset");
    himc_performance *fresh = performer(drum_like(himc_performance_drum(p, 0)));
    play_piece(fresh, PLAYED, &expected);
    play_piece(p, PLAYED, &played);
    check_piece(&expected, &played, story(0));
    session_do(p, "reset");
    session_do(fresh, "reset");
    himc_performance_process(p, (int)(DECLICK * RATE), NULL); // of how the piece has ended
    himc_performance_process(fresh, (int)(DECLICK * RATE), NULL);
    return fresh;
}

static void print_counts(void)
{
    printf("%ld commands: %ld carried out, %ld refused; %ld notes; largest sample %.3g, %.3g of "
           "the loudest stroke, measured %ld times; most energy %.3g J; %ld rows, %ld packets\n",
           seen.said, seen.accepted, seen.refused, seen.notes, seen.loudest, seen.share,
           seen.measured, seen.energy, seen.rows, seen.packets);
    for (int k = 0; k < SPOILINGS; k++)
        printf("  %-14s %8ld tried, %8ld refused in one line\n", spoiling_name[k], seen.spoilt[k],
               seen.answered[k]);
    fflush(stdout);
}

static long from_environment(const char *name, long usual)
{
    const char *text = getenv(name);
    return text ? atol(text) : usual;
}

static void test_hostile_commands_leave_a_performance_finite_bounded_and_as_good_as_new(void)
{
    long commands = from_environment("HIMC_TORMENT", 4000);
    const char *first = getenv("HIMC_SEED");
    random_seed seed = first ? strtoull(first, NULL, 10) : 1;
    pair of = {.p = performer(himc_drum_new("kettle", 23, RATE, &error))};
    printf("seed %llu\n", seed);
    for (int round = (int)from_environment("HIMC_ROUND", 0); seen.said < commands; round++) {
        begun = seed;
        round_begun = round;
        himc_performance *fresh = reset_and_compare(of.p);
        if (round % TWINS == 0) {
            of.twin = fresh;
            himc_performance_on_motion(fresh, unread, NULL); // a head that is asked may round else
        } else
            himc_performance_free(fresh);
        write_files();
        TEST_ASSERT_TRUE(finite_watch_begin(&of.watch, of.p));
        memset(loudest, 0, sizeof loudest);
        memset(highest, 0, sizeof highest);
        thrown = false;
        swung = 0;
        for (int i = 0; i < ROUND; i++) {
            say_one(&of, &seed);
            play_on(&of, &seed);
        }
        himc_performance_free(of.twin);
        of.twin = NULL;
        seen.rows += of.watch.rows;
        seen.packets += of.watch.packets;
        finite_watch_end(&of.watch);
        if (commands > 100000 && round % 50 == 49)
            print_counts();
    }
    himc_performance_free(reset_and_compare(of.p));
    himc_performance_free(of.p);
    print_counts();
    for (int k = 0; k < SPOILINGS; k++)
        TEST_ASSERT_TRUE(seen.spoilt[k] > 0);
    TEST_ASSERT_TRUE(seen.rows > seen.said / 20 && seen.packets > seen.said / 20);
}

// A drum whose ears fade out, or have not yet begun to hear: nothing of that reaches the next
// listener.
static void listen_again(int samples)
{
    double force[2][HIMC_HANDS][LONGEST_BLOCK];
    double *ours[] = {force[0][0], force[0][1]}, *theirs[] = {force[1][0], force[1][1]};
    pair of = {.p = performer(himc_drum_new("kettle", 23, RATE, &error))};
    himc_command c;
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, "place 0.7 0.1 0.8", &error) &&
                     himc_drum_command(himc_performance_drum(of.p, 0), &c, &error));
    session_do(of.p, "listener 1 1 1");
    himc_performance_process(of.p, samples, NULL);
    of.twin = reset_and_compare(of.p);
    for (int i = 0; i < 100; i++) {
        for (int k = 0; k < 2; k++) {
            himc_performance *p = k ? of.twin : of.p;
            if (i == 20)
                session_do(p, "listener 2 0 1.5");
            if (i % 20 == 0)
                himc_drum_strike_at(himc_performance_drum(p, 0), 10, 0.1, 0, 3, &error);
            himc_performance_process(p, LONGEST_BLOCK, k ? theirs : ours);
        }
        check_twin(&of, LONGEST_BLOCK, ours, theirs);
    }
    himc_performance_free(of.twin);
    himc_performance_free(of.p);
}

static void test_a_listener_of_before_a_reset_is_not_heard_after_it(void)
{
    listen_again(0);
    listen_again(1000);
}

int main(void)
{
    UNITY_BEGIN();
    make_files();
    RUN_TEST(test_a_listener_of_before_a_reset_is_not_heard_after_it);
    RUN_TEST(test_hostile_commands_leave_a_performance_finite_bounded_and_as_good_as_new);
    remove_files();
    return UNITY_END();
}
