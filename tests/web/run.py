#!/usr/bin/env python3
"""Runs test modules of pages in one browser: run.py web_test exploring_test. Exits with 77 where all their tests are skipped."""
import sys

from page_test_case import run

if __name__ == "__main__":
    run(*sys.argv[1:])
