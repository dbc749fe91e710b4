/* Feeds the core with the pattern of soak.py, again and again; see there.
 *
 *   soak PERIODS FIRST-NANOSECOND TAIL
 */
#include "pattern.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define STEP INT64_C(1000000)
#define BINS 400000
#define BIN_NS 10

uint64_t bins[BINS]; /* not static: that all its pages are touched first is not left out */

static int64_t now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static long resident_kib(void)
{
    long size = 0, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if ((file == NULL) || (fscanf(file, "%ld %ld", &size, &pages) != 2)) {
        exit(1);
    }
    fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

int main(int argc, char **argv)
{
    const uint64_t samples = (argc == 4) ? strtoull(argv[1], NULL, 10) * ROWS : 0;
    const uint64_t tail = (argc == 4) ? strtoull(argv[3], NULL, 10) : 0;
    const uint64_t tenth = (samples / 10 > 0) ? samples / 10 : 1;
    const rv_memory memory = {malloc, realloc, free, NULL, 0};
    rv_monitor *monitor = rv_new(plan, sizeof plan, memory);
    int64_t t = (argc == 4) ? strtoll(argv[2], NULL, 10) : 0;
    int64_t longest = 0, before = 0;
    uint64_t n, taken = 0;
    int32_t rule, shown = 0;
    if (monitor == NULL) {
        return 1;
    }
    memset(bins, 1, sizeof bins);
    before = now();
    memset(bins, 0, sizeof bins);
    printf("{\"resident\":[%ld", resident_kib());
    for (n = 0; n < samples + tail; n++, t += STEP) {
        const int32_t row = (int32_t)(n % ROWS);
        const int32_t count = (n < samples) ? first[row + 1] - first[row] : 0;
        int64_t after;
        before = now();
        if (rv_step(monitor, t, &updates[first[row]], count) != RV_OK) {
            break;
        }
        rv_forget_records(monitor);
        after = now() - before;
        taken++;
        longest = (after > longest) ? after : longest;
        bins[(after / BIN_NS < BINS) ? after / BIN_NS : BINS - 1]++;
        if ((n < samples) && ((n + 1) % tenth == 0)) {
            printf(",%ld", resident_kib());
        }
    }
    (void)rv_finish(monitor, RV_NO_TIME);
    printf("],\"taken\":%" PRIu64 ",\"longest\":%" PRId64 ",\"counts\":[", taken, longest);
    for (rule = 0; rule < rv_sizes_of(monitor).requirements; rule++) {
        const rv_counts c = rv_count(monitor, rule);
        printf("%s[%" PRId64 ",%" PRId64 ",%" PRId64 "]", (rule > 0) ? "," : "", c.failed, c.passed,
               c.inconclusive);
    }
    printf("],\"bins\":[");
    for (n = 0; n < BINS; n++) {
        if (bins[n] > 0) {
            printf("%s[%" PRIu64 ",%" PRIu64 "]", (shown++ > 0) ? "," : "", n, bins[n]);
        }
    }
    printf("]}\n");
    rv_free(monitor);
    return 0;
}
