/// Sets of trees that explain a scan: a tree is a tube that branches, paths that links (branch_links.hpp) hold together.
#pragma once

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <vector>

#include "modeling/joining/branch_links.hpp"
#include "modeling/joining/path_cover.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A tube under construction.
struct Tree {
  PathNumbers paths = {};
  PathNumbers links = {};
  PathNumbers used_ends = {};
  std::uint64_t key = 0;  ///< the paths' keys, xor: the same for the same paths in any order (Zobrist 1970)
  double link_cost = 0.0;
  double cost = 0.0;                      ///< with what its length says
  double length = 0.0;                    ///< of paths and links, metres
  std::optional<double> whole_odds = {};  ///< as TubeModel has them
  std::vector<double> link_odds = {};     ///< of the links, as TubePath::bridge_odds

  bool holds(std::uint32_t path) const { return std::find(paths.begin(), paths.end(), path) != paths.end(); }
  bool uses(std::uint32_t end) const { return std::find(used_ends.begin(), used_ends.end(), end) != used_ends.end(); }
};

/// Trees that together hold each path once, chosen from the possible ones.
struct Forest {
  std::vector<Tree> possible;
  std::vector<PathCandidate> candidates;  ///< the possible trees as sets of paths
  PathCover cover;
};

/// How far a forest is searched for.
struct ForestSearch {
  std::size_t trees_per_path, cover_nodes;
};

class TreeJoiner {
 public:
  /// Of paths whose ends are 2 path and 2 path + 1; `links` are sorted, the cheapest first.
  TreeJoiner(const std::vector<TubePiece>& paths, std::vector<PieceEnd> ends, std::vector<BranchLink> links,
             double radius);

  /// Every link that is cheaper than the limit, cheapest first, unless its paths hang together already: a spanning forest
  /// of least cost (Kruskal 1956).
  std::vector<Tree> likely_trees(double cost_limit) const;

  /// Of the lengths of trees that fairly sure links make, that which explains the scan best as the length of all trees,
  /// metres; 0 where trees of any length explain it better.
  double common_length();

  /// The trees of this length, metres, that explain the scan best, with their odds.
  std::vector<Tree> trees_of_length(double tube_length);

  /// The tree as a tube of these paths.
  TubeModel tube_of(const Tree& tree, const std::vector<TubePath>& paths) const;

 private:
  struct Growth;

  std::vector<double> possible_lengths() const;
  double cost_of_length(const Forest& forest, double tube_length) const;
  Forest cheapest_forest(double tube_length, const ForestSearch& search);
  void add_link(Tree& tree, std::uint32_t l) const;
  double length_sigma(double scatter, std::size_t paths) const;
  double lack_in_sigmas(double missing, std::size_t paths) const;
  double length_cost(const Tree& tree) const;
  void grow(const Tree& single, std::size_t trees_per_path);
  Tree grown_tree(Tree tree, const Growth& growth) const;
  bool may_grow(const Tree& tree, std::uint32_t l, std::uint32_t next) const;
  bool keep_if_cheapest(const Tree& tree);

  double radius_;
  double tube_length_ = 0.0;  ///< of the forest that is searched for, metres
  std::vector<PieceEnd> ends_;
  std::vector<BranchLink> links_;
  std::vector<std::vector<std::uint32_t>> links_of_path_;
  std::vector<std::uint64_t> keys_;
  std::vector<Tree> singles_;  ///< each path alone
  std::vector<Tree> trees_;
  std::unordered_map<std::uint64_t, std::size_t> tree_of_key_;
};

}  // namespace tubebin::modeling
