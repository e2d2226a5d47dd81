/// evaluate_take.c: own captures under each controller, compared with the captures themselves.
///
/// As in the published comparison (trial.c), the player's measures, mean posture and joint limits
/// come from the take; the posture regression, the null-space target of `himc`, from the other
/// takes that show a whole arm and strike a head if this one does, or do not either: leave one out.
/// (An arm that reaches teaches a stroke worse than the built-in one, learned from strokes.)
/// Without such a take it is the built-in one, and a line says so. Under the `printed` law `himc`
/// has no null-space target, as published. A capture has its own noise and its own body, so none is
/// added, and a take is played once.
#include "evaluate_take.h"
#include "capture/take.h"
#include "control/posture_regression.h"
#include "performance/research.h"
#include "pool.h"
#include "trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000                     // sample rate (Hz)
#define BLOCK 64                       // (samples)
#define KINDS (1 + 2 * HIMC_LAW_COUNT) // ik; id and himc under each law
#define LEARNED 16 // other takes that a regression is learned from, at most; chosen

typedef struct own_result {
    double rms, most;       ///< to the capture (m)
    double height, percent; ///< of the captured strokes (m); rms of it (%)
    double elbow;           ///< range of the elbows' height, simulated / captured
    int strokes, played;
    bool arm;     ///< the take shows a whole one
    bool learned; ///< the regression comes from the other takes
} own_result;

typedef struct own_takes {
    const char *const *path;
    int count;
    const himc_take_options *options;
    own_result *result; ///< (count x KINDS)
} own_takes;

static trial_kind kind_of(int k)
{
    static const himc_pipeline controller[] = {HIMC_PIPELINE_ID, HIMC_PIPELINE_HIMC};
    if (k == 0)
        return (trial_kind){.controller = HIMC_PIPELINE_IK};
    return (trial_kind){.controller = controller[(k - 1) / HIMC_LAW_COUNT],
                        .law = (himc_law)((k - 1) % HIMC_LAW_COUNT)};
}

/// The first of the names, separated by commas, that the take has, in `name`; NULL if it has none.
static const char *choose_name(const himc_take *take, const char *names, char name[64])
{
    while (names && *names) {
        size_t length = strcspn(names, ",");
        snprintf(name, 64, "%.*s", (int)length, names);
        if (himc_take_find(take, name) >= 0)
            return name;
        names += length + (names[length] == ',');
    }
    return NULL;
}

typedef struct opened {
    himc_take *take;
    himc_player *player;
    himc_take_options options;
    char name[HIMC_HANDS][64];
    bool strikes; ///< strikes are seen in the tips
} opened;

static void close_take(opened *o)
{
    himc_player_free(o->player);
    himc_take_free(o->take);
}

static bool find_strikes(opened *o, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    int count = 0;
    if (!himc_take_tips(o->take, &o->options, tips, error))
        return false;
    free(himc_take_find_strikes(o->take, tips, &count));
    o->strikes = count > 0;
    return true;
}

static bool open_take(const own_takes *own, int file, opened *o, himc_error *error)
{
    himc_skeleton_config given = himc_skeleton_default();
    himc_take_options plain = *own->options;
    plain.left_tip = plain.right_tip = NULL;
    *o = (opened){.take = himc_take_load(own->path[file], &plain, error)};
    if (!o->take)
        return false;
    o->options = plain;
    o->options.left_tip = choose_name(o->take, own->options->left_tip, o->name[HIMC_LEFT]);
    o->options.right_tip = choose_name(o->take, own->options->right_tip, o->name[HIMC_RIGHT]);
    himc_take_free(o->take); // the tips decide where the take faces
    o->take = himc_take_load(own->path[file], &o->options, error);
    o->player = o->take ? himc_player_new(o->take, &o->options, &given, error) : NULL;
    if (o->player && find_strikes(o, error))
        return true;
    close_take(o);
    return himc_take_name_error(own->path[file], error);
}

static bool shows_arm(const himc_player *player, int hand)
{
    return player->pose && !player->walks &&
           himc_player_known_arm(player, (himc_hand)hand) == HIMC_ARM_JOINTS;
}

static bool shows_any_arm(const himc_player *player)
{
    return shows_arm(player, HIMC_LEFT) || shows_arm(player, HIMC_RIGHT);
}

