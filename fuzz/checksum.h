/* What a monitor of the core reports besides its records, as one checksum, to compare runs. */
#ifndef RVMON_CHECKSUM_H
#define RVMON_CHECKSUM_H

#include "core.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* FNV hash of everything that is reported. */
static inline uint64_t mixed(uint64_t sum, int64_t what)
{
    return (sum ^ (uint64_t)what) * UINT64_C(0x100000001b3);
}

/* The checksum of the note of a record. */
static inline uint64_t read_note(const rv_monitor *m, const rv_record *record)
{
    rv_note note;
    uint64_t sum = 0;
    if (rv_note_of(m, record, &note)) {
        const rv_piece *piece = note.first;
        int64_t i;
        for (i = 0; i < note.count; i++) {
            sum = mixed(sum, note.words[i]);
        }
        for (i = 0; i < note.state_count; i++) {
            sum = mixed(sum, note.state[i]);
        }
        while (piece != NULL) {
            int32_t count;
            const int64_t *words = rv_piece_words(piece, &count);
            count = (piece == note.last) ? note.last_count : count;
            for (i = 0; i < count; i++) {
                sum = mixed(sum, words[i]);
            }
            piece = (piece == note.last) ? NULL : rv_piece_next(piece);
        }
    }
    return sum;
}

/* The bits of a number, the same for both zeros and for all NaN: compilers differ in their signs. */
static inline int64_t bits_of(double x)
{
    int64_t bits = 0;
    if ((x == x) && (x != 0.0)) {
        (void)memcpy(&bits, &x, sizeof bits);
    }
    return bits;
}

static inline bool note_margin(void *user, const rv_margin *one)
{
    uint64_t *sum = user;
    if (!(one->low <= one->high)) {
        (void)fprintf(stderr, "a margin whose least is above its greatest\n");
        abort();
    }
    *sum = mixed(mixed(mixed(*sum, one->t), one->number), one->requirement);
    *sum = mixed(mixed(mixed(*sum, bits_of(one->low)), bits_of(one->high)), bits_of(one->kept));
    return true;
}

static inline uint64_t noted_margins(rv_monitor *m, uint64_t sum)
{
    const rv_margin *margins;
    const int64_t count = rv_margins(m, &margins);
    uint64_t found = sum;
    int64_t i;
    for (i = 0; !rv_spoilt(m) && (i < count); i++) { /* without meaning after a lack of memory */
        (void)note_margin(&found, &margins[i]);
    }
    rv_forget_margins(m);
    return found;
}

#endif
