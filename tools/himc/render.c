/// render.c: `himc render`: plays a score or a take offline, as fast as the machine can, into a
/// sound file.
///
/// The commands `listener`, `score` or `take`, then `play` on sample 0, then block after block,
/// just as `[himc~]` does it in Pd; each sample of a channel is the sum of the drums' samples,
/// rounded to 32-bit float once, as Pd's signals are. The end is tested only where a cell of 0.2 s
/// ends; blocks end there too, so that nothing depends on --block. The end: the performer is done
/// and a whole cell stayed 80 dB below the peak, or 8 s have passed.
#define _POSIX_C_SOURCE 200809L
#include "capture/take.h"
#include "cli.h"
#include "motion_table.h"
#include "render_tables.h"
#include "scene_record.h"
#include "sound_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#define HEARD_BY_TWO 2 // channels, one for each ear
#define BLOCK_MAX CLI_BLOCK

enum {
    OUT,
    RATE,
    BLOCK,
    CHANNELS,
    STROKES,
    MOTION,
    COLUMNS,
    SCENE,
    COMPARE,
    MODE,
    LAW,
    SOLVER,
    LIMITS,
    PLAYER,
    SET,
    JSON,
    TAKE
};

static const cli_option options[] = {
    {"output", 'o', "OUT.wav",
     "the sound of all drums, 32-bit float; also .w64 .aiff .flac .ogg .mp3; -: standard output"},
    {"rate", 0, "HZ", "sample rate, 8000 .. 192000 (48000)"},
    {"block", 0, "N", "samples computed at a time, 1 .. 8192 (64); the result is the same"},
    {"channels", 0, "N",
     "2: two ears in front of the drums, or where the score has them; 1: both in one (2)"},
    {"strokes", 0, "F.csv", "a row for each contact: when, where, how fast, how hard"},
    {"motion", 0, "F", "a row every 4 ms: .csv, .npz for NumPy, .sto .mot for OpenSim, .c3d"},
    {"columns", 0, "LIST",
     "what is in it: groups like tips,torques,energy, or all; help lists them"},
    {"scene", 0, "F.himc", "a recording for himc-viewer --play: motion, drums, strikes, sound"},
    {"compare", 0, "MODES",
     "in the scene also what others make of it: some of ik,id,himc, and captured, the take itself"},
    {"mode", 0, "mode", "control pipeline (himc)"},
    {"law", 0, "law", "inverse dynamics (computed-torque)"},
    {"solver", 0, "solver", "inverse kinematics (dls)"},
    {"limits", 0, "limits", "joint limits (off)"},
    {"player", 0, "H,M", "height and mass of the player (m, kg); a take keeps its lengths"},
    {"set", 0, "COMMAND...", "any command of the manual, before playing; may be repeated"},
    {"json", 0, NULL, "the report as a JSON object also on a terminal"},
    CLI_TAKE_OPTIONS,
    {0},
};

/// The arguments.
enum { FILES = 5 };

typedef struct job {
    const char *source, *files[FILES]; ///< `files`: the source and what is written
    const cli_arguments *arguments;
    int rate, block, channels;
    himc_take_options take;
    double length; ///< from the first beat to the last, or of the take; 0: not known (s)
} job;

/// The state of the rendering.
typedef struct rendering {
    himc_performance *performance;
    cli_file wav, strokes, motion, scene;
    render_strokes struck;
    motion_table *rows;   ///< NULL without --motion
    scene_record *record; ///< NULL without --scene
    SNDFILE *sound;
    int channels;
    int failed;    ///< errno of the first write that did not arrive
    bool too_long; ///< for the format of the sound file
    cli_ending ending;
} rendering;

// what is compared, in this order, and whether a list "ik,id" has it
static const char *const others[] = {"ik", "id", "himc", "captured"};
enum { CAPTURED = 3, OTHERS };

