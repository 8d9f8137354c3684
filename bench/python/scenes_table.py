"""Scenes a second of tubebin.torch.Scenes in a loader and of generate_dataset, the same scenes in turn, as a Markdown table.

  scenes_table.py GENERATE_DATASET [--tubes 10] [--cases 96] [--workers 2] [--rounds 5] [--seed 1]

Every round has a seed of its own. generate_dataset is timed as a whole command that writes into memory and to the temporary
folder's disk, the loader from its first worker's start to the last sample. Needs torch, tubebin, and nothing else to do.
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


def seconds_of_loader(arguments, seed):
    scenes = tubebin.torch.Scenes(CONFIG, seed, tubes=arguments.tubes, cases=arguments.cases)
    start = time.perf_counter()
    count = sum(1 for _ in torch.utils.data.DataLoader(scenes, batch_size=None, num_workers=arguments.workers))
    assert count == arguments.cases
    return time.perf_counter() - start


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("program")
for name, value in [("tubes", 10), ("cases", 96), ("workers", 2), ("rounds", 5), ("seed", 1)]:
    parser.add_argument(f"--{name}", type=int, default=value)
arguments = parser.parse_args()

ways = {
    "generate_dataset, into memory": lambda seed: seconds_of_program(arguments, seed, "/dev/shm"),
    "generate_dataset, onto the disk": lambda seed: seconds_of_program(arguments, seed, None),
    "tubebin.torch.Scenes": lambda seed: seconds_of_loader(arguments, seed),
}
speeds = {way: [] for way in ways}
for seed in range(arguments.seed, arguments.seed + arguments.rounds):
    for way, measure in ways.items():
        speeds[way].append(arguments.cases / measure(seed))
print("| way | scenes a second | as a share of the first |\n| --- | ---: | ---: |")
for way, values in speeds.items():
    shares = [value / first for value, first in zip(values, speeds["generate_dataset, into memory"])]
    print(f"| {way} | {statistics.median(values):.1f} | {statistics.median(shares):.2f} ({min(shares):.2f}-{max(shares):.2f}) |")
