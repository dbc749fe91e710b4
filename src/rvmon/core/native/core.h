/* The public interface of the monitor core: an interpreter, in C99, that evaluates the requirements
 * of a plan over a stream of time-stamped samples and reports the verdict of each attempt as soon
 * as it is decided. It depends on no Python and has no global state; everything a run remembers
 * hangs off one rv_monitor.
 *
 * A plan (plan/plan.md) is a constant block of bytes that `rvmon.core.pack` compiles from a
 * specification. It is validated once, by rv_new; after that nothing in it can make the core read
 * or write outside its memory. Names do not reach the core: signals, events and requirements are
 * numbers that the maker of the plan assigned.
 *
 * Time is counted in ticks of one nanosecond, and every instant lies strictly between -2^62 and
 * 2^62, so that the sum of two instants does not overflow.
 *
 * An unknown value is a kind of rv_number, so NaN never reaches a comparison. Nevertheless compile
 * without -ffast-math and with -ffp-contract=off, or sums differ in the last bit between compilers. */
#ifndef RVMON_CORE_H
#define RVMON_CORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RV_NEVER INT64_MAX
/* "No such instant": for example the last sample of a run that has none. */
#define RV_NO_TIME INT64_MIN

/* A number: whole numbers are exact (int64), all others binary64; the two are compared exactly. A
 * Boolean is the whole number 0 or 1, a label the whole number that the plan gives it. */
enum { RV_UNKNOWN = 0, RV_WHOLE = 1, RV_REAL = 2 };

/* Why a number is unknown, in `as.whole`; for diagnostics only, it never influences a verdict. */
enum { RV_IS_NONE = 0, RV_IS_NAN = 1 };

typedef struct {
    int32_t kind;
    union {
        int64_t whole;
        double real;
    } as;
} rv_number;

/* What an update says about its name. NO: this event did not occur. UNKNOWN: the value, or whether
 * the event occurred, was lost. */
enum { RV_SAYS_NO = 0, RV_SAYS_UNKNOWN = 1, RV_SAYS_YES = 2 };

/* One update of one name. Several updates of one event in a sample are several occurrences. */
typedef struct {
    int32_t name;              /* signals are numbered first, then events */
    int32_t says;              /* a signal: UNKNOWN or YES */
    rv_number value;           /* signals only */
    const rv_number *fields;   /* payload of an event that occurs: one number per declared field; NULL
                                * if all fields are unknown */
} rv_update;

enum { RV_FAIL = 0, RV_PASS = 1, RV_INCONCLUSIVE = 2, RV_NOT_TRIGGERED = 3 };

/* How an attempt was settled: by the samples up to its decision; by the rule that an obligation
 * without a deadline counts as kept at the end of the trace; by the `at end` policy of its
 * requirement; or not at all, so it stayed open. */
enum { RV_BY_PREFIX = 0, RV_HELD_TO_END = 1, RV_BY_POLICY = 2, RV_OPEN = 3 };

/* The record of one attempt. */
typedef struct {
    int64_t triggered;         /* start of the attempt */
    int64_t decided;           /* when the verdict became certain; for an open attempt the end of the
                                * trace, or meaningless if it comes from rv_each_open */
    int64_t captured;          /* index of its first captured value, for rv_captured; -1: it captures
                                * none */
    int64_t note;              /* index of its note, for rv_note_of; -1: it has none */
    int32_t requirement;
    uint32_t number;           /* from 1, in order of the starts within the requirement; attempts in
                                * doubt are numbered separately */
    uint8_t verdict;
    uint8_t decision;
    uint8_t in_doubt;          /* 1: it is unknown whether the trigger occurred */
} rv_record;

/* The robustness (margin) of an attempt, or of one position: bounds on the distance to violation.
 * The exact value lies in [low, high] for every completion of the unknown inputs and of the trace
 * beyond its end. A positive value means that the formula holds. */
typedef struct {
    int64_t t;                 /* start of the attempt, or the position */
    double low;
    double high;
    double kept;               /* the lower bound if obligations without a deadline are kept beyond the
                                * end of the trace */
    int32_t requirement;
    uint32_t number;
    uint8_t in_doubt;          /* as in `rv_record` */
    uint8_t of_position;       /* 1: measures a position, not an attempt */
} rv_margin;

typedef struct rv_monitor rv_monitor;

/* Where a monitor gets its memory. Either three functions that behave as malloc, realloc and free,
 * or one caller-owned block of `size` bytes, in which case running out of it is RV_NO_MEMORY and
 * the functions are ignored. rv_free releases everything at once. */
