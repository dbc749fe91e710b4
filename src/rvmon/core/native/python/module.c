/* The module rvmon.native._core: the type Monitor, its step functions, and the locking of its
 * methods. */
#include "python/module.h"

#ifndef RVMON_SOURCE_HASH
#define RVMON_SOURCE_HASH "" /* compiled by hand */
#endif

enum { TAKEN, LEFT, FAILED };

/* Convert a sample and pass it to the core. LEFT: Python has to look at it, or the core refused it;
 * nothing changed. FAILED: an error is set. No Python code runs in here. */
static inline int take(monitor *c, int64_t t, PyObject *values, bool checked)
{
    int code = RV_FINISHED;
    bool converted;
    c->busy = true;
    Py_BEGIN_CRITICAL_SECTION(values);
    converted = convert_sample(&c->in, values, checked);
    Py_END_CRITICAL_SECTION();
    c->busy = false;
    if (converted) {
        code = rv_step(c->m, t, c->in.updates, (int32_t)c->in.count);
    }
    if (code == RV_OK) {
        note_arrivals(&c->in, t);
    }
    if (code == RV_NO_MEMORY) {
        (void)PyErr_NoMemory();
        return FAILED;
    }
    return (code == RV_OK) ? TAKEN : (PyErr_Occurred() != NULL) ? FAILED : LEFT;
}

/* Call a step function of Python with the arguments of a call of step. */
static PyObject *step_in_python(PyObject *function, PyObject *const *args, Py_ssize_t count,
                               PyObject *names)
{
    const Py_ssize_t named = (names == NULL) ? 0 : PyTuple_Size(names);
    PyObject *by_place = PyTuple_New(count);
    PyObject *by_name = PyDict_New();
    PyObject *made = NULL;
    bool done = (by_place != NULL) && (by_name != NULL);
    Py_ssize_t i;
    if (function == NULL) {
        PyErr_SetString(PyExc_RuntimeError, "this monitor was collected");
        done = false;
    }
    for (i = 0; done && (i < count); i++) {
        done = PyTuple_SetItem(by_place, i, Py_NewRef(args[i])) == 0;
    }
    for (i = 0; done && (i < named); i++) {
        done = PyDict_SetItem(by_name, PyTuple_GetItem(names, i), args[count + i]) == 0;
    }
    if (done) {
        Py_INCREF(function);
        made = PyObject_Call(function, by_place, by_name);
        Py_DECREF(function);
    }
    Py_XDECREF(by_place);
    Py_XDECREF(by_name);
    return made;
}

/* Step without running Python; returns what was decided. NULL without an error: Python has to look at
 * the sample. */
static inline PyObject *step_quickly(monitor *c, int64_t t, PyObject *values)
{
    PyObject *made = NULL;
    Py_BEGIN_CRITICAL_SECTION(c);
    if (!c->held && !c->busy && PyDict_CheckExact(values) && (take(c, t, values, false) == TAKEN)) {
        made = (c->figures != NULL) ? figures_since(c) : decided_since(c);
    }
    Py_END_CRITICAL_SECTION();
    return made;
}

static PyObject *monitor_step_ns(PyObject *self, PyObject *const *args, Py_ssize_t count,
                                 PyObject *names)
{
    monitor *c = (monitor *)self;
    if ((count == 2) && (names == NULL) && PyLong_CheckExact(args[0])) {
        int beyond = 0;
        const long long t = PyLong_AsLongLongAndOverflow(args[0], &beyond);
        if (beyond == 0) {
            PyObject *made = step_quickly(c, (int64_t)t, args[1]);
            if ((made != NULL) || (PyErr_Occurred() != NULL)) {
                return made;
            }
        }
    }
    return step_in_python(c->slow_step_ns, args, count, names);
}

/* From 2^23 s (97 days) on, neighbouring doubles are more than a nanosecond apart. */
#define COARSE_FROM 8388608.0

/* Seconds in nanoseconds, as `ticks_of_seconds` computes them: those of the shortest decimal that reads
 * as this float. False: not certain here. The fraction is exact but products are rounded, hence the
 * margin in `half`. */
static bool ticks_of_float(double seconds, int64_t *t)
{
    const int64_t whole = (seconds > -4e9) && (seconds < 4e9) ? (int64_t)seconds : 0;
    const double part = seconds - (double)whole;
    const double size = fabs(seconds);
    const double half = (size < COARSE_FROM) ? 0.4999e-9 : (nextafter(size, INFINITY) - size) / 2.0;
    double power = (size < COARSE_FROM) ? 1e9 : 1.0;
    if (!(fabs(part) < 1.0)) {
        return false;
    }
    while ((fabs(part * power - rint(part * power)) > half * power) && (power < 1e9)) {
        power *= 10.0; /* until the digits are enough to read as this float */
    }
    *t = whole * INT64_C(1000000000) + (int64_t)(rint(part * power) * (1e9 / power));
    return fabs(part * power - rint(part * power)) <= half * power;
}

