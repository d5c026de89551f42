"""The commands' names, options and help, by subject; what each does is a file of :mod:`stribeck.cli`."""
