"""The estimator: builds a library of models for a record, chooses one, and gives every estimate two uncertainties."""
