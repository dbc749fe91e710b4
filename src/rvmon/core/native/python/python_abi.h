/* CPython as module.c sees it: <Python.h> or, where that is missing (a bare Debian has Python without
   headers), own declarations of the part of the stable ABI of 3.11 that is used.

   With RVMON_OWN_PYTHON_H defined, the declarations below are used. Their layouts are fixed by the
   stable ABI for all later versions of Python 3 with a GIL; a free-threaded build has another layout
   of objects and needs the real header. tests/rvmon/native/test_build.py compares each line below with
   the real header, so additions must follow the form of the lines around them. */
#ifndef RVMON_PYTHON_ABI_H
#define RVMON_PYTHON_ABI_H

#ifndef PY_SSIZE_T_CLEAN
#define PY_SSIZE_T_CLEAN
#endif

#ifndef RVMON_OWN_PYTHON_H

#include <Python.h>
#include <structmember.h>

#endif

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef RVMON_OWN_PYTHON_H

/* Structures: one field a line. */

typedef struct _typeobject PyTypeObject;

typedef struct _object {
    ptrdiff_t ob_refcnt;
    PyTypeObject *ob_type;
} PyObject;

#endif
#if defined(RVMON_OWN_PYTHON_H) || defined(RVMON_COMPARE_PYTHON_H)

/* Types that are names for others. */

typedef ptrdiff_t Py_ssize_t;
typedef struct _longobject PyLongObject;
typedef struct _ts PyThreadState;
typedef PyObject *(*PyCFunction)(PyObject *, PyObject *);
typedef int (*inquiry)(PyObject *);
typedef int (*visitproc)(PyObject *, void *);
typedef int (*traverseproc)(PyObject *, visitproc, void *);
typedef void (*freefunc)(void *);
typedef PyObject *(*getter)(PyObject *, void *);
typedef int (*setter)(PyObject *, PyObject *, void *);

#endif
#ifdef RVMON_OWN_PYTHON_H

typedef struct PyMethodDef {
    const char *ml_name;
    PyCFunction ml_meth;
    int ml_flags;
    const char *ml_doc;
} PyMethodDef;

typedef struct PyMemberDef {
    const char *name;
    int type;
    Py_ssize_t offset;
    int flags;
    const char *doc;
} PyMemberDef;

typedef struct PyGetSetDef {
    const char *name;
    getter get;
    setter set;
    const char *doc;
    void *closure;
} PyGetSetDef;

typedef struct PyType_Slot {
    int slot;
    void *pfunc;
} PyType_Slot;

typedef struct PyType_Spec {
    const char *name;
    int basicsize;
    int itemsize;
    unsigned int flags;
    PyType_Slot *slots;
} PyType_Spec;

typedef struct PyModuleDef_Slot {
    int slot;
    void *value;
} PyModuleDef_Slot;

typedef struct PyModuleDef_Base {
    PyObject ob_base;
    PyObject *(*m_init)(void);
    Py_ssize_t m_index;
    PyObject *m_copy;
} PyModuleDef_Base;

typedef struct PyModuleDef {
    PyModuleDef_Base m_base;
    const char *m_name;
    const char *m_doc;
    Py_ssize_t m_size;
    PyMethodDef *m_methods;
    PyModuleDef_Slot *m_slots;
    traverseproc m_traverse;
    inquiry m_clear;
    freefunc m_free;
} PyModuleDef;

typedef struct bufferinfo {
    void *buf;
    PyObject *obj;
    Py_ssize_t len;
    Py_ssize_t itemsize;
    int readonly;
    int ndim;
    char *format;
    Py_ssize_t *shape;
    Py_ssize_t *strides;
    Py_ssize_t *suboffsets;
    void *internal;
} Py_buffer;

/* Constants: values only. */

#define METH_VARARGS 0x0001
#define METH_KEYWORDS 0x0002
#define METH_NOARGS 0x0004
#define METH_O 0x0008
#define METH_FASTCALL 0x0080

#define Py_mod_exec 2

#define T_DOUBLE 4
#define T_BOOL 14
#define T_OBJECT_EX 16
#define T_LONGLONG 17

#define Py_tp_base 48
#define Py_tp_clear 51
#define Py_tp_dealloc 52
#define Py_tp_methods 64
#define Py_tp_new 65
#define Py_tp_traverse 71
#define Py_tp_members 72
#define Py_tp_getset 73

