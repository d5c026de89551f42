"""C99 for firmware."""