static PyObject *monitor_step(PyObject *self, PyObject *const *args, Py_ssize_t count,
                              PyObject *names)
{
    monitor *c = (monitor *)self;
    int64_t t;
    if ((count == 2) && (names == NULL) && PyFloat_CheckExact(args[0])
        && ticks_of_float(PyFloat_AsDouble(args[0]), &t)) {
        PyObject *made = step_quickly(c, t, args[1]);
        if ((made != NULL) || (PyErr_Occurred() != NULL)) {
            return made;
        }
    }
    return step_in_python(c->slow_step, args, count, names);
}

#define METHOD(name)                                            \
    static PyObject *monitor_##name(PyObject *self, PyObject *arg) \
    {                                                           \
        PyObject *made = NULL;                                  \
        Py_BEGIN_CRITICAL_SECTION(self);                        \
        if (is_free((monitor *)self)) {                         \
            made = name##_of((monitor *)self, arg);             \
        }                                                       \
        Py_END_CRITICAL_SECTION();                              \
        return made;                                            \
    }

static bool is_free(const monitor *c)
{
    if (c->busy) {
        PyErr_SetString(PyExc_RuntimeError, "another call is under way");
    }
    return !c->busy;
}

/* judge(t, values, checked): whether the sample was taken; `checked`: Python has already checked it. */
static PyObject *judge_of(monitor *c, PyObject *args)
{
    long long t;
    PyObject *values;
    int checked;
    int done = LEFT;
    if (!PyArg_ParseTuple(args, "LOp", &t, &values, &checked)) {
        return NULL;
    }
    if (PyDict_CheckExact(values)) {
        done = take(c, (int64_t)t, values, checked != 0);
    }
    return (done == FAILED) ? NULL : Py_NewRef((done == TAKEN) ? Py_True : Py_False);
}

static PyObject *advance_of(monitor *c, PyObject *until)
{
    const long long t = PyLong_AsLongLong(until);
    int code;
    if ((t == -1) && (PyErr_Occurred() != NULL)) {
        return NULL;
    }
    code = rv_advance(c->m, (int64_t)t);
    return is_done(code) ? Py_NewRef(Py_None) : NULL;
}

/* finish(t or None): the last instant of the trace, or None. */
static PyObject *finish_of(monitor *c, PyObject *until)
{
    int64_t t = RV_NO_TIME;
    int64_t end;
    int code;
    if (until != Py_None) {
        t = (int64_t)PyLong_AsLongLong(until);
        if ((t == -1) && (PyErr_Occurred() != NULL)) {
            return NULL;
        }
    }
    end = rv_end(c->m, t);
    code = rv_spoilt(c->m) ? RV_NO_MEMORY : rv_finish(c->m, t);
    /* An interrupted finish may be repeated. */
    return ((code == RV_FINISHED) || is_done(code)) ? instant(end, RV_NO_TIME) : NULL;
}

static PyObject *reset_of(monitor *c, PyObject *unused)
{
    (void)unused;
    c->given = 0;
    forget_arrivals(&c->in);
    free_dropped(&c->notes);
    rv_forget_records(c->m);
    return is_done(rv_reset(c->m)) ? Py_NewRef(Py_None) : NULL;
}

METHOD(judge)
METHOD(advance)
METHOD(lose)
METHOD(found)
METHOD(late)
METHOD(finish)
METHOD(reset)
METHOD(keep)
METHOD(arrivals)
METHOD(take_arrivals)
METHOD(flush)
METHOD(failed)
METHOD(open)
METHOD(records)
METHOD(counts)
METHOD(stale)
METHOD(times)
METHOD(next_due)
METHOD(measure)
METHOD(figures)
METHOD(open_figures)
METHOD(margins)
METHOD(memory_used)
METHOD(rows)
METHOD(save)
METHOD(load)
METHOD(truths)
METHOD(hits)
METHOD(situation)
METHOD(passages)

static PyObject *monitor_hold(PyObject *self, PyObject *held)
{
    monitor *c = (monitor *)self;
    bool done;
    Py_BEGIN_CRITICAL_SECTION(self);
    done = !c->busy;
    if (done) {
        c->held = held == Py_True;
    }
    Py_END_CRITICAL_SECTION();
    return Py_NewRef(done ? Py_True : Py_False);
}

static int monitor_traverse(PyObject *self, visitproc visit, void *arg)
{
    Py_VISIT(Py_TYPE(self));
    Py_VISIT(((monitor *)self)->owner);
    if (((monitor *)self)->figures != NULL) {
        Py_VISIT(((monitor *)self)->figures->owner);
    }
    return 0;
}

/* Borrowed references end with their owner, so `busy` makes further calls impossible. */
static int monitor_clear(PyObject *self)
{
    monitor *c = (monitor *)self;
    c->busy = true;
    c->slow_step = NULL;
    c->slow_step_ns = NULL;
    Py_CLEAR(c->owner);
    free_figures(c);
    return 0;
}

static void monitor_dealloc(PyObject *self)
{
    monitor *c = (monitor *)self;
    PyTypeObject *type = Py_TYPE(self);
    PyObject_GC_UnTrack(self);
    (void)monitor_clear(self);
    if (c->m != NULL) {
        (void)rv_reset(c->m); /* releases what pieces hold */
        rv_free(c->m);
    }
    free_dropped(&c->notes);
    free(c->notes.dropped);
    free_intake(&c->in);
    PyMem_Free(c->captured);
    free(c->plan);
    Py_XDECREF(c->data);
    Py_XDECREF(c->nothing);
    PyObject_GC_Del(self);
    Py_DECREF(type);
}

