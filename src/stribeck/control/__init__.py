"""Controllers that compensate friction: their equations, written once, and their Lyapunov function."""
