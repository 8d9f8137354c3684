// The shapes' constructors, one a file.
#pragma once

#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::tube {

std::unique_ptr<Shape> make_chain();
std::unique_ptr<Shape> make_branching();
std::unique_ptr<Shape> make_ring();
std::unique_ptr<Shape> make_sphere();
std::unique_ptr<Shape> make_curve();

/// A shape that copies itself by its copy constructor.
template <typename Derived>
class CopiedShape : public Shape {
 public:
  std::unique_ptr<Shape> clone() const override {
    return std::make_unique<Derived>(static_cast<const Derived&>(*this));
  }
};

}  // namespace tubebin::tube
