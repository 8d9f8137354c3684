#include "render/opengl/shader_program.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace tubebin::render {
namespace {

GLuint compile(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::array<char, 2000> message{};
  glGetShaderInfoLog(shader, message.size(), nullptr, message.data());
  glDeleteShader(shader);
  throw std::runtime_error(std::string("OpenGL refuses a shader of the preview: ") + message.data());
}

}  // namespace

ShaderProgram::ShaderProgram(const char* vertex_source, const char* fragment_source) : program_(glCreateProgram()) {
  for (const auto& [kind, source] :
       {std::pair{GL_VERTEX_SHADER, vertex_source}, std::pair{GL_FRAGMENT_SHADER, fragment_source}}) {
    const GLuint shader = compile(static_cast<GLenum>(kind), source);
    glAttachShader(program_, shader);
    glDeleteShader(shader);  // with the program
  }
  glLinkProgram(program_);
  GLint linked = GL_FALSE;
  glGetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) throw std::runtime_error("OpenGL can't link a shader of the preview");
  glUseProgram(program_);
}

}  // namespace tubebin::render
