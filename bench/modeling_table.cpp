/// modeling_table DATASET... : how well and how fast the tubes of data sets' clouds are modelled. Prints Markdown:
/// micro-recall by set and tubes, with noise and at ratio 0.3; geometry; time beside stock PCL in the same run; worst
/// scenes.
#include <fmt/format.h>
#include <pcl/common/io.h>
#include <pcl/console/print.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/extract_indices.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>

#include "tubebin/evaluation/micro_recall.hpp"
#include "tubebin/results/model_cloud.hpp"

namespace {

using namespace tubebin;
namespace fs = std::filesystem;

struct Score {
  double micro_recall = 0.0;
  double seconds = 0.0;
  std::size_t tubes_found = 0;
  std::vector<double> to_truth, to_model;  ///< distances of centreline samples, metres; to_model: of visible places
};

struct Variant {
  const char* name;
  double noise;  ///< metres, standard deviation along the ray
  double ratio;
  modeling::ModelingMethod method;
  bool radius_known;
};

constexpr Variant kVariants[] = {
    {"centerline", 0.0, 1.0, modeling::ModelingMethod::centerline, true},
    {"centerline, 0.3 mm noise", 0.0003, 1.0, modeling::ModelingMethod::centerline, true},
    {"centerline, ratio 0.3", 0.0, 0.3, modeling::ModelingMethod::centerline, true},
    {"centerline, radius estimated", 0.0, 1.0, modeling::ModelingMethod::centerline, false},
    {"region_growing, ratio 0.3", 0.0, 0.3, modeling::ModelingMethod::region_growing, true},
    {"region_growing", 0.0, 1.0, modeling::ModelingMethod::region_growing, true}};

results::CloudToModel with_noise(results::CloudToModel input, double noise, std::uint64_t seed) {
  if (noise <= 0.0) return input;
  Random random(seed);
  const Vec3 eye = input.cloud.world_from_sensor.translation();
  for (cloud::Point& p : input.cloud.points)
    if (cloud::is_finite(p))
      p = (p.cast<double>() + noise * random.normal() * (p.cast<double>() - eye).normalized()).cast<float>();
  return input;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

/// Samples a millimetre apart, each by its distance to the nearest of the other side's segments.
template <typename Distance>
void add_samples(const Vec3& a, const Vec3& b, const Distance& distance, std::vector<double>& distances) {
  const int count = std::max(1, static_cast<int>((b - a).norm() / 0.001));
  for (int k = 0; k < count; ++k) distances.push_back(distance(a + (k + 0.5) / count * (b - a)));
}

void compare_geometry(const results::CloudToModel& input, const modeling::ModelingResult& result, Score& score) {
  const auto to_truth = [&](const Vec3& p) {
    double nearest = 1.0;
    for (const scene::PlacedTube& tube : input.scene->scene.tubes)
      for (const tube::Cylinder& c : tube.tube.cylinders)
        nearest = std::min(nearest, distance_to_segment(p, tube.node_in_world(c.node_a), tube.node_in_world(c.node_b)));
    return nearest;
  };
  for (const modeling::TubeModel& tube : result.tubes)
    for (const modeling::TubePath& path : tube.paths)
      for (std::size_t k = 0; k + 1 < path.nodes.size(); ++k)
        if (!path.bridged[k]) add_samples(path.nodes[k], path.nodes[k + 1], to_truth, score.to_truth);
  // The other way from where points say that the tube is in sight: each such point's foot on its true centreline.
  for (std::size_t k = 0; k < result.source.size(); k += 50) {
    const cloud::Label label = input.cloud.labels[result.source[k]];
    if (label == 0) continue;
    const Vec3 p = input.cloud.points[result.source[k]].cast<double>();
    const scene::PlacedTube& tube = input.scene->scene.tubes[label - 1];
    Vec3 foot = p;
    double nearest = 1.0;
    for (const tube::Cylinder& c : tube.tube.cylinders) {
      const Vec3 a = tube.node_in_world(c.node_a), b = tube.node_in_world(c.node_b);
      const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      if ((p - a - t * (b - a)).norm() < nearest) nearest = (p - a - t * (b - a)).norm(), foot = a + t * (b - a);
    }
    double to_model = 1.0;
    for (const modeling::TubeModel& found : result.tubes)
      for (const modeling::TubePath& path : found.paths)
        to_model = std::min(to_model, modeling::distance_to_polyline(foot, path.nodes));
    score.to_model.push_back(to_model);
  }
}

Score score_of(const results::CloudToModel& clean, const Variant& variant, std::uint64_t seed) {
  const results::CloudToModel input = with_noise(clean, variant.noise, seed);
  results::ModelConfig config;
  config.modeling.method = variant.method;
  config.modeling.filtering.ratio = variant.ratio;
  if (variant.radius_known) config.modeling.radius = clean.scene->scene.tubes.front().tube.radius;
  Score score{.seconds = 1e9, .to_truth = {}, .to_model = {}};
  modeling::ModelingResult result;
  const int repeats = variant.method == modeling::ModelingMethod::centerline ? 3 : 1;
  for (int repeat = 0; repeat < repeats; ++repeat) {  // the fastest: others' work on the machine only adds
    result = results::model_cloud(input, config);
    score.seconds = std::min(score.seconds, result.seconds.total());
  }
  std::vector<evaluation::SegmentId> truth, predicted;
  for (std::size_t k = 0; k < result.source.size(); ++k) {
    truth.push_back(input.cloud.labels[result.source[k]]);
    predicted.push_back(result.labels[k]);
  }
  score.micro_recall = evaluation::match_segments(evaluation::count_pairs(truth, predicted, 0U)).micro_recall();
  score.tubes_found = result.tubes.size();
  compare_geometry(clean, result, score);
  return score;
}

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;

/// Normals, RegionGrowing and RANSAC cylinders as PCL's tutorials put them together, on the points inside the bin.
double stock_pcl_seconds(const results::CloudToModel& input) {
  results::ModelConfig config;
  const modeling::ModelingInput positions{
      .points = input.cloud.points, .world_from_sensor = input.cloud.world_from_sensor, .bin = input.scene->scene.bin};
  PclPoints::Ptr points(new PclPoints);
  for (const std::uint32_t i : modeling::crop_bin(positions, config.modeling.filtering))
    points->push_back({input.cloud.points[i].x(), input.cloud.points[i].y(), input.cloud.points[i].z()});
  const auto start = std::chrono::steady_clock::now();
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  PclNormals::Ptr normals(new PclNormals);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  const cloud::Point eye = input.cloud.world_from_sensor.translation().cast<float>();
  estimation.setViewPoint(eye.x(), eye.y(), eye.z());
  estimation.setInputCloud(points);
  estimation.setSearchMethod(tree);
  estimation.setKSearch(30);
  estimation.compute(*normals);
  pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
  growing.setMinClusterSize(50);
  growing.setSearchMethod(tree);
  growing.setNumberOfNeighbours(30);
  growing.setInputCloud(points);
  growing.setInputNormals(normals);
  growing.setSmoothnessThreshold(static_cast<float>(radians(8.0)));
  growing.setCurvatureThreshold(1.0f);
  std::vector<pcl::PointIndices> clusters;
  growing.extract(clusters);
  const auto radius = input.scene->scene.tubes.front().tube.radius;
  for (const pcl::PointIndices& cluster : clusters) {
    PclPoints::Ptr rest(new PclPoints(*points, cluster.indices));
    PclNormals::Ptr rest_normals(new PclNormals(*normals, cluster.indices));
    while (rest->size() >= 50 && 5 * rest->size() >= cluster.indices.size()) {
      pcl::SACSegmentationFromNormals<pcl::PointXYZ, pcl::Normal> sac;
      sac.setOptimizeCoefficients(true);
      sac.setModelType(pcl::SACMODEL_CYLINDER);
      sac.setMethodType(pcl::SAC_RANSAC);
      sac.setNormalDistanceWeight(0.1);
      sac.setMaxIterations(1000);
      sac.setDistanceThreshold(0.2 * radius);
      sac.setRadiusLimits(0.5 * radius, 1.5 * radius);
      sac.setInputCloud(rest);
      sac.setInputNormals(rest_normals);
      pcl::PointIndices::Ptr inliers(new pcl::PointIndices);
      pcl::ModelCoefficients coefficients;
      sac.segment(*inliers, coefficients);
      if (inliers->indices.empty()) break;
      pcl::ExtractIndices<pcl::PointXYZ> extract;
      pcl::ExtractIndices<pcl::Normal> extract_normals;
      PclPoints::Ptr left(new PclPoints);
      PclNormals::Ptr left_normals(new PclNormals);
      extract.setInputCloud(rest);
      extract.setIndices(inliers);
      extract.setNegative(true);
      extract.filter(*left);
      extract_normals.setInputCloud(rest_normals);
      extract_normals.setIndices(inliers);
      extract_normals.setNegative(true);
      extract_normals.filter(*left_normals);
      rest = left;
      rest_normals = left_normals;
    }
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

struct Row {
  std::vector<double> micro_recall, seconds, tube_error, to_truth, to_model;
};

/// Row by folder ("A10", fewer tubes first) and variant.
using RowKey = std::pair<std::pair<std::size_t, std::string>, std::size_t>;

void print_rows(const std::map<RowKey, Row>& rows, const std::map<std::string, std::vector<double>>& stock) {
  fmt::print(
      "| set | method | clouds | micro-recall mean | least | tubes off | centreline mm: model to truth, mean | 95 % "
      "| truth to model, mean | 95 % | ms | stock PCL ms | times faster |\n");
  fmt::print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (const auto& [key, row] : rows) {
    const std::string& folder = key.first.second;
    const double stock_ms = 1e3 * mean(stock.at(folder)), ms = 1e3 * mean(row.seconds);
    fmt::print(
        "| {} | {} | {} | {:.4f} | {:.4f} | {:.2f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:.0f} | {:.1f} |\n",
        folder, kVariants[key.second].name, row.micro_recall.size(), mean(row.micro_recall),
        quantile(row.micro_recall, 0.0), mean(row.tube_error), 1e3 * mean(row.to_truth),
        1e3 * quantile(row.to_truth, 0.95), 1e3 * mean(row.to_model), 1e3 * quantile(row.to_model, 0.95), ms, stock_ms,
        stock_ms / ms);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  std::map<RowKey, Row> rows;
  std::map<std::string, std::vector<double>> stock;
  std::vector<std::pair<double, std::string>> worst;
  std::uint64_t seed = 0;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  // As stock PCL does.
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  for (int a = 1; a < argc; ++a) {
    std::vector<fs::path> clouds;
    for (const auto& entry : fs::recursive_directory_iterator(argv[a]))
      if (entry.path().filename() == "cloud.pcd") clouds.push_back(entry.path());
    std::sort(clouds.begin(), clouds.end());
    for (const fs::path& path : clouds) {
      const results::CloudToModel input = results::read_cloud_to_model(path.string());
      const std::size_t tubes = input.scene->scene.tubes.size();
      const std::string folder = path.parent_path().parent_path().filename().string();
      auto& stock_seconds = stock[folder];
      if (stock_seconds.size() < 3) stock_seconds.push_back(stock_pcl_seconds(input));
      ++seed;
      for (std::size_t v = 0; v < std::size(kVariants); ++v) {
        const Score score = score_of(input, kVariants[v], seed);
        Row& row = rows[{{tubes, folder}, v}];
        row.micro_recall.push_back(score.micro_recall);
        row.seconds.push_back(score.seconds);
        row.tube_error.push_back(std::abs(double(score.tubes_found) - double(tubes)));
        row.to_truth.insert(row.to_truth.end(), score.to_truth.begin(), score.to_truth.end());
        row.to_model.insert(row.to_model.end(), score.to_model.begin(), score.to_model.end());
        if (v == 0) worst.emplace_back(score.micro_recall, path.parent_path().string());
      }
    }
  }
  print_rows(rows, stock);
  std::sort(worst.begin(), worst.end());
  fmt::print("\nWorst clouds, centerline:\n");
  for (std::size_t k = 0; k < std::min<std::size_t>(10, worst.size()); ++k)
    fmt::print("- {}: {:.4f}\n", worst[k].second, worst[k].first);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("\nPeak memory, stock PCL's included: {} MB\n", usage.ru_maxrss / 1024);
} catch (const std::exception& error) {
  fmt::print(stderr, "modeling_table: {}\n", error.what());
  return 1;
}
