/* The module rvmon.native._zones for CPython: one function, no state. */
#include "zones.h"

#include "../../core/native/python/python_abi.h"

#ifndef RVMON_SOURCE_HASH
#define RVMON_SOURCE_HASH "" /* compiled by hand */
#endif

typedef struct {
    PyObject *continues;
    PyObject *diverges;
    PyThreadState *thread;
} callbacks;

/* Call a Python function and return its integer result, or -1 if it raised. Steals the arguments. */
static long ask(PyObject *function, PyObject *arguments)
{
    PyObject *given;
    long number = -1;
    if (arguments == NULL) {
        return -1;
    }
    given = PyObject_Call(function, arguments, NULL);
    Py_DECREF(arguments);
    if (given != NULL) {
        number = PyLong_AsLong(given);
        Py_DECREF(given);
    }
    return (PyErr_Occurred() != NULL) ? -1 : number;
}

static bool continues(void *context, uint64_t visited, uint64_t waiting)
{
    callbacks *c = context;
    long on;
    PyEval_RestoreThread(c->thread);
    on = ask(c->continues, Py_BuildValue("(LL)", (long long)visited, (long long)waiting));
    c->thread = PyEval_SaveThread();
    return on > 0;
}

static int diverges(void *context, const numbers *path, int32_t loop, const int64_t *head,
                    uint32_t dim)
{
    callbacks *c = context;
    const Py_ssize_t size = (Py_ssize_t)(dim * dim * sizeof *head);
    long found;
    PyEval_RestoreThread(c->thread);
    found = ask(c->diverges,
                Py_BuildValue("(y#iy#)", (const char *)path->at,
                              (Py_ssize_t)(path->count * sizeof *path->at), (int)loop,
                              (const char *)head, size));
    c->thread = PyEval_SaveThread();
    return (found < 0) ? -1 : (found > 0);
}

static PyObject *answered(const answer *found)
{
    const Py_ssize_t path = (Py_ssize_t)(found->path.count * sizeof *found->path.at);
    const size_t part = (size_t)found->dim * found->dim * sizeof *found->parts;
    const Py_ssize_t parts = (Py_ssize_t)(found->part_count * part);
    const char *none = "";
    return Py_BuildValue(
        "(iiiiLLLLy#y#y#)", (int)found->state, (int)found->ending, (int)found->loop,
        (int)found->improper, (long long)found->visited, (long long)found->stored,
        (long long)found->states, (long long)found->peak,
        (found->path.at != NULL) ? (const char *)found->path.at : none, path,
        (found->parts != NULL) ? (const char *)found->parts : none, parts,
        (found->spans != NULL) ? (const char *)found->spans : none,
        (Py_ssize_t)(2 * found->span_count * sizeof *found->spans));
}

/* Copy plan and costs to aligned blocks and validate them; sets an exception if that fails. */
static bool taken(const Py_buffer *plan, const Py_buffer *costs, int32_t **numbers_of,
                  double **costs_of)
{
    const size_t count = (size_t)plan->len / sizeof **numbers_of;
    plan_state state = PLAN_NO_MEMORY;
    *numbers_of = PyMem_Malloc((size_t)plan->len + 1);
    *costs_of = PyMem_Malloc((size_t)costs->len + 1);
    if ((*numbers_of != NULL) && (*costs_of != NULL)) {
        (void)memcpy(*numbers_of, plan->buf, (size_t)plan->len);
        (void)memcpy(*costs_of, costs->buf, (size_t)costs->len);
        state = plan_check(*numbers_of, count);
    }
    if ((state == PLAN_GOOD)
        && ((size_t)costs->len
            != (size_t)plan_count(*numbers_of, AT_EDGES) * sizeof **costs_of)) {
        state = PLAN_DAMAGED;
    }
    if (state == PLAN_NO_MEMORY) {
        (void)PyErr_NoMemory();
    } else if (state == PLAN_DAMAGED) {
        PyErr_SetString(PyExc_ValueError, "the plan is damaged");
    }
    return state == PLAN_GOOD;
}

/* search(plan, costs, continues, diverges, most_states, most_bytes, proper_only), as described in zones.h.
 * Returns state, ending, loop, improper, visited, stored, discrete states, peak of bytes in use, and as
 * bytes path, parts and spans. */
static PyObject *zones_search(PyObject *module, PyObject *args)
{
    callbacks c = {NULL, NULL, NULL};
    caller from;
    Py_buffer plan;
    Py_buffer costs;
    long long most_states;
    long long most_bytes;
    int proper_only;
    int32_t *numbers_of = NULL;
    double *costs_of = NULL;
    PyObject *made = NULL;
    (void)module;
    if (!PyArg_ParseTuple(args, "y*y*OOLLi", &plan, &costs, &c.continues, &c.diverges, &most_states,
                          &most_bytes, &proper_only)) {
        return NULL;
    }
    if (taken(&plan, &costs, &numbers_of, &costs_of)) {
        answer found;
        from.context = &c;
        from.continues = continues;
        from.diverges = diverges;
        from.most_states = (most_states < 0) ? UINT64_MAX : (uint64_t)most_states;
        from.most_bytes = (most_bytes < 0) ? UINT64_MAX : (uint64_t)most_bytes;
        from.proper_only = proper_only != 0;
        c.thread = PyEval_SaveThread();
        found = search(numbers_of, costs_of, &from);
        PyEval_RestoreThread(c.thread);
        if (PyErr_Occurred() == NULL) {
            made = answered(&found);
        }
        release_answer(&found);
    }
    PyMem_Free(numbers_of);
    PyMem_Free(costs_of);
    PyBuffer_Release(&plan);
    PyBuffer_Release(&costs);
    return made;
}

static PyMethodDef methods[] = {
    {"search", zones_search, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL},
};

static int execute(PyObject *module)
{
    return PyModule_AddStringConstant(module, "source_hash", RVMON_SOURCE_HASH);
}

RVMON_MODULE(_zones, methods, execute)
