/* What judges attempts, and what it remembers of them: the part of the state that one judge has. */
#ifndef RVMON_JUDGING_H
#define RVMON_JUDGING_H

#include "plan/plan.h"

typedef struct run run;

/* An open attempt; its clocks stand behind it, then those of its other reading. */
typedef struct {
    int64_t triggered;
    int64_t due;
    uint32_t number;
    int32_t next;
    int32_t location;
    int32_t better;            /* its location if the unknown is taken for the better */
    bool parted;               /* whether that reading is another */
    bool sure;                 /* else it is in doubt whether there was a trigger */
    bool trigger_unknown;              /* whether its trigger was unknown while it ran */
    bool cannot_pass;               /* over before all that it speaks of had a value */
    int64_t doubted_at;        /* where its readings parted; RV_NO_TIME: nowhere */
    int32_t record;            /* of its margin, 1 for the first; 0: it is not measured */
    int64_t clocks[];
} attempt;

/* What else an attempt of a part has whose attempts or instances have values of their own. */
typedef struct {
    run *judge;                /* that judges it; NULL: it is none */
    int64_t became;            /* when it was sure, or in doubt */
    int64_t decided;
    int64_t note;
    int32_t next_sure;
    int32_t next_doubt;
    int32_t next_done;
    int32_t rule;
    uint32_t doubt_number;
    uint8_t verdict;
    uint8_t decision;
} turn;

/* Positions at which something is known. */
typedef rv_range range;

typedef struct {
    range *at;
    int32_t room;
    int32_t first;             /* those before it were dropped */
    int32_t end;
} ranges;

/* What is known of a part of a formula: by value, where it is false and where true. */
typedef struct {
    ranges known[2];
    ranges news[2];            /* what became so last */
    int64_t base;              /* the first position that was wanted and not known */
    int64_t swept;             /* up to which its operands only lead on */
    int64_t wanted;
    int64_t earliest[2];        /* by value, before when nothing new of it can be known */
} operator_state;

typedef struct {
    operator_state *nodes;
    ranges samples;            /* their instants, from the oldest that is kept on */
    int64_t oldest;
    int64_t now;
    int64_t was_now;
    int64_t first;
    int64_t last;              /* the last position of which the letter is known */
    int64_t was_last;
    int64_t closed;            /* the end of the trace, or NEVER */
} network;

/* The network of a judge: two of them from the first unknown letter on. */
typedef struct {
    network readings[2];
    uint8_t *leaf;             /* 1: true for the worse; 2: for the better */
    uint8_t *next_leaf;        /* the same from the position `turn` on */
    int64_t turn;
    int32_t visits;
    bool begun;
    bool parted;
} networks;

/* Positions at which a value changes, in order, as a ring. */
typedef struct {
    int64_t *at;
    int32_t room;              /* a power of two, or 0 */
    int32_t head;
    int32_t count;
    int32_t asked;             /* so many were before the position that was asked for last */
    bool begun;                /* the value before all of them */
} changes;

/* One reading of a chain of windows: of each level where its value changes if the letter stays; level
 * 0 is the base. */
typedef struct {
    changes *levels;
    changes ends;              /* of the leaf that ends what is kept up */
    changes excused;           /* of that which is true where the windows do not matter */
    int64_t start;             /* up to there it is kept up */
} chain_reading;

/* A chain of windows that judges: two readings from the first unknown letter on. */
typedef struct {
    chain_reading readings[2];
    changes stamps;            /* the instants of samples, if only these are positions */
    uint8_t *values;           /* by operator up to the base, room for what it is */
    uint8_t letter[3];         /* the base, and the two leaves: 1 if it is true for the worse, and 2
                                * for the better */
    int32_t kept;              /* letters since what is known was dropped */
    bool begun;
    bool parted;
} chain;

/* An attempt in a queue. */
typedef struct {
    int64_t triggered;
    uint32_t number;
    int32_t spare;
} queued;

/* So many of them, one behind the other, in one location. */
typedef struct {
    int32_t location;
    int32_t count;
} segment;

/* Locations that a queue may come to at once; a plan's maker looks through the orders of fewer. */
#define SEGMENTS_MOST 16

typedef struct {
    queued *items;             /* a ring, the oldest first */
    int32_t room;              /* a power of two, or 0 */
    int32_t head;
    int32_t count;
    int32_t segment_count;
    segment segments[SEGMENTS_MOST];
} queue;