static bool lists(const char *list, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = list; at; at = strchr(at, ',')) {
        at += *at == ',';
        if (!strncmp(at, word, length) && (!at[length] || at[length] == ','))
            return true;
    }
    return false;
}

static bool check_compare(const char *list, const char *scene, const char *source,
                          himc_error *error)
{
    size_t known = 0, words = 1;
    for (const char *at = list; (at = strchr(at, ',')); at++)
        words++;
    for (int i = 0; i < OTHERS; i++)
        known += lists(list, others[i]);
    if (known != words)
        return himc_error_set(error, "--compare %s: expected some of ik,id,himc,captured", list);
    if (!scene)
        return himc_error_set(error, "--compare: no --scene F.himc given");
    return cli_is_take(source) || !lists(list, others[CAPTURED]) ||
           himc_error_set(error, "--compare captured: %s is no take", source);
}

// The ending of a table's name says its format; a name without one is a CSV.
static bool check_table(const char *option, const char *path, bool motion, himc_error *error)
{
    const char *slash = path ? strrchr(path, '/') : NULL;
    const char *dot = path ? strrchr(slash ? slash : path, '.') : NULL;
    return !dot || !strcasecmp(dot, ".csv") || !strcasecmp(dot, ".txt") ||
           (motion && motion_table_format_of(path) != MOTION_TABLE_CSV) ||
           himc_error_set(error, "--%s: %s, expected endings are .csv%s", option, path,
                          motion ? " .npz .sto .mot .c3d" : "");
}

static bool read_job(const cli_arguments *arguments, job *out, himc_error *error)
{
    const char *const *value = arguments->value;
    *out = (job){.source = cli_input(arguments->operand, error),
                 .arguments = arguments,
                 .rate = 48000,
                 .block = 64,
                 .channels = HEARD_BY_TWO};
    if (!out->source)
        return false;
    const char *files[] = {out->source, value[OUT], value[STROKES], value[MOTION], value[SCENE]};
    memcpy(out->files, files, sizeof files);
    if (!value[OUT])
        return himc_error_set(error, "no -o OUT.wav given (himc render --help)");
    if (!check_table("strokes", value[STROKES], false, error) ||
        !check_table("motion", value[MOTION], true, error))
        return false;
    if (value[COLUMNS] && !value[MOTION])
        return himc_error_set(error, "--columns: no --motion F given");
    if (value[COMPARE] && !check_compare(value[COMPARE], value[SCENE], out->source, error))
        return false;
    for (int i = 1; i < FILES; i++)
        if (!cli_apart(files[i], files, i, error))
            return false;
    return cli_count("--rate", value[RATE], 8000, 192000, "Hz", &out->rate, error) &&
           cli_count("--block", value[BLOCK], 1, BLOCK_MAX, "samples", &out->block, error) &&
           cli_count("--channels", value[CHANNELS], 1, 2, "", &out->channels, error) &&
           cli_take_options(out->source, value + TAKE, &out->take, error);
}

static double score_seconds(const himc_score *score)
{
    double seconds = 0;
    for (int i = 0; i < score->stroke_count; i++) {
        const himc_stroke *stroke = &score->strokes[i];
        double end = stroke->beat + (stroke->ornament >= HIMC_ROLL_SINGLE ? stroke->length : 0);
        seconds = fmax(seconds, himc_score_seconds(score->tempi, score->tempo_count, end));
    }
    return seconds;
}

// samples of a channel that the sound file can hold
static double room(const job *wanted)
{
    return sound_file_room(wanted->arguments->value[OUT], wanted->channels);
}

// The commands of the score (or NULL), then those of --set; NULL for one that is none.
static const himc_command *command_at(const himc_score *score, const cli_arguments *arguments,
                                      int index, himc_command *parsed)
{
    int lines = score ? score->line_count : 0;
    if (index < lines)
        return &score->lines[index].command;
    const char *text = arguments->repeated[index - lines];
    return himc_command_parse_text(parsed, HIMC_PERFORMER, text, NULL) ? parsed : NULL;
}

