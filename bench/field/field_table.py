#!/usr/bin/env python3
"""Recall and false points of model_tubes on whole clouds, nothing told, by kind of cloud.

  field_table.py MODEL_TUBES FOLDER [--method centerline|region_growing] [--only KIND...] [--artefact NAME]
                 [--no-viewpoint] [--check] [-- OPTION...]

FOLDER has either depth images with labels (KIND_N.npz: depth, label, depth_of_0, depth_step, hfov, world_from_camera, frame,
unit, shift, yaw_deg), or is a data set of generate_dataset (SET/CASE/cloud.pcd with its own labels); its clouds are modelled
without their scene.json, and with --scene beside it; with --calibration-error the cloud has moved by so many millimetres and degrees
in a random direction, and scene.json has not. With --artefact the depth images are as a scanner with that artefact (artefacts.py)
has them. OPTIONs go to model_tubes.

recall: share of all tube points of the cloud that carry their tube's label, labels matched one to one (Hungarian).
false: points of anything else that carry a tube's label, as a share of the tube points. seconds: of all steps, without reading
and writing. Needs numpy and scipy.

--check exits with 1 where a cloud's recall is below 0.95 or its false points are above 2 %, with 77 where FOLDER, numpy or
scipy is missing.
"""
import argparse, json, re, shutil, subprocess, sys, tempfile
from pathlib import Path

try:
    import numpy as np
    from scipy.optimize import linear_sum_assignment

    from artefacts import ARTEFACTS, with_artefact
except ImportError as missing:
    print(f'skipped: {missing}')
    sys.exit(77)

TYPES = {('F', '4'): '<f4', ('F', '8'): '<f8', ('U', '4'): '<u4', ('U', '2'): '<u2', ('U', '1'): 'u1', ('I', '4'): '<i4'}


def read_pcd(path):
    raw = Path(path).read_bytes()
    end = raw.index(b'\n', raw.index(b'\nDATA ') + 1) + 1
    head = {line.split()[0]: line.split()[1:] for line in raw[:end].decode().splitlines() if line and line[0] != '#'}
    if head['DATA'] != ['binary']:
        sys.exit(f'{path}: DATA {head["DATA"][0]}; only binary is read here')
    fields = [(n, TYPES[t, s]) for n, t, s in zip(head['FIELDS'], head['TYPE'], head['SIZE'])]
    return np.frombuffer(raw, np.dtype(fields), int(head['POINTS'][0]), end)


def points_of(image):
    """Points (height x width x 3) in the file's frame and unit, and the viewpoint."""
    depth = image['depth']
    height, width = depth.shape
    focal = width / 2 / np.tan(image['hfov'] / 2)
    column, row = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    z = np.where(depth > 0, image['depth_of_0'] + depth * image['depth_step'], np.nan)
    points, viewpoint = np.stack([column / focal * z, row / focal * z, z], -1), np.zeros(3)
    if image['frame'] == 'world':
        pose, yaw = image['world_from_camera'], np.radians(image['yaw_deg'])
        turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        points = (points @ pose[:, :3].T + pose[:, 3]) @ turn.T + image['shift']
        viewpoint = turn @ pose[:, 3] + image['shift']
    return points / image['unit'], viewpoint / image['unit']


def write_organized(points, viewpoint, path):
    height, width = points.shape[:2]
    out = np.zeros(height * width, [('x', '<f4'), ('y', '<f4'), ('z', '<f4')])
    out['x'], out['y'], out['z'] = points.reshape(-1, 3).T
    header = (f'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {width}\nHEIGHT {height}\n'
              f'VIEWPOINT {viewpoint[0]:.6f} {viewpoint[1]:.6f} {viewpoint[2]:.6f} 1 0 0 0\n'
              f'POINTS {height * width}\nDATA binary\n')
    Path(path).write_bytes(header.encode() + out.tobytes())


def move(path, to, millimetres, degrees, random):
    """Writes the cloud and its viewpoint moved and turned about the world's origin."""
    raw, points = path.read_bytes(), read_pcd(path).copy()
    header = raw[:raw.index(b'\n', raw.index(b'\nDATA ') + 1) + 1].decode()
    axis, shift = (v / np.linalg.norm(v) for v in random.normal(size=(2, 3)))
    cross = np.cross(np.eye(3), -axis)
    angle = np.radians(degrees)
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross  # Rodrigues
    moved = lambda p: p @ turn.T + millimetres / 1000 * shift
    points['x'], points['y'], points['z'] = moved(np.stack([points['x'], points['y'], points['z']], -1).astype(float)).T
    viewpoint = re.search(r'VIEWPOINT ((\S+ ){3})', header)[1]
    new = ' '.join(f'{x:.6f}' for x in moved(np.array(viewpoint.split(), float)))
    to.write_bytes(header.replace(f'VIEWPOINT {viewpoint}', f'VIEWPOINT {new} ').encode() + points.tobytes())


def forget_viewpoint(points, labels, random):
    """The measured points (1 x count x 3, metres) and their labels in a random order, in another frame."""
    order = random.permutation(np.flatnonzero(np.isfinite(points).all(-1)))
    points, labels = points.reshape(-1, 3)[order], labels[order]
    return (points - points[labels > 0].mean(0) + [0.8, 0.1, 0.0])[None], labels


