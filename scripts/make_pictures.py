#!/usr/bin/env python3
"""Draws the pictures of README and docs from what the programs make (needs numpy, Pillow and, for the report, Chromium).

usage: scripts/make_pictures.py BIN_DIR [--folder FOLDER] [--only NAME...]
FOLDER keeps the data sets and models between runs; NAME is a function below without its `draw_`.
"""
import argparse
import itertools
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image, ImageDraw

from picture_data import coordinates, normals_of, organized_points, read_json, ROOT, SCENE, scene_colors, truth_of_labels, Work
from picture_drawing import beside, fit, GREY, IMAGES, pale, save, TopView, WHITE

sys.path.insert(0, str(ROOT / "examples/python"))
sys.dont_write_bytecode = True
from clouds import read_pcd  # noqa: E402


def draw_tutorial_scene(work):
    folder = work.dataset() / SCENE
    for name in ("preview", "ground_truth"):
        picture = Image.open(folder / f"{name}.png").convert("RGB")
        picture.thumbnail((720, 480), Image.Resampling.LANCZOS)
        save(picture, f"tutorial_{name}.png", colors=None)


def found(work, view):
    """Draws the tubes that model_tubes found, in the colours of the true tubes that they match."""
    scene, match = read_json(work.dataset() / SCENE / "scene.json"), truth_of_labels(work, work.model())
    colors = scene_colors(scene)
    for tube in read_json(work.model() / "model.json")["tubes"]:
        color = colors.get(match.get(tube["label"]), GREY)
        for k, cylinder in enumerate(tube["cylinders"]):
            view.cylinder(cylinder["start"], cylinder["end"], cylinder["radius"], color, joint=k > 0)
    return view.picture()


def extent(points, margin=0.01):
    low, high = np.nanmin(points, axis=0) - margin, np.nanmax(points, axis=0) + margin
    return (low[0], high[0]), (low[1], high[1])


def labelled(work, view):
    """Draws the points of labeled.pcd in the colours of the true tubes that their labels match."""
    scene, match = read_json(work.dataset() / SCENE / "scene.json"), truth_of_labels(work, work.model())
    colors = scene_colors(scene)
    cloud = read_pcd((work.model() / "labeled.pcd").read_bytes())
    table = np.array([colors.get(match.get(k), GREY) for k in range(cloud["label"].max() + 1)], np.uint8)
    view.splat(coordinates(cloud), table[cloud["label"]], 2)
    return view.picture()


def draw_tutorial_found(work):
    cloud = read_pcd((work.model() / "labeled.pcd").read_bytes())
    x, y = extent(coordinates(cloud))
    save(beside([labelled(work, TopView(x, y, 520)), found(work, TopView(x, y, 520))],
                ["labeled.pcd", "model.json"]), "tutorial_found.png")


def draw_overview(work):
    folder = work.dataset() / SCENE
    cloud = read_pcd((work.model() / "labeled.pcd").read_bytes())
    x, y = extent(coordinates(cloud))
    model = found(work, TopView(x, y, 470))
    truth = np.array(Image.open(folder / "ground_truth.png").convert("RGB"))
    truth[(truth == 0).all(axis=2)] = WHITE
    truth[(truth == 128).all(axis=2)] = (225, 225, 225)
    preview = Image.open(folder / "preview.png").convert("RGB")
    save(beside([fit(preview, model.size), fit(Image.fromarray(truth), model.size), model]), "overview.png")


def draw_full_bins(work):
    """A hundred tubes and hoses of three radii, as previews, side by side."""
    pictures = []
    for config, scene in ("full_bin", "full100/001"), ("euro_bin", "euro10/001"), ("hoses", "hoses15/001"):
        tubes = scene.split("/")[0].removeprefix(config.split("_")[0])
        folder = work.run(config, "generate_dataset", ROOT / f"config/{config}.yaml", "--output", config, "--tubes", tubes,
                          "--cases", "1", "--preview", "--quiet")
        pictures.append(fit(Image.open(folder / scene / "preview.png").convert("RGB"), (360, 270)))
    save(beside(pictures), "full_bins.png", colors=None)


