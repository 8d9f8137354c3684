#include "modeling/joining/branch_links.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace tubebin::modeling {
namespace {

/// -log of how seldom (1 in 100) a place that a tube takes up is measured as empty.
constexpr double kEmptyLinkCost = 4.6;
/// radii^2 of a branch's side that is seen through and counts as one place: a few cells of the view.
constexpr double kSeenThroughOnce = 0.25;
/// In radii: what is farther ahead is met by chance as likely as by a branch.
constexpr double kReach = 12.0;

/// The first place of the polyline that the way straight on from the tip comes nearer to than half a radius, within
/// `reach`.
std::optional<Vec3> place_ahead(const Vec3& tip, const Vec3& outward, const std::vector<Vec3>& nodes, double radius,
                                double reach) {
  for (double ahead = 0.0; ahead <= reach; ahead += radius / 8.0) {
    const Vec3 place = nearest_on_polyline(tip + ahead * outward, nodes);
    if ((tip + ahead * outward - place).norm() <= radius / 2.0) return place;
  }
  return std::nullopt;
}

/// Straight from the tip to the place, sampled as OcclusionTest wants it.
std::vector<Vec3> line_between(const Vec3& tip, const Vec3& place, double radius) {
  const int steps = std::max(2, static_cast<int>((place - tip).norm() / (radius / 2.0)));
  std::vector<Vec3> line;
  for (int i = 0; i <= steps; ++i) line.push_back(tip + double(i) / steps * (place - tip));
  return line;
}

/// radii^2 of a branch's side between its tip and its place on the other path that a scanner sees through, clear of the
/// other path's surface.
double side_seen_through(const Vec3& tip, const Vec3& place, const TubePiece& other, const OcclusionTest& occlusion) {
  using Evidence = RangeImage::Evidence;
  constexpr int kAround = 48;  // samples, and as far apart along the branch
  constexpr double kStep = 2.0 * std::numbers::pi / kAround;
  const double radius = other.radius, length = (place - tip).norm();
  const Vec3 along = (place - tip) / length;
  const Vec3 right = along.unitOrthogonal(), up = along.cross(right);
  int seen_through = 0;
  for (int k = 0; k < kAround; ++k) {
    const Vec3 normal = std::cos(k * kStep) * right + std::sin(k * kStep) * up;
    for (double ahead = 0.5 * kStep * radius; ahead < length; ahead += kStep * radius) {
      const Vec3 at = tip + ahead * along + radius * normal;
      const Evidence seen = occlusion.facing(at, normal);
      const bool is_empty = seen == Evidence::empty || seen == Evidence::no_data || seen == Evidence::beyond;
      seen_through += is_empty && distance_to_polyline(at, other.nodes) > 1.25 * radius;
    }
  }
  return seen_through * kStep * kStep;
}

/// What the scene's paths are like.
struct Surroundings {
  double radius, bending_rate;
  double chance_cost;  ///< nats, of "a path passes there by chance", in side_cost
};

Surroundings surroundings_of(const std::vector<TubePiece>& paths) {
  Eigen::AlignedBox3d box;
  double length = 0.0;
  for (const TubePiece& path : paths) {
    length += path.length();
    for (const Vec3& node : path.nodes) box.extend(node);
  }
  const double radius = paths.front().radius;
  // Lines of density L a volume pass a ray within w on either side pi / 2 L w times a metre.
  const double line_density = length / (box.sizes().array() + 2.0 * radius).prod();
  return {.radius = radius,
          .bending_rate = estimate_bending_rate(paths, radius),
          .chance_cost = -std::log(4.0 * radius * std::numbers::pi / 2.0 * line_density)};
}

/// A place of another path, or straight ahead of that path's end.
struct Side {
  Vec3 place;
  Vec3 on_path;           ///< the same place, or the end
  double ahead = 0.0;     ///< metres from the end
  double variance = 0.0;  ///< of the place, m^2 an axis
};

/// As in join_candidates.cpp, a direction that walks at random with variance q a metre is off by q D^3 / 3 an axis after a
/// length D.
double variance_ahead(const PieceEnd& end, double length, double bending_rate) {
  return (bending_rate * length / 3.0 + end.direction_variance) * length * length;
}

/// -log of the likelihood ratio of "the end leads to the other path's place" to "that path passes there by chance", where
/// as many ends out of sight lead to another path of their tube as do not.
/// Of the two axes only the one across both counts, since the branch may start anywhere along the other path. Tails are
/// Student's t with 3 degrees of freedom (in 1 dimension, log norm log(2 / (pi sqrt(3)))).
double side_cost(const PieceEnd& end, const Side& side, const Surroundings& around) {
  const Vec3 chord = side.place - end.position;
  const double length = std::max(chord.norm(), around.radius);
  const double ahead = chord.dot(end.outward);
  const double off = ahead > 0.0 ? (chord - ahead * end.outward).norm() : chord.norm();
  const double fit = around.radius / 4.0;
  const double variance = variance_ahead(end, length, around.bending_rate) + side.variance + fit * fit;
  constexpr double kLogNorm = -1.0009;
  const double branch = 2.0 * std::log1p(off * off / (3.0 * variance)) - kLogNorm + 0.5 * std::log(variance);
  return branch + (length + side.ahead) / (4.0 * around.radius) - around.chance_cost;
}

/// Places half a radius apart on the path, and straight ahead of its ends as far as nothing is seen: a fork may be hidden.
std::vector<Side> sides_of(const TubePiece& path, const PieceEnd& first, const PieceEnd& last,
                           const Surroundings& around) {
  const double step = around.radius / 2.0;
  std::vector<Side> sides;
  for (std::size_t k = 0; k + 1 < path.nodes.size(); ++k) {
    const Vec3 along = path.nodes[k + 1] - path.nodes[k];
    const int steps = static_cast<int>(along.norm() / step) + 1;
    for (int i = 0; i <= steps; ++i) {
      const Vec3 place = path.nodes[k] + double(i) / steps * along;
      sides.push_back({.place = place, .on_path = place});
    }
  }
  for (const PieceEnd* end : {&first, &last}) {
    if (end->seen_free >= 0.5) continue;
    const double reach = std::min(end->hidden_reach + around.radius, kReach * around.radius);
    for (double ahead = step; ahead <= reach; ahead += step)
      sides.push_back({.place = end->position + ahead * end->outward,
                       .on_path = end->position,
                       .ahead = ahead,
                       .variance = variance_ahead(*end, ahead, around.bending_rate)});
  }
  return sides;
}

/// The likeliest place of the other path, as far as its shape says.
std::optional<BranchLink> likeliest_side(const PieceEnd& end, const std::vector<Side>& sides,
                                         const Surroundings& around) {
  std::optional<BranchLink> best;
  for (const Side& side : sides) {
    const double length = (side.place - end.position).norm();
    if (length > kReach * around.radius) continue;
    const double cost = side_cost(end, side, around);
    if (!best || cost < best->cost)
      best = {.place = side.place, .on_path = side.on_path, .length = length, .cost = cost};
  }
  return best;
}

/// What the end's and the path's shapes say of a link.
std::optional<BranchLink> link_by_shape(const PieceEnd& end, const TubePiece& other, const std::vector<Side>& sides,
                                        const Surroundings& around) {
  // Fits are off by less than a quarter of a radius, so no flat end seems to lie nearer than the rest.
  const auto on_side = place_on_side(end.position, end.outward, other.nodes, around.radius);
  if (on_side && (*on_side - end.position).norm() <= 0.75 * around.radius)
    return BranchLink{
        .place = *on_side, .on_path = *on_side, .length = (*on_side - end.position).norm(), .cost = kOnSideCost};
  auto link = likeliest_side(end, sides, around);
  if (link) link->cost += kEmptyLinkCost * end.seen_free;
  return link;
}

/// Adds to the link's cost what the scan shows of its way, up to the limit.
void add_evidence(const PieceEnd& end, const TubePiece& other, const OcclusionTest& occlusion, double cost_limit,
                  BranchLink& link) {
  if (link.cost == kOnSideCost) return;  // so near that there is no way
  const double radius = other.radius, samples = std::max(link.length / (2.0 * radius), 1.0);
  link.cost += kEmptyLinkCost * samples * occlusion.empty_part(line_between(end.position, link.place, radius), 1.0);
  if (link.cost >= cost_limit) return;
  const double seen_through = side_seen_through(end.position, link.place, other, occlusion);
  link.cost += kEmptyLinkCost * std::min(seen_through / kSeenThroughOnce, 1.0);
}

bool is_cheaper(const BranchLink& a, const BranchLink& b) { return a.cost < b.cost; }

/// Finds an end's links to the sides of other paths.
class SideLinks {
 public:
  SideLinks(const std::vector<TubePiece>& paths, const std::vector<PieceEnd>& ends, const OcclusionTest& occlusion,
            const Surroundings& around)
      : paths_(paths), ends_(ends), occlusion_(occlusion), around_(around) {
    for (std::size_t p = 0; p < paths.size(); ++p)
      sides_.push_back(sides_of(paths[p], ends[2 * p], ends[2 * p + 1], around));
  }

