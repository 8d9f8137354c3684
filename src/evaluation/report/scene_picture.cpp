#include "tubebin/evaluation/scene_picture.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>

#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/micro_recall.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::evaluation {
namespace {

constexpr cloud::Color kBackground = 0xffffff;
constexpr cloud::Color kNoLabel = 0x000000;
constexpr cloud::Color kNoTube = 0x9a9a9a;
constexpr cloud::Color kCorrect = 0xd0d0d0;
constexpr cloud::Color kWrong = 0xd55e00;  // Okabe & Ito's vermilion
constexpr double kLongestSide = 520.0;     // pixels
constexpr double kMargin = 6.0;            // pixels

/// Where each point falls in a picture of the points' part of the scanner's image.
struct View {
  std::vector<Eigen::Vector2d> places;
  int width = 1;
  int height = 1;
  int dot = 1;  ///< side of a point's square, pixels
};

View make_view(const LabelledPoints& input) {
  const scene::Camera camera(input.scanner);
  View view;
  Eigen::AlignedBox2d box;
  for (const cloud::Point& point : input.points) {
    view.places.push_back(camera.project_from_world(point.cast<double>()));
    box.extend(view.places.back());
  }
  if (box.isEmpty()) return view;
  const double scale = std::min(1.0, (kLongestSide - 2.0 * kMargin) / std::max(box.sizes().maxCoeff(), 1.0));
  for (Eigen::Vector2d& place : view.places) place = ((place - box.min()) * scale).array() + kMargin;
  view.width = static_cast<int>(box.sizes().x() * scale + 2.0 * kMargin);
  view.height = static_cast<int>(box.sizes().y() * scale + 2.0 * kMargin);
  view.dot = std::clamp(static_cast<int>(std::ceil(scale / std::sqrt(std::max(input.ratio, 0.01)))), 2, 5);
  return view;
}

std::string encode_png(const std::vector<std::uint8_t>& rgb, int width, int height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (png_image_write_get_memory_size(image, size, 0, rgb.data(), 0, nullptr) == 0)
    throw_io_error("a picture cannot be encoded: {}", image.message);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    throw_io_error("a picture cannot be encoded: {}", image.message);
  bytes.resize(size);
  return bytes;
}

template <typename ColorOf>
std::string draw(const View& view, ColorOf color_of) {
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(view.width * view.height) * 3, kBackground & 0xff);
  for (std::size_t i = 0; i < view.places.size(); ++i) {
    const cloud::Color color = color_of(i);
    const int left = static_cast<int>(view.places[i].x()) - view.dot / 2;
    const int top = static_cast<int>(view.places[i].y()) - view.dot / 2;
    for (int y = std::max(top, 0); y < std::min(top + view.dot, view.height); ++y)
      for (int x = std::max(left, 0); x < std::min(left + view.dot, view.width); ++x) {
        std::uint8_t* pixel = &rgb[static_cast<std::size_t>(y * view.width + x) * 3];
        for (int channel = 0; channel < 3; ++channel)
          pixel[channel] = static_cast<std::uint8_t>(color >> (16 - 8 * channel));
      }
  }
  return encode_png(rgb, view.width, view.height);
}

/// The ground-truth id that each predicted id is matched with.
std::vector<std::pair<SegmentId, SegmentId>> matched_pairs(const LabelledPoints& points) {
  const Contingency contingency = count_pairs(points.truth, points.predicted, 0);
  const Matching matching = match_segments(contingency);
  std::vector<std::pair<SegmentId, SegmentId>> pairs;
  for (std::size_t row = 0; row < matching.column_of_row.size(); ++row)
    if (const int column = matching.column_of_row[row]; column != kUnmatched)
      pairs.emplace_back(contingency.predicted_ids[static_cast<std::size_t>(column)], contingency.truth_ids[row]);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

ScenePicture draw_scene(const LabelledPoints& points) {
  const View view = make_view(points);
  const auto pairs = matched_pairs(points);
  const SegmentId largest = points.truth.empty() ? 0 : *std::max_element(points.truth.begin(), points.truth.end());
  const std::vector<cloud::Color> colors = cloud::label_colors(largest);
  const auto matched_truth = [&](std::size_t i) -> std::optional<SegmentId> {
    const auto pair = std::lower_bound(pairs.begin(), pairs.end(), std::pair(points.predicted[i], SegmentId{0}));
    return pair != pairs.end() && pair->first == points.predicted[i] ? std::optional(pair->second) : std::nullopt;
  };
  ScenePicture picture;
  picture.width = view.width;
  picture.height = view.height;
  picture.truth = draw(view, [&](std::size_t i) { return colors[points.truth[i]]; });
  picture.labels = draw(view, [&](std::size_t i) {
    const auto truth = matched_truth(i);
    return truth ? colors[*truth] : points.predicted[i] == kNullId ? kNoLabel : kNoTube;
  });
  picture.errors = draw(view, [&](std::size_t i) {
    if (points.predicted[i] == kNullId) return kNoLabel;
    return matched_truth(i) == points.truth[i] ? kCorrect : kWrong;
  });
  return picture;
}

}  // namespace tubebin::evaluation
