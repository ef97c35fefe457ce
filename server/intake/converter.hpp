#pragma once

#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// A new directory under the system's temporary one. The destructor removes it with its content; the next constructor
/// removes those of killed processes, once they are a minute old.
class TemporaryDirectory {
 public:
  /// throws    LoadError naming `file` if none can be made
  explicit TemporaryDirectory(const std::string& file);
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int lock_ = -1;  // on the directory: marks it as in use
};

/// Converts a file of any format to a .cscene file in a separate process, the converter. The destructor removes the
/// .cscene file.
///
/// The converter (collided-import) is found by find_helper_program and COLLIDED_IMPORT. It limits its own memory,
/// processor time and system calls, and is ended after $COLLIDED_IMPORT_SECONDS (default 30). Lines of its output that
/// begin with "placed: ", "note: ", "mended: ", "refused: " or "warning: " go to the report; its error stream goes into
/// the LoadError.
class ConvertedFile {
 public:
  /// Runs the converter to its end.
  /// throws    LoadError if there is no converter, it fails or takes too long, or the caller cancels
  ConvertedFile(const std::string& path, const std::string& scene_name, const LoadOptions& options, LoadReport& report);

  std::string path() const { return directory_.path() + "/scene.cscene"; }

 private:
  TemporaryDirectory directory_;
};

}  // namespace collided::engine
