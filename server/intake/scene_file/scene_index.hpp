#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

// Saved indexes after the tables of a scene file: for each mesh a piece aligned to 64 bytes, then a list of the pieces,
// then a last record with the position of the list. Programs that do not know about indexes read only the tables. The
// bytes of an index are opaque here; the code that uses an index checks it.

/// The pieces to write after tables of before_bytes bytes; empty if no mesh has an index. They point into the scene's
/// indexes, and into padding and list, which must outlive them.
std::vector<std::span<const std::byte>> index_section(const Scene& scene, std::size_t before_bytes,
                                                      std::vector<std::byte>& padding, std::vector<std::byte>& list);

/// How many of the file's bytes are tables: all, if there is no last record.
std::size_t table_bytes(std::span<const char> file);

/// Gives each mesh of the scene its index from the file.
///
/// keeper    keeps the file's bytes valid and unchanged, as a mapping does for a file that is only ever replaced by
///           rename; null: the indexes are copied
/// returns   false if the list is damaged: then no mesh gets an index
bool attach_indexes(std::span<const char> file, const std::shared_ptr<const void>& keeper, Scene& scene);

/// Drops the indexes of a scene whose meshes have changed.
void forget_indexes(Scene& scene);

}  // namespace collided::engine
