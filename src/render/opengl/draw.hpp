// Draws a mesh: positions, normals and dome light are the fixed-function vertex, normal and texture
// coordinate.
#pragma once

#include "render/mesh.hpp"
#include "render/opengl/offscreen_context.hpp"

namespace tubebin::render {

inline void draw(const Mesh& mesh) {
  if (mesh.indices.empty()) return;
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_NORMAL_ARRAY);
  glVertexPointer(3, GL_FLOAT, sizeof(Vertex), mesh.vertices.front().position.data());
  glNormalPointer(GL_FLOAT, sizeof(Vertex), mesh.vertices.front().normal.data());
  glEnableClientState(GL_TEXTURE_COORD_ARRAY);
  glTexCoordPointer(1, GL_FLOAT, sizeof(Vertex), &mesh.vertices.front().dome_light);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.indices.size()), GL_UNSIGNED_INT, mesh.indices.data());
}

}  // namespace tubebin::render
