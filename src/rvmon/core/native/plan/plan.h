/* The binary plan as C structs: sections of fixed-size records. plan.md explains what each section
 * means, `rvmon.core.pack` packs them, and plan.c validates every index and size before anything
 * else reads them. All records consist of int32, int64 and double in an order without padding, so
 * that the layout is the same on every platform. */
#ifndef RVMON_PLAN_H
#define RVMON_PLAN_H

#include "core.h"

/* The sections in order, each with its name, the pointer to it in `plan` (plan_view.h), its records. */
#define PLAN_SECTIONS(SECTION) \
    SECTION(FIELD_FIRST, field_first, int32_t)                     /* [events + 1]: its first field */ \
    SECTION(SUBSCRIPTION_FIRST, subscription_first, int32_t)       /* [names + 1]: the first subscription */ \
    SECTION(SUBSCRIPTIONS, subscriptions, subscription)            /* which parts read a name */ \
    SECTION(PARTS, parts, part_plan) \
    SECTION(SIGNALS, signals, signal_plan) \
    SECTION(EVENTS, events, event_plan) \
    SECTION(ATOMS, atoms, atom_plan) \
    SECTION(NODES, nodes, node_plan) \
    SECTION(LINKS, links, link_plan) \
    SECTION(JUDGES, judges, judge_plan) \
    SECTION(AUTOMATA, automata, automaton_plan) \
    SECTION(FORMS, forms, form_plan) \
    SECTION(OPERATORS, operators, operator_plan) \
    SECTION(WATCHES, watches, watch_plan) \
    SECTION(GROUPS, groups, group_plan) \
    SECTION(NUMBERS, numbers, number_plan)                         /* constants of programs */ \
    SECTION(CODE, code, int32_t)                                   /* programs of expressions */ \
    SECTION(LISTS, lists, int32_t)                                 /* all lists of indices */ \
    SECTION(INTS, ints, int32_t)                                   /* tables of automata and diagrams */ \
    SECTION(TICKS, ticks, int64_t)                                 /* clock bounds of automata */ \
    SECTION(MARGINS, margins, margin_plan)                         /* by judge over all parts; or empty */ \
    SECTION(MEASURES, measures, measure_plan)

#define SECTION_NUMBER(name, field, record) SEC_##name,
enum { PLAN_SECTIONS(SECTION_NUMBER) SECTIONS };

#define PLAN_MAGIC "rvmonpl1"
#define PLAN_ORDER UINT32_C(0x01020304)

typedef struct {
    char magic[8];
    uint32_t order;            /* PLAN_ORDER, as the packing machine stores it: tells the byte order */
    int32_t sections;
    int64_t size;              /* bytes of the plan, this header included */
    uint64_t hash;             /* FNV-1a over the 8-byte words behind the header */
    int64_t gap;               /* ticks between two positions; 0: only samples are positions */
    int32_t signals;
    int32_t events;
    int32_t fields;
    int32_t requirements;
    int32_t captured;          /* the most values that an attempt captures */
    int32_t filling;           /* 0 */
} plan_header;

typedef struct {
    int64_t offset;            /* in bytes from the start of the plan, a multiple of 8 */
    int64_t count;             /* number of records */
} section;

/* A range of SEC_LISTS, or of another section where a comment says so. */
typedef struct {
    int32_t first;
    int32_t count;
} list;

typedef struct {
    int32_t part;
    int32_t local;             /* its one requirement */
} subscription;

/* A part: requirements judged together; one that captures values is alone. REPLAYS: an attempt
 * replays all past samples, as the past depends on captured values; KEEPS_PAST: samples are stored
 * for that; FRESH: an instance starts from the state of the root instead; FORGETS: an instance equal
 * to the root can be closed; CAPTURES_NOW: a captured value changes with time alone. */
enum { PART_REPLAYS = 1, PART_FRESH = 2, PART_FORGETS = 4, PART_KEEPS_PAST = 8, PART_CAPTURES_NOW = 16 };