/// Learns from the other takes that show a whole arm, of strokes if `strikes`, else of other
/// motion. `learned` false without one.
static bool learn_from_others(const own_takes *own, int unseen, bool strikes,
                              himc_posture_regression *regression, bool *learned, himc_error *error)
{
    opened other[LEARNED];
    himc_skeleton skeleton[LEARNED];
    himc_posture_regression_take take[LEARNED];
    int count = 0;
    bool good = true;
    for (int i = 0; good && i < own->count && count < LEARNED; i++) {
        opened *o = &other[count];
        if (i == unseen)
            continue;
        good = open_take(own, i, o, error);
        const himc_player *p = good ? o->player : NULL;
        if (!p || !shows_any_arm(p) || o->strikes != strikes) {
            if (p)
                close_take(o);
            continue;
        }
        good = himc_skeleton_init(&skeleton[count], &p->config, error);
        take[count] = (himc_posture_regression_take){
            .skeleton = &skeleton[count],
            .pose = p->pose,
            .frames = p->frames,
            .rate = himc_take_rate(o->take),
            .unseen_arm = {!shows_arm(p, HIMC_LEFT), !shows_arm(p, HIMC_RIGHT)},
            .unseen_trunk = !p->known[HIMC_TRUNK - 1]};
        count++;
    }
    *learned = good && count > 0;
    good = good && (!count || himc_posture_regression_learn(regression, take, count, error));
    while (count > 0)
        close_take(&other[--count]);
    return good;
}

/// Gives `p` the regression of the other takes, fitted to this player.
static bool use_others(himc_performance *p, const own_takes *own, int file, const opened *o,
                       bool *learned, himc_error *error)
{
    himc_posture_regression regression;
    himc_skeleton skeleton;
    *learned = false;
    if (!shows_any_arm(o->player))
        return true; // this player's means are not known
    if (!learn_from_others(own, file, o->strikes, &regression, learned, error))
        return false;
    if (!*learned)
        return true;
    himc_posture_regression_take one = {
        .skeleton = &skeleton,
        .pose = o->player->pose,
        .frames = o->player->frames,
        .rate = himc_take_rate(o->take),
        .unseen_arm = {!shows_arm(o->player, HIMC_LEFT), !shows_arm(o->player, HIMC_RIGHT)},
        .unseen_trunk = !o->player->known[HIMC_TRUNK - 1]};
    if (!himc_skeleton_init(&skeleton, &o->player->config, error) ||
        !himc_posture_regression_fit(&regression.player, &one, 1, error))
        return false;
    himc_performance_set_posture_regression(p, &regression);
    return true;
}

/// The elbows' heights while the take plays.
typedef struct elbows {
    double begin, end; ///< of the take (s)
    double low[HIMC_HANDS], high[HIMC_HANDS];
} elbows;

static void see_elbows(void *user, const himc_motion_row *row)
{
    elbows *e = user;
    for (int hand = 0; hand < HIMC_HANDS && row->time >= e->begin && row->time <= e->end; hand++) {
        e->low[hand] = fmin(e->low[hand], row->elbow[hand].z);
        e->high[hand] = fmax(e->high[hand], row->elbow[hand].z);
    }
}

static elbows no_elbows(double length)
{
    return (elbows){.begin = HIMC_APPROACH,
                    .end = HIMC_APPROACH + length,
                    .low = {INFINITY, INFINITY},
                    .high = {-INFINITY, -INFINITY}};
}

/// Ranges of the hands whose arms the take shows, simulated over captured; NAN without one.
static double elbow_ratio(const elbows *e, const himc_player *player)
{
    himc_skeleton skeleton;
    himc_body_state state;
    double captured = 0, simulated = 0;
    if (!player->pose || !himc_skeleton_init(&skeleton, &player->config, NULL))
        return NAN;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; shows_arm(player, hand) && i < player->frames; i++) {
            himc_pose_to_state(&skeleton, &player->pose[i], NULL, &state);
            low = fmin(low, state.origin[HIMC_LEFT_FOREARM + hand].z);
            high = fmax(high, state.origin[HIMC_LEFT_FOREARM + hand].z);
        }
        captured += high > low ? high - low : 0;
        simulated += high > low ? e->high[hand] - e->low[hand] : 0;
    }
    return captured > 0 ? simulated / captured : NAN;
}

/// Mean height of the captured strokes, from the highest place since the hand's last strike to the
/// head; 0 without strikes, NaN without memory. As in the published comparison, and so the same
/// under each controller.
static double captured_amplitude(himc_take *take, const himc_take_options *options)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_strike_survey seen;
    int from[HIMC_HANDS] = {0, 0};
    double sum = 0;
    if (!himc_take_tips(take, options, tips, NULL) || !himc_take_strikes(take, tips, &seen))
        return NAN;
    for (int i = 0; i < seen.count; i++) {
        const himc_take_strike *s = &seen.strikes[i];
        double head = seen.head[s->head].z, top = head;
        for (int k = from[s->hand]; k < s->frame; k++)
            top = fmax(top, tips[s->hand].x[k].z);
        sum += top - head;
        from[s->hand] = s->frame;
    }
    free(seen.strikes);
    return seen.count > 0 ? sum / seen.count : 0;
}

