// Curves of many samples, to ask what is near them.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "tubebin/core/geometry.hpp"

namespace tubebin::modeling {

/// Samples of a curve, in boxes that answer most questions without a look at the samples. Keeps a reference to them.
class BoxedCurve {
 public:
  explicit BoxedCurve(const std::vector<Vec3>& samples) : samples_(samples) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i % kRun == 0) boxes_.emplace_back();
      boxes_.back().extend(samples[i]);
      box_.extend(samples[i]);
    }
  }

  /// Whether a sample of each are nearer to each other than this.
  bool comes_nearer(const BoxedCurve& other, double distance) const {
    const double squared = distance * distance;
    if (!(box_.squaredExteriorDistance(other.box_) < squared)) return false;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      if (!(boxes_[i].squaredExteriorDistance(other.box_) < squared)) continue;
      for (std::size_t j = 0; j < other.boxes_.size(); ++j)
        if (boxes_[i].squaredExteriorDistance(other.boxes_[j]) < squared && any_nearer(run(i), other.run(j), squared))
          return true;
    }
    return false;
  }

  /// The sample nearest to `p`, soonest where `guess` is near it.
  std::size_t nearest(const Vec3& p, std::size_t guess) const {
    double least = (p - samples_[guess]).squaredNorm();
    for (std::size_t box = 0; box < boxes_.size(); ++box) {
      if (!(boxes_[box].squaredExteriorDistance(p) < least)) continue;
      const std::span<const Vec3> samples = run(box);
      for (std::size_t i = 0; i < samples.size(); ++i)
        if (const double squared = (p - samples[i]).squaredNorm(); squared < least)
          least = squared, guess = box * kRun + i;
    }
    return guess;
  }

 private:
  static constexpr std::size_t kRun = 6;

  std::span<const Vec3> run(std::size_t i) const {
    return std::span(samples_).subspan(i * kRun, std::min(kRun, samples_.size() - i * kRun));
  }
  static bool any_nearer(std::span<const Vec3> a, std::span<const Vec3> b, double squared) {
    for (const Vec3& p : a)
      for (const Vec3& q : b)
        if ((p - q).squaredNorm() < squared) return true;
    return false;
  }

  const std::vector<Vec3>& samples_;
  Eigen::AlignedBox3d box_;
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< of each run of kRun samples
};

}  // namespace tubebin::modeling
