/// performance_play.c: playing, for C programs and for the commands of the same names: strokes and
/// hits, transport, live targets, units of motion. Scores and takes have files of their own.
#include "performance/performance_state.h"
#include "base/format.h"
#include "base/head_frame.h"
#include "capture/take.h"
#include "drum/membrane_state.h"
#include "head/idiophone.h"
#include "head/two_heads.h"
#include "midi/part.h"
#include "plan/ornament.h"
#include "plan/score.h"
#include "plan/sticking.h"

#include <stdlib.h>
#include <string.h>

#define MISSED_TARGET 1e-3  // chosen: the user is told of a target missed by more (m)
#define DEEPEST_TARGET 0.01 // chosen: a firm press of a mallet; largest depth of a target (m)
#define UNDER_THE_HEAD 0.3  // a target deeper than this is under the drum, not in its head (m)

// chosen: a stroke so little out of reach is played
#define OUT_OF_REACH 0.01 // (m)
#define BEHIND (-0.2)     // forward over sideways: further back is behind the performer

// a clock that is followed; chosen
#define SYNC_STEP 0.012 // it is not looked at sooner again (s): 200 beats a minute of MIDI
#define SYNC_GAP 1.0    // after that it is another one (s)
#define SYNC_SILENT 0.3 // after that the clock is not heard, and its mean tempo holds (s)
#define SYNC_LEAST 6    // looks from which its tempo is known
#define SYNC_SAME 0.003 // so little another tempo is the same: 1.5 ms in half a second

#define QUARTER_TONE 0.5 // a pitch is a MIDI key's within that (semitones)

#define LATEST_BEAT 1e9 // beats are exact to 1e-7 up to here

// chosen: shorter than a contact, longer than a slow bounce
#define LEAST_BOUNCE 0.01 // (s)
#define MOST_BOUNCE 0.5   // (s)
#define LEAST_ROLL 0.01   // (beats)

static bool check_stroke(const himc_stroke *s, bool any_hand, himc_error *error)
{
    bool hand = (unsigned)s->hand < HIMC_HANDS || s->hand == HIMC_FOOT ||
                (any_hand && s->hand == HIMC_HAND_ANY);
    bool placed = s->spot == HIMC_SPOT_XY;
    if (!hand || (unsigned)s->nuance >= HIMC_NUANCES || (unsigned)s->spot > HIMC_SPOT_XY ||
        !memchr(s->drum, 0, sizeof s->drum))
        return himc_error_set(error, "stroke: no such hand, nuance or spot, or no drum's name");
    bool rolls = s->ornament >= HIMC_ROLL_SINGLE;
    bool bounces =
        (unsigned)s->ornament <= HIMC_ROLL_PRESS && s->bounces >= HIMC_DEAD && s->bounces <= 1;
    return himc_check_range("stroke: DYNAMIC", s->dynamic, 0, 1, "", error) &&
           himc_check_range("stroke: X", placed ? s->x : 0, -1, 1, "m", error) &&
           himc_check_range("stroke: Y", placed ? s->y : 0, -1, 1, "m", error) &&
           (bounces ||
            himc_error_set(error, "stroke: no such ornament, or %d bounces", s->bounces)) &&
           himc_check_range("stroke: early", s->early, 0, 1, "s", error) &&
           himc_check_range("stroke: bounce_time", s->bounces ? s->bounce_time : LEAST_BOUNCE,
                            LEAST_BOUNCE, MOST_BOUNCE, "s", error) &&
           himc_check_range("roll: LENGTH", rolls ? s->length : LEAST_ROLL, LEAST_ROLL, LATEST_BEAT,
                            "beats", error) &&
           himc_check_range("roll: DYNAMIC", rolls ? s->last_dynamic : 0, 0, 1, "", error);
}

void himc_performance_name_drum(const himc_performance *p, himc_stroke *stroke, int drum)
{
    if (drum >= 0 && stroke->ornament < HIMC_ROLL_SINGLE)
        himc_format(stroke->drum, sizeof stroke->drum, "%s",
                    himc_drum_name(p->drums.slot[drum].drum));
}

