#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace collided::engine {

/// Room for more entries, by an eighth and not twofold where they come one by one: an entry that is added costs some copies,
/// and columns are most of what a crowd takes.
template <class T>
void reserve_column(std::vector<T>& column, std::size_t count, std::size_t share = 8) {
  if (count > column.capacity()) column.reserve(std::max(count, column.capacity() + column.capacity() / share + 16));
}

template <class T>
void add_to_column(std::vector<T>& column, T entry) {
  reserve_column(column, column.size() + 1);
  column.push_back(std::move(entry));
}

/// Sets the size of a column that has an entry a slot, and gives memory back where it needs less than three quarters.
template <class T>
void resize_column(std::vector<T>& column, std::size_t count) {
  constexpr std::size_t kKept = 1'024;
  reserve_column(column, count);
  column.resize(count);
  if (column.capacity() > kKept && column.capacity() - column.capacity() / 4 > count) column.shrink_to_fit();
}

}  // namespace collided::engine
