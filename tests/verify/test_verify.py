"""The certificates' checker: what is right passes, what was tampered with or is false does not."""

from __future__ import annotations

import copy
import json
import os
import random
import re
import subprocess
import sys
from itertools import cycle, islice, product
from math import inf
from typing import Any

import numpy as np
import pytest
from flint import fmpq

import stribeck
from stribeck.properties.statement import statement
from stribeck.properties.verdicts import Verdict
from stribeck_verify import theorems, verify
from stribeck_verify.__main__ import main
from stribeck_verify.equations import compare_bound, to_node
from stribeck_verify.expressions import Refused
from stribeck_verify.theorems import read_case
from tests.shared import places
from tests.verify import hand_made as by_hand
from tests.verify.hand_made import ALL, SIGNS, claim

RIGHT = {
    "bounded": (by_hand.bounded, "lugre"),
    "bounded at its edge": (by_hand.bounded_at_its_edge, "lugre"),
    "unique": (by_hand.unique, "lugre"),
    "passive": (by_hand.passive, "lugre"),
    "passive at any z": (by_hand.passive_at_any_z, None),
    "smooth": (by_hand.smooth, "literature.RootMajorant"),
    "drift_free": (by_hand.drift_free, None),
}


def refusal(*args: Any) -> str | None:
    certificate, law, *rest = (*args, None)
    problems = verify(certificate, None if law is None else statement(law), *(x for x in rest if x is not None))
    return problems[0] if problems else None


@pytest.mark.parametrize("name", RIGHT)
def test_what_is_right_is_accepted(name):
    make, law = RIGHT[name]
    assert refusal(make(), by_hand.law(law) if law else None, make()["property"]) is None


# -- tampering ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(RIGHT.keys() - {"smooth"}))
def test_no_claim_can_be_left_out(name):
    whole = RIGHT[name][0]()
    for i in range(len(whole["claims"])):
        less = copy.deepcopy(whole)
        del less["claims"][i]
        assert refusal(less) is not None, i


@pytest.mark.parametrize("name", ["bounded", "passive", "drift_free"])
def test_no_region_can_be_made_smaller(name):
    whole = RIGHT[name][0]()
    for i, one in enumerate(whole["claims"]):
        for axis in {"u", "w"} & one.keys():
            less = copy.deepcopy(whole)
            lo, hi = one[axis]
            less["claims"][i][axis] = [lo, "1000" if hi == "inf" else by_hand.text(by_hand.Fraction(hi) * 0.999)]
            assert refusal(less) is not None, (i, axis)


def changed(data: Any, path: tuple[Any, ...], value: Any) -> Any:
    new = copy.deepcopy(data)
    at = new
    for step in path[:-1]:
        at = at[step]
    at[path[-1]] = value
    return new


COVER, RELATION = "the claims do not cover", "the relation must be"
FALSE = {
    "another theorem": (by_hand.passive, ("theorem",), "outside", "no theorem 'outside'"),
    "another property": (by_hand.bounded, ("property",), "unique", "no theorem"),
    "a theorem that is none": (by_hand.bounded, ("theorem",), "evident", "no theorem 'evident'"),
    "no hypothesis": (by_hand.passive, ("hypotheses",), {}, "do not cover z"),
    "an empty hypothesis": (by_hand.passive, ("hypotheses", "bounded", "claims"), [], "do not cover v"),
    "no proof of uniqueness": (by_hand.bounded_at_its_edge, ("hypotheses", "unique", "claims"), [], "do not cover"),
    "a hypothesis with a larger Z": (by_hand.passive, ("hypotheses", "bounded", "Z"), "1/50000", "about another law"),
    "a smaller Z": (by_hand.bounded, ("Z",), "1/100000", "do not cover v"),
    "another relation": (by_hand.bounded, ("claims", 0, "relation"), "!=0", "relation must be >=0"),
    "no relation": (by_hand.bounded, ("claims", 0, "relation"), "", "relation: '': must be >=0"),
    "a slope that is too small": (by_hand.unique, ("claims", 1, "b"), "49999", "a leaf does not hold"),
    "a negative slope": (by_hand.unique, ("claims", 0, "a"), "-1", "must not be negative"),
    "an atom's range that is too small": (by_hand.bounded, ("claims", 0, "tree", 1, 0, 2), "1/2", "exp is not within"),
    "an atom's range that is too small above": (
        by_hand.bounded,
        ("claims", 0, "tree", 1, 0, 3),
        "1/2",
        "exp is not within",
    ),
    "no atom": (by_hand.bounded, ("claims", 0, "tree", 1), [], "exp has no atom"),
    "a tree that is none": (by_hand.bounded, ("claims", 0, "tree"), ["leaf"], "no tree"),
    "a tree of nothing": (by_hand.bounded, ("claims", 0, "tree"), [], "a tree is no list"),
    "another law's damping": (by_hand.passive, ("force", 1, 2, 1), "201", "a leaf does not hold"),
    "another storage": (by_hand.passive, ("claims", 0, "slope"), "1", "a leaf does not hold"),
    "a speed limit that is none": (by_hand.passive, ("v_max",), "0", "v_max"),
    "too large an elastic range": (by_hand.drift_free, ("data", "z_0"), "1/100000", "do not cover v"),
    "no elastic range": (by_hand.drift_free, ("data", "z_0"), "0", "must be > 0"),
    "a law of |v| by name": (by_hand.bounded, ("dz_dt", 2, 1, 1), "u", "may depend on v and z only"),
    "another format": (by_hand.bounded, ("format",), 2, "format: 2"),
    "a name defined anew": (by_hand.bounded, ("definitions", 0, 0), "v", "cannot be defined"),
}


