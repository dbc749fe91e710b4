/* Judging whole columns of samples. Most rows of a recording change no truth, so 64 rows at a time are
 * compared column by column, without branches where possible, and only rows at which something can
 * change are judged as samples (rv_step). The result is the same as judging each row.
 *
 * Two row masks per column: `said`, it has an update; `needed`, the core has to see that update. A row is
 * judged if some column tells, or something is due by then. */
#ifndef RVMON_ROWS_H
#define RVMON_ROWS_H

#include "runs/runs.h"

/* In `says` of a column: no update. */
#define NO_UPDATE 255

/* Rows that are examined together, a bit each. */
#define TOGETHER 64

/* Which updates of a name can change something, from all to few; smaller is stricter. */
enum {
    NO_UPDATES,                /* it is not read */
    EACH_UPDATE,
    EACH_VALUE,                /* those that change its value */
    BY_CONSTANTS,              /* those that change the outcome of a comparison with a constant */
    OCCURRENCES                /* events: those that say it occurred */
};

/* A column while its rows are examined. */
typedef struct {
    const rv_column *column;
    const subscription *readers; /* parts that read the name */
    int32_t reader_count;
    int32_t how;               /* which updates matter: EACH_VALUE, ... */
    int32_t fields;            /* fields of an event that the column gives */
    bool is_event;
    bool ignores_nan;
    bool perishable;           /* updates postpone that it goes stale */
    bool is_plain;             /* its comparisons influence attempts only: measured.c */
    bool is_idle;              /* and no attempt is open */
    rv_number last;            /* its last value in the rows examined so far */
    span between;              /* a value in it, or equal to `last`, compares as `last` does */
    uint64_t said;             /* rows with an update, as bits */
    uint64_t needed;           /* those the core has to see */
} column_watch;

/* A sample assembled from rows. */
typedef struct {
    rv_update *updates;
    rv_number *fields;
    int64_t room;              /* capacity in rows */
    int32_t count;
    int32_t field_count;
} row_sample;

typedef struct {
    rv_monitor *m;
    const int64_t *times;
    int64_t count;
    column_watch *watches;
    int32_t columns;
    row_sample sample;
    int64_t first;             /* the first row examined */
    int64_t together;          /* rows examined; 0: none are */
    int64_t fresh;             /* updates before this row have postponed staleness */
    uint64_t moved;            /* rows at which something may change, as bits from `first` */
    bool known;                /* `how` of the columns is final: every part is in phase 1 */
    bool perishes;             /* some column is of a signal that goes stale */
    double *leaves[2];         /* margins: scratch for the leaves of rows, at least and at most */
    int32_t leaves_room;       /* capacity, in values per row */
    int64_t unsettled;         /* rows since margins were last settled */
} batch;

static inline home *home_of(const batch *s, const column_watch *w, int32_t reader)
{
    return &s->m->homes[w->readers[reader].part];
}

static inline run *root_of(const batch *s, const column_watch *w, int32_t reader)
{
    return home_of(s, w, reader)->root;
}

static inline bool bit_at(uint64_t word, int64_t place)
{
    return ((word >> place) & 1U) != 0U;
}

/* A mask of the bits below a place, which is 64 at most. */
static inline uint64_t bits_before(int64_t place)
{
    return (place >= TOGETHER) ? ~UINT64_C(0) : ((UINT64_C(1) << place) - 1);
}

/* ---- rows.c */
rv_number number_in(const rv_column *c, int64_t row);

/* ---- passing.c: which updates matter */
void learn_how(const batch *s, column_watch *w);
void learn_between(const batch *s, column_watch *w);
bool compares_alike(const column_watch *w, const rv_number *value);

/* ---- measured.c: rows that are measured but not judged */
bool begin_measured(batch *s);
void end_measured(batch *s);
bool may_pass_measured(const rv_monitor *m);
bool is_plain_column(const batch *s, const column_watch *w);
bool is_idle_now(const batch *s, const column_watch *w);
void measure_rows(batch *s, int64_t row, int64_t end);
void settle_rows(batch *s, int64_t rows);

/* ---- ahead.c: the rows at which something may change */
void look_ahead(batch *s, int64_t row);

/* ---- passing.c */
void turn_from(batch *s, int64_t row);
int64_t pass_over(batch *s, int64_t row);
void make_ready(batch *s, int64_t row, int64_t end);
void note_judged(batch *s, int64_t end);

#endif
