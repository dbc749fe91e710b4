/* The monitor core: judges a stream of samples by a plan. C99, no Python, no global state.
 *
 * A plan (plan.md) is a constant block of bytes, made from a specification by `rvmon.core.plan`. It
 * is checked once, when it is opened; after that nothing in it can make the core read or write
 * outside of its memory. Times are nanoseconds between -2^62 and 2^62.
 *
 * Unknown values are a kind of number of their own, so NaN never reaches a comparison; still, compile
 * without -ffast-math and with -ffp-contract=off, or sums differ in the last digit. */
#ifndef RVMON_CORE_H
#define RVMON_CORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RV_NEVER INT64_MAX
/* No instant yet: of a run without samples. */
#define RV_NO_TIME INT64_MIN

/* A number: exact if it is whole, else binary64. Booleans are the whole numbers 0 and 1; labels are
 * whole numbers that the plan's maker has given them. */
enum { RV_UNKNOWN = 0, RV_WHOLE = 1, RV_REAL = 2 };

/* Why a number is unknown, as its `whole`, for who tells of it. */
enum { RV_IS_NONE = 0, RV_IS_NAN = 1 };

typedef struct {
    int32_t kind;
    union {
        int64_t whole;
        double real;
    } as;
} rv_number;

/* What a sample says of a name: NO is "an event that did not occur"; UNKNOWN, that it was lost. */
enum { RV_SAYS_NO = 0, RV_SAYS_UNKNOWN = 1, RV_SAYS_YES = 2 };

/* One update. Several of one event in one sample are several occurrences. */
typedef struct {
    int32_t name;              /* signals first, then events */
    int32_t says;              /* of a signal: UNKNOWN or YES */
    rv_number value;           /* of a signal */
    const rv_number *fields;   /* of an event that occurs, as many as it has; NULL: all unknown */
} rv_update;

enum { RV_FAIL = 0, RV_PASS = 1, RV_INCONCLUSIVE = 2, RV_NOT_TRIGGERED = 3 };

/* What settled an attempt: the samples so far; the end of the trace; a policy; nothing. */
enum { RV_BY_PREFIX = 0, RV_HELD_TO_END = 1, RV_BY_POLICY = 2, RV_OPEN = 3 };

/* The record of an attempt; `decided` of an open one is the end of the trace, or means nothing. */
typedef struct {
    int64_t triggered;
    int64_t decided;
    int64_t captured;          /* place of its captured values among those of all; -1: it has none */
    int64_t note;              /* place of what its reason is worked out from; -1: nothing is noted */
    int32_t requirement;
    uint32_t number;
    uint8_t verdict;
    uint8_t decision;
    uint8_t in_doubt;          /* 1: a trigger that may not have been; counted apart */
} rv_record;

/* By how much the formula of an attempt holds, or of a position what its requirement owes there: within
 * these bounds, whatever is not known and whatever had come behind the end. Above 0 it holds. */
typedef struct {
    int64_t t;                 /* of the trigger, or the position */
    double low;
    double high;
    double kept;               /* the least, if all is well behind the end that has to be kept up */
    int32_t requirement;
    uint32_t number;
    uint8_t in_doubt;          /* as in `rv_record` */
    uint8_t of_position;       /* 1: it is of no attempt */
} rv_margin;

typedef struct rv_plan rv_plan;
typedef struct rv_monitor rv_monitor;

/* Where memory comes from. Three functions, as malloc, realloc, free: from a heap. A block: that alone, and running out of it is
 * `RV_NO_MEMORY`. Everything is given back at once, by `rv_free`. */
typedef struct {
    void *(*allocate)(size_t size);
    void *(*resize)(void *memory, size_t size);
    void (*release)(void *memory);
    void *block;
    size_t size;
} rv_memory;

/* Why something was not done. */
enum {
    RV_OK = 0,
    RV_BAD_PLAN = 1,
    RV_NO_MEMORY = 2,
    RV_TOO_EARLY = 3,          /* the sample is not later than all before */
    RV_OUT_OF_RANGE = 4,       /* an instant beyond 2^62 */
    RV_FINISHED = 5,
    RV_BAD_SNAPSHOT = 6,       /* the bytes are none of this plan, or damaged */
    RV_NOT_FRESH = 7           /* a run has begun */
};

/* Check a plan: the place of the first section found wrong, -1 if all is well. The bytes are not
 * copied: they have to stay, aligned to 8. */
int32_t rv_plan_check(const void *bytes, size_t size);

/* A monitor at the begin of a run; NULL if the plan is wrong or memory is short. */
rv_monitor *rv_new(const void *plan, size_t size, rv_memory memory);
void rv_free(rv_monitor *m);

/* Make room for so many open attempts of each part of the plan, at once and not bit by bit, and for as
 * many records. Where memory is short the run is spoilt. */
int rv_reserve(rv_monitor *m, int32_t attempts);

/* Bytes that a block, aligned to 16, has to have for what was done so far; more if not all of it is
 * done again. */
size_t rv_memory_used(const rv_monitor *m);

/* Begin another run; names declared absent are so still. */
int rv_reset(rv_monitor *m);

