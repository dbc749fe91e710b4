/* Judges the cases that benchmarks/core_mutants.py has written, and prints one line per case. Mutants of
 * the core, and builds for other machines, must print the same.
 *
 * A case is judged in several ways: step by step, with queries for open and due attempts; again after a
 * reset, without queries; by rows, if possible; continued from snapshots; and in blocks of memory, most of
 * them too small. The line has a checksum of all records in their order, a checksum of what was open, noted
 * and measured, and letters for faults. a, o, k, m: the results differ with queries or after a reset, by
 * rows, from snapshots, in a block. d: time alone decided something that was not due. f, t: a sample was
 * accepted after the end, or twice. g: a run short of memory was green. r, s: rows, or a step, refused. */
#include "../fuzz/checksum.h"

#include "plan/plan.h"

#define UPDATES_MOST 64
#define FIELDS_MOST 8
#define ROWS_MOST 128
#define NAMES_MOST 32

/* A sample of a case. */
typedef struct {
    int64_t t;
    int32_t count;
    bool in_rows;              /* no name occurs twice */
    rv_update updates[UPDATES_MOST];
    rv_number fields[UPDATES_MOST][FIELDS_MOST];
} sample;

/* For lost and found, the updates have only names. */
enum { A_SAMPLE, AN_ADVANCE, A_LOSS, A_FINDING };

typedef struct {
    int64_t kind;
    sample s;
} action;

typedef struct {
    const void *plan;
    size_t size;
    const int64_t *absent;
    int64_t absent_count;
    int64_t end;
    int64_t count;
    action actions[ROWS_MOST];
} story;

/* Faults found, as letters. */
typedef struct {
    uint64_t sum;
    uint64_t open;             /* checksum of what was open in between */
    char wrong[8];
} outcome;

static void blame(outcome *x, char letter)
{
    const size_t length = strlen(x->wrong);
    if ((length + 1 < sizeof x->wrong) && (strchr(x->wrong, letter) == NULL)) {
        x->wrong[length] = letter;
        x->wrong[length + 1] = '\0';
    }
}

static void add(outcome *x, int64_t what)
{
    x->sum = mixed(x->sum, what);
}

static rv_number number_at(const int64_t *words)
{
    rv_number made;
    made.kind = (int32_t)words[0];
    (void)memcpy(&made.as, &words[1], sizeof made.as);
    return made;
}

/* Read a sample; returns the position after it. */
static const int64_t *read_sample(const int64_t *at, sample *s)
{
    int32_t i;
    s->t = *at++;
    s->count = (int32_t)*at++;
    s->in_rows = true;
    if (s->count > UPDATES_MOST) {
        abort();
    }
    for (i = 0; i < s->count; i++) {
        rv_update *u = &s->updates[i];
        int64_t fields;
        int64_t k;
        (void)memset(u, 0, sizeof *u);
        u->name = (int32_t)at[0];
        u->says = (int32_t)at[1];
        u->value = number_at(&at[2]);
        fields = at[4];
        at += 5;
        if (fields > FIELDS_MOST) {
            abort();
        }
        for (k = 0; k < fields; k++) {
            s->fields[i][k] = number_at(at);
            at += 2;
        }
        u->fields = (fields > 0) ? s->fields[i] : NULL;
        for (k = 0; k < i; k++) {
            s->in_rows = s->in_rows && (s->updates[k].name != u->name);
        }
        s->in_rows = s->in_rows && (u->name < NAMES_MOST);
    }
    return at;
}

/* Read a case; returns the position after it. */
static const int64_t *read_story(const int64_t *at, story *x)
{
    int64_t i;
    int32_t k;
    const int64_t size = *at++;
    if (size > 0) { /* otherwise the plan of the previous case */
        x->plan = at;
        x->size = (size_t)size;
        at += size / 8;
    }
    x->absent_count = *at++;
    x->absent = at;
    at += x->absent_count;
    x->end = *at++;
    x->count = *at++;
    if (x->count > ROWS_MOST) {
        abort();
    }
    for (i = 0; i < x->count; i++) {
        action *a = &x->actions[i];
        a->kind = *at++;
        if (a->kind == A_SAMPLE) {
            at = read_sample(at, &a->s);
        } else {
            a->s.t = *at++;
            a->s.count = (a->kind == AN_ADVANCE) ? 0 : (int32_t)*at++;
            for (k = 0; k < a->s.count; k++) {
                a->s.updates[k].name = (int32_t)*at++;
            }
        }
    }
    return at;
}

