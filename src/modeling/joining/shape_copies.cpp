#include "modeling/joining/shape_copies.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "modeling/joining/sampled_curve.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {
namespace {

/// As in join_candidates.cpp: log of how seldom a place that a tube takes up is measured as empty.
constexpr double kEmptyPlaceCost = 4.6;

/// A copy that costs as much after its first fit costs too much after the others, too.
constexpr double kHopelessCost = 2.0 * kCopyCostLimit;

/// How far from a copy that is not fitted yet its sections may lie, radii.
constexpr double kFirstReach = 1.5;

/// Of a section on a copy, of one shape: half a second's worth. Piles of 12 rods take 0.6 million at most, of 25 2.2, of 40 five.
constexpr std::size_t kMostTests = 5'000'000;

class CopyFinder {
 public:
  CopyFinder(std::span<const Section> sections, const std::vector<Vec3>& shape, double radius,
             const OcclusionTest& occlusion)
      : sections_(sections),
        shape_(shape),
        radius_(radius),
        occlusion_(occlusion),
        is_explained_(sections.size(), false) {
    for (std::size_t k = 0; k < shape.size(); ++k) {
      const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, shape.size() - 1);
      tangents_.push_back((shape[after] - shape[before]).normalized());
      box_.extend(shape[k]);
    }
  }

  /// Copies of which this section is a part, unless it takes too long.
  void add_copies_at(const Section& section) {
    if (tests_ > kMostTests) return;
    std::vector<Vec3> samples = section.samples;
    place_along(samples);
    std::ranges::reverse(samples);
    place_along(samples);
  }

  bool explains(std::uint32_t section) const { return is_explained_[section]; }

  std::vector<ShapeCopy> copies() const {
    std::vector<ShapeCopy> copies;
    for (const auto& [explained, copy] : copies_) copies.push_back(copy);
    return copies;
  }

 private:
  using Places = std::vector<std::uint32_t>;

  /// The section anywhere along the shape where it fits, a radius farther each time.
  void place_along(const std::vector<Vec3>& samples) {
    for (std::size_t first = 0; first + samples.size() <= shape_.size() + 2; first += 2) {
      const std::size_t count = std::min(samples.size(), shape_.size() - first);
      const std::span<const Vec3> along(shape_.data() + first, count), shown(samples.data(), count);
      const Pose pose = best_motion(along, shown);
      if (mean_squared_distance(along, shown, pose) > 0.25 * radius_ * radius_) continue;
      consider(pose);
      turn_about(samples, pose);
    }
  }

  /// A straight section leaves the shape free to turn about it: so that each of the others lies on it, in turn.
  void turn_about(const std::vector<Vec3>& samples, const Pose& pose) {
    const Vec3& origin = samples.front();
    const Vec3 axis = (samples.back() - origin).normalized();
    const auto across = [&](const Vec3& p) -> Vec3 { return p - origin - (p - origin).dot(axis) * axis; };
    // By how far ahead along the axis and how far off it they are, all turns of the shape are the same.
    const auto profile = [&](const Vec3& p) { return Eigen::Vector2d((p - origin).dot(axis), across(p).norm()); };
    std::vector<Vec3> places;
    std::vector<Eigen::Vector2d> profiles;
    Eigen::AlignedBox2d box;
    for (const Vec3& sample : shape_) {
      places.push_back(pose * sample);
      profiles.push_back(profile(places.back()));
      box.extend(profiles.back());
    }
    for (std::uint32_t other = 0; other < sections_.size(); ++other) {
      const Vec3& middle = sections_[other].samples[sections_[other].samples.size() / 2];
      const Eigen::Vector2d sought = profile(middle);
      if (sought.y() < 2.0 * radius_ || box.squaredExteriorDistance(sought) > radius_ * radius_) continue;
      const auto away = [&](const Eigen::Vector2d& each) { return (each - sought).squaredNorm(); };
      const auto nearest = std::ranges::min_element(profiles, {}, away);
      if (away(*nearest) > radius_ * radius_) continue;
      const Vec3 from = across(places[static_cast<std::size_t>(nearest - profiles.begin())]), to = across(middle);
      const double angle = std::atan2(axis.dot(from.cross(to)), from.dot(to));
      const Pose turned =
          Eigen::Translation3d(origin) * Eigen::AngleAxisd(angle, axis) * Eigen::Translation3d(-origin) * pose;
      ++tests_;
      if (place(other, turned.inverse(), kFirstReach * radius_)) consider(turned);
    }
  }

