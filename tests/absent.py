"""Python without some packages, as an installation without their extras is."""

_FINDER = """
import sys
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {blocked!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Finder())
import importlib.util
real = importlib.util.find_spec
importlib.util.find_spec = lambda name, *rest: None if name.partition(".")[0] in {blocked!r} else real(name, *rest)
"""


def without(blocked):
    """Code that makes these packages impossible to import in a process that runs it."""
    return _FINDER.format(blocked=set(blocked))


def site_without(blocked, folder):
    """A folder for PYTHONPATH: no process that has it can import these packages."""
    folder.mkdir(exist_ok=True)
    (folder / "sitecustomize.py").write_text(without(blocked))
    return folder
