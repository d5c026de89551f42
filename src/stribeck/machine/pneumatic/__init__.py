"""A pneumatic cylinder, its cascade and its observer: equations, written once."""
