/* (e^x - 1)/x */
static real phi_1(real x) { return FN(fabs)(x) < EPSILON ? R(1) : FN(expm1)(x) / x; }
