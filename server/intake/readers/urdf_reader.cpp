#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <pugixml.hpp>
#include <unordered_map>

#include "server/intake/file_bytes.hpp"
#include "server/intake/readers/robot_packages.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/srdf.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxLinks = 10'000;

Pose operator*(const Pose& parent, const Pose& child) {
  return {parent.position + parent.rotation * child.position, (parent.rotation * child.rotation).normalized()};
}

struct Joint {
  std::string parent;
  std::string child;
  Pose origin;
  bool moves = false;
};

/// Reads a robot: each link with a collision shape becomes an object, placed as with all joints at zero.
/// source    ROS URDF specification, wiki.ros.org/urdf/XML; units and axes: REP 103
class UrdfReader {
 public:
  explicit UrdfReader(const Reading& reading)
      : reading_(reading), packages_(reading.folder, reading.options.packages) {}

  Scene read() {
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(reading_.bytes.data(), reading_.bytes.size());
    if (!parsed) refuse_byte(reading_, static_cast<std::size_t>(parsed.offset), parsed.description());
    const pugi::xml_node robot = document.child("robot");
    if (!robot) refuse(reading_, "no <robot> in it");
    place_links(robot);
    for (const pugi::xml_node link : robot.children("link")) add_link(link);
    if (!missing_.empty()) {
      refuse(reading_,
             fmt::format("{} not there, the first is {}; {}",
                         missing_.size() == 1 ? "1 mesh file is" : fmt::format("{} mesh files are", missing_.size()),
                         in_quotes(missing_[0], kShownOfPath), packages_.advice(missing_[0])));
    }
    if (scene_.objects.empty()) refuse(reading_, "no link has a collision shape");
    allow_pairs_of_links();
    return std::move(scene_);
  }

 private:
  Pose origin_of(const pugi::xml_node& node) const {
    const pugi::xml_node origin = node.child("origin");
    if (!origin) return {};
    const Vec3 rpy = numbers(origin.attribute("rpy"), Vec3::Zero());
    const Quat rotation = Eigen::AngleAxisd(rpy[2], Vec3::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vec3::UnitY()) *
                          Eigen::AngleAxisd(rpy[0], Vec3::UnitX());
    return {numbers(origin.attribute("xyz"), Vec3::Zero()), rotation.normalized()};
  }

  /// The three numbers of an attribute; `otherwise` if it is missing.
  Vec3 numbers(const pugi::xml_attribute& attribute, const Vec3& otherwise) const {
    if (!attribute) return otherwise;
    const std::string_view text = attribute.value();
    const Reading inside{fmt::format("{}: attribute {} {}", reading_.file, attribute.name(), in_quotes(text)), text,
                         reading_.options, reading_.report};
    TextCursor cursor(inside, text, TextCursor::LineEnd::newline, false);
    Vec3 result;
    for (double& number : result) number = cursor.finite_number("number");
    return result;
  }

  double size(const pugi::xml_node& node, const char* name) const {
    const std::string_view text = node.attribute(name).value();
    const Reading inside{fmt::format("{}: <{}> {}", reading_.file, node.name(), name), text, reading_.options,
                         reading_.report};
    TextCursor cursor(inside, text, TextCursor::LineEnd::newline, false);
    const double value = cursor.finite_number("size");
    if (!(value > 0))
      refuse(reading_, fmt::format("<{}> {} is {} m, allowed are lengths above 0", node.name(), name, value));
    return value;
  }

  /// Places the links, along the tree of joints, starting with the links that are not the child of any.
  void place_links(const pugi::xml_node& robot) {
    std::unordered_map<std::string, std::vector<Joint>> joints_below;
    std::unordered_map<std::string, std::size_t> parent_counts;
    std::size_t link_count = 0;
    for (const pugi::xml_node link : robot.children("link")) {
      const auto [entry, is_new] = parent_counts.try_emplace(link.attribute("name").value(), 0);
      if (!is_new)
        refuse(reading_, fmt::format("two links have the name {}", in_quotes(std::string_view(entry->first))));
      if (++link_count > kMaxLinks) refuse(reading_, fmt::format("more than {} links", kMaxLinks));
    }
    for (const pugi::xml_node node : robot.children("joint")) {
      Joint joint{node.child("parent").attribute("link").value(), node.child("child").attribute("link").value(),
                  origin_of(node), std::string_view(node.attribute("type").value()) != "fixed"};
      for (const std::string* name : {&joint.parent, &joint.child}) {
        if (!parent_counts.contains(*name)) {
          refuse(reading_, fmt::format("joint {} names the link {}, which is not there",
                                       in_quotes(node.attribute("name").value()), in_quotes(std::string_view(*name))));
        }
      }
      if (++parent_counts[joint.child] > 1)
        refuse(reading_, fmt::format("link {} is the child of two joints", in_quotes(std::string_view(joint.child))));
      moving_joint_count_ += joint.moves ? 1 : 0;
      joints_below[joint.parent].push_back(std::move(joint));
    }
    std::vector<std::string> waiting;
    for (const auto& [name, count] : parent_counts) {
      if (count == 0) waiting.push_back(name);
    }
    for (const std::string& root : waiting) poses_[root] = {};
    while (!waiting.empty()) {
      const std::string parent = std::move(waiting.back());
      waiting.pop_back();
      for (const Joint& joint : joints_below[parent]) {
        poses_[joint.child] = poses_[parent] * joint.origin;
        waiting.push_back(joint.child);
      }
    }
    if (poses_.size() < link_count) refuse(reading_, "its joints form a ring");
  }

