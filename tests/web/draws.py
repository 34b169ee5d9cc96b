#!/usr/bin/env python3
"""Opens a page in headless Chromium and counts the colours of its picture: draws.py PAGE. Exits with 1 if it is blank or complains."""
import sys

from browser import Browser

LEAST_COLORS = 50  # a blank page has one, a message instead of the picture a dozen


def main():
    with Browser() as browser:
        browser.viewport(400, 300)
        browser.open(sys.argv[1])
        browser.settle()
        colors = browser.colors()
        if colors < LEAST_COLORS or browser.complaints:
            sys.exit(f"{sys.argv[1]}: {colors} colours {browser.complaints}, expected {LEAST_COLORS} and a silent console")
        print(f"{sys.argv[1]}: draws, {colors} colours")


if __name__ == "__main__":
    main()
