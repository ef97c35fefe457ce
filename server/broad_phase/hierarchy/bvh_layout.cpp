#include "server/broad_phase/hierarchy/bvh_layout.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace collided::engine::bvh {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kCacheLine = 64;

std::size_t mapped_length(std::size_t bytes) { return (bytes + kHugePage - 1) / kHugePage * kHugePage; }

/// A number near `center` on a lattice of 1/16 of the scene's size; zero if that is close enough, so that coordinates
/// given as floats stay floats.
double lattice_origin(double center, int size_exponent) {
  const double step = std::ldexp(1.0, std::max(size_exponent - 4, -1074));
  if (std::abs(center) <= 64 * step) return 0;
  const double steps = center / step;
  return std::abs(steps) < 0x1p52 ? std::nearbyint(steps) * step : center;
}

}  // namespace

LocalFrame local_frame(const Aabb& bounds) {
  LocalFrame frame;
  if (bounds.empty()) return frame;
  // Halves first: a scene may span more than the largest double.
  const Vec3 center = bounds.low / 2 + bounds.high / 2;
  const double half_size = (bounds.high / 2 - bounds.low / 2).maxCoeff();
  const int size_exponent = half_size > 0 ? std::ilogb(half_size) + 1 : -1000;
  for (int axis = 0; axis < 3; ++axis) frame.origin[axis] = lattice_origin(center[axis], size_exponent);

  const double reach =
      std::max((bounds.high - frame.origin).cwiseAbs().maxCoeff(), (bounds.low - frame.origin).cwiseAbs().maxCoeff());
  const int reach_exponent = reach > 0 ? std::ilogb(reach) + 1 : -1000;
  // Below 2^-1000 the inverse scale would overflow; such a scene stays small in local coordinates, which is allowed.
  frame.scale_exponent = -std::max(reach_exponent, -1000);
  frame.scale = std::ldexp(1.0, frame.scale_exponent);
  frame.inverse_scale = std::ldexp(1.0, -frame.scale_exponent);
  return frame;
}

float round_down(double value) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value ? std::nextafter(nearest, -kInfinity) : nearest;
}

float round_up(double value) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value ? std::nextafter(nearest, kInfinity) : nearest;
}

std::span<std::byte> allocate_pages(std::size_t bytes) {
  if (bytes < kHugePage) {
    void* memory = std::aligned_alloc(kCacheLine, (bytes + kCacheLine) / kCacheLine * kCacheLine);
    if (memory == nullptr) throw std::bad_alloc();
    return {static_cast<std::byte*>(memory), bytes};
  }
  // Maps new memory: memory reused by malloc already has small pages.
  const std::size_t length = mapped_length(bytes);
  void* mapping = mmap(nullptr, length + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapping == MAP_FAILED) throw std::bad_alloc();
  auto* first = static_cast<std::byte*>(mapping);
  const std::size_t before = (kHugePage - reinterpret_cast<std::uintptr_t>(first) % kHugePage) % kHugePage;
  std::byte* memory = first + before;
  if (before > 0) munmap(first, before);
  munmap(memory + length, kHugePage - before);
  // Only a hint: if the system refuses, the tree is slower, not wrong.
  (void)madvise(memory, length, MADV_HUGEPAGE);
  return {memory, bytes};
}

void free_pages(std::span<std::byte> memory) {
  if (memory.size() < kHugePage) {
    std::free(memory.data());
  } else {
    munmap(memory.data(), mapped_length(memory.size()));
  }
}

}  // namespace collided::engine::bvh
