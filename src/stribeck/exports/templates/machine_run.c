/* {{ about[0] }} Runs it and writes its columns as CSV: {{ P }}_run [t_end [step]] */
#include <stdio.h>
#include <stdlib.h>
#include <math.h>

#include "{{ P }}.h"

int main(int count, char **words)
{
    const double t_end = count > 1 ? atof(words[1]) : {{ t_end }}, step = count > 2 ? atof(words[2]) : {{ step }};
    double row[{{ P | upper }}_COLUMNS];
    {{ P }}_machine *m = malloc({{ P }}_size());
    if (!m || !(step > 0)) return 2;
    {{ P }}_start(m);
    printf("t");
    for (int i = 0; i < {{ P | upper }}_COLUMNS; i++) printf(",%s", {{ P }}_column_names[i]);
    for (long i = 0; i <= (long)floor(t_end / step + 1e-9); i++) {
        const int status = {{ P }}_advance(m, (double)i * step);
        if (status != {{ P | upper }}_DONE) {
            fprintf(stderr, "ended at t = %.9g s: %d\n", {{ P }}_time(m), status);
            return 1;
        }
        {{ P }}_columns(m, row);
        printf("\n%.17g", {{ P }}_time(m));
        for (int k = 0; k < {{ P | upper }}_COLUMNS; k++) printf(",%.17g", row[k]);
    }
    printf("\n");
    free(m);
    return 0;
}
