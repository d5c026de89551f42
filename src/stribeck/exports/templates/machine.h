/*
{% for line in about | wrapped %}
 *{{ " " + line if line else "" }}
{% endfor %}
 *
 * Fill in a machine with {{ P }}_start (at t = 0), change its constants, inputs and states, and call {{ P }}_advance
 * for each time that is wanted: the signals are those of the file, and each input is added to one of them, held until it
 * is changed. Sampled controllers take their samples and put out their outputs on their own.
{% if noise_end %}
 * The noise of the readings is that of the file until t = {{ noise_end }} s; there is none after it.
{% endif %}
 * There is no allocation, no input or output, no global state: a machine can be copied with memcpy.
 */
#ifndef {{ P | upper }}_H
#define {{ P | upper }}_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {{ P }}_machine {{ P }}_machine;

enum { {{ P | upper }}_DONE = 0, {{ P | upper }}_MORE = 1 /* too many steps were needed: call it again */,
       {{ P | upper }}_STEP_TOO_SMALL = -1, {{ P | upper }}_NOT_FINITE = -2, {{ P | upper }}_BAD_CONSTANT = -3,
       {{ P | upper }}_STALLED = -4 /* steps so short that the end is 1e12 of them away */ };

/* What {{ P }}_columns fills in, by place. */
enum {
{% for column in m.columns %}
    {{ P | upper }}_{{ m.column_names[column.name] }} = {{ loop.index0 }}, /* {{ (column.unit or "1") | plain }}: {{ column.meaning | plain }} */
{% endfor %}
    {{ P | upper }}_COLUMNS = {{ m.columns | length }}
};

/* States, which {{ P }}_states gives by place. */
enum {
{% for state in m.machine.states %}
    {{ P | upper }}_X_{{ m.state_names[state.name] }} = {{ loop.index0 }}, /* {{ (state.unit or "1") | plain }}: {{ state.meaning | plain }} */
{% endfor %}
    {{ P | upper }}_STATES = {{ m.machine.states | length }}
};

/* Constants, and inputs (which are 0), that {{ P }}_constants gives by place; a change holds from the next step on. */
enum {
{% for each in m.parameters %}
    {{ P | upper }}_P_{{ each.name }} = {{ loop.index0 }}, /* {{ (each.constant.unit or "1") | plain }}: {{ each.constant.meaning | plain }} ({{ each.path }}) */
{% endfor %}
    {{ P | upper }}_CONSTANTS = {{ m.parameters | length }}
};

size_t {{ P }}_size(void); /* of a machine, in bytes; its place must be aligned as for a double */
void {{ P }}_start({{ P }}_machine *m);
int {{ P }}_advance({{ P }}_machine *m, double t); /* {{ P | upper }}_DONE, or why it ended at an earlier time */
double {{ P }}_time(const {{ P }}_machine *m);
/* For a solver of your own, in the place of {{ P }}_advance: the time derivatives of the states at the time that {{ P }}_at
 * sets. At t = 0, and at each time that it returns, {{ P }}_happen lets signals go on and controllers sample and act. */
void {{ P }}_rates(const {{ P }}_machine *m, double out[{{ P | upper }}_STATES]);
void {{ P }}_at({{ P }}_machine *m, double t);
double {{ P }}_happen({{ P }}_machine *m, double t); /* the next such time, or infinity; it may change the state E_in */
void {{ P }}_columns(const {{ P }}_machine *m, double out[{{ P | upper }}_COLUMNS]);
double *{{ P }}_states({{ P }}_machine *m);
double *{{ P }}_constants({{ P }}_machine *m);
void {{ P }}_tolerance({{ P }}_machine *m, double rtol); /* the file's is {{ wanted }} */
const char *{{ P }}_wrong(const {{ P }}_machine *m); /* which constant is not allowed, and what is; or NULL */
extern const char *const {{ P }}_column_names[{{ P | upper }}_COLUMNS];

#ifdef __cplusplus
}
#endif
#endif
