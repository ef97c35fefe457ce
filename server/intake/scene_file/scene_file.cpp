#include "server/intake/scene_file/scene_file.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <cstring>
#include <unordered_set>

#include "idl/scene_tables.hpp"
#include "server/intake/file_bytes.hpp"
#include "server/intake/limits.hpp"
#include "server/intake/readers/names.hpp"
#include "server/intake/scene_file/scene_decoder.hpp"
#include "server/intake/scene_file/scene_encoder.hpp"
#include "server/intake/scene_file/scene_index.hpp"
#include "server/intake/scene_file/write_file.hpp"

namespace collided::engine {
namespace {

static_assert(sizeof(EdgeCollapse) == 2 * sizeof(std::uint32_t));
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(TriangleCorners) == 3 * sizeof(std::uint32_t));

/// Checks that the names of a scene are valid and occur once.
class NameCheck {
 public:
  std::string take(const flatbuffers::String& name) {
    const std::string_view text(name.c_str(), name.size());
    if (const std::string flaw = flaw_of_name(text); !flaw.empty()) {
      throw Flaw{fmt::format("name {} {}", in_quotes(text), flaw)};
    }
    if (!taken_.insert(text).second) {
      throw Flaw{fmt::format("two parts or objects have the name {}", in_quotes(text))};
    }
    return std::string(text);
  }

