#include "tubebin/cloud/cloud_io.hpp"

#include <gmock/gmock.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <bit>
#include <filesystem>
#include <limits>

#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::cloud {
namespace {

constexpr CloudFormat kFormats[] = {CloudFormat::pcd_binary, CloudFormat::pcd_compressed, CloudFormat::pcd_ascii,
                                    CloudFormat::ply_binary};

struct Contents {
  bool organized = true;
  bool colors = true;
  bool labels = true;
};

Cloud make_cloud(std::uint32_t width, std::uint32_t height, Contents contents = {}) {
  Random random(7);
  Cloud cloud;
  cloud.width = contents.organized ? width : width * height;
  cloud.height = contents.organized ? height : 1;
  const std::size_t count = std::size_t{width} * height;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < count; ++i) {
    const bool hit = i % 7 != 3;
    const auto draw = [&] { return static_cast<float>(random.uniform(-1.0, 1.0)); };
    cloud.points.push_back(hit ? Point(draw(), draw(), draw()) : Point(nan, nan, nan));
    if (contents.colors) cloud.colors.push_back(hit ? static_cast<Color>(random.integer(1, 0xFFFFFF)) : kNullColor);
    if (contents.labels) cloud.labels.push_back(hit ? static_cast<Label>(random.integer(0, 300)) : 0);
  }
  cloud.world_from_sensor = make_pose(random.rotation(), Vec3(0.25, -0.5, 2.0));
  return cloud;
}

void expect_same(const Cloud& actual, const Cloud& expected, double pose_tolerance) {
  EXPECT_EQ(actual.width, expected.width);
  EXPECT_EQ(actual.height, expected.height);
  ASSERT_EQ(actual.size(), expected.size());
  EXPECT_EQ(actual.colors, expected.colors);
  EXPECT_EQ(actual.labels, expected.labels);
  EXPECT_TRUE(actual.world_from_sensor.matrix().isApprox(expected.world_from_sensor.matrix(), pose_tolerance));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (is_finite(expected.points[i])) ASSERT_EQ(actual.points[i], expected.points[i]) << i;
    else ASSERT_FALSE(is_finite(actual.points[i])) << i;
  }
}

std::string temporary_path(const std::string& name) { return ::testing::TempDir() + "tubebin_cloud_io_" + name; }

TEST(CloudIo, EveryFormatReadsBackTheSame) {
  for (const CloudFormat format : kFormats)
    for (const Contents contents : {Contents{}, {false, true, true}, {true, false, true}, {false, false, false}}) {
      SCOPED_TRACE(testing::Message() << "format " << static_cast<int>(format) << " colors " << contents.colors);
      const Cloud cloud = make_cloud(40, 30, contents);
      const std::string path = temporary_path("round_trip") + extension(format);
      write_cloud(path, cloud, format);
      expect_same(read_cloud(path), cloud, format == CloudFormat::ply_binary ? 1e-6 : 1e-14);
      std::filesystem::remove(path);
    }
}

TEST(CloudIo, AnEmptyCloudAndOnePointReadBack) {
  for (const CloudFormat format : kFormats) {
    for (const std::uint32_t count : {0U, 1U}) {
      Cloud cloud = make_cloud(count, 1);
      const Cloud back = parse_cloud(format_cloud(cloud, format), "tiny");
      expect_same(back, cloud, 1e-6);
    }
  }
}

TEST(CloudIo, CloudsOfManyBlocksReadBack) {
  const Cloud cloud = make_cloud(201, 100);
  for (const CloudFormat format : kFormats)
    expect_same(parse_cloud(format_cloud(cloud, format), "blocks"), cloud, 1e-6);
}

