/// lesson_page.c: the lesson as one HTML page, a CSV and a JSON object.
///
/// The page has no script and asks for nothing: inline SVG, whose lines are narrow enough for a
/// telephone and stand beside each other on a wide screen or on paper.
#include "lesson.h"

#include "cli.h"

#include <math.h>
#include <string.h>

#define SURE 1.96  // standard uncertainties of the 95 % that are shown
#define LINE 4.0   // time of a line of the timeline (s); chosen: strokes 5 to 30 mm apart
#define SHOWN 2500 // strokes in pictures and table; chosen: 1.5 MB
#define WIDE 360.0 // of a picture
#define LEFT 34.0  // of its axis
#define HIGH 110.0 // of a plot

static const char *const side[] = {"left", "right"};

static void put_text(FILE *out, const char *text)
{
    for (; *text; text++)
        if (*text == '<' || *text == '>' || *text == '&' || *text == '"')
            fprintf(out, "&#%d;", *text);
        else
            fputc(*text, out);
}

static void put_number(FILE *out, double x, int digits, const char *unknown)
{
    if (isfinite(x))
        fprintf(out, "%.*f", digits, x + 0.0);
    else
        fputs(unknown, out);
}

static void put_head(const lesson *l, FILE *out)
{
    fputs("<!DOCTYPE html><html lang=en><meta charset=utf-8>"
          "<meta name=viewport content='width=device-width,initial-scale=1'><title>Lesson: ",
          out);
    put_text(out, l->take);
    fputs(
        "</title><style>:root{--left:#1864ab;--right:#c2410c}"
        "body{font:16px/1.45 sans-serif;color:#222;max-width:1100px;margin:0 auto;padding:12px}"
        "h1{font-size:1.4em}h2{font-size:1.15em;margin:1.6em 0 .4em}"
        "ol{padding-left:1.3em}li{margin:.7em 0}li b{font-size:1.08em}small{color:#555}"
        ".g{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(330px,100%),1fr));gap:10px}"
        "svg{width:100%;height:auto;background:#fafafa;break-inside:avoid}svg text{font:9px sans-serif;fill:#444}"
        ".left{fill:var(--left);color:var(--left)}.right{fill:var(--right);color:var(--right)}"
        ".t{overflow-x:auto}table{border-collapse:collapse;font-size:.86em}"
        "td,th{padding:2px 8px;text-align:right;border-bottom:1px solid #ddd;vertical-align:top}td{white-space:nowrap}td:last-child{white-space:normal}"
        "th:first-child,td:first-child{text-align:left}.bad{background:#fde2e2}"
        "@media print{body{font-size:11px;padding:0}.t{overflow:visible}table{font-size:8px}"
        "svg text{font-size:8px}tr{break-inside:avoid}}</style><h1>Lesson: ",
        out);
    put_text(out, l->take);
    fputs(" <small>against</small> ", out);
    put_text(out, l->score);
    fprintf(
        out,
        "</h1><p>%d of %d strokes found, %d missing, %d too many. Tempo %.1f ± %.1f BPM; the score has %g.",
        l->matched, l->asked_count, l->missing, l->extra, l->bpm * l->tempo.mean,
        SURE * l->bpm * l->tempo.u, l->bpm);
    for (int h = 0; h < HIMC_HANDS; h++)
        if (!l->seen[h])
            fprintf(out, " The take does not show the %s stick, so its strokes are not judged.",
                    side[h]);
    fprintf(out, " All together you play %.1f dB %s than the model at the score's dynamics.</p>",
            fabs(l->level), l->level < 0 ? "softer" : "louder");
}

