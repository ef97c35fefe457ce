#pragma once

#include "collided/client.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// A row of a column with three numbers per row.
inline Vec3 vector_in(const dds_sequence_double& column, std::size_t row) {
  return {column._buffer[3 * row], column._buffer[3 * row + 1], column._buffer[3 * row + 2]};
}

}  // namespace collided::client
