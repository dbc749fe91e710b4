/* What is kept so that notes can be told, in a snapshot. */
#include "notes/notes.h"
#include "snapshot/snapshot.h"

/* A position, or what stands for one that there was none. */
static void carry_position(carrier *c, int64_t *x)
{
    carry_long(c, x, RV_NO_TIME, LIMIT);
}

static void carry_truth_times(carrier *c, truth_times *x)
{
    carry_position(c, &x->since);
    carry_position(c, &x->last[0]);
    carry_position(c, &x->last[1]);
}

void carry_truth_log(carrier *c, run *r)
{
    truth_log *s = r->truth_log;
    int32_t i;
    carry_position(c, &s->moved_at);
    carry_position(c, &s->begun);
    for (i = 0; (i < r->part->logged) && !is_lost(c); i++) {
        logged_node *own = &s->nodes[i];
        uint8_t moved = ((own->moved_at == s->moved_at) && (s->moved_at != RV_NO_TIME)) ? 1 : 0;
        carry_truth_times(c, &own->now);
        carry_byte(c, &moved, 1);
        if (moved != 0U) {
            own->moved_at = s->moved_at;
            carry_truth_times(c, &own->was);
            carry_byte(c, &own->truth, IS_TRUE);
        }
    }
}

/* Truths at instants, in order. */
static void carry_truths(carrier *c, truths *ring, int32_t words)
{
    int32_t count = ring->count;
    int64_t before = -LIMIT;
    int32_t i;
    int32_t k;
    carry_size(c, &count, MOST, 8);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        int64_t *one;
        if (c->reading && (next_truths(c->m, ring, words) == NULL)) {
            break;
        }
        one = entry_of(ring, i, words);
        carry_instant(c, &one[0]);
        demand(c, one[0] >= before);
        before = one[0];
        for (k = 1; k <= words; k++) {
            carry_long(c, &one[k], INT64_MIN, INT64_MAX);
        }
        demand(c, are_truths(&one[1], words));
    }
}

/* Where the state is that was noted last, if notes to come may share it; else -1. */
static void carry_shared(carrier *c, run *r, int32_t index)
{
    rv_monitor *m = c->m;
    noting *n = r->judges[index].noting;
    int64_t place = ((n->epoch == m->epoch) && (n->state_at == r->truth_log->moved_at)) ? n->state : -1;
    carry_long(c, &place, -1, m->note_count);
    if (c->reading && !c->refused && (place >= 0)) {
        demand(c, is_state(c, &r->part->judges[index], place));
        n->state = place;
        n->state_at = r->truth_log->moved_at;
        n->epoch = m->epoch;
    }
}

void carry_noting(carrier *c, run *r, int32_t index)
{
    const judge_plan *judged = &r->part->judges[index];
    noting *n = r->judges[index].noting;
    const int32_t words = words_for(judged->leaves.count);
    carry_truths(c, &n->triggers, words);
    carry_truths(c, &n->doubts, words);
    carry_position(c, &n->began_at);
    carry_long(c, &n->undecidable_since, -LIMIT, NEVER);
    carry_shared(c, r, index);
    if (is_networked(r, index)) {
        carry_letters(c, n, words_for(judged->propositions.count) + 1);
    }
    if (c->reading && !is_lost(c) && (n->doubts.count > 0)) {
        n->doubted_at = entry_of(&n->doubts, n->doubts.count - 1, words)[0];
    }
}

void carry_unknowns(carrier *c, home *h)
{
    const int32_t signals = h->part->plan->signals.count;
    int32_t i;
    carry_size(c, &h->unknown_count, MOST, 9);
    if (c->reading) {
        unknown_stretch *made =
            enlarged(c->m, h->unknowns, &h->unknown_room, h->unknown_count, sizeof *made);
        h->unknowns = (made != NULL) ? made : h->unknowns;
        for (i = 0; i < signals; i++) {
            h->unknown_of[i] = -1;
        }
    }
    for (i = 0; (i < h->unknown_count) && !is_lost(c); i++) {
        unknown_stretch *one = &h->unknowns[i];
        carry_position(c, &one->since);
        carry_instant_or(c, &one->until, NEVER);
        carry_int(c, &one->local, 0, signals);
        carry_int(c, &one->why, RV_IS_NONE, HAS_NO_SOURCE + 1);
        if (c->reading && !c->refused) {
            h->unknown_of[one->local] = i;
        }
    }
}
