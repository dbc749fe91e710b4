/* The check of a plan: what plan.c, plan_formulas.c and plan_judges.c share. */
#ifndef RVMON_PLAN_CHECK_H
#define RVMON_PLAN_CHECK_H

#include "basics.h"

#define MOST INT32_MAX
/* Fields that all events have, and values that attempts of a requirement capture: so many at most. */
#define FIELDS_MOST (1 << 20)
#define CAPTURED_MOST 1023
/* Items that all groups of a part have: so many at most. */
#define ITEMS_MOST (1 << 22)

/* Whether so many records from `first` on lie in a section. */
static inline bool has(const plan *p, int32_t which, int64_t first, int64_t count)
{
    return (first >= 0) && (count >= 0) && (first + count <= p->counts[which]);
}

/* A list of numbers that are at least `low` and less than `behind`. */
static inline bool lists(const plan *p, list l, int64_t low, int64_t behind)
{
    int32_t i;
    if (!has(p, SEC_LISTS, l.first, l.count)) {
        return false;
    }
    for (i = 0; i < l.count; i++) {
        if (!is_within(p->lists[l.first + i], low, behind)) {
            return false;
        }
    }
    return true;
}

static inline bool both(const plan *p, const list *phases, int64_t low, int64_t behind)
{
    return lists(p, phases[0], low, behind) && lists(p, phases[1], low, behind);
}

/* Whether numbers ascend from 0 to the end of what they count. */
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

/* ---- plan_formulas.c: what is measured */
bool check_margins(const plan *p, const part_plan *x);

#endif