static void put_faults(const lesson *l, FILE *out)
{
    fputs("<h2>Practise first</h2>", out);
    if (!l->faults)
        fputs(
            "<p><b>Nothing stands out.</b> No difference is both beyond your own spread and beyond "
            "what is noticed.</p>",
            out);
    fputs("<ol>", out);
    for (int k = 0; k < l->faults && k < LESSON_NAMED; k++) {
        const lesson_fault *f = &l->fault[k];
        fputs("<li><b>", out);
        put_text(out, f->what);
        fputs(".</b><br><small>", out);
        bool counted = f->u == 0;
        if (counted)
            fprintf(out, "The camera is certain to half a frame, %.1f ms. ", 500 / l->rate);
        else
            fprintf(out, "%.1f ± %.1f %s (95 %%), your own spread %.1f %s, threshold %.1f %s. ",
                    fabs(f->effect), SURE * f->u, f->unit, f->spread, f->unit, f->threshold,
                    f->unit);
        put_text(out, f->how);
        fputs(". ", out);
        put_text(out, f->source);
        fputs(".</small></li>", out);
    }
    fputs("</ol>", out);
    if (l->faults > LESSON_NAMED)
        fprintf(out, "<p><small>%d more beyond their thresholds, smaller than these.</small></p>",
                l->faults - LESSON_NAMED);
}

static void put_mark(FILE *out, double x, double y, himc_hand hand, bool hollow)
{
    fprintf(out, "<circle cx=%.1f cy=%.1f r=3 class=%s%s />", x, y, side[hand],
            hollow ? " style='fill-opacity:0;stroke:currentColor;stroke-width:1.2'" : "");
}

// asked strokes above, in the player's tempo; played ones below, their size the speed
static void put_timeline(const lesson *l, FILE *out)
{
    double first = l->played[0].strike.time, scale = (WIDE - LEFT - 6) / LINE, loudest = 0;
    for (int k = 0; k < l->count; k++)
        loudest = fmax(loudest, l->played[k].strike.velocity);
    fputs(
        "<h2>Strokes in time</h2><p><small>Of each hand above: asked, in your own tempo; below: played, "
        "larger when faster. Joined: one stroke. A ring alone is missing, a disc alone is too many or in a roll. "
        "A line is 4 s.</small></p><div class=g>",
        out);
    for (double from = floor(first); from <= first + l->length && from < first + 400;
         from += LINE) {
        fprintf(out, "<svg viewBox='0 0 %g 84' role=img aria-label='strokes from %g s'>", WIDE,
                from);
        for (int s = 0; s <= (int)LINE; s++)
            fprintf(out, "<path d='M%.1f 4V72' stroke='#ddd'/><text x=%.1f y=82>%g s</text>",
                    LEFT + s * scale, LEFT + s * scale - 6, from + s);
        fputs("<text x=0 y=26>left</text><text x=0 y=62>right</text>", out);
        double latest = 0, map = 1 / l->tempo.mean;
        for (int k = 0; k < l->asked_count; k++) {
            const lesson_asked *a = &l->asked[k];
            const lesson_played *p = a->by < 0 ? NULL : &l->played[a->by];
            if (p)
                latest = p->strike.time - p->off - map * a->time;
            double t = latest + map * a->time - from, y = a->hand == HIMC_LEFT ? 14 : 50;
            if (t < 0 || t >= LINE)
                continue;
            put_mark(out, LEFT + t * scale, y, a->hand, true);
            if (p)
                fprintf(out, "<path d='M%.1f %gL%.1f %g' stroke='#888'/>", LEFT + t * scale, y + 3,
                        LEFT + (p->strike.time - from) * scale,
                        p->strike.hand == HIMC_LEFT ? 30.0 : 66.0);
        }
        for (int k = 0; k < l->count; k++) {
            const lesson_played *p = &l->played[k];
            double t = p->strike.time - from;
            if (t >= 0 && t < LINE)
                fprintf(out, "<circle cx=%.1f cy=%d r=%.1f class=%s />", LEFT + t * scale,
                        p->strike.hand == HIMC_LEFT ? 30 : 66,
                        1.5 + 3.5 * p->strike.velocity / loudest, side[p->strike.hand]);
        }
        fputs("</svg>", out);
    }
    fputs("</div>", out);
}

