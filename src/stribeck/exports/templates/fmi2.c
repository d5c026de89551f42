
/* ---- FMI 2.0 ---- */

typedef struct {
    Model model;
    fmi2CallbackFunctions callbacks;
    char name[128];
} Instance;

#define MODEL(i) (&((Instance *)(i))->model)

static fmi2Status fail(fmi2Component i, const char *message)
{
    const Instance *instance = (const Instance *)i;
    if (instance->callbacks.logger)
        instance->callbacks.logger(instance->callbacks.componentEnvironment, instance->name, fmi2Error, "logStatusError", message);
    return fmi2Error;
}

static fmi2Status checked(fmi2Component i)
{
    const char *problem = wrong(MODEL(i));
    return problem ? fail(i, problem) : fmi2OK;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component i, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    UNUSED(i); UNUSED(on); UNUSED(n); UNUSED(categories);
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String path,
    const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *i;
    UNUSED(path); UNUSED(visible); UNUSED(logging);
{% if exchange %}
    UNUSED(type);
{% else %}
    if (type != fmi2CoSimulation) {
        if (callbacks && callbacks->logger)
            callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "this FMU is for co-simulation only");
        return NULL;
    }
{% endif %}
    if (!guid || strcmp(guid, "{{ token }}") != 0) {
        if (callbacks && callbacks->logger)
            callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "the GUID is not that of this FMU");
        return NULL;
    }
    i = calloc(1, sizeof *i);
    if (!i) return NULL;
    if (callbacks) i->callbacks = *callbacks;
    if (name) strncpy(i->name, name, sizeof i->name - 1);
    start(&i->model);
    return i;
}

void fmi2FreeInstance(fmi2Component i) { free(i); }

fmi2Status fmi2SetupExperiment(fmi2Component i, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
    fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    UNUSED(stopTimeDefined); UNUSED(stopTime);
    if (!isfinite(startTime)) return fail(i, "the start time is not finite");
    if (toleranceDefined && (!(tolerance >= 0) || !isfinite(tolerance))) return fail(i, "the tolerance must be a finite number > 0");
    MODEL(i)->time = startTime;
    if (toleranceDefined && tolerance > 0) MODEL(i)->tolerance = tolerance;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component i) { UNUSED(i); return fmi2OK; }

fmi2Status fmi2ExitInitializationMode(fmi2Component i)
{
    MODEL(i)->initialized = 1;
    return checked(i);
}

fmi2Status fmi2EnterEventMode(fmi2Component i) { UNUSED(i); return fmi2OK; }
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component i) { return checked(i); }
fmi2Status fmi2Terminate(fmi2Component i) { UNUSED(i); return fmi2OK; }

fmi2Status fmi2Reset(fmi2Component i)
{
    start(MODEL(i));
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component i, const fmi2ValueReference references[], size_t n, fmi2Real values[])
{
    for (size_t k = 0; k < n; ++k) {
        double value = 0;
        if (computed(references[k]) && checked(i) != fmi2OK) return fmi2Error;
        if (!get(MODEL(i), references[k], &value)) return fail(i, "there is no Real of this reference");
        if (!isfinite(value)) return fail(i, "a variable is not finite");
        values[k] = value;
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component i, const fmi2ValueReference references[], size_t n, const fmi2Real values[])
{
    for (size_t k = 0; k < n; ++k)
        if (!set(MODEL(i), references[k], values[k])) return fail(i, "there is no Real of this reference that can be set");
    return fmi2OK;
}

#define NONE(name, type)                                                                              \
    fmi2Status fmi2Get##name(fmi2Component i, const fmi2ValueReference r[], size_t n, type values[])       \
    {                                                                                                 \
        UNUSED(r); UNUSED(values);                                                                    \
        return n ? fail(i, "there is no variable of type " #name) : fmi2OK;                           \
    }                                                                                                 \
    fmi2Status fmi2Set##name(fmi2Component i, const fmi2ValueReference r[], size_t n, const type values[]) \
    {                                                                                                 \
        UNUSED(r); UNUSED(values);                                                                    \
        return n ? fail(i, "there is no variable of type " #name) : fmi2OK;                           \
    }
NONE(Integer, fmi2Integer)
NONE(Boolean, fmi2Boolean)
NONE(String, fmi2String)

{% include "fmi_state.c" %}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component i, const fmi2ValueReference unknowns[], size_t nUnknowns,
    const fmi2ValueReference knowns[], size_t nKnowns, const fmi2Real seed[], fmi2Real result[])
{
    if (checked(i) != fmi2OK) return fmi2Error;
    for (size_t j = 0; j < nUnknowns; ++j) {
        result[j] = 0;
        for (size_t k = 0; k < nKnowns; ++k) {
            double value;
            if (!partial(MODEL(i), unknowns[j], knowns[k], &value)) return fail(i, "there is no derivative of this by that");
            result[j] += value * seed[k];
        }
        if (!isfinite(result[j])) return fail(i, "a derivative is not finite");
    }
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component i, fmi2EventInfo *info)
{
    memset(info, 0, sizeof *info);
{% if events is defined %}
    double next;
    if (checked(i) != fmi2OK) return fmi2Error;
    info->valuesOfContinuousStatesChanged = update(MODEL(i), &next) ? fmi2True : fmi2False;
    info->nextEventTimeDefined = next < INFINITY ? fmi2True : fmi2False;
    info->nextEventTime = next < INFINITY ? next : 0;
{% endif %}
    return checked(i);
}

{% include "fmi_exchange.c" %}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component i, const fmi2ValueReference r[], size_t n, const fmi2Integer orders[],
    const fmi2Real values[])
{
    UNUSED(r); UNUSED(n); UNUSED(orders); UNUSED(values);
    return fail(i, "inputs are held over a step");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component i, const fmi2ValueReference r[], size_t n, const fmi2Integer orders[],
    fmi2Real values[])
{
    UNUSED(r); UNUSED(n); UNUSED(orders); UNUSED(values);
    return fail(i, "outputs have no derivatives");
}

fmi2Status fmi2DoStep(fmi2Component i, fmi2Real point, fmi2Real step, fmi2Boolean noSet)
{
    const char *problem;
    UNUSED(noSet);
    if (!MODEL(i)->initialized) return fail(i, "the instance is not initialized");
    if (checked(i) != fmi2OK) return fmi2Error;
    if (!isfinite(point + step)) return fail(i, "the communication point or the step is not finite");
    MODEL(i)->time = point;
    problem = advance_model(MODEL(i), step);
    if (problem) return fail(i, problem);
    MODEL(i)->time = point + step;
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component i) { return fail(i, "a step does not wait"); }

#define NO_STATUS(name, type)                                                              \
    fmi2Status fmi2Get##name(fmi2Component i, const fmi2StatusKind kind, type *value)      \
    {                                                                                      \
        UNUSED(i); UNUSED(kind); UNUSED(value);                                            \
        return fmi2Discard;                                                                \
    }
NO_STATUS(Status, fmi2Status)
NO_STATUS(RealStatus, fmi2Real)
NO_STATUS(IntegerStatus, fmi2Integer)
NO_STATUS(BooleanStatus, fmi2Boolean)
NO_STATUS(StringStatus, fmi2String)
