#pragma once

#include <cstdint>

#include "idl/dds.hpp"

namespace collided::dds {

/// A number for the participant behind a writer that the reader is matched with, the same for all its writers; 0: it is
/// matched no longer. Two participants of one domain have the same number with a chance of 1 in 2^64.
///
/// writer   publication_handle in the info of its samples
/// threads  any, DDS's callbacks too
std::uint64_t participant_of(dds_entity_t reader, dds_instance_handle_t writer);

}  // namespace collided::dds
