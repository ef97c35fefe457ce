#include "server/service/commands/surface_numbers.hpp"

#include <algorithm>

namespace collided::engine::service {

std::uint64_t SurfaceNumbers::number_of(const std::shared_ptr<const TriangleMesh>& mesh) {
  return number_of(mesh.get(), {.mesh = mesh, .scene = {}});
}

std::uint64_t SurfaceNumbers::number_of(const std::shared_ptr<const StaticScene>& scene) {
  // The mesh is a member of the scene, so its pointer shares the scene's lifetime.
  return number_of(&scene->mesh, {.mesh = std::shared_ptr<const TriangleMesh>(scene, &scene->mesh), .scene = scene});
}

std::uint64_t SurfaceNumbers::number_of(const TriangleMesh* mesh, Known known) {
  const auto found = numbers_.find(mesh);
  // Another mesh may have the address of one that is gone.
  if (found != numbers_.end() && !known_.at(found->second).mesh.expired()) return found->second;
  if (found != numbers_.end()) known_.erase(found->second);
  if (known_.size() >= sweep_at_) forget_what_is_gone();
  numbers_[mesh] = ++newest_;
  known_.emplace(newest_, std::move(known));
  return newest_;
}

SurfaceNumbers::Found SurfaceNumbers::find(std::uint64_t number) const {
  const auto found = known_.find(number);
  if (found == known_.end()) return {};
  return {.mesh = found->second.mesh.lock(), .scene = found->second.scene.lock()};
}

void SurfaceNumbers::forget_what_is_gone() {
  std::erase_if(known_, [](const auto& entry) { return entry.second.mesh.expired(); });
  std::erase_if(numbers_, [this](const auto& entry) { return !known_.contains(entry.second); });
  sweep_at_ = std::max<std::size_t>(256, 2 * known_.size());
}

}  // namespace collided::engine::service
