#pragma once

#include <memory>
#include <span>
#include <string>
#include <variant>

#include "server/geometry/mesh.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// The closed surface of an upright prism over a simple polygon, or why there is none.
///
/// corners  of the polygon, x and y in metres, in either direction around it
std::variant<std::shared_ptr<const TriangleMesh>, Refusal> upright_prism(std::span<const std::array<double, 2>> corners,
                                                                         double low_m, double high_m);

}  // namespace collided::engine::service
