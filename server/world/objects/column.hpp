#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace collided::engine {

/// Makes room for more entries. A column grows by an eighth, not twofold: each added entry then costs some copies, but
/// columns take most of a large world's memory.
template <class T>
void reserve_column(std::vector<T>& column, std::size_t count, std::size_t share = 8) {
  if (count > column.capacity()) column.reserve(std::max(count, column.capacity() + column.capacity() / share + 16));
}

template <class T>
void add_to_column(std::vector<T>& column, T entry) {
  reserve_column(column, column.size() + 1);
  column.push_back(std::move(entry));
}

/// Sets the size of a column with one entry per slot. Gives memory back if it needs less than three quarters.
template <class T>
void resize_column(std::vector<T>& column, std::size_t count) {
  constexpr std::size_t kKept = 1'024;
  reserve_column(column, count);
  column.resize(count);
  if (column.capacity() > kKept && column.capacity() - column.capacity() / 4 > count) column.shrink_to_fit();
}

}  // namespace collided::engine
