#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

/// The shapes of `add`, for errors.
inline constexpr const char* kShapeForms =
    "shapes: sphere R, box X Y Z, capsule R L, cylinder R L, cone R H, ellipsoid X Y Z, plane [NX NY NZ],\n"
    "points FILE R, polyline FILE R, heights FILE DX [DY], mesh FILE, hull FILE";

/// The same for the help. Lengths are in metres or have a unit; axes are the object's own, with its centre at the
/// origin.
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
    "  heights FILE DX [DY]      heights on a grid\n"
    "  mesh FILE                 the triangles of a file that `collide check` reads\n"
    "  hull FILE                 the convex hull of its points\n";

/// Makes a shape: sphere R | box X Y Z (full lengths) | capsule R L (L between the two centres, along z) | cylinder R L
/// | cone R H | ellipsoid X Y Z (full lengths) | plane [NX NY NZ] (solid behind it). Throws Failure.
ShapePart make_shape(std::string_view kind, const std::vector<double>& numbers);

/// The same from one text: "sphere:0.1", "box:0.4,0.4,0.4", "capsule:5cm,30cm".
ShapePart parse_shape(std::string_view text);

/// A warning if an angle without a unit, thus in radians, is more than a full turn, since degrees must be meant. Else
/// empty.
std::string angle_warning(std::string_view option, const std::string& angles);

/// The pose that the texts of "--at", "--rpy" and "--quat" give; an empty text leaves the default. Throws Failure.
Pose parse_pose(const std::string& at, const std::string& rpy, const std::string& quat);

}  // namespace collided::cli
