/// lesson_page.c: the lesson as one HTML page, a CSV and a JSON object.
///
/// The page has no script and asks for nothing: inline SVG, whose pictures are narrow enough for a
/// telephone and stand side by side on a wide screen or on paper.
#include "lesson.h"

#include "cli.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#define SURE 1.96  // standard uncertainties of the 95 % that are shown
#define LINE 4.0   // time of a line of the timeline (s); chosen: strokes 5 to 30 mm apart
#define LINES 100  // of the timeline; chosen: the page stays below 4 MB
#define SHOWN 2500 // strokes in plots and table; chosen likewise
#define WIDE 360.0 // of a picture
#define LEFT 34.0  // of its axis
#define HIGH 110.0 // of a plot
#define NAMED " stroke=#c00 stroke-width=2" // of a stroke that a fault is about

/// A number of a played stroke: in the CSV, in the table of all strokes (`shown`), and as a mean of
/// each hand (`mean`); published figures beside the latter.
typedef struct column {
    const char *csv, *shown, *mean;
    size_t at;
    double scale;
    int digits;
    const char *published;
} column;

#define AT(field) offsetof(lesson_played, field)
static const column columns[] = {
    {"played_s", "played (s)", NULL, AT(strike.time), 1, 3, ""},
    {"off_beat_s", "off the beat (ms)", "After the beat (ms)", AT(off), 1e3, 1,
     "professionals with a metronome: hands 9 to 12 ms apart (Fujii et al. 2011)"},
    {"off_metronome_s", "off a metronome (ms)", NULL, AT(steady), 1e3, 1, ""},
    {"time_uncertainty_s", NULL, NULL, AT(u_time), 1, 5, ""},
    {"speed_m_s", "speed (m/s)", NULL, AT(strike.velocity), 1, 2, ""},
    {"level_db", "loudness (dB)", "Loudness about your mean (dB)", AT(level), 1, 1, ""},
    {"level_uncertainty_db", "± (dB)", NULL, AT(u_level), SURE, 1, ""},
    {"aside_x_m", "away (mm)", "Place, away from you (mm)", AT(aside.x), 1e3, 0, ""},
    {"aside_y_m", "to the left (mm)", "Place, to the left (mm)", AT(aside.y), 1e3, 0, ""},
    {"height_m", "height (mm)", "Height before the stroke (mm)", AT(height), 1e3, 0,
     "grows with the dynamic (Dahl 2004)"},
    {"path_m", "path (mm)", "Path of the fall (mm)", AT(path), 1e3, 0, ""},
    {"shoulder_share", NULL, "Shoulder's share of the fall (%)", AT(share[0]), 100, 0, ""},
    {"elbow_share", NULL, "Elbow's (%)", AT(share[1]), 100, 0, ""},
    {"wrist_share", NULL, "Wrist's and fingers' (%)", AT(share[2]), 100, 0, ""},
    {"trunk_share", NULL, "Trunk's (%)", AT(share[3]), 100, 0, ""},
    {"shoulder_torque_n_m", NULL, "Largest torque, shoulder (N m)", AT(torque[0]), 1, 1, ""},
    {"elbow_torque_n_m", NULL, "elbow (N m)", AT(torque[1]), 1, 1, ""},
    {"wrist_torque_n_m", NULL, "wrist (N m)", AT(torque[2]), 1, 1, ""},
    {"upper_arm_deg", NULL, "Upper arm at the stroke, from hanging (°)", AT(raised), 1, 0,
     "strained beyond 45° (RULA)"}};
#define COLUMNS (int)(sizeof columns / sizeof *columns)

static double number(const lesson_played *p, const column *c)
{
    return p ? *(const double *)(const void *)((const char *)p + c->at) : NAN;
}

static void put_text(FILE *out, const char *text)
{
    for (; *text; text++)
        fprintf(out, strchr("<>&\"'", *text) ? "&#%d;" : "%c", *text);
}

static void put_number(FILE *out, double x, int digits, const char *unknown)
{
    if (!isfinite(x))
        fputs(unknown, out);
    else // no -0
        fprintf(out, "%.*f", digits, fabs(x) < 0.5 * pow(10, -digits) ? 0 : x);
}

