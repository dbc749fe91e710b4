/* Per-judge state: the open attempts of a requirement and the engine that decides them. A judge uses
 * one of four engines: an automaton that drives attempts one by one; an automaton with a queue,
 * where attempts differ only by age (attempts/queue.c); a network that evaluates the formula over
 * ranges of positions (networks/); a chain of nested windows (windows/).
 *
 * Throughout, "worse" and "better" are the two readings of unknown input: every unknown proposition
 * resolved against the requirement, or in its favour. While the readings agree, one state serves
 * both; they are parted from the first unknown letter that makes a difference until they agree
 * again. An attempt is decided when the worse reading passes or the better one fails. */
#ifndef RVMON_JUDGING_H
#define RVMON_JUDGING_H

#include "plan/plan.h"

typedef struct run run;

/* An open attempt, in the pool of its home. `next` links it into the list of its judge, or of the
 * free slots. It is followed by its clocks, then those of its better reading: the instants at which
 * they were reset. */
typedef struct {
    int64_t triggered;         /* instant of the trigger */
    int64_t due;               /* the next tick at which time alone changes it; NEVER */
    uint32_t number;
    int32_t next;
    int32_t location;
    int32_t better;            /* location in the better reading, if parted */
    bool parted;               /* whether the two readings differ */
    bool sure;                 /* whether it surely was triggered */
    bool trigger_unknown;      /* episodes: whether `running` was unknown at one of its positions */
    bool cannot_pass;          /* it can at best be inconclusive: a signal has had no value yet, or a
                                * captured value is no longer known */
    int64_t doubted_at;        /* the position at which its readings parted, for notes; RV_NO_TIME if
                                * they did not */
    int32_t record;            /* its margin record, from 1; 0: not measured */
    int64_t clocks[];
} attempt;

/* Further fields of an attempt whose part captures values, at the same index as the attempt. Such
 * attempts are spread over many runs, so numbers are assigned and records written at the end of a
 * call, when the order over all instances is known (runs/captured.c). The three links form lists of
 * the home. */
typedef struct {
    run *judge;                /* the run that judges it; NULL: the slot is free */
    int64_t became;            /* when it became sure */
    int64_t decided;           /* this, `note`, `rule` (the judge), `verdict` and `decision` are as in
                                * its record */
    int64_t note;
    int32_t next_sure;
    int32_t next_doubt;
    int32_t next_done;
    int32_t rule;
    uint32_t doubt_number;
    uint8_t verdict;
    uint8_t decision;
} captured_attempt;

/* Failed attempts of a run that were only counted: one starts at `first`, then one every `period`. */
typedef struct {
    int64_t first;
    int64_t period;
    int64_t count;
    uint32_t rank;             /* of the run */
} repetition;

/* A stretch without input, and the failed attempts that were only counted in it. */
typedef struct {
    int64_t from;              /* the stretch lies between these two instants; there is none while */
    int64_t until;             /* `until` is -LIMIT */
    int64_t reported;          /* failures reported one by one */
    repetition *counted;       /* where values are captured: counted, not numbered yet; by `first` */
    int64_t total;             /* attempts in `counted` */
    int32_t count;             /* entries in `counted` */
    int32_t room;
} silence;

/* A walk through `counted`, while attempts are numbered in their order: entries below index `over` lie
 * before the attempt, those from index `started` on after it. */
typedef struct {
    int64_t before;            /* attempts in the entries below `over` */
    int32_t over;
    int32_t started;
} numbering;

/* Inclusive ranges of positions, disjoint and ascending. */
typedef rv_range range;

typedef struct {
    range *at;
    int32_t room;
    int32_t first;             /* index of the oldest; those before were dropped */
    int32_t end;
} ranges;

/* What a network knows of one operator: indexed by value, the positions at which it is known to be
 * false, and to be true. */
typedef struct {
    ranges known[2];
    ranges added[2];           /* by the last step */
    int64_t base;              /* the first wanted position that is not known */
    int64_t wanted;
    int64_t earliest[2];       /* by value, the earliest instant at which a position can become known */
} operator_state;

typedef struct {
    operator_state *nodes;     /* by operator of the form */
    ranges samples;            /* sampled time: instants of the samples, indexed by position, from
                                * `oldest` on */
    int64_t oldest;
    int64_t now;
    int64_t was_now;
    int64_t first;
    int64_t last;              /* the last position whose letter is known */
    int64_t was_last;
    int64_t closed;            /* the end of the trace once it is over; else NEVER */
} network;

/* The networks of a judge. `readings[1]`, the better one, is used from the first unknown letter on. */
typedef struct {
    network readings[2];
    uint8_t *leaf;             /* by leaf, bits: 1, true in the worse reading; 2, in the better */
    uint8_t *next_leaf;        /* the leaves from position `turn` on */
    int64_t turn;
    int64_t searched;          /* when it was last searched for a decision, or a letter came */
    int32_t visits;
    bool started;
    bool parted;
} networks;

