#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// Two objects as another library receives them: their parts, in world coordinates.
struct OpinionRequest {
  std::vector<ConvexPart> a;
  std::vector<ConvexPart> b;
};

/// Most parts of the two together that are sent.
inline constexpr std::size_t kMostOpinionParts = 200'000;
inline constexpr std::size_t kMostOpinionBytes = std::size_t{64} << 20;

/// The request as bytes for collided-opinion, little-endian: a word that names the format, the number of parts of each
/// object, then for each part its kind (a byte: the number in Primitive, or that of a triangle) and its doubles; for a
/// hull its vertices and faces instead.
std::vector<std::byte> encoded(const OpinionRequest& request);

/// The request, or the reason why the bytes are not one. The bytes are untrusted: every number must be finite, every
/// size not negative, every index within its vertices, and nothing is reserved that the bytes do not contain.
std::variant<OpinionRequest, std::string> read_opinion_request(std::span<const std::byte> bytes);

}  // namespace collided::engine
