/// drum.c: a drum advances with all that is in contact with it, sample by sample, into a ring that
/// others read.
///
/// Every sample is the same computation however it is asked for. While nothing can touch the head
/// (himc_contact_clear) it runs free in long vectorised passes, with the same bits as single
/// steps (bank.c); otherwise each sample is a himc_contact_step of all sticks. So the output does
/// not depend on how the caller cuts time into blocks.
#include "drum/drum_state.h"

#include "base/head_frame.h"
#include "base/line.h"
#include "drum/contact.h"
#include "drum/strike_point.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RUN_BLOCK 64         // samples of a pass of the free head; chosen: bank.c's
#define WATCHED HIMC_PICKUPS // index of the ring of displacements
#define NOISE_UNIT (100 / HIMC_PICKUP_PRESSURE) // the noise was fitted where 1.0 was 100 Pa
#define LEVEL_RAMP 0.010      // (s) of the head's own sound from on to off; chosen: no click
#define MUFFLED_DAMP 0.5      // a cloth ends noise as such a hand does; chosen: in 0.2 s
#define NOISE_MOVES 400.0     // of a pickup's nearness to noise (1/m in a second); chosen: no click
#define FIRST_WATCHED (-0.75) // x per radius: where strokes `normal` land

static const himc_vec3 FIRST_PLACE = {0.70, 0, 0.85}; // (m) chosen: in front of a seated player

bool himc_drum_check_rate(double rate, himc_error *error)
{
    return himc_check_range("sample rate", rate, 8000, 192000, "Hz", error);
}

// of uneven lugs: another for another name (G. Fowler, L. C. Noll & K.-P. Vo: FNV-1a)
static int seed_of(const char *name)
{
    uint32_t hash = 2166136261u;
    for (; *name; name++)
        hash = (hash ^ (unsigned char)*name) * 16777619u;
    return (int)(hash % ((uint32_t)HIMC_SEED_MAX + 1));
}

bool himc_drum_settings_new(himc_drum_settings *settings, const char *name, double inches,
                            double sample_rate, himc_error *error)
{
    if (!name)
        return himc_error_set(error, "drum: a name is missing");
    if (strlen(name) >= HIMC_NAME_SIZE)
        return himc_error_set(error, "drum: name %s, expected up to %d characters", name,
                              HIMC_NAME_SIZE - 1);
    if (!himc_line_is_clean(name))
        return himc_error_set(error, "drum: name %s, expected UTF-8 without control characters",
                              name);
    if (!himc_check_range("inches", inches, HIMC_INCHES_MIN, HIMC_INCHES_MAX, "in", error) ||
        !himc_drum_check_rate(sample_rate, error))
        return false;
    himc_head head = himc_head_default();
    head.radius = inches * METRES_PER_INCH / 2;
    head.uniformity_seed = seed_of(name);
    *settings = (himc_drum_settings){.head = {.shape = {.kind = &himc_kind_round},
                                              .head = head,
                                              .pickups = {himc_pickup_default()},
                                              .pickup_count = 1,
                                              .rate = sample_rate},
                                     .usual = head,
                                     .place = {.center = FIRST_PLACE, .radius = head.radius},
                                     .noise = himc_stroke_noise_at(sample_rate).amount,
                                     .gain = 1};
    snprintf(settings->name, sizeof settings->name, "%s", name);
    himc_drum_take_mallet(settings, DRUM_MALLET_MEDIUM);
    return true;
}

himc_drum *himc_drum_new(const char *name, double inches, double sample_rate, himc_error *error)
{
    himc_drum_settings settings;
    return himc_drum_settings_new(&settings, name, inches, sample_rate, error)
               ? himc_drum_new_of(&settings, error)
               : NULL;
}

// of a pickup to the noise (1/m): 0 on the head, which hears none
static double nearness(const himc_pickup *pickup)
{
    return pickup->kind == HIMC_PICKUP_AIR ? 1 / pickup->distance : 0;
}

// while no noise sounds, it is at once where the pickups are
static void settle_noise(himc_drum *drum)
{
    const himc_membrane_config *head = himc_membrane_config_of(drum->membrane);
    for (int k = 0; k < head->pickup_count && !drum->noise.sounds; k++)
        drum->nearness[k] = nearness(&head->pickups[k]);
}

