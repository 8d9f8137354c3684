#include "tubebin/scene/bin_mesh.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "support/stl.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/scene/triangle_tree.hpp"

namespace tubebin::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::vector<std::array<Vec3, 3>> kBoxTriangles = testing::triangles_of(bin_parts(Bin{}));

std::string stl_problem(const std::string& stl) {
  try {
    parse_stl(stl, "a.stl", 1.0);
  } catch (const IoError& error) {
    return error.what();
  }
  return "none";
}

TEST(BinMesh, BothKindsOfStlGiveTheTrianglesInMetres) {
  for (const BinMesh& mesh : {parse_stl(testing::ascii_stl(kBoxTriangles, 1000.0), "a.stl", 0.001),
                              parse_stl(testing::binary_stl(kBoxTriangles), "b.stl", 1.0)}) {
    ASSERT_EQ(mesh.triangles.size(), kBoxTriangles.size());
    for (std::size_t i = 0; i < kBoxTriangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((mesh.triangles[i].corners[k] - kBoxTriangles[i][k]).norm(), 1e-7);
    EXPECT_TRUE(mesh.bounds.isApprox(bin_bounds(Bin{}), 1e-6));
  }
}

TEST(BinMesh, OtherFilesAreRefusedByPlaceAndValue) {
  const std::string binary = testing::binary_stl(kBoxTriangles), ascii = testing::ascii_stl(kBoxTriangles);
  EXPECT_THAT(stl_problem(""), HasSubstr("a.stl: 0 bytes are no STL file"));
  EXPECT_THAT(stl_problem("ply\nformat ascii 1.0\n"), HasSubstr("no STL file"));
  EXPECT_THAT(stl_problem(binary.substr(0, binary.size() - 1)),
              HasSubstr("3083 bytes are not valid; valid: an STL file, of 3084 bytes for the 60 triangles"));
  EXPECT_THAT(stl_problem(ascii.substr(0, ascii.find("endfacet"))),
              HasSubstr("line 8: the file's end is not valid; valid: 'endfacet'"));
  EXPECT_THAT(stl_problem("solid\nfacet normal 0 0 1 outer loop\nvertex 1 2 up"),
              HasSubstr("line 3: 'up' is not valid; valid: a number"));
  EXPECT_THAT(stl_problem("solid\nfacet normal 0 0 1 outer loop\nvertex 1 nan 3"), HasSubstr("line 3: nan"));
  EXPECT_THAT(stl_problem(testing::binary_stl(
                  {{Vec3(0, 0, std::numeric_limits<double>::infinity()), Vec3::UnitX(), Vec3::UnitY()}})),
              HasSubstr("byte 104: inf is not valid; valid: finite"));
  EXPECT_THAT(stl_problem(testing::binary_stl({})), HasSubstr("no triangle has an area"));
  EXPECT_THAT(stl_problem(testing::binary_stl({{Vec3::Zero(), Vec3::UnitX(), Vec3(2.0 * Vec3::UnitX())}})),
              HasSubstr("no triangle has an area"));
  EXPECT_THAT(stl_problem(testing::binary_stl(std::vector<std::array<Vec3, 3>>(kMeshTrianglesMax + 1))),
              AllOf(HasSubstr("300001 triangles"), HasSubstr("valid: up to 300000")));
}

TEST(TriangleTree, FindsTheDistanceThatLookingAtAllTrianglesFinds) {
  Random random(3);
  const auto place = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  std::vector<Triangle> triangles;
  for (int i = 0; i < 300; ++i) {
    const Vec3 at = place();
    triangles.push_back({{at, at + 0.1 * place(), at + 0.1 * place()}});
  }
  const TriangleTree tree(triangles);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = place();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& triangle : triangles) nearest = std::min(nearest, (triangle.project(p) - p).norm());
    EXPECT_EQ(tree.distance(p), nearest);
  }
}

}  // namespace
}  // namespace tubebin::scene
