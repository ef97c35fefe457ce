#include "server/world/query/world_digest.hpp"

#include <bit>
#include <span>
#include <string_view>

namespace collided::engine {
namespace {

/// A prime, so that a difference of sums can be divided by one object's hash.
constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;

__extension__ using Wide = unsigned __int128;

std::uint64_t product(std::uint64_t a, std::uint64_t b) { return static_cast<std::uint64_t>(Wide{a} * b % kPrime); }
std::uint64_t sum(std::uint64_t a, std::uint64_t b) { return (a + b) % kPrime; }
std::uint64_t difference(std::uint64_t a, std::uint64_t b) { return (a + kPrime - b) % kPrime; }

/// a^-1, by Fermat's little theorem; a is not 0.
std::uint64_t inverse(std::uint64_t a) {
  std::uint64_t result = 1;
  for (std::uint64_t exponent = kPrime - 2; exponent > 0; exponent >>= 1) {
    if ((exponent & 1) != 0) result = product(result, a);
    a = product(a, a);
  }
  return result;
}

/// Source: Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014 (variant 13 of the finaliser).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// The same on every machine, unlike std::hash.
class DigestHash {
 public:
  void add(std::uint64_t number) { state_ = mix(state_ ^ number); }
  /// -0 counts as 0: which of the two a pose has depends on how it was computed.
  void add(double number) { add(std::bit_cast<std::uint64_t>(number + 0.0)); }
  void add(std::string_view text) {
    add(std::uint64_t{text.size()});
    for (const char c : text) add(std::uint64_t{static_cast<unsigned char>(c)});
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

std::uint64_t key_of(std::string_view name) {
  DigestHash hash;
  hash.add(name);
  return hash.value() % kPrime;
}

std::size_t group_of(const ObjectInfo& info, std::uint64_t key) {
  constexpr std::size_t kPublished = WorldDigest::kGroups - WorldDigest::kUnpublishedGroups;
  return info.publisher != 0 ? key % kPublished : kPublished + key % WorldDigest::kUnpublishedGroups;
}

/// Never 0 modulo the prime, so that an added or missing object changes the sum.
std::uint64_t hash_of(const ObjectInfo& info, const Frame& frame) {
  DigestHash hash;
  hash.add(info.name);
  hash.add(std::uint64_t{info.moving});
  hash.add(std::uint64_t{info.filter.layers});
  hash.add(std::uint64_t{info.filter.mask});
  hash.add(std::uint64_t{info.filter.group});
  if (const AllowedPartners& allowed = info.rare->allowed; allowed.pairs) {
    hash.add(std::uint64_t{allowed.number});
    hash.add(std::uint64_t{allowed.pairs->is_every_pair()});
    for (const auto& [low, high] : allowed.pairs->pairs()) {
      if (low == allowed.number || high == allowed.number) hash.add(std::uint64_t{low} << 32 | high);
    }
  }
  hash.add(std::uint64_t{info.primitives.size()});
  hash.add(std::uint64_t{info.mesh ? info.mesh->mesh->triangles.size() : 0});
  for (const double x : frame.position) hash.add(x);
  for (const double x : frame.rotation.reshaped()) hash.add(x);
  return hash.value() % (kPrime - 1) + 1;
}

bool counts(const ObjectInfo* info) { return info != nullptr && info->scene_part == kNoScenePart; }

}  // namespace

WorldDigest digest_of(const Snapshot& state) {
  WorldDigest digest;
  for (std::size_t slot = 0; slot < state.objects.size(); ++slot) {
    const ObjectInfo* const info = state.objects[slot].get();
    if (!counts(info)) continue;
    const std::uint64_t key = key_of(info->name);
    const std::uint64_t hash = hash_of(*info, state.frame(static_cast<std::uint32_t>(slot)));
    std::uint64_t* const sums = &digest.sums[2 * group_of(*info, key)];
    sums[0] = sum(sums[0], hash);
    sums[1] = sum(sums[1], product(hash, key));
  }
  return digest;
}

// If the hash of one object alone differs, by d, the sums differ by d and d * key.
std::string first_difference(const Snapshot& state, const WorldDigest& here, const WorldDigest& there) {
  for (std::size_t group = 0; group < WorldDigest::kGroups; ++group) {
    const std::uint64_t by = difference(here.sums[2 * group], there.sums[2 * group]);
    if (by == 0) continue;
    const std::uint64_t key = product(difference(here.sums[2 * group + 1], there.sums[2 * group + 1]), inverse(by));
    for (const auto& info : state.objects) {
      if (counts(info.get()) && key_of(info->name) == key) return info->name;
    }
  }
  return {};
}

std::uint64_t scene_fingerprint(const Snapshot& state) {
  std::uint64_t sum = 0;
  for (const auto& scene : state.scenes) {
    DigestHash hash;
    hash.add(scene->name);
    for (const Part& part : scene->parts) {
      hash.add(part.name);
      hash.add(std::uint64_t{part.triangle_count});
    }
    for (const auto& triangle : scene->mesh.triangles) {
      for (const auto corner : triangle) {
        for (const double x : scene->mesh.vertices[static_cast<std::size_t>(corner)]) hash.add(x);
      }
    }
    sum += hash.value();
  }
  return sum;
}

}  // namespace collided::engine
