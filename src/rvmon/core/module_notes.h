/* How module.c gives out notes: as bytes, which attempts share. Included there alone.
 *
 * What is given out outlives the monitor: nothing of it is the core's memory. A piece of letters becomes
 * bytes once it is full, and hangs on to them; of the last one there are bytes for each length at which
 * it was asked for. */
#ifndef RVMON_MODULE_NOTES_H
#define RVMON_MODULE_NOTES_H

#include "core.h"
#include "python_abi.h"

typedef struct {
    PyObject *standing;        /* what was given out last */
    int64_t standing_place;
    PyObject **dropped;        /* what pieces hung on to that are gone */
    size_t dropped_count;
    size_t dropped_room;
} note_cache;

/* A piece is gone, which may be while other threads of Python run. */
static void note_dropped(void *user, void *held)
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

static void free_dropped(note_cache *cache)
{
    while (cache->dropped_count > 0) {
        cache->dropped_count--;
        Py_DECREF(cache->dropped[cache->dropped_count]);
    }
}

/* Forget what was given out last: its place may be another's next. */
static void forget_standing(note_cache *cache)
{
    Py_CLEAR(cache->standing);
    free_dropped(cache);
}

static PyObject *bytes_of_words(const int64_t *words, int64_t count)
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
static bool letters_of(const rv_note *note, PyObject **pieces, PyObject **last)
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

/* What an attempt keeps, of which values that it captured are a part: (captured, note, standing, pieces,
 * last piece). The reference to `captured` is taken over. */
static PyObject *noted_with(note_cache *cache, const rv_monitor *m, const rv_record *record,
                            PyObject *captured)
{
    rv_note note;
    PyObject *words = NULL;
    PyObject *pieces = NULL;
    PyObject *last = NULL;
    PyObject *made = NULL;
    if ((captured == NULL) || !rv_note_of(m, record, &note)) {
        return captured;
    }
    if (note.standing == NULL) {
        forget_standing(cache);
        cache->standing_place = -1;
    } else if ((cache->standing == NULL) || (cache->standing_place != note.words[1])) {
        forget_standing(cache);
        cache->standing = bytes_of_words(note.standing, note.standing_count);
        cache->standing_place = note.words[1];
    } else {
        /* It is the one before. */
    }
    if ((note.standing == NULL) || (cache->standing != NULL)) {
        words = bytes_of_words(note.words, note.count);
        if ((words != NULL) && letters_of(&note, &pieces, &last)) {
            made = PyTuple_Pack(5, captured, words,
                                (cache->standing != NULL) ? cache->standing : Py_None, pieces, last);
        }
    }
    Py_XDECREF(words);
    Py_XDECREF(pieces);
    Py_XDECREF(last);
    Py_DECREF(captured);
    return made;
}

#endif
