"""Runs generate_dataset and the peers in turn on fresh seeds and prints a Markdown table of times and outcomes."""

import argparse
import json
import os
import platform
import secrets
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import job
import outcome
import tubes

HERE = Path(__file__).resolve().parent
CONFIGS = HERE.parents[1] / "config"
PEERS = {"PyBullet": "pybullet_peer.py", "MuJoCo": "mujoco_peer.py"}
MILLIMETRES = 1e3


@dataclass
class Program:
    """One row of the table."""

    name: str
    command: list[str]
    walls: list[float] = field(default_factory=list)  # seconds of whole commands
    scenes: list[dict] = field(default_factory=list)  # figures in the peers' form, of all rounds
    penetrations: list[float] = field(default_factory=list)
    drifts: list[float] = field(default_factory=list)

    @property
    def is_peer(self) -> bool:
        return self.command[0] == sys.executable


def programs(arguments: argparse.Namespace) -> list[Program]:
    config = CONFIGS / ("full_bin.yaml" if arguments.full_bin else "set_a.yaml")
    own = [str(arguments.build / "bin" / "generate_dataset"), str(config), "--quiet"]
    more = ["--full-bin"] if arguments.full_bin else []
    rows = [Program("generate_dataset", own)]
    for gates, flags in (("same gates", ["--same-gates"]), ("velocities alone", [])):
        for name in arguments.peers:
            command = [sys.executable, str(HERE / PEERS[name]), "--attempts", str(arguments.attempts)]
            rows.append(Program(f"{name}, {gates}", command + flags + more))
    return rows


