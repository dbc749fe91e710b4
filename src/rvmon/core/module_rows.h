/* How module.c judges rows: buffers of columns become those of the core. Included there alone. */
#ifndef RVMON_MODULE_ROWS_H
#define RVMON_MODULE_ROWS_H

#include "module_attempts.h"

/* The buffers of a call, which all have a value for each row. */
typedef struct {
    Py_buffer *held;
    int64_t count;
    int64_t rows;
} buffers;

/* The values of an object that has so many bytes for each row; NULL with an error. None has none. */
static bool borrow_values(buffers *all, PyObject *object, size_t size, const void **values)
{
    Py_buffer *own = &all->held[all->count];
    *values = NULL;
    if (object == Py_None) {
        return true;
    }
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

/* A column out of (name, kind, values, says). */
static bool borrow_column(const monitor *c, buffers *all, PyObject *given, rv_column *column)
{
    static const size_t sizes[] = {sizeof(double), sizeof(int64_t), 1};
    PyObject *values;
    PyObject *says;
    const void *states;
    if (!PyTuple_CheckExact(given)
        || !PyArg_ParseTuple(given, "iiOO", &column->name, &column->kind, &values, &says)) {
        if (PyErr_Occurred() == NULL) {
            PyErr_SetString(PyExc_TypeError, "a column is a tuple");
        }
        return false;
    }
    if ((column->name < 0) || (column->name >= c->in.names) || (column->kind < RV_COLUMN_REAL)
        || (column->kind > RV_COLUMN_BYTE)
        || ((column->name < c->in.signals) != (values != Py_None))) {
        PyErr_SetString(PyExc_ValueError, "no such column");
        return false;
    }
    column->fields = NULL;
    if (!borrow_values(all, values, sizes[column->kind], &column->values)
        || !borrow_values(all, says, 1, &states)) {
        return false;
    }
    column->says = states;
    return true;
}

/* Judge rows while other threads of Python run; nobody else can get at the monitor. */
static int judge_rows(monitor *c, const buffers *all, const rv_column *columns, int64_t count,
                      int64_t *done)
{
    int code;
    Py_BEGIN_ALLOW_THREADS
    code = rv_rows(c->m, all->held[0].buf, all->rows, columns, (int32_t)count, done);
    Py_END_ALLOW_THREADS
    return code;
}

/* rows(times, columns): how many were judged; fewer than given if one is not later than all before. */
static PyObject *rows_of(monitor *c, PyObject *args)
{
    PyObject *times;
    PyObject *columns;
    PyObject *made = NULL;
    rv_column *laid;
    buffers all = {NULL, 0, 0};
    int64_t done = 0;
    Py_ssize_t count;
    Py_ssize_t i;
    bool good;
    if (!PyArg_ParseTuple(args, "OO!", &times, &PyTuple_Type, &columns)) {
        return NULL;
    }
    count = PyTuple_Size(columns);
    laid = PyMem_Calloc((size_t)count + 1U, sizeof *laid);
    all.held = PyMem_Calloc(2U * (size_t)count + 1U, sizeof *all.held);
    good = (laid != NULL) && (all.held != NULL);
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
    PyMem_Free(all.held);
    PyMem_Free(laid);
    return made;
}

#endif