himc_drum *himc_drum_new_of(const himc_drum_settings *settings, himc_error *error)
{
    himc_membrane *membrane =
        himc_membrane_new_of(himc_model_new(&settings->head, NULL, error), error);
    himc_drum *drum = membrane ? calloc(1, sizeof *drum) : NULL;
    if (!drum) {
        if (membrane)
            himc_error_set(error, "drum: no memory");
        himc_membrane_free(membrane);
        return NULL;
    }
    drum->references = 1;
    drum->level = drum->fader = 1;
    drum->walls = HIMC_WALLS_USUAL;
    drum->membrane = membrane;
    drum->set = *settings;
    drum->rate = settings->head.rate;
    drum->noise = himc_stroke_noise_at(drum->rate);
    himc_drum_find_noise(drum, &drum->set.mallet[HIMC_RIGHT]);
    settle_noise(drum);
    drum->outside_x = FIRST_WATCHED * settings->place.radius;
    himc_membrane_watch(membrane, drum->outside_x, drum->outside_y);
    return drum;
}

himc_drum_settings himc_drum_settings_of(const himc_drum *drum)
{
    himc_drum_settings settings = drum->set;
    settings.head = himc_drum_head_config(drum);
    settings.pedal = false;
    settings.head.muted = false;
    return himc_drum_settings_copy(&settings);
}

himc_drum_settings himc_drum_settings_copy(const himc_drum_settings *settings)
{
    himc_shape_retain(&settings->head.shape);
    return *settings;
}

void himc_drum_settings_free(himc_drum_settings *settings)
{
    himc_shape_release(&settings->head.shape);
    settings->head.shape.grid = NULL;
    settings->head.shape.body = NULL;
}

void himc_drum_settings_take_head(himc_drum_settings *settings, const himc_drum_settings *from)
{
    const himc_shape *own = &settings->head.shape, *its = &from->head.shape;
    if (own->body != its->body || own->shell != its->shell) { // its own mallet came with it
        memcpy(settings->mallet, from->mallet, sizeof settings->mallet);
        memcpy(settings->mallet_name, from->mallet_name, sizeof settings->mallet_name);
    }
    settings->head = from->head;
    settings->picked = from->picked;
    settings->pedal = from->pedal;
    settings->gliss = from->gliss;
    settings->place = himc_head_frame_at(&settings->place, &from->place);
}

bool himc_drum_has_head(const himc_drum *drum, const himc_drum_settings *settings)
{
    himc_membrane_config head = himc_drum_head_config(drum);
    return himc_membrane_config_equal(&head, &settings->head);
}

// gives the drum's head another config, or the model that was made of it, in that time
static bool set_head(himc_drum *drum, const himc_membrane_config *to, double seconds,
                     himc_model **made, himc_error *error)
{
    const himc_membrane_config *now = himc_membrane_config_of(drum->membrane);
    himc_membrane_config here = *to;
    here.rate = now->rate;
    here.shares = now->shares;
    if (made && *made) {
        if (here.rate != (*made)->config.rate || here.shares != (*made)->config.shares)
            himc_model_make(*made, &here);
        return himc_drum_take_head(drum, &here, seconds, made, error);
    }
    here.rays = false;
    himc_membrane_config_set_rays(&here, now->rays ? now->pickups + HIMC_PICKUPS : NULL);
    himc_membrane_config was = himc_drum_head_config(drum);
    bool moves = seconds >= 0 && himc_drum_glides(drum);
    if (!moves && himc_membrane_config_equal(&was, &here))
        return true;
    return !moves && himc_head_equal(&was.head, &here.head) &&
                   himc_shape_equal(&was.shape, &here.shape)
               ? himc_membrane_set_pickups(drum->membrane, here.pickups, here.pickup_count, error)
               : himc_drum_take_head(drum, &here, seconds, NULL, error);
}

bool himc_drum_set(himc_drum *drum, const himc_drum_settings *to, himc_model **made,
                   himc_error *error)
{
    const himc_mallet_head *mallet = drum->set.mallet;
    const himc_head_frame *place = &drum->set.place;
    himc_head_frame there = himc_head_frame_at(&to->place, place);
    bool moves = !himc_head_frame_equal(place, &there);
    bool grows = !himc_head_frame_equal(&to->place, &there) ||
                 himc_membrane_config_of(drum->membrane)->shape.kind != to->head.shape.kind;
    bool exchanges = made && *made;
    if (!set_head(drum, &to->head, to->pedal ? to->gliss : -1, made, error))
        return false;
    bool heard = himc_drum_is_heard(drum);
    drum->revision += moves || grows || memcmp(mallet, to->mallet, sizeof to->mallet) != 0;
    drum->set = *to;
    drum->set.pedal = false;
    himc_drum_find_noise(drum, &drum->set.mallet[HIMC_RIGHT]);
    settle_noise(drum);
    if (moves || exchanges || heard != himc_drum_is_heard(drum))
        himc_drum_find_ways(drum);
    return true;
}

