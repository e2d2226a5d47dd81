/// lesson.c: `himc lesson`: a take compared with a score, stroke by stroke.
///
/// The asked strokes are those of a performance that plays the score; the played ones are the
/// strikes of the take.
#include "lesson.h"

#include "base/head_frame.h"
#include "capture/take.h"
#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FASTEST 12.0 // (m/s) chosen: of drummers' tips about 10 are measured
// of the model, in half the time of 8 kHz; speeds differ by 0.1 dB and less, planned times do not
#define PHYSICS "rate physics 2000"

// the hand that the score names for a stroke; the model may play it by the other
static himc_hand named_hand(const himc_score *score, const himc_strike *s)
{
    himc_hand hand = s->hand;
    int at_once = 0;
    for (int i = 0; i < score->stroke_count; i++) {
        const himc_stroke *of = &score->strokes[i];
        if (fabs(of->beat - s->beat) > 1e-6)
            continue;
        if (of->hand == s->hand || of->ornament != HIMC_PLAIN)
            return s->hand;
        hand = of->hand;
        at_once++;
    }
    return at_once == 1 ? hand : s->hand;
}

// where a stroke is in its bar
static void find_bar(const himc_score *score, lesson_asked *a)
{
    himc_bars bars = {.beat = 1, .beats = 4, .unit = 4};
    for (int i = 0; i < score->bar_count; i++)
        if (i == 0 || score->bars[i].beat <= a->beat + 1e-6)
            bars = score->bars[i];
    double length = 4.0 * bars.beats / bars.unit, since = fmod(a->beat - bars.beat + 1e-6, length);
    a->in_bar = 1 + (since < 0 ? since + length : since) - 1e-6;
    a->metre = (int)ceil(length);
}

static bool keep_asked(lesson *l, himc_performance *p, const himc_score *score,
                       const himc_event *event, himc_error *error)
{
    const himc_strike *s = &event->strike;
    bool strike = event->kind == HIMC_EVENT_STRIKE || event->kind == HIMC_EVENT_MISSED;
    if (!strike || !isfinite(s->beat) || !isfinite(s->planned_time) || s->hand >= HIMC_HANDS)
        return true;
    for (int k = 0; k < l->rolls; k++) // its own strokes are the player's choice
        if (s->beat >= l->roll[k].from - 1e-6 && s->beat < l->roll[k].to - 1e-6)
            return true;
    if (l->asked_count == LESSON_MOST)
        return himc_error_set(error, "%s: more than %d strokes", l->score, LESSON_MOST);
    himc_drum *drum = NULL;
    for (int i = 0;
         (drum = himc_performance_drum(p, i)) && strcmp(himc_drum_name(drum), s->drum) != 0;)
        i++;
    lesson_asked a = {.beat = s->beat,
                      .time = s->planned_time,
                      .hand = named_hand(score, s),
                      .by = -1,
                      .speed = event->kind == HIMC_EVENT_STRIKE ? s->velocity : NAN};
    find_bar(score, &a);
    snprintf(a.nuance, sizeof a.nuance, "%s", s->nuance);
    snprintf(a.drum, sizeof a.drum, "%s", s->drum);
    a.x = drum ? himc_head_frame_to_world(himc_drum_head_frame(drum), s->planned_x, s->planned_y)
               : himc_vec3_make(s->planned_x, s->planned_y, 0);
    int k = l->asked_count++;
    for (; k > 0 && l->asked[k - 1].time > a.time; k--)
        l->asked[k] = l->asked[k - 1];
    l->asked[k] = a;
    return true;
}

// fills the rolls, in beats; ask() makes seconds of them
static bool find_rolls(lesson *l, const himc_score *score, himc_error *error)
{
    for (int i = 0; i < score->stroke_count; i++) {
        const himc_stroke *s = &score->strokes[i];
        if (s->ornament >= HIMC_ROLL_SINGLE && l->rolls == LESSON_ROLLS / 2)
            return himc_error_set(error, "%s: more than %d rolls", l->score, LESSON_ROLLS / 2);
        if (s->ornament >= HIMC_ROLL_SINGLE)
            l->roll[l->rolls++] = (lesson_roll){
                .beat = s->beat, .from = s->beat, .to = s->beat + s->length, .written = true};
    }
    l->bpm = score->tempi[0].bpm;
    for (int i = 1; i < score->tempo_count && score->stroke_count; i++)
        if (score->tempi[i].beat <= score->strokes[0].beat)
            l->bpm = score->tempi[i].bpm;
    return true;
}

