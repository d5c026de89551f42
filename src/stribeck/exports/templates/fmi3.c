
/* ---- FMI 3.0 ---- */

typedef struct {
    Model model;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Instance;

#define MODEL(i) (&((Instance *)(i))->model)

static fmi3Status fail(fmi3Instance i, const char *message)
{
    const Instance *instance = (const Instance *)i;
    if (instance->log) instance->log(instance->environment, fmi3Error, "logStatusError", message);
    return fmi3Error;
}

static fmi3Status checked(fmi3Instance i)
{
    const char *problem = wrong(MODEL(i));
    return problem ? fail(i, problem) : fmi3OK;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance i, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    UNUSED(i); UNUSED(on); UNUSED(n); UNUSED(categories);
    return fmi3OK;
}

static fmi3Instance instantiate(fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    Instance *i;
    if (!token || strcmp(token, "{{ token }}") != 0) {
        if (log) log(environment, fmi3Error, "logStatusError", "the instantiation token is not that of this FMU");
        return NULL;
    }
    i = calloc(1, sizeof *i);
    if (!i) return NULL;
    i->environment = environment;
    i->log = log;
    start(&i->model);
    return i;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    UNUSED(name); UNUSED(path); UNUSED(visible); UNUSED(logging);
{% if exchange %}
    return instantiate(token, environment, log);
{% else %}
    UNUSED(token);
    if (log) log(environment, fmi3Error, "logStatusError", "this FMU is for co-simulation only");
    return NULL;
{% endif %}
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference required[], size_t n,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    UNUSED(name); UNUSED(path); UNUSED(visible); UNUSED(logging); UNUSED(events); UNUSED(early); UNUSED(required);
    UNUSED(n); UNUSED(update);
    return instantiate(token, environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    UNUSED(name); UNUSED(token); UNUSED(path); UNUSED(visible); UNUSED(logging); UNUSED(environment); UNUSED(log);
    UNUSED(update); UNUSED(lock); UNUSED(unlock);
    return NULL;
}

void fmi3FreeInstance(fmi3Instance i) { free(i); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance i, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
    fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    UNUSED(stopTimeDefined); UNUSED(stopTime);
    if (!isfinite(startTime)) return fail(i, "the start time is not finite");
    if (toleranceDefined && (!(tolerance >= 0) || !isfinite(tolerance))) return fail(i, "the tolerance must be a finite number > 0");
    MODEL(i)->time = startTime;
    if (toleranceDefined && tolerance > 0) MODEL(i)->tolerance = tolerance;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance i)
{
    MODEL(i)->initialized = 1;
    return checked(i);
}

fmi3Status fmi3EnterEventMode(fmi3Instance i) { UNUSED(i); return fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance i) { UNUSED(i); return fmi3OK; }
fmi3Status fmi3EnterConfigurationMode(fmi3Instance i) { UNUSED(i); return fmi3OK; }
fmi3Status fmi3ExitConfigurationMode(fmi3Instance i) { UNUSED(i); return fmi3OK; }
fmi3Status fmi3EnterStepMode(fmi3Instance i) { UNUSED(i); return fmi3OK; }
fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance i) { return checked(i); }
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance i) { UNUSED(i); return fmi3OK; }

