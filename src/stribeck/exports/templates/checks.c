static int failures;

static void check(const char *what, double found, double expected, double tolerance)
{
    if (fabs(found - expected) <= tolerance) return;
    printf("%s: %.17g, expected %.17g within %.3g\n", what, found, expected, tolerance);
    ++failures;
}

static void must(const char *what, int status, int expected)
{
    if (status == expected) return;
    printf("%s: status %d, expected %d\n", what, status, expected);
    ++failures;
}
