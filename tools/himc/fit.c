#include "cli.h"
#include "fit_drum.h"
#include <math.h>
static const cli_option options[] = {{"output", 'o', "DRUM.txt", "the drum"}, {0}};
static int run(const cli_arguments *a)
{
    himc_error error;
    partials_sound sound = {0};
    static partials_list found;
    if (!partials_read(&sound, a->operand, &error) || !partials_find(&sound, 1200, &found, &error))
        return cli_fail(&cli_fit, "%s", error.text);
    printf("noise %.1f room %.2f\n", sound.noise, found.room);
    fit_drum d = {0};
    bool good = fit_drum_find(&found, &d, &error);
    for (int i = 0; i < found.count; i++) {
        partial *p = &found.row[i];
        if (p->clear > 6)
            printf("%8.2f +- %.2f  T60 %.2f +- %.2f  level %.1f energy %.1f clear %.1f\n", p->frequency,
               p->frequency_error, p->t60, p->t60_error, p->level, p->energy, p->clear);
    }
    if (!good)
        return cli_fail(&cli_fit, "%s", error.text);
    printf("drum %g tune %.2f decay %g %g score %.0f cents %.1f\n", d.inches, d.tune, d.constant, d.square, d.score, d.cents);
    fit_mode modes[60];
    int n = fit_drum_modes(&d, modes, &error);
    for (int i = 0; i < n; i++)
        if (modes[i].n == 1 && modes[i].m <= 6 && modes[i].m > 0)
            printf("  m %d %.2f %.2f found %.2f %.2f\n", modes[i].m, modes[i].frequency, modes[i].t60,
                   d.of[2*modes[i].m - 2+modes[i].sine] < 0 ? 0 : found.row[d.of[2*modes[i].m - 2+modes[i].sine]].frequency,
                   d.of[2*modes[i].m - 2+modes[i].sine] < 0 ? 0 : found.row[d.of[2*modes[i].m - 2+modes[i].sine]].t60);
    return 0;
}
const cli_call cli_fit = {"fit", "RECORDING", " -o DRUM.txt", "makes a drum of recorded strokes", "", options, run};
