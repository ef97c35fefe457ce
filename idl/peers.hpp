#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "idl/dds.hpp"
#include "idl/dds_proven_peers.hpp"

namespace collided::dds {

/// A number for the participant of a writer that the reader is matched with, the same for all its writers; 0: no longer
/// matched. Two participants of a domain have the same number with a probability of 2^-64.
///
/// writer   publication_handle in the info of its samples
/// threads  any, DDS's callbacks too
std::uint64_t participant_of(dds_entity_t reader, dds_instance_handle_t writer);

/// Facts about a matched writer.
struct WriterFacts {
  std::uint64_t participant = 0;  // as from participant_of()
  GuidPrefix prefix{};
  std::string partition;  // the first of its partitions; empty: the default one
};
/// None if it is no longer matched.
std::optional<WriterFacts> facts_of_writer(dds_entity_t reader, dds_instance_handle_t writer);

}  // namespace collided::dds
