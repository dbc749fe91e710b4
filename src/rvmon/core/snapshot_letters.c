/* Letters that notes refer to, in a snapshot: the pieces of each judge, those that are left to notes, and
 * which of them each note refers to. Pieces are numbered as they are carried. */
#include "notes.h"
#include "snapshot.h"

/* The letters of a piece, from an instant on; `whole`: there is no room for more. Returns the last one's
 * instant. */
static int64_t carry_piece(carrier *c, rv_piece *piece, int64_t from, bool whole)
{
    const int32_t most = LETTERS_IN_PIECE * piece->stride;
    int64_t before = from;
    int32_t i;
    int32_t k;
    piece->number = c->pieces;
    c->pieces++;
    carry_int(c, &piece->count, whole ? most : 0, (int64_t)most + 1);
    demand(c, piece->count % piece->stride == 0);
    for (i = 0; (i < piece->count) && !is_lost(c); i += piece->stride) {
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

/* The letter before the one that came last: so many from the end of the last piece, of which the first may
 * be in the piece before; 0: there is none. */
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
            /* None. */
        }
        if (!c->reading && (last->before == there)) {
            back = i;
        } else if (c->reading && (i == 0)) {
            carry_int(c, &back, 0, (int64_t)most + 1);
        } else {
            /* It is another one. */
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
    bool over = false; /* none from here on is referred to */
    int32_t i;
    carry_size(c, &count, MOST, 5);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        bool pinned = !c->reading && (one->pinned == c->m->pins);
        second = c->reading ? n->last : second;
        one = c->reading ? next_piece(c->m, n, stride) : one;
        if (one == NULL) {
            break;
        }
        before = carry_piece(c, one, before, i < count - 1);
        carry_flag(c, &pinned);
        demand(c, !pinned || !over);
        over = !pinned && ((n->pinned != NULL) || over);
        if (c->reading && pinned) {
            one->pinned = c->m->pins;
            n->pinned = one;
        }
        if (i < count - 1) {
            second = one;
            one = one->next;
        }
    }
    if ((count > 0) && !is_lost(c)) {
        carry_before(c, n->last, (count > 1) ? second : NULL);
    }
}

/* What is known of a piece by its number: that behind it, the end of those behind it, how many they are,
 * and how many of them and itself are not kept for notes. */
typedef struct {
    rv_piece *piece;
    int32_t end;
    int32_t behind;
    int32_t loose;
    bool follows;              /* whether it is behind another one */
} place;

/* Number what is in the lists of judges, the last one of each first; in `places` if there are some. */
static void place_pieces(const carrier *c, home *h, place *places)
{
    run *r;
    rv_piece *one;
    int32_t i;
    for (r = h->root; r != NULL; r = following(h, r)) {
        for (i = 0; i < r->part->plan->judges.count; i++) {
            const noting *n = r->judges[i].noting;
            int32_t left = n->pieces;
            int32_t loose = 0;
            for (one = n->last; one != NULL; one = NULL) {
                loose = 0;
            }
            for (one = n->first; one != NULL; one = one->next) {
                loose += (one->pinned != c->m->pins) ? 1 : 0;
            }
            for (one = n->first; one != NULL; one = one->next) {
                place *own = &places[one->number];
                left--;
                own->piece = one;
                own->end = n->last->number;
                own->behind = left;
                own->loose = loose;
                own->follows = one != n->first;
                loose -= (one->pinned != c->m->pins) ? 1 : 0;
            }
        }
    }
}
