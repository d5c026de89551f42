"""Checks every proof in this folder with Coq, from first principles, and what they rest on.

python3 proofs/check.py      # needs coqc with Coquelicot; nothing is installed, nothing is left behind

Exit status 0: every file compiles, no theorem rests on more than the axioms of the real numbers, the laws' equations in
Laws.v are those that are simulated, and a certificate of ``stribeck check`` holds as goals. 1: one of these fails. 3: there
is no coqc, so nothing was checked.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path

HERE = Path(__file__).parent
# each after those that it needs
FILES = (
    "Laws", "Motion", "Power", "Terms", "Continuous", "Relaxation", "Passive", "Level", "Extract", "Necessary",
    "Machine", "Contacts", "Unique", "Smooth", "Others",
)  # fmt: skip
# What Coq's real numbers are built on, and no more: a decidable property fails for some natural number or holds for all; a
# statement's negation holds or does not; equal values make equal functions; and, for Coquelicot, the excluded middle.
ALLOWED = {
    "ClassicalDedekindReals.sig_forall_dec", "ClassicalDedekindReals.sig_not_dec", "Classical_Prop.classic",
    "FunctionalExtensionality.functional_extensionality_dep",
}  # fmt: skip
INSTALL = "apt-get install coq libcoq-coquelicot libcoq-interval"
NO_COQ = 3
CERTIFIED = Fraction(1, 50), Fraction(1, 10)  # the speeds, m/s, that the goals of a certificate are about


def theorems() -> list[tuple[str, str]]:
    """The file and the name of every theorem and lemma."""
    texts = {name: (HERE / f"{name}.v").read_text() for name in FILES}
    return [
        (f, name) for f, text in texts.items() for name in re.findall(r"^(?:Theorem|Lemma) (\w+)", text, re.MULTILINE)
    ]


def compiled(coqc: str, folder: Path, name: str) -> str:
    """What Coq prints for a file; ends the program where the file does not compile."""
    command = [coqc, "-q", "-w", "-ambiguous-paths", "-R", ".", "Stribeck", f"{name}.v"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{name}.v does not compile:\n{done.stdout}{done.stderr}")
    return done.stdout


def axioms(printed: str) -> set[str]:
    """The axioms named in what Print Assumptions printed."""
    return {line.split()[0] for line in printed.splitlines() if line[:1].strip()} - {"Axioms:", "Closed"}


def compare_equations() -> str | None:
    """What keeps the equations from being compared, None where they are those of the laws."""
    sys.path[:0] = [str(HERE), str(HERE.parent / "src")]
    try:
        from generate import laws_text
    except ImportError as error:
        return f"the laws cannot be loaded here ({error}); the tests compare them"
    if (HERE / "Laws.v").read_text() != laws_text():
        sys.exit("Laws.v is not what the laws say: run python proofs/generate.py")
    return None


def check_certificate(coqc: str, folder: Path) -> str:
    """What was found when Coq checked the certificate of passivity that ``stribeck check`` gives for one law and set."""
    sys.path[:0] = [str(HERE), str(HERE.parent / "src")]
    try:
        from goals import goals

        from stribeck import law
        from stribeck.properties import WORK
        from stribeck.properties.checked import Checked

        verdict = Checked(law("lugre_majorant", "canudas1995", sigma_2=200.0, k_v=1e6), None, WORK).passive()
    except ImportError as error:
        return f"not checked, the package cannot be loaded here ({error}); the tests check one"
    if not verdict.holds or verdict.certificate is None:
        sys.exit("proofs: lugre_majorant with sigma_2 = 200 has no certificate of passivity")
    text = goals(verdict.certificate, *CERTIFIED)
    (folder / "Certificate.v").write_text(text)
    compiled(coqc, folder, "Certificate")
    slowest, fastest = (float(x) for x in CERTIFIED)
    return (
        f"{text.count('Lemma ')} goals of lugre_majorant's, for {slowest:g} m/s <= |v| <= {fastest:g} m/s and |z| <= Z"
    )


def main() -> None:
    """Compile, print the assumptions, compare."""
    coqc = shutil.which("coqc")
    if coqc is None:
        print(f"proofs: not checked, there is no coqc ({INSTALL})")
        sys.exit(NO_COQ)
    missing = {f.stem for f in HERE.glob("*.v")} ^ set(FILES)
    if missing:
        sys.exit(f"proofs: {', '.join(sorted(missing))}: a file that check.py does not name, or a name without a file")
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in FILES:
            shutil.copy(HERE / f"{file}.v", folder)
            compiled(coqc, folder, file)
        stated = theorems()
        lines = [f"From Stribeck Require {' '.join(FILES)}.", "From Coq Require Import List."]
        every = ", ".join(f"@Stribeck.{file}.{theorem}" for file, theorem in stated)
        lines += [f"Definition every := ({every}).", "Print Assumptions every."]
        (folder / "Assumptions.v").write_text("\n".join(lines) + "\n")
        used = axioms(compiled(coqc, folder, "Assumptions"))
        certificate = check_certificate(coqc, folder)
    if used - ALLOWED:
        sys.exit(f"proofs: more is assumed than the real numbers: {', '.join(sorted(used - ALLOWED))}")
    reason = compare_equations()
    print(f"proofs: {len(stated)} theorems and lemmas in {len(FILES)} files, {time.monotonic() - start:.0f} s")
    print(f"axioms: {', '.join(sorted(used))}")
    print(f"equations: {reason or 'those of the laws'}")
    print(f"certificate of stribeck check: {certificate}")


if __name__ == "__main__":
    main()