static bool put_foot_stroke(himc_performance *p, const himc_stroke *stroke, int drum,
                            himc_error *error)
{
    if (!himc_performance_ensure_drum(p, stroke->drum, stroke->spot, &drum, error) ||
        !himc_feet_add(&p->motion->feet, stroke, &p->drums, drum, error))
        return false;
    himc_performance_find_end(p);
    himc_motion_stir(p->motion);
    return true;
}

bool himc_performance_put_stroke(himc_performance *p, const himc_stroke *written, himc_error *error)
{
    int drum;
    himc_stroke placed = *written, *stroke = &placed;
    if (!check_stroke(stroke, false, error) ||
        !himc_performance_index_drum(p, stroke->drum, stroke->spot, &drum, error) ||
        !himc_performance_place_stroke(p, stroke, drum, error))
        return false;
    // the silent drum that it may need, before the planner makes room
    himc_drum *first = NULL;
    if (p->drums.count == 0) {
        first = himc_drum_new(FIRST_DRUM, HIMC_INCHES_USUAL, p->clock.sample_rate, error);
        if (!first)
            return false;
    }
    if (stroke->hand == HIMC_FOOT)
        return put_foot_stroke(p, stroke, drum, error);
    bool rolls = stroke->ornament >= HIMC_ROLL_SINGLE;
    int tempo_count;
    const himc_tempo_change *tempi = himc_planner_tempi(p->motion->planner, &tempo_count);
    if (rolls ? !himc_score_accepts_roll(tempi, tempo_count, stroke, error)
              : !himc_planner_accepts(p->motion->planner, stroke, drum, error)) {
        himc_drum_release(first);
        return false;
    }
    if (first && !himc_performance_adopt_drum(p, first, DRUM_SILENT, &drum, error))
        return false;
    himc_motion_replan(p->motion);
    himc_stroke plain = *stroke;
    plain.ornament = HIMC_PLAIN;
    himc_performance_name_drum(p, &plain, drum);
    if (!rolls && !himc_planner_add(p->motion->planner, &plain, drum, error))
        return false;
    himc_performance_add_ornament(p, stroke, drum);
    himc_motion_go_on(p->motion, step_time(p));
    return true;
}

bool himc_performance_add_stroke(himc_performance *p, const himc_stroke *asked, himc_error *error)
{
    himc_stroke own = *asked, *stroke = &own;
    himc_dynamics *dynamics = &p->written.dynamics;
    if (stroke->dynamic == HIMC_DYNAMIC_FOLLOWS)
        dynamics->from = fmax(dynamics->from, 1 + stroke->beat);
    himc_dynamics_give(dynamics, stroke);
    if (!himc_written_room(&p->written.score, "stroke", error) ||
        !himc_check_range("stroke: BEAT", stroke->beat, 0, LATEST_BEAT, "beats", error) ||
        !himc_performance_put_stroke(p, stroke, error))
        return false;
    himc_written_stroke(&p->written.score, stroke);
    return true;
}

void himc_performance_add_ornament(himc_performance *p, const himc_stroke *stroke, int drum)
{
    himc_stroke own = *stroke;
    if (stroke->ornament == HIMC_PLAIN)
        return;
    himc_performance_name_drum(p, &own, drum);
    int left_out = himc_planner_add_ornament(p->motion->planner, &own, drum,
                                             himc_drum_pitch(p->drums.slot[drum].drum));
    if (left_out == 0)
        return;
    if (stroke->ornament >= HIMC_ROLL_SINGLE)
        himc_events_note(&p->events,
                         "roll at beat %g: %d of its strokes left out, too near to others",
                         stroke->beat, left_out);
    else
        himc_events_note(
            &p->events, "%s at beat %g %s %s: no grace notes, the %s hand has another stroke there",
            himc_grace_name(own.ornament), own.beat, himc_hand_name(own.hand), own.drum,
            himc_hand_name(himc_other_hand(own.hand)));
}

// "too low" and so on, from the direction in which the reach ends
static const char *direction_of(himc_vec3 beyond, himc_vec3 center)
{
    if (fabs(beyond.z) > hypot(beyond.x, beyond.y))
        return beyond.z < 0 ? "too low" : "too high";
    if (center.x < BEHIND * fabs(center.y))
        return "too far behind";
    return beyond.x * center.x + beyond.y * center.y < 0 ? "too near" : "too far";
}

