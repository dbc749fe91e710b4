/* rvmon.native._csv for CPython: functions without state. */
#include "csv.h"

#include "../../core/native/python/python_abi.h"

#ifndef RVMON_SOURCE_HASH
#define RVMON_SOURCE_HASH "" /* compiled by hand */
#endif

/* Read a number with Python. The GIL is taken once and kept until the end of the call, because
 * taking it for every such number would be slow. */
static double slow_number(void *taken, const char *text)
{
    PyThreadState **thread = taken;
    double found;
    if (*thread != NULL) {
        PyEval_RestoreThread(*thread);
        *thread = NULL;
    }
    found = PyOS_string_to_double(text, NULL, NULL);
    if (PyErr_Occurred() != NULL) {
        PyErr_Clear();
        return NAN;
    }
    return found;
}

/* Whether all buffers are large enough, slots are columns, and kinds exist. */
static bool fit(const csv_reader *r, const Py_buffer *numbers, const Py_buffer *says,
                const Py_buffer *table)
{
    const int64_t cells = (int64_t)r->columns * r->room;
    int32_t i;
    for (i = 0; i < r->width; i++) {
        if ((r->slots[i] < -1) || (r->slots[i] >= r->columns)) {
            return false;
        }
    }
    for (i = 0; i < r->columns; i++) {
        if ((r->kinds[i] < 0) || (r->kinds[i] > CSV_STAMP + CSV_PLACES)) {
            return false;
        }
    }
    return (r->at >= 0) && (r->at <= r->size) && (r->width > 0) && (r->columns > 0)
           && (numbers->len / 8 >= cells) && (says->len >= cells)
           && (table->len / 8 >= r->label_room) && (r->label_room >= r->columns)
           && (r->label_room < INT32_MAX / 4) && (r->odd_room >= r->columns);
}

/* Read rows without the GIL. */
static csv_end read_unlocked(csv_reader *r)
{
    PyThreadState *thread = PyEval_SaveThread();
    csv_end ended;
    r->slow = slow_number;
    r->taken = &thread;
    ended = csv_read(r);
    if (thread != NULL) {
        PyEval_RestoreThread(thread);
    }
    return ended;
}

/* read(text, start, is_last, longest, slots, kinds, absent, numbers, says, lines, odd, labels, table):
 * see csv.h. Returns why it ended, and the numbers rows, at, end, lines, odd cells, labels. */
static PyObject *csv_read_rows(PyObject *module, PyObject *args)
{
    enum { TEXT, SLOTS, KINDS, NUMBERS, SAYS, LINES, ODD, LABELS, TABLE, BUFFERS };
    Py_buffer b[BUFFERS];
    csv_reader r;
    Py_ssize_t start;
    Py_ssize_t longest;
    Py_ssize_t absent_size = 0;
    const char *absent = NULL;
    int is_last;
    PyObject *made = NULL;
    int i;
    (void)module;
    (void)memset(&r, 0, sizeof r);
    if (!PyArg_ParseTuple(args, "y*niny*y*z#w*w*w*w*w*w*", &b[TEXT], &start, &is_last,
                          &longest, &b[SLOTS], &b[KINDS], &absent, &absent_size, &b[NUMBERS],
                          &b[SAYS], &b[LINES], &b[ODD], &b[LABELS], &b[TABLE])) {
        return NULL;
    }
    r.text = b[TEXT].buf;
    r.size = b[TEXT].len;
    r.at = start;
    r.is_last = is_last != 0;
    r.longest = longest;
    r.slots = b[SLOTS].buf;
    r.width = (int32_t)(b[SLOTS].len / 4);
    r.kinds = b[KINDS].buf;
    r.columns = (int32_t)(b[KINDS].len / 4);
    r.absent = absent;
    r.absent_size = absent_size;
    r.numbers = b[NUMBERS].buf;
    r.says = b[SAYS].buf;
    r.lines = b[LINES].buf;
    r.room = b[LINES].len / 8;
    r.odd = b[ODD].buf;
    r.odd_room = b[ODD].len / 32;
    r.labels = b[LABELS].buf;
    r.label_room = b[LABELS].len / 32;
    r.table = b[TABLE].buf;
    if (fit(&r, &b[NUMBERS], &b[SAYS], &b[TABLE])) {
        const csv_end ended = read_unlocked(&r);
        made = Py_BuildValue("(iLLLLLL)", (int)ended, (long long)r.rows, (long long)r.at,
                             (long long)r.end, (long long)r.line, (long long)r.odd_count,
                             (long long)r.label_count);
    } else {
        PyErr_SetString(PyExc_ValueError, "the rooms do not fit");
    }
    for (i = 0; i < BUFFERS; i++) {
        PyBuffer_Release(&b[i]);
    }
    return made;
}

/* as_plain(text, separator, has_commas): see csv.h; returns None in place of false. */
static PyObject *csv_plain_text(PyObject *module, PyObject *args)
{
    const char *text;
    Py_ssize_t size;
    int separator;
    int has_commas;
    PyObject *made;
    char *put;
    (void)module;
    if (!PyArg_ParseTuple(args, "y#ii", &text, &size, &separator, &has_commas)) {
        return NULL;
    }
    made = PyBytes_FromStringAndSize(NULL, size);
    put = (made == NULL) ? NULL : PyBytes_AsString(made);
    if ((put != NULL) && !csv_as_plain(text, size, (char)separator, has_commas != 0, put)) {
        Py_DECREF(made);
        made = Py_BuildValue("");
    }
    return made;
}

/* rise(times): whether these int64 rise strictly. */
static PyObject *csv_rise(PyObject *module, PyObject *args)
{
    Py_buffer times;
    bool rise = true;
    Py_ssize_t i;
    (void)module;
    if (!PyArg_ParseTuple(args, "y*", &times)) {
        return NULL;
    }
    for (i = 1; rise && (i < times.len / 8); i++) {
        const int64_t *t = times.buf;
        rise = t[i - 1] < t[i];
    }
    PyBuffer_Release(&times);
    return PyBool_FromLong(rise);
}

static PyMethodDef methods[] = {
    {"rise", csv_rise, METH_VARARGS, NULL},
    {"read", csv_read_rows, METH_VARARGS, NULL},
    {"as_plain", csv_plain_text, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL},
};

static int execute(PyObject *module)
{
    return PyModule_AddStringConstant(module, "source_hash", RVMON_SOURCE_HASH);
}

RVMON_MODULE(_csv, methods, execute)
