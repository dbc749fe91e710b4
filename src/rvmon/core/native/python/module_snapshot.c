/* How module.c writes a run down, and takes one up. */
#include "python/module.h"

/* save(): the run as bytes; what was decided has been given out. */
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

/* load(bytes): go on as that run; false, and nothing is done, if they are no run of this plan. */
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
        (void)rv_reset(c->m); /* pieces give back what hangs on them */
        rv_free(c->m);
        free_dropped(&c->notes);
        c->m = made;
        c->given = rv_records(made, &records);
        return Py_NewRef(Py_True);
    }
    rv_free(made);
    return (code == RV_BAD_SNAPSHOT) ? Py_NewRef(Py_False) : PyErr_NoMemory();
}

