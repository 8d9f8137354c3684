#include "tubebin/render/preview.hpp"

#include <stdexcept>

#include "core/png.hpp"

#ifdef TUBEBIN_HAVE_OSMESA
#include "render/opengl/functions.hpp"
#include "render/opengl/views.hpp"
#endif

namespace tubebin::render {

namespace {

[[noreturn]] void refuse() {
  throw std::runtime_error(
      "previews can't be drawn: OSMesa is missing, or was when this was configured "
      "(Debian and Ubuntu: apt install libosmesa6-dev, then configure and build anew)");
}

}  // namespace

std::string encode_png(const Image& image) { return encode_rgb_png(image.rgb, image.width, image.height); }

#ifdef TUBEBIN_HAVE_OSMESA

bool can_render() { return load_opengl(); }

Image render_preview(const scene::Scene& scene, int width, int height) {
  if (!can_render()) refuse();
  return draw_lit_view(scene, width, height);
}

Image render_labels(const scene::Scene& scene, const scene::PixelWindow& window) {
  if (window.width == 0 || window.height == 0) return {};
  if (!can_render()) refuse();
  return draw_label_view(scene, window);
}

#else

bool can_render() { return false; }

Image render_preview(const scene::Scene&, int, int) { refuse(); }

Image render_labels(const scene::Scene&, const scene::PixelWindow&) { refuse(); }

#endif

}  // namespace tubebin::render
