/* The allocator of a monitor: an arena of chunks from which blocks of a few sizes are cut. A block that
 * is given back goes to a list of its size class and is reused for the next block of that class; chunks
 * are returned only when the monitor ends. So a monitor cannot leak, and works the same way on a heap
 * and in one block of a microcontroller.
 *
 * Sizes are rounded up to four classes per power of two, which wastes at most a fifth. On a heap a
 * block larger than a chunk gets a chunk of its own, so that growing it is a realloc. Giving and
 * taking cost O(1). */
#include "basics.h"

#include <string.h>

#define ALIGNMENT ((size_t)16)
#ifndef CHUNK_SIZE /* with a tiny one, each block is an allocation of its own, which tests let fail */
#define CHUNK_SIZE ((size_t)16384)
#endif
#define CHUNK_HEAD ((sizeof(chunk) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT)

/* The class of a size, and, in `size`, the size of that class. In units of 16 bytes: 1 to 7 are
 * classes of their own; above, the three highest bits name the class (4 to 7 times a power of two)
 * and the rest is rounded up. */
static size_t class_of(size_t *size)
{
    size_t units = (*size + ALIGNMENT - 1) / ALIGNMENT;
    size_t octave = 0;
    if (units < 1) {
        units = 1;
    }
    while ((units >> octave) >= 8) {
        octave++;
    }
    if (octave > 0) {
        const size_t low = ((size_t)1 << octave) - 1;
        units = (units + low) & ~low;
        if ((units >> octave) >= 8) {
            octave++;
        }
    }
    *size = units * ALIGNMENT;
    return octave * 4 + (units >> octave);
}

/* Set the links to a chunk, and from the next one back to it: after realloc they are out of date. */
static void hook(chunk *one)
{
    *one->link = one;
    if (one->next != NULL) {
        one->next->link = &one->next;
    }
}

/* Add a chunk with `room` bytes after its head; returns their address, or NULL: memory is short. */
static char *add_chunk(arena *a, size_t room)
{
    chunk *made = (a->from.allocate != NULL) ? a->from.allocate(CHUNK_HEAD + room) : NULL;
    if (made == NULL) {
        return NULL;
    }
    made->next = a->chunks;
    made->link = &a->chunks;
    hook(made);
    return (char *)made + CHUNK_HEAD;
}

/* Whether a block of this size is a chunk of its own, which can be resized. */
static bool has_own_chunk(const arena *a, size_t room)
{
    return (room > CHUNK_SIZE) && (a->from.allocate != NULL);
}

/* A block with unspecified content; `size` becomes its real size. NULL: memory is short. */
static void *take_as_it_is(arena *a, size_t *size)
{
    size_t room = *size;
    size_t class;
    char *made;
    if (room > SIZE_MAX / 4) { /* beyond that, sums of sizes could wrap around */
        return NULL;
    }
    class = class_of(&room);
    *size = room;
    made = a->spare[class];
    if (made != NULL) {
        (void)memcpy(&a->spare[class], made, sizeof(void *));
        return made;
    }
    if (has_own_chunk(a, room)) {
        made = add_chunk(a, room);
        a->used += (made != NULL) ? room : 0;
        return made;
    }
    if (a->left < room) { /* the rest of the current chunk, less than 16 KiB, is abandoned */
        made = add_chunk(a, CHUNK_SIZE);
        if (made == NULL) {
            return NULL;
        }
        a->free = made;
        a->left = CHUNK_SIZE;
    }
    made = a->free;
    a->free += room;
    a->left -= room;
    a->used += room;
    return made;
}

void *arena_enlarge(arena *a, void *old, size_t size, size_t wanted)
{
    size_t was = size;
    size_t room = wanted;
    void *made;
    (void)class_of(&was);
    if ((old != NULL) && has_own_chunk(a, was) && (wanted <= SIZE_MAX / 4)) {
        chunk *head = (chunk *)(void *)((char *)old - CHUNK_HEAD);
        (void)class_of(&room);
        head = a->from.resize(head, CHUNK_HEAD + room);
        if (head == NULL) {
            return NULL;
        }
        hook(head);
        a->used += room - was;
        return (char *)head + CHUNK_HEAD;
    }
    made = take_as_it_is(a, &room);
    if ((made != NULL) && (old != NULL)) {
        (void)memcpy(made, old, size);
        arena_give(a, old, size);
    }
    return made;
}

void *arena_take(arena *a, size_t size)
{
    size_t room = size;
    void *made = take_as_it_is(a, &room);
    return (made != NULL) ? memset(made, 0, room) : NULL;
}

void arena_give(arena *a, void *block, size_t size)
{
    size_t room = size;
    size_t class;
    if (block == NULL) {
        return;
    }
    class = class_of(&room);
    (void)memcpy(block, &a->spare[class], sizeof block); /* a spare block starts with the link */
    a->spare[class] = block;
}

void arena_move(arena *to, const arena *from)
{
    *to = *from;
    if (to->chunks != NULL) {
        to->chunks->link = &to->chunks;
    }
}

void arena_release(arena *a)
{
    chunk *one = a->chunks;
    while (one != NULL) {
        chunk *next = one->next;
        a->from.release(one);
        one = next;
    }
    a->chunks = NULL;
    a->free = NULL;
    a->left = 0;
}

void *widened(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each)
{
    int64_t more = 2 * (int64_t)*room;
    void *made;
    if (wanted <= *room) {
        return old;
    }
    more = (more < 4) ? 4 : more;
    more = (more < wanted) ? wanted : more;
    if ((more >= INT32_MAX / 2) || ((size_t)more > SIZE_MAX / 4 / each)) { /* sizes could wrap */
        m->spoilt = true;
        return NULL;
    }
    made = arena_enlarge(&m->memory, old, (size_t)*room * each, (size_t)more * each);
    if (made == NULL) {
        m->spoilt = true;
        return NULL;
    }
    *room = (int32_t)more;
    return made;
}

void *enlarged(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each)
{
    const int32_t was = *room;
    char *made = widened(m, old, room, wanted, each);
    if ((made != NULL) && (*room > was)) {
        (void)memset(made + (size_t)was * each, 0, (size_t)(*room - was) * each);
    }
    return made;
}
