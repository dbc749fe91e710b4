/* Storage of discrete states, packed and unique, and of symbolic states with their zones in chunks. */
#ifndef RVMON_ZONES_STATES_H
#define RVMON_ZONES_STATES_H

#include "programs.h"

/* Pack a discrete state; `mark` is what the search distinguishes in addition, such as the piece. */
static void pack(const engine *h, const spot *here, uint32_t mark,
                 uint32_t *to)
{
    const int n = h->automaton_count + h->variable_count;
    int i;
    (void)memset(to, 0, h->words * sizeof *to);
    to[h->words - 1] = mark;
    for (i = 0; i < n; i++) {
        const field f = h->fields[i];
        const int32_t x = (i < h->automaton_count) ? here->places[i]
                                                     : here->values[i - h->automaton_count];
        to[f.word] |= ((uint32_t)x - (uint32_t)f.low) << f.shift;
    }
}

static void unpack(const engine *h, uint32_t state, const spot *to)
{
    const uint32_t *from = h->bits + (size_t)state * h->words;
    const int n = h->automaton_count + h->variable_count;
    int i;
    for (i = 0; i < n; i++) {
        const field f = h->fields[i];
        const int32_t x = (int32_t)((from[f.word] >> f.shift & f.mask) + (uint32_t)f.low);
        *((i < h->automaton_count) ? to->places + i : to->values + (i - h->automaton_count)) = x;
    }
}

static uint32_t mark_of(const engine *h, uint32_t state)
{
    return h->bits[(size_t)state * h->words + h->words - 1];
}

static uint32_t hash_of(const void *data, size_t words)
{
    const uint32_t *w = data;
    uint64_t x = UINT64_C(0x9e3779b97f4a7c15);
    size_t i;
    for (i = 0; i < words; i++) {
        x ^= w[i];
        x *= UINT64_C(0xff51afd7ed558ccd);
        x ^= x >> 32;
    }
    return (uint32_t)(x ^ x >> 29);
}

/* Make room for one more entry in a table of `count`, which stays half empty; false without memory. */
static bool widen(engine *h, table *t, uint32_t count, uint32_t (*hash)(const engine *, uint32_t))
{
    table wide = {NULL, 0};
    uint32_t i;
    if (2 * ((uint64_t)count + 1) <= t->size) {
        return true;
    }
    wide.at = enlarge(h, NULL, &wide.size, (t->size == 0) ? 1024 : 2 * (uint64_t)t->size,
                      sizeof *wide.at);
    if (wide.at == NULL) {
        return false;
    }
    (void)memset(wide.at, 0xff, wide.size * sizeof *wide.at);
    for (i = 0; i < t->size; i++) {
        if (t->at[i] != NONE) {
            uint32_t k = hash(h, t->at[i]) & (wide.size - 1);
            while (wide.at[k] != NONE) {
                k = (k + 1) & (wide.size - 1);
            }
            wide.at[k] = t->at[i];
        }
    }
    give_back(h, t->at, t->size, sizeof *t->at);
    *t = wide;
    return true;
}

static uint32_t hash_state(const engine *h, uint32_t state)
{
    return hash_of(h->bits + (size_t)state * h->words, h->words);
}

/* The slot of a packed state in the table, or the empty slot for it; NULL without memory. */
static uint32_t *find_state(engine *h, const uint32_t *packed)
{
    const size_t bytes = h->words * sizeof *packed;
    const table *t = &h->met;
    uint32_t k;
    if (!widen(h, &h->met, h->state_count, hash_state)) {
        return NULL;
    }
    k = hash_of(packed, h->words) & (t->size - 1);
    while ((t->at[k] != NONE)
           && (memcmp(h->bits + (size_t)t->at[k] * h->words, packed, bytes) != 0)) {
        k = (k + 1) & (t->size - 1);
    }
    return t->at + k;
}

static bool add_state(engine *h, uint32_t *at, bool delays)
{
    const uint64_t n = (uint64_t)h->state_count + 1;
    if (!ROOM(h, h->bits, h->bits_room, n * h->words) || !ROOM(h, h->heads, h->heads_room, n)
        || !ROOM(h, h->delays, h->delays_room, n)) {
        return false;
    }
    (void)memcpy(h->bits + (size_t)h->state_count * h->words, h->packed,
                 h->words * sizeof *h->packed);
    h->heads[h->state_count] = NONE;
    h->delays[h->state_count] = delays;
    *at = h->state_count++;
    return true;
}

static bound *zone_at(const engine *h, uint32_t slot)
{
    return h->chunks[slot / ZONES_IN_CHUNK]
           + (size_t)(slot % ZONES_IN_CHUNK) * (size_t)h->entries;
}

