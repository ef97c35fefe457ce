#include <unordered_set>

#include "client/library/connection/errors.hpp"
#include "collided/robot.hpp"

// What-if questions about a robot's joint positions.
namespace collided {

Result<RobotObjects> robot_objects(Client& client, const Robot& robot, const std::string& scene) {
  const std::string stem = (scene.empty() ? robot.name() : scene) + "/";
  const Result<ObjectList> listed = client.list({.name = stem + "*", .limit = 1'000'000});
  if (!listed) return listed.error();
  std::unordered_set<std::string> there;
  for (const ListedObject& object : listed->objects) there.insert(object.name);
  RobotObjects found;
  for (std::size_t link = 0; link < robot.links().size(); ++link) {
    std::string name = stem + robot.links()[link];
    if (!there.contains(name)) continue;
    found.links.push_back(link);
    found.names.push_back(std::move(name));
  }
  if (!found.links.empty()) return found;
  return Error{ErrorCode::refused, "no link of robot '" + robot.name() + "' is in the world as '" + stem + "LINK'",
               "load it as a scene that moves: collide load FILE --moving"};
}

Result<WhatIfAnswers> what_if(Client& client, const Robot& robot, const JointConfigurations& configurations,
                              const RobotPlace& place, const WhatIfOptions& options) {
  const std::size_t width = configurations.joints.size();
  const std::vector<double>& given = configurations.positions;
  if (width == 0 || given.empty() || given.size() % width != 0) {
    return client::bad_input("what-if: " + std::to_string(given.size()) + " positions for " + std::to_string(width) +
                             " joints; a configuration has one for each joint that is named");
  }
  const Result<RobotObjects> objects = robot_objects(client, robot, place.scene);
  if (!objects) return objects.error();
  WhatIfConfigurations asked{.objects = objects->names, .poses = {}};
  asked.poses.reserve(given.size() / width * objects->links.size());
  std::vector<JointValue> values;
  for (const std::string& joint : configurations.joints) values.push_back({.name = joint});
  std::vector<double> positions;
  for (std::size_t first = 0; first < given.size(); first += width) {
    for (std::size_t i = 0; i < width; ++i) values[i].position = given[first + i];
    const Result<std::vector<std::string>> set = robot.set(values, positions, place.beyond_limits);
    if (!set) {
      return client::bad_input("what-if: configuration " + std::to_string(first / width) + ": " + set.error().message,
                               set.error().hint);
    }
    const std::vector<Pose> poses = robot.link_poses(positions, place.base);
    for (const std::size_t link : objects->links) asked.poses.push_back(poses[link]);
  }
  return client.what_if(asked, options);
}

}  // namespace collided
