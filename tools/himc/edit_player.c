/// edit_player.c: what is the same wherever a piece under edit is played: in processes
/// (edit_play.c), or in a page (viewer/engine/edit.c).
#include "edit_player.h"
#include "edit_journal.h"
#include "performance/research.h"
#include "plan/score.h"

#include <math.h>
#include <string.h>

enum {
    EARS = 2,
    BLOCK = 64,
    CELL = EDIT_RATE / 5 // CLI_CELL, where a piece may end
};

void edit_player_put(edit_player *p, const char *kind, const void *bytes, size_t size)
{
    uint32_t length = (uint32_t)size;
    fwrite(kind, 4, 1, p->to);
    fwrite(&length, sizeof length, 1, p->to);
    fwrite(bytes, 1, size, p->to);
}

static void take_events(edit_player *p)
{
    himc_event event;
    while (himc_performance_event(p->performance, &event)) {
        scene_record_event(p->record, &event);
        p->ending.done |= event.kind == HIMC_EVENT_DONE;
    }
}

void edit_player_cell(edit_player *p)
{
    struct {
        uint32_t first, sum[2];
        int16_t sample[EARS * CELL];
    } sound = {.first = (uint32_t)p->ending.samples};
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    for (int at = 0; at < CELL; at += BLOCK) {
        float out[EARS * BLOCK];
        double peak = himc_performance_read(p->performance, out, EARS, BLOCK);
        p->ending.cell_peak = fmax(p->ending.cell_peak, peak);
        p->ending.samples += BLOCK;
        take_events(p);
        scene_record_block(p->record, NULL, BLOCK);
        sum = edit_hash(sum, out, sizeof out);
        for (int i = 0; i < EARS * BLOCK; i++)
            sound.sample[EARS * at + i] = (int16_t)lrint(32767 * fmax(-1, fmin(1, out[i])));
    }
    sound.sum[0] = (uint32_t)sum, sound.sum[1] = (uint32_t)(sum >> 32);
    scene_record_flush(p->record);
    edit_player_put(p, "pcm ", &sound, sizeof sound);
    fflush(p->to);
}

// `heard`: it will play
static bool load(edit_player *p, const char *text, bool heard, himc_error *error)
{
    himc_performance_config config = himc_performance_default();
    himc_score *score = p->spare ? NULL : himc_score_parse(text, p->name, NULL, error);
    bool drums = p->spare || (score && cli_first_drum(score));
    himc_drum *made;
    p->performance = p->spare || score ? himc_performance_new(&config, error) : NULL;
    himc_score_free(score);
    if (!p->performance)
        return false;
    for (int i = 0; p->spare && (made = himc_performance_drum(p->spare, i)); i++)
        if (!himc_performance_add_drum(p->performance, made, error))
            return false;
    himc_performance_make_drums(p->performance, true);
    himc_performance_take_options(p->performance, p->options);
    return (drums || cli_add_drum(p->performance, EDIT_RATE, error)) &&
           (!heard || cli_tell(p->performance, CLI_LISTENER, NULL, error)) &&
           (heard ? himc_performance_load_text
                  : himc_performance_load_unheard)(p->performance, text, p->name, error) &&
           cli_tell(p->performance, "loop 0", NULL, error);
}

bool edit_player_exchange(edit_player *p, const char *text, bool *late, himc_error *error)
{
    double time = (double)p->ending.samples / EDIT_RATE;
    edit_player fresh = {.name = p->name, .options = p->options, .spare = p->spare};
    bool good = load(&fresh, text, false, error);
    *late = good && !himc_performance_exchange_strokes(p->performance, fresh.performance);
    himc_performance_free(fresh.performance);
    if (good && !*late)
        edit_player_put(p, "from", &time, sizeof time);
    return good && !*late;
}

bool edit_player_begin(edit_player *p, const char *text, const char *record, himc_error *error)
{
    double start = 0;
    edit_player spare = *p;
    if ((!record && !load(&spare, text, false, error)) || !load(p, text, true, error) ||
        (record && !cli_tell(p->performance, "record", record, error)))
        return false;
    p->spare = record ? NULL : spare.performance;
    edit_player_put(p, "from", &start, sizeof start);
    scene_record_config config = {.performance = p->performance,
                                  .stream = p->to,
                                  .source = p->name,
                                  .name = "himc",
                                  .rate = EDIT_RATE,
                                  .live = true,
                                  .bare = true};
    p->record = scene_record_begin(&config, error);
    if (!p->record)
        return false;
    himc_performance_on_tick(p->performance, scene_record_tick, p->record);
    himc_performance_on_motion(p->performance, scene_record_row, p->record);
    scene_record_flush(p->record);
    return true;
}

bool edit_player_is_over(edit_player *p)
{
    return cli_is_over(&p->ending, EDIT_RATE);
}

bool edit_player_end(edit_player *p, himc_error *error)
{
    scene_record_end(p->record, NULL);
    fflush(p->to); // which ends a process if nobody wants the recording any more
    bool good = himc_performance_end_recording(p->performance, error);
    himc_performance_free(p->performance);
    himc_performance_free(p->spare);
    return good;
}
