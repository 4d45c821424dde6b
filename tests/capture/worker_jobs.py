"""Jobs for the tests of the worker process: found there by name."""

import os
import threading

from studio.core.errors import NothingToExport


def count(request, progress):
    for number in range(request):
        progress("solve", (number + 1) / request)
    return os.getpid()


def refuse(request, progress):
    raise NothingToExport(request, "it is a test")


def die(request, progress):
    os._exit(3)


def stumble(request, progress):
    return [][request]


def answer_with(request, progress):
    progress("write", 0.5)
    return request


def answer_with_what_cannot_be_sent(request, progress):
    return threading.Lock()


def run_for_ever(request, progress):
    progress("solve", 0.5)
    threading.Event().wait()
