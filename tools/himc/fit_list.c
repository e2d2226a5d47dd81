/// fit_list.c: partials as a list of modes: all of one mass, with shape 1 or -1 everywhere, so that
/// only the pressure of each says how loud it is.
///
/// The mallet. A contact of length T has the spectrum of a bell curve, 6 dB down at 1.1/T. It is as
/// long as lets each partial be as loud as recorded without much more pressure than the others. So
/// a softer blow is darker, and other mallets differ, as on a drum.
///
/// The push. While the mallet pushes, all modes radiate its force at once, a tick. Their signs
/// cancel most of it, and one mode far below hearing the rest: the instrument that sways.
///
/// The pressures follow from blows on the list, whose spectra, in windows one after the other, are
/// set beside the recording's at each frequency; of lines (partials_lines.c) level and T60 are. No
/// mode is let be louder than the recording. Above PARTIALS_LINES, where a hall decays in two
/// slopes, peaks of the late spectrum join.
///
/// All modes together are heavier than the mallet: under a lighter list it chatters.
#include "fit_list.h"

#include "fit_levels.h"

#include "base/order.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FOUND 160 // the strongest; chosen: of halls' recordings a third of all poles
#define PEAKS 240 // peaks of the spectrum, early and late
#define MODES (FOUND + PEAKS)
#define MASS 0.1         // (kg) what all have together where it is struck: eight mallets'
#define SHAPE 0.1        // of all modes; chosen: no pressure leaves its range
#define MALLET 0.012     // (kg) chosen: as the named ones
#define FELT 2.5         // its exponent; chosen, of piano hammers 2.1 to 5 (Boutillon 1988)
#define TIMES 2.715      // T v/c of that exponent, c the deepest (Hertz)
#define SPEED 2.9        // (m/s) of a stroke mf
#define HALVED 1.1       // f T at -6 dB
#define LESS 10.0        // (dB) the contact may have less than a partial ...
#define GAP 2.0          // ... and f T is below its first gap
#define FALLEN 6.0       // (dB) most that a partial falls in the first window
#define HEARD 150.0      // (Hz) below, partials are heard less
#define MATTERS 30.0     // (dB) below the strongest a partial does not choose the mallet
#define SHORTEST 2e-4    // (s) of contacts ...
#define LONGEST 1.6e-3   // ... a longer one has a gap below 1.4 kHz
#define BOOST 24.0       // (dB) of pressure, more than the strongest's
#define SWAY 2.0         // (Hz) and its T60 (s)
#define LOUDNESS (-30.0) // (LUFS) of a stroke mf: the usual timpano's ...
#define PEAK 0.25        // ... but of what is short no larger sample, so ff does not clip
#define FIRST 3.0        // factor of pressures; chosen: of most lists the loudness is then near
#define ROUNDS 7
#define LAST 3      // ... in the last ones only what is too loud changes, and lines
#define CLEAR 0.0   // (dB) a partial less clear is the room's
#define NEAR 1.5    // (Hz)
#define BEAT 1.1    // (s) before the blow
#define SECONDS 4.0 // after it
#define AT_ONCE 1.3 // of T60, in a round
#define AT_ONCE_DB 12.0
#define DAMPED 0.6          // of a change, after the first rounds: neighbours change as well
#define RATE 48000.0        // (Hz) of what is heard ...
#define LOWEST_RATE 16000.0 // ... if the recording's is lower
#define SHOWN 50.0          // (dB) below its loudest window a mode's level does not count
#define OVER 8.0            // (dB) over what is left at the end ...
#define SEEN 4.0       // a window shows a mode of its own if it is not so much shorter than T60
#define EXCESS 3.0     // (dB) no mode is louder by so much
#define SLOW_LOW 600.0 // (Hz) below, the first window is too short for what rings ...
#define SLOW_T60 0.3   // ... longer (s)
#define T60_LEAST 0.03 // (s) of a mode's ...
#define CYCLES 12.0    // ... and so many periods: less is no tone
#define T60_MOST 20.0
#define LATE 3            // the window whose peaks join
#define BINS 5400         // of a spectrum
#define BANDS 6           // per octave ...
#define EACH 6            // ... so many peaks
#define PROMINENT 25.0    // (dB) below another within ...
#define SKIRT 15          // ... so many bins a peak is that one's
#define ONSET_DOWN 50.0   // (dB) below the loudest of the onset peaks do not count ...
#define LATE_DOWN 65.0    // ... late
#define PEAKS_ABOVE 90.0  // (Hz) above PARTIALS_LINES: no line is hidden by one
#define ONSET 1           // the window in which a line ...
#define ONSET_MORE 6.0    // ... has so much more (dB) than its slope says ...
#define ONSET_STRONG 25.0 // (dB) ... and is no softer than the strongest by this ...
#define ONSET_T60 0.15    // (s) ... that falls so
#define PITCH_STRONG 12.0 // (dB) the lowest that is so near the strongest is the pitch ...
#define PITCH_NEAR 0.06   // ... or the strongest so near the tuning
#define PITCH_LEAST 30.0  // (Hz)