def run(program: Program, arguments: argparse.Namespace, seed: int, output: Path, *more: str) -> float:
    """Seconds of the whole command. Exit code 3 is some scenes not done: they are counted from the output."""
    scenes = ["--tubes", str(arguments.tubes), "--cases", str(arguments.cases), "--seed", str(seed)]
    command = [*program.command, *scenes, "--jobs", str(arguments.jobs), "--output", str(output)]
    os.sync()  # nobody waits for what another has written
    start = time.perf_counter()
    result = subprocess.run([*command, *more], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    seconds = time.perf_counter() - start
    if result.returncode not in (0, 3):
        raise SystemExit(f"{' '.join(command)} ended with {result.returncode}:\n{result.stdout}")
    return seconds


def chain_in_tubes_txt(tokens: list[str]) -> np.ndarray:
    """Takes the next tube off the tokens of a tubes.txt (docs/file_formats.md): its endpoints in order along it."""
    _, node_count, edge_count = (int(tokens.pop()) for _ in range(3))
    nodes = {}
    for _ in range(node_count):
        identifier, x, y, z, _ = (tokens.pop() for _ in range(5))
        nodes[identifier] = [float(x), float(y), float(z)]
    edges = [[tokens.pop() for _ in range(13)] for _ in range(edge_count)]
    edges.sort(key=lambda edge: int(edge[3]))
    chain = [edges[0][1], edges[0][2]]
    if len(edges) > 1 and chain[0] in edges[1][1:3]:
        chain.reverse()
    for _, a, b, *_ in edges[1:]:
        chain.append(b if a == chain[-1] else a)
    return np.array([nodes[identifier] for identifier in chain])


def read_tubes_txt(path: Path) -> list[np.ndarray]:
    tokens = path.read_text().split()[::-1]
    return [chain_in_tubes_txt(tokens) for _ in range(int(tokens.pop()))]


def read_npz(path: Path) -> list[np.ndarray]:
    with np.load(path) as file:
        return np.split(file["nodes"], np.cumsum(file["counts"])[:-1])


def own_figures(output: Path) -> list[dict]:
    """The manifest's lines in the peers' form."""
    figures = []
    for line in (output / "manifest.jsonl").read_text().splitlines():
        scene = json.loads(line)
        seconds, physics = scene["seconds"], scene["physics"]
        figures.append(
            {
                "done": True,
                "attempts": 1 + len(scene["rejected"]),
                "simulated_seconds": physics["simulated_seconds"],
                "drift": physics["largest_drift"],
                "seconds": {
                    "generate": seconds["build"],
                    "settle": seconds["drop"],
                    "render": seconds["scan"],
                    "write": seconds["write"],
                },
            }
        )
    return figures


def record(program: Program, output: Path) -> None:
    """Reads a round's output: each scene's figures, and how deep its solids overlap."""
    if program.is_peer:
        figures = [json.loads(line) for line in (output / "figures.jsonl").read_text().splitlines()]
        scenes = [read_npz(path) for path in sorted(output.glob("*.npz"))]
    else:
        figures = own_figures(output)
        scenes = [read_tubes_txt(path) for path in sorted(output.glob("*/*/tubes.txt"))]
        program.drifts += [scene["drift"] for scene in figures]
    done = sum(scene["done"] for scene in figures)
    if done != len(scenes):
        raise SystemExit(f"{program.name}: {done} scenes are reported done, {len(scenes)} are in {output}")
    program.scenes += figures
    program.penetrations += [outcome.deepest_penetration(nodes) for nodes in scenes]


def warm_up(rows: list[Program], arguments: argparse.Namespace) -> None:
    """So that no program is read from the disk while it is timed."""
    few = argparse.Namespace(**{**vars(arguments), "cases": arguments.jobs})
    for program in rows:
        with tempfile.TemporaryDirectory() as folder:
            run(program, few, arguments.seed, Path(folder) / "scenes")


def measure(rows: list[Program], arguments: argparse.Namespace) -> None:
    """Timed rounds, each starting with another program; the peers' drift comes from a run that is not timed."""
    warm_up(rows, arguments)
    for round_index in range(arguments.rounds):
        for turn in range(len(rows)):
            program = rows[(turn + round_index) % len(rows)]
            with tempfile.TemporaryDirectory() as folder:
                output = Path(folder) / "scenes"
                program.walls.append(run(program, arguments, arguments.seed + round_index, output))
                record(program, output)
            print(f"round {round_index + 1}: {program.name}: {program.walls[-1]:.2f} s", file=sys.stderr)
    for program in rows:
        if program.is_peer:
            with tempfile.TemporaryDirectory() as folder:
                output = Path(folder) / "scenes"
                run(program, arguments, arguments.seed, output, "--report-drift")
                lines = (output / "figures.jsonl").read_text().splitlines()
                program.drifts = [scene["drift"] for scene in map(json.loads, lines) if scene["done"]]


def seconds_per_scene(program: Program, arguments: argparse.Namespace) -> np.ndarray:
    return np.array(program.walls) / arguments.cases


def row(program: Program, own: Program, arguments: argparse.Namespace) -> str:
    per_scene = seconds_per_scene(program, arguments)
    ratios = np.array(program.walls) / np.array(own.walls)
    done = [scene for scene in program.scenes if scene["done"]]
    stages = [
        np.mean([scene["seconds"].get(stage, 0.0) for scene in program.scenes]) * 1e3
        for stage in ("generate", "build", "settle", "render", "write")
    ]
    at_rest = np.mean(np.array(program.drifts or [np.inf]) <= job.DRIFT_MAX)
    depths = np.array(program.penetrations or [np.nan]) * MILLIMETRES
    cells = [
        program.name,
        f"{np.median(per_scene):.3f} ({per_scene.min():.3f}-{per_scene.max():.3f})",
        f"{1.0 / np.median(per_scene):.1f}",
        "1" if program is own else f"{np.median(ratios):.1f} ({ratios.min():.1f}-{ratios.max():.1f})",
        " / ".join(f"{stage:.0f}" for stage in stages),
        f"{len(done)} of {len(program.scenes)}",
        f"{np.mean([scene['attempts'] for scene in program.scenes]):.2f}",
        f"{at_rest:.0%}",
        f"{np.max(program.drifts, initial=0.0) * MILLIMETRES:.2f}",
        f"{np.median(depths):.2f}, {depths.max():.2f}",
    ]
    return f"| {' | '.join(cells)} |"


HEADER = [
    "Program",
    "Wall clock a scene, s",
    "Scenes a second",
    "Times ours",
    "Generate / build / settle / render / write, ms of a process",
    "Scenes done",
    "Attempts a scene",
    "At rest (drift in 1 s at most 0.5 mm)",
    "Largest drift, mm",
    "Deepest penetration a scene, mm: median, largest",
]


def report(rows: list[Program], arguments: argparse.Namespace, load: float) -> str:
    lines = [
        f"{arguments.rounds} rounds of {arguments.cases} scenes of {arguments.tubes} tubes, {arguments.jobs} processes "
        f"each, seeds {arguments.seed} to {arguments.seed + arguments.rounds - 1}, on {os.cpu_count()} cores "
        f"({platform.machine()}), Python {platform.python_version()}; load average at the start {load:.2f}. "
        "Times are medians of whole commands, in brackets the range.",
        "",
        f"| {' | '.join(HEADER)} |",
        f"|{' --- |' * len(HEADER)}",
        *(row(program, rows[0], arguments) for program in rows),
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True, help="build folder with bin/generate_dataset")
    parser.add_argument("--tubes", type=int, default=10)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seed", type=int, default=secrets.randbelow(2**31), help="of the first round; default: drawn")
    parser.add_argument("--peers", nargs="+", choices=PEERS, default=list(PEERS))
    parser.add_argument("--attempts", type=int, default=20, help="drops of a peer's scene before it is given up")
    parser.add_argument("--full-bin", action="store_true", help="the bin of config/full_bin.yaml, not the paper's")
    arguments = parser.parse_args()
    if arguments.full_bin:
        tubes.use_full_bin()
    load = os.getloadavg()[0]
    rows = programs(arguments)
    measure(rows, arguments)
    print(report(rows, arguments, load))


if __name__ == "__main__":
    main()