typedef struct {
    list signals;              /* this and the next five are ranges of the section of that name */
    list events;
    list atoms;
    list nodes;
    list judges;               /* requirements first, then the judges of attempts in doubt */
    list forms;
    int32_t requirements;      /* how many of the judges are requirements */
    int32_t fields;            /* fields of all its events together */
    int32_t timers;            /* nodes that have a timer */
    int32_t seen;              /* memory slots of nodes, by kind: `seen`, `edges`, `stretches` */
    int32_t edges;
    int32_t stretches;
    int32_t perishable;        /* number of signals that can go stale */
    int32_t clocks;            /* clocks that an attempt needs room for, at least 1 */
    int32_t undetermined;      /* number of judges with a `determined` node */
    int32_t births;            /* number of signals whose birth is awaited */
    list stateful;             /* sampled time: nodes to be evaluated at each sample */
    list networked;            /* judges without an automaton */
    /* For a part that captures values. */
    int32_t captured;          /* number of captured values, the key of `for each` first; 0: none */
    int32_t each;              /* 1: it has a key */
    int32_t requirement;       /* its number */
    int32_t flags;
    int32_t root_starters;     /* judges whose attempts start in the root, as a bit set */
    int32_t instance_starters; /* judges whose attempts start in an instance */
    int32_t each_event;        /* the event and field that hold the key */
    int32_t each_field;        /* number within its event */
    list captures;             /* programs of the `let` values: offsets in SEC_CODE */
    list varying_atoms;        /* atoms that read captured values */
    list varying_nodes;        /* nodes above them that carry no memory into an attempt */
    list varying;              /* all nodes above them */
    list lapsed;               /* the LAPSED nodes */
    list dead_timers;          /* nodes whose timers are not needed in phase 1 */
    int32_t truths;            /* the form whose truths are recorded over time; -1: none */
    list watches;              /* range of SEC_WATCHES, and next of SEC_GROUPS: coverage */
    list groups;
    int32_t sums;              /* number of exact sums of windows */
    int32_t amounts;           /* number of windows whose result others read */
} part_plan;

/* A list for each phase: [0] until every awaited signal was born and every trigger was known; [1],
 * a subset, from then on. */
typedef list phased[2];

/* IGNORES_NAN: NaN is no update; MARKS: a formula reads `updated` of it; HISTORY: a formula reads its
 * last two updates; CAPTURED: a `let` reads it. */
enum { SIGNAL_IGNORES_NAN = 1, SIGNAL_MARKS = 2, SIGNAL_HISTORY = 4, SIGNAL_CAPTURED = 8 };

typedef struct {
    int64_t stale_after;       /* ticks without an update until it is unknown; 0: never */
    int32_t name;              /* its number in the monitor */
    int32_t flags;
    int32_t births;            /* updates awaited: 0; 1, its first value; 2, one more update */
    int32_t perishable;        /* its number among the signals that can go stale; -1: it cannot */
    phased on_change;          /* atoms to read again when its value changes */
    phased on_update;          /* atoms to read again at each update */
    list on_birth;             /* nodes */
    list needs;                /* atoms that are momentary if it has a source: see `momentary` */
    int64_t spare;
} signal_plan;

/* MARKS: a formula reads `updated` of it, FIELDS: its payloads; KEY: its payload selects an instance. */
enum { EVENT_MARKS = 1, EVENT_FIELDS = 2, EVENT_KEY = 4 };

typedef struct {
    int32_t name;
    int32_t flags;
    int32_t field;             /* its first field, among those of the part's events */
    int32_t fields;
    int32_t key;               /* the field that selects an instance; -1: all instances see it */
    phased on_occurrence;      /* atoms */
    list needs;
    int32_t spare;
} event_plan;

/* An atom is what a formula reads from the input at a position, e.g. one comparison. */
enum {
    ATOM_SIGNAL,               /* a Boolean signal */
    ATOM_REAL,                 /* a real signal compared with a constant */
    ATOM_COMPARE,              /* two expressions compared */
    ATOM_PAYLOAD,              /* the same over fields: TRUE if some combination of occurrences is */
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
    double constant;           /* ATOM_REAL only */
    int32_t op;
    int32_t compare;
    int32_t input;             /* the signal or event */
    int32_t left;              /* programs: offsets in SEC_CODE */
    int32_t right;
    int32_t momentary;         /* names that make it momentary: valid at one position; 0: it stays */
    list events;               /* of ATOM_PAYLOAD */
    phased nodes;              /* nodes to evaluate when it changes */
    int64_t tells;             /* 1: windows read its numbers: evaluate its nodes at every reading */
} atom_plan;

