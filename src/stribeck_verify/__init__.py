"""A second, small checker of the certificates that ``stribeck check`` gives for each *yes*.

It imports nothing of stribeck: it has arithmetic of its own (exact rational numbers, intervals, Bernstein coefficients),
builds every inequality from the equations itself, and accepts only the theorems of :mod:`stribeck_verify.theorems`, whose
hypotheses it checks.
"""

from __future__ import annotations

from collections.abc import Mapping

from stribeck_verify.counterexamples import confirmed
from stribeck_verify.equations import compare, compare_bound
from stribeck_verify.expressions import Json, Refused
from stribeck_verify.theorems import UNREADABLE, prove, reaches, read_case

__all__ = ["confirmed", "verify"]


def verify(
    certificate: Json, law: Mapping[str, Json] | None = None, property: str | None = None, v_max: float | None = None
) -> list[str]:
    """Why a certificate is not accepted; nothing where it proves what it states.

    Args:
        certificate: of one property, as it stands in the file that ``stribeck check --certificate FILE`` writes.
        law: where given, the certificate must be about this law, and about its Z: its equations as plain data
            (:mod:`stribeck_verify.equations`).
        property: where given, the certificate must be of this property.
        v_max: with the property ``passive``, the speed up to which it must hold, m/s; None is every speed.
    """
    try:
        case = read_case(certificate)
        if law is not None:  # first, as it is quick
            compare(law, case.law.dz_dt, case.law.force)
            compare_bound(law, case.Z)
        prove(case)
        if property is not None and case.property != property:
            raise Refused(f"it is about {case.property!r}, not {property!r}")
        if property == "passive":
            reaches(case, v_max)
    except Refused as reason:
        return [str(reason)]
    except UNREADABLE as error:
        return [f"the certificate cannot be read: {type(error).__name__}: {error}"]
    return []