/* Say that a name has no source: it is unknown throughout. Before the first sample. */
void rv_set_absent(rv_monitor *m, int32_t name);

/* Judge one sample, whole. What is refused leaves the monitor as it was, except RV_NO_MEMORY: then
 * the run is spoilt: it takes nothing more, and no verdict of it is green. */
int rv_step(rv_monitor *m, int64_t t, const rv_update *updates, int32_t count);

/* No sample before `t` will come. */
int rv_advance(rv_monitor *m, int64_t t);

/* From `since` on these names may say anything: they are unknown, and so is whether they are updated.
 * What comes of them meanwhile is left out. It is `rv_advance(since)` too; RV_TOO_EARLY, and nothing is
 * done, if that was judged already. Names without a source are unknown anyway; there may be none. */
int rv_lose(rv_monitor *m, int64_t since, const int32_t *names, int32_t count);

/* `at` is the last instant at which these names are lost, and time has come to it: an event is known
 * behind it, a signal at its first update there or at `at` itself. */
int rv_found(rv_monitor *m, int64_t at, const int32_t *names, int32_t count);

/* A sample at `t` with these names came behind what was judged: it is not judged. No verdict of a
 * requirement that it would have touched is green any more; `count` -1: of any, as it cannot be read. */
int rv_late(rv_monitor *m, int64_t t, const int32_t *names, int32_t count);

/* End the run, at `t` if that is later than all so far (RV_NO_TIME: where it is). */
int rv_finish(rv_monitor *m, int64_t t);

/* The last instant of a trace that is finished at `t`; RV_NO_TIME if it has no position. */
int64_t rv_end(const rv_monitor *m, int64_t t);

/* The next instant at which time alone can decide something. */
int64_t rv_next_due(rv_monitor *m);

/* The instants of the first and the last sample, and the instant that time has come to. */
typedef struct {
    int64_t began;
    int64_t last;
    int64_t reached;
} rv_times;

rv_times rv_times_of(const rv_monitor *m);

/* How often a signal went stale, and when first. */
typedef struct {
    int64_t count;
    int64_t first;
} rv_staleness;

rv_staleness rv_stale(const rv_monitor *m, int32_t signal);

/* Records since the last `rv_forget_records`, of each call in the order of reports: by decision, then
 * requirement, then number. Valid until the next call. */
int64_t rv_records(const rv_monitor *m, const rv_record **records);
const rv_number *rv_captured(const rv_monitor *m, const rv_record *record);

/* How many values each attempt of a requirement has: that of `for each`, then those of `let`. */
int32_t rv_captured_of(const rv_monitor *m, int32_t requirement);
void rv_forget_records(rv_monitor *m);

/* For a run of weeks: have but the newest records of each requirement and verdict be kept, so many, and
 * as many of the attempts that stay open for good. Nothing is dropped but by `rv_trim`, which looks
 * whether it is worth it, and says whether records are others than before; at the end of a run it always
 * is. What was dropped is counted on. */
int rv_keep(rv_monitor *m, int64_t most);
bool rv_trim(rv_monitor *m);

/* Attempts that are open; `take` returns false to end. `captured` is NULL if they have no values. Notes
 * of them are valid until the next call. */
typedef bool (*rv_take)(void *user, const rv_record *record, const rv_number *captured);
void rv_each_open(rv_monitor *m, rv_take take, void *user);

/* Have noted with each record from here on what its reason is worked out from: where its run stood just
 * before the decision, since when propositions had their truths, the letters that matter. Before the
 * first sample; nobody who wants verdicts alone needs it. It takes some words a decision and a few
 * nanoseconds a change. The words are told of in notes.c.
 *
 * Letters stand in pieces, which many notes share; a piece that is full stays as it is. Who reads them
 * can hang something on a piece, and is told by `let_go` when that serves no more. */
typedef struct rv_piece rv_piece;
const int64_t *rv_piece_words(const rv_piece *piece, int32_t *count); /* a position, then truths */
int32_t rv_piece_room(const rv_piece *piece);                         /* words that it can have */
rv_piece *rv_piece_next(const rv_piece *piece);
void **rv_piece_held(rv_piece *piece, int32_t which);                 /* of who reads it: 0 or 1 */

typedef struct {
    const int64_t *words;
    const int64_t *state;      /* of the propositions at the decision; NULL: nobody asks */
    int64_t count;
    int64_t state_count;
    rv_piece *first;           /* letters; NULL: they do not matter */
    rv_piece *last;
    int32_t last_count;        /* words of the last piece */
} rv_note;

/* Keep notes of decisions. Of a plan that measures none are kept: figures have no reasons. */
typedef void (*rv_let_go)(void *user, void *held);
int rv_keep_notes(rv_monitor *m, rv_let_go let_go, void *user);

/* What was noted with a record; false: nothing. */
bool rv_note_of(const rv_monitor *m, const rv_record *record, rv_note *note);

/* The words of all notes, and the letters of a number among those that notes refer to; false: there are
 * no more. */