/* Truths of the leaves of a judge at some instants, in order, as a ring: the instant, then the words. */
typedef struct {
    int64_t *words;
    int32_t room;              /* entries, a power of two, or 0 */
    int32_t head;
    int32_t count;
} truths;

/* Letters, some of those that notes of a judge refer to. */
struct rv_piece {
    rv_piece *next;            /* the later ones */
    rv_piece *next_left;       /* of those that no open attempt needs any more, but notes do */
    const int64_t *before;     /* the last letter; while it is the last piece */
    void *held[2];             /* of who reads them */
    uint32_t pinned;           /* whether notes refer to it: the epoch of these; see `rv_monitor` */
    int32_t count;             /* words that are in it */
    int32_t stride;            /* of a letter */
    int32_t number;            /* among all, while they are written down or read */
    int64_t words[];           /* the position, then the truths of propositions there */
};

/* Letters that a note refers to. */
typedef struct {
    rv_piece *first;
    rv_piece *last;
    int32_t last_count;
} span_of_letters;

/* What a judge remembers for notes. */
typedef struct {
    truths triggers;           /* at triggers, where they are others than at the one before */
    truths doubts;             /* where something was unknown that its attempts may hang on */
    rv_piece *first;           /* letters, of one that a network judges */
    rv_piece *last;
    rv_piece *pinned;          /* the last one that is, while it is kept */
    int32_t pieces;
    int32_t open_count;        /* attempts that were open when they were told of */
    uint32_t epoch;            /* of the last state that was noted; see `rv_monitor` */
    int64_t state;             /* its place; -1: none */
    int64_t state_at;          /* its position */
    int64_t began_at;          /* the last trigger */
    int64_t doubted_at;        /* the last doubt */
    int64_t undecidable_since;        /* the first of those that stay open for good; NEVER: there are none */
} noting;

/* A node that notes tell of: since when it has its truth, and the last positions at which it was false
 * and true before; RV_NO_TIME: there is none. */
typedef struct {
    int64_t since;
    int64_t last[2];
} truth_times;

/* The same, now and before the position at which it changed last. */
typedef struct {
    truth_times now;
    truth_times was;
    int64_t moved_at;          /* that position; RV_NO_TIME: it never did */
    uint8_t truth;             /* before it */
} logged_node;

/* Such nodes of a run. */
typedef struct {
    logged_node *nodes;
    int64_t moved_at;          /* the last position at which one changed */
    int64_t begun;             /* from which on a run saw what is its own; RV_NO_TIME: it saw all */
} truth_log;

/* What becomes of a judge at a position. */
enum { TOUCHED_LETTER = 1, TOUCHED_TRIGGER = 2 };

typedef struct {
    int64_t position;          /* that its attempts have come to */
    int64_t lag;               /* what is decided so long before it is due is still to be found */
    int64_t failed_at;         /* when the attempt of the episode that runs did */
    int64_t again_at;          /* when the last one began that followed such a failure */
    networks *net;
    chain *chain;
    queue *queue;              /* NULL: its attempts are driven one by one */
    noting *noting;            /* NULL: nothing is noted */
    int32_t first;
    int32_t last;
    int32_t undecidable;              /* the first of those that stay open for good */
    int32_t current;           /* the attempt of the episode that runs */
    int32_t letter;            /* the class of letters that they stepped with */
    int32_t other;             /* the same, the unknown taken for the better */
    int32_t worse;             /* the letter as the nodes stand now, summed up */
    int32_t better;
    uint32_t count;
    uint32_t doubts;
    uint32_t passed;
    uint32_t failed;
    uint32_t inconclusive;
    uint8_t before;            /* the truth of its trigger at the position before */
    uint8_t touched;
    bool running;
    bool restless;             /* whether an attempt may move at the next position, whatever comes */
    bool slides;
    bool sorted;               /* whether no attempt is due before an older one */
    bool is_restless_listed;
    bool is_failing_listed;
    bool blind;                /* whether its network, which looks back, missed positions: nothing more
                                * is said of attempts */
} judge;

/* Why a signal was not known, behind what core.h says of numbers. */
enum { IS_STALE = RV_IS_NAN + 1, NEVER_KNOWN_YET, HAS_NO_SOURCE };

/* A stretch over which a signal was not known. */
typedef struct {
    int64_t since;             /* of no meaning if it was never known */
    int64_t until;             /* NEVER: it still is not */
    int32_t local;
    int32_t why;
} unknown_stretch;

#endif
