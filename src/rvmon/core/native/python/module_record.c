/* The type Record: an attempt with its fields at fixed places. Python's attempt type derives from it
 * and computes the late fields when they are first asked for.
 *
 * Records are not tracked by the garbage collector: they refer to nothing that can refer back, and
 * tracking millions of them would cost more than making them. */
#include "python/module.h"

/* Whether objects of a type have a header for the collector, as those of every Python class have. */
static bool is_collected(PyTypeObject *type)
{
    return (PyType_GetFlags(type) & Py_TPFLAGS_HAVE_GC) != 0U;
}

/* An uninitialised object that the collector does not track, as it would only waste time on it; NULL
 * with an error. */
PyObject *new_uncollected(PyTypeObject *type)
{
    return is_collected(type) ? _PyObject_GC_New(type) : PyType_GenericAlloc(type, 0);
}

/* Free an object that new_uncollected() made. */
void free_uncollected(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    if (is_collected(type)) {
        PyObject_GC_Del(self);
    } else {
        PyObject_Free(self);
    }
    Py_DECREF(type);
}

/* An empty record, which the collector does not track; NULL with an error. */
attempt_record *new_record(PyTypeObject *type)
{
    attempt_record *made = (attempt_record *)new_uncollected(type);
    if (made != NULL) {
        (void)memset(made->objects, 0, offsetof(attempt_record, few) - offsetof(attempt_record, objects));
    }
    return made;
}

static void record_dealloc(PyObject *self)
{
    attempt_record *own = (attempt_record *)self;
    const int32_t count = own->is_worked_out ? OBJECTS : NOTED;
    int32_t i;
    for (i = 0; i < count; i++) {
        Py_XDECREF(own->objects[i]);
    }
    Py_XDECREF(own->values);
    free_note(own);
    free_uncollected(self);
}

/* `_noted`: the value that was set, else the captured values with the note, if there is one. */
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
    own->is_worked_out = true;
    own->objects[NOTED] = (value != NULL) ? Py_NewRef(value) : NULL;
    Py_XDECREF(was);
    Py_CLEAR(own->values);
    free_note(own);
    return 0;
}

/* `decided`, stored as a number instead of an object, as most attempts are never asked for it. */
static PyObject *get_decided(PyObject *self, void *unused)
{
    const attempt_record *own = (const attempt_record *)self;
    (void)unused;
    switch (own->settling) {
    case AT_INSTANT: return PyLong_FromLongLong(own->decided);
    case NEVER_SO_FAR: return Py_NewRef(Py_None);
    default: PyErr_SetString(PyExc_AttributeError, "decided"); return NULL;
    }
}

static int set_decided(PyObject *self, PyObject *value, void *unused)
{
    attempt_record *own = (attempt_record *)self;
    (void)unused;
    if ((value != NULL) && (value != Py_None)) {
        const long long decided = PyLong_AsLongLong(value);
        if ((decided == -1) && (PyErr_Occurred() != NULL)) {
            return -1;
        }
        own->decided = decided;
    }
    own->settling = (value == NULL) ? UNSET : ((value == Py_None) ? NEVER_SO_FAR : AT_INSTANT);
    return 0;
}

/* The names of the late fields, by their places in `objects`. */
static const char *const late_names[OBJECTS] = {
    [REASON] = "reason", [DEADLINE] = "deadline", [AT_TRIGGER] = "at_trigger",
    [AT_DECISION] = "at_decision", [REQUIRED] = "required", [CAPTURED] = "captured",
    [BLAME] = "blame", [FORECAST] = "forecast", [ROBUSTNESS] = "robustness",
};

/* A late field, computed now if it was not computed before. */
static PyObject *get_late(PyObject *self, void *place)
{
    PyObject **field = &((attempt_record *)self)->objects[(uintptr_t)place];
    if (*field == NULL) {
        PyObject *done = PyObject_CallMethod(self, "_work_out", "s", late_names[(uintptr_t)place]);
        if (done == NULL) {
            return NULL;
        }
        Py_DECREF(done);
    }
    if (*field == NULL) {
        PyErr_SetString(PyExc_AttributeError, "it was not worked out");
        return NULL;
    }
    return Py_NewRef(*field);
}

