#include "server/intake/readers/gltf_buffers.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "idl/base64.hpp"
#include "server/intake/readers/byte_order.hpp"

namespace collided::engine {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546c67;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinaryChunk = 0x004e4942;

/// A URI with escapes such as "%20" replaced by their characters.
std::string unescaped(std::string_view uri) {
  const auto hex = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1;
  };
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool is_escape = uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0;
    text += is_escape ? static_cast<char>(hex(uri[i + 1]) * 16 + hex(uri[i + 2])) : uri[i];
    i += is_escape ? 2 : 0;
  }
  return text;
}

}  // namespace

GltfText gltf_text(const Reading& reading) {
  const std::span<const char> bytes = reading.bytes;
  if (bytes.size() < 12 || number_at<std::uint32_t>(bytes.data(), std::endian::little) != kGlbMagic)
    return {{bytes.data(), bytes.size()}};
  const auto version = number_at<std::uint32_t>(bytes.data() + 4, std::endian::little);
  if (version != 2) refuse(reading, fmt::format("GLB version {}; only 2 is read", version));
  GltfText text;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const auto length = number_at<std::uint32_t>(bytes.data() + at, std::endian::little);
    const auto kind = number_at<std::uint32_t>(bytes.data() + at + 4, std::endian::little);
    if (length > bytes.size() - at - 8) {
      refuse_byte(reading, at, fmt::format("a piece of {} bytes, the file has {} more", length, bytes.size() - at - 8));
    }
    const std::span<const char> piece = bytes.subspan(at + 8, length);
    if (kind == kJsonChunk && text.json.empty()) text.json = {piece.data(), piece.size()};
    if (kind == kBinaryChunk && text.binary.empty()) text.binary = piece;
    at += 8 + std::size_t{length};
  }
  if (text.json.empty()) refuse(reading, "GLB without its JSON piece");
  return text;
}

GltfBuffers::GltfBuffers(const Reading& reading, const JsonView& root, std::span<const char> binary) : root_(root) {
  for (std::size_t i = 0; i < root.size_of("buffers"); ++i) {
    buffers_.push_back(open(reading, root.element("buffers", i), i == 0 ? binary : std::span<const char>{}));
  }
}

std::span<const char> GltfBuffers::open(const Reading& reading, const JsonView& buffer, std::span<const char> binary) {
  const std::uint64_t length = buffer.at("byteLength").index(reading.options.max_file_bytes + 1);
  std::span<const char> bytes = binary;
  if (buffer.has("uri")) {
    const JsonView uri = buffer.at("uri");
    const std::string text = uri.text();
    if (text.starts_with("data:")) {
      const std::size_t comma = text.find(";base64,");
      if (comma == std::string::npos) uri.complain("is data in another form than base64");
      std::optional<std::string> decoded = decode_base64(std::string_view(text).substr(comma + 8));
      if (!decoded) uri.complain("holds a letter that is none of base64");
      decoded_.push_back(std::make_unique<std::string>(std::move(*decoded)));
      bytes = *decoded_.back();
    } else {
      const std::filesystem::path path = std::filesystem::path(unescaped(text)).lexically_normal();
      const bool leaves = path.is_absolute() || path.empty() || *path.begin() == "..";
      if (leaves || reading.folder.empty()) {
        uri.complain(fmt::format("is {}; only files in the folder of this one and below it are read",
                                 in_quotes(text, kShownOfPath)));
      }
      const auto full = (std::filesystem::path(reading.folder) / path).string();
      files_.push_back(std::make_unique<FileBytes>(full, FileBytes::Access::copied, reading.options));
      bytes = files_.back()->bytes();
    }
  }
  if (bytes.size() < length) buffer.complain(fmt::format("says {} bytes, there are {}", length, bytes.size()));
  return bytes.first(length);
}

GltfBuffers::Elements GltfBuffers::elements(const JsonView& accessor, std::uint64_t count,
                                            std::size_t element_bytes) const {
  const JsonView view = root_.element("bufferViews", accessor.at("bufferView").index(root_.size_of("bufferViews")));
  const std::span<const char> buffer = buffers_[view.at("buffer").index(buffers_.size())];
  const std::uint64_t whole = buffer.size();
  const std::uint64_t view_begin = view.index_or("byteOffset", whole + 1, 0);
  const std::uint64_t view_length = view.at("byteLength").index(whole - view_begin + 1);
  const std::uint64_t begin = accessor.index_or("byteOffset", view_length + 1, 0);
  const std::uint64_t stride = view.index_or("byteStride", 253, element_bytes);
  if (stride < element_bytes)
    view.complain(fmt::format("has a stride of {} bytes for elements of {}", stride, element_bytes));
  const std::uint64_t room = view_length - begin;
  const bool fits = count == 0 || (room >= element_bytes && (count - 1) <= (room - element_bytes) / stride);
  if (!fits) accessor.complain(fmt::format("has {} elements, its buffer view has no room for them", count));
  return {buffer.data() + view_begin + begin, stride};
}

}  // namespace collided::engine
