#pragma once

#include <memory>

#include "idl/dds.hpp"
#include "server/service/ingest/samples.hpp"

namespace collided::engine::service {

/// A sample off the wire as the world's thread wants it; what it says is checked there.
std::unique_ptr<DefinitionSample> decoded(const wire::Definition& from);
/// Into vectors that are reused; received_ns is the caller's to set.
void decode(const wire::PoseBatch& from, PoseSample& sample);

}  // namespace collided::engine::service
