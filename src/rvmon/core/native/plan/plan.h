/* The plan as C sees it: sections of records of fixed size. plan.md says what each means, `plan.py`
 * packs them, `plan.c` checks every index and size before anything else reads them.
 *
 * All records are made of int32 and int64, so their layout is the same everywhere. */
#ifndef RVMON_PLAN_H
#define RVMON_PLAN_H

#include "core.h"

enum {
    SEC_FIELD_FIRST,           /* int32[events + 1]: the first field of each event */
    SEC_SUBSCRIPTION_FIRST,    /* int32[names + 1] */
    SEC_SUBSCRIPTIONS,         /* subscription[]: which parts read a name */
    SEC_PARTS,                 /* part_plan[] */
    SEC_SIGNALS,               /* signal_plan[] */
    SEC_EVENTS,                /* event_plan[] */
    SEC_ATOMS,                 /* atom_plan[] */
    SEC_NODES,                 /* node_plan[] */
    SEC_LINKS,                 /* link_plan[] */
    SEC_JUDGES,                /* judge_plan[] */
    SEC_AUTOMATA,              /* automaton_plan[] */
    SEC_FORMS,                 /* form_plan[] */
    SEC_OPERATORS,             /* operator_plan[] */
    SEC_WATCHES,               /* watch_plan[] */
    SEC_GROUPS,                /* group_plan[] */
    SEC_NUMBERS,               /* number_plan[]: constants of programs */
    SEC_CODE,                  /* int32[]: programs, and what of them is not an index of its own */
    SEC_LISTS,                 /* int32[]: all lists of indices */
    SEC_INTS,                  /* int32[]: tables of automata and diagrams */
    SEC_TICKS,                 /* int64[]: cuts and ages of automata */
    SEC_MARGINS,               /* margin_plan[]: of each judge what is measured; or none */
    SEC_MEASURES,              /* measure_plan[] */
    SECTIONS
};

#define PLAN_MAGIC "rvmonpl1"
#define PLAN_ORDER UINT32_C(0x01020304)

typedef struct {
    char magic[8];
    uint32_t order;            /* that of the bytes of a number */
    int32_t sections;
    int64_t size;              /* of all, this header among it */
    uint64_t hash;             /* FNV-1a of the words of 8 bytes behind the header */
    int64_t gap;               /* ticks between two positions; 0: only samples are positions */
    int32_t signals;
    int32_t events;
    int32_t fields;
    int32_t requirements;
    int32_t captured;          /* the most values that an attempt has */
    int32_t filling;           /* 0 */
} plan_header;

typedef struct {
    int64_t offset;            /* from the begin of the plan, a multiple of 8 */
    int64_t count;             /* of records */
} section;

/* Indices that stand one behind the other in SEC_LISTS. */
typedef struct {
    int32_t first;
    int32_t count;
} list;

typedef struct {
    int32_t part;
    int32_t local;             /* the signal or event there; events count from 0, too */
} subscription;

/* Some requirements that are judged together; those with values of their own are alone. */
enum { PART_REPLAYS = 1, PART_FRESH = 2, PART_FORGETS = 4, PART_KEEPS_PAST = 8, PART_CAPTURES_NOW = 16 };

typedef struct {
    list signals;              /* records of SEC_SIGNALS; so with what follows */
    list events;
    list atoms;
    list nodes;
    list judges;               /* the requirements, then what judges attempts in doubt */
    list forms;
    int32_t requirements;      /* so many of the judges are requirements */
    int32_t fields;            /* of its events, together */
    int32_t timers;            /* of nodes */
    int32_t seen;              /* memories of each kind */
    int32_t edges;
    int32_t stretches;
    int32_t perishable;        /* signals that go stale */
    int32_t clocks;            /* the most that an automaton has, at least 1 */
    int32_t undetermined;      /* how many judges have a `determined` */
    int32_t births;            /* how many signals are waited for */
    list stateful;             /* nodes to be worked out at each sample, if only these are positions */
    list networked;            /* judges without an automaton */
    /* What follows is of a part whose attempts or instances have values of their own. */
    int32_t captured;          /* so many, that of `for each` the first; 0: none */
    int32_t each;              /* 1: it is a `for each` */
    int32_t requirement;       /* its number */
    int32_t flags;
    int32_t root_starters;     /* judges of which attempts start in the root, as bits */
    int32_t instance_starters; /* and in instances */
    int32_t each_event;
    int32_t each_field;        /* counted within its event */
    list captures;             /* places in SEC_CODE of the programs of `let` */
    list varying_atoms;        /* those that read captured values */
    list varying_nodes;        /* those above them that remember nothing, operands first */
    list varying;              /* all nodes above them */
    list lapsed;               /* nodes LAPSED */
    list dead_timers;          /* nodes with timers that are not needed once the part is settled */
    int32_t truths;            /* the form of whose operators it is kept where they are known; -1 */
    list watches;              /* records of SEC_WATCHES; so with what follows */
    list groups;
    int32_t sums;              /* so many tallies of windows */
    int32_t amounts;           /* and numbers that they come to */
} part_plan;

