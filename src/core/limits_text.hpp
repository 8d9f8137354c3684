// Limits in words, for errors and docs.
#pragma once

#include <fmt/format.h>

#include <string>

#include "tubebin/core/fields.hpp"

namespace tubebin {

/// "a finite number", "at least 0", "at most 1" or "0 to 1".
inline std::string limits_text(Limits limits) {
  const Limits open;
  if (limits.min == open.min && limits.max == open.max) return "a finite number";
  if (limits.max == open.max) return fmt::format("at least {}", limits.min);
  if (limits.min == open.min) return fmt::format("at most {}", limits.max);
  return fmt::format("{} to {}", limits.min, limits.max);
}

}  // namespace tubebin
