/* What module.c makes of a decision: the type Record, which has all fields of an attempt at fixed places.
 * Python's type of attempts derives from it and works out those that nobody has set when someone asks.
 * Included there alone.
 *
 * The collector does not look at those that are made here: nothing that they refer to refers to them. */
#ifndef RVMON_MODULE_RECORD_H
#define RVMON_MODULE_RECORD_H

#include "module_notes.h"

/* The fields that are objects. */
enum {
    REQUIREMENT, DECIDED, VERDICT, DECISION, DETAILS, NOTED, REASON, DEADLINE, AT_TRIGGER, AT_DECISION,
    OWED, CAPTURED, BLAME, FORECAST, ROBUSTNESS, OBJECTS
};

typedef struct {
    PyObject_HEAD
    PyObject *objects[OBJECTS]; /* NULL: not set */
    PyObject *values;          /* that were captured; NULL: none */
    note_copy note;            /* from which `details` gives what is not set, unless NOTED is set */
    long long number;
    long long triggered;
    char in_doubt;
} attempt_record;

/* Whether its type, as each that Python makes, is one that the collector looks at. */
static bool is_collected(PyTypeObject *type)
{
    return (PyType_GetFlags(type) & Py_TPFLAGS_HAVE_GC) != 0U;
}

/* Hide a record that was just made from the collector, whose time it would take for nothing. */
static void hide_record(PyObject *self)
{
    if (is_collected(Py_TYPE(self))) {
        PyObject_GC_UnTrack(self);
    }
}

static void record_dealloc(PyObject *self)
{
    attempt_record *own = (attempt_record *)self;
    PyTypeObject *type = Py_TYPE(self);
    int32_t i;
    for (i = 0; i < OBJECTS; i++) {
        Py_XDECREF(own->objects[i]);
    }
    Py_XDECREF(own->values);
    free_note(&own->note);
    if (is_collected(type)) {
        PyObject_GC_Del(self);
    } else {
        PyObject_Free(self);
    }
    Py_DECREF(type);
}

/* What was set; or the values that it captured, and behind them the note, if there is one. */
static PyObject *get_noted(PyObject *self, void *unused)
{
    attempt_record *own = (attempt_record *)self;
    (void)unused;
    if (own->objects[NOTED] != NULL) {
        return Py_NewRef(own->objects[NOTED]);
    }
    if (own->objects[DETAILS] == NULL) {
        PyErr_SetString(PyExc_AttributeError, "_noted");
        return NULL;
    }
    return noted_with(&own->note, (own->values != NULL) ? own->values : Py_None);
}

static int set_noted(PyObject *self, PyObject *value, void *unused)
{
    attempt_record *own = (attempt_record *)self;
    PyObject *was = own->objects[NOTED];
    (void)unused;
    own->objects[NOTED] = (value != NULL) ? Py_NewRef(value) : NULL;
    Py_XDECREF(was);
    Py_CLEAR(own->values);
    free_note(&own->note);
    return 0;
}

static PyGetSetDef record_getset[] = {
    {"_noted", get_noted, set_noted, NULL, NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

#define RVMON_OBJECT(name, place) \
    {name, T_OBJECT_EX, offsetof(attempt_record, objects) + (place) * sizeof(PyObject *), 0, NULL}

static PyMemberDef record_members[] = {
    {"number", T_LONGLONG, offsetof(attempt_record, number), 0, NULL},
    {"triggered", T_LONGLONG, offsetof(attempt_record, triggered), 0, NULL},
    {"in_doubt", T_BOOL, offsetof(attempt_record, in_doubt), 0, NULL},
    RVMON_OBJECT("requirement", REQUIREMENT),
    RVMON_OBJECT("decided", DECIDED),
    RVMON_OBJECT("verdict", VERDICT),
    RVMON_OBJECT("decision", DECISION),
    RVMON_OBJECT("_details", DETAILS),
    RVMON_OBJECT("reason", REASON),
    RVMON_OBJECT("deadline", DEADLINE),
    RVMON_OBJECT("at_trigger", AT_TRIGGER),
    RVMON_OBJECT("at_decision", AT_DECISION),
    RVMON_OBJECT("owed", OWED),
    RVMON_OBJECT("captured", CAPTURED),
    RVMON_OBJECT("blame", BLAME),
    RVMON_OBJECT("forecast", FORECAST),
    RVMON_OBJECT("robustness", ROBUSTNESS),
    {NULL, 0, 0, 0, NULL},
};

static PyType_Slot record_slots[] = {
    {Py_tp_dealloc, RVMON_SLOT(record_dealloc)},
    {Py_tp_members, record_members},
    {Py_tp_getset, record_getset},
    {0, NULL},
};

static PyType_Spec record_spec = {
    "rvmon.native._core.Record", sizeof(attempt_record), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
    record_slots,
};

/* The type, which says of itself what a dataclass that derives from it need not find places for; NULL
 * with an error. */
static PyObject *record_type(PyObject *module)
{
    PyObject *type = PyType_FromModuleAndSpec(module, &record_spec, NULL);
    PyObject *names = Py_BuildValue("[s]", record_getset[0].name);
    const PyMemberDef *one;
    for (one = record_members; (names != NULL) && (one->name != NULL); one++) {
        PyObject *name = PyUnicode_FromString(one->name);
        if ((name == NULL) || (PyList_Append(names, name) < 0)) {
            Py_CLEAR(names);
        }
        Py_XDECREF(name);
    }
    if ((type == NULL) || (names == NULL)
        || (PyObject_SetAttrString(type, "__slots__", names) < 0)) {
        Py_CLEAR(type);
    }
    Py_XDECREF(names);
    return type;
}

/* Whether a type derives from Record; false with an error. */
static bool is_record(PyTypeObject *type)
{
    PyTypeObject *base = type;
    while ((base != NULL) && (PyType_GetSlot(base, Py_tp_dealloc) != RVMON_SLOT(record_dealloc))) {
        base = PyType_GetSlot(base, Py_tp_base);
    }
    if (base == NULL) {
        PyErr_SetString(PyExc_TypeError, "attempts derive from Record");
    }
    return base != NULL;
}

#endif
