#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <unordered_map>

#include <pugixml.hpp>

#include "client/library/connection/errors.hpp"
#include "collided/robot.hpp"

namespace collided {
namespace {

constexpr std::size_t kMostLinks = 10'000;
constexpr std::streamoff kMostBytes = 64 << 20;

/// The fault of a text, without its source.
struct Fault {
  std::string what;
};

std::string quote(const std::string& text) {
  constexpr std::size_t kMost = 100;
  std::string quoted = "'";
  quoted.append(text, 0, kMost);
  if (text.size() > kMost) quoted += "...";
  return quoted += '\'';
}

/// Reads exactly `count` finite numbers separated by blanks.
std::vector<double> numbers_in(const std::string& text, std::size_t count, const std::string& where) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto skip_blanks = [&] {
    while (at != end && std::string_view(" \t\r\n").find(*at) != std::string_view::npos) ++at;
  };
  for (skip_blanks(); at != end; skip_blanks()) {
    if (*at == '+') ++at;  // from_chars refuses it
    double number = 0;
    const auto [after, error] = std::from_chars(at, end, number);
    if (error != std::errc() || !std::isfinite(number)) throw Fault{where + ": " + quote(text) + " is not numbers"};
    numbers.push_back(number);
    at = after;
  }
  if (numbers.size() != count) {
    throw Fault{where + ": " + quote(text) + " has " + std::to_string(numbers.size()) + " numbers, " +
                std::to_string(count) + " are needed"};
  }
  return numbers;
}

Vec3 vector_in(const pugi::xml_attribute& attribute, const Vec3& otherwise, const std::string& where) {
  if (!attribute) return otherwise;
  const std::vector<double> numbers = numbers_in(attribute.value(), 3, where + " " + attribute.name());
  return {numbers[0], numbers[1], numbers[2]};
}

double number_in(const pugi::xml_attribute& attribute, double otherwise, const std::string& where) {
  return attribute ? numbers_in(attribute.value(), 1, where + " " + attribute.name())[0] : otherwise;
}

Pose origin_in(const pugi::xml_node& node, const std::string& where) {
  const pugi::xml_node origin = node.child("origin");
  const Vec3 rpy = vector_in(origin.attribute("rpy"), Vec3::Zero(), where + ": origin");
  const Quat rotation = Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) *
                        Eigen::AngleAxisd(rpy.x(), Vec3::UnitX());
  return {vector_in(origin.attribute("xyz"), Vec3::Zero(), where + ": origin"), rotation.normalized()};
}

}  // namespace

/// Makes a Robot from its description. Throws Fault.
class RobotReader {
 public:
  Robot read(const pugi::xml_node& robot) {
    made_.name_ = robot.attribute("name").value();
    std::unordered_map<std::string, std::size_t> numbers;  // of links, in the file's order
    std::vector<std::string> names;
    for (const pugi::xml_node link : robot.children("link")) {
      const std::string name = link.attribute("name").value();
      if (!numbers.emplace(name, names.size()).second) throw Fault{"two links have the name " + quote(name)};
      names.push_back(name);
      if (names.size() > kMostLinks) throw Fault{"more than " + std::to_string(kMostLinks) + " links"};
    }
    if (names.empty()) throw Fault{"it has no link"};
    for (const pugi::xml_node node : robot.children("joint")) read_joint(node, numbers);
    put_in_order(names);
    follow();
    return std::move(made_);
  }

 private:
  void read_joint(const pugi::xml_node& node, const std::unordered_map<std::string, std::size_t>& links) {
    RobotJoint joint;
    joint.name = node.attribute("name").value();
    const std::string where = "joint " + quote(joint.name);
    const auto link_of = [&](const char* end) {
      const std::string name = node.child(end).attribute("link").value();
      const auto found = links.find(name);
      if (found == links.end()) throw Fault{where + ": it names the link " + quote(name) + ", which is not there"};
      return found->second;
    };
    joint.parent = link_of("parent");
    joint.child = link_of("child");
    joint.kind = kind_of(node, where);
    joint.origin = origin_in(node, where);
    if (joint.kind != JointKind::fixed) read_motion(node, where, joint);
    if (const pugi::xml_node mimic = node.child("mimic"); mimic && joint.kind != JointKind::fixed) {
      joint.mimic = RobotJoint::Mimic{.multiplier = number_in(mimic.attribute("multiplier"), 1, where + ": mimic"),
                                      .offset = number_in(mimic.attribute("offset"), 0, where + ": mimic")};
      leaders_.emplace(joint.name, mimic.attribute("joint").value());
    }
    if (!names_.emplace(joint.name, 0).second) throw Fault{"two joints have the name " + quote(joint.name)};
    made_.joints_.push_back(std::move(joint));
  }

