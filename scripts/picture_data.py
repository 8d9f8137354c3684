"""What the pictures of the docs are drawn from: the programs' data sets and models, each made once."""
import json
import pathlib
import subprocess

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCENE = "A10/001"  # of the tutorial's data set


class Work:
    """Runs the programs in a folder, each command once."""

    def __init__(self, bin_dir, folder):
        self.bin_dir, self.folder = pathlib.Path(bin_dir).resolve(), pathlib.Path(folder)

    def run(self, output, program, *arguments):
        if not (self.folder / output).exists():
            subprocess.run([self.bin_dir / program, *arguments], cwd=self.folder, check=True, stdout=subprocess.DEVNULL)
        return self.folder / output

    def dataset(self):
        return self.run("dataset", "generate_dataset", ROOT / "config/set_a.yaml", "--output", "dataset", "--tubes",
                        "1,5,10", "--cases", "2", "--preview", "--quiet")

    def model(self):
        """Folder of the tutorial's model of SCENE."""
        self.dataset()
        return self.run("one", "model_tubes", f"dataset/{SCENE}/cloud.pcd", "--output", "one")

    def results(self):
        self.dataset()
        return self.run("results", "model_tubes", "dataset", "--output", "results", "--ratios", "0.3,1.0", "--method",
                        "both", "--quiet")


def coordinates(cloud):
    return np.stack([cloud["x"], cloud["y"], cloud["z"]], axis=1).astype(float)


def truth_of_labels(work, folder):
    """By evaluate's matching: the true label of each label that was found."""
    table = subprocess.run([work.bin_dir / "evaluate", "--filtered", folder / "filtered.pcd", "--labeled",
                            folder / "labeled.pcd", "--format", "csv"], check=True, capture_output=True, text=True)
    rows = [line.split(",") for line in table.stdout.splitlines()]
    return {int(row[2]): int(row[0]) for row in rows if len(row) > 3 and row[0].isdigit() and row[2].isdigit()}


def read_json(path):
    return json.loads(path.read_text())


def scene_colors(scene):
    return {tube["label"]: tuple(tube["color"]) for tube in scene["tubes"]}


def organized_points(cloud, columns):
    return coordinates(cloud).reshape(-1, columns, 3)


def normals_of(grid):
    """Normals of an organized cloud (rows x columns x 3) by planes through 5 x 5 pixels, towards the scanner above."""
    padded = np.pad(grid, ((2, 2), (2, 2), (0, 0)), constant_values=np.nan)
    window = np.lib.stride_tricks.sliding_window_view(padded, (5, 5), axis=(0, 1)).reshape(*grid.shape, 25)
    near = np.linalg.norm(window - grid[..., None], axis=2) < 0.006
    window = np.where(near[:, :, None], window, 0.0)
    count = np.maximum(near.sum(axis=2), 1)[..., None]
    offset = np.where(near[:, :, None], window - (window.sum(axis=3) / count)[..., None], 0.0)
    covariance = np.einsum("rcip,rcjp->rcij", offset, offset)
    normal = np.linalg.eigh(covariance)[1][..., 0]
    return normal * np.where(normal[..., 2:] < 0, -1, 1), near.sum(axis=2) >= 12
