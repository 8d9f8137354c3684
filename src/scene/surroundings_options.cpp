#include "tubebin/scene/place_surroundings.hpp"

namespace tubebin::scene {
namespace {

constexpr Limits kCounts = {0, 100};
constexpr Limits kSizes = {0.001, 100.0};

/// `key`_max is not below `key`_min.
template <typename Value>
void check_range(Value min, Value max, const KeyPlaces& places, const std::string& key) {
  if (max < min) places.fail(key + "_max", fmt::format("{} is below {}_min = {}", max, key, min));
}

}  // namespace

void describe(Fields& fields, SurroundingsOptions& o) {
  fields.group(
      "table", "what the bin stands on, its middle below the bin's; a large one is a floor", [&](Fields& table) {
        table.number("length", o.table_length, {0.0, 100.0}, "m", "along x; 0 is no table, and nothing around the bin");
        table.number("width", o.table_width, {0.0, 100.0}, "m", "along y");
        table.number("thickness", o.table_thickness, kSizes, "m", "below the bin's floor");
      });
  fields.group("boxes", "that stand on the table, turned at random", [&](Fields& boxes) {
    boxes.integer("count_min", o.box_count_min, kCounts, "", "fewest");
    boxes.integer("count_max", o.box_count_max, kCounts, "", "most");
    boxes.number("size_min", o.box_size_min, kSizes, "m", "shortest edge");
    boxes.number("size_max", o.box_size_max, kSizes, "m", "longest edge");
  });
  fields.group("cylinders", "that stand on the table: mugs, bottles, a robot's column", [&](Fields& cylinders) {
    cylinders.integer("count_min", o.cylinder_count_min, kCounts, "", "fewest");
    cylinders.integer("count_max", o.cylinder_count_max, kCounts, "", "most");
    cylinders.number("radius_min", o.cylinder_radius_min, kSizes, "m", "least");
    cylinders.number("radius_max", o.cylinder_radius_max, kSizes, "m", "most");
    cylinders.number("height_min", o.cylinder_height_min, kSizes, "m", "least");
    cylinders.number("height_max", o.cylinder_height_max, kSizes, "m", "most");
  });
  fields.integer("bins", o.bins, {0, 10}, "",
                 "further bins on the table, of the form of `bin`, empty, turned at random");
  fields.number("clearance", o.clearance, {0.0, 10.0}, "m",
                "left between any two objects, and between them and the bin, tubes that hang out of it, and scanners");
}

void check(const SurroundingsOptions& options, const Bin& bin, const KeyPlaces& places, const std::string& prefix) {
  check_range(options.box_count_min, options.box_count_max, places, prefix + ".boxes.count");
  check_range(options.box_size_min, options.box_size_max, places, prefix + ".boxes.size");
  check_range(options.cylinder_count_min, options.cylinder_count_max, places, prefix + ".cylinders.count");
  check_range(options.cylinder_radius_min, options.cylinder_radius_max, places, prefix + ".cylinders.radius");
  check_range(options.cylinder_height_min, options.cylinder_height_max, places, prefix + ".cylinders.height");
  if (options.table_length == 0.0) {
    for (const auto& [key, count] :
         {std::pair(".boxes.count_max", options.box_count_max),
          std::pair(".cylinders.count_max", options.cylinder_count_max), std::pair(".bins", options.bins)})
      if (count > 0)
        places.fail(prefix + key,
                    fmt::format("{} need a table to stand on; set {}.table.length and width", count, prefix));
    return;
  }
  if (bin.has_mesh() && options.bins > 0)
    places.fail(prefix + ".bins", fmt::format("{} are not valid beside bin.mesh; valid: 0", options.bins));
  const Box bounds = bin_bounds(bin);
  const auto check_side = [&](const char* key, double side, double needed) {
    if (side < needed)
      places.fail(
          prefix + ".table." + key,
          fmt::format("{} m is not valid; valid: at least {:.6g} m, so that the bin stands on it", side, needed));
  };
  check_side("length", options.table_length, bounds.sizes().x());
  check_side("width", options.table_width, bounds.sizes().y());
}

}  // namespace tubebin::scene
