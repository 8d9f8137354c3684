"""Validates scripts/kubernetes/*.yaml against the published schema of Kubernetes, offline, and checks what the schema can't
know. Needs the packages kubernetes-validate (PyPI; holds the schemas) and yaml; exit code 77 where they are missing.

Usage: check_manifests.py FOLDER BIN_DIR
"""
import pathlib
import subprocess
import sys

try:
    import kubernetes_validate
    import yaml
except ImportError as error:
    print(f"skipped: {error} (pip install kubernetes-validate)")
    sys.exit(77)

VERSIONS = ("1.29", "1.33")
folder, programs = map(pathlib.Path, sys.argv[1:])
manifests = sorted(folder.glob("*.yaml"))
assert manifests, f"{folder} has no manifests"
for path in manifests:
    job = yaml.safe_load(path.read_text())
    for version in VERSIONS:
        kubernetes_validate.validate(job, version, strict=True)
    spec = job["spec"]
    container = spec["template"]["spec"]["containers"][0]
    counts = [variable["value"] for variable in container.get("env", []) if variable["name"] == "TUBEBIN_SHARD_COUNT"]
    assert counts == ([str(spec["completions"])] if "completions" in spec else []), f"{path}: {counts}"
    assert spec["podFailurePolicy"]["rules"][1]["onExitCodes"]["containerName"] == container["name"], path
    # The options are ours: the program knows each of them.
    program, *arguments = container["command"]
    known = subprocess.run([programs / program, "--help"], capture_output=True, text=True, check=True).stdout
    for option in (argument for argument in arguments if argument.startswith("--")):
        assert option in known, f"{path}: {program} has no {option}"
    print(f"{path.name}: valid for Kubernetes {', '.join(VERSIONS)}")
