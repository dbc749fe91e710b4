/* The state of a monitor. */
#ifndef RVMON_STATE_H
#define RVMON_STATE_H

#include "judging.h"
#include "margins/measuring.h"
#include "plan/plan_view.h"

#define NEVER RV_NEVER
#define LIMIT (INT64_C(1) << 62)

/* Truth values; NONE is of nothing yet. */
enum { IS_FALSE = 0, IS_UNKNOWN = 1, IS_TRUE = 2 };

/* The two last locations of every automaton. */
enum { FAILED = 0, PASSED = 1, WAITING = 2 };

typedef struct home home;

/* Timers: an indexed heap of the ids that are due some time. */
typedef struct {
    int64_t *due;              /* by id */
    int32_t *ids;              /* the heap */
    int32_t *place;            /* by id, within the heap */
    int64_t next;              /* when the first of them is due */
    int32_t count;
} timers;

/* What lies between two numbers, neither of them among it. */
typedef struct {
    double low;
    double high;
} span;

typedef struct {
    rv_number last;
    rv_number before;
    int64_t at;
    int64_t before_at;
    int32_t updates;           /* 0, 1, or 2 for more */
    int32_t spare;
} history;

/* Occurrences of one event at one position. */
typedef struct {
    rv_number *fields;
    uint8_t *known;
    int32_t count;
    int32_t room;
} occurrences;

typedef struct {
    int64_t begin;
    int64_t end;
} stretch;

/* How a name is: not lost; lost; lost up to an instant that is known; lost till its next update. */
enum { NOT_LOST = 0, LOST_ON = 1, LOST_UNTIL = 2, LOST_SINCE = 3 };

/* What is said of a name in place of an update: see `rv_lose` and `rv_found`. What is said of none:
 * AHEAD, before the first sample something was lost; DENSE, from here on every tick may be a position;
 * SPARSE, only samples are behind here. */
enum { SAYS_LOST = RV_SAYS_YES + 1, SAYS_FOUND, SAYS_AHEAD, SAYS_DENSE, SAYS_SPARSE };

/* Whether there are positions: surely; nobody knows; from the next one on. */
enum { ARE_THERE = 0, MAY_BE_THERE = 1, ARE_THERE_NEXT = 2 };

/* Stretches of instants at which a `since` in bounds holds, or which are members of a window (members.h),
 * as a ring. Of a window, what is said of members stands in the first one of two, and in the second how
 * many may be some, and how many are to come until it is known which the last ones are. Of sums, `left` says
 * that all numbers were whole ones; of the last updates that are the least or greatest, `total` counts all. */
typedef struct {
    stretch *at;
    int32_t room;              /* a power of two, or 0 */
    int32_t head;
    int32_t count;
    bool left;
    bool right;
    bool growing;              /* whether the end of the last one is still to come */
    bool apart;                /* whether there is a second one, the unknown taken for the better */
    int64_t total;             /* members that count */
    int64_t lost;              /* members that are not known */
    int64_t members;           /* all */
    int32_t *slots;            /* the latest of equal members: distinct.c */
    int32_t slot_room;
    int32_t known_slots;       /* -1: the table is to be made anew */
} stretches;

typedef struct {
    int64_t at;
    bool left;
    bool right;
    bool apart;
} edge;

/* A sum of numbers, exactly: a number in two's complement of 32 bits a limb, the lowest worth
 * 2^-1088. The largest double times the longest duration, added up for as long, has bit 2240. Behind it
 * stands the sum of squares, or the same with what may be a member. */
#define SUM_LIMBS 71
#define SQUARE_LIMBS 142
#define TALLY_LIMBS (SUM_LIMBS + SQUARE_LIMBS)
typedef struct {
    uint32_t limb[TALLY_LIMBS];
} tally;

/* The state of a part: of all requirements without values of their own, of an instance, or of an
 * attempt with captured values. What a fork copies stands in one block. */