def clouds(folder, work, with_scene, calibration_error, artefact=None, no_viewpoint=False):
    """(kind, cloud file, true label of each of its points, factor to metres) of every cloud."""
    random = np.random.default_rng(5)
    for path in sorted(Path(folder).glob('*.npz')):
        image = dict(np.load(path))
        if artefact:
            image = with_artefact(image, artefact, random)
        points, viewpoint = points_of(image)
        labels, unit = image['label'].ravel().astype(int), float(image['unit'])
        if no_viewpoint:
            points, labels = forget_viewpoint(points * unit, labels, random)
            viewpoint, unit = np.zeros(3), 1.0
        write_organized(points, viewpoint, work / 'cloud.pcd')
        yield path.stem.rsplit('_', 1)[0], work / 'cloud.pcd', labels, unit
    for path in sorted(Path(folder).glob('*/*/cloud.pcd')):
        labels = read_pcd(path)['label'].astype(int)
        if with_scene or any(calibration_error):
            shutil.copy(path.parent / 'scene.json', work)
        move(path, work / 'cloud.pcd', *calibration_error, random)
        yield path.parent.parent.name, work / 'cloud.pcd', labels, 1.0


def model(program, cloud, unit, options, work):
    """Labels of all points and the seconds that they took."""
    command = [program, str(cloud), '--output', str(work / 'model'), '--full', *options]
    if unit != 1.0:
        command += ['--scale', str(unit)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(f'{" ".join(command)}: {done.stderr}')
    seconds = json.loads((work / 'model/model.json').read_text())['seconds']['total']
    return read_pcd(work / 'model/full.pcd'), seconds


def score(truth, full):
    measured = np.isfinite(full['z'])
    truth, found = truth[measured], full['label'][measured].astype(int)
    counts = np.zeros((truth.max() + 1, found.max() + 1), int)
    np.add.at(counts, (truth, found), 1)
    tubes = counts[1:].sum()
    off = int((counts[:, 1:].sum(0) > 0).sum()) - int((counts[1:].sum(1) > 0).sum())
    if tubes == 0:  # an empty bin: nothing to miss, and any false point is too many
        return 1.0, float('inf') if counts[0, 1:].any() else 0.0, off
    row, column = linear_sum_assignment(-counts[1:, 1:])
    return counts[1:, 1:][row, column].sum() / tubes, counts[0, 1:].sum() / tubes, off


def split_arguments():
    """The script's own arguments, and those after -- for model_tubes."""
    own, options = sys.argv[1:], []
    if '--' in own:
        options = own[own.index('--') + 1:]
        own = own[:own.index('--')]
    return own, options


def main():
    arguments, options = split_arguments()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('model_tubes')
    parser.add_argument('folder')
    parser.add_argument('--method', default='centerline', choices=['centerline', 'region_growing'])
    parser.add_argument('--only', nargs='*', default=[])
    parser.add_argument('--scene', action='store_true', help='leave scene.json beside the clouds of a data set')
    parser.add_argument('--calibration-error', nargs=2, type=float, default=(0.0, 0.0), metavar=('MM', 'DEG'))
    parser.add_argument('--artefact', choices=ARTEFACTS)
    parser.add_argument('--no-viewpoint', action='store_true', help='unordered points, and the file does not say from where')
    parser.add_argument('--check', action='store_true', help='fail where a cloud is far from the rest')
    given = parser.parse_args(arguments)
    if given.check and not Path(given.folder).is_dir():
        print(f'skipped: no {given.folder}')
        sys.exit(77)
    of_images = '--artefact' if given.artefact else '--no-viewpoint' if given.no_viewpoint else ''
    if of_images and not any(Path(given.folder).glob('*.npz')):
        parser.error(f'{of_images}: {given.folder} has no depth images (KIND_N.npz)')
    kinds = {}
    with tempfile.TemporaryDirectory() as work:
        for kind, cloud, truth, unit in clouds(given.folder, Path(work), given.scene, given.calibration_error,
                                                given.artefact, given.no_viewpoint):
            if given.only and kind not in given.only:
                continue
            full, seconds = model(given.model_tubes, cloud, unit, ['--method', given.method, *options], Path(work))
            kinds.setdefault(kind, []).append((*score(truth, full), seconds))
    if not kinds:
        sys.exit(f'{given.folder}: no cloud' + (f' of {", ".join(given.only)}' if given.only else ''))
    print('| kind | clouds | recall, mean | least | false points, mean | most | count off by more than one | seconds, most |')
    print('| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |')
    for kind, rows in [*kinds.items(), ('all', [row for rows in kinds.values() for row in rows])]:
        recall, false, off, seconds = map(np.array, zip(*rows))
        print(f'| {kind} | {len(rows)} | {recall.mean():.4f} | {recall.min():.4f} | {100 * false.mean():.2f} % | '
              f'{100 * false.max():.2f} % | {(abs(off) > 1).sum()} | {seconds.max():.2f} |', flush=True)
    failed = [kind for kind, rows in kinds.items() if any(row[0] < 0.95 or row[1] > 0.02 for row in rows)]
    if given.check and failed:
        sys.exit(f'recall below 0.95 or false points above 2 %: {", ".join(failed)}')


if __name__ == '__main__':
    main()
