/* Returning notes to Python. An attempt copies the words of its note, and converts them to bytes when
 * they are read. Letters are shared: each piece has a bytes object attached. For a full piece it has the
 * letters; for a growing one it has the piece's full capacity, and a last word that counts the words
 * written. An attempt knows how many of them are its own, so later letters are added without copying. */
#include "python/module.h"

/* The core freed a piece: remember its object to release it later, as Python code must not run now. */
void note_dropped(void *user, void *held)
{
    note_cache *cache = (note_cache *)user;
    if (cache->dropped_count == cache->dropped_room) {
        const size_t room = (cache->dropped_room > 0) ? 2 * cache->dropped_room : 64;
        PyObject **made = realloc(cache->dropped, room * sizeof *made);
        if (made == NULL) {
            return; /* a leak is better than running code here */
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

/* The letters of a full piece as bytes, made once. */
static PyObject *bytes_of_full(rv_piece *piece)
{
    PyObject **held = (PyObject **)rv_piece_held(piece, 0);
    int32_t count;
    const int64_t *words = rv_piece_words(piece, &count);
    if ((*held == NULL) || (PyBytes_Size(*held) != (Py_ssize_t)count * (Py_ssize_t)sizeof *words)) {
        PyObject *made = bytes_of_words(words, count);
        if (made == NULL) {
            return NULL;
        }
        Py_XDECREF(*held);
        *held = made;
    }
    return Py_NewRef(*held);
}

/* Bytes that start with at least `count` words of a growing piece. */
static PyObject *bytes_from(rv_piece *piece, int32_t count)
{
    PyObject **held = (PyObject **)rv_piece_held(piece, 0);
    const int32_t room = rv_piece_room(piece);
    const Py_ssize_t size = ((Py_ssize_t)room + 1) * (Py_ssize_t)sizeof(int64_t);
    int32_t all;
    const int64_t *words = rv_piece_words(piece, &all);
    int64_t *to;
    if (*held == NULL) {
        *held = PyBytes_FromStringAndSize(NULL, size);
        if (*held == NULL) {
            return NULL;
        }
        ((int64_t *)(void *)PyBytes_AsString(*held))[room] = 0;
    }
    if (PyBytes_Size(*held) == size) {
        to = (int64_t *)(void *)PyBytes_AsString(*held);
        for (; to[room] < count; to[room]++) {
            to[to[room]] = words[to[room]];
        }
    }
    return Py_NewRef(*held);
}

/* The first `count` words of a bytes object; the object itself if it has no more. */
static PyObject *first_words(PyObject *bytes, int32_t count)
{
    if (PyBytes_Size(bytes) == (Py_ssize_t)count * (Py_ssize_t)sizeof(int64_t)) {
        return Py_NewRef(bytes);
    }
    return bytes_of_words((const int64_t *)(const void *)PyBytes_AsString(bytes), count);
}

/* The full pieces of a note as a tuple, which stays attached to the last piece for the next note. */
static PyObject *pieces_of(const rv_note *note)
{
    PyObject **held = (PyObject **)rv_piece_held(note->last, 1);
    PyObject *first;
    PyObject *made;
    rv_piece *one = note->first;
    Py_ssize_t count = 0;
    Py_ssize_t i;
    if (note->first == note->last) {
        return PyTuple_New(0);
    }
    first = bytes_of_full(note->first);
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
        PyObject *own = bytes_of_full(one);
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

/* The letters of a note: the tuple of full pieces; bytes that start with the last piece, shared by
 * notes; and the number of words of that piece. None, None and 0 if the note has no letters. */
PyObject *letters_of(const rv_note *note)
{
    PyObject *pieces;
    PyObject *last;
    PyObject *count;
    PyObject *made = NULL;
    if (note->first == NULL) {
        pieces = Py_NewRef(Py_None);
        last = Py_NewRef(Py_None);
        count = PyLong_FromLongLong(0);
    } else {
        pieces = pieces_of(note);
        last = bytes_from(note->last, note->last_count);
        count = PyLong_FromLongLong(note->last_count);
    }
    if ((pieces != NULL) && (last != NULL) && (count != NULL)) {
        made = PyTuple_Pack(3, pieces, last, count);
    }
    Py_XDECREF(pieces);
    Py_XDECREF(last);
    Py_XDECREF(count);
    return made;
}

/* Copy the note of a record; false with an error. */
bool copy_note(attempt_record *to, const rv_monitor *m, const rv_record *record)
{
    note_copy *made = &to->note;
    rv_note note;
    if (!rv_note_of(m, record, &note)) {
        return true;
    }
    made->words = (note.count + note.state_count <= FEW_WORDS)
        ? to->few : PyMem_Malloc((size_t)(note.count + note.state_count) * sizeof *made->words);
    if (made->words == NULL) {
        (void)PyErr_NoMemory();
        return false;
    }
    made->count = (int32_t)note.count;
    made->state_count = (int32_t)note.state_count;
    (void)memcpy(made->words, note.words, (size_t)note.count * sizeof *made->words);
    if (note.state_count > 0) {
        (void)memcpy(&made->words[note.count], note.state,
                     (size_t)note.state_count * sizeof *made->words);
    }
    if (note.first == NULL) {
        return true;
    }
    made->pieces = pieces_of(&note);
    made->last = bytes_from(note.last, note.last_count);
    made->last_count = note.last_count;
    return (made->pieces != NULL) && (made->last != NULL);
}

void free_note(attempt_record *of)
{
    if (of->note.words != of->few) {
        PyMem_Free(of->note.words);
    }
    of->note.words = NULL;
    Py_CLEAR(of->note.pieces);
    Py_CLEAR(of->note.last);
}

/* The captured values, or None. With a note, a tuple (values, note, state, pieces, last piece), in which
 * missing parts are None. */
PyObject *noted_with(const note_copy *note, PyObject *values)
{
    PyObject *words;
    PyObject *state;
    PyObject *last;
    PyObject *made = NULL;
    if (note->words == NULL) {
        return Py_NewRef(values);
    }
    words = bytes_of_words(note->words, note->count);
    state = (note->state_count > 0)
        ? bytes_of_words(&note->words[note->count], note->state_count) : Py_NewRef(Py_None);
    last = (note->last != NULL) ? first_words(note->last, note->last_count) : Py_NewRef(Py_None);
    if ((words != NULL) && (state != NULL) && (last != NULL)) {
        made = PyTuple_Pack(5, values, words, state,
                            (note->pieces != NULL) ? note->pieces : Py_None, last);
    }
    Py_XDECREF(words);
    Py_XDECREF(state);
    Py_XDECREF(last);
    return made;
}

