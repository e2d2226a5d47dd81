/// tempo.c: tempo marks, words, ritardandi and fermatas as a map of tempi.
///
/// A metronome's number holds before the custom of a word. A ritardando or accelerando moves evenly
/// to its share of the tempo, up to the next mark, within LONGEST_RAMP, a step on each half beat. A
/// note under a fermata lasts twice, up to MOST_HELD longer. Shares and times are chosen, in the
/// middle of what conductors do.
#include "musicxml/music.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>

#define USUAL_BPM 120     // of a score that says nothing, as notation programs play it
#define LONGEST_RAMP 16.0 // (beats)
#define ALONE_RAMP 8.0    // of a ramp that no mark ends (beats)
#define STEP 0.5          // of a ramp (beats)
#define MOST_HELD 2.0     // of a fermata (s)
#define SAME 1e-6         // (beats)
#define MOST_TEMPI 9000   // a score has 10000 lines

typedef struct map {
    himc_tempo_change *tempi;
    int count, room;
    himc_error *error;
} map;

static bool add(map *m, double beat, double bpm)
{
    bpm = fmin(fmax(bpm, HIMC_BPM_MIN), HIMC_BPM_MAX);
    himc_tempo_change *last = m->count > 0 ? &m->tempi[m->count - 1] : NULL;
    if (last && last->beat >= beat - SAME) {
        last->bpm = bpm;
        return true;
    }
    if ((last && last->bpm == bpm) || m->count == MOST_TEMPI)
        return true;
    if (!himc_array_grow(&m->tempi, m->count, &m->room, sizeof *m->tempi, m->error))
        return false;
    m->tempi[m->count++] = (himc_tempo_change){beat, bpm};
    return true;
}

static bool sets_tempo(music_meaning meaning)
{
    return meaning == MUSIC_TEMPO || meaning == MUSIC_TEMPO_WORD || meaning == MUSIC_TEMPO_BACK ||
           meaning == MUSIC_TEMPO_AGAIN || meaning == MUSIC_TEMPO_SHARE ||
           meaning == MUSIC_TEMPO_RAMP;
}

// evenly from sign `i` to the next mark of tempo, and to its tempo if it lies on the way; returns
// the tempo at its end, 0 without memory
static double add_ramp(map *to, const music *m, int i, double bpm)
{
    const music_sign *s = &m->signs[i];
    double end = s->at.beat + ALONE_RAMP, last = fmax(bpm * s->value, HIMC_BPM_MIN);
    for (int k = i + 1; k < m->sign_count; k++)
        if (sets_tempo(m->signs[k].meaning) && m->signs[k].at.beat > s->at.beat + SAME) {
            double beat = m->signs[k].at.beat;
            bool near = beat - s->at.beat <= LONGEST_RAMP,
                 mark =
                     m->signs[k].meaning == MUSIC_TEMPO || m->signs[k].meaning == MUSIC_TEMPO_WORD;
            if (near && mark && (m->signs[k].value - bpm) * (s->value - 1) > 0)
                last = m->signs[k].value;
            end = near ? beat : fmin(end, beat);
            break;
        }
    int steps = (int)ceil((end - s->at.beat) / STEP);
    for (int k = 0; k < steps; k++) {
        double share = (k + 0.5) / steps;
        if (!add(to, s->at.beat + k * STEP, bpm + share * (last - bpm)))
            return 0;
    }
    return last;
}

static bool add_signs(map *to, const music *m)
{
    double bpm = USUAL_BPM, first = 0, before = 0; // now, the first, before the last ramps
    double begin = 0;                              // beat of the first
    double numbered = -1, shared = -1, ramp = -1;  // beats of the last number, share and ramp
    bool ramps = false;
    for (int i = 0; i < m->sign_count; i++) {
        const music_sign *s = &m->signs[i];
        double now = bpm;
        if (s->meaning == MUSIC_TEMPO && s->at.beat > numbered + SAME) {
            numbered = s->at.beat;
            bpm = s->value;
        } else if (s->meaning == MUSIC_TEMPO_WORD && s->at.beat > numbered + SAME) {
            bpm = s->value;
        } else if (s->meaning == MUSIC_TEMPO_AGAIN) {
            bpm = himc_midi_bpm(to->tempi, to->count, s->value + SAME);
        } else if (s->meaning == MUSIC_TEMPO_SHARE && s->at.beat > numbered + SAME &&
                   s->at.beat > shared + SAME) {
            shared = s->value == 1 ? shared : s->at.beat; // also where all parts say it
            bpm *= s->value;
        } else if (s->meaning == MUSIC_TEMPO_BACK && s->at.beat > numbered + SAME) {
            bpm = s->value > 0 && first > 0 ? first : before > 0 ? before : bpm;
        } else if (s->meaning == MUSIC_TEMPO_RAMP && s->at.beat > ramp + SAME) {
            before = ramps ? before : bpm; // rit. molto rit. a tempo
            ramps = true;
            ramp = s->at.beat;
            if (!(bpm = add_ramp(to, m, i, bpm)))
                return false;
            continue;
        } else {
            continue;
        }
        if (first == 0 || s->at.beat < begin + SAME) { // a word, then its number
            first = bpm;
            begin = s->at.beat;
        }
        ramps = false;
        if (s->meaning != MUSIC_TEMPO_BACK && now != bpm)
            before = 0;
        if (!add(to, s->at.beat, bpm))
            return false;
    }
    return true;
}

// the tempi of `from` with holds; fermatas at one beat are one
static bool add_fermatas(map *to, const map *from, const music *m)
{
    int next = 0;
    double done = 0;
    for (int i = 0; i < m->sign_count; i++) {
        const music_sign *s = &m->signs[i];
        if (s->meaning != MUSIC_FERMATA || s->at.beat < done - SAME)
            continue;
        double begin = s->at.beat, end = begin + s->value;
        for (; next < from->count && from->tempi[next].beat < begin - SAME; next++)
            if (!add(to, from->tempi[next].beat, from->tempi[next].bpm))
                return false;
        double bpm = himc_midi_bpm(from->tempi, from->count, begin);
        double more = fmin(s->value, MOST_HELD * bpm / 60);
        if (!add(to, begin, bpm * s->value / (s->value + more)))
            return false;
        while (next < from->count && from->tempi[next].beat <= end + SAME)
            next++;
        if (!add(to, end, himc_midi_bpm(from->tempi, from->count, end)))
            return false;
        done = end;
    }
    for (; next < from->count; next++)
        if (!add(to, from->tempi[next].beat, from->tempi[next].bpm))
            return false;
    return true;
}

bool himc_music_tempo(const music *m, midi_file *file, himc_error *error)
{
    map signs = {.error = error}, held = {.error = error};
    bool good = add(&signs, 0, USUAL_BPM) && add_signs(&signs, m) && add_fermatas(&held, &signs, m);
    free(signs.tempi);
    file->tempi = held.tempi;
    file->tempo_count = held.count;
    return good;
}