@pytest.mark.parametrize("what", FALSE)
def test_what_is_changed_is_refused(what):
    make, path, value, why = FALSE[what]
    assert why in refusal(changed(make(), path, value))


def test_a_speed_limit_makes_a_weaker_statement_of_its_own():
    limited = changed(by_hand.passive(), ("v_max",), "1/100")
    assert refusal(limited) is None
    assert "up to 0.01 m/s" in refusal(limited, None, "passive")
    assert verify(limited, None, "passive", v_max=0.01) != []  # 0.01 is a little more than 1/100
    assert verify(limited, None, "passive", v_max=0.009) == []
    assert verify(by_hand.passive(), None, "passive", v_max=0.009) == []


def test_a_yes_without_a_certificate_is_not_verified():
    lugre = by_hand.law("lugre")
    assert Verdict(True, "said so").verify(lugre, "passive") is False
    assert Verdict(True, "", certificate=by_hand.passive()).verify(lugre, "passive") is True
    assert Verdict(True, "", certificate=by_hand.bounded()).verify(lugre, "passive") is False
    assert Verdict(None, "undecided").verify(lugre, "passive") is None


@pytest.mark.parametrize("law", ["bounds.HalfTheDecay", "literature.RootMajorant", "lugre_arctan"])
def test_another_law_is_refused(law):
    other = stribeck.law(law, by_hand.MILD, k_v=1e6) if law == "lugre_arctan" else by_hand.law(law)
    assert "equation" in refusal(by_hand.bounded(), other) or "Z is" in refusal(by_hand.bounded(), other)


def test_other_constants_are_refused():
    other = stribeck.law("lugre", by_hand.MILD, sigma_2=100.00000000000001)
    assert "equation of F" in refusal(by_hand.passive(), other)
    with pytest.raises(Refused, match=r"Z is 1\.5, the law's is 1\.4142"):
        compare_bound({"Z": ["sqrt", 2.0], "constants": {}}, fmpq(3, 2))


def test_a_condition_that_an_infinite_number_decides_has_one_case():
    for condition, left in ((["lt", "v", inf], "v"), (["lt", inf, "v"], "z")):
        assert to_node(["where", condition, "v", "z"], {}).value == left
    with pytest.raises(Refused, match="the number inf"):
        to_node(["add", "v", inf], {})


def test_random_changes_do_not_crash_it():
    """All but three are refused, which change nothing, or what says nothing."""
    rng, refused = random.Random(3), 0
    for _ in range(60):
        data = copy.deepcopy(RIGHT[rng.choice(list(RIGHT))][0]())
        at: Any = data
        while True:
            keys = list(at) if isinstance(at, dict) else range(len(at))
            key = rng.choice(list(keys))
            if not isinstance(at[key], dict | list) or not at[key] or rng.random() < 0.1:
                break
            at = at[key]
        at[key] = rng.choice([None, [], {}, "x", "-1", "1/0", 7, ["leaf", []], ["split"], True, at])
        refused += refusal(data) is not None
    assert refused == 57