typedef struct tone {
    double frequency, t60;
    double amplitude, pressure;            // at the onset, as recorded; what makes it (in any unit)
    double level[FIT_WINDOWS + 1], energy; // recorded (dB)
    const partial *line;                   // that falls evenly, or NULL
    bool onset;                            // it is what a line has more at first
} tone;

typedef struct list {
    tone tone[MODES];
    int count;
    double contact; // (s)
    double louder;  // factor of all pressures
    double pitch, radius;
} list;

// a stroke mf in free air; `peak`: its largest sample, `loudness` in LUFS
static bool hear(const cli_file *file, double rate, partials_sound *out, double *peak,
                 double *loudness, himc_error *error)
{
    const char *path = file->temp[0] ? file->temp : file->path;
    size_t frames = (size_t)((BEAT + SECONDS) * rate);
    himc_performance_config config = himc_performance_default();
    himc_state_line line = himc_state_begin("instrument");
    himc_state_word(&line, "fitted");
    himc_state_word(&line, "modes");
    himc_state_word(&line, path);
    config.sample_rate = rate;
    config.physics_rate = fmin(config.physics_rate, rate);
    config.heard = true;
    float *heard = calloc(2 * frames, sizeof *heard);
    himc_performance *p = heard ? himc_performance_new(&config, error) : NULL;
    bool good = p && cli_tell(p, line.text, NULL, error) && cli_tell(p, "room 0", NULL, error) &&
                cli_tell(p, "tempo 120", NULL, error) &&
                cli_tell(p, "stroke 1 right legato mf", NULL, error) &&
                cli_tell(p, "play", NULL, error);
    if (good)
        *peak = himc_performance_read(p, heard, 2, (int)frames);
    else if (!heard)
        himc_error_set(error, "out of memory");
    *loudness = good ? fit_loudness(heard, frames, rate) : 0;
    good = good && partials_add(out, heard, frames, 2, rate, "the instrument made", false, error);
    himc_performance_free(p);
    free(heard);
    return good;
}

static double omega(const tone *t)
{
    return 2 * HIMC_PI * t->frequency;
}

static int by_pressure(const void *a, const void *b)
{
    const tone *p = a, *q = b;
    return (p->pressure < q->pressure) - (p->pressure > q->pressure);
}

static void print_mode(FILE *out, double pressure, double frequency, double t60, double mass,
                       bool against)
{
    fprintf(out, "pressure %.4g\nmode %.7g %.4g %g %g\n", fmin(fmax(1e-12, pressure), 1), frequency,
            fmin(t60, 60), mass, against ? -SHAPE : SHAPE);
}

static bool write(const list *l, const char *path, cli_file *file, himc_error *error)
{
    static list sorted; // large
    double sum = 0, mass = MASS * SHAPE * SHAPE * (l->count + 1),
           deepest = l->contact * SPEED / TIMES;
    sorted = *l;
    qsort(sorted.tone, (size_t)l->count, sizeof *l->tone, by_pressure);
    cli_file_drop(file);
    if (!cli_file_open(file, path, error))
        return false;
    fprintf(file->stream,
            "# made by himc fit\npitch %.6g\nmallet %.4g %g %g\nsurface struck disc %g\n", l->pitch,
            0.5 * (FELT + 1) * MALLET * SPEED * SPEED / pow(deepest, FELT + 1), FELT, MALLET,
            l->radius);
    for (int i = 0; i < l->count; i++) {
        const tone *t = &sorted.tone[i];
        double p = l->louder * t->pressure;
        bool against = sum > 0;
        sum += against ? -p : p;
        print_mode(file->stream, p, t->frequency, t->t60, mass, against);
    }
    print_mode(file->stream, fabs(sum), SWAY, SWAY, mass, sum > 0);
    return cli_file_close(file, error);
}

