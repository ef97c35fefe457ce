#pragma once

#include "server/service/server.hpp"

namespace collided::engine::service {

/// The places that servers of this program have: those of a fleet. A program that is built without the fleet
/// (COLLIDED_FLEET) makes the place of a server alone, and refuses the fleet's settings.
PlaceSource fleet_source();

}  // namespace collided::engine::service