# -- false statements about laws ---------------------------------------------------------------------------------------------


def test_false_laws_are_refused():
    half = ["sub", "v", ["mul", ["mul", "1/2", ["div", ["abs", "v"], "n1"]], "z"]]
    grows = ["add", by_hand.LUGRE, ["mul", "1/1000", "z"]]
    at_rest = ["where", ["le", ["abs", "v"], "0"], "1/1000000", by_hand.LUGRE]
    for rate in (half, grows, at_rest):
        assert "claim inward" in refusal(by_hand.bounded(rate))
        assert "claim inward" in refusal(by_hand.passive(rate))


JUMPS = {
    "a step": ["where", ["lt", "z", "1/200000"], "0", "1"],
    "a step at 0": ["where", ["lt", "z", "0"], "0", "1"],
    "a value of its own at 0": ["where", ["le", ["abs", "z"], "0"], "1", "0"],
    "the sign": ["sign", "z"],
    "a step told twice": ["where", ["both", ["lt", "z", "1/200000"], ["lt", ["mul", "2", "z"], "1/100000"]], "5", "0"],
    "a step by a step": ["where", ["lt", ["where", ["lt", "z", "1/200000"], "0", "2"], "1"], "5", "0"],
    "a step on a line": ["where", ["lt", "z", "v"], "0", "1"],
}


@pytest.mark.parametrize("what", JUMPS)
def test_a_rate_that_jumps_is_not_lipschitz_nor_smooth(what):
    jumps = ["add", by_hand.LUGRE, ["mul", "v", JUMPS[what]]]
    here = [["w", "u"]]
    for make, rate in ((by_hand.unique, jumps), (by_hand.smooth, ["add", by_hand.ROOT, ["mul", "v", JUMPS[what]]])):
        data = make(rate)
        surface = {"about": "switching", "relation": "=0", "there": here, "u": ALL, "w": ALL}
        surfaces = [{**surface, "v": s, "z": t} for s, t in product(SIGNS, SIGNS)]
        data["claims"] = [c | ({"b": "1000001"} if "b" in c else {}) for c in data["claims"]] + surfaces
        assert "meet" in refusal(data) or "agree" in refusal(data)


KINKS = {
    "|z|": ["abs", "z"],
    "|z - c|": ["abs", ["sub", "z", "1/200000"]],
    "|v|": ["abs", "v"],
    "v |z|/(v^2 + z^2)": ["div", ["mul", "v", ["abs", "z"]], ["add", ["mul", "v", "v"], ["mul", "z", "z"]]],
    "sqrt(v^2)": ["sqrt", ["mul", "v", "v"]],
    "v^(3/4)": ["pow", ["abs", "v"], "3/4"],
}


@pytest.mark.parametrize("what", KINKS)
def test_a_kink_is_not_smooth(what):
    in_force = by_hand.smooth()
    in_force["force"] = ["add", in_force["force"], KINKS[what]]
    for result in (refusal(by_hand.smooth(["add", by_hand.ROOT, KINKS[what]])), refusal(in_force)):
        assert re.search("could not be shown to (agree|meet)|may be singular", result)


BELL = ["exp", ["neg", ["mul", "v", "v"]]]
SMOOTH = {
    "v |v|": ["mul", "v", ["abs", "v"]],
    "sgn(v) v^2": ["mul", ["sign", "v"], ["mul", "v", "v"]],
    "a spline": ["where", ["lt", "v", "1"], "0", ["mul", ["sub", "v", "1"], ["sub", "v", "1"]]],
    "cases that agree": ["where", ["lt", "z", "v"], ["mul", "2", "z"], ["add", "z", "z"]],
    "a largest that is not passed": ["where", ["lt", BELL, "1"], BELL, "1"],
    "a least that is not passed": ["where", ["le", "1", BELL], BELL, "1"],
}


@pytest.mark.parametrize("what", SMOOTH)
def test_what_only_looks_like_a_kink_is_smooth(what):
    in_force = by_hand.smooth()
    in_force["force"] = ["add", in_force["force"], SMOOTH[what]]
    assert refusal(in_force) is None


def test_a_storage_without_a_bound_is_refused():
    """F = 0, dz/dt = -z^3 at any v: S' = 1/z would "store" without end as z -> 0."""
    stored = by_hand.passive_at_any_z(["where", ["le", ["abs", "z"], "0"], "0", ["div", "1", "z"]])
    stored |= {"dz_dt": ["neg", ["mul", "z", ["mul", "z", "z"]]], "force": "0"}
    assert "may have no bound" in refusal(stored)