static int set_late(PyObject *self, PyObject *value, void *place)
{
    attempt_record *own = (attempt_record *)self;
    PyObject **field = &own->objects[(uintptr_t)place];
    PyObject *was = *field;
    own->is_worked_out = true;
    *field = (value != NULL) ? Py_NewRef(value) : NULL;
    Py_XDECREF(was);
    return 0;
}

#define RVMON_LATE(name, place) {name, get_late, set_late, NULL, (void *)(uintptr_t)(place)}

static PyGetSetDef record_getset[] = {
    {"_noted", get_noted, set_noted, NULL, NULL},
    {"decided", get_decided, set_decided, NULL, NULL},
    RVMON_LATE("reason", REASON),
    RVMON_LATE("deadline", DEADLINE),
    RVMON_LATE("at_trigger", AT_TRIGGER),
    RVMON_LATE("at_decision", AT_DECISION),
    RVMON_LATE("required", REQUIRED),
    RVMON_LATE("captured", CAPTURED),
    RVMON_LATE("blame", BLAME),
    RVMON_LATE("forecast", FORECAST),
    RVMON_LATE("robustness", ROBUSTNESS),
    {NULL, NULL, NULL, NULL, NULL},
};

#define RVMON_OBJECT(name, place) \
    {name, T_OBJECT_EX, offsetof(attempt_record, objects) + (place) * sizeof(PyObject *), 0, NULL}

static PyMemberDef record_members[] = {
    {"number", T_LONGLONG, offsetof(attempt_record, number), 0, NULL},
    {"triggered", T_LONGLONG, offsetof(attempt_record, triggered), 0, NULL},
    {"origin", T_LONGLONG, offsetof(attempt_record, origin), 0, NULL},
    {"in_doubt", T_BOOL, offsetof(attempt_record, in_doubt), 0, NULL},
    RVMON_OBJECT("requirement", REQUIREMENT),
    RVMON_OBJECT("verdict", VERDICT),
    RVMON_OBJECT("decision", DECISION),
    RVMON_OBJECT("_details", DETAILS),
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

static bool add_name(PyObject *names, const char *text)
{
    PyObject *name = PyUnicode_FromString(text);
    const bool done = (name != NULL) && (PyList_Append(names, name) == 0);
    Py_XDECREF(name);
    return done;
}

/* Add a type to the module; false with an error. Its __slots__ list all fields, so that a dataclass that
 * derives from it adds none of its own. */
bool add_base_type(PyObject *module, const char *name, PyType_Spec *spec, const PyMemberDef *set,
                   const PyGetSetDef *got)
{
    PyObject *type = PyType_FromModuleAndSpec(module, spec, NULL);
    PyObject *names = PyList_New(0);
    bool done = (type != NULL) && (names != NULL);
    for (; done && (set->name != NULL); set++) {
        done = add_name(names, set->name);
    }
    for (; done && (got->name != NULL); got++) {
        done = add_name(names, got->name);
    }
    done = done && (PyObject_SetAttrString(type, "__slots__", names) == 0)
           && (PyModule_AddObjectRef(module, name, type) == 0);
    Py_XDECREF(names);
    Py_XDECREF(type);
    return done;
}

bool add_record_type(PyObject *module)
{
    return add_base_type(module, "Record", &record_spec, record_members, record_getset);
}

/* Whether a type derives from the one whose objects `dealloc` frees, and so has its fields; false with
 * an error. */
bool derives(PyTypeObject *type, void (*dealloc)(PyObject *self))
{
    PyTypeObject *base = type;
    while ((base != NULL) && (PyType_GetSlot(base, Py_tp_dealloc) != RVMON_SLOT(dealloc))) {
        base = PyType_GetSlot(base, Py_tp_base);
    }
    if (base == NULL) {
        PyErr_SetString(PyExc_TypeError, "it derives from another type");
    }
    return base != NULL;
}

/* Whether a type derives from Record; false with an error. */
bool is_record(PyTypeObject *type)
{
    return derives(type, record_dealloc);
}
