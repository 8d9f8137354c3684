#include "modeling/fitting/piece_parts.hpp"

namespace tubebin::modeling {

void share_points(const TubePiece& piece, std::span<const cloud::Point> points, std::vector<TubePiece>& parts) {
  if (parts.empty()) return;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const TubePiece& part : parts) boxes.push_back(box_of(part.nodes));
  std::size_t nearest = 0;  // mostly that of the point before
  for (const std::uint32_t i : piece.points) {
    const Vec3 p = points[i].cast<double>();
    double least = distance_to_polyline(p, parts[nearest].nodes);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      if (k == nearest || boxes[k].squaredExteriorDistance(p) > least * least) continue;
      const double distance = distance_to_polyline(p, parts[k].nodes);
      if (distance < least || (distance == least && k < nearest)) least = distance, nearest = k;
    }
    parts[nearest].points.push_back(i);
  }
}

}  // namespace tubebin::modeling
