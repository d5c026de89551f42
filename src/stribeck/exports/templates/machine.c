/* {{ about[0] }}
 * {{ about[-1] }} See {{ P }}.h. */
{{ code }}

/* ---- The machine: its values, and what is made of the functions above. ------------------------------------------------ */
#include <string.h>
#include "{{ P }}.h"

static const double DEFAULTS[] = {
    {{ values }}};
static const double STARTS[] = {
    {{ starts }}};
static const double TOLERANCES[] = { /* absolute, of each state */
    {{ atol }}};
static const double FIXED[] = {{ "{" }}{{ fixed }}}; /* 1 for those that do not follow the motion */
static const double PIECE_START[] = { /* when the signals' pieces begin */
    {{ piece_start }}};
static const double PIECE_ROWS[] = { /* their numbers */
    {{ piece_rows }}};
static const int8_t PIECE_RESTART[] = {{ "{" }}{{ piece_restart }}};
{% if noise_room %}
static const double NOISE[] = { /* standard normal numbers, one a sample */
    {{ noise }}};
{% else %}
#define NOISE NULL
{% endif %}
#define PARAMETERS (sizeof(Parameters) / sizeof(double))
#define ROOM {{ room }} /* outputs that wait at most, of each controller */
#define MEMORY {{ memory }} /* numbers that sampled controllers remember */

struct {{ P }}_machine {
    Run run;
    double constants[PARAMETERS], acting[PARAMETERS];
    double x[N], atol[N], fixed_atol[N], atol_now[N], row[N + HELD + SHOWN];
    double held[HELD + 1], memory[MEMORY + 1], queue[(HELD + 1) * ROOM];
    double none[WATCHES + 1];
    int64_t sampled[HELD + 1], acted[HELD + 1];
    int begun;
};

const char *const {{ P }}_column_names[{{ P | upper }}_COLUMNS] = {
{% for column in m.columns %}
    "{{ column.name }}",
{% endfor %}
};

size_t {{ P }}_size(void) { return sizeof({{ P }}_machine); }

void {{ P }}_start({{ P }}_machine *m)
{
    memset(m, 0, sizeof *m);
    memcpy(m->constants, DEFAULTS, sizeof m->constants);
    memcpy(m->x, STARTS, sizeof m->x);
    {{ P }}_tolerance(m, {{ wanted }});
    m->run.h = m->run.h_smallest = INFINITY;
    m->run.h_limit = {{ limit }};
    m->run.step = 1;
    m->run.pieces = {{ pieces }};
    m->run.rows = 1;
    m->run.queue_room = ROOM;
    m->run.noise_room = {{ noise_room }};
    m->run.event_room = stribeck_event_room();
}

void {{ P }}_tolerance({{ P }}_machine *m, double rtol)
{
{% if held %}
    const double share = fmin(fmax({{ low }} * pow(1e-6 / rtol, {{ power }}), {{ low }}), {{ high }}); /* that one step may err by */
{% else %}
    const double share = {{ rtol }} / {{ wanted }}; /* that one step may err by */
{% endif %}
    m->run.rtol = fmax(share * rtol, 1e-13);
    for (int i = 0; i < N; i++) {
        m->atol[i] = TOLERANCES[i] / {{ rtol }} * m->run.rtol;
        m->fixed_atol[i] = FIXED[i] * m->atol[i];
    }
}

/* The pointers of a machine that may have been copied. */
static void bind({{ P }}_machine *m)
{
    m->run.parameters = m->acting;
    m->run.atol = m->atol;
    m->run.fixed_atol = m->fixed_atol;
    m->run.atol_now = m->atol_now;
    m->run.x = m->x;
    m->run.piece_start = PIECE_START;
    m->run.piece_rows = PIECE_ROWS;
    m->run.piece_restart = PIECE_RESTART;
    m->run.out = m->row;
    m->run.thresholds = m->none; /* all 0: no events are noted */
    m->run.held = m->held;
    m->run.memory = m->memory;
    m->run.queue = m->queue;
    m->run.noise = NOISE;
    m->run.sampled = m->sampled;
    m->run.acted = m->acted;
}

