/* Feeds a generated monitor with the pattern of soak.py, again and again; see there.
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

static uint64_t counts[SOAK_RULES][3];
uint64_t bins[BINS]; /* not static: that all its pages are touched first is not left out */
static soak_monitor monitor;
static soak_attempt attempts[256];

static void on_record(void *user, const soak_record *record)
{
    (void)user;
    counts[record->requirement][record->verdict]++;
}

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
    static const soak_sample quiet;
    int64_t t = (argc == 4) ? strtoll(argv[2], NULL, 10) : 0;
    int64_t longest = 0, before = 0;
    uint64_t n, taken = 0;
    int rule;
    memset(bins, 1, sizeof bins);
    before = now();
    memset(bins, 0, sizeof bins);
    soak_init(&monitor, attempts, sizeof attempts / sizeof attempts[0], on_record, NULL);
    printf("{\"resident\":[%ld", resident_kib());
    for (n = 0; n < samples + tail; n++, t += STEP) {
        const soak_sample *sample = (n < samples) ? &pattern[n % ROWS] : &quiet;
        int64_t after;
        before = now();
        if (!soak_step(&monitor, t, sample)) {
            break;
        }
        after = now() - before;
        taken++;
        longest = (after > longest) ? after : longest;
        bins[(after / BIN_NS < BINS) ? after / BIN_NS : BINS - 1]++;
        if ((n < samples) && ((n + 1) % tenth == 0)) {
            printf(",%ld", resident_kib());
        }
    }
    (void)soak_finish(&monitor, INT64_MIN);
    printf("],\"taken\":%" PRIu64 ",\"longest\":%" PRId64 ",\"overflowed\":%d,\"counts\":[", taken,
           longest, soak_overflowed(&monitor));
    for (rule = 0; rule < SOAK_RULES; rule++) {
        printf("%s[%" PRIu64 ",%" PRIu64 ",%" PRIu64 "]", (rule > 0) ? "," : "", counts[rule][0],
               counts[rule][1], counts[rule][2]);
    }
    printf("],\"bins\":[");
    for (n = 0, rule = 0; n < BINS; n++) {
        if (bins[n] > 0) {
            printf("%s[%" PRIu64 ",%" PRIu64 "]", (rule++ > 0) ? "," : "", n, bins[n]);
        }
    }
    printf("]}\n");
    return 0;
}
