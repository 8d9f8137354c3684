"""Ten tubes fall into a bin, and a scanner sees them: python3 1_generate_and_plot.py [SEED] writes tubes.png."""

import json
import sys

import matplotlib
import numpy as np

import tubebin

matplotlib.use("Agg")
import matplotlib.pyplot as plt

scene = tubebin.generate({"scanner": {"position": [0, 0, 1.8]}}, tubes=10, seed=int(sys.argv[1]) if sys.argv[1:] else 7)
cloud = scene.scan()

figure, (depth, labels) = plt.subplots(1, 2, figsize=(12, 4))
depth.set_title("height above the floor, mm")
figure.colorbar(depth.imshow(1e3 * cloud.points[..., 2]), ax=depth)
labels.set_title("labels")
labels.imshow(np.ma.masked_equal(cloud.labels, 0), cmap="tab10", interpolation="nearest")
for axes in (depth, labels):
    axes.set_axis_off()
figure.savefig("tubes.png", dpi=150)

for tube in json.loads(scene.json)["tubes"]:
    pixels = f"{tube['visible_pixels']} of {tube['amodal_pixels']} pixels"
    print(f"tube {tube['label']}: {tube['length']:.3f} m, {pixels} visible")