def screenshot(work, page, size):
    """What Chromium shows of the page, drawing WebGL by software; nothing without Chromium."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if not browser:
        print(f"no Chromium here: no picture of {page.name}")
        return None
    shot = work.folder / "screenshot.png"
    subprocess.run([browser, "--headless", "--no-sandbox", "--hide-scrollbars", "--use-gl=angle", "--use-angle=swiftshader",
                    "--enable-unsafe-swiftshader", f"--window-size={size[0]},{size[1]}", "--virtual-time-budget=5000",
                    f"--screenshot={shot}", page.resolve().as_uri()], check=True, stderr=subprocess.DEVNULL)
    return Image.open(shot).resize((size[0] * 3 // 4, size[1] * 3 // 4), Image.Resampling.LANCZOS)


def draw_tutorial_report(work):
    work.results()
    report = work.run("report.html", "evaluate", "results", "--html", "report.html", "--quiet")
    if picture := screenshot(work, report, (1100, 900)):
        save(picture, "tutorial_report.png", 64)


def draw_tutorial_view(work):
    """With a tube chosen, whose numbers stand beside it."""
    work.model()
    page = work.run("view.html", "view", "one")
    choice = """<script>document.querySelector("select").selectedIndex = 5;
        document.querySelector("select").dispatchEvent(new Event("change"));</script>"""
    chosen = work.folder / "chosen.html"
    chosen.write_text(page.read_text().replace("</body>", choice + "</body>"))
    if picture := screenshot(work, chosen, (1100, 800)):
        save(picture, "tutorial_view.png")


def draw_modeling(work):
    """Points, votes, pieces, bridges and joined tubes of one part of the scene."""
    folder = work.dataset() / SCENE
    scene, model = read_json(folder / "scene.json"), read_json(work.model() / "model.json")
    bridges = [c for tube in model["tubes"] for c in tube["cylinders"] if c["bridged"]]
    middle = np.median([np.add(c["start"], c["end"]) / 2 for c in bridges], axis=0)
    x, y = (middle[0] - 0.12, middle[0] + 0.12), (middle[1] - 0.09, middle[1] + 0.09)
    view = lambda: TopView(x, y, 480)

    grid = organized_points(read_pcd((folder / "cloud.pcd").read_bytes()), scene["scanner"]["window"]["width"])
    labels = read_pcd((folder / "cloud.pcd").read_bytes())["label"].reshape(grid.shape[:2])
    normals, known = normals_of(grid)
    tubes = known & (labels > 0) & np.isfinite(grid[..., 2])
    light = (0.45 + 0.55 * np.clip(normals[tubes] @ np.array([-0.35, 0.35, 0.87]), 0, 1))[:, None]
    points = view()
    points.splat(grid[tubes], (light * 210).astype(np.uint8), 3)
    votes = view()
    votes.splat(grid[tubes], pale(GREY, 0.65), 3)
    votes.height[:] = -np.inf
    votes.splat(grid[tubes] - model["radius"] * normals[tubes], (200, 30, 30), 2)

    match, colors = truth_of_labels(work, work.model()), scene_colors(scene)
    pieces, joined = view(), view()
    palette = itertools.cycle([(230, 120, 30), (60, 130, 200), (90, 170, 70), (190, 80, 160), (220, 190, 40), (80, 190, 190)])
    for tube in model["tubes"]:
        color = colors.get(match.get(tube["label"]), GREY)
        piece_color = next(palette)
        for k, c in enumerate(tube["cylinders"]):
            before = tube["cylinders"][k - 1]["bridged"] if k else True
            if c["bridged"]:
                piece_color = next(palette)
            else:
                pieces.cylinder(c["start"], c["end"], c["radius"], piece_color, joint=not before)
            joined.cylinder(c["start"], c["end"], c["radius"], color, joint=k > 0)
    bridged = Image.fromarray(pieces.image.copy())
    draw = ImageDraw.Draw(bridged)
    for c in bridges:
        ends = pieces.pixels(np.array([c["start"], c["end"]]))
        draw.line([tuple(p) for p in ends], (20, 20, 20), 3)
        for u, v in ends:
            draw.ellipse([u - 4, v - 4, u + 4, v + 4], (20, 20, 20))
    save(beside([points.picture(), votes.picture(), bridged, joined.picture()],
                ["points", "votes: a radius behind each point", "pieces, and the bridges that join them", "tubes"],
                columns=2), "modeling.png")


def from_the_front(points):
    """World coordinates (metres) as TopView wants them, to look at the bin from in front, a little aside and above."""
    aside, down = np.radians(25), np.radians(24)
    x, y, z = np.moveaxis(np.asarray(points, float), -1, 0)
    x, y = x * np.cos(aside) + y * np.sin(aside), y * np.cos(aside) - x * np.sin(aside)
    return np.stack([x, z * np.cos(down) + y * np.sin(down), z * np.sin(down) - y * np.cos(down)], axis=-1)


def bin_outline(bin_, step=0.0005):
    """Points (metres) of the bin's floor and of its edges."""
    x, y = (np.arange(-bin_[side] / 2, bin_[side] / 2, step) for side in ("length", "width"))
    floor = np.array([(u, v, 0.0) for u in x for v in y])
    on_edge = (abs(floor[:, 0]) > x[-1] - step / 2) | (abs(floor[:, 1]) > y[-1] - step / 2)
    corners = np.array([(u, v, z) for u in (x[0], x[-1]) for v in (y[0], y[-1]) for z in np.arange(0, bin_["height"], step)])
    return floor, np.concatenate([floor[on_edge], floor[on_edge] + [0.0, 0.0, bin_["height"]], corners])


