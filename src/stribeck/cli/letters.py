"""Letters for a terminal or a file that has none of them: ``u`` for the micro sign, ``sigma_0`` and ``^2``."""

from __future__ import annotations

import unicodedata

_WORDS = {"\u00b5": "u", "±": "+-"}
_SIGNS = {"<super>": "^", "<sub>": "_"}


def plain(error: UnicodeError) -> tuple[str, int]:
    """What stands for the letters that cannot be encoded (a handler of :func:`codecs.register_error`): plain letters where
    they are those of a quantity, else escapes."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    found, last = list[str](), ""
    for letter in error.object[error.start : error.end]:
        kind = unicodedata.decomposition(letter).partition(" ")[0]
        if kind in _SIGNS:
            base = unicodedata.normalize("NFKD", letter).replace("\u2212", "-")
            text = (_SIGNS[kind] if kind != last else "") + base
        else:
            text = _WORDS.get(letter) or _greek(letter) or letter
        found.append(text.encode("ascii", "backslashreplace").decode())
        last = kind
    return "".join(found), error.end


def _greek(letter: str) -> str:
    """The name of a Greek letter."""
    words = unicodedata.name(letter, "").split()
    if len(words) != 4 or words[0] != "GREEK" or words[2] != "LETTER":
        return ""
    return words[3].capitalize() if words[1] == "CAPITAL" else words[3].lower()
