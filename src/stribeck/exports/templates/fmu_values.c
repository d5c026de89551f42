    switch (reference) {
{% for variable in variables %}
    case {{ variable.reference }}: *value = {{ variable.c }}; return 1; /* {{ variable.name }} */
{% endfor %}
    default: return 0;
    }
}

static int set(Model *m, unsigned reference, double value)
{
    switch (reference) {
{% for variable in variables if variable.settable %}
    case {{ variable.reference }}: {{ variable.c }} = value; return 1; /* {{ variable.name }} */
{% endfor %}
    default: return 0;
    }
}

/* Whether it is computed from the constants, which must then be allowed. */
static int computed(unsigned reference)
{
    switch (reference) {
{% for variable in variables if not variable.settable and variable.causality != "independent" %}
    case {{ variable.reference }}: return 1; /* {{ variable.name }} */
{% endfor %}
    default: return 0;
    }
}
