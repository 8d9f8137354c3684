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
  OffscreenContext(int width, int height);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /// What has been drawn.
  Image read() const;

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> rgba_;  ///< from the top
  void* context_;                   ///< an OSMesaContext
};

}  // namespace tubebin::render
