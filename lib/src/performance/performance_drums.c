/// performance_drums.c: the drums of a performance.
///
/// A drum without a `place` is put on the arc of the first drum around the player. Its angle is
/// the one nearest to straight ahead at which its rim is clear of the others, first to the right,
/// then to the left. So no two drums are at one place, where a stick could not tell them apart.
#include "performance/performance_drums.h"
#include "base/argument.h"
#include "base/array.h"
#include "base/format.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

// chosen: as timpani are set up, rims a finger apart and all within a turn of the trunk
#define LONGEST_WAIT 12 // of a change of the head for a stick to leave it (ticks); chosen: 50 ms
#define RIM_GAP 0.02    // least, between two rims (m)
#define ARC_ANGLE_STEP 0.02 // between two angles that are tried (rad)
#define ARC_END 1.9         // largest turn of a player (rad)
#define ARC_STEP 0.1        // from one arc to the next (m)
#define LARGEST_ARC 2.0     // (m)

int himc_drums_find(const performance_drums *d, const char *name)
{
    for (int i = 0; i < d->count; i++)
        if (strcmp(himc_drum_name(d->slot[i].drum), name) == 0)
            return i;
    return -1;
}

const himc_head_frame *himc_drums_frame(const performance_drums *d, int index)
{
    return himc_drum_head_frame(d->slot[index].drum);
}

const himc_head_axes *himc_drums_axes(performance_drums *d, int index)
{
    drum_slot *slot = &d->slot[index];
    const himc_head_frame *frame = himc_drums_frame(d, index);
    if (!himc_head_frame_equal(&slot->seen, frame)) {
        slot->seen = *frame;
        slot->axes = himc_head_axes_of(frame);
    }
    return &slot->axes;
}

himc_vec3 himc_drums_local(performance_drums *d, int index, himc_vec3 point)
{
    const himc_head_axes *axes = himc_drums_axes(d, index);
    himc_vec3 away = himc_vec3_sub(point, himc_drums_frame(d, index)->center);
    return himc_vec3_make(himc_vec3_dot(away, axes->x), himc_vec3_dot(away, axes->y),
                          himc_vec3_dot(away, axes->normal));
}

static bool is_clear(const performance_drums *d, int index, himc_vec3 center)
{
    // of the sizes as they were made, which a dump tells before anything else
    double radius = 0.5 * METRES_PER_INCH * himc_drum_inches(d->slot[index].drum);
    for (int i = 0; i < d->count; i++) {
        const himc_head_frame *other = himc_drums_frame(d, i);
        double its = 0.5 * METRES_PER_INCH * himc_drum_inches(d->slot[i].drum);
        double apart = hypot(center.x - other->center.x, center.y - other->center.y);
        if (i != index && apart < radius + its + RIM_GAP)
            return false;
    }
    return true;
}

// false once its owner has moved a drum
static bool is_where_put(const drum_slot *slot)
{
    himc_vec3 now = himc_drum_head_frame(slot->drum)->center;
    return slot->moved && slot->placed == himc_drum_is_placed(slot->drum) && now.x == slot->at.x &&
           now.y == slot->at.y && now.z == slot->at.z;
}

static void stand(drum_slot *slot, himc_vec3 center)
{
    if (!is_where_put(slot)) {
        slot->found = himc_drum_head_frame(slot->drum)->center;
        slot->placed = himc_drum_is_placed(slot->drum);
        slot->moved = true;
    }
    slot->at = center;
    himc_drum_stand(slot->drum, center);
}

// places a drum automatically, where a command could have placed it
static void find_room(performance_drums *d, int index)
{
    drum_slot *slot = &d->slot[index];
    himc_vec3 first = himc_drums_frame(d, index)->center;
    if (himc_drum_is_placed(slot->drum))
        return;
    for (double arc = first.x; arc < LARGEST_ARC; arc += ARC_STEP)
        for (double angle = 0; angle < ARC_END; angle += ARC_ANGLE_STEP)
            for (int side = -1; side <= 1; side += 2) {
                himc_vec3 center = {himc_argument_single(arc * cos(angle)),
                                    himc_argument_single(side * arc * sin(angle)),
                                    himc_argument_single(first.z)};
                if (index == 0 && angle == 0 && arc == first.x)
                    center = first;
                if (!is_clear(d, index, center))
                    continue;
                stand(slot, center);
                slot->untold = angle > 0;
                return;
            }
}

