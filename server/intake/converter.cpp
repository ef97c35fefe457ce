#include "server/intake/converter.hpp"
namespace collided {
ConvertedFile::ConvertedFile(const std::string& path, const std::string&, const LoadOptions&, LoadReport&) {
  throw LoadError(path + ": no reader for this ending. Nothing was loaded.");
}
ConvertedFile::~ConvertedFile() = default;
}