/* Lists for the two phases: until all is born and determined, and from then on. */
typedef list phased[2];

enum { SIGNAL_IGNORES_NAN = 1, SIGNAL_MARKS = 2, SIGNAL_HISTORY = 4, SIGNAL_CAPTURED = 8 };

typedef struct {
    int64_t stale_after;       /* ticks; 0: it does not go stale */
    int32_t name;
    int32_t flags;
    int32_t births;            /* 0: nobody asks; 1: its first value; 2: and an update after it */
    int32_t perishable;        /* its number among these; -1: it is none */
    phased on_change;          /* atoms to be read again when its value changes */
    phased on_update;          /* and at each update */
    list on_birth;             /* nodes */
    list needs;                /* atoms that speak of one position if this has a source */
    int64_t spare;
} signal_plan;

enum { EVENT_MARKS = 1, EVENT_FIELDS = 2, EVENT_KEY = 4 };

typedef struct {
    int32_t name;
    int32_t flags;
    int32_t field;             /* its first field, in the part */
    int32_t fields;
    int32_t key;               /* the field, within the event, whose value says which instance it
                                * concerns; -1: all */
    phased on_occurrence;      /* atoms */
    list needs;
    int32_t spare;
} event_plan;

/* What is read off the input at a position. */
enum {
    ATOM_SIGNAL,               /* a boolean signal */
    ATOM_REAL,                 /* a real signal and a constant */
    ATOM_COMPARE,              /* two programs */
    ATOM_PAYLOAD,              /* two programs that read fields, over all occurrences */
    ATOM_EVENT,
    ATOM_KNOWN_SIGNAL,
    ATOM_KNOWN_EVENT,
    ATOM_UPDATED_SIGNAL,
    ATOM_UPDATED_EVENT,
    ATOM_CHANGED,
    ATOM_START,
    ATOMS
};
enum { CMP_LT, CMP_LE, CMP_EQ, CMP_NE, CMP_GE, CMP_GT, CMPS };

typedef struct {
    double constant;           /* of ATOM_REAL */
    int32_t op;
    int32_t compare;
    int32_t input;             /* the signal or event */
    int32_t left;              /* places in SEC_CODE */
    int32_t right;
    int32_t momentary;         /* how many names with a source make it speak of one position only */
    list events;               /* of ATOM_PAYLOAD */
    phased nodes;              /* leaves that show it */
    int64_t tells;             /* 1: somebody reads its numbers, which may be others though its truth
                                * is the same */
} atom_plan;

enum {
    NODE_LEAF, NODE_CONSTANT, NODE_UNBORN, NODE_LAPSED, NODE_ELAPSED,
    NODE_NOT, NODE_AND, NODE_OR, NODE_SURE, NODE_DOUBT, NODE_PREVIOUS,
    NODE_EVER,                 /* since, without bounds */
    NODE_EDGE,                 /* since from 0 on, or without an end */
    NODE_STRETCH,              /* since in bounds */
    NODE_WINDOW,               /* what the members of a window come to: window.c */
    NODE_PASSED,               /* so long has passed as a number says */
    NODE_COMPARED,             /* an atom that reads what windows come to */
    NODES
};

typedef struct {
    int64_t low;               /* of a `since`; of ELAPSED, how long; of WINDOW, the program of its
                                * limit, or the place of its number; of PASSED, that of the instant, in ticks */
    int64_t high;              /* RV_NEVER: none */
    int32_t op;
    int32_t a;                 /* of a leaf, COMPARED or PASSED, the atom; of WINDOW, that of the numbers, -1: none;
                                * of a constant, the truth; DOUBT: pulse */
    int32_t b;                 /* of a leaf, the truth before birth; DOUBT: no trigger is sure; of WINDOW,
                                * a fold with marks; of PASSED, a tick more */
    int32_t slot;              /* its memory; -1: it has none */
    int32_t timer;             /* -1: time alone does not change it */
    list operands;             /* of a leaf and UNBORN: signals times 2, plus 1 if an update after the
                                * first value is asked for */
    phased parents;
    list links;                /* records of SEC_LINKS */
    int32_t sum;               /* of WINDOW, the number of its tally; -1: it has none */
    int32_t most;              /* of WINDOW, so many members are in it; 0: any number */
    int32_t chosen;            /* of WINDOW, from which operand on they are asked of each occurrence */
    int32_t since;             /* of WINDOW, the captured instant that it begins with; -1: another */
    int32_t spare;
} node_plan;

