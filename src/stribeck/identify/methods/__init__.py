"""Methods of fits: static, dynamic, motion."""
