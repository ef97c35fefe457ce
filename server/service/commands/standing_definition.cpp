#include "server/service/commands/standing_definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/commands/fence_prism.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/solids/declared.hpp"
#include "server/world/solids/solid.hpp"

namespace collided::engine::service {
namespace {

std::uint8_t detects_of(const Arguments& arguments) {
  if (!arguments.has("detect")) return kDetectAll;
  std::uint8_t detects = 0;
  for (const std::string& word : arguments.texts("detect")) {
    const auto found = std::ranges::find_if(kDetectWords, [&](const auto& told) { return word == told.first; });
    if (found == std::end(kDetectWords))
      throw BadCommand(fmt::format("fence: 'detect' has {}; allowed: enter, exit, cross", printable(word)));
    detects |= found->second;
  }
  return detects;
}

/// Makes the definition's mesh, which must be closed, include its interior.
void enclose(FenceDefinition& definition) {
  if (!definition.shape.mesh) return;
  DeclaredMesh declared = declare_solid_at_once(definition.shape.mesh);
  if (!declared.solid)
    throw BadCommand(fmt::format("fence {}: its mesh holds nothing: {}. Nothing was added", printable(definition.name),
                                 declared.refusal));
  definition.solid = std::move(declared.solid);
}

Shape prism_of(const Arguments& arguments) {
  const std::vector<double> list = arguments.numbers("prism");
  const auto wrong = [] {
    throw BadCommand("fence: 'prism' is [low, high, x, y, x, y, ...], in metres, with three corners or more");
  };
  if (list.size() < 8 || list.size() % 2 != 0) wrong();
  std::vector<std::array<double, 2>> corners;
  for (std::size_t i = 2; i < list.size(); i += 2) corners.push_back({list[i], list[i + 1]});
  auto made = upright_prism(corners, list[0], list[1]);
  if (const auto* refusal = std::get_if<Refusal>(&made))
    throw BadCommand(fmt::format("fence: {}. Nothing was added", refusal->reason));
  return {.primitives = {}, .mesh = std::get<std::shared_ptr<const TriangleMesh>>(made)};
}

FenceDefinition bands_of(const Arguments& arguments) {
  FenceDefinition margin{.name = arguments.text("name"),
                         .only = arguments.text("only"),
                         .skip = arguments.text("skip"),
                         .mask = arguments.whole_32("mask"),
                         .margin = MarginBands{.around = arguments.text("around"),
                                               .bands_m = arguments.numbers("bands"),
                                               .hysteresis_m = arguments.number("hysteresis")}};
  margin.margin->dwell_ns = static_cast<std::int64_t>(arguments.whole("dwell_ns"));
  if (!is_good_name(margin.name))
    throw BadCommand(
        fmt::format("margin: the name {} is empty, longer than 255 bytes or not text", printable(margin.name)));
  if (margin.margin->around.empty() || margin.only.empty())
    throw BadCommand(fmt::format("margin {}: two names or globs are needed, 'around' and 'only'. Nothing was added",
                                 printable(margin.name)));
  // Touching objects are within all bands.
  if (margin.margin->bands_m.empty() || margin.margin->bands_m.back() != 0) margin.margin->bands_m.push_back(0);
  return margin;
}

FenceDefinition nearest_of(const Arguments& arguments) {
  FenceDefinition asked{
      .name = arguments.text("name"),
      .carrier = arguments.text("to"),
      .only = arguments.text("only"),
      .skip = arguments.text("skip"),
      .mask = arguments.whole_32("mask"),
      .nearest = NearestRule{.within_m = arguments.number("within"), .hysteresis_m = arguments.number("hysteresis")}};
  if (!is_good_name(asked.name))
    throw BadCommand(
        fmt::format("nearest: the name {} is empty, longer than 255 bytes or not text", printable(asked.name)));
  const std::optional<Vec3> point = arguments.vector("point");
  if (point.has_value() != asked.carrier.empty())
    throw BadCommand(fmt::format("nearest {}: an object, 'to', or a point is needed, and not both. Nothing was added",
                                 printable(asked.name)));
  if (asked.only.empty())
    throw BadCommand(fmt::format("nearest {}: the name or glob of the objects is needed, 'only'. Nothing was added",
                                 printable(asked.name)));
  if (point && !point->allFinite())
    throw BadCommand(fmt::format("nearest {}: the point is not finite. Nothing was added", printable(asked.name)));
  asked.shape.primitives.emplace_back(Sphere{point.value_or(Vec3::Zero()), 0});
  return asked;
}

FenceDefinition region_of(const Arguments& arguments, std::span<const std::byte> shape_bytes) {
  FenceDefinition fence{.name = arguments.text("name"),
                        .carrier = arguments.text("to"),
                        .only = arguments.text("only"),
                        .skip = arguments.text("skip"),
                        .mask = arguments.whole_32("mask"),
                        .detects = detects_of(arguments)};
  if (!is_good_name(fence.name))
    throw BadCommand(
        fmt::format("fence: the name {} is empty, longer than 255 bytes or not text", printable(fence.name)));
  if (arguments.has("prism")) {
    fence.shape = prism_of(arguments);
  } else {
    DecodedShape decoded = decode_shape(shape_bytes);
    if (!decoded.shape) throw BadCommand("fence: " + decoded.refusal);
    fence.shape = std::move(*decoded.shape);
  }
  enclose(fence);
  return fence;
}

}  // namespace

FenceDefinition definition_of(const Arguments& arguments, std::span<const std::byte> shape_bytes) {
  if (arguments.has("bands")) return bands_of(arguments);
  if (arguments.has("within")) return nearest_of(arguments);
  return region_of(arguments, shape_bytes);
}

}  // namespace collided::engine::service