himc_drum *himc_drum_retain(himc_drum *drum)
{
    drum->references++;
    return drum;
}

void himc_drum_release(himc_drum *drum)
{
    if (!drum || --drum->references > 0)
        return;
    himc_membrane_free(drum->membrane);
    himc_model_free(drum->gliss.goal);
    free(drum->ears);
    free(drum);
}

const char *himc_drum_name(const himc_drum *drum)
{
    return drum->set.name;
}

void himc_drum_rest(himc_drum *drum)
{
    himc_membrane_rest(drum->membrane);
    himc_stroke_noise_rest(&drum->noise);
    drum->waiting_count = 0;
    for (int i = 0; i < HIMC_STICKS; i++)
        drum->mallets[i] = (drum_mallet){.used = false};
}

bool himc_drum_is_placed(const himc_drum *drum)
{
    return drum->set.placed;
}

double himc_drum_inches(const himc_drum *drum)
{
    return 2 * drum->set.usual.radius / METRES_PER_INCH;
}

void himc_drum_fade(himc_drum *drum, double factor)
{
    drum->fader = factor;
}

void himc_drum_stand(himc_drum *drum, himc_vec3 center)
{
    drum->set.place.center = center;
    drum->revision++;
    himc_drum_find_ways(drum);
}

const himc_head_frame *himc_drum_head_frame(const himc_drum *drum)
{
    return &drum->set.place;
}

bool himc_drum_is_footed(const himc_drum *drum)
{
    const himc_head_frame *place = &drum->set.place;
    const himc_shell *shell = himc_membrane_config_of(drum->membrane)->shape.shell;
    return shell && shell->mallet == &himc_shell_beater && place->center.z < 2 * place->radius;
}

himc_membrane *himc_drum_membrane(himc_drum *drum)
{
    return drum->membrane;
}

const himc_mallet_head *himc_drum_mallet(const himc_drum *drum, himc_hand hand)
{
    return &drum->set.mallet[hand];
}

unsigned himc_drum_revision(const himc_drum *drum)
{
    return drum->revision;
}

double himc_drum_rate(const himc_drum *drum)
{
    return drum->rate;
}

bool himc_drum_set_rate(himc_drum *drum, double sample_rate, himc_error *error)
{
    if (!himc_drum_check_rate(sample_rate, error) ||
        !himc_membrane_set_rate(drum->membrane, sample_rate, error))
        return false;
    double ratio = sample_rate / drum->rate;
    for (int i = 0; i < drum->waiting_count; i++) {
        uint64_t left = drum->waiting[i].at > drum->time ? drum->waiting[i].at - drum->time : 0;
        drum->waiting[i].at = drum->time + (uint64_t)llround((double)left * ratio);
    }
    // contacts in progress keep the seconds that have passed since
    for (int i = 0; i < HIMC_STICKS; i++) {
        drum_mallet *m = &drum->mallets[i];
        m->first = drum->time - (uint64_t)llround((double)(drum->time - m->first) * ratio);
        m->end = drum->time - (uint64_t)llround((double)(drum->time - m->end) * ratio);
    }
    drum->rate = sample_rate;
    himc_stroke_noise_set_rate(&drum->noise, sample_rate);
    himc_drum_find_ways(drum);
    return true;
}

// the outside force of sample `at`, finite and limited
static double force_at(const himc_outside_force *o, int at)
{
    if (!o->force || !isfinite(o->force[at]))
        return 0;
    return fmin(fmax(o->force[at], -HIMC_FORCE_MAX), HIMC_FORCE_MAX);
}

// whether its point is another there
static bool moves_at(const himc_drum *drum, const himc_outside_force *o, int at)
{
    return o->force && o->x && o->y && isfinite(o->x[at]) && isfinite(o->y[at]) &&
           (o->x[at] != drum->outside_x || o->y[at] != drum->outside_y);
}

