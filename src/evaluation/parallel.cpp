#include "evaluation/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tubebin::evaluation {

void parallel_for(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                  const OnProgress& on_progress) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> stopped = false;
  std::mutex mutex;  // of what follows
  std::size_t done = 0;
  std::exception_ptr error;
  std::size_t error_index = count;
  const auto run = [&] {
    for (std::size_t i = next++; i < count && !stopped; i = next++) {
      try {
        work(i);
        if (!on_progress) continue;
        const std::lock_guard lock(mutex);
        on_progress(++done, count);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (i < error_index) {
          error_index = i;
          error = std::current_exception();
        }
        stopped = true;
      }
    }
  };
  const std::size_t threads = std::min(count, static_cast<std::size_t>(std::max(1, jobs)));
  {
    std::vector<std::jthread> pool;
    for (std::size_t i = 1; i < threads; ++i) pool.emplace_back(run);
    run();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace tubebin::evaluation