typedef struct {
    void *(*allocate)(size_t size);
    void *(*resize)(void *memory, size_t size);
    void (*release)(void *memory);
    void *block;
    size_t size;
} rv_memory;

/* Return codes. */
enum {
    RV_OK = 0,
    RV_NO_MEMORY = 1,
    RV_TOO_EARLY = 2,          /* at or before an instant that was already judged */
    RV_OUT_OF_RANGE = 3,       /* an instant outside (-2^62, 2^62) */
    RV_FINISHED = 4,           /* rv_finish was called; only rv_reset starts over */
    RV_BAD_SNAPSHOT = 5,       /* made for another plan, or damaged */
    RV_NOT_FRESH = 6           /* rv_load needs a monitor without samples */
};

/* Validate a plan. Returns -1 if it is valid, else the number of the first section found wrong
 * (plan/plan.h); 0 may also mean a bad header. `bytes` has to be aligned to 8. */
int32_t rv_plan_check(const void *bytes, size_t size);

/* A monitor before its first sample; NULL if the plan is invalid or memory is short. The plan is
 * not copied: it has to outlive the monitor and stay unchanged. */
rv_monitor *rv_new(const void *plan, size_t size, rv_memory memory);
void rv_free(rv_monitor *m);

/* Preallocate room for this many simultaneously open attempts in each part of the plan, and for as
 * many records, instead of growing on demand. RV_NO_MEMORY spoils the run (see rv_step). */
int rv_reserve(rv_monitor *m, int32_t attempts);

/* Bytes handed out so far: the size that a block aligned to 16 needs for the same calls. Measure it in
 * a block, or after rv_reserve: on a heap, an array that grew beyond 16 KiB was resized and counts
 * once, while in a block its smaller predecessors remain. */
size_t rv_memory_used(const rv_monitor *m);

/* Start a new run: all attempts, records and values are dropped, memory is kept for reuse, and
 * names declared absent remain so. */
int rv_reset(rv_monitor *m);

/* Declare, before the first sample, that nothing will ever report this name: it is unknown
 * throughout the run. */
void rv_set_absent(rv_monitor *m, int32_t name);

/* Judge one sample: all updates with the instant `t`, which has to be later than every sample
 * before. A refused sample leaves the monitor as it was, except for RV_NO_MEMORY: then the run is
 * spoilt, that is, it accepts nothing more and no requirement gets the verdict PASS or
 * NOT_TRIGGERED. */
int rv_step(rv_monitor *m, int64_t t, const rv_update *updates, int32_t count);

/* Promise that no sample before `t` will come. This lets deadlines before `t` expire. */
int rv_advance(rv_monitor *m, int64_t t);

/* Start an outage of these names: from `since` on their sources may have sent anything, so values,
 * occurrences and even whether there was an update are unknown. Updates of the names that arrive
 * during the outage are ignored. Implies rv_advance(since); RV_TOO_EARLY, without any effect, if
 * `since` was already judged. Names without a source are skipped. `count` may be 0, since in sampled
 * time a lost sample matters even if none of its names is read. */
int rv_lose(rv_monitor *m, int64_t since, const int32_t *names, int32_t count);

/* End the outage of these names; `at` is its last instant, and time has to have advanced that far.
 * An event is known again after `at`, a signal from its first update at or after `at`. */
int rv_found(rv_monitor *m, int64_t at, const int32_t *names, int32_t count);

/* Report that a sample at `t` with these names arrived too late to be judged. From now on no
 * requirement that it could have affected gets PASS or NOT_TRIGGERED; records already reported stay
 * valid. `count` -1: the sample is unreadable, so every requirement is affected. */
int rv_late(rv_monitor *m, int64_t t, const int32_t *names, int32_t count);

/* End the run at `t`, or at the last instant known so far if that is later or `t` is RV_NO_TIME.
 * Pending attempts are settled by their requirements' `at end` policies. */
int rv_finish(rv_monitor *m, int64_t t);

/* The last instant that the trace would have if it were finished at `t`; RV_NO_TIME if it has none. */
int64_t rv_end(const rv_monitor *m, int64_t t);

/* The next instant at which passing time alone, without a sample, can decide something; RV_NEVER if
 * none. */
int64_t rv_next_due(rv_monitor *m);

/* The first sample, the last sample, and how far time has advanced; RV_NO_TIME before the first
 * sample. */
typedef struct {
    int64_t began;
    int64_t last;
    int64_t reached;
} rv_times;

rv_times rv_times_of(const rv_monitor *m);

/* How often a signal went stale, and when it first did. */
typedef struct {
    int64_t count;
    int64_t first;
} rv_staleness;

