/// A settled scene: bin, scanner and posed tubes. It is what simulation hands to scanning, rendering and files.
/// World frame: origin at the centre of the bin's floor, z up, x along the bin's length, y along its width.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tubebin/core/yaml.hpp"
#include "tubebin/scene/bin_mesh.hpp"
#include "tubebin/scene/scanner_effects.hpp"
#include "tubebin/scene/surroundings.hpp"
#include "tubebin/tube/solids.hpp"

namespace tubebin::scene {

/// An open container: a floor and four walls, all `wall_thickness` thick, around an inner space that measures length and
/// width at its floor. All metres but where the name says otherwise.
struct Bin {
  double length = 0.55;
  double width = 0.37;
  double height = 0.20;
  double wall_thickness = 0.02;
  double draft_deg = 0.0;      ///< degrees by which the walls lean outward
  double rim_width = 0.0;      ///< from the walls' inner upper edge outward; 0: none
  double corner_radius = 0.0;  ///< between the walls' inner faces; 0: edges
  std::string mesh = {};       ///< an STL file of its surfaces; length, width and height are then its inner space's
  double mesh_scale = 1.0;     ///< metres for each unit of that file
  /// Read from that file by load_mesh(); none where there is no file, or it is not read yet.
  std::shared_ptr<const BinMesh> surface = {};

  bool has_mesh() const { return !mesh.empty(); }
  /// Upright walls that meet at right angles, without a rim.
  bool is_box() const { return draft_deg == 0.0 && rim_width == 0.0 && corner_radius == 0.0; }

  /// Of loaded meshes the names tell the bytes.
  friend bool operator==(const Bin& a, const Bin& b);
};

/// An axis-aligned solid box, metres.
using Box = Eigen::AlignedBox3d;

/// A solid box, of a bin or of what stands around it, in a frame of its own.
struct BinPart {
  Box box;
  Pose world_from_part = Pose::Identity();
  bool is_turned = false;  ///< else its frame is the world's

  std::array<Vec3, 8> corners_in_world() const;  ///< numbered as a box's: bit k says on which side along axis k
  Box bounds_in_world() const;
};

/// The bin's solids, whose union is the bin for all who simulate, scan or draw it: the floor slab, then the walls at -x,
/// +x, -y, +y. A box's walls share faces and do not overlap. Where walls lean, each is a plate behind its inner face; plates
/// of rounded corners follow, then the rim. These overlap outside of the inner space. None where the bin has a mesh: its
/// triangles are the bin.
std::vector<BinPart> bin_parts(const Bin& bin);

/// The surfaces of a bin that has a mesh; none of another. Throws IoError where they are not loaded.
const std::vector<Triangle>& mesh_triangles(const Bin& bin);

/// Around all of the bin, world frame.
Box bin_bounds(const Bin& bin);

/// Reads the bin's mesh, which lies in `folder`, and names it by its content (BinMesh::file_name). Nothing without one.
/// Throws IoError.
void load_mesh(Bin& bin, const std::string& folder);
/// The same of a configuration: the mesh lies relative to the file that names it.
void load_mesh(Bin& bin, const KeyPlaces& places, const std::string& prefix);

/// A plane that bounds a bin's inner space.
struct InnerFace {
  Vec3 outward;         ///< unit
  double offset = 0.0;  ///< metres: outward . p <= offset inside
  /// Metres that a point lies inside; negative beyond the face.
  double depth_inside(const Vec3& p) const { return offset - outward.dot(p); }
};
/// Floor, the walls at -x, +x, -y, +y, then the flat facets that stand for rounded corners. The inner space is what lies
/// inside all of them up to the bin's height.
std::vector<InnerFace> inner_faces(const Bin& bin);

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

/// The rotation_deg with which the optical axis of a scanner at `position` meets `target`, another point of the world
/// (metres): image x is level and image y points down; straight down or up, image x is along the world's.
Vec3 rotation_deg_towards(const Vec3& target, const Vec3& position);

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
  std::optional<Surroundings> surroundings = {};

  std::size_t source_count() const { return 1 + further_scanners.size(); }
};

/// The boxes that stand around the bin: the table, boxes, the parts of further bins.
std::vector<BinPart> surrounding_boxes(const Scene& scene);
/// The cylinders that do.
std::vector<StandingCylinder> surrounding_cylinders(const Scene& scene);

/// The scene with one of its scanners alone.
Scene seen_from(const Scene& scene, std::size_t source);

void describe(Fields& fields, Bin& bin);
/// Length to wall_thickness, which every bin has, and what makes a bin other than a box.
void describe_box(Fields& fields, Bin& bin);
void describe_walls(Fields& fields, Bin& bin);
void describe_mesh(Fields& fields, Bin& bin);
void check(const Bin& bin, const KeyPlaces& places, const std::string& prefix);
/// The camera alone, without its effects.
void describe(Fields& fields, Scanner& scanner);
void check(const Scanner& scanner, const KeyPlaces& places, const std::string& prefix);

}  // namespace tubebin::scene