  /// Fits the copy to the sections that it explains. Most copies are hopeless after the first round.
  void consider(const Pose& pose) {
    constexpr int kRounds = 4, kMostTries = 8;
    std::vector<PlacedSection> placed = explained_by(pose, kFirstReach * radius_);
    if (!fix_pose(placed) || ++tries_[places_of(placed)] > kMostTries) return;
    ShapeCopy copy{.shape = &shape_, .pose = pose, .placed = std::move(placed), .cost = 0.0};
    for (int round = 0; round < kRounds; ++round) {
      copy.pose = fitted(copy.pose, copy.placed);
      copy.placed = explained_by(copy.pose, radius_);
      if (!fix_pose(copy.placed)) return;
      if (round == 0 && hidden_cost(copy, {}) > kHopelessCost) return;
    }
    const double misfit = misfit_cost(copy);
    if (misfit + hidden_cost(copy, {}) > kCopyCostLimit) return;
    copy.cost = misfit + hidden_cost(copy, sections_beside(copy));
    if (copy.cost > kCopyCostLimit) return;
    for (const PlacedSection& each : copy.placed) is_explained_[each.section] = true;
    const auto [known, is_new] = copies_.try_emplace(places_of(copy.placed), copy);
    if (!is_new && copy.cost < known->second.cost) known->second = std::move(copy);
  }

  /// Two sections do, and one that bends; a straight one may lie anywhere along a straight stretch, and turned about it.
  bool fix_pose(const std::vector<PlacedSection>& placed) const {
    if (placed.size() != 1) return !placed.empty();
    return sagitta(sections_[placed.front().section].samples) >= 2.0 * radius_;
  }

  static Places places_of(const std::vector<PlacedSection>& placed) {
    Places places;
    for (const PlacedSection& each : placed) places.push_back(each.section);
    std::ranges::sort(places);
    return places;
  }

  Pose fitted(const Pose& pose, const std::vector<PlacedSection>& placed) const {
    const Pose inverse = pose.inverse();
    std::vector<Vec3> from, to;
    for (const PlacedSection& each : placed)
      for (const Vec3& sample : sections_[each.section].samples) {
        from.push_back(nearest_point(inverse * sample));
        to.push_back(sample);
      }
    return best_motion(from, to);
  }

  /// The sections that lie on the copy from one end to the other, no two at one place of it.
  std::vector<PlacedSection> explained_by(const Pose& pose, double reach) {
    tests_ += sections_.size();
    const Pose inverse = pose.inverse();
    std::vector<PlacedSection> placed;
    for (std::uint32_t k = 0; k < sections_.size(); ++k)
      if (const auto on_copy = place(k, inverse, reach)) placed.push_back(*on_copy);
    std::ranges::stable_sort(placed, {}, [](const PlacedSection& each) { return each.first + each.last; });
    constexpr std::size_t kOverlap = 4;  // ends run on by a diameter
    for (std::size_t k = 0; k + 1 < placed.size();) {
      const PlacedSection &one = placed[k], &next = placed[k + 1];
      if (next.first + kOverlap >= one.last) {
        ++k;
        continue;
      }
      const bool keeps_one = one.last - one.first >= next.last - next.first;
      placed.erase(placed.begin() + static_cast<std::ptrdiff_t>(keeps_one ? k + 1 : k));
      if (k > 0) --k;
    }
    return placed;
  }

