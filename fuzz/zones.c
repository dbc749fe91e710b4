/* Entry point of the fuzzer: the bytes are a plan of the search through zones.
 *
 * Its magic number and the offsets of its sections are corrected. If the plan is accepted, it is
 * searched with bounds of 32 and of 64 bits, which must agree, and with limited memory. */
#include "zones.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool continues(void *context, uint64_t visited, uint64_t waiting)
{
    int *left = context;
    (void)visited;
    (void)waiting;
    return (*left)-- > 0;
}

static int diverges(void *context, const numbers *path, int32_t loop, const int64_t *head,
                    uint32_t dim)
{
    (void)context;
    if ((loop < 0) || (head[0] != 1) || (dim == 0)) { /* each loop has a start */
        abort();
    }
    return (path->count / 4) % 2 == 1;
}

static answer searched(const int32_t *plan, const double *costs, bool wide, uint64_t most_bytes)
{
    int left = 20;
    caller from = {&left, continues, diverges, 300, most_bytes, false};
    from.proper_only = (plan[HEAD_BOUND] % 2) == 1;
    return wide ? search_wide(plan, costs, &from) : search_narrow(plan, costs, &from);
}

static bool is_known(const answer *a)
{
    return (a->state != SEARCH_NO_MEMORY) && (a->state != SEARCH_TOO_LARGE);
}

static void compare(const int32_t *plan, const double *costs, uint32_t seed)
{
    answer narrow = searched(plan, costs, false, UINT64_C(1) << 24);
    answer wide = searched(plan, costs, true, UINT64_C(1) << 24);
    answer poor = searched(plan, costs, false, (narrow.peak > 0) ? seed % narrow.peak : 0);
    if (is_known(&narrow) && is_known(&wide)
        && ((narrow.state != wide.state) || (narrow.visited != wide.visited)
            || (narrow.part_count != wide.part_count)
            || (narrow.path.count != wide.path.count))) {
        abort();
    }
    if (is_known(&narrow) && is_known(&poor)) {
        abort(); /* it used more memory than it was allowed */
    }
    release_answer(&narrow);
    release_answer(&wide);
    release_answer(&poor);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const size_t head = HEAD_SECTIONS + 2 * SECTIONS;
    const size_t count = size / sizeof(int32_t);
    int32_t *plan;
    double *costs;
    int64_t at = (int64_t)head;
    uint32_t seed = 0;
    size_t i;
    if (count < head) {
        return 0;
    }
    plan = malloc(count * sizeof *plan);
    if (plan == NULL) {
        return 0;
    }
    (void)memcpy(plan, data, count * sizeof *plan);
    for (i = 0; i < count; i++) {
        seed = seed * 31 + (uint32_t)plan[i];
    }
    plan[HEAD_MAGIC] = PLAN_MAGIC;
    for (i = 0; (i < SECTIONS) && (at <= INT32_MAX); i++) {
        plan[HEAD_SECTIONS + 2 * i] = (int32_t)at;
        at += (int64_t)plan[HEAD_SECTIONS + 2 * i + 1] * plan_widths[i];
    }
    if (plan_check(plan, count) == PLAN_GOOD) {
        costs = calloc((size_t)plan_count(plan, AT_EDGES) + 1, sizeof *costs);
        if (costs != NULL) {
            compare(plan, costs, seed);
        }
        free(costs);
    }
    free(plan);
    return 0;
}
