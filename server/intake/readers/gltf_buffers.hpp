#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/intake/file_bytes.hpp"
#include "server/intake/readers/json_view.hpp"

namespace collided::engine {

/// A glTF 2.0 file apart: its JSON text and, of a GLB file, the binary piece behind it.
struct GltfText {
  std::string_view json;
  std::span<const char> binary{};
};

/// source    glTF 2.0 specification, 4.4 "GLB File Format Specification"
GltfText gltf_text(const Reading& reading);

/// The bytes that a glTF file speaks of: in itself (GLB), in its text (base64), or in a file beside it, which must be
/// in the same folder or below.
class GltfBuffers {
 public:
  GltfBuffers(const Reading& reading, const JsonView& root, std::span<const char> binary);

  /// count elements of element_bytes each, stride_bytes apart, from byte_offset on in a buffer view.
  struct Elements {
    const char* first = nullptr;
    std::size_t stride_bytes = 0;
    const char* at(std::uint64_t i) const { return first + i * stride_bytes; }
  };
  Elements elements(const JsonView& accessor, std::uint64_t count, std::size_t element_bytes) const;

 private:
  std::span<const char> open(const Reading& reading, const JsonView& buffer, std::span<const char> binary);

  JsonView root_;
  std::vector<std::span<const char>> buffers_;
  std::vector<std::unique_ptr<std::string>> decoded_;
  std::vector<std::unique_ptr<FileBytes>> files_;
};

}  // namespace collided::engine
