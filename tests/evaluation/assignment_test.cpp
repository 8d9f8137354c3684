#include "tubebin/evaluation/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>

#include "support/commands.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::evaluation {
namespace {

/// Weights as between segments: most pairs share no point.
Counts random_weights(int rows, int columns, int high, Random& random) {
  Counts weights(rows, columns);
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    weights.data()[i] = random.integer(0, 1) == 0 ? 0 : random.integer(0, high);
  return weights;
}

/// The total of a matching, after checking that it is one.
std::int64_t total(const Counts& weights, const std::vector<int>& column_of_row) {
  EXPECT_EQ(column_of_row.size(), static_cast<std::size_t>(weights.rows()));
  std::set<int> used;
  std::int64_t sum = 0;
  for (std::size_t row = 0; row < column_of_row.size(); ++row) {
    const int column = column_of_row[row];
    if (column == kUnmatched) continue;
    EXPECT_LT(column, weights.cols());
    EXPECT_TRUE(used.insert(column).second) << "column " << column << " is taken twice";
    sum += weights(static_cast<Eigen::Index>(row), column);
  }
  return sum;
}

/// The best total over all ways to give each row a column of its own or none.
std::int64_t best_by_brute_force(const Counts& weights) {
  const Counts wide = weights.rows() > weights.cols() ? Counts(weights.transpose()) : weights;
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(wide.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  std::int64_t best = 0;
  do {
    std::int64_t sum = 0;
    for (Eigen::Index row = 0; row < wide.rows(); ++row) sum += wide(row, columns[static_cast<std::size_t>(row)]);
    best = std::max(best, sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  return best;
}

TEST(Assignment, PaperExample) {
  Counts weights(2, 3);
  weights << 26, 2, 11, 2, 24, 7;
  EXPECT_EQ(max_weight_assignment(weights), (std::vector<int>{0, 1}));
}

TEST(Assignment, EqualsBruteForceOnSmallCases) {
  Random random(5);
  for (int round = 0; round < 600; ++round) {
    const Counts weights = random_weights(random.integer(1, 6), random.integer(1, 6), random.integer(1, 20), random);
    EXPECT_EQ(total(weights, max_weight_assignment(weights)), best_by_brute_force(weights)) << weights;
  }
}

TEST(Assignment, GreedyWouldFail) {
  Counts weights(2, 2);
  weights << 10, 9, 9, 0;
  EXPECT_EQ(max_weight_assignment(weights), (std::vector<int>{1, 0}));
}

TEST(Assignment, PairsWithoutPointsStayUnmatched) {
  Counts weights(3, 3);
  weights << 5, 0, 0, 0, 0, 0, 0, 0, 2;
  EXPECT_EQ(max_weight_assignment(weights), (std::vector<int>{0, kUnmatched, 2}));
}

TEST(Assignment, NoRowsOrNoColumns) {
  EXPECT_TRUE(max_weight_assignment(Counts(0, 4)).empty());
  EXPECT_EQ(max_weight_assignment(Counts(2, 0)), (std::vector<int>{kUnmatched, kUnmatched}));
}

TEST(Assignment, TransposedWeightsGiveTheSameTotal) {
  Random random(6);
  for (int round = 0; round < 50; ++round) {
    const Counts weights = random_weights(30, 45, 5000, random);
    EXPECT_EQ(total(weights, max_weight_assignment(weights)),
              total(weights.transpose(), max_weight_assignment(weights.transpose())));
  }
}

TEST(Assignment, EqualsScipyOnCommittedCases) {
  std::ifstream file(TUBEBIN_SOURCE_DIR "/tests/evaluation/fixtures/assignments.txt");
  Eigen::Index rows = 0;
  Eigen::Index columns = 0;
  std::int64_t best = 0;
  int cases = 0;
  while (file >> rows >> columns >> best) {
    Counts weights(rows, columns);
    for (Eigen::Index row = 0; row < rows; ++row)
      for (Eigen::Index column = 0; column < columns; ++column) file >> weights(row, column);
    EXPECT_EQ(total(weights, max_weight_assignment(weights)), best);
    ++cases;
  }
  EXPECT_EQ(cases, 9);
}

TEST(Assignment, EqualsScipyOnRandomCases) {
  const auto python = testing::find_python("numpy, scipy");
  if (!python) GTEST_SKIP() << "no python3 with numpy and scipy here";
  Random random(2022);
  const std::string path = ::testing::TempDir() + "/assignment_cases.txt";
  std::vector<std::int64_t> totals;
  {
    std::ofstream file(path);
    for (int round = 0; round < 60; ++round) {
      const Counts weights = random_weights(random.integer(1, 50), random.integer(1, 50), 100000, random);
      totals.push_back(total(weights, max_weight_assignment(weights)));
      file << weights.format(Eigen::IOFormat(Eigen::StreamPrecision, Eigen::DontAlignCols, " ", ";")) << "\n";
    }
  }
  const auto scipy = testing::run_command(*python +
                                          " -c 'import numpy as np; from scipy.optimize import "
                                          "linear_sum_assignment as lsa\nfor line in open(\"" +
                                          path +
                                          "\"):\n w = np.array([r.split() for r in line.split(\";\")], "
                                          "dtype=np.int64)\n print(w[lsa(w, maximize=True)].sum())'");
  ASSERT_EQ(scipy.exit_code, 0);
  std::istringstream output(scipy.output);
  for (const std::int64_t expected : totals) {
    std::int64_t best = -1;
    output >> best;
    EXPECT_EQ(expected, best) << "the cases are in " << path;
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tubebin::evaluation
