/// 4_score_labels: how well the labels of labeled.pcd match the ground truth in filtered.pcd (micro-recall).
#include <iostream>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/cloud_pair.hpp"
#include "tubebin/evaluation/micro_recall.hpp"

int main() try {
  using namespace tubebin;
  const cloud::Cloud truth = cloud::read_cloud("filtered.pcd");
  const cloud::Cloud predicted = cloud::read_cloud("labeled.pcd");

  const evaluation::PairedIds pairs = evaluation::pair_clouds({truth, "filtered.pcd"}, {predicted, "labeled.pcd"});
  const evaluation::Contingency contingency = evaluation::count_pairs(pairs.truth, pairs.predicted, pairs.bin_id);
  const evaluation::Matching matching = evaluation::match_segments(contingency);
  for (std::size_t row = 0; row < contingency.truth_ids.size(); ++row)
    std::cout << "ground truth " << contingency.truth_ids[row] << ": " << contingency.truth_size(row) << " points\n";
  std::cout << "micro-recall " << matching.micro_recall() << " = " << matching.correct << " / " << matching.total
            << " points\n";
} catch (const tubebin::IoError& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