  std::optional<PlacedSection> place(std::uint32_t k, const Pose& inverse, double reach) const {
    const std::vector<Vec3>& samples = sections_[k].samples;
    const Vec3 center = inverse * samples[samples.size() / 2];
    if (!may_be_near(center, reach)) return std::nullopt;
    const auto [middle, off_middle] = nearest(center);
    if (off_middle > reach) return std::nullopt;
    const Vec3 along = inverse.linear() * (samples.back() - samples.front()).normalized();
    const bool is_fragment = sections_[k].length < 2.0 * radius_;
    if (!is_fragment && std::abs(along.dot(tangents_[middle])) < 0.85) return std::nullopt;
    const auto [first, off_first] = nearest(inverse * samples.front());
    if (off_first > 2.0 * reach) return std::nullopt;
    const auto [last, off_last] = nearest(inverse * samples.back());
    if (off_last > 2.0 * reach) return std::nullopt;
    double squares = 0.0;
    for (const Vec3& sample : samples) squares += std::pow(nearest(inverse * sample).second, 2);
    const double distance = std::sqrt(squares / static_cast<double>(samples.size()));
    if (distance > reach) return std::nullopt;
    return PlacedSection{.section = k,
                         .first = std::min(first, last),
                         .last = std::max(first, last),
                         .is_reversed = first > last,
                         .distance = distance};
  }

  /// Whether some sample may be within `reach` across the shape: by every fourth sample, no farther than a radius from those
  /// between.
  bool may_be_near(const Vec3& place, double reach) const {
    const double farthest = reach + 2.0 * radius_;
    if (box_.squaredExteriorDistance(place) > farthest * farthest) return false;
    for (std::size_t k = 0; k < shape_.size(); k += 4)
      if ((shape_[k] - place).squaredNorm() <= farthest * farthest) return true;
    return (shape_.back() - place).squaredNorm() <= farthest * farthest;
  }

  /// The shape's sample nearest to a place, and the square of its distance.
  std::pair<std::size_t, double> nearest_sample(const Vec3& place) const {
    std::size_t best = 0;
    double squared = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < shape_.size(); ++k)
      if (const double d = (shape_[k] - place).squaredNorm(); d < squared) squared = d, best = k;
    return {best, squared};
  }

  Vec3 nearest_point(const Vec3& place) const {
    const std::size_t k = nearest_sample(place).first;
    const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, shape_.size() - 1);
    return nearest_on_polyline(place, std::span(shape_).subspan(before, after - before + 1));
  }

  /// The shape's sample nearest to a place, and the distance across the shape there; beyond its ends, by as much as fits end
  /// too late, that counts as none.
  std::pair<std::size_t, double> nearest(const Vec3& place) const {
    const auto [best, squared] = nearest_sample(place);
    const double along = std::abs((place - shape_[best]).dot(tangents_[best]));
    const double slack = best == 0 || best + 1 == shape_.size() ? radius_ : radius_ / 4.0;
    return {best, std::sqrt(std::max(squared - std::pow(std::min(along, slack), 2), 0.0))};
  }

  double misfit_cost(const ShapeCopy& copy) const {
    const double sigma = radius_ / 3.0;
    double cost = 0.0;
    for (const PlacedSection& each : copy.placed) cost += 0.5 * std::pow(each.distance / sigma, 2);
    return cost;
  }

  /// What the scan and other sections beside it say against the parts of the copy that no section shows. Neighbouring samples say
  /// much the same: a diameter's worth, four of them, counts once.
  double hidden_cost(const ShapeCopy& copy, const std::vector<const Section*>& others) const {
    std::vector<bool> is_shown(shape_.size(), false);
    for (const PlacedSection& each : copy.placed)
      for (std::size_t k = each.first; k <= each.last; ++k) is_shown[k] = true;
    double cost = 0.0;
    for (std::size_t k = 0; k < shape_.size() && cost <= kHopelessCost; ++k) {
      if (is_shown[k]) continue;
      const Vec3 place = copy.pose * shape_[k], along = copy.pose.linear() * tangents_[k];
      cost += kEmptyPlaceCost / 4.0 * (is_taken(place, others) ? 1.0 : occlusion_.around(place, along).empty);
    }
    return cost;
  }

  /// Those of other tubes that come near the copy.
  std::vector<const Section*> sections_beside(const ShapeCopy& copy) const {
    const Pose inverse = copy.pose.inverse();
    std::vector<const Section*> others;
    for (std::uint32_t k = 0; k < sections_.size(); ++k) {
      const Section& section = sections_[k];
      const Vec3 middle = inverse * section.samples[section.samples.size() / 2];
      const bool is_near = box_.exteriorDistance(middle) < section.length + 2.0 * radius_;
      const auto is_k = [&](const PlacedSection& each) { return each.section == k; };
      if (section.length >= 4.0 * radius_ && is_near && std::ranges::none_of(copy.placed, is_k))
        others.push_back(&section);
    }
    return others;
  }

  /// No two centrelines come nearer than two radii, less what both are off.
  bool is_taken(const Vec3& place, const std::vector<const Section*>& others) const {
    return std::ranges::any_of(others, [&](const Section* other) {
      return std::ranges::any_of(other->samples, [&](const Vec3& sample) {
        return (sample - place).squaredNorm() < 2.25 * radius_ * radius_;
      });
    });
  }

  std::span<const Section> sections_;
  const std::vector<Vec3>& shape_;
  std::vector<Vec3> tangents_;  ///< of the shape's samples
  Eigen::AlignedBox3d box_;     ///< of the shape
  double radius_;
  const OcclusionTest& occlusion_;
  std::vector<bool> is_explained_;  ///< of each section: it is a part of a copy
  std::size_t tests_ = 0;
  std::map<Places, int> tries_;  ///< from poses that seemed to explain these sections
  std::map<Places, ShapeCopy> copies_;
};

