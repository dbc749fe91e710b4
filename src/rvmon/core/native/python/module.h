/* The binding to Python: what its files share. */
#ifndef RVMON_MODULE_H
#define RVMON_MODULE_H

#include "core.h"
#include "python/python_abi.h"

typedef struct {
    PyObject **dropped;        /* what pieces hung on to that are gone */
    size_t dropped_count;
    size_t dropped_room;
} note_cache;

/* The note of an attempt. */
typedef struct {
    int64_t *words;            /* NULL: there is none; behind them the state of the propositions */
    PyObject *pieces;          /* letters; NULL: they do not matter */
    PyObject *last;            /* bytes, of which the first `last_count` words are its last letters */
    int32_t last_count;
    int32_t count;
    int32_t state_count;       /* 0: nobody asks */
} note_copy;

/* The fields that are objects; from REASON on those that are worked out late. */
enum {
    REQUIREMENT, DECIDED, VERDICT, DECISION, DETAILS, NOTED, REASON, DEADLINE, AT_TRIGGER, AT_DECISION,
    REQUIRED, CAPTURED, BLAME, FORECAST, ROBUSTNESS, OBJECTS
};

typedef struct {
    PyObject_HEAD
    PyObject *objects[OBJECTS]; /* NULL: not set */
    PyObject *values;          /* that were captured; NULL: none */
    note_copy note;            /* from which `details` gives what is not set, unless NOTED is set */
    long long number;
    long long triggered;
    long long origin;          /* the first instant of the run */
    char in_doubt;
    bool is_worked_out;        /* whether a field from NOTED on may be set */
} attempt_record;

/* What the values of a signal or field are. */
enum { IS_BOOLEAN, IS_WHOLE, IS_REAL, IS_LABEL };

/* How a signal, an event, a field is read; of events, `words` are fields by name. */
typedef struct {
    PyObject *words;           /* borrowed: a number for each label; NULL: it has none */
    int32_t kind;              /* of a signal or field */
    int32_t fields;            /* of an event: so many */
    int32_t single;            /* of an event: only one occurrence of it can be judged at an instant; of a
                                * signal: that it is unknown is no update */
} reading;

/* What came of a name or a field: how often it said that it is unknown, and when first. */
typedef struct {
    int64_t came;              /* the first instant at which a signal was told; RV_NO_TIME: none yet */
    int64_t none_count;
    int64_t none_first;
    int64_t nan_count;
    int64_t nan_first;
} arrival;

/* A name that came at some place of a sample, and its number. */
typedef struct {
    PyObject *name;
    int32_t number;
    int32_t kind;              /* of a signal what its values are; -1 of an event */
} seen_name;

/* The names of a monitor, and the sample that is laid out. */
typedef struct {
    PyObject *numbers;         /* borrowed: of the names that can come */
    int32_t signals;
    int32_t names;             /* signals, then events */
    int32_t all;               /* names, then fields */
    reading *readings;         /* of all */
    arrival *arrivals;         /* of all */
    int32_t *first_fields;     /* of events, among those */
    seen_name *seen;           /* as names came last */
    rv_update *updates;
    int64_t count;
    int64_t room;
    rv_number *fields;         /* of all events that occur */
    int64_t fields_count;
    int64_t fields_room;
    int64_t fields_most;       /* if each occurs once */
    int32_t to_come;           /* so many signals were told of in no sample */
    bool is_odd;               /* whether something is unknown in the sample that is laid out */
} intake;

typedef struct {
    PyObject_HEAD
    rv_monitor *m;
    void *plan;                /* a copy, if Python's bytes are not aligned to 8; else NULL */
    PyObject *data;            /* the plan in Python's bytes: the core reads it to its end */
    rv_sizes sizes;
    int64_t given;             /* records that were given out, or are of attempts that stay open */
    bool held;                 /* whether Python is amid a call */
    bool busy;                 /* whether this is */
    intake in;
    int32_t *captured;         /* how many values the attempts of each requirement have */
    PyObject *owner;           /* what the rest is borrowed from; NULL: the collector took it away */
    PyObject *look_closer;     /* takes what this does not understand, in seconds */
    PyObject *look_closer_ns;  /* the same in ticks */
    PyTypeObject *attempt;     /* derived from Record */
    PyObject *ids;             /* of requirements */
    PyObject *verdicts;
    PyObject *decisions;
    PyObject *details;         /* gives an attempt its other fields */
    PyObject *nothing;         /* the tuple of no attempts */
    PyObject *many;            /* makes a sequence of records that makes attempts as they are read; or None */
    note_cache notes;
    int64_t keep;              /* so many records of each kind are kept; -1: all */
    struct figures *figures;   /* what figures are made of; NULL: steps give attempts */
} monitor;

/* So many attempts a call makes itself; of more it gives a sequence that makes each as it is read, so
 * that what a million cost is bounded by what of them is looked at. */
