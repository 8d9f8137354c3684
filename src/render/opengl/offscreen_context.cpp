#include "render/opengl/offscreen_context.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace tubebin::render {
namespace {

constexpr int kDepthBits = 24;

}  // namespace

OffscreenContext::OffscreenContext(int width, int height)
    : width_(width),
      height_(height),
      rgba_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      context_(OSMesaCreateContextExt(OSMESA_RGBA, kDepthBits, 0, 0, nullptr)) {
  const auto context = static_cast<OSMesaContext>(context_);
  if (context == nullptr || !OSMesaMakeCurrent(context, rgba_.data(), GL_UNSIGNED_BYTE, width, height)) {
    if (context != nullptr) OSMesaDestroyContext(context);
    throw std::runtime_error(fmt::format("OSMesa can't draw an image of {} x {} pixels", width, height));
  }
  OSMesaPixelStore(OSMESA_Y_UP, 0);
  glViewport(0, 0, width, height);
}

OffscreenContext::~OffscreenContext() { OSMesaDestroyContext(static_cast<OSMesaContext>(context_)); }

Image OffscreenContext::read() const {
  glFinish();
  Image image{width_, height_, {}};
  image.rgb.reserve(rgba_.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba_.size(); i += 4)
    image.rgb.insert(image.rgb.end(), {rgba_[i], rgba_[i + 1], rgba_[i + 2]});
  return image;
}

}  // namespace tubebin::render
