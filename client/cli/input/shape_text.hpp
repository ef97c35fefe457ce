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

/// The same for the help: lengths in metres or with a unit, an object's own axes, its centre at the origin.
inline constexpr const char* kShapeTable =
    "  sphere R                  a ball\n"
    "  box X Y Z                 full lengths\n"
    "  capsule R L               a ball drawn along z, L between its two centres\n"
    "  cylinder R L              along z\n"
    "  cone R H                  along z, the tip up\n"
    "  ellipsoid X Y Z           full lengths\n"
    "  plane [NX NY NZ]          solid behind it; the normal is z where none is given\n"
    "  points FILE R             balls about points\n"
    "  polyline FILE R           lines with a thickness\n"
    "  heights FILE DX [DY]      heights on a grid\n";

/// sphere R | box X Y Z (full lengths) | capsule R L (L between the two centres, along z) | cylinder R L | cone R H |
/// ellipsoid X Y Z (full lengths) | plane [NX NY NZ] (solid behind it). Throws Failure.
ShapePart make_shape(std::string_view kind, const std::vector<double>& numbers);

/// "sphere:0.1", "box:0.4,0.4,0.4", "capsule:5cm,30cm".
ShapePart parse_shape(std::string_view text);

/// A warning for angles of more than a whole turn that were given without a unit, so in radians, though degrees are meant
/// surely; empty where there is nothing to say.
std::string angle_warning(std::string_view option, const std::string& angles);

/// A pose from "--at", "--rpy" and "--quat" as written; empty texts leave the default.
Pose parse_pose(const std::string& at, const std::string& rpy, const std::string& quat);

}  // namespace collided::cli
