/* Judging whole columns of samples. Most rows of a recording change no truth, so 64 rows at a time are
 * compared column by column, without branches where possible, and only rows at which something can
 * change are judged as samples (rv_step). The result is the same as judging each row.
 *
 * Each column has two row masks: `given`, it has an update; `needed`, the core has to see that update. A
 * row is judged if a column needs it, or if something is due by then. */
#ifndef RVMON_ROWS_H
#define RVMON_ROWS_H

#include "runs/runs.h"

/* In `says` of a column: no update. */
#define NO_UPDATE 255

/* Number of rows examined together, one bit each. */
#define TOGETHER 64

/* Which updates of a name can change something; a smaller number is the stricter choice. */
enum {
    NO_UPDATES,                /* none: it is not read */
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
    bool perishable;           /* its updates postpone its going stale */
    bool is_plain;             /* its comparisons influence only attempts: measured.c */
    bool is_idle;              /* the same, and no attempt is open */
    bool is_counted;           /* its values reach nothing but bins: counted.c */
    rv_number last;            /* its last value in the rows examined so far */
    span between;              /* values in it, or equal to `last`, compare as `last` does */
    uint64_t given;            /* rows with an update, as bits */
    uint64_t needed;           /* rows that the core has to see */
} column_watch;

/* A node over some rows, as bits: those at which it is TRUE, and at which it is FALSE. */
typedef struct {
    uint64_t is_true;
    uint64_t is_false;
} node_rows;

/* How a node depends on counted columns. */
enum {
    READS_NONE,
    READS_COLUMN,              /* a column reaches it */
    READS_MORE                 /* and from it more than bins: that column is not counted after all */
};

/* Counting in bulk, in a monitor that only counts. */
typedef struct {
    node_rows *rows;           /* by node, for those in `nodes` */
    uint8_t *reads;            /* by node: READS_... */
    int32_t *nodes;            /* the nodes that counted columns reach, operands first */
    uint64_t *bits;            /* by watch, whether it is true in some row */
    uint8_t *is_bulk;          /* by group, whether it is sampled at all rows and its bins last */
    int32_t count;             /* number of `nodes` */
} counting;

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
    int64_t together;          /* number of rows examined */
    int64_t fresh;             /* updates before this row have postponed staleness */
    uint64_t moved;            /* rows at which something may change, as bits from `first` */
    bool known;                /* `how` of the columns is final: every part is in phase 1 */
    bool perishes;             /* some column belongs to a signal that goes stale */
    counting *counting;        /* NULL: the monitor does more than count */
    bool counts;               /* the rows examined are counted in bulk */
    int64_t counted;           /* the end of the rows that the run has yet to catch up with; 0: none */
    double *leaves[2];         /* margins: scratch for the leaves of rows, lower and upper bounds */
    int32_t leaves_room;       /* capacity, in values per row */
    int64_t unsettled;         /* number of rows since margins were last settled */
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

/* A mask of the bits below a place, which is at most 64. */
static inline uint64_t bits_before(int64_t place)
{
    return (place >= TOGETHER) ? ~UINT64_C(0) : ((UINT64_C(1) << place) - 1);
}

/* Pack 64 bytes of 0 or 1 into bits. The multiplication moves the low bits of 8 bytes into the top
 * byte. */
static inline uint64_t bits_of(const uint8_t *one)
{
    uint64_t word = 0;
    int32_t i;
    for (i = 0; i < TOGETHER / 8; i++) {
        const uint8_t *b = &one[8 * i];
        const uint64_t x = (uint64_t)b[0] | ((uint64_t)b[1] << 8) | ((uint64_t)b[2] << 16)
                           | ((uint64_t)b[3] << 24) | ((uint64_t)b[4] << 32) | ((uint64_t)b[5] << 40)
                           | ((uint64_t)b[6] << 48) | ((uint64_t)b[7] << 56);
        word |= ((x * UINT64_C(0x0102040810204080)) >> 56) << (8 * i);
    }
    return word;
}

/* Number of words that hold one bit per watch of a part. */
static inline size_t words_of_watches(const part_plan *p)
{
    return ((size_t)p->watches.count + 63U) / 64U;
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
int32_t next_shown(const run *r, int32_t local, int32_t *atom, int32_t *at);
bool is_plain_column(const batch *s, const column_watch *w);
bool is_idle_now(const batch *s, const column_watch *w);
void measure_rows(batch *s, int64_t row, int64_t end);
void settle_rows(batch *s, int64_t rows);

/* ---- counted.c: which columns are counted in bulk */
bool begin_counted(batch *s);
void end_counted(batch *s);
void learn_counted(batch *s);
bool may_count(const batch *s);

/* ---- count_rows.c */
bool count_rows(batch *s, int64_t row, int64_t end);
void catch_up(batch *s);

/* ---- ahead.c: the rows at which something may change */
void look_ahead(batch *s, int64_t row);

/* ---- passing.c */
void turn_from(batch *s, int64_t row);
int64_t pass_over(batch *s, int64_t row);
void make_ready(batch *s, int64_t row, int64_t end);
void note_judged(batch *s, int64_t end);

#endif
