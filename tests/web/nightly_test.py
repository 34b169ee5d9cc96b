#!/usr/bin/env python3
"""Tests of pages that take long, with their full numbers: a million Gaussians, three hundred frames. Others run shorter ones at every change.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Chromium or VOG_NIGHTLY is not set.
"""
import sys

from page_test_case import nightly, run

if __name__ == "__main__":
    if not nightly():
        print("skipped: VOG_NIGHTLY is not set (scripts/nightly.sh)", file=sys.stderr)
        sys.exit(77)
    run("web_test.Pages.test_many_gaussians_open", "exploring_test.Exploring.test_many_frames_take_no_more_memory")
