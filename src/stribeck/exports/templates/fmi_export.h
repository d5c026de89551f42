#ifndef FMI_EXPORT
#if defined _WIN32 || defined __CYGWIN__
#define FMI_EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define FMI_EXPORT __attribute__((visibility("default")))
#else
#define FMI_EXPORT
#endif
#endif
