#include <algorithm>
#include <stdexcept>

#include "tube/shapes/shapes.hpp"

namespace tubebin::tube {
namespace {

struct Entry {
  const char* name;
  std::unique_ptr<Shape> (*make)();
};

constexpr Entry kRegistry[] = {
    {"chain", make_chain},   {"branching", make_branching}, {"ring", make_ring},
    {"sphere", make_sphere}, {"curve", make_curve},
};

int index_of(const std::string& name) {
  const auto found = std::ranges::find(shape_names(), name);
  if (found == shape_names().end()) throw std::out_of_range("no shape is called " + name);
  return static_cast<int>(found - shape_names().begin());
}

}  // namespace

const std::vector<std::string>& shape_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Entry& entry : kRegistry) all.emplace_back(entry.name);
    return all;
  }();
  return names;
}

ShapeChoice::ShapeChoice(int index) : index_(index), shape_(kRegistry[index].make()) {}

ShapeChoice::ShapeChoice(const std::string& name) : ShapeChoice(index_of(name)) {}

ShapeChoice& ShapeChoice::operator=(ShapeChoice other) noexcept {
  index_ = other.index_;
  shape_ = std::move(other.shape_);
  return *this;
}

void ShapeChoice::describe(Fields& fields) {
  int index = index_;
  fields.choice(
      "shape", index, shape_names(),
      "chain: the paper's tube; branching: a tree of paths; ring: closed; sphere: a ball; curve: smooth. Each "
      "has keys of its own");
  if (index != index_) *this = ShapeChoice(index);
}

}  // namespace tubebin::tube