@pytest.mark.parametrize("c", [0.0, 0.3])
def test_a_force_that_decays_too_slowly_is_refused(c):
    s, d, above, x = 1.5, 0.7, 0.4, np.linspace(0, 3, 3001)
    share = np.exp(-x * x)
    least = np.max(s**2 * share**2 * (d * x + above) / (4 * (s * share + c)))
    numbers, knots = [fmpq(*v.as_integer_ratio()) for v in (s, d, c)], [fmpq(i, 500) for i in range(1000)]
    theorems._decays_fast(*numbers, fmpq(int(1.01e9 * least), 10**9), fmpq(2, 5), knots)
    with pytest.raises(Refused, match="is not shown between"):
        theorems._decays_fast(*numbers, fmpq(int(0.999e9 * least), 10**9), fmpq(2, 5), knots)


def test_splits_and_polar_coordinates():
    # u^2 - u w + w^2 > 0 for u, w > 0: not shown by one leaf on [0, inf]^2, shown in polar coordinates with splits
    leaf: Any = ["leaf", []]
    top = ["add", ["sub", ["mul", "u", "u"], ["mul", "u", "w"]], ["mul", "w", "w"]]

    def with_tree(tree: Any, w: Any = ALL) -> dict[str, Any]:
        data = by_hand.smooth()
        data["dz_dt"] = ["add", by_hand.ROOT, "0"]
        return {**data, "claims": [claim("divisor", 1, 1, "!=0", w=w, tree=tree, expression=top)]}

    from stribeck_verify import claims as of

    def proved(tree: Any, w: Any = ALL, u: Any = ALL) -> bool:
        case = read_case(
            {**with_tree(tree), "claims": [claim("divisor", 1, 1, ">0", u=u, w=w, tree=tree, expression=top)]}
        )
        try:
            of.prove(case.claims[0], case.law)
        except Refused:
            return False
        return True

    split = ["split", "q", "1/2", leaf, ["split", "q", "1", leaf, leaf]]
    assert not proved(leaf)
    assert proved(["polar u", split])
    assert not proved(["polar u", ["split", "q", "1/2", leaf, ["split", "p", "1", leaf, leaf]]])  # no such axis
    assert not proved(["polar u", ["split", "q", "0", leaf, leaf]])  # not within
    assert not proved(["polar u", ["polar u", leaf]])
    small = ["diagonal", ["split", "q", "1/2", leaf, leaf], ["split", "p", "1/2", leaf, leaf]]
    assert proved(small, ["0", "1"], ["0", "1"])
    assert not proved(small)  # only for finite rectangles


# -- fields of another type, and what is printed -----------------------------------------------------------------------------

ESCAPE = "\x1b[31mX\x1b]0;title\x07"
FIELDS = {  # texts that are no number or word, and numbers of another kind; other types below, in every field
    ("v_max",): ["nan", "-1", "0", "no limit at all", " 1", "1 ", "1e3", "1" + ESCAPE],
    ("Z",): [1, " 3/200000", "3/200000\n", "+3/200000", "3 /200000", "3_0/200000", "\u0663/200000", "3/0"],
    ("claims", 0, "w"): [[" 1", "inf"], ["1"], "inf", ["inf", "1"], ["2", "1"], [0, "inf"], {"0": "inf"}],
    ("claims", 0, "v"): [1.0, "1", 2],
    ("claims", 0, "relation"): [1, ">= 0"],
    ("claims", 0, "about"): [5],
    ("property",): [5, "passive" + ESCAPE],
    ("theorem",): [5, "outside" + ESCAPE],
    ("law",): [5],
    ("format",): [True, 1.0, "1"],
    ("constants",): [{"F_c": 1.0}, {"F_c": "1" + ESCAPE}],
    ("definitions",): [{}, [["n0"]], [[5, "v"]], [["x y", "v"]]],
    ("dz_dt",): [5, ["add" + ESCAPE, "v", "z"], "\ud800", [["add"], "v", "z"]],
    ("level",): [{"F_c": x} for x in ("1", ["nan", "inf"], ["inf", "inf"], ["2", "1"], ["1"] * 3)],
    ("force",): [["both", ["lt", "v", "z"], ["lt", "v", "z"]]],
}


