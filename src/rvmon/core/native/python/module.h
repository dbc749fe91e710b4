/* The CPython binding: the types Monitor and Record of rvmon.native._core. Samples come as dictionaries
 * or columns, attempts go out as objects. It uses the stable ABI only.
 *
 * Two rules shape it. No Python code runs between reading a sample and handing it to the core, so that
 * an interrupt or another thread cannot come in between: samples that would need Python code take a
 * slower path in Python. And no returned object refers to the core's memory, so objects may outlive
 * their monitor. */
#ifndef RVMON_MODULE_H
#define RVMON_MODULE_H

#include "core.h"
#include "python/python_abi.h"

/* Objects that freed pieces of letters had attached. The core may free pieces where no Python code may
 * run, so the objects are released later (free_dropped). */
typedef struct {
    PyObject **dropped;        /* to be released */
    size_t dropped_count;
    size_t dropped_room;
} note_cache;

/* A copy of the note of an attempt. */
typedef struct {
    int64_t *words;            /* the note, then the state of the propositions; NULL: there is no note */
    PyObject *pieces;          /* tuple of the full pieces of letters; NULL: letters do not matter */
    PyObject *last;            /* bytes of the last piece, shared with other notes, of which the first
                                * `last_count` words belong to this note */
    int32_t last_count;
    int32_t count;
    int32_t state_count;       /* words of the state; 0: none */
} note_copy;

/* Fields of a record that are objects; those from REASON on are computed when first read. */
enum {
    REQUIREMENT, VERDICT, DECISION, DETAILS, NOTED, REASON, DEADLINE, AT_TRIGGER, AT_DECISION,
    REQUIRED, CAPTURED, BLAME, FORECAST, ROBUSTNESS, OBJECTS
};

enum { UNSET, NEVER_SO_FAR, AT_INSTANT };

/* Words of a note that fit in a record. With its header, an object then stays below 512 bytes, up to
 * which Python allocates fast. */
#define FEW_WORDS 24

typedef struct {
    PyObject_HEAD
    PyObject *objects[OBJECTS]; /* NULL: not set */
    PyObject *values;          /* captured values; NULL: none */
    note_copy note;            /* raw material for `details`, until NOTED is set */
    long long number;
    long long triggered;
    long long origin;          /* first sample of the run */
    long long decided;         /* if it is AT_INSTANT */
    char in_doubt;
    char settling;             /* UNSET, NEVER_SO_FAR: `decided` is None, or AT_INSTANT */
    bool is_worked_out;        /* a field from NOTED on may be set */
    int64_t few[FEW_WORDS];    /* the words of short notes; new_record() leaves only these unset */
} attempt_record;

/* Kinds of a signal's or field's values. */
enum { IS_BOOLEAN, IS_WHOLE, IS_REAL, IS_LABEL };

/* How the values of a signal, event or field are read. */
typedef struct {
    PyObject *words;           /* borrowed: dict of label numbers, or of an event's field numbers;
                                * NULL */
    int32_t kind;              /* IS_BOOLEAN, ..., of a signal or field */
    int32_t fields;            /* number of fields of an event */
    int32_t single;            /* event: at most one occurrence per instant; signal: unknown is no
                                * update */
} reading;

/* Input health of a name or field: how often it was unknown, and when first. */
typedef struct {
    int64_t came;              /* first update of a signal; RV_NO_TIME: none yet */
    int64_t none_count;
    int64_t none_first;
    int64_t nan_count;
    int64_t nan_first;
} arrival;

/* Cache: the name at this place of the last sample, and its number. Samples mostly have the same key
 * objects in the same order, so that a pointer comparison replaces the lookup. */
typedef struct {
    PyObject *name;
    int32_t number;
    int32_t kind;              /* kind of a signal; -1: an event */
} seen_name;

