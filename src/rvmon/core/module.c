/* rvmon.core._core for CPython. */
#include "python_abi.h"

#ifndef RVMON_SOURCE_HASH
#define RVMON_SOURCE_HASH "" /* compiled by hand */
#endif

static int execute(PyObject *module)
{
    return PyModule_AddStringConstant(module, "source_hash", RVMON_SOURCE_HASH);
}

static PyModuleDef_Slot slots[] = {{Py_mod_exec, RVMON_SLOT(execute)}, {0, NULL}};
static PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "_core", NULL, 0, NULL, slots, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__core(void);
PyMODINIT_FUNC PyInit__core(void)
{
    return PyModuleDef_Init(&definition);
}