// one line for each drum that stands where it was not asked to, or out of reach, and for each whose
// pedal the score moves and no foot reaches
static void tell_places(himc_performance *p)
{
    himc_performance_notice_drums(p);
    himc_drums_tell_places(&p->drums, &p->events);
    for (int i = 0; i < p->drums.count; i++) {
        drum_slot *slot = &p->drums.slot[i];
        const himc_head_frame *head = himc_drums_frame(&p->drums, i);
        himc_vec3 beyond = himc_motion_beyond(p->motion, head);
        double distance = himc_vec3_length(beyond);
        himc_pedal any;
        if (p->settings.stance == HIMC_STANCE_SEATED && !slot->pedal_told &&
            himc_drum_heads_pedal(slot->heads, -1, INFINITY) &&
            !himc_pedal_of(&p->motion->body.posture, head, &any)) {
            slot->pedal_told = true;
            himc_events_note(&p->events,
                             "the pedal of drum %s is out of reach of his feet: it moves alone",
                             himc_drum_name(slot->drum));
        }
        if (distance < OUT_OF_REACH || slot->reach_told || himc_drum_is_footed(slot->drum) ||
            himc_feet_plays(&p->motion->feet, i))
            continue;
        slot->reach_told = true;
        himc_events_note(&p->events, "drum %s is %s by %.2f m: strokes on it are given up",
                         himc_drum_name(slot->drum), direction_of(beyond, head->center), distance);
    }
}

void himc_performance_tell_misses(himc_performance *p)
{
    himc_planner_miss miss;
    while (himc_planner_miss_next(p->motion->planner, &miss)) {
        const himc_stroke *s = &miss.stroke;
        himc_strike missed = {.time = miss.time,
                              .hand = s->hand,
                              .planned_time = miss.time,
                              .beat = miss.hit ? NAN : s->beat};
        himc_format(missed.nuance, sizeof missed.nuance, "%s", himc_nuance_name(s->nuance));
        himc_head_frame_spot(himc_drums_frame(&p->drums, miss.drum), s, &missed.x, &missed.y);
        himc_events_missed(&p->events, &missed, himc_drum_name(p->drums.slot[miss.drum].drum),
                           miss.why);
    }
}

bool himc_performance_hit(himc_performance *p, const himc_stroke *stroke, himc_error *error)
{
    himc_stroke own = *stroke;
    himc_hit asked = {.stroke = &own};
    himc_planner *planner = p->motion->planner;
    own.beat = fmax(himc_motion_score_beat(p->motion, step_time(p)), 0);
    himc_dynamics_give(&p->written.dynamics, &own);
    if (!check_stroke(&own, true, error))
        return false;
    // to the hands that no take moves
    double now = step_time(p);
    bool left = himc_motion_free_hand(p->motion, HIMC_LEFT, now),
         right = himc_motion_free_hand(p->motion, HIMC_RIGHT, now);
    asked.alone = !left || !right;
    if (asked.alone && own.hand == HIMC_HAND_ANY)
        own.hand = left ? HIMC_LEFT : HIMC_RIGHT;
    if (own.hand < HIMC_HANDS && !(own.hand == HIMC_LEFT ? left : right))
        return himc_error_set(error, "hit: not possible while a take is playing");
    if (!himc_performance_ensure_drum(p, stroke->drum, stroke->spot, &asked.drum, error))
        return false;
    if (stroke->hand == HIMC_HAND_ANY && himc_drum_is_footed(p->drums.slot[asked.drum].drum))
        own.hand = HIMC_FOOT;
    if (!himc_performance_place_stroke(p, &own, asked.drum, error))
        return false;
    himc_performance_name_drum(p, &own, asked.drum);
    if (own.hand == HIMC_FOOT) {
        himc_feet_hit(&p->motion->feet, &own, &p->drums, asked.drum, now, p->settings.latency,
                      &p->events);
        return true;
    }
    tell_places(p);
    // a command that acts in this step was meant for its sample, up to a step before
    int64_t sample = p->queue.acting >= 0 ? p->queue.acting : p->clock.played;
    double from = (double)sample / p->clock.sample_rate;
    asked.at = from + p->settings.latency;
    // to the contact, from the moment it was asked; infinite if it is given up
    double latency = p->settings.latency > 0
                         ? himc_planner_hit_at(planner, now, &asked) - from
                         : himc_planner_hit(planner, now, &own, asked.drum) - now;
    himc_performance_tell_misses(p);
    if (isfinite(latency))
        himc_statistics_hit(&p->statistics, latency);
    himc_motion_replan(p->motion);
    return true;
}

