// What the writer and the reader of scene.json share.
#pragma once

#include <cstddef>

namespace tubebin::scene {

constexpr const char* kSceneJsonFormat = "tubebin scene";
/// Grows when a reader of the version before would misunderstand a file; new keys alone don't count.
constexpr int kSceneJsonVersion = 1;

inline double visible_fraction(std::size_t visible, std::size_t amodal) {
  return amodal > 0 ? static_cast<double>(visible) / static_cast<double>(amodal) : 0.0;
}

}  // namespace tubebin::scene