const char *{{ P }}_wrong(const {{ P }}_machine *m)
{
    const Parameters *p = (const Parameters *)m->constants;
    (void)p;
{% for each, allowed, test in m.conditions %}
    if (!({{ test }})) return "{{ each.path }} must be {{ allowed }}";
{% endfor %}
{% for place, each in m.inputs.items() %}
    if (!isfinite(m->constants[{{ place }}])) return "{{ each.name }} must be a finite number";
{% endfor %}
    return NULL;
}

/* Constants that were changed, inputs among them, act from now on. */
static void take_constants({{ P }}_machine *m)
{
    if (!memcmp(m->acting, m->constants, sizeof m->acting)) return;
#if MOVED >= 0
    if (m->begun) {
        const Run *run = &m->run;
        PRESENT(piece)
        Coefficients before, after;
        prepare((const Parameters *)m->acting, &before);
        prepare((const Parameters *)m->constants, &after);
        m->x[MOVED] += moved_energy((const Parameters *)m->constants, &after, piece, m->run.t, m->x)
                       - moved_energy((const Parameters *)m->acting, &before, piece, m->run.t, m->x);
    }
#endif
    memcpy(m->acting, m->constants, sizeof m->acting);
    m->run.restart = JUMP;
}

int {{ P }}_advance({{ P }}_machine *m, double t)
{
    bind(m);
    if ({{ P }}_wrong(m)) return {{ P | upper }}_BAD_CONSTANT;
    int finite = t == t;
    for (int i = 0; i < N; i++) finite &= m->x[i] - m->x[i] == 0; /* neither infinite nor nan */
    if (!finite) return {{ P | upper }}_NOT_FINITE;
    take_constants(m);
    m->begun = 1;
    m->run.t_end = t;
    m->run.attempts_left = {{ max_steps }};
    return stribeck_advance(&m->run);
}

/* When a signal goes on, or a controller samples or acts, the next time. */
static double next_of(const {{ P }}_machine *m, const Parameters *p)
{
    double next = INFINITY;
    (void)p;
    if (m->run.piece + 1 < m->run.pieces) next = PIECE_START[m->run.piece + 1];
#if HELD > 0
    double timing[2 * HELD];
    find_timing(p, timing);
    next = smaller(next, next_output(&m->run, timing));
    for (int i = 0; i < HELD; i++) next = smaller(next, (double)m->sampled[i] * timing[i]);
#endif
    return next;
}

double {{ P }}_happen({{ P }}_machine *m, double t)
{
    const Parameters *p = (const Parameters *)m->acting;
    Coefficients c;
    bind(m);
    take_constants(m);
    prepare(p, &c);
    const double due = next_of(m, p);
    m->run.t = m->begun && due > t && due <= t * (1 + 1e-9) ? due : t; /* a time that another program computed */
    pass(&m->run, p, &c, !m->begun);
    m->run.t = t;
    m->begun = 1;
    m->run.row = 1;
    return next_of(m, p);
}

/* A machine as it is now: one that has not begun has taken the samples of its start. */
static void settle(const {{ P }}_machine *m, {{ P }}_machine *now)
{
    *now = *m;
    bind(now);
    if (!now->begun) {{ P }}_happen(now, m->run.t);
}

void {{ P }}_rates(const {{ P }}_machine *m, double out[{{ P | upper }}_STATES])
{
    {{ P }}_machine now;
    settle(m, &now);
    const Run *run = &now.run;
    PRESENT(piece)
    const Parameters *p = (const Parameters *)now.constants;
    Coefficients c;
    prepare(p, &c);
    rates(p, &c, piece, now.run.t, now.x, out);
}

void {{ P }}_at({{ P }}_machine *m, double t) { m->run.t = t; }
double {{ P }}_time(const {{ P }}_machine *m) { return m->run.t; }
double *{{ P }}_states({{ P }}_machine *m) { return m->x; }
double *{{ P }}_constants({{ P }}_machine *m) { return m->constants; }

void {{ P }}_columns(const {{ P }}_machine *m, double out[{{ P | upper }}_COLUMNS])
{
    {{ P }}_machine now;
    settle(m, &now);
    const Run *run = &now.run;
    PRESENT(piece)
    columns((const Parameters *)now.constants, piece, now.run.t, now.x,{{ " (const Memory *)now.memory," if memory }} out);
}