// The file that a command reads or writes, if it does that; else NULL.
static const char *file_of(const himc_command *c, himc_file_use use)
{
    int atom;
    return c && himc_command_file(c, &atom) == use ? c->atom[atom].symbol : NULL;
}

// No file of the command line and of the commands is written and read, or written twice.
static bool check_apart(const job *wanted, const himc_score *score, himc_error *error)
{
    int lines = score ? score->line_count : 0, count = lines + wanted->arguments->repeats;
    himc_command parsed, other;
    for (int i = 0; i < count; i++) {
        const himc_command *c = command_at(score, wanted->arguments, i, &parsed);
        const char *read = file_of(c, HIMC_FILE_READ), *written = file_of(c, HIMC_FILE_WRITE);
        bool good = !written || cli_apart(written, wanted->files, FILES, error);
        for (int k = 1; k < FILES && good; k++)
            good = !read || cli_apart(wanted->files[k], &read, 1, error);
        for (int j = 0; j < count && written && good; j++) {
            const char *from =
                file_of(command_at(score, wanted->arguments, j, &other), HIMC_FILE_READ);
            good = !from || cli_apart(written, &from, 1, error);
        }
        if (!good)
            return himc_error_prefix(error, "%s", i < lines ? wanted->source : "--set");
    }
    return true;
}

/// Finds out if the score makes drums itself, if it loops, by itself or by --set, and how long it
/// is; false if it is too long for the sound file.
static bool inspect_score(job *wanted, bool *makes_drums, bool *loops, himc_error *error)
{
    himc_score *score = himc_score_load(wanted->source, error);
    if (!score)
        return false;
    *makes_drums = cli_first_drum(score) != NULL;
    himc_command parsed;
    for (int i = 0; i < score->line_count + wanted->arguments->repeats; i++) {
        const himc_command *c = command_at(score, wanted->arguments, i, &parsed);
        if (c && c->id == HIMC_COMMAND_LOOP)
            *loops = c->count > 1 || c->atom[0].number != 0;
    }
    bool good = check_apart(wanted, score, error);
    wanted->length = score_seconds(score);
    himc_score_free(score);
    if (!good)
        return false;
    if (wanted->length + CLI_TAIL > room(wanted) / wanted->rate)
        return himc_error_set(
            error,
            "%s: lasts %.0f s, expected up to %.0f s in this file at %d Hz (.w64 and "
            ".flac have no end)",
            wanted->source, wanted->length, room(wanted) / wanted->rate - CLI_TAIL, wanted->rate);
    return true;
}

// read once more, for the progress alone
static void inspect_take(job *wanted)
{
    himc_take *take =
        cli_shows_progress() ? himc_take_load(wanted->source, &wanted->take, NULL) : NULL;
    if (take)
        wanted->length = HIMC_APPROACH + take->frames / take->rate;
    himc_take_free(take);
}

// the settings of the command line; before a take, which keeps the player's height and mass, and
// after a score, whose own settings they replace
static bool apply_settings(himc_performance *p, const cli_arguments *arguments, himc_error *error)
{
    const char *player = arguments->value[PLAYER];
    char text[128];
    for (int i = MODE; i <= LIMITS; i++)
        if (arguments->value[i] && !cli_tell(p, options[i].name, arguments->value[i], error))
            return false;
    if (player) {
        snprintf(text, sizeof text, "player %.100s", player);
        char *comma = strchr(text, ',');
        if (comma)
            *comma = ' ';
        if (!cli_tell(p, text, NULL, error))
            return himc_error_prefix(error, "--player");
    }
    for (int i = 0; i < arguments->repeats; i++)
        if (!cli_tell(p, arguments->repeated[i], NULL, error))
            return himc_error_prefix(error, "--set");
    return true;
}

