/*
{% for line in about %}
 *{{ " " + line if line else "" }}
{% endfor %}
 *
 * Once a sample, call the function ..._step with what is measured at time t, put u out at once, and hold it until
 * the next sample{% if period %} (the scenario samples every {{ repr(period) }} s){% endif %}. To give the desired path yourself, call ..._track instead.
{% if kept %}
 * The states go on by dt with what was measured held: x + dt phi_1(J dt) dx/dt, J = d(dx/dt)/dx, phi_1(a) = (e^a - 1)/a,
 * exact where dx/dt is linear in x (zero-order hold). Stribeck's simulation with drive.sample_time does the same.
{% endif %}
 *
 * Every function returns {{ P }}_OK or an error; on an error
 * nothing that it points to is changed: put the valve where it is safe then.
 * There is no allocation, no input or output, no global state. For single precision compile everything with
 * -D{{ P | upper }}_FLOAT; t then moves in steps of 0.2 ms after an hour: begin it anew, or
 * give the path yourself.
 */
{% include "real.h" %}

/* Constants, named and grouped as in the scenario; ..._defaults fills them in, ..._check tells whether they are allowed. */
typedef struct {
{% for group, constants in cascade.constants.items() %}
    struct { /* {{ groups[group] }} */
{% for name, (c, value) in constants.items() %}
        {{ P }}_real {{ name }}; /* {{ (c.unit or "1") | plain }}: {{ c.meaning | plain }}, {{ c.allowed }} */
{% endfor %}
    } {{ group }};
{% endfor %}
} {{ P }}_parameters;

/* What is kept from sample to sample. */
typedef struct {
{% for column, start in kept %}
    {{ P }}_real {{ column.name }}; /* {{ column.unit | plain }}: {{ column.meaning | plain }} */
{% else %}
    {{ P }}_real {{ unused.name }}; /* without an observer there is none: stays 0 */
{% endfor %}
} {{ P }}_state;

/* The desired position and its derivatives. */
typedef struct {
{% for column in path %}
    {{ P }}_real {{ column.name }}; /* {{ column.unit | plain }}: {{ column.meaning | plain }} */
{% endfor %}
} {{ P }}_path;

/* What is measured, all at the same time. */
typedef struct {
{% for column in inputs %}
    {{ P }}_real {{ column.name }}; /* {{ column.unit | plain }}: {{ column.meaning | plain }} */
{% endfor %}
} {{ P }}_measured;

/* What the controller computes: u is for the valve, the others are for whoever watches. */
typedef struct {
{% for column in outputs %}
    {{ P }}_real {{ column.name }}; /* {{ column.unit | plain }}: {{ column.meaning | plain }} */
{% endfor %}
} {{ P }}_output;

enum {
    {{ P }}_OK = 0,
    {{ P }}_NOT_FINITE, /* an argument, the state or the result is inf or nan */
    {{ P }}_BAD_STEP, /* dt must be > 0 */
{% for group, constants in cascade.constants.items() %}
{% for name, (c, value) in constants.items() %}
    {{ P }}_BAD_{{ group }}_{{ name }}, /* {{ name }} must be {{ c.allowed }} */
{% endfor %}
{% endfor %}
};

/* The constants that were exported. */
void {{ P }}_defaults({{ P }}_parameters *p);

/* {{ P }}_OK, or which constant is not allowed. Call it once: the other functions take what they are given. */
int {{ P }}_check(const {{ P }}_parameters *p);

/* The state before the first sample. */
void {{ P }}_reset({{ P }}_state *s);

/* The scenario's path ({{ cascade.scenario.signal.kind }}) at the time t (s). */
int {{ P }}_path_at(const {{ P }}_parameters *p, {{ P }}_real t, {{ P }}_path *path);

/* One sample on the scenario's path: measured at the time t (s), the next one follows dt (s) later. */
int {{ P }}_step(const {{ P }}_parameters *p, {{ P }}_state *s, {{ P }}_real t, const {{ P }}_measured *measured,
    {{ P }}_real dt, {{ P }}_output *output);

/* The same on a path of your own. It must have three continuous derivatives, and these must be its own. */
int {{ P }}_track(const {{ P }}_parameters *p, {{ P }}_state *s, const {{ P }}_path *path,
    const {{ P }}_measured *measured, {{ P }}_real dt, {{ P }}_output *output);

#ifdef __cplusplus
}
#endif
#endif
