#pragma once

#include <cstddef>
#include <vector>

namespace collided::engine {

/// Sets the size of a column that has an entry a slot, and gives memory back of which it needs less than a quarter.
template <class T>
void resize_column(std::vector<T>& column, std::size_t count) {
  constexpr std::size_t kKept = 1'024;
  column.resize(count);
  if (column.capacity() > kKept && column.capacity() / 4 > count) column.shrink_to_fit();
}

}  // namespace collided::engine
