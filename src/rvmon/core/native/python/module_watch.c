/* What module.c tells of what is kept beside attempts. */
#include "python/module.h"

PyObject *instant(int64_t t, int64_t none)
{
    return (t == none) ? Py_NewRef(Py_None) : PyLong_FromLongLong((long long)t);
}

/* Where an operator has a value, as bytes. */
static PyObject *known_of(const monitor *c, int32_t number, bool better, bool value)
{
    const rv_range *found;
    const int64_t count = rv_truths(c->m, number, better, value, &found);
    if (count < 0) {
        PyErr_SetString(PyExc_ValueError, "the plan keeps no truths of that");
        return NULL;
    }
    return PyBytes_FromStringAndSize((const char *)found,
                                     (Py_ssize_t)count * (Py_ssize_t)sizeof *found);
}

/* truths(operator): where it is surely true, and where it is surely false. */
PyObject *truths_of(monitor *c, PyObject *number)
{
    const long long place = PyLong_AsLongLong(number);
    PyObject *is;
    PyObject *is_not;
    if ((place == -1) && (PyErr_Occurred() != NULL)) {
        return NULL;
    }
    if (rv_spoilt(c->m)) {
        return PyErr_NoMemory();
    }
    if ((place < 0) || (place > INT32_MAX)) {
        PyErr_SetString(PyExc_ValueError, "the plan keeps no truths of that");
        return NULL;
    }
    is = known_of(c, (int32_t)place, false, true);
    is_not = (is == NULL) ? NULL : known_of(c, (int32_t)place, true, false);
    if (is_not == NULL) {
        Py_XDECREF(is);
        return NULL;
    }
    return Py_BuildValue("NN", is, is_not);
}

/* hits(): of each item how often it was hit, and when first, as bytes. */
PyObject *hits_of(monitor *c, PyObject *unused)
{
    int32_t items;
    const rv_hit *hits = rv_hits(c->m, &items);
    (void)unused;
    return rv_spoilt(c->m) ? PyErr_NoMemory()
                           : PyBytes_FromStringAndSize((const char *)hits,
                                                       (Py_ssize_t)items * (Py_ssize_t)sizeof *hits);
}

/* situation(now): how the run stands, as bytes, and the next instant at which time may change that. */
PyObject *situation_of(monitor *c, PyObject *at)
{
    const long long now = PyLong_AsLongLong(at);
    int64_t room = 256;
    int64_t count = 0;
    int64_t next = RV_NEVER;
    int64_t *words = NULL;
    PyObject *made = NULL;
    if ((now == -1) && (PyErr_Occurred() != NULL)) {
        return NULL;
    }
    for (;;) {
        int64_t *larger = PyMem_Realloc(words, (size_t)room * sizeof *words);
        if (larger == NULL) {
            PyMem_Free(words);
            return PyErr_NoMemory();
        }
        words = larger;
        count = rv_situation(c->m, (int64_t)now, words, room, &next);
        if (count <= room) {
            break;
        }
        room = count;
    }
    if (count >= 0) {
        made = Py_BuildValue("NN", PyBytes_FromStringAndSize((const char *)words,
                                                             (Py_ssize_t)count * (Py_ssize_t)sizeof *words),
                             instant(next, RV_NEVER));
    } else if (rv_spoilt(c->m)) {
        (void)PyErr_NoMemory();
    } else {
        PyErr_SetString(PyExc_ValueError, "the run tells no situation");
    }
    PyMem_Free(words);
    return made;
}

/* passages(requirement): how many locations there are, and from each to each how often attempts went, and
 * when first, as bytes. */
PyObject *passages_of(monitor *c, PyObject *requirement)
{
    const long long number = PyLong_AsLongLong(requirement);
    int32_t locations;
    const rv_hit *moves;
    if ((number == -1) && (PyErr_Occurred() != NULL)) {
        return NULL;
    }
    if (rv_spoilt(c->m)) {
        return PyErr_NoMemory();
    }
    moves = rv_moves(c->m, ((number < 0) || (number > INT32_MAX)) ? -1 : (int32_t)number, &locations);
    return Py_BuildValue("iN", locations,
                         PyBytes_FromStringAndSize((const char *)moves,
                                                   (Py_ssize_t)locations * (Py_ssize_t)locations
                                                       * (Py_ssize_t)sizeof *moves));
}

