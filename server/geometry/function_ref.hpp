#pragma once

#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

namespace collided::engine {

template <typename Signature>
class FunctionRef;

/// A reference to a callback: a function, a lambda or any callable, not owned. Two words, freely copied; copies refer
/// to the same callable, which must outlive every call. Meant as a parameter type: a lambda written in the call's
/// arguments lives long enough, one that initialises a FunctionRef variable does not. As thread-safe as the callable.
template <typename R, typename... Args>
class FunctionRef<R(Args...)> {
 public:
  template <typename F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<R, F&, Args...>)
      // NOLINTNEXTLINE(google-explicit-constructor): callers pass lambdas.
      FunctionRef(F&& callable) {
    using Callable = std::remove_reference_t<F>;
    if constexpr (std::is_function_v<Callable>) {
      target_.function = reinterpret_cast<void (*)()>(&callable);
      call_ = [](Target target, Args... args) -> R {
        return std::invoke(reinterpret_cast<Callable*>(target.function), std::forward<Args>(args)...);
      };
    } else {
      target_.object = std::addressof(callable);
      call_ = [](Target target, Args... args) -> R {
        using Kept = std::conditional_t<std::is_const_v<Callable>, const void*, void*>;
        return std::invoke(*static_cast<Callable*>(const_cast<Kept>(target.object)), std::forward<Args>(args)...);
      };
    }
  }

  R operator()(Args... args) const { return call_(target_, std::forward<Args>(args)...); }

 private:
  union Target {
    const void* object;
    void (*function)();
  };

  Target target_;
  R (*call_)(Target, Args...);
};

}  // namespace collided::engine
