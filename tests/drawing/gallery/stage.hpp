#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "client/draw/drawing/drawing.hpp"
#include "tests/drawing/methods/back_faces.hpp"
#include "tests/drawing/methods/edge_image.hpp"
#include "tests/drawing/scenes.hpp"
#include "tests/service/child_process.hpp"

namespace collided::drawing_test {

/// The result, or its error thrown.
template <class T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// A server of the gallery's own, and what stands in it.
class Stage {
 public:
  explicit Stage(const std::string& program);

  /// Clears, and puts this there.
  void set(const Shape& shape);
  /// Clears, and loads a file; false where it is not there.
  bool load(const std::string& path);

  /// What there is, drawn.
  struct Shot {
    draw::Drawing drawing;
    Polygons polygons;
    Buffers buffers;
    std::uint64_t rays = 0;
    std::uint64_t undecided = 0;
  };
  Shot shoot(draw::DrawOptions options, bool with_buffers);

 private:
  testing_support::ScratchFolder folder_;
  std::unique_ptr<testing_support::ChildProcess> server_;
  std::optional<Client> client_;
  std::optional<Publisher> publisher_;
};

}  // namespace collided::drawing_test