/* The names of a monitor, and the sample that is being converted. */
typedef struct {
    PyObject *numbers;         /* borrowed: dict of name to number */
    int32_t signals;
    int32_t names;             /* signals, then events */
    int32_t all;               /* names, then fields */
    reading *readings;         /* by name, then field */
    arrival *arrivals;         /* of all */
    int32_t *first_fields;     /* by event, number of its first field */
    seen_name *seen;           /* by place in a sample */
    rv_update *updates;
    int64_t count;
    int64_t room;
    rv_number *fields;         /* payloads of the sample */
    int64_t fields_count;
    int64_t fields_room;
    int64_t fields_most;       /* fields of all events together */
    int32_t to_come;           /* number of signals without an update so far */
    bool is_odd;               /* the sample has an unknown value or a payload */
} intake;

typedef struct {
    PyObject_HEAD
    rv_monitor *m;
    void *plan;                /* a copy, if `data` is not aligned to 8; else NULL */
    PyObject *data;            /* the plan, which the core reads for all its life */
    rv_sizes sizes;
    int64_t given;             /* number of records handed out so far, or left open for good */
    bool held;                 /* Python is in the middle of a call (hold) */
    bool busy;                 /* C is in the middle of a call */
    intake in;
    int32_t *captured;         /* captured values per attempt, by requirement */
    PyObject *owner;           /* argument tuple that owns the next fields; NULL: garbage-collected */
    PyObject *slow_step;       /* Python's step, for samples that C does not convert */
    PyObject *slow_step_ns;    /* the same for step_ns */
    PyTypeObject *attempt;     /* derived from Record */
    PyObject *ids;             /* names of requirements, by number */
    PyObject *verdicts;
    PyObject *decisions;
    PyObject *details;         /* function that computes the late fields of an attempt */
    PyObject *nothing;         /* an empty tuple, returned by most steps */
    PyObject *many;            /* function that makes a lazy sequence from records, or None */
    note_cache notes;
    int64_t keep;              /* rv_keep's number; -1: all are kept */
    struct figures *figures;   /* how margins are made into objects; NULL: steps return attempts */
} monitor;

/* Calls that return more attempts than this return a lazy sequence, so that of a million decisions only
 * those that are read cost time. */
enum { MOST_AT_ONCE = 4096 };

/* Copies of records, each with room for the most captured values of any requirement. They have to be
 * copies: making objects from them may run the garbage collector, and so arbitrary code, even steps of
 * this monitor. */
typedef struct {
    monitor *c;
    rv_record *records;        /* `few` while they fit */
    rv_number *captured;
    int64_t count;
    int64_t room;
    bool failed;
    rv_record few[8];
} gathering;

typedef int (*telling)(rv_monitor *m, int64_t t, const int32_t *names, int32_t count);

/* The types from which figures are made. */
struct figures {
    PyObject *owner;           /* argument tuple that owns the next fields */
    PyTypeObject *measured;    /* derived from Figure */
    PyTypeObject *robustness;  /* derived from Bounds */
};

/* ---- module_notes.c */
void note_dropped(void *user, void *held);
void free_dropped(note_cache *cache);
PyObject *bytes_of_words(const int64_t *words, int64_t count);
PyObject *letters_of(const rv_note *note);
bool copy_note(attempt_record *to, const rv_monitor *m, const rv_record *record);
void free_note(attempt_record *of);
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
bool convert_sample(intake *in, PyObject *values, bool checked);
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
PyObject *failed_of(monitor *c, PyObject *args);

/* ---- module_open.c */
PyObject *monitor_new(PyTypeObject *type, PyObject *args, PyObject *unused);

/* ---- module_rows.c: outages */
PyObject *pass_on(monitor *c, PyObject *args, telling tell);
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
PyObject *times_of(monitor *c, PyObject *unused);
PyObject *next_due_of(monitor *c, PyObject *unused);

/* ---- module_rows.c */
PyObject *rows_of(monitor *c, PyObject *args);

/* ---- module_open.c: snapshots */
PyObject *save_of(monitor *c, PyObject *unused);
PyObject *load_of(monitor *c, PyObject *bytes);

/* ---- module_results.c: truths, coverage, situations */
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
