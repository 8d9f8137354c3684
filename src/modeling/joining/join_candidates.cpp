#include "modeling/joining/join_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>

#include "modeling/joining/branch_links.hpp"

namespace tubebin::modeling {
namespace {

/// log of how seldom (1 in 100) a place that a tube takes up is measured as empty: at silhouettes, by a bend of the
/// hidden stretch.
constexpr double kEmptyCost = 4.6;

Vec3 hermite(const PieceEnd& a, const PieceEnd& b, double gap, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * a.position + (t3 - 2 * t2 + t) * gap * a.outward + (3 * t2 - 2 * t3) * b.position -
         (t3 - t2) * gap * b.outward;
}

/// The bridge of least bending energy between two ends, to first order: the cubic that leaves and arrives along them.
std::vector<Vec3> bridge_between(const PieceEnd& a, const PieceEnd& b, double radius) {
  const double gap = (b.position - a.position).norm();
  const int steps = std::max(2, static_cast<int>(std::ceil(gap / (radius / 2.0))));
  std::vector<Vec3> bridge;
  for (int i = 0; i <= steps; ++i) bridge.push_back(hermite(a, b, gap, double(i) / steps));
  return bridge;
}

/// The angle between two unit vectors, as a vector across the first.
Vec3 angle_vector(const Vec3& from, const Vec3& to) {
  const Vec3 across = to - to.dot(from) * from;
  const double sine = across.norm();
  return sine < 1e-12 ? Vec3(Vec3::Zero()) : Vec3(across / sine * std::atan2(sine, to.dot(from)));
}

/// Whether two ends overlap or fall short of a bend, so that their chord has no direction of its own: where no two
/// tubes' ends can lie, nearer than a radius, or nearly two where one lies beside the other's tube.
bool have_met(const Vec3& chord, const Vec3& onward, double radius) {
  return chord.norm() <= (chord.dot(onward) < 0.0 ? 1.5 * radius : radius);
}

/// Whether the directions of both ends are known: fragments shorter than a radius have none.
bool have_directions(const PieceEnd& a, const PieceEnd& b) { return a.direction_variance + b.direction_variance < 1.0; }

/// Whether a bridge would turn by more than 120 degrees within the width of two tubes side by side: what hides two such tubes
/// hides their ends alike, and no tube bends about its own side.
bool is_hairpin(const PieceEnd& a, const PieceEnd& b, double radius) {
  return have_directions(a, b) && a.outward.dot(b.outward) > 0.5 && (b.position - a.position).norm() < 3.0 * radius;
}

/// -log of the likelihood ratio of "the tube goes on from a to b" to "b is some other tube's end".
/// A tube's direction walks at random along it with variance q a metre and axis. Its place and direction after a
/// length D are then normal with covariance [q D^3 / 3, q D^2 / 2; q D^2 / 2, q D] an axis, of determinant q^2 D^4 / 12,
/// and the exponent is the bending energy 4 (a^2 + a b + b^2) / D of the cubic that leaves the chord at angle a and
/// arrives at angle b, over 2 q. `other_cost`: of the other explanation, nats.
double shape_cost(const PieceEnd& a, const PieceEnd& b, double bending_rate, double radius, double other_cost) {
  const Vec3 chord = b.position - a.position;
  const double length = std::max(chord.norm(), radius);
  const Vec3 onward = (a.outward - b.outward).normalized();
  const Vec3 along = have_met(chord, onward, radius) ? onward : Vec3(chord.normalized());
  const Vec3 leave = angle_vector(along, a.outward);
  const Vec3 arrive = angle_vector(along, -b.outward);
  const double energy = 4.0 * (leave.squaredNorm() + leave.dot(arrive) + arrive.squaredNorm()) / length;
  const double rate = bending_rate + (a.direction_variance + b.direction_variance) / length;
  const double determinant = rate * rate * length * length * length * length / 12.0;
  // Tubes bend at joints, seldom but at once: tails as of Student's t with 3 degrees of freedom, in 4 dimensions
  // (leaving and arriving, two axes each), log norm Gamma(7/2) / (Gamma(3/2) (3 pi)^2).
  constexpr double kLogNorm = -3.165;
  const double join = 3.5 * std::log1p(energy / (3.0 * rate)) - kLogNorm + std::log(determinant);
  return join - other_cost;
}

/// How far the pieces turn within each stretch of that length from the end of a cylinder on, radians, in ascending order.
std::vector<double> turns_seen(const std::vector<TubePiece>& pieces, double stretch) {
  std::vector<double> turns;
  for (const TubePiece& piece : pieces)
    for (std::size_t first = 0, last = 0; first + 2 < piece.nodes.size(); first = last) {
      const Vec3 direction = piece.nodes[first + 1] - piece.nodes[first];
      double length = 0.0, turn = 0.0;
      for (last = first; last + 2 < piece.nodes.size() && length < stretch;) {
        ++last;
        const Vec3 next = piece.nodes[last + 1] - piece.nodes[last];
        length += next.norm();
        turn = std::max(turn, angle_between(direction, next));
      }
      if (length >= stretch) turns.push_back(turn);
    }
  std::ranges::sort(turns);
  return turns;
}

/// What it costs that the bridge turns more than twice as far within a stretch as the pieces do, nats: by the rule of succession
/// one stretch in n + 2 does, where none of n is seen to. Student's tails reckon with one in seven.
double sharpness_cost(const PieceEnd& a, const PieceEnd& b, const std::vector<double>& turns, double stretch) {
  constexpr double kReckonedWith = 2.0;
  const double turn = angle_between(a.outward, -b.outward);
  const double within = turn * std::min(1.0, stretch / (b.position - a.position).norm());
  const auto as_far = static_cast<double>(turns.end() - std::ranges::lower_bound(turns, 0.5 * within));
  return std::max(std::log((static_cast<double>(turns.size()) + 2.0) / (as_far + 1.0)) - kReckonedWith, 0.0);
}

/// A pair whose cost has what was looked into so far.
struct Examined : PossibleJoin {
  double limit = 0.0;  ///< nats, of the cost
  enum class Step : std::uint8_t { shape, occlusion, room } last = Step::shape;
};

/// What the many bridges ask of each piece.
struct Obstacle {
  const std::vector<Vec3>& nodes;
  bool is_fragment;
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox3d reach;  ///< beyond which a tube is clear of it
  Vec3 middle;                ///< of a fragment, which is one cylinder
};

std::vector<Obstacle> obstacles_of(const std::vector<TubePiece>& pieces) {
  std::vector<Obstacle> obstacles;
  for (const TubePiece& piece : pieces) {
    const Eigen::AlignedBox3d box = box_of(piece.nodes);
    const Vec3 diameter = Vec3::Constant(2.0 * piece.radius);
    obstacles.push_back({.nodes = piece.nodes,
                         .is_fragment = is_fragment(piece),
                         .box = box,
                         .reach = {box.min() - diameter, box.max() + diameter},
                         .middle = 0.5 * (piece.nodes.front() + piece.nodes.back())});
  }
  return obstacles;
}

/// Two tubes cannot occupy one place: how far a bridge comes nearer than two radii to other pieces' centrelines, against
/// how well its course is known (between its ends, the random walk's deviation q D^3 / 192 at the middle).
class RoomTest {
 public:
  RoomTest(const std::vector<Obstacle>& obstacles, double bending_rate, double radius)
      : obstacles_(obstacles), bending_rate_(bending_rate), radius_(radius), blockers_(2 * obstacles.size()) {}