 private:
  std::unordered_set<std::string_view> taken_;
};

std::optional<SolidBy> solid_of(format::Solid solid) {
  switch (solid) {
    case format::Solid::surface: return std::nullopt;
    case format::Solid::closing: return SolidBy::closing;
    case format::Solid::winding: return SolidBy::winding;
  }
  throw Flaw{fmt::format("solid {}, allowed are 0 to 2", static_cast<int>(solid))};
}

void decode_parts(const format::Scene& from, NameCheck& names, Scene& scene) {
  const std::uint64_t triangle_count = scene.mesh.triangles.size();
  std::uint64_t covered = 0;
  for (std::uint32_t i = 0; from.parts() != nullptr && i < from.parts()->size(); ++i) {
    const format::Part& part = *from.parts()->Get(i);
    if (part.first_triangle() != covered || part.triangle_count() == 0 ||
        part.triangle_count() > triangle_count - covered) {
      throw Flaw{fmt::format("part {} is {} triangles from {}; parts must follow each other from {} up to {}", i,
                             part.triangle_count(), part.first_triangle(), covered, triangle_count)};
    }
    covered += part.triangle_count();
    scene.parts.push_back({names.take(*part.name()), part.first_triangle(), part.triangle_count(),
                           filter_of(part.filter()), cut_of(part, "part", part.triangle_count()),
                           solid_of(part.solid())});
  }
  if (covered != triangle_count) { throw Flaw{fmt::format("parts cover {} of {} triangles", covered, triangle_count)}; }
}

CollapseOrder decode_collapses(const format::Scene& from, std::size_t vertex_count) {
  const auto* numbers = from.collapses();
  if (numbers == nullptr) return {};
  if (numbers->size() % 2 != 0 || numbers->size() / 2 > vertex_count) {
    throw Flaw{fmt::format("{} numbers of collapses, allowed are twos, at most one for each of {} vertices",
                           numbers->size(), vertex_count)};
  }
  CollapseOrder order = format::copied<EdgeCollapse>(numbers);
  if (const std::string flaw = flaw_of(order, vertex_count); !flaw.empty()) throw Flaw{flaw};
  return order;
}

std::shared_ptr<const AllowedPairs> decode_pairs(const format::Scene& from, std::size_t object_count) {
  if (from.every_pair_allowed()) return std::make_shared<const AllowedPairs>();
  const auto* numbers = from.allowed_pairs();
  if (from.format() < kPairsFormat || (from.frozen() != nullptr && numbers == nullptr)) return nullptr;
  std::vector<NumberPair> pairs;
  const std::size_t number_count = numbers == nullptr ? 0 : numbers->size();
  if (number_count % 2 != 0) throw Flaw{fmt::format("{} numbers of allowed pairs, allowed are twos", number_count)};
  for (std::uint32_t i = 0; i < number_count; i += 2) {
    const NumberPair pair(numbers->Get(i), numbers->Get(i + 1));
    if (pair.high >= object_count) {
      throw Flaw{
          fmt::format("allowed pair {} has object {}, allowed are those before {}", i / 2, pair.high, object_count)};
    }
    pairs.push_back(pair);
  }
  return std::make_shared<const AllowedPairs>(std::move(pairs));
}

/// Decodes the parts of a snapshot beyond a scene: every part and object once in its order, and boxes that are not empty.
FrozenWorld decode_frozen(const format::Frozen& from, std::size_t member_count) {
  FrozenWorld frozen{.version = from.version(),
                     .world_time_ns = from.world_time_ns(),
                     .order = format::copied<std::uint32_t>(from.order())};
  std::vector<bool> is_placed(member_count);
  for (const std::uint32_t member : frozen.order) {
    if (member >= member_count || is_placed[member])
      throw Flaw{
          fmt::format("the order of ids has {} twice, or where only {} parts and objects are", member, member_count)};
    is_placed[member] = true;
  }
  if (!frozen.order.empty() && frozen.order.size() != member_count)
    throw Flaw{fmt::format("the order of ids has {} of {} parts and objects", frozen.order.size(), member_count)};
  if (from.states_covers()) {
    frozen.covers = format::copied<Aabb>(from.covers());
    for (const Aabb& box : *frozen.covers) {
      if (!(box.low.array() <= box.high.array()).all()) throw Flaw{"a box that it covers is empty or not a number"};
    }
  }
  for (std::uint32_t i = 0; from.lacks() != nullptr && i < from.lacks()->size(); ++i)
    frozen.lacks.push_back(from.lacks()->Get(i)->str());
  return frozen;
}

Scene decode_scene(const format::Scene& from, std::uint64_t byte_budget, std::uint64_t max_triangles) {
  SceneDecoder decoder(byte_budget, max_triangles, byte_budget);
  Scene scene;
  scene.name = from.name()->str();
  if (const std::string flaw = flaw_of_name(scene.name); !flaw.empty()) {
    throw Flaw{fmt::format("scene name {} {}", in_quotes(scene.name), flaw)};
  }
  if (from.mesh() != nullptr) { scene.mesh = decoder.mesh(*from.mesh()); }
  scene.collapses = decode_collapses(from, scene.mesh.vertices.size());
  NameCheck names;
  decode_parts(from, names, scene);
  for (std::uint32_t i = 0; from.objects() != nullptr && i < from.objects()->size(); ++i) {
    const format::Object& object = *from.objects()->Get(i);
    std::string name = names.take(*object.name());
    try {
      Pose pose;
      if (object.position() != nullptr) { pose.position = decoder.point(*object.position(), "position"); }
      if (object.rotation() != nullptr) { pose.rotation = decoder.rotation(*object.rotation(), "rotation"); }
      Shape shape = decoder.shape(*object.shape());
      const std::size_t triangle_count = shape.mesh ? shape.mesh->triangles.size() : 0;
      scene.objects.push_back({name,
                               std::move(shape),
                               pose,
                               filter_of(object.filter()),
                               {},
                               cut_of(object, "object", triangle_count),
                               i,
                               solid_of(object.solid())});
    } catch (const Flaw& flaw) { throw Flaw{fmt::format("object {}: {}", in_quotes(name), flaw.what)}; }
  }
  scene.allowed_pairs = decode_pairs(from, scene.objects.size());
  if (from.frozen() != nullptr) scene.frozen = decode_frozen(*from.frozen(), scene.parts.size() + scene.objects.size());
  return scene;
}

/// The offset of the checksum in verified tables; nothing if they have none.
std::optional<std::size_t> checksum_place(const std::uint8_t* data) {
  const std::uint8_t* at = flatbuffers::GetRoot<flatbuffers::Table>(data)->GetAddressOf(format::Scene::VT_CHECKSUM);
  return at == nullptr ? std::nullopt : std::optional(static_cast<std::size_t>(at - data));
}

std::uint64_t checksum_of(const std::uint8_t* data, std::size_t byte_count, std::size_t place) {
  constexpr std::uint8_t kZeros[sizeof(std::uint64_t)] = {};
  const std::size_t after = place + sizeof kZeros;
  uLong sum = crc32_z(0, data, place);
  sum = crc32_z(sum, kZeros, sizeof kZeros);
  return kIsChecksum | crc32_z(sum, data + after, byte_count - after);
}

/// Throws a Flaw if the format is unknown or the checksum does not match. Decoding would not notice a number that was
/// changed into another valid one.
void check_whole(const format::Scene& root, const std::uint8_t* data, std::size_t byte_count) {
  if (root.format() < 1 || root.format() > kSceneFormat) {
    throw Flaw{fmt::format("scene format {}, this program reads up to {}", root.format(), kSceneFormat)};
  }
  const std::optional<std::size_t> place = checksum_place(data);
  const bool fits = place ? root.checksum() == checksum_of(data, byte_count, *place) : root.format() == 1;
  if (!fits) throw Flaw{"cut or damaged: its checksum is not that of its bytes"};
}

Scene decode_scene_bytes(std::span<const std::byte> bytes, std::uint64_t max_triangles) {
  const format::AlignedBytes aligned(bytes);
  const auto* root = format::verified<format::Scene>(aligned.data(), bytes.size(), format::SceneIdentifier());
  if (root == nullptr) { throw Flaw{"not a scene file, or a damaged one: its tables do not check out"}; }
  check_whole(*root, aligned.data(), bytes.size());
  return decode_scene(*root, bytes.size(), max_triangles);
}

}  // namespace

