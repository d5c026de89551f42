/* {{ about[0] }}
 * {{ about[-1] }} What it does and how to use it: {{ P }}.h. */
#include "{{ P }}.h"

#include <math.h>

#ifdef __FAST_MATH__
#error "-ffast-math takes nan and inf for impossible: the checks of this file need them"
#endif

{% include "real.c" %}
#ifdef {{ P | upper }}_FLOAT
#define SLOWEST 1e-15F
#else
#define SLOWEST 1e-100
#endif
{% if eq.uses("sign") %}

static real sign_of(real x) { return R((x > 0) - (x < 0)); }
{% endif %}
{% if inputs %}

/* The constants, and what the contact is given at this instant. */
typedef struct {
    parameters p;
    {{ P }}_load load;
} given;
{% endif %}

/* ---- the equations ---- */

static real rate_of(const {{ call.type }} *p, real v, real z)
{
{{ eq.body([("return", "rate")], ["p", "v", "z"]) }}
}

static real force_of(const {{ call.type }} *p, real v, real z, real rate)
{
{{ eq.body([("return", "force_at_rate")], ["p", "v", "z", "rate"]) }}
}
{% if law.has_z %}

/* F while v is held, whose sign is side. */
static real steady_force_of(const {{ call.type }} *p, real v, real side)
{
{{ eq.body([("return", "steady_force")], ["p", "v", "side"]) }}
}
{% if eq.linear %}

/* dz/dt = a z + b at this velocity. */
static void hold(const {{ call.type }} *p, real v, real *a, real *b)
{
{{ eq.body([("*a", "a"), ("*b", "b")], ["p", "v"]) }}
}
{% else %}

/* dz/dt, and its derivative by z. */
static real rate_and_slope(const {{ call.type }} *p, real v, real z, real *slope)
{
{{ eq.body([("*slope", "rate_z"), ("return", "rate")], ["p", "v", "z"]) }}
}
{% endif %}
{% endif %}
{% if smooth or with_body %}

/* F and the derivatives of dz/dt and F by v and z. */
typedef struct {
    real force, rate_v, rate_z, force_v, force_z;
} Slopes;

static void slopes(const {{ call.type }} *p, real v, real z, Slopes *l)
{
{{ eq.body([("l->force", "force"), ("l->rate_v", "rate_v"), ("l->rate_z", "rate_z"), ("l->force_v", "force_v"), ("l->force_z", "force_z")], ["p", "v", "z"]) }}
}
{% endif %}

/* ---- the bristle over a step ---- */
{% if law.has_z %}

{% include "phi_1.c" %}
{% if eq.linear %}

/* z after dt with v held; pull is added to dz/dt. */
static real advance(const {{ call.type }} *p, real v, real pull, real z, real dt)
{
    real a, b;
    hold(p, v, &a, &b);
    return FN(exp)(a * dt) * z + dt * phi_1(a * dt) * (b + pull);
}
{% if with_body %}

/* z after an implicit step. */
static real settle(const {{ call.type }} *p, real v, real z, real dt)
{
    real a, b;
    hold(p, v, &a, &b);
    return (z + dt * b) / (1 - dt * a);
}
{% endif %}
{% else %}

/* The root x of x = z + dt (dz/dt(v, x) + pull) between z and far: Newton's step where it stays inside, else the middle.
 * dz/dt falls with z, so there is one root. */
static real implicit(const {{ call.type }} *p, real v, real pull, real z, real far, real dt)
{
    real near = z, x = far, first;
    const real rate = rate_and_slope(p, v, z, &first) + pull, guess = z + dt * rate / (1 - dt * first);
    if ((guess - near) * (guess - far) < 0) x = guess;
    for (int i = 0; i < 60; ++i) {
        real slope;
        const real excess = x - z - dt * (rate_and_slope(p, v, x, &slope) + pull);
        if (FN(fabs)(excess) <= EPSILON * (FN(fabs)(x) + FN(fabs)(z) + dt * FN(fabs)(v))) break;
        if ((excess < 0) == (far > z)) near = x; else far = x;
        const real newton = x - excess / (1 - dt * slope);
        x = (newton - near) * (newton - far) < 0 ? newton : near + (far - near) / 2;
    }
    return x;
}

/* z after dt with v held; pull is added to dz/dt. One step, or up to 64 where the slope changes on the way; what would
 * overshoot even then is left to one implicit step. */
static real advance(const {{ call.type }} *p, real v, real pull, real z, real dt)
{
    const real shortest = dt / 64;
    real left = dt, h = dt, slope, after;
    real rate = rate_and_slope(p, v, z, &slope) + pull;
    while (left > 0) {
        if (h > left) h = left;
        const real next = z + h * phi_1(slope * h) * rate;
        if (!(h > 0) || !isfinite(next)) return next; /* no time is left that a number could hold, or no number */
        if (FN(fabs)(next - z) <= 4 * EPSILON * FN(fabs)(z)) return next; /* steady */
        const real next_rate = rate_and_slope(p, v, next, &after) + pull;
        const int overshoots = (rate > 0 && next_rate < 0) || (rate < 0 && next_rate > 0);
        if ((overshoots || FN(fabs)(after - slope) * h > R(0.05)) && h > shortest) {
            h = h > 2 * shortest ? h / 2 : shortest;
            continue;
        }
        if (overshoots) return implicit(p, v, pull, z, z + left * phi_1(slope * left) * rate, left);
        z = next;
        rate = next_rate;
        slope = after;
        left -= h;
        h *= 2;
    }
    return z;
}
{% if with_body %}