// n samples into ring `index`, times their levels, if any; `row` is NULL for silence
static void store_row(himc_drum *drum, int index, int n, const double *row, const double *levels)
{
    if (row)
        drum->filled[index] = drum->time + (uint64_t)n;
    else if (drum->filled[index] == 0 || drum->time >= drum->filled[index] + HIMC_DRUM_RING)
        return; // the ring is silent already
    for (int i = 0; i < n; i++) {
        size_t at = (drum->time + (uint64_t)i) % HIMC_DRUM_RING;
        drum->ring[index][at] = !row ? 0 : levels ? levels[i] * row[i] : row[i];
    }
}

// Puts the ears in the place of the first two channels, as far as they are heard; `sound` has the
// rays behind the pickups. Returns the number of channels that may sound.
static int listen_in(himc_drum *drum, int n, double *const *sound, bool silent)
{
    himc_ears *ears = drum->ears;
    const himc_membrane_config *head = himc_membrane_config_of(drum->membrane);
    int count = silent ? 0 : head->pickup_count, some = count > HIMC_EARS ? count : HIMC_EARS;
    if (!himc_ears_heard(ears) || (silent && himc_ears_at_rest(ears)))
        return count;
    for (int k = himc_ears_alone(ears) ? 0 : count; k < HIMC_EARS; k++)
        memset(sound[k], 0, (size_t)n * sizeof(double));
    if (count == 1 && !himc_ears_alone(ears))
        memcpy(sound[1], sound[0], (size_t)n * sizeof(double));
    himc_ears_hear(ears, n, !silent && head->rays ? sound + HIMC_PICKUPS : NULL, sound,
                   drum->set.gain * drum->fader);
    if (himc_ears_alone(ears))
        himc_membrane_mute_pickups(drum->membrane, true);
    if (!himc_ears_heard(ears))
        himc_membrane_set_rays(drum->membrane, NULL);
    return some;
}

// n samples into the rings; `watched` is NULL if unwanted
static void store(himc_drum *drum, int n, double *const *sound, const double *watched, bool silent)
{
    double levels[RUN_BLOCK];
    int count = listen_in(drum, n, sound, silent);
    bool sounds = drum->set.technique == HIMC_TECHNIQUE_MODAL && !drum->set.mute;
    double goal = sounds ? drum->set.gain * drum->fader : 0; // of the head's own sound
    for (int i = 0; i < n && (count > 0 || drum->level != goal); i++) {
        if (drum->level != goal) {
            double step = fmax(fmax(goal, drum->level), 1) / (LEVEL_RAMP * drum->rate);
            drum->level += fmin(fmax(goal - drum->level, -step), step);
        }
        levels[i] = drum->level;
    }
    for (int k = 0; k < HIMC_PICKUPS; k++) {
        bool again = k == 1 && count == 1; // a single pickup is heard on both sides
        store_row(drum, k, n, again ? sound[0] : k < count ? sound[k] : NULL, levels);
    }
    store_row(drum, WATCHED, n, silent ? NULL : watched, NULL);
    drum->time += (uint64_t)n;
}

// adds the noise of blows, while `force` acts in each sample, to the pickups in the air and to the
// rays to a listener
static void add_noise(himc_drum *drum, int n, double force, double *const *sound)
{
    double noise[HIMC_NOISE_ROWS][RUN_BLOCK], most = NOISE_MOVES / drum->rate;
    const himc_membrane_config *head = himc_membrane_config_of(drum->membrane);
    const himc_pickup *pickups = head->pickups;
    bool rays = head->rays;
    if (!drum->noise.sounds && force == 0) {
        settle_noise(drum);
        return;
    }
    double held = fmin(head->head.damp + MUFFLED_DAMP * head->head.muffle + drum->hold, 1);
    if (drum->noise.damp != held)
        himc_stroke_noise_damp(&drum->noise, held);
    himc_stroke_noise_run(&drum->noise, n, force, rays ? 2 : 1, (double *[]){noise[0], noise[1]});
    for (int k = himc_ears_alone(drum->ears) ? HIMC_EARS : 0; k < head->pickup_count; k++) {
        double *at = &drum->nearness[k], to = nearness(&pickups[k]);
        int i = 0;
        for (; i < n && *at != to; i++) { // the pickup has moved
            *at += fmin(fmax(to - *at, -most), most);
            sound[k][i] += NOISE_UNIT * noise[0][i] * *at;
        }
        for (; i < n && pickups[k].kind == HIMC_PICKUP_AIR; i++)
            sound[k][i] += NOISE_UNIT * noise[0][i] / pickups[k].distance;
    }
    for (int k = 0; k < HIMC_RAYS && rays; k++)
        for (int i = 0; i < n; i++)
            sound[HIMC_PICKUPS + k][i] += NOISE_UNIT * noise[k == HIMC_RAY_RIGHT][i];
}

