{## The state of an FMU kept, brought back and written down, alike in FMI 2.0 and 3.0 but for the names. #}
{% set F = "fmi%d" % fmi %}
{% set Handle, State, De = ("fmi2Component", "FMUstate", "DeSerialize") if fmi == 2 else ("fmi3Instance", "FMUState", "Deserialize") %}
{{ F }}Status {{ F }}Get{{ State }}({{ Handle }} i, {{ F }}{{ State }} *state)
{
    if (!*state) *state = malloc(sizeof(Model));
    if (!*state) return fail(i, "there is no memory");
    memcpy(*state, MODEL(i), sizeof(Model));
    return {{ F }}OK;
}

{{ F }}Status {{ F }}Set{{ State }}({{ Handle }} i, {{ F }}{{ State }} state)
{
    memcpy(MODEL(i), state, sizeof(Model));
    return {{ F }}OK;
}

{{ F }}Status {{ F }}Free{{ State }}({{ Handle }} i, {{ F }}{{ State }} *state)
{
    UNUSED(i);
    free(*state);
    *state = NULL;
    return {{ F }}OK;
}

{{ F }}Status {{ F }}Serialized{{ State }}Size({{ Handle }} i, {{ F }}{{ State }} state, size_t *size)
{
    UNUSED(i); UNUSED(state);
    *size = sizeof(Model);
    return {{ F }}OK;
}

{{ F }}Status {{ F }}Serialize{{ State }}({{ Handle }} i, {{ F }}{{ State }} state, {{ F }}Byte bytes[], size_t size)
{
    if (size < sizeof(Model)) return fail(i, "there is no room for the state");
    memcpy(bytes, state, sizeof(Model));
    return {{ F }}OK;
}

{{ F }}Status {{ F }}{{ De }}{{ State }}({{ Handle }} i, const {{ F }}Byte bytes[], size_t size, {{ F }}{{ State }} *state)
{
    if (size < sizeof(Model)) return fail(i, "this is no state of this FMU");
    if (!*state) *state = malloc(sizeof(Model));
    if (!*state) return fail(i, "there is no memory");
    memcpy(*state, bytes, sizeof(Model));
    return {{ F }}OK;
}
