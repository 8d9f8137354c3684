// The elements are those of the published data set's .world files, without their plugins (which only their authors'
// Gazebo has) and without a <state>: the models' own poses are the settled ones.
#include <cmath>

#include "dataset/randomization.hpp"
#include "export/formats.hpp"
#include "export/published_layout.hpp"
#include "export/tube_mesh_file.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::exports {
namespace {

/// Stiffness (N/m), damping (N s/m) and contacts a pair of bodies, as in the published files. Gazebo derives ERP and
/// CFM of a contact from the first two.
constexpr double kStiffness = 1e6;
constexpr double kDamping = 1.0;
constexpr int kContactsMax = 10;

/// Elements within elements, indented.
class XmlWriter {
 public:
  template <typename Content>
  void element(const std::string& tag, const std::string& attributes, const Content& content) {
    line(fmt::format("<{}{}>", tag, attributes));
    ++depth_;
    content();
    --depth_;
    line(fmt::format("</{}>", tag));
  }
  template <typename Content>
  void element(const std::string& tag, const Content& content) {
    element(tag, "", content);
  }
  void text(const std::string& tag, const std::string& value) { line(fmt::format("<{0}>{1}</{0}>", tag, value)); }
  void number(const std::string& tag, double value) { text(tag, fmt::format("{:.9g}", value)); }
  void empty(const std::string& tag, const std::string& attributes = "") {
    line(fmt::format("<{}{}/>", tag, attributes));
  }
  void line(const std::string& line) { xml_ += std::string(2 * depth_, ' ') + line + "\n"; }
  const std::string& xml() const { return xml_; }

 private:
  std::string xml_;
  std::size_t depth_ = 0;
};

std::string named(const std::string& name) { return fmt::format(" name='{}'", name); }

std::string triple(const Vec3& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z()); }

/// "x y z roll pitch yaw": about the fixed axes x, y, z in that order, SDFormat's way.
std::string pose_text(const Pose& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  const bool is_upright = std::hypot(r(0, 0), r(1, 0)) < 1e-12;  // roll and yaw turn about the same axis
  const double roll = is_upright ? 0.0 : std::atan2(r(2, 1), r(2, 2));
  const double yaw = is_upright ? std::atan2(-r(0, 1), r(1, 1)) : std::atan2(r(1, 0), r(0, 0));
  return fmt::format("{} {:.12g} {:.12g} {:.12g}", triple(pose.translation()), roll, pitch, yaw);
}

/// Beside the world's file: how a tube that one can look into looks.
std::string mesh_path(const SceneEntry& entry, std::size_t k) {
  return published_path(entry, "gazebo_worlds", fmt::format("_{}.stl", k + 1));
}

std::string bin_mesh_path(const SceneEntry& entry, const scene::Bin& bin) {
  const std::string world = published_path(entry, "gazebo_worlds", ".world");
  return world.substr(0, world.rfind('/') + 1) + bin.mesh;
}

Pose at(const Vec3& position) { return make_pose(Quat::Identity(), position); }

/// SDFormat's cameras look along +x with z up, ours along +z with y down.
Pose camera_pose(const scene::Scanner& scanner) {
  Eigen::Matrix3d optical_from_sdf;
  optical_from_sdf << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Pose pose = scanner.world_from_scanner();
  pose.linear() = pose.linear() * optical_from_sdf;
  return pose;
}

class WorldWriter {
 public:
  WorldWriter(const SceneToExport& exported, const physics::PhysicsOptions& physics)
      : entry_(exported.entry), scene_(exported.record.scene), colors_(exported.record.colors), physics_(physics) {}

  std::string write() {
    out_.line("<?xml version='1.0'?>");
    out_.element("sdf", " version='1.7'", [&] {
      out_.element("world", named("default"), [&] {
        write_sensor();
        out_.text("gravity", triple({0, 0, -physics_.gravity}));
        out_.text("magnetic_field", "6e-06 2.3e-05 -4.2e-05");
        out_.empty("atmosphere", " type='adiabatic'");
        write_physics();
        write_look();
        write_bin();
        if (scene_.surroundings) write_surroundings();
        for (std::size_t k = 0; k < scene_.tubes.size(); ++k) write_tube(k);
      });
    });
    return out_.xml();
  }

 private:
  void write_sensor() {
    const scene::Scanner& scanner = scene_.scanner;
    out_.element("model", named("scanner"), [&] {
      out_.text("static", "1");
      out_.text("pose", pose_text(camera_pose(scanner)));
      out_.element("link", named("link"), [&] {
        out_.element("sensor", named("sensor") + " type='depth'", [&] {
          out_.text("update_rate", "30");
          out_.element("camera", [&] {
            out_.number("horizontal_fov", radians(scanner.horizontal_fov_deg));
            out_.element("image", [&] {
              out_.number("width", scanner.width);
              out_.number("height", scanner.height);
              out_.text("format", "B8G8R8");
            });
            out_.element("clip", [&] {
              out_.number("near", scanner.range_min);
              out_.number("far", scanner.range_max);
            });
            out_.element("depth_camera", [&] { out_.text("output", "points"); });
          });
        });
      });
    });
  }