struct run {
    home *home;
    const part *part;
    const plan *all;           /* the whole plan */
    int64_t gap;               /* ticks between two positions; 0: only samples are positions */
    run *next;                 /* of the same list */
    run *previous;
    run *parent;               /* in which its attempt was triggered */
    run *first_child;          /* of the attempts that were triggered in it */
    run *sibling;              /* of those of its parent */
    run *previous_sibling;
    uint64_t call;             /* the last one that concerned it */
    int32_t id;                /* its number among the runs of its home */
    judge *judges;
    truth_log *truth_log;      /* NULL: nothing is noted */
    timers rules;              /* by number of the judge */
    int32_t *touched;
    int32_t *restless;
    int32_t *repeating;        /* pulses that were true at the position before */
    int32_t *failing;          /* episodes whose attempt has failed */
    int32_t *due_rules;        /* room for those that are due */
    int32_t touched_count;
    int32_t restless_count;
    int32_t repeating_count;
    int32_t failing_count;
    /* Of an instance or an attempt with values of its own. */
    int64_t opens_at;          /* nothing starts before; NEVER: nothing does */
    int64_t cut;               /* from then on it is not known what was captured */
    int64_t occurred;          /* when the value did first of which it is the instance */
    uint32_t rank;             /* of its instance; 0: none, or of unknown value */
    int32_t key;               /* the place of that value */
    int32_t judged;            /* the judge of its attempt, if values are captured */
    int32_t starters;          /* the judges of which attempts start here, as bits */
    int32_t judging;           /* those of which attempts are judged here */
    bool opening;              /* whether attempts start from the next position on */
    bool over;                 /* whether what occurred belongs to the last position */
    bool watched;              /* whether it is seen to whether its values stay known */
    bool blurs;                /* whether that can end */
    bool touched_now;          /* whether it came to a position in this call */
    bool doubted;              /* whether it is not known that there is such an instance */
    bool stays_busy;           /* whether the next position matters to what was captured here */
    /* The arrays of a part's size. */
    size_t copied;             /* bytes of the block that a fork copies as they stand */
    char *block;
    rv_number *captured;
    rv_number *value;
    span *spans;               /* of each signal, where no comparison of it comes out otherwise */
    history *history;
    occurrences *payloads;
    int32_t *chosen;           /* by event, the occurrence that a comparison looks at */
    stretches *past;
    edge *edges;
    tally *tallies;
    rv_number *amounts;        /* what windows come to */
    timers wake;               /* nodes, then perishable signals */
    uint64_t *dirty;           /* nodes to be worked out, as bits */
    uint64_t *dirty_words;     /* words of that which are not 0, as bits */
    int32_t *fading;           /* atoms that speak of the last position only */
    int32_t *fresh;            /* the same of the next one */
    int32_t *marks;            /* names of which something is to be forgotten after the position */
    uint8_t *marked;
    uint8_t *truth;
    uint8_t *atom;
    uint8_t *momentary;
    uint8_t *is_fading;
    uint8_t *is_fresh;
    uint8_t *births;
    uint8_t *updated;
    uint8_t *changed;
    uint8_t *occurs;
    uint8_t *silent;
    uint8_t *absent;
    uint8_t *seen;
    /* Of a plan by which names can be lost, else empty. */
    uint8_t *lost;             /* by name, how it is */
    int64_t *until;            /* by name, the last instant at which it is lost; till that is known
                                * the first one */
    rv_number *kept;           /* by signal, what came at that instant */
    uint8_t *has_kept;
    uint8_t *keeps;            /* whether what comes at that instant counts behind it */
    measuring *margins;        /* by judge; NULL: nothing is measured */
    timers margins_due;        /* by judge, when time alone may settle something */
    int32_t *changed_inputs;          /* judges whose leaves may be others than was read */
    int64_t measured_at;       /* the position up to which all are known */
    int32_t changed_count;
    int32_t asked;             /* attempts whose margins are to come */
    /* What is copied with them. */
    struct progress {
        int64_t origin;
        int64_t dense_from;    /* the first such tick */
        int64_t begun;         /* the first position that is surely there */
        int64_t position;
        int64_t before;
        int64_t alarm;         /* before that nothing happens without a change */
        int64_t after;         /* the last sample that was taken */
        int64_t awaited;       /* the tick of a clock that what was taken belongs to; or the position
                                * at which names are lost */
        int64_t ends_at;       /* a position behind which some are known to be found */
        int64_t quiet_from;    /* between these nothing comes that is not there yet */
        int64_t quiet_until;
        int32_t lost_count;    /* names of which something is lost */
        int32_t fading_count;
        int32_t fresh_count;
        int32_t marks_count;
        int32_t births_left;
        int32_t undetermined_left;
        int32_t phase;         /* 1: all is born and determined */
        bool started;
        uint8_t starting;      /* a truth: whether this is the first position */
        uint8_t presence;      /* whether there are positions now */
        bool dense;            /* whether every tick may be one, where only samples are */
        bool gathered;
        bool dirty;            /* a position is to be looked at though no node is dirty */
    } at;
};

/* A value of `for each` that occurred. */
typedef struct {
    rv_number value;
    int64_t occurred;
    run *open;                 /* its instance; NULL: that is over */
    uint32_t rank;
    int32_t next;              /* of those with the same hash */
    int32_t older;             /* of those that are over */
    int32_t newer;
} key;

/* An update of a part: the signal or event there, and what it says. */
typedef struct {
    int32_t local;
    bool event;
    const rv_update *update;
} incoming;

/* An update that is kept for those that look at what was before, or until its tick comes. */
typedef struct {
    int64_t t;
    rv_number value;
    const rv_number *fields;
    int32_t local;
    bool event;
    int32_t says;
    bool last;                 /* of its sample */
} past_update;

/* What is known of a group of items. */
typedef struct {
    int32_t current;           /* so many items are true, or may still be since they were */
    uint8_t before;            /* the truth of its occasion at the position before */
    bool called;               /* whether it looks at the position at hand */
} covered;

/* What was hit in a run. */
typedef struct {
    rv_hit *hits;              /* by item */
    int32_t *current_items;    /* of each group from its first on */
    uint8_t *stands;           /* by item, whether it is one of those */
    covered *groups;
    int32_t *groups_called;
    int32_t *called;           /* watches whose groups look at the next position */
    uint8_t *is_called;        /* by watch */
    int32_t *bins;             /* room for those of all axes that are true */
    int32_t items;
    int32_t called_count;
} covering;

