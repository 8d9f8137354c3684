#include <fmt/format.h>

#include "evaluation/statistics.hpp"
#include "tubebin/evaluation/paper_comparison.hpp"

namespace tubebin::evaluation {
namespace {

const std::vector<double>* find(const GenerationSeconds& seconds, const std::string& set, int tubes) {
  const auto of_set = seconds.find(set);
  if (of_set == seconds.end() || !of_set->second.contains(tubes)) return nullptr;
  return &of_set->second.at(tubes);
}

Claim rises_with_tubes(const GenerationSeconds& seconds) {
  Claim claim{"The time to generate a cloud increases with the number of tubes",
              "A: 3.13 to 28.10 s, B: 2.68 to 25.02 s",
              "",
              {}};
  bool holds = true;
  for (const auto& [set, by_tubes] : seconds) {
    if (by_tubes.size() < 3) continue;
    std::vector<double> x;
    std::vector<double> y;
    for (const auto& [tubes, values] : by_tubes) {
      x.push_back(tubes);
      y.push_back(mean(values));
    }
    const double correlation = rank_correlation(x, y);
    holds = holds && correlation >= kMonotone;
    claim.here += fmt::format("{}{}: {:.3f} to {:.3f} s (rank correlation {:.2f})", claim.here.empty() ? "" : "; ", set,
                              y.front(), y.back(), correlation);
  }
  if (!claim.here.empty()) claim.verdict = holds ? Verdict::confirmed : Verdict::not_confirmed;
  return claim;
}

Claim b_takes_less(const GenerationSeconds& seconds) {
  Claim claim{"On average set B takes slightly less time to generate than set A",
              "-4.8 % (sums of the columns of Table 1)",
              "",
              {}};
  std::vector<std::vector<double>> groups;
  if (const auto a = seconds.find("A"); a != seconds.end())
    for (const auto& [tubes, values] : a->second)
      if (const auto* b = find(seconds, "B", tubes)) {
        groups.push_back(values);
        groups.push_back(*b);
      }
  if (groups.empty()) return claim;
  const Interval change = bootstrap_of_means(
      groups,
      [](std::span<const double> means) {
        double a = 0.0;
        double b = 0.0;
        for (std::size_t i = 0; i < means.size(); i += 2) {
          a += means[i];
          b += means[i + 1];
        }
        return b / a - 1.0;
      },
      kBootstrapSeed);
  claim.here =
      fmt::format("{:+.1f} % [{:+.1f}, {:+.1f}]", 100.0 * change.mean, 100.0 * change.low, 100.0 * change.high);
  claim.verdict = change.high < 0.0 ? Verdict::confirmed : Verdict::not_confirmed;
  return claim;
}

Claim ten_tubes_within_15_seconds(const GenerationSeconds& seconds) {
  Claim claim{
      "A bin with ten tubes takes less than 15 s, so that an hour gives 240 clouds", "A: 14.20 s, B: 13.73 s", "", {}};
  bool holds = true;
  for (const auto& [set, by_tubes] : seconds) {
    const auto* values = find(seconds, set, 10);
    if (values == nullptr) continue;
    const double average = mean(*values);
    holds = holds && average < 15.0;
    claim.here += fmt::format("{}{}: {:.3f} s, {:.0f} clouds an hour", claim.here.empty() ? "" : "; ", set, average,
                              3600.0 / average);
  }
  if (!claim.here.empty()) claim.verdict = holds ? Verdict::confirmed : Verdict::not_confirmed;
  return claim;
}

}  // namespace

std::vector<Claim> generation_claims(const GenerationSeconds& seconds) {
  return {rises_with_tubes(seconds), b_takes_less(seconds), ten_tubes_within_15_seconds(seconds)};
}

}  // namespace tubebin::evaluation
