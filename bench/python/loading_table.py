"""How many clouds a second are loaded of packs in either PCD encoding and of exported NPZ files, as a Markdown table.

  loading_table.py BUILD [--tubes 10] [--cases 60] [--rounds 5] [--seed 1] [--folder FOLDER]

Makes the same data set in either encoding, packed, by BUILD/bin/generate_dataset, and NPZ of it by export_dataset. One process
loads all clouds, in turn, as tubebin.Dataset does (the programs' reader) and as np.load does: from memory, where the
system has read the files before, and from FOLDER's disk, where it was told to forget them. Needs tubebin, and numpy.
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np

import tubebin


def run(build, program, *words):
    subprocess.run([f"{build}/bin/{program}", *map(str, words), "--quiet"], check=True, stdout=subprocess.DEVNULL)


def make(arguments, folder, encoding):
    config = folder / f"{encoding}.yaml"
    config.write_text(f"output: {{format: {encoding}}}\n")
    size = ["--tubes", arguments.tubes, "--cases", arguments.cases, "--seed", arguments.seed]
    run(arguments.build, "generate_dataset", config, "--output", folder / encoding, "--pack", *size)


def load_dataset(folder):
    for sample in tubebin.Dataset(folder):
        yield sample.cloud.points, sample.cloud.labels


def load_npz(folder):
    for path in sorted(folder.glob("A*/*.npz")):
        with np.load(path) as arrays:
            yield arrays["points"], arrays["labels"]


def forget(folder):
    os.sync()
    for path in folder.rglob("*"):
        if path.is_file():
            with path.open("rb") as file:
                os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def clouds_per_second(load, folder):
    start = time.perf_counter()
    count = sum(1 for _ in load(folder))
    return count / (time.perf_counter() - start)


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build")
for name, value in [("tubes", 10), ("cases", 60), ("rounds", 5), ("seed", 1)]:
    parser.add_argument(f"--{name}", type=int, default=value)
parser.add_argument("--folder", help="where the data sets are made; the temporary folder")
arguments = parser.parse_args()

with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
    work = pathlib.Path(name)
    loaders = {"pcd_binary": load_dataset, "pcd_compressed": load_dataset, "npz": load_npz}
    for encoding in ("pcd_binary", "pcd_compressed"):
        make(arguments, work, encoding)
    run(arguments.build, "export_dataset", work / "pcd_binary", "--format", "npz", "--output", work / "npz")
    warm, cold = {kind: [] for kind in loaders}, {kind: [] for kind in loaders}
    for _ in range(arguments.rounds):
        for kind, load in loaders.items():
            forget(work / kind)
            cold[kind].append(clouds_per_second(load, work / kind))
            warm[kind].append(clouds_per_second(load, work / kind))
    print("| clouds | MB a scene | clouds a second, from memory | from the disk |\n| --- | ---: | ---: | ---: |")
    for kind in loaders:
        megabytes = sum(path.stat().st_size for path in (work / kind).rglob("*") if path.is_file()) / 1e6 / arguments.cases
        print(f"| `{kind}` | {megabytes:.2f} | {statistics.median(warm[kind]):.0f} | {statistics.median(cold[kind]):.0f} |")
