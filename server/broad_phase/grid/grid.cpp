#include "server/broad_phase/grid/grid.hpp"

#include <algorithm>
#include <vector>

#include "server/broad_phase/grid/grid_levels.hpp"
#include "server/broad_phase/grid/grid_walk.hpp"

namespace collided::engine {

namespace {

/// With more changed boxes than one in this many, a rebuild costs less than searching two indexes from then on.
constexpr std::size_t kRebuildShare = 16;

}  // namespace

/// The boxes of the last rebuild, and over them those that changed since. A box of the second kind is hidden in the
/// first.
struct Grid::Storage {
  Use use = Use::questions;
  std::shared_ptr<grid::Levels> base = std::make_shared<grid::Levels>();  // others may read it: written while unshared
  std::vector<std::uint64_t> is_newer;                                    // by number: a bit each; none without newer
  std::vector<std::uint32_t> newer;
  std::vector<Aabb> newer_boxes;
  // Shared with what it was updated from, which so must be rebuilt by the same thread, if at all.
  std::shared_ptr<grid::RebuildScratch> scratch = std::make_shared<grid::RebuildScratch>();
  std::size_t box_count = 0;     // that it was last rebuilt or updated with, empty ones included
  std::size_t hidden_count = 0;  // boxes of base that are not empty there and hidden
  grid::Levels over;             // of newer_boxes, numbered by their place in there

  bool hides(std::uint32_t number) const {
    return number / 64 < is_newer.size() && (is_newer[number / 64] >> number % 64 & 1) != 0;
  }
  void hide(std::uint32_t number) {
    if (hides(number)) return;
    is_newer[number / 64] |= std::uint64_t{1} << number % 64;
    newer.push_back(number);
    hidden_count += base->holds(number) ? 1 : 0;
  }
};

Grid::Grid(Use use) : storage_(std::make_unique<Storage>()) { storage_->use = use; }
Grid::~Grid() = default;
Grid::Grid(Grid&&) noexcept = default;
Grid& Grid::operator=(Grid&&) noexcept = default;

void Grid::rebuild(std::span<const Aabb> boxes) {
  Storage& s = *storage_;
  s.newer.clear();
  s.is_newer.clear();
  s.hidden_count = 0;
  s.box_count = boxes.size();
  if (s.base.use_count() > 1) s.base = std::make_shared<grid::Levels>();
  s.base->rebuild(boxes, s.use == Use::questions, *s.scratch);
}

void Grid::update(const Grid& before, std::span<const Aabb> boxes, std::span<const std::uint32_t> changed) {
  const Storage& old = *before.storage_;
  Storage& s = *storage_;
  s.scratch = old.scratch;
  const std::size_t most = old.base->entry_count / kRebuildShare;
  // With fewer boxes than before, numbers are out of use.
  if (changed.size() > 2 * most || boxes.size() < old.box_count) return rebuild(boxes);
  s.box_count = boxes.size();
  s.base = old.base;
  s.newer = old.newer;
  s.is_newer = old.is_newer;
  s.hidden_count = old.hidden_count;
  s.is_newer.resize(boxes.size() / 64 + 1);
  for (const std::uint32_t number : changed) s.hide(number);
  if (s.newer.size() > most) return rebuild(boxes);
  s.newer_boxes.clear();
  for (const std::uint32_t number : s.newer) s.newer_boxes.push_back(boxes[number]);
  s.over.rebuild(s.newer_boxes, s.use == Use::questions, *s.scratch);
}

std::size_t Grid::size() const {
  const Storage& s = *storage_;
  return s.base->entry_count - s.hidden_count + (s.newer.empty() ? 0 : s.over.entry_count);
}

bool Grid::is_swept() const { return storage_->newer.empty() && storage_->base->few.size() > 0; }

std::size_t Grid::bytes() const {
  const Storage& s = *storage_;
  return s.base->bytes() + s.over.bytes() + s.scratch->bytes() + s.is_newer.capacity() * sizeof(s.is_newer[0]) +
         s.newer.capacity() * sizeof(s.newer[0]) + s.newer_boxes.capacity() * sizeof(s.newer_boxes[0]);
}

void Grid::pairs(PairFound found, WalkCost& cost) const {
  const Storage& s = *storage_;
  if (s.newer.empty()) return grid::find_pairs(*s.base, found, cost);
  bool goes_on = true;
  const auto tell = [&](std::uint32_t a, std::uint32_t b) { return goes_on = found(std::min(a, b), std::max(a, b)); };
  const auto tell_base = [&](std::uint32_t a, std::uint32_t b) { return s.hides(a) || s.hides(b) || tell(a, b); };
  const auto tell_over = [&](std::uint32_t a, std::uint32_t b) { return tell(s.newer[a], s.newer[b]); };
  grid::find_pairs(*s.base, tell_base, cost);
  if (goes_on) grid::find_pairs(s.over, tell_over, cost);
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
  if (goes_on) grid::walk_box(s.over, asked, tell_over, cost);
}

/// Walks what was rebuilt last and then what changed since, within the limit that the first walk leaves.
/// walk(levels, limit, found): in one of the two.
template <class Found, class Walk>
void Grid::walk_both(double limit, const Found& found, const Walk& walk) const {
  const Storage& s = *storage_;
  if (s.newer.empty()) return walk(*s.base, limit, found);
  double reached = limit;
  const auto tell = [&](std::uint32_t number, double current) {
    return s.hides(number) ? current : reached = found(number, current);
  };
  walk(*s.base, limit, Found(tell));
  const auto tell_over = [&](std::uint32_t place, double current) { return found(s.newer[place], current); };
  walk(s.over, reached, Found(tell_over));
}

void Grid::walk_ray(const Ray& ray, double limit, RayFound found, WalkCost& cost) const {
  walk_both(limit, found, [&](const grid::Levels& levels, double from, RayFound tell) {
    grid::walk_ray(levels, ray, from, tell, cost);
  });
}

void Grid::walk_near(const Vec3& point, double limit_m2, NearFound found, WalkCost& cost) const {
  walk_both(limit_m2, found, [&](const grid::Levels& levels, double from_m2, NearFound tell) {
    grid::walk_near(levels, point, from_m2, tell, cost);
  });
}

}  // namespace collided::engine
