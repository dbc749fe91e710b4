/* Entry point of the fuzzer (libFuzzer, or AFL++ by `-fsanitize=fuzzer`).
 *
 * Compiled with -DPLANS, the bytes are a plan, whose hash is corrected. If it is accepted, it judges
 * some samples. Otherwise the first byte selects a plan from the file `$RVMON_PLANS`, and the others
 * are a script of calls. Each run is repeated after a reset, and again while other monitors take over
 * from snapshots now and then; both must give the same results. Then it is repeated with limited
 * memory, and must not be green. With -DSNAPSHOTS the first byte also selects a plan, and the others
 * are a snapshot without its head, which is added. If it is accepted, it judges some samples. */
#include "checksum.h"

#include "plan/plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAMES_MOST 64
#define FIELDS_MOST 64
#define UPDATES_MOST 12
#define STEPS_MOST 200

extern long guarded_left;
extern size_t guarded_in_use;
extern bool guarded_refused;

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Bytes that say which calls to make: the given ones, then `more` bytes of a generator (`seed`). */
typedef struct {
    const uint8_t *data;
    size_t size;
    size_t at;
    size_t more;
    uint64_t seed;
} script;

/* Whether notes are kept: with half of the plans, and always for snapshots, which contain notes. */
static bool keeps_notes(size_t size)
{
#ifdef SNAPSHOTS
    return size > 0U;
#else
    return size / 8U % 2U == 0U;
#endif
}

static bool is_over(const script *s)
{
    return s->at >= s->size + s->more;
}

static uint8_t byte_of(script *s)
{
    const size_t at = s->at++;
    if (at < s->size) {
        return s->data[at];
    }
    s->seed = s->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint8_t)(s->seed >> 56);
}

static rv_number number_of(script *s)
{
    static const int64_t whole[] = {0, 1, -1, 2, INT64_MAX, INT64_MIN, INT64_C(1) << 53,
                                    (INT64_C(1) << 53) + 1, INT64_MIN + 1};
    static const double real[] = {0.0, -0.0, 0.5, 1.0, -1.0, 9007199254740992.0,
                                  9223372036854775808.0, 1e300, -1e300, 4.9e-324};
    const uint8_t code = byte_of(s);
    rv_number made;
    (void)memset(&made, 0, sizeof made);
    if (code < 128) {
        made.kind = RV_WHOLE;
        made.as.whole = whole[code % (sizeof whole / sizeof *whole)];
    } else if (code < 250) {
        made.kind = RV_REAL;
        made.as.real = real[code % (sizeof real / sizeof *real)];
    } else {
        made.kind = RV_UNKNOWN;
    }
    return made;
}

/* Ticks to the next instant: at most some thousands, because a requirement that fails anew at each
 * tick makes as many records. */
static int64_t step_of(script *s)
{
    const uint8_t code = byte_of(s);
    if (code < 200) {
        return 1 + code % 8;
    }
    return (code < 240) ? 8 + (int64_t)byte_of(s) : (int64_t)1 << (code % 13);
}

/* Read the notes of open attempts only to find bad accesses; their content is not compared. */
static bool read_open(void *user, const rv_record *record, const rv_number *captured)
{
    static volatile uint64_t last;
    (void)captured;
    last = read_note((const rv_monitor *)user, record);
    (void)last;
    return true;
}

static bool note_open(void *user, const rv_record *record, const rv_number *captured)
{
    uint64_t *sum = user;
    *sum = mixed(mixed(*sum, record->triggered), record->number);
    *sum = mixed(*sum, (captured != NULL) ? captured->kind : -1);
    return true;
}

