"""Trains a small network to see where tubes end in depth images: python3 4_train_on_depth_images.py [STEPS]."""

import sys

import torch
from torch import nn
from torch.utils.data import DataLoader

from tubebin.torch import Scenes

CONFIG = {"scanner": {"region": "full", "width": 192, "height": 128, "horizontal_fov_deg": 17}}
CLASSES = ["bin", "tube", "edge"]  # edge: the next pixel to the left or above has another label


def depth_and_classes(sample):
    """Depth (1, H, W), decimetres from the nearest point, and CLASSES of the pixels (H, W)."""
    depth = torch.from_numpy(sample.depth_image.depth)
    labels = torch.from_numpy(sample.depth_image.labels.astype("int64"))
    edge = (labels != labels.roll(1, 0)) | (labels != labels.roll(1, 1))
    return 10 * (depth - depth.min())[None], torch.where(edge, 2, (labels > 0).long())


torch.manual_seed(1)
layers, inputs = [], 1
for dilation in (1, 1, 2, 4, 8):
    layers += [nn.Conv2d(inputs, 16, 3, padding="same", dilation=dilation), nn.GroupNorm(4, 16), nn.ReLU()]
    inputs = 16
network = nn.Sequential(*layers, nn.Conv2d(inputs, len(CLASSES), 1))
optimizer = torch.optim.Adam(network.parameters(), lr=1e-2)
steps = int(sys.argv[1]) if sys.argv[1:] else 120
scenes = Scenes(CONFIG, seed=1, cases=4 * steps, batch_size=4, transform=depth_and_classes)
for step, (depth, classes) in enumerate(DataLoader(scenes, batch_size=4, num_workers=2), 1):
    loss = nn.functional.cross_entropy(network(depth), classes, weight=torch.tensor([1.0, 1.0, 3.0]))  # edges are few
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()
    if step % 10 == 0:
        print(f"step {step}: cross-entropy {loss.item():.3f}", flush=True)

unseen = Scenes(CONFIG, seed=2, cases=20, batch_size=20, transform=depth_and_classes)
depth, classes = next(iter(DataLoader(unseen, batch_size=20)))
found = network(depth).argmax(dim=1)
for k, name in enumerate(CLASSES):
    print(f"{name}: IoU {((found == k) & (classes == k)).sum() / ((found == k) | (classes == k)).sum():.3f}")
