#!/usr/bin/env python3
"""The tables of docs/real_scans.md: model_tubes on real scans that others have published.

  real_scans.py MODEL_TUBES CLONES [--pictures FOLDER] [-- OPTION...]

CLONES is a folder of git clones by their names on GitHub; what is missing there is skipped and named:
  bin-picking-robot (xinyiz0931)       depth images of bent rods, data/test/depthN.png; our labels are in labels/
  Bin-Picking_PointCloud (thantham-ky) RealSense clouds of pipe pieces, data/raw/online/90_real_N_pre.ply; pipes are blue
  data (PointCloudLibrary)             Kinect clouds of cans and mugs, segmentation/mOSD/{learn,test}: nothing there is a tube
OPTIONs go to model_tubes. Needs numpy, scipy and pillow.

Rods: recall is the share of the rods' points that carry their rod's label, labels matched one to one (Hungarian); points
that nobody could tell (255) are left out. false: other points with a rod's label, as a share of the rods' points.
"""
import argparse, colorsys, re, sys, tempfile
from pathlib import Path

import numpy as np
from PIL import Image

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'field'))
from field_table import model, score, split_arguments, write_organized

# The depth images do not say their scale. With these the rods' straight stretches come out round: 8 bit over 62 mm.
FOCAL_PX, FAR_M, RANGE_M = 2431.0, 1.128, 0.062
# The rods' shape, from those that are seen whole in these scans.
ROD = ['--tube-shape', '0.053,90,0.067,90,0.053', '--bend-radius', '0.0175']


def rod_scan(image_path):
    level = np.array(Image.open(image_path).convert('L')).astype(float)
    height, width = level.shape
    row, column = np.mgrid[:height, :width]
    z = np.where(level > 0, FAR_M - level * RANGE_M / 255, np.nan)
    return np.stack([(column + 0.5 - width / 2) * z / FOCAL_PX, (row + 0.5 - height / 2) * z / FOCAL_PX, z], -1)


def colors_of(labels):
    """Grey for 0, white for -1; of one label and the next, hues lie far apart."""
    hues = [colorsys.hsv_to_rgb(0.618 * k % 1, 0.65, 1) for k in range(labels.max())]
    return np.array([(0.5, 0.5, 0.5), *hues, (1, 1, 1)])[labels]


def draw(points, truth, full, path):
    """The scan; the found rods, white where they match no true one; in red the points whose label is not their rod's."""
    from scipy.optimize import linear_sum_assignment
    height, width = points.shape[:2]
    across, down = np.gradient(points[..., 2], axis=1), np.gradient(points[..., 2], axis=0)
    pixel = np.nanmedian(np.diff(points[..., 0], axis=1))
    shade = np.nan_to_num(0.25 + 0.75 / np.sqrt(1 + (across / pixel) ** 2 + (down / pixel) ** 2))[..., None]
    found = full['label'].reshape(height, width).astype(int)
    counts = np.zeros((256, found.max() + 1), int)
    np.add.at(counts, (truth, found), 1)
    matched = np.zeros(found.max() + 1, int)
    row, column = linear_sum_assignment(-counts[1:255, 1:])
    matched[column + 1] = np.where(counts[row + 1, column + 1] > 0, row + 1, 0)
    is_wrong = (matched[found] != truth) & ~((truth == 0) & (found == 0)) & (truth != 255)
    errors = np.where(is_wrong[..., None], (1.0, 0.15, 0.1), 0.8)
    scan = np.full((height, width, 3), 0.8)
    shown = np.where((found > 0) & (matched[found] == 0), -1, matched[found])
    panels = [shade * panel for panel in (scan, colors_of(shown), errors)]
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray((255 * np.concatenate(panels, 1)).astype(np.uint8)).save(path)