static void fill_slot(performance_drums *d, int index, himc_drum *drum, drum_source source)
{
    d->slot[index] =
        (drum_slot){.drum = drum, .source = source, .revision = himc_drum_revision(drum) - 1};
    find_room(d, index);
    himc_drum_enclose(drum, &d->walls);
    himc_drum_fade(drum, d->mute ? 0 : d->gain);
    himc_drum_listen(drum, &d->listener);
}

void himc_drums_begin(performance_drums *d, bool heard)
{
    *d = (performance_drums){.walls = HIMC_WALLS_USUAL, .gain = 1, .heard = heard};
    if (heard)
        d->listener = himc_listener_usual();
}

void himc_drums_catch_up_one(performance_drums *d, int index)
{
    drum_slot *slot = &d->slot[index];
    if (slot->behind > 0)
        himc_drum_advance_sticks(slot->drum, slot->behind, NULL, 0, NULL, NULL);
    slot->behind = 0;
}

void himc_drums_catch_up(performance_drums *d)
{
    for (int i = 0; i < d->count; i++)
        himc_drums_catch_up_one(d, i);
}

void himc_drums_join(performance_drums *d)
{
    himc_drum *drums[HIMC_DRUMS];
    for (int i = 0; i < d->count; i++)
        drums[i] = d->slot[i].drum;
    if (d->air)
        himc_air_between_join(d->air, drums, d->count);
}

// gives a drum back
static void release(performance_drums *d, himc_drum *drum)
{
    if (d->air)
        himc_air_between_leave(d->air, drum);
    himc_drum_listen(drum, NULL);
    himc_drum_enclose(drum, &HIMC_WALLS_USUAL);
    himc_drum_fade(drum, 1);
    himc_drum_set_heads(drum, NULL);
    himc_drum_release(drum);
}

bool himc_drums_full(const char *name, himc_error *error)
{
    return himc_error_set(error, "drum %s: a performer plays on %d drums at most", name,
                          HIMC_DRUMS);
}

// adds a word to a list of several; nothing more once it is full
static void list_name(char *list, size_t size, const char *name)
{
    size_t used = strlen(list);
    bool fits = used + strlen(name) + sizeof " ..." < size;
    if (fits || (size > used + sizeof " ..." && !strstr(list, "...")))
        himc_format(list + used, size - used, "%s%s", used ? " " : "", fits ? name : "...");
}

bool himc_drums_refuse_of(const char *const *names, int count, const char *word, himc_spot spot,
                          himc_error *error)
{
    char drums[160] = "", spots[64] = "";
    himc_nearest nearest = {.word = word};
    bool may_be_spot = spot == HIMC_SPOT_NORMAL, may_be_dead = spot != HIMC_SPOT_XY;
    if (may_be_dead)
        himc_nearest_try(&nearest, "dead");
    for (int i = 0; may_be_spot && i < HIMC_SPOT_XY; i++) {
        himc_nearest_try(&nearest, himc_spot_name((himc_spot)i));
        list_name(spots, sizeof spots, himc_spot_name((himc_spot)i));
    }
    for (int i = 0; i < count; i++) {
        himc_nearest_try(&nearest, names[i]);
        list_name(drums, sizeof drums, names[i]);
    }
    return himc_error_set(error, "%.40s: %s%s%s%sno drum (%s)%s%s%s", word,
                          may_be_spot ? "no spot (" : "", spots, may_be_spot ? "), " : "",
                          may_be_dead ? "not dead, " : "",
                          count > 0 ? drums : "there is none: `drum NAME` makes one",
                          nearest.name ? ", did you mean " : "", nearest.name ? nearest.name : "",
                          nearest.name ? "?" : "");
}

bool himc_drums_refuse(const performance_drums *d, const char *word, himc_spot spot,
                       himc_error *error)
{
    const char *names[HIMC_DRUMS];
    for (int i = 0; i < d->count; i++)
        names[i] = himc_drum_name(d->slot[i].drum);
    return himc_drums_refuse_of(names, d->count, word, spot, error);
}