// energy (dB) that is seen in all windows
static double shown(const double level[FIT_WINDOWS + 1])
{
    double sum = 0;
    for (int w = 0; w < FIT_WINDOWS; w++)
        if (isfinite(level[w]))
            sum += pow(10, level[w] / 10) * (fit_windows[w][1] - fit_windows[w][0]);
    return 10 * log10(sum + 1e-20);
}

static bool counts(const tone *t, int w)
{
    return isfinite(t->level[w]) && (w > 0 || t->frequency > SLOW_LOW || t->t60 < SLOW_T60);
}

static double loudest(const tone *t, int *window)
{
    double most = -INFINITY;
    *window = 0;
    for (int w = 0; w < FIT_WINDOWS; w++)
        if (counts(t, w) && t->level[w] > most) {
            most = t->level[w];
            *window = w;
        }
    return most;
}

// mean of a mode's amplitude, 1 at the onset, in a window
static double mean(const tone *t, int w)
{
    double from = fit_windows[w][0], to = fit_windows[w][1], sum = 0, n = 40;
    for (int i = 0; i < n; i++)
        sum +=
            (from > 0 ? 1 - cos(2 * HIMC_PI * (i + 0.5) / n) : 1 + cos(HIMC_PI * (i + 0.5) / n)) /
            n * pow(1000, -(from + (to - from) * (i + 0.5) / n) / t->t60);
    return sum;
}

static int by_energy(const void *a, const void *b)
{
    const tone *p = a, *q = b;
    return (p->energy < q->energy) - (p->energy > q->energy);
}

// fills in what the recording has there
static bool measure(const partials_sound *sound, tone *t, int count, himc_error *error)
{
    static double frequency[PARTIALS_MOST + PEAKS], level[PARTIALS_MOST + PEAKS][FIT_WINDOWS + 1];
    for (int i = 0; i < count; i++)
        frequency[i] = t[i].frequency;
    if (!fit_levels(sound, frequency, count, level))
        return himc_error_set(error, "out of memory");
    for (int i = 0; i < count; i++) {
        int w;
        memcpy(t[i].level, level[i], sizeof t->level);
        t[i].energy = shown(level[i]);
        double most = loudest(&t[i], &w);
        t[i].amplitude = pow(10, most / 20) / mean(&t[i], w);
        if (t[i].line)
            t[i].amplitude = pow(10, t[i].line->level / 20);
    }
    return true;
}

// those found, the strongest of them first
static bool choose(const partials_sound *sound, partials_list *found, list *l, himc_error *error)
{
    static tone all[PARTIALS_MOST];
    partial *of[PARTIALS_MOST];
    int count = 0;
    for (int i = 0; i < found->count; i++) {
        partial *p = &found->row[i];
        of[count] = p;
        if (p->clear > CLEAR)
            all[count++] = (tone){.frequency = p->frequency,
                                  .t60 = fmax(p->t60, CYCLES / p->frequency),
                                  .line = p->line ? p : NULL};
    }
    if (count == 0)
        return himc_error_set(error,
                              "no partial is clear of the noise, expected a sound that rings");
    if (!measure(sound, all, count, error))
        return false;
    for (int i = 0; i < count; i++) {
        double level = 20 * log10(all[i].amplitude);
        if (of[i]->level > level + EXCESS) { // the sound before its window is not its own
            of[i]->level = level;
            of[i]->energy = level + 10 * log10(of[i]->t60);
        }
    }
    double strongest = -INFINITY; // it is a line, even or not
    for (int i = 0; i < count; i++)
        strongest = fmax(strongest, of[i]->energy);
    for (int i = 0; i < count; i++)
        if (of[i]->frequency < PARTIALS_LINES && of[i]->energy > strongest - FIT_LIST_STRONG)
            all[i].line = of[i];
    qsort(all, (size_t)count, sizeof *all, by_energy);
    l->count = count < FOUND ? count : FOUND;
    memcpy(l->tone, all, sizeof *all * (size_t)l->count);
    return true;
}

