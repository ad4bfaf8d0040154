"""`python -m frames_lint`: runs the program with the same arguments and exit code."""

import os
import subprocess
import sys

from frames_lint import find_program

if __name__ == "__main__":
    call = [find_program(), *sys.argv[1:]]
    if os.name == "nt":
        sys.exit(subprocess.run(call).returncode)
    os.execv(call[0], call)
