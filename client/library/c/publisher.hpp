#pragma once

#include <vector>

#include "client/library/c/values.hpp"

struct collided_publisher {
  collided::Publisher publisher;
  collided::PublisherReport report = {};  // its texts are lent to the caller until the next one
  std::vector<const char*> names = {}, reasons = {};
};