def draw_drop_stages(work):
    """A scene's tubes when they start, falling and at rest."""
    program = work.bin_dir.parent / "bench/drop_stages"
    stages = json.loads(subprocess.run([program, ROOT / "config/set_a.yaml", "10", "0.3"], check=True,
                                       capture_output=True).stdout)
    scene = read_json(work.dataset() / SCENE / "scene.json")
    floor, edges = map(from_the_front, bin_outline(scene["bin"]))
    nodes = from_the_front([node for stage in stages for tube in stage for node in tube["nodes"]])
    x, y = extent(np.concatenate([nodes, edges]), 0.02)
    pictures = []
    for stage in stages:
        view = TopView(x, y, 330)
        view.splat(floor, (236, 236, 236))
        view.splat(edges, (110, 110, 110), 2)
        for tube, color in zip(stage, scene_colors(scene).values()):
            ends = from_the_front(tube["nodes"])
            for k, (start, end) in enumerate(zip(ends, ends[1:])):
                view.cylinder(start, end, tube["radius"], color, joint=k > 0)
        pictures.append(view.picture())
    save(beside(pictures, ["spawned above the rim", "falling, 0.3 s later", "at rest"]), "drop_stages.png")


def effect_configs(work):
    """Name and scanner.effects of each picture, with the values of scanner_zivid_like.yaml."""
    work.run("zivid", "generate_dataset", ROOT / "config/scanner_zivid_like.yaml", "--output", "zivid", "--tubes", "10",
             "--cases", "1", "--quiet")
    all_effects = read_json(work.folder / "zivid/A10/001/scene.json")["scanner"]["effects"]
    base = {"reference_distance": all_effects["reference_distance"]}
    alone = [("lateral noise", "lateral_noise"), ("projector's shadow", "projector"), ("drop-outs", "dropouts"),
             ("mixed pixels", "mixed_pixels"), ("range noise", "range_noise"), ("outliers", "outliers")]
    configs = [(name, base | {key: all_effects[key]}) for name, key in alone]
    return [("exact", base)] + configs + [("all of scanner_zivid_like.yaml", all_effects)]


def draw_scanner_effects(work):
    """The same pixels under each effect: blue too near, red too far by up to 1 mm, black missing."""
    pictures, titles = [], []
    for number, (name, effects) in enumerate(effect_configs(work)):
        config = work.folder / f"effect_{number}.yaml"
        config.write_text(json.dumps({"include": str(ROOT / "config/set_a.yaml"), "scanner": {"effects": effects},
                                      "output": {"clean_cloud": True}}))
        folder = work.run(f"effect_{number}", "generate_dataset", config, "--output", f"effect_{number}", "--tubes",
                          "10", "--cases", "1", "--quiet") / "A10/001"
        pictures.append(effect_picture(folder))
        titles.append(name)
    save(beside(pictures, titles, columns=4), "scanner_effects.png")


def effect_picture(folder):
    scene = read_json(folder / "scene.json")
    columns = scene["scanner"]["window"]["width"]
    clean_file = folder / "cloud_clean.pcd"
    measured = organized_points(read_pcd((folder / "cloud.pcd").read_bytes()), columns)
    clean = organized_points(read_pcd((clean_file if clean_file.exists() else folder / "cloud.pcd").read_bytes()), columns)
    rows, cols = slice(160, 280), slice(200, 360)
    normals, _ = normals_of(clean[rows, cols])
    light = 0.35 + 0.65 * np.clip(normals @ np.array([-0.35, 0.35, 0.87]), 0, 1)
    off = np.clip((clean - measured)[rows, cols, 2] / 0.001, -1, 1)[..., None]  # metres; positive: too far
    color = np.where(off > 0, [220, 40, 30], [30, 70, 220]) * abs(off) + 235 * (1 - abs(off))
    image = np.where(np.isfinite(off), light[..., None] * color, 0)
    return Image.fromarray(np.nan_to_num(image).astype(np.uint8)).resize((320, 240), Image.Resampling.NEAREST)


def main():
    pictures = {name.removeprefix("draw_"): function for name, function in globals().items() if name.startswith("draw_")}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin_dir")
    parser.add_argument("--folder")
    parser.add_argument("--only", nargs="+", choices=pictures)
    arguments = parser.parse_args()
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(arguments.folder or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        work = Work(arguments.bin_dir, folder)
        for name in arguments.only or pictures:
            pictures[name](work)


if __name__ == "__main__":
    main()