static void note_number(outcome *x, const rv_number *n)
{
    int64_t bits = 0;
    if (n->kind != RV_UNKNOWN) {
        (void)memcpy(&bits, &n->as, sizeof bits);
    }
    add(x, n->kind);
    add(x, bits);
}

/* Pass an action to a monitor. */
static int tell(rv_monitor *m, const action *a)
{
    int32_t names[UPDATES_MOST];
    int32_t i;
    for (i = 0; i < a->s.count; i++) {
        names[i] = a->s.updates[i].name;
    }
    switch (a->kind) {
    case A_SAMPLE: return rv_step(m, a->s.t, a->s.updates, a->s.count);
    case AN_ADVANCE: return rv_advance(m, a->s.t);
    case A_LOSS: return rv_lose(m, a->s.t, names, a->s.count);
    default: return rv_found(m, a->s.t, names, a->s.count);
    }
}

/* Take the records of a call, with notes and margins. Before `due`, time alone decides nothing. */
static void note_records(outcome *x, rv_monitor *m, int64_t due, int64_t t)
{
    const rv_record *records;
    const int64_t count = rv_records(m, &records);
    int64_t i;
    for (i = 0; i < count; i++) {
        const rv_record *one = &records[i];
        const rv_number *captured = rv_captured(m, one);
        const int32_t most = rv_captured_of(m, one->requirement);
        int32_t k;
        add(x, one->triggered);
        add(x, (one->decision == RV_OPEN) ? 0 : one->decided);
        add(x, one->requirement + 1000 * (int64_t)one->number);
        add(x, one->verdict + 8 * one->decision + 64 * one->in_doubt);
        for (k = 0; (captured != NULL) && (k < most); k++) {
            note_number(x, &captured[k]);
        }
        x->open = mixed(x->open, (int64_t)read_note(m, one));
        if ((t < due) && (one->decision == RV_BY_PREFIX) && (one->decided < t)) {
            blame(x, 'd');
        }
    }
    x->open = noted_margins(m, x->open);
    rv_forget_records(m);
}

static bool note_open(void *user, const rv_record *record, const rv_number *captured)
{
    uint64_t *sum = user; /* independent of the order */
    *sum += (uint64_t)record->triggered * 31 + (uint64_t)record->requirement * 7 + record->number
            + 1000 * (uint64_t)record->in_doubt + ((captured != NULL) ? 1 : 0);
    return true; /* continue */
}

/* A call that has to succeed if there is enough memory. */
static void demand(outcome *x, const rv_monitor *m, int code)
{
    if (code != (rv_spoilt(m) ? RV_NO_MEMORY : RV_OK)) {
        blame(x, 's');
    }
}

static void note_end(outcome *x, rv_monitor *m, const story *s)
{
    const int32_t requirements = rv_sizes_of(m).requirements;
    int32_t i;
    demand(x, m, rv_finish(m, s->end));
    note_records(x, m, RV_NO_TIME, 0);
    for (i = 0; i < requirements; i++) {
        const rv_counts counts = rv_count(m, i);
        add(x, rv_verdict(m, i));
        add(x, counts.failed + 1000 * counts.passed + 1000000 * counts.inconclusive);
        add(x, counts.heard ? 1 : 0);
        if (rv_spoilt(m) && (rv_verdict(m, i) != RV_FAIL) && (rv_verdict(m, i) != RV_INCONCLUSIVE)) {
            blame(x, 'g');
        }
    }
    if ((rv_step(m, s->end + 1000, NULL, 0) != RV_FINISHED) && (s->end != RV_NO_TIME)) {
        blame(x, 'f');
    }
}

static const rv_memory heap = {malloc, realloc, free, NULL, 0};

