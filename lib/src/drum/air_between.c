/// air_between.c: the losses by sound of several heads, as one matrix.
///
/// Shared mode i of a drum at r sends a_i(q) exp(-i k q.r) v_i in the direction q (shared.h). All
/// together lose the power v'C v/2,
///     C_ij = sum_b w_b(f_i) w_b(f_j) Re sum_q a_i conj(a_j) exp(-i k_b q.(r_i - r_j)),
/// a Gram sum over directions q and bands b of frequency: no velocities can make it negative,
/// whatever the places, sizes and tunings. A frequency lies between two bands, half an octave
/// apart, with w^2 + w^2 = 1, so that modes in tune have the k of their frequency, and modes far
/// out of tune, which cannot move each other, no C_ij. Two drums in unison, d apart, have the ratio
/// j_0(kd) for (0,1), 3 j_1(kd)/kd for (1,1) across the line between them, as two poles and two
/// dipoles have. The reactive part and the time between them (2 ms) are left out.
///
/// The modes themselves are without these losses (himc_membrane_share). In its place, every
/// `himc_membrane_interval` samples t, all velocities change at once by the trapezoidal rule,
///     m (v' - v) = -t C (v + v')/2,
/// so that the kinetic energy changes by -t (v + v')'C(v + v')/8 <= 0, and no displacement changes.
/// Between exchanges each head is passive by itself. So the energy of all never grows.
///
/// The table of directions holds for distances up to REACH; drums farther apart do not hear each
/// other: there less than a tenth of a loss is shared.
#include "drum/air_between.h"

#include "base/head_frame.h"
#include "drum/membrane_state.h"

#include <math.h>
#include <string.h>

#define REACH 2.0          // (m) between the centres; chosen: a set of four, with room
#define LOWEST 30.0        // (Hz) of the bands; chosen: below the deepest timpano
#define BANDS_PER_OCTAVE 2 // chosen: k d hardly changes between two
#define LEAST 1e-13 // (m/s) a head at rest does not notice less; chosen: 260 dB below a stroke
#define MODES (HIMC_NEIGHBOURS * HIMC_SHARED)

static himc_membrane *head_of(const himc_air_between *air, int drum)
{
    return himc_drum_membrane(air->drum[drum]);
}

static int interval(const himc_air_between *air)
{
    return himc_membrane_interval(himc_drum_rate(air->drum[0]));
}

static bool in_air(himc_drum *drum)
{
    return himc_membrane_head(himc_drum_membrane(drum))->air;
}

static bool is_near(himc_drum *const *drums, int count, int i)
{
    bool near = false;
    himc_vec3 here = himc_drum_head_frame(drums[i])->center;
    for (int k = 0; k < count; k++) {
        himc_vec3 away = himc_vec3_sub(here, himc_drum_head_frame(drums[k])->center);
        near = near || (k != i && himc_vec3_length(away) < REACH && in_air(drums[k]));
    }
    return near && in_air(drums[i]);
}

// w_b of a frequency (rad/s)
static double weight_in(int band, double omega)
{
    double place = BANDS_PER_OCTAVE * log2(omega / (2 * HIMC_PI * LOWEST));
    double away = fabs(fmin(fmax(place, 0), HIMC_AIR_BANDS - 1) - band);
    return away < 1 ? cos(HIMC_PI / 2 * away) : 0;
}

// a shared mode with a part in a band
typedef struct sender {
    int at, drum; // in the matrix, in the air
    const himc_shared_mode *mode;
    double weight;
} sender;

// all of them; returns their number
static int find_senders(const himc_air_between *air, int band, sender *senders)
{
    int found = 0;
    for (int drum = 0; drum < air->count; drum++) {
        const himc_model *model = head_of(air, drum)->model;
        for (int i = 0; i < model->shared_count; i++) {
            const himc_shared_mode *mode = &model->shared[i];
            double weight = weight_in(band, mode->omega) * sqrt(2 * HIMC_PI / HIMC_AIR_AZIMUTHS);
            if (weight > 0)
                senders[found++] = (sender){air->first[drum] + i, drum, mode, weight};
        }
    }
    return found;
}

static himc_air_view view_from(const himc_drum *drum, himc_vec3 to)
{
    himc_head_frame level = *himc_drum_head_frame(drum);
    level.tilt = 0; // a tilt of some degrees turns no low mode's sound
    himc_vec3 x = himc_head_frame_away(&level);
    double across = hypot(to.x, to.y), nearer = himc_vec3_dot(level.center, to);
    double c = (x.x * to.x + x.y * to.y) / across, s = (x.x * to.y - x.y * to.x) / across;
    himc_air_view v = {.cosine = {1, c, c * c - s * s}, .sine = {0, s, 2 * s * c}};
    for (int band = 0; band < HIMC_AIR_BANDS; band++) {
        double k = 2 * HIMC_PI * LOWEST * exp2((double)band / BANDS_PER_OCTAVE) / HIMC_AIR_SPEED;
        v.re[band] = cos(k * nearer);
        v.im[band] = -sin(k * nearer);
    }
    return v;
}

