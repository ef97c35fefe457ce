#include "tests/oracle/sampled_contacts.hpp"

#include <algorithm>
#include <utility>

namespace collided::oracle {

SampledContacts::SampledContacts(std::vector<Figure> a, std::vector<Figure> b, const Vec3& displacement)
    : a_(std::move(a)), b_(std::move(b)), displacement_(exact(displacement)) {}

bool SampledContacts::touch_at(long ticks, long of) const {
  Point by;
  for (std::size_t k = 0; k < 3; ++k) by[k] = displacement_[k] * Rational(ticks, of);
  return std::any_of(b_.begin(), b_.end(), [&](const Figure& part) {
    const Figure moved = shifted(part, by);
    return std::any_of(a_.begin(), a_.end(), [&](const Figure& other) { return overlaps(other, moved); });
  });
}

}  // namespace collided::oracle