/* z after an implicit step. */
static real settle(const {{ call.type }} *p, real v, real z, real dt)
{
    const real rate = rate_of(p, v, z);
    return rate > 0 || rate < 0 ? implicit(p, v, R(0), z, z + dt * rate, dt) : z;
}
{% endif %}
{% endif %}
{% if eq.bounded %}

/* Rounding must not carry z over its bound. */
static real within(const {{ call.type }} *p, real z, real before)
{
    real bound;
{{ eq.body([("bound", "bound")], ["p"]) }}
    if (FN(fabs)(before) > bound) bound = FN(fabs)(before);
    return z > bound ? bound : z < -bound ? -bound : z;
}
{% endif %}
{% else %}

/* There is no bristle: the force follows the velocity at once. */
static real advance(const {{ call.type }} *p, real v, real pull, real z, real dt)
{
    (void)p; (void)v; (void)pull; (void)dt;
    return z;
}
{% if with_body %}

static real settle(const {{ call.type }} *p, real v, real z, real dt)
{
    return advance(p, v, R(0), z, dt);
}
{% endif %}
{% endif %}

/* ---- what the header declares ---- */

void {{ P }}_defaults(parameters *p)
{
{% for name, (c, value) in constants.items() %}
    p->{{ name }} = R({{ repr(value) }}); /* {{ (c.unit or "1") | plain }} */
{% endfor %}
}

int {{ P }}_check(const parameters *p)
{
{% for name, (c, value) in constants.items() %}
    if (!isfinite(p->{{ name }}){% if c.above is not none %} || !(p->{{ name }} > R({{ repr(c.above + 0.0) }})){% elif c.at_least is not none %} || !(p->{{ name }} >= R({{ repr(c.at_least + 0.0) }})){% endif %}) return {{ P }}_BAD_{{ name }};
{% endfor %}
{% for key, allowed, condition in relations %}
    if (!({{ condition }})) return {{ P }}_BAD_{{ key }}; /* must be {{ allowed }} */
{% endfor %}
    return {{ P }}_OK;
}

void {{ P }}_reset({{ P }}_state *s) { s->z = R({{ repr(start.z) }}); }
{% if with_body %}

void {{ P }}_body_reset({{ P }}_body *s)
{
    s->y = R({{ repr(start.y) }});
    s->v = R({{ repr(start.v) }});
    s->z = R({{ repr(start.z) }});
}
{% endif %}

/* Gives the result out where it is finite. */
static int give(real value, real *result)
{
    if (!isfinite(value)) return {{ P }}_NOT_FINITE;
    *result = value;
    return {{ P }}_OK;
}

int {{ P }}_force({{ call.declared_inside }}, real v, real z, real *force)
{
{{ call.begin }}    if (!isfinite(v) || !isfinite(z)) return {{ P }}_NOT_FINITE;
    return give(force_of(p, v, z, rate_of(p, v, z)), force);
}

int {{ P }}_rate({{ call.declared_inside }}, real v, real z, real *rate)
{
{{ call.begin }}    if (!isfinite(v) || !isfinite(z)) return {{ P }}_NOT_FINITE;
    return give(rate_of(p, v, z), rate);
}
{% if smooth %}

int {{ P }}_force_rate({{ call.declared_inside }}, real v, real z, real dv_dt, real *force_rate)
{
{{ call.begin }}    Slopes l;
    if (!isfinite(v) || !isfinite(z) || !isfinite(dv_dt)) return {{ P }}_NOT_FINITE;
    slopes(p, v, z, &l);
    return give(l.force_v * dv_dt + l.force_z * rate_of(p, v, z), force_rate);
}
{% endif %}

int {{ P }}_steady_force({{ call.declared_inside }}, real v, real *force)
{
{{ call.begin }}    if (!isfinite(v)) return {{ P }}_NOT_FINITE;
    if (!(v < 0 || v > 0)) return give(R(0), force);
{% if not law.has_z %}
    return give(force_of(p, v, R(0), R(0)), force);
{% else %}
    const real w = FN(fabs)(v) < SLOWEST ? (v < 0 ? -SLOWEST : SLOWEST) : v; /* slower: products would vanish */
    return give(steady_force_of(p, w, R(w > 0 ? 1 : -1)), force);
{% endif %}
}

static int step(const {{ call.type }} *p, {{ P }}_state *s, real v, real dt, real pull, real *force)
{
    if (!isfinite(v) || !isfinite(s->z) || !isfinite(pull)) return {{ P }}_NOT_FINITE;
    if (!(dt > 0) || !isfinite(dt)) return {{ P }}_BAD_STEP;
    {{ "" if law.has_z and eq.bounded else "const " }}real z = advance(p, v, pull, s->z, dt);
{% if law.has_z and eq.bounded %}
    if (!(pull < 0 || pull > 0)) z = within(p, z, s->z);
{% endif %}
    const real F = force_of(p, v, z, rate_of(p, v, z) + pull);
    if (!isfinite(z) || !isfinite(F)) return {{ P }}_NOT_FINITE;
    s->z = z;
    *force = F;
    return {{ P }}_OK;
}