static bool play_score(lesson *l, himc_performance *p, const himc_score *score, double most,
                       himc_error *error)
{
    himc_event event = {.kind = HIMC_EVENT_BEAT};
    bool good = cli_tell(p, "mode ik", NULL, error) && cli_tell(p, PHYSICS, NULL, error) &&
                cli_tell(p, "human 0", NULL, error) && cli_tell(p, "loop 0", NULL, error) &&
                cli_tell(p, "play", NULL, error);
    for (uint64_t n = 0; good && event.kind != HIMC_EVENT_DONE && (double)n < most * LESSON_RATE;
         n += LESSON_BLOCK) {
        himc_performance_process(p, LESSON_BLOCK, NULL);
        while (good && event.kind != HIMC_EVENT_DONE && himc_performance_event(p, &event))
            good = keep_asked(l, p, score, &event, error);
    }
    return good;
}

static bool ask(lesson *l, himc_error *error)
{
    himc_score *score = himc_score_load(l->score, error);
    if (!score)
        return false;
    double last = 0;
    for (int i = 0; i < score->stroke_count; i++)
        last = fmax(last, score->strokes[i].beat + score->strokes[i].length);
    int asked = score->stroke_count;
    bool good = find_rolls(l, score, error);
    if (good && l->seen[0] && l->seen[1] && asked > 8 * l->count) // to play a long one takes long
        good = himc_error_set(error,
                              "%s does not match %s: %d strokes found, of %d strokes and rolls, "
                              "expected an eighth",
                              l->take, l->score, l->count, asked);
    last = himc_score_seconds(score->tempi, score->tempo_count, last);
    himc_performance *p = good ? cli_load(l->score, LESSON_RATE, NULL, error) : NULL;
    l->asked = malloc(LESSON_MOST * sizeof *l->asked);
    good = p && (l->asked || himc_error_set(error, "out of memory")) &&
           play_score(l, p, score, last + 30, error);
    if (good && !l->asked_count)
        good = himc_error_set(error, "%s: no strokes beside rolls, expected some to compare",
                              l->score);
    // a stroke that the model could not play has the speed of the next, else of the last
    for (int k = l->asked_count - 2; good && k >= 0; k--)
        if (!isfinite(l->asked[k].speed))
            l->asked[k].speed = l->asked[k + 1].speed;
    for (int k = 1; good && k < l->asked_count; k++)
        if (!isfinite(l->asked[k].speed))
            l->asked[k].speed = l->asked[k - 1].speed;
    if (good && !isfinite(l->asked[0].speed))
        good = himc_error_set(error, "%s: the model can play none of its strokes", l->score);
    for (int k = 0; good && k < l->rolls; k++) { // the first beat may wait for the first stroke
        const lesson_asked *a = &l->asked[0];
        double delay = a->time - himc_score_seconds(score->tempi, score->tempo_count, a->beat);
        lesson_roll *r = &l->roll[k];
        r->from = delay + himc_score_seconds(score->tempi, score->tempo_count, r->from);
        r->to = delay + himc_score_seconds(score->tempi, score->tempo_count, r->to);
    }
    himc_performance_free(p);
    himc_score_free(score);
    return good;
}

// height before a stroke, and the path of its fall
static void follow_tip(const lesson *l, const himc_take_tip *tip, int from, lesson_played *p)
{
    int frame = p->strike.frame, top = from;
    for (int k = from; k <= frame; k++)
        if (tip->x[k].z >= tip->x[top].z)
            top = k;
    p->top = top;
    p->height = tip->x[top].z - p->strike.x.z;
    for (int k = top; k < frame; k++)
        p->path += himc_vec3_length(himc_vec3_sub(tip->x[k + 1], tip->x[k]));
    // a time is uniform within a frame. Of generated takes with 0.3 mm of noise (lesson_takes.py)
    // speeds are off by 0.3 dB; falls of few frames by up to 2 dB in 8 frames and 4 dB in 5
    double frames = 2 * fmax(p->height, 0.02) / p->strike.velocity * l->rate;
    p->u_time = 1 / (l->rate * sqrt(12));
    p->u_level = hypot(0.3, 60 / (frames * frames));
}

