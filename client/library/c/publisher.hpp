#pragma once

#include "client/library/c/values.hpp"

struct collided_publisher {
  collided::Publisher publisher;
};
