#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evaluation/statistics.hpp"
#include "tubebin/evaluation/paper_comparison.hpp"
#include "tubebin/evaluation/paper_figures.hpp"

namespace tubebin::evaluation {
namespace {

constexpr double kFigure8Ratio = 0.3;
constexpr int kFigure9Tubes = 10;
/// Linear means that a line explains so much of the variance of the means.
constexpr double kLinear = 0.8;
/// Flat means at most this share of the whole rise.
constexpr double kFlat = 0.1;

Verdict verdict(bool holds) { return holds ? Verdict::confirmed : Verdict::not_confirmed; }

/// Values by scene, in the order of the scenes.
using ByScene = std::map<std::string, double>;
/// One method's values by set, ratio and number of tubes.
class Values {
 public:
  void add(const RunKey& key, double value) { values_[key.set][key.ratio][key.tubes][key.scene] = value; }

  bool has(const std::string& set, double ratio, int tubes) const { return find(set, ratio, tubes) != nullptr; }
  std::vector<double> at(const std::string& set, double ratio, int tubes) const {
    std::vector<double> list;
    if (const ByScene* scenes = find(set, ratio, tubes))
      for (const auto& [scene, value] : *scenes) list.push_back(value);
    return list;
  }
  double mean_at(const std::string& set, double ratio, int tubes) const { return mean(at(set, ratio, tubes)); }
  /// Value at `high` minus value at `low` of each scene that has both.
  std::vector<double> rises(const std::string& set, int tubes, double low, double high) const {
    std::vector<double> list;
    const ByScene* from = find(set, low, tubes);
    const ByScene* to = find(set, high, tubes);
    if (from == nullptr || to == nullptr) return list;
    for (const auto& [scene, value] : *from)
      if (const auto other = to->find(scene); other != to->end()) list.push_back(other->second - value);
    return list;
  }
  std::vector<int> tubes(const std::string& set, double ratio) const {
    std::vector<int> list;
    const auto of_set = values_.find(set);
    if (of_set == values_.end() || !of_set->second.contains(ratio)) return list;
    for (const auto& [count, scenes] : of_set->second.at(ratio)) list.push_back(count);
    return list;
  }
  std::vector<double> ratios(const std::string& set, int tubes) const {
    std::vector<double> list;
    if (const auto of_set = values_.find(set); of_set != values_.end())
      for (const auto& [ratio, counts] : of_set->second)
        if (counts.contains(tubes)) list.push_back(ratio);
    return list;
  }

 private:
  const ByScene* find(const std::string& set, double ratio, int tubes) const {
    const auto of_set = values_.find(set);
    if (of_set == values_.end()) return nullptr;
    const auto of_ratio = of_set->second.find(ratio);
    if (of_ratio == of_set->second.end()) return nullptr;
    const auto of_tubes = of_ratio->second.find(tubes);
    return of_tubes == of_ratio->second.end() ? nullptr : &of_tubes->second;
  }

