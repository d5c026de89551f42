"""Kept outputs: what commands and calls say and write, beside what is kept in ``outputs/``.

``python -m tests.kept`` renews the kept files and prints what changed; words after it choose cases by their names.
"""
