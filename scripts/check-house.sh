#!/usr/bin/env bash
# The rules of the house that no compiler checks, and before them that their checks can fail.
set -euo pipefail
cd "$(dirname "$0")/.."

python3 tests/scripts/check_house_test.py
scripts/check_house.py