  void add_link(const pugi::xml_node& link) {
    SceneObject object;
    object.name = link.attribute("name").value();
    object.pose = poses_[object.name];
    auto mesh = std::make_shared<TriangleMesh>();
    for (const pugi::xml_node collision : link.children("collision")) {
      add_shape(collision.child("geometry"), origin_of(collision), object.shape, *mesh);
    }
    if (!mesh->triangles.empty()) object.shape.mesh = std::move(mesh);
    if (!object.shape.empty()) scene_.objects.push_back(std::move(object));
  }

  void add_shape(const pugi::xml_node& geometry, const Pose& pose, Shape& shape, TriangleMesh& mesh) {
    const Mat3 axes = pose.rotation.toRotationMatrix();
    if (const pugi::xml_node box = geometry.child("box")) {
      const Vec3 whole = numbers(box.attribute("size"), Vec3::Constant(-1));
      if (!(whole.array() > 0).all())
        refuse(reading_,
               fmt::format("<box> size is {} {} {} m, allowed are lengths above 0", whole[0], whole[1], whole[2]));
      shape.primitives.push_back(Box{.center = pose.position, .axes = axes, .half_m = whole / 2});
    } else if (const pugi::xml_node sphere = geometry.child("sphere")) {
      shape.primitives.push_back(Sphere{pose.position, size(sphere, "radius")});
    } else if (const pugi::xml_node cylinder = geometry.child("cylinder")) {
      const Vec3 half = axes.col(2) * (size(cylinder, "length") / 2);
      shape.primitives.push_back(Cylinder{pose.position - half, pose.position + half, size(cylinder, "radius")});
    } else if (const pugi::xml_node capsule = geometry.child("capsule")) {
      const Vec3 half = axes.col(2) * (size(capsule, "length") / 2);
      shape.primitives.push_back(Capsule{pose.position - half, pose.position + half, size(capsule, "radius")});
    } else if (const pugi::xml_node file = geometry.child("mesh")) {
      add_mesh(file, pose, mesh);
    } else {
      refuse(reading_, fmt::format("a collision geometry {}; read are box, sphere, cylinder, capsule and mesh",
                                   in_quotes(geometry.first_child().name())));
    }
  }

  void add_mesh(const pugi::xml_node& node, const Pose& pose, TriangleMesh& mesh) {
    const std::string name = node.attribute("filename").value();
    const fs::path path = packages_.find(name);
    if (path.empty()) {
      missing_.push_back(name);
      return;
    }
    const Vec3 scale = numbers(node.attribute("scale"), Vec3::Ones());
    LoadOptions options;
    options.unit_m = 1;
    options.up = 'z';
    options.max_triangles = reading_.options.max_triangles;
    options.cancelled = reading_.options.cancelled;
    LoadReport report;
    const Scene part = load_scene(path.string(), options, report);
    if (!part.objects.empty()) refuse(reading_, fmt::format("{} is no mesh", in_quotes(name, kShownOfPath)));
    for (const std::string& line : report.refused)
      reading_.report.refused.push_back(path.filename().string() + ": " + line);
    for (const std::string& line : report.warnings)
      reading_.report.warnings.push_back(path.filename().string() + ": " + line);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    triangle_count_ += part.mesh.triangles.size();
    check_triangle_count(reading_, triangle_count_);
    for (const Vec3& vertex : part.mesh.vertices) {
      mesh.vertices.push_back(pose.rotation * vertex.cwiseProduct(scale) + pose.position);
      if (!mesh.vertices.back().allFinite())
        refuse(reading_, fmt::format("{} is too large where it is placed", in_quotes(name, kShownOfPath)));
    }
    const bool mirrors = scale.prod() < 0;
    for (TriangleCorners corners : part.mesh.triangles) {
      if (mirrors) std::swap(corners[1], corners[2]);
      mesh.triangles.push_back({corners[0] + first, corners[1] + first, corners[2] + first});
    }
  }

  void allow_pairs_of_links() {
    LoadReport& report = reading_.report;
    if (moving_joint_count_ > 0)
      report.placed.push_back(moving_joint_count_ == 1 ? std::string("1 joint stands at 0")
                                                       : fmt::format("{} joints stand at 0", moving_joint_count_));
    if (reading_.options.srdf.empty()) {
      scene_.allowed_pairs = std::make_shared<const AllowedPairs>();  // allows every pair
      report.warnings.emplace_back(
          "the links never meet each other: without an SRDF file (--srdf) nothing says which of them may touch");
      return;
    }
    const FileBytes bytes(reading_.options.srdf, FileBytes::Access::copied, reading_.options);
    const LinkPairs pairs = read_srdf({bytes.bytes().data(), bytes.bytes().size()}, file_name(reading_.options.srdf));
    if (const std::uint64_t unknown_count = allow_pairs(pairs, scene_); unknown_count > 0) {
      report.warnings.push_back(fmt::format("{} of {} pairs in the SRDF file name a link without a collision shape",
                                            unknown_count, pairs.size()));
    }
  }

  const Reading& reading_;
  RobotPackages packages_;
  std::unordered_map<std::string, Pose> poses_;
  std::vector<std::string> missing_;
  std::uint64_t moving_joint_count_ = 0;
  std::uint64_t triangle_count_ = 0;  // of all links
  Scene scene_;
};

}  // namespace

Scene read_urdf(const Reading& reading) { return UrdfReader(reading).read(); }

}  // namespace collided::engine