  void write_physics() {
    out_.element("physics", " name='default_physics' default='0' type='ode'", [&] {
      out_.number("max_step_size", physics_.time_step);
      out_.text("real_time_factor", "1");
      out_.number("real_time_update_rate", std::round(1.0 / physics_.time_step));
      out_.text("max_contacts", "10000");
      out_.element("ode", [&] {
        out_.element("solver", [&] {
          out_.text("type", "quick");
          out_.number("iters", physics_.solver_iterations);
          out_.number("sor", physics_.solver_over_relaxation);
          out_.text("use_dynamic_moi_rescaling", "0");
        });
        out_.element("constraints", [&] {
          out_.number("contact_max_correcting_vel", physics_.correcting_speed_max);
          out_.number("contact_surface_layer", physics_.contact_layer);
          out_.number("cfm", physics_.contact_cfm);
          out_.number("erp", physics_.contact_erp);
        });
      });
    });
  }

  void write_look() {
    out_.element("scene", [&] {
      out_.text("ambient", "0.4 0.4 0.4 1");
      out_.text("background", "0.7 0.7 0.7 1");
      out_.text("shadows", "0");
    });
    out_.element("light", named("sun") + " type='directional'", [&] {
      out_.text("pose", "0 0 10 0 0 0");
      out_.text("diffuse", "0.8 0.8 0.8 1");
      out_.text("direction", "-0.3 0.2 -0.9");
    });
  }