  /// The cheapest below the limit, `most` of them.
  std::vector<BranchLink> of(std::uint32_t end, double cost_limit, std::size_t most) const {
    std::vector<BranchLink> links;
    for (BranchLink& link : likely_by_shape(end, cost_limit)) {
      // Evidence only adds to what further ones cost.
      if (links.size() == most && links.back().cost <= link.cost) break;
      add_evidence(ends_[end], paths_[link.other], occlusion_, cost_limit, link);
      if (link.cost >= cost_limit) continue;
      links.insert(std::ranges::upper_bound(links, link, is_cheaper), link);
      if (links.size() > most) links.pop_back();
    }
    return links;
  }

 private:
  std::vector<BranchLink> likely_by_shape(std::uint32_t end, double cost_limit) const {
    std::vector<BranchLink> links;
    for (std::uint32_t other = 0; other < paths_.size(); ++other) {
      if (other == end / 2) continue;
      auto link = link_by_shape(ends_[end], paths_[other], sides_[other], around_);
      if (!link || link->cost >= cost_limit) continue;
      link->end = end;
      link->other = other;
      links.push_back(*link);
    }
    std::ranges::sort(links, is_cheaper);
    return links;
  }

  const std::vector<TubePiece>& paths_;
  const std::vector<PieceEnd>& ends_;
  const OcclusionTest& occlusion_;
  const Surroundings& around_;
  std::vector<std::vector<Side>> sides_;
};

}  // namespace

