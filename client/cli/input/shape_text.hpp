#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

/// What `add` takes.
inline constexpr const char* kShapeForms =
    "shapes: sphere R, box X Y Z, capsule R L, cylinder R L, cone R H, ellipsoid X Y Z, plane [NX NY NZ],\n"
    "points FILE R, polyline FILE R, heights FILE DX [DY]";

/// sphere R | box X Y Z (full lengths) | capsule R L (L between the two centres, along z) | cylinder R L | cone R H |
/// ellipsoid X Y Z (full lengths) | plane [NX NY NZ] (solid behind it). Throws Failure.
ShapePart make_shape(std::string_view kind, const std::vector<double>& numbers);

/// "sphere:0.1", "box:0.4,0.4,0.4", "capsule:5cm,30cm".
ShapePart parse_shape(std::string_view text);

/// A pose from "--at", "--rpy" and "--quat" as written; empty texts leave the default.
Pose parse_pose(const std::string& at, const std::string& rpy, const std::string& quat);

}  // namespace collided::cli