/* What members of a window come to: how many they are; as ticks; together; that by how many; times ticks;
 * how far they spread; how far the last is from the first; how many there are of different ones; the least
 * and the greatest; the first. */
enum {
    FOLD_COUNT, FOLD_DURATION, FOLD_SUM, FOLD_MEAN, FOLD_INTEGRAL, FOLD_VARIANCE, FOLD_DELTA, FOLD_DISTINCT,
    FOLD_MIN, FOLD_MAX, FOLD_AGO,
    FOLDS
};
/* The limit is not enough; the second operand says whether a member counts; there is no limit, but a number
 * that others read. */
enum { WINDOW_FOLD = 15, WINDOW_STRICT = 16, WINDOW_COUNTED = 32, WINDOW_NUMBER = 64 };

/* WATCH alone: the number is that of a watch, and weights mean nothing. */
enum { LINK_LETTER = 1, LINK_TRIGGER = 2, LINK_DETERMINED = 4, LINK_WATCH = 8 };

typedef struct {
    int32_t judge;
    int32_t kind;
    int32_t worse[3];          /* what FALSE, UNKNOWN, TRUE add to its letter */
    int32_t better[3];
} link_plan;

enum {
    JUDGE_PULSE = 1, JUDGE_EPISODIC = 2, JUDGE_HIDDEN = 4, JUDGE_BLURS_ANYWHERE = 8,
    JUDGE_IN_RUNS = 16, JUDGE_TRACED = 32
};

/* What judges the attempts of a requirement, or those in doubt. Nodes; -1: there is none. */
typedef struct {
    int32_t trigger;           /* -1: the end of the trace */
    int32_t again;             /* FALSE where no attempt follows a failure */
    int32_t unborn;            /* TRUE while something that is owed had no value */
    int32_t determined;        /* TRUE as soon as the trigger was TRUE or FALSE */
    int32_t running;           /* FALSE where its episode is over */
    int32_t blurs;             /* UNKNOWN where other values may be captured */
    int32_t owner;             /* the judge that counts its attempts */
    int32_t requirement;
    int32_t flags;
    int32_t automaton;         /* in SEC_AUTOMATA; -1: a network judges */
    int32_t form;              /* in the part; -1: none */
    int32_t diagram;           /* of its letters, in SEC_INTS; -1: a table has their classes */
    list propositions;         /* nodes: its letters, and the digits of its diagram, are told by these */
    list leaves;               /* nodes that it reads of the input, as they are told of */
    int32_t outcomes[8];       /* at the end: verdict + 4 * decision, by 1 holds, 2 cannot pass, 4
                                * cannot fail */
} judge_plan;

/* An automaton. A row is a location with a region for each clock. Offsets in SEC_INTS, but `cuts` and
 * `ages` in SEC_TICKS. */
typedef struct {
    int32_t initial;
    int32_t locations;
    int32_t clocks;            /* the most of a location */
    int32_t classes;           /* of letters */
    int32_t letters;           /* 0: a diagram classes them */
    int32_t rows;
    int32_t targets_count;
    int32_t class_of;          /* [letters] */
    int32_t bases;             /* [locations]: the first row */
    int32_t widths;            /* [locations]: how many clocks */
    int32_t strides;           /* [locations * clocks] */
    int32_t cut_first;         /* [locations * clocks + 1], within `cuts` */
    int32_t cuts;              /* [..]: ages at which a clock enters the next region */
    int32_t edges;             /* [rows * classes] */
    int32_t targets;           /* [targets_count]: locations */
    int32_t sources;           /* [targets_count * clocks]: the old clock; -1: now */
    int32_t time_values;       /* [rows]: a truth if time alone decides there */
    int32_t clause_first;      /* [locations + 1]: of the rule for the end */
    int32_t test_first;        /* [clauses + 1] */
    int32_t tests;             /* [2 * tests]: clock (-1: none), whether the end counts */
    int32_t ages;              /* [tests] */
    int32_t spare;
} automaton_plan;

