#include "modeling/fitting/piece_cleaning.hpp"

#define BOOST_ALLOW_DEPRECATED_HEADERS  // its own rtree includes one

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <utility>

#include "modeling/labeling.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

namespace geometry = boost::geometry;

/// The pieces' nodes, both ends moved outward by `by` metres.
std::vector<std::vector<Vec3>> lengthened(const std::vector<TubePiece>& pieces, double by) {
  std::vector<std::vector<Vec3>> result;
  for (const TubePiece& piece : pieces) {
    auto nodes = piece.nodes;
    nodes.front() += by * (nodes[0] - nodes[1]).normalized();
    nodes.back() += by * (nodes.back() - nodes[nodes.size() - 2]).normalized();
    result.push_back(std::move(nodes));
  }
  return result;
}

std::vector<char> explained(std::span<const cloud::Point> points, const std::vector<TubePiece>& pieces,
                            double spacing) {
  if (pieces.empty()) return std::vector<char>(points.size(), false);
  const double radius = pieces.front().radius;
  // An end is placed to about a row of points; three cover the row's spacing along a tilted tube.
  const auto nodes = lengthened(pieces, 3.0 * spacing);
  std::vector<TubeSurface> surfaces;
  for (const auto& n : nodes) surfaces.push_back({n, radius});
  return within_surfaces(points, surfaces, radius / 10.0);
}

/// Longer than wide, and at least a third of its visible width is there.
bool is_well_seen(const TubePiece& piece, double spacing) {
  const double full = points_of_visible_stretch(piece.radius, piece.length(), spacing);
  return piece.length() > 2.0 * piece.radius && static_cast<double>(piece.points.size()) > 0.3 * full;
}

/// Finds pieces by their boxes.
class PieceTree {
 public:
  explicit PieceTree(const std::vector<TubePiece>& pieces) : tree_(entries_of(pieces)) {}

  /// Those whose boxes come nearer than `distance` metres to the piece's, ascending.
  std::vector<std::size_t> near(const TubePiece& piece, double distance) const {
    std::vector<std::size_t> found;
    for (auto entry = tree_.qbegin(geometry::index::intersects(box(piece, distance))); entry != tree_.qend(); ++entry)
      found.push_back(entry->second);
    std::ranges::sort(found);
    return found;
  }

 private:
  using Corner = geometry::model::point<double, 3, geometry::cs::cartesian>;
  using Box = geometry::model::box<Corner>;
  using Entry = std::pair<Box, std::size_t>;
  using Tree = geometry::index::rtree<Entry, geometry::index::quadratic<16>>;

  static std::vector<Entry> entries_of(const std::vector<TubePiece>& pieces) {
    std::vector<Entry> entries;
    for (std::size_t k = 0; k < pieces.size(); ++k) entries.emplace_back(box(pieces[k], 0.0), k);
    return entries;
  }

  static Box box(const TubePiece& piece, double margin) {
    const Eigen::AlignedBox3d box = box_of(piece.nodes);
    const Vec3 low = box.min().array() - margin, high = box.max().array() + margin;
    return {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
  }

  Tree tree_;
};

/// Cuts the last node's end of `nodes` back while it lies within `clearance` of `other`; false if nothing is left.
bool cut_end(std::vector<Vec3>& nodes, const std::vector<Vec3>& other, double clearance, double step) {
  while (distance_to_polyline(nodes.back(), other) < clearance) {
    const Vec3 last = nodes.back() - nodes[nodes.size() - 2];
    if (last.norm() > step) {
      nodes.back() -= step * last.normalized();
    } else if (nodes.size() > 2) {
      nodes.pop_back();
    } else {
      return false;
    }
  }
  return true;
}

}  // namespace

Segment unexplained_points(const std::vector<cloud::Point>& points, const std::vector<TubePiece>& pieces,
                           double spacing) {
  const std::vector<char> is_explained = explained(points, pieces, spacing);
  Segment left;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (!is_explained[i]) left.push_back(i);
  return left;
}

FilteredCloud without_pieces(const FilteredCloud& cloud, const std::vector<TubePiece>& pieces) {
  return selected(cloud, unexplained_points(cloud.points, pieces, cloud.spacing));
}

void drop_explained_pieces(std::vector<TubePiece>& pieces, const std::vector<cloud::Point>& points, double spacing) {
  const auto thin = std::stable_partition(pieces.begin(), pieces.end(),
                                          [&](const TubePiece& piece) { return is_well_seen(piece, spacing); });
  const std::vector<TubePiece> well_seen(pieces.begin(), thin);
  std::vector<cloud::Point> thin_points;
  for (auto piece = thin; piece != pieces.end(); ++piece)
    for (const std::uint32_t i : piece->points) thin_points.push_back(points[i]);
  const std::vector<char> is_explained = explained(thin_points, well_seen, spacing);
  std::vector<TubePiece> kept = well_seen;
  auto first = is_explained.begin();
  for (auto piece = thin; piece != pieces.end(); ++piece) {
    const auto last = first + static_cast<std::ptrdiff_t>(piece->points.size());
    const auto count = static_cast<std::size_t>(std::count(first, last, true));
    if (2 * count < piece->points.size()) kept.push_back(std::move(*piece));
    first = last;
  }
  pieces = std::move(kept);
}

void cut_overlaps(std::vector<TubePiece>& pieces) {
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const TubePiece& a, const TubePiece& b) { return a.length() > b.length(); });
  std::vector<bool> is_left(pieces.size(), true);
  const PieceTree tree(pieces);  // pieces only get shorter
  for (std::size_t a = 0; a < pieces.size(); ++a) {
    const double clearance = pieces[a].radius / 2.0, step = pieces[a].radius / 8.0;
    for (const std::size_t b : tree.near(pieces[a], clearance)) {
      if (!is_left[a]) break;
      if (a == b || !is_left[b]) continue;
      for (int end = 0; end < 2 && is_left[a]; ++end) {
        is_left[a] = cut_end(pieces[a].nodes, pieces[b].nodes, clearance, step);
        std::reverse(pieces[a].nodes.begin(), pieces[a].nodes.end());
      }
    }
  }
  std::vector<TubePiece> kept;
  for (std::size_t k = 0; k < pieces.size(); ++k)
    if (is_left[k] && pieces[k].length() > pieces[k].radius / 4.0) kept.push_back(std::move(pieces[k]));
  pieces = std::move(kept);
}

}  // namespace tubebin::modeling
