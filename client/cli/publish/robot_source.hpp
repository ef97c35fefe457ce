#pragma once

#include <memory>
#include <string>

#include "client/cli/io.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

/// A robot and the positions of its joints.
struct RobotSourceOptions {
  std::string robot_path;    // the URDF, on this machine; the server reads it too if the robot is not in the world
  std::string joints_path;   // "-": stdin
  std::string scene;         // name of the robot's scene; empty: the stem of its file
  std::string package = {};  // "NAME=DIR", the folder of a package that the robot's file names; empty: none
  Pose base = {};
  LostPolicy lost_policy = LostPolicy::freeze;
  bool beyond_limits = false;
  bool paced = false;  // a rate was given, so the rows need no times
};

/// A source that moves the links of a robot by a table of joint positions; each row is a frame. A robot that is not in
/// the world is loaded as moving, and stays there. Throws Failure if robot or table cannot be read.
std::unique_ptr<MotionSource> make_robot_source(Io& io, const RobotSourceOptions& options);

}  // namespace collided::cli
