/* The state of a monitor, outermost first: the monitor has a home for each part of the plan, a home
 * one or more runs, a run its nodes and judges (judging.h). A part without captured values has
 * exactly one run. One with `let` or `for each` has a root, a run per key of `for each` (an
 * instance), and a run per open attempt with `let` values; they form a tree through parent,
 * first_child and sibling.
 *
 * All memory comes from the monitor's arena; arrays that grow do so by doubling. */
#ifndef RVMON_STATE_H
#define RVMON_STATE_H

#include "judging.h"
#include "margins/measuring.h"
#include "plan/plan_view.h"

#define NEVER RV_NEVER
#define LIMIT (INT64_C(1) << 62)

/* Truth values in Kleene's order: `and` is the minimum, `or` the maximum. */
enum { IS_FALSE = 0, IS_UNKNOWN = 1, IS_TRUE = 2 };

/* Locations: 0 and 1 are final in every automaton; a network's attempts are WAITING until decided. */
enum { FAILED = 0, PASSED = 1, WAITING = 2 };

typedef struct home home;

/* Timers: a binary min-heap of ids by due instant, indexed: a timer is moved or cleared in logarithmic
 * time. A timer that is not set is due NEVER and not in the heap. */
typedef struct {
    int64_t *due;              /* by id */
    int32_t *ids;              /* the heap */
    int32_t *place;            /* by id, its index in `ids` */
    int64_t next;              /* due instant of the first */
    int32_t count;
} timers;

/* An open interval of numbers. */
typedef struct {
    double low;
    double high;
} span;

/* The last two updates of a signal, for `prev`, `delta`, `rate` and `changed`. */
typedef struct {
    rv_number last;
    rv_number before;
    int64_t at;                /* instant of `last` */
    int64_t before_at;         /* instant of `before` */
    int32_t updates;           /* 0, 1, or 2 for more */
    int32_t spare;
} history;

/* Occurrences of one event at the current position. */
typedef struct {
    rv_number *fields;         /* one row of fields per occurrence */
    uint8_t *known;            /* per occurrence; 0: it may not have occurred */
    int32_t count;
    int32_t room;
} occurrences;

/* An inclusive range of instants; in the second ring of a window, a number instead (members.c). */
typedef struct {
    int64_t begin;
    int64_t end;
} stretch;

/* The outage state of a name: not lost; lost, with unknown end; lost up to the instant in `until`;
 * for a signal: the outage is over, but no update has come since. */
enum { NOT_LOST = 0, LOST_ON = 1, LOST_UNTIL = 2, LOST_SINCE = 3 };

/* What an internal update says, in addition to core.h: an outage of a name starts, or ends. The rest
 * concern no name: there was an outage before the first sample; from here on every tick may be a
 * position; after this instant only samples are positions again. */
enum { SAYS_LOST = RV_SAYS_YES + 1, SAYS_FOUND, SAYS_AHEAD, SAYS_DENSE, SAYS_SPARSE };

/* Whether the trace has started: yes; unknown, because of an outage before the first sample; it will
 * have started at the next position. */
enum { ARE_THERE = 0, MAY_BE_THERE = 1, ARE_THERE_NEXT = 2 };

/* Memory of a past operator: the ranges of instants at which a bounded `since` holds, or the
 * members of a window (formulas/members.h), in a ring. A node has two. For a `since` the second is
 * the better reading, in use while `apart`. For a window the second holds the members' numbers; its
 * `total` counts the possible members, its `lost` how many members have to come until the last ones
 * are known again; `left` of the first ring says that all numbers summed were whole. For a minimum
 * or maximum of the last `most` members, `total` numbers the members. */
typedef struct {
    stretch *at;
    int32_t room;              /* a power of two, or 0 */
    int32_t head;
    int32_t count;
    bool left;                 /* of a `since`: its operands at the previous position */
    bool right;
    bool growing;              /* the last range is still growing */
    bool apart;                /* the second reading differs and is kept */
    int64_t total;             /* number of members that count */
    int64_t lost;              /* number of members whose number is unknown */
    int64_t members;           /* number of all members */
    int32_t *slots;            /* hash table of the latest among equal members: distinct.c */
    int32_t slot_room;
    int32_t known_slots;       /* slots in use; -1: the table has to be rebuilt */
} stretches;

/* Memory of a `since` with lower bound 0, or without upper bound: one instant (formulas/past.c). */
typedef struct {
    int64_t at;
    bool left;
    bool right;
    bool apart;
} edge;

/* An exact sum (Kulisch's long accumulator, formulas/exact.c): two's complement fixed point in
 * limbs of 32 bits, the lowest bit worth 2^-1088. 2240 bits hold the largest double times the
 * longest duration, added at every tick of that duration. It is followed by the sum of squares (for
 * a variance, at twice that precision), or by the sum in the better reading. */
