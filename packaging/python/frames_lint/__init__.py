"""The program frames-lint as a Python package: installed in Python's scripts folder, and run by `python -m frames_lint`."""

import os
import sys
import sysconfig

__all__ = ["find_program"]


def find_program() -> str:
    """The path of the installed program.

    Raises `FileNotFoundError` where the package was installed without it (from its source folder, for example).
    """
    name = "frames-lint" + (sysconfig.get_config_var("EXE") or "")
    user = sysconfig.get_preferred_scheme("user") if sys.version_info >= (3, 10) else os.name + "_user"
    here = os.path.dirname(os.path.abspath(__file__))
    folders = [
        sysconfig.get_path("scripts"),
        # `pip install --target`, `--prefix` and `--user`
        os.path.join(os.path.dirname(here), "bin"),
        os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(here)))), "bin"),
        sysconfig.get_path("scripts", scheme=user),
    ]
    for folder in folders:
        path = os.path.join(folder, name)
        if os.path.isfile(path):
            return path
    raise FileNotFoundError(f"no program `{name}` in {', '.join(folders)}")