@pytest.mark.parametrize(
    ("path", "value"), [(path, value) for path, values in FIELDS.items() for value in values], ids=str
)
def test_a_field_of_another_type_is_refused_before_anything_is_confirmed(path, value):
    assert refusal(changed(by_hand.bounded(), path, value)) is not None


def whole_certificates():
    """Certificates that have every field there is, also those that the theorem does not use."""
    atoms = [
        ["u", "range", "0", "1"],
        ["u", "root", "u", "1"],
        ["u", "far"],
        ["u", "above", "0"],
        [["lt", "u", "w"], "either"],
    ]
    trees = [["split", "u", "1", ["polar u", ["leaf", atoms]], ["leaf", []]], ["diagonal", ["leaf", []], ["leaf", []]]]
    unused = [
        claim(
            "switching", 1, 1, "=0", a="u", b="w", there=[["u", "w"]], condition=["lt", "u", "w"], axis="z", side=1,
            order=1,
        ),
        *(claim("excess", 1, 1, ">=0", k="1", above="1", N="1", tree=tree) for tree in trees),
        claim("growth", 1, 1, ">=0", a="1", b="1", l="1", k=1),
        claim("slope sign", 0, 1, ">=0", slope="z"),
        claim("divisor", 1, 1, "!=0", expression="u"),
        claim("finite", 1, 0, ">=0", sign=1, a="0", b="1", k=1),
    ]  # fmt: skip
    result = {name: make() for name, (make, _) in RIGHT.items()}
    for each in result.values():
        each["claims"] = [*each["claims"][:1], *unused]
        each |= {"constants": {"F_c": "1"}, "level": {"F_c": ["1", "inf"]}}
    inner = {"bounded": {**result["bounded"], "claims": []}}
    result["unique"] |= {"data": {"within": "1"}, "hypotheses": inner}
    result["passive"]["hypotheses"] = inner
    result["passive"]["data"] = {"slope": "z", "own_up_to": "1", "cells": [[1, "0", "1", "2"]]}
    result["smooth"]["data"] = {"of": ["dz_dt", "force"]}
    numbers = dict.fromkeys(("k", "s", "d", "c", "N", "above"), "1")
    result["damped"] = {
        **result["passive"],
        "theorem": "damped",
        "data": {**numbers, "knots": ["0", "1"]},
        "hypotheses": {},
    }
    return result


@pytest.mark.parametrize("name", [*RIGHT, "damped"])
def test_every_field_has_its_type_also_those_that_the_theorem_does_not_use(name):
    whole = whole_certificates()[name]
    assert read_case(whole).property == whole["property"]
    values = cycle((None, 1.5, {"a key that none has": 1}, True, [["1"]]))
    for path in places(whole):
        for value in islice(values, 1):
            with pytest.raises((Refused, TypeError)):  # verify() turns both into a reason
                read_case(changed(whole, path, value))


@pytest.mark.parametrize("name", [*RIGHT, "damped"])
def test_no_table_has_a_field_that_is_not_known(name):
    whole = whole_certificates()[name]
    for path in places(whole):
        at: Any = whole
        for step in path:
            at = at[step]
        if isinstance(at, dict) and path[-1] not in ("constants", "level"):
            assert re.search("no .*(has|is) 'remark'", refusal(changed(whole, (*path, "remark"), "1"))), path


def test_what_a_file_says_is_printed_as_one_line_of_ascii(tmp_path, capsys):
    """An escape reached the terminal, and a line break in a name made a line of its own: "passive: confirmed"."""
    names = ["bounded" + ESCAPE, "x\npassive: confirmed\nbounded", "bounded\udcff", "bounded\u202e", "b" * 100_000]
    for name in names:
        for law, names_of in ((name, ["bounded"]), ("lugre", [name])):
            file = tmp_path / "c.json"
            data = {"format": 1, "law": law, "certificates": {n: {**by_hand.bounded(), "law": law} for n in names_of}}
            file.write_text(json.dumps(data))
            assert main([str(file)]) == (0 if law == name else 1)
            out = capsys.readouterr().out
            assert out.isascii()
            assert all(c.isprintable() or c == "\n" for c in out)
            assert not any(line.startswith("passive") for line in out.splitlines())
            assert max(len(line) for line in out.splitlines() if not line.startswith("  ")) < 1000


