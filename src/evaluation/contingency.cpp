#include "tubebin/evaluation/contingency.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "tubebin/core/error.hpp"

namespace tubebin::evaluation {
namespace {

/// Beyond this many pairs of segments (128 MB of counts) a cloud's colours are a photograph's, not labels.
constexpr std::size_t kMaxPairs = std::size_t{1} << 24;

/// The different ids in ascending order, and each point's index among them.
struct Indexed {
  std::vector<SegmentId> ids;
  std::vector<std::uint32_t> index_of_point;
};

Indexed index_ids(std::span<const SegmentId> ids) {
  std::unordered_map<SegmentId, std::uint32_t> index_of_id;
  Indexed indexed;
  indexed.index_of_point.reserve(ids.size());
  // Neighbouring points mostly share their segment, so the last id saves most look-ups.
  SegmentId last_id = 0;
  std::uint32_t last_index = 0;
  for (const SegmentId id : ids) {
    if (indexed.ids.empty() || id != last_id) {
      const auto [entry, is_new] = index_of_id.try_emplace(id, static_cast<std::uint32_t>(indexed.ids.size()));
      if (is_new) indexed.ids.push_back(id);
      last_id = id;
      last_index = entry->second;
    }
    indexed.index_of_point.push_back(last_index);
  }
  std::vector<SegmentId> sorted = indexed.ids;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> rank(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) rank[index_of_id.at(sorted[i])] = static_cast<std::uint32_t>(i);
  for (std::uint32_t& index : indexed.index_of_point) index = rank[index];
  indexed.ids = std::move(sorted);
  return indexed;
}

}  // namespace

std::int64_t Contingency::total() const { return std::accumulate(unlabeled.begin(), unlabeled.end(), counts.sum()); }

void require_segments(std::size_t truth_count, std::size_t predicted_count, const std::string& name) {
  if (truth_count * predicted_count > kMaxPairs)
    throw_io_error("{}{}{} different ground-truth colours or labels and {} predicted ones: these are no segments", name,
                   name.empty() ? "" : ": ", truth_count, predicted_count);
}

Contingency count_pairs(std::span<const SegmentId> truth, std::span<const SegmentId> predicted,
                        std::optional<SegmentId> bin_id) {
  const Indexed rows = index_ids(truth);
  const Indexed columns = index_ids(predicted);
  require_segments(rows.ids.size(), columns.ids.size());
  Counts counts =
      Counts::Zero(static_cast<Eigen::Index>(rows.ids.size()), static_cast<Eigen::Index>(columns.ids.size()));
  for (std::size_t i = 0; i < truth.size(); ++i) ++counts(rows.index_of_point[i], columns.index_of_point[i]);

  Contingency contingency;
  contingency.truth_ids = rows.ids;
  contingency.predicted_ids = columns.ids;
  contingency.unlabeled.assign(rows.ids.size(), 0);
  contingency.bin_id = bin_id;
  // Ids are in ascending order, so the null id, if any, is the first column.
  if (!columns.ids.empty() && columns.ids.front() == kNullId) {
    for (std::size_t row = 0; row < rows.ids.size(); ++row)
      contingency.unlabeled[row] = counts(static_cast<Eigen::Index>(row), 0);
    contingency.predicted_ids.erase(contingency.predicted_ids.begin());
    counts = counts.rightCols(counts.cols() - 1).eval();
  }
  contingency.counts = std::move(counts);
  return contingency;
}

}  // namespace tubebin::evaluation
