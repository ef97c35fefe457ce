#pragma once

#include "server/intake/files/file_options.hpp"

namespace collided::files {

/// Tables that are asked for besides.
struct CheckTables {
  bool volumes = false;
  bool encodings = false;
};

/// Prints what a file holds and what is wrong with it. 0: all of it was taken; 1: something was refused.
int check(const FileOptions& file, bool as_json, const CheckTables& tables = {});

}  // namespace collided::files
