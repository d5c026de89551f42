"""From a measured log to a law's parameters."""
