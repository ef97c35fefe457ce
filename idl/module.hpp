#pragma once

#include <stdexcept>
#include <string>

/// Parts of this project that link libraries which only some users need. Each is a file that is loaded when it is first used,
/// so that nothing else links those libraries.
namespace collided {

/// It is not installed or cannot be loaded: which part needs it, where it was looked for, which package has it.
struct ModuleMissing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The function by which a module is used. The module stays loaded for as long as the process lives.
///
/// file     its name, such as "collided-http.so"
/// purpose  what needs it: "etcd"
/// throws   ModuleMissing
/// threads  any
void* module_function(const std::string& file, const char* function, const std::string& purpose);

}  // namespace collided
