/// Pictures of a scene, drawn off-screen without a graphics card or a display.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::render {

/// Row by row from the top, three bytes (red, green, blue) a pixel.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  cloud::Color pixel(int column, int row) const {
    const std::uint8_t* p =
        &rgb[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column))];
    return static_cast<cloud::Color>(p[0]) << 16 | static_cast<cloud::Color>(p[1]) << 8 |
           static_cast<cloud::Color>(p[2]);
  }
};

/// Whether there is OSMesa to draw with: it was found when this was configured, and can be loaded, which this does.
bool can_render();

/// The bin and its tubes in their ground-truth colours, lit, from obliquely above (as the paper's Figures 3
/// and 6 show scenes). The bin's front walls are glass. Throws std::runtime_error where !can_render().
Image render_preview(const scene::Scene& scene, int width, int height);

/// The ground-truth colours that the scanner sees in the window's pixels, black where it sees nothing: no
/// light, no antialiasing, the scanner's camera and range. Throws std::runtime_error where !can_render().
Image render_labels(const scene::Scene& scene, const scene::PixelWindow& window);

/// The image as a PNG file's bytes; equal images give equal bytes.
std::string encode_png(const Image& image);

}  // namespace tubebin::render
