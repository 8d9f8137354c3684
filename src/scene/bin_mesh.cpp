#include "tubebin/scene/bin_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "tubebin/core/error.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::scene {
namespace {

constexpr std::size_t kStlHeaderBytes = 84;  // 80 of any text, then the number of triangles
constexpr std::size_t kStlTriangleBytes = 50;
constexpr double kMeshReachMax = 100.0;  // metres from the origin

/// Adds what is read, in metres.
class MeshBuilder {
 public:
  MeshBuilder(const std::string& name, double scale) : name_(name), scale_(scale) {}

  void add(const std::array<Vec3, 3>& corners) {
    Triangle triangle;
    std::ranges::transform(corners, triangle.corners.begin(),
                           [&](const Vec3& corner) { return Vec3(scale_ * corner); });
    const auto& [a, b, c] = triangle.corners;
    if ((b - a).cross(c - a).norm() > 0.0) mesh_.triangles.push_back(triangle);
    for (const Vec3& corner : triangle.corners) mesh_.bounds.extend(corner);
  }

  void check_count(std::size_t count) const {
    if (count > kMeshTrianglesMax)
      throw_io_error("{}: {} triangles or more are not valid; valid: up to {}", name_, count, kMeshTrianglesMax);
  }

  void check_coordinate(double value, const std::string& place) const {
    if (!(std::abs(value * scale_) <= kMeshReachMax))
      throw_io_error(
          "{}: {}: {:.9g} is not valid; valid: finite, and at most {} m from the origin after bin.mesh_scale {}", name_,
          place, value, kMeshReachMax, scale_);
  }

  BinMesh build(std::string stl) && {
    if (mesh_.triangles.empty()) throw_io_error("{}: no triangle has an area; valid: at least one that does", name_);
    mesh_.stl = std::move(stl);
    mesh_.path = name_;
    return std::move(mesh_);
  }

 private:
  const std::string& name_;
  double scale_;
  BinMesh mesh_;
};

std::uint32_t binary_count(std::string_view stl) {
  std::uint32_t count = 0;
  std::memcpy(&count, stl.data() + kStlHeaderBytes - sizeof count, sizeof count);
  return count;
}

void read_binary(std::string_view stl, MeshBuilder& mesh) {
  const std::size_t count = binary_count(stl);
  mesh.check_count(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 9> numbers{};
    const std::size_t begin = kStlHeaderBytes + i * kStlTriangleBytes + 3 * sizeof(float);  // behind the normal
    std::memcpy(numbers.data(), stl.data() + begin, sizeof numbers);
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const auto value = static_cast<double>(numbers[k]);
      mesh.check_coordinate(value, fmt::format("byte {}", begin + k * sizeof(float)));
      corners[k / 3][static_cast<Eigen::Index>(k % 3)] = value;
    }
    mesh.add(corners);
  }
}

/// The words of an ASCII STL file.
class StlWords {
 public:
  StlWords(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::string_view next() {
    constexpr std::string_view kSpace = " \t\r\n\f\v";
    const std::size_t begin = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
    line_ += std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                        text_.begin() + static_cast<std::ptrdiff_t>(begin), '\n');
    at_ = std::min(text_.find_first_of(kSpace, begin), text_.size());
    return text_.substr(begin, at_ - begin);
  }
  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }
  void expect(std::string_view word) {
    if (const std::string_view found = next(); found != word) fail(found, fmt::format("'{}'", word));
  }
  double number() {
    const std::string_view word = next();
    const std::optional<double> value = to_number<double>(word);
    if (!value) fail(word, "a number");
    return *value;
  }
  [[noreturn]] void fail(std::string_view word, const std::string& valid) const {
    const std::string found = word.empty() ? "the file's end" : fmt::format("'{}'", excerpt(word));
    throw_io_error("{}: {}: {} is not valid; valid: {}", name_, place(), found, valid);
  }
  std::string place() const { return fmt::format("line {}", line_); }

 private:
  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::ptrdiff_t line_ = 1;
};

void read_ascii_facet(StlWords& words, MeshBuilder& mesh) {
  words.expect("normal");
  for (int i = 0; i < 3; ++i) words.next();  // follows from the corners
  words.expect("outer");
  words.expect("loop");
  std::array<Vec3, 3> corners;
  for (Vec3& corner : corners) {
    words.expect("vertex");
    for (double& value : corner) {
      value = words.number();
      mesh.check_coordinate(value, words.place());
    }
  }
  words.expect("endloop");
  words.expect("endfacet");
  mesh.add(corners);
}

void read_ascii(std::string_view stl, const std::string& name, MeshBuilder& mesh) {
  StlWords words(stl, name);
  words.expect("solid");
  words.skip_line();  // a name
  for (std::size_t count = 1;; ++count) {
    const std::string_view word = words.next();
    if (word == "endsolid") return;
    if (word != "facet") words.fail(word, "'facet' or 'endsolid'");
    mesh.check_count(count);
    read_ascii_facet(words, mesh);
  }
}

}  // namespace

Vec3 Triangle::normal() const { return (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized(); }

/// After Ericson, "Real-Time Collision Detection" (2005), Section 5.1.5.
Vec3 Triangle::project(const Vec3& point) const {
  const auto& [a, b, c] = corners;
  const Vec3 ab = b - a, ac = c - a, ap = point - a, bp = point - b, cp = point - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

std::string BinMesh::file_name() const { return fmt::format("bin-{}.stl", record_bytes(stl).xxh128); }

BinMesh parse_stl(std::string stl, const std::string& name, double scale) {
  MeshBuilder mesh(name, scale);
  const bool has_header = stl.size() >= kStlHeaderBytes;
  // Binary files may begin with "solid", too: their size tells.
  if (has_header && stl.size() == kStlHeaderBytes + kStlTriangleBytes * binary_count(stl)) read_binary(stl, mesh);
  else if (stl.starts_with("solid")) read_ascii(stl, name, mesh);
  else if (has_header)
    throw_io_error(
        "{}: {} bytes are not valid; valid: an STL file, of {} bytes for the {} triangles that it says at byte 80",
        name, stl.size(), kStlHeaderBytes + kStlTriangleBytes * std::size_t{binary_count(stl)}, binary_count(stl));
  else
    throw_io_error("{}: {} bytes are no STL file; valid: an ASCII one that begins with 'solid', or a binary one", name,
                   stl.size());
  return std::move(mesh).build(std::move(stl));
}

}  // namespace tubebin::scene
