typedef {{ P }}_real real;
typedef {{ P }}_parameters parameters;

#define R(x) ((real)(x))
#ifdef {{ P | upper }}_FLOAT
#define FN(name) name##f
#define EPSILON 1.1920929e-7F
#else
#define FN(name) name
#define EPSILON 2.220446049250313e-16
#endif
