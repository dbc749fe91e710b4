/* Rows of columns: what rows.c and ahead.c share. */
#ifndef RVMON_ROWS_H
#define RVMON_ROWS_H

#include "runs/runs.h"

/* Of a row: it says nothing of a name. */
#define NO_UPDATE 255

/* Rows that are looked at together: a bit each. */
#define TOGETHER 64

/* Which updates of a name can change something. */
enum {
    NO_UPDATES,                /* nobody reads it */
    EACH_UPDATE,
    EACH_VALUE,                /* those that bring another value */
    BY_CONSTANTS,              /* those that bring a value that compares otherwise */
    OCCURRENCES                /* of an event */
};

/* A column of those rows. */
typedef struct {
    const rv_column *column;
    const subscription *readers;
    int32_t reader_count;
    int32_t how;
    int32_t fields;            /* of an event */
    bool is_event;
    bool ignores_nan;
    bool perishable;           /* an update keeps it from going stale, whatever it says */
    bool is_plain;             /* nobody but attempts hears what it compares as */
    bool is_idle;              /* and there are none */
    rv_number last;            /* what it said before, while rows are looked through */
    double low;                /* what lies between these, or is the same, compares as that does */
    double high;
    int64_t floor;             /* the same of whole numbers */
    int64_t ceiling;
    uint64_t said;             /* rows at which it says something */
    uint64_t told;             /* those of which the core has to hear */
} column_watch;

/* A sample that is laid out. */
typedef struct {
    rv_update *updates;
    rv_number *fields;
    int64_t room;              /* in rows */
    int32_t count;
    int32_t field_count;
} laid;

typedef struct {
    rv_monitor *m;
    const int64_t *times;
    int64_t count;
    column_watch *watches;
    int32_t columns;
    laid laid;
    int64_t first;             /* of those that are looked at together */
    int64_t together;          /* so many; 0: none */
    int64_t fresh;             /* what perishes is as fresh as the rows before this one make it */
    uint64_t moved;            /* at which something may change */
    bool known;                /* whether it is known for good which updates can change something */
    bool perishes;             /* whether a column is of a signal that goes stale */
    double *leaves[2];         /* room for what is measured of rows: at least, and at most */
    int32_t leaves_room;       /* of one row */
    int64_t unsettled;         /* rows of which it was not asked which figures they have settled */
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

/* The bits before a place, which is 64 at most. */
static inline uint64_t bits_before(int64_t place)
{
    return (place >= TOGETHER) ? ~UINT64_C(0) : ((UINT64_C(1) << place) - 1);
}

/* ---- rows.c */
rv_number number_in(const rv_column *c, int64_t row);

/* ---- passing.c: what matters */
void learn_how(const batch *s, column_watch *w);
void learn_between(const batch *s, column_watch *w);
bool compares_alike(const column_watch *w, const rv_number *value);

/* ---- measured.c: rows that are measured, and are not judged */
bool begin_measured(batch *s);
void end_measured(batch *s);
bool may_pass_measured(const rv_monitor *m);
bool is_plain_column(const batch *s, const column_watch *w);
bool is_idle_now(const batch *s, const column_watch *w);
void measure_rows(batch *s, int64_t row, int64_t end);
void settle_rows(batch *s, int64_t rows);

/* ---- ahead.c: at which rows something may change */
void look_ahead(batch *s, int64_t row);

/* ---- passing.c */
bool begin_rows(batch *s, const rv_column *columns);
void end_rows(batch *s, int64_t row);
int64_t pass_over(batch *s, int64_t row);
void make_ready(batch *s, int64_t row, int64_t end);
void note_judged(batch *s, int64_t end);

#endif