def test_the_equations_of_each_certificate_are_shown_before_it(tmp_path, capsys):
    """A certificate about other equations was confirmed below those of the first one."""
    other = changed(by_hand.drift_free(), ("law",), "lugre")
    data = {"format": 1, "law": "lugre", "certificates": {"bounded": by_hand.bounded(), "drift_free": other}}
    (tmp_path / "c.json").write_text(json.dumps(data))
    assert main([str(tmp_path / "c.json")]) == 0
    lines = capsys.readouterr().out.splitlines()
    shown = [line.partition(": ")[2] for line in lines if line.startswith("  dz_dt: ")]
    assert shown == [json.dumps(each["dz_dt"]).replace("1/200000", "5e-06") for each in (by_hand.bounded(), other)]
    places = [lines.index(f"{name}: confirmed") for name in data["certificates"]]
    assert lines[places[0] + 1].startswith("  definitions: ")
    assert places[1] > places[0] + 4


@pytest.mark.parametrize(
    ("number", "shown"),
    [
        ("3/2", "1.5"), ("1152921504606847/1152921504606846976", "0.001"), ("-1/3", "about -0.3333333333333333"),
        ("1152921504606847/1152921504606846977", "about 0.001"), ("1" + "0" * 400 + "/3", "about 3e399"),
        ("10", "10"), ("1/0", "1/0"),
    ],
)  # fmt: skip
def test_fractions_of_the_equations_are_printed_as_decimals(tmp_path, capsys, number, shown):
    """The exact ones stay in the file."""
    data = {"format": 1, "law": "lugre", "certificates": {"bounded": changed(by_hand.bounded(), ("Z",), number)}}
    (tmp_path / "c.json").write_text(json.dumps(data))
    main([str(tmp_path / "c.json")])
    assert f'  Z: "{shown}"' in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize(
    "text",
    ["[]", "{}", '{"format": 1, "law": ["a"], "certificates": {}}', '{"format": 1, "law": "x", "certificates": []}',
     '{"format": 1, "law": "x", "certificates": {"bounded": NaN}}', "[" * 100_000 + "]" * 100_000,
     '{"format": 1, "law": "x", "law": "y", "certificates": {}}', '{"format": 1, "law": "x", "certificates": {}, "more": 1}',
     '{"contacts": {}, "format": 1}'],
)  # fmt: skip
def test_a_file_that_holds_no_certificates_is_one_line(tmp_path, capsys, text):
    file = tmp_path / "c.json"
    file.write_text(text)
    assert main([str(file)]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert len(shown.err.splitlines()) == 1
    assert "holds no certificates" in shown.err


def test_the_certificates_of_a_machine_are_those_of_its_contacts(tmp_path, capsys):
    of_law = {"format": 1, "law": "lugre", "certificates": {"bounded": by_hand.bounded()}}
    file = tmp_path / "machine.json"
    file.write_text(json.dumps({"contacts": {"mesh": of_law, "bearing": of_law}}))
    assert main([str(file)]) == 0
    assert "bearing: bounded: confirmed" in capsys.readouterr().out


def test_a_file_can_be_checked_by_others(tmp_path, capsys):
    file = tmp_path / "lugre.json"
    data = {"format": 1, "law": "lugre", "certificates": {"bounded": by_hand.bounded(), "passive": by_hand.passive()}}
    file.write_text(json.dumps(data))
    assert main([str(file)]) == 0
    assert "passive: confirmed" in capsys.readouterr().out
    data["certificates"]["passive"]["claims"].pop()
    file.write_text(json.dumps(data))
    assert main([str(file)]) == 1
    assert "passive: the claims do not cover" in capsys.readouterr().out
    assert main([]) == 2


@pytest.mark.skipif(sys.platform == "win32", reason="pipes end otherwise there")
def test_a_reader_that_goes_early_is_no_traceback():
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, "-m", "stribeck_verify", "--help"], stdout=write, stderr=subprocess.PIPE)
    os.close(write)
    assert (done.returncode, done.stderr) == (2, b"")


@pytest.mark.parametrize(("words", "status"), [(["--help"], 0), (["-h"], 0), ([], 2), (["a.json", "b.json"], 2)])
def test_its_help_stands_where_it_is_asked_for(words, status, capsys):
    assert main(words) == status
    captured = capsys.readouterr()
    assert "check the certificates" in (captured.err if status else captured.out)
