#include "render/opengl/multisample_target.hpp"

#include <algorithm>

namespace tubebin::render {

MultisampleTarget::MultisampleTarget(const OffscreenContext& context) : context_(context) {
  GLint most_samples = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &most_samples);
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glGenRenderbuffers(2, buffers_);
  const GLenum formats[2] = {GL_RGBA8, GL_DEPTH_COMPONENT24};
  const GLenum attachments[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
  for (int i = 0; i < 2; ++i) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffers_[i]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, std::min(most_samples, 4), formats[i], context.width(),
                                     context.height());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachments[i], GL_RENDERBUFFER, buffers_[i]);
  }
  glViewport(0, 0, context.width(), context.height());
}

MultisampleTarget::~MultisampleTarget() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(2, buffers_);
}

void MultisampleTarget::resolve() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, context_.width(), context_.height(), 0, 0, context_.width(), context_.height(),
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace tubebin::render
