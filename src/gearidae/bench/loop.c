/* The native driver's stepping loop once more, in C, to see what the compiled Python costs; IDA finds the roots here.
 *
 * It works on the solver that gearidae's own open_solver has set up, calls the same SUNDIALS library, and reaches the
 * same residual, guard, history and output functions through their addresses. Keep it in step with
 * gearidae.engine.native.advance.
 */
#include <stdint.h>

extern int IDASolve(void *, double, double *, void *, void *, int);
extern int IDAGetDky(void *, double, int, void *);
extern int IDAReInit(void *, double, void *, void *);
extern int IDASetInitStep(void *, double);
extern int IDASetStopTime(void *, double);
extern int IDARootInit(void *, int, int (*)(double, void *, void *, double *, void *));
extern int IDASetRootDirection(void *, int *);
extern int IDASetNoInactiveRootWarn(void *);
extern int IDAGetNumSteps(void *, long *);
extern int IDAGetNumResEvals(void *, long *);

enum { ONE_STEP = 2, TSTOP_RETURN = 1, ROOT_RETURN = 2 };
enum { CONTINUE = 0, RESTART = 1 };

/* Order of gearidae.bench.c_loop.CALLS. */
typedef struct {
    void (*accept)(double *d, double t, double *y, double *yp, int32_t flag);
    int32_t (*handle)(double *d, double t, double *y, double *events, int64_t *count);
    void (*observe)(double *d, double t, double *y, double *row);
    double (*start)(double *d, double t, double *y, double *yp, double *scale, double rtol, double longest);
    int (*guard)(double t, void *yy, void *yyp, double *out, void *d);
} calls_t;

static int start(const calls_t *call, void *solver, void *yy, void *yyp, double *d, double t, double *y, double *yp,
                 double *scale, double rtol, double end)
{
    double first = call->start(d, t, y, yp, scale, rtol, end - t);
    int flag = IDAReInit(solver, t, yy, yyp);
    flag |= IDASetInitStep(solver, first);
    flag |= IDASetStopTime(solver, end);
    return flag;
}

static void count(void *solver, int64_t *counts)
{
    long number = 0;
    IDAGetNumSteps(solver, &number);
    counts[0] += number;
    IDAGetNumResEvals(solver, &number);
    counts[1] += number;
}

/* Run to the end; 0 if all went well. counts: steps, residual evaluations. */
int gearidae_loop(const calls_t *call, void *solver, void *yy, void *yyp, void *dkyy, double *d, double *y, double *yp,
                  double *dky, double *scale, double rtol, double end, int64_t total, int64_t columns, double *rows,
                  double *events, int64_t room, int64_t *counts)
{
    const double spacing = end / (double)(total - 1);
    double t = 0.0;
    int64_t next = 1, happened = 0;
    int falling = -1;
    int flag = IDARootInit(solver, 1, call->guard);
    flag |= IDASetRootDirection(solver, &falling);
    flag |= IDASetNoInactiveRootWarn(solver);
    flag |= start(call, solver, yy, yyp, d, t, y, yp, scale, rtol, end);
    while (flag == 0) {
        flag = IDASolve(solver, end, &t, yy, yyp, ONE_STEP);
        if (flag < 0)
            return flag;
        while (next < total) {
            double sample = next < total - 1 ? (double)next * spacing : end;
            if (sample > t)
                break;
            IDAGetDky(solver, sample, 0, dkyy);
            call->observe(d, sample, dky, rows + next * columns);
            next++;
        }
        call->accept(d, t, y, yp, flag);
        if (flag == ROOT_RETURN) {
            if (happened >= room)
                happened = 0;
            int32_t action = call->handle(d, t, y, events, &happened);
            flag = 0;
            if (action == RESTART) {
                count(solver, counts);
                flag = start(call, solver, yy, yyp, d, t, y, yp, scale, rtol, end);
            } else if (action != CONTINUE) {
                return 1;
            }
        } else if (flag == TSTOP_RETURN) {
            count(solver, counts);
            return 0;
        }
    }
    return flag;
}
