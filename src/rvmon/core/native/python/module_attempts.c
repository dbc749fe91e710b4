/* Making attempts of records. */
#include "python/module.h"

/* Whether a code of the core is RV_OK; else an exception is set. */
bool is_done(int code)
{
    if (code == RV_NO_MEMORY) {
        (void)PyErr_NoMemory();
    } else if (code != RV_OK) {
        (void)PyErr_Format(PyExc_ValueError, "what was checked is refused (%d)", code);
    } else {
        return true;
    }
    return false;
}

void begin_gathering(gathering *g, monitor *c)
{
    g->c = c;
    g->records = g->few;
    g->captured = NULL;
    g->count = 0;
    g->room = (c->sizes.captured > 0) ? 0 : (int64_t)(sizeof g->few / sizeof *g->few);
    g->failed = false;
}

static bool widen_gathering(gathering *g)
{
    const size_t most = (size_t)g->c->sizes.captured;
    const bool few = g->records == g->few;
    const size_t room = (g->room > 0) ? 2 * (size_t)g->room : 8;
    rv_record *records = PyMem_Realloc(few ? NULL : g->records, room * sizeof *records);
    rv_number *numbers = NULL;
    if (records != NULL) {
        if (few) {
            (void)memcpy(records, g->few, (size_t)g->count * sizeof *records);
        }
        g->records = records;
        numbers = PyMem_Realloc(g->captured, (room * most + 1U) * sizeof *numbers);
    }
    if (numbers == NULL) {
        g->failed = true;
        return false;
    }
    g->captured = numbers;
    g->room = (int64_t)room;
    return true;
}

/* Copy the captured values of a record, if any; further places of `to` stay as they are. */
void copy_captured(const monitor *c, const rv_record *record, const rv_number *captured,
                          rv_number *to)
{
    if (captured != NULL) {
        (void)memcpy(to, captured, (size_t)c->captured[record->requirement] * sizeof *to);
    }
}

bool gather(void *user, const rv_record *record, const rv_number *captured)
{
    gathering *g = (gathering *)user;
    if ((g->count == g->room) && !widen_gathering(g)) {
        return false;
    }
    g->records[g->count] = *record;
    g->records[g->count].captured = (captured != NULL) ? 0 : -1;
    if (captured != NULL) {
        copy_captured(g->c, record, captured,
                      &g->captured[g->count * (int64_t)g->c->sizes.captured]);
    }
    g->count++;
    return true;
}

static PyObject *object_of(const rv_number *number)
{
    switch (number->kind) {
    case RV_WHOLE: return PyLong_FromLongLong((long long)number->as.whole);
    case RV_REAL: return PyFloat_FromDouble(number->as.real);
    default: return Py_NewRef(Py_None);
    }
}

/* Captured values as a tuple. */
static PyObject *values_of(const rv_number *values, int32_t count)
{
    PyObject *made = PyTuple_New((Py_ssize_t)count);
    int32_t i;
    for (i = 0; (made != NULL) && (i < count); i++) {
        PyObject *value = object_of(&values[i]);
        if ((value == NULL) || (PyTuple_SetItem(made, (Py_ssize_t)i, value) < 0)) {
            Py_CLEAR(made);
        }
    }
    return made;
}

static PyObject *attempt_of(const monitor *c, const rv_record *record, const rv_number *captured)
{
    const int32_t count = (captured == NULL) ? 0 : c->captured[record->requirement];
    const int64_t began = rv_times_of(c->m).began;
    attempt_record *made = new_record(c->attempt);
    if (made == NULL) {
        return NULL;
    }
    made->objects[REQUIREMENT] = Py_NewRef(PyTuple_GetItem(c->ids, record->requirement));
    made->objects[VERDICT] = Py_NewRef(PyTuple_GetItem(c->verdicts, record->verdict));
    made->objects[DECISION] = Py_NewRef(PyTuple_GetItem(c->decisions, record->decision));
    made->objects[DETAILS] = Py_NewRef(c->details);
    made->number = record->number;
    made->triggered = record->triggered;
    made->origin = (began != RV_NO_TIME) ? began : 0;
    made->settling = (record->decision == (uint8_t)RV_OPEN) ? NEVER_SO_FAR : AT_INSTANT;
    made->decided = record->decided;
    made->in_doubt = (record->in_doubt != 0U) ? 1 : 0;
    if (count > 0) {
        made->values = values_of(captured, count);
    }
    if (((count > 0) && (made->values == NULL)) || !copy_note(made, c->m, record)) {
        Py_CLEAR(made);
    }
    return (PyObject *)made;
}

