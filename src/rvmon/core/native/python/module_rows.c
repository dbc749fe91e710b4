/* Judging rows from Python: buffers of columns become columns of the core; and reports of lost, found
 * and late names. */
#include "python/module.h"

/* The buffers of a call, each with a value per row. */
typedef struct {
    Py_buffer *held;
    uint8_t *taken;            /* by name, whether it has a column */
    int64_t count;
    int64_t room;
    int64_t rows;
} buffers;

/* Borrow the values of an object that has `size` bytes per row; false with an error. For None, `values`
 * is NULL. */
static bool borrow_values(buffers *all, PyObject *object, size_t size, const void **values)
{
    Py_buffer *own;
    *values = NULL;
    if (object == Py_None) {
        return true;
    }
    if (all->count == all->room) {
        PyErr_SetString(PyExc_ValueError, "too many columns");
        return false;
    }
    own = &all->held[all->count];
    if (PyObject_GetBuffer(object, own, PyBUF_SIMPLE) < 0) {
        return false;
    }
    all->count++;
    if (((uint64_t)own->len != (uint64_t)all->rows * size) || ((uintptr_t)own->buf % size != 0U)) {
        PyErr_SetString(PyExc_ValueError, "a column has other rows, or is not aligned");
        return false;
    }
    *values = own->buf;
    return true;
}

/* Cells from (kind, values, says); the values of an unknown field are None. */
static bool borrow_cells(buffers *all, PyObject *given, const reading *as, rv_column *column)
{
    static const size_t sizes[] = {sizeof(double), sizeof(int64_t), 1};
    PyObject *values;
    PyObject *says;
    const void *states;
    if (!PyTuple_CheckExact(given)
        || !PyArg_ParseTuple(given, "iOO", &column->kind, &values, &says)) {
        if (PyErr_Occurred() == NULL) {
            PyErr_SetString(PyExc_TypeError, "cells are a tuple");
        }
        return false;
    }
    if ((column->kind < RV_COLUMN_REAL) || (column->kind > RV_COLUMN_BYTE)
        || ((values != Py_None) && ((as->kind == IS_REAL) != (column->kind == RV_COLUMN_REAL)))) {
        PyErr_SetString(PyExc_ValueError, "a column of another kind");
        return false;
    }
    if (!borrow_values(all, values, sizes[column->kind], &column->values)
        || !borrow_values(all, says, 1, &states)) {
        return false;
    }
    column->says = states;
    return true;
}

/* The columns of the fields of an event; false with an error. */
static bool borrow_fields(const monitor *c, buffers *all, PyObject *given, rv_column *column)
{
    const reading *event = &c->in.readings[column->name];
    const reading *as = &c->in.readings[c->in.names + c->in.first_fields[column->name - c->in.signals]];
    rv_column *fields;
    bool good = true;
    Py_ssize_t i;
    if (!PyTuple_CheckExact(given) || (PyTuple_Size(given) != event->fields)) {
        PyErr_SetString(PyExc_ValueError, "an event has a column for each field, or none");
        return false;
    }
    fields = PyMem_Calloc((size_t)event->fields + 1U, sizeof *fields);
    if (fields == NULL) {
        (void)PyErr_NoMemory();
        return false;
    }
    column->fields = fields; /* rows_of() frees them with the columns */
    for (i = 0; good && (i < event->fields); i++) {
        good = borrow_cells(all, PyTuple_GetItem(given, i), &as[i], &fields[i]);
    }
    return good;
}

