#pragma once

#include <string>

#include "server/intake/scene.hpp"

namespace collided {

/// The .cscene file that the converter process made from a file in another format; removed with this.
///
/// The converter (collided-import) is looked for at $COLLIDED_IMPORT, beside the running program, then where the
/// install put it. It runs with limits on memory, processor time and wall time; what it says is passed on: "mended",
/// "refused" and "warning" lines into the report, anything else into the error.
class ConvertedFile {
 public:
  /// throws    LoadError when there is no converter, it fails, or the caller cancels
  ConvertedFile(const std::string& path, const std::string& scene_name, const LoadOptions& options,
                LoadReport& report);
  ~ConvertedFile();
  ConvertedFile(const ConvertedFile&) = delete;
  ConvertedFile& operator=(const ConvertedFile&) = delete;

  const std::string& path() const { return output_; }

 private:
  std::string directory_;
  std::string output_;
};

}  // namespace collided