#define Py_TPFLAGS_DEFAULT 0UL
#define Py_TPFLAGS_IMMUTABLETYPE (1UL << 8)
#define Py_TPFLAGS_BASETYPE (1UL << 10)
#define Py_TPFLAGS_HAVE_GC (1UL << 14)

#define PyBUF_SIMPLE 0

#endif
#if defined(RVMON_OWN_PYTHON_H) || defined(RVMON_COMPARE_PYTHON_H)

/* Objects, then functions, one per line. A name for which the real header also has a macro is in
   parentheses. */

extern PyObject _Py_NoneStruct;
extern PyLongObject _Py_FalseStruct;
extern PyLongObject _Py_TrueStruct;
extern PyObject *PyExc_AttributeError;
extern PyObject *PyExc_RuntimeError;
extern PyObject *PyExc_TypeError;
extern PyObject *PyExc_ValueError;
extern PyTypeObject PyBytes_Type;
extern PyTypeObject PyDict_Type;
extern PyTypeObject PyFloat_Type;
extern PyTypeObject PyLong_Type;
extern PyTypeObject PyTuple_Type;
extern PyTypeObject PyType_Type;
extern PyTypeObject PyUnicode_Type;

int _PyArg_ParseTuple_SizeT(PyObject *, const char *, ...);
PyObject *_Py_BuildValue_SizeT(const char *, ...);
void Py_IncRef(PyObject *);
void Py_DecRef(PyObject *);

void PyErr_Clear(void);
PyObject *PyErr_Format(PyObject *, const char *, ...);
PyObject *PyErr_NoMemory(void);
PyObject *PyErr_Occurred(void);
void PyErr_SetString(PyObject *, const char *);

void PyEval_RestoreThread(PyThreadState *);
PyThreadState *PyEval_SaveThread(void);

void *PyMem_Calloc(size_t, size_t);
void PyMem_Free(void *);
void *PyMem_Malloc(size_t);
void *PyMem_Realloc(void *, size_t);

int PyModule_AddObjectRef(PyObject *, const char *, PyObject *);
int PyModule_AddStringConstant(PyObject *, const char *, const char *);
PyObject *PyModuleDef_Init(PyModuleDef *);

PyObject *PyType_FromModuleAndSpec(PyObject *, PyType_Spec *, PyObject *);
PyObject *PyType_GenericAlloc(PyTypeObject *, Py_ssize_t);
PyObject *_PyObject_GC_New(PyTypeObject *);
unsigned long PyType_GetFlags(PyTypeObject *);
void *PyType_GetSlot(PyTypeObject *, int);
int PyType_IsSubtype(PyTypeObject *, PyTypeObject *);

PyObject *PyObject_Call(PyObject *, PyObject *, PyObject *);
PyObject *PyObject_CallMethod(PyObject *, const char *, const char *, ...);
void PyObject_Free(void *);
void PyObject_GC_Del(void *);
void PyObject_GC_UnTrack(void *);
int PyObject_SetAttrString(PyObject *, const char *, PyObject *);
int PyObject_GetBuffer(PyObject *, Py_buffer *, int);
void PyBuffer_Release(Py_buffer *);

char *PyBytes_AsString(PyObject *);
PyObject *PyBytes_FromStringAndSize(const char *, Py_ssize_t);
Py_ssize_t PyBytes_Size(PyObject *);

PyObject *PyDict_GetItemWithError(PyObject *, PyObject *);
PyObject *PyDict_New(void);
int PyDict_Next(PyObject *, Py_ssize_t *, PyObject **, PyObject **);
int PyDict_SetItem(PyObject *, PyObject *, PyObject *);

double PyFloat_AsDouble(PyObject *);
PyObject *PyFloat_FromDouble(double);

int PyList_Append(PyObject *, PyObject *);
PyObject *PyList_New(Py_ssize_t);

long PyLong_AsLong(PyObject *);
long long PyLong_AsLongLong(PyObject *);
long long PyLong_AsLongLongAndOverflow(PyObject *, int *);
PyObject *PyBool_FromLong(long);
PyObject *PyLong_FromLongLong(long long);
PyObject *PyLong_FromUnsignedLong(unsigned long);

double PyOS_string_to_double(const char *, char **, PyObject *);

PyObject *PySequence_Tuple(PyObject *);

PyObject *PyTuple_GetItem(PyObject *, Py_ssize_t);
PyObject *PyTuple_New(Py_ssize_t);
PyObject *PyTuple_Pack(Py_ssize_t, ...);
int PyTuple_SetItem(PyObject *, Py_ssize_t, PyObject *);
Py_ssize_t PyTuple_Size(PyObject *);
PyObject *PyUnicode_FromString(const char *);