// of left and right, times a factor
static void put_both(const double of[HIMC_HANDS], double by, int digits, FILE *out)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        fputs("<td>", out);
        put_number(out, by * of[hand], digits, "");
    }
}

static void put_head(const lesson *l, FILE *out)
{
    const char *take = strrchr(l->take, '/'), *score = strrchr(l->score, '/');
    fputs(
        "<!DOCTYPE html><html lang=en><meta charset=utf-8>\n<meta name=viewport "
        "content='width=device-width,initial-scale=1'><title>Lesson</title><style>\n"
        "body{font:16px/1.45 sans-serif;color:#222;max-width:1100px;margin:auto;padding:12px}\n"
        "h1{font-size:1.4em}h2{font-size:1.15em;margin:1.6em 0 .4em}ol{padding-left:1.3em}\n"
        "li{margin:.7em 0}small{color:#555}.t{overflow-x:auto}.bad{background:#fde2e2}\n"
        ".g{display:grid;gap:10px;"
        "grid-template-columns:repeat(auto-fill,minmax(min(330px,100%),1fr))}\n"
        "svg{width:100%;background:#fafafa;break-inside:avoid}text{font-size:9px;fill:#444}\n"
        ".left{fill:#1864ab;color:#1864ab}.right{fill:#c2410c;color:#c2410c}\n"
        "table{border-collapse:collapse;font-size:.86em}td{white-space:nowrap}\n"
        "td,th{padding:2px 8px;text-align:right;border-bottom:1px solid #ddd;vertical-align:top}\n"
        "th:first-child,td:first-child,.p{text-align:left;white-space:normal;min-width:9em}\n"
        "@media print{body{font-size:11px;padding:0}.t{overflow:visible}tr{break-inside:avoid}}\n"
        "</style><h1>Lesson: ",
        out);
    put_text(out, take ? take + 1 : l->take);
    fputs(" <small>against</small> ", out);
    put_text(out, score ? score + 1 : l->score);
    fprintf(
        out,
        "</h1><p>%d of %d strokes found, %d missing, %d too many. Tempo %.1f ± %.1f BPM; the "
        "score has %g. On the whole you play %.1f dB %s than the model at the score's dynamics.",
        l->matched, l->due, l->missing, l->extra, l->bpm * l->tempo.mean,
        SURE * l->bpm * l->tempo.u, l->bpm, fabs(l->level), l->level < 0 ? "softer" : "louder");
    if (l->unseen)
        fprintf(out, " Where %d stroke%s due, the take has a gap: whether %s played is not known.",
                l->unseen, l->unseen > 1 ? "s are" : " is", l->unseen > 1 ? "they were" : "it was");
    if (l->apart)
        fputs(" The drums stand otherwise than in the score (<code>place</code>): places are "
              "measured on each drum alone, and a drum that is missed as a whole is not told.",
              out);
    for (int h = 0; h < HIMC_HANDS; h++)
        if (!l->seen[h])
            fprintf(out, " The take does not show the %s stick; its strokes are not judged.",
                    himc_hand_name((himc_hand)h));
}

static void put_sentence(const char *text, bool goes_on, FILE *out)
{
    fprintf(out, "%c%s. ", goes_on ? *text : toupper(*text), text + 1);
}