static bool prepare(himc_performance *performance, job *wanted, himc_error *error)
{
    bool take = cli_is_take(wanted->source), makes_drums = false, loops = false;
    himc_performance_make_drums(performance, true);
    himc_performance_take_options(performance, &wanted->take);
    if (take && !check_apart(wanted, NULL, error))
        return false;
    if (take)
        inspect_take(wanted);
    else if (!inspect_score(wanted, &makes_drums, &loops, error))
        return false;
    if (!makes_drums && !cli_add_drum(performance, wanted->rate, error))
        return false;
    if (!cli_tell(performance, CLI_LISTENER, NULL, error))
        return false;
    if (take && !apply_settings(performance, wanted->arguments, error))
        return false;
    if (!cli_tell(performance, take ? "take" : "score", wanted->source, error))
        return false;
    if (!take && !apply_settings(performance, wanted->arguments, error))
        return false;
    if (loops) {
        himc_error note;
        himc_error_set(&note, "%s: loop: the score is rendered once", wanted->source);
        cli_say("note: %s\n", note.text);
    }
    return cli_tell(performance, "loop 0", NULL, error) &&
           cli_tell(performance, "play", NULL, error);
}

static bool open_sound(rendering *r, const char *path, const job *wanted, himc_error *error)
{
    if (!cli_file_open(&r->wav, path, error))
        return false;
    r->sound = sound_file_begin(r->wav.stream, path, wanted->rate, wanted->channels, error);
    return r->sound != NULL;
}

static void show_progress(double seconds, double length, double elapsed)
{
    char whole[32] = "";
    if (seconds < length)
        snprintf(whole, sizeof whole, " of %.0f", length);
    if (cli_shows_progress())
        fprintf(stderr, "\r%7.1f%s s played, %.1f x real time \033[K", seconds, whole,
                seconds / elapsed);
}

static void clear_progress(void)
{
    if (cli_shows_progress())
        fputs("\r\033[K", stderr);
}

/// Takes the performer's events: strikes go to their table, notes to the user.
static void take_events(rendering *r)
{
    himc_event event;
    while (himc_performance_event(r->performance, &event)) {
        if (r->record)
            scene_record_event(r->record, &event);
        bool row = event.kind == HIMC_EVENT_STRIKE || event.kind == HIMC_EVENT_MISSED;
        if (row && r->strokes.stream)
            render_strokes_add(&r->struck, &event.strike);
        else if (event.kind == HIMC_EVENT_NOTE) {
            clear_progress();
            if (r->sound)
                cli_say("note: %s\n", event.text);
        } else if (event.kind == HIMC_EVENT_DONE)
            r->ending.done = true;
    }
}

static void take_row(void *user, const himc_motion_row *row)
{
    rendering *r = user;
    if (r->rows)
        motion_table_row(r->rows, row);
    if (r->record)
        scene_record_row(r->record, row);
}

static void play_block(rendering *r, int n)
{
    static float out[HEARD_BY_TWO * BLOCK_MAX]; // too large for a small stack
    double peak = himc_performance_read(r->performance, out, r->channels, n);
    r->ending.cell_peak = fmax(r->ending.cell_peak, peak);
    errno = 0;
    if (r->sound && sf_writef_float(r->sound, out, n) != n)
        r->failed = errno ? errno : EIO;
    r->ending.samples += (uint64_t)n;
    take_events(r);
    if (r->record)
        scene_record_block(r->record, r->channels ? out : NULL, n);
}

/// Plays to the end; returns how long it took (s).
static double play(rendering *r, const job *wanted)
{
    int cell = (int)lround(CLI_CELL * wanted->rate);
    double start = cli_now();
    do {
        for (int left = cell; left > 0 && !r->failed;) {
            int n = left < wanted->block ? left : wanted->block;
            play_block(r, n);
            left -= n;
        }
        r->too_long = (double)(r->ending.samples + (uint64_t)cell) > room(wanted);
        show_progress((double)r->ending.samples / wanted->rate, wanted->length, cli_now() - start);
    } while (!cli_is_over(&r->ending, wanted->rate) && !r->failed && !r->too_long);
    double elapsed = cli_now() - start;
    clear_progress();
    return elapsed;
}

