#include "server/broad_phase/hierarchy/bvh_saved.hpp"

#include <cstring>

#include "server/broad_phase/hierarchy/bvh_check.hpp"
#include "server/broad_phase/hierarchy/bvh_checksum.hpp"
#include "server/broad_phase/hierarchy/bvh_primitive.hpp"
#include "server/broad_phase/hierarchy/bvh_threads.hpp"

namespace collided::engine::bvh {
namespace {

constexpr char kMagic[8] = {'C', 'B', 'S', 'P', 'T', 'R', 'E', 'E'};
/// Increase it with every change in the meaning of the bytes; a tree of another version is rebuilt.
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kByteOrder = 0x01020304;

/// Every field is checked before the bytes after the header are read.
struct SavedHeader {
  char magic[8] = {};
  std::uint32_t version = kVersion;
  std::uint32_t byte_order = kByteOrder;
  std::uint32_t node_bytes = sizeof(Node);
  std::uint32_t leaf_bytes = sizeof(Leaf);
  std::uint32_t width = kWidth;
  std::uint32_t has_corners = 0;
  std::uint64_t triangle_count = 0;
  std::uint64_t vertex_count = 0;
  std::uint64_t mesh_checksum = 0;
  std::uint64_t payload_checksum = 0;
  std::uint64_t node_count = 0;
  std::uint64_t leaf_count = 0;
  std::uint64_t split_count = 0;
  float root_low[3] = {};
  float root_high[3] = {};
  std::uint32_t root = kNothing;
  std::uint8_t spare[68] = {};
  std::uint64_t header_checksum = 0;  // of everything before it
};
static_assert(sizeof(SavedHeader) == 192 && sizeof(SavedHeader) % kSavedAlignment == 0);

std::uint64_t mesh_checksum(const TriangleMesh& mesh, unsigned threads) {
  return joined_checksum(checksum(std::as_bytes(std::span(mesh.vertices)), threads),
                         checksum(std::as_bytes(std::span(mesh.triangles)), threads));
}

std::uint64_t header_checksum(const SavedHeader& header) {
  return checksum(std::as_bytes(std::span(&header, 1)).first(offsetof(SavedHeader, header_checksum)), 1);
}

/// Checks for flaws that are visible in the header alone.
std::string flaw_of_header(const SavedHeader& header, const TriangleMesh& mesh, std::size_t byte_count) {
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0) return "it does not begin as one";
  if (header.version != kVersion)
    return "it is of version " + std::to_string(header.version) + ", this program reads " + std::to_string(kVersion);
  const bool same_machine = header.byte_order == kByteOrder && header.node_bytes == sizeof(Node) &&
                            header.leaf_bytes == sizeof(Leaf) && header.width == kWidth;
  if (!same_machine) return "it is for another kind of machine";
  if (header.header_checksum != header_checksum(header)) return "its header is damaged";
  if (header.triangle_count != mesh.triangles.size() || header.vertex_count != mesh.vertices.size()) {
    return "it is of another mesh";
  }
  if (header.node_count > kIndexMask || header.leaf_count > kIndexMask || header.split_count > header.triangle_count ||
      byte_count != sizeof(SavedHeader) + header.node_count * sizeof(Node) + header.leaf_count * sizeof(Leaf) +
                        header.split_count * sizeof(Split)) {
    return "its length is not what its header says";
  }
  return {};
}

template <class Record>
PlainArray<Record> copied(std::span<const std::byte> bytes) {
  PlainArray<Record> records(bytes.size() / sizeof(Record));
  if (!bytes.empty()) std::memcpy(static_cast<void*>(records.data()), bytes.data(), bytes.size());
  return records;
}

template <class Record>
PlainArray<Record> borrowed(std::span<const std::byte> bytes) {
  return PlainArray<Record>::borrowed({reinterpret_cast<const Record*>(bytes.data()), bytes.size() / sizeof(Record)});
}

void place(const SavedHeader& header, std::span<const std::byte> payload, std::shared_ptr<const void> keeper,
           Layout& layout) {
  const auto nodes = payload.first(header.node_count * sizeof(Node));
  const auto leaves = payload.subspan(nodes.size(), header.leaf_count * sizeof(Leaf));
  const auto splits = payload.subspan(nodes.size() + leaves.size());
  const bool in_place = keeper != nullptr && reinterpret_cast<std::uintptr_t>(payload.data()) % kSavedAlignment == 0;
  layout.nodes = in_place ? borrowed<Node>(nodes) : copied<Node>(nodes);
  layout.leaves = in_place ? borrowed<Leaf>(leaves) : copied<Leaf>(leaves);
  layout.splits.resize(header.split_count);
  if (!splits.empty()) std::memcpy(layout.splits.data(), splits.data(), splits.size());
  if (in_place) layout.keeper = std::move(keeper);
  layout.root = header.root;
  std::copy_n(header.root_low, 3, layout.root_low);
  std::copy_n(header.root_high, 3, layout.root_high);
}

}  // namespace

