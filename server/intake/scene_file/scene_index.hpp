#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// Saved indexes behind the tables of a scene file: 64-byte blocks, one a mesh, then a list of them, then a last record
/// that says where the list is. Programs that know nothing of them read the tables alone. What the bytes of an index
/// mean is not known here; whoever uses one checks it.

/// What has to follow tables of that many bytes in the file; empty where no mesh has an index. The pieces lie in the
/// scene's indexes and in padding and list.
std::vector<std::span<const std::byte>> index_section(const Scene& scene, std::size_t before_bytes,
                                                      std::vector<std::byte>& padding, std::vector<std::byte>& list);

/// The bytes of the file that are tables: all of them, where there is no last record.
std::size_t table_bytes(std::span<const char> file);

/// Gives each mesh of the scene its index. keeper keeps the file's bytes as they are, which a mapping does for files
/// that are only ever replaced by rename; null: they are copied.
/// returns   false when the list is damaged: no mesh got one
bool attach_indexes(std::span<const char> file, const std::shared_ptr<const void>& keeper, Scene& scene);

/// For a scene whose meshes have changed.
void forget_indexes(Scene& scene);

}  // namespace collided::engine
