#include "modeling/fitting/ball_finding.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "modeling/input/normals.hpp"
#include "modeling/sphere_fit.hpp"

namespace tubebin::modeling {
namespace {

/// Of some six hundred that are looked at: a ball's hundredth of the points has six.
constexpr std::size_t kLeastPlaces = 3;

using Sphere = FittedSphere<3>;

/// Whether both places may be of one ball, which each of them tells to a quarter of its radius.
bool agree(const RoundPlace& a, const RoundPlace& b) {
  const double tolerance = (a.radius + b.radius) / 4.0;
  return std::abs(a.radius - b.radius) < tolerance && (a.center - b.center).norm() < tolerance;
}

Sphere mean_of(std::span<const RoundPlace> places) {
  const auto count = static_cast<double>(places.size());
  Sphere mean{.center = Vec3::Zero(), .radius = 0.0};
  for (const RoundPlace& place : places) {
    mean.center += place.center / count;
    mean.radius += place.radius / count;
  }
  return mean;
}

/// Of the radius, metres.
double error_of(const Sphere& sphere) { return std::sqrt(std::max(sphere.radius_variance, 0.0)); }

/// Some ten thousand of the cloud's points, with normals as a tube of that radius lets estimate them.
FilteredCloud sample_of(const FilteredCloud& cloud, const ViewProjection& projection, double radius) {
  constexpr double kSample = 20'000.0;
  const SurfaceNormals surface(cloud, projection, normal_radius(cloud.spacing, radius));
  return thinned(cloud, cloud.spacing * std::sqrt(static_cast<double>(cloud.points.size()) / kSample), surface);
}

/// Points within `part` radii of the sphere's surface whose normals are the sphere's, more or less.
std::vector<Vec3> points_about(const Sphere& sphere, double part, const FilteredCloud& cloud) {
  constexpr double kSameDirection = 0.9;  // cosine
  std::vector<Vec3> about;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Vec3 point = cloud.points[i].cast<double>(), offset = point - sphere.center;
    const double distance = offset.norm();
    if (std::abs(distance - sphere.radius) < part * sphere.radius &&
        offset.dot(cloud.normals[i].cast<double>()) > kSameDirection * distance)
      about.push_back(point);
  }
  return about;
}

/// From the places' estimate to what ever nearer points show; none where most of what lies about it is not on it, or where the
/// points are of a sphere of any radius, as those of a small or flat patch are.
std::optional<Sphere> sphere_of(std::span<const RoundPlace> places, const FilteredCloud& cloud, double noise) {
  constexpr double kOn = 0.02, kAbout = 0.1, kLeastOn = 0.7, kMostError = 0.02;
  constexpr std::size_t kLeastPoints = 20;
  const Sphere estimate = mean_of(places);
  Sphere sphere = estimate;
  const double scatter = 3.0 * noise / sphere.radius;
  for (const double part : {0.3, 0.2, kAbout, kOn + scatter, kOn + scatter}) {
    const std::vector<Vec3> points = points_about(sphere, part, cloud);
    if (points.size() < kLeastPoints) return std::nullopt;
    sphere = fit_sphere<3>(points, sphere);
    if (!(std::abs(sphere.radius - estimate.radius) < estimate.radius / 2.0)) return std::nullopt;
  }
  if (error_of(sphere) > kMostError * sphere.radius) return std::nullopt;
  const auto on = static_cast<double>(points_about(sphere, kOn + scatter, cloud).size());
  const auto about = static_cast<double>(points_about(sphere, kAbout + scatter, cloud).size());
  return on > kLeastOn * about ? std::optional(sphere) : std::nullopt;
}

/// Its evidence is that of its curvature beside a plane's, as a tube's.
TubePiece piece_of(const Sphere& sphere) {
  const double deviations = sphere.radius / std::max(error_of(sphere), 1e-3 * sphere.radius);
  return {.nodes = {sphere.center}, .radius = sphere.radius, .points = {}, .evidence = 0.5 * deviations * deviations};
}

bool is_as_thick(const TubePiece& ball, const TubeClass& tubes) {
  return std::abs(std::log(ball.radius / tubes.radius)) < 0.3;
}

/// Whether most of the piece's centreline is within the ball. That of a tube is nowhere.
bool is_of_ball(const TubePiece& piece, const TubePiece& ball) {
  constexpr int kPlaces = 8;  // of each cylinder
  double inside = 0.0;
  for (std::size_t k = 0; k + 1 < piece.nodes.size(); ++k) {
    const Vec3 step = (piece.nodes[k + 1] - piece.nodes[k]) / kPlaces;
    for (int i = 0; i < kPlaces; ++i)
      if ((piece.nodes[k] + (i + 0.5) * step - ball.nodes.front()).norm() < ball.radius) inside += step.norm();
  }
  return 2.0 * inside > piece.length();
}

}  // namespace

std::vector<TubePiece> find_balls(std::vector<RoundPlace> round, const FilteredCloud& cloud,
                                  const ViewProjection& projection, double noise, std::vector<TubeClass>& classes) {
  std::vector<TubePiece> balls;
  std::optional<FilteredCloud> sample;
  while (!round.empty()) {
    const RoundPlace first = round.front();
    const auto others =
        std::stable_partition(round.begin(), round.end(), [&](const RoundPlace& place) { return agree(place, first); });
    const std::span<const RoundPlace> alike(round.begin(), others);
    if (alike.size() >= kLeastPlaces) {
      if (!sample) sample = sample_of(cloud, projection, classes.empty() ? 0.0 : classes.front().radius);
      if (const auto sphere = sphere_of(alike, *sample, noise)) balls.push_back(piece_of(*sphere));
    }
    round.erase(round.begin(), others);
  }
  std::erase_if(balls, [&](const TubePiece& ball) {
    return std::ranges::any_of(classes, [&](const TubeClass& tubes) { return is_as_thick(ball, tubes); });
  });
  for (TubeClass& tubes : classes)
    std::erase_if(tubes.pieces, [&](const TubePiece& piece) {
      return std::ranges::any_of(balls, [&](const TubePiece& ball) { return is_of_ball(piece, ball); });
    });
  std::erase_if(classes, [](const TubeClass& tubes) { return tubes.pieces.empty(); });
  return balls;
}

}  // namespace tubebin::modeling
