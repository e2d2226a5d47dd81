/// lesson_beat.h: the matched strokes of a lesson and the player's own beat through them.
#ifndef LESSON_BEAT_H
#define LESSON_BEAT_H

#include "lesson.h"

#define LESSON_SURE 2.6       ///< standard uncertainties of a 99 % bound
#define LESSON_FEWEST 4       ///< chosen: strokes of a group
#define LESSON_JND_TIME 0.006 ///< of short intervals, see lesson_jnd (s)

/// The matched strokes by asked time.
typedef struct lesson_course {
    int n;
    int *stroke, *segment; // of played strokes; waits divide segments
    double *asked, *played, *weight, *value[3], *scratch;
    double interval;   // median asked (s)
    double bend, half; // of a tempo that changes: bend u^2 (s), u from -1 to 1 within half (s); or
    double knee;       // at this asked time (s), NaN: none, by bend (s/s)
} lesson_course;

#define LESSON_UNEVEN_LEVEL 2.0 ///< of strokes that should be equally loud (dB)

extern const char lesson_time_source[], lesson_none_source[], lesson_uneven_source[];

/// The smallest shift of a stroke that listeners notice (s) in intervals of that length (s).
double lesson_jnd(double interval);
/// Sorts `x`.
double lesson_median(double *x, int n);
/// Standard deviation of the middle of `x`: 1.4826 times the median of magnitudes.
double lesson_spread(const lesson_course *c, const double *x);
/// y = b + a u + c u^2 by least squares, u from -1 to 1 over x; with standard uncertainties, which
/// grow with the correlation of neighbours.
void lesson_fit(const double *x, const double *y, int n, int terms, double p[3], double u[3]);
/// A standard deviation less its lower 99 % bound, by the chi-square of Wilson and Hilferty (1931).
double lesson_below(double sd, double free);
/// The player's beat at an asked time, by the line through the nearest strokes of the segment.
double lesson_beat_at(const lesson_course *c, double asked, int segment);
/// The matched strokes, with waits, left out phrases and the tempo judged; value[0] has the times
/// off the beat. False: no memory; free it all the same.
bool lesson_course_new(lesson *l, lesson_course *c);
void lesson_course_free(lesson_course *c);
/// Runs of equal fast strokes become rolls as well.
void lesson_find_runs(lesson *l);
/// Length, speed and evenness of the rolls.
void lesson_judge_rolls(lesson *l, const lesson_course *c);

#endif
