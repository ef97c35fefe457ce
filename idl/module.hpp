#pragma once

#include <stdexcept>
#include <string>

/// Modules: parts of this project whose libraries only some users need. Each is a file that is loaded at its first use,
/// so that other parts do not link those libraries.
namespace collided {

/// A module is not installed or cannot be loaded. The message names the part that needs it, the folders searched, and
/// the package with it.
struct ModuleMissing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns a module's entry function. The module stays loaded until the process ends.
///
/// file     file name, such as "collided-http.so"
/// purpose  the part that needs it, such as "etcd"
/// throws   ModuleMissing
/// threads  any
void* module_function(const std::string& file, const char* function, const std::string& purpose);

}  // namespace collided