TEST(CloudIo, RowsWithoutColumnsAreAnEmptyCloud) {
  const Cloud cloud = parse_cloud(
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 0\nHEIGHT 4000000000\nPOINTS 0\nDATA ascii\n", "a");
  EXPECT_EQ(cloud.size(), 0U);
  EXPECT_FALSE(cloud.organized());
}

TEST(CloudIo, EqualCloudsGiveEqualBytes) {
  for (const CloudFormat format : kFormats)
    EXPECT_EQ(format_cloud(make_cloud(20, 10), format), format_cloud(make_cloud(20, 10), format));
}

TEST(CloudIo, ScaleMultipliesPointsAndSensorPosition) {
  const Cloud cloud = make_cloud(5, 4);
  const Cloud scaled = parse_cloud(format_cloud(cloud, CloudFormat::pcd_binary), "mm", 0.001);
  EXPECT_FLOAT_EQ(scaled.points[0].x(), cloud.points[0].x() * 0.001F);
  EXPECT_NEAR(scaled.world_from_sensor.translation().z(), 0.002, 1e-12);
}

TEST(CloudIo, CompressionCopesWithNoiseAndShrinksWhatRepeats) {
  Cloud noise = make_cloud(100, 1);
  Random random(1);
  for (Color& color : noise.colors) color = static_cast<Color>(random.bits() & 0xFFFFFF);
  expect_same(parse_cloud(format_cloud(noise, CloudFormat::pcd_compressed), "noise"), noise, 1e-14);
  Cloud flat = make_cloud(1000, 100);
  std::fill(flat.points.begin(), flat.points.end(), Point(1, 2, 3));
  EXPECT_LT(format_cloud(flat, CloudFormat::pcd_compressed).size(),
            format_cloud(flat, CloudFormat::pcd_binary).size() / 2);
}

/// What PCL's readers make of a file.
struct PclCloud {
  pcl::PointCloud<pcl::PointXYZRGBL> points;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
};

template <typename Reader>
PclCloud read_with_pcl(const std::string& path) {
  PclCloud cloud;
  pcl::PCLPointCloud2 blob;
  int version = 0;
  EXPECT_EQ(Reader().read(path, blob, cloud.origin, cloud.orientation, version), 0);
  // Labels in PLY are int, since Open3D reads no uint; PCL's own are unsigned, and alike in their bytes.
  for (pcl::PCLPointField& field : blob.fields)
    if (field.name == "label") field.datatype = pcl::PCLPointField::UINT32;
  pcl::fromPCLPointCloud2(blob, cloud.points);
  return cloud;
}

TEST(CloudIo, PclReadsWhatWeWrite) {
  const Cloud cloud = make_cloud(40, 30);
  for (const CloudFormat format : kFormats) {
    SCOPED_TRACE(static_cast<int>(format));
    const std::string path = temporary_path("for_pcl") + extension(format);
    write_cloud(path, cloud, format);
    const PclCloud theirs =
        format == CloudFormat::ply_binary ? read_with_pcl<pcl::PLYReader>(path) : read_with_pcl<pcl::PCDReader>(path);
    std::filesystem::remove(path);
    ASSERT_EQ(theirs.points.width, cloud.width);
    ASSERT_EQ(theirs.points.height, cloud.height);
    if (format != CloudFormat::ply_binary) {  // PCL 1.13 does not hand on the pose, of its own PLY files neither
      EXPECT_TRUE(theirs.origin.head<3>().isApprox(cloud.world_from_sensor.translation().cast<float>()));
      EXPECT_TRUE(
          theirs.orientation.toRotationMatrix().isApprox(cloud.world_from_sensor.linear().cast<float>(), 1e-5F));
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto& point = theirs.points[i];
      if (is_finite(cloud.points[i])) {
        ASSERT_EQ(Point(point.getVector3fMap()), cloud.points[i]);
      }
      ASSERT_EQ(point.rgba & 0xFFFFFF, cloud.colors[i]);
      ASSERT_EQ(point.label, cloud.labels[i]);
    }
  }
}

template <typename PclPoint>
pcl::PointCloud<PclPoint> to_pcl(const Cloud& cloud) {
  pcl::PointCloud<PclPoint> out(cloud.width, cloud.height);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    out[i].getVector3fMap() = cloud.points[i];
    out[i].rgba = cloud.colors[i] | 0xFF000000;
    if constexpr (requires { out[i].label; }) out[i].label = cloud.labels[i];
  }
  out.sensor_origin_.template head<3>() = cloud.world_from_sensor.translation().template cast<float>();
  out.sensor_orientation_ = Quat(cloud.world_from_sensor.linear()).template cast<float>();
  return out;
}

TEST(CloudIo, WeReadWhatPclWrites) {
  const Cloud cloud = make_cloud(40, 30);
  const auto theirs = to_pcl<pcl::PointXYZRGBL>(cloud);
  const std::string path = temporary_path("by_pcl.pcd");
  pcl::PCDWriter pcd;
  pcd.writeBinary(path, theirs);
  expect_same(read_cloud(path), cloud, 1e-5);
  pcd.writeBinaryCompressed(path, theirs);
  expect_same(read_cloud(path), cloud, 1e-5);
  pcd.writeASCII(path, theirs, 9);
  expect_same(read_cloud(path), cloud, 1e-5);
  for (const bool binary : {true, false}) {
    pcl::PLYWriter().write(path, theirs, binary);
    Cloud back = read_cloud(path);
    if (!binary)  // their text keeps fewer digits
      for (std::size_t i = 0; i < back.size(); ++i)
        if (is_finite(cloud.points[i]) && (back.points[i] - cloud.points[i]).norm() < 1e-5F)
          back.points[i] = cloud.points[i];
    expect_same(back, cloud, 1e-4);
  }
  std::filesystem::remove(path);
}

