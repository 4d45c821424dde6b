"""Jobs for the tests of the worker process: found there by name."""

import os

from studio.core.errors import NothingToExport


def count(request, progress):
    for number in range(request):
        progress("solve", (number + 1) / request)
    return os.getpid()


def refuse(request, progress):
    raise NothingToExport(request)


def die(request, progress):
    os._exit(3)
