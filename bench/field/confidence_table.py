#!/usr/bin/env python3
"""Whether model_tubes is as sure as it is right: of its bridges and tubes that it states a probability of, how many are right.

  confidence_table.py MODEL_TUBES FOLDER... [--scene] [-- OPTION...]

FOLDERs have clouds as field_table.py takes them; without --scene, they are modelled without their scene.json. OPTIONs go to
model_tubes. The probability is 1 / (1 + exp(-log_odds)) of a bridge, and of whole_log_odds of a tube.

A stretch of a tube between its bridges belongs to the true tube that most of its points are of. A bridge is right where the
stretches on both sides belong to one true tube; a tube is right where all of its stretches belong to one, and no other
tube's do. Needs numpy and scipy.
"""
import argparse, json, math, tempfile
from pathlib import Path

import numpy as np

import field_table

BINS = [0.5, 0.7, 0.9, 0.99, 0.999, 1.0]
FEWEST_POINTS = 20  # of a stretch whose true tube is asked for


def probability(log_odds):
    return 1 / (1 + math.exp(-log_odds))


def stretches_and_bridges(tube):
    """The tube's visible stretches, lists of (start, end), and its bridges, (stretch, stretch, log_odds)."""
    stretches, bridges, loose = [], [], []
    for path in sorted({cylinder['path'] for cylinder in tube['cylinders']}):
        before, bridge = None, None
        for cylinder in (c for c in tube['cylinders'] if c['path'] == path):
            if cylinder['bridged']:
                bridge = cylinder
            elif before is None or bridge is not None:
                stretches.append([(cylinder['start'], cylinder['end'])])
                if before is not None:
                    bridges.append((before, len(stretches) - 1, bridge['log_odds']))
                elif bridge is not None:
                    loose.append((len(stretches) - 1, bridge['start'], path, bridge['log_odds']))
                before, bridge = len(stretches) - 1, None
            else:
                stretches[-1].append((cylinder['start'], cylinder['end']))
        if bridge is not None:
            loose.append((before, bridge['end'], path, bridge['log_odds']))
    for stretch, place, path, log_odds in loose:  # the start of a branch, on another path
        distance = [distances(np.array([place]), s)[0] if k != stretch else np.inf for k, s in enumerate(stretches)]
        bridges.append((stretch, int(np.argmin(distance)), log_odds))
    return stretches, bridges


def distances(points, stretch):
    """Of the points to the polyline."""
    least = np.full(len(points), np.inf)
    for start, end in np.array(stretch, float):
        along = end - start
        t = np.clip((points - start) @ along / max(along @ along, 1e-18), 0, 1)
        least = np.minimum(least, np.linalg.norm(points - start - t[:, None] * along, axis=1))
    return least


def true_tubes(tube, stretches, points, found, truth):
    """Of each stretch, the true tube; 0 where too few points tell."""
    own = np.flatnonzero(found == tube['label'])[::5]
    nearest = np.argmin([distances(points[own], stretch) for stretch in stretches], axis=0)
    counts = [np.bincount(truth[own[nearest == k]], minlength=1) for k in range(len(stretches))]
    return [int(np.argmax(c)) if c.sum() * 5 >= FEWEST_POINTS else 0 for c in counts]


def judge(model, points, found, truth):
    """(probability, is right) of every bridge and of every tube whose truth the points tell."""
    bridges, tubes, owners = [], [], {}
    for tube in model['tubes']:
        stretches, joins = stretches_and_bridges(tube)
        if not stretches:  # a ball
            continue
        of_stretch = true_tubes(tube, stretches, points, found, truth)
        for a, b, log_odds in joins:
            if of_stretch[a] and of_stretch[b]:
                bridges.append((probability(log_odds), of_stretch[a] == of_stretch[b]))
        own = set(of_stretch) - {0}
        for true_tube in own:
            owners.setdefault(true_tube, set()).add(tube['label'])
        if own and 'whole_log_odds' in tube:
            tubes.append((probability(tube['whole_log_odds']), own))
    return bridges, [(stated, len(own) == 1 and len(owners[min(own)]) == 1) for stated, own in tubes]


def row(kind, judged):
    if not judged:
        return
    stated, right = np.array(judged, float).T
    cells = []
    for low, high in zip(BINS, BINS[1:]):
        inside = (stated >= low) & ((stated < high) | (high == 1))
        cells.append(f'{stated[inside].mean():.4f}: {int(right[inside].sum())} of {inside.sum()}' if inside.any() else '')
    print(f'| {kind} | {len(stated)} | {stated.mean():.3f} | {right.mean():.3f} | ' + ' | '.join(cells) + ' |', flush=True)


def main():
    arguments, options = field_table.split_arguments()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('model_tubes')
    parser.add_argument('folders', nargs='+', metavar='FOLDER')
    parser.add_argument('--scene', action='store_true', help='leave scene.json beside the clouds of a data set')
    given = parser.parse_args(arguments)
    kinds = {}
    with tempfile.TemporaryDirectory() as work:
        for folder in given.folders:
            for kind, cloud, truth, unit in field_table.clouds(folder, Path(work), given.scene, (0.0, 0.0)):
                full, _ = field_table.model(given.model_tubes, cloud, unit, options, Path(work))
                measured = np.isfinite(full['z'])
                points = np.stack([full['x'], full['y'], full['z']], -1)[measured].astype(float)
                judged = judge(json.loads((Path(work) / 'model/model.json').read_text()), points,
                               full['label'][measured].astype(int), truth[measured])
                for all_judged, of_cloud in zip(kinds.setdefault(kind, ([], [])), judged):
                    all_judged.extend(of_cloud)
    for what, place in (('bridges', 0), ('tubes', 1)):
        print(f'\n| {what} of | number | stated, mean | right | ' +
              ' | '.join(f'{low} to {high}' for low, high in zip(BINS, BINS[1:])) + ' |')
        print('| --- |' + ' ---: |' * (len(BINS) + 2))
        for kind, judged in kinds.items():
            row(kind, judged[place])
        row('all', [entry for judged in kinds.values() for entry in judged[place]])


if __name__ == '__main__':
    main()