TEST(CloudIo, WeReadPclCloudsWithNormalsAndWithoutLabels) {
  Cloud cloud = make_cloud(10, 10);
  cloud.labels.clear();
  const auto theirs = to_pcl<pcl::PointXYZRGBNormal>(cloud);
  const std::string path = temporary_path("normals.pcd");
  pcl::PCDWriter().writeBinary(path, theirs);
  expect_same(read_cloud(path), cloud, 1e-5);
  pcl::PCDWriter().writeBinaryCompressed(path, theirs);
  expect_same(read_cloud(path), cloud, 1e-5);
  std::filesystem::remove(path);
}

/// Bytes of values as they stand in a file.
template <typename... Values>
std::string raw(Values... values) {
  std::string out;
  (out.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return out;
}

TEST(CloudIo, ReadsOtherTypesOrdersAndExtraFields) {
  const std::string header =
      "VERSION .7\nFIELDS label normal z _ y x rgba\nSIZE 2 4 8 1 8 8 4\nTYPE I F F U F F U\nCOUNT 1 3 1 5 1 "
      "1 1\n"
      "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 2 0 1 0 0\nPOINTS 2\nDATA binary\n";
  const auto point = [](std::int16_t label, double x, std::uint32_t rgba) {
    return raw(label, 0.F, 0.F, 1.F, x + 2, char{}, char{}, char{}, char{}, char{}, x + 1, x, rgba);
  };
  const Cloud cloud = parse_cloud(header + point(5, 1.0, 0xFF804020) + point(0, 10.0, 0x00FFFFFF), "other");
  EXPECT_EQ(cloud.points, (std::vector<Point>{{1, 2, 3}, {10, 11, 12}}));
  EXPECT_EQ(cloud.labels, (std::vector<Label>{5, 0}));
  EXPECT_EQ(cloud.colors, (std::vector<Color>{0x804020, 0xFFFFFF}));
  EXPECT_TRUE(cloud.world_from_sensor.linear().isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()));
}

TEST(CloudIo, ReadsTextWithFloatColorsWindowsLinesAndNoPoints) {
  const std::string text =
      "# .PCD v.7\r\nVERSION .7\r\nFIELDS x y z rgb\r\nSIZE 4 4 4 4\r\nTYPE F F F F\r\nWIDTH 3\r\nHEIGHT "
      "1\r\n"
      "DATA ascii\r\n1 +2 3e0 4.2108e+06\r\nnan nan nan 0\r\n\r\n0.5 1e-50 -inf 2.3418052e-38\r\n";
  const Cloud cloud = parse_cloud(text, "text");
  ASSERT_EQ(cloud.size(), 3U);
  EXPECT_EQ(cloud.points[0], Point(1, 2, 3));
  EXPECT_FALSE(is_finite(cloud.points[1]));
  EXPECT_EQ(cloud.points[2].y(), 0.0F);
  EXPECT_EQ(cloud.colors[0], std::bit_cast<Color>(4.2108e+06F) & 0xFFFFFF);
  EXPECT_EQ(cloud.colors[2], std::bit_cast<Color>(2.3418052e-38F));
}

TEST(CloudIo, ReadsBigEndianPlyWithDoublesAndFacesFirst) {
  const auto big = [](auto value) {
    std::string bytes = raw(value);
    return std::string(bytes.rbegin(), bytes.rend());
  };
  const std::string header =
      "ply\nformat binary_big_endian 1.0\ncomment hi\nelement face 1\nproperty list uchar int "
      "vertex_indices\n"
      "element vertex 2\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty short label\nend_header\n";
  std::string body = big(std::uint8_t{3}) + big(0) + big(1) + big(2);
  for (const double x : {1.0, 4.0})
    body += big(x) + big(x + 1) + big(x + 2) + big(0.5F) + "\x10\x20\xFF" + big(std::int16_t{300});
  const Cloud cloud = parse_cloud(header + body, "big");
  EXPECT_EQ(cloud.points, (std::vector<Point>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(cloud.colors, (std::vector<Color>{0x1020FF, 0x1020FF}));
  EXPECT_EQ(cloud.labels, (std::vector<Label>{300, 300}));
}

TEST(CloudIo, ReadsPlyText) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float label\n"
      "element face 7\nproperty list uchar int vertex_indices\nend_header\n";
  const Cloud cloud = parse_cloud(header + "1 2 3 1 2 255 8\n4 5 6 0 0 1 9\n3 0 1 1\n", "text");
  EXPECT_EQ(cloud.points, (std::vector<Point>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(cloud.colors, (std::vector<Color>{0x0102FF, 0x000001}));
  EXPECT_EQ(cloud.labels, (std::vector<Label>{8, 9}));
}

TEST(CloudIo, WritingNamesThePathThatFails) {
  try {
    write_cloud("/nowhere/cloud.pcd", make_cloud(1, 1), CloudFormat::pcd_binary);
    FAIL();
  } catch (const IoError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/cloud.pcd: cannot be written: No such file or directory");
  }
}

}  // namespace
}  // namespace tubebin::cloud