// a line that falls faster at first has a second, short mode
static void add_onsets(list *l)
{
    int count = l->count;
    for (int i = 0; i < count && l->count < MODES; i++) {
        const tone *t = &l->tone[i];
        double more = t->level[ONSET] - 20 * log10(t->amplitude * mean(t, ONSET));
        if (!t->line || more < ONSET_MORE || t->energy < l->tone[0].energy - ONSET_STRONG)
            continue;
        tone *short_one = &l->tone[l->count++];
        *short_one = *t;
        short_one->line = NULL;
        short_one->onset = true;
        short_one->t60 = fmax(ONSET_T60, CYCLES / t->frequency);
        short_one->amplitude = pow(10, t->level[ONSET] / 20) / mean(short_one, ONSET);
    }
}

// a spectrum whose peaks become modes, where none is near
typedef struct spectrum {
    int window, bins;
    double grid, lowest, least; // (Hz, dB)
    double level[BINS][FIT_WINDOWS + 1];
} spectrum;

static bool is_peak(const spectrum *s, int k, const list *l)
{
    double here = s->level[k][s->window], frequency = s->lowest + s->grid * k;
    if (!(here > s->least) || here < s->level[k - 1][s->window] ||
        here <= s->level[k + 1][s->window] || here < s->level[k][FIT_END] + OVER)
        return false;
    for (int i = k - SKIRT; i <= k + SKIRT; i++)
        if (i >= 0 && i < s->bins && s->level[i][s->window] > here + PROMINENT)
            return false;
    for (int i = 0; i < l->count; i++)
        if (fabs(l->tone[i].frequency - frequency) < 2 * s->grid)
            return false;
    return true;
}

// T60 from there to the next window
static double falls(const double level[FIT_WINDOWS + 1], int w)
{
    double apart = 0.5 * (fit_windows[w + 1][0] + fit_windows[w + 1][1] - fit_windows[w][0] -
                          fit_windows[w][1]);
    return fmin(60 * apart / fmax(level[w] - level[w + 1], 0.1), 4);
}

// the highest peaks of a band
static void add_band(const spectrum *s, int from, int to, list *l)
{
    int first = l->count;
    for (int k = from > 1 ? from : 1; k < to && k < s->bins - 1; k++) {
        double here = s->level[k][s->window];
        if (!is_peak(s, k, l))
            continue;
        bool full = l->count == MODES || l->count - first == EACH;
        int at = full ? l->count - 1 : l->count++;
        if (at < first || (full && here < l->tone[at].energy))
            continue;
        for (; at > first && here > l->tone[at - 1].energy; at--)
            l->tone[at] = l->tone[at - 1];
        l->tone[at] = (tone){.frequency = s->lowest + s->grid * k,
                             .energy = here,
                             .t60 = fmax(falls(s->level[k], s->window), T60_LEAST)};
    }
}

// what no partial is: an onset's noise, what a hall leaves late
static bool add_peaks(const partials_sound *sound, int window, double down, list *l,
                      himc_error *error)
{
    static spectrum s; // large
    static double frequency[BINS] = {0};
    int first = l->count;
    s.window = window;
    s.grid = 1 / (fit_windows[window][1] - fit_windows[window][0]);
    s.lowest = PARTIALS_LINES + PEAKS_ABOVE;
    s.bins = (int)fmin(BINS, (fmin(0.45 * sound->rate, FIT_LIST_HIGHEST) - s.lowest) / s.grid);
    s.least = -INFINITY;
    for (int k = 0; k < s.bins; k++)
        frequency[k] = s.lowest + s.grid * k;
    if (!fit_levels(sound, frequency, s.bins, s.level))
        return himc_error_set(error, "out of memory");
    for (int i = 0; i < first; i++)
        s.least = fmax(s.least, l->tone[i].level[0] - down);
    double wide = pow(2, 1.0 / BANDS);
    for (double low = s.lowest; low < FIT_LIST_HIGHEST; low *= wide)
        add_band(&s, (int)((low - s.lowest) / s.grid), (int)((wide * low - s.lowest) / s.grid), l);
    return measure(sound, l->tone + first, l->count - first, error);
}

// level of the onset as an ear has it (dB)
static double heard(const tone *t)
{
    return t->level[0] + fmin(-20 * log10(mean(t, 0)), FALLEN) -
           20 * log10(1 + pow(HEARD / t->frequency, 2));
}

