// session.c: what of a performance Python would be too slow for: adds up the drums' sound, keeps rows and strikes.
#include "capture/take.h"
#include "himc/drive.h"
#include "himc/drum.h"
#include "himc/himc.h"
#include "himc/membrane.h"
#include "himc/mocap.h"
#include "performance/performance_state.h"
#include "plan/score.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 8192 // (samples) processed at a time

typedef struct session {
    himc_performance *performance;
    himc_motion_row *rows; // since session_keep_rows
    size_t row_count, row_room;
    himc_strike *strikes;
    size_t strike_count, strike_room;
    himc_strike *missed;
    size_t missed_count, missed_room;
    char *notes; // lines
    size_t notes_size;
    bool done, keeps_rows, failed; // `failed`: no memory for a row, strike or note
    uint64_t samples, zero;        // played in all, and at the last reset
    double peak;                   // of the last session_process
    char left[64], right[64];
} session;

typedef struct mode_row {
    int m, n;
    double frequency, ratio, t60;
} mode_row;

static void *grown(session *s, void *old, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return old;
    size_t more = *room ? 2 * *room : 256;
    void *bytes = realloc(old, more * size);
    if (bytes)
        *room = more;
    else
        s->failed = true;
    return bytes ? bytes : old;
}

static void keep_row(void *user, const himc_motion_row *row)
{
    session *s = user;
    s->rows = grown(s, s->rows, s->row_count, &s->row_room, sizeof *row);
    if (s->row_count < s->row_room)
        s->rows[s->row_count++] = *row;
}

static session *session_new(double rate, double physics, double task, himc_error *error)
{
    himc_performance_config config = himc_performance_default();
    session *s = calloc(1, sizeof *s);
    if (!s) {
        himc_error_set(error, "out of memory");
        return NULL;
    }
    config.sample_rate = rate;
    config.physics_rate = physics != 0 ? physics : fmin(config.physics_rate, rate);
    config.task_rate = task != 0 ? task : config.task_rate;
    s->performance = himc_performance_new(&config, error);
    if (!s->performance) {
        free(s);
        return NULL;
    }
    himc_performance_make_drums(s->performance, true);
    return s;
}

static void session_free(session *s)
{
    himc_performance_free(s->performance);
    free(s->rows);
    free(s->strikes);
    free(s->missed);
    free(s->notes);
    free(s);
}

// after a reset, by the command or by a file's
static void begin_again(session *s)
{
    s->zero = s->samples;
    s->row_count = s->strike_count = s->missed_count = 0;
    s->done = false;
}

static void keep_note(session *s, const char *text)
{
    size_t length = strlen(text);
    char *notes = realloc(s->notes, s->notes_size + length + 2);
    if (!notes) {
        s->failed = true;
        return;
    }
    s->notes = notes;
    memcpy(notes + s->notes_size, text, length);
    memcpy(notes + s->notes_size + length, "\n", 2);
    s->notes_size += length + 1;
}

static void answer(void *user, const char *line)
{
    keep_note(user, line);
}

// a command with its atoms in `text`, or with one that may have spaces, `word`
static bool session_command(session *s, const char *text, const char *word, himc_error *error)
{
    himc_command command;
    himc_atom atom = {HIMC_ATOM_SYMBOL, 0, word};
    bool good = word ? himc_command_parse(&command, HIMC_PERFORMER, text, &atom, 1, error)
                     : himc_command_parse_text(&command, HIMC_PERFORMER, text, error);
    double before = himc_performance_measure(s->performance).seconds;
    good = good && himc_performance_command(s->performance, &command, 0, error);
    if (good && (command.id == HIMC_COMMAND_PLAY || s->performance->motion->playing))
        s->done = false; // `play` acts on its sample, a stroke goes on at once
    if (himc_performance_measure(s->performance).seconds < before)
        begin_again(s);
    if (good && command.id == HIMC_COMMAND_INFO)
        himc_performance_describe(s->performance, HIMC_DESCRIBE_INFO, answer, s);
    if (good && command.id == HIMC_COMMAND_DUMP && command.count == 0)
        himc_performance_describe(s->performance, HIMC_DESCRIBE_STATE, answer, s);
    return good;
}

