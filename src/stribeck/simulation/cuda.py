"""The compiled solver of many trajectories as a kernel for a GPU: one trajectory a thread, the same equations and method.

The kernel is the text that runs in the lanes of a processor with other numbers (runtime/cuda.cu): a lane of its own for
each thread, refilled from the queue that all share. CuPy compiles it with NVRTC when it is first needed.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from stribeck.codegen import source
from stribeck.codegen.source import PORTABLE, runtime_text
from stribeck.equations import Equations
from stribeck.errors import StribeckError
from stribeck.simulation.lanes import Arrays, Batch, Outcome, lane_arrays, outcome
from stribeck.simulation.variations import Variations

_THREADS = 64  # of a block
_BLOCKS_PER_PROCESSOR = 16
_STACK = 16384  # bytes a thread: the search for events halves its interval some fifty times
_KERNEL = """
#if defined(__CUDACC__)
extern "C" __global__ void stribeck_kernel(const Batch *b) { stribeck_solve_batch(b); }
#endif
"""


class NoDevice(StribeckError):
    """There is no GPU that CUDA can use; the message says what is missing."""


def kernel(system: Equations) -> str:
    """The kernel's text, C++20: for NVRTC, or for any C++ compiler, which makes of it one thread after the other."""
    head, rest = source(system, lanes=True).split(runtime_text("vector.c"))
    about, _, sizes = head.partition(PORTABLE)
    comment = about[: about.index("#include")]
    text = "\n".join([comment, runtime_text("cuda.cu"), sizes, rest, _KERNEL])
    return text.replace("static const ", "static constexpr ").replace('_Pragma("GCC unroll 8")', '_Pragma("unroll")')


def device() -> str:
    """The name of the GPU that is used.

    Raises:
        NoDevice: there is none, or CuPy is not installed.
    """
    properties = _cupy().cuda.runtime.getDeviceProperties(0)
    return str(properties["name"].decode())


def _cupy() -> Any:
    try:
        import cupy
    except ImportError as error:
        raise NoDevice(f"device 'cuda' needs CuPy (pip install 'stribeck[cuda]'): {error}") from None
    try:
        count = cupy.cuda.runtime.getDeviceCount()
    except Exception as error:  # whatever the driver says
        raise NoDevice(f"device 'cuda': no GPU can be used: {error}") from None
    if count == 0:
        raise NoDevice("device 'cuda': there is no GPU on this machine")
    return cupy


@lru_cache(maxsize=16)
def _module(system: Equations) -> Any:
    cupy = _cupy()
    cupy.cuda.runtime.deviceSetLimit(cupy.cuda.runtime.cudaLimitStackSize, _STACK)
    module = cupy.RawModule(code=kernel(system), options=("--std=c++20",), backend="nvrtc")
    return module.get_function("stribeck_kernel")


def solve(lanes: Variations, progress: Callable[[float], None] | None = None) -> Outcome:
    """Integrate every lane on the GPU.

    Raises:
        NoDevice: there is no GPU.
        StribeckError: it has too little memory, or the kernel failed.
    """
    cupy, function = _cupy(), _module(lanes.scenario.system)
    made = lane_arrays(lanes)
    try:
        there = {name: cupy.asarray(x) for name, x in made.by_name.items()}
    except cupy.cuda.memory.OutOfMemoryError as error:
        raise StribeckError(f"the GPU has too little memory for {len(lanes)} lanes: {error}; use fewer rows") from None
    batch = Batch.from_buffer_copy(made.batch)
    for name, x in there.items():
        ctypes.c_void_p.from_buffer(batch, getattr(Batch, name).offset).value = x.data.ptr
    shared = cupy.asarray(np.frombuffer(bytes(batch), np.uint8))
    processors = cupy.cuda.runtime.getDeviceProperties(0)["multiProcessorCount"]
    blocks = min(-(-len(lanes) // _THREADS), processors * _BLOCKS_PER_PROCESSOR)
    running, beside = cupy.cuda.Stream(non_blocking=True), cupy.cuda.Stream(non_blocking=True)
    cupy.cuda.Stream.null.synchronize()
    with running:
        function((blocks,), (_THREADS,), (shared.data.ptr,))
    try:
        while not running.done:
            time.sleep(0.02)
            if progress is not None:
                with beside:
                    progress(float(there["turn"][1].get()) / len(lanes))
    finally:
        with beside:
            there["turn"][2] = 1  # Ctrl-C: every thread ends with its step
        beside.synchronize()
        running.synchronize()
    for name, x in made.by_name.items():
        x[...] = there[name].get()
    return outcome(made)


__all__ = ["Arrays", "NoDevice", "device", "kernel", "solve"]
