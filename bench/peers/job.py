"""What both peers share: the scanner, the criterion of rest, the files they write, and the loop over scenes."""

import argparse
import contextlib
import json
import multiprocessing
import os
import time
from pathlib import Path
from typing import Any, Callable, Iterator, Protocol

import numpy as np

import tubes

SCANNER_HEIGHT = 2.0
IMAGE_WIDTH, IMAGE_HEIGHT = 1920, 1200
FOCAL_LENGTH = IMAGE_WIDTH / 2.0 / np.tan(1.22 / 2.0)  # pixels; horizontal field of view 1.22 rad
RANGE_MIN, RANGE_MAX = 0.1, 2.6

# What rest is, as PhysicsOptions has it.
REST_SPEED = 0.01  # m/s
REST_ANGULAR_SPEED = 0.1  # rad/s
REST_WINDOW = 0.1  # seconds that all tubes stay below both
TIME_LIMIT = 10.0  # simulated seconds
CHECK_TIME = 1.0  # seconds that a scene runs on to prove that it is at rest
DRIFT_MAX = 0.0005  # metres that an endpoint may move meanwhile
PENETRATION_MAX = 0.0005  # metres
LOST_CHECK_INTERVAL = 0.1  # simulated seconds between looks for a tube that fell past the bin


class Window:
    """The pixels to render: outside the window that covers bin and tubes nothing is hit.

    The scanner looks at the bin's centre, so the window is the image's middle and a smaller field of view renders it.
    """

    def __init__(self, nodes: list[np.ndarray]) -> None:
        rim = np.array([tubes.BIN_LENGTH, tubes.BIN_WIDTH]) / 2.0 + tubes.WALL_THICKNESS
        points = np.vstack([[*rim, tubes.BIN_HEIGHT], *nodes])
        reach = (np.abs(points[:, :2]) + tubes.RADIUS) / (SCANNER_HEIGHT - tubes.RADIUS - points[:, 2:])
        half_width, half_height = np.ceil(FOCAL_LENGTH * reach.max(axis=0)).astype(int)
        self.width = int(min(2 * half_width, IMAGE_WIDTH))
        self.height = int(min(2 * half_height, IMAGE_HEIGHT))
        self.fov_y_deg = float(np.degrees(2.0 * np.arctan(self.height / 2.0 / FOCAL_LENGTH)))

    def pixels(self) -> tuple[slice, slice]:
        """Rows and columns of the full image."""
        row, column = (IMAGE_HEIGHT - self.height) // 2, (IMAGE_WIDTH - self.width) // 2
        return slice(row, row + self.height), slice(column, column + self.width)


class StageTimer:
    """Seconds by stage, summed over a scene's attempts."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextlib.contextmanager
    def stage(self, name: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start


class Peer(Protocol):
    """What a physics library does in this job. A world is whatever the library needs to go on with a scene."""

    def build(self, bodies: list[tubes.Body]) -> Any: ...

    def step(self, world: Any) -> tuple[float, float, float]:
        """One time step; the simulated time, and the highest speed and angular speed of any tube."""

    def run_on(self, world: Any, seconds: float) -> None:
        """Steps with every tube awake, so that what only sleep holds still moves."""

    def centers(self, world: Any) -> np.ndarray:
        """Each tube's centre of mass."""

    def nodes_in_world(self, world: Any, bodies: list[tubes.Body]) -> list[np.ndarray]: ...

    def deepest_penetration(self, world: Any) -> float:
        """By the library's own contacts."""

    def render(self, world: Any, window: Window) -> tuple[np.ndarray, np.ndarray]:
        """Depth along the view in metres, 0 where nothing is, and the label of each pixel of the window."""


def all_inside(centers: np.ndarray) -> bool:
    half = np.array([tubes.BIN_LENGTH, tubes.BIN_WIDTH]) / 2.0
    return bool((np.abs(centers[:, :2]) < half).all() and (centers[:, 2] > 0.0).all())


def settle(peer: Peer, world: Any) -> float | None:
    """Steps until every tube was slower than the thresholds for REST_WINDOW; the simulated time, None if never."""
    quiet_since, next_look = None, LOST_CHECK_INTERVAL
    now = 0.0
    while now < TIME_LIMIT:
        now, speed, angular_speed = peer.step(world)
        if speed > REST_SPEED or angular_speed > REST_ANGULAR_SPEED:
            quiet_since = None
        elif quiet_since is None:
            quiet_since = now
        elif now - quiet_since >= REST_WINDOW:
            return now
        if now >= next_look:
            next_look = now + LOST_CHECK_INTERVAL
            if peer.centers(world)[:, 2].min() < 0.0:
                return None
    return None