static void put_faults(const lesson *l, FILE *out)
{
    fputs("</p><h2>Practise first</h2><ol>", out);
    for (int k = 0; k < l->faults && k < LESSON_NAMED; k++) {
        const lesson_fault *f = &l->fault[k];
        fputs("<li><b>", out);
        put_text(out, f->what);
        fputs(".</b><br><small>", out);
        if (f->u > 0) // else a count
            fprintf(out, "%.1f ± %.1f %s (95 %%), your own spread %.1f, threshold %.1f: ",
                    fabs(f->effect), SURE * f->u, f->unit, f->spread, f->threshold);
        put_sentence(f->source, f->u > 0, out);
        put_sentence(f->how, false, out);
        fputs("</small>", out);
        fputs("</li>\n", out);
    }
    fputs("</ol>", out);
    if (l->scene) {
        fputs("<p>The model plays these bars in your body, on your beat, as a ghost beside you: "
              "<code>himc share ",
              out);
        put_text(out, l->scene);
        fputs(
            " -o ghost.html</code> makes a page of it; in <code>himc-viewer --play</code> the key c puts the two side by side.</p>",
            out);
    }
    double seconds, decibels;
    lesson_scatter(l, &seconds, &decibels);
    if (!l->faults)
        fprintf(
            out,
            "<p><b>Nothing stands out.</b> No difference is both beyond your own spread and beyond "
            "its threshold: %.1f ms in this tempo, %g dB, %g mm.</p>",
            1e3 * l->jnd, LESSON_JND_LEVEL, 1e3 * LESSON_PLACE);
    fprintf(
        out,
        "<p>Your strokes lie %.1f ms off your own beat and %.1f dB off the written dynamics "
        "(root mean square, a usual size of the differences). The more they scatter, the larger a difference must be to be named.</p>",
        1e3 * seconds, decibels);
    if (l->faults > LESSON_NAMED)
        fprintf(out, "<p><small>%d more are beyond their thresholds, by less.</small></p>",
                l->faults - LESSON_NAMED);
}

static void put_mark(FILE *out, double x, double y, double r, himc_hand hand, const char *style)
{
    fprintf(out, "<circle cx=%.1f cy=%.1f r=%.1f class=%s%s />", x, y, r, himc_hand_name(hand),
            style);
}

// of the player's clock from the score's (s)
static double offset(const lesson_played *p, const lesson_asked *a, double slope)
{
    return p->strike.time - p->off - slope * a->time;
}

// of one line: asked strokes, in the player's tempo, above the played ones, larger if faster
static void put_line(const lesson *l, double from, double loudest, FILE *out)
{
    double scale = (WIDE - LEFT - 6) / LINE, latest = NAN, slope = 1 / l->tempo.mean;
    for (int k = 0; k < l->asked_count && !isfinite(latest); k++) // before the first match
        if (l->asked[k].by >= 0)
            latest = offset(&l->played[l->asked[k].by], &l->asked[k], slope);
    fprintf(out, "<svg viewBox='0 0 %g 84'><text y=26>left</text><text y=62>right</text>", WIDE);
    for (int s = 0; s <= (int)LINE; s++)
        fprintf(out, "<path d='M%.1f 4V72' stroke='#ddd'/><text x=%.1f y=82>%g s</text>",
                LEFT + s * scale, LEFT + s * scale - 12, from + s);
    for (int k = 0; k < l->asked_count; k++) {
        const lesson_asked *a = &l->asked[k];
        const lesson_played *p = a->by < 0 ? NULL : &l->played[a->by];
        latest = p ? offset(p, a, slope) : latest;
        double t = latest + slope * a->time - from, y = a->hand == HIMC_LEFT ? 14 : 50;
        if (t < 0 || t >= LINE || !l->seen[a->hand])
            continue;
        put_mark(out, LEFT + t * scale, y, 3, a->hand, " fill-opacity=0 stroke=currentColor");
        if (p)
            fprintf(out, "<path d='M%.1f %gL%.1f %d' stroke='#888'/>", LEFT + t * scale, y + 3,
                    LEFT + (p->strike.time - from) * scale, p->strike.hand == HIMC_LEFT ? 30 : 66);
    }
    for (int k = 0; k < l->count; k++) {
        const himc_take_strike *s = &l->played[k].strike;
        if (s->time >= from && s->time < from + LINE)
            put_mark(out, LEFT + (s->time - from) * scale, s->hand == HIMC_LEFT ? 30 : 66,
                     1.5 + 3.5 * s->velocity / loudest, s->hand, "");
    }
    fputs("</svg>\n", out);
}

static void put_timeline(const lesson *l, FILE *out)
{
    double first = floor(l->played[0].strike.time), loudest = 0;
    for (int k = 0; k < l->count; k++)
        loudest = fmax(loudest, l->played[k].strike.velocity);
    fputs(
        "<h2>Strokes in time</h2><p><small>Of each hand, above: asked, in your own tempo; below: "
        "played, larger if faster. Lines join the same stroke. A ring alone is missing, a disc alone "
        "is too many or in a roll.</small></p><div class=g>",
        out);
    for (int k = 0; k < LINES && k * LINE <= l->length + 1; k++)
        put_line(l, first + k * LINE, loudest, out);
    fputs("</div>", out);
    if (l->length + 1 >= LINES * LINE)
        fprintf(out, "<p><small>Here are the first %g s; --csv has all.</small></p>", LINES * LINE);
}

