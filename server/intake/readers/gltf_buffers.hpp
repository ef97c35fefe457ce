#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/intake/file_bytes.hpp"
#include "server/intake/readers/json_view.hpp"

namespace collided::engine {

/// A glTF 2.0 file taken apart: its JSON text and, in a GLB file, the binary chunk after it. Both point into the file.
struct GltfText {
  std::string_view json;
  std::span<const char> binary{};
};

/// Takes a text or GLB file apart, or throws a LoadError.
/// source    glTF 2.0 specification, 4.4 "GLB File Format Specification"
GltfText gltf_text(const Reading& reading);

/// The buffers that a glTF file refers to: in the file itself (GLB), in its text (base64), or in other files, which
/// must be in its folder or below. The reading must outlive this.
class GltfBuffers {
 public:
  /// Opens or decodes every buffer, or throws a LoadError.
  GltfBuffers(const Reading& reading, const JsonView& root, std::span<const char> binary);

  /// Equally spaced elements in a buffer.
  struct Elements {
    const char* first = nullptr;
    std::size_t stride_bytes = 0;
    const char* at(std::uint64_t i) const { return first + i * stride_bytes; }
  };
  /// The elements of an accessor. Throws a LoadError if `count` of them, of element_bytes each, do not fit the buffer.
  Elements elements(const JsonView& accessor, std::uint64_t count, std::size_t element_bytes) const;

 private:
  std::span<const char> open(const Reading& reading, const JsonView& buffer, std::span<const char> binary);

  JsonView root_;
  std::vector<std::span<const char>> buffers_;
  std::vector<std::unique_ptr<std::string>> decoded_;
  std::vector<std::unique_ptr<FileBytes>> files_;
};

}  // namespace collided::engine
