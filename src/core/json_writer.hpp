/// Values as JSON, numbers with all their digits.
#pragma once

#include <nlohmann/json.hpp>

#include "tubebin/core/fields.hpp"

namespace tubebin {

using OrderedJson = nlohmann::ordered_json;

/// Throws std::invalid_argument where the number is not finite: JSON has no such number.
OrderedJson to_json(double number);
OrderedJson to_json(const Vec3& vector);
/// {"position": [x, y, z], "quaternion": [w, x, y, z], "rotation": rows of the matrix}. The matrix reads back
/// bit by bit; the quaternion is the same rotation for those who prefer it.
OrderedJson to_json(const Pose& pose);

/// The fields that `describe` names, as an object.
OrderedJson fields_to_json(const std::function<void(Fields&)>& describe);

/// The object with a key a line, and an array of objects with an element a line.
std::string format_json(const OrderedJson& object);

}  // namespace tubebin