/// All files complete, or none of them.
static bool keep_files(rendering *r, const job *wanted, himc_error *error)
{
    const char *path = r->wav.path;
    if (r->failed)
        return himc_error_set(error, "%s: cannot be written: %s", path, strerror(r->failed));
    if (r->too_long)
        return himc_error_set(error, "%s: longer than this file can hold (%.0f samples)", path,
                              room(wanted));
    bool closed = !sf_close(r->sound);
    r->sound = NULL;
    if (!closed)
        return himc_error_set(error, "%s: cannot be written to its end", path);
    if (r->struck.full)
        return himc_error_set(error, "%s: out of memory for its rows", r->strokes.path);
    if (r->strokes.stream)
        render_strokes_write(&r->struck, r->strokes.stream);
    if (r->rows && !motion_table_end(r->rows, error))
        return false;
    bool recorded = scene_record_end(r->record, error);
    r->record = NULL;
    return recorded && cli_file_close(&r->wav, error) && cli_file_close(&r->strokes, error) &&
           cli_file_close(&r->motion, error) && cli_file_close(&r->scene, error) &&
           cli_file_keep(&r->wav, error) && cli_file_keep(&r->strokes, error) &&
           cli_file_keep(&r->motion, error) && cli_file_keep(&r->scene, error);
}

static void close_all(rendering *r)
{
    if (r->sound)
        sf_close(r->sound);
    scene_record_end(r->record, NULL);
    cli_file_drop(&r->wav);
    cli_file_drop(&r->strokes);
    cli_file_drop(&r->motion);
    cli_file_drop(&r->scene);
    free(r->struck.row);
    motion_table_free(r->rows);
    himc_performance_free(r->performance);
}

static bool open_performance(rendering *r, job *wanted, himc_error *error)
{
    himc_performance_config config = himc_performance_default();
    config.sample_rate = wanted->rate;
    if (config.physics_rate > wanted->rate)
        config.physics_rate = wanted->rate;
    r->performance = himc_performance_new(&config, error);
    if (!r->performance || !prepare(r->performance, wanted, error))
        return false;
    cli_unwatch(r->performance);
    return true;
}

static bool open_record(rendering *r, const job *wanted, FILE *stream, const char *name,
                        bool captured, himc_error *error)
{
    scene_record_config config = {.performance = r->performance,
                                  .stream = stream,
                                  .source = wanted->source,
                                  .name = name ? name : "himc",
                                  .rate = wanted->rate,
                                  .channels = r->channels,
                                  .captured = captured};
    r->record = scene_record_begin(&config, error);
    himc_performance_on_tick(r->performance, r->record ? scene_record_tick : NULL, r->record);
    return r->record != NULL;
}

// plays the same once more by another pipeline, as long, into the scene of `r`
static bool play_other(rendering *r, job *wanted, const char *mode, himc_error *error)
{
    rendering other = {0};
    FILE *file = tmpfile();
    bool good = file || himc_error_set(error, "no temporary file: %s", strerror(errno));
    good = good && open_performance(&other, wanted, error) &&
           cli_tell(other.performance, "mode", mode, error) &&
           open_record(&other, wanted, file, mode, false, error);
    if (good) {
        himc_performance_on_motion(other.performance, take_row, &other);
        while (other.ending.samples < r->ending.samples) {
            uint64_t left = r->ending.samples - other.ending.samples;
            play_block(&other, left < (uint64_t)wanted->block ? (int)left : wanted->block);
        }
        good = scene_record_end(other.record, error);
        other.record = NULL;
    }
    if (good)
        scene_record_more(r->record, file);
    close_all(&other);
    if (file)
        fclose(file);
    return good;
}

