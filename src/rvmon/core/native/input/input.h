/* Input: from the updates of a sample to the truths of atoms.
 *
 * An update changes a held value of a run, or adds an occurrence of an event. The *atoms* that read it
 * (one comparison, event or predicate each) are read again, and the leaves of those that changed are
 * marked dirty for formulas/. A name can be *absent* (no source), *stale*, or *lost* in an outage; then
 * it is unknown.
 *
 * `local` is the number of a signal, or of an event, in the part. `name` is a number in the part that
 * counts signals first, then events. */
#ifndef RVMON_INPUT_H
#define RVMON_INPUT_H

#include "basics.h"
#include "margins/margins.h"

/* ---- numbers.c */
int32_t compare_numbers(int32_t how, const rv_number *a, const rv_number *b); /* CMP_...; a truth */
bool same_number(const rv_number *a, const rv_number *b);
rv_number difference(const rv_number *a, const rv_number *b);
int64_t seconds_in_ticks(const rv_number *seconds);
rv_number program_value(const run *r, int32_t place, const int32_t *at);
rv_number number_of_double(double x);

/* ---- functions.c */
#define MOST_ARGUMENTS 4
int32_t arguments_of(int32_t op); /* of CODE_...; 0: not an operation */
rv_number function_of_wholes(int32_t op, int64_t a, int64_t b);
double function_of_reals(int32_t op, const double *x); /* a result that is not finite is unknown */

/* ---- values.c: samples, held values, what occurred */
void mark(run *r, int32_t name);
uint8_t remember(history *h, int64_t t, const rv_number *value);
void come_to_birth(run *r, int32_t local, bool known);
void be_born(run *r, int32_t local);
void set_stale(run *r, int32_t local, int64_t t);
void keep_payload(run *r, int32_t local, bool known, const rv_number *fields);
/* The value in an update of a signal; if unknown, `as.whole` says why (RV_IS_NONE, RV_IS_NAN). */
rv_number number_given(const rv_update *u);
void apply_update(run *r, int64_t t, const incoming *in);

/* ---- spans.c */
bool compares_with(const run *r, const atom_plan *a, int32_t local, rv_number *constant);
bool narrow_span(const run *r, int32_t local, const rv_number *value, span *s);
void learn_span(run *r, int32_t local);

/* Whether a value changes no comparison of a signal, so that only the held value has to be replaced.
 * Most samples of most signals end here. */
static inline bool stays_in_span(const span *s, const rv_number *held, const rv_number *value)
{
    const double x = (value->kind == RV_REAL) ? value->as.real : (double)value->as.whole;
    return (value->kind == held->kind) && (s->low < x) && (x < s->high);
}

void margins_mark_changed(run *r, int32_t what);

/* ---- atoms.c */
bool find_quick(arena *a, const plan *all, part *p);
bool recheck(run *r, int32_t atom);     /* whether its truth changed */
bool recheck_list(run *r, list l);      /* whether one of them did */
void recheck_amid(run *r, list l);
uint8_t first_choice(const run *r, list of);
bool next_choice(const run *r, list of);
bool is_sure_choice(const run *r, list of);
uint8_t atom_now(const run *r, const atom_plan *a);
void recheck_fading(run *r);
void reread(run *r, int32_t atom, bool pending);
bool is_taken_for(const run *r, const node_plan *n);
uint8_t leaf_truth(const run *r, const node_plan *n);

/* How a value compares with a constant: the index of a bit, or of `quick_compare.truths`. */
enum { IS_EQUAL, IS_LESS, IS_GREATER };

static inline int32_t order_of(double x, double constant)
{
    return IS_LESS * (int32_t)(x < constant) + IS_GREATER * (int32_t)(x > constant);
}

/* The signals of a run that take_quickly() may take now; NULL: none, since the run is not in the second
 * phase, or has an outage, or more than truths depends on values. */
static inline const quick_signal *quick_now(const run *r)
{
    return ((r->at.phase == 1) && (r->at.lost_count == 0) && (r->margins == NULL)) ? r->part->quick
                                                                                    : NULL;
}

/* Take an update of a signal that only a few comparisons with constants read; false: it is not such a
 * signal, or not a known value of its kind. Branches on noisy values would be mispredicted half the
 * time, so the comparisons have none: a change becomes a mask. */
static inline bool take_quickly(run *r, const quick_signal *quick, int32_t local, const rv_update *u)
{
    const int32_t kind = quick[local].kind;
    const quick_compare *c = quick[local].compares;
    int32_t left = quick[local].count;
    rv_number *value = &r->value[local];
    uint64_t *dirty = r->dirty;
    uint64_t *words = r->dirty_words;
    uint8_t *atoms = r->atom;
    double x;
    if ((kind == RV_UNKNOWN) || (u->value.kind != kind) || (value->kind != kind)
        || (u->says != RV_SAYS_YES)) {
        return false;
    }
    if (u->value.as.whole == value->as.whole) {
        return true; /* the same bits: the union's integer stands for both kinds */
    }
    x = (kind == RV_REAL) ? u->value.as.real : (double)u->value.as.whole;
    value->as = u->value.as;
    for (; left > 0; left--, c++) {
        const int32_t word = c->word;
        const uint8_t now = c->truths[order_of(x, c->constant)];
        const uint64_t other = (now != atoms[c->atom]) ? UINT64_MAX : 0U;
        dirty[word] |= c->dirty & other;
        words[word >> 6] |= c->dirty_word & other;
        atoms[c->atom] = now;
    }
    return true;
}

static inline void take_update(run *r, int64_t t, const incoming *in)
{
    const rv_update *u = in->update;
    if (r->margins != NULL) {
        margins_mark_changed(r, in->event ? r->part->plan->signals.count + in->local : in->local);
    }
    if (!in->event && (u->says == RV_SAYS_YES)
        && stays_in_span(&r->spans[in->local], &r->value[in->local], &u->value)) {
        r->value[in->local] = u->value;
    } else {
        apply_update(r, t, in);
    }
}

void forget(run *r);
void go_stale(run *r, int64_t t, int32_t perishable);
void mark_absent(run *r, bool event, int32_t local);
void declare_no_source(run *r, bool event, int32_t local);

/* ---- pulses.c: events that only start attempts */
bool find_pulses(arena *a, const plan *all, part *p);
bool take_pulse(run *r, int32_t local, int32_t says);
void start_pulses(run *r, int64_t t);
void end_pulses(run *r);

/* ---- outages.c: stretches of time over which names are lost */
void clear_losses(run *r);
bool take_while_lost(run *r, int64_t t, const incoming *in);
void end_outages(run *r, int64_t t);
void end_loss_when_stale(run *r, int32_t local);
bool has_no_source(const run *r, int32_t name);
bool is_lost_at(const run *r, int32_t name, int64_t t);
void run_take_loss(run *r, int64_t t, const incoming *in, int32_t count);
int32_t names_to_lose(const run *r);

/* ---- unknowns.c: positions that may not exist */
void await_blank_start(run *r, int64_t t);
void begin_blank(run *r, int64_t t);
void end_blank(run *r, int64_t t);
void resume_episodes(run *r, int64_t t);

/* ---- unknowns.c: when and why signals were unknown, for notes */
bool begin_unknowns(home *h);
void note_knowledge(run *r, int64_t t, int32_t local, const rv_number *value);
int64_t unknowns_count(const run *r, int32_t index, int64_t doubt);
void put_unknowns(const run *r, int32_t index, int64_t doubt, int64_t *to);

#endif
