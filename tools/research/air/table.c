/// table.c: computes lib/src/head/air_table.c (a minute): `make air-table`.
#include "galerkin.h"

#include <math.h>
#include <stdio.h>

// 20, 23, 26, 29 and 32 inches (m)
static const double RADIUS[HIMC_AIR_DRUMS] = {0.254, 0.292, 0.328, 0.368, 0.406};

static short ratio[HIMC_AIR_ENTRIES], decay[HIMC_AIR_ENTRIES];
static double outer[HIMC_AIR_ORDERS][HIMC_AIR_RANKS], inner[HIMC_AIR_ORDERS][HIMC_AIR_RANKS];
static double slosh[HIMC_AIR_ORDERS];

// added masses at rest
static void solve_at_rest(const himc_air_order *order)
{
    double real[HIMC_AIR_BASIS][HIMC_AIR_BASIS], loss[HIMC_AIR_BASIS][HIMC_AIR_BASIS];
    double inside[HIMC_AIR_BASIS][HIMC_AIR_BASIS];
    himc_air_outside(order, 0, real, loss);
    himc_air_inside(order, 0, HIMC_AIR_KETTLE_SHAPE / HIMC_PI, inside);
    for (int n = 0; n < HIMC_AIR_RANKS; n++) {
        double norm = order->next[n] * order->next[n] / 2;
        outer[order->m][n] = real[n][n] / norm;
        inner[order->m][n] = inside[n][n] / norm;
    }
    slosh[order->m] = order->beta[order->m == 0];
}

// the modes (m, 1 .. HIMC_AIR_RANKS) of one drum at one tension
static bool solve_node(const himc_air_order *order, int drum, int k, himc_error *error)
{
    double tension = HIMC_AIR_TABLE_LOW *
                     pow(HIMC_AIR_TABLE_HIGH / HIMC_AIR_TABLE_LOW, k / (HIMC_AIR_NODES - 1.0));
    himc_air_problem problem = {
        .tension = tension / (HIMC_AIR_TABLE_FILM * HIMC_AIR_SPEED * HIMC_AIR_SPEED),
        .loading = HIMC_AIR_DENSITY * RADIUS[drum] / HIMC_AIR_TABLE_FILM,
        .depth = HIMC_AIR_KETTLE_SHAPE / HIMC_PI,
        .quality = HIMC_AIR_KETTLE_QUALITY,
    };
    himc_air_root root[HIMC_AIR_RANKS];
    if (!himc_air_oscillators(order, &problem, HIMC_AIR_RANKS, root, error))
        return false;
    for (int n = 0; n < HIMC_AIR_RANKS; n++) {
        double bare = order->alpha[n] * sqrt(problem.tension);
        int i = HIMC_AIR_ROW(drum, order->m, n) + k;
        ratio[i] = (short)lround(log(root[n].x / bare) / HIMC_AIR_RATIO_UNIT);
        decay[i] =
            (short)lround(log(fmax(root[n].decay, 0) + HIMC_AIR_FLOOR) / HIMC_AIR_DECAY_UNIT);
    }
    return true;
}

static void print_table(const char *name, const short *table)
{
    printf("\nconst short %s[HIMC_AIR_ENTRIES] = {\n", name);
    for (int i = 0; i < HIMC_AIR_ENTRIES; i++)
        printf("%d,%s", table[i], i % HIMC_AIR_NODES == HIMC_AIR_NODES - 1 ? "\n" : "");
    puts("};");
}

static void print_masses(const char *name, double table[][HIMC_AIR_RANKS])
{
    printf("\nconst double %s[HIMC_AIR_ORDERS][HIMC_AIR_RANKS] = {\n", name);
    for (int m = 0; m < HIMC_AIR_ORDERS; m++)
        printf("    {%.6f, %.6f, %.6f, %.6f},\n", table[m][0], table[m][1], table[m][2],
               table[m][3]);
    puts("};");
}

static void print_all(void)
{
    puts("/// air_table.c: the modes of five timpani in air (make air-table).\n"
         "///\n"
         "/// A row is a mode over the tensions; rows go by n, then m, then drum.\n"
         "#include \"head/air.h\"\n\n"
         "// clang-format off");
    printf("const double himc_air_radius[HIMC_AIR_DRUMS] = {%g, %g, %g, %g, %g};\n", RADIUS[0],
           RADIUS[1], RADIUS[2], RADIUS[3], RADIUS[4]);
    print_masses("himc_air_outer", outer);
    print_masses("himc_air_inner", inner);
    puts("\nconst double himc_air_slosh[HIMC_AIR_ORDERS] = {");
    for (int m = 0; m < HIMC_AIR_ORDERS; m++)
        printf("    %.7f,\n", slosh[m]);
    puts("};");
    print_table("himc_air_ratio", ratio);
    print_table("himc_air_decay", decay);
}

int main(void)
{
    himc_error error;
    himc_air_order order;
    for (int m = 0; m < HIMC_AIR_ORDERS; m++) {
        himc_air_order_make(&order, m);
        solve_at_rest(&order);
        for (int drum = 0; drum < HIMC_AIR_DRUMS; drum++)
            for (int k = 0; k < HIMC_AIR_NODES; k++)
                if (!solve_node(&order, drum, k, &error)) {
                    fprintf(stderr, "%s\n", error.text);
                    return 1;
                }
    }
    print_all();
    return 0;
}
