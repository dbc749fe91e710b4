/* Reading a run from Python: attempts, records, counts, input health, coverage, situations. */
#include "python/module.h"

/* arrivals(): input health by name and field, as bytes of `arrival`. */
PyObject *arrivals_of(monitor *c, PyObject *unused)
{
    (void)unused;
    return PyBytes_FromStringAndSize((const char *)c->in.arrivals,
                                     (Py_ssize_t)c->in.all * (Py_ssize_t)sizeof(arrival));
}

/* take_arrivals(bytes): restore input health; false if the bytes do not fit the plan. */
PyObject *take_arrivals_of(monitor *c, PyObject *bytes)
{
    const Py_ssize_t size = PyBytes_Size(bytes);
    if (size < 0) {
        return NULL;
    }
    if (size != (Py_ssize_t)c->in.all * (Py_ssize_t)sizeof(arrival)) {
        return Py_NewRef(Py_False);
    }
    (void)memcpy(c->in.arrivals, PyBytes_AsString(bytes), (size_t)size);
    count_to_come(&c->in);
    return Py_NewRef(Py_True);
}

/* keep(most): keep the newest records of each requirement and verdict. */
PyObject *keep_of(monitor *c, PyObject *most)
{
    const long long count = PyLong_AsLongLong(most);
    if ((count == -1) && (PyErr_Occurred() != NULL)) {
        return NULL;
    }
    if (count < 0) {
        PyErr_SetString(PyExc_ValueError, "so many cannot be kept");
        return NULL;
    }
    c->keep = (int64_t)count;
    return is_done(rv_keep(c->m, c->keep)) ? Py_NewRef(Py_None) : NULL;
}

PyObject *flush_of(monitor *c, PyObject *unused)
{
    (void)unused;
    return rv_spoilt(c->m) ? PyErr_NoMemory() : decided_since(c);
}

/* open(): the attempts that are undecided, including those settled as such at the end. */
PyObject *open_of(monitor *c, PyObject *unused)
{
    PyObject *made;
    gathering g;
    (void)unused;
    begin_gathering(&g, c);
    gather_records(c, 0, true, &g);
    free_dropped(&c->notes);
    if (!g.failed) {
        rv_each_open(c->m, gather, &g);
    }
    made = attempts_of(&g);
    free_dropped(&c->notes);
    return made;
}

/* The spans of letters that notes refer to, by number. */
static PyObject *spans_of(const monitor *c)
{
    PyObject *made = PyList_New(0);
    int32_t i;
    rv_note note;
    for (i = 0; (made != NULL) && rv_span(c->m, i, &note); i++) {
        PyObject *both = letters_of(&note);
        if ((both == NULL) || (PyList_Append(made, both) < 0)) {
            Py_CLEAR(made);
        }
        Py_XDECREF(both);
    }
    return made;
}

/* Records from `first` on as bytes, with captured values (`sizes.captured` places each), all note
 * words, and the letter spans. */
PyObject *records_from(const monitor *c, int64_t first)
{
    const rv_record *records;
    const int64_t count = rv_records(c->m, &records) - first;
    const Py_ssize_t most = (Py_ssize_t)c->sizes.captured;
    PyObject *one = PyBytes_FromStringAndSize((const char *)&records[first],
                                              (Py_ssize_t)count * (Py_ssize_t)sizeof *records);
    PyObject *other = PyBytes_FromStringAndSize(
        NULL, (Py_ssize_t)count * most * (Py_ssize_t)sizeof(rv_number));
    const int64_t *words;
    const int64_t word_count = rv_notes(c->m, &words);
    PyObject *notes = bytes_of_words(words, word_count);
    PyObject *spans = spans_of(c);
    PyObject *made = NULL;
    if ((one != NULL) && (other != NULL) && (notes != NULL) && (spans != NULL)) {
        rv_number *to = (rv_number *)(void *)PyBytes_AsString(other);
        int64_t i;
        (void)memset(to, 0, (size_t)PyBytes_Size(other));
        for (i = 0; i < count; i++) {
            const rv_record *record = &records[first + i];
            copy_captured(c, record, rv_captured(c->m, record), &to[i * most]);
        }
        made = PyTuple_Pack(4, one, other, notes, spans);
    }
    Py_XDECREF(notes);
    Py_XDECREF(spans);
    Py_XDECREF(one);
    Py_XDECREF(other);
    return made;
}

PyObject *records_of(monitor *c, PyObject *unused)
{
    (void)unused;
    return records_from(c, 0);
}

/* counts(): per requirement, attempts failed, passed, open; and whether its trigger was ever known and
 * nothing came too late. */
PyObject *counts_of(monitor *c, PyObject *unused)
{
    PyObject *made = rv_spoilt(c->m) ? PyErr_NoMemory() : PyList_New(0);
    int32_t i;
    (void)unused;
    for (i = 0; (made != NULL) && (i < c->sizes.requirements); i++) {
        const rv_counts found = rv_count(c->m, i);
        PyObject *own = Py_BuildValue("LLLi", (long long)found.failed, (long long)found.passed,
                                      (long long)found.inconclusive,
                                      (found.heard && !found.late) ? 1 : 0);
        if ((own == NULL) || (PyList_Append(made, own) < 0)) {
            Py_CLEAR(made);
        }
        Py_XDECREF(own);
    }
    return made;
}

/* stale(): number, count and first instant of each signal that went stale. */
PyObject *stale_of(monitor *c, PyObject *unused)
{
    PyObject *made = PyList_New(0);
    int32_t i;
    (void)unused;
    for (i = 0; (made != NULL) && (i < c->sizes.signals); i++) {
        const rv_staleness found = rv_stale(c->m, i);
        PyObject *own;
        if (found.count > 0) {
            own = Py_BuildValue("iLL", (int)i, (long long)found.count, (long long)found.first);
            if ((own == NULL) || (PyList_Append(made, own) < 0)) {
                Py_CLEAR(made);
            }
            Py_XDECREF(own);
        }
    }
    return made;
}

PyObject *times_of(monitor *c, PyObject *unused)
{
    const rv_times found = rv_times_of(c->m);
    (void)unused;
    return Py_BuildValue("NNN", instant(found.began, RV_NO_TIME), instant(found.last, RV_NO_TIME),
                         instant(found.reached, RV_NO_TIME));
}

PyObject *next_due_of(monitor *c, PyObject *unused)
{
    (void)unused;
    return instant(rv_next_due(c->m), RV_NEVER);
}

/* Coverage, truths and situations. */

PyObject *instant(int64_t t, int64_t none)
{
    return (t == none) ? Py_NewRef(Py_None) : PyLong_FromLongLong((long long)t);
}

/* The ranges of positions at which an operator has a value, as bytes. */
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

/* truths(operator): the ranges at which it is certainly true, and certainly false. */
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

/* hits(): count and first hit of each item, as bytes. */
PyObject *hits_of(monitor *c, PyObject *unused)
{
    int32_t items;
    const rv_hit *hits = rv_hits(c->m, &items);
    (void)unused;
    return rv_spoilt(c->m) ? PyErr_NoMemory()
                           : PyBytes_FromStringAndSize((const char *)hits,
                                                       (Py_ssize_t)items * (Py_ssize_t)sizeof *hits);
}

/* situation(now): the relative state as bytes, and the next instant at which time may change it. */
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

/* passages(requirement): the number of locations, and the moves between them as bytes. */
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
