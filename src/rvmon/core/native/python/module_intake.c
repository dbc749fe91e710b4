/* Converting samples from Python: a dictionary of plain values becomes updates. Anything else, such as a
 * subclass, a NumPy scalar or an unknown name, makes `convert_sample` return false before anything is
 * judged. Python then looks at the sample, and passes plain values back or raises an error. */
#include "python/module.h"

/* The cause of an unknown field that the payload lacks. */
#define IS_NOT_SAID (-1)

/* Convert a value other than a float; false: Python has to look at it. */
static bool number_of_other(PyObject *value, const reading *as, rv_number *number)
{
    int beyond = 0;
    if (as->kind == IS_BOOLEAN) {
        number->kind = RV_WHOLE;
        number->as.whole = (value == Py_True) ? 1 : 0;
        return (value == Py_True) || (value == Py_False);
    }
    if (as->kind == IS_LABEL) {
        PyObject *found = NULL;
        if (PyUnicode_CheckExact(value)) {
            found = PyDict_GetItemWithError(as->words, value);
        }
        number->kind = RV_WHOLE;
        number->as.whole = (found == NULL) ? 0 : PyLong_AsLongLong(found);
        return found != NULL;
    }
    if (!PyLong_CheckExact(value)) {
        return false;
    }
    number->kind = RV_WHOLE;
    number->as.whole = PyLong_AsLongLongAndOverflow(value, &beyond);
    if (as->kind == IS_REAL) {
        number->kind = RV_REAL;
        number->as.real = (double)number->as.whole;
    }
    return beyond == 0;
}

/* Convert a float; NaN is unknown. */
static inline void take_float(PyObject *value, rv_number *number)
{
    const double x = PyFloat_AsDouble(value);
    number->kind = RV_REAL;
    number->as.real = x;
    if (x != x) {
        number->kind = RV_UNKNOWN;
        number->as.whole = RV_IS_NAN;
    }
}

/* Convert a value; false: Python has to look at it. */
static bool number_of(PyObject *value, const reading *as, rv_number *number)
{
    if ((as->kind == IS_REAL) && PyFloat_Check(value)) {
        take_float(value, number);
        return true;
    }
    return number_of_other(value, as, number);
}

/* The name at a place of the sample; NULL: not a known name. The cache mostly hits, as samples have the
 * same key objects in the same order. */
static const seen_name *name_at(intake *in, PyObject *name, int32_t place)
{
    PyObject *found = NULL;
    seen_name *seen = &in->seen[place];
    long number;
    if (place >= in->names) {
        return NULL;
    }
    if (seen->name == name) {
        return seen;
    }
    if (PyUnicode_CheckExact(name)) {
        found = PyDict_GetItemWithError(in->numbers, name);
    }
    number = (found == NULL) ? -1 : PyLong_AsLong(found);
    if ((number < 0) || (number >= in->names)) {
        return NULL;
    }
    Py_INCREF(name);
    Py_XDECREF(seen->name);
    seen->name = name;
    seen->number = (int32_t)number;
    seen->kind = (number < in->signals) ? in->readings[number].kind : -1;
    return seen;
}

static inline rv_update *next_update(intake *in, int32_t name)
{
    rv_update *update = &in->updates[in->count];
    in->count++;
    update->name = name;
    update->says = RV_SAYS_YES;
    update->fields = NULL;
    return update;
}

static inline bool convert_signal(intake *in, const seen_name *name, PyObject *value)
{
    rv_update *update = next_update(in, name->number);
    if ((name->kind == IS_REAL) && PyFloat_CheckExact(value)) {
        take_float(value, &update->value);
    } else if ((name->kind == IS_BOOLEAN) && ((value == Py_True) || (value == Py_False))) {
        update->value.kind = RV_WHOLE;
        update->value.as.whole = (value == Py_True) ? 1 : 0;
        return true;
    } else if (value == Py_None) {
        update->value.kind = RV_UNKNOWN;
        update->value.as.whole = RV_IS_NONE;
    } else if (!number_of(value, &in->readings[name->number], &update->value)) {
        return false;
    } else {
        /* number_of() has converted it. */
    }
    if (update->value.kind == RV_UNKNOWN) {
        update->says = RV_SAYS_UNKNOWN;
        in->is_odd = true;
    }
    return true;
}

static bool convert_fields(const intake *in, int32_t name, PyObject *payload, rv_number *fields)
{
    const reading *event = &in->readings[name];
    const reading *readings = &in->readings[in->names + in->first_fields[name - in->signals]];
    PyObject *key;
    PyObject *value;
    Py_ssize_t at = 0;
    while (PyDict_Next(payload, &at, &key, &value) != 0) {
        PyObject *found = NULL;
        long field;
        if (PyUnicode_CheckExact(key)) {
            found = PyDict_GetItemWithError(event->words, key);
        }
        field = (found == NULL) ? -1 : PyLong_AsLong(found);
        if ((field < 0) || (field >= event->fields)
            || ((value != Py_None) && !number_of(value, &readings[field], &fields[field]))) {
            return false;
        }
        if (value == Py_None) {
            fields[field].as.whole = RV_IS_NONE;
        }
    }
    return true;
}

