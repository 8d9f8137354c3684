"""What it costs to load scenes from packs, as clouds in either PCD encoding and as depth images, and from exported NPZ files,
as a Markdown table.

  loading_table.py BUILD [--config CONFIG] [--tubes 10] [--cases 60] [--rounds 5] [--seed 1] [--folder FOLDER]

Makes the same data set in either encoding, packed, with depth images, by BUILD/bin/generate_dataset, and NPZ of it by
export_dataset. One process loads all scenes, in turn, with tubebin.Dataset, which has the programs' reader, or np.load: first
from FOLDER's disk, as the system was told to forget the files, which takes wall-clock time, then from memory, which takes the
processor's. Medians of the rounds. MB are those of the files that are loaded. Needs tubebin and numpy.
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import tarfile
import tempfile
import time

import numpy as np

import tubebin


def run(build, program, *words):
    subprocess.run([f"{build}/bin/{program}", *map(str, words), "--quiet"], check=True, stdout=subprocess.DEVNULL)


def make(arguments, folder, encoding):
    config = folder / f"{encoding}.yaml"
    config.write_text(f"include: {arguments.config.resolve()}\n"
                      f"output: {{format: {encoding}, depth_image: true, clean_cloud: false}}\n")
    size = ["--tubes", arguments.tubes, "--cases", arguments.cases, "--seed", arguments.seed]
    run(arguments.build, "generate_dataset", config, "--output", folder / encoding, "--pack", *size)


def load_clouds(folder):
    for sample in tubebin.Dataset(folder):
        yield sample.cloud.points, sample.cloud.labels


def load_depth_images(folder):
    for sample in tubebin.Dataset(folder):
        yield sample.depth_image.depth, sample.depth_image.labels


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


def sizes(folder):
    """Bytes by name of all files, and of those in packs."""
    for path in filter(pathlib.Path.is_file, folder.rglob("*")):
        yield path.name, path.stat().st_size
        if path.suffix == ".tar":
            yield from ((member.name, member.size) for member in tarfile.open(path))


def milliseconds(clock, load, folder):
    start = clock()
    count = sum(1 for _ in load(folder))
    return 1e3 * (clock() - start) / count


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build")
parser.add_argument("--config", type=pathlib.Path, default=pathlib.Path(__file__).parents[2] / "config/set_a.yaml")
for name, value in [("tubes", 10), ("cases", 60), ("rounds", 5), ("seed", 1)]:
    parser.add_argument(f"--{name}", type=int, default=value)
parser.add_argument("--folder", help="where the data sets are made; the temporary folder")
arguments = parser.parse_args()

with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
    work = pathlib.Path(name)
    kinds = [  # title, folder, loader, ends of the names of what is loaded
        ("`pcd_binary`, packed", "pcd_binary", load_clouds, "cloud.pcd"),
        ("`pcd_compressed`, packed", "pcd_compressed", load_clouds, "cloud.pcd"),
        ("depth images, packed", "pcd_binary", load_depth_images, ("depth.png", "labels.png")),
        ("NPZ of `export_dataset`, `np.load`", "npz", load_npz, ".npz"),
    ]
    for encoding in ("pcd_binary", "pcd_compressed"):
        make(arguments, work, encoding)
    run(arguments.build, "export_dataset", work / "pcd_binary", "--format", "npz", "--output", work / "npz")
    memory, disk = {title: [] for title, *_ in kinds}, {title: [] for title, *_ in kinds}
    for _ in range(arguments.rounds):
        for title, data, load, _ends in kinds:
            forget(work / data)
            disk[title].append(milliseconds(time.perf_counter, load, work / data))
            memory[title].append(milliseconds(time.process_time, load, work / data))
    print("| loaded | MB a scene | from memory, CPU ms a scene | from the disk, ms a scene |\n| --- | ---: | ---: | ---: |")
    for title, data, _load, ends in kinds:
        size = sum(size for name, size in sizes(work / data) if name.endswith(ends)) / 1e6 / arguments.cases
        times = f"{statistics.median(memory[title]):.1f} | {statistics.median(disk[title]):.1f}"
        print(f"| {title} | {size:.2f} | {times} |")
