"""The lock of a folder: another waits for it or is told; a file system without locks is no obstacle."""

import errno
import math

import pytest

from stribeck import platforms
from stribeck.platforms import Occupied, locked


def test_who_does_not_wait_is_told_and_the_lock_is_given_back(tmp_path):
    with locked(tmp_path):
        with pytest.raises(Occupied), locked(tmp_path, wait=False):
            pytest.fail("two had the lock")
        with locked(tmp_path.parent, wait=False):
            pass  # another folder has a lock of its own
    with locked(tmp_path, wait=False), pytest.raises(Occupied), locked(tmp_path, wait=False):
        pass
    with locked(tmp_path):
        pass


def test_a_file_system_without_locks_is_no_obstacle(tmp_path, monkeypatch):
    def none(handle, wait):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(platforms, "_lock", none)
    entered = []
    with locked(tmp_path):
        entered.append(tmp_path)
    assert entered


@pytest.mark.parametrize(("container", "room"), [("1024", 1024.0), ("8192", 4096.0), ("max", 4096.0)])
def test_free_memory_is_the_least_of_the_machine_s_and_the_container_s(container, room, monkeypatch):
    texts = {"meminfo": "MemFree: 1 kB\nMemAvailable: 4 kB\n", "memory.max": container}
    monkeypatch.setattr(platforms.Path, "read_text", lambda self, encoding: texts[self.name])
    assert platforms.free_memory() == room


def test_where_the_system_says_nothing_of_what_is_free_all_its_memory_counts(monkeypatch):
    def absent(self, encoding):
        raise FileNotFoundError

    monkeypatch.setattr(platforms.Path, "read_text", absent)
    monkeypatch.setattr(platforms.os, "sysconf_names", {"SC_PHYS_PAGES": 1}, raising=False)
    monkeypatch.setattr(platforms.os, "sysconf", {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": 3}.get, raising=False)
    assert platforms.free_memory() == 12288.0
    monkeypatch.delattr(platforms.os, "sysconf")
    assert platforms.free_memory() == math.inf