static bool session_drive(session *s, const himc_drive *drive, himc_error *error)
{
    return himc_performance_drive(s->performance, drive, error);
}

// writes what `record` has begun and `record stop` has not ended
static bool session_end_recording(session *s, himc_error *error)
{
    return himc_performance_end_recording(s->performance, error);
}

static bool session_drum_command(session *s, const char *name, const char *text, himc_error *error)
{
    himc_command command;
    himc_drum *drum;
    for (int i = 0; (drum = himc_performance_drum(s->performance, i)); i++)
        if (!strcmp(himc_drum_name(drum), name))
            break;
    if (!drum)
        return himc_error_set(error, "no drum of that name: %s", name);
    if (!himc_command_parse_text(&command, HIMC_DRUM, text, error) ||
        !himc_drum_command(drum, &command, error))
        return false;
    if (command.id == HIMC_COMMAND_DRUM_INFO)
        himc_drum_describe(drum, HIMC_DESCRIBE_INFO, answer, s);
    if (command.id == HIMC_COMMAND_DRUM_DUMP && command.count == 0)
        himc_drum_describe(drum, HIMC_DESCRIBE_STATE, answer, s);
    return true;
}

static bool session_add_drum(session *s, const char *name, double inches, himc_error *error)
{
    himc_atom atom = {.kind = HIMC_ATOM_SYMBOL, .symbol = name};
    himc_command c;
    himc_drum *other;
    char line[HIMC_NAME_SIZE + 8];
    snprintf(line, sizeof line, "drum %s", name);
    if (!himc_command_parse(&c, HIMC_PERFORMER, "drum", &atom, 1, error) ||
        !himc_command_parse_text(&c, HIMC_PERFORMER, line, error))
        return false; // a name that scores cannot have: no word, or a number
    for (int i = 0; (other = himc_performance_drum(s->performance, i)); i++)
        if (strcmp(himc_drum_name(other), name) == 0)
            return himc_error_set(error, "drum: %s: there is one of that name", name);
    double rate = himc_performance_measure(s->performance).sample_rate;
    himc_drum *drum = himc_drum_new(name, inches != 0 ? inches : HIMC_INCHES_USUAL, rate, error);
    bool good = drum && himc_performance_add_drum(s->performance, drum, error);
    himc_drum_release(drum);
    return good;
}

static bool session_is_command(const char *word)
{
    return himc_command_find(HIMC_PERFORMER, word) != NULL;
}

// 1 if the score makes drums itself, 0 if not, -1 with the reason
static int session_makes_drums(const char *path, himc_error *error)
{
    himc_score *score = himc_score_load(path, error);
    int makes = 0;
    if (!score)
        return -1;
    for (int i = 0; i < score->line_count; i++)
        makes |= himc_score_makes_drum(&score->lines[i]);
    himc_score_free(score);
    return makes;
}

static himc_take_options options_of(const char *left, const char *right, const char *up)
{
    himc_take_options options = himc_take_default();
    options.left_tip = left && left[0] ? left : NULL;
    options.right_tip = right && right[0] ? right : NULL;
    options.up = up && up[0] == 'y' ? HIMC_UP_Y : up && up[0] == 'z' ? HIMC_UP_Z : HIMC_UP_AUTO;
    return options;
}

static void session_take_options(session *s, const char *left, const char *right, const char *up)
{
    snprintf(s->left, sizeof s->left, "%s", left);
    snprintf(s->right, sizeof s->right, "%s", right);
    himc_take_options options = options_of(s->left, s->right, up);
    himc_performance_take_options(s->performance, &options);
}

static void session_keep_rows(session *s, bool keep)
{
    if (keep != s->keeps_rows)
        himc_performance_on_motion(s->performance, keep ? keep_row : NULL, s);
    s->keeps_rows = keep;
}