static bound *zone_of(const engine *h, uint32_t n)
{
    return zone_at(h, h->nodes[n].zone);
}

/* A slot for a zone, or NONE without memory. Free slots hold the index of the next free one. */
static uint32_t new_slot(engine *h)
{
    uint32_t slot = h->freed;
    if (slot != NONE) {
        (void)memcpy(&h->freed, zone_at(h, slot), sizeof slot);
        return slot;
    }
    slot = h->zone_count;
    if (slot % ZONES_IN_CHUNK == 0) {
        uint32_t room = 0;
        if (!ROOM(h, h->chunks, h->chunk_room, (uint64_t)h->chunk_count + 1)) {
            return NONE;
        }
        h->chunks[h->chunk_count] = enlarge(h, NULL, &room, ZONES_IN_CHUNK, h->zone_bytes);
        if (h->chunks[h->chunk_count] == NULL) {
            return NONE;
        }
        h->chunk_count++;
    }
    h->zone_count++;
    return slot;
}

static void drop_zone(engine *h, uint32_t n)
{
    const uint32_t slot = h->nodes[n].zone;
    (void)memcpy(zone_at(h, slot), &h->freed, sizeof slot);
    h->freed = slot;
    h->nodes[n].zone = NONE;
}

/* A new symbolic state, a child of the one being expanded; NONE without memory or if its numbers are too
 * large. */
static uint32_t new_node(engine *h, uint32_t state, const bound *z)
{
    uint32_t slot;
    if (!fits(h, z) || !ROOM(h, h->nodes, h->node_room, (uint64_t)h->node_count + 1)) {
        return NONE;
    }
    slot = new_slot(h);
    if (slot == NONE) {
        return NONE;
    }
    copy_zone(h, zone_at(h, slot), z);
    h->nodes[h->node_count] = (node){h->from_node, state, NONE, slot, h->link};
    return h->node_count++;
}

static bound *push(engine *h, federation *f)
{
    if (f->count == f->room) {
        f->zones = enlarge(h, f->zones, &f->room, (uint64_t)f->count + 1, h->zone_bytes);
        if (f->count == f->room) {
            return NULL;
        }
    }
    return f->zones + (size_t)f->count++ * (size_t)h->entries;
}

static bound *nth(const engine *h, const federation *f, uint32_t k)
{
    return f->zones + (size_t)k * (size_t)h->entries;
}

static bool push_zone(engine *h, federation *f, const bound *z)
{
    bound *to = push(h, f);
    if (to != NULL) {
        copy_zone(h, to, z);
    }
    return to != NULL;
}

static void empty(engine *h, federation *f)
{
    give_back(h, f->zones, f->room, h->zone_bytes);
    *f = (federation){0, 0, NULL};
}

static void swap(federation *a, federation *b)
{
    const federation was = *a;
    *a = *b;
    *b = was;
}

/* Subtract a zone from a union: split each zone along the bounds of the other into disjoint parts. */
static bool subtract(engine *h, federation *from, const bound *other)
{
    const int d = h->dim;
    uint32_t k;
    h->rest.count = 0;
    for (k = 0; k < from->count; k++) {
        bound *left = nth(h, from, k);
        int e;
        count_work(h);
        for (e = 0; e < h->entries; e++) {
            bound *out;
            if (other[e] >= left[e]) {
                continue;
            }
            out = push(h, &h->rest);
            if (out == NULL) {
                return false;
            }
            copy_zone(h, out, left);
            if (!constrain(out, d, e % d, e / d, negated(other[e]))) {
                h->rest.count--;
            } else if (!fits(h, out)) {
                return false;
            }
            if (!constrain(left, d, e / d, e % d, other[e])) {
                break;
            }
        }
        if (!runs(h)) {
            return false;
        }
    }
    swap(from, &h->rest);
    return true;
}

static bool subtract_all(engine *h, federation *f, const federation *others)
{
    uint32_t i;
    for (i = 0; (i < others->count) && (f->count > 0); i++) {
        if (!subtract(h, f, nth(h, others, i))) {
            return false;
        }
    }
    return true;
}

/* Append a node to the queue. When the array is full, consumed entries are dropped if they fill half. */
static bool wait_for(engine *h, uint32_t n)
{
    if ((h->queue_end == h->queue_room) && (h->queue_head > h->queue_room / 2)) {
        (void)memmove(h->queue, h->queue + h->queue_head,
                      (size_t)(h->queue_end - h->queue_head) * sizeof *h->queue);
        h->queue_end -= h->queue_head;
        h->queue_head = 0;
    }
    if (!ROOM(h, h->queue, h->queue_room, (uint64_t)h->queue_end + 1)) {
        return false;
    }
    h->queue[h->queue_end++] = n;
    return true;
}

#endif