/* Continue in a new monitor from a snapshot of the old one, which is freed. */
static rv_monitor *taken_up(outcome *x, rv_monitor *m, const story *s)
{
    const size_t size = rv_save(m, NULL, 0);
    void *bytes = malloc(size + 1U);
    rv_monitor *made = rv_new(s->plan, s->size, heap);
    if ((size == 0) || (bytes == NULL) || (made == NULL)) { /* a run with margins has no snapshot */
        rv_free(made);
        made = m;
    } else if ((rv_keep_notes(made, NULL, NULL) != RV_OK) || (rv_save(m, bytes, size) != size)
               || (rv_load(made, bytes, size) != RV_OK)) {
        blame(x, 'k');
        rv_free(made);
        made = m;
    } else {
        rv_free(m);
    }
    free(bytes);
    return made;
}

/* Step by step. `asks`: query what is open and due in between. `put_away`: continue from snapshots. */
static outcome by_steps(rv_monitor **own, const story *s, bool asks, bool put_away)
{
    rv_monitor *m = *own;
    outcome x = {1, 0, ""};
    int64_t due = RV_NO_TIME;
    int64_t i;
    for (i = 0; i < s->count; i++) {
        const action *a = &s->actions[i];
        demand(&x, m, tell(m, a));
        if ((a->kind == A_SAMPLE) && (tell(m, a) == RV_OK)) {
            blame(&x, 't');
        }
        note_records(&x, m, (a->kind > AN_ADVANCE) ? RV_NO_TIME : due, a->s.t);
        due = (asks && (i % 3 != 0)) ? rv_next_due(m) : RV_NO_TIME;
        if (asks && (i % 2 == 0)) {
            int32_t k;
            x.open *= 31;
            rv_each_open(m, note_open, &x.open);
            for (k = 0; k < rv_sizes_of(m).requirements; k++) {
                x.open = 3 * x.open + (rv_count(m, k).open ? 1 : 0);
            }
        }
        m = put_away ? taken_up(&x, m, s) : m;
        *own = m;
    }
    note_end(&x, m, s);
    return x;
}

/* The column of a name or field. */
typedef struct {
    uint8_t says[ROWS_MOST];
    double reals[ROWS_MOST];
    int64_t whole[ROWS_MOST];
    bool is_real;
} cells;

/* Columns of some samples. */
typedef struct {
    int64_t times[ROWS_MOST];
    int64_t rows;
    cells names[NAMES_MOST];
    cells fields[NAMES_MOST][FIELDS_MOST];
} table;

static void put(cells *c, int64_t row, int32_t says, const rv_number *value)
{
    c->says[row] = (uint8_t)says;
    c->is_real = c->is_real || (value->kind == RV_REAL);
    c->reals[row] = value->as.real;
    c->whole[row] = value->as.whole;
}

static void lay(table *made, const rv_monitor *m, const sample *s)
{
    const int32_t signals = rv_sizes_of(m).signals;
    const int64_t row = made->rows++;
    int32_t i;
    int32_t k;
    made->times[row] = s->t;
    for (i = 0; i < NAMES_MOST; i++) {
        made->names[i].says[row] = 255;
        for (k = 0; k < FIELDS_MOST; k++) {
            made->fields[i][k].says[row] = 255;
        }
    }
    for (i = 0; i < s->count; i++) {
        const rv_update *u = &s->updates[i];
        int32_t first;
        put(&made->names[u->name], row, u->says, &u->value);
        for (k = 0; (u->name >= signals) && (u->fields != NULL)
                    && (k < rv_fields_of(m, u->name - signals, &first)); k++) {
            const bool known = u->fields[k].kind != RV_UNKNOWN;
            put(&made->fields[u->name][k], row, known ? RV_SAYS_YES : RV_SAYS_UNKNOWN, &u->fields[k]);
        }
    }
}

static rv_column column_of(const cells *c)
{
    rv_column made;
    (void)memset(&made, 0, sizeof made);
    made.kind = c->is_real ? RV_COLUMN_REAL : RV_COLUMN_WHOLE;
    made.values = c->is_real ? (const void *)c->reals : (const void *)c->whole;
    made.says = c->says;
    return made;
}

