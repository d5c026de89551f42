/* Checks {{ P }}.c against values computed by stribeck: exit status 0 when all agree.
 * cc -std=c99 {{ P }}.c {{ P }}_test.c -lm && ./a.out */
#include <math.h>
#include <stdio.h>

#include "{{ P }}.h"

typedef {{ P }}_real real;
#define R(x) ((real)(x))
#ifdef {{ P | upper }}_FLOAT
#define EPSILON 1.1920929e-7
#else
#define EPSILON 2.220446049250313e-16
#endif