// values of one hand over time: 'o'ff the beat (ms) or 'l'evel (dB), the threshold as a band
static void put_plot(const lesson *l, himc_hand hand, int what, double most, double band, FILE *out)
{
    double first = l->played[0].strike.time, middle = HIGH / 2,
           scale = (WIDE - LEFT - 8) / fmax(l->length, 1e-3), up = (middle - 8) / most;
    fprintf(
        out,
        "<svg viewBox='0 0 %g %g' role=img aria-label='%s hand'><rect x=%g y=%.1f width=%g height=%.1f "
        "fill='#e6f4e6'/>",
        WIDE, HIGH, side[hand], LEFT, middle - band * up, WIDE - LEFT, 2 * band * up);
    fprintf(
        out,
        "<path d='M%g %gH%g' stroke='#888'/><text x=0 y=12>%.0f %s</text><text x=0 y=%g>%s</text>"
        "<text x=0 y=%g>%.0f %s</text><text x=%g y=12 class=%s>%s hand</text>",
        LEFT, middle, WIDE, most, what == 'o' ? "early" : "louder", middle + 3,
        what == 'o' ? "0 ms" : "0 dB", HIGH - 2, most, what == 'o' ? "late" : "softer", WIDE - 50,
        side[hand], side[hand]);
    for (int k = 0, shown = 0; k < l->count && shown < SHOWN; k++) {
        const lesson_played *p = &l->played[k];
        double y = what == 'o' ? 1e3 * p->off : p->level,
               u = what == 'o' ? 1e3 * p->u_time : p->u_level;
        if (p->strike.hand != hand || !isfinite(y))
            continue;
        double x = LEFT + 4 + (p->strike.time - first) * scale;
        y = fmax(-most, fmin(most, what == 'o' ? -y : y));
        fprintf(out, "<path d='M%.1f %.1fV%.1f' stroke='#999'/>", x, middle - (y + u) * up,
                middle - (y - u) * up);
        put_mark(out, x, middle - y * up, hand, false);
        shown++;
    }
    fputs("</svg>", out);
}

static void put_plots(const lesson *l, FILE *out)
{
    double most[2] = {12, 3};
    for (int k = 0; k < l->count; k++) {
        most[0] = isfinite(l->played[k].off)
                      ? fmax(most[0], fmin(200, 1100 * fabs(l->played[k].off)))
                      : most[0];
        most[1] = isfinite(l->played[k].level)
                      ? fmax(most[1], fmin(20, 1.1 * fabs(l->played[k].level)))
                      : most[1];
    }
    for (int what = 0; what < 2; what++) {
        fputs(
            what
                ? "<h2>Loudness</h2><p><small>By impact speed, against the score's dynamic, less your mean. "
                  "Green: within 1 dB. Bars: the camera's uncertainty.</small></p><div class=g>"
                : "<h2>Timing</h2><p><small>Against the beat of your own tempo; above the line early, below late. "
                  "Green: within 6 ms, which no listener notices. Bars: the camera's uncertainty.</small></p>"
                  "<div class=g>",
            out);
        for (int h = 0; h < HIMC_HANDS; h++)
            if (l->seen[h])
                put_plot(l, (himc_hand)h, what ? 'l' : 'o', most[what], what ? 1 : 6, out);
        fputs("</div>", out);
    }
}

static void put_figure(const lesson *l, const char *name, int of, double scale, int digits,
                       const char *reference, FILE *out)
{
    lesson_figure f[HIMC_HANDS];
    fprintf(out, "<tr><td>%s", name);
    for (int h = 0; h < HIMC_HANDS; h++) {
        f[h] = lesson_mean(l, (himc_hand)h, of);
        fputs("<td>", out);
        put_number(out, scale * f[h].mean, digits, "");
        if (f[h].count > 1)
            fprintf(out, " ± %.*f (%.*f)", digits, SURE * scale * f[h].u, digits,
                    scale * f[h].spread);
    }
    fputs("<td>", out);
    put_number(out, scale * (f[0].mean - f[1].mean), digits, "");
    fprintf(out, "<td style='text-align:left'>%s", reference);
}