  void write_bin() {
    // In the order of bin_parts().
    static constexpr const char* kNames[] = {"bottom", "west_wall", "east_wall", "south_wall", "north_wall"};
    const std::vector<scene::BinPart> parts = scene::bin_parts(scene_.bin);
    out_.element("model", named("bin"), [&] {
      out_.text("static", "1");
      if (scene_.bin.has_mesh()) write_bin_mesh();
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string name = i < std::size(kNames) ? kNames[i] : fmt::format("part_{}", i + 1);
        write_box(name, parts[i]);
      }
    });
  }

  void write_bin_mesh() {
    out_.element("link", named("mesh"), [&] {
      write_solid("mesh", Pose::Identity(), physics_.friction_bin, &colors_[0], [&] {
        out_.element("mesh", [&] {
          out_.text("uri", scene_.bin.mesh);
          out_.text("scale", triple(Vec3::Constant(scene_.bin.mesh_scale)));
        });
      });
    });
  }

  void write_surroundings() {
    const std::vector<scene::BinPart> boxes = scene::surrounding_boxes(scene_);
    const std::vector<scene::StandingCylinder> cylinders = scene::surrounding_cylinders(scene_);
    out_.element("model", named("surroundings"), [&] {
      out_.text("static", "1");
      for (std::size_t i = 0; i < boxes.size(); ++i) write_box(i == 0 ? "table" : fmt::format("box_{}", i), boxes[i]);
      for (std::size_t i = 0; i < cylinders.size(); ++i) {
        const std::string name = fmt::format("cylinder_{}", i + 1);
        const scene::StandingCylinder& cylinder = cylinders[i];
        out_.element("link", named(name), [&] {
          write_solid(name, at(cylinder.position + cylinder.height / 2.0 * Vec3::UnitZ()), physics_.friction_bin,
                      &colors_[0], [&] { write_cylinder_shape(cylinder.radius, cylinder.height); });
        });
      }
    });
  }

  void write_box(const std::string& name, const scene::BinPart& part) {
    const Pose pose = part.world_from_part * at(part.box.center());
    out_.element("link", named(name), [&] {
      write_solid(name, pose, physics_.friction_bin, &colors_[0],
                  [&] { out_.element("box", [&] { out_.text("size", triple(part.box.sizes())); }); });
    });
  }

  void write_cylinder_shape(double radius, double length) {
    out_.element("cylinder", [&] {
      out_.number("radius", radius);
      out_.number("length", length);
    });
  }

  void write_tube(std::size_t k) {
    const scene::PlacedTube& placed = scene_.tubes[k];
    const tube::Tube& tube = placed.tube;
    const std::string name = std::to_string(k + 1);
    out_.element("model", named(name), [&] {
      out_.text("static", "0");
      out_.text("pose", pose_text(placed.world_from_tube));
      out_.element("link", named(name), [&] {
        write_inertial(tube);
        const tube::TubeSolids solids = tube::tube_solids(tube, tube.nodes);
        const bool is_open = solids.has_open_end();  // SDFormat's shapes have no bore: the mesh is what one sees
        const cloud::Color* color = is_open ? nullptr : &colors_[k + 1];
        for (std::size_t i = 0; i < solids.cylinders.size(); ++i) write_cylinder(solids.cylinders[i], i + 1, color);
        for (const tube::JointSphere& joint : solids.joints) write_joint(joint, color);
        if (is_open) write_mesh(k);
      });
    });
  }

  void write_inertial(const tube::Tube& tube) {
    if (tube.mass <= 0.0) return;  // unknown: Gazebo's own default
    const tube::MassProperties body = tube::mass_properties(tube);
    out_.element("inertial", [&] {
      out_.text("pose", pose_text(at(body.center)));
      out_.number("mass", body.mass);
      out_.element("inertia", [&] {
        static constexpr const char* kAxes = "xyz";
        for (int i = 0; i < 3; ++i)
          for (int j = i; j < 3; ++j) out_.number(fmt::format("i{}{}", kAxes[i], kAxes[j]), body.inertia(i, j));
      });
    });
  }

  void write_cylinder(const tube::SolidCylinder& cylinder, std::size_t number, const cloud::Color* color) {
    const Vec3 axis = cylinder.b - cylinder.a;
    const Pose pose = make_pose(Quat::FromTwoVectors(Vec3::UnitZ(), axis), 0.5 * (cylinder.a + cylinder.b));
    write_solid(fmt::format("cylinder-{}", number), pose, physics_.friction_tube, color,
                [&] { write_cylinder_shape(cylinder.radius, axis.norm()); });
  }

  void write_joint(const tube::JointSphere& joint, const cloud::Color* color) {
    write_solid(fmt::format("sphere-{}", joint.node + 1), at(joint.center), physics_.friction_tube, color,
                [&] { out_.element("sphere", [&] { out_.number("radius", joint.radius); }); });
  }

  void write_mesh(std::size_t k) {
    const std::string path = mesh_path(entry_, k);
    write_visual("mesh", Pose::Identity(), colors_[k + 1],
                 [&] { out_.element("mesh", [&] { out_.text("uri", path.substr(path.rfind('/') + 1)); }); });
  }

  /// A shape to collide with and, where `color` is given, to look at.
  template <typename Shape>
  void write_solid(const std::string& name, const Pose& pose, double friction, const cloud::Color* color,
                   const Shape& shape) {
    out_.element("collision", named("collision-" + name), [&] {
      out_.text("pose", pose_text(pose));
      out_.element("geometry", shape);
      write_surface(friction);
      out_.number("max_contacts", kContactsMax);
    });
    if (color != nullptr) write_visual(name, pose, *color, shape);
  }

  template <typename Shape>
  void write_visual(const std::string& name, const Pose& pose, cloud::Color color, const Shape& shape) {
    out_.element("visual", named("visual-" + name), [&] {
      out_.text("pose", pose_text(pose));
      out_.element("geometry", shape);
      const std::string rgba = fmt::format("{:.3g} {:.3g} {:.3g} 1", (color >> 16 & 0xFF) / 255.0,
                                           (color >> 8 & 0xFF) / 255.0, (color & 0xFF) / 255.0);
      out_.element("material", [&] {
        out_.text("ambient", rgba);
        out_.text("diffuse", rgba);
      });
    });
  }

  void write_surface(double friction) {
    out_.element("surface", [&] {
      out_.element("friction", [&] {
        out_.element("ode", [&] {
          out_.number("mu", friction);
          out_.number("mu2", friction);
        });
      });
      out_.element("contact", [&] {
        out_.element("ode", [&] {
          out_.number("kp", kStiffness);
          out_.number("kd", kDamping);
          out_.number("max_vel", physics_.correcting_speed_max);
          out_.number("min_depth", physics_.contact_layer);
        });
      });
    });
  }

  const SceneEntry& entry_;
  const scene::Scene& scene_;
  const std::vector<cloud::Color>& colors_;
  const physics::PhysicsOptions& physics_;
  XmlWriter out_;
};

class SdfFormat : public ExportFormat {
 public:
  explicit SdfFormat(dataset::DatasetConfig config) : config_(std::move(config)) {}

  std::string scene_path(const SceneEntry& entry) const override {
    return published_path(entry, "gazebo_worlds", ".world");
  }

  SceneFiles export_scene(const SceneToExport& scene) const override {
    const dataset::DatasetConfig drawn = dataset::with_numbers(config_, scene.record.drawn);
    SceneFiles files{.beside = {}, .scene = {{"", WorldWriter(scene, drawn.physics).write()}}};
    const std::vector<scene::PlacedTube>& tubes = scene.record.scene.tubes;
    for (std::size_t k = 0; k < tubes.size(); ++k)
      if (tubes[k].solids_in_world().has_open_end()) files.beside[mesh_path(scene.entry, k)] = tube_stl(tubes[k].tube);
    const scene::Bin& bin = scene.record.scene.bin;
    if (bin.surface) files.beside[bin_mesh_path(scene.entry, bin)] = bin.surface->stl;
    return files;
  }

 private:
  dataset::DatasetConfig config_;
};

}  // namespace

std::unique_ptr<ExportFormat> sdf_format(const dataset::DatasetConfig& config) {
  return std::make_unique<SdfFormat>(config);
}

}  // namespace tubebin::exports