static bool compare(rendering *r, job *wanted, himc_error *error)
{
    const char *const *value = wanted->arguments->value, *own = value[MODE] ? value[MODE] : "himc";
    for (int i = 0; value[COMPARE] && i < CAPTURED; i++)
        if (lists(value[COMPARE], others[i]) && strcmp(others[i], own) != 0 &&
            !play_other(r, wanted, others[i], error))
            return false;
    return true;
}

static bool open_all(rendering *r, job *wanted, const char *const *value, himc_error *error)
{
    r->channels = wanted->channels;
    if (!open_performance(r, wanted, error) || !open_sound(r, value[OUT], wanted, error) ||
        !cli_file_open(&r->strokes, value[STROKES], error) ||
        !cli_file_open(&r->motion, value[MOTION], error) ||
        !cli_ending_is("--scene", value[SCENE], ".himc", error) ||
        !cli_file_open(&r->scene, value[SCENE], error))
        return false;
    const char *compare = value[COMPARE];
    if (r->scene.stream && !open_record(r, wanted, r->scene.stream, value[MODE],
                                        compare && lists(compare, others[CAPTURED]), error))
        return false;
    if (r->motion.stream) {
        r->rows = motion_table_new(r->motion.stream, motion_table_format_of(value[MOTION]),
                                   value[COLUMNS], error);
        if (!r->rows)
            return false;
    }
    if (r->rows || r->record)
        himc_performance_on_motion(r->performance, take_row, r);
    return true;
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    rendering r = {0};
    job wanted;
    if (arguments->list) {
        motion_table_help(stdout, getenv("HIMC_MARKDOWN") != NULL);
        return cli_finish(&cli_render);
    }
    if (!read_job(arguments, &wanted, &error))
        return cli_fail(&cli_render, "%s", error.text);
    if (!open_all(&r, &wanted, arguments->value, &error)) {
        close_all(&r);
        return cli_fail(&cli_render, "%s", error.text);
    }
    double elapsed = play(&r, &wanted), seconds = (double)r.ending.samples / wanted.rate;
    himc_performance_stats stats = himc_performance_measure(r.performance);
    bool good = compare(&r, &wanted, &error) && keep_files(&r, &wanted, &error) &&
                himc_performance_end_recording(r.performance, &error),
         piped = cli_is_standard(r.wav.path) || cli_is_standard(r.strokes.path) ||
                 cli_is_standard(r.motion.path),
         json = arguments->value[JSON] || !isatty(STDOUT_FILENO);
    double peak = r.ending.peak;
    close_all(&r);
    if (!good)
        return cli_fail(&cli_render, "%s", error.text);
    if (peak > 1 && sound_file_clips(arguments->value[OUT]))
        cli_say("note: the sound is cut off where it is too loud for this format, by up to %.1f dB "
                "(--set \"gain %.0f\")\n",
                20 * log10(peak), floor(-20 * log10(peak)));
    render_report(&stats, seconds, seconds / elapsed, !json ? NULL : piped ? stderr : stdout);
    return cli_finish(&cli_render);
}

const cli_call cli_render = {
    "render",
    "SOURCE",
    " -o OUT.wav",
    "plays a score, MIDI, MusicXML or a take," HIMC_TAKE_SUFFIXES ", into a sound file",
    "SOURCE - is the standard input. The last line on standard output (standard error, if a file is\n"
    "-) is one JSON object, unless it is a terminal: seconds strokes played missed tip_rms_mm tip_rms_percent\n"
    " peak_force_n realtime_factor unplanned_contacts longest_contact_s moved moved_max_mm\n"
    "captured_rms_mm captured_rms_percent captured_max_mm captured_max_percent captured_speed_ratio\n"
    "peak_rate_rad_s peak_rate_joint peak_torque_n_m peak_torque_joint. A score that makes no drum is played on\n"
    "\"kettle\", 26 inches.",
    options,
    run,
};
