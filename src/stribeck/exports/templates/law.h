/*
{% for line in about | wrapped %}
 *{{ " " + line if line else "" }}
{% endfor %}
 *
 * Every function returns {{ P }}_OK or an error; on an error nothing that it points to is changed. There is no
 * allocation, no input or output, no global state. Compile everything with -D{{ P | upper }}_FLOAT for single precision.
{% if law.has_z %}
 * {{ P }}_step: {% if eq.linear %}exact where the velocity is constant over the step (zero-order hold), for a step of any length.
{% else %}of order 2 where the velocity is constant over the step (exponential Rosenbrock-Euler, in up to 64 parts
 * where d(dz/dt)/dz changes on the way); where a part would still overshoot the steady deflection, the implicit
 * Euler rule makes the rest of the step instead, so that it never does.
{% endif %}
{% if eq.bounded %}
 * |z| never exceeds its bound, whatever the step, once it is within.
{% endif %}
 * A force that is computed from a measured velocity acts a sample late: {{ P }}_step inside a loop with a mass is
 * stable for short steps only{% if with_body %}; {{ P }}_body_step is stable for all{% endif %}.
{% endif %}
{% for line in costs %}
 * {{ line }}
{% endfor %}
 */
{% include "real.h" %}

/* Constants of the law; {{ P }}_defaults fills them in, {{ P }}_check tells whether they are allowed. */
typedef struct {
{% for name, (c, value) in constants.items() %}
    {{ P }}_real {{ name }}; /* {{ (c.unit or "1") | plain }}: {{ c.meaning | plain }}, {{ c.allowed }} */
{% endfor %}
} {{ P }}_parameters;
{% if inputs %}

/* What the contact is given at an instant; a force counts as it acts on its body. */
typedef struct {
{% for name, c in inputs.items() %}
    {{ P }}_real {{ name }}; /* {{ (c.unit or "1") | plain }}: {{ c.meaning | plain }} */
{% endfor %}
} {{ P }}_load;
{% endif %}

/* State of the law. */
typedef struct {
    {{ P }}_real z; /* {{ u("m") }}: mean bristle deflection{{ "" if law.has_z else "; this law has none, it stays 0" }} */
} {{ P }}_state;
{% if with_body %}

/* State of a body with this friction. */
typedef struct {
    {{ P }}_real y; /* {{ u("m") }}: {{ w("position") }} */
    {{ P }}_real v; /* {{ u("m/s") }}: {{ w("velocity") }} */
    {{ P }}_real z; /* {{ u("m") }}: mean bristle deflection */
} {{ P }}_body;
{% endif %}

/* What a friction compensation is set to. */
typedef struct {
    {{ P }}_real gain; /* 1: share of the friction that is compensated, 0 to 1 */
    {{ P }}_real dt; /* s: time from sample to sample, > 0 */
} {{ P }}_compensator;

enum {
    {{ P }}_OK = 0,
    {{ P }}_NOT_FINITE, /* an argument, the state or the result is inf or nan */
    {{ P }}_BAD_STEP, /* dt must be > 0 */
    {{ P }}_BAD_MASS, /* mass must be > 0 */
    {{ P }}_BAD_GAIN, /* the gain must be >= 0 */
    {{ P }}_NO_SOLUTION, /* the implicit step found no solution */
{% for name, (c, value) in constants.items() %}
    {{ P }}_BAD_{{ name }}, /* {{ name }} must be {{ c.allowed }} */
{% endfor %}
};

/* The constants that were exported. */
void {{ P }}_defaults({{ P }}_parameters *p);

/* {{ P }}_OK, or which constant is not allowed. Call it once: the other functions take what they are given. */
int {{ P }}_check(const {{ P }}_parameters *p);

/* The deflection of the start, {{ repr(start.z) }} {{ u("m") }}. */
void {{ P }}_reset({{ P }}_state *s);
{% if with_body %}

