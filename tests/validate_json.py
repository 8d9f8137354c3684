#!/usr/bin/env python3
"""Check JSON files against a JSON Schema (draft 2020-12).

usage: validate_json.py SCHEMA FILE...
exit code: 0 all valid, 1 something is not, 77 the Python package jsonschema is missing (Debian: python3-jsonschema)
"""
import json
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    sys.exit(77)


def main(schema_path, *paths):
    with open(schema_path, encoding="utf-8") as file:
        schema = json.load(file)
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    valid = True
    for path in paths:
        with open(path, encoding="utf-8") as file:
            document = json.load(file)
        for error in validator.iter_errors(document):
            valid = False
            print(f"{path}: {error.json_path}: {error.message}")
    return 0 if valid else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
