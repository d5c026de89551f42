"""The paper as a report: one module a chapter, each with a function ``chapter(done)``."""
