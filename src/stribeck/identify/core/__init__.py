"""The estimator: a record becomes a library of models, one is chosen, and every number gets two uncertainties."""