#define FUNCTION(name) (PyCFunction)(void (*)(void))monitor_##name

static PyMethodDef monitor_methods[] = {
    {"step", FUNCTION(step), METH_FASTCALL | METH_KEYWORDS,
     "step(t, values)\n--\n\nTake one sample, at seconds; see `rvmon.Monitor`."},
    {"step_ns", FUNCTION(step_ns), METH_FASTCALL | METH_KEYWORDS,
     "step_ns(t_ns, values)\n--\n\nTake one sample, at ticks; see `rvmon.Monitor`."},
    {"judge", monitor_judge, METH_VARARGS, NULL},
    {"rows", monitor_rows, METH_VARARGS, NULL},
    {"advance", monitor_advance, METH_O, NULL},
    {"lose", monitor_lose, METH_VARARGS, NULL},
    {"found", monitor_found, METH_VARARGS, NULL},
    {"late", monitor_late, METH_VARARGS, NULL},
    {"finish", monitor_finish, METH_O, NULL},
    {"keep", monitor_keep, METH_O, NULL},
    {"arrivals", monitor_arrivals, METH_NOARGS, NULL},
    {"take_arrivals", monitor_take_arrivals, METH_O, NULL},
    {"flush", monitor_flush, METH_NOARGS, NULL},
    {"failed", monitor_failed, METH_VARARGS, NULL},
    {"open", monitor_open, METH_NOARGS, NULL},
    {"records", monitor_records, METH_NOARGS, NULL},
    {"counts", monitor_counts, METH_NOARGS, NULL},
    {"stale", monitor_stale, METH_NOARGS, NULL},
    {"times", monitor_times, METH_NOARGS, NULL},
    {"next_due", monitor_next_due, METH_NOARGS, NULL},
    {"truths", monitor_truths, METH_O, NULL},
    {"passages", monitor_passages, METH_O, NULL},
    {"situation", monitor_situation, METH_O, NULL},
    {"hits", monitor_hits, METH_NOARGS, NULL},
    {"measure", monitor_measure, METH_VARARGS, NULL},
    {"figures", monitor_figures, METH_NOARGS, NULL},
    {"open_figures", monitor_open_figures, METH_NOARGS, NULL},
    {"margins", monitor_margins, METH_NOARGS, NULL},
    {"memory_used", monitor_memory_used, METH_NOARGS, NULL},
    {"hold", monitor_hold, METH_O, NULL},
    {"reset", monitor_reset, METH_NOARGS, NULL},
    {"save", monitor_save, METH_NOARGS, NULL},
    {"load", monitor_load, METH_O, NULL},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot monitor_slots[] = {
    {Py_tp_new, RVMON_SLOT(monitor_new)},
    {Py_tp_dealloc, RVMON_SLOT(monitor_dealloc)},
    {Py_tp_traverse, RVMON_SLOT(monitor_traverse)},
    {Py_tp_clear, RVMON_SLOT(monitor_clear)},
    {Py_tp_methods, monitor_methods},
    {0, NULL},
};

static PyType_Spec monitor_spec = {
    "rvmon.native._core.Monitor", sizeof(monitor), 0,
    Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_IMMUTABLETYPE, monitor_slots,
};

/* memory_of(plan, attempts): bytes of a block in which a run can start with that many attempts. */
static PyObject *core_memory_of(PyObject *module, PyObject *args)
{
    const rv_memory heap = {malloc, realloc, free, NULL, 0};
    Py_buffer plan;
    int attempts;
    PyObject *made = NULL;
    rv_monitor *m;
    (void)module;
    if (!PyArg_ParseTuple(args, "y*i", &plan, &attempts)) {
        return NULL;
    }
    m = rv_new(plan.buf, (size_t)plan.len, heap);
    if ((m != NULL) && (rv_reserve(m, attempts) == RV_OK)) {
        made = PyLong_FromLongLong((long long)rv_memory_used(m));
    } else if (rv_plan_check(plan.buf, (size_t)plan.len) >= 0) {
        PyErr_SetString(PyExc_ValueError, "the plan is damaged");
    } else {
        (void)PyErr_NoMemory();
    }
    rv_free(m);
    PyBuffer_Release(&plan);
    return made;
}

static PyMethodDef core_methods[] = {
    {"memory_of", core_memory_of, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL},
};

static int execute(PyObject *module)
{
    PyObject *type = PyType_FromModuleAndSpec(module, &monitor_spec, NULL);
    const bool done = (type != NULL) && (PyModule_AddObjectRef(module, "Monitor", type) == 0)
                      && add_record_type(module) && add_figure_types(module);
    Py_XDECREF(type);
    return done ? PyModule_AddStringConstant(module, "source_hash", RVMON_SOURCE_HASH) : -1;
}

RVMON_MODULE(_core, core_methods, execute)
