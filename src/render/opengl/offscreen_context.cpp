#include "render/opengl/offscreen_context.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace tubebin::render {
namespace {

constexpr int kDepthBits = 24;

}  // namespace

OffscreenContext::OffscreenContext(int width, int height, int samples)
    : width_(width),
      height_(height),
      samples_(samples),
      rgba_(4 * static_cast<std::size_t>(width * samples) * static_cast<std::size_t>(height * samples)),
      context_(OSMesaCreateContextExt(OSMESA_RGBA, kDepthBits, 0, 0, nullptr)) {
  const auto context = static_cast<OSMesaContext>(context_);
  if (context == nullptr ||
      !OSMesaMakeCurrent(context, rgba_.data(), GL_UNSIGNED_BYTE, width * samples, height * samples)) {
    if (context != nullptr) OSMesaDestroyContext(context);
    throw std::runtime_error(fmt::format("OSMesa can't draw an image of {} x {} pixels", width, height));
  }
  OSMesaPixelStore(OSMESA_Y_UP, 0);
  glViewport(0, 0, width * samples, height * samples);
}

OffscreenContext::~OffscreenContext() { OSMesaDestroyContext(static_cast<OSMesaContext>(context_)); }

Image OffscreenContext::read() const {
  glFinish();
  Image image{width_, height_, {}};
  image.rgb.reserve(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int row = 0; row < height_; ++row)
    for (int column = 0; column < width_; ++column)
      for (std::size_t channel = 0; channel < 3; ++channel) image.rgb.push_back(mean(column, row, channel));
  return image;
}

std::uint8_t OffscreenContext::mean(int column, int row, std::size_t channel) const {
  int sum = 0;
  for (int y = row * samples_; y < (row + 1) * samples_; ++y)
    for (int x = column * samples_; x < (column + 1) * samples_; ++x)
      sum += rgba_[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ * samples_) +
                        static_cast<std::size_t>(x)) +
                   channel];
  const int count = samples_ * samples_;
  return static_cast<std::uint8_t>((sum + count / 2) / count);
}

std::vector<float> OffscreenContext::read_depths() const {
  std::vector<float> depths(rgba_.size() / 4);
  glReadPixels(0, 0, width_ * samples_, height_ * samples_, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  return depths;
}

}  // namespace tubebin::render
