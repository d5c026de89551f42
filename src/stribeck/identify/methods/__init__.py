"""How it is fitted: static, presliding, dynamic, motion."""