  static JointKind kind_of(const pugi::xml_node& node, const std::string& where) {
    const std::string type = node.attribute("type").value();
    if (type == "fixed") return JointKind::fixed;
    if (type == "revolute") return JointKind::revolute;
    if (type == "continuous") return JointKind::continuous;
    if (type == "prismatic") return JointKind::prismatic;
    throw Fault{where + ": its type is " + quote(type) + "; allowed: fixed, revolute, continuous, prismatic"};
  }

  static void read_motion(const pugi::xml_node& node, const std::string& where, RobotJoint& joint) {
    const Vec3 axis = vector_in(node.child("axis").attribute("xyz"), Vec3::UnitX(), where + ": axis");
    const double length = axis.stableNorm();
    if (!(length > 0) || !std::isfinite(length)) throw Fault{where + ": its axis has no direction"};
    joint.axis = axis / length;
    if (joint.kind == JointKind::continuous) return;
    const pugi::xml_node limit = node.child("limit");
    if (!limit) throw Fault{where + ": it has no <limit>, which this type of joint needs"};
    joint.lower = number_in(limit.attribute("lower"), 0, where + ": limit");
    joint.upper = number_in(limit.attribute("upper"), 0, where + ": limit");
    if (joint.lower > joint.upper) throw Fault{where + ": its lower limit is above the upper one"};
  }

  /// Numbers links from the root, and joints by their children.
  void put_in_order(const std::vector<std::string>& names) {
    std::vector<std::vector<std::size_t>> joints_below(names.size());
    std::vector<int> parents(names.size());
    for (std::size_t i = 0; i < made_.joints_.size(); ++i) {
      const RobotJoint& joint = made_.joints_[i];
      if (++parents[joint.child] > 1) throw Fault{"link " + quote(names[joint.child]) + " is the child of two joints"};
      joints_below[joint.parent].push_back(i);
    }
    std::vector<std::size_t> order, number(names.size());
    for (std::size_t link = 0; link < names.size(); ++link) {
      if (parents[link] == 0) order.push_back(link);
    }
    if (order.empty()) throw Fault{"its joints form a ring"};
    if (order.size() > 1) {
      throw Fault{"links " + quote(names[order[0]]) + " and " + quote(names[order[1]]) +
                  " have no parent both; a robot has one root"};
    }
    std::vector<RobotJoint> joints;
    for (std::size_t at = 0; at < order.size(); ++at) {
      number[order[at]] = at;
      made_.links_.push_back(names[order[at]]);
      for (const std::size_t i : joints_below[order[at]]) {
        joints.push_back(std::move(made_.joints_[i]));
        order.push_back(joints.back().child);
      }
    }
    if (order.size() < names.size()) throw Fault{"its joints form a ring"};
    for (RobotJoint& joint : joints) joint.parent = number[joint.parent], joint.child = number[joint.child];
    made_.joints_ = std::move(joints);
  }

  /// Finds the joints that others follow.
  void follow() {
    for (std::size_t i = 0; i < made_.joints_.size(); ++i) names_[made_.joints_[i].name] = i;
    for (RobotJoint& joint : made_.joints_) {
      if (!joint.mimic) continue;
      const std::string& leader = leaders_.at(joint.name);
      const auto found = names_.find(leader);
      if (found == names_.end())
        throw Fault{"joint " + quote(joint.name) + ": it follows " + quote(leader) + ", which is no joint"};
      joint.mimic->joint = found->second;
    }
    for (std::size_t start = 0; start < made_.joints_.size(); ++start) {
      std::size_t steps = 0;
      for (std::size_t at = start; made_.joints_[at].mimic; at = made_.joints_[at].mimic->joint) {
        if (++steps > made_.joints_.size())
          throw Fault{"joint " + quote(made_.joints_[start].name) + ": the joints that it follows form a ring"};
      }
    }
  }

  Robot made_;
  std::unordered_map<std::string, std::string> leaders_;
  std::unordered_map<std::string, std::size_t> names_;
};

Result<Robot> Robot::parse(std::string_view urdf, const std::string& source) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(urdf.data(), urdf.size());
  if (!parsed) {
    return client::bad_input(source + ": byte " + std::to_string(parsed.offset) + ": " + parsed.description(),
                             "no robot was read");
  }
  const pugi::xml_node robot = document.child("robot");
  if (!robot) return client::bad_input(source + ": no <robot> in it", "no robot was read");
  try {
    return RobotReader().read(robot);
  } catch (const Fault& fault) { return client::bad_input(source + ": " + fault.what, "no robot was read"); }
}

Result<Robot> Robot::read(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  if (!file || size < 0) return client::bad_input(path + ": it cannot be read", "no robot was read");
  if (size > kMostBytes) {
    return client::bad_input(
        path + ": it has " + std::to_string(size) + " bytes, allowed " + std::to_string(kMostBytes),
        "no robot was read");
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(text.data(), size)) return client::bad_input(path + ": it cannot be read", "no robot was read");
  return parse(text, path);
}

}  // namespace collided
