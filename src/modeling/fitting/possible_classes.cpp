#include "modeling/fitting/possible_classes.hpp"

#include <algorithm>
#include <functional>

#include "modeling/fitting/piece_cleaning.hpp"
#include "modeling/fitting/piece_evidence.hpp"

namespace tubebin::modeling {
namespace {

/// So many pieces are joined in a second or two; a pile of a hundred tubes has some five hundred.
constexpr std::size_t kMostPieces = 1500;

void keep_surest(std::vector<TubePiece>& pieces) {
  if (pieces.size() <= kMostPieces) return;
  std::ranges::stable_sort(pieces, std::greater<>(), &TubePiece::evidence);
  pieces.resize(kMostPieces);
}

/// Marks the pieces most of whose points the others explain.
void mark_explained(std::span<const UnsurePiece> unsure, const std::vector<TubePiece>& others, double spacing,
                    std::vector<char>& is_other) {
  std::vector<cloud::Point> points;
  std::vector<std::size_t> piece_of;
  for (std::size_t k = 0; k < unsure.size(); ++k) {
    points.insert(points.end(), unsure[k].points.begin(), unsure[k].points.end());
    piece_of.resize(points.size(), k);
  }
  std::vector<std::size_t> unexplained(unsure.size(), 0);
  for (const std::uint32_t i : unexplained_points(points, others, spacing)) ++unexplained[piece_of[i]];
  for (std::size_t k = 0; k < unsure.size(); ++k)
    if (2 * unexplained[k] < unsure[k].points.size()) is_other[k] = true;
}

}  // namespace

bool is_known(const TubePiece& piece, double off, std::span<const PossibleClass> earlier) {
  return std::ranges::any_of(earlier, [&](const PossibleClass& other) {
    return std::ranges::any_of(other.unsure, [&](const UnsurePiece& unsure) {
      return unsure.off < 2.0 * off + 4.0 * other.typical_off && is_inside(piece, unsure.piece);
    });
  });
}

std::vector<TubeClass> settled(std::span<const PossibleClass> possible, double spacing) {
  std::vector<TubeClass> classes;
  for (const PossibleClass& own : possible) {
    std::vector<char> is_other(own.unsure.size(), false);
    for (const PossibleClass& other : possible)
      if (&other != &own) mark_explained(own.unsure, other.sure.pieces, spacing, is_other);
    classes.push_back(own.sure);
    for (std::size_t k = 0; k < own.unsure.size(); ++k)
      if (!is_other[k]) classes.back().pieces.push_back(own.unsure[k].piece);
    keep_surest(classes.back().pieces);
  }
  return classes;
}

}  // namespace tubebin::modeling
