"""`ament_frames_lint`: the program frames-lint, called as ament calls linters."""

import argparse
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile


def program():
    """The call of frames-lint: on PATH, or the Python package of that name; `None` where it is not installed."""
    found = shutil.which('frames-lint')
    if found:
        return [found]
    if importlib.util.find_spec('frames_lint'):
        return [sys.executable, '-m', 'frames_lint']
    return None


def main(argv=None):
    """Checks `paths` together; exit code 0 where they are clean, 1 with findings, 3 where too little could be read."""
    parser = argparse.ArgumentParser(
        description='Check the coordinate frames of URDF, xacro, calibration and launch files with frames-lint.',
        epilog='Further options are those of `frames-lint check`, as --name=value.',
    )
    parser.add_argument('paths', nargs='*', default=[os.curdir], help='files and folders that belong together')
    parser.add_argument('--xunit-file', help='where to write a report in the form of xUnit')
    parser.add_argument('--config', help='the configuration; else the nearest frames-lint.yaml')
    parser.add_argument('--profile', help='the profile of rules: ci, pre-survey or dataset-acceptance')
    args, further = parser.parse_known_args(argv)
    call = program()
    if call is None:
        print('frames-lint is not installed: `pip install frames-lint`', file=sys.stderr)
        return 2
    call += ['check', '--format', 'concise', *further]
    if args.config:
        call += ['--config', args.config]
    if args.profile:
        call += ['--profile', args.profile]
    if not args.xunit_file:
        return subprocess.call([*call, '--', *args.paths])
    folder = os.path.dirname(os.path.abspath(args.xunit_file))
    os.makedirs(folder, exist_ok=True)
    # ament has put a result there that says "no result"; frames-lint replaces no file that it did not write.
    with tempfile.TemporaryDirectory(dir=folder) as inside:
        written = os.path.join(inside, 'xunit.xml')
        code = subprocess.call([*call, '--output', 'junit=' + written, '--', *args.paths])
        if os.path.exists(written):
            os.replace(written, args.xunit_file)
    return code


if __name__ == '__main__':
    sys.exit(main())
