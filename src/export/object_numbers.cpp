#include "export/object_numbers.hpp"

#include <fmt/format.h>

#include "tubebin/core/error.hpp"
#include "tubebin/core/file_record.hpp"

namespace tubebin::exports {
namespace {

constexpr int kObjectsOfAKind = 1'000'000;

}  // namespace

ObjectIdentity identify(const tube::Tube& tube) {
  std::string shape = fmt::format("{} {}", tube.radius, tube.wall_thickness);
  for (const Vec3& node : tube.nodes) shape += fmt::format(" ({} {} {})", node.x(), node.y(), node.z());
  for (const tube::Cylinder& cylinder : tube.cylinders)
    shape += fmt::format(" [{} {} {}]", cylinder.node_a, cylinder.node_b, cylinder.radius);
  return {tube.kind.empty() ? "tube" : tube.kind, record_bytes(shape).xxh128};
}

TubeNumbers ObjectNumbers::number(const ObjectIdentity& tube) {
  const auto [kind, is_new] = kinds_.try_emplace(tube.kind);
  if (is_new) kind->second.number = static_cast<int>(kinds_.size());
  auto& objects = kind->second.objects;
  const int next = static_cast<int>(objects.size()) + 1;
  const int object = objects.try_emplace(tube.shape, next).first->second;
  if (object >= kObjectsOfAKind || kind->second.number > 2000)
    throw_config_error("the data set has more than {} objects of the kind {}, or more than 2000 kinds",
                       kObjectsOfAKind - 1, tube.kind);
  return {kind->second.number, (kind->second.number - 1) * kObjectsOfAKind + object};
}

}  // namespace tubebin::exports
