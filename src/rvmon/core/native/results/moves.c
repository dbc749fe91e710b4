/* Where attempts go in automata: from which location to which, how often, and when first. Automata are
 * shared by all of one shape; counts are each judge's own. */
#include "results/results.h"

#include <string.h>

static bool is_traced(const home *h, int32_t index)
{
    return (h->part->judges[index].flags & JUDGE_TRACED) != 0;
}

static int32_t pairs_of(const home *h, int32_t index)
{
    const int32_t locations = h->part->machines[index].locations;
    return locations * locations;
}

/* Begin a run: nothing went anywhere; false: memory is short. */
bool begin_moves(home *h)
{
    const int32_t judges = h->part->plan->judges.count;
    arena *a = &h->monitor->memory;
    int32_t i;
    if (h->moves == NULL) {
        h->moves = arena_take(a, (size_t)judges * sizeof *h->moves);
    }
    for (i = 0; (h->moves != NULL) && (i < judges); i++) {
        const size_t size = is_traced(h, i) ? (size_t)pairs_of(h, i) * sizeof(rv_hit) : 0;
        if (is_traced(h, i) && (h->moves[i] == NULL)) {
            h->moves[i] = arena_take(a, size);
            if (h->moves[i] == NULL) {
                return false;
            }
        }
        if (is_traced(h, i)) {
            (void)memset(h->moves[i], 0, size);
        }
    }
    return h->moves != NULL;
}

void count_move(const machine *a, rv_hit *moves, int32_t from, int32_t to, int64_t count, int64_t t)
{
    rv_hit *one = &moves[from * a->locations + to];
    one->first = ((one->count == 0) || (t < one->first)) ? t : one->first;
    one->count += count;
}

/* An attempt of a judge begins at `t`. */
void count_begin(run *r, int32_t index, int64_t t)
{
    const machine *a = &r->part->machines[index];
    rv_hit *moves = moves_of(r, index);
    if (moves != NULL) {
        count_move(a, moves, a->initial, a->initial, 1, t);
    }
}

const rv_hit *rv_moves(const rv_monitor *m, int32_t requirement, int32_t *locations)
{
    int32_t i;
    int32_t k;
    *locations = 0;
    for (i = 0; i < m->plan.part_count; i++) {
        const home *h = &m->homes[i];
        for (k = 0; (h->moves != NULL) && (k < h->part->plan->requirements); k++) {
            if ((h->part->judges[k].requirement == requirement) && (h->moves[k] != NULL)) {
                *locations = h->part->machines[k].locations;
                return h->moves[k];
            }
        }
    }
    return NULL;
}
