/* How module.c gives out margins: as figures, the fields of which are set by their descriptors, or as
 * bytes. */
#include "python/module.h"

/* measure((measured, robustness, descriptors), positions): have steps give figures. */
PyObject *measure_of(monitor *c, PyObject *args)
{
    PyObject *types;
    PyObject *descriptors;
    int positions;
    int i;
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
    c->figures = made;
    made->owner = Py_NewRef(types);
    if (!PyArg_ParseTuple(types, "O!O!O!", &PyType_Type, &made->measured, &PyType_Type,
                          &made->robustness, &PyTuple_Type, &descriptors)) {
        return NULL;
    }
    if (PyTuple_Size(descriptors) != FIGURE_COUNT) {
        PyErr_SetString(PyExc_ValueError, "not the fields of a figure");
        return NULL;
    }
    for (i = 0; i < FIGURE_COUNT; i++) {
        made->slots[i] = PyTuple_GetItem(descriptors, i);
        made->set[i] = (descrsetfunc)(uintptr_t)PyType_GetSlot(Py_TYPE(made->slots[i]),
                                                               Py_tp_descr_set);
        if (made->set[i] == NULL) {
            PyErr_SetString(PyExc_TypeError, "no field of a figure");
            return NULL;
        }
    }
    if (positions != 0) {
        rv_measure_positions(c->m);
    }
    return Py_NewRef(Py_None);
}

static bool share_field(const struct figures *f, PyObject *made, int slot, PyObject *value)
{
    return (value != NULL) && (f->set[slot](f->slots[slot], made, value) == 0);
}

/* The same with an object that is given away. */
static bool set_field(const struct figures *f, PyObject *made, int slot, PyObject *value)
{
    const bool done = share_field(f, made, slot, value);
    Py_XDECREF(value);
    return done;
}

/* A number as an object, which may be that of another. */
static PyObject *bound_of(double value, double other, PyObject *of_other)
{
    return ((value == other) && (of_other != NULL)) ? Py_NewRef(of_other)
                                                    : PyFloat_FromDouble(value);
}

/* Bounds are mostly one number. */
static PyObject *robustness_of(const struct figures *f, const rv_margin *x)
{
    PyObject *made = PyType_GenericAlloc(f->robustness, 0);
    PyObject *low = PyFloat_FromDouble(x->low);
    PyObject *high = bound_of(x->high, x->low, low);
    PyObject *kept = bound_of(x->kept, x->low, low);
    if ((made == NULL) || !share_field(f, made, FIGURE_LOW, low)
        || !share_field(f, made, FIGURE_HIGH, high) || !share_field(f, made, FIGURE_KEPT, kept)) {
        Py_CLEAR(made);
    }
    Py_XDECREF(low);
    Py_XDECREF(high);
    Py_XDECREF(kept);
    return made;
}

static PyObject *figure_object(const monitor *c, const rv_margin *x)
{
    const struct figures *f = c->figures;
    PyObject *made = PyType_GenericAlloc(f->measured, 0);
    PyObject *number = (x->of_position != 0U) ? Py_NewRef(Py_None)
                                             : PyLong_FromUnsignedLong(x->number);
    if ((made != NULL)
        && share_field(f, made, FIGURE_REQUIREMENT, PyTuple_GetItem(c->ids, x->requirement))
        && share_field(f, made, FIGURE_NUMBER, number)
        && set_field(f, made, FIGURE_T, PyLong_FromLongLong(x->t))
        && set_field(f, made, FIGURE_ROBUSTNESS, robustness_of(f, x))
        && share_field(f, made, FIGURE_IN_DOUBT, (x->in_doubt != 0U) ? Py_True : Py_False)) {
        Py_DECREF(number);
        return made;
    }
    Py_XDECREF(number);
    Py_XDECREF(made);
    return NULL;
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
        PyObject *one = figure_object(c, &copies[i]);
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