// runs the head without contact; the sticks fly
static void run_clear(himc_drum *drum, int n, himc_stick *const *sticks, int count,
                      double *const *forces, int at)
{
    double sound[HIMC_OUTPUTS][RUN_BLOCK], watched[RUN_BLOCK], h = 1 / drum->rate;
    double *into[HIMC_OUTPUTS], *seen = drum->unwatched ? NULL : watched;
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        into[k] = sound[k];
    bool silent = himc_membrane_at_rest(drum->membrane) && !drum->noise.sounds;
    drum->hold = 0;
    if (!silent)
        himc_membrane_run_all(drum->membrane, n, into, seen);
    add_noise(drum, n, 0, into);
    store(drum, n, into, seen, silent);
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < n; i++)
            himc_stick_fly(sticks[k], h);
        for (int i = 0; forces && forces[k] && i < n; i++)
            forces[k][at + i] = 0;
    }
}

// samples made one by one that are not stored yet: ears take several together
typedef struct singles {
    int count;
    double sound[HIMC_OUTPUTS][RUN_BLOCK], watched[RUN_BLOCK];
} singles;

static void store_singles(himc_drum *drum, singles *s)
{
    double *sound[HIMC_OUTPUTS];
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        sound[k] = s->sound[k];
    if (s->count > 0)
        store(drum, s->count, sound, drum->unwatched ? NULL : s->watched, false);
    s->count = 0;
}

// runs one sample with everything that may touch the head: `given` sticks and the drum's mallets
static void step_once(himc_drum *drum, himc_stick **all, int given, double *const *forces,
                      double outside, int at, singles *made)
{
    if (outside != 0)
        himc_membrane_push(drum->membrane, drum->outside_x, drum->outside_y, outside);
    int count = given + himc_drum_add_mallets(drum, all + given);
    unsigned known[2 * HIMC_STICKS];
    double pressing = 0;
    uint64_t now = drum->time + (uint64_t)made->count;
    drum->hold = now >= drum->laid_from && now < drum->laid_until;
    for (int k = 0; k < count; k++)
        known[k] = all[k]->contacts;
    himc_contact_step(drum->membrane, all, count);
    for (int k = 0; k < count; k++) {
        if (all[k]->contacts != known[k]) {
            store_singles(drum, made); // an onset has the drum's time
            if (drum->set.mallet[HIMC_LEFT].noise != drum->set.mallet[HIMC_RIGHT].noise)
                himc_drum_find_noise(drum, &all[k]->head);
            himc_stroke_noise_begin(&drum->noise, all[k]->x, all[k]->y);
            himc_drum_keep_onset(drum, all[k]);
            himc_drum_launch_shaft(drum, all[k]);
        }
        pressing += all[k]->force;
        drum->hold = fmax(drum->hold, all[k]->force > 0 ? all[k]->hold : 0);
    }
    if (drum->hold > 0) // 2 d of the velocity is d of an oscillation
        himc_bank_slow(drum->membrane->model->bank, 2 * drum->hold * HIMC_DAMP / drum->rate);
    for (int k = 0; forces && k < given; k++)
        if (forces[k])
            forces[k][at] = all[k]->force;
    double *into[HIMC_OUTPUTS];
    for (int k = 0; k < HIMC_OUTPUTS; k++) {
        into[k] = &made->sound[k][made->count];
        *into[k] = himc_membrane_sound(drum->membrane, k);
    }
    made->watched[made->count++] = drum->unwatched ? 0 : himc_membrane_watched(drum->membrane);
    add_noise(drum, 1, pressing, into);
    // launches and pedal go by the drum's time
    if (count > given || drum->waiting_count > 0 || himc_drum_glides(drum) ||
        made->count == RUN_BLOCK)
        store_singles(drum, made);
    himc_drum_follow_mallets(drum);
}

