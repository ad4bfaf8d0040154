"""`python -m frames_lint`: the program with the same arguments, and its exit code."""

import os
import subprocess
import sys

from frames_lint import find_program

if __name__ == "__main__":
    call = [find_program(), *sys.argv[1:]]
    if os.name == "nt":
        sys.exit(subprocess.run(call).returncode)
    os.execv(call[0], call)