static void put_hands(const lesson *l, FILE *out)
{
    static const char *const limbs[] = {"Shoulder's share of the fall (%)", "Elbow's (%)",
                                        "Wrist's and fingers' (%)", "Trunk's (%)"};
    static const char *const torques[] = {"Largest torque, shoulder (N m)", "elbow (N m)",
                                          "wrist (N m)"};
    fputs(
        "<h2>Left and right</h2><div class=t><table><tr><th>mean ± 95 % (spread)<th>left<th>right<th>left − right"
        "<th style='text-align:left'>published",
        out);
    put_figure(l, "After the beat (ms)", 'o', 1e3, 1,
               "professionals with a metronome: hands 8 to 12 ms apart (Fujii et al. 2011)", out);
    put_figure(l, "Loudness about your mean (dB)", 'l', 1, 1, "", out);
    put_figure(l, "Height before the stroke (mm)", 'h', 1e3, 0,
               "grows with the dynamic (Dahl 2004)", out);
    put_figure(l, "Path of the fall (mm)", 'p', 1e3, 0, "", out);
    for (int k = 0; k < LESSON_LIMBS && l->body; k++)
        put_figure(l, limbs[k], k, 100, 0, "", out);
    for (int k = 0; k < 3 && l->torques; k++)
        put_figure(l, torques[k], 4 + k, 1, 1, "", out);
    if (l->body)
        fprintf(
            out,
            "<tr><td>Wrist bent beyond 15° (%% of the time)<td>%.0f<td>%.0f<td>"
            "<td style='text-align:left'>beyond it strained (RULA, McAtamney and Corlett 1993); of drummers' "
            "disorders 25 %% are in the wrist (Azar 2020)",
            100 * l->bent[0], 100 * l->bent[1]);
    if (l->torques)
        fprintf(out, "<tr><td>Work of the arm, a stroke (J)<td>%.2f<td>%.2f<td><td>", l->work[0],
                l->work[1]);
    fputs("</table></div>", out);
    bool head = false;
    for (int k = 0; k < l->rolls; k++) {
        const lesson_roll *r = &l->roll[k];
        if (r->strokes < 8)
            continue;
        fputs(
            head
                ? ""
                : "<h2>Rolls and fast runs</h2><div class=t><table><tr><th>played at<th>strokes<th>a second"
                  "<th>unevenness (ms)<th>every second one late by (ms)<th>loudness spread (dB)",
            out);
        fprintf(out, "<tr><td>%.1f s<td>%d<td>%.1f<td>%.1f ± %.1f<td>%+.1f ± %.1f<td>%.1f", r->from,
                r->strokes, r->rate, 1e3 * r->uneven, SURE * 1e3 * r->u, 1e3 * r->gallop,
                SURE * 1e3 * r->u_gallop, r->spread);
        head = true;
    }
    fputs(head ? "</table></div>" : "", out);
}

static void put_table(const lesson *l, FILE *out)
{
    fprintf(
        out,
        "<h2>All strokes</h2><p><small>A stroke's own uncertainty: ± %.1f ms by the frame rate of %.0f Hz. "
        "Places are measured from the median of the take.</small></p><div class=t><table><tr><th>beat<th>hand<th>"
        "played (s)<th>off the beat (ms)<th>off a metronome (ms)<th>speed (m/s)<th>loudness (dB)<th>away (mm)<th>to the left (mm)<th>"
        "height (mm)<th>path (mm)",
        SURE * 1e3 / (l->rate * sqrt(12)), l->rate);
    for (int k = 0; k < l->asked_count && k < SHOWN; k++) {
        const lesson_asked *a = &l->asked[k];
        const lesson_played *p = a->by < 0 ? NULL : &l->played[a->by];
        if (!l->seen[a->hand])
            continue;
        fprintf(out, "<tr%s><td>%g<td class=%s>%s", p ? "" : " class=bad", a->beat, side[a->hand],
                side[a->hand]);
        if (!p) {
            fputs("<td colspan=9 style='text-align:left'>missing", out);
            continue;
        }
        fprintf(out,
                "%s<td>%.3f<td>%+.1f<td>%+.1f<td>%.2f<td>%+.1f<td>%+.0f<td>%+.0f<td>%.0f<td>%.0f",
                p->strike.hand == a->hand ? "" : " (played by the other)", p->strike.time,
                1e3 * p->off, 1e3 * p->steady, p->strike.velocity, p->level, 1e3 * p->aside.x,
                1e3 * p->aside.y, 1e3 * p->height, 1e3 * p->path);
    }
    fputs("</table></div>", out);
    if (l->asked_count > SHOWN)
        fprintf(out, "<p>The first %d of %d strokes; --csv has all.</p>", SHOWN, l->asked_count);
}

