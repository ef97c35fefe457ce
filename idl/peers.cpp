#include "idl/peers.hpp"

#include <array>
#include <cstring>
#include <memory>

namespace collided::dds {

namespace {

struct EndpointDeleter {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const { dds_builtintopic_free_endpoint(endpoint); }
};
using Endpoint = std::unique_ptr<dds_builtintopic_endpoint_t, EndpointDeleter>;

std::uint64_t participant_of(const dds_builtintopic_endpoint_t& endpoint) {
  std::array<std::uint64_t, 2> halves{};
  static_assert(sizeof endpoint.participant_key.v == sizeof halves);
  std::memcpy(halves.data(), endpoint.participant_key.v, sizeof halves);
  // Mixed, since participants of one machine differ in only some bytes (Steele et al., SplitMix64).
  std::uint64_t mixed = halves[0] ^ (halves[1] * 0x9e3779b97f4a7c15);
  mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9;
  mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111eb;
  mixed ^= mixed >> 31;
  return mixed == 0 ? 1 : mixed;
}

std::string first_partition(const dds_qos_t* qos) {
  std::uint32_t count = 0;
  char** names = nullptr;
  if (!dds_qget_partition(qos, &count, &names)) return {};
  std::string first = count > 0 ? names[0] : "";
  for (std::uint32_t i = 0; i < count; ++i) dds_free(names[i]);
  dds_free(names);
  return first;
}

}  // namespace

std::uint64_t participant_of(dds_entity_t reader, dds_instance_handle_t writer) {
  const Endpoint endpoint(dds_get_matched_publication_data(reader, writer));
  return endpoint ? participant_of(*endpoint) : 0;
}

std::optional<WriterFacts> facts_of_writer(dds_entity_t reader, dds_instance_handle_t writer) {
  const Endpoint endpoint(dds_get_matched_publication_data(reader, writer));
  if (!endpoint) return std::nullopt;
  WriterFacts facts{.participant = participant_of(*endpoint), .partition = first_partition(endpoint->qos)};
  std::memcpy(facts.prefix.data(), endpoint->participant_key.v, facts.prefix.size());
  return facts;
}

}  // namespace collided::dds
