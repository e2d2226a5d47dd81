/// fuzz_score.c: scores from arbitrary text. What is accepted is sorted, finite and in range, and
/// beats and seconds are each other's inverse.
#include "fuzz.h"
#include "plan/score.h"

#include <math.h>

static void check_strokes(const himc_score *score)
{
    for (int i = 0; i < score->stroke_count; i++) {
        const himc_stroke *s = &score->strokes[i];
        require(isfinite(s->beat) && s->beat >= 0, "a stroke has a beat");
        require(i == 0 || s->beat >= score->strokes[i - 1].beat, "strokes are sorted");
        require(s->dynamic >= 0 && s->dynamic <= 1, "a dynamic is 0 .. 1");
        require(isfinite(s->x) && isfinite(s->y), "a spot is finite");
        require((int)s->hand >= 0 && (int)s->hand < HIMC_HANDS && (int)s->nuance >= 0 &&
                    (int)s->nuance < HIMC_NUANCES,
                "a stroke has a hand and a nuance");
    }
}

static void check_tempi(const himc_score *score)
{
    require(score->tempo_count > 0 && score->tempi[0].beat == 0, "a tempo holds from beat 0");
    for (int i = 1; i < score->tempo_count; i++)
        require(score->tempi[i].beat >= score->tempi[i - 1].beat, "tempi are sorted");
    for (double beat = 0; beat < 1e5; beat = 3 * beat + 1) {
        double seconds = himc_score_seconds(score->tempi, score->tempo_count, beat);
        double back = himc_score_beat(score->tempi, score->tempo_count, seconds);
        require(fabs(back - beat) <= 1e-6 * (1 + beat), "beats and seconds are inverse");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    char *text = fuzz_text(data, size);
    himc_score *score = himc_score_parse(text, "fuzz.txt", NULL, &error);
    if (score) {
        check_strokes(score);
        check_tempi(score);
        for (int i = 0; i < score->line_count; i++)
            require(himc_command_table((int)score->lines[i].command.id) != NULL, "a line is known");
    } else {
        require_line(&error);
        require(strncmp(error.text, "fuzz.txt:", 9) == 0, "an error says where");
    }
    himc_score_free(score);
    free(text);
    return 0;
}