bool is_long(const TubePiece& piece) { return piece.length() >= 4.0 * piece.radius; }

std::optional<Vec3> place_on_side(const Vec3& tip, const Vec3& outward, const std::vector<Vec3>& nodes, double radius) {
  // Closer than nine tenths of a radius, to leave room for what fits are off.
  if (distance_to_polyline(tip, nodes) > 0.9 * radius) return std::nullopt;
  const std::optional<Vec3> place = place_ahead(tip, outward, nodes, radius, 1.5 * radius);
  const bool is_at_end =
      place && ((*place - nodes.front()).norm() <= radius || (*place - nodes.back()).norm() <= radius);
  return is_at_end ? std::nullopt : place;
}

bool faces(const PieceEnd& a, const PieceEnd& b, double radius) {
  constexpr double kAcross = 4.0, kOpposite = -0.8;  // radii; the cosine of 143 degrees
  return (a.position - b.position).norm() < kAcross * radius && a.outward.dot(b.outward) < kOpposite;
}

bool show_branches(const std::vector<TubePiece>& pieces, const std::vector<PieceEnd>& ends) {
  // A tube that runs across another one may seem to end on both of its sides.
  const auto is_crossing = [&](const PieceEnd& end) {
    return std::ranges::any_of(
        ends, [&](const PieceEnd& other) { return other.is_on_side && faces(end, other, pieces.front().radius); });
  };
  const auto whole = std::ranges::count_if(pieces, [](const TubePiece& piece) { return !is_fragment(piece); });
  std::size_t branches = 0;
  for (std::size_t end = 0; end < ends.size(); ++end)
    branches += ends[end].is_on_side && is_long(pieces[end / 2]) && !is_crossing(ends[end]);
  return branches > 0 && 100 * (branches - 1) > static_cast<std::size_t>(whole);
}

std::vector<BranchLink> find_branch_links(const std::vector<TubePiece>& paths, const std::vector<PieceEnd>& ends,
                                          const OcclusionTest& occlusion, double cost_limit) {
  constexpr std::size_t kLinksPerEnd = 4;  // to sides, and as many joins
  std::vector<BranchLink> links;
  if (paths.empty()) return links;
  const Surroundings around = surroundings_of(paths);
  const SideLinks side_links(paths, ends, occlusion, around);
  for (std::uint32_t end = 0; end < ends.size(); ++end)
    std::ranges::copy(side_links.of(end, cost_limit, kLinksPerEnd), std::back_inserter(links));
  const JoinLimits limits{.cost = cost_limit, .joins_per_end = kLinksPerEnd};
  for (const JoinCandidate& join :
       find_join_candidates(paths, ends, find_possible_joins(paths, ends, occlusion, around.bending_rate, limits.cost),
                            occlusion, around.bending_rate, limits))
    links.push_back({.end = join.end_a,
                     .other = join.end_b / 2,
                     .other_end = join.end_b,
                     .place = ends[join.end_b].position,
                     .on_path = ends[join.end_b].position,
                     .length = polyline_length(join.bridge),
                     .cost = join.cost});
  std::ranges::sort(links, is_cheaper);
  return links;
}

}  // namespace tubebin::modeling
