#include "tubebin/render/preview.hpp"

#include <stdexcept>

#ifdef TUBEBIN_HAVE_OSMESA
#include "render/opengl/views.hpp"
#endif

namespace tubebin {

#ifdef TUBEBIN_HAVE_OSMESA

bool can_render() { return true; }

Image render_preview(const Scene& scene, int width, int height) { return draw_lit_view(scene, width, height); }

Image render_labels(const Scene& scene, const PixelWindow& window) {
  if (window.width == 0 || window.height == 0) return {};
  return draw_label_view(scene, window);
}

#else

namespace {

[[noreturn]] void refuse() {
  throw std::runtime_error(
      "this build can't draw previews: OSMesa was missing when it was configured "
      "(Debian and Ubuntu: apt install libosmesa6-dev, then configure and build anew)");
}

}  // namespace

bool can_render() { return false; }

Image render_preview(const Scene&, int, int) { refuse(); }

Image render_labels(const Scene&, const PixelWindow&) { refuse(); }

#endif

}  // namespace tubebin
