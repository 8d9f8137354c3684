#include "tubebin/dataset/scanner_options.hpp"

namespace tubebin::dataset {
namespace {

void check_look_at(const ScannerOptions& scanner, const KeyPlaces& places, const std::string& prefix) {
  if (!scanner.look_at) return;
  if (!scanner.rotation_deg.isZero(0.0))
    places.fail(prefix + ".rotation_deg", "look_at says where the scanner looks; valid: one of the two");
  if (*scanner.look_at == scanner.position)
    places.fail(prefix + ".look_at", "is the scanner's position; valid: another point");
}

}  // namespace

scene::Scanner ScannerOptions::posed() const {
  scene::Scanner scanner = *this;
  if (look_at) scanner.rotation_deg = scene::rotation_deg_towards(*look_at, position);
  return scanner;
}

void describe(Fields& fields, ScannerOptions& scanner) {
  scene::describe(fields, scanner);
  fields.vector(
      "look_at", scanner.look_at, {-1000.0, 1000.0}, "m",
      "instead of rotation_deg: the point of the world that the optical axis meets; image x is level, and along "
      "the bin where the scanner looks straight down");
  fields.group("effects", "what a real scanner adds (docs/scanner_effects.md); all off: exact rays",
               [&](Fields& effects) { describe(effects, scanner.effects); });
}

void check(const ScannerOptions& scanner, const scene::Bin& bin, const scene::SurroundingsOptions& surroundings,
           const KeyPlaces& places, const std::string& prefix) {
  scene::check(scanner, places, prefix);
  check_look_at(scanner, places, prefix);
  const auto fail = [&](const char* place) {
    places.fail(prefix + ".position",
                fmt::format("[{}, {}, {}] m is inside {}; valid: a place in the open", scanner.position.x(),
                            scanner.position.y(), scanner.position.z(), place));
  };
  for (const scene::BinPart& part : scene::bin_parts(bin))
    if (part.box.contains(part.world_from_part.inverse() * scanner.position)) fail("the bin's floor or a wall of it");
  const scene::StandingBox table = scene::table_of(surroundings, bin);
  const Vec3 in_table = scanner.position - table.position;
  const scene::Box slab(Vec3(-table.size.x() / 2.0, -table.size.y() / 2.0, 0.0),
                        Vec3(table.size.x() / 2.0, table.size.y() / 2.0, table.size.z()));
  if (surroundings.table_length > 0.0 && slab.contains(in_table)) fail("the table of the surroundings");
}

}  // namespace tubebin::dataset
