/// lesson_ghost.c: the take as a scene, and beside it, as a ghost, the model.
///
/// The model has the student's body and place and plays the score on the student's own beat: from
/// each matched stroke to the next it has the tempo that leads there, so it waits where the student
/// waits and never runs away.
#include "lesson.h"

#include "cli.h"
#include "scene_record.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define RATE 48000   // (Hz)
#define EARS 2       // channels
#define AFTERWARDS 2 // chosen: of the scene, after the take's end (s)

typedef struct showing {
    himc_performance *performance;
    scene_record *record;
    uint64_t samples;
    bool done;
} showing;

static void keep_row(void *user, const himc_motion_row *row)
{
    scene_record_row(user, row);
}

// the score's drums, and the body and the place of the take
static bool open_showing(showing *s, const lesson *l, const himc_take_options *how, FILE *out,
                         const char *name, himc_error *error)
{
    *s = (showing){.performance = cli_load(l->score, RATE, CLI_LISTENER, error)};
    if (!s->performance)
        return false;
    himc_performance_take_options(s->performance, how);
    if (!cli_tell(s->performance, "take", l->take, error))
        return false;
    scene_record_config config = {.performance = s->performance,
                                  .stream = out,
                                  .source = l->take,
                                  .name = name,
                                  .rate = RATE,
                                  .channels = EARS};
    s->record = scene_record_begin(&config, error);
    himc_performance_on_tick(s->performance, scene_record_tick, s->record);
    himc_performance_on_motion(s->performance, keep_row, s->record);
    return s->record != NULL;
}

static void play(showing *s, uint64_t samples)
{
    static float out[EARS * LESSON_BLOCK];
    himc_event event;
    for (uint64_t end = s->samples + samples; s->samples < end;) {
        uint64_t left = end - s->samples;
        int n = left < LESSON_BLOCK ? (int)left : LESSON_BLOCK;
        himc_performance_read(s->performance, out, EARS, n);
        while (himc_performance_event(s->performance, &event)) {
            s->done |= event.kind == HIMC_EVENT_DONE;
            scene_record_event(s->record, &event);
        }
        scene_record_block(s->record, out, n);
        s->samples += (uint64_t)n;
    }
}

static bool close_showing(showing *s, himc_error *error)
{
    bool good = scene_record_end(s->record, error);
    himc_performance_free(s->performance);
    return good;
}

static bool set_tempo(himc_performance *p, double beat, double bpm, himc_error *error)
{
    char text[80];
    snprintf(text, sizeof text, "tempo %.9g %.9g", bpm, beat);
    return cli_tell(p, text, NULL, error);
}

// from each matched stroke to the next the tempo that leads there; the score's own changes between
// them are replaced. `lead`: of the beats before the first (s)
static bool set_beat(const lesson *l, himc_performance *p, const himc_score *score, double lead,
                     himc_error *error)
{
    double beat = 0, time = -lead, first = NAN;
    bool good = true;
    int change = 0;
    for (int k = 0; k < l->asked_count && good; k++) {
        const lesson_asked *a = &l->asked[k];
        const lesson_played *to = a->by < 0 ? NULL : &l->played[a->by];
        if (!to || !isfinite(to->off) || (a->beat <= beat && !isnan(first)))
            continue;
        double target = to->strike.time - to->off;
        first = isnan(first) ? target : first;
        target -= first;
        double bpm = target > time ? 60 * (a->beat - beat) / (target - time) : HIMC_BPM_MAX;
        bpm = fmin(fmax(bpm, HIMC_BPM_MIN), HIMC_BPM_MAX);
        good = a->beat <= beat || set_tempo(p, beat, bpm, error);
        for (; good && change < score->tempo_count && score->tempi[change].beat < a->beat; change++)
            if (score->tempi[change].beat > beat)
                good = set_tempo(p, score->tempi[change].beat, bpm, error);
        time += 60 * (a->beat - beat) / bpm;
        beat = a->beat;
    }
    return good;
}

// the first matched stroke, whose beat is that of the take
static const lesson_asked *first_matched(const lesson *l)
{
    const lesson_asked *a = l->asked;
    while (a->by < 0 || !isfinite(l->played[a->by].off))
        a++;
    return a;
}

static bool show_model(const lesson *l, const himc_take_options *how, const showing *take,
                       FILE *out, himc_error *error)
{
    showing s;
    himc_score *score = himc_score_load(l->score, error);
    bool good = score && open_showing(&s, l, how, out, "model", error) &&
                cli_tell(s.performance, "score", l->score, error) &&
                cli_tell(s.performance, "human 0", NULL, error) &&
                cli_tell(s.performance, "loop 0", NULL, error);
    if (good) {
        const lesson_asked *a = first_matched(l);
        const lesson_played *p = &l->played[a->by];
        double at = HIMC_APPROACH + p->strike.time - p->off;
        double delay = l->asked[0].time -
                       himc_score_seconds(score->tempi, score->tempo_count, l->asked[0].beat);
        double lead = fmin(at - delay, a->beat * 60 / (l->bpm * l->tempo.mean));
        good = set_beat(l, s.performance, score, fmax(lead, 0), error);
        play(&s, (uint64_t)(fmax(at - delay - lead, 0) * RATE));
        good = good && cli_tell(s.performance, "play", NULL, error);
        play(&s, take->samples - s.samples);
        good &= close_showing(&s, error);
    }
    himc_score_free(score);
    return good;
}

bool lesson_scene(const lesson *l, const himc_take_options *how, FILE *out, himc_error *error)
{
    showing s;
    FILE *file = tmpfile();
    bool good = (file || himc_error_set(error, "no temporary file: %s", strerror(errno))) &&
                open_showing(&s, l, how, out, "take", error) &&
                cli_tell(s.performance, "mode ik", NULL, error) &&
                cli_tell(s.performance, "play", NULL, error);
    if (good) {
        while (!s.done)
            play(&s, LESSON_BLOCK);
        play(&s, (uint64_t)AFTERWARDS * RATE);
        good = show_model(l, how, &s, file, error);
        if (good)
            scene_record_more(s.record, file);
        good &= close_showing(&s, error);
    }
    if (file)
        fclose(file);
    return good;
}
