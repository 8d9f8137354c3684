/// Independent work on several threads.
#pragma once

#include "tubebin/evaluation/evaluation.hpp"

namespace tubebin::evaluation {

/// Calls work(0) to work(count - 1), each once, on up to `jobs` threads. The first exception (of the lowest
/// index that was reached) is thrown on when all threads are done; no new work starts after it.
void parallel_for(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                  const OnProgress& on_progress = {});

}  // namespace tubebin::evaluation