// adds what all send in a direction to C
static void add_direction(const himc_air_between *air, const sender *senders, int n, int band,
                          int direction, double c[MODES][MODES])
{
    double re[MODES], im[MODES];
    int ring = direction / HIMC_AIR_AZIMUTHS;
    for (int i = 0; i < n; i++) {
        const himc_shared_mode *mode = senders[i].mode;
        const himc_air_view *v = &air->view[senders[i].drum][direction];
        int m = mode->order;
        double a = senders[i].weight *
                   (mode->along[ring] * v->cosine[m] + mode->across[ring] * v->sine[m]);
        double x = v->re[band], y = v->im[band];
        re[i] = a * (m == 1 ? y : m == 2 ? -x : x); // times (-i)^m
        im[i] = a * (m == 1 ? -x : m == 2 ? -y : y);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            c[senders[i].at][senders[j].at] += re[i] * re[j] + im[i] * im[j];
}

// solves a x = b, a symmetric with eigenvalues of 1 and more, for each of the n columns of b, in
// place; of a remains Cholesky's factor
static void solve(int n, double a[MODES][MODES], double b[MODES][MODES])
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = a[i][j];
            for (int k = 0; k < j; k++)
                sum -= a[i][k] * a[j][k];
            a[i][j] = i == j ? sqrt(sum) : sum / a[j][j];
        }
    for (int i = 0; i < n; i++)
        for (int column = 0; column < n; column++) {
            for (int k = 0; k < i; k++)
                b[i][column] -= a[i][k] * b[k][column];
            b[i][column] /= a[i][i];
        }
    for (int i = n - 1; i >= 0; i--)
        for (int column = 0; column < n; column++) {
            for (int k = i + 1; k < n; k++)
                b[i][column] -= a[k][i] * b[k][column];
            b[i][column] /= a[i][i];
        }
}

// With u = sqrt(m) v and S = C/sqrt(m_i m_j): u' - u = -t (1 + t S/2)^-1 S u.
static void find_change(himc_air_between *air)
{
    double sum[MODES][MODES], root[MODES]; // 1 + t S/2
    sender senders[MODES];
    double t = interval(air) / himc_drum_rate(air->drum[0]);
    int n = 0;
    for (int drum = 0; drum < air->count; drum++) {
        const himc_membrane *head = head_of(air, drum);
        air->first[drum] = n;
        air->revision[drum] = head->revision;
        for (int i = 0; i < head->model->shared_count; i++)
            root[n++] = sqrt(head->model->shared[i].mass);
    }
    air->first[air->count] = n;
    for (int i = 0; i < n; i++)
        memset(air->change[i], 0, sizeof air->change[i]);
    for (int band = 0; band < HIMC_AIR_BANDS; band++) {
        int found = find_senders(air, band, senders);
        for (int i = 0; found > 0 && i < HIMC_AIR_DIRECTIONS; i++)
            add_direction(air, senders, found, band, i, air->change);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            air->change[i][j] /= root[i] * root[j];
            sum[i][j] = (i == j) + 0.5 * t * air->change[i][j];
        }
    solve(n, sum, air->change);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            air->change[i][j] *= -t * root[j] / root[i];
}

void himc_air_between_join(himc_air_between *air, himc_drum *const *drums, int count)
{
    air->count = 0;
    for (int i = 0; i < count; i++) {
        bool near = air->count < HIMC_NEIGHBOURS && is_near(drums, count, i);
        himc_membrane_share(himc_drum_membrane(drums[i]), near);
        if (near)
            air->drum[air->count++] = drums[i];
    }
    // views of all drums, from everywhere, hang on the places alone, and tunings change more often
    for (int i = 0; i < HIMC_AIR_DIRECTIONS; i++) {
        double up = himc_shared_sine[i / HIMC_AIR_AZIMUTHS], across = sqrt(1 - up * up);
        double azimuth = 2 * HIMC_PI * (i % HIMC_AIR_AZIMUTHS) / HIMC_AIR_AZIMUTHS;
        himc_vec3 to = {across * cos(azimuth), across * sin(azimuth), up};
        for (int drum = 0; drum < air->count; drum++)
            air->view[drum][i] = view_from(air->drum[drum], to);
    }
    if (air->count > 0)
        find_change(air);
}

void himc_air_between_leave(himc_air_between *air, himc_drum *drum)
{
    for (int i = 0; i < air->count; i++)
        if (air->drum[i] == drum) {
            himc_membrane_share(himc_drum_membrane(drum), false);
            air->drum[i] = air->drum[--air->count];
        }
}

int himc_air_between_until(const himc_air_between *air, int64_t now, int n)
{
    if (air->count == 0)
        return n;
    int left = interval(air) - (int)(now % interval(air));
    return n < left ? n : left;
}

bool himc_air_between_due(const himc_air_between *air, int64_t now)
{
    return air->count > 0 && now % interval(air) == 0;
}

void himc_air_between_exchange(himc_air_between *air)
{
    double v[MODES], change[MODES], q;
    bool stale = false, moves = false;
    for (int drum = 0; drum < air->count; drum++) {
        const himc_membrane *head = head_of(air, drum);
        stale = stale || air->revision[drum] != head->revision;
        moves = moves || !himc_membrane_at_rest(head);
    }
    if (stale)
        find_change(air);
    if (!moves)
        return;
    for (int drum = 0; drum < air->count; drum++) {
        const himc_model *model = head_of(air, drum)->model;
        for (int i = 0; i < model->shared_count; i++)
            himc_bank_state(model->bank, model->shared[i].index, &q, &v[air->first[drum] + i]);
    }
    int n = air->first[air->count];
    for (int i = 0; i < n; i++) {
        change[i] = 0;
        for (int j = 0; j < n; j++)
            change[i] += air->change[i][j] * v[j];
    }
    for (int drum = 0; drum < air->count; drum++) {
        const himc_membrane *head = head_of(air, drum);
        const himc_model *model = head->model;
        const double *by = change + air->first[drum];
        double most = 0;
        for (int i = 0; i < model->shared_count; i++)
            most = fmax(most, fabs(by[i]));
        bool changes = !himc_membrane_at_rest(head) || most >= LEAST;
        for (int i = 0; i < model->shared_count && changes; i++)
            himc_bank_kick(model->bank, model->shared[i].index, by[i]);
    }
}