fmi3Status fmi3Reset(fmi3Instance i)
{
    start(MODEL(i));
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance i, const fmi3ValueReference references[], size_t n, fmi3Float64 values[], size_t count)
{
    if (n != count) return fail(i, "as many values as references are needed");
    for (size_t k = 0; k < n; ++k) {
        double value = 0;
        if (computed(references[k]) && checked(i) != fmi3OK) return fmi3Error;
        if (!get(MODEL(i), references[k], &value)) return fail(i, "there is no Float64 of this reference");
        if (!isfinite(value)) return fail(i, "a variable is not finite");
        values[k] = value;
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance i, const fmi3ValueReference references[], size_t n, const fmi3Float64 values[], size_t count)
{
    if (n != count) return fail(i, "as many values as references are needed");
    for (size_t k = 0; k < n; ++k)
        if (!set(MODEL(i), references[k], values[k])) return fail(i, "there is no Float64 of this reference that can be set");
    return fmi3OK;
}

#define NONE(name, type)                                                                                          \
    fmi3Status fmi3Get##name(fmi3Instance i, const fmi3ValueReference r[], size_t n, type values[], size_t count)       \
    {                                                                                                             \
        UNUSED(r); UNUSED(values); UNUSED(count);                                                                 \
        return n ? fail(i, "there is no variable of type " #name) : fmi3OK;                                       \
    }                                                                                                             \
    fmi3Status fmi3Set##name(fmi3Instance i, const fmi3ValueReference r[], size_t n, const type values[], size_t count) \
    {                                                                                                             \
        UNUSED(r); UNUSED(values); UNUSED(count);                                                                 \
        return n ? fail(i, "there is no variable of type " #name) : fmi3OK;                                       \
    }
NONE(Float32, fmi3Float32)
NONE(Int8, fmi3Int8)
NONE(UInt8, fmi3UInt8)
NONE(Int16, fmi3Int16)
NONE(UInt16, fmi3UInt16)
NONE(Int32, fmi3Int32)
NONE(UInt32, fmi3UInt32)
NONE(Int64, fmi3Int64)
NONE(UInt64, fmi3UInt64)
NONE(Boolean, fmi3Boolean)
NONE(String, fmi3String)

fmi3Status fmi3GetBinary(fmi3Instance i, const fmi3ValueReference r[], size_t n, size_t sizes[], fmi3Binary values[], size_t count)
{
    UNUSED(r); UNUSED(sizes); UNUSED(values); UNUSED(count);
    return n ? fail(i, "there is no variable of type Binary") : fmi3OK;
}

fmi3Status fmi3SetBinary(fmi3Instance i, const fmi3ValueReference r[], size_t n, const size_t sizes[], const fmi3Binary values[], size_t count)
{
    UNUSED(r); UNUSED(sizes); UNUSED(values); UNUSED(count);
    return n ? fail(i, "there is no variable of type Binary") : fmi3OK;
}

fmi3Status fmi3GetClock(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Clock values[])
{
    UNUSED(r); UNUSED(values);
    return n ? fail(i, "there is no clock") : fmi3OK;
}

fmi3Status fmi3SetClock(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Clock values[])
{
    UNUSED(r); UNUSED(values);
    return n ? fail(i, "there is no clock") : fmi3OK;
}

#define NO_CLOCK(name, unused, ...)                                       \
    fmi3Status name(fmi3Instance i, const fmi3ValueReference r[], size_t n, __VA_ARGS__) \
    {                                                                     \
        UNUSED(r); UNUSED(n); unused;                                     \
        return fail(i, "there is no clock");                              \
    }
NO_CLOCK(fmi3GetIntervalDecimal, ((void)a, (void)b), fmi3Float64 a[], fmi3IntervalQualifier b[])
NO_CLOCK(fmi3GetIntervalFraction, ((void)a, (void)b, (void)c), fmi3UInt64 a[], fmi3UInt64 b[], fmi3IntervalQualifier c[])
NO_CLOCK(fmi3GetShiftDecimal, (void)a, fmi3Float64 a[])
NO_CLOCK(fmi3GetShiftFraction, ((void)a, (void)b), fmi3UInt64 a[], fmi3UInt64 b[])
NO_CLOCK(fmi3SetIntervalDecimal, (void)a, const fmi3Float64 a[])
NO_CLOCK(fmi3SetIntervalFraction, ((void)a, (void)b), const fmi3UInt64 a[], const fmi3UInt64 b[])
NO_CLOCK(fmi3SetShiftDecimal, (void)a, const fmi3Float64 a[])
NO_CLOCK(fmi3SetShiftFraction, ((void)a, (void)b), const fmi3UInt64 a[], const fmi3UInt64 b[])

fmi3Status fmi3ActivateModelPartition(fmi3Instance i, fmi3ValueReference clock, fmi3Float64 time)
{
    UNUSED(clock); UNUSED(time);
    return fail(i, "there is no scheduled execution");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance i, fmi3ValueReference reference, size_t *n)
{
    UNUSED(reference); UNUSED(n);
    return fail(i, "dependencies stand in modelDescription.xml");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance i, fmi3ValueReference dependent, size_t a[], fmi3ValueReference b[],
    size_t c[], fmi3DependencyKind d[], size_t n)
{
    UNUSED(dependent); UNUSED(a); UNUSED(b); UNUSED(c); UNUSED(d); UNUSED(n);
    return fail(i, "dependencies stand in modelDescription.xml");
}

{% include "fmi_state.c" %}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance i, const fmi3ValueReference unknowns[], size_t nUnknowns,
    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 result[], size_t nResult)
{
    if (checked(i) != fmi3OK) return fmi3Error;
    if (nSeed != nKnowns || nResult != nUnknowns) return fail(i, "as many values as references are needed");
    for (size_t j = 0; j < nUnknowns; ++j) {
        result[j] = 0;
        for (size_t k = 0; k < nKnowns; ++k) {
            double value;
            if (!partial(MODEL(i), unknowns[j], knowns[k], &value)) return fail(i, "there is no derivative of this by that");
            result[j] += value * seed[k];
        }
        if (!isfinite(result[j])) return fail(i, "a derivative is not finite");
    }
    return fmi3OK;
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance i, const fmi3ValueReference unknowns[], size_t nUnknowns,
    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 result[], size_t nResult)
{
    if (checked(i) != fmi3OK) return fmi3Error;
    if (nSeed != nUnknowns || nResult != nKnowns) return fail(i, "as many values as references are needed");
    for (size_t k = 0; k < nKnowns; ++k) {
        result[k] = 0;
        for (size_t j = 0; j < nUnknowns; ++j) {
            double value;
            if (!partial(MODEL(i), unknowns[j], knowns[k], &value)) return fail(i, "there is no derivative of this by that");
            result[k] += value * seed[j];
        }
        if (!isfinite(result[k])) return fail(i, "a derivative is not finite");
    }
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance i, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
    fmi3Boolean *states, fmi3Boolean *timeDefined, fmi3Float64 *time)
{
    *again = *terminate = *nominals = *states = *timeDefined = fmi3False;
    *time = 0;
{% if events is defined %}
    double next;
    if (checked(i) != fmi3OK) return fmi3Error;
    *states = update(MODEL(i), &next) ? fmi3True : fmi3False;
    *timeDefined = next < INFINITY ? fmi3True : fmi3False;
    *time = next < INFINITY ? next : 0;
{% endif %}
    return checked(i);
}

{% include "fmi_exchange.c" %}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance i, size_t *n)
{
    UNUSED(i);
    *n = 0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance i, size_t *n)
{
    UNUSED(i);
    *n = STATES;
    return fmi3OK;
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Int32 orders[],
    fmi3Float64 values[], size_t count)
{
    UNUSED(r); UNUSED(n); UNUSED(orders); UNUSED(values); UNUSED(count);
    return fail(i, "outputs have no derivatives");
}

fmi3Status fmi3DoStep(fmi3Instance i, fmi3Float64 point, fmi3Float64 step, fmi3Boolean noSet, fmi3Boolean *event,
    fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
{
    const char *problem;
    UNUSED(noSet);
    *event = *terminate = *early = fmi3False;
    *last = point;
    if (!MODEL(i)->initialized) return fail(i, "the instance is not initialized");
    if (checked(i) != fmi3OK) return fmi3Error;
    if (!isfinite(point + step)) return fail(i, "the communication point or the step is not finite");
    MODEL(i)->time = point;
    problem = advance_model(MODEL(i), step);
    if (problem) return fail(i, problem);
    MODEL(i)->time = *last = point + step;
    return fmi3OK;
}