/* Operators of formulas of present and past; plan.md lists the fields that each of them uses. */
enum {
    NODE_LEAF, NODE_CONSTANT, NODE_UNBORN, NODE_LAPSED, NODE_ELAPSED,
    NODE_NOT, NODE_AND, NODE_OR, NODE_SURE, NODE_DOUBT, NODE_PREVIOUS,
    NODE_EVER,                 /* `since` without bounds: one truth remembers it */
    NODE_EDGE,                 /* `since` from 0 on, or without an end: one instant does */
    NODE_STRETCH,              /* any other `since`: ranges of instants */
    NODE_WINDOW,               /* an aggregate over a window of the past: window.c */
    NODE_PASSED,               /* a duration that an expression yields has passed */
    NODE_COMPARED,             /* a comparison that reads windows' results */
    NODES
};

typedef struct {
    int64_t low;               /* ticks; WINDOW, PASSED: a program (WINDOW_NUMBER: its result) */
    int64_t high;              /* ticks; RV_NEVER: unbounded */
    int32_t op;
    int32_t a;                 /* the atom; CONSTANT: the truth; DOUBT: 1, a pulse; see plan.md */
    int32_t b;                 /* LEAF: truth while unborn; WINDOW: fold and flags; see plan.md */
    int32_t slot;              /* number of its memory, of its operator's kind; -1: none */
    int32_t timer;             /* number of its timer; -1: time alone does not change it */
    list operands;             /* nodes; LEAF, UNBORN: 2 * signal, plus 1 for its second update */
    phased parents;
    list links;                /* records of SEC_LINKS */
    int32_t sum;               /* WINDOW: number of its exact sum; -1: none */
    int32_t most;              /* WINDOW: bound on the number of members; 0: none */
    int32_t chosen;            /* WINDOW: operands from here on are evaluated per occurrence */
    int32_t since;             /* WINDOW: the captured instant at which it begins; -1: none */
    int32_t spare;
} node_plan;

/* Aggregates: number of members; ticks they lasted; sum; mean; sum times ticks; variance; last
 * minus first; number of distinct values; minimum; maximum; first. */
enum {
    FOLD_COUNT, FOLD_DURATION, FOLD_SUM, FOLD_MEAN, FOLD_INTEGRAL, FOLD_VARIANCE, FOLD_DELTA, FOLD_DISTINCT,
    FOLD_MIN, FOLD_MAX, FOLD_AGO,
    FOLDS
};
/* WINDOW_FOLD masks the aggregate. STRICT: it has to exceed the limit; COUNTED: the second operand
 * says whether a member counts; NUMBER: there is no limit, other nodes read the result. */
enum { WINDOW_FOLD = 15, WINDOW_STRICT = 16, WINDOW_COUNTED = 32, WINDOW_NUMBER = 64 };

/* What a node reports to a judge when its truth changes. With LINK_WATCH, which is always alone,
 * `judge` is the number of a watch and weights have no meaning. */
enum { LINK_LETTER = 1, LINK_TRIGGER = 2, LINK_DETERMINED = 4, LINK_WATCH = 8 };

typedef struct {
    int32_t judge;
    int32_t kind;
    int32_t worse[3];          /* by truth FALSE, UNKNOWN, TRUE: what it adds to the letter */
    int32_t better[3];
} link_plan;

/* EPISODIC: an attempt lasts while its trigger holds; HIDDEN: judges attempts in doubt; BLURS_ANYWHERE:
 * in a doubted instance any position may capture other values; TRACED: its moves are counted. */
enum {
    JUDGE_PULSE = 1, JUDGE_EPISODIC = 2, JUDGE_HIDDEN = 4, JUDGE_BLURS_ANYWHERE = 8,
    JUDGE_TRACED = 16
};

