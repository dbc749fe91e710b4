/* Making a monitor from a plan, the readings of its names and the type of attempts; snapshots. */
#include "python/module.h"

/* Open the plan in `data`; false with an error. It is copied only if it is not aligned to 8. */
static bool open_plan(monitor *c, PyObject *data)
{
    const rv_memory heap = {malloc, realloc, free, NULL, 0};
    const size_t size = (size_t)PyBytes_Size(data);
    const void *plan = PyBytes_AsString(data);
    c->data = Py_NewRef(data);
    if ((uintptr_t)plan % 8U != 0U) {
        c->plan = malloc(size + 1U);
        if (c->plan == NULL) {
            (void)PyErr_NoMemory();
            return false;
        }
        plan = memcpy(c->plan, plan, size);
    }
    c->m = rv_new(plan, size, heap);
    if (c->m == NULL) {
        const int32_t wrong = rv_plan_check(plan, size);
        if (wrong >= 0) {
            (void)PyErr_Format(PyExc_ValueError, "the plan is damaged (section %d)", (int)wrong);
        } else {
            (void)PyErr_NoMemory();
        }
        return false;
    }
    c->sizes = rv_sizes_of(c->m);
    if (rv_keep_notes(c->m, note_dropped, &c->notes) != RV_OK) {
        (void)PyErr_NoMemory();
        return false;
    }
    return true;
}

/* Look up how many values each requirement captures; false with an error. */
static bool find_captured(monitor *c)
{
    int32_t i;
    if ((PyTuple_Size(c->ids) != c->sizes.requirements)
        || (PyTuple_Size(c->verdicts) != RV_NOT_TRIGGERED + 1)
        || (PyTuple_Size(c->decisions) != RV_OPEN + 1)) {
        PyErr_SetString(PyExc_ValueError, "not the requirements, verdicts, decisions of the plan");
        return false;
    }
    c->captured = PyMem_Calloc((size_t)c->sizes.requirements + 1U, sizeof *c->captured);
    if (c->captured == NULL) {
        (void)PyErr_NoMemory();
        return false;
    }
    for (i = 0; i < c->sizes.requirements; i++) {
        c->captured[i] = rv_captured_of(c->m, i);
    }
    return true;
}

/* Declare names without a source; false with an error. */
static bool set_absent(const monitor *c, PyObject *absent)
{
    int32_t i;
    if (PyBytes_Size(absent) != c->in.names) {
        PyErr_SetString(PyExc_ValueError, "not the names of the plan");
        return false;
    }
    for (i = 0; i < c->in.names; i++) {
        if (PyBytes_AsString(absent)[i] != 0) {
            rv_set_absent(c->m, i);
        }
    }
    return true;
}

/* Monitor(plan, (numbers, words, kinds, single), absent, (slow_step, slow_step_ns),
 *         (attempt, ids, verdicts, decisions, details, many)) */
PyObject *monitor_new(PyTypeObject *type, PyObject *args, PyObject *unused)
{
    PyObject *data;
    PyObject *numbers;
    PyObject *words;
    PyObject *kinds;
    PyObject *single;
    PyObject *absent;
    monitor *c = (monitor *)PyType_GenericAlloc(type, 0);
    (void)unused;
    if (c == NULL) {
        return NULL;
    }
    if (PyArg_ParseTuple(args, "O!(O!O!O!O!)O!(OO)(O!O!O!O!OO)", &PyBytes_Type, &data,
                         &PyDict_Type, &numbers, &PyTuple_Type, &words, &PyBytes_Type, &kinds,
                         &PyBytes_Type, &single, &PyBytes_Type, &absent, &c->slow_step,
                         &c->slow_step_ns, &PyType_Type, &c->attempt,
                         &PyTuple_Type, &c->ids, &PyTuple_Type, &c->verdicts, &PyTuple_Type,
                         &c->decisions, &c->details, &c->many)) {
        c->owner = Py_NewRef(args);
        c->nothing = PyTuple_New(0);
        c->keep = -1;
        if ((c->nothing != NULL) && open_plan(c, data) && make_intake(&c->in, c->m, numbers, words, kinds, single)
            && is_record(c->attempt) && find_captured(c) && set_absent(c, absent)) {
            return (PyObject *)c;
        }
    }
    Py_DECREF(c);
    return NULL;
}

/* Snapshots. */

/* save(): the run as bytes; decided attempts have been handed out before. */
PyObject *save_of(monitor *c, PyObject *unused)
{
    const size_t size = rv_save(c->m, NULL, 0);
    PyObject *made = (size > 0) ? PyBytes_FromStringAndSize(NULL, (Py_ssize_t)size) : PyErr_NoMemory();
    (void)unused;
    if ((made != NULL) && (rv_save(c->m, PyBytes_AsString(made), size) != size)) {
        Py_CLEAR(made);
        return PyErr_NoMemory();
    }
    return made;
}

/* load(bytes): continue a saved run; False, without effect, if the bytes are not a run of this plan. A
 * new monitor is loaded, which replaces the old one only on success. */
PyObject *load_of(monitor *c, PyObject *bytes)
{
    const rv_memory heap = {malloc, realloc, free, NULL, 0};
    const rv_record *records;
    PyObject *data = PyTuple_GetItem(c->owner, 0);
    rv_monitor *made;
    int code;
    if ((data == NULL) || (PyBytes_Size(bytes) < 0)) {
        return NULL;
    }
    made = rv_new((c->plan != NULL) ? c->plan : PyBytes_AsString(data), (size_t)PyBytes_Size(data), heap);
    if (made == NULL) {
        return PyErr_NoMemory(); /* the plan was checked before */
    }
    code = rv_keep_notes(made, note_dropped, &c->notes);
    if (code == RV_OK) {
        code = rv_load(made, PyBytes_AsString(bytes), (size_t)PyBytes_Size(bytes));
    }
    if ((code == RV_OK) && (c->keep >= 0)) {
        code = rv_keep(made, c->keep);
    }
    if (code == RV_OK) {
        (void)rv_reset(c->m); /* releases what pieces hold */
        rv_free(c->m);
        free_dropped(&c->notes);
        c->m = made;
        c->given = rv_records(made, &records);
        return Py_NewRef(Py_True);
    }
    rv_free(made);
    return (code == RV_BAD_SNAPSHOT) ? Py_NewRef(Py_False) : PyErr_NoMemory();
}