/* A Boolean function of positions, as the ascending positions at which it changes, in a ring. */
typedef struct {
    int64_t *at;
    int32_t room;              /* a power of two, or 0 */
    int32_t head;
    int32_t count;
    int32_t cursor;            /* how many lie before the position last queried, as queries mostly
                                * ascend */
    bool initial;              /* the value before the first change */
} changes;

/* One reading of a chain of windows: for each nesting level, where its value changes if the letter
 * stays as it is. Level 0 is the innermost operand. */
typedef struct {
    changes *levels;
    changes ends;              /* of the leaf that ends the outermost obligation */
    changes excused;           /* of the leaf that makes the windows irrelevant while true */
    int64_t start;             /* up to this position the obligation is met */
} chain_reading;

/* The state of a chain of nested windows (windows/chain.c); `readings[1]` as in `networks`. */
typedef struct {
    chain_reading readings[2];
    changes stamps;            /* sampled time: the instants of the samples */
    uint8_t *values;           /* by operator up to the innermost operand, scratch for evaluating a
                                * letter */
    uint8_t letter[3];         /* innermost operand and the two leaves, in bits: 1, true in the worse
                                * reading; 2, in the better */
    int32_t kept;              /* letters since old knowledge was last dropped */
    bool started;
    bool parted;
} chain;

/* An attempt in a queue: its location and clocks are those of its segment. */
typedef struct {
    int64_t triggered;
    uint32_t number;
    int32_t spare;
} queued;

/* The most clocks of an automaton whose attempts may be in a queue; rvmon builds none with more. */
#define QUEUED_CLOCKS 6

/* Values for a clock of a segment that is not one common instant: the clock was reset at each attempt's
 * trigger; or at every tick up to the judge's `position`; or at an instant of each attempt (`own`),
 * none earlier than that of the attempt before. */
#define OF_TRIGGER RV_NEVER
#define OF_EACH_TICK (RV_NEVER - 1)
#define OF_EACH_ATTEMPT (RV_NEVER - 2)

/* In place of a slot of the pool: the youngest attempt of the queue. */
#define IN_QUEUE (-2)

/* `count` consecutive attempts of a queue in one location, with clocks of one kind. */
typedef struct {
    int32_t location;
    int32_t count;
    int64_t clocks[QUEUED_CLOCKS];
} segment;

typedef struct {
    segment *at;
    int32_t room;
    int32_t count;
} segments;

/* The state of a queue's attempt after its first letter. Its clocks start with the attempt, so equal
 * first letters always lead to the same state. */
typedef struct {
    int64_t due;               /* ticks until its region changes; NEVER */
    int32_t letter;            /* the first letter; -1: no attempt has started yet */
    int32_t location;
    uint32_t sliding;          /* by clock, whether each tick resets it while the letter stays */
    bool rests;                /* the next equal letter leaves it there */
} attempt_start;

typedef struct {
    queued *items;             /* a ring, the oldest first */
    int64_t *own;              /* by slot of the ring and clock of the automaton; NULL: not needed yet */
    int32_t room;              /* a power of two, or 0 */
    int32_t head;
    int32_t count;
    segments now;
    segments next;             /* scratch: what a step makes of them */
    attempt_start latest;      /* of the attempt that started last */
} queue;

/* Truths of a judge's leaves at some instants, ascending, in a ring. An entry is the instant, then
 * the truths packed two bits each. */
typedef struct {
    int64_t *words;
    int32_t room;              /* entries, a power of two, or 0 */
    int32_t head;
    int32_t count;
} truths;

/* A chunk of the letters that notes of a judge refer to (notes/letters.c). A letter is its
 * position, then the packed truths of the propositions. */
struct rv_piece {
    rv_piece *next;            /* the following chunk of the same judge */
    rv_piece *next_left;       /* in the list of chunks that only notes still need */
    const int64_t *before;     /* the letter that keep_letter last compared with, in this chunk or the
                                * one before; valid while this is the last chunk */
    void *held[2];             /* pointers of the reader: see rv_piece_held */
    uint32_t pinned;           /* equals rv_monitor.pins if records' notes refer to it */
    int32_t count;             /* words in use */
    int32_t stride;            /* words per letter */
    int32_t number;            /* index while a snapshot is written or read */
    int64_t words[];
};

/* The letters that a note refers to: from the start of `first` to the first `last_count` words of
 * `last`. */
typedef struct {
    rv_piece *first;
    rv_piece *last;
    int32_t last_count;
} span_of_letters;

