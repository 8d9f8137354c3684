/// Work on all cores, as many as tbb::global_control allows.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <type_traits>
#include <vector>

namespace tubebin::modeling {

/// What work(0) to work(count - 1) return.
template <typename Work>
auto map_in_parallel(std::size_t count, const Work& work) {
  std::vector<std::invoke_result_t<Work, std::size_t>> results(count);
  tbb::parallel_for(
      std::size_t{0}, count, [&](std::size_t k) { results[k] = work(k); }, tbb::simple_partitioner());
  return results;
}

/// The same of vectors, one after the other.
template <typename Work>
auto gather_in_parallel(std::size_t count, const Work& work) {
  std::invoke_result_t<Work, std::size_t> all;
  for (auto& part : map_in_parallel(count, work)) std::ranges::move(part, std::back_inserter(all));
  return all;
}

/// Calls work(first, last) for ranges of numbers that together are all below `count`.
template <typename Work>
void for_ranges_in_parallel(std::size_t count, const Work& work) {
  constexpr std::size_t kLeast = 4096;  // points, that take longer than handing them out
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kLeast),
                    [&](const auto& range) { work(range.begin(), range.end()); });
}

}  // namespace tubebin::modeling