// where the take does not show a stick
static bool find_gaps(lesson *l, const himc_take *take, const himc_take_tip tips[HIMC_HANDS])
{
    int frames = himc_take_frames(take);
    l->gap = malloc(((size_t)frames * HIMC_HANDS + 1) * sizeof *l->gap);
    for (int h = 0; l->gap && h < HIMC_HANDS; h++)
        for (int k = 0, from = -1; tips[h].present && k <= frames; k++) {
            bool lost = k < frames && !isfinite(himc_take_point(take, k, tips[h].point).z);
            if (lost && from < 0)
                from = k;
            if (lost || from < 0)
                continue;
            l->gap[l->gaps++] = (lesson_gap){(himc_hand)h, (from - 1) / l->rate, k / l->rate};
            from = -1;
        }
    return l->gap;
}

static bool hear(lesson *l, himc_take *take, const himc_take_options *options, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_strike_survey seen;
    int from[HIMC_HANDS] = {0, 0}, fast = 0;
    if (!himc_take_tips(take, options, tips, error))
        return himc_take_name_error(l->take, error);
    if (!himc_take_strikes(take, tips, &seen))
        return himc_error_set(error, "out of memory");
    l->rate = himc_take_rate(take);
    l->played = calloc((size_t)seen.count + 1, sizeof *l->played);
    for (int h = 0; h < HIMC_HANDS; h++)
        l->seen[h] = tips[h].present;
    bool good = find_gaps(l, take, tips);
    if (seen.count > LESSON_MOST)
        cli_say("note: %s: %d strikes, the first %d are used\n", l->take, seen.count, LESSON_MOST);
    for (int k = 0; l->played && k < seen.count && k < LESSON_MOST; k++) {
        lesson_played *p = &l->played[l->count++];
        fast += seen.strikes[k].velocity > FASTEST;
        *p = (lesson_played){.strike = seen.strikes[k],
                             .of = -1,
                             .roll = -1,
                             .off = NAN,
                             .steady = NAN,
                             .level = NAN,
                             .aside = {NAN, NAN, NAN},
                             .share = {NAN, NAN, NAN, NAN},
                             .torque = {NAN, NAN, NAN},
                             .raised = NAN};
        follow_tip(l, &tips[p->strike.hand], from[p->strike.hand], p);
        from[p->strike.hand] = p->strike.frame;
    }
    if (seen.count > 0 && 2 * fast > seen.count)
        cli_say("note: %s: most strikes are faster than %g m/s, expected slower ones: is its unit "
                "of length right?\n",
                l->take, FASTEST);
    l->length = seen.count ? seen.strikes[seen.count - 1].time - seen.strikes[0].time : 0;
    free(seen.strikes);
    return ((l->played && good) || himc_error_set(error, "out of memory")) &&
           (l->count ||
            himc_error_set(error, "%s: no strikes found in the tips: do --up and its unit fit?",
                           l->take));
}

enum { OUT, CSV, SCENE, JSON, TAKE };
static const cli_option options[] = {
    {"output", 'o', "PAGE.html", "the page; needs no server and no network"},
    {"csv", 0, "F.csv", "a row for each stroke: asked, played, missing"},
    {"scene", 0, "F.himc",
     "the take and, as a ghost in the same body, the model that plays the score"},
    {"json", 0, NULL, "figures and faults as one JSON object on standard output"},
    CLI_TAKE_OPTIONS,
    {0},
};

// what the reader doubted or repaired: units, gaps
static void tell_note(void *user, const char *line)
{
    const lesson *l = user;
    if (!strncmp(line, "note: ", 6))
        cli_say("note: %s: %s\n", l->take, line + 6);
}

