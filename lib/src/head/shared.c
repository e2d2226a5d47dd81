/// shared.c: what the lowest modes of a head send out, by direction.
///
/// A mode that moves with velocity v cos(w t) sends, far away in the direction q,
///     p = w W(q) (-i)^m v/R,
/// W its pressure per acceleration at 1 m (pickup.c). So it loses the power C v^2/2 with
///     C = int w^2 W^2 dq/(rho c)
/// over the half of all directions above the rim, and decays by C/(2 m): by that much less if the
/// air between the heads takes the power instead (air_between.c). Where air.h knows less of a
/// mode's loss than that, its sound counts for less.
///
/// They are the five lowest, (0,1), (1,1) and (2,1), one of each m and sign: what two of them send
/// out in all directions is orthogonal, so that a drum alone loses what air.h says, and its modes
/// stay apart.
#include "head/shared.h"

#include "head/pickup.h"

#include <math.h>

// Gauss and Legendre's six points in 0 .. 1
const double himc_shared_sine[HIMC_SHARED_RINGS] = {0.0337652428984240, 0.1693953067668677,
                                                    0.3806904069584015, 0.6193095930415985,
                                                    0.8306046932331323, 0.9662347571015760};
const double himc_shared_part[HIMC_SHARED_RINGS] = {0.0856622461895852, 0.1803807865240693,
                                                    0.2339569672863455, 0.2339569672863455,
                                                    0.1803807865240693, 0.0856622461895852};

// what it sends at all elevations; returns C
static double find_amplitudes(const himc_head *head, const himc_modes *modes, const himc_mode *mode,
                              himc_shared_mode *s)
{
    double c = 0, quarter = s->order > 0 ? HIMC_PI / (2 * s->order) : 0;
    double turn = s->order > 0 ? HIMC_PI : 2 * HIMC_PI; // integral of cos^2(m azimuth)
    for (int ring = 0; ring < HIMC_SHARED_RINGS; ring++) {
        himc_pickup to = {
            .kind = HIMC_PICKUP_AIR, .elevation = asin(himc_shared_sine[ring]), .distance = 1};
        double scale =
            s->omega * sqrt(himc_shared_part[ring] / (HIMC_AIR_DENSITY * HIMC_AIR_SPEED));
        s->along[ring] = scale * himc_pickup_pressure(&to, head, modes, s->index, mode);
        to.azimuth = quarter;
        s->across[ring] =
            s->order > 0 ? scale * himc_pickup_pressure(&to, head, modes, s->index, mode) : 0;
        c += turn * (s->along[ring] * s->along[ring] + s->across[ring] * s->across[ring]);
    }
    return c;
}

int himc_shared_find(const himc_head *head, const himc_modes *modes, const himc_air *air,
                     double highest, himc_shared_mode *shared)
{
    int count = 0;
    for (int i = 0; i < modes->count && count < HIMC_SHARED; i++) {
        himc_mode bare = himc_modes_get(modes, head, i);
        himc_mode mode = himc_air_mode(air, head, &bare);
        himc_shared_mode *s = &shared[count];
        if (mode.frequency > highest)
            continue;
        *s = (himc_shared_mode){
            .index = i, .order = mode.m, .omega = 2 * HIMC_PI * mode.frequency, .mass = mode.mass};
        double known = himc_air_on(air, mode.m, mode.n, mode.zero).radiation;
        double sent = find_amplitudes(head, modes, &mode, s) / (2 * s->mass);
        double part = sent > known ? sqrt(known / sent) : 1;
        s->decay = part * part * sent;
        for (int ring = 0; ring < HIMC_SHARED_RINGS; ring++) {
            s->along[ring] *= part;
            s->across[ring] *= part;
        }
        count++;
    }
    return count;
}

double himc_shared_by_other_orders(const himc_head *head, const himc_modes *modes, int index,
                                   const himc_mode *mode)
{
    double omega = 2 * HIMC_PI * mode->frequency, power = 0;
    himc_pickup_orders sent;
    for (int ring = 0; ring < HIMC_SHARED_RINGS; ring++) {
        himc_pickup to = {
            .kind = HIMC_PICKUP_AIR, .elevation = asin(himc_shared_sine[ring]), .distance = 1};
        if (!himc_pickup_find_orders(&to, head, modes, index, mode, &sent))
            return 0;
        for (int m = 0; m < HIMC_UNEVEN_ORDERS; m++) {
            double square = sent.cosine[m] * sent.cosine[m] + sent.sine[m] * sent.sine[m];
            double turn = m == 0 ? 2 * HIMC_PI : HIMC_PI;
            power += m == mode->m ? 0 : turn * himc_shared_part[ring] * square;
        }
    }
    return omega * omega * power / (HIMC_AIR_DENSITY * HIMC_AIR_SPEED) / (2 * mode->mass);
}