/* A judge: what decides the attempts of a requirement, or its attempts in doubt. The first six
 * fields are nodes; -1: none. */
typedef struct {
    int32_t trigger;           /* starts attempts; -1: the end of the trace does */
    int32_t again;             /* FALSE where no attempt follows a failure in an episode */
    int32_t unborn;            /* TRUE while a signal of the consequent was never known */
    int32_t determined;        /* TRUE from the first position at which the trigger was known */
    int32_t running;           /* FALSE where an episode is over */
    int32_t blurs;             /* UNKNOWN where an attempt may have started with other values */
    int32_t owner;             /* the requirement's judge, which counts its attempts */
    int32_t requirement;
    int32_t flags;
    int32_t automaton;         /* number in SEC_AUTOMATA; -1: no automaton, `form` judges */
    int32_t form;              /* number in the part; -1: none */
    int32_t diagram;           /* offset in SEC_INTS of the diagram of letters; -1: a table */
    list propositions;         /* nodes: the propositions of its letters, by digit of the diagram */
    list leaves;               /* leaves below the propositions, for notes */
    list names;                /* signals, then events (numbered after signals), that the leaves read */
    int32_t outcomes[8];       /* verdict + 4 * decision, by the sum of: 1, kept; 2, it cannot pass; 4,
                                * it cannot fail */
} judge_plan;

/* A deterministic timed automaton. A row of its table is a location with a region (an interval
 * between two cuts) for each of its clocks. The int32 tables are given by offsets in SEC_INTS,
 * `cuts` and `ages` by offsets in SEC_TICKS; automata of the same shape share them. */
typedef struct {
    int32_t initial;
    int32_t locations;
    int32_t clocks;            /* the most that a location has */
    int32_t classes;           /* number of letter classes */
    int32_t letters;           /* letters in `class_of`; 0: a diagram maps them */
    int32_t rows;
    int32_t targets_count;
    int32_t class_of;          /* [letters] */
    int32_t bases;             /* [locations]: the first row */
    int32_t widths;            /* [locations]: how many clocks */
    int32_t strides;           /* [locations * clocks] */
    int32_t cut_first;         /* [locations * clocks + 1], within `cuts` */
    int32_t cuts;              /* [..]: ages, in ticks, at which a clock enters the next region */
    int32_t edges;             /* [rows * classes]: the transition */
    int32_t targets;           /* [targets_count]: locations */
    int32_t sources;           /* [targets_count * clocks]: the old clock kept; -1: reset */
    int32_t time_values;       /* [rows]: TRUE or FALSE if reaching the region decides, else UNKNOWN */
    int32_t clause_first;      /* [locations + 1]: it is true at the end if one of its clauses is */
    int32_t test_first;        /* [clauses + 1]: a clause is true if all its tests are */
    int32_t tests;             /* [2 * tests]: clock (-1: true); 1: age at the end, 0: as time came */
    int32_t ages;              /* [tests]: the least age of the clock for the test to be true */
    int32_t spare;
} automaton_plan;

/* A future formula for a network or, if `windows` is not empty, for a chain of windows. Operands
 * precede operators; the last operator is the root. */
typedef struct {
    int64_t reach;             /* ticks until a truth is known or equals a later one; NEVER */
    list operators;
    int32_t leaves;
    int32_t looks_back;        /* 1: it has to see positions before its attempts */
    list windows;              /* chain: its window operators, innermost first; empty: no chain */
    int32_t base;              /* chain: the operand of the innermost window, a leaf or junction */
    int32_t left;              /* chain: the leaf whose truth ends the obligation; -1: none */
    int32_t excused;           /* chain: the leaf that makes windows irrelevant while true; -1 */
    int32_t spare;
} form_plan;

/* Operators of networks. UNTIL and SINCE have no bounds; bounded ones are composed with WINDOW and
 * SHIFT. */
enum { OP_LEAF, OP_JUNCTION, OP_WINDOW, OP_SHIFT, OP_UNTIL, OP_SINCE, OPS };

