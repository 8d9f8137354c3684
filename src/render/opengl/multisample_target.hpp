// A picture with several samples a pixel, averaged when it is resolved.
#pragma once

#include "render/opengl/offscreen_context.hpp"

namespace tubebin::render {

class MultisampleTarget {
 public:
  /// From here on drawing goes into this target. `context` must live on.
  explicit MultisampleTarget(const OffscreenContext& context);
  ~MultisampleTarget();
  MultisampleTarget(const MultisampleTarget&) = delete;
  MultisampleTarget& operator=(const MultisampleTarget&) = delete;

  /// Averages the samples into the context's own image.
  void resolve() const;

 private:
  const OffscreenContext& context_;
  GLuint framebuffer_ = 0;
  GLuint buffers_[2] = {0, 0};  ///< colour, depth
};

}  // namespace tubebin::render
