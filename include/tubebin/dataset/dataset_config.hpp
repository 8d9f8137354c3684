/// What one data set is made from: everything that decides its bytes, and how many scenes of it are wanted.
#pragma once

#include <string>
#include <vector>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/dataset/scanner_options.hpp"
#include "tubebin/physics/lift.hpp"
#include "tubebin/scene/cloud_space.hpp"
#include "tubebin/scene/place_surroundings.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::dataset {

struct OutputOptions {
  cloud::CloudFormat format = cloud::CloudFormat::pcd_binary;
  scene::CloudSpace space;
  bool clean_cloud = false;  ///< the noise-free twin beside each cloud
  bool depth_image = false;  ///< depth.png and labels.png beside each cloud (scene/depth_image.hpp)
  bool preview = false;      ///< a rendered picture and the ground-truth image beside each cloud
};

/// Which tube is lifted out next.
enum class LiftRule {
  top,    ///< of the tubes with the fewest above them, the one whose centre of mass is highest
  random  ///< any of these
};

/// How piles are taken apart, tube by tube, with a scene of each step.
struct SequenceOptions {
  int lifts = 0;  ///< at most; one tube stays
  LiftRule rule = LiftRule::top;
  physics::LiftOptions lift;
};

struct DatasetConfig {
  std::string tool_version;  ///< that makes the data set
  std::string set = "A";     ///< scenes are called `<set><tubes>/<case>`
  std::uint64_t seed = 1;
  std::vector<int> tubes = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 20};
  int cases = 20;                     ///< scenes for each number of tubes
  int attempts_max = 50;              ///< per scene
  double attempt_time_limit = 120.0;  ///< seconds of wall-clock time, per attempt
  tube::TubeOptions tube;
  std::vector<tube::TubeKind> kinds;  ///< of a mixed bin, instead of `tube`
  scene::Bin bin;
  scene::SurroundingsOptions surroundings;
  physics::PhysicsOptions physics;
  ScannerOptions scanner;
  SequenceOptions sequence;
  std::vector<ScannerOptions> scanners;  ///< several, merged into one cloud, instead of `scanner`
  OutputOptions output;
  Distributions distributions;  ///< numbers that are drawn for each scene or tube (docs/randomization.md)

  /// The scanners that look at each scene: `scanners`, or `scanner` alone; those that look at a point are turned to it.
  std::vector<scene::Scanner> all_scanners() const;
};

void describe(Fields& fields, DatasetConfig& config);
/// The configuration as `describe` wants it bound, for read_yaml_*, write_yaml and the like.
std::function<void(Fields&)> fields_of(DatasetConfig& config);

/// Reads the mesh that bin.mesh names, relative to the file that names it, or to the working directory where that is none.
/// Throws ConfigError, IoError.
void load_bin_mesh(DatasetConfig& config, const KeyPlaces& places);

/// Reads and checks a configuration file, for this tool version. Throws ConfigError with file:line:column, key, value
/// and what is valid.
DatasetConfig load_config(const std::string& path);
/// Throws ConfigError where values contradict each other; `places` says where each was set.
void check(const DatasetConfig& config, const KeyPlaces& places);
/// The same but for what only the version that runs, and this machine, must fit: of a data set that is there already.
void check_of_any_version(const DatasetConfig& config, const KeyPlaces& places);
/// The same of the values that the fields have, whatever is drawn for them.
void check_numbers(const DatasetConfig& config, const KeyPlaces& places);

/// The configuration as a file that load_config reads back to the same values.
std::string format_config(const DatasetConfig& config);

/// docs/configuration.md: every key with its default, unit, valid values and effect.
std::string document_config();

/// Keys whose values decide a scene's bytes and differ: "tube.radius: 0.0125 there, 0.01 here".
std::vector<std::string> differences(const DatasetConfig& there, const DatasetConfig& here);

/// `here` with the numbers of tubes and the cases of both, those of `there` first.
DatasetConfig unite(const DatasetConfig& there, DatasetConfig here);

/// "1,5,10-15" -> 1, 5, 10, 11, ..., 15. Throws ConfigError naming the part that is no number or range.
std::vector<int> parse_tube_counts(const std::string& text);

}  // namespace tubebin::dataset
