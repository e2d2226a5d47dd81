/* silence.h: while DSP is off nothing plays.

That is told once, unless the message that switches it on comes behind in the same moment. A score
begins when it is on; what is for now, a hit or a strike, is left out. */
#ifndef SILENCE_H
#define SILENCE_H

#include "m_pd.h"

#define SILENCE_PATIENCE 20.0 /* from a message to the line that DSP is off (ms); chosen */

typedef struct t_silence {
    t_object *s_owner;
    t_clock *s_clock;
    bool s_told;        /* since it is off */
    const char *s_lost; /* by that, and not told: the name of the command; or NULL */
} t_silence;

static void silence_tell(t_silence *s)
{
    const char *name = class_getname(pd_class(&s->s_owner->ob_pd));
    if (!pd_getdspstate())
        logpost(s->s_owner, PD_NORMAL, "%s: DSP is off: nothing plays", name);
    else if (s->s_lost)
        logpost(s->s_owner, PD_NORMAL, "%s: %s: left out, it came before DSP was on", name,
                s->s_lost);
    s->s_lost = NULL;
}

static inline void silence_init(t_silence *s, t_object *owner)
{
    *s = (t_silence){.s_owner = owner, .s_clock = clock_new(s, (t_method)silence_tell)};
}

static inline void silence_free(t_silence *s)
{
    clock_free(s->s_clock);
}

/* From a dsp method. */
static inline void silence_over(t_silence *s)
{
    s->s_told = false;
}

/* True, and told, while nothing plays; `lost` is the name of what is left out, or NULL. */
static inline bool silence_holds(t_silence *s, const char *lost)
{
    if (pd_getdspstate())
        return false;
    if (!s->s_told)
        clock_delay(s->s_clock, SILENCE_PATIENCE);
    s->s_told = true;
    s->s_lost = lost ? lost : s->s_lost;
    return true;
}

#endif