#define SUM_LIMBS 71
#define SQUARE_LIMBS 142
#define TALLY_LIMBS (SUM_LIMBS + SQUARE_LIMBS)
typedef struct {
    uint32_t limb[TALLY_LIMBS];
} tally;

/* A run: the state of a part of the plan, of an instance, or of an attempt with captured values.
 * Everything that a fork has to copy lies in one block, so that forking is a memcpy (runs/runs.c). */
struct run {
    home *home;
    const part *part;
    const plan *all;           /* the whole plan */
    int64_t gap;               /* ticks between two positions; 0: only samples are positions */
    run *next;                 /* in the list of its home */
    run *previous;
    run *parent;               /* the run in which its attempt was triggered; NULL: it has none */
    run *first_child;          /* list of the runs of attempts triggered in it */
    run *sibling;
    run *previous_sibling;
    uint64_t call;             /* number of the last call that concerned it */
    int32_t id;                /* its index in the runs of its home */
    int32_t touched_at;        /* its place in the home's `touched`, from 1; 0: it is not there */
    judge *judges;             /* by judge of the part */
    truth_log *truth_log;      /* NULL: no notes are kept */
    timers rules;              /* timers, by judge */
    int32_t *touched;          /* judges that look at the current position */
    int32_t *restless;         /* judges with attempts that may move at the next position */
    int32_t *repeating;        /* judges whose pulse trigger was true at the previous position */
    int32_t *failing;          /* judges whose current episode has failed */
    int32_t *due_rules;        /* scratch, for judges whose timer fired */
    int32_t touched_count;
    int32_t restless_count;
    int32_t repeating_count;
    int32_t failing_count;
    /* For an instance, or for an attempt with captured values. */
    int64_t opens_at;          /* no attempt starts earlier; NEVER: none ever starts */
    int64_t cut;               /* from this instant on the captured values are no longer known */
    int64_t occurred;          /* first occurrence of the key of this instance */
    uint32_t rank;             /* of its instance, by first occurrence, from 1; else 0 */
    int32_t key;               /* index of its key in the home's keys */
    int32_t judged;            /* the judge of its one attempt, with captured values */
    int32_t starters;          /* judges whose attempts start here, as a bit set */
    int32_t watched_children;  /* how many of its children are `watched` */
    int32_t judging;           /* judges whose attempts are judged here, as a bit set */
    bool opening;              /* attempts start from the next position on */
    bool over;                 /* `payloads` are of the last position: captures still read them */
    bool watched;              /* its parent has to check whether the captured values remain known */
    bool blurs;                /* its captured values can still become unknown */
    bool is_spare;             /* released, for reuse */
    bool doubted;              /* it is unknown whether there is such an instance */
    bool stays_busy;           /* visit the next position, for captured values or watches */
    /* Arrays whose size depends on the part, laid out by cut_block. */
    size_t copied;             /* size of the prefix of `block` that a fork copies */
    char *block;
    rv_number *captured;       /* the key of `for each`, then each `let` */
    rv_number *value;          /* by signal, its current value, or another one in its span */
    span *spans;               /* by signal, the interval in which no comparison of it changes */
    history *history;          /* by signal with SIGNAL_HISTORY */
    occurrences *payloads;     /* by event */
    int32_t *chosen;           /* by event, the occurrence that the current comparison reads */
    stretches *past;           /* two for each STRETCH or WINDOW node */
    edge *edges;               /* two for each EDGE node, as for `past` */
    tally *tallies;            /* by `sum` of WINDOW nodes */
    rv_number *amounts;        /* results of WINDOW_NUMBER nodes */
    timers wake;               /* timers: of nodes, then of signals that go stale */
    uint64_t *dirty;           /* nodes to be evaluated, as a bit set */
    uint64_t *dirty_words;     /* words of `dirty` that are not 0, as a bit set */
    int32_t *fading;           /* atoms valid only at the last position, to be read again */
    int32_t *fresh;            /* atoms valid only at the coming position */
    int32_t *marks;            /* names whose updates are forgotten after this position */
    uint8_t *marked;           /* by name, whether it is in `marks` */
    uint8_t *truth;            /* by node */
    uint8_t *atom;             /* by atom, its truth */
    uint8_t *momentary;        /* by atom, how many names with a source make it momentary */
    uint8_t *is_fading;
    uint8_t *is_fresh;
    uint8_t *births;           /* by signal, births so far: 1, a first value; 2, an update after it */
    uint8_t *updated;          /* by name, whether it was updated at this position */
    uint8_t *changed;          /* by signal, whether the update changed its value */
    uint8_t *occurs;           /* by event, a truth */
    uint8_t *silent;           /* by event, `occurs` without an update: UNKNOWN if lost, else FALSE */
    uint8_t *absent;           /* by name, whether it is lost, or without a source */
    uint8_t *seen;             /* by slot, truths that nodes remember */
    /* Outages, by name; empty if the part reads none. */
    uint8_t *lost;             /* NOT_LOST, ... */
    int64_t *until;            /* the last instant of the outage; while it is unknown, the first */
    rv_number *kept;           /* the last value received at the instant `until` */
    uint8_t *has_kept;         /* whether there is such a value */
    uint8_t *keeps;            /* whether a value at that instant counts after the outage */
    measuring *margins;        /* margins, by judge; NULL: the plan has none */
    timers margins_due;        /* timers, by judge: when time alone may settle a margin */
    int32_t *changed_inputs;   /* judges whose leaves may have changed */
    int64_t measured_at;       /* the position up to which margins are known */
    int32_t changed_count;
    int32_t pending_margins;   /* attempts whose margins are still to come */
    /* Scalars that a fork copies, too. */
    struct progress {
        int64_t origin;        /* the first position, or the first one that may exist */
        int64_t dense_from;    /* the first tick that may be a position (`dense`) */
        int64_t sure_from;     /* the first position that certainly exists; NEVER */
        int64_t position;      /* the position visited last */
        int64_t before;        /* the position before the current one */
        int64_t alarm;         /* nothing happens before this instant unless an input changes */
        int64_t after;         /* the last sample taken */
        int64_t awaited;       /* with a gap: the tick that sees the samples taken since the last */
        int64_t ends_at;       /* the next position at which some outage may be over; NEVER */
        int32_t lost_count;    /* number of names in an outage */
        int32_t fading_count;
        int32_t fresh_count;
        int32_t marks_count;
        int32_t births_left;   /* births still awaited */
        int32_t undetermined_left; /* triggers that were never known */
        int32_t phase;         /* 1 once both of these are 0 (plan.md: phases) */
        bool started;
        uint8_t starting;      /* a truth: whether the current position is the first */
        uint8_t presence;      /* ARE_THERE, ... */
        bool dense;            /* sampled time, in an outage: every tick may be a position */
        bool gathered;         /* something has to be forgotten after the current position */
        bool dirty;            /* the position has to be visited though no node is dirty */
    } at;
};