def rods(program, folder, options, pictures):
    print('| scan | rods | method | recall | labels | no label | false | seconds |')
    print('| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: |')
    recalls = {}
    for labels in sorted((HERE / 'labels').glob('*.npz'), key=lambda path: int(re.search(r'\d+', path.stem)[0])):
        points, truth = rod_scan(folder / f'{labels.stem}.png'), np.load(labels)['label'].astype(int)
        for method, told in ('centerline', []), ('centerline, shape told', ROD), ('region_growing', []):
            with tempfile.TemporaryDirectory() as work:
                cloud = Path(work) / 'cloud.pcd'
                write_organized(points, np.zeros(3), cloud)
                full, seconds = model(program, cloud, 1.0, ['--method', method.split(',')[0], *told, *options], Path(work))
            told = truth.ravel() != 255
            recall, false, _ = score(truth.ravel()[told], full[told])
            is_rod = (truth.ravel() > 0) & told & np.isfinite(full['z'])
            unlabelled = (full['label'][is_rod] == 0).mean()
            print(f'| {labels.stem} | {truth[truth < 255].max()} | {method} | {recall:.3f} | {full["label"].max()} | '
                  f'{100 * unlabelled:.1f} % | {100 * false:.2f} % | {seconds:.2f} |', flush=True)
            recalls.setdefault(method, []).append(recall)
            if pictures and method == 'centerline':
                draw(points, truth, full, Path(pictures) / f'rods_{labels.stem}.png')
    for method, values in recalls.items():
        print(f'\n{method}: mean recall {np.mean(values):.3f}, least {min(values):.3f}')


def is_blue(path):
    """Of each vertex of an ascii PLY mesh with colours."""
    lines = Path(path).read_text().splitlines()
    count = int(next(line for line in lines if line.startswith('element vertex')).split()[2])
    first = lines.index('end_header') + 1
    rows = np.array([line.split()[:6] for line in lines[first:first + count]], float)
    return rows[:, 5] > rows[:, 3] + 40


def pipes(program, folder, options):
    print('| cloud | blue points with a label | other points with a label | tubes | seconds |')
    print('| --- | ---: | ---: | ---: | ---: |')
    for path in sorted(folder.glob('90_real_*_pre.ply')):
        with tempfile.TemporaryDirectory() as work:
            full, seconds = model(program, path, 1.0, options, Path(work))
        blue = is_blue(path)
        found = full['label'] > 0
        print(f'| {path.stem} | {100 * found[blue].mean():.1f} % | {100 * found[~blue].mean():.1f} % | '
              f'{full["label"].max()} | {seconds:.2f} |', flush=True)


def cans(program, folder, options):
    files = [folder / f'learn/learn{k}.pcd' for k in range(33, 45)] + [folder / f'test/test{k}.pcd' for k in range(31, 43)]
    shares = []
    for path in files:
        with tempfile.TemporaryDirectory() as work:
            full, _ = model(program, path, 1.0, options, Path(work))
        shares.append((full['label'][np.isfinite(full['z'])] > 0).mean())
    print(f'{len(files)} clouds of cans and mugs, no tube in any: {100 * np.mean(shares):.1f} % of their points carry a '
          f"tube's label, {100 * max(shares):.1f} % at most, none in {sum(share == 0 for share in shares)} of the clouds")


def main():
    arguments, options = split_arguments()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('model_tubes')
    parser.add_argument('clones', type=Path)
    parser.add_argument('--pictures', help='folder for a picture of each scan of rods')
    given = parser.parse_args(arguments)
    for title, inside, table in (
            ('Bent rods, PhoXi', 'bin-picking-robot/data/test',
             lambda folder: rods(given.model_tubes, folder, options, given.pictures)),
            ('Pipe pieces, RealSense', 'Bin-Picking_PointCloud/data/raw/online',
             lambda folder: pipes(given.model_tubes, folder, options)),
            ('Cans and mugs, Kinect', 'data/segmentation/mOSD', lambda folder: cans(given.model_tubes, folder, options))):
        print(f'\n## {title}\n')
        folder = given.clones / inside
        if folder.is_dir():
            table(folder)
        else:
            print(f'skipped: no {folder}')


if __name__ == '__main__':
    main()
