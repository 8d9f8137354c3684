#!/usr/bin/env python3
"""How far the bins that model_tubes finds by itself are off.

  bin_table.py MODEL_TUBES FOLDER... [--only KIND...] [-- OPTION...]

FOLDERs have clouds as field_table.py takes them, modelled without their scene.json. For each kind: clouds with a bin, bins
found, and of those the largest errors: of length, width and height, of the place of the floor's middle, and of the pose's angle (a
bin looks the same from two sides). Needs numpy and scipy.
"""
import argparse, json, tempfile
from pathlib import Path

import numpy as np

import field_table


def truths(folder):
    """(kind, inner size or nothing, cloud_from_bin) of every cloud, in the order of field_table.clouds."""
    for path in sorted(Path(folder).glob('*.npz')):
        image = np.load(path)
        world_from_camera = np.vstack([image['world_from_camera'], [0, 0, 0, 1]])
        yaw = np.radians(image['yaw_deg'])
        moved = np.eye(4)
        moved[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
        moved[:3, 3] = image['shift']
        pose = moved if image['frame'] == 'world' else np.linalg.inv(world_from_camera)
        yield path.stem.rsplit('_', 1)[0], image['bin'] if image['bin'].size == 3 and image['bin'].all() else None, pose
    for path in sorted(Path(folder).glob('*/*/scene.json')):
        size = json.loads(path.read_text())['bin']
        yield path.parent.parent.name, np.array([size['length'], size['width'], size['height']]), np.eye(4)


def rotation(degrees):
    x, y, z = np.radians(degrees)
    turn = lambda angle, a, b: np.eye(3) + (np.cos(angle) - 1) * np.diag([k in (a, b) for k in range(3)]) + np.sin(angle) * (
        np.outer(np.eye(3)[b], np.eye(3)[a]) - np.outer(np.eye(3)[a], np.eye(3)[b]))
    return turn(z, 0, 1) @ turn(y, 2, 0) @ turn(x, 1, 2)


def errors(found, size, pose):
    """Of length, width, height and place in mm, and of the angle in degrees."""
    off = [1000 * abs(found[key] - true) for key, true in zip(('length', 'width', 'height'), size)]
    place = 1000 * np.linalg.norm(np.array(found['position']) - pose[:3, 3])
    turns = [pose[:3, :3] @ np.diag([side, side, 1]) for side in (1, -1)]
    cosine = max((np.trace(rotation(found['rotation_deg']).T @ turn) - 1) / 2 for turn in turns)
    return [*off, place, np.degrees(np.arccos(np.clip(cosine, -1, 1)))]


def main():
    arguments, options = field_table.split_arguments()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('model_tubes')
    parser.add_argument('folders', nargs='+', metavar='FOLDER')
    parser.add_argument('--only', nargs='*', default=[])
    given = parser.parse_args(arguments)
    kinds = {}
    with tempfile.TemporaryDirectory() as work:
        for folder in given.folders:
            clouds = field_table.clouds(folder, Path(work), False, (0.0, 0.0))
            for (kind, size, pose), (_, cloud, _, unit) in zip(truths(folder), clouds):
                if given.only and kind not in given.only:
                    continue
                field_table.model(given.model_tubes, cloud, unit, options, Path(work))
                found = json.loads((Path(work) / 'model/model.json').read_text())['scene']['bin']
                counts = kinds.setdefault(kind, {'bins': 0, 'found': 0, 'wrong': 0, 'errors': []})
                counts['bins'] += size is not None
                if found and size is None:
                    counts['wrong'] += 1
                elif found:
                    counts['found'] += 1
                    counts['errors'].append(errors(found, size, pose))
    print('| kind | bins | found | found where none is | length, mm | width, mm | height, mm | place, mm | angle, degrees |')
    print('| --- |' + ' ---: |' * 8)
    for kind, counts in kinds.items():
        most = np.max(counts['errors'], axis=0) if counts['errors'] else []
        print(f'| {kind} | {counts["bins"]} | {counts["found"]} | {counts["wrong"]} | ' +
              (' | '.join(f'{x:.1f}' for x in most[:4]) + f' | {most[4]:.2f} |' if len(most) else ' | | | | |'))


if __name__ == '__main__':
    main()
