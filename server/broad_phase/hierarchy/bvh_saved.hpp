#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// A tree as bytes: a header of 192, the nodes, the leaves, the split triangles. Written as they lie in memory, so that
/// they are used where a file is mapped; the header says for which kind of machine, and of which mesh.

inline constexpr std::size_t kSavedAlignment = 64;

std::vector<std::byte> save(const Layout& layout, const TriangleMesh& mesh);

/// Makes the checksums right again: the last step of save, and of a test that tampers with what they would tell first.
void seal(std::span<std::byte> saved, const TriangleMesh& mesh);

/// Fills layout and report; or says what is wrong, and both are to be forgotten.
std::string load(const TriangleMesh& mesh, std::span<const std::byte> bytes, std::shared_ptr<const void> keeper,
                 unsigned threads, Layout& layout, BvhReport& report);

}  // namespace collided::engine::bvh
