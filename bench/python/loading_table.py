"""What it costs to load clouds from packs in either PCD encoding and from exported NPZ files, as a Markdown table.

  loading_table.py BUILD [--tubes 10] [--cases 60] [--rounds 5] [--seed 1] [--folder FOLDER]

Makes the same data set in either encoding, packed, by BUILD/bin/generate_dataset, and NPZ of it by export_dataset. One process
loads all clouds, in turn, with tubebin.Dataset, which has the programs' reader, or np.load: first from FOLDER's disk, as the
system was told to forget the files, which takes wall-clock time, then from memory, which takes the processor's. Medians of the
rounds. Needs tubebin and numpy.
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


def milliseconds(clock, load, folder):
    start = clock()
    count = sum(1 for _ in load(folder))
    return 1e3 * (clock() - start) / count


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
    memory, disk = {kind: [] for kind in loaders}, {kind: [] for kind in loaders}
    for _ in range(arguments.rounds):
        for kind, load in loaders.items():
            forget(work / kind)
            disk[kind].append(milliseconds(time.perf_counter, load, work / kind))
            memory[kind].append(milliseconds(time.process_time, load, work / kind))
    print("| clouds | MB a scene | from memory, CPU ms a cloud | from the disk, ms a cloud |\n| --- | ---: | ---: | ---: |")
    for kind in loaders:
        size = sum(path.stat().st_size for path in (work / kind).rglob("*") if path.is_file()) / 1e6 / arguments.cases
        times = f"{statistics.median(memory[kind]):.1f} | {statistics.median(disk[kind]):.1f}"
        print(f"| `{kind}` | {size:.2f} | {times} |")
