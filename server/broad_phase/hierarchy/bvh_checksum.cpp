#include "server/broad_phase/hierarchy/bvh_checksum.hpp"

#include <cstring>
#include <vector>

#include "server/broad_phase/hierarchy/bvh_threads.hpp"

namespace collided::engine::bvh {
namespace {

constexpr std::size_t kRunBytes = std::size_t{1} << 20;
constexpr std::size_t kLanes = 4;  // independent chains of multiplications

// Invertible in h for a given word and in the word for a given h: no single change is lost.
std::uint64_t mixed(std::uint64_t h, std::uint64_t word) {
  h = (h ^ word) * 0x9e3779b97f4a7c15u;
  return h ^ (h >> 32);
}

std::uint64_t word_at(const std::byte* bytes) {
  std::uint64_t word;
  std::memcpy(&word, bytes, sizeof(word));
  return word;
}

std::uint64_t run_checksum(std::span<const std::byte> bytes) {
  std::uint64_t lanes[kLanes] = {1, 2, 3, 4};
  constexpr std::size_t kStep = kLanes * sizeof(std::uint64_t);
  std::size_t at = 0;
  for (; at + kStep <= bytes.size(); at += kStep) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] = mixed(lanes[lane], word_at(&bytes[at + 8 * lane]));
  }
  std::byte rest[kStep] = {};
  if (at < bytes.size()) std::memcpy(rest, &bytes[at], bytes.size() - at);
  for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] = mixed(lanes[lane], word_at(rest + 8 * lane));
  std::uint64_t sum = mixed(bytes.size(), 0);
  for (const std::uint64_t lane : lanes) sum = mixed(sum, lane);
  return sum;
}

}  // namespace

std::uint64_t checksum(std::span<const std::byte> bytes, unsigned threads) {
  std::vector<std::uint64_t> sums((bytes.size() + kRunBytes - 1) / kRunBytes);
  in_runs(threads, bytes.size(), kRunBytes, [&](std::size_t begin, std::size_t end) {
    sums[begin / kRunBytes] = run_checksum(bytes.subspan(begin, end - begin));
  });
  return run_checksum(std::as_bytes(std::span(sums)));
}

std::uint64_t joined_checksum(std::uint64_t first, std::uint64_t second) { return mixed(mixed(1, first), second); }

}  // namespace collided::engine::bvh
