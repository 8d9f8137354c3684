#include "evaluation/report/viewed_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluation/report/base64.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::evaluation {
namespace {

constexpr std::size_t kMostOffTubes = kMostViewedPoints / 5;  // where tubes could fill the view
constexpr double kLeastSide = 1e-6;                           // metres, of the box

bool is_on_tube(const LabelledPoints& points, std::size_t i) {
  return (!points.truth.empty() && points.truth[i] != 0) ||
         (!points.predicted.empty() && points.predicted[i] != kNullId);
}

void append_evenly(const std::vector<std::size_t>& from, std::size_t count, std::vector<std::size_t>& to) {
  for (std::size_t k = 0; k < count; ++k) to.push_back(from[k * from.size() / count]);
}

void append_number(std::uint16_t number, std::string& bytes) {
  bytes += static_cast<char>(number & 0xff);
  bytes += static_cast<char>(number >> 8);
}

}  // namespace

ViewedPoints choose_points(const LabelledPoints& points) {
  std::vector<std::size_t> on_tubes, others;
  for (std::size_t i = 0; i < points.points.size(); ++i)
    if (cloud::is_finite(points.points[i])) (is_on_tube(points, i) ? on_tubes : others).push_back(i);
  if (on_tubes.empty() && others.empty()) throw_io_error("there is no finite point to show");
  const std::size_t room = kMostViewedPoints - std::min(on_tubes.size(), kMostViewedPoints);
  const std::size_t shown_others = std::min(others.size(), std::max(room, kMostOffTubes));
  const std::size_t shown_on_tubes = std::min(on_tubes.size(), kMostViewedPoints - shown_others);
  ViewedPoints viewed;
  append_evenly(on_tubes, shown_on_tubes, viewed.chosen);
  append_evenly(others, shown_others, viewed.chosen);
  std::sort(viewed.chosen.begin(), viewed.chosen.end());
  for (const std::size_t i : viewed.chosen) viewed.box.extend(points.points[i].cast<double>());
  const std::size_t all = on_tubes.size() + others.size(), shown = viewed.chosen.size();
  if (shown == all) viewed.note = fmt::format("All {} points.", all);
  else if (others.empty()) viewed.note = fmt::format("Evenly chosen: {} of {} points.", shown, all);
  else
    viewed.note = fmt::format("Evenly chosen: {} of {} points on tubes, {} of {} others.", shown_on_tubes,
                              on_tubes.size(), shown_others, others.size());
  return viewed;
}

std::string encode_points(const LabelledPoints& points, const ViewedPoints& viewed,
                          std::span<const std::uint16_t> kinds) {
  const Vec3 sides = viewed.box.sizes().cwiseMax(kLeastSide);
  std::string bytes;
  for (const std::size_t i : viewed.chosen) {
    const Vec3 part = (points.points[i].cast<double>() - viewed.box.min()).cwiseQuotient(sides) * 65535.0;
    for (int axis = 0; axis < 3; ++axis) append_number(static_cast<std::uint16_t>(std::lround(part[axis])), bytes);
  }
  const bool is_wide = *std::max_element(kinds.begin(), kinds.end()) > 0xff;
  for (const std::uint16_t kind : kinds)
    if (is_wide) append_number(kind, bytes);
    else bytes += static_cast<char>(kind);
  return base64(bytes);
}

}  // namespace tubebin::evaluation
