#pragma once

#include <collided/certificate.hpp>

#include "server/exact_phase/proof.hpp"

namespace collided::engine::service {

/// The proof as clients check it.
Certificate certificate_of(const Proof& proof);

}  // namespace collided::engine::service
