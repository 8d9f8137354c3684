/// What the script of the 3D view reads.
#pragma once

#include "core/json_writer.hpp"
#include "tubebin/evaluation/scene_view.hpp"

namespace tubebin::evaluation {

/// {"note", "lo", "size", "up", "count", "points", "layers": [{"name", "colors", "tubes"}], "start", "tubes": [{"name",
/// "layer", "color", "radius", "facts", "line"}]}. `points` is base64 of x y z a point as 16-bit parts of the box, and then
/// a byte a point: its kind (two bytes where there are more than 256). A kind is a pair of true and found tube; `colors`
/// and `tubes` have an element a kind, the latter -1 where there is no tube. A colour "--name" is the page's. `start` is
/// the layer that is shown first. Throws IoError where there is no finite point.
OrderedJson view_data(const LabelledPoints& points);

}  // namespace tubebin::evaluation
