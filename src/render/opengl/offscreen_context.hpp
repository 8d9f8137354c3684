// An OpenGL context that draws into memory.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/opengl/functions.hpp"
#include "tubebin/render/preview.hpp"

namespace tubebin::render {

/// The current context of this thread from construction on; one lives at a time. Throws std::runtime_error
/// where there can be none of that size. Needs load_opengl().
class OffscreenContext {
 public:
  /// Each pixel is the mean of `samples` by `samples`.
  OffscreenContext(int width, int height, int samples = 1);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// What has been drawn.
  Image read() const;
  /// Depths in [0, 1] of all samples, row by row from the bottom.
  std::vector<float> read_depths() const;

 private:
  std::uint8_t mean(int column, int row, std::size_t channel) const;

  int width_;
  int height_;
  int samples_;
  std::vector<std::uint8_t> rgba_;  ///< of all samples, from the top
  void* context_;                   ///< an OSMesaContext
};

}  // namespace tubebin::render