/* A key: a value of `for each` that occurred. */
typedef struct {
    rv_number value;
    int64_t occurred;          /* instant of its first occurrence */
    run *open;                 /* its instance; NULL: it was closed */
    uint32_t rank;
    int32_t next;              /* hash chain, or free list */
    int32_t older;             /* links of the list of closed keys, in order of closing */
    int32_t newer;
} key;

/* An update as a part sees it, with the part's own number of the name. */
typedef struct {
    int32_t local;
    bool event;
    const rv_update *update;
} incoming;

/* A stored update, for runs that replay the past, or until its tick comes. It owns `fields`. */
typedef struct {
    int64_t t;
    rv_number value;
    const rv_number *fields;
    int32_t local;
    bool event;
    int32_t says;
    bool last;                 /* the last update of its sample */
} past_update;

/* What the runs of a part share: their lists, the pool of attempts, the inbox of a sample. */
struct home {
    rv_monitor *monitor;
    const part *part;
    run *root;                 /* heads the list of root and instances */
    run *last_root;            /* tail of that list */
    run *captured;             /* list of the runs of attempts with `let` values */
    run *last_captured;        /* tail of that list */
    run *spare;                /* released runs, for reuse */
    run **runs;                /* by id, released ones among them */
    rv_number *values;         /* by run and signal, if the part captures values: `value` of the runs */
    span *spans;               /* the same for `spans` of the runs */
    struct block_span *common; /* by block of runs and signal (runs/span_blocks.c) */
    int32_t *known_spans;      /* by block, how many of them are known */
    int32_t block_room;
    run **touched;             /* runs that did something in this call */
    int32_t *called;           /* scratch: ids of the runs that a call concerns */
    timers alarms;             /* timers, by id of the run */
    uint64_t call;
    int32_t run_count;
    int32_t run_room;
    int32_t touched_count;
    int32_t alarmed;           /* so many of them, the first ones, have their alarm set */
    char *pool;                /* attempts */
    attempt *scratch_attempt;  /* scratch: a queued attempt in the form of one in the pool */
    unknown_stretch *unknowns; /* when signals were unknown, for notes; NULL: no notes */
    int32_t *unknown_of;       /* by signal, its latest entry there; -1: dropped */
    int32_t unknown_count;
    int32_t unknown_room;
    captured_attempt *captured_attempts; /* by attempt, if the part captures values */
    size_t stride;             /* bytes of an attempt with its clocks */
    int32_t capacity;          /* of `pool`, in attempts */
    int32_t used;              /* slots of `pool` ever used */
    int32_t free_slot;         /* list of free slots below `used`; -1 */
    incoming *inbox;           /* updates of the current sample that the part reads */
    int32_t inbox_count;
    int32_t inbox_room;
    int64_t previous;          /* instant of the sample before the current one */
    int64_t alarm;
    silence silence;           /* the current stretch without input */
    /* For a part that captures values. */
    uint32_t count;            /* counts as in `judge` */
    uint32_t doubts;
    uint32_t passed;
    uint32_t failed;
    uint32_t inconclusive;
    rv_number *room;           /* scratch: values captured again, to compare them */
    rv_number *unknown_values; /* by signal, all unknown, for captures in an outage; NULL at first */
    int32_t sure[2];           /* list of attempts that became sure, to be numbered: first and last */
    int32_t doubtful[2];       /* the same for attempts in doubt */
    int32_t done[2];           /* the same for attempts to be reported */
    past_update *past;         /* stored samples */
    int32_t past_count;
    int32_t past_room;
    int32_t past_judged;       /* how many updates of `past` were judged already */
    rv_update *held;           /* scratch: a stored sample as updates */
    int32_t held_room;
    key *keys;                 /* all keys seen, except the oldest closed ones */
    int32_t *heads;            /* hash table; -1: empty chain */
    int32_t key_room;
    int32_t key_count;
    int32_t free_key;          /* list of free keys; -1 */
    int32_t oldest;            /* closed keys; -1: none */
    int32_t newest;
    int32_t over_count;
    uint32_t last_rank;
    networks *truths;          /* the form whose truths are recorded (rv_truths); NULL at first */
    bool is_blind;             /* an outage hid positions from `truths`, so nothing is reported */
    covering *covering;        /* coverage; NULL: none */
    rv_hit **moves;            /* by judge, moves between locations (rv_moves); NULL: none */
};