static double midi_key(double hz)
{
    return 69 + 12 * log2(hz / 440); // A4
}

// How far a MIDI key is from what a drum sounds (semitones), infinite of one without a pitch. A
// keyboard has the key or its octaves, and `part` becomes the bar.
static double key_distance(himc_drum *drum, int key, char part[HIMC_PART_SIZE])
{
    const himc_shape *shape = &himc_membrane_config_of(himc_drum_membrane(drum))->shape;
    double least = INFINITY, hz;
    if (!shape->body && !shape->shell)
        return fabs(midi_key(himc_drum_pitch(drum)) - key);
    for (int i = 0; shape->body && i < shape->body->parts; i++) {
        const char *name = shape->body->part[i].name;
        double way = himc_note_frequency(name, &hz) ? fabs(midi_key(hz) - key) : INFINITY;
        if (way < least && lround(way) % 12 == 0) {
            least = way;
            himc_format(part, HIMC_PART_SIZE, "%s", name);
        }
    }
    return least;
}

// the instrument of a key of General MIDI's drum channel, of that name or else of its kind the one
// nearest in size, and its stroke; -1: there is none
static int kit_drum(const performance_drums *drums, int key, himc_stroke *stroke, midi_stroke *note)
{
    midi_part kit = {.choice = MIDI_DRUMS, .stroke = note, .count = 1};
    *note = (midi_stroke){.key = key, .spot = HIMC_SPOT_NORMAL};
    himc_midi_kit(&kit);
    if (note->head < 0)
        return -1;
    midi_head *head = &kit.head[note->head];
    double inches = himc_midi_split_size(head->made), least = INFINITY;
    int named = himc_drums_find(drums, head->name), found = named;
    for (int i = 0; i < drums->count && named < 0; i++) {
        const himc_shape *s =
            &himc_membrane_config_of(himc_drum_membrane(drums->slot[i].drum))->shape;
        const char *kind = s->body ? s->body->name : s->shell ? s->shell->name : "";
        double away = fabs(himc_drum_inches(drums->slot[i].drum) - inches);
        if (strcmp(kind, head->made) == 0 && away < least) {
            least = away;
            found = i;
        }
    }
    stroke->spot = note->spot;
    stroke->hand = note->foot ? HIMC_FOOT : HIMC_HAND_ANY;
    himc_format(stroke->part, sizeof stroke->part, "%s", note->part);
    return found;
}

// the drum of a MIDI key; -1 with the reason if there is none
static int find_key(const himc_performance *p, int key, himc_stroke *stroke, midi_stroke *note,
                    himc_error *error)
{
    const performance_drums *drums = &p->drums;
    char part[HIMC_PART_SIZE], nearest[HIMC_PART_SIZE] = "";
    double least = INFINITY;
    int found = drums->count == 1 ? 0 : -1;
    for (int i = 0; i < drums->count; i++) {
        part[0] = '\0';
        double way = key_distance(drums->slot[i].drum, key, part);
        if (way < least) {
            least = way;
            found = i;
            memcpy(nearest, part, sizeof part);
        }
    }
    int of_kit = least > QUARTER_TONE ? kit_drum(drums, key, stroke, note) : -1;
    if (of_kit >= 0)
        return of_kit;
    *note = (midi_stroke){.key = key};
    *stroke = (himc_stroke){.hand = HIMC_HAND_ANY, .spot = HIMC_SPOT_NORMAL};
    memcpy(stroke->part, nearest, sizeof nearest);
    if (found < 0)
        himc_error_set(error, "note: %d%s%s: no drum has that pitch, no instrument that key", key,
                       himc_midi_key_sound(key)[0] ? ", " : "", himc_midi_key_sound(key));
    return found;
}

