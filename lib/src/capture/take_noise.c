/// take_noise.c: the noise of a tracker: normal deviates (Box & Muller 1958) of a counter that
/// is scrambled (Steele, Lea & Flood 2014), so that a seed gives the same noise everywhere.
#include "capture/take_data.h"

// uniform in (0, 1]
static double uniform(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return ldexp((double)((z ^ (z >> 31)) >> 11) + 1, -53);
}

static double normal(uint64_t *state)
{
    double radius = sqrt(-2 * log(uniform(state)));
    return radius * cos(2 * HIMC_PI * uniform(state));
}

void himc_take_add_noise(himc_take *take, double deviation, uint64_t seed)
{
    for (size_t i = 0; i < (size_t)take->frames * (size_t)take->points; i++) {
        himc_vec3 *x = &take->x[i];
        x->x += deviation * normal(&seed);
        x->y += deviation * normal(&seed);
        x->z += deviation * normal(&seed);
    }
}
