/* The monitor as an object of Python, and how module.c gives out its records: as attempts, the fields of
 * which are set by their descriptors. Included there alone. */
#ifndef RVMON_MODULE_ATTEMPTS_H
#define RVMON_MODULE_ATTEMPTS_H

#include "module_intake.h"

/* The fields of an attempt that are set here. */
enum {
    SLOT_REQUIREMENT, SLOT_NUMBER, SLOT_TRIGGERED, SLOT_DECIDED, SLOT_VERDICT, SLOT_DECISION,
    SLOT_IN_DOUBT, SLOT_DETAILS, SLOT_NOTED, SLOT_COUNT
};

typedef struct {
    PyObject_HEAD
    rv_monitor *m;
    void *plan;                /* a copy, if Python's bytes are not aligned to 8; else NULL */
    rv_sizes sizes;
    int64_t given;             /* records that were given out, or are of attempts that stay open */
    bool held;                 /* whether Python is amid a call */
    bool busy;                 /* whether this is */
    intake in;
    int32_t *captured;         /* how many values the attempts of each requirement have */
    PyObject *owner;           /* what the rest is borrowed from; NULL: the collector took it away */
    PyObject *look_closer;     /* takes what this does not understand, in seconds */
    PyObject *look_closer_ns;  /* the same in ticks */
    PyTypeObject *attempt;
    PyObject *slots[SLOT_COUNT]; /* descriptors of its fields */
    descrsetfunc set[SLOT_COUNT];
    PyObject *ids;             /* of requirements */
    PyObject *verdicts;
    PyObject *decisions;
    PyObject *details;         /* gives an attempt its other fields */
    struct figures *figures;   /* what figures are made of; NULL: steps give attempts */
} monitor;

/* Raises what it comes to that the core did not do something. */
static bool is_done(int code)
{
    if (code == RV_NO_MEMORY) {
        (void)PyErr_NoMemory();
    } else if (code != RV_OK) {
        (void)PyErr_Format(PyExc_ValueError, "what was checked is refused (%d)", code);
    } else {
        return true;
    }
    return false;
}

/* Records, each with room for as many captured values as any has. They are copies: what is made of
 * them may set off the collector, and that anything, such as steps of this very monitor. */
typedef struct {
    const monitor *c;
    rv_record *records;        /* `few` as long as they fit in there */
    rv_number *captured;
    int64_t count;
    int64_t room;
    bool failed;
    rv_record few[8];
} gathering;

static void begin_gathering(gathering *g, const monitor *c)
{
    g->c = c;
    g->records = g->few;
    g->captured = NULL;
    g->count = 0;
    g->room = (c->sizes.captured > 0) ? 0 : (int64_t)(sizeof g->few / sizeof *g->few);
    g->failed = false;
}

static bool widen_gathering(gathering *g)
{
    const size_t most = (size_t)g->c->sizes.captured;
    const bool few = g->records == g->few;
    const size_t room = (g->room > 0) ? 2 * (size_t)g->room : 8;
    rv_record *records = PyMem_Realloc(few ? NULL : g->records, room * sizeof *records);
    rv_number *numbers = NULL;
    if (records != NULL) {
        if (few) {
            (void)memcpy(records, g->few, (size_t)g->count * sizeof *records);
        }
        g->records = records;
        numbers = PyMem_Realloc(g->captured, (room * most + 1U) * sizeof *numbers);
    }
    if (numbers == NULL) {
        g->failed = true;
        return false;
    }
    g->captured = numbers;
    g->room = (int64_t)room;
    return true;
}

/* Write down what an attempt captured, if anything; further places are left as they are. */
static void copy_captured(const monitor *c, const rv_record *record, const rv_number *captured,
                          rv_number *to)
{
    if (captured != NULL) {
        (void)memcpy(to, captured, (size_t)c->captured[record->requirement] * sizeof *to);
    }
}

static bool gather(void *user, const rv_record *record, const rv_number *captured)
{
    gathering *g = (gathering *)user;
    if ((g->count == g->room) && !widen_gathering(g)) {
        return false;
    }
    g->records[g->count] = *record;
    g->records[g->count].captured = (captured != NULL) ? 0 : -1;
    if (captured != NULL) {
        copy_captured(g->c, record, captured,
                      &g->captured[g->count * (int64_t)g->c->sizes.captured]);
    }
    g->count++;
    return true;
}

