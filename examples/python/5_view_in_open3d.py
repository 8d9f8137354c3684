"""Shows a scan in the colours of the tubes that were found, with their centrelines, in Open3D's window."""

import numpy as np

import open3d
import tubebin

cloud = tubebin.generate({}, tubes=10).scan()
model = tubebin.model(cloud.points, cloud.viewpoint)

seen = np.isfinite(cloud.points).all(axis=2)
colors = np.random.default_rng(1).uniform(0.2, 1.0, (len(model.tubes) + 1, 3))
colors[0] = 0.5  # grey, of no tube
shown = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(cloud.points[seen].astype(float)))
shown.colors = open3d.utility.Vector3dVector(colors[model.labels[seen]])

lines = [
    open3d.geometry.LineSet(
        open3d.utility.Vector3dVector(tube.centerline),
        open3d.utility.Vector2iVector([[k, k + 1] for k in range(len(tube.centerline) - 1)]),
    )
    for tube in model.tubes
]
open3d.visualization.draw_geometries([shown, *lines])
