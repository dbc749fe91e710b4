/* Runs the commands on the standard input with the exported core and plans; see exported.py.
 *
 * Arguments of calls are copied and freed after the call, so that a sanitizer sees a core that keeps a
 * pointer to them. */
#include "plans.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST 256

/* Allocations that a limited heap still grants; negative: no limit. */
static int64_t left = -1;

static void *resize(void *block, size_t size)
{
    if (left == 0) {
        return NULL;
    }
    left -= (left > 0) ? 1 : 0;
    return realloc(block, size);
}

static void *allocate(size_t size)
{
    return resize(NULL, size);
}

static void *copied(const void *from, size_t size)
{
    void *made = malloc(size + 1);
    (void)memcpy(made, from, size);
    return made;
}

static rv_number read_number(void)
{
    rv_number made = {RV_UNKNOWN, {0}};
    if (scanf("%" SCNd32 " %" SCNx64, &made.kind, (uint64_t *)&made.as.whole) != 2) {
        exit(2);
    }
    return made;
}

/* Read all words of a note and all letters it refers to, for the sanitizer. */
static void read_note(const rv_monitor *m, const rv_record *record)
{
    rv_note note;
    if (rv_note_of(m, record, &note)) {
        const rv_piece *piece = note.first;
        volatile int64_t sum = 0;
        int64_t i;
        for (i = 0; i < note.count; i++) {
            sum = sum ^ note.words[i];
        }
        for (i = 0; i < note.state_count; i++) {
            sum = sum ^ note.state[i];
        }
        while (piece != NULL) {
            int32_t count;
            const int64_t *words = rv_piece_words(piece, &count);
            count = (piece == note.last) ? note.last_count : count;
            for (i = 0; i < count; i++) {
                sum = sum ^ words[i];
            }
            piece = (piece == note.last) ? NULL : rv_piece_next(piece);
        }
    }
}

static bool read_open(void *user, const rv_record *record, const rv_number *captured)
{
    (void)captured;
    read_note((const rv_monitor *)user, record);
    return true;
}

static void tell(const rv_monitor *m)
{
    const rv_record *records;
    const int64_t count = rv_records(m, &records);
    int64_t i;
    int32_t k;
    for (i = 0; i < count; i++) {
        const rv_record *one = &records[i];
        const rv_number *captured = rv_captured(m, one);
        read_note(m, one);
        printf("r %" PRId64 " %" PRId64 " %" PRId32 " %" PRIu32 " %d %d %d", one->triggered,
               one->decided, one->requirement, one->number, one->verdict, one->decision, one->in_doubt);
        for (k = 0; (captured != NULL) && (k < rv_captured_of(m, one->requirement)); k++) {
            if (captured[k].kind != RV_UNKNOWN) {
                printf(" %d:%" PRIx64, (int)captured[k].kind, (uint64_t)captured[k].as.whole);
            }
        }
        printf("\n");
    }
}

int main(void)
{
    static rv_update updates[MOST];
    static rv_number fields[MOST];
    rv_monitor *m = NULL;
    void *block = NULL;
    int32_t count = 0;
    int32_t fields_count = 0;
    int64_t t;
    char what;
    bool noting = false;
    while (scanf(" %c %" SCNd64, &what, &t) == 2) {
        int code = RV_OK;
        if (what == 'c') { /* plan and size of the block; -1: heap; -2 - n: heap of n allocations */
            rv_memory memory = {allocate, resize, free, NULL, 0};
            int64_t size;
            if (scanf("%" SCNd64, &size) != 1) {
                return 2;
            }
            left = (size < -1) ? -2 - size : -1;
            if (size >= 0) {
                memory.allocate = NULL;
                memory.release = NULL;
                memory.block = block = malloc((size_t)size + 1);
                memory.size = (size_t)size;
            }
            m = rv_new(plans[t].bytes, plans[t].size, memory);
            printf("%s\n", (m == NULL) ? "none" : "begun");
        } else if (m == NULL) {
            /* No monitor: skip the rest of the case. */
            int32_t says;
            if (((what == 'u') && (scanf("%" SCNd32, &says) == 1)) || (what == 'f')) {
                (void)read_number();
            }
        } else if (what == 'a') {
            rv_set_absent(m, (int32_t)t);
        } else if (what == 'r') { /* a limited heap grants all again */
            left = -1;
            code = rv_reset(m);
        } else if (what == 'n') {
            code = rv_keep_notes(m, NULL, NULL);
            noting = code == RV_OK;
        } else if (what == 'm') {
            code = rv_reserve(m, (int32_t)t);
        } else if (what == 'u') {
            rv_update *one = &updates[count++];
            one->name = (int32_t)t;
            one->fields = NULL;
            if (scanf("%" SCNd32, &one->says) != 1) {
                return 2;
            }
            one->value = read_number();
        } else if (what == 'f') { /* a field of the last update: place and value */
            fields[fields_count] = read_number();
            if (t == 0) {
                updates[count - 1].fields = &fields[fields_count];
            }
            fields_count++;
        } else if (what == 's') {
            rv_number *own_fields = copied(fields, (size_t)fields_count * sizeof *fields);
            rv_update *own = copied(updates, (size_t)count * sizeof *updates);
            int32_t i;
            for (i = 0; i < count; i++) {
                if (own[i].fields != NULL) {
                    own[i].fields = own_fields + (updates[i].fields - fields);
                }
            }
            code = rv_step(m, t, own, count);
            if (noting) {
                rv_each_open(m, read_open, m);
            }
            free(own);
            free(own_fields);
            count = 0;
            fields_count = 0;
        } else if (what == 'w') {
            code = rv_advance(m, t);
        } else if (what == 'd') {
            (void)rv_next_due(m);
        } else if (what == 'e') {
            code = rv_finish(m, t);
        } else if (what == 'z') {
            rv_free(m);
            m = NULL;
            noting = false;
        } else {
            return 2;
        }
        if ((m != NULL) && (what != 'c')) {
            if (code != RV_OK) {
                printf("x %d\n", code);
            }
            tell(m);
            rv_forget_records(m);
        }
        if ((m != NULL) && (what == 'e')) { /* whether memory ran out, verdicts, bytes used */
            int32_t i;
            printf("e %d", rv_spoilt(m) ? 1 : 0);
            for (i = 0; i < rv_sizes_of(m).requirements; i++) {
                printf(" %d", rv_verdict(m, i));
            }
            printf(" %zu\n", rv_memory_used(m));
        }
        if (what == 'z') {
            free(block);
            block = NULL;
            printf(".\n");
        }
    }
    return 0;
}