  /// Not summed up beyond `limit`.
  double cost(const std::vector<Vec3>& bridge, const Examined& join, double limit) {
    const double gap = (bridge.back() - bridge.front()).norm();
    const double sigma = std::hypot(0.2 * radius_, std::sqrt(bending_rate_ * gap * gap * gap / 192.0));
    const double step = longest_step(bridge);
    const Eigen::AlignedBox3d own_box = box_of(bridge);
    double cost = 0.0;
    const auto blocks = [&](std::size_t k) {
      const Obstacle& other = obstacles_[k];
      if (k == join.end_a / 2 || k == join.end_b / 2 || other.is_fragment || !own_box.intersects(other.reach))
        return false;
      const double depth = deepest_overlap(bridge, step, other);
      cost += 0.5 * depth * depth / (sigma * sigma);
      return cost > limit;
    };
    // What blocked an end's last bridge is the likeliest to block its next.
    std::size_t& blocker = blockers_[join.end_a];
    const std::size_t first = blocker;
    if (blocks(first)) return cost;
    for (std::size_t k = 0; k < obstacles_.size(); ++k)
      if (k != first && blocks(k)) {
        blocker = k;
        break;
      }
    return cost;
  }

 private:
  double deepest_overlap(const std::vector<Vec3>& bridge, double step, const Obstacle& other) const {
    const double reach = 2.0 * radius_;
    double deepest = 0.0;
    for (std::size_t i = 0; i < bridge.size();) {
      double distance = other.box.exteriorDistance(bridge[i]);
      if (distance < reach - deepest) distance = distance_to_polyline(bridge[i], other.nodes);
      deepest = std::max(deepest, reach - distance);
      // As many samples on, the bridge can have come nearer than it has been, not before.
      i += static_cast<std::size_t>((distance - (reach - deepest)) / step) + 1;
    }
    return deepest;
  }

