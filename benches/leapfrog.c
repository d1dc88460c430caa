/* A leapfrog for a bar of one material as one would write it by hand in C, without any damping: what `cargo bench` compares
 * barwave with. The grid, the time step and the three problems are those of benches/against_c.rs.
 *
 * Usage: leapfrog CELLS PROBLEM [STEPS WAVES]
 * Prints: steps, seconds of stepping, relative L1 error of the stress against the exact solution.
 * With STEPS: so many steps of a bar with free ends that moves as WAVES sine waves at first, so that every cell is at work;
 * in place of the error then 0.
 * Problem 1: elastic, struck at 10 m/s. 2: bilinear, isotropic hardening, 20 m/s. 3: power law as a table of 60 rows,
 * isotropic hardening, 20 m/s. Compression is positive here.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROWS = 60 };

static const double E = 200e9, RHO = 7800, YIELD = 200e6, TANGENT = 20e9, EXPONENT = 0.2, TABLE_END = 0.05, LENGTH = 1;

typedef struct {
    int cells, steps;
    double dt, dx;
    double *restrict v;      /* nodes: cells + 1 */
    double *restrict sigma;  /* cells */
    double *restrict state;  /* cells: yield stress (2), accumulated plastic strain (3) */
    int *restrict row;       /* cells: the table row in which the cell was last */
} Bar;

typedef struct {
    double strain[ROWS + 1], stress[ROWS + 1], slope[ROWS + 1];
} Table;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

/* sigma = YIELD (strain/yield strain)^EXPONENT, straight between rows whose strains form a geometric series. */
static Table power_law(void) {
    Table t = {{0}, {0}, {0}};
    const double ey = YIELD / E;
    for (int k = 1; k <= ROWS; k++) {
        t.strain[k] = ey * pow(TABLE_END / ey, (k - 1) / (ROWS - 1.0));
        t.stress[k] = YIELD * pow(t.strain[k] / ey, EXPONENT);
    }
    for (int k = 0; k < ROWS; k++)
        t.slope[k] = (t.stress[k + 1] - t.stress[k]) / (t.strain[k + 1] - t.strain[k]);
    t.slope[ROWS] = t.slope[ROWS - 1];
    return t;
}

static void stresses_elastic(Bar *bar) {
    const double gain = E * bar->dt / bar->dx;
    for (int i = 0; i < bar->cells; i++)
        bar->sigma[i] -= gain * (bar->v[i + 1] - bar->v[i]);
}

/* Radial return with linear isotropic hardening. */
static void stresses_bilinear(Bar *bar) {
    const double gain = E * bar->dt / bar->dx, hardening = E * TANGENT / (E - TANGENT);
    const double back = E / (E + hardening), raise = hardening / (E + hardening);
    for (int i = 0; i < bar->cells; i++) {
        const double trial = bar->sigma[i] - gain * (bar->v[i + 1] - bar->v[i]);
        double over = fabs(trial) - bar->state[i];
        over = over > 0 ? over : 0;
        bar->sigma[i] = trial - copysign(back * over, trial);
        bar->state[i] += raise * over;
    }
}

/* The stress is the lesser of the trial stress and the table at |trial|/E + p. */
static void stresses_table(Bar *bar, const Table *t) {
    const double gain = E * bar->dt / bar->dx;
    for (int i = 0; i < bar->cells; i++) {
        const double trial = bar->sigma[i] - gain * (bar->v[i + 1] - bar->v[i]);
        const double strain = fabs(trial) * (1 / E) + bar->state[i];
        int k = bar->row[i];
        while (k < ROWS && strain > t->strain[k + 1]) k++;
        while (k > 0 && strain < t->strain[k]) k--;
        bar->row[i] = k;
        const double limit = t->stress[k] + t->slope[k] * (strain - t->strain[k]);
        const double size = fabs(trial) < limit ? fabs(trial) : limit;
        bar->state[i] += (fabs(trial) - size) * (1 / E);
        bar->sigma[i] = copysign(size, trial);
    }
}

static void velocities(Bar *bar) {
    const double gain = bar->dt / (RHO * bar->dx);
    for (int i = 1; i < bar->cells; i++)
        bar->v[i] -= gain * (bar->sigma[i] - bar->sigma[i - 1]);
    bar->v[bar->cells] += 2 * gain * bar->sigma[bar->cells - 1];
}

static void advance(Bar *bar, int problem, double struck, int waves, const Table *t) {
    if (!waves) bar->v[0] = struck;
    if (problem == 1) stresses_elastic(bar);
    else if (problem == 2) stresses_bilinear(bar);
    else stresses_table(bar, t);
    velocities(bar);
    if (waves) bar->v[0] -= 2 * bar->dt / (RHO * bar->dx) * bar->sigma[0];
}

/* Exact stress behind the fronts of a long bar, at x/t. */
static double exact(int problem, double struck, double speed) {
    const double c0 = sqrt(E / RHO), c1 = sqrt(TANGENT / RHO);
    if (speed >= c0) return 0;
    if (problem == 1) return RHO * c0 * struck;
    if (problem == 2) return speed < c1 ? YIELD + RHO * c1 * (struck - YIELD / (RHO * c0)) : YIELD;
    /* c(strain) = c0 sqrt(n) (strain/ey)^((n-1)/2) and v = integral of c d strain. */
    const double n = EXPONENT, ey = YIELD / E, root = sqrt(n);
    const double largest = pow((struck / (c0 * ey) - 1) * (n + 1) / 2 / root + 1, 2 / (n + 1));
    const double ratio = pow(speed / (root * c0), 2 / (n - 1));
    return YIELD * pow(fmin(fmax(ratio, 1), largest), n);
}

int main(int argc, char **argv) {
    if (argc != 3 && argc != 5) return 2;
    const int n = atoi(argv[1]), problem = atoi(argv[2]), waves = argc == 5 ? atoi(argv[4]) : 0;
    const double c0 = sqrt(E / RHO), struck = problem == 1 ? 10 : 20, end = 0.8 * LENGTH / c0, dx = LENGTH / n;
    const int all = (int)ceil(end / (dx / c0) - 1e-9), steps = waves ? atoi(argv[3]) : all;
    Bar bar = {n, steps, end / all, dx, calloc(n + 1, sizeof(double)), calloc(n, sizeof(double)),
               calloc(n, sizeof(double)), calloc(n, sizeof(int))};
    if (!bar.v || !bar.sigma || !bar.state || !bar.row) return 1;
    for (int i = 0; problem == 2 && i < n; i++) bar.state[i] = YIELD;
    for (int i = 0; waves && i <= n; i++) bar.v[i] = struck * sin(2 * M_PI * waves * i / n);
    const Table table = power_law();

    const double start = now();
    for (int step = 0; step < steps; step++) advance(&bar, problem, struck, waves, &table);
    const double seconds = now() - start;

    double difference = 0, sum = 0;
    for (int i = 0; i < n; i++) {
        const double wanted = exact(problem, struck, (i + 0.5) * dx / end);
        difference += fabs(bar.sigma[i] - wanted);
        sum += fabs(wanted);
    }
    printf("%d %.9g %.6g\n", steps, seconds, waves ? 0 : difference / sum);
    return 0;
}