typedef struct {
    int64_t low;               /* bounds in ticks, or in positions if there is a gap */
    int64_t high;
    int64_t over;              /* ticks until no position can enter the window, or until the shifted
                                * position; -1: past */
    int32_t kind;
    int32_t turned;            /* 1: the dual: `all` instead of `some` of the operands or positions */
    int32_t kept;              /* 1: it counts as true beyond the end of the trace */
    int32_t left;              /* operand; of a leaf, its number among the leaves */
    int32_t right;             /* second operand; of a leaf, its node, -1: constant */
    list operands;             /* JUNCTION only */
    int32_t values[3];         /* LEAF, by truth: 1 if true for the worse, plus 2 for the better */
} operator_plan;

/* Coverage: a watched formula, which is a bin or an occasion. */
typedef struct {
    int32_t node;
    int32_t is_pulse;          /* 1: true for one position only */
    list groups;               /* groups to evaluate when it changes or repeats */
} watch_plan;

/* Coverage: a coverpoint, or a cross of several. An item is one bin of each axis; the last axis
 * varies fastest. */
typedef struct {
    int32_t occasion;          /* the watch at which bins are sampled; -1: they are sampled always */
    int32_t first;             /* number of its first item among those of all groups */
    list axes;                 /* pairs: an axis's first watch, and its number of watches */
} group_plan;

/* Margins of a judge: its formula as a network, with measures for leaves. */
typedef struct {
    list operators;
    list measures;             /* range of SEC_MEASURES, by leaf */
    int32_t looks_back;        /* it has to see positions before its attempts */
    int32_t spare;
} margin_plan;

enum {
    MEASURE_CONSTANT,          /* true: +infinity */
    MEASURE_TRUTH,             /* a node's truth: + or -infinity */
    MEASURE_DENIED,            /* whether a node is FALSE: + or -infinity */
    MEASURE_DISTANCE,          /* the distance by which a leaf's comparison holds */
    MEASURES
};

/* The measure of a leaf. */
typedef struct {
    double factor;             /* DISTANCE: converts it to base units */
    int32_t kind;
    int32_t turned;            /* 1: the leaf is negated */
    int32_t node;              /* number in the part; -1: CONSTANT */
    int32_t spare;
} measure_plan;

/* A constant of a program. */
typedef struct {
    int64_t kind;
    union {
        int64_t whole;
        double real;
    } as;
} number_plan;

/* Expressions as programs of a stack machine. A word is an operation plus 256 times its argument;
 * CODE_FIELD has the event as argument and the field within it in the next word. */
enum {
    CODE_END, CODE_NUMBER, CODE_SIGNAL, CODE_CAPTURED,
    CODE_FIELD,                /* of the occurrence being compared; in a `let`, of the last one */
    CODE_PREV, CODE_DELTA, CODE_RATE,
    CODE_ADD, CODE_SUB, CODE_MUL, CODE_DIV, CODE_NEG, CODE_ABS, CODE_MIN, CODE_MAX, CODE_SQRT,
    CODE_HYPOT, CODE_FLOOR, CODE_CEIL, CODE_ROUND, CODE_SIGN, CODE_MOD, CODE_CLAMP,
    CODE_SIN, CODE_COS, CODE_TAN, CODE_ASIN, CODE_ACOS, CODE_ATAN2, CODE_EXP, CODE_LOG, CODE_LOG10,
    CODE_POW, CODE_ANGLE_BETWEEN, CODE_DISTANCE_ON_EARTH,
    CODE_BIT_AND, CODE_BIT_OR, CODE_BIT_XOR, CODE_SHIFT_LEFT, CODE_SHIFT_RIGHT, CODE_BIT,
    CODE_NOW,                  /* ticks since the first position */
    CODE_WINDOW,               /* the result of a WINDOW_NUMBER node */
    CODES
};
/* Depth of the stack; programs stay below it. */
#define PROGRAM_DEPTH 32
/* Most events whose fields one comparison may read: combinations multiply. */
#define PAYLOAD_EVENTS_MOST 8
/* Most axes of a group. */
#define AXES_MOST 64
/* Most locations of an automaton whose moves are counted: counts are quadratic in them. */
#define TRACED_MOST 64

#endif