/* Location and clocks of an attempt before its last move, for notes. */
typedef struct {
    int64_t clocks[CLOCKS_MOST];
    int32_t location;
    int32_t width;             /* clocks in use */
} before_decision;

struct rv_monitor {
    arena memory;
    plan plan;
    part *parts;               /* by part of the plan */
    home *homes;               /* by part */
    rv_record *records;
    rv_number *captured;       /* captured values of records */
    uint8_t *absent;           /* by name, declared to have no source */
    int64_t record_count;
    int64_t record_room;
    int64_t sorted;            /* records already in order */
    int64_t captured_count;
    int64_t captured_room;
    int64_t *notes;            /* note words, and the states that notes share (notes/write_notes.c) */
    int64_t note_count;
    int32_t note_room;
    int32_t span_count;
    int32_t span_room;
    span_of_letters *spans;    /* letter ranges of notes */
    rv_piece *left;            /* pieces that only notes still need */
    uint32_t pins;             /* current value of `pinned`: bumped to unpin all pieces at once */
    rv_let_go let_go;
    void *let_go_user;
    int64_t settled_notes;     /* words of records' notes; those of open attempts follow */
    int32_t settled_spans;
    int64_t *kept_of;          /* scratch: records by requirement and verdict; NULL: all are kept */
    int64_t keep;              /* records kept of each */
    int64_t undecidable_count; /* undecidable attempts since the last trim */
    int64_t trim_at;           /* rv_trim acts beyond this many records and undecidable attempts */
    uint32_t epoch;            /* of notes: states written in another epoch are not shared */
    before_decision before;    /* of the current attempt */
    int64_t began;
    int64_t last;
    int64_t after;             /* a sample has to be later */
    int64_t reached;           /* no sample before this instant will come */
    rv_staleness *stale;       /* by signal */
    margin_shape *shapes;      /* margins, by judge over all parts; NULL: the plan has no margins */
    margin_results margins;
    uint8_t *late;             /* by requirement, whether a late sample concerned it */
    /* Sampled time (`gap` 0): outages. */
    uint8_t *losing;           /* by name, whether it is lost; last, an outage without a name */
    int32_t losing_count;
    int64_t dense_until;       /* last tick that may be a position; NEVER: open; RV_NO_TIME: none */
    int64_t dense_end;         /* the last tick of the latest outage */
    int64_t outage_at;         /* when an outage last started or ended; RV_NO_TIME: never */
    bool measures_positions;
    bool defers_margins;       /* rows are judged in bulk, so margins may be settled later */
    bool is_alone;             /* there is one part, without captured values */
    bool finished;
    bool spoilt;
    bool keeps_notes;
    bool writes_open_notes;    /* notes of open attempts are being written */
    bool has_open_notes;       /* notes of open attempts follow those of records */
};

#endif
