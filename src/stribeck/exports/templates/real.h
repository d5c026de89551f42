#ifndef {{ P | upper }}_H
#define {{ P | upper }}_H

#ifdef __cplusplus
extern "C" {
#endif

#ifdef {{ P | upper }}_FLOAT
typedef float {{ P }}_real;
#else
typedef double {{ P }}_real;
#endif
