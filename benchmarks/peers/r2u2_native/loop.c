/* Runs R2U2's monitor over rows in memory, and prints the CPU time of the loop and, for each formula,
 * the first row at which it was false. A row has one byte per signal. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "r2u2.h"

static long *violated;
static long row;

static r2u2_status_t take(r2u2_mltl_instruction_t instruction, r2u2_verdict *verdict)
{
    if (!get_verdict_truth(*verdict) && violated[instruction.op2_value] < 0) {
        violated[instruction.op2_value] = row;
    }
    return R2U2_OK;
}

static unsigned char *read_all(const char *path, long *size)
{
    FILE *file = fopen(path, "rb");
    unsigned char *made;
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
        exit(2);
    }
    *size = ftell(file);
    rewind(file);
    made = malloc((size_t)*size);
    if (made == NULL || fread(made, 1, (size_t)*size, file) != (size_t)*size) {
        exit(2);
    }
    (void)fclose(file);
    return made;
}

static r2u2_monitor_t monitor = R2U2_DEFAULT_MONITOR;

int main(int argc, char **argv)
{
    if (argc != 5) {
        return 2;
    }
    const long signals = atol(argv[3]);
    const long formulas = atol(argv[4]);
    long size = 0;
    unsigned char *specification = read_all(argv[1], &size);
    const unsigned char *rows = read_all(argv[2], &size);
    const long count = size / signals;
    struct timespec began;
    struct timespec ended;
    violated = malloc((size_t)formulas * sizeof *violated);
    for (long i = 0; i < formulas; i++) {
        violated[i] = -1;
    }
    if (r2u2_load_specification(specification, &monitor) != R2U2_OK) {
        return 2;
    }
    monitor.out_func = take;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &began);
    for (row = 0; row < count; row++) {
        for (long i = 0; i < signals; i++) {
            r2u2_load_bool_signal(&monitor, (size_t)i, rows[row * signals + i] != 0);
        }
        if (r2u2_step(&monitor) != R2U2_OK) {
            return 3;
        }
    }
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ended);
    (void)printf("%lld", (ended.tv_sec - began.tv_sec) * 1000000000LL
                             + (ended.tv_nsec - began.tv_nsec));
    for (long i = 0; i < formulas; i++) {
        (void)printf(" %ld", violated[i]);
    }
    return 0;
}