static void judge_table(outcome *x, rv_monitor *m, table *made)
{
    static rv_column columns[NAMES_MOST];
    static rv_column fields[NAMES_MOST][FIELDS_MOST];
    const rv_sizes sizes = rv_sizes_of(m);
    int64_t done = 0;
    int32_t i;
    int32_t k;
    for (i = 0; i < sizes.signals + sizes.events; i++) {
        columns[i] = column_of(&made->names[i]);
        columns[i].name = i;
        for (k = 0; (i >= sizes.signals) && (k < FIELDS_MOST); k++) {
            fields[i][k] = column_of(&made->fields[i][k]);
        }
        columns[i].fields = (i >= sizes.signals) ? fields[i] : NULL;
    }
    if ((rv_rows(m, made->times, made->rows, columns, sizes.signals + sizes.events, &done) != RV_OK)
        || (done != made->rows)) {
        blame(x, 'r');
    }
    (void)memset(made, 0, sizeof *made);
}

/* By rows: consecutive samples without repeated names are judged as one table. */
static outcome by_rows(rv_monitor *m, const story *s)
{
    static table made;
    outcome x = {1, 0, ""};
    int64_t i;
    (void)memset(&made, 0, sizeof made);
    for (i = 0; i < s->count; i++) {
        const action *a = &s->actions[i];
        if ((a->kind == A_SAMPLE) && a->s.in_rows) {
            lay(&made, m, &a->s);
            continue;
        }
        judge_table(&x, m, &made);
        demand(&x, m, tell(m, a));
    }
    judge_table(&x, m, &made);
    note_end(&x, m, s);
    return x;
}

static void mark_absent(rv_monitor *m, const story *s)
{
    int64_t i;
    for (i = 0; i < s->absent_count; i++) {
        rv_set_absent(m, (int32_t)s->absent[i]);
    }
}

/* Add the faults of another way, and `letter` if its results differ. */
static void blame_other(outcome *x, const outcome *other, char letter)
{
    size_t i;
    for (i = 0; other->wrong[i] != '\0'; i++) {
        blame(x, other->wrong[i]);
    }
    if (other->sum != x->sum) {
        blame(x, letter);
    }
}

static void judge(const story *s)
{
    static char block[1 << 20];
    rv_monitor *m = rv_new(s->plan, s->size, heap);
    outcome whole;
    outcome other;
    size_t used;
    size_t size;
    if (m == NULL) {
        exit(3); /* the plan belongs to another version */
    }
    (void)rv_keep_notes(m, NULL, NULL);
    mark_absent(m, s);
    whole = by_steps(&m, s, true, false);
    (void)rv_reset(m);
    other = by_steps(&m, s, false, false);
    blame_other(&whole, &other, 'a');
    (void)rv_reset(m);
    other = by_rows(m, s);
    blame_other(&whole, &other, 'o');
    used = rv_memory_used(m);
    (void)rv_reset(m);
    other = by_steps(&m, s, true, true);
    blame_other(&whole, &other, 'k');
    rv_free(m);
    for (size = used / 4; (size <= 2 * used) && (size + 16 < sizeof block); size += used / 4 + 64) {
        rv_memory own = {NULL, NULL, NULL, 0};
        own.block = block + size / 16 % 16; /* aligned or not */
        own.size = size;
        m = rv_new(s->plan, s->size, own);
        if (m != NULL) {
            mark_absent(m, s);
            other = by_steps(&m, s, true, false);
            other.sum = rv_spoilt(m) ? whole.sum : other.sum;
            blame_other(&whole, &other, 'm');
            rv_free(m);
        }
    }
    (void)printf("%016llx %016llx %s\n", (unsigned long long)whole.sum,
                 (unsigned long long)whole.open, whole.wrong);
}

int main(int argc, char **argv)
{
    static story s;
    FILE *file = (argc == 2) ? fopen(argv[1], "rb") : NULL;
    int64_t *words;
    const int64_t *at;
    int64_t cases;
    long size;
    if ((file == NULL) || (fseek(file, 0, SEEK_END) != 0)) {
        return 2;
    }
    size = ftell(file);
    rewind(file);
    words = malloc((size_t)size + 8);
    if ((words == NULL) || (fread(words, 1, (size_t)size, file) != (size_t)size)) {
        return 2;
    }
    (void)fclose(file);
    at = words;
    for (cases = *at++; cases > 0; cases--) {
        at = read_story(at, &s);
        judge(&s);
    }
    free(words);
    return 0;
}