static uint64_t noted_records(rv_monitor *m, uint64_t sum, bool finished)
{
    const rv_record *records;
    const int64_t count = rv_records(m, &records);
    int64_t i;
    int32_t k;
    for (i = 0; i < count; i++) {
        const rv_record *one = &records[i];
        const rv_number *captured = rv_captured(m, one);
        static volatile uint64_t last;
        last = read_note(m, one);
        (void)last;
        if (finished || (one->decision != RV_OPEN)) {
            sum = mixed(mixed(mixed(sum, one->triggered), one->decided), one->number);
        }
        sum = mixed(mixed(mixed(sum, one->requirement), one->verdict), one->in_doubt);
        for (k = 0; (captured != NULL) && (k < rv_captured_of(m, one->requirement)); k++) {
            sum = mixed(sum, captured[k].kind);
        }
    }
    rv_forget_records(m);
    return sum;
}

static int one_step(rv_monitor *m, script *s, int64_t t, bool in_rows)
{
    const rv_sizes sizes = rv_sizes_of(m);
    rv_update updates[UPDATES_MOST];
    rv_number fields[UPDATES_MOST][FIELDS_MOST];
    const int32_t names = sizes.signals + sizes.events;
    const int32_t count = (names > 0) ? byte_of(s) % UPDATES_MOST : 0;
    int32_t i;
    (void)memset(updates, 0, sizeof updates);
    (void)memset(fields, 0, sizeof fields);
    for (i = 0; i < count; i++) {
        rv_update *u = &updates[i];
        u->name = byte_of(s) % ((names < 256) ? names : 256);
        u->says = RV_SAYS_YES;
        if (byte_of(s) >= 230) {
            u->says = (u->name < sizes.signals) ? RV_SAYS_UNKNOWN : byte_of(s) % 2;
        }
        if (u->name < sizes.signals) {
            u->value = number_of(s);
        } else {
            int32_t first;
            const int32_t own = rv_fields_of(m, u->name - sizes.signals, &first);
            int32_t k;
            for (k = 0; (k < own) && (own <= FIELDS_MOST); k++) {
                fields[i][k] = number_of(s);
            }
            u->fields = ((own > 0) && (own <= FIELDS_MOST)) ? fields[i] : NULL;
        }
    }
    if (in_rows && (count == 1) && (updates[0].name < sizes.signals)) {
        rv_column column;
        int64_t done;
        const uint8_t says = (uint8_t)updates[0].says;
        const uint8_t value = (uint8_t)(updates[0].value.as.whole & 1);
        (void)memset(&column, 0, sizeof column);
        column.values = &value;
        column.says = &says;
        column.kind = RV_COLUMN_BYTE;
        column.name = updates[0].name;
        return rv_rows(m, &t, 1, &column, 1, &done);
    }
    return rv_step(m, t, updates, count);
}

/* Report names as lost, found, or too late. */
static int one_loss(rv_monitor *m, script *s, int64_t t, uint8_t what)
{
    const rv_sizes sizes = rv_sizes_of(m);
    const int32_t names = sizes.signals + sizes.events;
    int32_t lost[3] = {0, 0, 0};
    const int32_t count = (names > 0) ? byte_of(s) % 4 : 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        lost[i] = byte_of(s) % ((names < 256) ? names : 256);
    }
    if (what == 0) {
        return rv_lose(m, t, lost, count);
    }
    return (what == 1) ? rv_found(m, t, lost, count) : rv_late(m, t - 3, lost, count - 1);
}

/* Everything reported besides attempts: coverage hits, moves of automata, truths. */
static uint64_t noted_watch(const rv_monitor *m, uint64_t sum)
{
    const rv_range *found;
    int32_t number;
    int32_t which;
    int64_t i;
    const rv_hit *hits = rv_hits(m, &number);
    for (i = 0; i < number; i++) {
        sum = mixed(mixed(sum, hits[i].count), hits[i].first);
    }
    for (number = 0; (number < rv_sizes_of(m).requirements) && (number < NAMES_MOST); number++) {
        int32_t locations;
        const rv_hit *moves = rv_moves(m, number, &locations);
        for (i = 0; i < (int64_t)locations * locations; i++) {
            sum = mixed(mixed(sum, moves[i].count), moves[i].first);
        }
    }
    for (number = 0; rv_truths(m, number, false, false, &found) >= 0; number++) {
        for (which = 0; which < 4; which++) {
            const int64_t count = rv_truths(m, number, which % 2 == 1, which >= 2, &found);
            for (i = 0; i < count; i++) {
                sum = mixed(mixed(sum, found[i].first), found[i].last);
            }
        }
    }
    return sum;
}

