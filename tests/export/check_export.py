#!/usr/bin/env python3
"""Compare an export with the data set that it was made from, with nothing of this project's own code.

usage: check_export.py FORMAT DATASET EXPORT [PUBLISHED_WORLD...]
exit code: 0 they agree, 1 they don't (the first difference is named), 77 a package that the check needs is missing
"""
import importlib
import sys

try:
    importlib.import_module("numpy")
except ImportError as error:
    print(error)
    sys.exit(77)

if __name__ == "__main__":
    importlib.import_module("check_" + sys.argv[1]).check(*sys.argv[2:])
