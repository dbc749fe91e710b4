/* How module.c is told that names are lost, and found, or came too late. */
#include "python/module.h"

/* Take the numbers of names; false with an error. */
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

/* Have the core be told; false if what is there was judged already. */
PyObject *told(monitor *c, PyObject *args, telling tell)
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
            /* An error was raised. */
        }
    } else {
        /* The same. */
    }
    PyMem_Free(numbers);
    Py_DECREF(all);
    return made;
}

PyObject *lose_of(monitor *c, PyObject *args)
{
    return told(c, args, rv_lose);
}

PyObject *found_of(monitor *c, PyObject *args)
{
    return told(c, args, rv_found);
}

/* late(names, t); of what cannot be read names is None. */
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
    return told(c, args, rv_late);
}