static bool convert_payload(intake *in, int32_t name, PyObject *payload)
{
    const int32_t count = in->readings[name].fields;
    rv_number *fields = &in->fields[in->fields_count];
    bool done;
    int32_t i;
    if (!PyDict_CheckExact(payload)) {
        return false;
    }
    in->fields_count += count;
    in->is_odd = true;
    for (i = 0; i < count; i++) {
        fields[i].kind = RV_UNKNOWN;
        fields[i].as.whole = IS_NOT_SAID;
    }
    next_update(in, name)->fields = fields;
    Py_BEGIN_CRITICAL_SECTION(payload);
    done = convert_fields(in, name, payload, fields);
    Py_END_CRITICAL_SECTION();
    return done;
}

/* Make room for `count` occurrences of an event and one update of every name after them. Payload
 * pointers follow when the fields move. */
static bool make_room(intake *in, int64_t count, int32_t fields)
{
    const int64_t updates = in->count + count + in->names;
    const int64_t numbers = in->fields_count + count * fields + in->fields_most;
    if (updates > in->room) {
        rv_update *made = PyMem_Realloc(in->updates, (size_t)updates * sizeof *made);
        if (made == NULL) {
            return false;
        }
        in->updates = made;
        in->room = updates;
    }
    if (numbers > in->fields_room) {
        rv_number *made = PyMem_Malloc((size_t)numbers * sizeof *made);
        int64_t i;
        if (made == NULL) {
            return false;
        }
        (void)memcpy(made, in->fields, (size_t)in->fields_count * sizeof *made);
        for (i = 0; i < in->count; i++) {
            if (in->updates[i].fields != NULL) {
                in->updates[i].fields = made + (in->updates[i].fields - in->fields);
            }
        }
        PyMem_Free(in->fields);
        in->fields = made;
        in->fields_room = numbers;
    }
    return true;
}

/* Convert several occurrences of an event; false: Python has to look at them, or, with an error, memory
 * is short. */
static bool convert_payloads(intake *in, int32_t name, PyObject *payloads, bool checked)
{
    const Py_ssize_t count = PyTuple_Size(payloads);
    bool done = true;
    Py_ssize_t i;
    if ((count > 1) && (in->readings[name].single != 0) && !checked) {
        return false;
    }
    if ((count > INT32_MAX / 2) || ((count > 1) && !make_room(in, count, in->readings[name].fields))) {
        (void)PyErr_NoMemory();
        return false;
    }
    if (count == 0) {
        next_update(in, name)->says = RV_SAYS_NO;
    }
    for (i = 0; done && (i < count); i++) {
        done = convert_payload(in, name, PyTuple_GetItem(payloads, i));
    }
    return done;
}

static bool convert_event(intake *in, int32_t name, PyObject *value, bool checked)
{
    if (value == Py_True) {
        (void)next_update(in, name);
    } else if (value == Py_False) {
        next_update(in, name)->says = RV_SAYS_NO;
    } else if (value == Py_None) {
        next_update(in, name)->says = RV_SAYS_UNKNOWN;
        in->is_odd = true;
    } else if (PyTuple_CheckExact(value)) {
        return convert_payloads(in, name, value, checked);
    } else {
        return convert_payload(in, name, value);
    }
    return true;
}

/* Convert a sample; false: Python has to look at it, or, with an error, memory is short. No Python code
 * runs, as only keys and values of exact built-in types are read. */
bool convert_sample(intake *in, PyObject *values, bool checked)
{
    PyObject *name;
    PyObject *value;
    Py_ssize_t at = 0;
    int32_t place;
    in->count = 0;
    in->fields_count = 0;
    in->is_odd = false;
    for (place = 0; PyDict_Next(values, &at, &name, &value) != 0; place++) {
        const seen_name *seen = name_at(in, name, place);
        if ((seen == NULL)
            || !((seen->number < in->signals) ? convert_signal(in, seen, value)
                                              : convert_event(in, seen->number, value, checked))) {
            return false;
        }
    }
    return true;
}

static void note_unknown(arrival *a, const rv_number *value, int64_t t)
{
    const bool is_nan = value->as.whole == RV_IS_NAN;
    int64_t *count = is_nan ? &a->nan_count : &a->none_count;
    int64_t *first = is_nan ? &a->nan_first : &a->none_first;
    *first = (*count == 0) ? t : *first;
    (*count)++;
}

/* Update input health by the sample taken at `t`. This is skipped if everything was known and every
 * signal has come before. */
