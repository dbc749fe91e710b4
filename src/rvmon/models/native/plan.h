/* The plan of a search: one array of int32, made by `search_plan.py`, checked by plan.c.
 *
 * A head of numbers, then for each section where it begins and how many rows it has, then the rows.
 * Programs are bytecode for a stack of int64 and end with OP_END; a reference to one is its place in
 * the section of code, or -1 for none. A clock is a number from 1. An upper bound is OP 0 (<) or
 * 1 (<=), a lower one 2 (>=) or 3 (>). */
#ifndef RVMON_ZONES_PLAN_H
#define RVMON_ZONES_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PLAN_MAGIC 0x5a4e3031

enum {
    HEAD_MAGIC,
    HEAD_KIND,
    HEAD_POLICY,
    HEAD_CLOCKS,
    HEAD_TIMER,   /* whether one more clock, the last, belongs to the query */
    HEAD_LEVELLED, /* whether lower and upper limits are the same */
    HEAD_BOUND,   /* of a late response; 1 where a run has to let time pass on */
    HEAD_SETS,    /* of acceptance */
    HEAD_LOCALS,  /* the number of variables of functions, which come last */
    HEAD_WATCHED, /* whether the last automaton is a watcher */
    HEAD_SECTIONS
};

/* The kinds of search: for a run to a goal; to a goal with deadlocks; for one that stays inside for ever,
 * from the start or from a goal; for one that stays inside longer than the bound, from the start or from
 * a goal; for a run to a goal with nested path formulas; whether such a goal holds at the start; for a
 * run that an automaton accepts whose states are the pieces inside. */
enum { SEEK_GOAL, SEEK_DEADLOCK, SEEK_STAY, SEEK_STAY_AFTER, SEEK_LATE, SEEK_LATE_AFTER, SEEK_NESTED,
       SEEK_START, SEEK_RUN,       SEEK_KINDS };
enum { POLICY_SHORTEST, POLICY_FASTEST, POLICY_LIKELY, POLICIES };

enum {
    AT_VARIABLES, /* low, high, initial, whether a bool */
    AT_AUTOMATA,  /* first location, number of locations, initial one (counted from the first) */
    AT_LOCATIONS, /* as below */
    AT_EDGES,     /* as below, sorted by location */
    AT_ATOMS,     /* clock, op, program or -1, number */
    AT_LIMITS,    /* clock, whether of lower bounds, the largest number */
    AT_CODE,
    AT_TABLE,     /* constant arrays */
    AT_GOAL,      /* alternatives: condition or -1, first atom, number of atoms */
    AT_INSIDE,    /* the same for where runs stay, or for the goal where there is a deadlock */
    AT_EXTRA,     /* limits that hold in every location */
    AT_TREE,      /* nested formula, as below; the last row is the whole */
    AT_PIECES,    /* alternatives of plain rows of the tree */
    AT_WAYS,      /* of each alternative inside: as below */
    AT_ARCS,      /* where they lead */
    AT_RANKS,     /* priorities, if there are any: of automata, of no channel, of channels */
    SECTIONS
};

enum { LOC_KIND, LOC_INVARIANT, LOC_ATOM, LOC_ATOMS, LOC_LIMIT, LOC_LIMITS, LOC_EDGE, LOC_EDGES,
       LOC_SIZE };
enum { KIND_NORMAL, KIND_URGENT, KIND_COMMITTED };
enum { EDGE_AUTOMATON, EDGE_TARGET, EDGE_GUARD, EDGE_ATOM, EDGE_ATOMS,
       EDGE_UPDATE,  /* program or -1 */
       EDGE_CHANNEL, /* program or -1 */
       EDGE_FIRST, EDGE_STOP, /* the channels that it may be */
       EDGE_FLAGS, EDGE_SIZE };
/* An edge of the watcher with FLAG_WATCHES joins a move of the others: its guard reads locations and
 * variables after that move. Its other edges are moves of their own, which nothing blocks. */
enum { FLAG_SENDS = 1, FLAG_BROADCAST = 2, FLAG_URGENT = 4, FLAG_WATCHES = 8 };
enum { ROW_CONDITION, ROW_ATOM, ROW_ATOMS, ROW_SIZE };
enum { ATOM_CLOCK, ATOM_OP, ATOM_CODE, ATOM_NUMBER, ATOM_SIZE };
enum { LIMIT_CLOCK, LIMIT_LOWER, LIMIT_NUMBER, LIMIT_SIZE };
/* Whether runs start there, the sets of acceptance that it belongs to, its arcs. */
enum { WAY_STARTS, WAY_SETS, WAY_ARC, WAY_ARCS, WAY_SIZE };
enum { TREE_KIND, TREE_LEFT, TREE_RIGHT, TREE_BOUND, TREE_SIZE };
/* Alternatives; both rows; one of them; not the left one; some run has left until right (left -1:
 * anything); some stays in left; some next move leads to left (-1: anywhere). The bound is -1 where
 * there is none. */
enum { TREE_PLAIN, TREE_AND, TREE_OR, TREE_NOT, TREE_UNTIL, TREE_STAY, TREE_NEXT, TREE_KINDS };

enum {
    OP_END, OP_CONST, OP_VARIABLE,
    OP_INDEX,    /* first index, number: the offset in an extent; else it fails */
    OP_ROW,      /* number of elements: offset of a row times that, plus the next offset */
    OP_ELEMENT,  /* first slot, number: the variable at an offset */
    OP_LOOKUP,   /* first number of the table, number: the constant at an offset */
    OP_PLACE,    /* automaton, location (counted from its first): whether it is there */
    OP_NOT, OP_NEGATE, OP_TRUTH,
    OP_AND, OP_OR, OP_IMPLY, /* where to go on if the first operand decides */
    OP_UNLESS,   /* where to go on if it is false */
    OP_GO,
    OP_LT, OP_LE, OP_EQ, OP_NE, OP_GE, OP_GT, OP_ADD, OP_SUB, OP_MUL, OP_DIV, OP_MOD,
    OP_BIT_AND, OP_BIT_OR, OP_BIT_XOR, OP_LEFT, OP_RIGHT, OP_LEAST, OP_MOST,
    OP_INVERT,
    OP_SET,      /* a variable: it takes the value, if that is in its range */
    OP_STORE,    /* first slot, number: the variable at an offset takes the value on top of it */
    OP_CLOCK,    /* a clock: it is set */
    OP_CALL,     /* a program before this one: its value */
    OP_DROP,
    OP_HEAD,     /* where a loop begins */
    OP_BACK,     /* where the loop begins */
    OP_FAIL,     /* there is no value */
    OPS
};

#define MOST_CLOCKS 5000 /* a zone of so many has 100 MB */
#define MOST_TREE_ROWS 1000
#define MOST_PIECES 4000
#define MOST_SETS 28
#define STACK 256
#define MOST_NEST 60        /* calls in calls */
#define MOST_ROUNDS 1000000 /* of the loops of one computation */

extern const uint8_t plan_widths[SECTIONS];

typedef enum { PLAN_GOOD, PLAN_DAMAGED, PLAN_NO_MEMORY } plan_state;

/* Whether a plan is valid: nothing in it refers outside it. */
plan_state plan_check(const int32_t *plan, size_t count);

static inline const int32_t *plan_rows(const int32_t *plan, int section)
{
    return plan + plan[HEAD_SECTIONS + 2 * section];
}

static inline int32_t plan_count(const int32_t *plan, int section)
{
    return plan[HEAD_SECTIONS + 2 * section + 1];
}

#endif
