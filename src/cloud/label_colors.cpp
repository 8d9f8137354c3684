#include "tubebin/cloud/label_colors.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <mutex>

#include "tubebin/core/error.hpp"

namespace tubebin::cloud {
namespace {

constexpr Color kBinColor = 0x808080;

/// Candidates are a grid over the RGB cube, without what is too dark or too light to tell hues apart.
constexpr int kGridStep = 8;
constexpr double kMinLightness = 0.40;
constexpr double kMaxLightness = 0.93;

/// Of every value of a channel.
std::array<double, 256> linear_from_srgb() {
  std::array<double, 256> linear;
  for (std::size_t channel = 0; channel < linear.size(); ++channel) {
    const double s = static_cast<double>(channel) / 255.0;
    linear[channel] = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  }
  return linear;
}

/// OKLab, where distances are close to how different people see colours (B. Ottosson, "A perceptual color
/// space for image processing", 2020).
Vec3 oklab(Color color) {
  static const std::array<double, 256> linear = linear_from_srgb();
  const Vec3 rgb(linear[color >> 16 & 0xFF], linear[color >> 8 & 0xFF], linear[color & 0xFF]);
  Eigen::Matrix3d cones_from_rgb;
  cones_from_rgb << 0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451, 0.1073969566, 0.0883024619,
      0.2817188376, 0.6299787005;
  Eigen::Matrix3d lab_from_roots;
  lab_from_roots << 0.2104542553, 0.7936177850, -0.0040720468, 1.9779984951, -2.4285922050, 0.4505937099, 0.0259040371,
      0.7827717662, -0.8086757660;
  const Vec3 cones = cones_from_rgb * rgb;
  return lab_from_roots * cones.unaryExpr([](double cone) { return std::cbrt(cone); });
}

struct Candidate {
  Color color = 0;
  Vec3 lab = Vec3::Zero();
  double distance = std::numeric_limits<double>::max();  ///< squared, to the nearest colour chosen so far
};

std::vector<Candidate> candidates() {
  std::vector<Candidate> all;
  for (Color red = 0; red < 256; red += kGridStep)
    for (Color green = 0; green < 256; green += kGridStep)
      for (Color blue = 0; blue < 256; blue += kGridStep) {
        const Color color = red << 16 | green << 8 | blue;
        const Vec3 lab = oklab(color);
        if (lab[0] >= kMinLightness && lab[0] <= kMaxLightness) all.push_back({color, lab});
      }
  return all;
}

/// Farthest-first traversal (Gonzalez 1985): each colour is the candidate farthest from all before it, so
/// that the first colours are the most different ones and label k has the same colour in every scene.
class ColorSequence {
 public:
  /// The bin's colour and those of the first tubes.
  std::vector<Color> first(std::size_t tube_count) {
    if (tube_count >= free_.size())
      throw_config_error("{} tubes are more than there are colours to tell them apart; valid: below {}", tube_count,
                         free_.size());
    while (colors_.size() <= tube_count) append_farthest();
    return {colors_.begin(), colors_.begin() + static_cast<std::ptrdiff_t>(tube_count) + 1};
  }

 private:
  void append_farthest() {
    const Candidate* farthest = &free_.front();
    for (Candidate& candidate : free_) {
      candidate.distance = std::min(candidate.distance, (candidate.lab - last_).squaredNorm());
      if (candidate.distance > farthest->distance) farthest = &candidate;
    }
    colors_.push_back(farthest->color);
    last_ = farthest->lab;
  }

  std::vector<Candidate> free_ = candidates();
  std::vector<Color> colors_ = {kBinColor};
  Vec3 last_ = oklab(kBinColor);
};

}  // namespace

std::vector<Color> label_colors(std::size_t tube_count) {
  static std::mutex mutex;
  static ColorSequence sequence;
  const std::lock_guard lock(mutex);
  return sequence.first(tube_count);
}

}  // namespace tubebin::cloud