/* A column from (name, cells), or for an event from (name, says, fields or None). */
static bool borrow_column(const monitor *c, buffers *all, PyObject *given, rv_column *column)
{
    PyObject *cells;
    PyObject *fields = Py_None;
    const void *states;
    if (!PyTuple_CheckExact(given)
        || !PyArg_ParseTuple(given, "iO|O", &column->name, &cells, &fields)) {
        if (PyErr_Occurred() == NULL) {
            PyErr_SetString(PyExc_TypeError, "a column is a tuple");
        }
        return false;
    }
    if ((column->name < 0) || (column->name >= c->in.names) || (all->taken[column->name] != 0U)) {
        PyErr_SetString(PyExc_ValueError, "no such name, or it has a column already");
        return false;
    }
    all->taken[column->name] = 1;
    if (column->name < c->in.signals) {
        if (!borrow_cells(all, cells, &c->in.readings[column->name], column)) {
            return false;
        }
        if (column->values == NULL) {
            PyErr_SetString(PyExc_ValueError, "a signal has values");
        }
        return column->values != NULL;
    }
    if (!borrow_values(all, cells, 1, &states)) {
        return false;
    }
    column->says = states;
    return (fields == Py_None) || borrow_fields(c, all, fields, column);
}

/* Whether an event has a payload in a row. */
static bool brings_payload(const monitor *c, const rv_column *column, int64_t row)
{
    bool found = false;
    int32_t i;
    if ((column->says != NULL) && (column->says[row] != RV_SAYS_YES)) {
        return false;
    }
    for (i = 0; !found && (i < c->in.readings[column->name].fields); i++) {
        found = (column->fields[i].says == NULL) || (column->fields[i].says[row] <= RV_SAYS_YES);
    }
    return found;
}

/* The number of rows before the first instant with two payloads of an event of which only one can be
 * judged. */
static int64_t judged_alone(const monitor *c, const int64_t *times, int64_t rows,
                            const rv_column *columns, int64_t count)
{
    int64_t found = rows;
    int64_t i;
    int64_t k;
    for (i = 0; i < count; i++) {
        const rv_column *column = &columns[i];
        int64_t begin = 0; /* the first row of the current instant */
        int64_t payloads = 0;
        for (k = 0; (column->fields != NULL) && (c->in.readings[column->name].single != 0) && (k < found);
             k++) {
            if (times[k] != times[begin]) {
                begin = k;
                payloads = 0;
            }
            payloads += brings_payload(c, column, k) ? 1 : 0;
            if (payloads > 1) {
                found = begin;
            }
        }
    }
    return found;
}

/* Judge rows without the GIL: no other thread can use the monitor meanwhile. */
static int judge_rows(monitor *c, const buffers *all, const rv_column *columns, int64_t count,
                      int64_t *done)
{
    const int64_t *times = all->held[0].buf;
    int code;
    Py_BEGIN_ALLOW_THREADS
    code = rv_rows(c->m, times, judged_alone(c, times, all->rows, columns, count), columns,
                   (int32_t)count, done);
    Py_END_ALLOW_THREADS
    return code;
}

/* rows(times, columns): how many rows were judged; fewer than given if a row is earlier than the one
 * above it, or if Python has to look at one. */