/* Set a field of an attempt; the reference is taken over. */
static bool set_slot(const monitor *c, PyObject *made, int slot, PyObject *value)
{
    const bool done = (value != NULL) && (c->set[slot](c->slots[slot], made, value) == 0);
    Py_XDECREF(value);
    return done;
}

static bool share_slot(const monitor *c, PyObject *made, int slot, PyObject *value)
{
    return (value != NULL) && (c->set[slot](c->slots[slot], made, value) == 0);
}

static PyObject *object_of(const rv_number *number)
{
    switch (number->kind) {
    case RV_WHOLE: return PyLong_FromLongLong((long long)number->as.whole);
    case RV_REAL: return PyFloat_FromDouble(number->as.real);
    default: return Py_NewRef(Py_None);
    }
}

/* The values that an attempt captured, as a tuple; None: it captures none. */
static PyObject *noted_of(const rv_number *values, int32_t count)
{
    PyObject *made;
    int32_t i;
    if (count == 0) {
        return Py_NewRef(Py_None);
    }
    made = PyTuple_New((Py_ssize_t)count);
    for (i = 0; (made != NULL) && (i < count); i++) {
        PyObject *value = object_of(&values[i]);
        if ((value == NULL) || (PyTuple_SetItem(made, (Py_ssize_t)i, value) < 0)) {
            Py_CLEAR(made);
        }
    }
    return made;
}

static PyObject *attempt_of(const monitor *c, const rv_record *record, const rv_number *captured)
{
    PyObject *made = PyType_GenericAlloc(c->attempt, 0);
    const bool open = record->decision == (uint8_t)RV_OPEN;
    const int32_t count = (record->captured < 0) ? 0 : c->captured[record->requirement];
    if (made == NULL) {
        return NULL;
    }
    if (share_slot(c, made, SLOT_REQUIREMENT, PyTuple_GetItem(c->ids, record->requirement))
        && share_slot(c, made, SLOT_VERDICT, PyTuple_GetItem(c->verdicts, record->verdict))
        && share_slot(c, made, SLOT_DECISION, PyTuple_GetItem(c->decisions, record->decision))
        && share_slot(c, made, SLOT_IN_DOUBT, (record->in_doubt != 0U) ? Py_True : Py_False)
        && share_slot(c, made, SLOT_DETAILS, c->details)
        && set_slot(c, made, SLOT_NOTED, noted_of(captured, count))
        && set_slot(c, made, SLOT_NUMBER, PyLong_FromUnsignedLong(record->number))
        && set_slot(c, made, SLOT_TRIGGERED, PyLong_FromLongLong(record->triggered))
        && (open ? share_slot(c, made, SLOT_DECIDED, Py_None)
                 : set_slot(c, made, SLOT_DECIDED, PyLong_FromLongLong(record->decided)))) {
        return made;
    }
    Py_DECREF(made);
    return NULL;
}

/* The attempts that were gathered, as a list; what holds them is given back. */
static PyObject *listed(gathering *g)
{
    PyObject *made = g->failed ? PyErr_NoMemory() : PyList_New((Py_ssize_t)g->count);
    int64_t i;
    for (i = 0; (made != NULL) && (i < g->count); i++) {
        const rv_record *record = &g->records[i];
        const rv_number *captured =
            (record->captured < 0) ? NULL : &g->captured[i * g->c->sizes.captured];
        PyObject *one = attempt_of(g->c, record, captured);
        if ((one == NULL) || (PyList_SetItem(made, (Py_ssize_t)i, one) < 0)) {
            Py_CLEAR(made);
        }
    }
    if (g->records != g->few) {
        PyMem_Free(g->records);
    }
    PyMem_Free(g->captured);
    return made;
}

/* The attempts of which there are records from `first` on: those that are decided, or the others. */
static void gather_records(const monitor *c, int64_t first, bool open, gathering *g)
{
    const rv_record *records;
    const int64_t count = rv_records(c->m, &records);
    int64_t i;
    for (i = first; (i < count) && !g->failed; i++) {
        if ((records[i].decision == (uint8_t)RV_OPEN) == open) {
            (void)gather(g, &records[i], rv_captured(c->m, &records[i]));
        }
    }
}

/* The attempts that were decided since the last time. */
static PyObject *decided_since(monitor *c)
{
    const rv_record *records;
    const int64_t count = rv_records(c->m, &records);
    const int64_t first = c->given;
    gathering g;
    if (count == first) {
        return PyTuple_New(0); /* always the same one */
    }
    c->given = count;
    begin_gathering(&g, c);
    gather_records(c, first, false, &g);
    return listed(&g);
}

#endif