/* Make attempts of the gathered records, and free the gathering. */
PyObject *attempts_of(gathering *g)
{
    PyObject *made = g->failed ? PyErr_NoMemory() : PyTuple_New((Py_ssize_t)g->count);
    int64_t i;
    for (i = 0; (made != NULL) && (i < g->count); i++) {
        const rv_record *record = &g->records[i];
        const rv_number *captured =
            (record->captured < 0) ? NULL : &g->captured[i * g->c->sizes.captured];
        PyObject *one = attempt_of(g->c, record, captured);
        if ((one == NULL) || (PyTuple_SetItem(made, (Py_ssize_t)i, one) < 0)) {
            Py_CLEAR(made);
        }
    }
    if (g->records != g->few) {
        PyMem_Free(g->records);
    }
    PyMem_Free(g->captured);
    free_dropped(&g->c->notes);
    return made;
}

/* Gather the records from `first` on: the decided ones, or the open ones. */
void gather_records(const monitor *c, int64_t first, bool open, gathering *g)
{
    const rv_record *records;
    const int64_t count = rv_records(c->m, &records);
    int64_t i;
    for (i = first; (i < count) && !g->failed; i++) {
        if ((records[i].decision == (uint8_t)RV_OPEN) != open) {
            continue;
        }
        if ((c->sizes.captured == 0) && (g->count < g->room)) { /* as most are, without calls */
            g->records[g->count] = records[i];
            g->count++;
        } else {
            (void)gather(g, &records[i], rv_captured(c->m, &records[i]));
        }
    }
}

/* Hand out the records up to `count`. */
static PyObject *attempts_up_to(monitor *c, int64_t count)
{
    const int64_t first = c->given;
    PyObject *made;
    gathering g;
    c->given = count;
    if ((count - first > MOST_AT_ONCE) && (c->many != Py_None)) {
        PyObject *raw = records_from(c, first);
        PyObject *given = (raw == NULL) ? NULL : PyTuple_Pack(1, raw);
        made = (given == NULL) ? NULL : PyObject_Call(c->many, given, NULL);
        Py_XDECREF(given);
        Py_XDECREF(raw);
    } else {
        begin_gathering(&g, c);
        gather_records(c, first, false, &g);
        made = attempts_of(&g);
    }
    return made;
}

/* Hand out the attempts decided since the last call; then trim, if records are bounded. */
PyObject *decided_since(monitor *c)
{
    const rv_record *records;
    const int64_t count = rv_records(c->m, &records);
    PyObject *made = (count == c->given) ? Py_NewRef(c->nothing) : attempts_up_to(c, count);
    if ((c->keep >= 0) && rv_trim(c->m)) {
        c->given = rv_records(c->m, &records);
        free_dropped(&c->notes);
    }
    return made;
}


/* failed(first, wanted): the number of records, and the attempts that failed among those from `first`
 * on, of the requirements with a 1 in `wanted`, which has a byte for each. */
PyObject *failed_of(monitor *c, PyObject *args)
{
    const rv_record *records;
    const int64_t count = rv_records(c->m, &records);
    long long first;
    Py_buffer wanted;
    gathering g;
    int64_t i;
    if (!PyArg_ParseTuple(args, "Ly*", &first, &wanted)) {
        return NULL;
    }
    begin_gathering(&g, c);
    for (i = (first > 0) ? (int64_t)first : 0; (i < count) && !g.failed; i++) {
        const rv_record *one = &records[i];
        if ((one->verdict == RV_FAIL) && (one->requirement < wanted.len)
            && (((const uint8_t *)wanted.buf)[one->requirement] != 0U)) {
            (void)gather(&g, one, rv_captured(c->m, one));
        }
    }
    PyBuffer_Release(&wanted);
    return Py_BuildValue("LN", (long long)count, attempts_of(&g));
}