/* The situation of a run at an instant, first written into too little room. */
static uint64_t noted_situation(rv_monitor *m, uint64_t sum, int64_t now)
{
    static int64_t words[1 << 16];
    const int64_t room = 1 << 16;
    int64_t next;
    const int64_t most = rv_situation(m, now, words, 3, &next);
    int64_t count = rv_situation(m, now, words, room, &next);
    int64_t i;
    if ((count > most) || ((most < 0) != (count < 0))) {
        (void)fprintf(stderr, "there is more to be told than was said\n");
        abort();
    }
    count = (count > room) ? room : count;
    for (i = 0; i < count; i++) {
        sum = mixed(sum, words[i]);
    }
    return mixed(mixed(sum, count), next);
}

/* The plan of a monitor. */
typedef struct {
    const void *plan;
    size_t size;
    bool forged;               /* from an invented snapshot: later states may be refused */
} source;

/* The snapshot of a run; NULL if the run is spoilt. */
static void *saved(rv_monitor *m, size_t *size)
{
    void *made = NULL;
    *size = rv_save(m, NULL, 0);
    if (*size > 0) {
        made = malloc(*size);
        if ((made == NULL) || (rv_save(m, made, *size) != *size)) {
            abort();
        }
    }
    return made;
}

/* A new monitor that continues from a snapshot of `m`, which is freed. */
static rv_monitor *taken_up(rv_monitor *m, source from)
{
    const rv_memory memory = {malloc, realloc, free, NULL, 0};
    size_t size;
    size_t again_size;
    void *bytes = saved(m, &size);
    void *again;
    rv_monitor *made;
    if (bytes == NULL) {
        return m;
    }
    made = rv_new(from.plan, from.size, memory);
    if ((made == NULL) || (keeps_notes(from.size) && (rv_keep_notes(made, NULL, NULL) != RV_OK))
        || (rv_load(made, bytes, size) != RV_OK)) {
        if (!from.forged && !guarded_refused) {
            (void)fprintf(stderr, "a snapshot is refused\n");
            abort();
        }
        free(bytes);
        rv_free(made);
        return m;
    }
    again = saved(made, &again_size);
    if (!guarded_refused
        && ((again == NULL) || (again_size != size) || (memcmp(again, bytes, size) != 0))) {
        (void)fprintf(stderr, "a snapshot is another the second time\n");
        abort();
    }
    free(again);
    free(bytes);
    rv_free(m);
    return made;
}

/* Continue a run at `t` by a script; returns the checksum of everything it reports. With `from`, other
 * monitors take over from snapshots. */
