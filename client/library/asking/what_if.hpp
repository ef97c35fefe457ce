#pragma once

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::what_if: checks the configurations and sends them in chunks, which are answered on one state.
Result<WhatIfAnswers> what_if(Connection& connection, const WhatIfConfigurations& given, const WhatIfOptions& options);

}  // namespace collided::client
