/* The arena that all memory of a monitor comes from, and typed views of the plan. */
#ifndef RVMON_PLAN_VIEW_H
#define RVMON_PLAN_VIEW_H

#include "margins/measuring.h"

/* ---- memory.c: blocks of a few sizes, all released at once */

#define SIZE_CLASSES (32 * sizeof(size_t)) /* four classes per power of two */

typedef struct chunk {
    struct chunk *next;
    struct chunk **link;       /* what points to it: `chunks` of the arena, or `next` of the one
                                * before */
} chunk;

typedef struct {
    rv_memory from;            /* where chunks come from */
    chunk *chunks;
    char *free;                /* unused rest of the newest chunk */
    size_t left;               /* bytes of that rest */
    size_t used;               /* bytes ever handed out, less those reused */
    void *spare[SIZE_CLASSES]; /* by size class, the list of blocks given back */
} arena;

void *arena_take(arena *a, size_t size);          /* zeroed; NULL: memory is short */
void *arena_enlarge(arena *a, void *old, size_t size, size_t wanted); /* NULL: memory is short, and
                                                                       * `old` stays valid */
void arena_give(arena *a, void *block, size_t size);
void arena_move(arena *to, const arena *from);    /* `from` must not be used any more */
void arena_release(arena *a);                     /* gives all memory back */

/* ---- plan.c: the checked plan, with a typed pointer for each section */

/* Most clocks of one automaton: lets a step keep the old ones on the stack. */
#define CLOCKS_MOST 64

/* An automaton with a pointer for each of its tables; `automaton_plan` says what each holds. */
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
    int64_t gap;               /* of the plan */
    int64_t step;              /* ticks from a position to the next: `gap`, or 1 */
    int32_t initial;
    int32_t locations;
    int32_t clocks;
    int32_t classes;
} machine;

/* A comparison of a signal with a constant whose one dependent is a leaf: see find_quick in
 * input/atoms.c. A Boolean signal is compared with 0. */
typedef struct {
    double constant;
    uint64_t dirty;            /* the bit of its leaf in that word of run.dirty */
    uint64_t dirty_word;       /* the bit of that word in its word of run.dirty_words */
    int32_t word;              /* index of that word in run.dirty */
    int32_t atom;
    uint8_t truths[3];         /* by IS_EQUAL, ...: the truth if the value is equal, less, greater */
} quick_compare;

/* A signal that in phase 1 only a few such comparisons read, so that its updates can skip the general
 * path. */
typedef struct {
    const quick_compare *compares;
    int32_t count;
    int32_t kind;              /* kind of its values; RV_UNKNOWN: not such a signal */
} quick_signal;

/* A part of the plan: its ranges of sections as pointers, and tables derived from them once. */
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
    machine *machines;         /* by judge; unset where there is no automaton */
    int32_t *timed;            /* by timer number, its node */
    int32_t *perishable;       /* by number among those that go stale, the signal */
    quick_signal *quick;       /* by signal */
    int32_t *pulses;           /* by atom, its leaf if nothing sees its end; else -1: input/pulses.c */
    int32_t *pulse_doubts;     /* by such an atom, the DOUBT above its leaf; -1: none */
    uint8_t *starts_only;      /* by event, whether it only starts attempts with captured values */
    uint8_t *unheard;          /* by node, whether it is the leaf of such an event */
    int32_t *pulsing;          /* by event, its one atom if only such a pulse reads it; else -1 */
    int32_t *networked;        /* judges decided by a network (not by a chain) */
    int32_t networked_count;
    int32_t *slots;            /* by node, its slot in truth_log; -1: notes do not describe it */
    int32_t logged;            /* number of such slots */
    bool has_unheard;          /* some node is `unheard` */
    bool has_episodes;         /* some judge is EPISODIC */
    margin_readers readers[2]; /* who reads what for margins, by phase */
    bool restarts;             /* some judge restarts after a failure */
    bool is_traced;            /* some judge is TRACED */
    bool is_watched;           /* it has watches or records truths over time */
} part;

#define SECTION_POINTER(name, field, record) const record *field;
typedef struct {
    const plan_header *header;
    PLAN_SECTIONS(SECTION_POINTER)
    int64_t counts[SECTIONS];  /* records of each section */
    int32_t part_count;
} plan;

bool plan_view(plan *p, const void *bytes, size_t size);
machine machine_view(const plan *p, const automaton_plan *a);

#endif