rv_staleness rv_stale(const rv_monitor *m, int32_t signal);

/* The records since the last rv_forget_records; returns their number. Those of one call are sorted
 * by decision instant, then requirement, then number. The array belongs to the monitor and is valid
 * until its next call. rv_captured returns the captured values of a record, valid for the same time;
 * NULL: none. */
int64_t rv_records(const rv_monitor *m, const rv_record **records);
const rv_number *rv_captured(const rv_monitor *m, const rv_record *record);

/* How many values an attempt of this requirement captures: the key of `for each`, if any, then each
 * `let`. */
int32_t rv_captured_of(const rv_monitor *m, int32_t requirement);
void rv_forget_records(rv_monitor *m);

/* Bound the memory of a run without end. After rv_keep, rv_trim keeps only the `most` newest
 * records per requirement and verdict, and as many of the attempts that are known to stay
 * undecided. Nothing is dropped except by rv_trim, which acts once what is stored has doubled since
 * it last did, and grown by one record per run, and always after rv_finish; it returns whether the
 * records changed. Counts and verdicts remain exact. */
int rv_keep(rv_monitor *m, int64_t most);
bool rv_trim(rv_monitor *m);

/* Call `take` for each open attempt until it returns false. `captured` is NULL if the attempt
 * captures nothing. Notes of open attempts are valid until the next call of the monitor. */
typedef bool (*rv_take)(void *user, const rv_record *record, const rv_number *captured);
void rv_each_open(rv_monitor *m, rv_take take, void *user);

/* Notes: for each record, the raw data from which a reason ("why did it fail?") can be derived: the
 * state of its automaton just before the decision, since when each proposition had its truth, and
 * the letters that matter. Off by default: a note takes some tens of words per decision and some
 * nanoseconds per change. notes/write_notes.c documents the words.
 *
 * Letters are stored in chunks called pieces, shared by many notes; a full piece never changes. A
 * reader may attach two pointers of its own to a piece; `let_go` is called with each when the piece
 * is freed. */
typedef struct rv_piece rv_piece;
const int64_t *rv_piece_words(const rv_piece *piece, int32_t *count); /* a position, then packed
                                                                       * truths, repeatedly */
int32_t rv_piece_room(const rv_piece *piece);                         /* its capacity in words */
rv_piece *rv_piece_next(const rv_piece *piece);
void **rv_piece_held(rv_piece *piece, int32_t which);                 /* the reader's pointer,
                                                                       * `which` 0 or 1 */

typedef struct {
    const int64_t *words;      /* the note itself */
    const int64_t *state;      /* the propositions at the decision; NULL if they are not needed */
    int64_t count;             /* words of the note */
    int64_t state_count;
    rv_piece *first;           /* the first piece of letters; NULL if letters do not matter */
    rv_piece *last;
    int32_t last_count;        /* how many words of the last piece belong to the note */
} rv_note;

/* Switch notes on, before the first sample. No effect for a plan that measures margins: those are
 * reported without reasons. */
typedef void (*rv_let_go)(void *user, void *held);
int rv_keep_notes(rv_monitor *m, rv_let_go let_go, void *user);

/* The note of a record; false: it has none. */
bool rv_note_of(const rv_monitor *m, const rv_record *record, rv_note *note);

/* All note words at once (returns their number), and the pieces of the letter span `number` that
 * notes refer to (false: no such span). */
int64_t rv_notes(const rv_monitor *m, const int64_t **words);
bool rv_span(const rv_monitor *m, int32_t number, rv_note *note);

/* Measure every position at which there is a sample, not only those at which an attempt starts, but
 * for requirements with captured values. To be called before the first sample, for a plan with
 * margins. */
void rv_measure_positions(rv_monitor *m);

/* The margins that became final since the last rv_forget_margins; returns their number. Those of
 * one call are sorted by instant, then requirement. Valid until the next call. */
int64_t rv_margins(rv_monitor *m, const rv_margin **margins);
void rv_forget_margins(rv_monitor *m);

/* Call `take` with the current bounds of every margin that is not final yet, until it returns
 * false. Bounds only ever tighten. */
typedef bool (*rv_take_margin)(void *user, const rv_margin *margin);
void rv_each_margin(rv_monitor *m, rv_take_margin take, void *user);

/* The attempts of a requirement by verdict. */
typedef struct {
    int64_t failed;
    int64_t passed;
    int64_t inconclusive;
    bool heard;                /* its trigger was known to be true or false at least once */
    bool open;                 /* some attempt is undecided now */
    bool late;                 /* rv_late reported a sample that could have affected it */
} rv_counts;

rv_counts rv_count(const rv_monitor *m, int32_t requirement);

