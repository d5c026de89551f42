"""C that does not depend on the system: operations and the solver, compiled together with the generated code."""
