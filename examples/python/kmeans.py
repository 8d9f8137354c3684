"""Labels the tubes of each scene by k-means: python3 kmeans.py DATASET OUTPUT (an example, and a bad method)."""

import sys

import numpy as np

from clouds import scenes, write_labels

dataset, output = sys.argv[1:]
for scene, cloud in scenes(dataset):
    xyz = np.stack([cloud["x"], cloud["y"], cloud["z"]], axis=1)
    inside = (abs(xyz[:, 0]) < 0.27) & (abs(xyz[:, 1]) < 0.18) & (xyz[:, 2] > 0.003)  # metres; NaN is outside
    xyz = xyz[inside]
    centers = xyz[:: max(1, len(xyz) // 10)][:10]
    for _ in range(10):
        label = np.linalg.norm(xyz[:, None] - centers, axis=2).argmin(axis=1)
        centers = np.array([xyz[label == k].mean(axis=0) for k in range(len(centers)) if (label == k).any()])
    write_labels(f"{output}/{scene}.pcd", xyz, label + 1)