enum { MOST_AT_ONCE = 4096 };

/* Records, each with room for as many captured values as any has. They are copies: what is made of
 * them may set off the collector, and that anything, such as steps of this very monitor. */
typedef struct {
    monitor *c;
    rv_record *records;        /* `few` as long as they fit in there */
    rv_number *captured;
    int64_t count;
    int64_t room;
    bool failed;
    rv_record few[8];
} gathering;

typedef int (*telling)(rv_monitor *m, int64_t t, const int32_t *names, int32_t count);

/* What figures are made of. */
struct figures {
    PyObject *owner;           /* what the rest is borrowed from */
    PyTypeObject *measured;    /* derived from Figure */
    PyTypeObject *robustness;  /* derived from Bounds */
};

/* ---- module_notes.c */
void note_dropped(void *user, void *held);
void free_dropped(note_cache *cache);
PyObject *bytes_of_words(const int64_t *words, int64_t count);
PyObject *letters_of(const rv_note *note);
bool copy_note(note_copy *to, const rv_monitor *m, const rv_record *record);
void free_note(note_copy *note);
PyObject *noted_with(const note_copy *note, PyObject *values);

/* ---- module_record.c */
attempt_record *new_record(PyTypeObject *type);
PyObject *new_uncollected(PyTypeObject *type);
void free_uncollected(PyObject *self);
bool add_base_type(PyObject *module, const char *name, PyType_Spec *spec, const PyMemberDef *set,
                   const PyGetSetDef *got);
bool add_record_type(PyObject *module);
bool derives(PyTypeObject *type, void (*dealloc)(PyObject *self));
bool is_record(PyTypeObject *type);

/* ---- module_figures.c */
bool add_figure_types(PyObject *module);
bool are_of_figures(const struct figures *f);
PyObject *figure_of(const struct figures *f, PyObject *requirement, const rv_margin *x);

/* ---- module_intake.c */
bool lay(intake *in, PyObject *values, bool looked);
void note_arrivals(intake *in, int64_t t);
void count_to_come(intake *in);
void forget_arrivals(intake *in);
void free_intake(intake *in);
bool make_intake(intake *in, const rv_monitor *m, PyObject *numbers, PyObject *words,
                 PyObject *kinds, PyObject *single);

/* ---- module_attempts.c */
bool is_done(int code);
void begin_gathering(gathering *g, monitor *c);
void copy_captured(const monitor *c, const rv_record *record, const rv_number *captured, rv_number *to);
bool gather(void *user, const rv_record *record, const rv_number *captured);
PyObject *attempts_of(gathering *g);
void gather_records(const monitor *c, int64_t first, bool open, gathering *g);
PyObject *decided_since(monitor *c);

/* ---- module_open.c */
PyObject *monitor_new(PyTypeObject *type, PyObject *args, PyObject *unused);

/* ---- module_rows.c: outages */
PyObject *told(monitor *c, PyObject *args, telling tell);
PyObject *lose_of(monitor *c, PyObject *args);
PyObject *found_of(monitor *c, PyObject *args);
PyObject *late_of(monitor *c, PyObject *args);

/* ---- module_results.c */
PyObject *arrivals_of(monitor *c, PyObject *unused);
PyObject *take_arrivals_of(monitor *c, PyObject *bytes);
PyObject *keep_of(monitor *c, PyObject *most);
PyObject *flush_of(monitor *c, PyObject *unused);
PyObject *open_of(monitor *c, PyObject *unused);
PyObject *records_of(monitor *c, PyObject *unused);
PyObject *records_from(const monitor *c, int64_t first);
PyObject *counts_of(monitor *c, PyObject *unused);
PyObject *stale_of(monitor *c, PyObject *unused);

/* ---- module_rows.c */
PyObject *rows_of(monitor *c, PyObject *args);

/* ---- module_open.c: as bytes */
PyObject *save_of(monitor *c, PyObject *unused);
PyObject *load_of(monitor *c, PyObject *bytes);

/* ---- module_results.c: beside attempts */
PyObject *instant(int64_t t, int64_t none);
PyObject *truths_of(monitor *c, PyObject *number);
PyObject *hits_of(monitor *c, PyObject *unused);
PyObject *situation_of(monitor *c, PyObject *at);
PyObject *passages_of(monitor *c, PyObject *requirement);

/* ---- module_margins.c */
PyObject *measure_of(monitor *c, PyObject *args);
PyObject *figures_since(monitor *c);
PyObject *figures_of(monitor *c, PyObject *unused);
PyObject *open_figures_of(monitor *c, PyObject *unused);
PyObject *margins_of(monitor *c, PyObject *unused);
PyObject *memory_used_of(monitor *c, PyObject *unused);
void free_figures(monitor *c);

#endif
