#pragma once

#include <cstring>
#include <random>

#include "tests/accuracy/census/inputs.hpp"
#include "tests/accuracy/census/table.hpp"

namespace collided::census {
using namespace engine;

/// How much of the census is taken.
struct Effort {
  std::mt19937_64& generator;
  double part = 1;               // of the long form
  std::uint64_t peer_count = 0;  // cases that peers are asked, at most
  std::string only;              // a query, or all

  std::uint64_t count(std::uint64_t whole) const {
    return std::max<std::uint64_t>(2048, static_cast<std::uint64_t>(part * static_cast<double>(whole)));
  }
  bool wants(const char* query) const { return only.empty() || only == query; }
};

void count_rays(Table& table, const Effort& effort);
void count_pairs(Table& table, const Effort& effort);

}  // namespace collided::census
