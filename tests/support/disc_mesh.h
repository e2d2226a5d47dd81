/// disc_mesh.h: a disc of triangles as masses and springs, and files of it.
///
/// Rings of 6 k places; linear triangles. The mass is half consistent, half lumped, whose leading
/// errors cancel on regular triangles.
#ifndef HIMC_TEST_DISC_MESH_H
#define HIMC_TEST_DISC_MESH_H

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct disc_mesh {
    int rings, inner, all;
    double *x, *y, *mass, *stiffness; // (all), (all, all)
} disc_mesh;

static int ring_start(int k)
{
    return k == 0 ? 0 : 1 + 3 * k * (k - 1);
}

// adds the stiffness and mass of a triangle
static void add_triangle(disc_mesh *d, int a, int b, int c, double tension, double density)
{
    int p[3] = {a, b, c};
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = d->y[p[(i + 1) % 3]] - d->y[p[(i + 2) % 3]];
        v[i] = d->x[p[(i + 2) % 3]] - d->x[p[(i + 1) % 3]];
    }
    double area = 0.5 * fabs(u[0] * v[1] - u[1] * v[0]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int at = p[i] * d->all + p[j];
            d->stiffness[at] += tension * (u[i] * u[j] + v[i] * v[j]) / (4 * area);
            d->mass[at] += density * area * (i == j ? 0.25 : 0.5 / 12);
        }
}

static disc_mesh disc_mesh_new(int rings, double radius, double tension, double density)
{
    disc_mesh d = {rings, ring_start(rings), ring_start(rings + 1), NULL, NULL, NULL, NULL};
    d.x = calloc((size_t)d.all, sizeof(double));
    d.y = calloc((size_t)d.all, sizeof(double));
    d.mass = calloc((size_t)d.all * (size_t)d.all, sizeof(double));
    d.stiffness = calloc((size_t)d.all * (size_t)d.all, sizeof(double));
    for (int k = 1; k <= rings; k++)
        for (int i = 0; i < 6 * k; i++) {
            double angle = 3.14159265358979323846 * i / (3 * k), r = radius * k / rings;
            d.x[ring_start(k) + i] = r * cos(angle);
            d.y[ring_start(k) + i] = r * sin(angle);
        }
    for (int k = 0; k < rings; k++)
        for (int s = 0; s < 6; s++)
            for (int i = 0; i <= k; i++) {
                int in = 6 * k > 0 ? 6 * k : 1, out = 6 * (k + 1);
                int a = ring_start(k) + (s * k + i) % in;
                int b = ring_start(k + 1) + (s * (k + 1) + i) % out;
                int c = ring_start(k + 1) + (s * (k + 1) + i + 1) % out;
                add_triangle(&d, a, b, c, tension, density);
                if (i < k)
                    add_triangle(&d, a, c, ring_start(k) + (s * k + i + 1) % in, tension, density);
            }
    return d;
}

static void disc_mesh_free(disc_mesh *d)
{
    free(d->x);
    free(d->y);
    free(d->mass);
    free(d->stiffness);
}

static void write_market(const char *path, const disc_mesh *d, const double *value)
{
    FILE *f = fopen(path, "w");
    long entries = 0;
    for (int i = 0; i < d->inner; i++)
        for (int j = 0; j <= i; j++)
            entries += value[i * d->all + j] != 0;
    fprintf(f, "%%%%MatrixMarket matrix coordinate real symmetric\n%% a disc\n%d %d %ld\n",
            d->inner, d->inner, entries);
    for (int i = 0; i < d->inner; i++)
        for (int j = 0; j <= i; j++)
            if (value[i * d->all + j] != 0)
                fprintf(f, "%d %d %.17g\n", i + 1, j + 1, value[i * d->all + j]);
    fclose(f);
}

static void write_rows(const char *path, const disc_mesh *d, const double *value)
{
    FILE *f = fopen(path, "w");
    for (int i = 0; i < d->inner; i++) {
        for (int j = 0; j < d->inner; j++)
            fprintf(f, "%.17g ", value[i * d->all + j]);
        fputc('\n', f);
    }
    fclose(f);
}

// writes the head's files into `folder`; the head itself is head.txt
static void disc_mesh_write(const disc_mesh *d, const char *folder, double tension, double density)
{
    char path[300];
    snprintf(path, sizeof path, "%s/k.mtx", folder);
    write_market(path, d, d->stiffness);
    snprintf(path, sizeof path, "%s/m.mtx", folder);
    write_market(path, d, d->mass);
    snprintf(path, sizeof path, "%s/k.txt", folder);
    if (d->inner < 500)
        write_rows(path, d, d->stiffness);
    snprintf(path, sizeof path, "%s/places.txt", folder);
    FILE *f = fopen(path, "w");
    fprintf(f, "# x y (m); the rim comes last\n");
    for (int i = 0; i < d->all; i++)
        fprintf(f, "%.17g %.17g\n", d->x[i], d->y[i]);
    fclose(f);
    snprintf(path, sizeof path, "%s/head.txt", folder);
    f = fopen(path, "w");
    fprintf(f,
            "# a disc\ntension %g\ndensity %g\n\nplaces places.txt\nmass m.mtx\nstiffness k.mtx\n",
            tension, density);
    fclose(f);
}

#endif
