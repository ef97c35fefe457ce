#pragma once

#include <memory>

#include "idl/dds.hpp"
#include "server/service/ingest/samples.hpp"

namespace collided::engine::service {

/// A definition from the wire, copied for the world's thread. The shape stays encoded in `shape_bytes`, and no value is
/// checked: both are done on the world's thread.
std::unique_ptr<DefinitionSample> decoded(const wire::Definition& from);
/// Copies a pose batch into `sample`, except received_ns, which the caller sets. The vectors keep their memory. Columns
/// of different lengths set has_odd_columns and leave poses and velocities empty; no other value is checked.
void decode(const wire::PoseBatch& from, PoseSample& sample);

}  // namespace collided::engine::service
