#include "tubebin/modeling/branch_joining.hpp"

#include <algorithm>

#include "tubebin/modeling/vote_voxels.hpp"

namespace tubebin {
namespace {

struct Tip {
  Vec3 position;
  Vec3 outward;  ///< unit
};

Tip tip_of(const TubePath& path, bool last) {
  const auto& n = path.nodes;
  const Vec3 tip = last ? n.back() : n.front(), inner = last ? n[n.size() - 2] : n[1];
  return {tip, (tip - inner).normalized()};
}

/// The first place of the polyline that the way straight on from the tip comes nearer to than half a radius, within
/// `reach`.
std::optional<Vec3> place_ahead(const Tip& tip, const std::vector<Vec3>& nodes, double radius, double reach) {
  for (double ahead = 0.0; ahead <= reach; ahead += radius / 8.0) {
    const Vec3 place = nearest_on_polyline(tip.position + ahead * tip.outward, nodes);
    if ((tip.position + ahead * tip.outward - place).norm() <= radius / 2.0) return place;
  }
  return std::nullopt;
}

struct Branch {
  std::uint32_t path = 0, other = 0;
  bool last = false;  ///< which of the path's ends
  Vec3 place = Vec3::Zero();
};

/// The branches that `leads_to(tip, other path)` finds among the ends that have none yet, each with the path that it
/// meets first.
template <typename LeadsTo>
void find_branches(const std::vector<TubePath>& paths, const LeadsTo& leads_to, std::vector<Branch>& branches) {
  for (std::uint32_t p = 0; p < paths.size(); ++p)
    for (const bool last : {false, true}) {
      if (std::any_of(branches.begin(), branches.end(), [&](const Branch& b) { return b.path == p && b.last == last; }))
        continue;
      const Tip tip = tip_of(paths[p], last);
      std::optional<Branch> first;
      for (std::uint32_t q = 0; q < paths.size(); ++q) {
        if (q == p) continue;
        const std::optional<Vec3> place = leads_to(tip, paths[q]);
        if (place && (!first || (*place - tip.position).norm() < (first->place - tip.position).norm()))
          first = {.path = p, .other = q, .last = last, .place = *place};
      }
      if (first) branches.push_back(*first);
    }
}

void lead_up(TubePath& path, const Branch& branch) {
  path.nodes.insert(branch.last ? path.nodes.end() : path.nodes.begin(), branch.place);
  path.bridged.insert(branch.last ? path.bridged.end() : path.bridged.begin(), true);
}

/// Straight from the tip to the place, sampled as OcclusionTest wants it.
std::vector<Vec3> line_between(const Vec3& tip, const Vec3& place, double radius) {
  const int steps = std::max(2, static_cast<int>((place - tip).norm() / (radius / 2.0)));
  std::vector<Vec3> line;
  for (int i = 0; i <= steps; ++i) line.push_back(tip + double(i) / steps * (place - tip));
  return line;
}

}  // namespace

std::optional<Vec3> place_on_side(const Vec3& tip, const Vec3& outward, const std::vector<Vec3>& nodes, double radius) {
  // Closer than nine tenths of a radius, to leave room for what fits are off.
  if (distance_to_polyline(tip, nodes) > 0.9 * radius) return std::nullopt;
  const std::optional<Vec3> place = place_ahead({tip, outward}, nodes, radius, 1.5 * radius);
  const bool is_at_end =
      place && ((*place - nodes.front()).norm() <= radius || (*place - nodes.back()).norm() <= radius);
  return is_at_end ? std::nullopt : place;
}

std::vector<TubeModel> join_branches(std::vector<TubePath> paths, double radius, const OcclusionTest& occlusion) {
  std::sort(paths.begin(), paths.end(),
            [](const TubePath& a, const TubePath& b) { return polyline_length(a.nodes) > polyline_length(b.nodes); });
  std::vector<Branch> branches;
  find_branches(
      paths,
      [&](const Tip& tip, const TubePath& other) {
        return place_on_side(tip.position, tip.outward, other.nodes, radius);
      },
      branches);
  find_branches(
      paths,
      [&](const Tip& tip, const TubePath& other) {
        const auto place = place_ahead(tip, other.nodes, radius, 6.0 * radius);
        const bool is_seen_through =
            place && occlusion.empty_part(line_between(tip.position, *place, radius), 1.0) > 0.1;
        return is_seen_through ? std::nullopt : place;
      },
      branches);

  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (const Branch& branch : branches) {
    lead_up(paths[branch.path], branch);
    links.emplace_back(branch.path, branch.other);
  }
  std::vector<TubeModel> tubes;
  const std::vector<std::uint32_t> tube_of_path = connected_components(paths.size(), links);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    if (tube_of_path[p] >= tubes.size()) tubes.resize(tube_of_path[p] + 1);
    tubes[tube_of_path[p]].radius = radius;
    tubes[tube_of_path[p]].paths.push_back(std::move(paths[p]));
  }
  return tubes;
}

std::vector<TubeModel> unbranched(std::vector<TubePath> paths, double radius) {
  std::vector<TubeModel> tubes;
  for (TubePath& path : paths) tubes.push_back({.paths = {std::move(path)}, .radius = radius});
  return tubes;
}

}  // namespace tubebin
