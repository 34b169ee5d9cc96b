#!python
"""Starts the command `vog` of the package, without loading the package."""
import importlib.util
import os
import sys

spec = importlib.util.find_spec("vog")
if spec is None or not spec.submodule_search_locations:
    sys.exit("vog: the Python package vog is not installed for " + sys.executable)
command = os.path.join(list(spec.submodule_search_locations)[0], "bin", "vog")
try:
    os.execv(command, ["vog", *sys.argv[1:]])
except OSError as error:
    sys.exit("vog: %s: %s" % (command, error.strerror))
