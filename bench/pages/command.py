# SPDX-License-Identifier: Apache-2.0
# What the commands share: errors as one line and an exit status, and runs of the program.
import shutil
import subprocess
import sys
from pathlib import Path

from .results import InputError

OK, CANNOT_BE_USED, CASES_FAILED, INTERRUPTED = 0, 2, 3, 130  # as the program's


def run_command(main):
    """The exit status of `main`, whose errors become one line on standard error."""
    name = Path(sys.argv[0]).name
    try:
        return main(sys.argv[1:])
    except InputError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return CANNOT_BE_USED
    except ProgramFailed as failure:
        return failure.status
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        sys.stdout = None  # who reads has seen enough
        return OK


class ProgramFailed(Exception):
    """`controlspace` ended without results; it has said why."""

    def __init__(self, status):
        super().__init__(status)
        self.status = status


class Program:
    """The program controlspace: `given`, beside the command, in a build folder, or in PATH."""

    def __init__(self, given=None):
        here = Path(sys.argv[0]).resolve().parent
        places = [here / "controlspace", *(here.parent / "build" / preset / "bin" / "controlspace"
                                           for preset in ("release", "ci"))]
        found = given or next((p for p in places if p.is_file()), shutil.which("controlspace"))
        if not found:
            raise InputError("controlspace was not found: name it with --program")
        self.path = found

    def compare(self, *arguments):
        """Runs a study; its rows say which cases failed."""
        try:
            status = subprocess.run([self.path, "compare", *map(str, arguments)]).returncode
        except OSError as error:
            raise InputError(f"{self.path}: {error.strerror.lower()}") from error
        if status not in (OK, CASES_FAILED):
            raise ProgramFailed(status)
