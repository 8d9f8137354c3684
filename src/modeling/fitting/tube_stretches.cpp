#include "modeling/fitting/tube_stretches.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "modeling/fitting/piece_parts.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kStretch = 4.0;  // radii

/// The piece's centreline by stretches of one length.
std::vector<TubePiece> cut(const TubePiece& piece) {
  const double stretches = std::max(std::round(piece.length() / (kStretch * piece.radius)), 1.0);
  const double length = piece.length() / stretches;
  std::vector<TubePiece> cut(static_cast<std::size_t>(stretches), {.nodes = {}, .radius = piece.radius, .points = {}});
  auto own = cut.begin();
  own->nodes = {piece.nodes.front()};
  double left = length;  // of the stretch, from its last node on
  for (std::size_t k = 1; k < piece.nodes.size(); ++k) {
    while (std::next(own) != cut.end() && (piece.nodes[k] - own->nodes.back()).norm() > left) {
      const Vec3 end = own->nodes.back() + left * (piece.nodes[k] - own->nodes.back()).normalized();
      own->nodes.push_back(end);
      (++own)->nodes = {end};
      left = length;
    }
    left -= (piece.nodes[k] - own->nodes.back()).norm();
    own->nodes.push_back(piece.nodes[k]);
  }
  return cut;
}

void append(TubePiece& run, const TubePiece& stretch) {
  run.nodes.insert(run.nodes.end(), stretch.nodes.begin() + 1, stretch.nodes.end());
  run.points.insert(run.points.end(), stretch.points.begin(), stretch.points.end());
}

}  // namespace

std::vector<TubePiece> tube_stretches(const TubePiece& piece, std::span<const cloud::Point> points,
                                      const std::function<bool(const TubePiece&)>& is_tube) {
  std::vector<TubePiece> stretches = cut(piece), runs;
  share_points(piece, points, stretches);
  bool goes_on = false;
  for (TubePiece& stretch : stretches) {
    const bool is_good = is_tube(stretch);
    if (is_good && goes_on) append(runs.back(), stretch);
    else if (is_good) runs.push_back(std::move(stretch));
    goes_on = is_good;
  }
  std::erase_if(runs, [](const TubePiece& run) { return run.length() < 2.0 * kStretch * run.radius; });
  return runs;
}

}  // namespace tubebin::modeling
