// Labels against the ground truth.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "tubebin/evaluation/metrics.hpp"

namespace tubebin::python {
namespace {

using evaluation::SegmentationScores;
using evaluation::TubeScore;

struct Evaluation {
  evaluation::Matching matching;
  SegmentationScores scores;

  double panoptic_quality() const {
    return evaluation::panoptic_quality(static_cast<int>(scores.tubes.size()), scores.predicted_tubes,
                                        scores.true_positives.front(), scores.true_positive_iou);
  }
};

Evaluation evaluate(const IdArray& truth_array, const IdArray& label_array, bool bin_counts) {
  const std::vector<std::uint32_t> truth = ids_of(truth_array, "truth"), labels = ids_of(label_array, "labels");
  const nb::gil_scoped_release without_lock;
  const evaluation::Contingency contingency = evaluation::count_pairs(truth, labels, 0);
  evaluation::Matching matching = evaluation::match_segments(
      contingency, bin_counts ? evaluation::BinPoints::counted : evaluation::BinPoints::left_out);
  SegmentationScores scores = evaluation::score_tubes(contingency, matching);
  return {std::move(matching), std::move(scores)};
}

void bind_tube_score(nb::module_& module) {
  nb::class_<TubeScore>(module, "TubeScore", "A true tube and the segment that is matched with it.")
      .def_ro("truth", &TubeScore::truth_id, "The tube's label in the ground truth.")
      .def_ro("label", &TubeScore::predicted_id, "The segment's label; None where the tube is unmatched.")
      .def_ro("points", &TubeScore::points, "Of the tube.")
      .def_ro("correct", &TubeScore::correct, "Points of the tube in its segment.")
      .def_ro("split", &TubeScore::split, "Points of the tube in other segments that are mostly this tube.")
      .def_ro("merged", &TubeScore::merged, "Points of the tube in segments that are mostly something else.")
      .def_ro("missed", &TubeScore::missed, "Points of the tube in no segment.")
      .def_prop_ro("recall", &TubeScore::recall, "correct / points.")
      .def_prop_ro("precision", &TubeScore::precision, "correct / points of the segment; 0 where unmatched.")
      .def_prop_ro("iou", &TubeScore::iou, "correct / points of the tube or the segment.");
}

}  // namespace

void bind_evaluation(nb::module_& module) {
  bind_tube_score(module);
  nb::class_<Evaluation>(module, "Evaluation",
                         "How well labels fit the ground truth; docs/metrics.md defines every measure.")
      .def_prop_ro(
          "micro_recall", [](const Evaluation& self) { return self.matching.micro_recall(); },
          "correct / total (the paper's measure).")
      .def_prop_ro(
          "correct", [](const Evaluation& self) { return self.matching.correct; },
          "Points in the segment that is matched with their own.")
      .def_prop_ro(
          "total", [](const Evaluation& self) { return self.matching.total; }, "Points that count.")
      .def_prop_ro(
          "tubes", [](const Evaluation& self) { return self.scores.tubes; },
          "Every true tube that has points, by label.")
      .def_prop_ro(
          "predicted_tubes", [](const Evaluation& self) { return self.scores.predicted_tubes; },
          "Number of segments that the labels name.")
      .def_prop_ro(
          "background", [](const Evaluation& self) { return self.scores.background; },
          "Points of the bin in the tubes' segments.")
      .def_prop_ro("panoptic_quality", &Evaluation::panoptic_quality, "Kirillov et al. 2019, tubes the only class.")
      .def_prop_ro(
          "adjusted_rand_index", [](const Evaluation& self) { return self.scores.adjusted_rand_index; },
          "Hubert & Arabie 1985, over the points of tubes.");
  module.def("evaluate", &evaluate, nb::arg("truth"), nb::arg("labels"), nb::arg("bin_counts"),
             nb::sig("def evaluate(truth: NDArray[numpy.integer], labels: NDArray[numpy.integer], bin_counts: bool) -> "
                     "Evaluation"));
}

}  // namespace tubebin::python
