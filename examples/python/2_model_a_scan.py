"""Finds the tubes of a scan: python3 2_model_a_scan.py [CLOUD.pcd|.ply]; without a file, of a scan with noise."""

import sys

import numpy as np

import tubebin

noise = {"scanner": {"effects": {"range_noise": {"sigma": 0.0001}}}}  # metres, at 1 m
cloud = tubebin.read_cloud(sys.argv[1]) if sys.argv[1:] else tubebin.generate(noise, tubes=6).scan()
model = tubebin.model(cloud.points, cloud.viewpoint)

print(f"{len(model.tubes)} tubes of radius {1e3 * model.radius:.2f} mm, noise {1e3 * model.noise:.2f} mm")
for tube in model.tubes:
    unseen = np.linalg.norm(np.diff(tube.centerline, axis=0), axis=1)[tube.bridged].sum()  # metres
    points = np.count_nonzero(model.labels == tube.label)
    print(f"tube {tube.label}: {tube.length:.3f} m, {unseen:.3f} m of it unseen, {points} points")
for warning in model.warnings:
    print("Warning:", warning)

labeled = tubebin.Cloud(cloud.points, labels=model.labels, viewpoint=cloud.viewpoint)
tubebin.write_cloud("labeled.pcd", labeled)
if cloud.labels is not None:
    print(f"micro-recall {tubebin.evaluate(cloud.labels, model.labels).micro_recall:.4f}")
