// What render_preview and render_labels draw where there is OpenGL.
#pragma once

#include "tubebin/render/preview.hpp"

namespace tubebin::render {

Image draw_lit_view(const scene::Scene& scene, int width, int height);
Image draw_label_view(const scene::Scene& scene, const scene::PixelWindow& window);

}  // namespace tubebin::render
