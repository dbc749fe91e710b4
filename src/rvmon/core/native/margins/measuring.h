/* What is kept of a formula that is measured: the part of the state that margins have. */
#ifndef RVMON_MEASURING_H
#define RVMON_MEASURING_H

#include "plan/plan.h"

/* From a position on a function has a value. */
typedef struct {
    int64_t at;
    double value;
} margin_step;

/* Steps in order, as a ring; each has its number from the first that ever was. */
typedef struct {
    margin_step *ring;
    int32_t room;              /* a power of two, or 0 */
    int64_t first;             /* the oldest that is kept */
    int64_t end;
} margin_steps;

/* A stretch of positions at which an `until` is what follows, kept between two bounds. */
typedef struct {
    int64_t first;
    double least;
    double most;
    double low;                /* the bounds of several together: in the front half, of it and all */
    double high;               /* behind it there; in the back half, of all before it there and it */
} margin_part;

typedef struct {
    margin_part *at;
    int32_t room;
    int32_t begin;
    int32_t middle;            /* where the back half begins */
    int32_t end;
} margin_parts;

/* An operand of an operator. */
typedef struct {
    int64_t read;              /* the number of its first step that was not taken */
    int64_t next;              /* where it begins; NEVER: there is none */
    double value;              /* what it is where the last one was taken */
} margin_edge;

typedef struct {
    margin_steps out;          /* its steps, as far as they are unread */
    margin_steps wedge;        /* of a window: values that may be its extreme, the best one first, and
                                * where the last window is that holds each */
    margin_parts parts;        /* of an `until`: what is not settled */
    int64_t known;             /* up to where it is known */
    int64_t joined;            /* up to where its operands are brought together */
    int64_t next;              /* of a window, the first position that is not known */
    int64_t positions;         /* the number of the first position that is not known */
    double carried;            /* what it was last */
    bool begun;
} margin_node;

/* One bound of the robustness of a formula while a trace goes by. */
typedef struct {
    margin_node *nodes;
    margin_edge *edges;
    double *letter;            /* what the leaves were last */
    margin_steps stamps;       /* the positions, if only samples are some */
    int64_t first;             /* the first position */
    int64_t read;              /* of the steps of the formula */
    double reported;           /* what the formula is by the last one that was read */
    bool begun;
    bool amid;                 /* whether what lies before the first position may be anything */
} gauge;

/* Of a formula that is measured, what of its shape is worked out once. */
typedef struct {
    int32_t edge;              /* its first operand */
    int32_t edge_count;
    bool alone;                /* whether its value matters where that of the formula is asked for alone */
} margin_place;

/* How a leaf is measured that compares a signal with a real constant. */
typedef struct {
    double constant;
    double slope;              /* by how much it grows with what the signal is above the constant */
    int32_t input;             /* the signal; -1: it is no such leaf */
    bool absolute;             /* with the distance from it, above or below */
} margin_real;

typedef struct {
    const margin_plan *plan;
    const operator_plan *nodes;
    const measure_plan *measures;
    margin_place *places;
    int32_t *operands;         /* by edge; -1: one that never changes */
    double *fixed;             /* by edge, what it is then */
    int32_t count;
    int32_t edges;
    int32_t *leaves;           /* by measure, the place of its leaf; -1: its steps are not read */
    margin_real *reals;        /* by measure */
    int64_t lag;               /* no position is settled less than so many ticks behind it */
    bool passes;               /* whether time alone can make something known */
    bool occurs;               /* whether a leaf may speak of what occurs at a position alone */
} margin_shape;

/* What is assumed of what lies behind the end of a trace: the least, the greatest, or the rule for the
 * end: the greatest for an unbounded `R` that has begun, else the least. */
enum { REST_LEAST, REST_GREATEST, REST_END };

typedef struct {
    int64_t instant;           /* the last one, ticks */
    int64_t last;              /* the last integer that may be a position */
    int32_t rest;
} margin_end;

/* A gauge at work. */
typedef struct gauging {
    rv_monitor *monitor;
    const margin_shape *shape;
    gauge *g;
    struct measuring *q;       /* says what is asked for */
    int32_t side;              /* 0: at least; 1: at most */
    const margin_end *end;     /* NULL: the trace goes on */
    int64_t step;              /* ticks from one position to the next */
    int64_t now;               /* up to where leaves are known */
    int64_t reached;           /* the instant that time has come to */
    bool sparse;               /* whether only samples are positions */
    bool thin;                 /* whether few positions are asked for */
    bool aligned;              /* whether each operator has a step at each position: of one number */
} gauging;

/* A position that is asked for. */
typedef struct {
    int64_t position;
    int32_t record;            /* of the attempt that begins there, 1 for the first; 0: of none */
} margin_ask;

/* What is measured of the attempts of a judge. */
typedef struct measuring {
    gauging work;
    gauge readings[2];         /* at least, and at most from the first unknown letter on */
    gauge scratch;             /* where the end of a trace is tried */
    double *letter[2];         /* scratch: what the leaves are, at least and at most */
    double *behind[2];         /* what they are behind what occurs at a position, likewise */
    margin_steps asks;         /* positions of attempts without a result; the value is the record */
    int64_t reported;          /* where each position is asked for: how many are reported */
    int64_t position;          /* of the letter that was read last */
    bool passes;               /* what is `behind` the last position is not given yet */
    bool active;
    bool parted;
    bool missed;               /* whether positions before those that it follows were missed */
    bool changed_inputs;       /* whether its leaves may be others than was read */
} measuring;

/* An attempt that is measured, until its figure is taken. */
typedef struct {
    int64_t triggered;
    uint32_t number;
    uint32_t doubt_number;
    int32_t next;              /* of those that are free */
    bool sure;
    bool vanished;             /* it was in doubt, and met: it leaves no figure */
} margin_record;

/* Which judges measure what a name says, or a node. */
typedef struct {
    int32_t *first;            /* by name of a part, signals first, then by node; the end */
    int32_t *judges;
} margin_readers;

/* Figures that were found, and attempts that wait for theirs. */
typedef struct {
    rv_margin *found;
    margin_record *records;
    int32_t *owners;           /* by figure, the record; 0: none */
    int32_t found_count;
    int32_t found_room;
    int32_t owners_room;
    int32_t ready;             /* so many of them stand in order, to be taken */
    int32_t record_count;
    int32_t record_room;
    int32_t free_record;
} margin_results;

#endif
