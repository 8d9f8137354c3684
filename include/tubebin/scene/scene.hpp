/// A settled scene: bin, scanner and posed tubes. It is what simulation hands to scanning, rendering and files.
/// World frame: origin at the centre of the bin's floor, z up, x along the bin's length, y along its width.
#pragma once

#include <cstdint>
#include <vector>

#include "tubebin/core/yaml.hpp"
#include "tubebin/scene/scanner_effects.hpp"
#include "tubebin/tube/solids.hpp"

namespace tubebin::scene {

/// An open box: a floor slab and four walls, all `wall_thickness` thick, around the inner space
/// |x| <= length / 2, |y| <= width / 2, 0 <= z <= height. All metres.
struct Bin {
  double length = 0.55;
  double width = 0.37;
  double height = 0.20;
  double wall_thickness = 0.02;

  friend bool operator==(const Bin&, const Bin&) = default;
};

/// An axis-aligned solid box, metres.
using Box = Eigen::AlignedBox3d;
/// The bin's solids: floor slab (z from -wall_thickness to 0, as wide as the outer walls), then the walls at
/// -x, +x (each as wide as the outer bin), -y, +y (between them). They share faces and do not overlap.
std::vector<Box> bin_boxes(const Bin& bin);

/// What part of the image becomes the cloud.
enum class ScanRegion {
  bin,   ///< the smallest pixel window that covers the bin and its tubes, organized
  full,  ///< all pixels, organized
  tubes  ///< tube points alone, not organized
};

/// A pinhole depth camera. Scanner frame: x to the right of the image, y down, z along the view.
struct Scanner {
  Vec3 position = {0.0, 0.0, 2.0};            ///< metres, world frame
  Vec3 rotation_deg = Vec3::Zero();           ///< roll, pitch, yaw (degrees, about world x, y, z in that order),
                                              ///< applied to a scanner that looks straight down, image x along +x
  int width = 1920;                           ///< pixels
  int height = 1200;                          ///< pixels
  double horizontal_fov_deg = degrees(1.22);  ///< degrees, between the image's left and right border
  double range_min = 0.1;                     ///< metres, along the optical axis, as a camera's near plane
  double range_max = 2.6;                     ///< metres, along the optical axis, inclusive
  ScanRegion region = ScanRegion::bin;
  ScannerEffects effects;  ///< none by default: exact rays

  Pose world_from_scanner() const;
};

struct PlacedTube {
  tube::Tube tube;
  Pose world_from_tube = Pose::Identity();

  Vec3 node_in_world(int node) const { return world_from_tube * tube.nodes[static_cast<std::size_t>(node)]; }
  /// World frame, metres.
  tube::TubeSolids solids_in_world() const;
};

/// Image columns [x, x + width) and rows [y, y + height), pixels.
struct PixelWindow {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  friend bool operator==(const PixelWindow&, const PixelWindow&) = default;
};

/// Two bodies that touch. Label 0 is the bin, label k tube k; label_a < label_b.
struct Contact {
  std::uint32_t label_a = 0;
  std::uint32_t label_b = 0;
  Vec3 position = Vec3::Zero();  ///< metres, world frame
  Vec3 normal = Vec3::Zero();    ///< unit, from a into b
  double depth = 0.0;            ///< how far the surfaces interpenetrate, metres; negative: a gap
};

struct Scene {
  Bin bin;
  Scanner scanner;
  std::vector<PlacedTube> tubes;               ///< tube k of the files and labels is tubes[k - 1]
  std::vector<Scanner> further_scanners = {};  ///< sources 1, 2, ... of a merged cloud; `scanner` is source 0

  std::size_t source_count() const { return 1 + further_scanners.size(); }
};

/// The scene with one of its scanners alone.
Scene seen_from(const Scene& scene, std::size_t source);

void describe(Fields& fields, Bin& bin);
/// The camera alone, without its effects.
void describe(Fields& fields, Scanner& scanner);
void check(const Scanner& scanner, const KeyPlaces& places, const std::string& prefix);

}  // namespace tubebin::scene