/* The verdict of a requirement: FAIL if an attempt failed, else INCONCLUSIVE if one is or may be
 * undecided, else PASS or NOT_TRIGGERED. It is final once the run is finished. It is never PASS or
 * NOT_TRIGGERED if the run is spoilt or a sample was late for the requirement. */
int rv_verdict(const rv_monitor *m, int32_t requirement);

/* Serialise the run, including all records not yet forgotten. Returns the size in bytes, and writes
 * them if `size` is at least that; 0 if the run is spoilt, or the plan has margins. */
size_t rv_save(rv_monitor *m, void *bytes, size_t size);

/* Restore a run that rv_save wrote into a monitor newly made from the same plan (no absent names, no
 * rv_reserve). The bytes are validated like a plan: none can lead outside the monitor's memory. After
 * RV_BAD_SNAPSHOT the monitor is spoilt and can only be freed, unless the bytes were too few for a
 * header. */
int rv_load(rv_monitor *m, const void *bytes, size_t size);

/* Whether memory ran out in this run. */
bool rv_spoilt(const rv_monitor *m);

/* For a plan that records the truths of formulas over time (`truths` in plan.md): the ranges of
 * positions at which an operator is known to have a value, with unknown inputs resolved against the
 * formula or, if `better`, in its favour. Positions are ticks; ticks divided by the gap; or, where
 * only samples are positions, sample numbers from 0. They extend to the last change, and to the end
 * once the run is finished. Returns the number of ranges, which are valid until the next call; -1 if
 * the plan records none, or has no such operator. */
typedef struct {
    int64_t first;
    int64_t last;
} rv_range;

int64_t rv_truths(const rv_monitor *m, int32_t operator_number, bool better, bool value,
                  const rv_range **found);

/* Coverage: how often each item of the plan's groups was hit, and when first (0 if never), in the
 * order of items. NULL and 0 if the plan has no groups. */
typedef struct {
    int64_t count;
    int64_t first;
} rv_hit;

const rv_hit *rv_hits(const rv_monitor *m, int32_t *items);

/* Coverage of an automaton: for each pair of locations how often an attempt moved from one to the
 * other, at index `from * locations + to`; the diagonal of the initial location counts the starts.
 * Attempts in doubt, and moves on which the two readings of an unknown letter disagree, are not
 * counted. NULL and 0 if the plan does not request it. */
const rv_hit *rv_moves(const rv_monitor *m, int32_t requirement, int32_t *locations);

/* The state of the run relative to `now`, which is at or after its last sample, as a word sequence:
 * two runs with equal words behave equally from `now` on (instants are relative, ages clamped).
 * Returns the number of words, of which the first `room` are written. `*next` is the first later
 * instant at which time alone may change something. Afterwards only rv_finish at `now` is allowed.
 * -1: not available, since the run is over, in an outage, or has a requirement judged by a window
 * chain (windows/). */
int64_t rv_situation(rv_monitor *m, int64_t now, int64_t *words, int64_t room, int64_t *next);

/* What the plan of a monitor declares. */
typedef struct {
    int32_t signals;
    int32_t events;
    int32_t fields;
    int32_t requirements;
    int32_t captured;          /* the most values that an attempt captures */
} rv_sizes;

rv_sizes rv_sizes_of(const rv_monitor *m);

/* Returns how many fields an event has; `*first` is the number of the first of them. */
int32_t rv_fields_of(const rv_monitor *m, int32_t event, int32_t *first);

/* Columns: the rows of a recording, in order of time. Rows with equal stamps are one sample; if it
 * has several values of a signal the last one counts. Real signals are given as REAL, NaN standing
 * for unknown; everything else as WHOLE or BYTE. */
enum { RV_COLUMN_REAL, RV_COLUMN_WHOLE, RV_COLUMN_BYTE };

typedef struct rv_column {
    const void *values;        /* elements as `kind` says; NULL: an event, or a field that is unknown
                                * throughout */
    const uint8_t *says;       /* per row an RV_SAYS_* value, or 255 for no update (for a field: not
                                * given); NULL: YES in every row */
    int32_t kind;
    int32_t name;              /* unused in a column of a field */
    const struct rv_column *fields; /* of an event, a column per field, or NULL; the event occurs with a
                                     * payload in rows where some field is given */
} rv_column;

/* Judge rows as rv_step would, one after the other; `done` receives how many rows were judged. At
 * most one column per name. */
int rv_rows(rv_monitor *m, const int64_t *times, int64_t rows, const rv_column *columns,
            int32_t count, int64_t *done);

#ifdef __cplusplus
}
#endif

#endif