#endif
#ifdef RVMON_OWN_PYTHON_H

/* Macros over these declarations. Reference counts change by function calls, not in place, so that
   immortal objects (3.12 and later) are left alone. */

#if defined(__GNUC__) || defined(__clang__)
#define PyMODINIT_FUNC __attribute__((visibility("default"))) PyObject *
#else
#define PyMODINIT_FUNC PyObject *
#endif

#define PyArg_ParseTuple _PyArg_ParseTuple_SizeT
#define Py_BuildValue _Py_BuildValue_SizeT

#define PyObject_HEAD PyObject ob_base;
#define PyModuleDef_HEAD_INIT {{1, NULL}, NULL, 0, NULL}

#define Py_None (&_Py_NoneStruct)
#define Py_False ((PyObject *)&_Py_FalseStruct)
#define Py_True ((PyObject *)&_Py_TrueStruct)

#define Py_TYPE(object) (((PyObject *)(object))->ob_type)
#define Py_IS_TYPE(object, type) (Py_TYPE(object) == (type))
#define PyObject_TypeCheck(object, type) \
    (Py_IS_TYPE(object, type) || PyType_IsSubtype(Py_TYPE(object), (type)))

#define PyDict_CheckExact(object) Py_IS_TYPE(object, &PyDict_Type)
#define PyFloat_Check(object) PyObject_TypeCheck(object, &PyFloat_Type)
#define PyFloat_CheckExact(object) Py_IS_TYPE(object, &PyFloat_Type)
#define PyLong_CheckExact(object) Py_IS_TYPE(object, &PyLong_Type)
#define PyTuple_CheckExact(object) Py_IS_TYPE(object, &PyTuple_Type)
#define PyUnicode_CheckExact(object) Py_IS_TYPE(object, &PyUnicode_Type)

#define Py_INCREF(object) Py_IncRef((PyObject *)(object))
#define Py_DECREF(object) Py_DecRef((PyObject *)(object))
#define Py_XDECREF Py_DECREF
#define Py_CLEAR(object)                           \
    do {                                           \
        PyObject *cleared_ = (PyObject *)(object); \
        (object) = NULL;                           \
        Py_XDECREF(cleared_);                      \
    } while (0)
#define Py_VISIT(object)                                          \
    do {                                                          \
        if (object) {                                             \
            const int visited_ = visit((PyObject *)(object), arg); \
            if (visited_) return visited_;                        \
        }                                                         \
    } while (0)

static inline PyObject *rvmon_new_reference(PyObject *object)
{
    Py_IncRef(object);
    return object;
}
#define Py_NewRef(object) rvmon_new_reference((PyObject *)(object))

#define Py_BEGIN_ALLOW_THREADS \
    {                          \
        PyThreadState *save_ = PyEval_SaveThread();
#define Py_END_ALLOW_THREADS     \
        PyEval_RestoreThread(save_); \
    }

#endif

/* A function as the value of a slot: ISO C has no direct conversion from functions to `void *`. */
#define RVMON_SLOT(function) ((void *)(uintptr_t)(function))

/* A module with functions, which `execute` completes; it does not need the GIL. */
#ifdef Py_GIL_DISABLED
#define RVMON_WITHOUT_GIL {Py_mod_gil, Py_MOD_GIL_NOT_USED},
#else
#define RVMON_WITHOUT_GIL
#endif
#define RVMON_MODULE(name, functions, execute)                                      \
    static PyModuleDef_Slot module_slots[] = {                                      \
        {Py_mod_exec, RVMON_SLOT(execute)}, RVMON_WITHOUT_GIL{0, NULL},             \
    };                                                                              \
    static PyModuleDef module_definition = {                                        \
        PyModuleDef_HEAD_INIT, #name, NULL, 0, functions, module_slots, NULL, NULL, NULL, \
    };                                                                              \
    PyMODINIT_FUNC PyInit_##name(void);                                             \
    PyMODINIT_FUNC PyInit_##name(void)                                              \
    {                                                                               \
        return PyModuleDef_Init(&module_definition);                                \
    }

/* Where only one thread runs at a time anyway, a critical section is a plain block. */
#ifndef Py_BEGIN_CRITICAL_SECTION
#define Py_BEGIN_CRITICAL_SECTION(object) {
#define Py_END_CRITICAL_SECTION() }
#endif

#endif