// the longest contact that has what the recording has
static void choose_mallet(list *l)
{
    double most = -INFINITY;
    l->contact = LONGEST;
    for (int i = 0; i < l->count; i++)
        most = fmax(most, heard(&l->tone[i]));
    for (int i = 0; i < l->count; i++) {
        double down = most - heard(&l->tone[i]);
        double times = fmin(HALVED * sqrt((LESS + down) / 6), GAP);
        if (down < MATTERS)
            l->contact = fmin(l->contact, times / l->tone[i].frequency);
    }
    l->contact = fmax(l->contact, SHORTEST);
    for (int i = 0; i < l->count; i++)
        l->tone[i].pressure = l->tone[i].amplitude / omega(&l->tone[i]);
}

// what is made of it (dB)
static double strength(const tone *t)
{
    return 20 * log10(t->pressure * omega(t)) + 10 * log10(t->t60);
}

static double find_pitch(const list *l, double tune)
{
    double strongest = -INFINITY, near = -INFINITY, pitch = tune, lowest = INFINITY;
    for (int i = 0; i < l->count; i++) {
        const tone *t = &l->tone[i];
        if (t->frequency > PITCH_LEAST)
            strongest = fmax(strongest, strength(t));
        if (tune > 0 && fabs(t->frequency / tune - 1) < PITCH_NEAR && strength(t) > near) {
            near = strength(t);
            pitch = t->frequency;
        }
    }
    if (near > strongest - PITCH_STRONG)
        return pitch;
    for (int i = 0; i < l->count; i++)
        if (strength(&l->tone[i]) > strongest - PITCH_STRONG && l->tone[i].frequency > PITCH_LEAST)
            lowest = fmin(lowest, l->tone[i].frequency);
    return isfinite(lowest) ? lowest : l->tone[0].frequency;
}

static const partial *nearest(const partials_list *partials, double frequency, double within)
{
    const partial *best = NULL;
    for (int k = 0; k < partials->count; k++)
        if (fabs(partials->row[k].frequency - frequency) < within) {
            best = &partials->row[k];
            within = fabs(best->frequency - frequency);
        }
    return best;
}

// the middle one of what the loudest are softer by than recorded (dB)
static double middle(const list *l, double (*made)[FIT_WINDOWS + 1])
{
    double softer[MODES];
    int count = 0, w;
    for (int i = 0; i < l->count && i < 15; i++) {
        loudest(&l->tone[i], &w);
        softer[count++] = l->tone[i].level[w] - made[i][w];
    }
    qsort(softer, (size_t)count, sizeof *softer, himc_order_doubles);
    return softer[count / 2];
}

// most that a mode is louder than recorded in any window (dB)
static double excess(const tone *t, const double made[FIT_WINDOWS + 1], double offset)
{
    int w;
    double most = -INFINITY, floor = loudest(t, &w) - SHOWN;
    double own = made[w] - 20 * log10(mean(t, w));
    for (w = 0; w < FIT_WINDOWS; w++)
        if (counts(t, w) && t->t60 < SEEN * fit_windows[w][1] + (w + 1 == FIT_WINDOWS) * T60_MOST) {
            double here = fmin(made[w], own + 20 * log10(mean(t, w)));
            most = fmax(most, here + offset - fmax(t->level[w], floor));
        }
    return most;
}

static double within(double x, double most)
{
    return fmin(fmax(x, -most), most);
}

// a mode whose level and decay follow the recording's spectrum
static void follow(tone *t, const double made[FIT_WINDOWS + 1], double offset, double part)
{
    int w;
    double floor = loudest(t, &w) - SHOWN, n = 0, st = 0, sd = 0, stt = 0, std = 0;
    for (w = 0; w < FIT_WINDOWS; w++) {
        double softer = t->level[w] - made[w] - offset, level = t->level[w];
        double at = w > 0 ? 0.5 * (fit_windows[w][0] + fit_windows[w][1]) : 0.3 * fit_windows[0][1];
        bool noise = level < floor || level < t->level[FIT_END] + OVER;
        if (!counts(t, w) || (noise && softer > 0))
            continue;
        double weight = fmax(level - floor, 5) / SHOWN;
        softer = within(softer, 2 * AT_ONCE_DB);
        n += weight, st += weight * at, sd += weight * softer;
        stt += weight * at * at, std += weight * at * softer;
    }
    if (n == 0)
        return;
    double spread = stt - st * st / n, slope = spread > 1e-6 ? (std - st * sd / n) / spread : 0;
    double decay = 60 / t->t60;
    slope = t->onset ? 0 : slope;
    slope *= part;
    double wanted = fmin(fmax(decay - slope, decay / AT_ONCE), decay * AT_ONCE);
    double onset = part * sd / n + (wanted - decay) * st / n;
    t->t60 = fmin(fmax(60 / wanted, fmax(T60_LEAST, CYCLES / t->frequency)), T60_MOST);
    t->pressure *= pow(10, within(onset, AT_ONCE_DB) / 20);
}

