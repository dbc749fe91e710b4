/* Where memory comes from, and a plan with a pointer for each of its sections. */
#ifndef RVMON_PLAN_VIEW_H
#define RVMON_PLAN_VIEW_H

#include "margins/measuring.h"

/* ---- memory.c: blocks of a few sizes, all given back at once */

#define SIZE_CLASSES (32 * sizeof(size_t)) /* four for each of its bits */

typedef struct chunk {
    struct chunk *next;
    struct chunk **link;       /* what points to it */
} chunk;

typedef struct {
    rv_memory from;
    chunk *chunks;
    char *free;
    size_t left;
    size_t used;               /* all that was handed out anew, together */
    void *spare[SIZE_CLASSES];
} arena;

void *arena_take(arena *a, size_t size);          /* zeroed; NULL: there is none */
void *arena_enlarge(arena *a, void *old, size_t size, size_t wanted); /* NULL: memory is short, it stays */
void arena_give(arena *a, void *block, size_t size);
void arena_move(arena *to, const arena *from);    /* `from` is not used any more */
void arena_release(arena *a);                     /* all of it */

/* ---- plan.c: the plan, checked, with a pointer for each section */

/* Clocks that one automaton may have. */
#define CLOCKS_MOST 64

/* An automaton with a pointer for each of its tables; see `automaton_plan`. */
typedef struct {
    const int32_t *class_of;
    const int32_t *bases;
    const int32_t *widths;
    const int32_t *strides;
    const int32_t *cut_first;
    const int64_t *cuts;
    const int32_t *edges;
    const int32_t *targets;
    const int32_t *sources;
    const int32_t *time_values;
    const int32_t *clause_first;
    const int32_t *test_first;
    const int32_t *tests;
    const int64_t *ages;
    int64_t gap;
    int64_t step;
    int32_t initial;
    int32_t locations;
    int32_t clocks;
    int32_t classes;
} machine;

/* A comparison of a signal with a constant, which one leaf shows; a Boolean one is compared with 0. */
typedef struct {
    double constant;
    uint64_t dirty;            /* its leaf, among those to be worked out, as a bit of a word */
    uint64_t dirty_word;       /* that word, likewise */
    int32_t word;
    int32_t atom;
    uint8_t truths[3];         /* by how a value stands to the constant */
} quick_compare;

/* A signal that a few of these read and nothing else, once all is born. */
typedef struct {
    const quick_compare *compares;
    int32_t count;
    int32_t kind;              /* of its values; RV_UNKNOWN: it is no such signal */
} quick_signal;

typedef struct {
    const part_plan *plan;
    const signal_plan *signals;
    const event_plan *events;
    const atom_plan *atoms;
    const node_plan *nodes;
    const judge_plan *judges;
    const form_plan *forms;
    const watch_plan *watches;
    const group_plan *groups;
    machine *machines;         /* by judge that has an automaton */
    int32_t *timed;            /* by timer, the node */
    int32_t *perishable;       /* by number among these, the signal */
    quick_signal *quick;       /* by signal */
    int32_t *networked;        /* judges that networks are, neither automata nor chains */
    int32_t networked_count;
    int32_t *slots;            /* by node, its number among those that notes tell of; -1: it is none */
    int32_t logged;            /* so many these are */
    bool has_episodes;         /* whether some attempt runs until its trigger is false */
    margin_readers readers[2]; /* by phase */
    bool restarts;             /* whether some failure may be followed by another attempt */
    bool is_traced;            /* whether it is counted where some attempts go */
    bool is_watched;           /* whether somebody asks for more than what becomes of attempts */
} part;

typedef struct {
    const plan_header *header;
    const int32_t *field_first;
    const int32_t *subscription_first;
    const subscription *subscriptions;
    const part_plan *parts;
    const signal_plan *signals;
    const event_plan *events;
    const atom_plan *atoms;
    const node_plan *nodes;
    const link_plan *links;
    const judge_plan *judges;
    const automaton_plan *automata;
    const form_plan *forms;
    const operator_plan *operators;
    const watch_plan *watches;
    const group_plan *groups;
    const number_plan *numbers;
    const int32_t *code;
    const int32_t *lists;
    const int32_t *ints;
    const int64_t *ticks;
    const margin_plan *margins; /* by judge */
    const measure_plan *measures;
    int64_t counts[SECTIONS];
    int32_t part_count;
} plan;

bool plan_view(plan *p, const void *bytes, size_t size);
machine machine_view(const plan *p, const automaton_plan *a);

#endif