static void play(himc_performance *p)
{
    himc_event event = {.kind = HIMC_EVENT_BEAT};
    while (event.kind != HIMC_EVENT_DONE) {
        himc_performance_process(p, BLOCK, NULL);
        while (event.kind != HIMC_EVENT_DONE && himc_performance_event(p, &event)) {
        }
    }
}

static bool play_take(himc_performance *p, const own_takes *own, int file, const trial_kind *kind,
                      opened *o, own_result *result, himc_error *error)
{
    trial_config config = {.kind = *kind, .gain = 1, .limits = o->player->pose != NULL};
    himc_performance_take_options(p, &o->options);
    if (!cli_add_drum(p, RATE, error) ||
        !himc_performance_play_player(p, o->take, o->player, own->path[file], error) ||
        !trial_set_control(p, &config, error))
        return false;
    if (kind->controller == HIMC_PIPELINE_HIMC && kind->law != HIMC_LAW_PRINTED &&
        !use_others(p, own, file, o, &result->learned, error))
        return false;
    elbows seen = no_elbows(himc_take_frames(o->take) / himc_take_rate(o->take));
    himc_performance_on_motion(p, see_elbows, &seen);
    if (!cli_tell(p, "play", NULL, error))
        return false;
    play(p);
    himc_performance_stats s = himc_performance_measure(p);
    result->rms = s.captured_rms;
    result->most = s.captured_most;
    result->height = captured_amplitude(o->take, &o->options);
    result->percent = result->height > 0 ? 100 * result->rms / result->height : NAN;
    result->arm = shows_any_arm(o->player);
    result->strokes = s.strokes;
    result->played = s.played;
    result->elbow = elbow_ratio(&seen, o->player);
    return true;
}

static bool work(void *user, int item, void *result, himc_error *error)
{
    const own_takes *own = user;
    opened o;
    trial_kind kind = kind_of(item % KINDS);
    himc_performance_config config = himc_performance_default();
    config.sample_rate = RATE;
    memset(result, 0, sizeof(own_result));
    if (!open_take(own, item / KINDS, &o, error))
        return false;
    himc_performance *p = himc_performance_new(&config, error);
    bool good = p && play_take(p, own, item / KINDS, &kind, &o, result, error);
    himc_performance_free(p);
    close_take(&o);
    return good;
}

static bool done(void *user, int item, const void *result, himc_error *error)
{
    own_takes *own = user;
    (void)error;
    memcpy(&own->result[item], result, sizeof(own_result));
    if (cli_shows_progress())
        fprintf(stderr, "\r%s, %d of %d\033[K\r", own->path[item / KINDS], item % KINDS + 1, KINDS);
    return true;
}

static void put_number(FILE *stream, bool json, const char *key, double value, double factor)
{
    if (json)
        fprintf(stream, ", \"%s\": ", key);
    else
        fputc(',', stream);
    if (isfinite(value))
        fprintf(stream, "%.6g", factor * value);
    else
        fputs(json ? "null" : "nan", stream);
}

static void print_row(const own_takes *own, int item, bool json, FILE *stream)
{
    const own_result *r = &own->result[item];
    trial_kind kind = kind_of(item % KINDS);
    if (json) {
        fputs(item ? ",\n  {\"take\": " : "[\n  {\"take\": ", stream);
        cli_put_json_text(stream, own->path[item / KINDS]);
        fprintf(stream, ", \"controller\": \"%s\", \"law\": \"%s\"",
                trial_controller_name(kind.controller).text, trial_law_name(&kind).text);
    } else {
        fprintf(stream, "%s,%s,%s", own->path[item / KINDS],
                trial_controller_name(kind.controller).text, trial_law_name(&kind).text);
    }
    put_number(stream, json, "strokes", r->strokes, 1);
    put_number(stream, json, "played", r->played, 1);
    put_number(stream, json, "rms_mm", r->rms, 1e3);
    put_number(stream, json, "max_mm", r->most, 1e3);
    put_number(stream, json, "amplitude_mm", r->height, 1e3);
    put_number(stream, json, "rms_percent", r->percent, 1);
    put_number(stream, json, "elbow_range_ratio", r->elbow, 1);
    fputs(json ? "}" : "\n", stream);
}

