{## Model exchange, alike in FMI 2.0 and 3.0 but for the names. #}
{% set F = "fmi%d" % fmi %}
#ifndef X
#define X(m) ((m)->x)
#define TOUCHED(m) ((void)0)
#endif

{% set Handle, Real = ("fmi2Component", "fmi2Real") if fmi == 2 else ("fmi3Instance", "fmi3Float64") %}
{{ F }}Status {{ F }}CompletedIntegratorStep({{ Handle }} i, {{ F }}Boolean noSet, {{ F }}Boolean *event, {{ F }}Boolean *terminate)
{
    UNUSED(i); UNUSED(noSet);
    *event = *terminate = {{ F }}False;
    return {{ F }}OK;
}

{{ F }}Status {{ F }}SetTime({{ Handle }} i, {{ Real }} time)
{
    if (!isfinite(time)) return fail(i, "the time is not finite");
    MODEL(i)->time = time;
    TOUCHED(MODEL(i));
    return {{ F }}OK;
}

{{ F }}Status {{ F }}SetContinuousStates({{ Handle }} i, const {{ Real }} x[], size_t n)
{
    if (n != STATES) return fail(i, "this is not the number of states");
    for (size_t k = 0; k < n; ++k)
        if (!isfinite(x[k])) return fail(i, "a state is not finite");
    for (size_t k = 0; k < n; ++k) X(MODEL(i))[k] = x[k];
    TOUCHED(MODEL(i));
    return {{ F }}OK;
}

{{ F }}Status {{ F }}GetContinuousStates({{ Handle }} i, {{ Real }} x[], size_t n)
{
    if (n != STATES) return fail(i, "this is not the number of states");
    for (size_t k = 0; k < n; ++k) x[k] = X(MODEL(i))[k];
    return {{ F }}OK;
}

{{ F }}Status {{ F }}Get{{ 'Derivatives' if fmi == 2 else 'ContinuousStateDerivatives' }}({{ Handle }} i, {{ Real }} rates[], size_t n)
{
    Evaluation e;
    if (n != STATES) return fail(i, "this is not the number of states");
    if (checked(i) != {{ F }}OK) return {{ F }}Error;
    evaluate(MODEL(i), &e);
    for (size_t k = 0; k < n; ++k) {
        if (!isfinite(e.rate[k])) return fail(i, "the derivative of a state is not finite");
        rates[k] = e.rate[k];
    }
    return {{ F }}OK;
}

{{ F }}Status {{ F }}GetNominalsOfContinuousStates({{ Handle }} i, {{ Real }} nominals[], size_t n)
{
    static const double nominal[STATES + 1] = { {% for state in states %}{{ repr(state.nominal) }}, {% endfor %}0 };
    if (n != STATES) return fail(i, "this is not the number of states");
    for (size_t k = 0; k < n; ++k) nominals[k] = nominal[k];
    return {{ F }}OK;
}

{{ F }}Status {{ F }}GetEventIndicators({{ Handle }} i, {{ Real }} values[], size_t n)
{
    UNUSED(values);
    return n ? fail(i, "there are no event indicators") : {{ F }}OK;
}
