/* The plan of a search: one array of int32, made by `search_plan.py` and checked by plan.c.
 *
 * It has a head, then for each section its start and its number of rows, then the rows. Programs are
 * bytecode for a stack of int64 and end with OP_END; a reference to one is its start in the section of
 * code, or -1 for none. Clocks count from 1. An upper bound has the op 0 (<) or 1 (<=), a lower bound
 * 2 (>=) or 3 (>). */
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
    HEAD_TIMER,   /* 1 if the query has a clock of its own, which is then the last */
    HEAD_LEVELLED, /* 1 if lower and upper limits of each clock must be made equal */
    HEAD_BOUND,   /* of a late response; for runs of an automaton, 1 if time must diverge */
    HEAD_SETS,    /* number of acceptance sets */
    HEAD_LOCALS,  /* number of variables of functions, which come last */
    HEAD_WATCHED, /* 1 if the last automaton is a watcher */
    HEAD_SECTIONS
};

/* The kinds of search: for a run to a goal; to a goal with deadlocks; for a run that stays inside forever,
 * from the start or from a goal; for one that stays inside longer than the bound, from the start or from
 * a goal; for a run to a goal with nested path formulas; whether such a goal holds at the start; for a
 * run accepted by an automaton whose states are the pieces inside. */
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
    AT_INSIDE,    /* the same for the states to stay in, or for the goal in states with a deadlock */
    AT_EXTRA,     /* limits that apply in every location */
    AT_TREE,      /* nested formula, as below; the last row is the whole */
    AT_PIECES,    /* alternatives of plain rows of the tree */
    AT_BUCHI,      /* for each alternative inside, the state of the automaton, as below */
    AT_ARCS,      /* targets of the arcs of these states */
    AT_RANKS,     /* priorities, if any: of automata, of steps without channel, of channels */
    SECTIONS
};

enum { LOC_KIND, LOC_INVARIANT, LOC_ATOM, LOC_ATOMS, LOC_LIMIT, LOC_LIMITS, LOC_EDGE, LOC_EDGES,
       LOC_SIZE };
enum { KIND_NORMAL, KIND_URGENT, KIND_COMMITTED };
enum { EDGE_AUTOMATON, EDGE_TARGET, EDGE_GUARD, EDGE_ATOM, EDGE_ATOMS,
       EDGE_UPDATE,  /* program or -1 */
       EDGE_CHANNEL, /* program or -1 */
       EDGE_FIRST, EDGE_STOP, /* the range of channels that it may use */
       EDGE_FLAGS, EDGE_SIZE };
/* An edge of the watcher with FLAG_WATCHES joins a move of the others: its guard reads locations and
 * variables after that move. Its other edges are moves of their own, which nothing blocks. */
enum { FLAG_SENDS = 1, FLAG_BROADCAST = 2, FLAG_URGENT = 4, FLAG_WATCHES = 8 };
enum { ROW_CONDITION, ROW_ATOM, ROW_ATOMS, ROW_SIZE };
enum { ATOM_CLOCK, ATOM_OP, ATOM_CODE, ATOM_NUMBER, ATOM_SIZE };
enum { LIMIT_CLOCK, LIMIT_LOWER, LIMIT_NUMBER, LIMIT_SIZE };
/* Whether runs start in the state, its acceptance sets as bits, its arcs. */
enum { BUCHI_STARTS, BUCHI_SETS, BUCHI_ARC, BUCHI_ARCS, BUCHI_SIZE };
enum { TREE_KIND, TREE_LEFT, TREE_RIGHT, TREE_BOUND, TREE_SIZE };
/* Alternatives; both rows; one of both rows; not the left row; some run has left until right (left -1:
 * anything); some run stays in left; some next move leads to left (-1: anywhere). The bound is -1 if
 * there is none. */
enum { TREE_PLAIN, TREE_AND, TREE_OR, TREE_NOT, TREE_UNTIL, TREE_STAY, TREE_NEXT, TREE_KINDS };

enum {
    OP_END, OP_CONST, OP_VARIABLE,
    OP_INDEX,    /* first index, number: replaces an index by its offset; fails if it is outside */
    OP_ROW,      /* number of elements: combines the offset of a row with that in the row */
    OP_ELEMENT,  /* first slot, number: the variable at an offset */
    OP_LOOKUP,   /* first entry of the table, number: the constant at an offset */
    OP_PLACE,    /* automaton, location (counted from its first): whether it is there */
    OP_NOT, OP_NEGATE, OP_TRUTH,
    OP_AND, OP_OR, OP_IMPLY, /* where to continue if the first operand decides */
    OP_UNLESS,   /* where to continue if the value is false */
    OP_GO,
    OP_LT, OP_LE, OP_EQ, OP_NE, OP_GE, OP_GT, OP_ADD, OP_SUB, OP_MUL, OP_DIV, OP_MOD,
    OP_BIT_AND, OP_BIT_OR, OP_BIT_XOR, OP_LEFT, OP_RIGHT, OP_LEAST, OP_MOST,
    OP_INVERT,
    OP_SET,      /* a variable, which takes the value; fails outside its range */
    OP_STORE,    /* first slot, number: the variable at an offset takes the value on top of it */
    OP_CLOCK,    /* a clock, which is set to the value */
    OP_CALL,     /* an earlier program, which gives the value */
    OP_DROP,
    OP_HEAD,     /* the start of a loop */
    OP_BACK,     /* the head of the loop to repeat */
    OP_FAIL,     /* there is no value */
    OPS
};

#define MOST_CLOCKS 5000 /* a zone with so many takes 100 MB */
#define MOST_TREE_ROWS 1000
#define MOST_PIECES 4000
#define MOST_SETS 28
#define STACK 256
#define MOST_NEST 60        /* depth of nested calls */
#define MOST_ROUNDS 1000000 /* of all loops of one computation */

extern const uint8_t plan_widths[SECTIONS];

typedef enum { PLAN_GOOD, PLAN_DAMAGED, PLAN_NO_MEMORY } plan_state;

/* Whether a plan is valid, so that a search never reads outside it. */
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
