#include "tubebin/evaluation/pile_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "evaluation/statistics.hpp"
#include "tubebin/evaluation/centerline.hpp"

namespace tubebin::evaluation {
namespace {

/// A cylinder's axis, and whether its ends are free: joined to no other cylinder.
struct TubeAxis {
  Vec3 start;
  Vec3 end;
  double radius = 0.0;
  bool start_is_free = false;
  bool end_is_free = false;

  Vec3 direction() const { return (end - start).normalized(); }
  double length() const { return (end - start).norm(); }
};

std::vector<TubeAxis> axes_of(const scene::PlacedTube& placed) {
  const std::vector<int> degrees = placed.tube.node_degrees();
  std::vector<TubeAxis> axes;
  for (const tube::Cylinder& c : placed.tube.cylinders)
    axes.push_back({placed.node_in_world(c.node_a), placed.node_in_world(c.node_b), placed.tube.radius_of(c),
                    degrees[static_cast<std::size_t>(c.node_a)] < 2, degrees[static_cast<std::size_t>(c.node_b)] < 2});
  return axes;
}

/// Distance of two axes; nothing where a free end is among the closest points (Ericson 2005, Section 5.1.9).
std::optional<double> axis_distance(const TubeAxis& a, const TubeAxis& b) {
  const Vec3 d = a.end - a.start;
  const Vec3 e = b.end - b.start;
  const Vec3 r = a.start - b.start;
  const double dd = d.squaredNorm();
  const double ee = e.squaredNorm();
  const double de = d.dot(e);
  const double denominator = dd * ee - de * de;
  double s = denominator > 1e-12 * dd * ee ? std::clamp((de * e.dot(r) - d.dot(r) * ee) / denominator, 0.0, 1.0) : 0.5;
  const double t = std::clamp((de * s + e.dot(r)) / ee, 0.0, 1.0);
  s = std::clamp((de * t - d.dot(r)) / dd, 0.0, 1.0);
  const bool at_free_end = (s <= 0.0 && a.start_is_free) || (s >= 1.0 && a.end_is_free) ||
                           (t <= 0.0 && b.start_is_free) || (t >= 1.0 && b.end_is_free);
  if (at_free_end) return std::nullopt;
  return (r + s * d - t * e).norm();
}

/// Gap between the surfaces of two tubes, negative where they are in each other.
std::optional<double> gap(const std::vector<TubeAxis>& a, const std::vector<TubeAxis>& b) {
  std::optional<double> smallest;
  for (const TubeAxis& first : a)
    for (const TubeAxis& second : b)
      if (const auto distance = axis_distance(first, second)) {
        const double between = *distance - first.radius - second.radius;
        if (!smallest || between < *smallest) smallest = between;
      }
  return smallest;
}

/// Height of a cylinder's lowest point: of a joint's sphere, or of the rim of a free end.
double lowest_point(const TubeAxis& axis) {
  const double rim = axis.radius * std::hypot(axis.direction().x(), axis.direction().y());
  return std::min(axis.start.z() - (axis.start_is_free ? rim : axis.radius),
                  axis.end.z() - (axis.end_is_free ? rim : axis.radius));
}

void add_heights_and_spread(const std::vector<CenterlineSamples>& samples, PileStatistics& statistics) {
  Vec3 sum = Vec3::Zero();
  double squares = 0.0;
  double count = 0.0;
  for (const CenterlineSamples& tube : samples)
    for (const Vec3& point : tube.points) {
      sum += point;
      squares += point.head<2>().squaredNorm();
      ++count;
    }
  statistics.mean_height = sum.z() / count;
  statistics.spread = std::sqrt(squares / count - (sum.head<2>() / count).squaredNorm());
  for (const CenterlineSamples& tube : samples)
    statistics.visible_share += tube.visible_fraction() / static_cast<double>(samples.size());
}

void add_contacts(const std::vector<std::vector<TubeAxis>>& axes, PileStatistics& statistics) {
  int touching = 0;
  for (std::size_t i = 0; i < axes.size(); ++i)
    for (std::size_t j = i + 1; j < axes.size(); ++j) {
      const auto between = gap(axes[i], axes[j]);
      if (!between) continue;
      touching += *between < kTouchingGap;
      statistics.penetration = std::max(statistics.penetration, -*between);
    }
  statistics.contacts = 2.0 * touching / static_cast<double>(axes.size());
}

void add_cylinders(const std::vector<std::vector<TubeAxis>>& axes, PileStatistics& statistics) {
  double tilt = 0.0;
  double length = 0.0;
  for (const std::vector<TubeAxis>& tube : axes) {
    for (const TubeAxis& axis : tube) {
      tilt += axis.length() * std::asin(std::min(1.0, std::abs(axis.direction().z())));
      length += axis.length();
      statistics.top_height =
          std::max({statistics.top_height, axis.start.z() + axis.radius, axis.end.z() + axis.radius});
      statistics.penetration = std::max(statistics.penetration, -lowest_point(axis));
    }
  }
  statistics.mean_tilt_deg = length > 0.0 ? degrees(tilt / length) : 0.0;
}

/// How a statistic is shown.
struct Column {
  const char* name;
  double PileStatistics::*value;
  double scale;
  int decimals;
};

constexpr Column kColumns[] = {{"mean height, mm", &PileStatistics::mean_height, 1e3, 1},
                               {"top height, mm", &PileStatistics::top_height, 1e3, 1},
                               {"mean tilt, degrees", &PileStatistics::mean_tilt_deg, 1.0, 1},
                               {"spread, mm", &PileStatistics::spread, 1e3, 0},
                               {"contacts a tube", &PileStatistics::contacts, 1.0, 2},
                               {"deepest penetration, mm", &PileStatistics::penetration, 1e3, 2},
                               {"visible points a tube", &PileStatistics::visible_points, 1.0, 0},
                               {"visible share, %", &PileStatistics::visible_share, 1e2, 1}};

std::vector<double> sorted_values(const std::vector<PileStatistics>& piles, const Column& column) {
  std::vector<double> values;
  for (const PileStatistics& pile : piles) values.push_back(column.scale * (pile.*column.value));
  std::sort(values.begin(), values.end());
  return values;
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(sorted.size() - 1)))];
}

}  // namespace

