// A compiled pair of shaders, in use once it is made. It ends with its context.
#pragma once

#include "render/opengl/offscreen_context.hpp"

namespace tubebin::render {

class ShaderProgram {
 public:
  /// Throws std::runtime_error with the compiler's message where a source is not accepted.
  ShaderProgram(const char* vertex_source, const char* fragment_source);

  void set(const char* uniform, int value) const { glUniform1i(place(uniform), value); }
  void set(const char* uniform, float value) const { glUniform1f(place(uniform), value); }
  void set(const char* uniform, const Eigen::Vector3f& value) const { glUniform3fv(place(uniform), 1, value.data()); }
  void set(const char* uniform, const Eigen::Matrix4f& value) const {
    glUniformMatrix4fv(place(uniform), 1, GL_FALSE, value.data());
  }

 private:
  GLint place(const char* uniform) const { return glGetUniformLocation(program_, uniform); }

  GLuint program_;
};

}  // namespace tubebin::render
