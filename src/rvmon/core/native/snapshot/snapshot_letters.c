/* Letters in a snapshot: the pieces of each judge, then those that notes refer to. A piece that is both
 * is written twice, and read back as two pieces. */
#include "notes/notes.h"
#include "runs/runs.h"
#include "snapshot/snapshot.h"

/* `count` words of letters of a piece, not before instant `from`; `whole`: the piece is full. Returns the
 * instant of the last letter. */
static int64_t carry_piece(carrier *c, rv_piece *piece, int32_t count, int64_t from, bool whole)
{
    const int32_t most = LETTERS_IN_PIECE * piece->stride;
    int64_t before = from;
    int32_t own = count;
    int32_t i;
    int32_t k;
    carry_int(c, &own, whole ? most : 0, (int64_t)most + 1);
    demand(c, own % piece->stride == 0);
    piece->count = c->reading ? own : piece->count;
    for (i = 0; (i < own) && !is_lost(c); i += piece->stride) {
        int64_t *one = &piece->words[i];
        carry_instant(c, &one[0]);
        demand(c, one[0] >= before);
        before = one[0];
        for (k = 1; k < piece->stride; k++) {
            carry_long(c, &one[k], INT64_MIN, INT64_MAX);
        }
        demand(c, are_truths(&one[1], piece->stride - 1));
    }
    return before;
}

/* `before` of the last piece, as a number of letters from the end, which may reach into the piece
 * before it; 0: NULL. */
static void carry_before(carrier *c, rv_piece *last, rv_piece *second)
{
    const int32_t letters = last->count / last->stride;
    const int32_t most = ((second != NULL) && (letters < 2)) ? letters + 1 : (letters < 2) ? letters : 2;
    int32_t back = 0;
    int32_t i;
    for (i = 0; i <= most; i++) {
        const int64_t *there = NULL;
        if (i > letters) {
            there = &second->words[second->count - second->stride];
        } else if (i > 0) {
            there = &last->words[last->count - i * last->stride];
        } else {
            /* There is no such letter. */
        }
        if (!c->reading && (last->before == there)) {
            back = i;
        } else if (c->reading && (i == 0)) {
            carry_int(c, &back, 0, (int64_t)most + 1);
        } else {
            /* `before` is another letter. */
        }
        if (c->reading && (back == i)) {
            last->before = there;
        }
    }
    if (!c->reading) {
        carry_int(c, &back, 0, (int64_t)most + 1);
    }
}

void carry_letters(carrier *c, noting *n, int32_t stride)
{
    int32_t count = n->pieces;
    rv_piece *one = n->first;
    rv_piece *second = NULL;
    int64_t before = -LIMIT;
    int32_t i;
    carry_size(c, &count, MOST, 5);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        second = (i > 0) ? one : NULL;
        one = c->reading ? next_piece(c->m, n, stride) : ((i > 0) ? one->next : one);
        if (one == NULL) {
            break;
        }
        before = carry_piece(c, one, one->count, before, i < count - 1);
    }
    if ((count > 0) && !is_lost(c)) {
        carry_before(c, n->last, second);
    }
}

/* The pieces that notes refer to, while they are numbered or read. */
typedef struct {
    rv_piece *piece;
    int32_t count;             /* words that notes refer to */
    int32_t next;              /* number of the following piece; -1: notes refer to none */
    int32_t chain;             /* number of the first piece of its linked list; -1: not known yet */
    int32_t index;             /* position in that list */
    bool follows;
} numbered_piece;

static void forget_numbers(rv_monitor *m)
{
    rv_piece *one;
    const run *r;
    int32_t i;
    int32_t k;
    for (one = m->left; one != NULL; one = one->next_left) {
        one->number = -1;
    }
    for (i = 0; i < m->plan.part_count; i++) {
        for (r = m->homes[i].root; r != NULL; r = following(&m->homes[i], r)) {
            for (k = 0; k < r->part->plan->judges.count; k++) {
                const noting *n = r->judges[k].noting;
                for (one = (n != NULL) ? n->first : NULL; one != NULL; one = one->next) {
                    one->number = -1;
                }
            }
        }
    }
}

/* Number the pieces that notes refer to, and put them into `places` unless NULL; returns how many. Spans
 * are taken in reverse order: for each judge the numbered pieces then end with its last span, so reaching
 * a numbered piece ends the walk. */
