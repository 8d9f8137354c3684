// PNG files of masks. A scene of many tubes has two for each, nearly all of whose rows are empty: such rows are compressed
// once for all of them.
#pragma once

#include <string>
#include <vector>

#include "export/scene_image.hpp"

namespace tubebin::exports {

class MaskEncoder {
 public:
  /// For masks of images of this size, in pixels.
  MaskEncoder(int width, int height);

  /// 8 bit grey: 255 inside, 0 outside.
  std::string png_of(const Mask& mask) const;

 private:
  /// A part of a zlib stream that can be read without the parts before it.
  struct Part {
    std::string deflated;
    std::uint32_t adler32 = 1;  ///< of the bytes that it stands for
    std::size_t size = 0;       ///< of these
  };

  static Part deflate(const std::string& bytes);
  static void append(Part& stream, const Part& part);
  std::string rows_of(const Mask& mask, int begin, int end) const;
  void append_empty_rows(Part& stream, int count) const;

  int width_, height_;            ///< pixels
  std::vector<Part> empty_rows_;  ///< 1, 2, 4, ... of them
};

}  // namespace tubebin::exports
