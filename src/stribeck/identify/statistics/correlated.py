"""Least squares under noise that remembers: an autoregressive model of it, and the covariance that it makes."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_toeplitz

from stribeck.arrays import Array

_LONGEST_MEMORY = 50  # samples, of the noise model


def noise_memory(misfit: Array) -> Array:
    """The coefficients a_1, a_2, ... of r_t = a_1 r_(t-1) + a_2 r_(t-2) + ... + white noise; none for white noise."""
    n = len(misfit)
    longest = min(_LONGEST_MEMORY, n // 20)
    if longest < 1 or not misfit.any():
        return np.zeros(0)
    centred = misfit - misfit.mean()
    spectrum = abs(np.fft.rfft(centred, 2 * n)) ** 2
    correlation = np.fft.irfft(spectrum)[: longest + 1] / n
    best, chosen = n * np.log(correlation[0]), np.zeros(0)
    for order in range(1, longest + 1):
        a = solve_toeplitz(correlation[:order], correlation[1 : order + 1])
        left = correlation[0] - a @ correlation[1 : order + 1]
        score = n * np.log(max(left, 1e-300)) + order * np.log(n)
        if score < best:
            best, chosen = score, a
    return np.asarray(chosen)


def covariance(slopes: Array, variance: float, memory: Array) -> Array:
    """The covariance of a least squares estimate whose residuals have that variance and that memory."""
    size = np.sqrt(np.mean(slopes**2, axis=0))
    size = np.where(size > 0, size, 1.0)
    scaled = slopes / size
    # a direction that nothing determines gets a variance that is huge, and finite
    normal = scaled.T @ scaled
    inverse = np.linalg.inv(normal + 1e-14 * np.trace(normal) * np.eye(len(normal)))
    if not len(memory):
        return np.asarray(variance * inverse / np.outer(size, size))
    n = len(scaled)
    waves = np.fft.rfft(scaled, 2 * n, axis=0)
    frequency = np.exp(-1j * np.pi * np.arange(n + 1) / n)
    gain = abs(1 - np.polyval(np.append(memory[::-1], 0.0), frequency)) ** -2.0
    both = np.ones(n + 1)
    both[1:-1] = 2.0  # the negative frequencies too
    gain *= 2 * n / float(both @ gain)  # the residuals' variance is the one given
    middle = np.real(waves.conj().T @ (waves * (both * gain)[:, None])) / (2 * n)
    return np.asarray(variance * inverse @ middle @ inverse / np.outer(size, size))


def supporting_samples(slopes: Array) -> Array:
    """How many samples each coordinate rests on: of its slopes, less what the others can imitate, (sum s^2)^2/sum s^4."""
    found = np.zeros(slopes.shape[1])
    for k in range(slopes.shape[1]):
        others = np.delete(slopes, k, axis=1)
        own = slopes[:, k]
        if others.shape[1]:
            own = own - others @ np.linalg.lstsq(others, own, rcond=1e-12)[0]
        fourth = float(np.sum(own**4))
        found[k] = float(np.sum(own**2)) ** 2 / fourth if fourth > 0 else 0.0
    return found
