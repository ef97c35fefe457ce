#include "server/broad_phase/grid/grid.hpp"

#include <algorithm>
#include <vector>

#include "server/broad_phase/box_tests.hpp"
#include "server/broad_phase/grid/grid_levels.hpp"
#include "server/broad_phase/grid/grid_walk.hpp"

namespace collided::engine {

namespace {

/// With more changed boxes than one in this many, a rebuild is cheaper than searching two indexes afterwards.
constexpr std::size_t kRebuildShare = 16;
/// Up to this many boxes, building an index takes less time than updating one.
constexpr std::size_t kFewNewer = 64;

}  // namespace

/// The boxes of the last rebuild, and over them those that changed since, in a grid of their own, which is updated in
/// the same way: a changed box costs a rebuild of few, and its share of a rebuild of each of the larger grids. Changed
/// boxes are hidden in the first grid.
struct Grid::Storage {
  Use use = Use::questions;
  std::shared_ptr<grid::Levels> base = std::make_shared<grid::Levels>();  // shared: written only while it has one owner
  std::vector<std::uint64_t> is_newer;                                    // by number, one bit each
  std::vector<std::uint32_t> newer;
  std::vector<Aabb> newer_boxes;
  // Shared with the grid that it was updated from, which must therefore be rebuilt by the same thread, if at all.
  std::shared_ptr<grid::RebuildScratch> scratch = std::make_shared<grid::RebuildScratch>();
  std::size_t box_count = 0;     // at the last rebuild or update, empty ones included
  std::size_t hidden_count = 0;  // non-empty boxes of base that are hidden
  Aabb reach;                    // contains all boxes, and former ones since the last rebuild
  std::unique_ptr<Grid> over;    // of newer_boxes, numbered by their index there; null or outdated if there are none