static void take_events(session *s)
{
    himc_event event;
    while (himc_performance_event(s->performance, &event)) {
        s->done = s->done || event.kind == HIMC_EVENT_DONE;
        if (event.kind == HIMC_EVENT_NOTE)
            keep_note(s, event.text);
        if (event.kind == HIMC_EVENT_MISSED) {
            s->missed = grown(s, s->missed, s->missed_count, &s->missed_room, sizeof *s->missed);
            if (s->missed_count < s->missed_room)
                s->missed[s->missed_count++] = event.strike;
        }
        if (event.kind != HIMC_EVENT_STRIKE)
            continue;
        s->strikes = grown(s, s->strikes, s->strike_count, &s->strike_room, sizeof *s->strikes);
        if (s->strike_count < s->strike_room)
            s->strikes[s->strike_count++] = event.strike;
    }
    s->done = s->done && !s->performance->motion->playing; // a clock may start it
}

// plays n samples into out (n x channels)
static void session_process(session *s, size_t n, int channels, float *out)
{
    himc_drum *drum;
    for (int d = 0; (drum = himc_performance_drum(s->performance, d)); d++)
        himc_drum_watch(drum, false); // nobody reads the displacement
    s->peak = 0;
    for (size_t done = 0; done < n;) {
        int count = n - done < BLOCK ? (int)(n - done) : BLOCK;
        float *to = out + done * (size_t)channels;
        s->peak = fmax(s->peak, himc_performance_read(s->performance, to, channels, count));
        s->samples += (uint64_t)count;
        done += (size_t)count;
        take_events(s);
    }
}

static himc_take *take_load(const char *path, const char *left, const char *right, const char *up,
                            const char *subject, himc_error *error)
{
    himc_take_options options = options_of(left, right, up);
    options.subject = subject[0] ? subject : NULL;
    return himc_take_load(path, &options, error);
}

static himc_vec3 *take_points(himc_take *take)
{
    return take->x;
}

static double *take_analog(himc_take *take, int *samples, int *channels, double *rate)
{
    *samples = take->analog_samples;
    *channels = take->analog_channels;
    *rate = take->analog_rate;
    return take->analog;
}

static const char *take_analog_name(himc_take *take, int channel)
{
    return take->analog_names[channel];
}

// 0 past the last
static int take_event(himc_take *take, int index, double *time, const char **label)
{
    if (index >= take->event_count)
        return 0;
    *time = take->events[index].time;
    *label = take->events[index].label;
    return 1;
}

static himc_take_strike *take_strikes(himc_take *take, const char *left, const char *right,
                                      int *count, himc_error *error)
{
    himc_take_options options = options_of(left, right, NULL);
    himc_take_tip tips[HIMC_HANDS];
    *count = -1;
    if (!himc_take_tips(take, &options, tips, error))
        return NULL;
    return himc_take_find_strikes(take, tips, count);
}

// the modes of the first drum of a score, or of the default one; their number, -1 with the reason
static int modes_of(const char *path, mode_row *out, int room, himc_error *error)
{
    session *s = session_new(48000, 0, 0, error);
    int count = s ? 0 : -1, makes = path && s ? session_makes_drums(path, error) : 0;
    if (makes < 0 || (s && !makes && !session_add_drum(s, "kettle", 0, error)) ||
        (s && path && !session_command(s, "score", path, error)))
        count = -1;
    himc_drum *drum = count == 0 ? himc_performance_drum(s->performance, 0) : NULL;
    const himc_membrane *membrane = drum ? himc_drum_membrane(drum) : NULL;
    double before = 0;
    for (int i = 0; membrane && himc_membrane_mode(membrane, i).mass > 0 && count < room; i++) {
        himc_mode mode = himc_membrane_mode(membrane, i);
        if (mode.m >= 0 && !(mode.sine && mode.frequency == before))
            out[count++] = (mode_row){
                mode.m, mode.n, mode.frequency,
                mode.frequency / himc_membrane_principal(membrane, himc_membrane_head(membrane)),
                log(1000) / mode.decay};
        before = mode.frequency;
    }
    if (s)
        session_free(s);
    return count;
}