// beats under a plot of all strokes
static void put_beats(const lesson *l, double first, double scale, FILE *out)
{
    double next = 0;
    for (int k = 0; k < l->asked_count; k++) {
        const lesson_asked *a = &l->asked[k];
        double x = a->by < 0 ? -1 : LEFT + 4 + (l->played[a->by].strike.time - first) * scale;
        if (x < next || x > WIDE - 12)
            continue;
        fprintf(out, "<text x=%.1f y=%g>%s%g</text>", x - 3, HIGH + 9, next > 0 ? "" : "beat ",
                a->beat);
        next = x + WIDE / 9;
    }
}

// one hand's times (ms, early above) or levels (dB) over time; `band`: the threshold
static void put_plot(const lesson *l, himc_hand hand, bool time, double band, FILE *out)
{
    double first = l->played[0].strike.time, middle = HIGH / 2, most = 2 * band,
           scale = (WIDE - LEFT - 8) / fmax(l->length, 1e-3);
    for (int k = 0; k < l->count; k++) // both hands have one scale
        most = fmax(most, 1.1 * fabs(time ? 1e3 * l->played[k].off : l->played[k].level));
    double up = (middle - 8) / most, mean = 0, n = 0;
    fprintf(out, "<svg viewBox='0 0 %g %g'><rect x=%g y=%.1f width=%g height=%.1f fill='#e6f4e6'/>",
            WIDE, HIGH + 12, LEFT, middle - band * up, WIDE - LEFT, 2 * band * up);
    fprintf(out,
            "<path d='M%g %gH%g' stroke='#888'/><text y=10>%.0f %s</text><text y=%g>0</text>"
            "<text y=%g>%.0f %s</text><text x=%g y=10 class=%s>%s hand</text>",
            LEFT, middle, WIDE, most, time ? "ms early" : "dB louder", middle + 3, HIGH - 2, most,
            time ? "ms late" : "dB softer", WIDE - 52, himc_hand_name(hand), himc_hand_name(hand));
    for (int k = 0; k < l->count && k < SHOWN; k++) {
        const lesson_played *p = &l->played[k];
        double y = time ? -1e3 * p->off : p->level, u = time ? 1e3 * p->u_time : p->u_level;
        double x = LEFT + 4 + (p->strike.time - first) * scale;
        if (p->strike.hand != hand || !isfinite(y))
            continue;
        fprintf(out, "<path d='M%.1f %.1fV%.1f' stroke='#999'/>", x, middle - (y + u) * up,
                middle - (y - u) * up);
        put_mark(out, x, middle - y * up, p->named ? 4 : 2.5, hand, p->named ? NAMED : "");
        mean += (y - mean) / ++n;
    }
    fprintf(out, "<path d='M%g %.1fH%g' stroke='#888' stroke-dasharray=4 />", LEFT,
            middle - mean * up, WIDE);
    put_beats(l, first, scale, out);
    fputs("</svg>\n", out);
}

static void put_plots(const lesson *l, FILE *out)
{
    static const char *const heads[] = {
        "Timing</h2><p><small>Against the beat of your own tempo",
        "Loudness</h2><p><small>By impact speed, against the score's "
        "dynamic, less your mean"};
    const double band[] = {1e3 * l->jnd, LESSON_JND_LEVEL};
    for (int what = 0; what < 2; what++) {
        fprintf(
            out,
            "<h2>%s. Green: within the threshold, %.1f %s%s. Dashed: the hand's mean; hands are named "
            "if their means are further apart than that even with the 99 %% bound of what your "
            "strokes' spread leaves open. Red rings: strokes that are named. Bars: uncertainty by "
            "the camera.</small></p><div class=g>",
            heads[what], band[what], what ? "dB" : "ms",
            what ? "" : " (listeners notice 6 ms, or 2.5 % of longer intervals)");
        for (int h = 0; h < HIMC_HANDS; h++)
            if (l->seen[h])
                put_plot(l, (himc_hand)h, what == 0, band[what], out);
        fputs("</div>", out);
    }
}