  void extend_reach(const Aabb& box) {
    if (!box.empty()) reach.extend(box);
  }
  bool hides(std::uint32_t number) const {
    return number / 64 < is_newer.size() && (is_newer[number / 64] >> number % 64 & 1) != 0;
  }
  /// Hides a box that is not hidden yet; it becomes the last of the newer ones.
  void hide(std::uint32_t number, const Aabb& box) {
    is_newer[number / 64] |= std::uint64_t{1} << number % 64;
    newer.push_back(number);
    newer_boxes.push_back(box);
    hidden_count += base->holds(number) ? 1 : 0;
  }
  void index_newer(const Storage& old, std::span<const Aabb> boxes, std::vector<std::uint32_t>& again);
};

Grid::Grid(Use use) : storage_(std::make_unique<Storage>()) { storage_->use = use; }
Grid::~Grid() = default;
Grid::Grid(Grid&&) noexcept = default;
Grid& Grid::operator=(Grid&&) noexcept = default;

void Grid::rebuild(std::span<const Aabb> boxes) {
  Storage& s = *storage_;
  s.newer.clear();
  s.newer_boxes.clear();
  s.is_newer.clear();
  s.hidden_count = 0;
  s.box_count = boxes.size();
  if (s.base.use_count() > 1) s.base = std::make_shared<grid::Levels>();
  s.base->rebuild(boxes, s.use == Use::questions, *s.scratch);
  s.reach = Aabb{};
  for (const Aabb& box : boxes) s.extend_reach(box);
}

void Grid::update(const Grid& before, std::span<const Aabb> boxes, std::span<const std::uint32_t> changed) {
  const Storage& old = *before.storage_;
  Storage& s = *storage_;
  s.scratch = old.scratch;
  const std::size_t most = old.base->entry_count / kRebuildShare;
  // With fewer boxes than before, some numbers are unused.
  if (changed.size() > 2 * most || boxes.size() < old.box_count) return rebuild(boxes);
  s.box_count = boxes.size();
  s.base = old.base;
  s.newer = old.newer;
  s.newer_boxes = old.newer_boxes;
  s.is_newer = old.is_newer;
  s.hidden_count = old.hidden_count;
  s.reach = old.reach;
  s.is_newer.resize(boxes.size() / 64 + 1);
  std::vector<std::uint32_t> again;
  for (const std::uint32_t number : changed) {
    s.extend_reach(boxes[number]);
    if (s.hides(number)) again.push_back(number);
    else s.hide(number, boxes[number]);
  }
  if (s.newer.size() > most) return rebuild(boxes);
  s.index_newer(old, boxes, again);
}

/// Updates `over` if `newer` has additional boxes at its end.
///
/// again  numbers of boxes that are in the old one, or twice among the new ones, and changed; sorted here
void Grid::Storage::index_newer(const Storage& old, std::span<const Aabb> boxes, std::vector<std::uint32_t>& again) {
  if (!over) over = std::make_unique<Grid>(use);
  const std::size_t change_count = again.size() + newer.size() - old.newer.size();
  if (newer.size() <= kFewNewer || old.newer.empty() || change_count > newer.size() / kRebuildShare) {
    for (std::size_t place = 0; place < newer.size(); ++place) newer_boxes[place] = boxes[newer[place]];
    return over->rebuild(newer_boxes);
  }
  std::vector<std::uint32_t> places;
  std::sort(again.begin(), again.end());
  for (std::uint32_t place = 0; place < old.newer.size() && !again.empty(); ++place) {
    if (!std::binary_search(again.begin(), again.end(), newer[place])) continue;
    newer_boxes[place] = boxes[newer[place]];
    places.push_back(place);
  }
  for (std::size_t place = old.newer.size(); place < newer.size(); ++place) {
    places.push_back(static_cast<std::uint32_t>(place));
  }
  over->update(*old.over, newer_boxes, places);
}

std::size_t Grid::size() const {
  const Storage& s = *storage_;
  return s.base->entry_count - s.hidden_count + (s.newer.empty() ? 0 : s.over->size());
}

bool Grid::is_swept() const { return storage_->newer.empty() && storage_->base->few.size() > 0; }

std::size_t Grid::bytes() const {
  const Storage& s = *storage_;
  return s.base->bytes() + (s.over ? s.over->bytes() : 0) + s.scratch->bytes() +
         s.is_newer.capacity() * sizeof(s.is_newer[0]) + s.newer.capacity() * sizeof(s.newer[0]) +
         s.newer_boxes.capacity() * sizeof(s.newer_boxes[0]);
}

void Grid::pairs(PairFound found, WalkCost& cost) const {
  const Storage& s = *storage_;
  if (s.newer.empty()) return grid::find_pairs(*s.base, found, cost);
  bool goes_on = true;
  const auto tell = [&](std::uint32_t a, std::uint32_t b) { return goes_on = found(std::min(a, b), std::max(a, b)); };
  const auto tell_base = [&](std::uint32_t a, std::uint32_t b) { return s.hides(a) || s.hides(b) || tell(a, b); };
  const auto tell_over = [&](std::uint32_t a, std::uint32_t b) { return tell(s.newer[a], s.newer[b]); };
  grid::find_pairs(*s.base, tell_base, cost);
  if (goes_on) s.over->pairs(tell_over, cost);
  for (std::size_t i = 0; i < s.newer.size() && goes_on; ++i) {
    const auto tell_across = [&](std::uint32_t other) { return s.hides(other) || tell(s.newer[i], other); };
    grid::walk_box(*s.base, s.newer_boxes[i], tell_across, cost);
  }
}

void Grid::walk_box(const Aabb& asked, BoxFound found, WalkCost& cost) const {
  const Storage& s = *storage_;
  if (s.newer.empty()) return grid::walk_box(*s.base, asked, found, cost);
  bool goes_on = true;
  const auto tell = [&](std::uint32_t number) { return s.hides(number) || (goes_on = found(number)); };
  grid::walk_box(*s.base, asked, tell, cost);
  const auto tell_over = [&](std::uint32_t place) { return found(s.newer[place]); };
  if (goes_on) s.over->walk_box(asked, tell_over, cost);
}

/// Walks the last rebuild and then the changes since, within the limit that the first walk leaves.
///
/// walk_base(levels, limit, found), walk_over(grid, limit, found): walk one of the two
template <class Found, class WalkBase, class WalkOver>
void Grid::walk_both(double limit, const Found& found, const WalkBase& walk_base, const WalkOver& walk_over) const {
  const Storage& s = *storage_;
  if (s.newer.empty()) return walk_base(*s.base, limit, found);
  double reached = limit;
  const auto tell = [&](std::uint32_t number, double current) {
    return s.hides(number) ? current : reached = found(number, current);
  };
  walk_base(*s.base, limit, Found(tell));
  const auto tell_over = [&](std::uint32_t place, double current) { return found(s.newer[place], current); };
  walk_over(*s.over, reached, Found(tell_over));
}

void Grid::walk_ray(const Ray& ray, double limit, RayFound found, WalkCost& cost) const {
  // Most rays miss all moving objects.
  const SlabSpan span = clip(ray, storage_->reach, limit);
  if (!(span.entry <= span.exit)) return;
  walk_both(
      limit, found,
      [&](const grid::Levels& levels, double from, RayFound tell) { grid::walk_ray(levels, ray, from, tell, cost); },
      [&](const Grid& over, double from, RayFound tell) { over.walk_ray(ray, from, tell, cost); });
}

void Grid::walk_near(const Vec3& point, double limit_m2, NearFound found, WalkCost& cost) const {
  walk_both(
      limit_m2, found,
      [&](const grid::Levels& levels, double from_m2, NearFound tell) {
        grid::walk_near(levels, point, from_m2, tell, cost);
      },
      [&](const Grid& over, double from_m2, NearFound tell) { over.walk_near(point, from_m2, tell, cost); });
}

}  // namespace collided::engine
