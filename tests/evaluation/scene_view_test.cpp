#include "tubebin/evaluation/scene_view.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tubebin/core/error.hpp"

namespace tubebin::evaluation {
namespace {

using ::testing::HasSubstr;

/// What the page's script reads.
nlohmann::json data_of(const std::string& html) {
  const std::string start = "<script type=\"application/json\">";
  const std::size_t begin = html.find(start) + start.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

nlohmann::json view_data_of(const LabelledPoints& points) { return data_of(view_figure({"a <scene>", points})); }

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    if ((count += 6) >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xff);
  }
  return bytes;
}

unsigned number_at(const std::string& bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]) | static_cast<unsigned>(static_cast<unsigned char>(bytes[at + 1])) << 8;
}

/// `tubes` rows of `per_tube` points.
LabelledPoints rows(std::size_t tubes, std::size_t per_tube) {
  LabelledPoints points;
  for (std::size_t k = 1; k <= tubes; ++k)
    for (std::size_t i = 0; i < per_tube; ++i) {
      points.points.emplace_back(0.5F * static_cast<float>(i) / static_cast<float>(per_tube),
                                 0.02F * static_cast<float>(k), 0.1F * static_cast<float>(k % 3));
      points.truth.push_back(static_cast<SegmentId>(k));
      points.predicted.push_back(static_cast<SegmentId>(tubes + 1 - k));
    }
  return points;
}

TEST(SceneView, KeepsPlacesToHalfAStepOfSixteenBits) {
  const LabelledPoints points = rows(7, 101);
  const nlohmann::json data = view_data_of(points);
  ASSERT_EQ(data["count"], points.points.size());
  const std::string bytes = from_base64(data["points"]);
  ASSERT_EQ(bytes.size(), 7 * points.points.size());
  for (std::size_t i = 0; i < points.points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const double size = data["size"][axis];
      const double place = data["lo"][axis].get<double>() + size / 65535.0 * number_at(bytes, 6 * i + 2 * axis);
      EXPECT_NEAR(place, points.points[i][axis], 0.5001 * size / 65535.0 + 1e-9);
    }
}

TEST(SceneView, ColorsAndNumbersFollowTheMatching) {
  LabelledPoints points = rows(3, 100);
  for (std::size_t i = 0; i < 25; ++i) points.predicted[i] = i < 15 ? 9 : kNullId;  // of tube 1; 9 is no tube's
  const nlohmann::json data = view_data_of(points);
  const std::string bytes = from_base64(data["points"]);
  const auto& layers = data["layers"];
  ASSERT_EQ(layers.size(), 3);
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    const auto kind = static_cast<unsigned char>(bytes[6 * points.points.size() + i]);
    const auto& truth = data["tubes"][layers[0]["tubes"][kind].get<std::size_t>()];
    EXPECT_EQ(truth["name"], "tube " + std::to_string(points.truth[i]));
    EXPECT_EQ(layers[0]["colors"][kind], truth["color"]);
    EXPECT_EQ(layers[1]["colors"][kind], i < 15 ? "--soft" : i < 25 ? "--ink" : truth["color"]);
    EXPECT_EQ(layers[2]["colors"][kind], i < 15 ? "#d55e00" : i < 25 ? "--ink" : "--quiet");
  }
  EXPECT_THAT(data["tubes"][0]["facts"].dump(), HasSubstr(R"(["recall","0.7500"])"));
  EXPECT_THAT(data["tubes"][0]["facts"].dump(), HasSubstr(R"(["found as","tube 3"])"));
}

TEST(SceneView, FiftyThousandPointsTakeLessThanHalfAMegabyte) {
  LabelledPoints points = rows(20, 4000);
  for (int i = 0; i < 100'000; ++i) {
    points.points.emplace_back(0.2F, 0.1F, -0.001F * static_cast<float>(i % 10));
    points.truth.push_back(0);
    points.predicted.push_back(kNullId);
  }
  const std::string figure = view_figure({"", points});
  const nlohmann::json data = data_of(figure);
  EXPECT_EQ(data["count"], kMostViewedPoints);
  EXPECT_EQ(data["note"], "Evenly chosen: 40000 of 80000 points on tubes, 10000 of 100000 others.");
  EXPECT_LT(figure.size(), 500'000U);
}

TEST(SceneView, MoreThan256KindsTakeTwoBytes) {
  const LabelledPoints points = rows(300, 2);
  const nlohmann::json data = view_data_of(points);
  const std::string bytes = from_base64(data["points"]);
  ASSERT_EQ(bytes.size(), 8 * points.points.size());
  for (std::size_t i = 0; i < points.points.size(); ++i)
    EXPECT_EQ(data["layers"][0]["tubes"][number_at(bytes, 6 * points.points.size() + 2 * i)], points.truth[i] - 1);
}

TEST(SceneView, ACloudWithoutLabelsIsColoredByItsHeightTowardsTheScanner) {
  LabelledPoints points;
  points.points = {{0.0F, 0.0F, 0.9F}, {0.1F, 0.0F, 1.0F}, {std::nanf(""), 0.0F, 0.0F}};
  points.scanner.position = Vec3::Zero();  // z away from the camera
  const nlohmann::json data = view_data_of(points);
  EXPECT_EQ(data["count"], 2);
  EXPECT_EQ(data["up"], (nlohmann::json{0.0, 0.0, -1.0}));
  EXPECT_EQ(data["layers"].size(), 1);
  EXPECT_EQ(data["layers"][0]["colors"].size(), 2);
  points.points.resize(0);
  EXPECT_THROW(view_data_of(points), IoError);
}

TEST(SceneView, NothingInATitleIsMarkup) {
  const std::string page = format_view_page(std::vector<SceneView>{{"<b>\"x\"</b>", rows(1, 3)}});
  EXPECT_THAT(page, HasSubstr("<h1>&lt;b&gt;"));
  EXPECT_THAT(page, ::testing::Not(HasSubstr("<b>\"x\"")));
  EXPECT_THAT(page, ::testing::Not(HasSubstr("src=\"http")));
}

}  // namespace
}  // namespace tubebin::evaluation
