#include "idl/peers.hpp"

#include <array>
#include <cstring>

namespace collided::dds {

std::uint64_t participant_of(dds_entity_t reader, dds_instance_handle_t writer) {
  dds_builtintopic_endpoint_t* const endpoint = dds_get_matched_publication_data(reader, writer);
  if (endpoint == nullptr) return 0;
  std::array<std::uint64_t, 2> halves{};
  static_assert(sizeof endpoint->participant_key.v == sizeof halves);
  std::memcpy(halves.data(), endpoint->participant_key.v, sizeof halves);
  dds_builtintopic_free_endpoint(endpoint);
  // Mixed, since of one machine's participants only some bytes differ (Steele et al., SplitMix64).
  std::uint64_t mixed = halves[0] ^ (halves[1] * 0x9e3779b97f4a7c15);
  mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9;
  mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111eb;
  mixed ^= mixed >> 31;
  return mixed == 0 ? 1 : mixed;
}

}  // namespace collided::dds
