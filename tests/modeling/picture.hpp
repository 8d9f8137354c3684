/// What a scanner at the origin measures that looks along z.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "modeling/input/source_views.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {

constexpr double kStep = 0.001;  // radians between pixels, and metres between points a metre away

/// Of the depth z(x / z, y / z), 300 rows of 400 points, with normal noise along z.
inline std::vector<cloud::Point> picture(const std::function<double(double, double)>& depth, double noise) {
  Random random(5);
  std::vector<cloud::Point> points;
  for (int row = -150; row < 150; ++row)
    for (int column = -200; column < 200; ++column) {
      const Vec3 ray(column * kStep, row * kStep, 1.0);
      points.push_back((ray * (depth(ray.x(), ray.y()) + noise * random.normal())).cast<float>());
    }
  return points;
}

inline SourceView view_from_origin(const std::vector<cloud::Point>& points) {
  SourceView view{.projection = {Pose::Identity(), cloud::Point(0, 0, 1)}, .points = points};
  view.images = view.projection.images(points);
  view.spacing = estimate_spacing(view.images);
  return view;
}

}  // namespace tubebin::modeling