static uint64_t run_on(rv_monitor **own, script s, int64_t t, const source *from)
{
    rv_monitor *m = *own;
    const rv_sizes sizes = rv_sizes_of(m);
    const int32_t names = sizes.signals + sizes.events;
    uint64_t sum = 1;
    int32_t steps = 0;
    int32_t i;
    if (byte_of(&s) >= 128) {
        rv_measure_positions(m);
    }
    if ((rv_times_of(m).reached == RV_NO_TIME) && (names > 0) && (byte_of(&s) >= 200)) {
        rv_set_absent(m, byte_of(&s) % ((names < 256) ? names : 256));
    }
    while (!is_over(&s) && (steps < STEPS_MOST)) {
        const uint8_t what = byte_of(&s);
        int code = RV_OK;
        if ((from != NULL) && (what % 5 == 0)) {
            m = taken_up(m, *from);
            *own = m;
        }
        if (what < 170) {
            code = one_step(m, &s, t, what % 4 == 3);
        } else if (what < 185) {
            code = rv_advance(m, t);
        } else if (what < 195) {
            sum = mixed(sum, rv_next_due(m));
        } else if (what < 205) {
            rv_each_open(m, note_open, &sum);
            rv_each_open(m, read_open, m);
            rv_each_margin(m, note_margin, &sum);
        } else if (what < 215) {
            sum = noted_records(m, sum, false);
            sum = noted_margins(m, sum);
        } else if (what < 220) {
            code = rv_step(m, t - 5, NULL, 0);
        } else if (what < 250) {
            code = one_loss(m, &s, t, (what < 234) ? 0 : ((what < 247) ? 1 : 2));
        } else {
            sum = mixed(sum, rv_end(m, t));
        }
        sum = mixed(sum, code);
        steps++;
        if (what % 8 != 0) {
            const int64_t step = step_of(&s);
            t += (t < (INT64_C(1) << 62)) ? step : 0;
        }
    }
    if (byte_of(&s) < 64) {
        sum = noted_situation(m, sum, t);
    }
    sum = mixed(sum, rv_finish(m, (byte_of(&s) < 128) ? RV_NO_TIME : t));
    sum = noted_records(m, sum, true);
    sum = noted_watch(m, sum);
    sum = noted_margins(m, sum);
    for (i = 0; (i < sizes.requirements) && (i < NAMES_MOST); i++) {
        const int verdict = rv_verdict(m, i);
        sum = mixed(mixed(sum, verdict), rv_count(m, i).failed);
        if (rv_spoilt(m) && ((verdict == RV_PASS) || (verdict == RV_NOT_TRIGGERED))) {
            (void)fprintf(stderr, "spoilt, and green\n");
            abort();
        }
    }
    return sum;
}

/* A whole run by a script. */
static uint64_t one_run(rv_monitor **own, script s, const source *from)
{
    static const int64_t begins[] = {0, 0, 0, INT64_C(1) << 53, (INT64_C(1) << 62) - 300,
                                     -(INT64_C(1) << 62) - 100};
    const int64_t begin = begins[byte_of(&s) % (sizeof begins / sizeof *begins)];
    const int64_t t = begin + byte_of(&s);
    return run_on(own, s, t, from);
}

#ifndef SNAPSHOTS

static void judge(const void *bytes, size_t size, script s)
{
    const rv_memory memory = {malloc, realloc, free, NULL, 0};
    const source from = {bytes, size, false};
    rv_monitor *m = rv_new(bytes, size, memory);
    if ((m != NULL) && keeps_notes(size) && (rv_keep_notes(m, NULL, NULL) != RV_OK)) {
        (void)fprintf(stderr, "notes take more memory than there is\n");
    }
    if (m != NULL) {
        const uint64_t first = one_run(&m, s, NULL);
        if ((rv_sizes_of(m).signals + rv_sizes_of(m).events <= NAMES_MOST) && !rv_spoilt(m)) {
            uint64_t again;
            /* A reset keeps absent names, so only the next two runs can be compared. */
            (void)rv_reset(m);
            again = one_run(&m, s, NULL);
            (void)rv_reset(m);
            guarded_refused = false; /* two monitors at a time need more memory than one */
            if (!rv_spoilt(m) && (one_run(&m, s, &from) != again) && !guarded_refused) {
                (void)fprintf(stderr, "%llx at first: another run says something else\n",
                              (unsigned long long)first);
                abort();
            }
        }
        rv_free(m);
    }
    guarded_left = byte_of(&s) % 64;
    m = rv_new(bytes, size, memory);
    if (m != NULL) {
        (void)rv_keep_notes(m, NULL, NULL);
        (void)one_run(&m, s, NULL);
        guarded_left = -1;
        (void)rv_reset(m);
        (void)one_run(&m, s, NULL);
        rv_free(m);
    }
    guarded_left = -1;
    if (guarded_in_use != 0) {
        (void)fprintf(stderr, "%zu bytes are not given back\n", guarded_in_use);
        abort();
    }
}

#endif

