/* How module.c gives out notes.
 *
 * What is given out outlives the monitor: nothing of it is the core's memory. An attempt has a copy of
 * its words, which become bytes when someone asks. A piece of letters, which attempts share, becomes bytes
 * once it is full, and hangs on to them; of the last one there are bytes for each length at which it was
 * asked for. */
#include "python/module.h"

/* A piece is gone, which may be while other threads of Python run. */
void note_dropped(void *user, void *held)
{
    note_cache *cache = (note_cache *)user;
    if (cache->dropped_count == cache->dropped_room) {
        const size_t room = (cache->dropped_room > 0) ? 2 * cache->dropped_room : 64;
        PyObject **made = realloc(cache->dropped, room * sizeof *made);
        if (made == NULL) {
            return; /* better than to free it here */
        }
        cache->dropped = made;
        cache->dropped_room = room;
    }
    cache->dropped[cache->dropped_count] = (PyObject *)held;
    cache->dropped_count++;
}

void free_dropped(note_cache *cache)
{
    while (cache->dropped_count > 0) {
        cache->dropped_count--;
        Py_DECREF(cache->dropped[cache->dropped_count]);
    }
}

PyObject *bytes_of_words(const int64_t *words, int64_t count)
{
    return PyBytes_FromStringAndSize((const char *)words, (Py_ssize_t)count * (Py_ssize_t)sizeof *words);
}

/* The first words of a piece; it hangs on to them. */
static PyObject *bytes_of_piece(rv_piece *piece, int32_t count)
{
    PyObject **held = (PyObject **)rv_piece_held(piece, 0);
    if ((*held == NULL) || (PyBytes_Size(*held) != (Py_ssize_t)count * (Py_ssize_t)sizeof(int64_t))) {
        int32_t all;
        PyObject *made = bytes_of_words(rv_piece_words(piece, &all), count);
        if (made == NULL) {
            return NULL;
        }
        Py_XDECREF(*held);
        *held = made;
    }
    return Py_NewRef(*held);
}

/* The pieces of a note but for the last one, as a tuple, on which that one hangs. */
static PyObject *pieces_of(const rv_note *note)
{
    PyObject **held = (PyObject **)rv_piece_held(note->last, 1);
    PyObject *first;
    PyObject *made;
    rv_piece *one = note->first;
    Py_ssize_t count = 0;
    Py_ssize_t i;
    int32_t words;
    if (note->first == note->last) {
        return PyTuple_New(0);
    }
    (void)rv_piece_words(note->first, &words);
    first = bytes_of_piece(note->first, words);
    if (first == NULL) {
        return NULL;
    }
    if ((*held != NULL) && (PyTuple_GetItem(*held, 0) == first)) {
        Py_DECREF(first);
        return Py_NewRef(*held);
    }
    Py_DECREF(first);
    while (one != note->last) {
        one = rv_piece_next(one);
        count++;
    }
    made = PyTuple_New(count);
    one = note->first;
    for (i = 0; (made != NULL) && (i < count); i++) {
        PyObject *own;
        (void)rv_piece_words(one, &words);
        own = bytes_of_piece(one, words);
        if ((own == NULL) || (PyTuple_SetItem(made, i, own) < 0)) {
            Py_CLEAR(made);
        }
        one = rv_piece_next(one);
    }
    if (made != NULL) {
        Py_XDECREF(*held);
        *held = Py_NewRef(made);
    }
    return made;
}

/* The letters of a note: all pieces but for the last one, that one; both None if there are none. */
bool letters_of(const rv_note *note, PyObject **pieces, PyObject **last)
{
    if (note->first == NULL) {
        *pieces = Py_NewRef(Py_None);
        *last = Py_NewRef(Py_None);
        return true;
    }
    *pieces = pieces_of(note);
    *last = bytes_of_piece(note->last, note->last_count);
    return (*pieces != NULL) && (*last != NULL);
}

/* Copy the note of a record; false with an error. */
bool copy_note(note_copy *to, const rv_monitor *m, const rv_record *record)
{
    rv_note note;
    if (!rv_note_of(m, record, &note)) {
        return true;
    }
    to->words = PyMem_Malloc((size_t)(note.count + note.state_count) * sizeof *to->words);
    if (to->words == NULL) {
        (void)PyErr_NoMemory();
        return false;
    }
    to->count = (int32_t)note.count;
    to->state_count = (int32_t)note.state_count;
    (void)memcpy(to->words, note.words, (size_t)note.count * sizeof *to->words);
    if (note.state_count > 0) {
        (void)memcpy(&to->words[note.count], note.state,
                     (size_t)note.state_count * sizeof *to->words);
    }
    return (note.first == NULL) || letters_of(&note, &to->pieces, &to->last);
}

void free_note(note_copy *note)
{
    PyMem_Free(note->words);
    note->words = NULL;
    Py_CLEAR(note->pieces);
    Py_CLEAR(note->last);
}

/* The values that an attempt captured, or None; with a note (values, note, state, pieces, last
 * piece), None for what there is not. */
PyObject *noted_with(const note_copy *note, PyObject *values)
{
    PyObject *words;
    PyObject *state;
    PyObject *made = NULL;
    if (note->words == NULL) {
        return Py_NewRef(values);
    }
    words = bytes_of_words(note->words, note->count);
    state = (note->state_count > 0)
        ? bytes_of_words(&note->words[note->count], note->state_count) : Py_NewRef(Py_None);
    if ((words != NULL) && (state != NULL)) {
        made = PyTuple_Pack(5, values, words, state,
                            (note->pieces != NULL) ? note->pieces : Py_None,
                            (note->last != NULL) ? note->last : Py_None);
    }
    Py_XDECREF(words);
    Py_XDECREF(state);
    return made;
}

