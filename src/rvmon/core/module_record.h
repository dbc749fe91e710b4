/* What module.c makes of a decision: the type Record, the fields of an attempt at fixed places. Python's
 * type of attempts derives from it and adds those that are worked out when someone asks. Included there
 * alone. */
#ifndef RVMON_MODULE_RECORD_H
#define RVMON_MODULE_RECORD_H

#include "core.h"
#include "python_abi.h"

typedef struct {
    PyObject_HEAD
    PyObject *requirement;
    PyObject *verdict;
    PyObject *decision;
    PyObject *decided;         /* an instant, or None */
    PyObject *details;         /* gives the other fields */
    PyObject *noted;           /* from this */
    long long number;
    long long triggered;
    char in_doubt;
} attempt_record;

static int record_traverse(PyObject *self, visitproc visit, void *arg)
{
    const attempt_record *own = (const attempt_record *)self;
    Py_VISIT(Py_TYPE(self));
    Py_VISIT(own->requirement);
    Py_VISIT(own->verdict);
    Py_VISIT(own->decision);
    Py_VISIT(own->decided);
    Py_VISIT(own->details);
    Py_VISIT(own->noted);
    return 0;
}

static int record_clear(PyObject *self)
{
    attempt_record *own = (attempt_record *)self;
    Py_CLEAR(own->requirement);
    Py_CLEAR(own->verdict);
    Py_CLEAR(own->decision);
    Py_CLEAR(own->decided);
    Py_CLEAR(own->details);
    Py_CLEAR(own->noted);
    return 0;
}

static void record_dealloc(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    PyObject_GC_UnTrack(self);
    (void)record_clear(self);
    PyObject_GC_Del(self);
    Py_DECREF(type);
}

#define RVMON_MEMBER(name, kind, field) {name, kind, offsetof(attempt_record, field), 0, NULL}

static PyMemberDef record_members[] = {
    RVMON_MEMBER("requirement", T_OBJECT_EX, requirement),
    RVMON_MEMBER("number", T_LONGLONG, number),
    RVMON_MEMBER("triggered", T_LONGLONG, triggered),
    RVMON_MEMBER("decided", T_OBJECT_EX, decided),
    RVMON_MEMBER("verdict", T_OBJECT_EX, verdict),
    RVMON_MEMBER("decision", T_OBJECT_EX, decision),
    RVMON_MEMBER("in_doubt", T_BOOL, in_doubt),
    RVMON_MEMBER("_details", T_OBJECT_EX, details),
    RVMON_MEMBER("_noted", T_OBJECT_EX, noted),
    {NULL, 0, 0, 0, NULL},
};

static PyType_Slot record_slots[] = {
    {Py_tp_dealloc, RVMON_SLOT(record_dealloc)},
    {Py_tp_traverse, RVMON_SLOT(record_traverse)},
    {Py_tp_clear, RVMON_SLOT(record_clear)},
    {Py_tp_members, record_members},
    {0, NULL},
};

static PyType_Spec record_spec = {
    "rvmon.native._core.Record", sizeof(attempt_record), 0,
    Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_BASETYPE, record_slots,
};

/* The type, which says of itself what a dataclass that derives from it need not find places for; NULL
 * with an error. */
static PyObject *record_type(PyObject *module)
{
    PyObject *type = PyType_FromModuleAndSpec(module, &record_spec, NULL);
    PyObject *names = Py_BuildValue("(sssssssss)", "requirement", "number", "triggered", "verdict",
                                    "decision", "in_doubt", "_details", "_noted", "decided");
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
    while ((base != NULL) && (PyType_GetSlot(base, Py_tp_traverse) != RVMON_SLOT(record_traverse))) {
        base = PyType_GetSlot(base, Py_tp_base);
    }
    if (base == NULL) {
        PyErr_SetString(PyExc_TypeError, "attempts derive from Record");
    }
    return base != NULL;
}

#endif