// mean, standard uncertainty and standard deviation of a hand's strokes; false without any
static bool put_mean(const lesson *l, const column *c, int hand, double *mean, FILE *out)
{
    double ss = 0, n = 0;
    *mean = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < l->count; k++) {
            double x = c->scale * number(&l->played[k], c);
            if ((int)l->played[k].strike.hand != hand || !isfinite(x))
                continue;
            if (pass)
                ss += (x - *mean) * (x - *mean);
            else
                *mean += (x - *mean) / ++n;
        }
    double spread = sqrt(ss / fmax(1, n - 1));
    fputs("<td>", out);
    put_number(out, n > 0 ? *mean : NAN, c->digits, "");
    if (n > 1)
        fprintf(out, " ± %.*f (%.*f)", c->digits, SURE * spread / sqrt(n), c->digits, spread);
    return n > 0;
}

static void put_hands(const lesson *l, FILE *out)
{
    fputs("<h2>Left and right</h2><div class=t><table><tr><th>mean ± 95 % (spread)<th>left<th>right"
          "<th>left − right<th class=p>published\n",
          out);
    for (const column *c = columns; c < columns + COLUMNS; c++) {
        double mean[HIMC_HANDS];
        if (!c->mean || (c->at >= AT(share) && !l->body) ||
            (c->at >= AT(torque) && c->at < AT(raised) && !l->torques))
            continue;
        fprintf(out, "<tr><td>%s", c->mean);
        bool left = put_mean(l, c, 0, &mean[0], out), right = put_mean(l, c, 1, &mean[1], out);
        fputs("<td>", out);
        put_number(out, left && right ? mean[0] - mean[1] : NAN, c->digits, "");
        fprintf(out, "<td class=p>%s\n", c->published);
    }
    if (l->body) {
        fputs("<tr><td>Wrist bent beyond 15° (% of the time)", out);
        put_both(l->bent, 100, 0, out);
        fputs("<td><td class=p>strained (RULA, McAtamney and Corlett 1993); a quarter of drummers' "
              "disorders are in the wrist (Azar 2020)",
              out);
    }
    if (l->torques) {
        fputs("<tr><td>Work of the arm, a stroke (J)", out);
        put_both(l->work, 1, 2, out);
        fputs("<td><td>", out);
    }
    fputs("</table></div>", out);
}

static void put_rolls(const lesson *l, FILE *out)
{
    bool any = false;
    for (const lesson_roll *r = l->roll; r < l->roll + l->rolls; r++) {
        if (r->rate <= 0)
            continue;
        if (!any)
            fputs(
                "<h2>Rolls and fast runs</h2><div class=t><table><tr><th>beat<th>strokes<th>a "
                "second<th>unevenness (ms)<th>every second one late by (ms)<th>loudness spread (dB)",
                out);
        any = true;
        fprintf(out, "<tr><td>%g<td>%d<td>%.1f<td>%.1f ± %.1f<td>%.1f ± %.1f<td>%.1f\n", r->beat,
                r->strokes, r->rate, 1e3 * r->uneven, SURE * 1e3 * r->u, 1e3 * r->gallop,
                SURE * 1e3 * r->u_gallop, r->spread);
    }
    fputs(any ? "</table></div>" : "", out);
}

