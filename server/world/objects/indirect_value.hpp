#pragma once

#include <memory>
#include <utility>

namespace collided::engine {

/// A value that is usually the default, which then takes only a null pointer. Copies are deep.
/// threads  as the value itself: any may read
template <class Value>
class IndirectValue {
 public:
  IndirectValue() = default;
  IndirectValue(const IndirectValue& other) : own_(other.own_ ? std::make_unique<Value>(*other.own_) : nullptr) {}
  IndirectValue(IndirectValue&&) noexcept = default;
  IndirectValue& operator=(IndirectValue other) noexcept {
    own_ = std::move(other.own_);
    return *this;
  }
  ~IndirectValue() = default;

  const Value& operator*() const { return own_ ? *own_ : kDefault; }
  const Value* operator->() const { return own_ ? own_.get() : &kDefault; }
  /// Returns the value for changing it; allocates it if needed.
  Value& edit() {
    if (!own_) own_ = std::make_unique<Value>();
    return *own_;
  }

 private:
  inline static const Value kDefault{};

  std::unique_ptr<Value> own_;
};

}  // namespace collided::engine
