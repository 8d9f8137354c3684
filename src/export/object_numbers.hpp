// Which tubes are specimens of the same object, and the numbers by which other formats know kinds and objects.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "export/scene_export.hpp"
#include "tubebin/tube/tube.hpp"

namespace tubebin::exports {

/// What makes a tube the same object as another one: its kind's name ("tube" where it has none) and its shape.
struct ObjectIdentity {
  std::string kind;
  std::string shape;  ///< hash of the tube's nodes, cylinders, radii and wall, in its own frame
};
ObjectIdentity identify(const tube::Tube& tube);

/// Numbers kinds from 1, and the objects of kind k from (k - 1) x 1 000 000 + 1, both in the order of appearance, so that
/// what has a number keeps it when scenes follow.
class ObjectNumbers {
 public:
  TubeNumbers number(const ObjectIdentity& tube);

 private:
  struct Kind {
    int number = 0;
    std::map<std::string, int> objects;  // by shape
  };
  std::map<std::string, Kind> kinds_;
};

}  // namespace tubebin::exports
