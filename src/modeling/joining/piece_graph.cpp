#include "modeling/joining/piece_graph.hpp"

#include "modeling/joining/boxed_curve.hpp"

namespace tubebin::modeling {
namespace {

bool share_an_end(const JoinCandidate& i, const JoinCandidate& j) {
  return i.end_a == j.end_a || i.end_a == j.end_b || i.end_b == j.end_a || i.end_b == j.end_b;
}

/// Two bridges of different tubes cannot occupy one place. Two of one end are no question: only one can be chosen.
std::vector<std::vector<std::uint32_t>> find_collisions(const std::vector<JoinCandidate>& joins, double radius) {
  std::vector<std::vector<std::uint32_t>> collisions(joins.size());
  std::vector<BoxedCurve> bridges;
  for (const JoinCandidate& join : joins) bridges.emplace_back(join.bridge);
  for (std::uint32_t i = 0; i < joins.size(); ++i)
    for (std::uint32_t j = 0; j < i; ++j)
      // Less than a radius apart is no matter of the bridges' uncertain course.
      if (!share_an_end(joins[i], joins[j]) && bridges[i].comes_nearer(bridges[j], radius)) {
        collisions[i].push_back(j);
        collisions[j].push_back(i);
      }
  return collisions;
}

}  // namespace

PieceGraph::PieceGraph(std::span<const TubePiece> pieces, std::span<const PieceEnd> ends,
                       std::vector<JoinCandidate> joins)
    : pieces(pieces),
      ends(ends),
      joins(std::move(joins)),
      joins_of_end(ends.size()),
      collisions(find_collisions(this->joins, pieces.front().radius)) {
  for (const TubePiece& piece : pieces) piece_lengths.push_back(piece.length());
  for (std::uint32_t j = 0; j < this->joins.size(); ++j) {
    bridge_lengths.push_back(polyline_length(this->joins[j].bridge));
    for (const std::uint32_t end : {this->joins[j].end_a, this->joins[j].end_b}) joins_of_end[end].push_back(j);
  }
}

}  // namespace tubebin::modeling