bool himc_performance_note(himc_performance *p, const himc_command *c, int delay, himc_stroke *hit,
                           himc_error *error)
{
    himc_command pedal;
    midi_stroke note;
    double velocity = c->atom[1].number, latency = p->settings.latency * p->clock.sample_rate;
    int index, after = delay + (int)latency - himc_clock_ahead(&p->clock);
    if (!himc_performance_ensure_drum(p, "", HIMC_SPOT_NORMAL, &index, error))
        return false;
    index = find_key(p, (int)lround(c->atom[0].number), hit, &note, error);
    if (index < 0)
        return velocity == 0; // what did not sound ends without a word
    drum_slot *slot = &p->drums.slot[index];
    slot->keys = velocity > 0 ? slot->keys + 1 : slot->keys > 0 ? slot->keys - 1 : 0;
    bool lays = velocity == 0 && slot->keys == 0 && p->settings.noteoff == HIMC_NOTEOFF_DAMP;
    if (velocity > 0 || lays)
        himc_drum_lay(slot->drum, after > 0 ? after : 0, lays);
    if (velocity == 0)
        return true;
    if (himc_drum_hats(slot->drum) && note.pedal != MIDI_AS_IT_IS) {
        himc_atom pressed = {HIMC_ATOM_NUMBER, note.pedal == MIDI_CLOSE, NULL};
        if (!himc_command_parse(&pedal, HIMC_DRUM, "pedal", &pressed, 1, error) ||
            !himc_drum_command(slot->drum, &pedal, error))
            return false;
    }
    hit->nuance = c->count > 2 ? (himc_nuance)c->choice[2] : HIMC_LEGATO;
    hit->dynamic = himc_midi_dynamic(velocity, 0);
    himc_format(hit->drum, sizeof hit->drum, "%s", himc_drum_name(slot->drum));
    return true;
}

bool himc_performance_set_tempo(himc_performance *p, double bpm, himc_error *error)
{
    if (!himc_check_range("tempo", bpm, HIMC_BPM_MIN, HIMC_BPM_MAX, "beats per minute", error))
        return false;
    himc_planner_tempo(p->motion->planner, step_time(p), bpm);
    himc_motion_replan(p->motion);
    return true;
}

// the score's beat through all rounds of a loop
static double total_beat(const himc_performance *p, double t)
{
    const himc_planner *planner = p->motion->planner;
    double round = himc_planner_length(planner) - himc_planner_loop_begin(planner);
    return himc_planner_beat(planner, t) + (double)himc_planner_round(planner, t) * round;
}

static bool is_clocked(const performance_sync *s, double t)
{
    return s->count >= SYNC_LEAST && t - s->seen[(s->count - 1) % SYNC_TICKS].time < SYNC_SILENT;
}

bool himc_performance_tempo(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_tempo_ramp ramp = himc_score_read_tempo(c);
    if (is_clocked(&p->sync, step_time(p)))
        return himc_error_set(error, "tempo: a clock sets it, expected sync off before");
    himc_motion_replan(p->motion);
    return c->count == 1 ? himc_performance_set_tempo(p, c->atom[0].number, error)
                         : himc_planner_add_tempo(p->motion->planner, &ramp, error);
}

void himc_performance_leave_clock(himc_performance *p, double t)
{
    himc_error unused;
    if (p->sync.bpm == 0 || is_clocked(&p->sync, t))
        return;
    himc_performance_set_tempo(p, p->sync.bpm, &unused);
    p->sync.bpm = 0;
}

// Sees the clock at its beat: the tempo becomes the clock's, and so much faster or slower that the
// beats meet within one.
static bool see_clock(himc_performance *p, double t, bool absolute, himc_error *error)
{
    performance_sync *s = &p->sync;
    long first = s->count < SYNC_TICKS ? 0 : s->count - SYNC_TICKS, last = s->count - 1;
    double since = last < 0 ? INFINITY : t - s->seen[last % SYNC_TICKS].time;
    if (since < SYNC_STEP)
        return true;
    if (since > SYNC_GAP)
        first = s->count = 0;
    double beats = s->beat - s->seen[first % SYNC_TICKS].beat,
           seconds = t - s->seen[first % SYNC_TICKS].time;
    bool known = s->count >= SYNC_LEAST && beats > 0;
    s->seen[s->count % SYNC_TICKS].time = t;
    s->seen[s->count++ % SYNC_TICKS].beat = s->beat;
    if (!known)
        return true;
    double ahead = himc_planner_beat(p->motion->planner, t) < 0 ? 0 : s->beat - total_beat(p, t);
    if (!absolute || fabs(ahead) > 1) // it began elsewhere: the same place in a beat
        ahead -= round(ahead);
    s->bpm = fmin(fmax(60 * beats / seconds, HIMC_BPM_MIN), HIMC_BPM_MAX);
    double bpm = s->bpm * (1 + fmin(fmax(ahead, -0.5), 0.5)),
           now = himc_planner_bpm(p->motion->planner, t);
    bpm = fmin(fmax(bpm, HIMC_BPM_MIN), HIMC_BPM_MAX);
    return fabs(bpm - now) < SYNC_SAME * now || himc_performance_set_tempo(p, bpm, error);
}

