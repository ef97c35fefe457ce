#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/exact_phase/proof.hpp"

namespace collided::engine::service {

/// JSON has no infinity; it is written as the text "inf".
nlohmann::json number_or_inf(double value);

/// A proof as the member `certificate` of an answer: client/library/asking/certificate_decoding.hpp reads it.
nlohmann::json certificate_json(const Proof& proof);

}  // namespace collided::engine::service
