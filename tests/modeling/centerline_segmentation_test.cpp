#include "modeling/fitting/centerline_segmentation.hpp"

#include <gtest/gtest.h>

#include "modeling/built_scene.hpp"

namespace tubebin::testing {

using namespace modeling;
namespace {

TEST(Segmentation, NeedsAsManyPointsAsAnAxisHasUnknowns) {
  for (const std::size_t count : {3u, 4u}) {
    FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = 0.003};
    for (std::size_t i = 0; i < count; ++i) {
      cloud.points.emplace_back(0.001f * static_cast<float>(i), 0.0f, 0.05f);
      cloud.normals.push_back(cloud::Point::UnitZ());
    }
    EXPECT_EQ(segment_by_votes(cloud, kRadius).size(), count < 4 ? 0u : 1u);
  }
}

}  // namespace
}  // namespace tubebin::testing
