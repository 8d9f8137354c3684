#include <nlohmann/json.hpp>

#include "core/json_reader.hpp"
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
  Json counts = Json::array();
  bool inside = false;
  std::size_t run = 0;
  for (int column = 0; column < mask.width; ++column)
    for (int row = 0; row < mask.height; ++row) {
      const auto i =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(mask.width) + static_cast<std::size_t>(column);
      if ((mask.values[i] != 0) != inside) {
        counts.push_back(run);
        run = 0;
        inside = !inside;
      }
      ++run;
    }
  counts.push_back(run);
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
  const std::size_t seen = pixels_of(visible), all = pixels_of(whole);
  return {{"id", entry.first_tube + static_cast<int>(k)},
          {"image_id", entry.number},
          {"category_id", entry.tubes[k].kind},
          {"iscrowd", 0},
          {"area", seen},
          {"bbox", box_json(visible)},
          {"segmentation", run_lengths(visible)},
          {"label", k + 1},
          {"amodal_bbox", box_json(whole)},
          {"amodal_area", all},
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
    Json annotations = Json::array();
    for (std::size_t k = 0; k < views.size(); ++k) {
      const Mask visible = image.visible_mask(static_cast<cloud::Label>(k + 1));
      if (pixels_of(visible) == 0) continue;  // COCO has no instances that nothing shows
      annotations.push_back(annotation_json(scene.entry, k, visible, image.mask_of(views[k])));
    }
    SceneFiles files;
    files.scene[kImage] = png_of_rgb(image.shaded_rgb(), image.width(), image.height());
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
