#include "idl/module.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <vector>

namespace collided {
namespace {

namespace fs = std::filesystem;

/// The folders of the file with this code and of the program, so that a library finds modules in any process.
std::vector<fs::path> own_folders() {
  std::vector<fs::path> folders;
  std::error_code error;
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&module_function), &self) != 0 && self.dli_fname != nullptr) {
    // For a program, the name is the word that started it, which may be relative to PATH.
    const fs::path file = fs::canonical(self.dli_fname, error);
    if (!error) folders.push_back(file.parent_path());
  }
  folders.push_back(fs::read_symlink("/proc/self/exe", error).parent_path());
  return folders;
}

/// The module's path; empty: not found.
fs::path path_of_module(const std::string& file) {
  std::error_code error;
  std::vector<fs::path> places;
  // Relative to the folders of libraries, of programs and of helpers; build trees are laid out like a prefix.
  for (const fs::path& folder : own_folders())
    for (const char* way : {"collided", "../" COLLIDED_LIBDIR "/collided", "../../" COLLIDED_LIBDIR "/collided"})
      places.push_back(folder / way / file);
  places.push_back(fs::path(COLLIDED_FULL_LIBDIR) / "collided" / file);
  for (const fs::path& place : places)
    if (fs::is_regular_file(place, error)) return place;
  return {};
}

}  // namespace

void* module_function(const std::string& file, const char* function, const std::string& purpose) {
  const fs::path path = path_of_module(file);
  if (path.empty())
    throw ModuleMissing(purpose + " needs " + file +
                        ", which is not in " COLLIDED_FULL_LIBDIR
                        "/collided; the package libcollided2 has it, unless its build leaves it out");
  void* const loaded = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const found = loaded == nullptr ? nullptr : dlsym(loaded, function);
  if (found == nullptr) {
    const char* const why = dlerror();
    throw ModuleMissing(purpose + " needs " + file + ": " + (why == nullptr ? path.string() : why));
  }
  return found;
}

}  // namespace collided