#define BAR 16     // width (pixels)
#define GROUP 150  // of a take
#define HIGH 240   // of the axis
#define DECADES 6  // of the axis, from 0.001 % to 1000 %
#define LEAST 1e-3 // (%)

// errors in percent of the strokes' height, or in mm where the take has no strokes, as bars on a
// logarithmic axis: figure 6b of the 2012 paper for own takes
static void draw(const own_takes *own, FILE *out)
{
    static const char *const colour[] = {"#999",    "#9ecae1", "#4292c6", "#084594",
                                         "#fdbe85", "#fd8d3c", "#a63603"};
    enum { colours = sizeof colour / sizeof *colour };
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "font-family=\"sans-serif\" font-size=\"11\">\n",
            220 + GROUP * own->count, HIGH + 60);
    for (int decade = 0; decade <= DECADES; decade++) {
        int y = 20 + HIGH - HIGH * decade / DECADES;
        fprintf(out,
                "<path d=\"M50 %dH%d\" stroke=\"#ddd\"/><text x=\"45\" y=\"%d\" "
                "text-anchor=\"end\">%g</text>\n",
                y, 60 + GROUP * own->count, y + 4, LEAST * pow(10, decade));
    }
    for (int i = 0; i < own->count * KINDS; i++) {
        const own_result *r = &own->result[i];
        double value = isfinite(r->percent) ? r->percent : 1e3 * r->rms;
        double high = fmin(fmax(log10(value / LEAST) / DECADES, 0), 1) * HIGH;
        fprintf(out, "<rect x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\" fill=\"%s\"/>\n",
                60 + GROUP * (i / KINDS) + BAR * (i % KINDS), 20 + HIGH - high, BAR - 2, high,
                colour[i % KINDS % colours]);
        if (i % KINDS == 0)
            fprintf(out, "<text x=\"%d\" y=\"%d\">take %d, %s</text>\n", 60 + GROUP * (i / KINDS),
                    HIGH + 36, i / KINDS + 1, isfinite(r->percent) ? "%" : "mm");
    }
    for (int k = 0; k < KINDS; k++) {
        trial_kind kind = kind_of(k);
        fprintf(out, "<text x=\"%d\" y=\"%d\" fill=\"%s\">%s %s</text>\n", 75 + GROUP * own->count,
                40 + 18 * k, colour[k % colours], trial_controller_name(kind.controller).text,
                k ? trial_law_name(&kind).text : "");
    }
    fputs("</svg>\n", out);
}

// what the table does not explain
static void tell_why(const own_takes *own)
{
    for (int i = 0; i < own->count * KINDS; i++) {
        const own_result *r = &own->result[i];
        trial_kind kind = kind_of(i % KINDS);
        const char *path = own->path[i / KINDS];
        bool printed = kind.controller != HIMC_PIPELINE_IK && kind.law == HIMC_LAW_PRINTED;
        if (r->played < r->strokes)
            cli_say("note: %s: %s %s plays %d of %d strokes within 5 ms and 2 cm: its sticks stray "
                    "by up to %.0f mm%s\n",
                    path, trial_controller_name(kind.controller).text, trial_law_name(&kind).text,
                    r->played, r->strokes, 1e3 * r->most,
                    printed ? " (the law as published feeds nothing forward, so they lag)" : "");
        if (i % KINDS == KINDS - 1 && !r->learned)
            cli_say(
                "note: %s: himc moves the arms in its built-in posture, not in one learned from "
                "takes: %s\n",
                path,
                !r->arm ? "this take does not show a whole arm"
                        : "that needs one more take that shows a whole arm, with strokes if "
                          "this one has strokes, else without (--take A B)");
    }
}

bool evaluate_takes(const char *const *path, int count, const himc_take_options *options, int jobs,
                    bool json, FILE *stream, FILE *figure, himc_error *error)
{
    own_takes own = {.path = path, .count = count, .options = options};
    own.result = calloc((size_t)count * KINDS, sizeof *own.result);
    if (!own.result)
        return himc_error_set(error, "out of memory");
    pool workers = {count * KINDS, jobs, sizeof(own_result), work, done, &own};
    bool good = pool_run(&workers, error);
    if (good && !json)
        fputs("take,controller,law,strokes,played,rms_mm,max_mm,amplitude_mm,rms_percent,"
              "elbow_range_ratio\n",
              stream);
    for (int i = 0; good && i < count * KINDS; i++)
        print_row(&own, i, json, stream);
    if (good && json)
        fputs("\n]\n", stream);
    if (good && figure)
        draw(&own, figure);
    if (good)
        tell_why(&own);
    free(own.result);
    return good;
}