/* The body at the start: y, v and z. */
void {{ P }}_body_reset({{ P }}_body *s);
{% endif %}

/* Friction {{ w("force") }} in {{ u("N") }} at {{ w("velocity") }} v ({{ u("m/s") }}) and deflection z ({{ u("m") }}), positive when it opposes positive {{ w("velocity") }}. */
int {{ P }}_force({{ call.declared }}, {{ P }}_real v, {{ P }}_real z, {{ P }}_real *force);

/* dz/dt in {{ u("m/s") }}. */
int {{ P }}_rate({{ call.declared }}, {{ P }}_real v, {{ P }}_real z, {{ P }}_real *rate);
{% if smooth %}

/* dF/dt in {{ u("N/s") }} at acceleration dv_dt ({{ u("m/s^2") }}). */
int {{ P }}_force_rate({{ call.declared }}, {{ P }}_real v, {{ P }}_real z, {{ P }}_real dv_dt,
    {{ P }}_real *force_rate);
{% else %}

/* There is no dF/dt: it does not exist at v = 0 for this law. */
{% endif %}

/* The {{ w("friction force") }} in {{ u("N") }} when v is held for long; 0 at v = 0. */
int {{ P }}_steady_force({{ call.declared }}, {{ P }}_real v, {{ P }}_real *force);

/* One sample: the state moves on by dt (s) with the measured {{ w("velocity") }} v ({{ u("m/s") }}) held, and gives the {{ w("friction force") }} in {{ u("N") }}
 * at the end of it. */
int {{ P }}_step({{ call.declared }}, {{ P }}_state *s, {{ P }}_real v, {{ P }}_real dt, {{ P }}_real *force);

/* Friction compensation: the {{ w("force") }} in {{ u("N") }} to add to the drive's, c->gain times the friction after one sample at v ({{ u("m/s") }}).
 * With v the reference velocity it is a feedforward, and cannot destabilize the loop; with v measured it also acts on
 * what the reference does not know, but a gain of 1 leaves no margin: an F_s or F_c set too high makes it hunt. */
int {{ P }}_compensate({{ call.declared }}, const {{ P }}_compensator *c, {{ P }}_state *s, {{ P }}_real v,
    {{ P }}_real *force);

{% if with_observer %}

/* The friction observer, one sample: dz/dt = (the law's) - K sigma_0 error, v and error held over the step.
 * error ({{ u("m/s") }}) is s = de/dt + lambda e with e = y - y_desired; K ({{ "m/N" if u("m") == "m" else "rad/(N m)" }}) its gain; force ({{ u("N") }}) the friction estimated.
{% if proven_observer %}
 * Sobczyk, Perondi, Cunha, eqs 14-15. With exact knowledge of v the error of the estimate tends to zero if
 * K_D >= {{ least_K_D }}, w = -d(dz/dt)/dz at the highest speed, K_D the gain on s of the drive force.
{% else %}
 * Sobczyk, Perondi, Cunha, eqs 14-15; their proof does not cover laws in which dz/dt is not linear in z, such as this.
{% endif %}
 */
int {{ P }}_observer_step({{ call.declared }}, {{ P }}_state *s, {{ P }}_real v, {{ P }}_real error, {{ P }}_real K,
    {{ P }}_real dt, {{ P }}_real *force);
{% endif %}
{% if with_body %}

/* A body of this {{ w("mass") }} ({{ u("kg") }}) with this friction, one step under the drive {{ w("force") }} u ({{ u("N") }}), which is held: implicit Euler for
 * y, v and z together. Stable for every dt, of order 1; energy is never created where the law creates none.
 * force ({{ u("N") }}) is the friction at the end of the step. */
int {{ P }}_body_step({{ call.declared }}, {{ P }}_body *s, {{ P }}_real mass, {{ P }}_real u, {{ P }}_real dt,
    {{ P }}_real *force);
{% endif %}

#ifdef __cplusplus
}
#endif
#endif