static bool read_sources(lesson *l, const cli_arguments *arguments, himc_error *error)
{
    himc_take_options how;
    if (!cli_is_take(l->take))
        return himc_error_set(error, "%s: expected a take," HIMC_TAKE_SUFFIXES, l->take);
    if (cli_is_take(l->score))
        return himc_error_set(error, "%s: expected a score, not a take", l->score);
    if (!cli_take_options(l->take, arguments->value + TAKE, &how, error))
        return false;
    himc_take *take = himc_take_load(l->take, &how, error);
    bool good = take && hear(l, take, &how, error) && ask(l, error) && lesson_match(l, error) &&
                lesson_judge(l, error);
    if (good) {
        himc_take_describe(take, &how, tell_note, l);
        lesson_body(l, take, &how);
    }
    himc_take_free(take);
    return good;
}

static bool write_scene(const lesson *l, const cli_arguments *arguments, cli_file *file,
                        himc_error *error)
{
    himc_take_options how;
    return !l->scene || (cli_take_options(l->take, arguments->value + TAKE, &how, error) &&
                         cli_file_open(file, l->scene, error) &&
                         lesson_scene(l, &how, file->stream, error) && cli_file_close(file, error));
}

// all files, or none
static bool write_files(const lesson *l, const cli_arguments *arguments, himc_error *error)
{
    cli_file scene = {0}, page = {0}, csv = {0};
    bool good = write_scene(l, arguments, &scene, error) &&
                cli_draft(&page, arguments->value[OUT], lesson_page, l, error) &&
                cli_draft(&csv, arguments->value[CSV], lesson_csv, l, error) &&
                cli_file_keep(&scene, error) && cli_file_keep(&page, error) &&
                cli_file_keep(&csv, error);
    cli_file_drop(&scene);
    cli_file_drop(&page);
    cli_file_drop(&csv);
    return good;
}

static void tell(const lesson *l)
{
    double seconds, decibels;
    lesson_scatter(l, &seconds, &decibels);
    printf("%d of %d strokes matched, %.1f BPM, %.1f ms and %.1f dB off (RMS)\n", l->matched,
           l->due, l->bpm * l->tempo.mean, 1e3 * seconds, decibels);
    for (int h = 0; h < HIMC_HANDS; h++)
        if (!l->seen[h])
            printf("the take does not show the %s stick\n", himc_hand_name((himc_hand)h));
    for (int k = 0; k < l->faults && k < LESSON_NAMED; k++)
        printf("%d. %s\n", k + 1, l->fault[k].what);
    if (!l->faults)
        puts("nothing stands out");
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    const char *const *value = arguments->value;
    lesson *l = calloc(1, sizeof *l);
    bool good =
        l && (value[OUT] || himc_error_set(&error, "no -o PAGE.html given (himc lesson --help)"));
    if (good) {
        l->score = cli_input(arguments->operand, &error);
        l->take = arguments->second;
        l->scene = value[SCENE];
        const char *const files[] = {l->score, l->take, value[OUT], value[CSV]};
        good = l->score && cli_ending_is("-o", value[OUT], ".html", &error) &&
               cli_ending_is("--csv", value[CSV], ".csv", &error) &&
               cli_ending_is("--scene", l->scene, ".himc", &error) &&
               cli_apart(value[OUT], files, 2, &error) && cli_apart(value[CSV], files, 3, &error) &&
               cli_apart(l->scene, files, 4, &error) && read_sources(l, arguments, &error) &&
               write_files(l, arguments, &error);
    }
    bool piped = cli_is_standard(value[OUT]) || cli_is_standard(value[CSV]);
    if (good && value[JSON])
        lesson_json(l, piped ? stderr : stdout);
    else if (good && !piped)
        tell(l);
    if (l) {
        free(l->asked);
        free(l->played);
        free(l->gap);
        free(l);
    }
    return good ? cli_finish(&cli_lesson)
                : cli_fail(&cli_lesson, "%s", l ? error.text : "out of memory");
}

const cli_call cli_lesson = {
    "lesson",
    "SCORE TAKE",
    " -o PAGE.html",
    "compares a take with a score: time, loudness, place, what to practise",
    "TAKE is a motion capture," HIMC_TAKE_SUFFIXES
    ", of which the tips of the sticks suffice. Its\n"
    "tempo and its beginning are free. The page opens in any browser, fits a phone and can be printed.",
    options,
    run,
};