bool himc_drum_advance_sticks(himc_drum *drum, int n, himc_stick *const *sticks, int count,
                              double *const *forces, const himc_outside_force *outside)
{
    static const himc_outside_force none;
    const himc_outside_force *o = outside ? outside : &none;
    himc_stick *all[2 * HIMC_STICKS];
    singles made;
    made.count = 0;
    bool near = false;
    for (int i = 0; i < count; i++)
        all[i] = sticks[i];
    int at = 0;
    while (at < n) {
        himc_drum_go_gliss(drum);
        himc_drum_launch(drum);
        if (moves_at(drum, o, at)) {
            drum->outside_x = o->x[at];
            drum->outside_y = o->y[at];
            himc_membrane_watch(drum->membrane, drum->outside_x, drum->outside_y);
        }
        bool alone = himc_drum_add_mallets(drum, all + count) == 0;
        int most = n - at < RUN_BLOCK ? n - at : RUN_BLOCK, run = 0;
        while (alone && run < most && force_at(o, at + run) == 0 && !moves_at(drum, o, at + run))
            run++;
        run = himc_drum_until_gliss(drum, himc_drum_until_launch(drum, run));
        uint64_t now = drum->time + (uint64_t)made.count;
        if (now < drum->laid_until) // under a hand, sample by sample
            run = now >= drum->laid_from                  ? 0
                  : drum->laid_from - now < (uint64_t)run ? (int)(drum->laid_from - now)
                                                          : run;
        run = himc_contact_clear(drum->membrane, all, count, run);
        near = near || run == 0;
        if (run > 0) {
            store_singles(drum, &made);
            run_clear(drum, run, all, count, forces, at);
        } else {
            step_once(drum, all, count, forces, force_at(o, at), at, &made);
        }
        at += run > 0 ? run : 1;
    }
    store_singles(drum, &made);
    return near;
}

void himc_drum_advance(himc_drum *drum, int n, const double *force, const double *x,
                       const double *y)
{
    himc_drum_advance_sticks(drum, n, NULL, 0, NULL, &(himc_outside_force){force, x, y});
}

// samples [start, start + n) of a ring, or the mean of two
static void copy(const himc_drum *drum, const double *ring, const double *other, uint64_t start,
                 int n, double *out)
{
    uint64_t oldest = drum->time > HIMC_DRUM_RING ? drum->time - HIMC_DRUM_RING : 0;
    for (int i = 0; i < n; i++) {
        uint64_t at = drum->zero + start + (uint64_t)i, k = at % HIMC_DRUM_RING;
        out[i] = at >= oldest && at < drum->time ? 0.5 * (ring[k] + other[k]) : 0;
    }
}

void himc_drum_read(const himc_drum *drum, uint64_t start, int n, double *sound,
                    double *displacement)
{
    int count = himc_membrane_config_of(drum->membrane)->pickup_count;
    bool both = count == 1 || himc_drum_is_heard(drum);
    const double *seen = drum->ring[WATCHED];
    if (sound)
        copy(drum, drum->ring[0], drum->ring[both ? 1 : 0], start, n, sound);
    if (displacement)
        copy(drum, seen, seen, start, n, displacement);
}

void himc_drum_read_channel(const himc_drum *drum, int channel, uint64_t start, int n,
                            double *sound)
{
    copy(drum, drum->ring[channel], drum->ring[channel], start, n, sound);
}

void himc_drum_watch(himc_drum *drum, bool on)
{
    drum->unwatched = !on;
}

uint64_t himc_drum_time(const himc_drum *drum)
{
    return drum->time - drum->zero;
}

void himc_drum_realign(himc_drum *drum, int ahead)
{
    uint64_t kept = ahead > 0 ? (uint64_t)ahead : 0, before = drum->zero;
    drum->zero = drum->time - (kept < drum->time ? kept : drum->time);
    for (int i = 0; i < drum->report_queue.count; i++)
        drum->reports[(drum->report_queue.first + i) % DRUM_QUEUE].time -=
            ((double)drum->zero - (double)before) / drum->rate;
}

bool himc_drum_set_driver(himc_drum *drum, himc_drum_driver driver)
{
    if (driver.performer && drum->driver.performer && drum->driver.performer != driver.performer)
        return false;
    drum->driver = driver;
    return true;
}

himc_drum_driver himc_drum_get_driver(const himc_drum *drum)
{
    return drum->driver;
}

himc_technique himc_drum_technique(const himc_drum *drum)
{
    return drum->set.technique;
}

void himc_drum_set_external_sound(himc_drum *drum, bool external)
{
    drum->set.external_sound = external;
}

bool himc_drum_is_touched(const himc_drum *drum)
{
    return drum->membrane->applied_count > 0;
}
