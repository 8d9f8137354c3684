// How near each stage of a scene comes to what the library or the machine beneath it can do:
// limits_table CONFIG.yaml FOLDER CASES TUBES. FOLDER is new and lies on the disk that is to be measured. Prints Markdown.
//
//   scan   rays a second, beside Embree's on the scene's triangles (64 facets around a tube), the same rays
//   write  bytes a second from the cloud in memory to the disk, beside writing and syncing as many bytes to a file
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>

#include "render/mesh.hpp"
#include "scan/embree.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/camera.hpp"

namespace {

using namespace tubebin;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Work done, and the seconds that we and the limit needed for it.
struct Stage {
  double work = 0.0;
  double seconds = 0.0;
  double limit_seconds = 0.0;
};

/// Embree's own job: the first triangle of each ray, eight rays at a time.
class TriangleScene {
 public:
  explicit TriangleScene(const scene::Scene& scene)
      : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_.get())) {
    const Vec3 origin = scene.scanner.world_from_scanner().translation();
    render::Mesh bin;
    for (const scene::BinPart& part : scene::bin_parts(scene.bin)) render::add_part(part, origin, {}, bin);
    attach(bin);
    for (const scene::PlacedTube& tube : scene.tubes) attach(render::tube_mesh(tube, origin, {}));
    rtcCommitScene(scene_.get());
  }

  /// Rays that hit; `directions` is padded to a multiple of eight.
  std::size_t count_hits(const std::vector<Vec3>& directions, const scene::Scanner& scanner) const {
    constexpr std::size_t kPacket = 8;
    alignas(32) const int valid[kPacket] = {-1, -1, -1, -1, -1, -1, -1, -1};
    std::size_t hits = 0;
    for (std::size_t begin = 0; begin + kPacket <= directions.size(); begin += kPacket) {
      RTCRayHit8 rays{};
      for (std::size_t i = 0; i < kPacket; ++i) {
        const Eigen::Vector3f direction = directions[begin + i].cast<float>();
        rays.ray.dir_x[i] = direction.x();
        rays.ray.dir_y[i] = direction.y();
        rays.ray.dir_z[i] = direction.z();
        rays.ray.tnear[i] = static_cast<float>(scanner.range_min);
        rays.ray.tfar[i] = static_cast<float>(scanner.range_max);
        rays.ray.mask[i] = ~0U;
        rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
      embree::QueryContext context;
      embree::init_context(context);
      embree::intersect(valid, scene_.get(), context, rays);
      for (const unsigned geometry : rays.hit.geomID) hits += geometry != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
  }

 private:
  void attach(const render::Mesh& mesh) {
    const embree::Geometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    const auto buffer = [&](RTCBufferType type, RTCFormat format, std::size_t size, std::size_t count) {
      return rtcSetNewGeometryBuffer(geometry.get(), type, 0, format, size, count);
    };
    auto* vertices =
        static_cast<float*>(buffer(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (const render::Vertex& vertex : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) *vertices++ = vertex.position[axis];
    auto* indices = static_cast<std::uint32_t*>(
        buffer(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.indices.size() / 3));
    std::copy(mesh.indices.begin(), mesh.indices.end(), indices);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene_.get(), geometry.get());
  }

  embree::Device device_;
  embree::Scene scene_;
};

void add_scan(const dataset::SceneContent& content, double seconds, Stage& stage) {
  const scene::Camera camera(content.record.scene.scanner);
  const scene::PixelWindow& window = content.record.window;
  std::vector<Vec3> directions;
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column < window.x + window.width; ++column)
      directions.push_back(camera.pixel_direction_in_world(column, row));
  stage.work += static_cast<double>(directions.size());
  stage.seconds += seconds;
  directions.resize((directions.size() + 7) / 8 * 8, Vec3::UnitZ());
  const TriangleScene triangles(content.record.scene);
  const double start = now();
  if (triangles.count_hits(directions, content.record.scene.scanner) == 0) throw_io_error("no ray hits a triangle");
  stage.limit_seconds += now() - start;
}

void add_write(const dataset::SceneStore& store, const std::string& folder, const std::string& name,
               const dataset::SceneContent& content, Stage& stage) {
  double start = now();
  const auto files = store.begin_write(name, content)();
  stage.seconds += now() - start;
  std::string bytes;
  for (const auto& [file, record] : files) bytes.resize(bytes.size() + record.bytes, 'x');
  stage.work += static_cast<double>(bytes.size());
  const std::string path = folder + "/limit.bin";
  start = now();
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0 || ::write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()) || ::fsync(file) != 0)
    throw_io_error("{}: cannot be written", path);
  ::close(file);
  stage.limit_seconds += now() - start;
  std::filesystem::remove(path);
}

void print_row(const char* name, const char* unit, double scale, const Stage& stage) {
  fmt::print("| {} | {} | {:.1f} | {:.1f} | {:.2f} |\n", name, unit, stage.work / stage.seconds / scale,
             stage.work / stage.limit_seconds / scale, stage.limit_seconds / stage.seconds);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) throw_config_error("usage: limits_table CONFIG.yaml FOLDER CASES TUBES");
  const dataset::DatasetConfig config = dataset::load_config(argv[1]);
  const dataset::SceneStore store(OutputFolder(argv[2]), config.output);
  Stage scan_stage, write_stage;
  for (int case_number = 1; case_number <= std::stoi(argv[3]); ++case_number) {
    const dataset::SceneId id{config.set, std::stoi(argv[4]), case_number};
    dataset::GeneratedScene scene;
    for (int attempt = 0; attempt == 0 || !scene.failure.empty(); ++attempt) {
      if (attempt == config.attempts_max) throw_io_error("{}: {}", id.name(), scene.failure_detail);
      scene = dataset::generate_scene(config, id, attempt);
    }
    add_scan(scene.content, scene.seconds["scan"], scan_stage);
    add_write(store, argv[2], id.name(), scene.content, write_stage);
  }
  fmt::print("| stage | unit | ours | limit | ours / limit |\n| --- | --- | ---: | ---: | ---: |\n");
  print_row("scan", "million rays a second on Embree's triangles", 1e6, scan_stage);
  print_row("write", "MB a second on the disk", 1e6, write_stage);
} catch (const std::exception& error) {
  fmt::print(stderr, "limits_table: {}\n", error.what());
  return 1;
}
