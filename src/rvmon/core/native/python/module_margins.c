/* How module.c gives out margins: as figures, or as bytes. */
#include "python/module.h"

/* measure((measured, robustness), positions): have steps give figures. */
PyObject *measure_of(monitor *c, PyObject *args)
{
    PyObject *types;
    int positions;
    struct figures *made;
    if (!PyArg_ParseTuple(args, "O!p", &PyTuple_Type, &types, &positions)) {
        return NULL;
    }
    if (c->figures != NULL) {
        PyErr_SetString(PyExc_ValueError, "it measures already");
        return NULL;
    }
    made = PyMem_Calloc(1, sizeof *made);
    if (made == NULL) {
        return PyErr_NoMemory();
    }
    if (!PyArg_ParseTuple(types, "O!O!", &PyType_Type, &made->measured, &PyType_Type, &made->robustness)
        || !are_of_figures(made)) {
        PyMem_Free(made);
        return NULL;
    }
    c->figures = made;
    made->owner = Py_NewRef(types);
    if (positions != 0) {
        rv_measure_positions(c->m);
    }
    return Py_NewRef(Py_None);
}

/* Copies of some figures as objects: what is made of them may set off the collector, and that
 * anything, such as steps of this very monitor. */
static PyObject *figure_tuple(const monitor *c, const rv_margin *found, int64_t count)
{
    rv_margin few[8];
    rv_margin *copies = few;
    PyObject *made;
    int64_t i;
    if (count > (int64_t)(sizeof few / sizeof *few)) {
        copies = PyMem_Malloc((size_t)count * sizeof *copies);
    }
    if (copies == NULL) {
        return PyErr_NoMemory();
    }
    if (count > 0) {
        (void)memcpy(copies, found, (size_t)count * sizeof *copies);
    }
    made = PyTuple_New((Py_ssize_t)count);
    for (i = 0; (made != NULL) && (i < count); i++) {
        const rv_margin *figure = &copies[i];
        PyObject *one = figure_of(c->figures, PyTuple_GetItem(c->ids, figure->requirement), figure);
        if ((one == NULL) || (PyTuple_SetItem(made, (Py_ssize_t)i, one) < 0)) {
            Py_CLEAR(made);
        }
    }
    if (copies != few) {
        PyMem_Free(copies);
    }
    return made;
}

/* The figures that were settled since the last time; of verdicts nothing is kept. */
PyObject *figures_since(monitor *c)
{
    const rv_margin *found;
    int64_t count;
    PyObject *made;
    rv_forget_records(c->m);
    c->given = 0;
    count = rv_margins(c->m, &found);
    if (count == 0) {
        return PyTuple_New(0); /* always the same one */
    }
    made = figure_tuple(c, found, count);
    if (made != NULL) {
        rv_forget_margins(c->m);
    }
    return made;
}

static bool is_measuring_now(const monitor *c)
{
    if (c->figures == NULL) {
        PyErr_SetString(PyExc_ValueError, "it does not measure");
    }
    return c->figures != NULL;
}

PyObject *figures_of(monitor *c, PyObject *unused)
{
    (void)unused;
    if (!is_measuring_now(c)) {
        return NULL;
    }
    return rv_spoilt(c->m) ? PyErr_NoMemory() : figures_since(c);
}

typedef struct {
    rv_margin *found;
    int64_t count;
    int64_t room;
    bool failed;
} margin_gathering;

static bool gather_margin(void *user, const rv_margin *one)
{
    margin_gathering *g = user;
    if (g->count == g->room) {
        const int64_t room = (g->room > 0) ? 2 * g->room : 16;
        rv_margin *made = PyMem_Realloc(g->found, (size_t)room * sizeof *made);
        if (made == NULL) {
            g->failed = true;
            return false;
        }
        g->found = made;
        g->room = room;
    }
    g->found[g->count] = *one;
    g->count++;
    return true;
}

/* What is known of attempts whose figures are to come. */
PyObject *open_figures_of(monitor *c, PyObject *unused)
{
    margin_gathering g = {NULL, 0, 0, false};
    PyObject *made = NULL;
    (void)unused;
    if (!is_measuring_now(c)) {
        return NULL;
    }
    rv_each_margin(c->m, gather_margin, &g);
    if (g.failed || rv_spoilt(c->m)) {
        (void)PyErr_NoMemory();
    } else {
        made = figure_tuple(c, g.found, g.count);
    }
    PyMem_Free(g.found);
    return made;
}

/* The figures that were settled, as bytes of `rv_margin`. */
PyObject *margins_of(monitor *c, PyObject *unused)
{
    const rv_margin *found;
    const int64_t count = rv_margins(c->m, &found);
    PyObject *made = NULL;
    (void)unused;
    if (rv_spoilt(c->m)) {
        return PyErr_NoMemory();
    }
    made = PyBytes_FromStringAndSize((const char *)found,
                                     (Py_ssize_t)count * (Py_ssize_t)sizeof *found);
    if (made != NULL) {
        rv_forget_margins(c->m);
    }
    return made;
}

/* The bytes that a run has taken for what it keeps; those given back serve again. */
PyObject *memory_used_of(monitor *c, PyObject *unused)
{
    (void)unused;
    return PyLong_FromLongLong((long long)rv_memory_used(c->m));
}

void free_figures(monitor *c)
{
    if (c->figures != NULL) {
        Py_CLEAR(c->figures->owner);
        PyMem_Free(c->figures);
        c->figures = NULL;
    }
}

