/// What a tube looks like: one file of src/tube/shapes/ a shape, and its line in src/tube/shapes/registry.cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/tube/tube.hpp"

namespace tubebin::tube {

struct TubeOptions;

/// A shape with its own options; what all shapes share (radius, wall, mass) is in TubeOptions.
class Shape {
 public:
  virtual ~Shape() = default;

  /// The keys that this shape has beside those of all shapes.
  virtual void describe(Fields& fields, TubeOptions& options) = 0;
  /// Throws ConfigError where options contradict each other; `prefix` is the tube's key path.
  virtual void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix) const = 0;
  /// One specimen's nodes and cylinders, in a frame of its own, metres.
  virtual Tube generate(const TubeOptions& options, Random& random) const = 0;
  virtual std::unique_ptr<Shape> clone() const = 0;
};

/// In the order of the registry; the first is the default.
const std::vector<std::string>& shape_names();

/// One shape of the registry. Copies have options of their own.
class ShapeChoice {
 public:
  ShapeChoice() : ShapeChoice(0) {}
  /// Throws std::out_of_range where no shape has that name.
  explicit ShapeChoice(const std::string& name);
  ShapeChoice(const ShapeChoice& other) : index_(other.index_), shape_(other.shape_->clone()) {}
  ShapeChoice(ShapeChoice&&) noexcept = default;
  ShapeChoice& operator=(ShapeChoice other) noexcept;
  ~ShapeChoice() = default;

  const std::string& name() const { return shape_names()[static_cast<std::size_t>(index_)]; }
  Shape* operator->() { return shape_.get(); }
  const Shape* operator->() const { return shape_.get(); }

  /// The key `shape`. Another shape begins with its own defaults.
  void describe(Fields& fields);

 private:
  explicit ShapeChoice(int index);

  int index_;
  std::unique_ptr<Shape> shape_;
};

}  // namespace tubebin::tube