  std::map<std::string, std::map<double, std::map<int, ByScene>>> values_;
};

std::string signed_interval(const Interval& i, int decimals) {
  return fmt::format("{:+.{}f} [{:+.{}f}, {:+.{}f}]", i.mean, decimals, i.low, decimals, i.high, decimals);
}
std::string percent_interval(const Interval& i) {
  return fmt::format("{:+.1f} % [{:+.1f}, {:+.1f}]", 100.0 * i.mean, 100.0 * i.low, 100.0 * i.high);
}

void add_text(std::string& text, const std::string& more) { text += (text.empty() ? "" : "; ") + more; }

/// Relative change of the mean from the first number of tubes to the second.
Interval relative_change(const Values& values, const std::string& set, double ratio, int from, int to) {
  return bootstrap_of_means(
      {values.at(set, ratio, from), values.at(set, ratio, to)},
      [](std::span<const double> means) { return means[1] / means[0] - 1.0; }, kBootstrapSeed);
}

Claim falls_linearly(const Values& recall) {
  Claim claim{
      "Micro-recall falls linearly as the number of tubes increases (ratio 0.3)", "Figure 8, both sets", "", {}};
  bool holds = true;
  bool measured = false;
  for (const std::string set : {"A", "B"}) {
    std::vector<double> x;
    std::vector<std::vector<double>> groups;
    std::vector<double> means;
    for (const int tubes : recall.tubes(set, kFigure8Ratio)) {
      if (set == "B" && tubes == 1) continue;  // the paper names it as an exception, which the third claim tests
      x.push_back(tubes);
      groups.push_back(recall.at(set, kFigure8Ratio, tubes));
      means.push_back(mean(groups.back()));
    }
    if (x.size() < 3) continue;
    measured = true;
    const Interval slope = bootstrap_of_means(
        groups, [&](std::span<const double> m) { return fit_line(x, m).slope; }, kBootstrapSeed);
    const double r_squared = fit_line(x, means).r_squared;
    holds = holds && slope.high < 0.0 && r_squared >= kLinear;
    add_text(claim.here, fmt::format("{}: {} a tube, R² {:.2f}", set, signed_interval(slope, 5), r_squared));
  }
  if (measured) claim.verdict = verdict(holds);
  return claim;
}

Claim a_above_b(const Values& recall) {
  Claim claim{"Set A is consistently above set B (ratio 0.3)", "Figure 8, every number of tubes", "", {}};
  std::vector<std::vector<double>> groups;
  int above = 0;
  double worst = std::numeric_limits<double>::max();
  int worst_tubes = 0;
  for (const int tubes : recall.tubes("A", kFigure8Ratio)) {
    if (!recall.has("B", kFigure8Ratio, tubes)) continue;
    groups.push_back(recall.at("A", kFigure8Ratio, tubes));
    groups.push_back(recall.at("B", kFigure8Ratio, tubes));
    const double difference = mean(groups[groups.size() - 2]) - mean(groups.back());
    above += difference > 0.0;
    if (difference < worst) {
      worst = difference;
      worst_tubes = tubes;
    }
  }
  if (groups.empty()) return claim;
  const Interval difference = bootstrap_of_means(
      groups,
      [](std::span<const double> means) {
        double sum = 0.0;
        for (std::size_t i = 0; i < means.size(); i += 2) sum += means[i] - means[i + 1];
        return 2.0 * sum / static_cast<double>(means.size());
      },
      kBootstrapSeed);
  const std::size_t counts = groups.size() / 2;
  claim.here = fmt::format("A above B at {} of {} numbers of tubes; A - B on average {}; least with {}: {:+.4f}", above,
                           counts, signed_interval(difference, 4), count_of_tubes(worst_tubes), worst);
  claim.verdict = verdict(above == static_cast<int>(counts));
  return claim;
}

Claim one_tube_below_two(const Values& recall) {
  Claim claim{"On set B one tube scores lower than two (ratio 0.3)", "0.867 to 0.901: +3.9 %", "", {}};
  if (!recall.has("B", kFigure8Ratio, 1) || !recall.has("B", kFigure8Ratio, 2)) return claim;
  const Interval change = relative_change(recall, "B", kFigure8Ratio, 1, 2);
  claim.here = fmt::format("{:.4f} to {:.4f}: {}", recall.mean_at("B", kFigure8Ratio, 1),
                           recall.mean_at("B", kFigure8Ratio, 2), percent_interval(change));
  claim.verdict = verdict(change.low > 0.0);
  return claim;
}

Claim ten_tubes_lowest(const Values& recall) {
  Claim claim{"On set B micro-recall falls from one to ten tubes, to the lowest value of 1 to 10 (ratio 0.3)",
              "0.867 to 0.831: -4.1 %",
              "",
              {}};
  if (!recall.has("B", kFigure8Ratio, 1) || !recall.has("B", kFigure8Ratio, 10)) return claim;
  const Interval change = relative_change(recall, "B", kFigure8Ratio, 1, 10);
  int lowest = 1;
  for (int tubes = 1; tubes <= 10; ++tubes)
    if (recall.has("B", kFigure8Ratio, tubes) &&
        recall.mean_at("B", kFigure8Ratio, tubes) < recall.mean_at("B", kFigure8Ratio, lowest))
      lowest = tubes;
  claim.here = fmt::format("{:.4f} to {:.4f}: {}; lowest with {}", recall.mean_at("B", kFigure8Ratio, 1),
                           recall.mean_at("B", kFigure8Ratio, 10), percent_interval(change), count_of_tubes(lowest));
  claim.verdict = verdict(change.high < 0.0 && lowest == 10);
  return claim;
}

Claim rises_with_ratio(const Values& recall) {
  Claim claim{
      "Micro-recall rises with the downsampling ratio, most at low ratios (10 tubes)", "Figure 9, both sets", "", {}};
  bool holds = true;
  bool measured = false;
  for (const std::string set : {"A", "B"}) {
    const std::vector<double> low = recall.rises(set, kFigure9Tubes, 0.1, 0.3);
    const std::vector<double> all = recall.rises(set, kFigure9Tubes, 0.1, 1.0);
    if (low.empty() || all.empty()) continue;
    measured = true;
    const Interval rise = bootstrap_mean(all, kBootstrapSeed);
    const double steep = mean(low) / 2.0;  // for each tenth of ratio
    const double rest = (mean(all) - mean(low)) / 7.0;
    holds = holds && rise.low > 0.0 && steep > rest;
    add_text(claim.here, fmt::format("{}: {} from 0.1 to 1; each tenth adds {:+.5f} up to 0.3, {:+.5f} beyond", set,
                                     signed_interval(rise, 4), steep, rest));
  }
  if (measured) claim.verdict = verdict(holds);
  return claim;
}

Claim flat_above(const Values& recall, const std::string& set, double ratio) {
  Claim claim{
      fmt::format("Above a ratio of {} micro-recall on set {} does not rise significantly (10 tubes)", ratio, set),
      "Figure 9",
      "",
      {}};
  const std::vector<double> beyond = recall.rises(set, kFigure9Tubes, ratio, 1.0);
  const std::vector<double> all = recall.rises(set, kFigure9Tubes, 0.1, 1.0);
  if (beyond.empty() || all.empty()) return claim;
  const Interval rise = bootstrap_mean(beyond, kBootstrapSeed);
  claim.here = fmt::format("{} from {} to 1, of {:+.4f} from 0.1 to 1", signed_interval(rise, 5), ratio, mean(all));
  claim.verdict = verdict(rise.low <= 0.0 || rise.mean <= kFlat * mean(all));
  return claim;
}

Claim time_rises_with_ratio(const Values& seconds, const std::string& set) {
  Claim claim{fmt::format("Modelling time rises with the downsampling ratio (set {})", set),
              set == "A" ? "1 tube: x1.7, 10 tubes: x3.4, 20 tubes: x4.7 from 0.1 to 1" : "similar to set A",
              "",
              {}};
  bool holds = true;
  bool measured = false;
  for (const int tubes : {1, 5, 10, 15, 20}) {
    const std::vector<double> ratios = seconds.ratios(set, tubes);
    if (ratios.size() < 3) continue;
    measured = true;
    std::vector<double> means;
    for (const double ratio : ratios) means.push_back(seconds.mean_at(set, ratio, tubes));
    const double correlation = rank_correlation(ratios, means);
    holds = holds && correlation >= kMonotone;
    add_text(claim.here, fmt::format("{}: x{:.1f} (rank correlation {:.2f})", count_of_tubes(tubes),
                                     means.back() / means.front(), correlation));
  }
  if (measured) claim.verdict = verdict(holds);
  return claim;
}

Claim time_rises_with_tubes(const Values& seconds, const std::string& set) {
  Claim claim{fmt::format("Modelling time rises with the number of tubes (set {}, ratio 0.1)", set),
              set == "A" ? "+68.4 % from 1 to 5 tubes, +50.0 % from 5 to 10" : "similar to set A",
              "",
              {}};
  const double ratio = 0.1;
  const std::vector<int> tubes = seconds.tubes(set, ratio);
  if (tubes.size() < 3) return claim;
  std::vector<double> x(tubes.begin(), tubes.end());
  std::vector<double> means;
  for (const int count : tubes) means.push_back(seconds.mean_at(set, ratio, count));
  for (const auto& [from, to] : {std::pair{1, 5}, {5, 10}, {10, 20}})
    if (seconds.has(set, ratio, from) && seconds.has(set, ratio, to))
      add_text(claim.here, fmt::format("{} to {} tubes: {}", from, to,
                                       percent_interval(relative_change(seconds, set, ratio, from, to))));
  const double correlation = rank_correlation(x, means);
  add_text(claim.here, fmt::format("rank correlation {:.2f}", correlation));
  claim.verdict = verdict(correlation >= kMonotone);
  return claim;
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::confirmed:
      return "confirmed";
    case Verdict::not_confirmed:
      return "not confirmed";
    case Verdict::not_measured:
      return "not measured";
  }
  return "";
}

std::vector<Claim> modelling_claims(const std::vector<RunScore>& runs, const std::string& method) {
  Values recall;
  Values seconds;
  for (const RunScore& run : runs) {
    if (run.key.method != method) continue;
    recall.add(run.key, run.micro_recall);
    if (run.seconds) seconds.add(run.key, *run.seconds);
  }
  return {falls_linearly(recall),
          a_above_b(recall),
          one_tube_below_two(recall),
          ten_tubes_lowest(recall),
          rises_with_ratio(recall),
          flat_above(recall, "A", 0.6),
          flat_above(recall, "B", 0.7),
          time_rises_with_ratio(seconds, "A"),
          time_rises_with_ratio(seconds, "B"),
          time_rises_with_tubes(seconds, "A"),
          time_rises_with_tubes(seconds, "B")};
}

}  // namespace tubebin::evaluation
