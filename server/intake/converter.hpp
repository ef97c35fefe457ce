#pragma once

#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// A directory of our own under the system's temporary one; goes with all that is in it.
class TemporaryDirectory {
 public:
  /// throws    LoadError naming `file` when none can be made
  explicit TemporaryDirectory(const std::string& file);
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The .cscene file that the converter process made from another file; removed with this.
///
/// The converter (collided-import) is $COLLIDED_IMPORT, else it stands beside the running program, else where the
/// install put it. It sets itself limits on memory, processor time and system calls and is ended after $COLLIDED_IMPORT_SECONDS
/// (default 900). What it prints is passed on: lines that begin with "placed: ", "note: ", "mended: ", "refused: " or
/// "warning: " go to the report, anything on its error stream goes into the LoadError.
class ConvertedFile {
 public:
  /// throws    LoadError when there is no converter, it fails or takes too long, or the caller cancels
  ConvertedFile(const std::string& path, const std::string& scene_name, const LoadOptions& options, LoadReport& report);

  std::string path() const { return directory_.path() + "/scene.cscene"; }

 private:
  TemporaryDirectory directory_;
};

}  // namespace collided::engine