int {{ P }}_step({{ call.declared_inside }}, {{ P }}_state *s, real v, real dt, real *force)
{
{{ call.begin }}    return step(p, s, v, dt, R(0), force);
}

int {{ P }}_compensate({{ call.declared_inside }}, const {{ P }}_compensator *c, {{ P }}_state *s, real v, real *force)
{
{{ call.begin }}    {{ P }}_state next = *s; /* which stays where it is when the force is not finite */
    real F = 0;
    if (!(c->gain >= 0) || !isfinite(c->gain)) return {{ P }}_BAD_GAIN;
    int status = step(p, &next, v, c->dt, R(0), &F);
    if (status == {{ P }}_OK) status = give(c->gain * F, force);
    if (status == {{ P }}_OK) *s = next;
    return status;
}
{% if with_observer %}

int {{ P }}_observer_step({{ call.declared_inside }}, {{ P }}_state *s, real v, real error, real K, real dt, real *force)
{
{{ call.begin }}    real pull;
    if (!(K >= 0) || !isfinite(K)) return {{ P }}_BAD_GAIN;
{{ eq.body([("pull", "pull")], ["p", "K", "error"]) }}
    return step(p, s, v, dt, pull, force);
}
{% endif %}
{% if with_body %}

/* What accelerates the body, and its derivative by the friction. */
static real net_force(real u, real F) { return {{ net_force.value }}; }
static const real net_force_by_F = {{ net_force.by_F }};

/* How far a velocity w at the end of the step is from balance, {{ u("N") }}; z there, the derivative by w, the friction, and the
 * sum of the absolute terms. */
typedef struct {
    real excess, z, slope, force, terms;
} Balance;

static Balance balance(const {{ call.type }} *p, const {{ P }}_body *s, real mass, real u, real dt, real w)
{
    Balance r;
    Slopes l;
    const real inertia = mass / dt;
    r.z = settle(p, w, s->z, dt);
    slopes(p, w, r.z, &l);
    r.force = l.force;
    r.excess = inertia * (w - s->v) - net_force(u, l.force);
    r.slope = inertia - net_force_by_F * (l.force_v + l.force_z * dt * l.rate_v / (1 - dt * l.rate_z));
    r.terms = inertia * (FN(fabs)(w) + FN(fabs)(s->v)) + FN(fabs)(l.force) + FN(fabs)(u)
        + FN(fabs)(l.force_v * w) + FN(fabs)(l.force_z * r.z);
    return r;
}

int {{ P }}_body_step({{ call.declared_inside }}, {{ P }}_body *s, real mass, real u, real dt, real *force)
{
{{ call.begin }}    if (!isfinite(s->y) || !isfinite(s->v) || !isfinite(s->z) || !isfinite(u)) return {{ P }}_NOT_FINITE;
    if (!(dt > 0) || !isfinite(dt)) return {{ P }}_BAD_STEP;
    if (!(mass > 0) || !isfinite(mass)) return {{ P }}_BAD_MASS;
    real near = s->v, far = near, w = near, move = 0;
    Balance r = balance(p, s, mass, u, dt, w);
    const int above = r.excess > 0; /* at near; the root lies below it then */
    int enclosed = 0;
    for (int i = 0; i < 300 && !(FN(fabs)(r.excess) <= 2 * EPSILON * r.terms); ++i) {
        if (!isfinite(r.excess)) return {{ P }}_NOT_FINITE;
        if ((r.excess > 0) == above) near = w; else { far = w; enclosed = 1; }
        if (enclosed && FN(fabs)(far - near) <= EPSILON * (FN(fabs)(near) + FN(fabs)(s->v))) break;
        const real newton = w - r.excess / r.slope;
        if (enclosed) {
            w = (newton - near) * (newton - far) < 0 ? newton : near + (far - near) / 2;
            if (!(w < near || w > near) || !(w < far || w > far)) break;
        } else { /* on, twice as far each time, until the excess changes its sign */
            move = i == 0 ? -r.excess / (r.slope > mass / dt ? r.slope : mass / dt) : 2 * move;
            w = near + move;
        }
        r = balance(p, s, mass, u, dt, w);
    }
    if (!(FN(fabs)(r.excess) <= 1e3F * EPSILON * r.terms) && !enclosed) return {{ P }}_NO_SOLUTION;
    const real y = s->y + dt * w, F = r.force + r.excess / net_force_by_F; /* where the force jumps, between its two sides */
    if (!isfinite(y) || !isfinite(w) || !isfinite(r.z) || !isfinite(F)) return {{ P }}_NOT_FINITE;
    s->y = y;
    s->v = w;
    s->z = r.z;
    *force = F;
    return {{ P }}_OK;
}
{% endif %}
