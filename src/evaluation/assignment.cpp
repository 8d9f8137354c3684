#include "tubebin/evaluation/assignment.hpp"

#include <limits>

namespace tubebin::evaluation {
namespace {

/// Shortest augmenting paths with potentials (Jonker & Volgenant 1987, after Kuhn 1955 and Munkres 1957) over
/// weights with no more rows than columns. Indices count from 1; 0 stands for "none", and column 0 holds the
/// row that is being inserted. Integer weights keep the potentials exact.
class HungarianMethod {
 public:
  explicit HungarianMethod(const Counts& weights)
      : weights_(weights),
        row_potential_(count(weights.rows()) + 1, 0),
        column_potential_(count(weights.cols()) + 1, 0),
        row_of_column_(count(weights.cols()) + 1, 0) {}

  /// The row matched with each column, both from 1.
  const std::vector<int>& solve() {
    for (int row = 1; row <= weights_.rows(); ++row) insert(row);
    return row_of_column_;
  }

 private:
  static std::size_t count(Eigen::Index n) { return static_cast<std::size_t>(n); }

  std::int64_t reduced_cost(int row, std::size_t column) const {
    const std::int64_t cost = -weights_(row - 1, static_cast<Eigen::Index>(column) - 1);
    return cost - row_potential_[count(row)] - column_potential_[column];
  }

  void insert(int row) {
    const std::size_t columns = row_of_column_.size();
    std::vector<std::int64_t> distance(columns, std::numeric_limits<std::int64_t>::max());
    std::vector<std::size_t> previous(columns, 0);
    std::vector<char> visited(columns, 0);
    row_of_column_[0] = row;
    std::size_t column = 0;
    while (row_of_column_[column] != 0) {
      visited[column] = 1;
      const std::size_t nearest = relax_from(column, distance, previous, visited);
      shift_potentials(distance[nearest], distance, visited);
      column = nearest;
    }
    augment(column, previous);
  }

  /// Updates the distances over the row matched with `column`; returns the nearest column not visited yet.
  std::size_t relax_from(std::size_t column, std::vector<std::int64_t>& distance, std::vector<std::size_t>& previous,
                         const std::vector<char>& visited) const {
    std::size_t nearest = 0;
    for (std::size_t next = 1; next < distance.size(); ++next) {
      if (visited[next]) continue;
      const std::int64_t through = reduced_cost(row_of_column_[column], next);
      if (through < distance[next]) {
        distance[next] = through;
        previous[next] = column;
      }
      if (nearest == 0 || distance[next] < distance[nearest]) nearest = next;
    }
    return nearest;
  }

  void shift_potentials(std::int64_t delta, std::vector<std::int64_t>& distance, const std::vector<char>& visited) {
    for (std::size_t column = 0; column < distance.size(); ++column) {
      if (visited[column]) {
        row_potential_[count(row_of_column_[column])] += delta;
        column_potential_[column] -= delta;
      } else {
        distance[column] -= delta;
      }
    }
  }

  void augment(std::size_t column, const std::vector<std::size_t>& previous) {
    while (column != 0) {
      row_of_column_[column] = row_of_column_[previous[column]];
      column = previous[column];
    }
  }

  const Counts& weights_;
  std::vector<std::int64_t> row_potential_;
  std::vector<std::int64_t> column_potential_;
  std::vector<int> row_of_column_;
};

}  // namespace

std::vector<int> max_weight_assignment(const Counts& weights) {
  std::vector<int> column_of_row(static_cast<std::size_t>(weights.rows()), kUnmatched);
  const bool transposed = weights.rows() > weights.cols();
  const Counts wide = transposed ? Counts(weights.transpose()) : weights;
  const std::vector<int> row_of_column = HungarianMethod(wide).solve();
  for (std::size_t column = 1; column < row_of_column.size(); ++column) {
    if (row_of_column[column] == 0) continue;
    int row_index = row_of_column[column] - 1;
    int column_index = static_cast<int>(column) - 1;
    if (transposed) std::swap(row_index, column_index);
    if (weights(row_index, column_index) > 0) column_of_row[static_cast<std::size_t>(row_index)] = column_index;
  }
  return column_of_row;
}

}  // namespace tubebin::evaluation