/* What a judge remembers for the notes of its attempts; see notes/notes.c. */
typedef struct {
    truths triggers;           /* the leaves at triggers; an entry stands for all triggers up to the
                                * next entry */
    truths doubts;             /* the leaves at positions where an unknown value may keep attempts from
                                * being decided */
    rv_piece *first;           /* of a network: the letters since the oldest open attempt */
    rv_piece *last;
    rv_piece *pinned;          /* the last pinned piece that is still listed */
    int32_t pieces;
    int32_t open_count;        /* open attempts, counted before their notes are written */
    uint32_t epoch;            /* `epoch` of the monitor when `state` was written */
    int64_t state;             /* index of the last state written among the note words, for sharing;
                                * -1: none */
    int64_t state_at;          /* the position that the state describes */
    int64_t began_at;          /* instant of the last trigger */
    int64_t doubted_at;        /* instant of the last entry of `doubts` */
    int64_t undecidable_since; /* the earliest trigger of an undecidable attempt; NEVER: none */
} noting;

/* The history of a node: since when it has its truth, and when it was last false and last true before
 * that; RV_NO_TIME: never. */
typedef struct {
    int64_t since;
    int64_t last[2];
} truth_times;

/* The history now, and as it was before the last change, since a network may report a decision one
 * position late. */
typedef struct {
    truth_times now;
    truth_times was;
    int64_t moved_at;          /* position of the last change; RV_NO_TIME: it never changed */
    uint8_t truth;             /* its truth before that */
} logged_node;

/* The histories of all nodes of a run that notes describe. */
typedef struct {
    logged_node *nodes;
    int64_t moved_at;          /* position of the last change of any of them */
    int64_t since;             /* an instance created late has no history before this position;
                                * RV_NO_TIME: it saw the whole run */
} truth_log;

/* Why a judge looks at the current position: its letter, or its trigger, changed. */
enum { TOUCHED_LETTER = 1, TOUCHED_TRIGGER = 2 };

typedef struct {
    int64_t position;          /* the position up to which its attempts were driven */
    int64_t lag;               /* networks: by how many ticks its timer was postponed; decisions may be
                                * that much earlier */
    int64_t failed_at;         /* when the attempt of the current episode failed; NEVER: it did not */
    int64_t again_at;          /* start of the latest attempt that followed a failure */
    networks *net;
    chain *chain;
    queue *queue;              /* NULL: its attempts are driven one by one */
    noting *noting;            /* NULL: no notes are kept */
    int32_t first;             /* the list of its open attempts; -1: empty */
    int32_t last;              /* the end of that list; -1 */
    int32_t undecidable;       /* list of its undecidable attempts, which are never looked at again; -1:
                                * empty */
    int32_t current;           /* the attempt of the current episode; IN_QUEUE: the youngest there; -1 */
    int32_t letter;            /* the letter class of the last step, in the worse reading */
    int32_t other;             /* the same in the better reading */
    int32_t worse;             /* running sum of the letter, worse reading: nodes add their weights as
                                * they change */
    int32_t better;            /* the same in the better reading */
    uint32_t count;            /* sure attempts so far */
    uint32_t doubts;           /* attempts in doubt so far */
    uint32_t passed;
    uint32_t failed;
    uint32_t inconclusive;
    uint8_t before;            /* truth of its trigger at the previous position, for edges */
    uint8_t touched;           /* TOUCHED_LETTER and TOUCHED_TRIGGER bits for the current position; 0:
                                * not listed */
    bool running;              /* an episode is open */
    bool restless;             /* an attempt may move at the next position even if nothing changes */
    bool slides;               /* some clock is restarted at every tick, so no attempt may be skipped */
    bool sorted;               /* whether `due` ascends along the list */
    bool is_restless_listed;
    bool is_failing_listed;
    bool blind;                /* its network looks back but missed positions of an outage: all further
                                * attempts are undecidable */
} judge;

/* Why a signal was not known, continuing RV_IS_NONE and RV_IS_NAN. */
enum { IS_STALE = RV_IS_NAN + 1, NEVER_KNOWN_YET, HAS_NO_SOURCE };

/* A stretch over which a signal had no known value, for notes. */
typedef struct {
    int64_t since;             /* meaningless if the signal never had a value */
    int64_t until;             /* NEVER: it still has no known value */
    int32_t local;
    int32_t why;
} unknown_stretch;

/* The state of a coverage group. */
typedef struct {
    int32_t current;           /* how many items are true, or were and have not been false since */
    uint8_t before;            /* truth of its occasion at the previous position */
    bool called;               /* it evaluates the current position */
} covered;

/* Coverage: the hits of a run. */
typedef struct {
    rv_hit *hits;              /* by item */
    int32_t *current_items;    /* the current items of each group, from its first item on */
    uint8_t *is_current;       /* by item, whether it is current */
    covered *groups;
    int32_t *groups_called;
    int32_t *called;           /* watches whose groups evaluate the next position */
    uint8_t *is_called;        /* by watch */
    uint64_t *true_bits;       /* by watch, whether it was true when last called */
    int32_t *bins;             /* scratch: the bins of all axes that are true */
    int32_t items;
    int32_t called_count;
} covering;

#endif