void note_arrivals(intake *in, int64_t t)
{
    static const rv_number none = {RV_UNKNOWN, {RV_IS_NONE}};
    int64_t i;
    for (i = 0; (in->is_odd || (in->to_come > 0)) && (i < in->count); i++) {
        const rv_update *u = &in->updates[i];
        arrival *a = &in->arrivals[u->name];
        if (u->name < in->signals) {
            const bool known = u->value.kind != RV_UNKNOWN;
            if (!known && (in->readings[u->name].single != 0)) {
                continue;
            }
            if (a->came == RV_NO_TIME) {
                a->came = t;
                in->to_come--;
            }
            if (!known) {
                note_unknown(a, &u->value, t);
            }
        } else if (u->says == RV_SAYS_UNKNOWN) {
            note_unknown(a, &none, t);
        } else if (u->fields != NULL) {
            arrival *fields = &in->arrivals[in->names + in->first_fields[u->name - in->signals]];
            int32_t k;
            for (k = 0; k < in->readings[u->name].fields; k++) {
                if ((u->fields[k].kind == RV_UNKNOWN) && (u->fields[k].as.whole != IS_NOT_SAID)) {
                    note_unknown(&fields[k], &u->fields[k], t);
                }
            }
        } else {
            /* An event without a payload. */
        }
    }
}

/* Count the signals without an update so far. */
void count_to_come(intake *in)
{
    int32_t i;
    in->to_come = 0;
    for (i = 0; i < in->signals; i++) {
        in->to_come += (in->arrivals[i].came == RV_NO_TIME) ? 1 : 0;
    }
}

/* Reset input health. */
void forget_arrivals(intake *in)
{
    int32_t i;
    for (i = 0; i < in->all; i++) {
        (void)memset(&in->arrivals[i], 0, sizeof in->arrivals[i]);
        in->arrivals[i].came = RV_NO_TIME;
    }
    count_to_come(in);
}

void free_intake(intake *in)
{
    int32_t i;
    for (i = 0; (in->seen != NULL) && (i < in->names); i++) {
        Py_XDECREF(in->seen[i].name);
    }
    PyMem_Free(in->readings);
    PyMem_Free(in->arrivals);
    PyMem_Free(in->first_fields);
    PyMem_Free(in->seen);
    PyMem_Free(in->updates);
    PyMem_Free(in->fields);
    (void)memset(in, 0, sizeof *in);
}

/* Set up how names and fields are read; false with an error. `words` and `kinds` are indexed by signal,
 * event and field, `single` by name. */
bool make_intake(intake *in, const rv_monitor *m, PyObject *numbers, PyObject *words,
                        PyObject *kinds, PyObject *single)
{
    const rv_sizes sizes = rv_sizes_of(m);
    const int32_t names = sizes.signals + sizes.events;
    const int32_t all = names + sizes.fields;
    int32_t i;
    if ((PyTuple_Size(words) != all) || (PyBytes_Size(kinds) != all)
        || (PyBytes_Size(single) != names)) {
        PyErr_SetString(PyExc_ValueError, "not the names of the plan");
        return false;
    }
    in->numbers = numbers;
    in->signals = sizes.signals;
    in->names = names;
    in->fields_most = sizes.fields;
    in->room = names + 1;
    in->fields_room = sizes.fields + 1;
    in->all = all;
    in->readings = PyMem_Calloc((size_t)all + 1, sizeof *in->readings);
    in->arrivals = PyMem_Calloc((size_t)all + 1, sizeof *in->arrivals);
    in->first_fields = PyMem_Calloc((size_t)sizes.events + 1, sizeof *in->first_fields);
    in->seen = PyMem_Calloc((size_t)names + 1, sizeof *in->seen);
    in->updates = PyMem_Calloc((size_t)in->room, sizeof *in->updates);
    in->fields = PyMem_Calloc((size_t)in->fields_room, sizeof *in->fields);
    if ((in->readings == NULL) || (in->arrivals == NULL) || (in->first_fields == NULL) || (in->seen == NULL)
        || (in->updates == NULL) || (in->fields == NULL)) {
        (void)PyErr_NoMemory();
        return false;
    }
    forget_arrivals(in);
    for (i = 0; i < all; i++) {
        reading *own = &in->readings[i];
        const bool is_event = (i >= sizes.signals) && (i < names);
        own->words = PyTuple_GetItem(words, (Py_ssize_t)i);
        own->kind = PyBytes_AsString(kinds)[i];
        own->single = (i < names) ? PyBytes_AsString(single)[i] : 0;
        if (is_event) {
            const int32_t event = i - sizes.signals;
            own->fields = rv_fields_of(m, event, &in->first_fields[event]);
        }
        if ((is_event || (own->kind == IS_LABEL)) && !PyDict_CheckExact(own->words)) {
            PyErr_SetString(PyExc_ValueError, "labels and fields come with a number for each");
            return false;
        }
    }
    return true;
}

