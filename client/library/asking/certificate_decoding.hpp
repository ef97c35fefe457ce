#pragma once

#include <nlohmann/json_fwd.hpp>

#include "collided/certificate.hpp"

namespace collided::client {

/// A number of an answer; "inf" is a text, since JSON has no infinity.
double number_or_inf(const nlohmann::json& value);

/// The certificate of an answer to `pair` or `clearance`. Throws nlohmann::json::exception where it is none.
Certificate certificate_of(const nlohmann::json& value);

}  // namespace collided::client