/* A formula for a network: operands first, the last operator is the root. */
typedef struct {
    int64_t reach;             /* ticks after which a position only leads on to later ones; NEVER: none */
    list operators;
    int32_t leaves;
    int32_t looks_back;        /* whether it has to see what is before its attempts */
    list windows;              /* of a chain, operators, the innermost first; empty: it is none */
    int32_t base;              /* of a chain, what the innermost is over: a leaf, or a junction */
    int32_t left;              /* of a chain that is kept up, the leaf that ends that; -1: none does */
    int32_t excused;           /* and the leaf that is true where the windows do not matter; -1 */
    int32_t spare;
} form_plan;

enum { OP_LEAF, OP_JUNCTION, OP_WINDOW, OP_SHIFT, OP_UNTIL, OP_SINCE, OPS };

typedef struct {
    int64_t low;               /* distances in ticks, or in positions if there is a gap */
    int64_t high;
    int64_t over;              /* ticks after which no further position comes to lie in a window; -1 in
                                * the past; of a shift, ticks after which it speaks of something */
    int32_t kind;
    int32_t turned;            /* all are asked for, or it is the dual */
    int32_t kept;              /* whether the end of the trace counts as true for it */
    int32_t left;              /* operators; of a leaf, its number */
    int32_t right;             /* of a leaf, the node; -1: a constant */
    list operands;             /* of a junction */
    int32_t values[3];         /* of a leaf by truth: 1 if true for the worse, 2 for the better */
} operator_plan;

/* A formula that is watched: a bin, or an occasion at which bins are looked at. */
typedef struct {
    int32_t node;
    int32_t is_pulse;          /* 1: it is over at the next position */
    list groups;               /* of the part, that are looked at where it changes, or a pulse goes on */
} watch_plan;

/* A coverpoint, or the cross of several: an item is a bin of each axis, the last one counted through
 * first. */
typedef struct {
    int32_t occasion;          /* the watch that says where it is looked at; -1: everywhere */
    int32_t first;             /* its first item, among those of the part's groups */
    list axes;                 /* pairs: the first watch of an axis, and how many it has */
} group_plan;

/* What is measured of the attempts of a judge: a formula as a network has it. */
typedef struct {
    list operators;
    list measures;             /* records of SEC_MEASURES, one for each leaf in the order of their
                                * numbers */
    int32_t looks_back;        /* whether it has to see what is before its attempts */
    int32_t spare;
} margin_plan;

enum {
    MEASURE_CONSTANT,          /* true */
    MEASURE_TRUTH,             /* that of a node, infinite */
    MEASURE_DENIED,            /* whether a node is FALSE for sure */
    MEASURE_DISTANCE,          /* by how much the comparison that a leaf shows holds */
    MEASURES
};

/* What a leaf is measured by. */
typedef struct {
    double factor;             /* of a distance, that makes base units of it */
    int32_t kind;
    int32_t turned;            /* whether it is negated */
    int32_t node;              /* in the part; -1: of a constant */
    int32_t spare;
} measure_plan;

/* A constant. */
typedef struct {
    int64_t kind;
    union {
        int64_t whole;
        double real;
    } as;
} number_plan;

/* Programs of a stack: each word is an operation and 256 times its argument; FIELD has the event as
 * its argument, and the number of the field within that in the next word. */
enum {
    CODE_END, CODE_NUMBER, CODE_SIGNAL, CODE_CAPTURED,
    CODE_FIELD,                /* of the occurrence at hand; while capturing, of the last one */
    CODE_PREV, CODE_DELTA, CODE_RATE,
    CODE_ADD, CODE_SUB, CODE_MUL, CODE_DIV, CODE_NEG, CODE_ABS, CODE_MIN, CODE_MAX, CODE_SQRT,
    CODE_HYPOT, CODE_FLOOR, CODE_CEIL, CODE_ROUND, CODE_SIGN, CODE_MOD, CODE_CLAMP,
    CODE_SIN, CODE_COS, CODE_TAN, CODE_ASIN, CODE_ACOS, CODE_ATAN2, CODE_EXP, CODE_LOG, CODE_LOG10,
    CODE_POW, CODE_ANGLE_BETWEEN, CODE_DISTANCE_ON_EARTH,
    CODE_BIT_AND, CODE_BIT_OR, CODE_BIT_XOR, CODE_SHIFT_LEFT, CODE_SHIFT_RIGHT, CODE_BIT,
    CODE_NOW,                  /* ticks since the first position */
    CODE_WINDOW,               /* what a window comes to */
    CODES
};
#define PROGRAM_DEPTH 32
/* Events whose fields one comparison may read. */
#define PAYLOAD_EVENTS_MOST 8
/* Axes that one group may have. */
#define AXES_MOST 64
/* Locations of an automaton whose moves may be counted. */
#define TRACED_MOST 64

#endif