#ifdef PLANS

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const size_t whole = size / 8 * 8;
    plan_header head;
    uint64_t *words;
    script s;
    size_t i;
    if (whole < sizeof head) {
        return 0;
    }
    words = malloc(whole); /* exactly this size, so that accesses beyond it are detected */
    if (words == NULL) {
        return 0;
    }
    (void)memcpy(words, data, whole);
    (void)memcpy(&head, words, sizeof head);
    (void)memcpy(head.magic, PLAN_MAGIC, sizeof head.magic);
    head.order = PLAN_ORDER;
    head.sections = SECTIONS;
    head.size = (int64_t)whole;
    head.hash = UINT64_C(0xcbf29ce484222325);
    for (i = sizeof head / 8; i < whole / 8; i++) {
        head.hash = (head.hash ^ words[i]) * UINT64_C(0x100000001b3);
    }
    (void)memcpy(words, &head, sizeof head);
    if (rv_plan_check(words, whole) < 0) {
        (void)memset(&s, 0, sizeof s);
        s.seed = head.hash;
        s.more = 400;
        judge(words, whole, s);
    }
    free(words);
    return 0;
}

#else

#define PLANS_MOST 256

static void *plans[PLANS_MOST];
static size_t plan_sizes[PLANS_MOST];
static size_t plan_count;

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    const char *path = getenv("RVMON_PLANS");
    FILE *file = (path != NULL) ? fopen(path, "rb") : NULL;
    int64_t size;
    (void)argc;
    (void)argv;
    while ((file != NULL) && (plan_count < PLANS_MOST) && (fread(&size, sizeof size, 1, file) == 1)) {
        void *one = malloc((size_t)size);
        if ((one == NULL) || (fread(one, (size_t)size, 1, file) != 1)) {
            abort();
        }
        plans[plan_count] = one;
        plan_sizes[plan_count] = (size_t)size;
        plan_count++;
    }
    if (plan_count == 0) {
        (void)fprintf(stderr, "no plans in $RVMON_PLANS\n");
        exit(2);
    }
    (void)fclose(file);
    return 0;
}

#ifdef SNAPSHOTS

static void put_word(uint8_t *at, uint64_t word)
{
    int32_t i;
    for (i = 0; i < 8; i++) {
        at[i] = (uint8_t)(word >> (8 * i));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const rv_memory memory = {malloc, realloc, free, NULL, 0};
    const size_t wanted = size + 31;
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    uint8_t *bytes;
    rv_monitor *m;
    source from;
    size_t i;
    if (size < 1) {
        return 0;
    }
    from.plan = plans[data[0] % plan_count];
    from.size = plan_sizes[data[0] % plan_count];
    from.forged = false;
    bytes = malloc(wanted); /* exactly this size, so that accesses beyond it are detected */
    if (bytes == NULL) {
        return 0;
    }
    for (i = 1; i < size; i++) {
        bytes[31 + i] = data[i];
        hash = (hash ^ data[i]) * UINT64_C(0x100000001b3);
    }
    (void)memcpy(bytes, "rvvshot3", 8);
    put_word(&bytes[8], ((const plan_header *)from.plan)->hash);
    put_word(&bytes[16], wanted);
    put_word(&bytes[24], hash);
    m = rv_new(from.plan, from.size, memory);
    if ((m != NULL) && (rv_keep_notes(m, NULL, NULL) == RV_OK) && (rv_load(m, bytes, wanted) == RV_OK)) {
        const int64_t reached = rv_times_of(m).reached;
        script s;
        (void)memset(&s, 0, sizeof s);
        s.seed = hash;
        s.more = 200;
        m = taken_up(m, from);
        from.forged = true;
        (void)run_on(&m, s, (reached == RV_NO_TIME) ? 0 : reached, &from);
    }
    rv_free(m);
    free(bytes);
    if (guarded_in_use != 0) {
        (void)fprintf(stderr, "%zu bytes are not given back\n", guarded_in_use);
        abort();
    }
    return 0;
}

#else

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    script s;
    size_t which;
    if (size < 4) {
        return 0;
    }
    which = data[0] % plan_count;
    (void)memset(&s, 0, sizeof s);
    s.data = data + 1;
    s.size = size - 1;
    judge(plans[which], plan_sizes[which], s);
    return 0;
}

#endif

#endif
