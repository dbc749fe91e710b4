/* The state of robustness: incremental evaluation of formulas, and the figures of attempts. */
#ifndef RVMON_MEASURING_H
#define RVMON_MEASURING_H

#include "plan/plan.h"

/* A function of positions has a value from a position on. */
typedef struct {
    int64_t at;
    double value;
} margin_step;

/* Steps in order, in a ring; they are numbered from the first one that was ever added. */
typedef struct {
    margin_step *ring;
    int32_t room;              /* a power of two, or 0 */
    int64_t first;             /* the number of the oldest that is kept */
    int64_t end;
} margin_steps;

/* A stretch of positions at which the value of an `until` is that of the next stretch, clamped to
 * [least, most]. */
typedef struct {
    int64_t first;
    double least;
    double most;
    double low;                /* the same clamp for several stretches: in the front half for this and */
    double high;               /* all later ones of the half, in the back half for this and all earlier */
} margin_part;

typedef struct {
    margin_part *at;
    int32_t room;
    int32_t begin;
    int32_t middle;            /* where the back half begins */
    int32_t end;
} margin_parts;

/* An operand of an operator, as far as the operator has read it. */
typedef struct {
    int64_t read;              /* the number of its first unread step */
    int64_t next;              /* the position of that step; NEVER: there is none */
    double value;              /* the value of the last step read */
} margin_edge;

typedef struct {
    margin_steps out;          /* its steps that some reader has not read */
    margin_steps wedge;        /* of a window: the values that can be its extreme, the best one first,
                                * each with the position of the last window that contains it */
    margin_parts parts;        /* of an `until`: the stretches without a final value */
    int64_t known;             /* the last position with a final value */
    int64_t joined;            /* the last position up to which its operands were read together */
    int64_t next;              /* of a window, the first position without a value */
    int64_t positions;         /* the number of the first sample without a value */
    double carried;            /* its last value */
    bool started;
} margin_node;

/* The lower or the upper bound of the robustness of a formula, evaluated incrementally. */
typedef struct {
    margin_node *nodes;
    margin_edge *edges;
    double *letter;            /* the last values of the leaves */
    margin_steps stamps;       /* the positions, where only samples are positions */
    int64_t first;             /* the first position */
    int64_t read;              /* the number of the first unread step of the formula */
    double reported;           /* the value of the last step read */
    bool started;
    bool after_gap;            /* whether input before the first position may have been anything */
} gauge;

/* Properties of an operator of a formula, computed once. */
typedef struct {
    int32_t edge;              /* its first operand */
    int32_t edge_count;
    bool alone;                /* whether only its values at the asked positions matter */
} margin_place;

/* The robustness of a leaf that compares a signal with a real constant. */
typedef struct {
    double constant;
    double slope;              /* its derivative by the signal */
    int32_t input;             /* the signal; -1: the leaf is of another kind */
    bool absolute;             /* whether it depends on the absolute distance */
} margin_real;

typedef struct {
    const margin_plan *plan;
    const operator_plan *nodes;
    const measure_plan *measures;
    margin_place *places;
    int32_t *operands;         /* by edge; -1: a constant operand */
    double *fixed;             /* by edge, the value of a constant operand */
    int32_t count;
    int32_t edges;
    int32_t *leaves;           /* by measure, the place of its leaf; -1: its steps are not read */
    margin_real *reals;        /* by measure */
    int64_t lag;               /* ticks that must pass after a position before its value can be final */
    bool passes;               /* whether time alone can make values final */
    bool occurs;               /* whether a leaf reads an event, which lasts for one position */
} margin_shape;

/* The value assumed after the end of a trace: the least, the greatest, or that of the rule for the end,
 * which is the greatest for an opened unbounded `R`, and the least for all other operators. */
enum { REST_LEAST, REST_GREATEST, REST_END };

typedef struct {
    int64_t instant;           /* the last instant of the trace, ticks */
    int64_t last;              /* the last integer that may be a position */
    int32_t rest;
} margin_end;

/* A step of a gauge. */
typedef struct gauging {
    rv_monitor *monitor;
    const margin_shape *shape;
    gauge *g;
    struct measuring *q;       /* has the asked positions */
    int32_t side;              /* 0: the lower bound; 1: the upper bound */
    const margin_end *end;     /* NULL: the trace goes on */
    int64_t step;              /* ticks from one position to the next */
    int64_t now;               /* the last position with known leaves */
    int64_t reached;           /* the instant that time has reached */
    bool sparse;               /* whether only samples are positions */
    bool thin;                 /* whether only the positions of attempts are asked */
    bool aligned;              /* whether each operator has one step per position, of equal number */
} gauging;

/* An asked position: one whose value has to be reported. */
typedef struct {
    int64_t position;
    int32_t record;            /* of the attempt that begins there, from 1; 0: of none */
} margin_request;

/* The robustness of the attempts of a judge. */
typedef struct measuring {
    gauging work;
    gauge readings[2];         /* lower bound; upper bound, from the first unknown letter on */
    gauge scratch;             /* a copy on which the end of the trace is tried */
    double *letter[2];         /* scratch: lower and upper bounds of the leaves */
    double *after[2];          /* the same once the events of the position are over */
    margin_steps requests;     /* positions of attempts without a figure; the value is the record */
    int64_t reported;          /* where all positions are asked: the number of reported ones */
    int64_t position;          /* the instant of the last letter that was read, ticks */
    bool passes;               /* whether `after` is still to be passed on for the next position */
    bool active;
    bool parted;
    bool missed;               /* whether earlier positions were missed in an outage */
    bool changed_inputs;       /* whether its leaves may have changed since they were read */
} measuring;

/* A measured attempt, until its figure is taken. */
typedef struct {
    int64_t triggered;
    uint32_t number;
    uint32_t doubt_number;
    int32_t next;              /* the next free record */
    bool sure;
    bool vanished;             /* it was in doubt and its obligation was met: no figure */
} margin_record;

/* The judges whose robustness reads a signal, an event or a node. */
typedef struct {
    int32_t *first;            /* by signal, event, then node of a part: its first judge below */
    int32_t *judges;
} margin_readers;

/* Figures, and attempts that wait for theirs. */
typedef struct {
    rv_margin *found;
    margin_record *records;
    int32_t *owners;           /* by figure, the record of its attempt; 0: none */
    int32_t found_count;
    int32_t found_room;
    int32_t owners_room;
    int32_t ready;             /* the number of figures that are in order and can be taken */
    int32_t record_count;
    int32_t record_room;
    int32_t free_record;
} margin_results;

#endif