int64_t rv_notes(const rv_monitor *m, const int64_t **words);
bool rv_span(const rv_monitor *m, int32_t number, rv_note *note);

/* Have each position of a sample be measured, and not those of attempts alone; what captures values is
 * not. Before the first sample, of a plan that says what is measured. */
void rv_measure_positions(rv_monitor *m);

/* Figures that nothing can change any more, since the last `rv_forget_margins`: of each call by instant,
 * then requirement. Valid until the next call. */
int64_t rv_margins(rv_monitor *m, const rv_margin **margins);
void rv_forget_margins(rv_monitor *m);

/* What is known of the attempts whose figures are to come; bounds that only draw closer. `take` returns
 * false to end. */
typedef bool (*rv_take_margin)(void *user, const rv_margin *margin);
void rv_each_margin(rv_monitor *m, rv_take_margin take, void *user);

/* How many attempts of a requirement failed, passed, stayed open, and whether its trigger was ever
 * true or false. */
typedef struct {
    int64_t failed;
    int64_t passed;
    int64_t inconclusive;
    bool heard;
    bool open;                 /* an attempt is undecided now */
    bool late;                 /* something came too late that it would have been judged by */
} rv_counts;

rv_counts rv_count(const rv_monitor *m, int32_t requirement);

/* The verdict so far: final once the run is finished; never PASS or NOT_TRIGGERED if it is spoilt, or
 * something came too late. */
int rv_verdict(const rv_monitor *m, int32_t requirement);

/* The run as it stands, as bytes, with all records that were not forgotten: so many are needed, and
 * written if there is room. 0: it is spoilt. */
size_t rv_save(rv_monitor *m, void *bytes, size_t size);

/* Have a monitor that was just made of the same plan go on where that of some bytes stood. No bytes lead
 * it outside of its memory. One that refuses them, RV_BAD_SNAPSHOT, is spoilt: free it. */
int rv_load(rv_monitor *m, const void *bytes, size_t size);

/* Whether memory was short in this run. */
bool rv_spoilt(const rv_monitor *m);

/* Where the formulas of a plan are known that it keeps the truths of (`truths` in plan.md): ranges of
 * positions at which an operator has a value, the unknown taken for the worse or for the better; ticks,
 * ticks divided by the gap, or, where only samples are positions, their numbers from 0. They go as far
 * as the last change, and to the end once the run is finished. Valid until the next call; -1: the plan
 * keeps none, or has no such operator. */
typedef struct {
    int64_t first;
    int64_t last;
} rv_range;

int64_t rv_truths(const rv_monitor *m, int32_t operator_number, bool better, bool value,
                  const rv_range **found);

/* How often each item of the groups of a plan was hit in the run, and when first (0 of none), in their
 * order; NULL and 0: it has none. */
typedef struct {
    int64_t count;
    int64_t first;
} rv_hit;

const rv_hit *rv_hits(const rv_monitor *m, int32_t *items);

/* How often attempts of a requirement went from one location of its automaton to another, and when
 * first: by `locations` times the one plus the other; one to itself: began, in the first. Those in doubt,
 * and those of which two readings differ, are left out. NULL and 0: the plan does not ask for it. */
const rv_hit *rv_moves(const rv_monitor *m, int32_t requirement, int32_t *locations);

/* How the run stands at `now`, at or after its last sample: words that are equal for runs that go on
 * alike, each as it is seen from there. Returns how many there are, of which `room` are written; `next`
 * is the first instant behind at which time alone may change something. Nothing but rv_finish at `now`
 * may follow. -1: nothing is told, as the run is over, or a chain of windows judges. */
int64_t rv_situation(rv_monitor *m, int64_t now, int64_t *words, int64_t room, int64_t *next);

/* What a plan declares. */
typedef struct {
    int32_t signals;
    int32_t events;
    int32_t fields;
    int32_t requirements;
    int32_t captured;          /* the most values that an attempt has */
} rv_sizes;

rv_sizes rv_sizes_of(const rv_monitor *m);

/* The first field of an event, and how many it has. */
int32_t rv_fields_of(const rv_monitor *m, int32_t event, int32_t *first);

/* Columns: rows of one recording, in order of time; those of one instant are one sample, in which of the
 * values of a signal the last one counts. What is real is given as REAL, NaN for unknown; all else as
 * WHOLE or BYTE. */
enum { RV_COLUMN_REAL, RV_COLUMN_WHOLE, RV_COLUMN_BYTE };

typedef struct rv_column {
    const void *values;        /* as `kind` says; NULL: of an event, or of a field that is unknown */
    const uint8_t *says;       /* per row; NULL: YES in all; 255: no update; of a field: it is not given */
    int32_t kind;
    int32_t name;              /* of a field nothing */
    const struct rv_column *fields; /* of an event: a column for each field, or NULL; it occurs with a
                                * payload where one of them is given */
} rv_column;

/* Judge rows; `done` counts those that were. No name has two columns. */
int rv_rows(rv_monitor *m, const int64_t *times, int64_t rows, const rv_column *columns,
            int32_t count, int64_t *done);

#ifdef __cplusplus
}
#endif

#endif