/* What the runs of a part share. */
struct home {
    rv_monitor *monitor;
    const part *part;
    run *root;                 /* without captured values */
    run *last_root;            /* behind it the instances */
    run *captured;             /* the first of an attempt */
    run *last_captured;
    run *spare;
    run **runs;                /* by number, those put aside among them */
    run **touched;             /* those that came to something in this call */
    int32_t *called;           /* numbers of those that a call concerns */
    timers alarms;             /* by number */
    uint64_t call;
    int32_t run_count;
    int32_t run_room;
    int32_t touched_count;
    char *pool;                /* attempts */
    attempt *lone;             /* room for one that stands in none */
    unknown_stretch *unknowns;        /* NULL: nothing is noted */
    int32_t *unknown_of;       /* by signal, the last of its own among those; -1: none is left */
    int32_t unknown_count;
    int32_t unknown_room;
    turn *turns;
    size_t stride;
    int32_t capacity;
    int32_t used;
    int32_t free_slot;
    incoming *inbox;
    int32_t inbox_count;
    int32_t inbox_room;
    int64_t previous;          /* the instant of the sample before the one at hand */
    int64_t alarm;
    /* Of a part whose attempts or instances have values of their own. */
    uint32_t count;
    uint32_t doubts;
    uint32_t passed;
    uint32_t failed;
    uint32_t inconclusive;
    rv_number *room;           /* for values that are captured to be compared */
    rv_number *nothing;        /* the values of its signals where all are unknown; NULL till then */
    int32_t sure[2];           /* what became so and is not numbered: first and last */
    int32_t doubtful[2];
    int32_t done[2];           /* what was decided and is not told */
    past_update *past;
    int32_t past_count;
    int32_t past_room;
    int32_t given;             /* so many of them were judged; others wait for their tick */
    rv_update *held;           /* room for one of those samples */
    int32_t held_room;
    key *keys;
    int32_t *heads;            /* the first key by hash; -1: none */
    int32_t key_room;
    int32_t key_count;
    int32_t free_key;
    int32_t oldest;            /* of those that are over; -1: none */
    int32_t newest;
    int32_t over_count;
    uint32_t last_rank;
    networks *truths;          /* of the form of which it is kept where it is known; NULL till then */
    bool is_blind;             /* whether positions were missed of that */
    covering *covering;        /* of a part with watches; else NULL */
    rv_hit **moves;            /* by judge, from each location to each; NULL: of none */
};

/* Where an attempt stood before it moved. */
typedef struct {
    int64_t clocks[CLOCKS_MOST];
    int32_t location;
    int32_t width;
} before_decision;

struct rv_monitor {
    arena memory;
    plan plan;
    part *parts;
    home *homes;
    rv_record *records;
    rv_number *captured;
    uint8_t *absent;
    int64_t record_count;
    int64_t record_room;
    int64_t sorted;            /* so many records are in order */
    int64_t captured_count;
    int64_t captured_room;
    int64_t *notes;            /* words, one note behind the other */
    int64_t note_count;
    int32_t note_room;
    int32_t span_count;
    int32_t span_room;
    span_of_letters *spans;    /* that notes refer to */
    rv_piece *left;            /* letters that only these refer to */
    uint32_t pins;             /* the epoch of notes that refer to letters */
    rv_let_go let_go;
    void *let_go_user;
    int64_t settled_notes;     /* so many words are of records; behind them those of open attempts */
    int32_t settled_spans;
    int64_t *kept_of;          /* room to count records by requirement and verdict; NULL: all are kept */
    int64_t keep;              /* so many are, of each */
    int64_t laid_count;        /* attempts that were laid down since some were dropped, and before */
    int64_t trim_at;           /* so many of both are borne */
    uint32_t epoch;            /* of notes: what was placed in another one is forgotten */
    before_decision before;    /* the token of the attempt at hand, before it moves */
    int64_t began;
    int64_t last;
    int64_t after;             /* a sample has to be later */
    int64_t reached;
    rv_staleness *stale;       /* by signal */
    margin_shape *shapes;      /* by judge, what is measured; NULL: nothing is */
    margin_results margins;
    uint8_t *late;             /* by requirement, whether something came too late for it */
    /* Where only samples are positions. */
    uint8_t *losing;           /* by name, whether it is lost; behind them, whether nothing is */
    int32_t losing_count;
    int64_t dense_until;       /* the last tick that may be one; NEVER: it goes on; RV_NO_TIME: none
                                * may be now */
    int64_t dense_end;         /* that of the last such stretch */
    int64_t heard;             /* how far names are known to have been lost; RV_NO_TIME: none was */
    bool measures_positions;
    bool hurries;              /* whether rows are judged, and figures can wait for some more of them */
    bool is_alone;             /* whether there is one part, without values of its own */
    bool finished;
    bool spoilt;
    bool keeps_notes;
    bool tells_open;           /* whether open attempts are being told of */
    bool told_open;            /* whether notes of them stand behind those of records */
};

#endif
