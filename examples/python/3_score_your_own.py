"""Scores an algorithm of your own, here DBSCAN on positions and normals: python3 3_score_your_own.py [DATASET]."""

import sys

import numpy as np
from sklearn.cluster import DBSCAN

import tubebin


def segment(points: np.ndarray) -> np.ndarray:
    """Labels (H, W) of an organized cloud (H, W, 3): 0 of no tube. A straw man: what crosses a tube cuts it in two."""
    normals = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    inside = (np.abs(points[..., :2]) < [0.27, 0.18]).all(axis=2)  # metres, from the middle of the floor
    chosen = np.isfinite(normals).all(axis=2) & inside & (points[..., 2] > 0.003)
    features = np.hstack([points[chosen], 0.005 * normals[chosen]])
    labels = np.zeros(chosen.shape, int)
    labels[chosen] = DBSCAN(eps=0.005, min_samples=10).fit_predict(features) + 1  # -1, noise, becomes 0
    return labels


if sys.argv[1:]:
    clouds = [sample.cloud for sample in tubebin.Dataset(sys.argv[1])]
else:
    clouds = [tubebin.generate({}, tubes=10, seed=seed).scan() for seed in (10, 11, 12)]
for cloud in clouds:
    theirs = tubebin.evaluate(cloud.labels, segment(cloud.points))
    ours = tubebin.evaluate(cloud.labels, tubebin.model(cloud.points, cloud.viewpoint).labels)
    segments = f"{theirs.predicted_tubes} segments, {ours.predicted_tubes} of tubebin"
    print(f"micro-recall: DBSCAN {theirs.micro_recall:.3f}, tubebin {ours.micro_recall:.3f} ({segments})")
