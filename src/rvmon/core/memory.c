/* Memory of a monitor: blocks of a few sizes out of chunks, all given back at once.
 *
 * So nothing can leak, a monitor in one block of a microcontroller works as one with a heap does, and
 * blocks that were given back serve again. */
#include "calls.h"

#include <string.h>

#define ALIGNMENT ((size_t)16)
#define CHUNK_SIZE ((size_t)16384)
#define CHUNK_HEAD ((sizeof(chunk) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT)

/* The class of a size, of which there are four from one power of two to the next; `size` becomes
 * that of the class. */
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

static bool add_chunk(arena *a, size_t size)
{
    size_t room = (size > CHUNK_SIZE) ? size : CHUNK_SIZE;
    char *made = NULL;
    chunk *head;
    if (a->from.allocate == NULL) {
        return false;
    }
    room += CHUNK_HEAD;
    made = a->from.allocate(room);
    if (made == NULL) {
        return false;
    }
    head = (chunk *)(void *)made;
    head->next = a->chunks;
    a->chunks = head;
    a->free = made + CHUNK_HEAD;
    a->left = room - CHUNK_HEAD;
    return true;
}

/* A block with whatever was in it; `size` becomes how large it is. */
static void *take_as_it_is(arena *a, size_t *size)
{
    size_t room = *size;
    size_t class;
    void *made;
    if (room > SIZE_MAX / 4) { /* beyond, sums of sizes could wrap */
        return NULL;
    }
    class = class_of(&room);
    made = a->spare[class];
    if (made != NULL) {
        (void)memcpy(&a->spare[class], made, sizeof made);
    } else {
        if ((a->left < room) && !add_chunk(a, room)) {
            return NULL;
        }
        made = a->free;
        a->free += room;
        a->left -= room;
        a->used += room;
    }
    *size = room;
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
    (void)memcpy(block, &a->spare[class], sizeof block);
    a->spare[class] = block;
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
    const size_t filled = (size_t)*room * each;
    int64_t more = 2 * (int64_t)*room;
    size_t size;
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
    size = (size_t)more * each;
    made = take_as_it_is(&m->memory, &size);
    if (made == NULL) {
        m->spoilt = true;
        return NULL;
    }
    if (old != NULL) {
        (void)memcpy(made, old, filled);
        arena_give(&m->memory, old, filled);
    }
    *room = (int32_t)more;
    return made;
}

void *grown(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each)
{
    const size_t filled = (size_t)*room * each;
    char *made = widened(m, old, room, wanted, each);
    if ((made != NULL) && (made != old)) {
        (void)memset(made + filled, 0, (size_t)*room * each - filled);
    }
    return made;
}
