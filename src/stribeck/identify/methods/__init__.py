"""How it is fitted: static, dynamic, motion."""
