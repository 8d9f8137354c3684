#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json_reader.hpp"
#include "core/png.hpp"
#include "export/formats.hpp"
#include "export/object_numbers.hpp"
#include "tubebin/core/atomic_file.hpp"

namespace tubebin::exports {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAnnotations = "annotations.json";
constexpr const char* kImage = "image.png";

/// COCO's run lengths: down the columns, first those outside.
Json run_lengths(const Mask& mask) {
  const auto width = static_cast<std::uint32_t>(mask.width), height = static_cast<std::uint32_t>(mask.height);
  std::vector<std::uint32_t> places;  // inside, counted down the columns
  for (const std::uint32_t pixel : mask.pixels) places.push_back(pixel % width * height + pixel / width);
  std::ranges::sort(places);
  Json counts = Json::array();
  std::uint32_t run_end = 0;  // of the last run inside
  for (std::size_t i = 0; i < places.size();) {
    std::uint32_t run = 1;
    while (i + run < places.size() && places[i + run] == places[i] + run) ++run;
    counts.push_back(places[i] - run_end);
    counts.push_back(run);
    run_end = places[i] + run;
    i += run;
  }
  if (run_end < width * height) counts.push_back(width * height - run_end);
  return {{"size", {mask.height, mask.width}}, {"counts", std::move(counts)}};
}

Json box_json(const Mask& mask) {
  const PixelBox box = box_of(mask);
  return {box.x, box.y, box.width, box.height};
}

Json image_json(const SceneEntry& entry, const SceneImage& image) {
  return {{"id", entry.number},
          {"file_name", entry.name + "/" + kImage},
          {"width", image.width()},
          {"height", image.height()},
          {"scene", entry.name}};
}

Json annotation_json(const SceneEntry& entry, std::size_t k, const Mask& visible, const Mask& whole) {
  return {{"id", entry.first_tube + static_cast<int>(k)},
          {"image_id", entry.number},
          {"category_id", entry.tubes[k].kind},
          {"iscrowd", 0},
          {"area", visible.pixels.size()},
          {"bbox", box_json(visible)},
          {"segmentation", run_lengths(visible)},
          {"label", k + 1},
          {"amodal_bbox", box_json(whole)},
          {"amodal_area", whole.pixels.size()},
          {"amodal_segmentation", run_lengths(whole)}};
}

/// The kinds of a scene's tubes, each once.
Json categories_json(const SceneToExport& scene) {
  std::map<int, std::string> names;
  for (std::size_t k = 0; k < scene.entry.tubes.size(); ++k)
    names[scene.entry.tubes[k].kind] = identify(scene.record.scene.tubes[k].tube).kind;
  Json categories = Json::array();
  for (const auto& [kind, name] : names)
    categories.push_back({{"id", kind}, {"name", name}, {"supercategory", "object"}});
  return categories;
}

class CocoFormat : public ExportFormat {
 public:
  explicit CocoFormat(ImageRegion region) : region_(region) {}

  std::string scene_path(const SceneEntry& entry) const override { return entry.name; }

  SceneFiles export_scene(const SceneToExport& scene) const override {
    const SceneImage image(scene, region_);
    const auto views = scan::view_tubes_alone(scene.record.scene);
    const std::vector<Mask> visible = image.visible_masks();
    Json annotations = Json::array();
    for (std::size_t k = 0; k < views.size(); ++k)
      if (!visible[k].pixels.empty())  // COCO has no instances that nothing shows
        annotations.push_back(annotation_json(scene.entry, k, visible[k], image.mask_of(views[k])));
    SceneFiles files;
    files.scene[kImage] = encode_rgb_png(image.shaded_rgb(), image.width(), image.height());
    files.scene[kAnnotations] =
        document(categories_json(scene), Json::array({image_json(scene.entry, image)}), annotations);
    return files;
  }

  Files summarize(const std::vector<SceneEntry>& entries, const std::string& output) const override {
    Json images = Json::array(), annotations = Json::array();
    std::map<int, Json> categories;
    for (const SceneEntry& entry : entries) {
      const Json scene = read_json(output + "/" + scene_path(entry) + "/" + kAnnotations);
      for (const Json& category : scene.at("categories")) categories[category.at("id").get<int>()] = category;
      images.insert(images.end(), scene.at("images").begin(), scene.at("images").end());
      annotations.insert(annotations.end(), scene.at("annotations").begin(), scene.at("annotations").end());
    }
    Json all_categories = Json::array();
    for (const auto& [kind, category] : categories) all_categories.push_back(category);
    return {{kAnnotations, document(all_categories, images, annotations)}};
  }

 private:
  static std::string document(const Json& categories, const Json& images, const Json& annotations) {
    return Json{{"info", {{"description", "Entangled tubes in a bin, by tubebin"}, {"version", TUBEBIN_VERSION}}},
                {"licenses", Json::array()},
                {"categories", categories},
                {"images", images},
                {"annotations", annotations}}
               .dump() +
           "\n";
  }

  ImageRegion region_;
};

}  // namespace

std::unique_ptr<ExportFormat> coco_format(ImageRegion region) { return std::make_unique<CocoFormat>(region); }

}  // namespace tubebin::exports