// the middle one of what lines are softer by than found (dB)
static double middle_line(const list *l, const partials_list *lines)
{
    double softer[MODES];
    int count = 0;
    for (int i = 0; i < l->count; i++) {
        const tone *t = &l->tone[i];
        const partial *best = t->line ? nearest(lines, t->frequency, NEAR) : NULL;
        if (best)
            softer[count++] = t->line->level - best->level;
    }
    qsort(softer, (size_t)count, sizeof *softer, himc_order_doubles);
    return count > 0 ? softer[count / 2] : 0;
}

// takes back what is louder or softer than recorded, or rings longer; at last only what is louder
static void correct(list *l, const partials_list *lines, double (*made)[FIT_WINDOWS + 1],
                    double part)
{
    double offset = middle(l, made), of_lines = middle_line(l, lines), least = INFINITY;
    for (int i = 0; i < l->count; i++) {
        tone *t = &l->tone[i];
        const partial *best = t->line ? nearest(lines, t->frequency, NEAR) : NULL;
        double over = excess(t, made[i], offset);
        if (best) {
            if (best->line)
                t->t60 *= fmin(fmax(t->line->t60 / best->t60, 1 / AT_ONCE), AT_ONCE);
            t->pressure *=
                pow(10, within(t->line->level - best->level - of_lines, AT_ONCE_DB) / 20);
        } else if (part > 0)
            follow(t, made[i], offset, part);
        else if (over > EXCESS)
            t->pressure *= pow(10, -over / 20);
        if (i < 5)
            least = fmin(least, t->pressure * omega(t) / t->amplitude);
    }
    for (int i = 0; i < l->count; i++) {
        tone *t = &l->tone[i];
        double most = pow(10, BOOST / 20) * least * t->amplitude / omega(t);
        t->pressure = t->line ? t->pressure : fmin(t->pressure, most);
    }
}

bool fit_list(const partials_sound *sound, partials_list *found, double radius, double *tune,
              const char *path, cli_file *file, partials_list *made, himc_error *error)
{
    static list l; // large
    l = (list){.louder = FIRST, .radius = radius};
    if (!choose(sound, found, &l, error))
        return false;
    if (!(found->room > 0)) // a hall's poles are there already
        add_onsets(&l);
    if (!add_peaks(sound, 0, ONSET_DOWN, &l, error) ||
        !add_peaks(sound, LATE, LATE_DOWN, &l, error))
        return false;
    choose_mallet(&l);
    for (int round = 0;; round++) {
        partials_sound heard = {.tracks = 0};
        static double level[MODES][FIT_WINDOWS + 1], frequency[MODES];
        double peak, loudness, rate = sound->rate < LOWEST_RATE ? RATE : sound->rate;
        l.pitch = find_pitch(&l, *tune);
        bool good = write(&l, path, file, error) &&
                    hear(file, rate, &heard, &peak, &loudness, error) &&
                    (round < ROUNDS || partials_find(&heard, FIT_LIST_HIGHEST, made, error));
        if (round < ROUNDS)
            made->count = 0;
        for (int i = 0; i < l.count; i++)
            frequency[i] = l.tone[i].frequency;
        good = good && (fit_levels(&heard, frequency, l.count, level) ||
                        himc_error_set(error, "out of memory"));
        made->room = round < ROUNDS ? 1 : found->room; // what beats there is a line here as well
        if (good)
            partials_lines(&heard, made);
        partials_sound_free(&heard);
        if (!good)
            return false;
        l.louder *= fmin(pow(10, (LOUDNESS - loudness) / 20), PEAK / peak);
        if (round == ROUNDS) {
            *tune = l.pitch;
            return write(&l, path, file, error);
        }
        correct(&l, made, level, round < 2 ? 1 : round < ROUNDS - LAST ? DAMPED : 0);
    }
}
