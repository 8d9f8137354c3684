// What render_preview and render_labels draw where there is OpenGL.
#pragma once

#include "tubebin/render/preview.hpp"

namespace tubebin {

Image draw_lit_view(const Scene& scene, int width, int height);
Image draw_label_view(const Scene& scene, const PixelWindow& window);

}  // namespace tubebin
