#include <cstdlib>

#include "client/library/c/options.hpp"

namespace collided::c {

namespace {

int code_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_input: return COLLIDED_BAD_INPUT;
    case ErrorCode::no_server: return COLLIDED_NO_SERVER;
    case ErrorCode::timeout: return COLLIDED_TIMEOUT;
    case ErrorCode::refused: return COLLIDED_REFUSED;
    case ErrorCode::disconnected: return COLLIDED_DISCONNECTED;
    case ErrorCode::internal: break;
  }
  return COLLIDED_INTERNAL;
}

}  // namespace

int fail(const Error& error, collided_error* target) {
  collided_error told{};
  told.code = code_of(error.code);
  told.retry_after_ns = std::chrono::nanoseconds(error.retry_after).count();
  put_text(error.message, told.message);
  put_text(error.hint, told.hint);
  const int code = told.code;
  give(told, target);
  return code;
}

void note(std::string_view text, collided_error* target) {
  collided_error told{};
  told.code = COLLIDED_OK;
  put_text(text, told.message);
  give(told, target);
}

Error missing(std::string_view what) {
  return {ErrorCode::bad_input, std::string(what) + " is null", "nothing was sent"};
}

Error unknown_kind(const std::string& what, std::int32_t kind, std::int32_t last) {
  return {ErrorCode::bad_input,
          "a " + what + " of kind " + std::to_string(kind) + "; known are 0 to " + std::to_string(last),
          "nothing was sent"};
}

Result<void> hand_out(std::string_view words, char** target) {
  if (!target) return {};
  *target = static_cast<char*>(std::malloc(words.size() + 1));
  if (!*target) return Error{ErrorCode::internal, "no memory for the answer", ""};
  std::copy_n(words.data(), words.size(), *target);
  (*target)[words.size()] = 0;
  return {};
}

AskOptions ask_options(const collided_ask_options* options) {
  collided_ask_options defaults;
  collided_ask_defaults(&defaults, sizeof defaults);
  const collided_ask_options given = taken(options, defaults);
  AskOptions made;
  made.mode = static_cast<HitMode>(given.mode);
  made.mask = given.mask;
  made.only = text(given.only);
  made.skip = text(given.skip);
  if (given.max_hits > 0) made.max_hits = given.max_hits;
  made.error_m = given.error_m;
  made.deadline = std::chrono::nanoseconds(given.deadline_ns);
  if (given.timeout_ns != 0) made.timeout = std::chrono::nanoseconds(given.timeout_ns);
  made.fresh = given.fresh != 0;
  made.importance = static_cast<Importance>(given.importance);
  made.as_of = {static_cast<Instant::Kind>(given.instant), std::chrono::nanoseconds(given.instant_ns)};
  return made;
}

}  // namespace collided::c

extern "C" {

const char* collided_version(void) { return collided::library_version().data(); }

void collided_free_text(char* text) { std::free(text); }

void collided_ask_defaults(collided_ask_options* options, uint32_t size) {
  if (!options) return;
  options->size = size;
  collided_ask_options defaults{};
  defaults.mask = 0xffffffff;
  collided::c::give(defaults, options);
}

}  // extern "C"
