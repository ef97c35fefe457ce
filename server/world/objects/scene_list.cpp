#include "server/world/objects/scene_list.hpp"

#include <utility>

namespace collided::engine {
namespace {

/// Up to this many scenes are tested one by one.
constexpr std::size_t kFewScenes = 8;

}  // namespace

SceneList::SceneList(Scenes scenes) {
  auto held = std::make_shared<Listed>();
  held->scenes = std::move(scenes);
  if (held->scenes.size() > kFewScenes) {
    std::vector<Aabb> bounds;
    bounds.reserve(held->scenes.size());
    for (const auto& scene : held->scenes) bounds.push_back(scene->tree.bounds());
    auto tree = std::make_unique<BoxTree>();
    tree->rebuild(bounds);
    held->tree = std::move(tree);
  }
  held_ = std::move(held);
}

const std::shared_ptr<const SceneList::Listed>& SceneList::nothing() {
  static const std::shared_ptr<const Listed> none = std::make_shared<const Listed>();
  return none;
}

}  // namespace collided::engine
