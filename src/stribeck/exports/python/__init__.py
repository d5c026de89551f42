"""Laws as objects of other Python libraries; each function needs its library."""

from stribeck.exports.python.jax import to_jax
from stribeck.exports.python.torch import to_torch

__all__ = ["to_jax", "to_torch"]
