#pragma once

#include <cstdint>
#include <vector>

#include "tests/studies/growth/law.hpp"

namespace collided::growth {

struct GrowthSetting {
  bool quick = false;
  std::uint64_t seed = 20260612;
};

/// Half decades from `low` to `high`.
std::vector<double> half_decades(double low, double high);

/// Whole answers about a terrain: its index, rays and nearest points.
std::vector<Law> triangle_laws(const GrowthSetting& setting);
/// Whole steps of balls at one density, with all events.
std::vector<Law> mover_laws(const GrowthSetting& setting);
/// Whole steps of balls of which each touches four others on average.
std::vector<Law> contact_laws(const GrowthSetting& setting);
/// Small changes of a large world: objects that join and leave, name patterns in turn, one that moves in a pile; and
/// rays among many scenes.
std::vector<Law> change_laws(const GrowthSetting& setting);

}  // namespace collided::growth