PyObject *rows_of(monitor *c, PyObject *args)
{
    PyObject *times;
    PyObject *columns;
    PyObject *made = NULL;
    rv_column *laid;
    buffers all = {NULL, NULL, 0, 0, 0};
    int64_t done = 0;
    Py_ssize_t count;
    Py_ssize_t i;
    bool good;
    if (!PyArg_ParseTuple(args, "OO!", &times, &PyTuple_Type, &columns)) {
        return NULL;
    }
    count = PyTuple_Size(columns);
    all.room = 1 + 2 * ((int64_t)c->in.names + c->in.fields_most);
    laid = PyMem_Calloc((size_t)c->in.names + 1U, sizeof *laid);
    all.taken = PyMem_Calloc((size_t)c->in.names + 1U, 1);
    all.held = PyMem_Calloc((size_t)all.room, sizeof *all.held);
    good = (laid != NULL) && (all.held != NULL) && (all.taken != NULL);
    if (!good) {
        (void)PyErr_NoMemory();
    } else if (PyObject_GetBuffer(times, &all.held[0], PyBUF_SIMPLE) < 0) {
        good = false;
    } else {
        const Py_buffer *own = &all.held[0];
        all.count = 1;
        all.rows = (int64_t)(own->len / (Py_ssize_t)sizeof(int64_t));
        good = ((uintptr_t)own->buf % sizeof(int64_t) == 0U) && (count <= c->in.names);
        if (!good) {
            PyErr_SetString(PyExc_ValueError, "times are not aligned, or too many columns");
        }
    }
    for (i = 0; good && (i < count); i++) {
        good = borrow_column(c, &all, PyTuple_GetItem(columns, i), &laid[i]);
    }
    if (good) {
        int code;
        c->busy = true;
        code = judge_rows(c, &all, laid, (int64_t)count, &done);
        c->busy = false;
        made = ((code == RV_TOO_EARLY) || (code == RV_OUT_OF_RANGE) || is_done(code))
                   ? PyLong_FromLongLong((long long)done)
                   : NULL;
    }
    for (i = 0; i < all.count; i++) {
        PyBuffer_Release(&all.held[i]);
    }
    for (i = 0; (laid != NULL) && (i < count) && (i < c->in.names); i++) {
        PyMem_Free((void *)(uintptr_t)laid[i].fields);
    }
    PyMem_Free(all.held);
    PyMem_Free(all.taken);
    PyMem_Free(laid);
    return made;
}

/* Names that are lost, are found, or came too late. */

/* Read the numbers of names; false with an error. */
static bool take_numbers(const monitor *c, PyObject *all, int32_t *numbers)
{
    Py_ssize_t i;
    for (i = 0; i < PyTuple_Size(all); i++) {
        const long number = PyLong_AsLong(PyTuple_GetItem(all, i));
        if ((number == -1) && (PyErr_Occurred() != NULL)) {
            return false;
        }
        if ((number < 0) || (number >= c->in.names)) {
            PyErr_SetString(PyExc_ValueError, "there is no such name");
            return false;
        }
        numbers[i] = (int32_t)number;
    }
    return true;
}

/* Report names and an instant to the core; False if that instant was already judged. */
PyObject *pass_on(monitor *c, PyObject *args, telling tell)
{
    PyObject *names;
    PyObject *all;
    PyObject *made = NULL;
    long long t;
    int32_t *numbers;
    if (!PyArg_ParseTuple(args, "OL", &names, &t)) {
        return NULL;
    }
    all = PySequence_Tuple(names);
    if (all == NULL) {
        return NULL;
    }
    numbers = PyMem_Calloc((size_t)PyTuple_Size(all) + 1U, sizeof *numbers);
    if (numbers == NULL) {
        (void)PyErr_NoMemory();
    } else if (take_numbers(c, all, numbers)) {
        const int code = tell(c->m, (int64_t)t, numbers, (int32_t)PyTuple_Size(all));
        if (code == RV_TOO_EARLY) {
            made = Py_NewRef(Py_False);
        } else if (is_done(code)) {
            made = Py_NewRef(Py_True);
        } else {
            /* is_done() has set an error. */
        }
    } else {
        /* take_numbers() has set an error. */
    }
    PyMem_Free(numbers);
    Py_DECREF(all);
    return made;
}

PyObject *lose_of(monitor *c, PyObject *args)
{
    return pass_on(c, args, rv_lose);
}

PyObject *found_of(monitor *c, PyObject *args)
{
    return pass_on(c, args, rv_found);
}

/* late(names, t): `names` is None if the sample cannot be read. */
PyObject *late_of(monitor *c, PyObject *args)
{
    PyObject *names;
    long long t;
    if (!PyArg_ParseTuple(args, "OL", &names, &t)) {
        return NULL;
    }
    if (names == Py_None) {
        return is_done(rv_late(c->m, (int64_t)t, NULL, -1)) ? Py_NewRef(Py_True) : NULL;
    }
    return pass_on(c, args, rv_late);
}
