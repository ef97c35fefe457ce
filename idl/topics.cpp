#include "idl/topics.hpp"

#include <algorithm>
#include <stdexcept>

namespace collided::wire_contract {
namespace {

bool starts_a_name(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '/'; }
bool continues_a_name(char c) { return starts_a_name(c) || (c >= '0' && c <= '9'); }

// A bijection in which every output bit depends on every input bit, so that sums of its values distinguish single
// pairs. Source: Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014 (variant 13 of the
// finaliser).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

}  // namespace

std::string topic_name(std::string_view name_space, const TopicQos& topic) {
  const bool good = !name_space.empty() && starts_a_name(name_space.front()) &&
                    std::all_of(name_space.begin(), name_space.end(), continues_a_name);
  if (!good) {
    throw std::invalid_argument("namespace '" + std::string(name_space) +
                                "': only letters, digits, '_' and '/' are allowed, and no digit first");
  }
  return std::string(name_space) + '/' + topic.suffix;
}

std::string reply_partition(std::uint64_t client) {
  constexpr char kDigits[] = "0123456789abcdef";
  const std::uint32_t place = reply_place(client);
  static_assert(kReplyPartitions == 256);
  return std::string("client_") + kDigits[place >> 4] + kDigits[place & 15];
}

std::string replica_namespace(std::string_view name_space, std::string_view member) {
  std::string name = std::string(name_space) + "/replica_";
  for (const char letter : member) name += continues_a_name(letter) && letter != '/' ? letter : '_';
  return name;
}

std::vector<std::uint8_t> pack_names(std::span<const std::string> names) {
  std::vector<std::uint8_t> packed;
  for (const std::string& name : names) {
    packed.insert(packed.end(), name.begin(), name.end());
    packed.push_back(0);
  }
  return packed;
}

std::vector<std::string_view> unpack_names(std::span<const std::uint8_t> packed) {
  std::vector<std::string_view> names;
  const std::uint8_t* first = packed.data();
  const std::uint8_t* const end = first + packed.size();
  while (first != end) {
    const std::uint8_t* const zero = std::find(first, end, std::uint8_t{0});
    if (zero == end) { break; }
    names.emplace_back(reinterpret_cast<const char*>(first), static_cast<std::size_t>(zero - first));
    first = zero + 1;
  }
  return names;
}

std::uint8_t contact_shard(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::uint8_t>(mix(mix(a) ^ b) % kContactShards);
}

std::uint64_t digest_hash(std::span<const std::uint64_t> sums) {
  std::uint64_t hash = 0;
  for (const std::uint64_t sum : sums) hash = mix(hash ^ sum);
  return hash;
}

std::uint64_t contact_hash(std::uint64_t a, std::uint64_t b, std::uint64_t episode) {
  return mix(mix(mix(a) ^ b) ^ episode);
}

}  // namespace collided::wire_contract
