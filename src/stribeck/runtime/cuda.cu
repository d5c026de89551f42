/* Numbers and operations for one trajectory in a thread of a GPU: what vector.c is for the lanes of a processor, with a
   single lane. C++ for NVRTC; any other C++ compiler makes of it one thread after the other, which the tests run. */
#if defined(__CUDACC_RTC__)
typedef signed char int8_t;
typedef long long int64_t;
#define NAN __longlong_as_double(0x7ff8000000000000LL) /* NVRTC has no headers */
#define INFINITY __longlong_as_double(0x7ff0000000000000LL)
#define HUGE_VAL INFINITY
#define INT64_MAX 0x7fffffffffffffffLL
#else
#include <cmath>
#include <cstddef>
#include <cstdint>
using std::exp, std::floor, std::atan, std::fabs, std::sqrt, std::log, std::sin, std::cos, std::tanh, std::pow, std::copysign;
#endif
#if defined(__CUDACC__)
#define DEVICE __device__
#define __atomic_fetch_add(place, value, order) \
    ((int64_t)atomicAdd((unsigned long long *)(place), (unsigned long long)(value)))
#define __atomic_load_n(place, order) (*(const volatile int64_t *)(place))
#else
#define DEVICE
#endif
#define UNUSED [[maybe_unused]]
#define EXPORT extern "C" DEVICE
#define LANES 1
#define GROUPS 1

struct mask {
    int64_t x;
    mask() = default;
    DEVICE mask(int64_t value) : x(value) {}
    DEVICE int64_t &operator[](int) { return x; }
    DEVICE int64_t operator[](int) const { return x; }
    DEVICE mask operator~() const { return ~x; }
    DEVICE void operator-=(mask other) { x -= other.x; }
    DEVICE void operator+=(mask other) { x += other.x; }
    DEVICE void operator|=(mask other) { x |= other.x; }
    DEVICE void operator&=(mask other) { x &= other.x; }
};
UNUSED static DEVICE inline mask operator&(mask a, mask b) { return a.x & b.x; }
UNUSED static DEVICE inline mask operator|(mask a, mask b) { return a.x | b.x; }
UNUSED static DEVICE inline mask operator^(mask a, mask b) { return a.x ^ b.x; }
UNUSED static DEVICE inline mask operator+(mask a, mask b) { return a.x + b.x; }
UNUSED static DEVICE inline mask operator-(mask a, mask b) { return a.x - b.x; }
UNUSED static DEVICE inline mask operator>=(mask a, mask b) { return -(int64_t)(a.x >= b.x); } /* true is -1, as in vectors */
UNUSED static DEVICE inline mask operator<(mask a, mask b) { return -(int64_t)(a.x < b.x); }

struct real {
    double x;
    real() = default;
    DEVICE real(double value) : x(value) {}
    DEVICE double &operator[](int) { return x; }
    DEVICE double operator[](int) const { return x; }
    DEVICE real operator-() const { return -x; }
    DEVICE void operator+=(real other) { x += other.x; }
    DEVICE void operator-=(real other) { x -= other.x; }
    DEVICE void operator*=(real other) { x *= other.x; }
    DEVICE void operator/=(real other) { x /= other.x; }
};
UNUSED static DEVICE inline real operator+(real a, real b) { return a.x + b.x; }
UNUSED static DEVICE inline real operator-(real a, real b) { return a.x - b.x; }
UNUSED static DEVICE inline real operator*(real a, real b) { return a.x * b.x; }
UNUSED static DEVICE inline real operator/(real a, real b) { return a.x / b.x; }
UNUSED static DEVICE inline mask operator<(real a, real b) { return -(int64_t)(a.x < b.x); }
UNUSED static DEVICE inline mask operator<=(real a, real b) { return -(int64_t)(a.x <= b.x); }
UNUSED static DEVICE inline mask operator>(real a, real b) { return -(int64_t)(a.x > b.x); }
UNUSED static DEVICE inline mask operator>=(real a, real b) { return -(int64_t)(a.x >= b.x); }
UNUSED static DEVICE inline mask operator==(real a, real b) { return -(int64_t)(a.x == b.x); }
UNUSED static DEVICE inline mask operator!=(real a, real b) { return -(int64_t)(a.x != b.x); }

UNUSED static DEVICE inline real splat(double x) { return x; }
UNUSED static DEVICE inline real choose(mask condition, real a, real b) { return condition.x ? a : b; }
UNUSED static DEVICE inline real larger(real a, real b) { return a.x > b.x ? a : b; }
UNUSED static DEVICE inline real smaller(real a, real b) { return a.x < b.x ? a : b; }
UNUSED static DEVICE inline unsigned lanes_in(mask m) { return m.x != 0; }
UNUSED static DEVICE inline int first_lane(unsigned) { return 0; }
UNUSED static DEVICE inline real abs_of(real a) { return fabs(a.x); }
UNUSED static DEVICE inline real sign_of(real a) { return (double)((a.x > 0) - (a.x < 0)); }
UNUSED static DEVICE inline real sqrt_of(real a) { return sqrt(a.x); }
UNUSED static DEVICE inline real log_of(real a) { return log(a.x); }
UNUSED static DEVICE inline real sin_of(real a) { return sin(a.x); }
UNUSED static DEVICE inline real cos_of(real a) { return cos(a.x); }
UNUSED static DEVICE inline real tanh_of(real a) { return tanh(a.x); }
UNUSED static DEVICE inline real floor_of(real a) { return floor(a.x); }
UNUSED static DEVICE inline real pow_of(real a, real b) { return pow(a.x, b.x); }
UNUSED static DEVICE inline real exp_of(real a) { return exp(a.x); }
UNUSED static DEVICE inline real atan_of(real a) { return atan(a.x); }
UNUSED static DEVICE inline real inverse_tenth_root(real a) { return (double)powf((float)a.x, -0.1f); }
#define static static DEVICE
