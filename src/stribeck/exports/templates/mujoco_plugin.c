/* {{ about[0] }} As an actuator plugin of MuJoCo.
 * {{ about[-1] }} Build it against MuJoCo's headers and library, here those of its Python package (PKG is its folder):
 *
 *   cc -O2 -shared -fPIC -IPKG/include {{ P }}.c {{ P }}_mujoco.c PKG/libmujoco.so.* -lm -o lib{{ P }}.so
 *   mujoco.mj_loadPluginLibrary("./lib{{ P }}.so"), then load {{ P }}.xml
 *
 * It samples the joint every {{ repr(b.step) }} s, at the first step of the model from then on{% if resolution %}, in counts of {{ repr(resolution) }}{% endif %}; its output acts {{ repr(delay) }} s later and
 * is held. All that it keeps is in data.plugin_state, so that copies of the data and resets are complete. RK4 asks for
 * forces between steps, where nothing is sampled: take Euler, implicit or implicitfast. */
#include <math.h>
#include <string.h>

#include <mujoco/mujoco.h>

#include "{{ P }}.h"

#define QUEUE {{ queue }} /* outputs that do not act yet, at most */
#define SAME_TIME 1e-9 /* of a period: MuJoCo adds its steps up, so that times are off by rounding */

typedef struct {
    {{ P }}_state state;
    double samples, acted, output, r, rate; /* taken, acting; the output that acts, the reference before and its rate */
    double queue[QUEUE];
} Kept;

/* In plugin_state stand what holds now, and what will hold when the step is taken. */
#define NUMBERS (sizeof(Kept) / sizeof(mjtNum))

static int own_signal(const mjModel *m, int instance)
{
    const char *word = mj_getPluginConfig(m, instance, "signal");
    return word != NULL && strcmp(word, "own") == 0;
}

static int state_numbers(const mjModel *m, int instance)
{
    (void)m; (void)instance;
    return (int)(2 * NUMBERS);
}

static int init(const mjModel *m, mjData *d, int instance)
{
    {{ P }}_parameters p;
    const char *word = mj_getPluginConfig(m, instance, "signal");
    (void)d;
    {{ P }}_defaults(&p);
    if ({{ P }}_check(&p) != {{ P }}_OK) { mju_warning("stribeck.{{ P }}: a constant is not allowed"); return -1; }
    if (word != NULL && word[0] && strcmp(word, "own") != 0 && strcmp(word, "ctrl") != 0) {
        mju_warning("stribeck.{{ P }}: signal must be own or ctrl");
        return -1;
    }
    if (m->opt.integrator == mjINT_RK4) {
        mju_warning("stribeck.{{ P }}: the integrator must be Euler, implicit or implicitfast");
        return -1;
    }
    return 0;
}

static void reset(const mjModel *m, mjtNum *plugin_state, void *plugin_data, int instance)
{
    Kept kept;
    (void)m; (void)plugin_data; (void)instance;
    memset(&kept, 0, sizeof kept);
    {{ P }}_reset(&kept.state);
    memcpy(plugin_state, &kept, sizeof kept);
    memcpy(plugin_state + NUMBERS, &kept, sizeof kept);
}

/* One sample. */
static void sample(Kept *kept, int own, double t, double position, double ctrl)
{
    {{ P }}_parameters p;
    {{ P }}_input in;
    {{ P }}_output out;
    memset(&in, 0, sizeof in);
    {{ P }}_defaults(&p);
    if (own) {
        {{ P }}_path_at(&p, t, &in);
    } else {
        const double rate = kept->samples > 0 ? (ctrl - kept->r) / {{ repr(b.step) }} : 0;
        in.r = ctrl;
{% if rate %}
        in.r_rate = rate;
{% endif %}
{% if second %}
        in.r_second = kept->samples > 1 ? (rate - kept->rate) / {{ repr(b.step) }} : 0;
{% endif %}
        kept->r = ctrl;
        kept->rate = rate;
    }
    in.y = {% if resolution %}floor(position / {{ repr(resolution) }} + 0.5) * {{ repr(resolution) }}{% else %}position{% endif %};
    if ({{ P }}_step(&p, &kept->state, &in, &out) != {{ P }}_OK) out.u = 0; /* not finite: nothing is put out */
    kept->queue[(int)fmod(kept->samples, QUEUE)] = out.u;
    kept->samples++;
}

static void compute(const mjModel *m, mjData *d, int instance, int capability)
{
    mjtNum *place = d->plugin_state + m->plugin_stateadr[instance];
    const double now = d->time + SAME_TIME * {{ repr(b.step) }};
    (void)capability;
    for (int i = 0; i < m->nu; i++) {
        Kept kept;
        if (m->actuator_plugin[i] != instance) continue;
        memcpy(&kept, place, sizeof kept);
        while (kept.samples * {{ repr(b.step) }} <= now)
            sample(&kept, own_signal(m, instance), kept.samples * {{ repr(b.step) }}, d->actuator_length[i], d->ctrl[i]);
        while (kept.acted * {{ repr(b.step) }} + {{ repr(delay) }} <= now) {
            kept.output = kept.queue[(int)fmod(kept.acted, QUEUE)];
            kept.acted++;
        }
        d->actuator_force[i] = kept.output;
        memcpy(place + NUMBERS, &kept, sizeof kept);
    }
}

static void advance(const mjModel *m, mjData *d, int instance)
{
    mjtNum *place = d->plugin_state + m->plugin_stateadr[instance];
    memcpy(place, place + NUMBERS, sizeof(Kept));
}

mjPLUGIN_LIB_INIT({{ P }})
{
    static const char *const attributes[] = { "signal" };
    mjpPlugin plugin;
    mjp_defaultPlugin(&plugin);
    plugin.name = "stribeck.{{ P }}";
    plugin.nattribute = 1;
    plugin.attributes = attributes;
    plugin.capabilityflags |= mjPLUGIN_ACTUATOR;
    plugin.nstate = state_numbers;
    plugin.init = init;
    plugin.reset = reset;
    plugin.compute = compute;
    plugin.advance = advance;
    mjp_registerPlugin(&plugin);
}