bool himc_drums_add(performance_drums *d, himc_drum *drum, drum_source source, int *index,
                    himc_error *error)
{
    int i = himc_drums_find(d, himc_drum_name(drum));
    if (i < 0 && d->count == HIMC_DRUMS)
        return himc_drums_full(himc_drum_name(drum), error);
    if (d->listener.on && !himc_drum_open_ears(drum, error))
        return false;
    if (!d->air && i < 0 && d->count == 1 && !(d->air = himc_new(sizeof *d->air, "drum", error)))
        return false;
    if (i < 0)
        i = d->count++;
    *index = i;
    if (d->slot[i].drum == drum) { // the same drum again stays where it is
        himc_drum_release(drum);
        d->slot[i].revision = himc_drum_revision(drum) - 1;
        return true;
    }
    himc_drum_heads *heads = d->slot[i].heads;
    if (d->slot[i].drum)
        release(d, d->slot[i].drum);
    fill_slot(d, i, drum, source);
    himc_drums_set_heads(d, i, heads);
    return true;
}

bool himc_drums_move(performance_drums *d, int index, himc_vec3 center, himc_error *error)
{
    if (!himc_drum_check_place(center, error))
        return false;
    stand(&d->slot[index], center);
    d->slot[index].untold = false;
    return true;
}

himc_head_frame himc_drums_found(const performance_drums *d, int index)
{
    const drum_slot *slot = &d->slot[index];
    himc_head_frame frame = *himc_drum_head_frame(slot->drum);
    if (is_where_put(slot))
        frame.center = slot->found;
    return frame;
}

void himc_drums_put_back(performance_drums *d)
{
    drum_slot old[HIMC_DRUMS];
    int count = d->count;
    memcpy(old, d->slot, sizeof old);
    for (int i = 0; i < count && d->air; i++)
        himc_air_between_leave(d->air, old[i].drum);
    himc_air_between *air = d->air;
    himc_drums_begin(d, d->heard);
    d->air = air;
    for (int i = 0; i < count; i++) {
        himc_drum *drum = old[i].drum;
        himc_drum_heads_free(old[i].heads);
        if (old[i].source != DRUM_GIVEN) {
            release(d, drum);
            continue;
        }
        himc_drum_set_heads(drum, NULL);
        if (is_where_put(&old[i]))
            himc_drum_stand(drum, old[i].found);
        himc_drum_rest(drum);
        fill_slot(d, d->count++, drum, DRUM_GIVEN);
    }
}

himc_drum_heads *himc_drums_set_heads(performance_drums *d, int index, himc_drum_heads *heads)
{
    himc_drum_heads *before = d->slot[index].heads;
    d->slot[index].heads = heads;
    himc_drum_set_heads(d->slot[index].drum, heads);
    return before;
}

void himc_drums_drop_heads(performance_drums *d)
{
    for (int i = 0; i < d->count; i++)
        himc_drum_heads_free(himc_drums_set_heads(d, i, NULL));
}

void himc_drums_turn_heads(performance_drums *d, double beat, long round, double end,
                           performance_events *events)
{
    for (int i = 0; i < d->count; i++) {
        drum_slot *slot = &d->slot[i];
        himc_error why = {""};
        if (slot->heads)
            himc_drum_heads_notice(slot->heads, slot->drum);
        if (!slot->heads || beat < 0)
            continue;
        if (round != d->round)
            himc_drums_catch_up_one(d, i);
        if (round > d->round) // the heads of a round that begins
            himc_drum_heads_begin_again(slot->heads, slot->drum, end, &why);
        else if (round < d->round) // or of another `play`
            himc_drum_heads_begin_anew(slot->heads);
        bool due = himc_drum_heads_due(slot->heads, beat);
        if (due)
            himc_drums_catch_up_one(d, i);
        // a change of a head under a stick would pluck it: it waits until the stick has left
        bool waits = due && slot->waited < LONGEST_WAIT && himc_drum_is_touched(slot->drum);
        slot->waited = waits ? slot->waited + 1 : 0;
        if (due && !waits)
            himc_drum_heads_turn(slot->heads, slot->drum, beat, &why);
        if (why.text[0])
            himc_events_note(events, "at: %s %s", himc_drum_name(slot->drum), why.text);
    }
    d->round = beat < 0 ? d->round : round;
}

bool himc_drums_damped(const performance_drums *d, int index)
{
    return himc_membrane_head(himc_drum_membrane(d->slot[index].drum))->damp > 0;
}

bool himc_drums_will_be_damped(const performance_drums *d, int index, double beat)
{
    const himc_drum_heads *heads = d->slot[index].heads;
    return heads && beat >= 0 ? himc_drum_heads_damp(heads, beat) > 0 : himc_drums_damped(d, index);
}

void himc_drums_release(performance_drums *d)
{
    himc_drums_drop_heads(d);
    while (d->count > 0)
        release(d, d->slot[--d->count].drum);
    free(d->air);
}

