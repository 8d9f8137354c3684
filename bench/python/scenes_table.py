"""Scenes a second of tubebin.torch.Scenes in a loader and of generate_dataset, the same scenes in turn, as a Markdown table.

  scenes_table.py GENERATE_DATASET [--tubes 10] [--cases 96] [--workers 2] [--rounds 5] [--seed 1]

Every round has a seed of its own. generate_dataset is timed as a whole command that writes into memory and to the temporary
folder's disk, the loader from its workers' start to the last sample: whole clouds one by one, and batches of eight images of
height and labels, cut or padded to one size. Shares are of the first row, median and range. Needs torch, tubebin, and a
machine with nothing else to do.
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

import torch.utils.data

import tubebin.torch

CONFIG = pathlib.Path(__file__).resolve().parents[2] / "config" / "set_a.yaml"


def seconds_of_program(arguments, seed, folder):
    with tempfile.TemporaryDirectory(dir=folder) as output:
        command = [arguments.program, CONFIG, "--output", f"{output}/data", "--seed", seed, "--tubes", arguments.tubes]
        command += ["--cases", arguments.cases, "--jobs", arguments.workers, "--quiet"]
        os.sync()  # nobody waits for what another has written
        start = time.perf_counter()
        subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
        return time.perf_counter() - start


def images(sample):
    """Heights, metres, and labels (2, 240, 360)."""
    image = torch.zeros(2, 240, 360)
    height, width = (min(there, room) for there, room in zip(sample.cloud.labels.shape, image.shape[1:]))
    image[0, :height, :width] = torch.from_numpy(sample.cloud.points[:height, :width, 2])
    image[1, :height, :width] = torch.from_numpy(sample.cloud.labels[:height, :width].astype("float32"))
    return image


def seconds_of_loader(arguments, seed, batch, transform):
    options = {"tubes": arguments.tubes, "cases": arguments.cases, "batch_size": batch or 1, "transform": transform}
    scenes = tubebin.torch.Scenes(CONFIG, seed, **options)
    start = time.perf_counter()
    for _ in torch.utils.data.DataLoader(scenes, batch_size=batch, num_workers=arguments.workers):
        pass
    return time.perf_counter() - start


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("program")
for name, value in [("tubes", 10), ("cases", 96), ("workers", 2), ("rounds", 5), ("seed", 1)]:
    parser.add_argument(f"--{name}", type=int, default=value)
arguments = parser.parse_args()

ways = {
    "generate_dataset, into memory": lambda seed: seconds_of_program(arguments, seed, "/dev/shm"),
    "generate_dataset, onto the disk": lambda seed: seconds_of_program(arguments, seed, None),
    "Scenes, clouds": lambda seed: seconds_of_loader(arguments, seed, None, tubebin.torch.tensors),
    "Scenes, batches of 8 images": lambda seed: seconds_of_loader(arguments, seed, 8, images),
}
speeds = {way: [] for way in ways}
for seed in range(arguments.seed, arguments.seed + arguments.rounds):
    for way, measure in ways.items():
        speeds[way].append(arguments.cases / measure(seed))
print("| way | scenes a second | share |\n| --- | ---: | ---: |")
for way, values in speeds.items():
    shares = sorted(value / first for value, first in zip(values, speeds["generate_dataset, into memory"]))
    spread = f"{statistics.median(shares):.2f} ({shares[0]:.2f}-{shares[-1]:.2f})"
    print(f"| {way} | {statistics.median(values):.1f} | {spread} |")
