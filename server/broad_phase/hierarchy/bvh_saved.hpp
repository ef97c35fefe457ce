#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// A tree as bytes: a header of 192 bytes, the nodes, the leaves, the split triangles. Stored as in memory, so that a
/// mapped file can be used in place; the header records the kind of machine and the mesh.

inline constexpr std::size_t kSavedAlignment = 64;

/// The layout, which must not be empty, as bytes with checksums.
std::vector<std::byte> save(const Layout& layout, const TriangleMesh& mesh);

/// Recomputes the checksums: the last step of save(), and of tests that tamper with bytes the checksums would reveal.
void seal(std::span<std::byte> saved, const TriangleMesh& mesh);

/// Fills layout and report, or returns the flaw; then both are invalid.
std::string load(const TriangleMesh& mesh, std::span<const std::byte> bytes, std::shared_ptr<const void> keeper,
                 unsigned threads, Layout& layout, BvhReport& report);

}  // namespace collided::engine::bvh