  const std::vector<Obstacle>& obstacles_;
  double bending_rate_;
  double radius_;
  std::vector<std::size_t> blockers_;  ///< of each end
};

/// The fragments that the bridge, or the pieces beside it, run through: bits of the same tube's surface.
std::vector<std::uint32_t> absorbed_fragments(const std::vector<Vec3>& bridge, const PieceEnd& a, const PieceEnd& b,
                                              const std::vector<Obstacle>& obstacles, std::size_t piece_a,
                                              std::size_t piece_b, double radius) {
  std::vector<Vec3> course = {bridge.front() - radius * a.outward};
  course.insert(course.end(), bridge.begin(), bridge.end());
  course.push_back(bridge.back() - radius * b.outward);
  const Eigen::AlignedBox3d box = box_of(course);
  std::vector<std::uint32_t> absorbed;
  for (std::uint32_t k = 0; k < obstacles.size(); ++k)
    if (k != piece_a && k != piece_b && obstacles[k].is_fragment &&
        box.squaredExteriorDistance(obstacles[k].middle) < radius * radius / 4.0 &&
        distance_to_polyline(obstacles[k].middle, course) < radius / 2.0)
      absorbed.push_back(k);
  return absorbed;
}

/// What the scan says against a bridge; not summed up beyond `limit`. Neighbouring samples, half a radius apart, say
/// much the same: a diameter's worth counts once.
double empty_cost(const std::vector<Vec3>& bridge, const OcclusionTest& occlusion, double radius, double limit) {
  const double gap = (bridge.back() - bridge.front()).norm();
  const double of_all = kEmptyCost * std::max(gap / (2.0 * radius), 1.0);
  return of_all * occlusion.empty_part(bridge, limit / of_all);
}

/// Where a tube would go on beyond an end's rim, radii.
constexpr double kBeyondEnd[] = {0.5, 0.75, 1.0};

/// The part of what lies beyond end a, along the bridge to end b, where the scan shows that no tube is.
double empty_along_bridge(const PieceEnd& a, const PieceEnd& b, const OcclusionTest& occlusion, double radius) {
  const double gap = (b.position - a.position).norm();
  double empty = 0.0, samples = 0.0;
  for (const double reach : kBeyondEnd) {
    const double t = reach * radius / gap;
    if (t > 1.0) break;
    const Vec3 along = hermite(a, b, gap, t + 0.05) - hermite(a, b, gap, t - 0.05);
    empty += occlusion.around(hermite(a, b, gap, t), along.normalized()).empty;
    samples += 1.0;
  }
  return samples > 0.0 ? empty / samples : 0.0;
}

/// What the scan says against a tube that goes on beyond both ends. Where it bends at once, it does so along the bridge
/// and not straight on; fragments, whose bridges lead anywhere, are not believed to.
double free_ends_cost(const PieceEnd& a, const PieceEnd& b, const OcclusionTest& occlusion, double radius) {
  const double straight_on = a.seen_free + b.seen_free;
  if (straight_on == 0.0 || a.is_of_fragment || b.is_of_fragment) return kEmptyCost * straight_on;
  const double along_bridge = empty_along_bridge(a, b, occlusion, radius) + empty_along_bridge(b, a, occlusion, radius);
  return kEmptyCost * std::min(straight_on, along_bridge);
}

/// What a common length says for a join that makes one tube of two chains, nats.
double length_gain(const PossibleJoin& join, const JoinLimits& limits) {
  const std::vector<double>& chains = limits.chain_lengths;
  if (chains.empty()) return 0.0;
  return limits.lengths.gain(chains[join.end_a] + chains[join.end_b] + join.gap, join.gap, 0.0);
}

double bounding_volume(const std::vector<PieceEnd>& ends, double radius) {
  Eigen::AlignedBox3d box;
  for (const PieceEnd& end : ends) box.extend(end.position);
  return (box.sizes().array() + 2.0 * radius).prod();
}

}  // namespace

std::vector<PossibleJoin> find_possible_joins(const std::vector<TubePiece>& pieces, const std::vector<PieceEnd>& ends,
                                              const OcclusionTest& occlusion, double bending_rate, double cost_limit) {
  std::vector<PossibleJoin> pairs;
  if (pieces.empty()) return pairs;
  const double radius = pieces.front().radius;
  const double density = static_cast<double>(ends.size()) / bounding_volume(ends, radius);
  // The bridge ends where the tube comes to light again: some radii on, as wide as occluders are. Another tube's end lies
  // anywhere with the ends' density and points anywhere.
  const double other_cost = -std::log(4.0 * radius * density / (4.0 * std::numbers::pi));
  const double stretch = 4.0 * radius;
  const std::vector<double> turns = turns_seen(pieces, stretch);
  std::vector<double> lengths;
  for (const TubePiece& piece : pieces) lengths.push_back(piece.length());
  for (std::uint32_t a = 0; a < ends.size(); ++a)
    for (std::uint32_t b = a + 1; b < ends.size(); ++b) {
      if (a / 2 == b / 2 || ends[a].is_on_side || ends[b].is_on_side || is_hairpin(ends[a], ends[b], radius)) continue;
      double cost = shape_cost(ends[a], ends[b], bending_rate, radius, other_cost);
      if (!(cost < cost_limit)) continue;
      if (have_directions(ends[a], ends[b])) cost += sharpness_cost(ends[a], ends[b], turns, stretch);
      if (!(cost < cost_limit)) continue;
      cost += free_ends_cost(ends[a], ends[b], occlusion, radius);
      if (!(cost < cost_limit)) continue;
      const double gap = (ends[b].position - ends[a].position).norm();
      pairs.push_back(
          {.end_a = a, .end_b = b, .cost = cost, .gap = gap, .length = lengths[a / 2] + lengths[b / 2] + gap});
    }
  return pairs;
}

bool is_fragment(const TubePiece& piece) { return piece.length() < 2.0 * piece.radius; }

double estimate_bending_rate(const std::vector<TubePiece>& pieces, double radius) {
  double squares = 0.0, length = 0.0;
  for (const TubePiece& piece : pieces) {
    if (piece.length() < 4.0 * radius) continue;
    length += piece.length();
    for (std::size_t k = 1; k + 1 < piece.nodes.size(); ++k) {
      const Vec3 before = (piece.nodes[k] - piece.nodes[k - 1]).normalized();
      const Vec3 after = (piece.nodes[k + 1] - piece.nodes[k]).normalized();
      squares += angle_vector(before, after).squaredNorm();
    }
  }
  // Tubes that look straight may still bend by two degrees a diameter: the limit of what short pieces tell.
  const double least = radians(2.0) * radians(2.0) / (2.0 * radius);
  return length > 0.0 ? std::max(squares / length / 2.0, least) : least;
}

std::vector<PieceEnd> find_piece_ends(const std::vector<TubePiece>& pieces, const OcclusionTest& occlusion,
                                      double reach_limit) {
  std::vector<PieceEnd> ends;
  for (const TubePiece& piece : pieces) {
    const auto& n = piece.nodes;
    for (const auto& [tip, inner] : {std::pair(n.front(), n[1]), std::pair(n.back(), n[n.size() - 2])}) {
      PieceEnd end{.position = tip, .outward = (tip - inner).normalized(), .is_of_fragment = is_fragment(piece)};
      // A cylinder of length l fitted to points with errors of about r / 20 (the curve's tolerance) points that much
      // over l astray; a fragment's axis is known to a quarter of a radius at best.
      const double error = end.is_of_fragment ? piece.radius / 4.0 : piece.radius / 20.0;
      const double astray = 2.0 * error / std::max((tip - inner).norm(), piece.radius / 2.0);
      end.direction_variance = 2.0 * astray * astray;
      for (const double reach : kBeyondEnd)
        end.seen_free += occlusion.around(end.position + reach * piece.radius * end.outward, end.outward).empty;
      end.seen_free /= static_cast<double>(std::size(kBeyondEnd));
      end.is_on_side =
          piece.length() > piece.radius && std::any_of(pieces.begin(), pieces.end(), [&](const auto& other) {
            return &other != &piece && place_on_side(end.position, end.outward, other.nodes, piece.radius).has_value();
          });
      end.hidden_reach = occlusion.hidden_reach(end.position, end.outward, reach_limit);
      ends.push_back(end);
    }
  }
  return ends;
}

std::vector<JoinCandidate> find_join_candidates(const std::vector<TubePiece>& pieces, const std::vector<PieceEnd>& ends,
                                                const std::vector<PossibleJoin>& pairs, const OcclusionTest& occlusion,
                                                double bending_rate, const JoinLimits& limits) {
  std::vector<JoinCandidate> candidates;
  if (pieces.empty()) return candidates;
  const double radius = pieces.front().radius;
  const std::vector<Obstacle> obstacles = obstacles_of(pieces);
  RoomTest room(obstacles, bending_rate, radius);
  const double longest = limits.lengths.longest();
  std::vector<Examined> examined;
  for (const PossibleJoin& pair : pairs) {
    const double limit = limits.cost + length_gain(pair, limits);
    if (pair.cost < limit && !(pair.length > longest)) examined.push_back({pair, limit});
  }
  std::vector<std::vector<Vec3>> bridges(examined.size());  // built when they are first asked for
  // Best first: a pair's cost only grows as it is looked into, so most pairs need no look at all.
  using Entry = std::pair<double, std::uint32_t>;  // cost so far, place in `examined`
  std::vector<Entry> entries;
  for (std::uint32_t k = 0; k < examined.size(); ++k) entries.emplace_back(examined[k].cost, k);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue({}, std::move(entries));
  std::vector<std::size_t> joins_of_end(ends.size(), 0);
  while (!queue.empty()) {
    const std::uint32_t k = queue.top().second;
    queue.pop();
    Examined& pair = examined[k];
    const std::uint32_t a = pair.end_a, b = pair.end_b;
    if (joins_of_end[a] >= limits.joins_per_end && joins_of_end[b] >= limits.joins_per_end) continue;
    std::vector<Vec3>& bridge = bridges[k];
    if (bridge.empty()) bridge = bridge_between(ends[a], ends[b], radius);
    if (pair.last != Examined::Step::room) {
      const double limit = pair.limit - pair.cost;
      if (pair.last == Examined::Step::shape) {
        pair.cost += empty_cost(bridge, occlusion, radius, limit);
        pair.last = Examined::Step::occlusion;
      } else {
        pair.cost += room.cost(bridge, pair, limit);
        pair.last = Examined::Step::room;
      }
      if (pair.cost < pair.limit) queue.emplace(pair.cost, k);
      continue;
    }
    ++joins_of_end[a], ++joins_of_end[b];
    auto absorbed = absorbed_fragments(bridge, ends[a], ends[b], obstacles, a / 2, b / 2, radius);
    candidates.push_back(
        {.end_a = a, .end_b = b, .cost = pair.cost, .bridge = std::move(bridge), .absorbed = std::move(absorbed)});
  }
  return candidates;
}

}  // namespace tubebin::modeling