bool himc_performance_clock(himc_performance *p, const himc_command *c, himc_error *error)
{
    enum { START, CONTINUE, STOP };
    performance_sync *s = &p->sync;
    bool phase = c->form == 0 && c->count > 0;
    int64_t sample = p->queue.acting >= 0 ? p->queue.acting : p->clock.played;
    double t = (double)sample / p->clock.sample_rate;
    if (p->settings.sync != (phase ? HIMC_SYNC_PHASE : HIMC_SYNC_MIDI))
        return true;
    if (c->form == 0 && !phase) {
        s->beat += 1.0 / SYNC_TICKS;
        return see_clock(p, t, true, error);
    }
    if (phase) {
        double way = c->atom[0].number - s->beat;
        s->beat += way - round(way);
        return see_clock(p, t, false, error);
    }
    if (c->choice[0] == STOP) {
        s->halt = s->beat;
        himc_performance_stop(p);
        return true;
    }
    if (c->choice[0] == CONTINUE && !isnan(s->halt)) { // ticks in between do not count
        s->beat = s->halt;
        s->count = 0;
    }
    s->halt = NAN;
    if (c->choice[0] == START) {
        s->beat = -1.0 / SYNC_TICKS; // the next tick is beat 0
        s->count = 0;
        himc_planner_seek(p->motion->planner, step_time(p), 0);
    }
    return himc_performance_play(p, error);
}

void himc_performance_tell_loop(himc_performance *p)
{
    const himc_planner *planner = p->motion->planner;
    double last = fmax(himc_planner_last_beat(planner), himc_feet_last(&p->motion->feet));
    if (himc_planner_loops_beats(planner) && last >= 0 && himc_planner_loop_begin(planner) > last)
        himc_events_note(
            &p->events, "loop: FROM: %g, nothing to play: expected 0 .. %g, the last stroke's beat",
            himc_planner_loop_begin(planner), last);
}

bool himc_performance_play(himc_performance *p, himc_error *error)
{
    int first;
    if (!himc_performance_ensure_drum(p, "", HIMC_SPOT_NORMAL, &first, error))
        return false;
    tell_places(p);
    if (himc_motion_plays_score(p->motion) && himc_planner_length(p->motion->planner) <= 0)
        himc_events_note(&p->events, "play: nothing to play: no strokes, no take");
    himc_performance_tell_loop(p);
    himc_motion_play(p->motion, step_time(p));
    return true;
}

void himc_performance_stop(himc_performance *p)
{
    himc_motion_stop(p->motion, step_time(p));
}

// the head that a target is in, NULL if there is none; limits its depth
static const himc_head_frame *head_of(const himc_performance *p, himc_vec3 *x)
{
    for (int i = 0; i < p->drums.count; i++) {
        const himc_head_frame *frame = himc_drums_frame(&p->drums, i);
        himc_vec3 local = himc_head_frame_from_world(frame, *x);
        double under = p->body->skeleton.mallet_radius - local.z;
        if (!himc_head_frame_contains(frame, local.x, local.y) || under < 0 ||
            under > UNDER_THE_HEAD)
            continue;
        *x = himc_vec3_madd(*x, fmax(under - DEEPEST_TARGET, 0), himc_head_frame_normal(frame));
        return frame;
    }
    return NULL;
}

