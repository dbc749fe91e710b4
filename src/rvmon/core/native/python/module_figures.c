/* The types Bounds and Figure, into which margins are converted, with fields at fixed places. Python's
 * types of figures derive from them. The bounds of a figure become an object when they are read.
 *
 * The collector does not track these objects: nothing that they refer to refers back to them. */
#include "python/module.h"

typedef struct {
    PyObject_HEAD
    double low;
    double high;
    double kept;
} bounds_object;

typedef struct {
    PyObject_HEAD
    PyObject *requirement;     /* NULL: not set, as for the next field */
    PyObject *number;
    PyObject *kind;            /* the type of its bounds; NULL: the bounds are not set */
    long long t;
    double low;
    double high;
    double kept;
    char in_doubt;
} figure_object;

static void bounds_dealloc(PyObject *self)
{
    free_uncollected(self);
}

static void figure_dealloc(PyObject *self)
{
    const figure_object *own = (figure_object *)self;
    Py_XDECREF(own->requirement);
    Py_XDECREF(own->number);
    Py_XDECREF(own->kind);
    free_uncollected(self);
}

static PyObject *get_robustness(PyObject *self, void *unused)
{
    const figure_object *own = (figure_object *)self;
    bounds_object *made;
    (void)unused;
    if (own->kind == NULL) {
        PyErr_SetString(PyExc_AttributeError, "robustness");
        return NULL;
    }
    made = (bounds_object *)new_uncollected((PyTypeObject *)own->kind);
    if (made != NULL) {
        made->low = own->low;
        made->high = own->high;
        made->kept = own->kept;
    }
    return (PyObject *)made;
}

static int set_robustness(PyObject *self, PyObject *value, void *unused)
{
    figure_object *own = (figure_object *)self;
    PyObject *was = own->kind;
    (void)unused;
    if (value == NULL) {
        PyErr_SetString(PyExc_AttributeError, "robustness");
        return -1;
    }
    if (!derives(Py_TYPE(value), bounds_dealloc)) {
        return -1;
    }
    own->low = ((bounds_object *)value)->low;
    own->high = ((bounds_object *)value)->high;
    own->kept = ((bounds_object *)value)->kept;
    own->kind = Py_NewRef((PyObject *)Py_TYPE(value));
    Py_XDECREF(was);
    return 0;
}

static PyMemberDef bounds_members[] = {
    {"low", T_DOUBLE, offsetof(bounds_object, low), 0, NULL},
    {"high", T_DOUBLE, offsetof(bounds_object, high), 0, NULL},
    {"kept", T_DOUBLE, offsetof(bounds_object, kept), 0, NULL},
    {NULL, 0, 0, 0, NULL},
};

static PyGetSetDef bounds_getset[] = {
    {NULL, NULL, NULL, NULL, NULL},
};

static PyMemberDef figure_members[] = {
    {"requirement", T_OBJECT_EX, offsetof(figure_object, requirement), 0, NULL},
    {"number", T_OBJECT_EX, offsetof(figure_object, number), 0, NULL},
    {"t", T_LONGLONG, offsetof(figure_object, t), 0, NULL},
    {"in_doubt", T_BOOL, offsetof(figure_object, in_doubt), 0, NULL},
    {NULL, 0, 0, 0, NULL},
};

static PyGetSetDef figure_getset[] = {
    {"robustness", get_robustness, set_robustness, NULL, NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot bounds_slots[] = {
    {Py_tp_dealloc, RVMON_SLOT(bounds_dealloc)},
    {Py_tp_members, bounds_members},
    {0, NULL},
};

static PyType_Slot figure_slots[] = {
    {Py_tp_dealloc, RVMON_SLOT(figure_dealloc)},
    {Py_tp_members, figure_members},
    {Py_tp_getset, figure_getset},
    {0, NULL},
};

static PyType_Spec bounds_spec = {
    "rvmon.native._core.Bounds", sizeof(bounds_object), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
    bounds_slots,
};

static PyType_Spec figure_spec = {
    "rvmon.native._core.Figure", sizeof(figure_object), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
    figure_slots,
};

/* Add both types to the module; false with an error. */
bool add_figure_types(PyObject *module)
{
    return add_base_type(module, "Bounds", &bounds_spec, bounds_members, bounds_getset)
           && add_base_type(module, "Figure", &figure_spec, figure_members, figure_getset);
}

/* Whether the types derive from Figure and Bounds; false with an error. */
bool are_of_figures(const struct figures *f)
{
    return derives(f->measured, figure_dealloc) && derives(f->robustness, bounds_dealloc);
}

/* A figure as an object; NULL with an error. */
PyObject *figure_of(const struct figures *f, PyObject *requirement, const rv_margin *x)
{
    PyObject *number = (x->of_position != 0U) ? Py_NewRef(Py_None) : PyLong_FromUnsignedLong(x->number);
    figure_object *made = (number != NULL) ? (figure_object *)new_uncollected(f->measured) : NULL;
    if (made == NULL) {
        Py_XDECREF(number);
        return NULL;
    }
    made->requirement = Py_NewRef(requirement);
    made->number = number;
    made->kind = Py_NewRef((PyObject *)f->robustness);
    made->t = x->t;
    made->low = x->low;
    made->high = x->high;
    made->kept = x->kept;
    made->in_doubt = (char)(x->in_doubt != 0U);
    return (PyObject *)made;
}
