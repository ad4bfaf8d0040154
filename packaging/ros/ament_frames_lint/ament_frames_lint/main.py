"""`ament_frames_lint`: runs frames-lint with the interface of ament linters."""

import argparse
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile


def program():
    """The command of frames-lint: on PATH, or its Python package; `None` if it is not installed."""
    found = shutil.which('frames-lint')
    if found:
        return [found]
    if importlib.util.find_spec('frames_lint'):
        return [sys.executable, '-m', 'frames_lint']
    return None


def main(argv=None):
    """Checks `paths` together; exit code 0 if they are clean, 1 with findings, 3 if incomplete."""
    parser = argparse.ArgumentParser(
        description='Check the coordinate frames of URDF, xacro, calibration and launch files with frames-lint.',
        epilog='Further options are those of `frames-lint check`, as --name=value.',
    )
    parser.add_argument('paths', nargs='*', default=[os.curdir], help='files and folders to check together (default: current folder)')
    parser.add_argument('--xunit-file', help='file for an xUnit report')
    parser.add_argument('--config', help='configuration (default: the nearest frames-lint.yaml)')
    parser.add_argument('--profile', help='profile: ci, pre-survey or dataset-acceptance')
    args, further = parser.parse_known_args(argv)
    call = program()
    if call is None:
        print('frames-lint is not installed: run `pip install frames-lint`', file=sys.stderr)
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
    # ament has written a placeholder result there; frames-lint does not overwrite files that it did not write.
    with tempfile.TemporaryDirectory(dir=folder) as inside:
        written = os.path.join(inside, 'xunit.xml')
        code = subprocess.call([*call, '--output', 'junit=' + written, '--', *args.paths])
        if os.path.exists(written):
            os.replace(written, args.xunit_file)
    return code


if __name__ == '__main__':
    sys.exit(main())