static void put_table(const lesson *l, FILE *out)
{
    fprintf(
        out,
        "<h2>All strokes</h2><p><small>A stroke's own uncertainty: ± %.1f ms (95 %%) by the frame "
        "rate of %.0f Hz. Places are measured from the median of the take, which is read %s%d°%s.%s</small></p>"
        "<div class=t><table><tr><th>beat<th>hand",
        SURE * 1e3 * l->played[0].u_time, l->rate,
        l->turn ? "as if turned by " : "in its own direction, ", l->turn,
        l->turn_sure ? ", which fits the score best"
                     : "; another direction fits nearly as well, so places are unsure",
        l->asked_count > SHOWN ? " Here are the first; --csv has all." : "");
    for (const column *c = columns; c < columns + COLUMNS; c++)
        if (c->shown)
            fprintf(out, "<th>%s", c->shown);
    for (int k = 0; k < l->asked_count && k < SHOWN; k++) {
        const lesson_asked *a = &l->asked[k];
        const lesson_played *p = a->by < 0 ? NULL : &l->played[a->by];
        const char *hand = himc_hand_name(a->hand);
        if (!l->seen[a->hand])
            continue;
        fprintf(out, "\n<tr%s><td>%g<td class=%s>%s%s", p && !p->named ? "" : " class=bad", a->beat,
                hand, hand,
                a->unseen                   ? " not seen"
                : !p                        ? " missing"
                : p->strike.hand != a->hand ? " (played by the other)"
                                            : "");
        for (const column *c = columns; c < columns + COLUMNS; c++)
            if (c->shown) {
                fputs("<td>", out);
                put_number(out, c->scale * number(p, c), c->digits, "");
            }
    }
    fputs("</table></div></html>\n", out);
}

void lesson_page(const void *of, FILE *out)
{
    const lesson *l = of;
    put_head(l, out);
    put_faults(l, out);
    put_timeline(l, out);
    put_plots(l, out);
    put_hands(l, out);
    put_rolls(l, out);
    put_table(l, out);
}

static void put_row(const lesson_asked *a, const lesson_played *p, FILE *out)
{
    const char *state = a && p         ? a->hand == p->strike.hand ? "played" : "other-hand"
                        : a            ? a->unseen ? "unseen" : "missing"
                        : p->roll >= 0 ? "roll"
                                       : "extra";
    fprintf(out, "\n%s,%s,%s", state, himc_hand_name(p ? p->strike.hand : a->hand),
            a ? a->nuance : "none");
    const double asked[] = {a ? a->beat : NAN, a ? a->time : NAN, a ? a->speed : NAN};
    for (int k = 0; k < 3 + COLUMNS; k++) {
        fputc(',', out);
        put_number(out, k < 3 ? asked[k] : number(p, &columns[k - 3]), 5, "nan");
    }
}

void lesson_csv(const void *of, FILE *out)
{
    const lesson *l = of;
    fputs("state,hand,nuance,beat,asked_s,asked_speed_m_s", out);
    for (int k = 0; k < COLUMNS; k++)
        fprintf(out, ",%s", columns[k].csv);
    for (int k = 0; k < l->asked_count; k++)
        if (l->seen[l->asked[k].hand])
            put_row(&l->asked[k], l->asked[k].by < 0 ? NULL : &l->played[l->asked[k].by], out);
    for (int k = 0; k < l->count; k++)
        if (l->played[k].of < 0)
            put_row(NULL, &l->played[k], out);
    fputc('\n', out);
}

void lesson_json(const lesson *l, FILE *out)
{
    fprintf(
        out,
        "{\"asked\": %d, \"matched\": %d, \"missing\": %d, \"unseen\": %d, \"extra\": %d, \"rate_hz\": %g, \"tempo_bpm\": "
        "%.3f, \"tempo_uncertainty_bpm\": %.3f, \"level_db\": %.3f, \"turned_deg\": %d, \"turned_sure\": %s, \"drums_apart\": %s, \"faults\": [",
        l->due, l->matched, l->missing, l->unseen, l->extra, l->rate, l->bpm * l->tempo.mean,
        l->bpm * l->tempo.u, l->level, l->turn, l->turn_sure ? "true" : "false",
        l->apart ? "true" : "false");
    for (int k = 0; k < l->faults; k++) {
        const lesson_fault *f = &l->fault[k];
        fprintf(out, "%s{\"kind\": \"%s\", \"what\": ", k ? ", " : "", f->kind);
        cli_put_json_text(out, f->what);
        fprintf(
            out,
            ", \"effect\": %.4g, \"uncertainty\": %.4g, \"spread\": %.4g, \"threshold\": %.4g, \"unit\": \"%s\"}",
            f->effect, f->u, f->spread, f->threshold, f->unit);
    }
    fputs("]}\n", out);
}