std::vector<std::byte> save(const Layout& layout, const TriangleMesh& mesh) {
  SavedHeader header;
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.has_corners = layout.has_corners ? 1 : 0;
  header.triangle_count = mesh.triangles.size();
  header.vertex_count = mesh.vertices.size();
  header.node_count = layout.nodes.size();
  header.leaf_count = layout.leaves.size();
  header.split_count = layout.splits.size();
  header.root = layout.root;
  std::copy_n(layout.root_low, 3, header.root_low);
  std::copy_n(layout.root_high, 3, header.root_high);
  std::vector<std::byte> bytes;
  bytes.reserve(sizeof(SavedHeader) + layout.nodes.bytes() + layout.leaves.bytes() +
                layout.splits.size() * sizeof(Split));
  const auto append = [&](std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
  append(std::as_bytes(std::span(&header, 1)));
  append(std::as_bytes(std::span(layout.nodes.data(), layout.nodes.size())));
  append(std::as_bytes(std::span(layout.leaves.data(), layout.leaves.size())));
  append(std::as_bytes(std::span(layout.splits)));
  seal(bytes, mesh);
  return bytes;
}

void seal(std::span<std::byte> saved, const TriangleMesh& mesh) {
  if (saved.size() < sizeof(SavedHeader)) return;
  const unsigned threads = thread_count(0);
  SavedHeader header;
  std::memcpy(&header, saved.data(), sizeof(SavedHeader));
  header.mesh_checksum = mesh_checksum(mesh, threads);
  header.payload_checksum = checksum(saved.subspan(sizeof(SavedHeader)), threads);
  header.header_checksum = header_checksum(header);
  std::memcpy(saved.data(), &header, sizeof(SavedHeader));
}

std::string load(const TriangleMesh& mesh, std::span<const std::byte> bytes, std::shared_ptr<const void> keeper,
                 unsigned threads, Layout& layout, BvhReport& report) {
  SavedHeader header;
  if (bytes.size() < sizeof(SavedHeader)) return "it is cut short";
  std::memcpy(&header, bytes.data(), sizeof(SavedHeader));
  if (std::string flaw = flaw_of_header(header, mesh, bytes.size()); !flaw.empty()) return flaw;
  const std::span<const std::byte> payload = bytes.subspan(sizeof(SavedHeader));
  if (checksum(payload, threads) != header.payload_checksum) return "its checksum is not that of its bytes";
  if (mesh_checksum(mesh, threads) != header.mesh_checksum) return "it is of another mesh";
  const MeshFrame found = mesh_frame(mesh, threads);
  if (found.has_corners != (header.has_corners != 0)) return "it is of another mesh";
  layout.frame = found.frame;
  layout.has_corners = found.has_corners;
  place(header, payload, std::move(keeper), layout);
  return flaw_of(layout, mesh, threads, report);
}

}  // namespace collided::engine::bvh