Scene read_scene_file(const Reading& reading) {
  try {
    const std::span tables = std::as_bytes(std::span(reading.bytes)).first(table_bytes(reading.bytes));
    Scene scene = decode_scene_bytes(tables, reading.options.max_triangles);
    if (!attach_indexes(reading.bytes, reading.keeper, scene)) {
      reading.report.warnings.emplace_back("the list of saved indexes is damaged; they are built anew");
    }
    if (scene.frozen) {
      for (const std::string& lack : scene.frozen->lacks) reading.report.notes.push_back("not carried over: " + lack);
    }
    return scene;
  } catch (const Flaw& flaw) { refuse(reading, flaw.what); }
}

void seal_scene(std::span<std::byte> tables) {
  const format::AlignedBytes aligned(tables);
  if (format::verified<format::Scene>(aligned.data(), tables.size(), format::SceneIdentifier()) == nullptr) return;
  const std::optional<std::size_t> place = checksum_place(aligned.data());
  if (!place) return;
  const std::uint64_t sum = checksum_of(aligned.data(), tables.size(), *place);
  std::memcpy(tables.data() + *place, &sum, sizeof sum);
}

namespace {

/// Saves a scene by put(pieces), which returns an error or an empty text.
template <class Put>
void save_scene_by(const std::string& name, const Scene& scene, const Put& put) {
  const auto fail = [&](const std::string& what) {
    throw LoadError(fmt::format("{}: {}. Nothing was written.", name, what));
  };
  if (const std::uint64_t bytes = encoded_bytes(scene); bytes > format::kMaxBufferBytes) {
    fail(fmt::format("the scene needs {} bytes, limit {}", bytes, format::kMaxBufferBytes));
  }
  SceneEncoder encoder(encoded_bytes(scene));
  encoder.scene(scene);
  seal_scene(encoder.bytes());
  const std::span<const std::byte> bytes = encoder.bytes();
  try {
    decode_scene_bytes(bytes, kMaxVertices);
  } catch (const Flaw& flaw) { fail(flaw.what); }
  std::vector<std::byte> padding;
  std::vector<std::byte> list;
  std::vector<std::span<const std::byte>> pieces = index_section(scene, bytes.size(), padding, list);
  pieces.insert(pieces.begin(), bytes);
  if (const std::string failure = put(pieces); !failure.empty()) { fail(failure); }
}

}  // namespace

void save_scene(const std::string& path, const Scene& scene) {
  save_scene_by(file_name(path), scene, [&](const auto& pieces) { return replace_file(path, pieces); });
}

void save_scene(int file, const std::string& name, const Scene& scene) {
  save_scene_by(name, scene, [&](const auto& pieces) { return write_file(file, pieces); });
}

DecodedShape decode_shape(std::span<const std::byte> bytes, const ShapeLimits& limits) {
  if (bytes.size() > limits.max_bytes) {
    return {.shape = std::nullopt, .refusal = fmt::format("{} bytes, limit {}", bytes.size(), limits.max_bytes)};
  }
  const format::AlignedBytes aligned(std::as_bytes(std::span(bytes)));
  const auto* root = format::verified<format::Shape>(aligned.data(), bytes.size(), nullptr);
  if (root == nullptr) {
    return {.shape = std::nullopt, .refusal = "not a shape, or a damaged one: its tables do not check out"};
  }
  try {
    return {.shape = SceneDecoder(bytes.size(), limits.max_triangles, limits.max_primitives).shape(*root),
            .refusal = {},
            .is_solid = root->is_solid(),
            .by_winding = root->by_winding()};
  } catch (const Flaw& flaw) { return {.shape = std::nullopt, .refusal = flaw.what}; }
}

std::vector<std::byte> encode_shape(const Shape& shape) {
  SceneEncoder encoder(encoded_bytes(shape));
  encoder.finish(encoder.shape(shape));
  const std::span<const std::byte> bytes = encoder.bytes();
  return {bytes.begin(), bytes.end()};
}

}  // namespace collided::engine