// one note when a stream of targets begins to be refused, or leaves the reach
void himc_performance_target(himc_performance *p, himc_hand hand, himc_vec3 asked)
{
    if (!himc_vec3_finite(asked) || (unsigned)hand >= HIMC_HANDS)
        return;
    himc_vec3 x = himc_posture_reachable(&p->motion->body.posture, hand, asked);
    bool free = himc_motion_free_hand(p->motion, hand, step_time(p));
    bool reached = himc_vec3_length(himc_vec3_sub(x, asked)) <= MISSED_TARGET;
    bool first = himc_motion_note_target(p->motion, hand, free && reached);
    if (first && free)
        himc_events_note(&p->events, "target %s %g %g %g: out of reach, going to %.3f %.3f %.3f",
                         himc_hand_name(hand), asked.x, asked.y, asked.z, x.x, x.y, x.z);
    else if (first)
        himc_events_note(&p->events, "target %s: not possible while a take is playing",
                         himc_hand_name(hand));
    if (!free)
        return;
    const himc_head_frame *head = head_of(p, &x);
    x = himc_motion_ease_down(p->motion, hand, step_time(p), x, head);
    himc_planner_reach(p->motion->planner, step_time(p), hand, x);
    himc_motion_replan(p->motion);
}

bool himc_performance_drive(himc_performance *p, const himc_drive *drive, himc_error *error)
{
    return himc_body_drive(p->body, drive, error);
}

// the command `units`: a take is cut into units of a nuance
typedef struct units_job {
    himc_job job;
    himc_performance *performance; ///< borrowed
    himc_command command;
    himc_take_options options;
    himc_grip grip;
    himc_unit unit[HIMC_UNITS];
    int count;
} units_job;

static bool cut_units(himc_job *job, himc_error *error)
{
    units_job *j = (units_job *)job;
    const himc_command *c = &j->command;
    himc_take *take = himc_take_load_in(c->folder, c->atom[0].symbol, &j->options, error);
    j->count = take ? himc_units_cut(take, &j->options, j->unit, HIMC_UNITS, error) : -1;
    if (take && j->count < 0)
        himc_take_name_error(c->atom[0].symbol, error);
    himc_take_free(take);
    for (int i = 0; i < j->count && i < HIMC_UNITS; i++) {
        j->unit[i].nuance = (himc_nuance)c->choice[1];
        j->unit[i].grip = j->grip;
        if (c->count > 2 && c->choice[2] >= 0)
            j->unit[i].spot = (himc_spot)c->choice[2];
    }
    return j->count >= 0 || himc_error_prefix(error, "units");
}

static himc_job_state add_units(himc_job *job, himc_error *error)
{
    units_job *j = (units_job *)job;
    himc_performance *p = j->performance;
    const char *path = j->command.atom[0].symbol;
    if (!himc_written_room(&p->written.units, "units", error) ||
        !himc_planner_add_units(p->motion->planner, j->unit, j->count, error)) {
        himc_error_prefix(error, "%s", path);
        return HIMC_JOB_FAILED;
    }
    himc_written_units(&p->written.units, &j->command);
    himc_motion_replan(p->motion);
    himc_events_note(&p->events, "%s: %d motion units of %s", path, j->count,
                     himc_nuance_name((himc_nuance)j->command.choice[1]));
    return HIMC_JOB_DONE;
}

static void free_units(himc_job *job)
{
    free(job);
}

static units_job *units_job_new(const himc_command *command, const himc_take_options *options,
                                himc_error *error)
{
    units_job *j =
        himc_job_new(sizeof *j, "units", (himc_job){cut_units, add_units, free_units}, error);
    if (!j)
        return NULL;
    himc_command_copy(&j->command, command);
    j->options = *options;
    return j;
}

himc_job *himc_performance_units_job(himc_performance *p, const himc_command *command,
                                     himc_error *error)
{
    units_job *j = units_job_new(command, &p->host.take_options, error);
    if (!j)
        return NULL;
    j->performance = p;
    j->grip = p->settings.grip;
    return &j->job;
}

int himc_performance_count_units(const himc_command *command, const himc_take_options *options,
                                 himc_error *error)
{
    units_job *j = units_job_new(command, options, error);
    if (!j)
        return -1;
    int count = cut_units(&j->job, error) ? j->count : -1;
    free_units(&j->job);
    return count;
}