static int32_t number_pieces(rv_monitor *m, numbered_piece *places)
{
    int32_t count = 0;
    int32_t i;
    forget_numbers(m);
    for (i = m->span_count - 1; i >= 0; i--) {
        const span_of_letters *own = &m->spans[i];
        rv_piece *one = own->first;
        while ((one != NULL) && (one->number < 0)) {
            one->number = count;
            if (places != NULL) {
                places[count].piece = one;
                places[count].count = (one == own->last) ? own->last_count : one->count;
            }
            count++;
            one = (one == own->last) ? NULL : one->next;
        }
    }
    return count;
}

/* The largest number of words of a letter. */
static int32_t widest_letter(const rv_monitor *m)
{
    int32_t found = 1;
    int32_t i;
    int32_t k;
    for (i = 0; i < m->plan.part_count; i++) {
        for (k = 0; k < m->plan.parts[i].judges.count; k++) {
            const int32_t own = words_for(m->parts[i].judges[k].propositions.count) + 1;
            found = (own > found) ? own : found;
        }
    }
    return found;
}

/* Find the linked list of each piece, and its position there; a cycle is refused. */
static void chain_pieces(carrier *c, numbered_piece *places, int32_t count)
{
    int32_t done = 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        const int32_t next = places[i].next;
        if (next >= 0) {
            demand(c, !places[next].follows && (places[next].piece->stride == places[i].piece->stride));
            places[next].follows = true;
            places[i].piece->next = places[next].piece;
        }
    }
    for (i = 0; i < count; i++) {
        int32_t one = places[i].follows ? -1 : i;
        int32_t index = 0;
        while (one >= 0) {
            places[one].chain = i;
            places[one].index = index;
            index++;
            done++;
            one = places[one].next;
        }
    }
    demand(c, done == count);
}

static void carry_span(carrier *c, const numbered_piece *places, int32_t count, span_of_letters *own)
{
    int32_t first = c->reading ? 0 : own->first->number;
    int32_t last = c->reading ? 0 : own->last->number;
    carry_int(c, &first, 0, count);
    carry_int(c, &last, 0, count);
    carry_int(c, &own->last_count, 0, (int64_t)MOST); /* 0: a piece without letters so far */
    if (c->reading && !c->refused) {
        const rv_piece *end = places[last].piece;
        demand(c, (places[first].chain == places[last].chain)
                      && (places[first].index <= places[last].index));
        demand(c, (own->last_count <= end->count) && (own->last_count % end->stride == 0));
        own->first = places[first].piece;
        own->last = places[last].piece;
    }
}

void carry_spans(carrier *c, rv_monitor *m)
{
    const int32_t widest = widest_letter(m);
    int32_t count = c->reading ? 0 : number_pieces(m, NULL);
    numbered_piece *places;
    size_t size;
    int32_t i;
    carry_size(c, &count, MOST, 9);
    size = ((size_t)count + 1U) * sizeof *places;
    places = is_lost(c) ? NULL : arena_take(&m->memory, size);
    if (places == NULL) {
        m->spoilt = m->spoilt || !c->refused;
        return;
    }
    if (!c->reading) {
        (void)number_pieces(m, places);
    }
    for (i = 0; (i < count) && !is_lost(c); i++) {
        numbered_piece *own = &places[i];
        int32_t stride = c->reading ? 0 : own->piece->stride;
        carry_int(c, &stride, 1, (int64_t)widest + 1);
        own->piece = (c->reading && !c->refused) ? made_piece(m, stride) : own->piece;
        if (is_lost(c)) {
            break;
        }
        if (c->reading) {
            own->piece->pinned = m->pins;
            own->piece->next_left = m->left;
            m->left = own->piece;
        } else {
            const rv_piece *next = own->piece->next;
            own->next = ((next != NULL) && (next->number >= 0)) ? next->number : -1;
        }
        carry_int(c, &own->next, -1, count);
        (void)carry_piece(c, own->piece, own->count, -LIMIT, false);
    }
    if (c->reading && !is_lost(c)) {
        chain_pieces(c, places, count);
    }
    carry_size(c, &m->span_count, MOST, 12);
    if (c->reading) {
        span_of_letters *made = enlarged(m, m->spans, &m->span_room, m->span_count, sizeof *made);
        m->spans = (made != NULL) ? made : m->spans;
    }
    for (i = 0; (i < m->span_count) && !is_lost(c); i++) {
        carry_span(c, places, count, &m->spans[i]);
    }
    arena_give(&m->memory, places, size);
}
