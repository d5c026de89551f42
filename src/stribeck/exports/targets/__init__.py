"""The tools to write for, one file each: it declares a ``TARGET``, and is found by that."""