void lesson_page(const lesson *l, FILE *out)
{
    put_head(l, out);
    put_faults(l, out);
    put_timeline(l, out);
    put_plots(l, out);
    put_hands(l, out);
    put_table(l, out);
    fprintf(out, "<p><small>himc lesson %s</small></p></html>\n", himc_version());
}

static void put_row(const lesson *l, const lesson_asked *a, const lesson_played *p, FILE *out)
{
    const char *state = a && p         ? a->hand == p->strike.hand ? "played" : "other-hand"
                        : a            ? "missing"
                        : p->roll >= 0 ? "roll"
                                       : "extra";
    double nan_ = NAN;
    const double values[] = {a ? a->time : nan_,
                             p ? p->strike.time : nan_,
                             p ? p->off : nan_,
                             p ? p->steady : nan_,
                             p ? p->u_time : nan_,
                             a ? a->speed : nan_,
                             p ? p->strike.velocity : nan_,
                             p ? p->level : nan_,
                             p ? p->u_level : nan_,
                             p ? p->aside.x : nan_,
                             p ? p->aside.y : nan_,
                             p ? p->height : nan_,
                             p ? p->path : nan_,
                             p ? p->share[0] : nan_,
                             p ? p->share[1] : nan_,
                             p ? p->share[2] : nan_,
                             p ? p->share[3] : nan_,
                             p ? p->torque[0] : nan_,
                             p ? p->torque[1] : nan_,
                             p ? p->torque[2] : nan_};
    fprintf(out, "%s,%s,%s,", state, himc_hand_name(p ? p->strike.hand : a->hand),
            a ? a->nuance : "none");
    put_number(out, a ? a->beat : nan_, 4, "nan");
    for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
        fputc(',', out);
        put_number(out, values[k], 5, "nan");
    }
    fputc('\n', out);
    (void)l;
}

void lesson_csv(const lesson *l, FILE *out)
{
    fputs(
        "state,hand,nuance,beat,asked_s,played_s,off_beat_s,off_metronome_s,time_uncertainty_s,asked_speed_m_s,"
        "speed_m_s,level_db,level_uncertainty_db,aside_x_m,aside_y_m,height_m,path_m,shoulder_share,elbow_share,"
        "wrist_share,trunk_share,shoulder_torque_n_m,elbow_torque_n_m,wrist_torque_n_m\n",
        out);
    for (int k = 0; k < l->asked_count; k++)
        if (l->seen[l->asked[k].hand])
            put_row(l, &l->asked[k], l->asked[k].by < 0 ? NULL : &l->played[l->asked[k].by], out);
    for (int k = 0; k < l->count; k++)
        if (l->played[k].of < 0)
            put_row(l, NULL, &l->played[k], out);
}

void lesson_json(const lesson *l, FILE *out)
{
    fprintf(
        out,
        "{\"asked\": %d, \"matched\": %d, \"missing\": %d, \"extra\": %d, \"rate_hz\": %g, \"tempo_bpm\": %.3f, "
        "\"tempo_uncertainty_bpm\": %.3f, \"level_db\": %.3f, \"faults\": [",
        l->asked_count, l->matched, l->missing, l->extra, l->rate, l->bpm * l->tempo.mean,
        l->bpm * l->tempo.u, l->level);
    for (int k = 0; k < l->faults; k++) {
        const lesson_fault *f = &l->fault[k];
        fprintf(out, "%s{\"kind\": \"%s\", \"what\": ", k ? ", " : "", f->kind);
        cli_put_json_text(out, f->what);
        fprintf(
            out,
            ", \"effect\": %.4g, \"uncertainty\": %.4g, \"spread\": %.4g, \"threshold\": %.4g, \"unit\": \"%s\", "
            "\"excess\": %.4g}",
            f->effect, f->u, f->spread, f->threshold, f->unit, f->excess);
    }
    fputs("]}\n", out);
}