/// Those that are long enough to say where a copy may lie, the longest first.
std::vector<std::uint32_t> seeds_of(std::span<const Section> sections, double radius) {
  std::vector<std::uint32_t> seeds;
  for (std::uint32_t k = 0; k < sections.size(); ++k)
    if (sections[k].length >= 3.0 * radius) seeds.push_back(k);
  std::ranges::stable_sort(seeds, std::greater<>(), [&](std::uint32_t k) { return sections[k].length; });
  return seeds;
}

}  // namespace

std::vector<std::vector<ShapeCopy>> find_shape_copies(std::span<const Section> sections,
                                                      std::span<const std::vector<Vec3>> shapes, double radius,
                                                      const OcclusionTest& occlusion, double least_explained) {
  double spare = 0.0;  // metres of sections that may be in no copy
  for (const Section& section : sections) spare += (1.0 - least_explained) * section.length;
  std::vector<CopyFinder> finders;
  for (const std::vector<Vec3>& shape : shapes) finders.emplace_back(sections, shape, radius, occlusion);
  for (const std::uint32_t seed : seeds_of(sections, radius)) {
    tbb::parallel_for(std::size_t{0}, finders.size(), [&](std::size_t k) { finders[k].add_copies_at(sections[seed]); });
    const auto explains = [&](const CopyFinder& finder) { return finder.explains(seed); };
    if (std::ranges::none_of(finders, explains)) spare -= sections[seed].length;
    if (spare < 0.0) return std::vector<std::vector<ShapeCopy>>(shapes.size());
  }
  std::vector<std::vector<ShapeCopy>> copies;
  for (const CopyFinder& finder : finders) copies.push_back(finder.copies());
  return copies;
}

bool lies_on_copy(const Section& section, const ShapeCopy& copy, double radius) {
  const Pose inverse = copy.pose.inverse();
  return std::ranges::all_of(section.samples, [&](const Vec3& sample) {
    return distance_to_polyline(inverse * sample, *copy.shape) < 1.5 * radius;
  });
}

}  // namespace tubebin::modeling