bool himc_drums_listen(performance_drums *d, const himc_listener *listener, himc_error *error)
{
    for (int i = 0; i < d->count; i++)
        if (listener->on && !himc_drum_open_ears(d->slot[i].drum, error))
            return false;
    d->hearings += !himc_listener_equal(&d->listener, listener);
    d->listener = *listener;
    for (int i = 0; i < d->count; i++)
        himc_drum_listen(d->slot[i].drum, listener);
    return true;
}

void himc_drums_enclose(performance_drums *d, const himc_walls *walls)
{
    d->hearings += d->walls.seconds != walls->seconds || d->walls.volume != walls->volume;
    d->walls = *walls;
    for (int i = 0; i < d->count; i++)
        himc_drum_enclose(d->slot[i].drum, walls);
}

void himc_drums_fade(performance_drums *d, double gain, bool mute)
{
    d->gain = gain;
    d->mute = mute;
    for (int i = 0; i < d->count; i++)
        himc_drum_fade(d->slot[i].drum, mute ? 0 : gain);
}

bool himc_drums_listening_takes_long(const performance_drums *d)
{
    bool takes_long = false;
    for (int i = 0; i < d->count; i++)
        takes_long = takes_long || himc_drum_listening_takes_long(d->slot[i].drum);
    return takes_long;
}

typedef struct listen_job {
    himc_job job;
    performance_drums *drums; ///< borrowed
    himc_listener listener;
    struct {
        himc_drum *drum; ///< that was in the slot
        himc_job *job;   ///< owned, as long as it is not done
        bool done;
    } of[HIMC_DRUMS];
    int count;
} listen_job;

static bool prepare_listening(himc_job *job, himc_error *error)
{
    listen_job *j = (listen_job *)job;
    bool good = true;
    for (int i = 0; good && i < j->count; i++)
        good = j->of[i].done || j->of[i].job->prepare(j->of[i].job, error);
    return good;
}

static himc_job_state install_listening(himc_job *job, himc_error *error)
{
    listen_job *j = (listen_job *)job;
    performance_drums *d = j->drums;
    bool again = false;
    for (int i = 0; i < j->count; i++) {
        bool there = i < d->count && d->slot[i].drum == j->of[i].drum; // it may have been replaced
        if (!j->of[i].done && there)
            j->of[i].done = j->of[i].job->install(j->of[i].job, error) != HIMC_JOB_AGAIN;
        again = again || (there && !j->of[i].done);
    }
    if (again)
        return HIMC_JOB_AGAIN;
    return himc_drums_listen(d, &j->listener, error) ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
}

static void free_listening(himc_job *job)
{
    listen_job *j = (listen_job *)job;
    for (int i = 0; i < j->count; i++)
        if (j->of[i].job)
            j->of[i].job->free(j->of[i].job);
    free(j);
}

himc_job *himc_drums_listen_job(performance_drums *d, const himc_listener *listener,
                                himc_error *error)
{
    listen_job *j =
        himc_job_new(sizeof *j, "listener",
                     (himc_job){prepare_listening, install_listening, free_listening}, error);
    if (!j)
        return NULL;
    j->drums = d;
    j->listener = *listener;
    for (; j->count < d->count; j->count++) {
        himc_drum *drum = j->of[j->count].drum = d->slot[j->count].drum;
        j->of[j->count].job = himc_drum_listen_job(drum, listener, error);
        if (!j->of[j->count].job) {
            free_listening(&j->job);
            return NULL;
        }
    }
    return &j->job;
}

bool himc_drums_noticed(performance_drums *d, int index)
{
    unsigned revision = himc_drum_revision(d->slot[index].drum);
    bool changed = revision != d->slot[index].revision;
    d->slot[index].revision = revision;
    d->slot[index].reach_told = d->slot[index].reach_told && !changed;
    d->slot[index].pedal_told = d->slot[index].pedal_told && !changed;
    return changed;
}

void himc_drums_tell_places(performance_drums *d, performance_events *events)
{
    for (int i = 0; i < d->count; i++) {
        himc_vec3 at = himc_drums_frame(d, i)->center;
        if (d->slot[i].untold && !himc_drum_is_placed(d->slot[i].drum))
            himc_events_note(events, "drum %s stands at %.2f %.2f %.2f: `place` moves it",
                             himc_drum_name(d->slot[i].drum), at.x, at.y, at.z);
        d->slot[i].untold = false;
    }
}
