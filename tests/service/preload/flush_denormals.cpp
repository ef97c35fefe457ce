#include <immintrin.h>

namespace {

/// What a library built with -ffast-math does when it is loaded: denormals become zero for the loading thread and for
/// every thread that it starts.
[[gnu::constructor]] void flush_denormals() {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

}  // namespace
