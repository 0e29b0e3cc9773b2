/* The native driver's stepping loop once more, in C, to see what the compiled Python costs.
 *
 * It works on the solver that gearidae's own open_solver has set up, calls the same SUNDIALS library, and reaches the
 * same guard, history, interpolation and output functions through their addresses. Keep it in step with
 * gearidae.engine.step.advance and gearidae.engine.integrate.roots.
 */
#include <math.h>
#include <stdint.h>

extern int IDASolve(void *, double, double *, void *, void *, int);
extern int IDAGetCurrentTime(void *, double *);
extern int IDAGetCurrentStep(void *, double *);
extern int IDAGetNumSteps(void *, long *);

enum { ONE_STEP = 2, TSTOP_RETURN = 1, ROOT_RETURN = 2 };
enum { GO_ON, AFRESH, DONE, BROKEN }; /* what `finish` answers */
enum { TRIES = 3 }; /* that of gearidae.engine.integrate.roots */

/* Order of gearidae_bench.c_calls.addresses. What lies at `words` and `numbers` only these functions know. */
typedef struct {
    int32_t (*finish)(int64_t *words, double *numbers, int32_t flag, double *events);
    void (*observe)(int64_t *words, double *numbers, double t, double *row);
    int32_t (*restart)(int64_t *words, double *numbers, int32_t again);
    double (*guard)(int64_t *words, double *numbers, double t);
    void (*keep)(int64_t *words, double *numbers);
    void (*state_at)(int64_t *words, double *numbers, double t);
} calls_t;

typedef struct {
    const calls_t *call;
    int64_t *words;
    double *numbers, *t; /* the time reached is one of the numbers */
    void *solver, *yy, *yyp;
    double low, low_time, step_end, stop_time, sharp;
    int rest, stop;
} search_t;

static void state_at(search_t *s, double t)
{
    s->call->state_at(s->words, s->numbers, t);
}

static double look(const search_t *s, double t)
{
    return s->call->guard(s->words, s->numbers, t);
}

static double rounding(const search_t *s)
{
    double step = 0.0;
    IDAGetCurrentStep(s->solver, &step);
    return 100.0 * 0x1p-52 * (fabs(s->step_end) + fabs(step));
}

static double inverse(double a, double at_a, double b, double at_b, double c, double at_c)
{
    return a * at_b * at_c / ((at_a - at_b) * (at_a - at_c)) + b * at_a * at_c / ((at_b - at_a) * (at_b - at_c))
           + c * at_a * at_b / ((at_c - at_a) * (at_c - at_b));
}

static double find(search_t *s, double high)
{
    double a = s->low_time, b = s->step_end, low = s->low, c = a, left = low, here = b, wide = b - a;
    const double tolerance = fmax(rounding(s), s->sharp * (b - a));
    int tries = 0;
    while (b - a > tolerance && (b - a) * high < tolerance * (high - low)) {
        here = b - (b - a) * high / (high - low);
        if (left != low && left != high)
            here = inverse(a, low, b, high, c, left);
        here += 0.5 * tolerance;
        if (++tries % TRIES == 0) {
            const int slow = b - a > 0.5 * wide;
            wide = b - a;
            if (slow)
                here = 0.5 * (a + b);
        }
        here = fmin(fmax(here, a + 0.25 * tolerance), b - 0.25 * tolerance);
        state_at(s, here);
        const double value = look(s, here);
        if (value < 0.0) {
            c = b, left = high, b = here, high = value;
        } else {
            c = a, left = low, a = here, low = value;
        }
    }
    if (here != b)
        state_at(s, b);
    return b;
}

static int at_stop(search_t *s)
{
    s->stop = 0;
    *s->t = s->stop_time;
    state_at(s, *s->t);
    return TSTOP_RETURN;
}

static int next_time(search_t *s, double end)
{
    double *t = s->t;
    if (s->rest) {
        s->low = look(s, *t), s->low_time = *t;
        if (fabs(s->step_end - *t) <= rounding(s))
            s->rest = 0;
    }
    const int rest = s->rest;
    if (rest) {
        *t = s->step_end;
        state_at(s, *t);
    } else if (s->stop) {
        return at_stop(s);
    } else {
        int flag = IDASolve(s->solver, end, t, s->yy, s->yyp, ONE_STEP);
        if (flag < 0)
            return flag;
        s->call->keep(s->words, s->numbers);
        if (flag == TSTOP_RETURN) {
            s->stop = 1, s->stop_time = *t;
            IDAGetCurrentTime(s->solver, t);
            state_at(s, *t);
        }
    }
    const double high = look(s, *t);
    if (s->low > 0.0 && high < 0.0) {
        s->step_end = *t;
        s->rest = 1;
        *t = find(s, high);
        return ROOT_RETURN;
    }
    s->low = high, s->low_time = *t;
    s->rest = 0;
    return s->stop && !rest ? at_stop(s) : 0;
}

static int start(search_t *s, int again)
{
    const int flag = s->call->restart(s->words, s->numbers, again);
    s->low = look(s, *s->t), s->low_time = *s->t;
    s->rest = s->stop = 0;
    return flag;
}

static int64_t steps(void *solver)
{
    long number = 0;
    IDAGetNumSteps(solver, &number);
    return number;
}

/* Run to the end; 0 if all went well, and the steps taken. */
int gearidae_loop(const calls_t *call, int64_t *words, double *numbers, double *t, void *solver, void *yy, void *yyp,
                  double sharp, double end, int64_t total, int64_t columns, double *rows, double *events,
                  int64_t *taken)
{
    search_t s = {call, words, numbers, t, solver, yy, yyp};
    s.sharp = sharp;
    const double spacing = end / (double)(total - 1);
    int64_t next = 1;
    int flag = start(&s, 0);
    while (flag == 0) {
        flag = next_time(&s, end);
        if (flag < 0)
            return flag;
        while (next < total) {
            const double sample = next < total - 1 ? (double)next * spacing : end;
            if (sample > *t)
                break;
            call->observe(words, numbers, sample, rows + next * columns);
            next++;
        }
        const int then = call->finish(words, numbers, flag, events);
        flag = 0;
        if (then == GO_ON)
            continue;
        *taken += steps(solver);
        if (then == DONE)
            return 0;
        if (then == BROKEN)
            return 1;
        flag = start(&s, 1);
    }
    return flag;
}