PileStatistics pile_statistics(const scene::Scene& scene, const std::vector<std::size_t>& tube_pixels) {
  PileStatistics statistics;
  if (scene.tubes.empty()) return statistics;
  std::vector<std::vector<TubeAxis>> axes;
  for (const scene::PlacedTube& tube : scene.tubes) axes.push_back(axes_of(tube));
  add_heights_and_spread(sample_centerlines(scene), statistics);
  add_cylinders(axes, statistics);
  add_contacts(axes, statistics);
  for (const std::size_t pixels : tube_pixels)
    statistics.visible_points += static_cast<double>(pixels) / static_cast<double>(scene.tubes.size());
  return statistics;
}

Table pile_table(const std::vector<PileComparison>& comparisons) {
  Table table{"Piles as published and here",
              {"piles", "statistic", "published", "here", "here, 5 %", "here, 95 %", "published within"},
              {},
              ""};
  int within_all = 0;
  int published_all = 0;
  for (const PileComparison& comparison : comparisons) {
    for (const Column& column : kColumns) {
      const std::vector<double> published = sorted_values(comparison.published, column);
      const std::vector<double> here = sorted_values(comparison.here, column);
      if (published.empty() || here.empty()) continue;
      const double low = quantile(here, 0.05);
      const double high = quantile(here, 0.95);
      const auto within =
          std::count_if(published.begin(), published.end(), [&](double v) { return v >= low && v <= high; });
      within_all += static_cast<int>(within);
      published_all += static_cast<int>(published.size());
      table.rows.push_back({comparison.name, column.name, number_cell(mean(published), column.decimals),
                            number_cell(mean(here), column.decimals), number_cell(low, column.decimals),
                            number_cell(high, column.decimals), fmt::format("{} of {}", within, published.size())});
    }
  }
  table.note = fmt::format(
      "{} of {} published values lie between our 5th and 95th percentiles (90 % would by chance, were the "
      "piles alike).",
      within_all, published_all);
  return table;
}

}  // namespace tubebin::evaluation
