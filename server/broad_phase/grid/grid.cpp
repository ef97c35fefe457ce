#include "server/broad_phase/grid/grid.hpp"

#include "server/broad_phase/grid/grid_levels.hpp"
#include "server/broad_phase/grid/grid_walk.hpp"

namespace collided::engine {

struct Grid::Storage {
  grid::Levels levels;
};

Grid::Grid() : storage_(std::make_unique<Storage>()) {}
Grid::~Grid() = default;
Grid::Grid(Grid&&) noexcept = default;
Grid& Grid::operator=(Grid&&) noexcept = default;

void Grid::rebuild(std::span<const Aabb> boxes) { storage_->levels.rebuild(boxes); }

std::size_t Grid::size() const { return storage_->levels.entry_count; }
bool Grid::is_swept() const { return storage_->levels.few.size() > 0; }
std::size_t Grid::bytes() const { return storage_->levels.bytes(); }

void Grid::pairs(PairFound found, WalkCost& cost) const { grid::find_pairs(storage_->levels, found, cost); }

void Grid::walk_box(const Aabb& asked, BoxFound found, WalkCost& cost) const {
  grid::walk_box(storage_->levels, asked, found, cost);
}

void Grid::walk_ray(const Ray& ray, double limit, RayFound found, WalkCost& cost) const {
  grid::walk_ray(storage_->levels, ray, limit, found, cost);
}

void Grid::walk_near(const Vec3& point, double limit_m2, NearFound found, WalkCost& cost) const {
  grid::walk_near(storage_->levels, point, limit_m2, found, cost);
}

}  // namespace collided::engine