def drift(peer: Peer, world: Any, bodies: list[tubes.Body]) -> float:
    """How far any endpoint moves when a scene runs on for CHECK_TIME."""
    before = np.concatenate(peer.nodes_in_world(world, bodies))
    peer.run_on(world, CHECK_TIME)
    return float(np.linalg.norm(np.concatenate(peer.nodes_in_world(world, bodies)) - before, axis=1).max())


def settle_proven(peer: Peer, world: Any, bodies: list[tubes.Body]) -> float | None:
    """Settles until running on moves nothing either, and the penetration is small enough."""
    while (now := settle(peer, world)) is not None:
        if drift(peer, world, bodies) <= DRIFT_MAX:
            return now + CHECK_TIME if peer.deepest_penetration(world) <= PENETRATION_MAX else None
    return None


def write_image(path: Path, window: Window, depth: np.ndarray, label: np.ndarray, nodes: list[np.ndarray]) -> None:
    """Writes depth (metres along the view, 0: nothing hit) and label (0 bin or nothing, k: tube k) at full size.

    The tubes' settled endpoints go beside them, stacked, with the number of endpoints of each.
    """
    full_depth = np.zeros((IMAGE_HEIGHT, IMAGE_WIDTH), np.float32)
    full_label = np.zeros((IMAGE_HEIGHT, IMAGE_WIDTH), np.uint8)
    full_depth[window.pixels()], full_label[window.pixels()] = depth, label
    counts = [len(tube) for tube in nodes]
    np.savez(path, depth=full_depth, label=full_label, nodes=np.concatenate(nodes), counts=counts)


def make_scene(peer: Peer, arguments: argparse.Namespace, case: int) -> dict:
    """One scene, made anew until its tubes lie at rest in the bin; returns its figures."""
    timer = StageTimer()
    for attempt in range(arguments.attempts):
        random = np.random.default_rng([arguments.seed, case, attempt])
        with timer.stage("generate"):
            bodies = [tubes.make_body(tube) for tube in tubes.spawn_tubes(arguments.tubes, random)]
        with timer.stage("build"):
            world = peer.build(bodies)
        with timer.stage("settle"):
            simulated = settle_proven(peer, world, bodies) if arguments.same_gates else settle(peer, world)
        if simulated is not None and all_inside(peer.centers(world)):
            break
    else:
        return {"case": case, "attempts": arguments.attempts, "done": False, "seconds": timer.seconds}
    nodes = peer.nodes_in_world(world, bodies)
    with timer.stage("render"):
        window = Window(nodes)
        depth, label = peer.render(world, window)
    with timer.stage("write"):
        write_image(arguments.output / f"{case:03}.npz", window, depth, label, nodes)
    figures = {"case": case, "attempts": attempt + 1, "done": True, "simulated_seconds": simulated}
    if arguments.report_drift:
        figures["drift"] = drift(peer, world, bodies)
    return figures | {"seconds": timer.seconds}


peer_of_process: Peer


def start_process(make_peer: Callable[[], Peer], full_bin: bool) -> None:
    global peer_of_process
    if full_bin:
        tubes.use_full_bin()
    peer_of_process = make_peer()


def make_scene_in_process(arguments: argparse.Namespace, case: int) -> dict:
    return make_scene(peer_of_process, arguments, case)


def parse_arguments(description: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tubes", type=int, default=10)
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--attempts", type=int, default=20, help="drops of a scene before it is given up")
    parser.add_argument("--full-bin", action="store_true", help="the bin of config/full_bin.yaml")
    parser.add_argument("--output", type=Path, required=True)
    parser.add_argument("--same-gates", action="store_true", help="prove rest and penetration as generate_dataset does")
    parser.add_argument("--report-drift", action="store_true", help="measure each finished scene's drift (not timed)")
    return parser.parse_args()


def main(make_peer: Callable[[], Peer], description: str) -> None:
    """The command line of a peer: makes the scenes and writes a JSON line for each to OUTPUT/figures.jsonl."""
    arguments = parse_arguments(description)
    arguments.output.mkdir(parents=True, exist_ok=True)
    with multiprocessing.Pool(arguments.jobs, start_process, (make_peer, arguments.full_bin)) as pool:
        scenes = pool.starmap(
            make_scene_in_process, [(arguments, case) for case in range(arguments.cases)], chunksize=1
        )
    (arguments.output / "figures.jsonl").write_text("".join(json.dumps(figures) + "\n" for figures in scenes))
    if not all(figures["done"] for figures in scenes):
        raise SystemExit(3)
