/* What the files of the plan check share. Each check_... returns false as soon as a record is
 * wrong. They rely on each other's order: wrong_in_part in plan.c runs them so that a check reads
 * only what earlier ones have validated. */
#ifndef RVMON_PLAN_CHECK_H
#define RVMON_PLAN_CHECK_H

#include "basics.h"

#define MOST INT32_MAX
/* Limits on all event fields, and on the values that a requirement captures: keep sizes in 32 bits. */
#define FIELDS_MOST (1 << 20)
#define CAPTURED_MOST 1023
/* Limit on the coverage items of a part. */
#define ITEMS_MOST (1 << 22)

/* Whether a section holds `count` records from `first` on. */
static inline bool has(const plan *p, int32_t which, int64_t first, int64_t count)
{
    return (first >= 0) && (count >= 0) && (first + count <= p->counts[which]);
}

/* Whether a list lies in SEC_LISTS and all its numbers are in [low, end). */
static inline bool lists(const plan *p, list l, int64_t low, int64_t end)
{
    int32_t i;
    if (!has(p, SEC_LISTS, l.first, l.count)) {
        return false;
    }
    for (i = 0; i < l.count; i++) {
        if (!is_within(p->lists[l.first + i], low, end)) {
            return false;
        }
    }
    return true;
}

/* The same for the lists of both phases. */
static inline bool both(const plan *p, const list *phases, int64_t low, int64_t end)
{
    return lists(p, phases[0], low, end) && lists(p, phases[1], low, end);
}

/* Whether count + 1 offsets start at 0, never decrease, and end at `end`. */
static inline bool ascends(const int32_t *first, int64_t count, int64_t end)
{
    int64_t i;
    if (first[0] != 0) {
        return false;
    }
    for (i = 0; i < count; i++) {
        if (first[i + 1] < first[i]) {
            return false;
        }
    }
    return first[count] == end;
}

static inline bool is_distance(int64_t t)
{
    return (t > -LIMIT) && (t < LIMIT);
}

/* ---- plan_formulas.c */
bool check_inputs(const plan *p, const part_plan *x);
bool check_atoms(const plan *p, const part_plan *x);
bool check_nodes(const plan *p, const part_plan *x);

/* ---- plan_judges.c */
bool check_automaton(const plan *p, const automaton_plan *a);
bool check_judge(const plan *p, const part_plan *x, int32_t number);
bool check_operators(const plan *p, const part_plan *x, list operators, int32_t leaves);
bool check_forms(const plan *p, const part_plan *x);
bool check_watches(const plan *p, const part_plan *x);
bool check_groups(const plan *p, const part_plan *x);

/* ---- plan_formulas.c: margins */
bool check_margins(const plan *p, const part_plan *x);

#endif
